"""Are two logs the same? Compared as the bit patterns of what the numbers parse to."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

from reflux.errors import UserError
from reflux.logs import FIRMWARE_PREFIX, Log, bare, read
from reflux.paths import shown

EXACT = ("number", "time")  # whole numbers and long times: more digits than a float32 has


@dataclass(frozen=True)
class Difference:
    row: int
    sample: str
    column: str
    left: str
    right: str


def excluded(column: str) -> bool:
    """Columns that differ from run to run by their nature: wall-clock and statistics."""
    name = bare(column).removeprefix(FIRMWARE_PREFIX)
    return name.startswith(("stat.", "wall")) or ".wall" in name


def bits(cell: str, single: bool) -> bytes | str:
    """The bit pattern a number parses to; text stays text. -0 and 0 differ, NaN equals NaN."""
    try:
        value = float(cell)
    except ValueError:
        return cell
    try:
        return struct.pack("<f" if single else "<d", value)
    except OverflowError:
        return cell


def compare(left: Log, right: Log, limit: int = 1) -> list[Difference]:
    """The first differences, in order of samples. Different columns are a UserError: nothing to compare."""
    columns = [c for c in left.columns if not excluded(c)]
    others = [c for c in right.columns if not excluded(c)]
    if columns != others:
        only = sorted(set(columns) ^ set(others)) or ["their order"]
        raise UserError(f"{left.source} and {right.source} do not have the same columns: {', '.join(only[:6])}")
    plan = []
    for column in columns:
        name = bare(column)
        single = name.startswith(FIRMWARE_PREFIX) and name.removeprefix(FIRMWARE_PREFIX) not in EXACT
        plan.append((column, left.columns.index(column), right.columns.index(column), single))
    found: list[Difference] = []
    for k, (a, b) in enumerate(zip(left.rows, right.rows)):
        for column, i, j, single in plan:
            if a[i] != b[j] and bits(a[i], single) != bits(b[j], single):
                found.append(Difference(k + 1, a[0], column, a[i], b[j]))
        if len(found) >= limit:
            return found[:limit]
    if len(left.rows) != len(right.rows):
        found.append(Difference(min(len(left.rows), len(right.rows)) + 1, "-", "(rows)",
                                str(len(left.rows)), str(len(right.rows))))
    return found[:limit]


def log_of(place: Path) -> Path:
    """An output folder of tools/run or tools/commission stands for the log in it."""
    path = place
    if place.is_dir():
        path = next((place / name for name in ("log.csv", "telemetry.csv") if (place / name).is_file()), place / "log.csv")
    if not path.is_file():
        raise UserError(f"{shown(place)}: no log.csv there" if place.is_dir() else f"{shown(place)}: no such file")
    return path


def compare_command(a: str, b: str) -> int:
    """tools/run --compare A B. 0 the same, 1 different."""
    left, right = read(log_of(Path(a))), read(log_of(Path(b)))
    differences = compare(left, right)
    if not differences:
        columns = sum(not excluded(c) for c in left.columns)
        print(f"the same: {len(left.rows)} samples, {columns} columns, bit for bit")
        return 0
    d = differences[0]
    if d.column == "(rows)":
        print(f"different: {left.source} has {d.left} rows, {right.source} {d.right}; equal up to there")
    else:
        print(f"different, first in sample {d.sample} (row {d.row}), column {d.column}: "
              f"{d.left} in {left.source}, {d.right} in {right.source}")
    return 1
