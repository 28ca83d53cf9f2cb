"""A board on a serial port, as reflux.Lab drives it: its console in machine mode, its telemetry as the log. Time is the board's."""

from __future__ import annotations

import os
import re
import time
from contextlib import suppress

from reflux import logs
from reflux.errors import RunFailed
from reflux.ports import Port
from reflux.session import Refused, Session

AT_ONCE_S = 0.001
FIRST_ROW_S = 5.0


class OnPort:
    """The console of a board."""

    def __init__(self, port: str):
        self._port = Port(port)
        self._header = ""
        self._lines: list[str] = []
        self._last: dict[str, str] = {}
        self._process = os.getpid()
        self._waited = False  # for the first row
        self._reply_due = False  # a command was interrupted, and its reply may still come
        try:
            self._session = Session(self._port, aside=self._aside)
            self._session.ask("log on 1")
        except BaseException:
            self._port.close()
            raise

    def _aside(self, line: str) -> None:
        if line.startswith("H,"):
            self._header = line
        if line.startswith(("H,", "T,")):
            self._lines.append(line)
        if line.startswith("T,") and self._header:
            names = [logs.bare(name) for name in self._header.split(",")[2:]]
            self._last = dict(zip(names, line.split(",")[2:]))

    def _own(self) -> None:
        if os.getpid() != self._process:
            raise RunFailed("the port belongs to another process, which opened this lab")

    def say(self, text: str) -> list[str]:
        self._own()
        if self._reply_due:
            self._session.machine_mode()
        self._reply_due = True
        try:
            reply = self._session.ask(text)
        except Refused:
            self._reply_due = False
            raise
        self._reply_due = False
        return reply

    def listen(self, seconds: float) -> None:
        """Takes what the board says for so long by this computer's clock."""
        self._own()
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            with suppress(TimeoutError):
                self._session.line(left)

    def listen_rows(self, rows: int, patience_s: float) -> None:
        """Until so many rows of telemetry have come; TimeoutError where the next one takes longer than patience_s."""
        self._own()
        while rows > 0:
            rows -= self._session.line(patience_s).startswith("T,")

    def log(self) -> logs.Log | None:
        lines, self._lines = self._lines, []
        if not any(line.startswith("T,") for line in lines):
            return None
        before = [self._header] if self._header and not lines[0].startswith("H,") else []
        return logs.telemetry_in([*before, *lines], "the board's telemetry", damaged=True)

    def _take_in(self) -> None:
        """What has come meanwhile, without a wait; telemetry of a fast board ends this after a while, too."""
        self._own()
        with suppress(TimeoutError):
            for _ in range(1000):
                self._session.line(AT_ONCE_S)

    def _first_row(self) -> None:
        """Waits, once, for the row that comes with the next sample, where the board has a plant: a tick, and as long as a slow line takes."""
        if self._last or self._waited:
            return
        state = re.match(r"state \w+, plant (?:at|link (\w+)).* base tick ([\d.e+-]+) s", " ".join(self.say("status")))
        if not state or state[1] not in (None, "ready"):  # None: it is at the board's pins
            return
        self._waited = True
        end = time.monotonic() + logs.number(state[2]) + FIRST_ROW_S
        with suppress(TimeoutError):
            while not self._last and (left := end - time.monotonic()) > 0:
                self._session.line(left)

    def value(self, name: str) -> float:
        self._take_in()
        self._first_row()
        for known in (name, f"{name}.app", f"{name}.cmd"):
            if known in self._last:
                return logs.number(self._last[known])
        return float("nan")

    @property
    def names(self) -> list[str]:
        """Columns of telemetry that have come."""
        self._take_in()
        self._first_row()
        return list(self._last)

    @property
    def time_s(self) -> float:
        return self.value("time")

    def close(self) -> None:
        """In a child of fork nothing: the port and its lock are the parent's."""
        if os.getpid() != self._process:
            return
        with suppress(Exception):
            self.say("log off")
        self._port.close()
