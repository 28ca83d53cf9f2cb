"""The lock of a build tree: a second process waits, a holder that was killed frees it, and every build takes it."""

import fcntl
import os
import shutil
import signal
import subprocess
import sys
import unittest
from pathlib import Path
from unittest import mock

from support import ROOT, FolderTest

from reflux import boards, build, launch
from reflux.errors import RunFailed

# Takes the lock, says "in", and leaves when a line comes. "tried" marks each attempt that failed.
HOLDER = """
import sys, time
from pathlib import Path
from reflux import build
folder, quiet, silent_s = Path(sys.argv[1]), sys.argv[2] == "quiet", float(sys.argv[3])
pause = time.sleep
def sleep(seconds):
    print("tried", file=sys.stderr, flush=True)
    pause(seconds)
build.time.sleep = sleep
build.SILENT_WAIT_S = silent_s
with build.locked(folder, quiet):
    print("in", flush=True)
    sys.stdin.readline()
    print("out", flush=True)
"""
NEVER_S = "1e9"


def is_held(tree: Path) -> bool:
    """True if a process, this one included, has the lock of this tree."""
    with tree.with_name(f"{tree.name}.lock").open("a") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False


class TwoProcesses(FolderTest):
    def setUp(self) -> None:
        super().setUp()
        self.tree = self.folder / "build" / "host"

    def start(self, how: str = "", silent_s: str = "0") -> subprocess.Popen:
        """A process that wants the lock of the tree."""
        process = subprocess.Popen([sys.executable, "-c", HOLDER, str(self.tree), how, silent_s], stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, "PYTHONPATH": str(ROOT / "tools"), "PYTHONDONTWRITEBYTECODE": "1"})
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def holder(self) -> subprocess.Popen:
        """A process that has the lock."""
        process = self.start()
        self.assertEqual(process.stdout.readline(), "in\n")
        return process

    def end(self, process: subprocess.Popen) -> str:
        """Lets the process go on, and returns what it still prints."""
        out, _ = process.communicate("\n")
        self.assertEqual(process.returncode, 0)
        return out

    def test_the_second_one_says_that_it_waits_and_comes_in_after_the_first(self) -> None:
        first = self.holder()
        second = self.start()
        self.assertRegex(second.stdout.readline(), r"^waiting for the build tree .*build/host, in which another process builds$")
        self.assertEqual(second.stderr.readline(), "tried\n")
        self.assertTrue(is_held(self.tree))
        self.assertEqual(self.end(first), "out\n")
        self.assertEqual(second.stdout.readline(), "in\n")
        self.assertEqual(self.end(second), "out\n")
        self.assertFalse(is_held(self.tree))

    def test_it_says_nothing_when_it_is_quiet_or_has_not_waited_long(self) -> None:
        for how, silent_s in (("quiet", "0"), ("", NEVER_S)):
            with self.subTest(how=how):
                first = self.holder()
                second = self.start(how, silent_s)
                for _ in range(3):
                    self.assertEqual(second.stderr.readline(), "tried\n")
                self.end(first)
                self.assertEqual(self.end(second), "in\nout\n")

    def test_a_holder_that_was_killed_frees_it(self) -> None:
        first = self.holder()
        second = self.start("quiet")
        self.assertEqual(second.stderr.readline(), "tried\n")
        first.send_signal(signal.SIGKILL)
        self.assertEqual(second.stdout.readline(), "in\n")

    def test_other_trees_are_free(self) -> None:
        self.holder()
        with build.locked(self.folder / "build" / "host-fixed"):
            self.assertTrue(is_held(self.folder / "build" / "host-fixed"))


class EachBuild(FolderTest):
    def setUp(self) -> None:
        super().setUp()
        self.enterContext(mock.patch.dict(os.environ, {"REFLUX_BUILD_ROOT": str(self.folder / "deep" / "build")}))
        self.steps: list[tuple[str, bool]] = []
        self.enterContext(mock.patch.object(build, "_run", self.note))

    def note(self, what: str, command: list[str], quiet: bool) -> None:
        """Stands in for a step that starts cmake."""
        tree = Path(command[command.index("-B" if "-B" in command else "--build") + 1])
        self.steps.append((what, is_held(tree)))

    def test_every_step_holds_the_lock_and_frees_it(self) -> None:
        tree = build.build("host", ("reflux-sim",))
        build.configure("asan")
        build.variant("host", "host-large", ("-DX=1",))
        self.assertEqual(self.steps, [("configuring host", True), ("building host", True), ("configuring asan", True),
                                      ("configuring host-large", True), ("building host-large -DX=1", True)])
        self.assertFalse(is_held(tree))

    def test_a_build_that_fails_frees_it(self) -> None:
        with mock.patch.object(build, "_run", side_effect=RunFailed("building host failed")):
            with self.assertRaises(RunFailed):
                build.build("host")
        self.assertFalse(is_held(build.build_dir("host")))

    def configured(self, *trees: str) -> None:
        """Each step of configuring leaves the next of these as build.ninja."""
        texts = list(trees)

        def note(what: str, command: list[str], quiet: bool) -> None:
            self.note(what, command, quiet)
            tree = build.build_dir("host")
            tree.mkdir(exist_ok=True)
            (tree / "build.ninja").write_text(texts.pop(0))

        self.enterContext(mock.patch.object(build, "_run", note))

    def test_a_tree_from_before_a_library_was_installed_is_made_anew(self) -> None:
        self.configured("rule a\n", "rule a\nbuild reflux-board: link x.o\n")
        self.assertTrue(build.knows("host", "reflux-board"))
        self.assertEqual(self.steps, [("configuring host", True)] * 2)
        self.assertTrue(build.knows("host", "reflux-board"))
        self.assertEqual(len(self.steps), 2)

    def test_without_unicorn_the_virtual_board_says_what_to_install(self) -> None:
        for kind in boards.VIRTUAL:
            with self.subTest(kind):
                shutil.rmtree(build.build_dir("host"), ignore_errors=True)
                self.configured("rule a\n", "build reflux-board-other: link x.o\n")
                with self.assertRaisesRegex(RunFailed, "apt install libunicorn-dev"):
                    launch.build_for(kind)

    def test_a_folder_that_cannot_be_written_is_an_error_in_one_line(self) -> None:
        (self.folder / "deep").write_text("a file")
        with self.assertRaisesRegex(RunFailed, "host.lock: cannot be opened: Not a directory"):
            build.build("host")


class Forecast(unittest.TestCase):
    def test_what_takes_longer_than_two_seconds_says_how_long_it_will(self) -> None:
        for text, elapsed, told in (("3 of 12 runs", 10.0, "3 of 12 runs, about 30 s left"), ("30/120", 10.0, "30/120, about 30 s left"),
                                    ("plant time 100 s of 1000 s (10 %), 7 ticks/s", 40.0, "plant time 100 s of 1000 s (10 %), 7 ticks/s, about 6 min left"),
                                    ("3 of 12 runs", 1.0, "3 of 12 runs"), ("0 of 12 runs", 10.0, "0 of 12 runs"), ("12 of 12", 10.0, "12 of 12"),
                                    ("3 of 12, about 4 s left", 10.0, "3 of 12, about 4 s left"), ("poles", 10.0, "poles")):
            self.assertEqual(build.forecast(text, elapsed), told)


if __name__ == "__main__":
    unittest.main()
