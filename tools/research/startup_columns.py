"""A distillation column as data among the plants of the campaign of start-ups: the methanol column of the simulator with another feed, fewer
stages, other purities and other measurements. Its linear twin at the nominal state, by the simulator itself, is what loops are judged on."""

from __future__ import annotations

import functools
import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from reflux import build
from reflux.errors import UserError
from reflux.paths import ROOT

SOURCE = ROOT / "host_sim" / "plants" / "methanol-water.json"
STAGES, FEED_STAGE = 24, 8
FEED_FRACTION = 35.0  # mole per cent of methanol
MEASURED = {"T4": 4, "T16": 16}
HALF_SPAN_K = 20.0
IMPURITY_PPM = 3000


@functools.cache
def file_of(name: str) -> dict[str, Any]:
    """The simulator's file, without nominal values of the outputs."""
    data = json.loads(SOURCE.read_text(encoding="utf-8"))
    data.update(name=name, title="methanol column of 24 stages with a richer feed", source="made up for the campaign of start-ups",
                ours="everything but the properties", stages=STAGES, feed_stage=FEED_STAGE)
    data.pop("truths")
    for d in data["disturbances"]:
        if d["name"] == "zF":
            d["nominal"] = FEED_FRACTION
    data["outputs"] = [{"name": y, "is": "temperature", "stage": stage, "unit": "K", "lo": 300, "hi": 420, "lag_s": 0, "noise": 0, "resolution": 0}
                       for y, stage in MEASURED.items()]
    data["truths"] = [{"name": "xD", "is": "fraction", "of": "water", "stage": STAGES, "unit": "ppm", "lo": 0, "hi": 1000000},
                      {"name": "xB", "is": "fraction", "of": "methanol", "stage": 1, "unit": "ppm", "lo": 0, "hi": 1000000}]
    data["steady_state"] = [{"channel": "xD", "value": IMPURITY_PPM, "trim": "R"}, {"channel": "xB", "value": IMPURITY_PPM, "trim": "Q"}]
    at = _steady(data)
    for y in data["outputs"]:
        middle = float(round(at[y["name"]]))
        y.update(lo=middle - HALF_SPAN_K, hi=middle + HALF_SPAN_K)
    return data


@functools.cache
def with_nominal(name: str) -> dict[str, Any]:
    """As file_of(), with the nominal values of all channels, as start-ups want them."""
    data = json.loads(json.dumps(file_of(name)))
    at = _steady(data)
    for c in (*data["inputs"], *data["outputs"]):
        c["nominal"] = at[c["name"]]
    return data


@functools.cache
def twin(name: str) -> dict[str, Any]:
    """The matrices at the nominal state, as a plant of state space."""
    plant = with_nominal(name)
    data = json.loads(_simulator(file_of(name), "--linearise", "--format", "json"))
    rows = [data["outputs"].index(y["name"]) for y in plant["outputs"]]
    columns = [data["inputs"].index(u["name"]) for u in plant["inputs"]]
    return {"name": name, "model": "state_space", "tick_s": plant["tick_s"], "inputs": plant["inputs"], "outputs": plant["outputs"],
            "A": data["A"], "B": [[row[j] for j in columns] for row in data["B"]], "C": [data["C"][i] for i in rows],
            "D": [[data["D"][i][j] for j in columns] for i in rows]}


def _steady(data: dict[str, Any]) -> dict[str, float]:
    rows = [line.split(",") for line in _simulator(data, "--steady").splitlines()[1:]]
    return {row[1]: float(row[3]) for row in rows}


def _simulator(data: dict[str, Any], task: str, *more: str) -> str:
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        path = Path(folder) / f"{data['name']}.json"
        path.write_text(json.dumps(data), encoding="utf-8")
        program = str(build.find_program("host", "reflux-sim-memory"))
        done = subprocess.run([program, task, "--plant", str(path), *more], capture_output=True, text=True, check=False)
    if done.returncode:
        raise UserError(f"{data['name']}: {(done.stderr.strip().splitlines() or ['the simulator said nothing'])[-1]}")
    return done.stdout
