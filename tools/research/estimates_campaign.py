"""The campaign of composition estimation: every structure of the source under every scenario, beside what she and a fresh reading of her
say; then noise, a thermometer that lies or is missing, other forms."""

from __future__ import annotations

import argparse
import hashlib
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

from reflux import build, table
from research import estimates, estimates_other_plants, trays, trays_campaign
from reflux.errors import RunFailed, UserError
from research.estimates import Case
from reflux.paths import CAMPAIGNS, ROOT
from reflux.schema import Table

LISTS = {"bias": 2}


@dataclass(frozen=True)
class Row:
    case: Case
    note: str  # what is different in it
    source: str
    fresh: str


@dataclass(frozen=True)
class Part:
    title: str
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Estimates:
    name: str
    title: str
    about: str
    parts: tuple[Part, ...]
    other_plants: tuple[estimates_other_plants.OtherPlant, ...] = ()

    def cases(self, fraction: float) -> list[Case]:
        wanted = list(dict.fromkeys(row.case for part in self.parts for row in part.rows))
        return wanted[:: max(1, round(1 / fraction))]


def changed(case: Case, words: str) -> Case:
    """`method=rekf noise=0.2 bias=30:2` of the fields of a case."""
    types = {f.name: f for f in fields(Case)}
    for word in words.split():
        name, _, text = word.partition("=")
        if name not in types or not text:
            raise UserError(f'"{word}": must be FIELD=VALUE with one of {", ".join(types)}')
        default = getattr(Case("-"), name)
        value: Any = text
        if isinstance(default, tuple):
            stage, _, amount = text.partition(":")
            value = (int(stage), float(amount))
        elif isinstance(default, bool):
            value = text == "yes"
        elif isinstance(default, (int, float)):
            value = type(default)(float(text))
        case = replace(case, **{name: value})
    return case


def load(top: Table, name: str) -> Estimates:
    title, about = top.text("title", name), " ".join(top.texts("about"))
    parts = []
    for one in top.tables("table"):
        heading = one.text("title")
        base = changed(Case("-"), one.text("all", ""))
        rows = []
        for line in one.tables("line"):
            structure, words = line.text("structure"), line.text("with", "")
            estimates.sensing(structure)
            rows.append(
                Row(
                    changed(replace(base, structure=structure), words),
                    words,
                    line.text("source", ""),
                    line.text("fresh", ""),
                )
            )
            line.done()
        one.done()
        parts.append(Part(heading, tuple(rows)))
    other_plants = tuple(estimates_other_plants.load(one, CAMPAIGNS) for one in top.tables("elsewhere"))
    top.done()
    return Estimates(name, title, about, tuple(parts), other_plants)


def fingerprint(campaign: Estimates) -> str:
    digest = hashlib.sha256()
    for file in (
        Path(__file__),
        Path(estimates.__file__),
        Path(estimates_other_plants.__file__),
        *(f for of in campaign.other_plants for f in (of.file, of.file.with_suffix(".conf"))),
        Path(trays.__file__),
        ROOT / "host_sim" / "plants" / "splitter.json",
        build.find_program("host", "reflux-sim-memory"),
        build.find_program("host", "reflux-sim"),
    ):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def job_of(case: Case) -> dict[str, Any]:
    return {**asdict(case), "bias": f"{case.bias[0]}:{case.bias[1]:g}"}


def run_one(case: Case) -> dict[str, Any]:
    """In a process of its own. A run that fails is a result too."""
    try:
        return {"job": job_of(case), **asdict(estimates.measure(case))}
    except (RunFailed, UserError) as error:
        return {"job": job_of(case), "failed": str(error)}


# ---- tables ----


def milli(x: float) -> str:
    return f"{1000 * x:+.1f}"


def header_of(part: Part) -> list[str]:
    out = ["structure", "with"]
    for p in estimates.points(part.rows[0].case):
        out += [f"{p}: initial", "least", "most", "final", "outside, h"]
    if any(row.case.use for row in part.rows):
        return [*out, "alarms and notes", "called good, %", "IAE of iC4_D", "least", "most", "final"]
    return [*out, "alarms and notes", "called good, %", "source", "fresh reading"]


def row_of(row: Row, result: dict[str, Any] | None, used: bool = False) -> list[str]:
    head = [row.case.structure, row.note]
    if result is None or "failed" in result:
        cells = [*head, "not run" if result is None else "failed"]
        return cells + [""] * (len(header_of(Part("", (row,)))) - len(cells))
    cells = head
    for p in estimates.points(row.case):
        e = result["error"][p]
        cells = [*cells, *(milli(e[k]) for k in ("initial", "low", "high", "final"))]
        cells.append(f"**{e['outside_h']:.2f}**" if e["outside_h"] > 0 else "0")
    cells += [", ".join(result["said"]), f"{100 * result['good']:.0f}"]
    if not used:
        return [*cells, row.source, row.fresh]
    i = result["impurity"]["iC4"]
    return [*cells, *(f"{1000 * i[k]:.1f}" for k in ("iae", "low", "peak", "final"))]


def write_results(campaign: Estimates, state: Any, folder: Path) -> None:
    text = [f"# {campaign.title}\n\nWritten by `tools/campaign {campaign.name}`. {campaign.about}\n"]
    for part in campaign.parts:
        used = any(row.case.use for row in part.rows)
        rows = [row_of(row, state.get(job_of(row.case)), used) for row in part.rows]
        text.append(f"\n## {part.title}\n\n" + table.markdown(header_of(part), rows))
    for of in campaign.other_plants:
        rows = estimates_other_plants.rows_of(of, state)
        text.append(f"\n## {of.title}\n\nIn {of.unit}.\n\n" + table.markdown(estimates_other_plants.header_of(of), rows))
    (folder / f"{campaign.name}.md").write_text("".join(text) + "\n", encoding="utf-8")


def execute(campaign: Estimates, options: argparse.Namespace, state: Any) -> int:
    cases = campaign.cases(options.fraction)
    trays_campaign.run_missing(cases, state, options.jobs, job_of, run_one)
    results = [state.get(job_of(c)) for c in cases]
    for of in campaign.other_plants if options.fraction == 1.0 else ():
        for way in of.ways:
            if state.get(estimates_other_plants.job_of(of, way)) is None:
                state.add(estimates_other_plants.measure(of, way))
    if not options.check and options.fraction == 1.0:
        write_results(campaign, state, options.results)
    for part in campaign.parts:
        found = [(row, state.get(job_of(row.case))) for row in part.rows]
        used = any(row.case.use for row in part.rows)
        shown = [row_of(row, result, used) for row, result in found if result]
        if shown:
            end = None if used else -2  # without what others say
            print(f"\n{part.title}, in 1e-3\n" + table.columns(header_of(part)[:end], [row[:end] for row in shown]))
    for of in campaign.other_plants if options.fraction == 1.0 else ():
        rows = estimates_other_plants.rows_of(of, state)
        print(f"\n{of.title}, {of.unit}\n" + table.columns(estimates_other_plants.header_of(of), rows))
    failed = [r for r in results if "failed" in r]
    for r in failed[:10]:
        print(f"FAILED  {r['job']['structure']}: {r['failed']}")
    print(f"\n{len(results)} runs, {len(failed)} failed")
    return 1 if failed else 0
