"""A board under start-up: what it says, taken apart, and everything said kept in DIR/transcript.txt."""

from __future__ import annotations

import contextlib
import math
import re
import signal
import time
from collections import deque
from dataclasses import dataclass, field
from pathlib import Path
from typing import Iterator

from reflux import logs
from reflux.errors import RunFailed
from reflux.ports import Port
from reflux.session import Refused, Session

UNDER_WAY = ("testing", "fitting", "analysing", "paused", "trial")


@dataclass(frozen=True)
class Channel:
    """As the plant announces it."""

    name: str
    unit: str
    lo: float
    hi: float
    safe: float = 0.0


@dataclass(frozen=True)
class Plant:
    name: str
    tick_s: float
    measurements: tuple[Channel, ...]
    inputs: tuple[Channel, ...]


@dataclass(frozen=True)
class Event:
    at_s: float
    level: str
    code: str
    subject: str
    value: float
    text: str


@dataclass(frozen=True)
class State:
    """`status`."""

    safe: bool
    link: str
    plant_s: float
    open_transaction: bool
    locked: bool
    values: dict[str, float]
    good: dict[str, bool]


@dataclass(frozen=True)
class Progress:
    """`commission`. Of a test: which input, how many of them, and how far it is."""

    phase: str
    plant_s: float = 0.0
    text: str = ""
    input: str = ""
    number: int = 0
    total: int = 0
    round: int = 0
    stage: str = ""
    amplitude: str = ""
    worst: tuple[str, float] | None = None
    left: str = ""  # how long it may still take, as the board says it


EVENT = re.compile(r"! *([\d.]+) (\S+) (\S+) (\S+) (\S+) ?(.*)$")
TEST = re.compile(r"input (\S+) \((\d+) of (\d+)\), round (\d+): (.*?), amplitude (\S+ \S*?)"
                  r"(?:, worst (\S+) at (\S+) of its limit)?$")


def event_of(line: str) -> Event | None:
    match = EVENT.match(line)
    if not match:
        return None
    at, level, code, subject, value, text = match.groups()
    return Event(float(at), level, code, subject, number(value), text)


def number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")


def pairs_of(words: list[str]) -> dict[str, str]:
    """name value name value ... as a dictionary; of names that come twice the first."""
    out: dict[str, str] = {}
    for name, value in zip(words[::2], words[1::2]):
        out.setdefault(name, value)
    return out


def plant_of(lines: list[str]) -> Plant | None:
    """Reply to `commission plant`; None where no plant is connected. Older records say output and input, as seen from the
    plant; only what the board moves has a safe value."""
    name, tick = "", 0.0
    measurements: list[Channel] = []
    moved: list[Channel] = []
    for line in lines:
        words = line.split()
        if words[0] == "plant" and len(words) > 4:
            tick, name = float(words[3]), " ".join(words[5:])
        elif channel := re.fullmatch(r"(?:measurement|output|input) (\S+) unit (.+) lo (\S+) hi (\S+)(?: safe (\S+))?", line):
            channel_name, unit, lo, hi, safe = channel.groups()
            (moved if safe else measurements).append(Channel(channel_name, unit, float(lo), float(hi), float(safe or 0)))
    if not measurements and not moved:
        return None
    return Plant(name, tick, tuple(measurements), tuple(moved))


def state_of(lines: list[str]) -> State:
    head = lines[0] if lines else ""
    link = re.search(r"plant (at the board's pins|link (\w+))", head)
    at = re.search(r"plant time ([\d.]+) s", head)
    values, good = {}, {}
    for line in lines[1:]:
        match = re.match(r"(\S+) = (\S+)(.*)$", line)
        if match:
            values[match[1]] = number(match[2])
            good[match[1]] = match[3].rstrip().endswith(" good")
    return State(head.startswith("state safe"), (link[2] or "ready") if link else "?", float(at[1]) if at else 0.0,
                 "transaction open" in head, "console locked" in head, values, good)


def progress_of(lines: list[str]) -> Progress:
    head = re.match(r"phase (\w+)(?:.*plant time s ([\d.]+))?", lines[0] if lines else "")
    if not head:
        raise RunFailed(f"the board answers `commission` with \"{lines[0] if lines else ''}\"; is its firmware "
                        "as old as this tool?")
    left = next((line for line in lines if line.startswith("left ")), "")
    text = next((line for line in lines[1:] if line != left), "")
    phase, plant_s = head[1], float(head[2] or 0)
    test = TEST.match(text)
    if not test:
        return Progress(phase, plant_s, text, left=left)
    name, at, of, which, stage, amplitude, worst, share = test.groups()
    return Progress(phase, plant_s, text, name, int(at), int(of), int(which), stage, amplitude.strip(),
                    (worst, number(share)) if worst else None, left)


class Transcript:
    """File to which Session writes its notes: plant time before each line, telemetry into a file of its own, which is made one table at the end."""

    def __init__(self, folder: Path):
        self.time_s = 0.0
        self.text = (folder / "transcript.txt").open("w", encoding="utf-8")
        self.table = folder / "telemetry.csv"
        self.telemetry = self.table.open("w", encoding="utf-8")
        self.rows = self.damaged = 0
        self.fields = -1  # of a row, by the header

    def write(self, note: str) -> None:
        sign, line = note[0], note[2:].rstrip("\n")
        if sign == "<" and line.startswith(("H,", "T,")):
            self._telemetry(line)
            return
        event = event_of(line) if sign == "<" and line.startswith("!") else None
        if event:
            self.time_s = max(self.time_s, event.at_s)
        self.text.write(f"{self.time_s:.3f} {sign} {line}\n")

    def _telemetry(self, line: str) -> None:
        """Rows that have lost something on the way, or whose header nobody has heard, are left out."""
        if line.startswith("H,"):
            self.fields = line.count(",")
        elif line.count(",") != self.fields or not math.isfinite(number(line.split(",", 4)[3])):
            self.damaged += 1
            return
        else:
            self.rows += 1
            self.time_s = number(line.split(",", 4)[3])
        self.telemetry.write(line + "\n")

    def flush(self) -> None:
        self.text.flush()

    def close(self) -> None:
        self.text.close()
        self.telemetry.close()
        if self.rows:
            logs.write_csv(logs.read(self.table), self.table)


@contextlib.contextmanager
def unbroken() -> Iterator[None]:
    """^C and the like wait until the reply has come: what is told the board after them must find the line in order."""
    held = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, held)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@dataclass
class Board:
    port: Port
    transcript: Transcript
    key: str = ""
    events: deque[Event] = field(default_factory=deque)

    def __post_init__(self) -> None:
        self.session = Session(self.port, self.transcript, self._aside)  # type: ignore[arg-type]
        if self.key:
            self.session.ask(f"unlock {self.key}")

    def _aside(self, line: str) -> None:
        event = event_of(line) if line.startswith("!") else None
        if event:
            self.events.append(event)

    def ask(self, command: str) -> list[str]:
        """Refused as Session has it; the engineer level, should it have locked itself, is opened again."""
        with unbroken():
            try:
                return self.session.ask(command)
            except Refused as error:
                if not self.key or not str(error).startswith("err LOCKED"):
                    raise
            self.session.ask(f"unlock {self.key}")
            return self.session.ask(command)

    def ask_together(self, commands: list[str]) -> list[str]:
        """The refusals."""
        with unbroken():
            return self.session.ask_together(commands)

    def listen(self, seconds: float) -> None:
        """Takes what comes."""
        end = time.monotonic() + seconds
        with unbroken():
            while (left := end - time.monotonic()) > 0:
                try:
                    self.session.line(left)
                except TimeoutError:
                    return

    def new_events(self) -> list[Event]:
        out = list(self.events)
        self.events.clear()
        return out

    def plant(self, patience_s: float) -> Plant:
        """Returns the announced plant; waits for one that is just greeting."""
        end = time.monotonic() + patience_s
        while True:
            try:
                plant = plant_of(self.ask("commission plant"))
            except Refused as error:
                raise RunFailed(f"this board cannot start up a plant by itself: {error}") from None
            if plant:
                return plant
            if time.monotonic() > end:
                raise RunFailed(f"no plant is connected to the board (plant link {self.state().link}): is it on, "
                                "and wired to the plant link?")
            self.listen(0.2)

    def state(self) -> State:
        return state_of(self.ask("status"))

    def progress(self) -> Progress:
        return progress_of(self.ask("commission"))

    def parameters(self) -> dict[str, str]:
        """Those in use, by name; numbers without their unit."""
        out = {}
        for line in self.ask("list"):
            name, _, value = line.partition(" = ")
            out[name] = value.split()[0] if value.split() else "-"
        return out

    def channels(self) -> int:
        """Number of channels of each kind that can be configured."""
        for line in self.ask("version"):
            match = re.match(r"limits: channels (\d+)", line)
            if match:
                return int(match[1])
        raise RunFailed("the board does not say how many channels it has (`version`)")

    def count(self, group: str, field_name: str) -> int:
        """Number of members of an indexed group of parameters."""
        return sum(re.match(rf"{group}\d+\.{field_name} = ", line) is not None for line in self.ask(f"list {group}"))

    def allowed(self, name: str) -> tuple[float, float]:
        """Range of a number, from `help NAME`."""
        for line in self.ask(f"help {name}"):
            match = re.match(r"\s*allowed: (\S+) \.\. (\S+)", line)
            if match:
                return float(match[1]), float(match[2])
        raise RunFailed(f"the board tells no range of {name}")
