#!/usr/bin/python3
"""tools/console against the firmware as a host process, over its sockets and over a pseudo-terminal."""

import os
import pty
import re
import select
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402

from reflux import build, live, session  # noqa: E402
from reflux.errors import UserError  # noqa: E402
from reflux.ports import Port  # noqa: E402

TOOL = board.ROOT / "tools" / "console"
CONFIGURATION = board.ROOT / "host_sim" / "scenarios" / "pilot.conf"


class ConsoleTool(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.firmware = self.enterContext(board.start("host"))

    def tool(self, *arguments: str, text: str = "", expect: int = 0) -> str:
        answer = subprocess.run([str(TOOL), self.firmware.console, *arguments], input=text, text=True,
                                capture_output=True, timeout=board.PATIENCE_S, check=False,
                                env={k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")})
        self.assertEqual(answer.returncode, expect, answer.stdout + answer.stderr)
        return answer.stdout if expect == 0 else answer.stderr

    def process(self, *arguments: str, text: str = "") -> subprocess.CompletedProcess[str]:
        return subprocess.run([str(TOOL), self.firmware.console, *arguments], input=text, text=True, capture_output=True,
                              timeout=board.PATIENCE_S, check=False)

    def plant(self) -> None:
        plant = subprocess.Popen(board.simulator(self.firmware, "--plant", "pilot", "--speed", "300", "--duration",
                                                 "1e6"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(plant.wait)
        self.addCleanup(plant.kill)

    def file(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.write_text(text)
        return path

    def test_command_files_dump_and_restore(self) -> None:
        self.plant()
        log = self.folder / "session.log"
        self.tool("--run", str(CONFIGURATION), "--log", str(log))
        self.assertIn("> apply\n< ok\n", log.read_text())
        saved = self.folder / "saved.conf"
        count = int(re.search(r"(\d+) parameters", self.tool("--dump", str(saved)))[1])
        self.assertGreater(count, 20)
        self.tool("--run", str(self.file("change", "set loop1.gain 0.5\n# a comment\n\n")))
        self.assertIn(f"{count} parameters restored and compared", self.tool("--restore", str(saved)))
        again = self.folder / "again.conf"
        self.tool("--dump", str(again))
        self.assertEqual(again.read_text().splitlines()[1:], saved.read_text().splitlines()[1:])

    def test_a_locked_board_wants_the_key(self) -> None:
        self.tool("--run", str(self.file("lock", "key secret\nlock\n")))
        saved = self.folder / "saved.conf"
        self.tool("--dump", str(saved))
        self.assertNotIn("secret", saved.read_text())
        self.assertIn("err LOCKED", self.tool("--restore", str(saved), expect=1))
        self.assertIn("restored and compared", self.tool("--key", "secret", "--restore", str(saved)))

    def test_a_key_from_a_file_or_standard_input_is_in_no_log_and_one_from_the_command_line_is_warned_of(self) -> None:
        log = self.folder / "log"
        lock = self.file("lock", "key secret\nset console.key secret\nlock\nunlock secret\nlock\n")
        self.tool("--run", str(lock), "--log", str(log))
        change = self.file("change", "set loop1.gain 2\n")
        for option, text in (("-", "secret\n"), (f"@{self.file('key', 'secret' + chr(10))}", ""), ("secret", "")):
            out = self.process("--key", option, "--run", str(change), "--log", str(log), text=text)
            self.assertEqual(out.returncode, 0, out.stderr)
            self.assertEqual("warning: other users can see a key" in out.stderr, option == "secret", out.stderr)
            self.tool("--run", str(self.file("again", "lock\n")))
        self.assertNotIn("secret", log.read_text())
        self.assertIn("> unlock ***\n", log.read_text())
        wrong = self.file("wrong", "unlock b@dsecret\n")
        self.assertNotIn("b@dsecret", self.tool("--run", str(wrong), "--log", str(log), expect=1) + log.read_text())
        self.assertIn("--key goes with", self.tool("--key", "@/nowhere", text="version\n", expect=2))

    def test_a_transaction_that_a_refused_file_began_is_abandoned(self) -> None:
        """Rebuilt from a public report: the mended file failed at its first line."""
        bad = self.file("bad", "begin\nset loop1.gain 2\nset loop1.gain -7\napply\n")
        good = self.file("good", "begin\nset loop1.gain 3\napply\n")
        self.assertIn("bad:3", self.tool("--run", str(bad), expect=1))
        self.tool("--run", str(good))
        unfit = self.file("unfit", "begin\nset loop1.lo 10\nset loop1.hi 0\napply\nversion\n")
        self.assertEqual(self.process("--run", str(unfit), "--keep-going").returncode, 1)
        self.tool("--run", str(good))

    def test_a_transaction_that_is_not_of_the_file_stays_open(self) -> None:
        self.tool("--run", str(self.file("open", "begin\nset loop1.gain 2\n")))
        bad = self.file("bad", "begin\nset loop1.gain 3\n")
        self.assertIn("bad:1", self.tool("--run", str(bad), expect=1))
        self.assertIn("bad:1", self.tool("--restore", str(bad), expect=1))
        self.tool("--run", str(self.file("go-on", "apply\n")))

    def test_a_refused_line_stops_and_names_itself(self) -> None:
        path = self.file("bad", "version\nset loop1.gain -7\nversion\n")
        self.assertRegex(self.tool("--run", str(path), expect=1),
                         r"bad:2: `set loop1.gain -7`: err RANGE .*\n$")
        going_on = subprocess.run([str(TOOL), self.firmware.console, "--run", str(path), "--keep-going"], text=True,
                                  capture_output=True, check=False)
        self.assertEqual((going_on.returncode, going_on.stdout.count("> version")), (1, 2))
        broken = self.file("broken", "begin\nset loop1.gain 2\nset loop1.gain x\napply\n")
        self.assertIn("broken:3", self.tool("--restore", str(broken), expect=1))
        self.assertIn("begin", self.tool("--run", str(self.file("open", "begin\nabandon\n"))))  # none was left open

    def watched(self, *arguments: str) -> str:
        """Two seconds of telemetry, or as many as a busy machine needs for a row."""
        for seconds in ("2", "20"):
            out = subprocess.run([str(TOOL), self.firmware.console, *arguments, "--seconds", seconds], text=True,
                                 capture_output=True, timeout=board.PATIENCE_S, check=False)
            if "no telemetry came" not in out.stderr:
                break
        return self.tool(*arguments, "--seconds", "200") if out.returncode != 0 else out.stdout

    def test_watching_channels(self) -> None:
        self.plant()
        self.tool("--run", str(CONFIGURATION))
        lines = self.watched("--spark", "T1,T10").splitlines()
        self.assertRegex(lines[0], r"^T1 +[\d.]+ degC +[▁▂▃▄▅▆▇█]+$")
        picture = self.folder / "live.png"
        out = self.watched("--plot", "T1,T10", "--png", str(picture), "--every", "0.5")
        self.assertRegex(out, r"\d+ rows")
        self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertIn("no channel T99; there are ", self.tool("--spark", "T99", "--seconds", "2", expect=2))

    def test_lines_from_standard_input_go_through(self) -> None:
        log = self.folder / "log"
        self.assertIn("reflux", self.tool("--log", str(log), text="version\n"))
        self.assertIn("reflux", log.read_text())

    def test_a_person_at_a_terminal(self) -> None:
        pid, terminal = pty.fork()
        if pid == 0:
            os.execv(str(TOOL), [str(TOOL), self.firmware.console])
        self.assertIn(b"^] leaves", self.until(terminal, b"leaves"))
        os.write(terminal, b"version\r")
        self.assertIn(b"> ", self.until(terminal, b"ok\r\n> "))
        os.write(terminal, b"\x1d")
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), 0)
        os.close(terminal)

    def until(self, terminal: int, wanted: bytes) -> bytes:
        text, end = b"", time.monotonic() + board.PATIENCE_S
        while wanted not in text and time.monotonic() < end:
            if select.select([terminal], [], [], 0.2)[0]:
                text += os.read(terminal, 4096)
        self.assertIn(wanted, text)
        return text


class Ports(unittest.TestCase):
    def test_a_pseudo_terminal(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            name = f"{folder}/console"
            firmware = subprocess.Popen([str(build.find_program("host", "reflux-host")), "--console", f"pty:{name}",
                                         "--link", "pty"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            self.addCleanup(firmware.wait)
            self.addCleanup(firmware.kill)
            end = time.monotonic() + board.PATIENCE_S
            while not os.path.exists(name) and time.monotonic() < end:
                time.sleep(0.02)
            out = subprocess.run([str(TOOL), name, "--run", "-"], input="version\n", text=True, capture_output=True,
                                 timeout=board.PATIENCE_S, check=False)
            self.assertEqual(out.returncode, 0, out.stderr)
            self.assertIn("reflux", out.stdout)

    def test_xoff_holds_the_sender_and_is_not_passed_on(self) -> None:
        board_side, tool_side = pty.openpty()
        port = Port(os.ttyname(tool_side))
        self.addCleanup(port.close)
        os.write(board_side, b"a\x13b")
        self.assertEqual(port.read(board.PATIENCE_S), b"ab")
        self.assertTrue(port.held)
        os.write(board_side, b"\x11c")
        self.assertEqual(port.write(b"go\n"), b"c")
        self.assertFalse(port.held)
        self.assertEqual(os.read(board_side, 10), b"go\n")

    def test_what_is_no_port_is_said_in_one_line(self) -> None:
        for where, expected in (("/nowhere", "there is no /nowhere"), ("socket:/nowhere", "No such file"),
                                (str(CONFIGURATION), "is not a serial device")):
            out = subprocess.run([str(TOOL), where], text=True, capture_output=True, check=False)
            self.assertEqual((out.returncode, out.stderr.count("\n")), (2, 1), out.stderr)
            self.assertIn(expected, out.stderr)
        out = subprocess.run([str(TOOL)], text=True, capture_output=True, check=False)
        self.assertEqual(out.returncode, 2)


class Parts(unittest.TestCase):
    def test_channels(self) -> None:
        channels = live.Channels(["T1"])
        channels.take("H,1,number,time[s],T1[degC]")
        self.assertEqual([channels.take(line) for line in ("T,1,0,0.5,20", "T,1,1", "T,1,1,1.0,x", "T,1,2,1.5,21")],
                         [True, False, False, True])
        self.assertEqual((list(channels.values["T1"]), channels.units["T1"]), ([20.0, 21.0], "degC"))
        with self.assertRaisesRegex(UserError, "no channel T2; there are number, time, T1"):
            live.Channels(["T2"]).take("H,1,number,time[s],T1[degC]")

    def test_sparkline(self) -> None:
        self.assertEqual(live.sparkline([0, 1, 2, 3, 4, 5, 6, 7], 20), "▁▂▃▄▅▆▇█")
        self.assertEqual(live.sparkline([5, 5, float("nan")], 20), "▁▁ ")
        self.assertEqual(live.sparkline([], 20), "")

    def test_differences(self) -> None:
        self.assertEqual(session.differences(["begin", "set a 1", "set b 2"], ["set a 1", "set b 3"]),
                         ["b is 3, the file says 2"])


if __name__ == "__main__":
    unittest.main()
