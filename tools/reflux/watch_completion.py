"""The tab key of tools/console --watch: the board completes the line, as it does for a person on a plain terminal. The line is typed there for a moment and
then taken back."""

from __future__ import annotations

import time
from typing import Callable

from reflux.keys import masked
from reflux.session import Session

PROMPT = "> "
CLEARED = "\x1b[K"
PATIENCE_S = 1.0
QUIET_S = 0.1  # the line has not changed for so long
TAKE_BACK = b"\x15"  # ^U


class Completion:
    def __init__(self, talk: Session, line: Callable[[str], None], say: Callable[[str], None]):
        """line: takes what comes meanwhile and is none of the choices."""
        self.talk, self.line, self.say = talk, line, say
        self.busy = False
        self.choices: list[str] = []
        self.sent = ""

    def take(self, text: str) -> None:
        """A line of choices; or the echo of what was typed, which has no prompt where a line was taken back before."""
        if text.strip() and text != self.sent:
            self.choices.append(text)

    def complete(self, text: str) -> str:
        if masked(text) != text or not text.strip():
            return text
        found = self._by_board(text)
        for choice in self.choices:
            self.say(choice)
        return found

    def _by_board(self, text: str) -> str:
        """The line as the board has completed it; as it is where the board does not answer. self.choices: those that it shows."""
        self.choices, self.sent, self.busy = [], text, True
        try:
            self.talk.rest += self.talk.port.write(text.encode("latin-1", "replace") + b"\t")
            seen, since, end = "", time.monotonic(), time.monotonic() + PATIENCE_S
            while (now := time.monotonic()) < end:
                self._take_in(QUIET_S)
                typed = self.talk.rest.decode("latin-1").rsplit(CLEARED, 1)[-1].removeprefix(PROMPT)
                if typed != seen:
                    seen, since = typed, now
                elif typed.startswith(text) and now - since >= QUIET_S:
                    return typed
            return text
        finally:
            self.talk.rest += self.talk.port.write(TAKE_BACK)
            self.busy = False

    def _take_in(self, patience_s: float) -> None:
        self.talk.rest += self.talk.port.read(patience_s)
        while b"\n" in self.talk.rest:
            self.line(self.talk.line(0.0))
