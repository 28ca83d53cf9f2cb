"""Every block of docs/start/tutorial.md, from top to bottom and as printed, but the commands that commands.toml names with a reason.

A fenced block is saved under the name that the sentence above it gives. An indented block is run: a shell command in the root of the
repository, a line behind `> ` at the console that tools/play has opened. What stands below a line behind `> ` or `$ ` must be the answer,
numbers of the console's replies left out.
"""

import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import sys
import termios
import time
import unittest
from dataclasses import dataclass
from pathlib import Path

import test_commands
from pages import CONSOLE, Command, Page, read
from support import ROOT

from reflux import ending

TUTORIAL = ROOT / "docs" / "start" / "tutorial.md"
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)
NAME = re.compile(r"[Ss]ave (?:this|it) as `([^`]+)`:\n\n$")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
SAID = re.compile(rb"\x1b\[\d+;1H\r?\n([^\x1b]*)")  # a line that scrolls below the part that is watched
PLAY = "tools/play"
TICK_S = 0.6  # of the column that tools/play runs at 60 times real time, and a little more
PATIENCE_S = 120.0


@dataclass
class File:
    """A fenced block and the name it is saved under."""

    number: int
    language: str
    name: str
    text: str


def page() -> Page:
    """The tutorial's commands."""
    return read(TUTORIAL)


def files() -> list[File]:
    """The tutorial's fenced blocks."""
    text = TUTORIAL.read_text(encoding="utf-8")
    out = []
    for found in FENCE.finditer(text):
        name = NAME.search(text[:found.start()])
        out.append(File(text.count("\n", 0, found.start()) + 1, found[1], name[1] if name else "", found[2]))
    return out


class Person:
    """tools/play at a terminal, and somebody who types one line after the other."""

    def __init__(self, test: unittest.TestCase, line: str, environment: dict[str, str]):
        self.test = test
        self.raw = b""
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.chdir(ROOT)
            words = line.split()
            os.execvpe(words[0], words, environment)
        fcntl.ioctl(self.terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 120, 0, 0))
        self.started: list[tuple[int, str]] = []
        test.addCleanup(os.close, self.terminal)
        test.addCleanup(lambda: ending.end_all([*self.started, *ending.descendants(self.pid)]))
        self.until(lambda: b"plant time" in self.raw)
        self.started = ending.descendants(self.pid)

    def until(self, met) -> None:
        """Reads until the condition is met."""
        end = time.monotonic() + PATIENCE_S
        while not met():
            self.test.assertLess(time.monotonic(), end, self.raw[-2000:])
            if select.select([self.terminal], [], [], 0.2)[0]:
                try:
                    self.raw += os.read(self.terminal, 65536)
                except OSError:
                    self.test.fail(f"it has ended: {self.raw[-2000:]!r}")

    def reply(self, typed: str) -> list[str]:
        """What the board answers to the line that was typed last."""
        said = [line.decode(errors="replace").strip() for line in SAID.findall(self.raw)]
        return [x for x in said[said.index(f"{CONSOLE}{typed}") + 1:] if not re.match(r"\d+ s  ", x)] if f"{CONSOLE}{typed}" in said else []

    def ask(self, line: str) -> list[str]:
        """The reply to a line, once the plant has taken the line before."""
        time.sleep(2 * TICK_S)
        self.raw = b""
        os.write(self.terminal, line.encode() + b"\r")
        self.until(lambda: (said := self.reply(line)) and (said[-1] == "ok" or said[-1].startswith("err ")))
        return self.reply(line)

    def leave(self) -> int:
        """Ctrl-C; its exit status."""
        os.write(self.terminal, b"\x03")
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            if select.select([self.terminal], [], [], 0.05)[0]:
                try:
                    os.read(self.terminal, 65536)
                except OSError:  # its end of the terminal is closed
                    pass
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                return os.waitstatus_to_exitcode(status)
        return -1


class Tutorial(test_commands.Commands):
    """One reader, from top to bottom."""

    def __init__(self, method: str):
        super().__init__(method, page())

    # What stands for exempt commands, and that each row has its line, is tested as for every page. These two tests go by another page's board.
    test_every_other_shell_command_runs_and_prints_what_the_page_says = None
    test_the_console_answers_what_the_page_says = None

    def setUp(self) -> None:
        super().setUp()
        (self.folder / "out").mkdir()
        self.person: Person | None = None

    def test_every_block_runs_as_printed_in_its_order(self) -> None:
        blocks: list[Command | File] = sorted([*self.page.commands, *files()], key=lambda block: block.number)
        for block in blocks:
            if isinstance(block, File):
                self.saved(block)
            elif block.console:
                self.typed(block)
            else:
                self.run_command(block)
        self.left()
        kinds = [block.language for block in blocks if isinstance(block, File)]
        self.assertEqual((kinds.count("json"), kinds.count("toml"), kinds.count("python")), (2, 2, 2))
        self.assertGreaterEqual(sum(isinstance(block, Command) and block.console for block in blocks), 8)
        self.results()

    def saved(self, block: File) -> None:
        self.assertTrue(block.name.startswith("out/"), f"line {block.number}: the sentence above the block names no file of out/")
        (self.folder / block.name).write_text(self.moved(block.text), encoding="utf-8")

    def typed(self, command: Command) -> None:
        with self.subTest(command.place()):
            self.assertIsNotNone(self.person, "tools/play comes first")
            expected = [x for x in command.printed or [] if x]
            said = self.person.ask(command.line.removeprefix(CONSOLE))
            end = time.monotonic() + PATIENCE_S
            while not expected and said[-1].startswith("err STATE") and time.monotonic() < end:  # the plant has not yet taken the mode
                said = self.person.ask(command.line.removeprefix(CONSOLE))
            if expected:
                self.assertEqual([NUMBER.sub("#", x) for x in said], [NUMBER.sub("#", x) for x in expected])
            else:
                self.assertEqual(said[-1], "ok")

    def run_command(self, command: Command) -> None:
        self.left()
        if command.line in self.exempt:
            return
        with self.subTest(command.place()):
            if command.line.startswith(PLAY):
                self.person = Person(self, command.line, self.environment)
                return
            answer = self.shell(command.line)
            self.assertEqual(answer.returncode, 0, answer.stdout[-2000:] + answer.stderr[-2000:])
            if command.printed is not None:
                self.assertEqual(self.as_printed(answer.stdout), [x for x in command.printed if x])

    def left(self) -> None:
        """The next step begins at the shell."""
        if self.person:
            self.assertEqual(self.person.leave(), 0)
            self.person = None

    def results(self) -> None:
        """What the page says comes of its commands."""
        out = self.folder / "out"
        reports = {name: (out / name / "report.html").read_text(encoding="utf-8") for name in ("commission-mine", "spirit", "broken")}
        for name, text in reports.items():
            self.assertTrue("<figure" in text, name)
        table = TUTORIAL.read_text(encoding="utf-8").split("| part | what to look for |\n|---|---|\n")[1].split("\n\n")[0]
        for row in table.splitlines():
            self.assertTrue(f"<h2>{row.split(' | ')[0].removeprefix('| ')}</h2>" in reports["commission-mine"], row)
        self.assertTrue("<h2>What happened</h2>" in reports["broken"])
        said = (out / "broken" / "transcript.txt").read_text(encoding="utf-8")
        codes = [found for found in re.findall(r"^[\d.]+ < ! [\d.]+ \w+ (\w+) ", said, re.M)]
        story = ["MEASUREMENT_BAD", "INTERLOCK_ON", "INTERLOCK_OFF", "NOT_FOLLOWING", "FOLLOWING", "NOT_FOLLOWING", "FOLLOWING"]
        self.assertEqual([code for code in codes if code in story[1:]], story[1:])
        self.assertLess(codes.index(story[0]), codes.index(story[1]))
        for picture in ("mypi.png", "gains.png"):
            self.assertTrue((out / picture).read_bytes().startswith(b"\x89PNG"), picture)


if __name__ == "__main__":
    unittest.main()
