"""All console lines of a board for a column: channels, loops, interlocks, table and estimator, as one paste (docs/use/columns.md, Onto a board)."""

from __future__ import annotations

import math
from typing import Any

from reflux import column_loops, column_slopes, estimate_lines, gradients, sensor_rules, simulator
from reflux.column_loops import Loop
from reflux.errors import UserError
from reflux.estimate_lines import Point
from reflux.sensor_rules import Thresholds
from reflux.table import figure

MEASUREMENTS, OUTPUTS = 16, 16  # of a board
LINE_MOST = 200  # characters that the console takes, all of them ASCII
HEATS = ("heat", "boilup")
FEED_F = 0.2  # part by which a feed that nobody measures may differ from the file's, as in docs/methods/kalman.md
FILTERED = {2: 2, 3: 3, 4: 5}  # components, and the thermometers from which a filter does better than the geometric method
SHOWN = {"-": 1.0, "%": 100.0, "ppm": 1e6, "%w": 100.0}  # a fraction in the unit of its channel
ROOM_K, BROKEN = 293.15, 0.025  # a column before its start; of the span: a reading so far below it counts as broken (docs/inside/faults.md, Readings)
OVERPRESSURE = 0.1  # of the absolute pressure: an interlock acts where it is so much above the steady state's
NEAR_END_K = 0.5  # least distance of a limit from the end of a span, and least hysteresis
LOW_LEVEL = 0.5  # of the level at rest


def lines(name: str, settings: tuple[str, ...], plant: dict[str, Any]) -> list[str]:
    """name: the column as the simulator is asked for it; settings: NAME=VALUE of its inputs; plant: what is in its file."""
    rest = simulator.at_rest(name, settings)
    at = column_slopes.steady(name, simulator.numbers(settings))
    of = gradients.diagram(at.temperature, at.x, at.names, gradients.liquid_of(plant, at.names))
    keys = sensor_rules.keys_of(at.x[-1], at.x[0], of.names, gradients.heaviness(plant, of.names, at.temperature))
    found = column_loops.design(name, settings, plant, of, keys or of.names, rest)
    column = estimate_lines.Column(name, settings, plant, of, Thresholds(), tuple(plant["outputs"]), installed_only=True)
    points, basis, estimator, remarks = estimate(column, keys)
    used = [*(loop.pv for loop in found.loops), *watched(plant), *(estimator.inputs if estimator else ())]
    out = [
        f"# {plant['name']}: {plant['title']}",
        "# Proposed from the column's file at its steady state: look at limits, safe values and interlocks before you trust it.",
        "begin",
        "defaults",
        *channels(plant, rest, used, points),
        *found.remarks,
        *(line for k, loop in enumerate(found.loops, 1) for line in loop_lines(k, loop)),
        *interlocks(plant, at.temperature, rest),
        *dict.fromkeys(remarks),
    ]
    if estimator:
        out += [*estimator.remarks, *simulator.table_lines(name, estimate_lines.TABLE_BLOCK, *estimator.table), *estimator.lines, *basis]
    out += ["apply", *start(plant, rest, found.loops)]
    return [line.encode("ascii", "replace").decode()[:LINE_MOST] if line.startswith("#") else line for line in out]


# ---- channels ----


def channels(plant: dict[str, Any], rest: dict[str, float], used: list[str], points: list[Point]) -> list[str]:
    if len(plant["inputs"]) > OUTPUTS:
        raise UserError(f"--board: a board has {OUTPUTS} manipulated variables, the column {len(plant['inputs'])}")
    first = [c for c in plant["outputs"] if c["name"] in used]
    others = [c for c in plant["outputs"] if c["name"] not in used]
    room = MEASUREMENTS - len(points) - len(first)
    kept = [c for c in plant["outputs"] if c in first or c in others[:room]]
    tick = float(plant["tick_s"])
    out = [f"# no measurement of the board is left for {', '.join(c['name'] for c in others[room:])}"] if others[room:] else []
    for k, c in enumerate(kept, 1):
        out += channel("meas", k, c)
        for field, key in (("every", "every_s"), ("delay", "delay_s")):
            out += [f"set meas{k}.{field} {round(c[key] / tick)}"] if c.get(key) else []
    for k, p in enumerate(points, len(kept) + 1):
        out += channel("meas", k, {"name": p.name, "unit": p.unit, "lo": p.lo, "hi": p.hi})
        out.append(f"set meas{k}.test off")
    for k, c in enumerate(plant["inputs"], 1):
        out += [*channel("mv", k, c), f"set mv{k}.min {c['lo']:.7g}", f"set mv{k}.max {c['hi']:.7g}", f"set mv{k}.safe {safe_value(c, rest):.7g}"]
        out += [f"set mv{k}.rate {c['slew']:.7g}"] if c.get("slew") else []
    return out


def safe_value(c: dict[str, Any], rest: dict[str, float]) -> float:
    """Safe value where the file has none: no heat, and the other flows as at the steady state."""
    return min(max(c.get("safe", 0.0 if c["is"] in HEATS else rest[c["name"]]), c["lo"]), c["hi"])


def channel(kind: str, k: int, c: dict[str, Any]) -> list[str]:
    return [f"set {kind}{k}.name {c['name']}", f"set {kind}{k}.unit {c['unit']}", f"set {kind}{k}.lo {c['lo']:.7g}", f"set {kind}{k}.hi {c['hi']:.7g}"]


# ---- loops and interlock ----


def loop_lines(k: int, loop: Loop) -> list[str]:
    rows = [("name", loop.name), ("pv", loop.pv), ("out", loop.mv), ("action", loop.action), ("gain", f"{loop.gain:.4g}"), ("ti", f"{loop.ti_s:.4g}")]
    rows += [("divisor", str(loop.divisor))] if loop.divisor > 1 else []
    return [f"set loop{k}.{field} {value}" for field, value in rows]


def interlocks(plant: dict[str, Any], temperature: list[float], rest: dict[str, float]) -> list[str]:
    """The heat is cut where the lowest thermometer is hotter than any liquid of the column boils at OVERPRESSURE, where the pressure is so high, and where
    the reboiler's level is low."""
    heat = next((c for c in plant["inputs"] if c["is"] in HEATS), None)
    if heat is None:
        return ["# no interlock: it needs the heat or the boil-up among the inputs"]
    found = [*hot(plant, temperature, rest), *pressed(plant, rest), *dry(plant, rest)]
    out, k = [], 0
    for remark, rows in found:
        out += remark
        if rows:
            k += 1
            out += [f"set lock{k}.{row}" for row in (rows[0], f"mv {heat['name']}", *rows[1:], f"value {safe_value(heat, {}):.7g}")]
    return out


Lock = tuple[list[str], list[str]]  # remarks, and rows without output and value: none where there is no interlock


def hot(plant: dict[str, Any], temperature: list[float], rest: dict[str, float]) -> list[Lock]:
    lowest = lowest_thermometer(plant)
    if lowest is None:
        return [(["# no interlock by temperature: it needs the thermometer of a stage"], [])]
    name, zero = lowest["name"], gradients.KELVIN if lowest["unit"] == "degC" else 0.0
    pascal = reboiler_pressure(plant, rest)
    boils, above = boiling(plant, pascal), boiling(plant, (1 + OVERPRESSURE) * pascal)
    limit = max(boils, temperature[int(lowest["stage"]) - 1]) + above - boils - zero
    cold, low = ROOM_K - zero, lowest["lo"] - BROKEN * column_loops.span(lowest)
    remarks = [f"# Cold, {name} reads below its span and counts as broken: lock1 then keeps the heat off. Set its valid_lo below the room's temperature "
               f"to start from cold."] if cold < low else []
    remarks.append(f"# {name} hotter than the highest-boiling component boils at {100 * OVERPRESSURE:.0f} % more than the reboiler's {pascal / 1000:.4g} kPa: "
                   "cut the heat.")
    if limit > lowest["hi"] - NEAR_END_K:
        remarks.append(f"# That is {limit:.4g} {lowest['unit']}, and the span of {name} ends at {lowest['hi']:.4g}: the limit is below its end. A wider span is better.")
        limit = lowest["hi"] - NEAR_END_K
    return [(remarks, [f"meas {name}", "side above", f"limit {limit:.4g}", f"hysteresis {max((above - boils) / 2, NEAR_END_K):.4g}"])]


def pressed(plant: dict[str, Any], rest: dict[str, float]) -> list[Lock]:
    gauge = next((c for c in plant["outputs"] if c["is"] == "pressure"), None)
    if gauge is None:
        return []
    name, at = gauge["name"], rest[gauge["name"]]
    limit = (1 + OVERPRESSURE) * at
    if limit >= gauge["hi"]:
        return [([f"# no interlock by pressure: the span of {name} ends at {gauge['hi']:.4g} {gauge['unit']}, below {limit:.4g}, {100 * OVERPRESSURE:.0f} % above "
                  "where it rests"], [])]
    return [([f"# {name} {100 * OVERPRESSURE:.0f} % above where it rests: cooling or vent fails. Cut the heat."],
             [f"meas {name}", "side above", f"limit {limit:.4g}", f"hysteresis {(limit - at) / 2:.4g}"])]


def dry(plant: dict[str, Any], rest: dict[str, float]) -> list[Lock]:
    level = reboiler_level(plant)
    if level is None:
        return [(["# No interlock sees the reboiler run dry: a thermometer there is then in vapour and reads no more than before. Measure the level, and cut the heat "
                  "below a limit."], [])]
    name, at = level["name"], rest[level["name"]]
    limit = level["lo"] + LOW_LEVEL * (at - level["lo"])
    return [([f"# {name} below half of where it rests: cut the heat before the reboiler runs dry."],
             [f"meas {name}", "side below", f"limit {limit:.4g}", f"hysteresis {0.2 * (at - level['lo']):.4g}"])]


def watched(plant: dict[str, Any]) -> list[str]:
    """Measurements that the interlocks need."""
    gauge = next((c for c in plant["outputs"] if c["is"] == "pressure"), None)
    return [c["name"] for c in (lowest_thermometer(plant), gauge, reboiler_level(plant)) if c]


def lowest_thermometer(plant: dict[str, Any]) -> dict[str, Any] | None:
    return min((c for c in plant["outputs"] if c["is"] == "temperature" and "stage" in c), key=lambda c: int(c["stage"]), default=None)


def reboiler_level(plant: dict[str, Any]) -> dict[str, Any] | None:
    return next((c for c in plant["outputs"] if c["is"] == "level" and c.get("stage") == 1), None)


def reboiler_pressure(plant: dict[str, Any], rest: dict[str, float]) -> float:
    """Pa"""
    constant = plant.get("constants", {}).get("pressure")
    channel = next((c for c in (*plant["inputs"], *plant.get("disturbances", [])) if c["is"] == "pressure"), None)
    value, unit = (rest[channel["name"]], channel["unit"]) if channel else (constant["value"], constant["unit"])
    return float(value * estimate_lines.SI[unit][0] + plant.get("pressure_drop", 0))


def boiling(plant: dict[str, Any], pascal: float) -> float:
    """Boiling point of the highest-boiling component, K, or the end of the range of temperatures."""
    low, high = plant["temperature_range"]
    constants = list(gradients.constants_of(plant).values())
    for _ in range(60):
        middle = (low + high) / 2
        boils = min(gradients.vapour_pressure(c, middle)[0] for c in constants) > pascal
        low, high = (low, middle) if boils else (middle, high)
    return float(high)


# ---- estimator ----


def estimate(column: estimate_lines.Column, keys: tuple[str, str] | None) -> tuple[list[Point], list[str], estimate_lines.Estimator | None, list[str]]:
    """Points, lines of their basis, the block, and remarks: why a point, or all of it, is left out."""
    plant, kept, remarks = column.plant, [], []
    wanted, basis = products(plant, keys)
    for p in wanted:
        try:
            estimate_lines.estimator(column, [*kept, p])
            kept.append(p)
        except UserError as error:
            remarks.append(f"# not estimated: {error}")
    noise = max((math.hypot(c.get("noise", 0), c.get("resolution", 0) / math.sqrt(12)) for c in plant["outputs"] if c["is"] == "temperature"), default=0.0)

    def method(sensors: int, components: int) -> list[str]:
        """A filter finds what nobody measures of the feed, where there are thermometers enough."""
        if sensors < FILTERED[components]:
            return []
        rows = ["method ekf", *([f"noise {noise:.4g}"] if noise else [])]
        rows += [] if any(c["is"] == "feed" for c in plant["outputs"]) else [f"feed_f {FEED_F:g}"]
        return [f"set block{estimate_lines.BLOCK}.{row}" for row in rows]

    estimator = estimate_lines.estimator(column, kept, method) if kept else None
    return kept, [f"set block{estimate_lines.BLOCK}.basis {basis}"] if basis != "mole" else [], estimator, remarks


def products(plant: dict[str, Any], keys: tuple[str, str] | None) -> tuple[list[Point], str]:
    """The first fraction of one component that the file has of each product; else the heavy key in the distillate and the light one in the
    bottoms. And the basis: mass where all of them are by mass; else one that is becomes a mole fraction."""
    points = []
    for stage, letter, key in ((plant["stages"], "D", 1), (1, "B", 0)):
        seen = [c for c in (*plant["outputs"], *plant.get("truths", [])) if c["is"] == "fraction" and c.get("stage") == stage and isinstance(c["of"], str)]
        if seen:
            c = seen[0]
            points.append(Point(f"{c['name'][:11]}_est", c["of"], stage, c["unit"], c["lo"], c["hi"], SHOWN[c["unit"]]))
        elif keys:
            points.append(Point(f"{keys[key][:9]}_{letter}_est", keys[key], stage))
    by_mass = [p.unit == "%w" for p in points]
    if not all(by_mass):  # a block has one basis
        points = [Point(p.name, p.component, p.stage) if p.unit == "%w" else p for p in points]
    return points, "mass" if points and all(by_mass) else "mole"


# ---- afterwards ----


def start(plant: dict[str, Any], rest: dict[str, float], loops: list[Loop]) -> list[str]:
    """As remarks: a paste moves nothing."""
    out = ["# All loops are in manual. The column rests with"]
    out += [f"#   out {c['name']} {figure(rest[c['name']], 6)}" for c in plant["inputs"]]
    out += [f"#   mode {loop.name} auto, then sp {loop.name} {figure(rest[loop.pv], 6)}" for loop in loops]
    return out
