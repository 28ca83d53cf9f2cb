"""Talking to a console in machine mode: one command, one reply (docs/use/console.md)."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path
from typing import Callable, TextIO

from reflux.errors import RunFailed
from reflux.keys import masked
from reflux.board_port import BoardPort
from reflux.ports import Port

REPLY_S = 20.0
SETTLED_S = 0.1
ASYNCHRONOUS = ("T,", "H,", "! ")
SENT, RECEIVED = "> ", "< "  # before each line of a log


class Refused(RunFailed):
    """The board answered `err`."""


class Session:
    """Asynchronous lines go to `aside` as they come."""

    def __init__(self, port: Port | BoardPort, log: TextIO | None = None, aside: Callable[[str], None] | None = None,
                 reply_s: float = REPLY_S, now: Callable[[], float] = time.monotonic):
        """now: the clock that waits are measured by, s; a virtual board has its own."""
        self.port, self.log, self.aside, self.reply_s, self.now = port, log, aside, reply_s, now
        self.rest = b""
        self.machine_mode()

    def machine_mode(self) -> None:
        """Asked until answered: what arrives before a receiver is switched on is lost. What was half typed is
        thrown away by ^U."""
        for _ in range(int(max(1.0, self.reply_s))):
            self.write("\x15\nmode machine")
            try:
                while self.line(1.0) != "ok":
                    pass
            except TimeoutError:
                continue
            self.settle()
            return
        raise RunFailed(f"{self.port.name}: no answer to `mode machine` within {self.reply_s:g} s; is it the console?")

    def settle(self) -> None:
        """Replies to earlier attempts may still be on their way; telemetry may go on all the time."""
        quiet_since, streams = self.now(), False
        while (left := quiet_since + SETTLED_S - self.now()) > 0:
            try:
                text = self.line(left)
            except TimeoutError:
                break
            streams = text.startswith(ASYNCHRONOUS)
            if not streams:
                quiet_since = self.now()
        if not streams:
            self.rest = b""

    def write(self, text: str) -> None:
        self._note(SENT, text)
        self.rest += self.port.write(text.encode("latin-1", "replace") + b"\n")

    def line(self, patience_s: float) -> str:
        end = self.now() + patience_s
        while b"\n" not in self.rest:
            left = end - self.now()
            if left <= 0:
                raise TimeoutError
            self.rest += self.port.read(min(left, 0.5))
        line, self.rest = self.rest.split(b"\n", 1)
        text = line.decode("latin-1").strip("\r")
        self._note(RECEIVED, text)
        if text.startswith(ASYNCHRONOUS) and self.aside:
            self.aside(text)
        return text

    def _note(self, sign: str, text: str) -> None:
        if self.log:
            self.log.write(f"{sign}{masked(text) if sign == SENT else text}\n")
            self.log.flush()

    def ask(self, command: str) -> list[str]:
        """Payload of the reply; Refused when it ends in `err`."""
        self.write(command)
        return self.reply(command)

    def ask_together(self, commands: list[str]) -> list[str]:
        """All of them sent before the first reply is read; the refusals among the replies."""
        for command in commands:
            self.write(command)
        refusals = []
        for command in commands:
            try:
                self.reply(command)
            except Refused as error:
                refusals.append(f"`{masked(command)}`: {error}")
        return refusals

    def reply(self, command: str) -> list[str]:
        reply: list[str] = []
        while True:
            try:
                text = self.line(self.reply_s)
            except TimeoutError:
                raise RunFailed(f"{self.port.name}: no reply to `{masked(command)}` within {self.reply_s:g} s") from None
            if text.startswith(ASYNCHRONOUS):
                continue
            if text == "ok":
                return reply
            if text.startswith("err "):
                raise Refused(text)
            reply.append(text)


def commands_in(path: Path, text: str) -> list[tuple[int, str]]:
    """Lines of a command file with their numbers; empty lines and those that begin with # are none."""
    return [(k, line.strip()) for k, line in enumerate(text.splitlines(), 1)
            if line.strip() and not line.strip().startswith("#")]


def abandon(session: Session) -> None:
    """Ends a transaction that the caller began, whatever state the line is in."""
    with contextlib.suppress(RunFailed):
        session.ask("abandon")


def run_file(session: Session, path: Path, text: str, say: Callable[[str], None], keep_going: bool = False) -> int:
    """Sends a file; returns how many commands were refused. Stops at the first unless told to keep going.

    A transaction that the file began and that a refusal, a silent board or ^C leaves open is abandoned. One that somebody else
    has open stays."""
    refused, begun = 0, False
    try:
        for number, command in commands_in(path, text):
            say(f"> {masked(command)}")
            try:
                for line in session.ask(command):
                    say(line)
                say("ok")
                begun = begun and command not in ("apply", "abandon") or command == "begin"
            except Refused as error:
                say(str(error))
                refused += 1
                if not keep_going:
                    raise Refused(f"{path}:{number}: `{masked(command)}`: {error}") from None
    except BaseException:
        if begun:
            abandon(session)
        raise
    if begun and refused:
        say("> abandon")
        abandon(session)
    return refused


def dump(session: Session) -> list[str]:
    """The board's configuration as lines that restore it: its own `dump`, or what differs from the defaults."""
    try:
        return session.ask("dump")
    except Refused as error:
        if not str(error).startswith("err UNKNOWN"):
            raise
    return ["begin", *session.ask("diff defaults"), "apply"]


def differences(wanted: list[str], have: list[str]) -> list[str]:
    """Parameters set otherwise than wanted, by their `set` lines."""
    def settings(lines: list[str]) -> dict[str, str]:
        return dict(line.split(None, 2)[1:3] for line in lines if line.startswith("set ") and line.count(" ") >= 2)

    there = settings(have)
    return [f"{name} is {there.get(name, 'at its default')}, the file says {value}"
            for name, value in settings(wanted).items() if there.get(name) != value]
