"""The campaign of the filter of 1989 (tools/research/kalman_1989.py): what he had, what made the difference, what the one that works
bears."""

from __future__ import annotations

import argparse
import hashlib
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

from reflux import build, table
from research import kalman_1989, trays_campaign
from reflux.errors import RunFailed, UserError
from research.kalman_1989 import DRUM, MEASURED, REBOILER, STEPS, TRAYS, UNMEASURED, Case
from reflux.paths import ROOT
from reflux.schema import Table

SHOWS = ("both", "trays", "steps")


@dataclass(frozen=True)
class Row:
    case: Case
    name: str
    note: str  # what is different in it
    source: str


@dataclass(frozen=True)
class Part:
    title: str
    shows: str
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class PilotKalman:
    name: str
    title: str
    about: str
    parts: tuple[Part, ...]

    def cases(self, fraction: float) -> list[Case]:
        wanted = list(dict.fromkeys(row.case for part in self.parts for row in part.rows))
        return wanted[:: max(1, round(1 / fraction))]


def changed_in(case: Any, words: str) -> Any:
    """`method=kalman feed_z=0 flow=yes` of the fields of a case."""
    known = {f.name: getattr(case, f.name) for f in fields(case)}
    for word in words.split():
        name, _, text = word.partition("=")
        if name not in known or not text:
            raise UserError(f'"{word}": must be FIELD=VALUE with one of {", ".join(known)}')
        value: Any = text
        if isinstance(known[name], bool):
            value = text == "yes"
        elif isinstance(known[name], (int, float)):
            value = type(known[name])(float(text))
        case = replace(case, **{name: value})
    return case


def load(top: Table, name: str) -> PilotKalman:
    title, about = top.text("title", name), " ".join(top.texts("about"))
    parts = []
    for one in top.tables("table"):
        heading, shows = one.text("title"), one.text("shows", "both", choices=SHOWS)
        base = changed_in(Case(), one.text("all", ""))
        rows = []
        for line in one.tables("line"):
            words = line.text("with", "")
            rows.append(Row(changed_in(base, words), line.text("name", ""), words, line.text("source", "")))
            line.done()
        one.done()
        parts.append(Part(heading, shows, tuple(rows)))
    top.done()
    return PilotKalman(name, title, about, tuple(parts))


def fingerprint(_: PilotKalman) -> str:
    digest = hashlib.sha256()
    for file in (
        Path(kalman_1989.__file__),
        kalman_1989.REFERENCE,
        ROOT / "host_sim" / "plants" / f"{kalman_1989.PLANT}.json",
        build.find_program("host", "reflux-sim-memory"),
        build.find_program("host", "reflux-sim"),
    ):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def run_one(case: Case) -> dict[str, Any]:
    """In a process of its own. A run that fails is a result too."""
    try:
        return {"job": asdict(case), **asdict(kalman_1989.measure(case))}
    except (RunFailed, UserError) as error:
        return {"job": asdict(case), "failed": str(error)}


# ---- tables: mole fractions in 1e-3 ----


def size(x: float) -> str:
    """Beyond the band in bold."""
    text = f"{1000 * abs(x):.1f}"
    return f"**{text}**" if abs(x) > kalman_1989.BAND else text


def left(x: float) -> str:
    text = f"{1000 * x:+.1f}"
    return f"**{text}**" if abs(x) > kalman_1989.BIAS else text


def worst(values: list[float], stages: tuple[int, ...]) -> float:
    return max((values[s - 1] for s in stages), key=abs)


def of_trays(trays: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(kalman_1989.stage_of(t) for t in trays)


def header_of(part: Part) -> list[str]:
    if part.shows == "trays":
        return ["filter", "", *(f"tray {t}" for t in range(1, TRAYS + 1)), "drum", "reboiler"]
    if part.shows == "steps":
        return ["filter", "", *(f"{name}: most" if k == 0 else "left" for name, _, _ in STEPS for k in range(2))]
    out = ["filter", "by", "with"]
    for where in ("with a thermometer", "without"):
        out += [f"trays {where}: most", "left", "unrest"]
    out += ["drum, reboiler: most", "left", "within", "outside, min", "called good, %"]
    return out if no_source(part) else [*out, "source"]


def no_source(part: Part) -> bool:
    return not any(row.source for row in part.rows)


def rows_of(part: Part, row: Row, result: dict[str, Any] | None) -> list[list[str]]:
    width = len(header_of(part))
    if result is None or "failed" in result:
        cells = [row.name, row.case.by, "not run" if result is None else "failed"]
        return [cells + [""] * (width - len(cells))]
    if part.shows == "trays":
        stages = (*of_trays(tuple(range(1, TRAYS + 1))), DRUM, REBOILER)
        return [
            [row.name, "most", *(size(result["most"][s - 1]) for s in stages)],
            ["", "left", *(left(result["bias"][s - 1]) for s in stages)],
        ]
    if part.shows == "steps":
        cells = [row.name, ""]
        for most, there, back in result["by_step"]:
            cells += [size(most), left(max(there, back, key=abs))]
        return [cells]
    cells = [row.name, row.case.by, " ".join(word for word in row.note.split() if not word.startswith("by="))]
    for trays in (MEASURED, UNMEASURED):
        stages = of_trays(trays)
        cells += [size(worst(result["most"], stages)), left(worst(result["bias"], stages))]
        cells.append(f"{1000 * worst(result['restless'], stages):.1f}")
    ends = (DRUM, REBOILER)
    cells += [size(worst(result["most"], ends)), left(worst(result["bias"], ends))]
    cells += ["yes" if reached(result) else "no", f"{result['outside_s'] / 60:.1f}"]
    cells.append("" if row.case.by != "firmware" else f"{100 * result['good']:.0f}")
    return [cells if no_source(part) else [*cells, row.source]]


def reached(result: dict[str, Any]) -> bool:
    stages = of_trays(MEASURED + UNMEASURED)
    return (
        worst(result["most"], stages) <= kalman_1989.BAND and abs(worst(result["bias"], stages)) <= kalman_1989.BIAS
    )


def lines_of(part: Part, state: Any) -> list[list[str]]:
    return [line for row in part.rows for line in rows_of(part, row, state.get(asdict(row.case)))]


def write_results(campaign: PilotKalman, state: Any, folder: Path) -> None:
    text = [f"# {campaign.title}\n\nWritten by `tools/campaign {campaign.name}`. {campaign.about}\n"]
    for part in campaign.parts:
        text.append(f"\n## {part.title}\n\n" + table.markdown(header_of(part), lines_of(part, state)) + "\n")
    (folder / f"{campaign.name}.md").write_text("".join(text), encoding="utf-8")


def execute(campaign: PilotKalman, options: argparse.Namespace, state: Any) -> int:
    cases = campaign.cases(options.fraction)
    trays_campaign.run_missing(cases, state, options.jobs, asdict, run_one)
    results = [state.get(asdict(c)) for c in cases]
    if not options.check and options.fraction == 1.0:
        write_results(campaign, state, options.results)
    for part in campaign.parts if options.fraction == 1.0 else ():
        shown = lines_of(part, state)
        end = None if no_source(part) or part.shows != "both" else -1  # without what he says
        print(f"\n{part.title}, in 1e-3\n" + table.columns(header_of(part)[:end], [row[:end] for row in shown]))
    failed = [r for r in results if "failed" in r]
    for r in failed[:10]:
        print(f"FAILED  {r['job']}: {r['failed']}")
    print(f"\n{len(results)} runs, {len(failed)} failed")
    return 1 if failed else 0
