"""Console lines of a block of the kind `composition` (docs/composition-estimation.md) for a column, as the gradient diagram proposes it."""

from __future__ import annotations

import re
import shlex
from typing import Any

from reflux_tools import build
from reflux_tools.errors import UserError
from reflux_tools.paths import shown
from reflux_tools.sensor_rules import Estimation

# SI of a unit: factor and zero.
SI = {
    "K": (1.0, 0.0),
    "degC": (1.0, 273.15),
    "W": (1.0, 0.0),
    "kW": (1e3, 0.0),
    "MW": (1e6, 0.0),
    "kcal/h": (4184 / 3600, 0.0),
    "Mcal/h": (4184e3 / 3600, 0.0),
    "mol/s": (1.0, 0.0),
    "mol/h": (1 / 3600, 0.0),
    "kmol/h": (1e3 / 3600, 0.0),
    "kmol/min": (1e3 / 60, 0.0),
    "kg/s": (1.0, 0.0),
    "kg/h": (1 / 3600, 0.0),
    "t/h": (1e3 / 3600, 0.0),
    "m3/s": (1.0, 0.0),
    "m3/h": (1 / 3600, 0.0),
    "l/h": (1e-3 / 3600, 0.0),
    "l/min": (1e-3 / 60, 0.0),
}
NAME_MOST = 15  # characters of a channel
DRIVES = ("feed", "feed_temperature", "feed_quality", "reflux", "heat", "boilup", "pressure")


def few(e: Estimation, gradient: list[float], feed: int, product: int, there: set[int]) -> list[int]:
    """Of the proposed thermometers in the section of a product three: the steepest, the nearest to the product, and one between. Those
    that the column has (on the stages `there`) come before any others."""
    section = [s for s in e.sensors if (s > feed) == (product > feed)]
    section = [s for s in section if s in there] or section
    if not section:
        return []
    steepest = max(section, key=lambda s: abs(gradient[s - 1]))
    nearest = min(section, key=lambda s: abs(s - product))
    between = min(section, key=lambda s: abs(2 * s - steepest - nearest))
    return sorted({steepest, nearest, between})


def lines(column: str, plant: dict[str, Any], e: Estimation, wanted: list[str], gradient: list[float]) -> list[str]:
    """column: the plant as the caller was given it. wanted: COMPONENT:STAGE of each point. The component with the least fractions of its own closes: the last of those modelled."""
    if len(e.modelled) < 2 or not e.sensors:
        raise UserError("--estimate: the diagram proposes no thermometers or no components to model for this column")
    names, feed = order(e), int(plant["feed_stage"])
    points = [point(text, names, plant["stages"]) for text in wanted]
    seen = [*plant.get("outputs", []), *plant.get("truths", [])]
    there = {int(c["stage"]) for c in seen if c["is"] == "temperature" and "stage" in c}
    sensors = sorted({s for _, product in points for s in few(e, gradient, feed, product, there)})
    if not sensors:
        raise UserError("--estimate: the diagram proposes no thermometer in that section")
    inputs = [thermometer(seen, s) for s in sensors]
    drives = [(c["name"], c["is"], c.get("unit", "-")) for c in plant["inputs"] if c["is"] in DRIVES]
    drives += [(c["name"], c["is"], c.get("unit", "-")) for c in seen if c["is"] in ("feed", "feed_temperature")]
    rows = [
        f"# {shown(build.find_program('host', 'reflux-sim'))} --table --plant {shlex.quote(column)} --components {','.join(names)} --block 1",
        *(f"# the column has no thermometer on stage {s}: measure there as {name}, in {unit}" for s, (name, unit) in zip(sensors, inputs) if s not in there),
        *point_lines(len(plant.get("outputs", [])), point_names(points)),
        "set block2.kind composition",
        "set block2.column 1",
        f"set block2.inputs {','.join([*(name for name, _ in inputs), *(name for name, _, _ in drives)])}",
        f"set block2.points {','.join(point_names(points))}",
    ]
    for k, (stage, (_, unit)) in enumerate(zip(sensors, inputs), 1):
        rows.append(f"set block2.place.{k} {stage},{names.index(e.innovated[stage]) + 1}")
        rows += si_row(k, unit)
    for k, (_, what, unit) in enumerate(drives, len(inputs) + 1):
        rows += [f"set block2.is.{k} {what}", *si_row(k, unit)]
    return rows + [f"set block2.point.{k} {stage},{names.index(name) + 1}" for k, (name, stage) in enumerate(points, 1)]


def point(text: str, names: list[str], stages: int) -> tuple[str, int]:
    match = re.fullmatch(r"(\w+):(\d+)", text)
    if not match or match[1] not in names or not 1 <= int(match[2]) <= stages:
        raise UserError(f"--estimate {text}: must be COMPONENT:STAGE with one of {', '.join(names)}")
    return match[1], int(match[2])


def point_names(points: list[tuple[str, int]]) -> list[str]:
    """A name on the board has up to 15 characters."""
    return [f"est_{component[:NAME_MOST - len(f'est__{stage}')]}_{stage}" for component, stage in points]


def point_lines(outputs: int, names: list[str]) -> list[str]:
    """The measurements that the block writes, behind those of the column."""
    out = [f"# meas{outputs + 1} and up, or others that are free: what the block writes, as mole fractions"]
    for n, name in enumerate(names, outputs + 1):
        out += [f"set meas{n}.name {name}", f"set meas{n}.hi 1"]
    return out


def order(e: Estimation) -> list[str]:
    """A component that is moved at a sensor cannot close."""
    moved = [n for n in e.modelled if n in e.innovated.values()]
    rest = [n for n in e.modelled if n not in moved]
    if not rest:
        raise UserError("--estimate: every component is to be moved somewhere, so that none can close")
    return [*moved, *rest]


def thermometer(seen: list[dict[str, Any]], stage: int) -> tuple[str, str]:
    for c in seen:
        if c["is"] == "temperature" and c.get("stage") == stage:
            return c["name"], c["unit"]
    return f"T{stage}", "K"


def si_row(k: int, unit: str) -> list[str]:
    if unit not in SI:
        return [f"# block2.si.{k}: factor and zero that make SI units of {unit}"]
    factor, zero = SI[unit]
    return [f"set block2.si.{k} {factor:.9g},{zero:g}"] if (factor, zero) != (1.0, 0.0) else []
