"""The report of a run: one HTML file that needs nothing else, for a browser and for paper."""

from __future__ import annotations

from pathlib import Path

from reflux import event_sentences, limits, logs, margins, markup, metrics, run_margins, run_plots, scenario_settings, table
from reflux import plots as plotting
from reflux.markup import Content, Markup, element, join
from reflux.page_style import CSS, PHONE_PX, badge, grid, listed, note
from reflux.paths import INSTALLED, SCENARIOS, tool
from reflux.runner import Result, events_in, replies_in, script_lines
from reflux.scenario import relative

def facts(result: Result) -> Markup:
    f = result.facts
    scenario = result.scenario
    rows = [
        ["Scenario", f"{scenario.name} ({f['scenario_file']})"],
        ["Plant", str(f["plant"])],
        *([["Connected", f"on the board's own pins ({f['wiring']}), no plant link"]] if "wiring" in f else []),
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
    units = result.units()
    for c in result.checks:
        when = "whole run" if c.at_s is None else f"from {c.at_s:g} s"
        rows.append([c.loop, when, _metric(c, units), table.figure(c.value), table.figure(c.most), badge(c.passed)])
    return grid(["loop", "window", "metric", "measured", "at most", ""], rows, text_columns=3)


def _metric(c: limits.Check, units: dict[str, tuple[str, str]]) -> str:
    y, u = (unit.strip("-") for unit in units.get(c.loop, ("", "")))
    unit = limits.UNITS[c.metric].format(y=y, u=u).strip()
    return f"{limits.TITLES[c.metric]} [{unit}]" if unit else limits.TITLES[c.metric]


def drawing(plot: plotting.Plot) -> Markup:
    """A plot in the page: an SVG, and a narrow one for a phone."""
    return markup.picture(plot.svg.encode(), "svg+xml", plot.caption, plot.alt, plot.narrow.encode(), PHONE_PX)


def figures(plots: list[plotting.Plot]) -> Markup:
    return join([drawing(plot) for plot in plots], "\n")


def margins_part(found: run_margins.Found) -> list[Content]:
    """Gain margin, phase margin and Ms of each loop, or why there are none."""
    if not found.loops:
        return [note(f"No margins: {found.why_not}.")]
    return [grid(["loop", *margins.HEADER], [[name, *m.cells()] for name, m in found.loops], text_columns=1),
            note("On the plant's linearisation at its steady state, with the settings before the first sample. ", margins.NOTE)]


def never_settled(result: Result) -> list[str]:
    """What stands behind each "never" in the table of windows."""
    units = result.units()
    out = []
    for loop in result.scenario.loops:
        for w in result.windows:
            if w.loop == loop.name and w.kind != "overall" and w.settling_s is not None and w.settling_s != w.settling_s:
                out.append(metrics.why_never(result.log, loop, w, units.get(loop.name, ("", ""))))
    return out


def events_table(result: Result) -> Markup:
    """Actions and the firmware's answers, in order of plant time."""
    names = event_sentences.names_of(scenario_settings.values_of(scenario_settings.lines_of(result.scenario)),
                                     lambda channel: logs.channel_unit(result.log, channel))
    rows = [(e.at_s, "plant", "", f"{e.name} = {e.value:g}") for e in result.scenario.events]
    rows += [(line.at_s, "console", "", line.text) for line in result.scenario.lines]
    rows += [(t, "firmware", level, event_sentences.sentence(level, code, text, names))
             for t, level, code, text in events_in(result.out / "transcript.txt")]
    rows.sort(key=lambda row: row[0])
    if not rows:
        return element("p", "Nothing happened.")
    return grid(["time [s]", "from", "level", "what"], [[f"{t:.10g}", *rest] for t, *rest in rows], text_columns=4)


def how_to_repeat(result: Result) -> Markup:
    s = result.scenario
    file = s.file.stem if INSTALLED and s.file.parent == SCENARIOS else relative(s.file)
    command = f"{tool('run')} {file} --firmware {s.firmware} --seed {s.seed} --noise {s.noise:g}"
    return join([element("pre", command), note("The same scenario, seed and noise give the same log, sample by sample; ",
                                               element("code", f"{tool('run')} --compare A B"), " tells whether two logs are the same.")])


def lines_sent(result: Result) -> Markup:
    return element("pre", "\n".join(line.text for line in script_lines(result.scenario) if line.at_s == 0), class_="columns")


def page(result: Result, plots: list[plotting.Plot], found: run_margins.Found | None = None) -> str:
    units = result.units()
    title = result.scenario.title
    said = replies_in(result.out / "transcript.txt", "version")
    parts = [
        element("h1", title),
        element("p", badge(result.passed, "all limits kept", "limits missed") if result.checks else "", class_="what"),
        listed(result.failures()),
        element("h2", "What was run"), facts(result),
        element("pre", "\n".join(said)) if said else "",
        element("h2", "Limits"), limits_table(result),
        element("h2", "How it went"), figures(plots),
        element("h2", "Loops, window by window"),
        grid(table.loop_header(units), table.loop_rows(result.windows, units), total="whole run"),
        note("A window runs from one change to the next. Over the whole run, overshoot and settling "
             "time are those of the worst setpoint step. A dash: nothing was stepped. Definitions: docs/use/scenarios.md."),
        listed(never_settled(result)),
        *([element("h2", "Margins"), *margins_part(found)] if found else []),
        element("h2", "What happened"), events_table(result),
        element("h2", "Console lines before the first sample"), lines_sent(result),
        element("h2", "How to repeat it"), how_to_repeat(result),
    ]
    return markup.page(title, CSS, parts)


def write(result: Result) -> Path:
    """report.html and the plots as PNG files; returns the report."""
    plots = run_plots.scenario_plots(result.log, result.scenario, events_in(result.out / "transcript.txt"))
    plotting.write_pngs(plots, result.out)
    path = result.out / "report.html"
    found = run_margins.of_scenario(result.scenario, result.scenario.plant_argument) if result.scenario.loops else None
    path.write_text(page(result, plots, found), encoding="utf-8")
    return path


