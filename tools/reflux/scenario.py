"""A scenario: one run of one plant against one firmware, as written in a TOML file (docs/use/scenarios.md)."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from pathlib import Path

from reflux import textfile
from reflux.errors import UserError
from reflux.paths import ROOT, SCENARIOS, shown, tool
from reflux.scenario_keys import EVENT, FIRMWARES, LIMIT, LINE, LOOP, METRICS, TOP, WITH_PINS
from reflux.schema import Table, check_number, load_toml

CHANNEL = re.compile(r"[A-Za-z0-9_]{1,15}")
EVENT_NAME = re.compile(r"[A-Za-z0-9_]{1,15}(\.[a-z_]{1,20})?")
LINE_MAX = 120  # bytes of one console line that the firmware is sure to take


@dataclass(frozen=True)
class Loop:
    """A loop as the report judges it: which measurement follows its setpoint by which output."""

    name: str
    pv: str
    mv: str
    band: float = 0.0  # settled when this close, in units of pv; 0: 5 % of the setpoint step


@dataclass(frozen=True)
class Line:
    """A console line sent before the sample at at_s."""

    at_s: float
    text: str
    allow_err: bool = False
    origin: str = ""  # where it was written, for messages


@dataclass(frozen=True)
class Event:
    at_s: float
    name: str
    value: float


@dataclass(frozen=True)
class Limit:
    """Limits of one loop: over the window that begins at at_s, or over the whole run."""

    loop: str
    at_s: float | None
    most: dict[str, float]


@dataclass(frozen=True)
class Scenario:
    file: Path
    name: str
    title: str
    plant: str
    duration_s: float
    tick_s: float | None = None
    seed: int = 1
    noise: float = 1.0
    speed: str = "max"
    firmware: str = "host"
    timeout_s: float = 30.0
    wiring: Path | None = None  # the plant is at the board's own pins
    console: tuple[Path, ...] = ()
    lines: tuple[Line, ...] = ()
    events: tuple[Event, ...] = ()
    measure: tuple[str, ...] = ()  # truths that are measured
    start: tuple[tuple[str, float], ...] = ()  # inputs at whose steady state the run begins
    loops: tuple[Loop, ...] = ()
    limits: tuple[Limit, ...] = ()
    config: tuple[Line, ...] = field(default=())  # what the console files hold, sent first

    @classmethod
    def named(cls, name: str | Path) -> "Scenario":
        """A scenario of host_sim/scenarios by name, or a .toml file."""
        return load(find(name))

    def with_options(self, **options: object) -> "Scenario":
        """The same scenario with what the command line gave; None leaves a value as written."""
        return replace(self, **{k: v for k, v in options.items() if v is not None})

    @property
    def plant_argument(self) -> str:
        """For --plant of reflux-sim: a plant file is looked for from the scenario's folder; anything else is a name."""
        return str(self.file.parent / self.plant) if self.plant.endswith(".json") else self.plant

    def plant_options(self) -> list[str]:
        """Options of reflux-sim that say which plant it is: its tick, what is measured, and where it begins."""
        out = ["--tick", f"{self.tick_s:.17g}"] if self.tick_s is not None else []
        for name in self.measure:
            out += ["--measure", name]
        for name, value in self.start:
            out += ["--start", f"{name}={value:.17g}"]
        return out


def find(name: str | Path) -> Path:
    """A path as given, or the name of a scenario in host_sim/scenarios."""
    path = Path(name)
    if path.is_file() or path.suffix == ".toml" or "/" in str(name):
        return path
    known = sorted(p.stem for p in SCENARIOS.glob("*.toml"))
    if str(name) in known:
        return SCENARIOS / f"{name}.toml"
    raise UserError(f"no scenario {name}; give a .toml file, or one of {', '.join(known)} "
                    f"from {shown(SCENARIOS)}")


def load(path: Path, plants: list[str] | None = None) -> Scenario:
    """Reads and checks a scenario file; plants, where known, are the names the simulator offers."""
    top = Table(load_toml(path), path)
    name = top.read(TOP["name"])
    if not re.fullmatch(r"[A-Za-z0-9_-]{1,40}", name):
        raise UserError(f'{top.path("name")} is "{name}"; letters, digits, - and _ only (it names a folder)')
    duration = top.read(TOP["duration_s"])
    scenario = Scenario(
        file=path,
        name=name,
        title=top.read(TOP["title"], name),
        plant=top.read(TOP["plant"], choices=plants),
        duration_s=duration,
        tick_s=top.read(TOP["tick_s"], high=duration),
        seed=top.read(TOP["seed"]),
        noise=top.read(TOP["noise"]),
        speed=_speed(top),
        firmware=top.read(TOP["firmware"]),
        timeout_s=top.read(TOP["timeout_s"]),
        wiring=_wiring(top, path),
        console=_console_files(top, path),
        loops=_loops(top),
        lines=_lines(top, path, duration),
        events=_events(top, duration),
        start=_start(top),
        measure=tuple(check_channel(name, top.path("measure")) for name in top.read(TOP["measure"])),
    )
    scenario = replace(scenario, limits=_limits(top, scenario))
    top.done()
    return replace(scenario, config=tuple(read_console_files(scenario.console)))


def _speed(top: Table) -> str:
    speed = top.read(TOP["speed"])
    check_speed(speed, top.path("speed"))
    return speed


def check_speed(speed: str, where: str) -> str:
    """max, or how many times faster than real time."""
    try:
        good = speed == "max" or 0 < float(speed) < 1e9
    except ValueError:
        good = False
    if not good:
        raise UserError(f'{where} is "{speed}"; "max", or how many times real time as a number above 0')
    return speed


def _console_files(top: Table, path: Path) -> tuple[Path, ...]:
    files = []
    for name in top.read(TOP["console"]):
        file = path.parent / name
        if not file.is_file():
            raise UserError(f'{top.path("console")}: there is no file {shown(file)}')
        files.append(file)
    return tuple(files)


def _wiring(top: Table, path: Path) -> Path | None:
    name = top.read(TOP["wiring"])
    if name is None:
        return None
    file = path.parent / name
    if not file.is_file():
        raise UserError(f'{top.path("wiring")}: there is no file {shown(file)}')
    return file


def check_pins(scenario: Scenario) -> None:
    """Refuses a firmware that has no pins for the wiring."""
    if scenario.wiring is not None and scenario.firmware not in WITH_PINS:
        raise UserError(f"{shown(scenario.file)}: with a wiring the firmware must have pins: {', '.join(WITH_PINS)}; {scenario.firmware} has none")


def check_link(scenario: Scenario) -> Scenario:
    """Refuses a scenario whose plant is not at the link, for a tool that has it only there."""
    if scenario.wiring is not None:
        raise UserError(f"{shown(scenario.file)}: its plant is at the board's own pins; {tool('run')} runs it")
    return scenario


def read_console_files(files: tuple[Path, ...]) -> list[Line]:
    """Console lines of configuration files: one a line, # starts a comment, empty lines do not count."""
    lines = []
    for file in files:
        for number, raw in enumerate(textfile.read(file).splitlines(), 1):
            where = f"{shown(file)}:{number}"
            line = re.sub(r"(^|\s)#.*", "", raw).strip()
            if line:
                lines.append(Line(0.0, check_line(line, where), line.startswith("?"), where))
    return lines


def check_line(text: str, where: str) -> str:
    text = text.removeprefix("?").strip()
    if not text or not text.isascii() or not text.isprintable():
        raise UserError(f"{where}: a console line is plain ASCII text on one line")
    if len(text) > LINE_MAX:
        raise UserError(f"{where}: a console line has at most {LINE_MAX} characters, this one {len(text)}")
    return text


def _lines(top: Table, path: Path, duration: float) -> tuple[Line, ...]:
    lines = []
    for table in top.tables("line"):
        where = table.path("send")
        line = Line(table.read(LINE["at_s"], high=duration), check_line(table.read(LINE["send"]), where),
                    table.read(LINE["allow_err"]), where)
        table.done()
        lines.append(line)
    return tuple(sorted(lines, key=lambda line: line.at_s))


def _start(top: Table) -> tuple[tuple[str, float], ...]:
    inputs = _flat_numbers(top.table("start")) if "start" in top.data else {}
    for name in inputs:
        if "." in name:
            raise UserError(f"{top.path('start')}: {name}: expected an input of the plant, as R")
    return tuple(inputs.items())


def _events(top: Table, duration: float) -> tuple[Event, ...]:
    events = []
    for table in top.tables("event"):
        at_s = table.read(EVENT["at_s"], high=duration)
        settings = table.table(EVENT["set"].name)
        if not settings.data:
            raise UserError(f"{table.path('set')} is empty; expected {{ NAME = number }}")
        for name, value in _flat_numbers(settings).items():
            if not EVENT_NAME.fullmatch(name):
                raise UserError(f"{settings.path(name)}: expected a channel, as F, or an option of one, as Qrb.hi")
            events.append(Event(at_s, name, value))
        table.done()
    return tuple(sorted(events, key=lambda event: event.at_s))


def _flat_numbers(table: Table) -> dict[str, float]:
    """TOML reads Qrb.hi = 1 as a table in a table; here it is the option hi of the channel Qrb."""
    out: dict[str, float] = {}
    for key, value in table.data.items():
        if isinstance(value, dict):
            out |= {f"{key}.{inner}": v for inner, v in table.table_of(key).numbers().items()}
        else:
            out[key] = check_number(table.path(key), value)
    return out


def check_channel(name: str, where: str) -> str:
    if not CHANNEL.fullmatch(name):
        raise UserError(f'{where}: "{name}" is not a channel name (1 to 15 letters, digits or _)')
    return name


def _loops(top: Table) -> tuple[Loop, ...]:
    loops: list[Loop] = []
    for table in top.tables("loop"):
        loop = Loop(check_channel(table.read(LOOP["name"]), table.path("name")),
                    check_channel(table.read(LOOP["pv"]), table.path("pv")),
                    check_channel(table.read(LOOP["mv"]), table.path("mv")),
                    table.read(LOOP["band"]))
        table.done()
        if loop.name in (known.name for known in loops):
            raise UserError(f"{table.path('name')}: there is a loop {loop.name} already")
        loops.append(loop)
    return tuple(loops)


def _limits(top: Table, scenario: Scenario) -> tuple[Limit, ...]:
    starts = window_starts(scenario)
    limits = []
    for table in top.tables("limit"):
        name = table.read(LIMIT["loop"], choices=[loop.name for loop in scenario.loops] or ["(no [[loop]] given)"])
        at_s = table.read(LIMIT["at_s"])
        if at_s is not None and at_s not in starts:
            raise UserError(f"{table.path('at_s')} is {at_s:g}, and nothing happens then; windows begin at "
                            f"{', '.join(f'{t:g}' for t in starts)}")
        most = {}
        for metric in METRICS:
            value = table.read(METRICS[metric])
            if value is not None:
                most[metric] = value
        table.done()
        if not most:
            raise UserError(f"{table.path('loop')}: this limit limits nothing; give one of {', '.join(METRICS)}")
        limits.append(Limit(name, at_s, most))
    return tuple(limits)


def is_stimulus(line: Line) -> bool:
    """Console lines that make something happen on the plant, and so begin a window of their own."""
    return line.text.split()[0] in ("sp", "out") or re.match(r"mode (?!machine|human|terminal)", line.text) is not None


def window_starts(scenario: Scenario) -> list[float]:
    """Times at which a setpoint, a mode, an output or the plant is changed: windows run from one to the next."""
    times = {0.0} | {event.at_s for event in scenario.events}
    times |= {line.at_s for line in scenario.lines if is_stimulus(line)}
    return sorted(t for t in times if t < scenario.duration_s)


def relative(path: Path) -> str:
    """Name of a file of the repository or package in results, whatever the folder it is started from."""
    try:
        return str(path.resolve().relative_to(ROOT))
    except ValueError:
        return path.name
