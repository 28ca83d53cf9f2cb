"""tests/run_once.txt: tests whose number format cannot matter, and proofs of what the file claims."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from pathlib import Path

from reflux import machine_code
from reflux.errors import RunFailed, UserError
from reflux.paths import ROOT, build_dir, shown
from dev.testing import ctest_files
from dev.testing.entries import SANITIZED

TABLE = ROOT / "tests" / "run_once.txt"
SECTIONS = ("same-code", "not-reached", "judged")
MARK = "# Section "


def sections(path: Path = TABLE) -> dict[str, list[str]]:
    """Names by section."""
    out: dict[str, list[str]] = {}
    current: list[str] | None = None
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith(MARK):
            current = out.setdefault(line.removeprefix(MARK).split(":")[0], [])
        elif line and not line.startswith("#"):
            if current is None:
                raise UserError(f"{shown(path)}:{number}: {line} stands before the first section")
            current.append(line)
    if tuple(out) != SECTIONS:
        raise UserError(f"{shown(path)}: its sections must be {', '.join(SECTIONS)}")
    return out


def entries(preset: str) -> dict[str, ctest_files.Entry]:
    """Tests of a sanitizer tree by name."""
    return {entry.name: entry for entry in ctest_files.entries(build_dir(preset))}


def same_code(left: ctest_files.Entry, right: ctest_files.Entry) -> bool:
    """True for the same command on programs that are the same machine code."""
    trees = [f"{build_dir(preset)}{os.sep}" for preset in SANITIZED]
    if len(left.command) != len(right.command) or left.items("ENVIRONMENT") != right.items("ENVIRONMENT"):
        return False
    for a, b in zip(left.command, right.command):
        if a == b:
            continue
        if not (a.startswith(trees[0]) and b.startswith(trees[1]) and a[len(trees[0]):] == b[len(trees[1]):]
                and machine_code.is_program(Path(a)) and machine_code.is_program(Path(b)) and machine_code.same(Path(a), Path(b))):
            return False
    return True


def differing_sources() -> set[str]:
    """Sources whose objects differ between the two sanitizer trees, apart from what is there for debuggers."""
    first, second = (build_dir(preset) for preset in SANITIZED)
    out = set()
    with tempfile.TemporaryDirectory() as place:
        for entry in json.loads((first / "compile_commands.json").read_text(encoding="utf-8")):
            words = entry["command"].split()
            name = words[words.index("-o") + 1]
            left, right = first / name, second / name
            if left.is_file() and right.is_file() and _code(left, Path(place)) != _code(right, Path(place)):
                out.add(os.path.relpath(entry["file"], ROOT))
    if not out:
        raise RunFailed("no object differs between the number formats: the trees are not built")
    return out


def _code(path: Path, place: Path) -> bytes:
    """An object without symbols of the debugger and without its own name."""
    target = place / "object.o"
    subprocess.run(["strip", "--strip-debug", "--remove-section=.comment", "-o", str(target), str(path)], check=True)
    return target.read_bytes()
