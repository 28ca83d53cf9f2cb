"""Every test function there is, with the tier and the entry in which it runs: to see that a change has lost none."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

from dev.testing import changed
from dev.testing.entries import Test
from reflux.paths import ROOT

RUN = re.compile(r"\bRUN_TEST\(\s*(\w+)\s*\)")


def show(default: list[Test], full: list[Test]) -> int:
    """A line for each function: tier, entry, function. Then the counts."""
    counts = {}
    seen: set[tuple[str, str]] = set()
    for tier, tests in (("default", default), ("full", full)):
        for test in tests:
            for kind, source, name in cases_of(test):
                print(f"{tier:8} {test.name:48} {name}")
                if (source, name) not in seen:
                    seen.add((source, name))
                    counts[tier, kind] = counts.get((tier, kind), 0) + 1
    print(f"\ndefault tier: {counts.get(('default', 'C'), 0)} C and {counts.get(('default', 'Python'), 0)} Python functions; "
          f"only in the full tier: {counts.get(('full', 'C'), 0)} C and {counts.get(('full', 'Python'), 0)} Python functions")
    return 0


def cases_of(test: Test) -> list[tuple[str, str, str]]:
    """(C or Python, source, function) of one entry. Scenario runs, campaigns, style and replays count as one each, by their names."""
    out = [("C", source, name) for source in sorted(changed.own_sources(test)) for name in _c_cases(ROOT / source)]
    for word in test.command:
        path = Path(word)
        if path.suffix == ".py" and path.name.startswith("test_"):
            out += [("Python", str(path), name) for name in _python_cases(path)]
    return out or [("C" if test.name.startswith("asan") else "Python", test.name, "(whole)")]


@cache
def _c_cases(path: Path) -> tuple[str, ...]:
    return tuple(RUN.findall(path.read_text(encoding="utf-8")))


@cache
def _python_cases(path: Path) -> tuple[str, ...]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return tuple(f"{c.name}.{f.name}" for c in tree.body if isinstance(c, ast.ClassDef)
                 for f in c.body if isinstance(f, ast.FunctionDef) and f.name.startswith("test"))
