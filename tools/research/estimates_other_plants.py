"""Estimates on columns that the source has not: a shipped scenario in several ways, each with more console lines of its own."""

from __future__ import annotations

import statistics
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from reflux import runner, scenario
from reflux.scenario import Line
from reflux.schema import Table

HOUR = 3600.0


@dataclass(frozen=True)
class Way:
    name: str
    config: tuple[str, ...]
    lines: tuple[tuple[float, str], ...]


@dataclass(frozen=True)
class OtherPlant:
    title: str
    file: Path
    unit: str
    pairs: tuple[tuple[str, str], ...]  # estimate, truth
    from_s: float
    ways: tuple[Way, ...]


def load(one: Table, folder: Path) -> OtherPlant:
    ways = []
    for way in one.tables("way"):
        lines = tuple((float(t), text) for t, _, text in (line.partition(" ") for line in way.texts("lines", [])))
        ways.append(Way(way.text("name"), tuple(way.texts("config", [])), lines))
        way.done()
    out = OtherPlant(
        one.text("title"),
        (folder / one.text("scenario")).resolve(),
        one.text("unit"),
        tuple(tuple(pair.split()) for pair in one.texts("pairs")),
        one.number("from_s"),
        tuple(ways),
    )
    one.done()
    return out


def job_of(of: OtherPlant, way: Way) -> dict[str, Any]:
    return {"elsewhere": of.title, "way": way.name, "lines": repr((way.config, way.lines, of.pairs))}


def measure(of: OtherPlant, way: Way) -> dict[str, Any]:
    base = scenario.load(of.file)
    config = [line for line in base.config if line.text != "apply"] + [Line(0.0, x) for x in (*way.config, "apply")]
    said = {tuple(text.split()[:2]) for _, text in way.lines}  # in place of what the scenario says of the same
    kept = [line for line in base.lines if tuple(line.text.split()[:2]) not in said]
    lines = sorted([*kept, *(Line(at, text) for at, text in way.lines)], key=lambda line: line.at_s)
    played = replace(base, firmware="memory", limits=(), config=tuple(config), lines=tuple(lines))
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        log = runner.run(played, runner.Options(Path(folder) / "out", quiet=True)).log
    t = log.numbers("time")
    after = [k for k, x in enumerate(t) if x > of.from_s]
    last = [k for k in after if t[k] > t[-1] - HOUR / 2]
    out: dict[str, Any] = {"job": job_of(of, way)}
    for estimate, truth in of.pairs:
        y = log.numbers(truth)
        e = [a - b for a, b in zip(log.numbers(f"fw.{estimate}"), y)]
        out[truth] = [
            min(y[k] for k in after),
            max(y[k] for k in after),
            statistics.fmean(y[k] for k in last),
            min(e[k] for k in after),
            max(e[k] for k in after),
            statistics.fmean(e[k] for k in last),
        ]
    return out


def header_of(of: OtherPlant) -> list[str]:
    out = [""]
    for _, truth in of.pairs:
        out += [f"{truth}: least", "most", "final", "estimate's error: least", "most", "final"]
    return out


def rows_of(of: OtherPlant, state: Any) -> list[list[str]]:
    rows = []
    for way in of.ways:
        result = state.get(job_of(of, way))
        row = [way.name]
        for _, truth in of.pairs:
            row += [f"{x:.4g}" for x in result[truth]] if result else ["-"] * 6
        rows.append(row)
    return rows
