"""The two tiers: the default one, and what only `tools/test --all` runs, each with the reason (tests/full_tier.toml)."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

from reflux import boards
from reflux.errors import UserError
from reflux.paths import ROOT, shown
from dev.testing.entries import AGAIN, LABELS, SANITIZED, Needs, Test, needs, needs_of_firmware

TABLE = ROOT / "tests" / "full_tier.toml"
AGAIN_REASON = "runs in float in the default tier; tests/run_once.txt says why its number format cannot matter"


@dataclass(frozen=True)
class Row:
    """Tests that only the full tier runs. With arguments the tests stay where they are, and the full tier adds NAME-all, which gets
    the arguments. tests: patterns of names."""

    tests: tuple[str, ...]
    reason: str
    arguments: tuple[str, ...] = ()


def rows(path: Path = TABLE) -> list[Row]:
    """The table as written."""
    with path.open("rb") as f:
        document = tomllib.load(f)
    out = []
    for number, entry in enumerate(document.get("full", []), 1):
        unknown = sorted(set(entry) - {"tests", "reason", "arguments"})
        if unknown or not entry.get("tests") or not entry.get("reason"):
            raise UserError(f"{shown(path)}: row {number} must have tests and reason, and may have arguments"
                            + (f"; it has {unknown[0]}" if unknown else ""))
        out.append(Row(tuple(entry["tests"]), entry["reason"], tuple(entry.get("arguments", []))))
    return out


def split(tests: list[Test], labels: set[str], table: list[Row]) -> tuple[list[Test], dict[str, str], list[Test]]:
    """The tests of the default tier; those of the full tier alone, by name with the reason; and the latter themselves.

    A row that matches no test is an error, where all labels are wanted: a test that was renamed would change its tier.
    """
    reasons = {test.name: AGAIN_REASON for test in tests if AGAIN in test.labels}
    extra: list[Test] = []
    for row in table:
        found = [test for test in tests if any(fnmatchcase(test.name, pattern) for pattern in row.tests)]
        idle = [p for p in row.tests if not any(fnmatchcase(test.name, p) for test in tests)]
        if idle and labels >= set(LABELS):
            raise UserError(f"{shown(TABLE)}: no test is called {idle[0]}")
        if row.arguments:
            for test in (t for t in found if AGAIN not in t.labels):
                extra.append(Test(f"{test.name}-all", [*test.command, *row.arguments], test.labels, test.needs, test.properties))
                reasons[f"{test.name}-all"] = row.reason
        else:
            reasons |= {test.name: row.reason for test in found}
    everything = [*tests, *extra]
    return ([t for t in everything if t.name not in reasons], reasons, [t for t in everything if t.name in reasons])


def needs_of_full(tests: list[Test]) -> Needs:
    """Targets that the full tier builds as well: every image, and every program of the sanitizer presets, tests or not."""
    labels = {label for test in tests for label in test.labels}
    out: Needs = needs_of_firmware(*boards.PRESETS) if "target" in labels else frozenset()
    if labels & {"unit", "loop", "fuzz"}:
        out |= frozenset().union(*map(needs, SANITIZED))
    return out
