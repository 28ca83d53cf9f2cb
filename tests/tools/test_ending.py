"""What a tool leaves when somebody ends it: no process, no temporary file; and a run that is refused leaves no folder."""

import contextlib
import io
import os
import pty
import select
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from unittest import mock

from support import GOOD, ROOT, FolderTest, call

from reflux import ending, runner
from reflux.errors import RunFailed, UserError

PATIENCE_S = 60.0
STARTS = """
import subprocess, sys, tempfile, time
from reflux import __main__ as entry
class Tool:
    @staticmethod
    def main(arguments):
        folder = tempfile.mkdtemp()
        child = subprocess.Popen([sys.executable, "-c", "import subprocess; subprocess.run(['sleep', '600'])"])
        while len(entry.ending.descendants(child.pid)) == 0:
            time.sleep(0.01)
        print(folder, child.pid, entry.ending.descendants(child.pid)[0][0], flush=True)
        {waits}
sys.modules["made_up"] = Tool
entry.COMMANDS["made-up"] = "made_up"
sys.argv = ["reflux", "made-up"]
sys.exit(entry.main())
"""
WAITS = "child.wait()"
POOL = """
        from concurrent.futures import ThreadPoolExecutor
        with ThreadPoolExecutor(1) as pool:
            for _ in range(100):
                pool.submit(subprocess.run, ["sleep", "600"])
            child.wait()"""

# The signal is noted, and the wait is not interrupted: as when it comes between the last step and the wait.
NOTED = """
        import ctypes, signal, threading
        threading.Timer(0.5, ctypes.pythonapi.PyErr_SetInterruptEx, [int(signal.SIGTERM)]).start()
        child.wait()"""


class Signals(FolderTest):
    def started(self, waits: str) -> tuple[subprocess.Popen[str], list[str]]:
        process = subprocess.Popen([sys.executable, "-c", STARTS.format(waits=waits)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, "PYTHONPATH": str(ROOT / "tools"), "TMPDIR": str(self.folder)})
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process, process.stdout.readline().split()

    def test_a_signal_ends_children_and_their_children_and_removes_temporary_files(self) -> None:
        for number in (signal.SIGTERM, signal.SIGHUP):
            for waits in (WAITS, POOL):
                with self.subTest(number=number.name, pool=waits is POOL):
                    process, (folder, child, grandchild) = self.started(waits)
                    self.assertTrue(Path(folder).is_dir())
                    process.send_signal(number)
                    self.assertEqual(process.wait(PATIENCE_S), 128 + number)
                    for pid in (child, grandchild):
                        self.assertEqual(ending.stat_of(int(pid)), [])
                    self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_signal_that_comes_just_before_a_wait_ends_the_wait(self) -> None:
        process, _ = self.started(NOTED)
        self.assertEqual(process.wait(PATIENCE_S), 128 + signal.SIGTERM)

    def test_the_signal_is_named_in_one_line(self) -> None:
        process, _ = self.started(WAITS)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.communicate(timeout=PATIENCE_S)[1], "tools/made-up: ended by SIGTERM\n")

    def test_a_tool_that_ends_by_itself_leaves_no_temporary_file(self) -> None:
        done = subprocess.run([str(ROOT / "tools" / "plot"), "none.csv"], capture_output=True, text=True, check=False,
                              env={**os.environ, "TMPDIR": str(self.folder)})
        self.assertEqual((done.returncode, list(self.folder.iterdir())), (2, []))


class Earlier(FolderTest):
    """Runs in one folder, made of what a run writes."""

    def run_once(self, words: str, ends: bool = True, quiet: bool = False) -> str:
        def made(_scenario, _options, out: Path) -> str:
            for name in ("script.txt", "transcript.txt") + (("result.json", "report.html", "plot-loop-top.png") if ends else ()):
                (out / name).write_text(words)
            if not ends:
                raise KeyboardInterrupt
            return words

        said = io.StringIO()
        with mock.patch.object(runner, "_run_in", made), contextlib.redirect_stdout(said), contextlib.suppress(KeyboardInterrupt):
            runner.run(mock.Mock(wiring=None), runner.Options(self.folder, quiet=quiet))
        return said.getvalue()

    def texts(self, folder: Path) -> dict[str, str]:
        return {file.name: file.read_text() for file in folder.iterdir() if file.is_file() and file.name != ".lock"}

    def test_runs_that_are_interrupted_leave_the_last_one_that_ended(self) -> None:
        whole = ("script.txt", "transcript.txt", "result.json", "report.html", "plot-loop-top.png")
        self.assertEqual(self.run_once("first"), "")
        self.assertFalse((self.folder / "before").exists())
        self.assertIn("files of the run before:", self.run_once("second", ends=False))
        self.assertEqual(self.texts(self.folder / "before"), dict.fromkeys(whole, "first"))
        self.run_once("third", ends=False)
        self.assertEqual(self.texts(self.folder / "before"), dict.fromkeys(whole, "first"))
        self.assertEqual(self.texts(self.folder), dict.fromkeys(whole[:2], "third"))
        self.assertEqual(self.run_once("fourth"), "")
        self.assertEqual(self.texts(self.folder / "before"), dict.fromkeys(whole, "first"))
        self.run_once("fifth")
        self.assertEqual((self.texts(self.folder / "before"), self.texts(self.folder)), (dict.fromkeys(whole, "fourth"), dict.fromkeys(whole, "fifth")))


class Refused(FolderTest):
    def test_a_run_that_is_refused_leaves_no_folder(self) -> None:
        file = self.file("trial.toml", GOOD.replace('"pilot"', '"nowhere"'))
        out = self.folder / "new" / "deeper"
        status, _out, err = call("run", str(file), "--firmware", "host", "--no-build", "--out", str(out))
        self.assertEqual((status, (self.folder / "new").exists()), (2, False), err)

    def test_a_refusal_within_the_run_takes_a_new_folder_away_and_leaves_an_old_one(self) -> None:
        old, new = self.folder / "old", self.folder / "a" / "b"
        old.mkdir()
        (old / "mine").touch()
        for out in (old, new):
            with self.assertRaises(UserError), runner.locked(out):
                (out / "transcript.txt").touch()
                raise UserError("wrong")
        self.assertEqual(((old / "mine").exists(), (self.folder / "a").exists()), (True, False))

    def test_a_run_that_failed_keeps_its_folder(self) -> None:
        with self.assertRaises(RunFailed), runner.locked(self.folder / "new"):
            raise RunFailed("died")
        self.assertTrue((self.folder / "new").is_dir())


if __name__ == "__main__":
    unittest.main()
