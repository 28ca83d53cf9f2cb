"""Duration of tests: as the last run here measured, else what tests/times.txt keeps from a machine with two cores."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path

from reflux.paths import ROOT, build_dir
from dev.testing.entries import LABELS, Test

KEPT = ROOT / "tests" / "times.txt"
UNKNOWN_S = 1.0


def measured_path() -> Path:
    """Seconds of the last runs on this machine."""
    return build_dir("test") / "times.json"


def load() -> dict[str, float]:
    """Seconds of each test by its name."""
    out: dict[str, float] = {}
    for line in KEPT.read_text(encoding="utf-8").splitlines() if KEPT.is_file() else []:
        if line and not line.startswith("#"):
            seconds, name = line.split()
            out[name] = float(seconds)
    try:
        out |= {str(k): float(v) for k, v in json.loads(measured_path().read_text(encoding="utf-8")).items()}
    except (OSError, ValueError, AttributeError):
        pass  # nothing has been measured here
    return out


def store(seconds: dict[str, float]) -> None:
    """Keeps what a run measured, for the next one."""
    path = measured_path()
    try:
        known = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        known = {}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({**known, **seconds}, indent=0, sort_keys=True), encoding="utf-8")


def keep(tests: list[Test], seconds: dict[str, float]) -> None:
    """Writes tests/times.txt."""
    lines = [f"{seconds[t.name]:.2f} {t.name}\n" for t in sorted(tests, key=lambda t: t.name) if t.name in seconds]
    KEPT.write_text("# Seconds of each test on two cores, written by tools/test --keep-times. Only order and forecasts depend on them.\n"
                    + "".join(lines), encoding="utf-8")


def by_label(tests: list[Test], seconds: dict[str, float], jobs: int) -> str:
    """`unit 300 tests about 80 s, loop ...`; seconds of wall time if each label ran alone."""
    totals: dict[str, float] = defaultdict(float)
    counts: dict[str, int] = defaultdict(int)
    for test in tests:
        label = next((x for x in LABELS if x in test.labels), "other")
        totals[label] += seconds.get(test.name, UNKNOWN_S)
        counts[label] += 1
    return ", ".join(f"{label} {counts[label]} tests about {totals[label] / jobs:.0f} s" for label in LABELS if counts[label])
