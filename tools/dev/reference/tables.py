"""The tables of the code as the programs of the build print them, and the notes beside them."""

from __future__ import annotations

import subprocess
import tomllib
from collections import defaultdict
from pathlib import Path
from typing import Any, Iterable

from reflux.errors import RunFailed
from reflux.paths import ROOT, shown

NOTES = ROOT / "docs" / "reference" / "notes"
Rows = dict[str, list[list[str]]]


def rows_of(text: str) -> Rows:
    """Fields of each line, by the first field, which says what the line is."""
    found: Rows = defaultdict(list)
    for line in text.splitlines():
        what, *fields = line.split("\t")
        found[what].append(fields)
    return dict(found)


def said_by(program: Path, *arguments: str, told: str = "") -> str:
    answer = subprocess.run([str(program), *arguments], input=told, capture_output=True, text=True, check=False)
    if answer.returncode:
        raise RunFailed(f"{shown(program)} {' '.join(arguments)} failed: {answer.stderr.strip()}")
    return answer.stdout


def notes(name: str) -> dict[str, Any]:
    return tomllib.loads((NOTES / f"{name}.toml").read_text(encoding="utf-8"))


def check_same(what: str, file: str, noted: Iterable[str], known: Iterable[str]) -> None:
    """Every item of the code has a note, each once, and there is no other note."""
    noted, known = list(noted), list(known)
    twice = {name for name in noted if noted.count(name) > 1}
    for names, wrong in ((set(known) - set(noted), "has no note"), (set(noted) - set(known), "is not in the code"), (twice, "is noted twice")):
        if names:
            raise RunFailed(f"docs/reference/notes/{file}.toml: {what} {', '.join(sorted(names))} {wrong}")
