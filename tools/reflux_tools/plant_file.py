"""A plant's file, for the tools that look into it themselves: where it is, and its text."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from reflux_tools import textfile
from reflux_tools.errors import UserError
from reflux_tools.paths import ROOT, shown

PLANTS = ROOT / "host_sim" / "plants"


def place_of(name: str) -> Path:
    """As reflux-sim finds it: a path, the folder REFLUX_PLANTS, the plants of the repository."""
    if "/" in name or name.endswith(".json"):
        return Path(name)
    folders = [Path(os.environ["REFLUX_PLANTS"])] if os.environ.get("REFLUX_PLANTS") else []
    for folder in (*folders, PLANTS):
        if (folder / f"{name}.json").is_file():
            return folder / f"{name}.json"
    known = ", ".join(sorted({p.stem for folder in (*folders, PLANTS) for p in folder.glob("*.json")}))
    raise UserError(f"{name}: no plant of that name has a file; there are {known}, and a file of your own is named by its path")


def load(name: str) -> tuple[dict[str, Any], Path]:
    """Returns the object in the file, and the path."""
    path = place_of(name)
    data = textfile.read_json(path)
    if not isinstance(data, dict):
        raise UserError(f"{shown(path)}: is no plant: it should hold an object")
    return data, path
