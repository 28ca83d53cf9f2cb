"""A board whose pins are checked: its newest readings with what is wrong with them, moves of its outputs, and the way back to where it was."""

from __future__ import annotations

import contextlib
import re
import time
from typing import TextIO

from reflux.board_port import BoardPort
from reflux.errors import RunFailed
from reflux.io_wiring import Channel, Output
from reflux.logs import bare
from reflux.ports import Port
from reflux.session import Refused, Session

TURN_S = 0.1
SILENT_TICKS, SILENT_S = 3, 5.0  # no telemetry for so many ticks and so long: no samples come
SLOWEST_S = 2.5  # settings may just have come: each sensor, a DS18B20 too, has been read by then, and says why where it could not be
WIDE = 1e9  # believes whatever a sensor says
QUALITIES = ("good", "uncertain", "bad", "missing")
EVENT = re.compile(r"\s*(?:! )?[\d.]+ \w+ (SENSOR_FAULT|SENSOR_FINE|MEASUREMENT_BAD|MEASUREMENT_GOOD) (\S+) \S+ [^:]*(?:: (.*))?$")


class CheckedBoard:
    """What it was asked to change it changes back in restore()."""

    def __init__(self, port: Port | BoardPort, log: TextIO | None) -> None:
        self.reasons: dict[str, str] = {}  # of measurements that are not usable
        self.faults: dict[str, str] = {}  # of sensors, in the board's words
        self.row: dict[str, float] = {}  # the newest telemetry
        self.rows = 0
        self._columns: list[str] = []
        self._moved: dict[str, Output] = {}
        self._widened: list[Channel] = []
        self.talk = Session(port, log, self._take, now=port.now if isinstance(port, BoardPort) else time.monotonic)
        self.now = self.talk.now
        self.tick_s = 1.0

    def begin(self) -> None:
        """Telemetry comes from here on. RunFailed: the board takes no samples."""
        for line in self.talk.ask("events"):
            if not line.lstrip().startswith("boot"):  # an earlier start
                self._take(line)
        self.reasons = {line.split()[1]: line.split(None, 2)[2] for line in self.talk.ask("alarm") if line.startswith("MEASUREMENT_BAD ")}
        found = re.search(r"base tick ([\d.]+) s", self.talk.ask("status")[0])
        self.tick_s = float(found[1]) if found and float(found[1]) > 0 else 1.0
        self.talk.ask("log on")
        end = self.now() + SLOWEST_S
        while self.now() < end:
            self.samples(1)

    def turn(self) -> None:
        """Takes what comes within a moment."""
        with contextlib.suppress(TimeoutError):
            self.talk.line(TURN_S)

    def samples(self, n: int) -> list[dict[str, float]]:
        """So many new rows of telemetry."""
        rows: list[dict[str, float]] = []
        heard, before = self.now(), self.rows
        while len(rows) < n:
            self.turn()
            if self.rows != before:
                rows.append(self.row)
                heard, before = self.now(), self.rows
            elif self.now() - heard > SILENT_TICKS * self.tick_s + SILENT_S:
                raise RunFailed("the board takes no samples: `status` at the console says why")
        return rows

    def value(self, name: str) -> float:
        return self.row.get(name, float("nan"))

    def usable(self, name: str) -> bool:
        """Whether the sensor is read and believed."""
        return name not in self.reasons and name not in self.faults and self.row.get(f"{name}.q", 3.0) < 2.0

    def words(self, c: Channel) -> str:
        """Value, quality, and the reason of what is not good."""
        if self.usable(c.name):
            return f"{self.value(c.name):.5g} {c.unit}".rstrip()
        reason = self.faults.get(c.name) or self.reasons.get(c.name) or "no reading yet"
        return f"{QUALITIES[int(self.row.get(f'{c.name}.q', 3.0))]}: {reason}"

    def _take(self, line: str) -> None:
        cells = line.split(",")
        if line.startswith("H,"):
            self._columns = [bare(cell) for cell in cells[2:]]
        elif line.startswith("T,") and len(cells) == len(self._columns) + 2:
            with contextlib.suppress(ValueError):
                self.row = {name: float(cell or "nan") for name, cell in zip(self._columns, cells[2:])}
                self.rows += 1
        elif (event := EVENT.match(line)) is not None:
            kept = self.faults if event[1].startswith("SENSOR") else self.reasons
            if event[1] in ("SENSOR_FAULT", "MEASUREMENT_BAD"):
                kept[event[2]] = event[3] or "no reason given"
            else:
                kept.pop(event[2], None)

    # ---- changes ----

    def transaction(self, lines: list[str]) -> None:
        """All of these settings or none. Refused: the board's words."""
        self.talk.ask("begin")
        try:
            for line in [*lines, "apply"]:
                self.talk.ask(line)
        except BaseException:
            with contextlib.suppress(RunFailed):
                self.talk.ask("abandon")
            raise
        self.samples(2)  # in force with the next one

    def widen(self, channels: list[Channel]) -> None:
        """Believes every reading of these until restore()."""
        self._widened += channels
        self.transaction([f"set {c.meas}.valid_{end} {sign}{WIDE:g}" for c in channels for end, sign in (("lo", "-"), ("hi", ""))])

    def narrow(self) -> None:
        """The limits of belief are again what they were."""
        if self._widened:
            self.transaction([f"set {c.meas}.valid_{end} {value:.9g}" for c in self._widened for end, value in (("lo", c.valid_lo), ("hi", c.valid_hi))])
        self._widened = []

    def move(self, output: Output, value: float) -> None:
        """Until park(). Refused: the board's words."""
        self._moved[output.name] = output
        self.talk.ask(f"out {output.name} {value:.9g}")
        self.samples(2)

    def park(self, output: Output) -> None:
        """Back to its safe value, seen by what the board applies. RunFailed: it is elsewhere."""
        self.talk.ask(f"out {output.name} {output.safe:.9g}")
        close = 1e-4 * max(abs(output.most - output.least), abs(output.safe))
        for row in self.samples(1) + self.samples(3):
            applied = row[f"{output.name}.app"]
            if abs(applied - output.safe) <= close:
                self._moved.pop(output.name, None)
                return
        raise RunFailed(f"{output.name} is at {applied:g} {output.unit} and not at its safe value {output.safe:g}: switch its supply off")

    def restore(self) -> None:
        """Outputs that were moved first, then settings. RunFailed: what could not be brought back."""
        lost = []
        with contextlib.suppress(RunFailed):
            self.talk.machine_mode()  # whatever was under way
        for output in list(self._moved.values()):
            try:
                self.park(output)
            except RunFailed as error:
                lost.append(f"{output.name} may not be at its safe value {output.safe:g}: switch its supply off ({error})")
        if self._widened:
            try:
                self.narrow()
            except RunFailed as error:
                lost.append(f"limits of belief of {', '.join(c.name for c in self._widened)} are still wide ({error})")
        with contextlib.suppress(RunFailed):
            self.talk.ask("log off")
        with contextlib.suppress(RunFailed):
            self.talk.write("mode human")
        if lost:
            raise RunFailed("; ".join(lost))

    def automatic_loops(self) -> list[str]:
        """Loops that may move an output by themselves."""
        return [words[0] for words in (line.split() for line in self.talk.ask("loop")) if len(words) > 1 and words[1] in ("auto", "cascade")]

    def save(self) -> str:
        """Empty, or the board's refusal."""
        try:
            self.talk.ask("save")
        except Refused as error:
            return str(error)
        return ""
