"""Plants as campaigns of start-ups know them: their files, with what is true of them at the nominal state, worked out apart
from the firmware. Of a column that is its linear twin: the simulator's own matrices at the nominal state."""

from __future__ import annotations

import functools
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from reflux import build
from reflux.errors import UserError
from reflux.paths import ROOT

sys.path.append(str(ROOT / "tests" / "reference"))

from linear_reference import Plant  # noqa: E402

PLANTS = ROOT / "host_sim" / "plants"


def exists(name: str) -> bool:
    return (PLANTS / f"{name}.json").exists()


@functools.cache
def read(name: str) -> dict[str, Any]:
    """The file. A column stands at its nominal state from the beginning: its outputs have nominal values, as a linear
    plant's have, and its inputs are safe there."""
    plant = json.loads((PLANTS / f"{name}.json").read_text(encoding="utf-8"))
    if "column" in plant:
        at = _nominal(name)
        for channel in (*plant["inputs"], *plant.get("disturbances", []), *plant["outputs"]):
            channel["nominal"] = at[channel["name"]]
        for u in plant["inputs"]:
            u["safe"] = u["nominal"]
    return plant


@functools.cache
def linear(name: str) -> Plant:
    """The plant, or a column's linear twin. The matrices of a column with levels that no flow holds have a pole at 0."""
    if "column" not in read(name):
        return Plant(PLANTS / f"{name}.json")
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        place = Path(folder) / "twin.json"
        place.write_text(json.dumps(_twin(name)), encoding="utf-8")
        return Plant(place)


@functools.cache
def gains(name: str) -> dict[tuple[str, str], float]:
    """Output and input: steady-state gain."""
    plant = linear(name)
    k = plant.gains()
    return {(y["name"], u["name"]): float(k[i, j]) for i, y in enumerate(plant.outputs) for j, u in enumerate(plant.inputs)}


@functools.cache
def pairing(name: str) -> list[tuple[str, str]]:
    """Outputs and inputs of the best pairing, sorted; none where the plant has none."""
    plant = linear(name)
    found = plant.pairing()
    return [] if isinstance(found, str) else sorted((plant.outputs[i]["name"], plant.inputs[j]["name"]) for i, j, _ in found)


def _nominal(name: str) -> dict[str, float]:
    rows = [line.split(",") for line in _simulator("--steady", name).splitlines()[1:]]
    return {row[1]: float(row[3]) for row in rows}


def _twin(name: str) -> dict[str, Any]:
    plant = read(name)
    data = json.loads(_simulator("--linearise", name, "--format", "json"))
    rows = [data["outputs"].index(y["name"]) for y in plant["outputs"]]
    columns = [data["inputs"].index(u["name"]) for u in plant["inputs"]]
    return {"name": name, "model": "state_space", "tick_s": plant["tick_s"], "inputs": plant["inputs"], "outputs": plant["outputs"],
            "A": data["A"], "B": [[row[j] for j in columns] for row in data["B"]], "C": [data["C"][i] for i in rows],
            "D": [[data["D"][i][j] for j in columns] for i in rows]}


def _simulator(task: str, name: str, *more: str) -> str:
    program = str(build.find_program("host", "reflux-sim-memory"))
    done = subprocess.run([program, task, "--plant", name, *more], capture_output=True, text=True, check=False)
    if done.returncode:
        raise UserError(f"{name}: {(done.stderr.strip().splitlines() or ['the simulator said nothing'])[-1]}")
    return done.stdout
