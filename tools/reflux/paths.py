"""Paths of folders and files."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
PROGRAMS = PACKAGE / "programs"
INSTALLED = PROGRAMS.is_dir()  # from a wheel (tools/wheel), which has programs, plants and scenarios in the package
ROOT = PACKAGE if INSTALLED else PACKAGE.parents[1]
SCENARIOS = ROOT / ("scenarios" if INSTALLED else "host_sim/scenarios")
PLANTS = ROOT / ("plants" if INSTALLED else "host_sim/plants")
CAMPAIGNS = ROOT / "tests" / "campaign"


def build_root() -> Path:
    """build/, or the folder that REFLUX_BUILD_ROOT names: each preset has a folder of its own in it."""
    return Path(os.environ.get("REFLUX_BUILD_ROOT") or ROOT / "build").resolve()


def build_dir(preset: str) -> Path:
    """The build tree of a preset; what an installed package has of the preset host."""
    return PROGRAMS if INSTALLED and preset == "host" else build_root() / preset


def tool(name: str) -> str:
    """The command as a person types it."""
    return f"reflux {name}" if INSTALLED else f"tools/{name}"


def every(folder: Path, *patterns: str) -> list[Path]:
    """Files that match one of the patterns, in order. FileNotFoundError where there is none: what goes through all pages, scenarios or layers must
    not pass because somebody has moved them."""
    found = sorted(path for pattern in patterns for path in folder.glob(pattern))
    if not found:
        raise FileNotFoundError(f"no {' or '.join(patterns)} in {folder}")
    return found


def figures() -> Path:
    """docs/figures, or the folder that REFLUX_FIGURES names: where the scripts of tools/figures put their pictures."""
    return Path(os.environ.get("REFLUX_FIGURES") or ROOT / "docs" / "figures").resolve()


def out_root() -> Path:
    """out/, or the folder that REFLUX_OUT names: where a tool puts its results if no option names another folder. A package has out/ where one
    stands."""
    return Path(os.environ.get("REFLUX_OUT") or (Path() if INSTALLED else ROOT) / "out").resolve()


def shown(path: Path | str) -> str:
    """The path as a person would type it from where they stand."""
    path = Path(path)
    try:
        relative = os.path.relpath(path)
    except ValueError:
        return str(path)
    return relative if not relative.startswith("../..") else str(path)


def named(text: str) -> Path:
    """A path as an option takes it. Path("") would be the folder one stands in, which nobody means by nothing."""
    if not text:
        raise argparse.ArgumentTypeError("must not be empty")
    return Path(text)
