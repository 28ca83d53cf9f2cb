"""A plant's file, for the tools that look into it themselves: where it is, and what is in it."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from reflux import textfile
from reflux.errors import UserError
from reflux.paths import PLANTS, shown

UNIT_MAX = 11
# As in host_sim/plants/plant_unit.c.
SIGNS = str.maketrans({"\u00b0": "deg", "\u00ba": "deg", "\u02da": "deg", "\u2103": "degC", "\u2109": "degF", "\u00b5": "u", "\u03bc": "u",
                       "\u00b9": "1", "\u00b2": "2", "\u00b3": "3", "\u207b": "-", "\u00b7": ".", "\u22c5": ".", "\u03a9": "ohm",
                       "\u2126": "ohm", "\u00a0": " ", "\u2009": " ", "\u202f": " "})
BLANKS = re.compile(r"(?<=deg) +|(?<![A-Za-z0-9]) +| +(?![A-Za-z0-9])")  # that are left out


def place_of(name: str) -> Path:
    """As reflux-sim finds it: a path, the folder REFLUX_PLANTS, the plants of the repository or package."""
    if "/" in name or name.endswith(".json"):
        return Path(name)
    folders = [Path(os.environ["REFLUX_PLANTS"])] if os.environ.get("REFLUX_PLANTS") else []
    for folder in (*folders, PLANTS):
        if (folder / f"{name}.json").is_file():
            return folder / f"{name}.json"
    known = ", ".join(sorted({p.stem for folder in (*folders, PLANTS) for p in folder.glob("*.json")}))
    raise UserError(f"{name}: no plant of that name has a file; there are {known}, and a file of your own is named by its path")


def load(name: str) -> tuple[dict[str, Any], Path]:
    """Returns the object in the file, its units as reflux-sim has them, and the path."""
    path = place_of(name)
    data = textfile.read_json(path)
    if not isinstance(data, dict):
        raise UserError(f"{shown(path)}: is not a plant: it should hold an object")
    for key in ("inputs", "disturbances", "outputs", "truths"):
        channels = data.get(key)
        for k, channel in enumerate(channels if isinstance(channels, list) else []):
            if isinstance(channel, dict) and isinstance(channel.get("unit"), str):
                channel["unit"] = unit_of(channel["unit"], f"{shown(path)}: $.{key}[{k}].unit")
    return data, path


def unit_of(written: str, where: str) -> str:
    """Returns the unit in the characters that boards and logs carry."""
    unit = BLANKS.sub("", written.translate(SIGNS))
    if not re.fullmatch(r"[!-+\--~]*", unit):
        raise UserError(f'{where}: "{written}" must be printable ASCII without blanks and commas, as degC or m3/h')
    if not 1 <= len(unit) <= UNIT_MAX:
        raise UserError(f"{where}: must have 1 to {UNIT_MAX} characters, has {len(unit)}")
    return unit
