"""Console lines of a block of the kind `composition` (docs/methods/composition-estimation.md) for a column, as the gradient diagram proposes it."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from typing import Any, Callable

from reflux import build, sensor_rules, simulator
from reflux.errors import RunFailed, UserError
from reflux.gradients import Diagram
from reflux.paths import shown
from reflux.sensor_rules import Thresholds

HOUR, MINUTE, CALORIE = 3600.0, 60.0, 4.184
# SI of a unit of docs/use/columns.md: factor and zero.
SI = {
    "K": (1.0, 0.0), "degC": (1.0, 273.15), "-": (1.0, 0.0),
    "W": (1.0, 0.0), "kW": (1e3, 0.0), "MW": (1e6, 0.0),
    "kcal/h": (1e3 * CALORIE / HOUR, 0.0), "Mcal/h": (1e6 * CALORIE / HOUR, 0.0), "Gcal/h": (1e9 * CALORIE / HOUR, 0.0),
    "kJ/h": (1e3 / HOUR, 0.0), "MJ/h": (1e6 / HOUR, 0.0), "GJ/h": (1e9 / HOUR, 0.0),
    "mol/s": (1.0, 0.0), "mol/min": (1 / MINUTE, 0.0), "mol/h": (1 / HOUR, 0.0),
    "kmol/s": (1e3, 0.0), "kmol/min": (1e3 / MINUTE, 0.0), "kmol/h": (1e3 / HOUR, 0.0),
    "kg/s": (1.0, 0.0), "kg/h": (1 / HOUR, 0.0), "t/h": (1e3 / HOUR, 0.0),
    "l/s": (1e-3, 0.0), "l/min": (1e-3 / MINUTE, 0.0), "l/h": (1e-3 / HOUR, 0.0), "m3/s": (1.0, 0.0), "m3/h": (1 / HOUR, 0.0),
    "Pa": (1.0, 0.0), "kPa": (1e3, 0.0), "bar": (1e5, 0.0), "mbar": (1e2, 0.0), "mmHg": (133.322, 0.0), "atm": (101325.0, 0.0),
}  # fmt: skip
NAME_MOST = 15  # characters of a channel
INPUTS_MOST, LIST_MOST = 12, 63  # of a block: names, and characters of their list
TABLE_COMPONENTS = 4
INSTALLED_LEAST = 2  # thermometers of a section, where it has them: less steep ones where too few are steep
DRIVES = ("feed", "feed_temperature", "feed_quality", "reflux", "heat", "boilup", "pressure")
TABLE_BLOCK, BLOCK = 1, 2


@dataclass(frozen=True)
class Point:
    """Value that the block writes: a mole fraction, times `show` in the measurement's own unit."""

    name: str
    component: str
    stage: int
    unit: str = "-"
    lo: float = 0.0
    hi: float = 1.0
    show: float = 1.0


@dataclass(frozen=True)
class Column:
    """A column at the steady state at which it is judged."""

    name: str  # as the simulator is asked for it
    settings: tuple[str, ...]  # NAME=VALUE of its inputs
    plant: dict[str, Any]  # its file
    diagram: Diagram
    thresholds: Thresholds
    seen: tuple[dict[str, Any], ...]  # what may be measured
    installed_only: bool = False  # no thermometers but these

    @property
    def feed(self) -> int:
        return int(self.plant["feed_stage"])

    @property
    def thermometers(self) -> dict[int, tuple[str, str]]:
        """Stage: name and unit."""
        found: dict[int, tuple[str, str]] = {}
        for c in self.seen:
            if c["is"] == "temperature" and "stage" in c:
                found.setdefault(int(c["stage"]), (c["name"], c["unit"]))
        return found


# ---- which thermometers ----


def usable(column: Column, above: bool, modelled: list[str]) -> list[int]:
    """Stages of a section to measure: steep ones where what is not modelled has at most `alien` of the shares, or where it has least;
    thermometers that the column has before any others. None where the section has one temperature, nearly."""
    of, t, there = column.diagram, column.thresholds, column.thermometers
    steep = sensor_rules.steep_stages(of, column.feed, above, t)
    alien = {s: 1 - of.part_of(s, modelled) for s in steep}
    clear = [s for s in steep if alien[s] <= max(t.alien, 2 * min(alien.values()))]
    installed = [s for s in clear if s in there]
    if not column.installed_only:
        return installed or clear
    rest = [s for s in there if s not in (*installed, column.feed) and (s > column.feed) == above and of.step_beside(s) >= t.flat]
    rest.sort(key=lambda s: (s in (1, of.stages), -of.step_beside(s)))  # what the ends show is the heaviest and the lightest component
    return sorted([*installed, *rest[: max(0, INSTALLED_LEAST - len(installed))]])


def few(column: Column, section: list[int], product: int, most: int = 3) -> list[int]:
    """Three of a section at most: the steepest, the nearest to the product, and one between. Of fewer the first of these."""
    if not section:
        return []
    steepest = max(section, key=column.diagram.step_beside)
    nearest = min(section, key=lambda s: abs(s - product))
    between = min(section, key=lambda s: abs(2 * s - steepest - nearest))
    return sorted({steepest, nearest, between} if most == 3 else {steepest, nearest} if most == 2 else {steepest})


def choose(column: Column, points: list[Point], modelled: list[str], most: int) -> list[int]:
    """Thermometers in the section of each point, so many at most. Where these are fewer than the components, two in the other section too:
    nobody measures the feed's composition, and one thermometer for each of its fractions is needed to find it."""
    chosen: dict[bool, set[int]] = {}
    for above in (False, True):
        products = [p for p in points if (p.stage > column.feed) == above]
        section = usable(column, above, modelled) if products else []
        if products and not section:
            raise UserError(no_thermometer(column, above, products[0]))
        chosen[above] = {s for p in products for s in few(column, section, p.stage, most)}
    for above in (False, True):
        section = [] if chosen[above] else usable(column, above, modelled)
        if section and len(chosen[not above]) < len(modelled):
            chosen[above] = set(few(column, section, column.diagram.stages if above else 1, min(most, 2)))
    return sorted(chosen[False] | chosen[True])


def no_thermometer(column: Column, above: bool, point: Point) -> str:
    return (
        f"{point.component}:{point.stage}: no {'thermometer' if column.installed_only else 'stage'} of the {'rectifying' if above else 'stripping'} section "
        f"has a step of {column.thresholds.flat:g} K or more, and an estimate is never good without a thermometer in its section"
    )


# ---- components and inputs ----


def components(column: Column, points: list[Point]) -> list[str]:
    """Those to model, in the order of the file: all that a table takes; of more those of the points, and of the others the ones that the
    diagram proposes, the largest shares first."""
    names = column.diagram.names
    if len(names) <= TABLE_COMPONENTS:
        return names
    e = sensor_rules.estimation(column.diagram, column.feed, column.thresholds)
    wanted = dict.fromkeys(p.component for p in points)
    rest = sorted((n for n in names if n not in wanted), key=lambda n: (n not in e.modelled, -e.parts[n]))
    most = max(2, min(len(set(e.modelled) | wanted.keys()), TABLE_COMPONENTS))
    chosen = [*wanted, *rest][:most]
    return [n for n in names if n in chosen]


def moved(column: Column, sensors: list[int], names: list[str]) -> tuple[list[str], dict[int, str]]:
    """The components with the one that closes last, and which is moved at each thermometer: the one with the largest share there. The
    one that closes is never moved: the last that has no largest share, or has it least often."""

    def largest(s: int, among: list[str]) -> str:
        return max(among, key=lambda n: abs(column.diagram.share[s - 1][column.diagram.names.index(n)]))

    often = [largest(s, names) for s in sensors]
    closing = min(reversed(names), key=often.count)
    others = [n for n in names if n != closing]
    return [*others, closing], {s: largest(s, others) for s in sensors}


def drives(column: Column) -> list[tuple[str, str, str]]:
    """Name, what it is, and unit of what drives the model: each once, as the column is driven before as it is measured."""
    found: dict[str, tuple[str, str, str]] = {}
    for c in (*column.plant["inputs"], *column.seen):
        if c["is"] in DRIVES:
            found.setdefault(c["is"], (c["name"], c["is"], c.get("unit", "-")))
    if "heat" in found:
        found.pop("boilup", None)
    kind = flow_kind(column.plant.get("constants", {}).get("reflux", {}).get("unit", found.get("reflux", ("", "", ""))[2]))
    if "reflux" in found and flow_kind(found["reflux"][2]) != kind:
        raise UserError(f"{found['reflux'][0]}: the file has its reflux as a flow of {kind}, and the table with it: measure it as that")
    levels = column.plant.get("levels", {})
    for what, vessel in (("reflux", "condenser"), ("boilup", "reboiler")):
        if levels.get(vessel, {}).get("by") == what and what not in found:
            raise UserError(f"the level of the {vessel} moves the {what}, and the column measures it nowhere: add an output that is {what} to its file")
    return list(found.values())


def flow_kind(unit: str) -> str:
    return "moles" if "mol" in unit else "volume" if unit[:1] in ("l", "m") else "mass"


# ---- lines ----


@dataclass(frozen=True)
class Estimator:
    table: tuple[str, ...]  # words of `reflux-sim --table`
    inputs: list[str]
    lines: list[str]  # of the block; not of the measurements that it writes
    remarks: list[str]


def estimator(column: Column, points: list[Point], method: Callable[[int, int], list[str]] | None = None) -> Estimator:
    """method: further lines of the block for so many thermometers and components."""
    if not column.diagram.share:
        raise UserError("what the components have to do with the gradient is not known, so no thermometer can be chosen for them")
    names = components(column, points)
    for p in points:
        if p.component not in names or not 1 <= p.stage <= column.diagram.stages:
            raise UserError(f"{p.component}:{p.stage}: must be COMPONENT:STAGE with one of {', '.join(column.diagram.names)}")
    driven = drives(column)
    for most in (3, 2, 1):  # in a section; fewer where the names are long
        sensors = choose(column, points, names, most)
        inputs = [(*thermometer(column, s), s) for s in sensors]
        listed = [*(name for name, _, _ in inputs), *(name for name, _, _ in driven)]
        if len(listed) <= INPUTS_MOST and len(",".join(listed)) <= LIST_MOST:
            break
    else:
        raise UserError(f"a block takes {INPUTS_MOST} inputs and {LIST_MOST} characters of their names with commas; these are {','.join(listed)}")
    names, innovated = moved(column, sensors, names)
    words = ("--components", ",".join(names), *simulator.setting_words(column.settings))
    try:
        simulator.table_lines(column.name, TABLE_BLOCK, *words)  # refuses what a board would refuse
    except (UserError, RunFailed) as error:
        raise UserError(f"no table for a board: {str(error).removeprefix('--table: ')}; docs/methods/gradients.md says what to do") from None
    rows = [
        f"set block{BLOCK}.kind composition",
        f"set block{BLOCK}.column {TABLE_BLOCK}",
        f"set block{BLOCK}.inputs {','.join(listed)}",
        f"set block{BLOCK}.points {','.join(p.name for p in points)}",
        *(method(len(sensors), len(names)) if method else ()),
    ]
    for k, (_, unit, stage) in enumerate(inputs, 1):
        rows += [f"set block{BLOCK}.place.{k} {stage},{names.index(innovated[stage]) + 1}", *si_row(k, unit)]
    for k, (_, what, unit) in enumerate(driven, len(inputs) + 1):
        rows += [f"set block{BLOCK}.is.{k} {what}", *si_row(k, unit)]
    for k, p in enumerate(points, 1):
        rows.append(f"set block{BLOCK}.point.{k} {p.stage},{names.index(p.component) + 1}")
        rows += [f"set block{BLOCK}.show.{k} {p.show:g},0"] if p.show != 1 else []
    return Estimator(words, listed, rows, remarks(column, inputs, names))


def remarks(column: Column, inputs: list[tuple[str, str, int]], names: list[str]) -> list[str]:
    out = [
        f"# the column has no thermometer on stage {s}: measure there as {name}, in {unit}"
        for name, unit, s in inputs
        if s not in column.thermometers
    ]
    if any(c["is"] == "pressure" for c in column.plant.get("disturbances", [])) and not any(c["is"] == "pressure" for c in column.seen):
        out.append("# the pressure changes and nothing measures it: the estimates are off meanwhile. Add an output that is pressure")
    alien = {s: 1 - column.diagram.part_of(s, names) for _, _, s in inputs}
    foreign = [s for s in alien if alien[s] > column.thresholds.alien]
    if foreign:
        out.append(
            f"# stages {sensor_rules.runs(foreign)}: up to {100 * max(alien[s] for s in foreign):.0f} % of the gradient comes of components that the table leaves out"
        )
    return out


def lines(column: Column, wanted: list[str]) -> list[str]:
    """wanted: COMPONENT:STAGE of each point, as the command line has them."""
    try:
        points = [point(text) for text in wanted]
        found = estimator(column, points)
    except UserError as error:
        raise UserError(f"--estimate: {error}") from None
    program = shown(build.find_program("host", "reflux-sim"))
    return [
        f"# {program} --table --plant {shlex.quote(column.name)} {shlex.join(found.table)} --block {TABLE_BLOCK}",
        *found.remarks,
        *point_lines(len(column.plant.get("outputs", [])), points),
        *found.lines,
    ]


def point(text: str) -> Point:
    match = re.fullmatch(r"(\w+):(\d+)", text)
    if not match:
        raise UserError(f"{text}: must be COMPONENT:STAGE, as iC4:37")
    component, stage = match[1], int(match[2])
    return Point(f"est_{component[: NAME_MOST - len(f'est__{stage}')]}_{stage}", component, stage)


def point_lines(outputs: int, points: list[Point]) -> list[str]:
    """The measurements that the block writes, behind those of the column."""
    out = [f"# meas{outputs + 1} and up, or others that are free: what the block writes, as mole fractions"]
    for n, p in enumerate(points, outputs + 1):
        out += [f"set meas{n}.name {p.name}", f"set meas{n}.hi {p.hi:g}"]
    return out


def thermometer(column: Column, stage: int) -> tuple[str, str]:
    return column.thermometers.get(stage, (f"T{stage}", "K"))


def si_row(k: int, unit: str) -> list[str]:
    factor, zero = SI[unit]
    return [f"set block{BLOCK}.si.{k} {factor:.9g},{zero:g}"] if (factor, zero) != (1.0, 0.0) else []
