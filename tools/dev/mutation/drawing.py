"""Faults drawn by chance from all code lines of the firmware, the same ones for the same seed."""

from __future__ import annotations

import hashlib
import random
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from reflux.errors import UserError
from dev.mutation import edits, registers
from dev.mutation.edits import Edit
from reflux.paths import ROOT, shown

EQUIVALENT = ROOT / "tests" / "mutants_equivalent.toml"
SOURCES = ("CMakeLists.txt", "CMakePresets.json", "firmware", "hal", "host_sim", "tests", "tools/cmake", "tools/libreflux")


@dataclass(frozen=True)
class Fault:
    """An edit in a file; old and new are the whole lines, with single blanks."""

    file: str
    edit: Edit
    old: str
    new: str

    @property
    def path(self) -> Path:
        return ROOT / self.file

    @property
    def key(self) -> tuple[str, str, str, str]:
        return self.file, self.edit.function, self.old, self.new


def faults_by_line(files: list[str], board: str = "") -> dict[tuple[str, int], list[Fault]]:
    """All that could be drawn: by file and line. files: ends of paths, or folders; none: all. board: of the sources of its port."""
    out: dict[tuple[str, int], list[Fault]] = {}
    sources = registers.sources(board) if board else sorted((ROOT / "firmware").rglob("*.[ch]"))
    edits_of = registers.edits_of if board else edits.edits_of
    for path in sources:
        name = str(path.relative_to(ROOT))
        if files and not any(name.endswith(f) or name.startswith(f.rstrip("/") + "/") for f in files):
            continue
        text = path.read_text(encoding="utf-8")
        for edit in edits_of(path, text):
            out.setdefault((name, edit.line), []).append(Fault(name, edit, *edit.shown(text)))
    if not out:
        raise UserError(f"{f'the port of {board}' if board else 'firmware/'} has no code in {' or '.join(files)}")
    return out


def draws(seed: int, by_line: dict[tuple[str, int], list[Fault]]) -> Iterator[Fault]:
    """Each line equally often, then each kind that is possible there, then each fault of that kind; none twice."""
    chance = random.Random(seed)
    lines = sorted(by_line)
    left = {line: list(faults) for line, faults in by_line.items()}
    while lines:
        line = lines[chance.randrange(len(lines))]
        kinds = [k for k in (*edits.KINDS, *registers.KINDS) if any(f.edit.kind == k for f in left[line])]
        kind = kinds[chance.randrange(len(kinds))]
        possible = [f for f in left[line] if f.edit.kind == kind]
        fault = possible[chance.randrange(len(possible))]
        left[line].remove(fault)
        if not left[line]:
            lines.remove(line)
        yield fault


def equivalents() -> dict[tuple[str, str, str, str], str]:
    """Faults shown to change nothing that could be observed, with the reason."""
    if not EQUIVALENT.is_file():
        return {}
    with EQUIVALENT.open("rb") as f:
        data = tomllib.load(f)
    out = {}
    for n, entry in enumerate(data.get("equivalent", []), 1):
        missing = [k for k in ("file", "old", "new", "reason") if not entry.get(k)]
        if missing:
            raise UserError(f"{shown(EQUIVALENT)}: entry {n} has no {missing[0]}")
        key = (entry["file"], entry.get("function", ""), " ".join(entry["old"].split()), " ".join(entry["new"].split()))
        out[key] = entry["reason"]
    return out


def sources_digest() -> str:
    """Hash of everything a verdict depends on."""
    sha = hashlib.sha256()
    for name in SOURCES:
        top = ROOT / name
        for path in [top] if top.is_file() else sorted(p for p in top.rglob("*") if p.is_file()):
            if "__pycache__" not in path.parts:
                sha.update(str(path.relative_to(ROOT)).encode() + b"\0" + path.read_bytes() + b"\0")
    return sha.hexdigest()
