"""Two tools on one pseudo-terminal: the second is refused, by the name and number of the process that has it."""

import contextlib
import os
import pty
import re
import select
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from support import ROOT, call

from reflux import port_lock
from reflux.errors import UserError
from reflux.ports import Port

HOLD = "import sys, time; from reflux.ports import Port; p = Port(sys.argv[1]); print('ready', flush=True); time.sleep(600)"


class PortLock(unittest.TestCase):
    def setUp(self) -> None:
        board, device = pty.openpty()  # the device stays open, as a firmware keeps it
        self.addCleanup(os.close, board)
        self.addCleanup(os.close, device)
        self.board, self.path = board, os.ttyname(device)

    def other(self) -> subprocess.Popen[str]:
        """Another process that has the port."""
        process = subprocess.Popen([sys.executable, "-c", HOLD, self.path], stdout=subprocess.PIPE, text=True,
                                   env={**os.environ, "PYTHONPATH": str(ROOT / "tools")})
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.assertEqual(process.stdout.readline(), "ready\n")
        return process

    def test_a_tool_is_refused_by_the_name_and_number_of_the_process_that_has_the_port(self) -> None:
        other = self.other()
        status, _out, err = call("console", self.path, "--dump", "-")
        name = os.path.basename(sys.executable)
        self.assertEqual((status, err), (2, f"tools/console: {self.path} is in use by {name} (process {other.pid}); end that first, or name another port\n"))

    def test_nothing_reaches_the_board_from_a_tool_that_is_refused(self) -> None:
        self.other()
        with self.assertRaises(UserError):
            Port(self.path)
        self.assertEqual(select.select([self.board], [], [], 0.2)[0], [])

    def test_the_lock_ends_with_a_process_that_is_killed(self) -> None:
        other = self.other()
        other.send_signal(signal.SIGKILL)
        other.wait()
        Port(self.path).close()

    def test_a_port_that_was_closed_is_free(self) -> None:
        for _ in range(2):
            with contextlib.closing(Port(self.path)), self.assertRaisesRegex(UserError, re.escape(f"(process {os.getpid()})")):
                Port(self.path)

    def test_a_run_is_refused_before_it_starts_and_leaves_the_lock_of_a_pseudo_terminal_to_the_simulator(self) -> None:
        with port_lock.held(self.path), contextlib.closing(Port(self.path)), self.assertRaisesRegex(UserError, "is in use by"):
            self.enterContext(port_lock.held(self.path))

    def test_a_tool_of_ours_is_called_as_people_start_it(self) -> None:
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        for pid, words in ((1, ["/usr/bin/python3", "-m", "reflux", "console", "PORT"]), (2, ["/usr/bin/picocom", "PORT"]),
                           (4, ["/home/me/env/bin/python3", "/home/me/env/bin/reflux", "console", "PORT"])):
            (folder / str(pid)).mkdir()
            (folder / str(pid) / "cmdline").write_text("\0".join([*words, ""]))
        with mock.patch.object(port_lock, "PROC", folder):
            self.assertEqual([port_lock.name_of(pid) for pid in (1, 2, 3, 4)], ["tools/console", "picocom", "a process", "reflux console"])


if __name__ == "__main__":
    unittest.main()
