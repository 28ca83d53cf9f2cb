"""The report of a run: one HTML file that needs nothing else, for a browser and for paper."""

from __future__ import annotations

import base64
import html
from pathlib import Path

from reflux_tools import plots as plotting
from reflux_tools import table
from reflux_tools.runner import Result, events_in, replies_in, script_lines
from reflux_tools.scenario import relative

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


def esc(text: object) -> str:
    return html.escape(str(text))


def grid(header: list[str], rows: list[list[str]], text_columns: int = 2, total: str = "",
         kind: str = "") -> str:
    """A table; columns after the first few hold numbers. total: rows whose second cell says so stand out."""
    classes = ["" if i < text_columns else ' class="n"' for i in range(len(header))]
    head = "".join(f"<th{c}>{esc(h)}</th>" for c, h in zip(classes, header))
    body = []
    for row in rows:
        mark = ' class="total"' if total and len(row) > 1 and row[1] == total else ""
        body.append(f"<tr{mark}>" + "".join(f"<td{c}>{cell if cell.startswith('<span') else esc(cell)}</td>"
                                            for c, cell in zip(classes, row)) + "</tr>")
    thead = f"<thead><tr>{head}</tr></thead>" if any(header) else ""
    return f'<div class="wide"><table class="{kind}">{thead}<tbody>{"".join(body)}</tbody></table></div>'


def badge(passed: bool, yes: str = "pass", no: str = "fail") -> str:
    return f'<span class="verdict {"pass" if passed else "fail"}">{yes if passed else no}</span>'


def facts(result: Result) -> str:
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


def limits_table(result: Result) -> str:
    if not result.checks:
        return "<p>This scenario sets no limits.</p>"
    rows = []
    for c in result.checks:
        when = "whole run" if c.at_s is None else f"from {c.at_s:g} s"
        rows.append([c.loop, when, _metric(c.metric), table.figure(c.value), table.figure(c.most), badge(c.passed)])
    return grid(["loop", "window", "metric", "measured", "at most", ""], rows, text_columns=3)


def _metric(name: str) -> str:
    return {"iae": "IAE", "overshoot_percent": "overshoot [%]", "settling_s": "settling time [s]",
            "tv": "total variation", "max_error": "largest error"}[name]


def figures(plots: list[plotting.Plot]) -> str:
    out = []
    for plot in plots:
        data = base64.b64encode(plot.svg.encode()).decode()
        out.append(f'<figure><img alt="{esc(plot.caption)}" src="data:image/svg+xml;base64,{data}">'
                   f"<figcaption>{esc(plot.caption)}</figcaption></figure>")
    return "\n".join(out)


def events_table(result: Result) -> str:
    """What was done, and what the firmware said about it, in order of plant time."""
    rows = [(e.at_s, "plant", "", f"{e.name} = {e.value:g}") for e in result.scenario.events]
    rows += [(line.at_s, "console", "", line.text) for line in result.scenario.lines]
    rows += [(t, "firmware", level, f"{code} {text}".strip())
             for t, level, code, text in events_in(result.out / "transcript.txt")]
    rows.sort(key=lambda row: row[0])
    if not rows:
        return "<p>Nothing happened.</p>"
    return grid(["time [s]", "from", "level", "what"], [[f"{t:g}", *rest] for t, *rest in rows], text_columns=4)


def how_to_repeat(result: Result) -> str:
    s = result.scenario
    command = f"tools/run {relative(s.file)} --firmware {s.firmware} --seed {s.seed} --noise {s.noise:g}"
    return (f"<pre>{esc(command)}</pre><p class='note'>The same scenario, seed and noise give the same log, "
            "sample by sample; <code>tools/run --compare A B</code> tells whether two logs are the same.</p>")


def lines_sent(result: Result) -> str:
    lines = [line.text for line in script_lines(result.scenario) if line.at_s == 0]
    return f'<pre class="columns">{esc(chr(10).join(lines))}</pre>'


def page(result: Result, plots: list[plotting.Plot]) -> str:
    units = result.units()
    title = result.scenario.title
    said = replies_in(result.out / "transcript.txt", "version")
    failures = "".join(f"<li>{esc(f)}</li>" for f in result.failures())
    parts = [
        f"<h1>{esc(title)}</h1>",
        f'<p class="what">{badge(result.passed, "all limits kept", "limits missed")}</p>',
        f"<ul>{failures}</ul>" if failures else "",
        "<h2>What was run</h2>", facts(result),
        f"<pre>{esc(chr(10).join(said))}</pre>" if said else "",
        "<h2>Limits</h2>", limits_table(result),
        "<h2>How it went</h2>", figures(plots),
        "<h2>Loops, window by window</h2>",
        grid(table.loop_header(units), table.loop_rows(result.windows, units), total="whole run"),
        '<p class="note">A window runs from one change to the next. Over the whole run, overshoot and settling '
        "time are those of the worst setpoint step. Definitions: docs/scenarios.md.</p>",
        "<h2>What happened</h2>", events_table(result),
        "<h2>Console lines before the first sample</h2>", lines_sent(result),
        "<h2>How to repeat it</h2>", how_to_repeat(result),
    ]
    return ("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
            '<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<title>{esc(title)}</title><style>{CSS}</style></head><body>\n" + "\n".join(parts) + "\n</body></html>\n")


def write(result: Result) -> Path:
    """report.html and the plots as PNG files; returns the report."""
    plots = plotting.scenario_plots(result.log, result.scenario)
    plotting.write_pngs(plots, result.out)
    path = result.out / "report.html"
    path.write_text(page(result, plots), encoding="utf-8")
    return path


