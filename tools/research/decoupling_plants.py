"""Plants of the campaign `decoupling`: which, how often they are sampled, and how they differ from what a design was made for."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reflux import ina_plant, plant_file
from reflux.errors import UserError

# Setpoints are stepped by so much of span, or by what moves no MV by more than this.
STEP, MOVE = 0.05, 0.25
# Changes of gains: those of inputs in turn, as valves and calibrations do, or the first element alone, as a wrong model does. (All
# elements in a chequered pattern would change the sign of the determinant where relative gains are above 1.8, and no controller with
# integral action bears that.)
ERROR = 0.2
ERRORS = ("inputs +-", "inputs -+", "element +", "element -")


@dataclass(frozen=True)
class Bench:
    """One plant. settles: samples of its slowest element; bits, clock: of the signals of its experiment."""

    name: str
    period_s: float
    settles: int
    bits: int
    clock: int
    amplitude: float = 0.05
    pairs: str | None = None
    na: int = 2  # highest order of A that the experiment tries

    def path(self) -> Path:
        return plant_file.PLANTS / f"{self.name}.json"

    def file(self) -> dict[str, Any]:
        return json.loads(self.path().read_text(encoding="utf-8"))


BENCHES = {b.name: b for b in (
    Bench("kotyk-column", 120, 40, 7, 2, 0.1),
    Bench("wood-berry", 120, 60, 7, 2),
    Bench("luyben-vinante", 60, 50, 7, 2),
    Bench("lime-kiln", 120, 100, 7, 2, 0.2, na=3),
    Bench("packed-bed", 30, 60, 7, 3, 0.3),
    Bench("air-compressor", 0.4, 40, 7, 2, 0.2, pairs="y1=u2,y2=u1", na=4),
    Bench("folami-gains", 120, 50, 7, 2),
    Bench("furnace", 60, 30, 8, 1),
    Bench("luyben-4x4", 300, 70, 8, 1),
)}


def named(name: str) -> Bench:
    if name not in BENCHES:
        raise UserError(f"no plant {name} in the campaign; there are: {', '.join(BENCHES)}")
    return BENCHES[name]


def ordered(bench: Bench) -> tuple[dict[str, Any], list[int], list[int]]:
    """The file, and its outputs and inputs in the order of the loops."""
    j = bench.file()
    rows, columns = ina_plant.paired(j, bench.pairs)
    return j, rows, columns


def signs(n: int, error: str) -> np.ndarray:
    """n x n of 1, -1 and 0: rows are outputs."""
    what, _, which = error.partition(" ")
    first = 1.0 if which.startswith("+") else -1.0
    if what == "inputs":
        return np.tile(first * (-1.0) ** np.arange(n), (n, 1))
    out = np.zeros((n, n))
    out[0, 0] = first
    return out


def write_wrong(bench: Bench, error: str, path: Path) -> None:
    """The plant with other gains."""
    j, rows, columns = ordered(bench)
    by = 1.0 + ERROR * signs(len(rows), error)
    if j["model"] == "transfer":
        for i, row in enumerate(rows):
            for k, column in enumerate(columns):
                if j["elements"][row][column]:
                    j["elements"][row][column]["gain"] *= by[i, k]
    elif j["model"] == "polynomial":
        for one in j["B"]:
            for i, row in enumerate(rows):
                for k, column in enumerate(columns):
                    one[row][column] *= by[i, k]
    else:
        raise UserError(f"{bench.name}: gains of a {j['model']} are not changed here")
    path.write_text(json.dumps(j), encoding="utf-8")
