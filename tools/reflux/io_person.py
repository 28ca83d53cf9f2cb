"""Questions to a person while a board goes on: its events and readings are taken meanwhile, and each question can have a time limit."""

from __future__ import annotations

import os
import select
import sys
from typing import Callable

from reflux.errors import RunFailed, UserError

YES, NO = ("y", "yes"), ("n", "no")


PINS_S = 3.0  # after a line for the virtual board the next one waits so long, so that answers of a file do not overtake what they cause


class Person:
    """Lines of standard input. turn: lets the board go on for a moment; now: its clock, s; set_pins: takes lines that begin with "pins." where the
    board is a virtual one."""

    def __init__(self, turn: Callable[[], None], now: Callable[[], float], set_pins: Callable[[str], None] | None, source: int | None = None) -> None:
        self.turn, self.now, self.set_pins = turn, now, set_pins
        self._source = sys.stdin.fileno() if source is None else source
        self._typed = b""
        self._ended = False
        self._wait_until = 0.0

    def ask(self, question: str, limit_s: float | None = None) -> str | None:
        """The answer without blanks around it; None when the time is over. RunFailed: there are no more answers."""
        self._say(question)
        end = None if limit_s is None else self.now() + limit_s
        while (answer := self._line()) is None:
            if self._ended and b"\n" not in self._typed:
                raise RunFailed("the answers have ended before the check has")
            if end is not None and self.now() >= end:
                print()
                return None
            self.turn()
        return answer

    def agrees(self, question: str, limit_s: float | None = None) -> bool | None:
        """Yes or no; None when the time is over."""
        end = None if limit_s is None else self.now() + limit_s
        while True:
            answer = self.ask(f"{question} [y/n] ", None if end is None else max(0.0, end - self.now()))
            if answer is None or answer.casefold() in (*YES, *NO):
                return None if answer is None else answer.casefold() in YES
            print("please type y or n")

    def watch(self, what: str, happened: Callable[[], bool], limit_s: float) -> bool | None:
        """Waits until it has happened: True; False: not within this time; None: Enter was typed."""
        self._say(what)
        end = self.now() + limit_s
        while not happened():
            if self._line() is not None:
                return None
            if self.now() >= end:
                print()
                return False
            self.turn()
        return True

    @staticmethod
    def _say(text: str) -> None:
        print(text, end="" if text.endswith(" ") else "\n", flush=True)

    def _line(self) -> str | None:
        """A line that was typed and is no line for the virtual board."""
        while self.now() >= self._wait_until:
            while not self._ended and b"\n" not in self._typed and select.select([self._source], [], [], 0)[0]:
                more = os.read(self._source, 4096)
                self._ended = not more
                self._typed += more or (b"\n" if self._typed else b"")  # the last line may have no end
            if b"\n" not in self._typed:
                return None
            line, self._typed = self._typed.split(b"\n", 1)
            text = line.decode("utf-8", "replace").strip()
            if not text.startswith("pins."):
                return text
            self._pins(text)
            self._wait_until = self.now() + PINS_S
        return None

    def _pins(self, text: str) -> None:
        try:
            if self.set_pins is None:
                raise UserError("only the pins of a virtual board can be set from here")
            self.set_pins(text)
        except UserError as error:
            print(error)
