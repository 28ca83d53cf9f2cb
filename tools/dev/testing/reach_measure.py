"""Measures tests/reach.txt: every test once, on programs that count what they run (gcc --coverage)."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

from reflux import boards, build
from reflux.errors import RunFailed
from reflux.paths import ROOT, build_root
from dev.testing import ctest_files
from dev.testing.entries import HANG_S, HOST, LIBRARIES, Test, script_tests, target_logs

FOLDERS = ("firmware/", "hal/", "host_sim/")
MAGIC, VERSION = 0x67636461, b"B2"  # gcc 12: lengths of records are in bytes
COUNTERS = 0x01A10000
HEADER = 16


def measure(jobs: int) -> dict[str, set[str]]:
    """Sources by test. A test that fails here has no row, so that it counts as unknown: it is named."""
    root = build_root() / "reach"
    tree = build.variant("coverage", "reach/host", targets=("tests", *HOST, *LIBRARIES))
    sources = sources_of_objects(tree)
    runs: list[tuple[str, list[str], Path, dict[str, str]]] = []
    for entry in ctest_files.entries(tree):
        environment = dict(item.split("=", 1) for item in entry.items("ENVIRONMENT"))
        runs.append((entry.name, list(entry.command), Path(entry.properties.get("WORKING_DIRECTORY", entry.folder)), environment))
    for test in [*script_tests("loop"), *script_tests("tools"), *map(on_host, target_logs())]:
        runs.append((test.name, test.command, ROOT, {"REFLUX_BUILD_ROOT": str(root)}))
    out: dict[str, set[str]] = {}
    progress, begun = build.Progress("reach"), time.monotonic()
    with ThreadPoolExecutor(jobs) as pool:
        results = pool.map(lambda run: one(*run, sources), runs)
        for done, ((name, *_), found) in enumerate(zip(runs, results), 1):
            left = (time.monotonic() - begun) / done * (len(runs) - done)
            progress.show(f"{done} of {len(runs)} tests, about {left:.0f} s left")
            if found is None:
                print(f"{name} fails on these programs: it has no row", flush=True)
            else:
                out[name] = found
    progress.end(f"{len(out)} tests, {time.monotonic() - begun:.0f} s")
    if not out:
        raise RunFailed("no test passed, so there is nothing to write")
    return out


def on_host(test: Test) -> Test:
    """A scenario on an image, run on the host instead: it reaches the same sources, but for those of the port."""
    return replace(test, command=["host" if word.removeprefix("board-") in (*boards.PRESETS, "host-fixed") else word for word in test.command])


def sources_of_objects(tree: Path) -> dict[str, str]:
    """Path of the source below the repository, by the path of the file that its object's counts go to."""
    out = {}
    for entry in json.loads((tree / "compile_commands.json").read_text(encoding="utf-8")):
        words = entry["command"].split()
        counts = Path(entry["directory"], words[words.index("-o") + 1]).with_suffix(".gcda")
        out[str(counts)] = os.path.relpath(entry["file"], ROOT)
    return out


def one(name: str, command: list[str], folder: Path, environment: dict[str, str], sources: dict[str, str]) -> set[str] | None:
    """The sources that a test runs, itself or in a process it starts. None where it fails."""
    with tempfile.TemporaryDirectory(prefix="reflux-") as place:
        answer = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=HANG_S, check=False,
                                env={**os.environ, **environment, "GCOV_PREFIX": place})
        if answer.returncode != 0:
            return None
        reached = set()
        for counts in Path(place).rglob("*.gcda"):
            source = sources.get(str(Path("/") / counts.relative_to(place)), "")
            if source.startswith(FOLDERS) and ran(counts.read_bytes(), counts):
                reached.add(source)
        return reached


def ran(data: bytes, path: Path) -> bool:
    """True where a counter of a .gcda file is not 0."""
    magic, = struct.unpack_from("<I", data)
    if magic != MAGIC or data[6:8] != VERSION[::-1]:
        raise RunFailed(f"{path.name}: written by another compiler than gcc 12, whose format is read here")
    at = HEADER
    while at + 8 <= len(data):
        tag, length = struct.unpack_from("<Ii", data, at)
        at += 8
        if tag == COUNTERS and length > 0 and any(data[at:at + length]):
            return True
        at += max(length, 0)  # below 0: all counters are 0, and none is written
    return False
