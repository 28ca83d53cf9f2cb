"""Reads what somebody types: lines in answer to questions, and while the plant is tested single keys (a terminal) or lines
(anything else), without keeping the board waiting."""

from __future__ import annotations

import contextlib
import os
import select
import sys
import termios
import tty
from collections import deque
from typing import Iterator

from reflux.commission.board import Board
from reflux.errors import UserError

KEYS = {"p": "pause", "r": "resume", "s": "skip", "b": "repeat", "a": "abort"}


class Ended(UserError):
    """There is nobody left to answer."""


class Keyboard:
    def __init__(self, board: Board, listens: bool = True, fd: int = 0):
        self.board, self.fd = board, fd
        self.terminal = os.isatty(fd)
        self.open = self.terminal or listens
        self.rest = b""
        self.lines: deque[str] = deque()

    def legend(self, words: tuple[str, ...]) -> str:
        told = {"skip": "skip this input", "repeat": "repeat the one before"}
        if self.terminal:
            return "keys: " + ", ".join(f"{k} {told.get(w, w)}" for k, w in KEYS.items() if w in words)
        return "lines: " + ", ".join(words)

    def ask(self, prompt: str) -> str:
        """The next line. What the board says meanwhile is taken."""
        sys.stdout.write(prompt)
        sys.stdout.flush()
        while not self.lines:
            if not self.open:
                print(flush=True)
                raise Ended("input ended at a question; --yes takes all defaults, --file reads answers")
            for ready in select.select([self.fd, self.board.port.fileno()], [], [])[0]:
                if ready == self.fd:
                    self._read()
                else:
                    self.board.listen(0.01)
        line = self.lines.popleft().strip()
        if not self.terminal:
            print(line, flush=True)
        return line

    def command(self) -> str | None:
        """Without waiting: what is to be done with the test under way. Other lines stay for the next question."""
        if self.terminal:
            typed = os.read(self.fd, 256).decode("latin-1") if select.select([self.fd], [], [], 0)[0] else ""
            return next((KEYS[c] for c in typed.lower() if c in KEYS), None)
        if self.open and not self.lines and select.select([self.fd], [], [], 0)[0]:
            self._read()
        if self.lines and self.lines[0].strip() in KEYS.values():
            return self.lines.popleft().strip()
        return None

    def _read(self) -> None:
        data = os.read(self.fd, 4096)
        self.open = bool(data)
        *whole, self.rest = (self.rest + data).split(b"\n")
        if not data and self.rest:
            whole, self.rest = [self.rest], b""
        self.lines.extend(line.decode("utf-8", "replace") for line in whole)

    @contextlib.contextmanager
    def keys(self) -> Iterator[None]:
        """Single keys, where there is a terminal; ^C stays what it is."""
        if not self.terminal:
            yield
            return
        before = termios.tcgetattr(self.fd)
        tty.setcbreak(self.fd)
        try:
            yield
        finally:
            termios.tcsetattr(self.fd, termios.TCSADRAIN, before)
