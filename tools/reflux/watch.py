"""tools/console --watch: loops, outputs and alarms in the upper part of the terminal, a line to type in the last row, and replies between."""

from __future__ import annotations

import contextlib
import os
import select
import shutil
import sys
import time
from collections import deque
from typing import TextIO

from reflux import table
from reflux.errors import RunFailed, UserError
from reflux.keys import masked
from reflux.line_editor import LineEditor
from reflux.session import Session
from reflux.terminal import raw
from reflux.watch_completion import CLEARED, PROMPT, Completion
from reflux.watch_state import EVENT, BoardState

DRAWN_S = 0.2
ALARMS_S = 5.0  # between two looks at the alarms, beside those after each event
ROWS_LEFT = 4  # for replies and the typed line, at the least


def check_terminal() -> None:
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise UserError("--watch needs a terminal; --spark and --plot show channels without one")


class Screen:
    """Upper part, scrolling part, last row; by the control sequences that all terminals of today know."""

    def __init__(self, out: TextIO):
        self.out = out
        self.size = (0, 0)
        self.top = 0  # rows of the upper part, its line below included

    def arrange(self, rows: int) -> None:
        """Sets the scrolling part where the terminal or the upper part has changed its size."""
        width, height = shutil.get_terminal_size()
        top = max(0, min(rows + 1, height - ROWS_LEFT))
        if (width, height, top) == (*self.size, self.top):
            return
        if not self.top:
            self.out.write("\n" * height)
        for row in range(1, max(self.top, top) + 1):
            self.out.write(f"\x1b[{row};1H\x1b[K")
        self.size, self.top = (width, height), top
        self.out.write(f"\x1b[{top + 1};{height - 1}r")

    def draw(self, lines: list[str], typed: str) -> None:
        self.arrange(len(lines))
        width, height = self.size
        for row, line in enumerate(lines[:max(0, self.top - 1)], 1):
            self.out.write(f"\x1b[{row};1H\x1b[K{line[:width]}")
        self.out.write(f"\x1b[{self.top};1H\x1b[K{'-' * width}" if self.top else "")
        shown = (PROMPT + typed)[-(width - 1):]
        self.out.write(f"\x1b[{height};1H\x1b[K{shown}")
        self.out.flush()

    def say(self, line: str) -> None:
        """Below what was said before."""
        self.out.write(f"\x1b[{self.size[1] - 1};1H\n{line}")

    def close(self) -> None:
        self.out.write(f"\x1b[r\x1b[{self.size[1]};1H\x1b[K")
        self.out.flush()


class Watch:
    """Replies belong to commands in the order in which they were sent; those that the person has not typed are not shown. The board is in human mode, so
    that events are sentences: it sends prompts, what it was sent, and the code that clears a line, which are left out here."""

    def __init__(self, talk: Session, screen: Screen):
        self.talk, self.screen = talk, screen
        self.state = BoardState()
        self.completion = Completion(talk, self.line, screen.say)
        self.editor = LineEditor(self.complete)
        self.later: list[str] = []  # asked while a line is with the board, which would take it for a part of that line
        self.waiting: deque[str] = deque()  # commands without their reply; of ours with a space before them
        self.reply: list[str] = []
        self.asked = 0.0

    def ask(self, command: str) -> None:
        if self.completion.busy:
            self.later.append(command)
        elif f" {command}" not in self.waiting:
            self.waiting.append(f" {command}")
            self.talk.write(command)

    def line(self, text: str) -> None:
        text = text.rsplit(CLEARED, 1)[-1]
        if text.startswith(PROMPT) or any(text == masked(command.strip()) for command in self.waiting):
            return
        if text.startswith(("H,", "T,")):
            self.state.telemetry(text)
        elif event := EVENT.match(text):
            self.screen.say(event_words(event[1], event[2], event[3]))
            self.ask("alarm")
            if "STARTED" in text:
                self.state.forget()
                self.ask("log on")
            if "CONFIG_APPLIED" in text or "configuration applied" in text:
                self.ask("list")
        elif text == "ok" or text.startswith("err "):
            self.end_reply(text)
        elif self.completion.busy and not self.waiting:
            self.completion.take(text)
        else:
            self.reply.append(text)
            if not (self.waiting and self.waiting[0].startswith(" ")):
                self.screen.say(text)

    def end_reply(self, text: str) -> None:
        command = self.waiting.popleft() if self.waiting else ""
        if command == " list" and text == "ok":
            self.state.configuration(self.reply)
        elif command == " alarm" and text == "ok":
            self.state.alarms = [line for line in self.reply if line and not line.startswith("no ")]
        elif not command.startswith(" "):
            self.screen.say(text)
        self.reply = []

    def complete(self, text: str) -> str:
        found = self.completion.complete(text)
        later, self.later = self.later, []
        for command in later:
            self.ask(command)
        return found

    def typed(self, command: str) -> None:
        self.screen.say(PROMPT + masked(command))
        self.waiting.append(command)
        self.talk.write(command)

    def loop(self) -> None:
        drawn = 0.0
        for command in ("mode human", "log on", "list", "alarm"):
            self.ask(command)
        while not self.editor.left:
            self.screen.arrange(len(self.state.lines(10)))
            ready = select.select([0, self.talk.port.fileno()], [], [], DRAWN_S)[0]
            if 0 in ready:
                data = os.read(0, 1024)
                if not data:
                    return
                for command in self.editor.feed(data):
                    self.typed(command)
                drawn = 0.0
            if self.talk.port.fileno() in ready:
                self.talk.rest += self.talk.port.read()
            while b"\n" in self.talk.rest:
                self.line(self.talk.line(0.0))
            if time.monotonic() - self.asked > ALARMS_S:
                self.asked = time.monotonic()
                self.ask("alarm")
            if time.monotonic() - drawn > DRAWN_S:
                drawn = time.monotonic()
                self.screen.draw(self.state.lines(shutil.get_terminal_size().columns), masked(self.editor.text))


def event_words(time_s: str, level: str, rest: str) -> str:
    """A sentence of the board, or CODE SUBJECT VALUE TEXT of a small one with four significant digits."""
    return f"{float(time_s):.0f} s  {level}  {table.rounded(rest)}"


def run(talk: Session) -> int:
    """Until the person leaves with ^C, ^D or ^]. The board is left in human mode."""
    check_terminal()
    talk.aside = None
    with raw():
        screen = Screen(sys.stdout)
        try:
            Watch(talk, screen).loop()
        finally:
            screen.close()
            with contextlib.suppress(RunFailed):
                talk.write("log off")
    return 0
