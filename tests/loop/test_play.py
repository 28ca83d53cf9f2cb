#!/usr/bin/python3
"""tools/play and tools/console --watch at a pseudo-terminal, as a person uses them."""

import os
import pty
import re
import select
import signal
import sys
import tempfile
import time
import tomllib
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402

from reflux import cmd_play, ending  # noqa: E402
from reflux.errors import UserError  # noqa: E402
from reflux.paths import SCENARIOS  # noqa: E402

TOOL = board.ROOT / "tools" / "play"
CONTROLS = re.compile(rb"\x1b\[[\d;]*[A-Za-z]")


class Terminal:
    """A tool at a terminal of its own."""

    def __init__(self, test: unittest.TestCase, *arguments: str):
        self.test = test
        self.folder = Path(test.enterContext(tempfile.TemporaryDirectory()))
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.environ["TMPDIR"] = str(self.folder)
            os.execv(str(TOOL), [str(TOOL), *arguments, "--no-build", "--speed", "600"])
        self.started: list[tuple[int, str]] = []
        test.addCleanup(os.close, self.terminal)
        test.addCleanup(lambda: ending.end_all([*self.started, *ending.descendants(self.pid)]))

    def until(self, wanted: bytes) -> bytes:
        text, end = b"", time.monotonic() + board.PATIENCE_S
        while not re.search(wanted, CONTROLS.sub(b"", text)) and time.monotonic() < end:
            if select.select([self.terminal], [], [], 0.2)[0]:
                try:
                    text += os.read(self.terminal, 4096)
                except OSError:  # the tool has ended
                    break
        self.test.assertRegex(CONTROLS.sub(b"", text), wanted)
        self.started = ending.descendants(self.pid)
        return text

    def type(self, text: bytes) -> None:
        os.write(self.terminal, text)

    def ended(self) -> int:
        """Exit status; nothing that was started is left, and no file."""
        status, end = None, time.monotonic() + board.PATIENCE_S
        while status is None and time.monotonic() < end:
            if select.select([self.terminal], [], [], 0.05)[0]:
                try:
                    os.read(self.terminal, 4096)
                except OSError:
                    pass
            pid, code = os.waitpid(self.pid, os.WNOHANG)
            status = os.waitstatus_to_exitcode(code) if pid else None
        self.test.assertEqual([pid for pid, began in self.started if (words := ending.stat_of(pid)) and words[19] == began], [])
        self.test.assertEqual(list(self.folder.iterdir()), [])
        self.test.assertGreaterEqual(len(self.started), 2)  # firmware and plant
        return status if status is not None else -1


class Play(unittest.TestCase):
    def test_one_command_leaves_a_person_in_a_column_whose_loops_run_and_control_c_ends_it(self) -> None:
        person = Terminal(self, "pilot")
        self.assertRegex(person.until(rb"Ctrl-C ends it"), rb"Try: status; loop; sp bottom \d+")
        person.type(b"loop\r")
        person.until(rb"(?s)top auto .*bottom auto .*ok")
        person.type(b"loop\r")
        person.until(rb"(?s)top auto .* sp 87\.13 degC.*bottom auto .* sp 106\.3 degC.*ok")  # of the operating point
        person.type(b"sp bottom 108\r")
        person.until(rb"bottom setpoint 108 degC")
        person.type(b"\x03")
        self.assertEqual(person.ended(), 0)

    def test_a_person_types_below_what_is_watched(self) -> None:
        person = Terminal(self, "pilot", "--watch")
        person.until(rb"(?s)plant time .*, run.*loop +mode +PV / SP +output.*top +auto +T1 [\d.]+ / [\d.]+ degC")
        person.type(b"sp bottom 108\r")
        person.until(rb"(?s)bottom setpoint 108 degC.*T10 [\d.]+ / 108 degC")
        person.type(b"sp bo\t109\r")
        person.until(rb"(?s)bottom setpoint 109 degC.*T10 [\d.]+ / 109 degC")
        person.type(b"set T1.\t")
        person.until(rb"(?s)T1\.name  T1\.unit.*> set T1\.")
        person.type(b"\x15set bottom.ga\t\r")
        person.until(rb"> set bottom\.gain")
        person.type(b"\x03")
        self.assertEqual(person.ended(), 0)

    def test_a_signal_ends_it_too(self) -> None:
        person = Terminal(self, "self-tuning-wood-berry", "--manual")
        person.until(rb"Ctrl-C ends it")
        os.kill(person.pid, signal.SIGTERM)
        self.assertEqual(person.ended(), 128 + signal.SIGTERM)


class Benches(unittest.TestCase):
    def test_every_configuration_knows_its_plant(self) -> None:
        for name in cmd_play.names():
            with self.subTest(name):
                bench = cmd_play.bench_of(name, None)
                self.assertIn("apply", bench.lines)
                plants = {tomllib.loads(path.read_text())["plant"] for path in SCENARIOS.glob("*.toml")}
                self.assertIn(bench.plant, plants | {str(SCENARIOS / plant) for plant in plants})
        self.assertEqual(cmd_play.bench_of("pilot", None).plant, "pilot")
        self.assertEqual(cmd_play.bench_of("splitter", None).plant, "splitter")

    def test_an_unknown_name_is_refused_with_those_that_are_known(self) -> None:
        with self.assertRaisesRegex(UserError, 'there is no configuration "pilto"; known are .*pilot, '):
            cmd_play.bench_of("pilto", None)
        for name, words in (("pilto", '; did you mean "pilot"'), ("none.conf", "none.conf: no such file; --plant PLANT goes with"),
                            ("wood-berry", "it is a plant; `tools/commission --plant wood-berry` writes a board.conf"),
                            ("pilot.toml", "is a scenario, which tools/run plays"), ("./mine.json", "is a plant, which goes behind --plant")):
            with self.subTest(name), self.assertRaises(UserError) as refused:
                cmd_play.bench_of(name, None)
            self.assertIn(words, str(refused.exception))

    def test_what_does_not_fit_the_plant_is_said_with_what_would(self) -> None:
        for name in cmd_play.names():
            with self.subTest(name):
                bench = cmd_play.bench_of(name, None)
                if "--measure" not in bench.options:  # which adds channels
                    self.assertEqual(cmd_play.misfits(bench), [])
        lines = ("set meas1.name xD", "set meas1.unit kg", "set meas2.name T9", "set meas2.unit degC", "set mv1.name R", "set mv1.unit l/h", "set mv2.name S", "set mv2.unit lb/min")
        self.assertEqual(cmd_play.misfits(cmd_play.Bench("wood-berry", (), lines)),
                         ["meas1.unit kg: the plant has xD in %w: `set meas1.unit %w`",
                          "meas2.name T9: the plant has no output of that name; it has xD (%w), xB (%w)",
                          "mv1.unit l/h: the plant has R in lb/min: `set mv1.unit lb/min`"])


if __name__ == "__main__":
    unittest.main()
