"""Are the loops of a start-up stable on the plant itself? Not on the model that they were designed on.

The settings are those of the transaction that is accepted (`commission edit`, `diff`). The sampled loops are closed on the
plant of the simulator's file with its own orders, zeros and dead times (tests/reference/sampled_loops.py, no approximation),
and judged by the eigenvalues of the whole: independent of the firmware's own criterion.
"""

from __future__ import annotations

import functools
import re
import sys
from collections.abc import Sequence

import numpy as np

from research import known_plants
from reflux.paths import ROOT

sys.path.append(str(ROOT / "tests" / "reference"))

from linear_reference import Plant  # noqa: E402
from sampled_loops import Loop, plant_parts  # noqa: E402


@functools.cache
def _parts(name: str) -> tuple[Plant, list | None]:
    plant = known_plants.linear(name)
    if plant.discrete:
        return plant, None
    return plant, plant_parts(plant, plant.j["tick_s"])


def settings(said: str) -> tuple[dict[int, dict[str, str]], dict[tuple[int, int], float]] | None:
    """Loops and decoupler of the transaction that `commission edit` opened; None where there was no proposal."""
    found = re.search(r"> commission edit\n\S+ < ok\n\S+ > diff\n(.*?)\n\S+ < ok$", said, re.M | re.S)
    if not found:
        return None
    loops: dict[int, dict[str, str]] = {}
    decoupler: dict[tuple[int, int], float] = {}
    for number, key, value in re.findall(r"< set loop(\d+)\.(\w+) (\S+)$", found.group(1), re.M):
        loops.setdefault(int(number), {})[key] = value
    for row, column, value in re.findall(r"< set decouple(\d+)\.d(\d+) (\S+)$", found.group(1), re.M):
        decoupler[int(row), int(column)] = float(value)
    return loops, decoupler


def radius(said: str, name: str, gain_times: float = 1.0, changes: Sequence[str] = ()) -> float | None:
    """Largest modulus of an eigenvalue of the accepted loops on the plant, below 1: stable. None: there is none.
    changes: "loop1.gain 2", what was set after `diff`."""
    found = settings(said)
    if not found or not found[0]:
        return None
    plant, parts = _parts(name)
    if parts is None:
        return None  # a plant with a period of its own
    outputs, inputs = ([c["name"] for c in channels] for channels in (plant.outputs, plant.j["inputs"]))
    loops, given = found
    for change in changes:
        number, key, value = re.fullmatch(r"loop(\d+)\.(\w+) (\S+)", change).groups()
        loops[int(number)][key] = value
    order = sorted(loops)
    sign = [-1.0 if loops[n].get("action") == "direct" else 1.0 for n in order]
    decoupler = np.array([[given.get((i, j), float(i == j)) for j in order] for i in order])
    return Loop(parts, [(outputs.index(loops[n]["pv"]), inputs.index(loops[n]["out"])) for n in order],
                [gain_times * s * float(loops[n]["gain"]) for n, s in zip(order, sign)],
                [float(loops[n]["ti"]) for n in order], plant.j["tick_s"], decoupler).radius()
