"""Cost of a tick without the plant link, beside another version of the firmware: the part of tools/bench about control.

Both versions are built from the same tests/bench/tick_cost.c, the other one in a worktree of its own below the build folder.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Callable

from reflux import build
from reflux.errors import RunFailed, UserError
from reflux.paths import ROOT, build_dir, build_root

BEFORE = "4fb4558"  # before the kinds of blocks
WAYS = (("2 loops", "2"), ("16 loops", "16"), ("16 loops, 8 of them decoupled", "decoupled"))
FORMATS = (("float", "host"), ("Q7.24", "host-fixed"))
TICKS = (20, 120)  # two runs, so that the start does not count
TITLE = "Instructions of a tick without the link, host"

Counted = Callable[[str, list[str]], int]


def header(before: str) -> list[str]:
    return ["what", "number format", f"commit {before}", "this version", "change"]


def rows(counted: Counted, before: str) -> list[list[str]]:
    """counted(function, command) counts the instructions of a function and what it calls."""
    out = []
    for name, preset in FORMATS:
        # As it is flashed: without the assertions of host builds.
        here = build.variant(preset, f"bench/{preset}", ("-DREFLUX_ASSERTIONS=OFF",), ("tick_cost",)) / "tests" / "unit" / "tick_cost"
        try:
            there: Path | None = beside(before, preset)
            reason = ""
        except RunFailed as error:
            there, reason = None, f"not measured: {error}"
        for what, way in WAYS:
            now = per_tick(counted, here, way)
            if there is None:
                out.append([what, name, reason, f"{now:,}", ""])
                continue
            then = per_tick(counted, there, way)
            out.append([what, name, f"{then:,}", f"{now:,}", f"{(now - then) / then * 100:+.1f} %"])
    return out


def check(before: str) -> None:
    """Refuses what is no commit here, before minutes of building. The default may lack in a shallow clone; its column says so."""
    if before != BEFORE:
        try:
            run("", ["git", "-C", str(ROOT), "rev-parse", "--verify", f"{before}^{{commit}}"])
        except RunFailed:
            raise UserError(f"--before {before} is not a commit here") from None


def per_tick(counted: Counted, program: Path, way: str) -> int:
    first, last = (counted("bench_ticks", [str(program), way, str(n)]) for n in TICKS)
    return round((last - first) / (TICKS[1] - TICKS[0]))


def beside(commit: str, preset: str) -> Path:
    """Builds tick_cost of another version and returns the program."""
    tree = build_root() / "before" / commit
    if not (tree / "CMakeLists.txt").is_file():
        run(f"no worktree of {commit}", ["git", "-C", str(ROOT), "worktree", "add", "--force", "--detach", str(tree), commit])
    folder = build_root() / "before" / f"{commit}-{preset}"
    run(f"{commit} cannot be configured",
        ["cmake", "--preset", preset, "-S", str(tree), "-B", str(folder), f"-DUNITY_DIR={unity()}",
         f"-DCMAKE_PROJECT_reflux_INCLUDE={ROOT / 'tests' / 'bench' / 'tick_cost.cmake'}"], tree)
    run(f"{commit} cannot be built", ["cmake", "--build", str(folder), "--target", "tick_cost_beside"], tree)
    return folder / "tick_cost_beside"


def unity() -> str:
    """The folder with the unit-test framework that this version uses: the other one need not fetch it again."""
    cache = (build_dir("host") / "CMakeCache.txt").read_text(encoding="utf-8", errors="replace")
    found = re.search(r"^UNITY_DIR:PATH=(.+)$", cache, re.M)
    return found[1] if found else str(ROOT / "build" / "unity")


def run(what: str, command: list[str], where: Path = ROOT) -> None:
    try:
        answer = subprocess.run(command, cwd=where, capture_output=True, text=True, errors="replace", check=False)
    except FileNotFoundError:
        raise RunFailed(f"{what}: there is no program {command[0]}") from None
    if answer.returncode != 0:
        last = (answer.stderr.strip() or answer.stdout.strip() or "it says nothing").splitlines()[-1]
        raise RunFailed(f"{what}: {last}")
