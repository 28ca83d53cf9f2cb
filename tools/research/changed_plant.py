"""A column of host_sim/plants that differs from what it is: another plant than the model that a controller has of it, or one with a further
meter."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from reflux.errors import UserError
from reflux.paths import ROOT

METERS = {"feed": ("feed", 5e-3)}  # what it is, noise as part of its span


def read(name: str) -> dict[str, Any]:
    try:
        whole = json.loads((ROOT / "host_sim" / "plants" / f"{name}.json").read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise UserError(f"{name} is not a plant of host_sim/plants") from None
    if "column" not in whole:
        raise UserError(f"{name} is not a column")
    return dict(whole)


def change(whole: dict[str, Any], words: str) -> None:
    """words: efficiency=X, that of all stages; holdups=X, times as much on each; meter=feed:NAME, a meter of that input, which is called so."""
    for word in words.split():
        key, _, value = word.partition("=")
        if key == "efficiency":
            whole["efficiency"] = number(word, value)
        elif key == "holdups":
            for place in ("reboiler", "tray", "condenser"):
                whole["holdup"][place] *= number(word, value)
        elif key == "meter":
            whole["outputs"].append(meter_of(whole, *value.partition(":")[::2]))
        else:
            raise UserError(f'"{word}" of a plant: known are efficiency=X, holdups=X, meter=feed:NAME')


def number(word: str, value: str) -> float:
    try:
        return float(value)
    except ValueError:
        raise UserError(f'"{word}" of a plant needs a number') from None


def meter_of(whole: dict[str, Any], what: str, name: str) -> dict[str, Any]:
    """With the unit and the span of the input that it measures."""
    found = next((x for x in whole["disturbances"] if x["is"] == what), None)
    if what not in METERS or found is None or not name:
        raise UserError(f'a meter is written meter=WHAT:NAME, and WHAT is one of {", ".join(METERS)}, which the plant must have as a disturbance')
    kind, noise = METERS[what]
    span = found["hi"] - found["lo"]
    return {"name": name, "is": kind, "unit": found["unit"], "lo": found["lo"], "hi": found["hi"], "noise": noise * span, "help": f"meter of {found['name']}"}


def write(whole: dict[str, Any], folder: Path) -> str:
    file = folder / f"{whole['name']}.json"
    file.write_text(json.dumps(whole), encoding="utf-8")
    return str(file)


def written(name: str, words: str, folder: Path) -> str:
    """The path of its file."""
    whole = read(name)
    change(whole, words)
    return write(whole, folder)
