"""The report of a run: one HTML file that needs nothing else, for a browser and for paper."""

from __future__ import annotations

from pathlib import Path
from typing import Sequence

from reflux import markup, table
from reflux import plots as plotting
from reflux.markup import Content, Markup, element, join, picture
from reflux.runner import Result, events_in, replies_in, script_lines
from reflux.scenario import relative

CSS = """
:root { color: #22292f; background: #fff; }
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.55rem; margin: 0 0 .2rem; }
h2 { font-size: 1.1rem; margin: 2.2rem 0 .6rem; border-bottom: 1px solid #d8dde3; padding-bottom: .2rem; }
.verdict { display: inline-block; padding: .15rem .7rem; border-radius: .9rem; font-weight: 600; }
.pass { color: #14532d; background: #dcf3e3; } .fail { color: #7f1d1d; background: #fbdede; }
.what { color: #55606b; margin: .2rem 0 1rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .88rem; width: 100%; }
th { text-align: left; font-weight: 600; border-bottom: 2px solid #aab3bd; padding: .3rem .6rem; vertical-align: bottom; }
td { border-bottom: 1px solid #e4e7eb; padding: .26rem .6rem; vertical-align: top; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr.total td { font-weight: 600; background: #f5f7f9; }
.facts td:first-child { color: #55606b; width: 12rem; } .facts td { overflow-wrap: anywhere; }
figure { margin: 1rem 0 1.6rem; } figure img { width: 100%; height: auto; }
figcaption { font-size: .86rem; color: #55606b; }
pre { background: #f5f7f9; padding: .7rem .9rem; font-size: .8rem; line-height: 1.4; overflow-x: auto; border-radius: .3rem; }
pre.columns { columns: 3 14rem; }
.note { font-size: .84rem; color: #55606b; }
@media print { body { max-width: none; margin: 0; font-size: 11pt; } figure, table, tr { break-inside: avoid; }
  h2 { break-after: avoid; } pre { white-space: pre-wrap; } }
"""


def grid(header: list[str], rows: Sequence[Sequence[Content]], text_columns: int = 2, total: str = "", kind: str = "") -> Markup:
    """A table; columns after the first few hold numbers. total: rows whose second cell says so stand out."""
    classes = ["" if i < text_columns else "n" for i in range(len(header))]

    def line(tag: str, cells: Sequence[Content], mark: str = "") -> Markup:
        return element("tr", *(element(tag, cell, class_=c) for c, cell in zip(classes, cells)), class_=mark)

    body = [line("td", row, "total" if total and len(row) > 1 and row[1] == total else "") for row in rows]
    head = [element("thead", line("th", header))] if any(header) else []
    return element("div", element("table", *head, element("tbody", *body), class_=kind), class_="wide")


def badge(passed: bool, yes: str = "pass", no: str = "fail") -> Markup:
    return element("span", yes if passed else no, class_="verdict pass" if passed else "verdict fail")


def note(*content: Content) -> Markup:
    return element("p", *content, class_="note")


def listed(lines: Sequence[str]) -> Markup:
    """A list; nothing where there are no lines."""
    return element("ul", *(element("li", line) for line in lines)) if lines else Markup("")


def facts(result: Result) -> Markup:
    f = result.facts
    scenario = result.scenario
    rows = [
        ["Scenario", f"{scenario.name} ({f['scenario_file']})"],
        ["Plant", str(f["plant"])],
        ["Firmware", f"{f['firmware']}: {f['version'] or 'it did not say its version'}"],
        ["Image", str(f["image"] or "on the board, not seen by this run")],
        ["Image SHA-256", str(f["image_sha256"] or "-")],
        ["Plant time", f"{scenario.duration_s / 3600:.4g} h, {f['samples']} samples"],
        ["Seed, noise", f"{scenario.seed}, {scenario.noise:g}"],
        ["Wall time", f"{f['wall_s']} s"],
    ]
    return grid(["", ""], rows, kind="facts")


def limits_table(result: Result) -> Markup:
    if not result.checks:
        return element("p", "This scenario sets no limits.")
    rows: list[list[Content]] = []
    for c in result.checks:
        when = "whole run" if c.at_s is None else f"from {c.at_s:g} s"
        rows.append([c.loop, when, _metric(c.metric), table.figure(c.value), table.figure(c.most), badge(c.passed)])
    return grid(["loop", "window", "metric", "measured", "at most", ""], rows, text_columns=3)


def _metric(name: str) -> str:
    return {"iae": "IAE", "overshoot_percent": "overshoot [%]", "settling_s": "settling time [s]",
            "tv": "total variation", "max_error": "largest error"}[name]


def figures(plots: list[plotting.Plot]) -> Markup:
    return join([picture(plot.svg.encode(), "svg+xml", plot.caption) for plot in plots], "\n")


def events_table(result: Result) -> Markup:
    """Actions and the firmware's answers, in order of plant time."""
    rows = [(e.at_s, "plant", "", f"{e.name} = {e.value:g}") for e in result.scenario.events]
    rows += [(line.at_s, "console", "", line.text) for line in result.scenario.lines]
    rows += [(t, "firmware", level, f"{code} {text}".strip())
             for t, level, code, text in events_in(result.out / "transcript.txt")]
    rows.sort(key=lambda row: row[0])
    if not rows:
        return element("p", "Nothing happened.")
    return grid(["time [s]", "from", "level", "what"], [[f"{t:g}", *rest] for t, *rest in rows], text_columns=4)


def how_to_repeat(result: Result) -> Markup:
    s = result.scenario
    command = f"tools/run {relative(s.file)} --firmware {s.firmware} --seed {s.seed} --noise {s.noise:g}"
    return join([element("pre", command), note("The same scenario, seed and noise give the same log, sample by sample; ",
                                               element("code", "tools/run --compare A B"), " tells whether two logs are the same.")])


def lines_sent(result: Result) -> Markup:
    return element("pre", "\n".join(line.text for line in script_lines(result.scenario) if line.at_s == 0), class_="columns")


def page(result: Result, plots: list[plotting.Plot]) -> str:
    units = result.units()
    title = result.scenario.title
    said = replies_in(result.out / "transcript.txt", "version")
    parts = [
        element("h1", title),
        element("p", badge(result.passed, "all limits kept", "limits missed"), class_="what"),
        listed(result.failures()),
        element("h2", "What was run"), facts(result),
        element("pre", "\n".join(said)) if said else "",
        element("h2", "Limits"), limits_table(result),
        element("h2", "How it went"), figures(plots),
        element("h2", "Loops, window by window"),
        grid(table.loop_header(units), table.loop_rows(result.windows, units), total="whole run"),
        note("A window runs from one change to the next. Over the whole run, overshoot and settling "
             "time are those of the worst setpoint step. Definitions: docs/scenarios.md."),
        element("h2", "What happened"), events_table(result),
        element("h2", "Console lines before the first sample"), lines_sent(result),
        element("h2", "How to repeat it"), how_to_repeat(result),
    ]
    return markup.page(title, CSS, parts)


def write(result: Result) -> Path:
    """report.html and the plots as PNG files; returns the report."""
    plots = plotting.scenario_plots(result.log, result.scenario)
    plotting.write_pngs(plots, result.out)
    path = result.out / "report.html"
    path.write_text(page(result, plots), encoding="utf-8")
    return path


