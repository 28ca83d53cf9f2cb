"""A recorded run as a plant can play it again: a folder of tools/run, or the telemetry of a board's console, with the
configuration it was recorded with. What is missing or wrong is said with its place."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from reflux import logs, scenario, textfile
from reflux.errors import UserError
from reflux.logs import Log
from reflux.paths import shown, tool

GOOD, UNCERTAIN, BAD, MISSING = range(4)
LINK_CHANNELS = 16  # of a kind
SENSOR = "temperature"
FEED_STAGE = 6  # of the values of a column's table


@dataclass(frozen=True)
class Channel:
    name: str
    unit: str
    lo: float
    hi: float


@dataclass
class Sensor:
    """A thermometer of the block. number: of the input."""

    number: int
    name: str
    stage: int
    moves: bool
    above: bool  # the feed
    factor: float  # kelvin for one unit of the channel


@dataclass
class Block:
    number: int
    settings: dict[str, str]
    inputs: list[str]
    points: list[str]
    sensors: list[Sensor] = field(default_factory=list)

    def get(self, name: str, default: str) -> str:
        return self.settings.get(name, default)


@dataclass
class Recorded:
    source: str
    config: list[str]  # console lines before the first sample
    later: list[tuple[float, str]]  # verbs of blocks, s
    not_played: list[str]  # settings that were changed on the way
    tick_s: float
    time_s: list[float]
    measured: list[Channel]
    driven: list[Channel]
    readings: list[list[tuple[float, int]]]  # a row for each sample: value and quality
    applied: list[list[float]]  # from each sample on
    owner: dict[str, str]  # the loop of an output


# ---- configuration ----


def settings_of(lines: list[str]) -> dict[str, str]:
    """The last `set` of each parameter counts."""
    return {words[1]: words[2] for words in (line.split(None, 2) for line in lines) if words[:1] == ["set"] and len(words) == 3}


def find_block(config: list[str], number: int | None, where: str) -> Block:
    known = settings_of(config)
    there = [int(m[1]) for name, kind in known.items() if (m := re.fullmatch(r"block(\d+)\.kind", name)) and kind == "composition"]
    if not there:
        raise UserError(f"{where}: no block of the kind composition is set up there, and only its innovations are judged")
    if number is None and len(there) > 1:
        raise UserError(f"{where}: blocks {', '.join(map(str, there))} are of the kind composition; --block names one")
    if number is not None and number not in there:
        raise UserError(f"--block {number}: no block of the kind composition; there is {', '.join(map(str, there))}")
    k = number or there[0]
    own = {name.split(".", 1)[1]: text for name, text in known.items() if name.startswith(f"block{k}.")}
    block = Block(k, own, _names(own.get("inputs", "")), _names(own.get("points", "")))
    feed = _feed_stage(known, own.get("column", "0"))
    for i, name in enumerate(block.inputs, 1):
        if own.get(f"is.{i}", SENSOR) == SENSOR:
            stage, moves = _pair(own.get(f"place.{i}", "0,0"))
            block.sensors.append(Sensor(i, name, int(stage), moves > 0, stage > feed, _pair(own.get(f"si.{i}", "0,0"))[0] or 1.0))
    if not block.sensors:
        raise UserError(f"{where}: block {k} has no thermometer among its inputs")
    return block


def _names(text: str) -> list[str]:
    return [] if text in ("", "-") else text.split(",")


def _pair(text: str) -> tuple[float, float]:
    values = [*map(logs.number, text.split(",")), 0.0, 0.0]
    return values[0], values[1]


def _feed_stage(known: dict[str, str], column: str) -> int:
    row = known.get(f"block{column}.value.1", "").split(",")
    return int(float(row[FEED_STAGE])) if len(row) > FEED_STAGE else 0


def channels(config: list[str], kind: str) -> list[Channel]:
    """meas or mv, in the order of their numbers."""
    known = settings_of(config)
    found = sorted(int(m[1]) for name, text in known.items() if (m := re.fullmatch(rf"{kind}(\d+)\.name", name)) and text != "-")
    return [Channel(known[f"{kind}{k}.name"], known.get(f"{kind}{k}.unit", "-"), float(known.get(f"{kind}{k}.lo", "0")),
                    float(known.get(f"{kind}{k}.hi", "100"))) for k in found]


# ---- the run ----


def read(place: Path, conf: list[Path], block: int | None) -> tuple[Recorded, Block]:
    log, folder = _log_at(place)
    lines, later = _config_of(folder, conf, place)
    of = find_block(lines, block, ", ".join(map(shown, conf)) if conf else shown(folder / "script.txt" if folder else place))
    simulated = any(name.endswith(".meas") for name in map(logs.bare, log.columns))
    if not simulated:  # what the board has filtered it would filter again
        lines = [*lines, *_without_filters(lines)]
    return _recorded(log, lines, later, of, simulated), of


def _log_at(place: Path) -> tuple[Log, Path | None]:
    if place.is_dir():
        if not (place / "log.csv").is_file():
            raise UserError(f"{shown(place)}: no log.csv there; a folder that `{tool('run')} ... --out` has written, or the log of {tool('console')}")
        return logs.read(place / "log.csv"), place
    if not place.is_file():
        raise UserError(f"{shown(place)}: no such file; a folder that `{tool('run')} ... --out` has written, or the log of {tool('console')}")
    return logs.read(place), place.parent


def _config_of(folder: Path | None, conf: list[Path], place: Path) -> tuple[list[str], list[tuple[float, str]]]:
    """Lines sent before the first sample, and lines sent later."""
    script = folder / "script.txt" if folder else None
    sent: list[tuple[float, str]] = []
    if script and script.is_file():
        for number, line in enumerate(textfile.read(script).splitlines(), 1):
            at, _, text = line.partition(" ")
            if math.isnan(logs.number(at)):
                raise UserError(f"{shown(script)}:{number}: expected a time in s and a console line")
            sent.append((float(at), text.removeprefix("?")))
    if conf:
        first = [line.text for line in scenario.read_console_files(tuple(_there(c) for c in conf))]
    elif sent:
        first = [text for at, text in sent if at <= 0 and is_setting(text)]
    else:
        raise UserError(f"{shown(place)}: with what configuration was it recorded? --conf FILE, as `{tool('console')} PORT --dump FILE` writes it")
    return first, [(at, text) for at, text in sent if at > 0 or not is_setting(text)]


def _there(path: Path) -> Path:
    if not path.is_file():
        raise UserError(f"--conf {shown(path)}: no such file")
    return path


def is_setting(text: str) -> bool:
    return text.split(" ", 1)[0] in ("begin", "set", "apply", "defaults", "abandon")


def _without_filters(lines: list[str]) -> list[str]:
    names = [name for name, text in settings_of(lines).items() if re.fullmatch(r"meas\d+\.filter", name) and float(text) > 0]
    return ["begin", *(f"set {name} 0" for name in names), "apply"] if names else []


def _recorded(log: Log, lines: list[str], later: list[tuple[float, str]], block: Block, simulated: bool) -> Recorded:
    value, quality = (".meas", ".quality") if simulated else ("", ".q")
    measured = [c for c in channels(lines, "meas") if c.name not in block.points and log.has(c.name + value)]
    driven = [c for c in channels(lines, "mv") if _applied_column(log, c)]
    have = {c.name for c in (*measured, *driven)}
    for name in block.inputs:
        if name not in have:
            raise UserError(f"{log.source}: no column {name}{value} or {name}.app, which block {block.number} reads; the log has "
                            f"{', '.join(map(logs.bare, log.columns))}")
    if len(measured) > LINK_CHANNELS or len(driven) > LINK_CHANNELS:
        raise UserError(f"{log.source}: more than {LINK_CHANNELS} measurements or outputs are configured; the plant link carries no more")
    time_s, known = log.numbers("time"), settings_of(lines)
    return Recorded(
        log.source,
        lines,
        [(at, text) for at, text in later if re.match(r"block \S+ [a-z]+( |$)", text) and not text.endswith((" on", " off"))],
        [f"`{text}` at {at:g} s" for at, text in later if at > 0 and text.startswith("set ")],
        _tick(time_s, log),
        time_s,
        measured,
        driven,
        _readings(log, measured, value, quality),
        _outputs(log, driven),
        {out: known[f"loop{m[1]}.name"] for name, out in known.items() if (m := re.fullmatch(r"loop(\d+)\.out", name)) and f"loop{m[1]}.name" in known},
    )


def _tick(time_s: list[float], log: Log) -> float:
    steps = [b - a for a, b in zip(time_s, time_s[1:])]
    if len(steps) < 2 or not all(math.isfinite(t) for t in time_s):
        raise UserError(f"{log.source}: column time has no two samples with their times")
    tick = min(steps)
    if tick < 1:
        raise UserError(f"{log.source}: ticks of {tick:g} s; innovations of single ticks can be read from 1 s on")
    for k, step in enumerate(steps):
        if abs(step / tick - round(step / tick)) > 0.01:
            raise UserError(f"{log.source}: {step:g} s pass before the sample at {time_s[k + 1]:g} s, which is not a multiple of the tick of {tick:g} s")
    return tick


def _readings(log: Log, measured: list[Channel], value: str, quality: str) -> list[list[tuple[float, int]]]:
    columns = []
    for channel in measured:
        values = log.numbers(channel.name + value)
        marks = log.numbers(channel.name + quality) if log.has(channel.name + quality) else [float(GOOD)] * len(values)
        for k, (x, mark) in enumerate(zip(values, marks)):
            if math.isnan(mark) or not math.isfinite(x) and mark < BAD:
                raise UserError(f"{log.source}: {channel.name}{value} is not a number in the sample at {log.text('time')[k]} s, and its quality does not say "
                                "bad; leave the row out, or give it quality 3")
        columns.append([(x if math.isfinite(x) else 0.0, int(mark)) for x, mark in zip(values, marks)])
    return [list(row) for row in zip(*columns)]


def _applied_column(log: Log, channel: Channel) -> str:
    """Values that the board took for applied, if it printed them; else what the plant says."""
    names = (f"{logs.FIRMWARE_PREFIX}{channel.name}.app", f"{channel.name}.app", f"{channel.name}.applied")
    return next((name for name in names if log.has(name)), "")


def _outputs(log: Log, driven: list[Channel]) -> list[list[float]]:
    """Telemetry has what applies from its tick on, a plant's log what applied before it."""
    columns = []
    for channel in driven:
        name = _applied_column(log, channel)
        values = log.numbers(name)
        for k, x in enumerate(values):
            if not math.isfinite(x):
                raise UserError(f"{log.source}: {name} is not a number in the sample at {log.text('time')[k]} s")
        columns.append([*values[1:], values[-1]] if name.endswith(".applied") else values)
    return [list(row) for row in zip(*columns)]
