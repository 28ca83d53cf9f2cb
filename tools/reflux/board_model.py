"""The model that the kind `experiment` has in its settings, from any text that lists them: `list block1` or `list all` at the console, the
transcript of a run, a file of `set` lines. In the units of the channels. docs/methods/experiment.md."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from reflux import textfile
from reflux.errors import UserError
from reflux.paths import shown

SETTING = re.compile(r"\b(?:set )?(block(\d+)\.\w+|tick\.base)(?: =)? (\S+)")
MODEL = re.compile(r"(?:a([12])_([1-4])|b([12])([12])_([1-8]))$")
A, B = 4, 8  # coefficients that there are settings for (firmware/kinds/experiment/plant_experiment.h)


def is_listing(name: str) -> bool:
    return name.endswith((".txt", ".conf", ".log"))


def read(path: Path, period: float | None) -> tuple[list[str], list[str], np.ndarray, np.ndarray, float, str]:
    """Outputs, inputs, a: n x 4, b: n x n x 8, period in s, the filter it was found behind; of the first block of the kind that has a model."""
    text = textfile.read(path)
    said: dict[str, dict[str, str]] = {}
    base = None
    for name, number, value in SETTING.findall(text):  # what is said last holds
        if not number:
            base = value
        else:
            said.setdefault(number, {})[name.partition(".")[2]] = value
    for number, settings in sorted(said.items(), key=lambda item: int(item[0])):
        if settings.get("kind") == "experiment" and settings.get("known") == "on":
            return model_of(settings, base, path, period, f"block{number}")
    raise UserError(f"{shown(path)} has no block of the kind experiment whose model is whole (known on); `list block1` after `proposal accept` prints one")


def number_of(text: str, name: str, path: Path) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise UserError(f"{shown(path)}: {name} is {text}, which is not a number")
    return value


def model_of(settings: dict[str, str], base: str | None, path: Path, period: float | None, block: str) -> tuple[list[str], list[str], np.ndarray, np.ndarray, float, str]:
    a, b = np.zeros((2, A)), np.zeros((2, 2, B))
    for name, value in settings.items():
        found = MODEL.match(name)
        if found and found[1]:
            a[int(found[1]) - 1, int(found[2]) - 1] = number_of(value, name, path)
        elif found:
            b[int(found[3]) - 1, int(found[4]) - 1, int(found[5]) - 1] = number_of(value, name, path)
    names = settings.get("inputs", "-").split(",")
    if len(names) not in (2, 4):
        raise UserError(f"{shown(path)}: {block}.inputs is {settings.get('inputs', 'not there')}; a model in settings has one or two measurements and as many MVs")
    n = len(names) // 2
    told = number_of(settings.get("period", "0"), f"{block}.period", path) or (number_of(base, "tick.base", path) if base else 0.0)
    if not told and period is None:
        raise UserError(f"{shown(path)} says neither {block}.period nor tick.base: --period says how often the model is sampled, s")
    cutoff = settings.get("cutoff", "0")
    fast = base is None or told > number_of(base, "tick.base", path)
    filtered = f"{block}.cutoff {cutoff}" if fast and number_of(cutoff, f"{block}.cutoff", path) > 0 else ""
    return names[:n], names[n:], a[:n], b[:n, :n], told or float(period or 0), filtered
