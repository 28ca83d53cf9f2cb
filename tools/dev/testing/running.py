"""Builds what tests need, writes them into one ctest tree, runs it, and shows what runs and how long it will still take."""

from __future__ import annotations

import contextlib
import os
import queue
import re
import subprocess
import sys
import threading
import time
from collections import defaultdict
from pathlib import Path

from reflux import build, environment
from reflux.paths import ROOT, build_dir
from dev.testing import times
from dev.testing.entries import Needs, Test

STARTED = re.compile(r"^\s*Start\s+\d+: (\S+)")
ENDED = re.compile(r"^\s*\d+/\d+\s+Test\s+#\d+: (\S+) \.*\s*(.*?)\s+([\d.]+) sec")
TOLD_EVERY_S = 30.0  # where the output is no terminal


def build_needs(wanted: Needs) -> None:
    """Builds each preset once. A preset that is wanted whole needs no list of targets."""
    targets: dict[str, list[str]] = defaultdict(list)
    for preset, target in sorted(wanted):
        targets[preset].append(target)
    for preset, names in targets.items():
        build.build(preset, () if "" in names else tuple(names))


def write_tree(tests: list[Test], seconds: dict[str, float]) -> Path:
    """build/test, with the longest tests first: the last ones to run are short, and no core waits long."""
    folder = build_dir("test")
    folder.mkdir(parents=True, exist_ok=True)
    text = ["# Written by tools/test; changes here are lost.\n"]
    for test in tests:
        text.append(f"add_test({quote(test.name)} {' '.join(map(quote, test.command))})\n")
        pairs = {"LABELS": test.labels, "WORKING_DIRECTORY": str(ROOT), "COST": f"{seconds.get(test.name, times.UNKNOWN_S):.2f}",
                 **test.properties}
        words = " ".join(f"{key} {quote(value)}" for key, value in pairs.items())
        text.append(f"set_tests_properties({quote(test.name)} PROPERTIES {words})\n")
    (folder / "CTestTestfile.cmake").write_text("".join(text), encoding="utf-8")
    # ctest would put its own record of other runs before COST.
    (folder / "Testing" / "Temporary" / "CTestCostData.txt").unlink(missing_ok=True)
    return folder


def quote(value: object) -> str:
    """CMake's bracket argument: nothing in it is special."""
    if isinstance(value, bool):
        value = "ON" if value else "OFF"
    if isinstance(value, list):
        value = ";".join(map(str, value))
    return f"[==[{value}]==]"


class Watch:
    """Shows what runs, what is done, and what is left."""

    def __init__(self, tests: list[Test], seconds: dict[str, float], jobs: int):
        self.left = {t.name: seconds.get(t.name, times.UNKNOWN_S) for t in tests}
        self.count, self.jobs = len(tests), jobs
        self.expected_done = 0.0
        self.running: dict[str, float] = {}
        self.seconds: dict[str, float] = {}
        self.failed: list[str] = []
        self.begun = time.monotonic()

    def started(self, name: str) -> None:
        self.running[name] = time.monotonic()

    def ended(self, name: str, outcome: str, seconds: float) -> None:
        self.running.pop(name, None)
        self.expected_done += self.left.pop(name, 0.0)
        self.seconds[name] = seconds
        if outcome != "Passed":
            self.failed.append(name)

    def left_s(self) -> float:
        """Seconds until all is done, at the speed so far. Before 5 s have passed the forecast alone counts."""
        passed = time.monotonic() - self.begun
        pace = passed * self.jobs / self.expected_done if passed > 5 and self.expected_done > 5 else 1.0
        now = time.monotonic()
        left = sum(max(0.0, s - (now - self.running[n]) / pace if n in self.running else s) for n, s in self.left.items())
        return pace * left / self.jobs

    def line(self) -> str:
        failed = f", {len(self.failed)} failed" if self.failed else ""
        left = self.left_s()
        forecast = f"about {left:.0f} s left" if left >= 1.0 or not self.running else "the rest takes longer than expected"
        return (f"{self.count - len(self.left)} of {self.count} tests{failed}, {forecast}"
                + (f"; running: {', '.join(self.running)}" if self.running else ""))


def run(folder: Path, tests: list[Test], seconds: dict[str, float], jobs: int) -> tuple[int, Watch]:
    """ctest's exit status, and what was seen. Prints output of tests that fail, and ctest's summary."""
    environment.prepare()
    command = ["ctest", "--test-dir", str(folder), "--output-on-failure", "--no-tests=error", "-j", str(jobs)]
    process = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               text=True, errors="replace", env=environment.clean(os.environ))
    lines: queue.Queue[str | None] = queue.Queue()
    threading.Thread(target=_read, args=(process, lines), daemon=True).start()
    watch = Watch(tests, seconds, jobs)
    progress = build.Progress("tests")
    announced, last = time.monotonic(), ""
    try:
        while True:
            with contextlib.suppress(queue.Empty):
                line = lines.get(timeout=1.0)
                if line is None:
                    break
                _take(line, watch, progress)
            progress.show(watch.line())
            if not progress.terminal and time.monotonic() - announced > TOLD_EVERY_S:
                announced = time.monotonic()
                if (text := watch.line()) != last:
                    print(f"tests: {text}", flush=True)
                last = text
        return process.wait(), watch
    except BaseException:
        process.terminate()
        process.wait()
        raise


def _read(process: subprocess.Popen[str], lines: queue.Queue[str | None]) -> None:
    assert process.stdout is not None
    for line in process.stdout:
        lines.put(line)
    lines.put(None)


def _take(line: str, watch: Watch, progress: build.Progress) -> None:
    """One line of ctest: what it says is counted, or stays on the screen where a person needs it."""
    if found := STARTED.match(line):
        watch.started(found[1])
    elif found := ENDED.match(line):
        watch.ended(found[1], found[2], float(found[3]))
        if found[2] != "Passed":
            _say(progress, line)
    elif not line.startswith(("Internal ctest changing", "Test project ")):
        _say(progress, line)


def _say(progress: build.Progress, line: str) -> None:
    """A line that stays, above the line of progress."""
    if progress.terminal:
        sys.stdout.write("\r\033[K")
    sys.stdout.write(line)
    sys.stdout.flush()
