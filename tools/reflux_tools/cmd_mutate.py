"""tools/mutate: faults put into the firmware on purpose, one at a time; the tests must notice each."""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import tomllib
from dataclasses import dataclass
from pathlib import Path

from reflux_tools import build
from reflux_tools.errors import RunFailed, UserError
from reflux_tools.paths import ROOT, build_root, shown

LIST = ROOT / "tests" / "mutants.toml"
COPIED = ("CMakeLists.txt", "CMakePresets.json", "firmware", "hal", "host_sim", "tests", "tools", "docs")


@dataclass(frozen=True)
class Mutant:
    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    def title(self) -> str:
        return f"{self.file}: {' '.join(self.old.split())}  ->  {' '.join(self.new.split()) or '(nothing)'}"


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/mutate",
        description="Builds a copy of the sources (build/mutants) with each fault of tests/mutants.toml in turn and runs "
        "the tests named there. A fault no test notices is printed, and the exit status is 1.")
    p.add_argument("files", nargs="*", metavar="FILE", help="only faults in source files whose path ends so")
    p.add_argument("--list", action="store_true", help="print the faults, try none")
    options = p.parse_args(arguments)
    mutants = [m for m in load() if not options.files or any(m.file.endswith(f) for f in options.files)]
    if not mutants:
        raise UserError(f"{shown(LIST)} has no fault in {' or '.join(options.files)}")
    check(mutants)
    if options.list:
        print("\n".join(m.title() for m in mutants))
        return 0
    place = build_root() / "mutants"
    source = copy(place)
    programs = sorted({t for m in mutants for t in m.tests})
    configure(source, place / "build")
    if (failure := make_and_run(place / "build", programs)) is not None:
        raise RunFailed(f"without any fault already: {failure}")
    survivors = []
    progress = build.Progress("mutants")
    for n, mutant in enumerate(mutants, 1):
        progress.show(f"{n} of {len(mutants)}, {mutant.file}")
        noticed = attempt(source, place / "build", mutant)
        if noticed is None:
            survivors.append(mutant)
    progress.end(f"{len(mutants)} tried")
    for mutant in survivors:
        print(f"not noticed: {mutant.title()}")
    print(f"mutants: {len(mutants)}, caught: {len(mutants) - len(survivors)}")
    return 1 if survivors else 0


def load() -> list[Mutant]:
    with LIST.open("rb") as f:
        data = tomllib.load(f)
    out = []
    for group in data["group"]:
        for fault in group["faults"]:
            out.append(Mutant(group["file"], fault[0], fault[1], tuple(group["tests"])))
    return out


def check(mutants: list[Mutant]) -> None:
    for m in mutants:
        n = (ROOT / m.file).read_text(encoding="utf-8").count(m.old)
        if n != 1:
            raise UserError(f"{shown(LIST)}: in {m.file} the text {m.old!r} stands {n} times, it must stand once")


def copy(place: Path) -> Path:
    """Only what has changed, so that the build of last time is still worth something."""
    source = place / "source"
    source.mkdir(parents=True, exist_ok=True)
    wanted = set()
    for name in COPIED:
        top = ROOT / name
        for f in [top] if top.is_file() else (p for p in top.rglob("*") if p.is_file() and "__pycache__" not in p.parts):
            to = source / f.relative_to(ROOT)
            wanted.add(to)
            if not to.is_file() or to.read_bytes() != f.read_bytes():
                to.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(f, to)
    for old in [p for p in source.rglob("*") if p.is_file() and p not in wanted]:
        old.unlink()
    return source


def configure(source: Path, folder: Path) -> None:
    command = ["cmake", "-S", str(source), "-B", str(folder), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_FLAGS=-w",
               f"-DUNITY_DIR={unity()}"]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        raise RunFailed(f"configuring {shown(folder)}: {answer.stderr.strip().splitlines()[-1]}")


def unity() -> Path:
    folder = ROOT / "build" / "unity"
    if not (folder / "unity.c").is_file():
        build.configure("host")
    return folder


def make_and_run(folder: Path, tests: list[str]) -> str | None:
    """What went wrong, or None when everything passed. A build that fails is a fault noticed too: by the compiler."""
    targets = [f"test_{t}" for t in tests]
    answer = subprocess.run(["cmake", "--build", str(folder), "--target", *targets], capture_output=True, text=True,
                            errors="replace", check=False)
    if answer.returncode != 0:
        return "the build failed: " + next((x for x in answer.stdout.splitlines() if "error" in x), "?")
    pattern = "^(" + "|".join(tests) + ")$"
    answer = subprocess.run(["ctest", "--test-dir", str(folder), "-R", pattern, "--stop-on-failure", "--timeout", "60",
                             "-j", str(os.cpu_count() or 2)], capture_output=True, text=True, errors="replace",
                            check=False)
    if answer.returncode != 0:
        return "a test failed: " + next((x for x in answer.stdout.splitlines() if "***" in x), "?")
    return None


def attempt(source: Path, folder: Path, mutant: Mutant) -> str | None:
    target = source / mutant.file
    whole = target.read_text(encoding="utf-8")
    target.write_text(whole.replace(mutant.old, mutant.new), encoding="utf-8")
    try:
        noticed = make_and_run(folder, list(mutant.tests))
    finally:
        target.write_text(whole, encoding="utf-8")
    if noticed and noticed.startswith("the build failed"):
        raise UserError(f"{shown(LIST)}: this is no fault a test could notice, it does not compile: {mutant.title()}; "
                        f"{noticed}")
    return noticed
