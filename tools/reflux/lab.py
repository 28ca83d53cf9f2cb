"""reflux.Lab: a board with a plant behind it, from Python (docs/use/python.md).

    with Lab("pilot") as lab:
        lab.mode("bottom", "auto")
        lab.setpoint("bottom", 108.5)
        log = lab.run(hours=2)
    log.plot()
"""

from __future__ import annotations

import contextlib
import functools
import logging
import os
import re
import threading
import weakref
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Concatenate, ParamSpec, Sequence, TypeVar

from reflux import cmd_play, given, lab_log, logs, runner, scenario_settings
from reflux import scenario as scenarios
from reflux.errors import RunFailed, UserError
from reflux.in_process import Channel, InProcess, Kind
from reflux.on_port import OnPort
from reflux.paths import SCENARIOS
from reflux.plant import Plant
from reflux.scenario import Scenario

logger = logging.getLogger("reflux")

HUMAN = re.compile(r"\s*mode\s+(human|terminal)\b", re.I)
TIMES = {"hours": 3600.0, "minutes": 60.0, "seconds": 1.0}
SAMPLES_MAX = 2**32 - 1  # numbers of samples on the link

P, R = ParamSpec("P"), TypeVar("R")


def _in_turn(method: "Callable[Concatenate[Lab, P], R]") -> "Callable[Concatenate[Lab, P], R]":
    """A call of one thread at a time: the library behind a lab knows no threads."""
    @functools.wraps(method)
    def alone(self: "Lab", *arguments: P.args, **options: P.kwargs) -> R:
        with self._turn:
            return method(self, *arguments, **options)

    return alone


@dataclass(frozen=True)
class Beginning:
    """What a lab starts from, as found by its name. Another lab may start from the same: no file is read again."""

    plant: str
    options: tuple[str, ...] = ()  # of reflux-sim
    lines: tuple[str, ...] | None = None  # None: those of the plant's channels
    scenario: Scenario | None = None
    kept: Plant | None = None  # its file lives as long


class Lab:
    """Firmware and plant in this process, or a board on a serial port.

    what: a configuration, a scenario or a plant by name, a Scenario, or a Plant. Of a plant alone the board knows the channels and has
    no loops. The plant stands at its operating point, the outputs too, the loops are in manual.
    port: the console of a board, such as /dev/ttyUSB0, instead; its time is real.

    What the board refuses is raised as reflux.Refused with the console's words. Threads that share a lab take turns, call by call.
    """

    def __init__(self, what: str | Path | Scenario | Plant | Beginning = "pilot", *, port: str | None = None, seed: int | None = None, noise: float | None = None,
                 tick_s: float | None = None, at_operating_point: bool = True):
        self._turn = threading.RLock()
        _labs.add(self)
        self.scenario: Scenario | None = None
        self._in_process: InProcess | None = None
        self._on_port: OnPort | None = None
        self._measured: list[str] = []
        self._outputs: list[str] = []
        self._played = False
        try:
            if port is not None:
                if (seed, noise, tick_s) != (None, None, None):
                    raise UserError("seed, noise and tick_s are for a plant in this process, not for a board on a port")
                if not isinstance(port, str) or "\0" in port:
                    raise UserError(f"a port is a name such as /dev/ttyUSB0, not {given.shown(port)}")
                self._on_port = OnPort(port)
                settings = self.command("dump").splitlines()
            else:
                settings = self._start(what, seed, noise, tick_s)
            self._find_channels(settings)
            if self._in_process and at_operating_point:
                self._operate()
        except BaseException:
            self.close()
            raise

    # ---- how it begins ----

    def _start(self, what: str | Path | Scenario | Plant | Beginning, seed: int | None, noise: float | None, tick_s: float | None) -> Sequence[str]:
        self.beginning = what if isinstance(what, Beginning) else _beginning(what)
        self.scenario, plant, options = self.beginning.scenario, self.beginning.plant, list(self.beginning.options)
        for name, value in (("--seed", seed), ("--noise", noise), ("--tick", tick_s)):
            if value is not None:
                options += [name, f"{value:.17g}" if isinstance(value, float) else str(value)]
        self._in_process = InProcess(plant, options)
        lines = self._channel_lines() if self.beginning.lines is None else self.beginning.lines
        for line in [*(line.text for line in runner.BEFORE), *lines, *(line.text for line in runner.AFTER)]:
            self._say(line)
        logger.info("%s in this process, a sample each %g s", plant, self.tick_s)
        return lines

    def _channel_lines(self) -> list[str]:
        """The plant's channels, as a board without a configuration takes them."""
        channels = self._engine("channels").channels.values()
        out = ["begin"]
        for kind, group in ((Kind.MEASUREMENT, "meas"), (Kind.MV, "mv")):
            for k, c in enumerate((c for c in channels if c.kind == kind), 1):
                out += [f"set {group}{k}.name {c.name}", f"set {group}{k}.unit {c.unit}", f"set {group}{k}.lo {c.lo:.9g}", f"set {group}{k}.hi {c.hi:.9g}"]
                if kind == Kind.MV:
                    out += [f"set mv{k}.min {c.lo:.9g}", f"set mv{k}.max {c.hi:.9g}", f"set mv{k}.safe {c.nominal:.9g}"]
        return [*out, "apply"]

    def _find_channels(self, settings: Sequence[str]) -> None:
        values = scenario_settings.values_of(tuple(settings))
        for group, names in (("meas", self._measured), ("mv", self._outputs)):
            names += scenario_settings.in_use(values, group)
        self._sequences = scenario_settings.has_sequence(values)

    def _operate(self) -> None:
        """Outputs to the plant's operating point; a plant that a sequence starts is left to the sequence."""
        if self.scenario is None and not self._sequences:
            for name in self._outputs:
                if name in self._there().names:
                    self._say(f"out {name} {self._there().value(name):.7g}")

    def _there(self) -> InProcess | OnPort:
        engine = self._in_process or self._on_port
        if engine is None:
            raise RunFailed("the lab is closed")
        return engine

    def _engine(self, call: str, instead: str = "") -> InProcess:
        engine = self._there()
        if not isinstance(engine, InProcess):
            raise UserError(f"lab.{call} goes with a plant in this process, not with a board on a port{instead}")
        return engine

    # ---- the console ----

    def _say(self, text: str) -> list[str]:
        engine = self._there()
        logger.debug("> %s", text.split()[0] if text.split() else "")  # not its words: one may be a key
        return engine.say(text)

    @_in_turn
    def command(self, text: str) -> str:
        """Any line of the console; the reply without its ok."""
        return "\n".join(self._command(text))

    def _command(self, text: str) -> list[str]:
        """What a caller says, who could smuggle a second line into it; lines of our own files go through _say()."""
        if HUMAN.match(given.line(text)):
            raise UserError(f"{text.strip()}: a lab needs the console in machine mode")
        self._there()
        return self._say(text) if text.strip() else []

    @_in_turn
    def mode(self, loop: str, mode: str) -> None:
        """manual, auto or cascade."""
        self._command(f"mode {loop} {mode}")

    @_in_turn
    def setpoint(self, loop: str, value: float) -> None:
        self._command(f"sp {loop} {given.number(value, f'the setpoint of {loop}'):.9g}")

    @_in_turn
    def output(self, name: str, value: float) -> None:
        """An output by hand; refused while its loop is not in manual."""
        self._command(f"out {name} {given.number(value, f'output {name}'):.9g}")

    @_in_turn
    def set(self, name: str, value: float | str) -> None:
        """A parameter, as bottom.gain; docs/reference/parameters.md has them all."""
        if not isinstance(value, str):
            value = f"{given.number(value, name):.9g}"
        self._command(f"set {name} {value}")

    @_in_turn
    def get(self, name: str) -> str:
        """A parameter's value as the console prints it, without its unit."""
        words = self.command(f"get {name}").partition(" = ")[2].split()
        return words[0] if words else ""

    @_in_turn
    def disturb(self, name: str, value: float, after_s: float = 0.0) -> None:
        """A disturbance of the plant, or an option of a channel (Qrb.hi, T10.dead; docs/inside/faults.md), from the next sample on or later."""
        engine = self._engine("disturb")
        after_s = given.finite(after_s, "after_s", 0.0)
        engine.event(engine.time_s + after_s, name, given.finite(value, name))

    # ---- time ----

    @_in_turn
    def run(self, *unnamed: object, hours: float = 0.0, minutes: float = 0.0, seconds: float = 0.0, ticks: int | None = None, csv: str | Path | None = None) -> Any:
        """Lets time pass and returns the log of it (lab_log.py), of a board on a port with all that came since the last one. csv: writes it
        into this file too, as tools/run does."""
        self._there()
        if unnamed:
            raise UserError(f"how long? run(hours={given.shown(unnamed[0])}) or run(seconds={given.shown(unnamed[0])}), also minutes= and ticks=")
        _check_csv(csv)
        span = sum(given.finite(value, name) * TIMES[name] for name, value in (("hours", hours), ("minutes", minutes), ("seconds", seconds)))
        if (ticks is None) == (span == 0.0) or span < 0:
            raise UserError("how long? hours=, minutes= and seconds= together, or ticks=, a whole number from 1")
        if self._on_port is not None:
            if ticks is None:
                self._on_port.listen(span)
            else:
                self._listen(given.whole(ticks, "ticks", SAMPLES_MAX))
        else:
            engine = self._engine("run")
            if ticks is None:
                samples = span / engine.tick_s
                if samples > SAMPLES_MAX:
                    raise UserError(f"how long? {span:g} s are more than {SAMPLES_MAX} samples")
                ticks = max(1, round(samples))
            engine.step(given.whole(ticks, "ticks", SAMPLES_MAX))
        return self._log(csv)

    @_in_turn
    def step(self, ticks: int = 1) -> None:
        """As run(ticks=...), without a log: for a program that decides anew at each sample."""
        self._engine("step").step(given.whole(ticks, "ticks", SAMPLES_MAX), keep=False)

    def _listen(self, rows: int) -> None:
        assert self._on_port is not None
        try:
            self._on_port.listen_rows(rows, 600.0)
        except TimeoutError:
            raise RunFailed("the board has sent no telemetry for 600 s; is its plant link ready?") from None

    @_in_turn
    def play(self, csv: str | Path | None = None) -> Any:
        """Carries out the lines and events of the scenario to its end, as tools/run does, and returns the log."""
        s, engine = self.scenario, self._engine("play")
        if s is None:
            raise UserError("this lab has no scenario to play; Lab(\"demo\") has")
        if self._played or engine.time_s >= s.duration_s:
            raise UserError(f"the scenario goes once, from the start to {s.duration_s:g} s, and plant time is {engine.time_s:g} s; start another Lab")
        _check_csv(csv)
        self._played = True
        for event in s.events:
            engine.event(event.at_s, event.name, event.value)
        for line in s.lines:
            engine.step(engine.samples_before(line.at_s))
            try:
                self._say(line.text)
            except RunFailed as error:
                if not line.allow_err:
                    raise type(error)(f"{line.origin or line.text}: {error}") from None
        engine.step(engine.samples_before(s.duration_s + 1e-6))
        return self._log(csv)

    def _log(self, csv: str | Path | None) -> Any:
        taken = self._in_process.take() if self._in_process else None
        fast = taken.numbers() if taken and csv is None else None
        if fast:
            return lab_log.of(*fast)
        log = taken.log() if taken else self._on_port.log() if self._on_port else None
        if log is None:
            raise RunFailed("no sample came in this time; is the board's plant link ready?")
        if csv is not None:
            try:
                lab_log.write(log, csv)
            except OSError as error:
                raise UserError(f"{csv} cannot be written: {error.strerror}") from None
        return lab_log.of(*lab_log.numbers(log))

    @property
    @_in_turn
    def time_s(self) -> float:
        """Plant time of the sample to come; of a board on a port, of its last one."""
        return self._there().time_s

    @property
    @_in_turn
    def tick_s(self) -> float:
        return self._engine("tick_s").tick_s

    # ---- numbers ----

    @property
    @_in_turn
    def channels(self) -> dict[str, Channel]:
        """Every channel of the plant, with unit, span and nominal value."""
        return dict(self._engine("channels", "; lab.measurements and lab.outputs name what the board has, lab.command(\"dump\") its settings").channels)

    @property
    @_in_turn
    def measurements(self) -> dict[str, float]:
        """What the board last measured; NaN before the first sample."""
        self._there()
        return {name: self._there().value(name) for name in self._measured}

    @property
    @_in_turn
    def outputs(self) -> dict[str, float]:
        """Where the outputs stand, to six digits."""
        self._there()
        return {name: self._number(name) for name in self._outputs}

    @property
    @_in_turn
    def loops(self) -> dict[str, dict[str, Any]]:
        """Of each loop, as the console's `loop` has it: mode, channels pv and out, setpoint sp."""
        out: dict[str, dict[str, Any]] = {}
        for line in self._say("loop"):
            name, *words = line.split()
            said = dict(re.findall(r"\b(pv|sp|out) (\S+)", line))
            out[name] = {"mode": words[0] if words else "", **said, "sp": logs.number(said.get("sp", ""))}
        return out

    @_in_turn
    def value(self, name: str) -> float:
        """A channel of the plant: a measurement as the board sees it, an output as it stands, anything else as it is."""
        engine = self._there()
        if name not in self._measured and name not in self._outputs and name not in engine.names:
            known = dict.fromkeys([*self._measured, *self._outputs, *engine.names])
            raise UserError(f"there is no channel {given.shown(name)}; there are {', '.join(known)}")
        return self._number(name)

    def _number(self, name: str) -> float:
        """The board's numbers have six to seven digits: an output of 50 stands at 50.0000038 there."""
        value = self._there().value(name)
        return float(f"{value:.6g}") if name in self._outputs else value

    def __getattr__(self, name: str) -> float | Callable[..., float]:
        """lab.T1 is a measurement. lab.Q1() is where an output stands. lab.Q1(50) sets it and returns 50.0, because TCLab's Q1 returns the value that it
        sets; the output stands there from the next sample on. TCLab clips a value outside of its range, a board refuses it."""
        if not name.startswith("_"):
            measured, outputs = self._measured, self._outputs
            for names, letter in ((measured, "T"), (outputs, "Q")):
                found = _channel(name, names, letter)
                if found and names is measured:
                    return self.value(found)
                if found:
                    self._there()
                    return self._handle(found)
        raise AttributeError(f"{name}: this lab has the measurements {', '.join(self.__dict__.get('_measured', []))} "
                             f"and the outputs {', '.join(self.__dict__.get('_outputs', []))}")

    def __setattr__(self, name: str, value: Any) -> None:
        """lab.Q1 = 50 would set nothing and hide the output."""
        if any(_channel(name, self.__dict__.get(names, []), letter) for names, letter in (("_measured", "T"), ("_outputs", "Q"))):
            raise AttributeError(f"{name} is a channel: lab.{name}(50) moves an output, and a measurement is only read")
        super().__setattr__(name, value)

    def _handle(self, name: str) -> Callable[..., float]:
        def handle(value: float | None = None) -> float:
            with self._turn:
                if value is None:
                    return self.value(name)
                self.output(name, value)
                return float(value)

        return handle

    # ---- the end ----

    @_in_turn
    def close(self) -> None:
        """Ends the run in this process, or lets go of the port; a board goes on as it is."""
        for engine in (self._in_process, self._on_port):
            if engine is not None:
                engine.close()
        self._in_process = self._on_port = None

    def __reduce_ex__(self, protocol: Any) -> Any:
        """For copy and pickle; a copy would share the board, and close it when it goes."""
        raise UserError("a lab cannot be copied or sent to another process, because its board is in this one; start another Lab there")

    def __del__(self) -> None:
        with contextlib.suppress(Exception):
            self.close()

    def __enter__(self) -> "Lab":
        self._there()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


_labs: "weakref.WeakSet[Lab]" = weakref.WeakSet()


def _after_fork() -> None:
    """In a child, a lab that another thread of the parent was using is in mid-call, and its lock taken, for ever: it is closed."""
    for lab in list(_labs):
        if lab._turn.acquire(blocking=False):
            lab._turn.release()
        else:
            lab._turn, lab._in_process, lab._on_port = threading.RLock(), None, None


os.register_at_fork(after_in_child=_after_fork)


def _beginning(what: str | Path | Scenario | Plant) -> Beginning:
    if isinstance(what, Plant):
        return Beginning(what.argument, kept=what)
    if not isinstance(what, (str, Path, Scenario)):
        raise UserError(f"a lab takes the name of a configuration, a scenario or a plant, a Scenario or a Plant, not {given.shown(what)}")
    what = str(what) if isinstance(what, Path) else what
    if isinstance(what, str) and ((SCENARIOS / f"{what}.conf").is_file() or what.endswith(".conf")):
        bench = cmd_play.bench_of(what, None)
        return Beginning(bench.plant, bench.options, bench.lines)
    s = what if isinstance(what, Scenario) else _scenario(what)
    if s is None:
        return _beginning(_plant(str(what)))
    scenarios.check_link(s)
    options = ["--seed", str(s.seed), "--noise", f"{s.noise:.17g}", *s.plant_options()]
    return Beginning(s.plant_argument, tuple(options), tuple(line.text for line in s.config), s)


def _check_csv(csv: Any) -> None:
    """Before time passes, so that no log is lost."""
    if csv is None:
        return
    if not isinstance(csv, (str, Path)) or "\0" in str(csv):
        raise UserError(f"csv must be the name of a file, not {given.shown(csv)}")
    path = Path(csv)
    if path.is_dir() or not path.parent.is_dir():
        raise UserError(f"{csv} cannot be written: {'it is a folder' if path.is_dir() else f'there is no folder {path.parent}'}")


def _scenario(name: str | Path) -> Scenario | None:
    """None: no scenario is called so."""
    if Path(name).suffix != ".toml" and not (SCENARIOS / f"{name}.toml").is_file():
        return None
    return scenarios.load(scenarios.find(name))


def _plant(name: str) -> Plant:
    try:
        return Plant(name)
    except UserError:
        known = sorted({path.stem for path in SCENARIOS.glob("*.*")})
        raise UserError(f"no configuration, scenario or plant {name}; configurations and scenarios are {', '.join(known)}, and plants those of "
                        "reflux-sim --list") from None


def _channel(name: str, names: list[str], letter: str) -> str | None:
    """The channel of this name; T1, T2 ... count measurements and Q1, Q2 ... outputs where no channel is called so."""
    if name in names:
        return name
    match = re.fullmatch(rf"{letter}([1-9]\d*)", name)
    if match and not any(re.fullmatch(rf"{letter}\d+", other) for other in names) and int(match[1]) <= len(names):
        return names[int(match[1]) - 1]
    return None
