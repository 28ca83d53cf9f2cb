"""The report of a start-up: one HTML file that needs nothing else."""

from __future__ import annotations

from pathlib import Path

from reflux import event_sentences, margins, markup
from reflux import plots as plotting
from reflux.commission import closed_loops, figures, results_text, second_opinions
from reflux.commission.record import Record, load
from reflux.commission.progress import span_of_time
from reflux.markup import Content, Markup, element
from reflux.page_style import CSS, badge, doubtful, folded, grid, listed, note
from reflux.paths import tool
from reflux.report import drawing

FLAGS = {
    "no_gain": "the gain cannot be told from noise: the times mean nothing",
    "short": "the test was short for what was found",
    "not_settled": "still moving when the test ended",
    "integrating": "looks like an integrator",
    "inverse": "moved the wrong way first",
    "oscillatory": "turned more often than a first-order response can",
}


def facts(r: Record) -> Markup:
    names = [e.code for e in r.events]
    time = {code: next((e.at_s for e in r.events if e.code == code), None) for code in names}
    began = time.get("COMMISSION_BEGUN")
    ended = next((e.at_s for e in reversed(r.events) if e.code in
                  ("TRIAL_KEPT", "TRIAL_FAILED", "COMMISSION_ENDED", "PROPOSAL", "NOT_DETERMINED")), None)
    analysed = time.get("PROPOSAL", time.get("NOT_DETERMINED"))
    rows = [["Plant", r.plant.name if r.plant else "-"],
            ["Sample interval", f"{r.plant.tick_s:g} s" if r.plant else "-"],
            ["Board", r.version[0] if r.version else "-"]]
    slowest = max((e.time_s + e.dead_s for e in r.model.elements.values() if e.has_gain), default=0.0)
    if began is not None and ended is not None:
        tests = (analysed or ended) - began
        words = span_of_time(tests)
        if 0 < slowest <= tests:
            words += f", {tests / slowest:.0f} times the slowest element's dead time and time constant"
        rows.append(["Tests took", words])
        rows.append(["Until the end", span_of_time(ended - began)])
    tested = len({name for e in r.experiments for name in figures.moved_in(r, e)})
    rows.append(["Tests", f"{len(r.experiments)}, of {tested} input{'s' if tested != 1 else ''}"])
    return grid(["", ""], rows, kind="facts")


def flags_used(r: Record) -> Markup:
    used = [f for f in FLAGS if any(f in e.flags for e in r.model.elements.values())]
    return listed([f"{f}: {FLAGS[f]}" for f in used])


def tests_part(r: Record, pictures: dict[str, plotting.Plot]) -> list[Content]:
    parts = [element("h2", "Tests"), grid(*results_text.input_rows(r.model), text_columns=1) if r.model.inputs else ""]
    return parts + [drawing(p) for name, p in pictures.items() if name.startswith("test")]


def model_part(r: Record) -> list[Content]:
    if not r.model.elements:
        return []
    header, rows = results_text.model_rows(r.model)
    return [element("h2", "Model"),
            note("Each element: gain exp(-L s) / (T s + 1), or with the lags and the zero of the last column, by least squares over all rounds, with "
                 "standard deviations. Loops and predictions come from this model. docs/methods/identification.md says how."),
            grid(header, rows, text_columns=2), flags_used(r), *second_opinions_part(r), *direction_part(r)]


def second_opinions_part(r: Record) -> list[Content]:
    """Methods that contradict the fit, with the reason: folded, because no setting comes from them."""
    header, rows = second_opinions.second_opinion_rows(r.model)
    if not rows:
        return []
    agree = sum("differs" not in row[-1] for row in rows)
    return [folded(f"Second opinions, which noise spoils first and from which no setting comes: {agree} of {len(rows)} gains agree within {100 * second_opinions.AGREE:.0f} %",
                   note("Both look at the last round of a test alone. Weighted moments need a test that ends at rest and without drift, and "
                        "their error goes into T and L with opposite signs; the plateau is a difference of two means and needs rest on both "
                        "sides. The fit uses all rounds at once and knows level and drift, so it counts where they differ."),
                   grid(header, rows, text_columns=2))]


def direction_part(r: Record) -> list[Content]:
    if not r.model.direction:
        return []
    return [note(results_text.direction_words(r.model)), grid(*results_text.direction_rows(r.model), text_columns=1)]


def analysis_part(r: Record, pictures: dict[str, plotting.Plot]) -> list[Content]:
    if not r.gains.singular:
        return []
    parts: list[Content] = [element("h2", "Interaction"), listed(results_text.gains_words(r.gains))]
    if r.gains.rga:
        parts += [element("p", "Relative gains at rest:"), grid(*results_text.rga_rows(r.gains), text_columns=1)]
    parts += [drawing(pictures[name]) for name in ("rga", "singular") if name in pictures]
    if "rga" not in pictures:
        parts.append(note("No relative gains along the frequency: the plant has none, or libreflux is not built "
                          "(cmake --build --preset host --target libreflux)."))
    parts += [element("h2", "Pairing and structure")]
    if r.pairing.pairs:
        parts += [grid(*results_text.pairing_rows(r.pairing)),
                  note("Share of draws: gains are drawn anew within their standard deviations; the share of them that gives this pair, too.")]
    parts.append(listed([*results_text.pairing_words(r.pairing), *results_text.structure_words(r.structure)]))
    return parts


def proposal_part(r: Record, pictures: dict[str, plotting.Plot]) -> list[Content]:
    p = r.proposal
    if not (p.why_not or p.loops):
        return []
    parts: list[Content] = [element("h2", "Proposal"), listed([*results_text.reasons(r.pairing), *results_text.proposal_words(p)])]
    if p.loops:
        parts += [grid(*results_text.loop_rows(p, {c.name: (c.span, c.unit) for c in r.channels.values()})), note(results_text.LOOPS_NOTE)]
        parts += margins_part(r)
    if r.trial:
        parts += [element("h2", "Trial"), grid(*results_text.trial_rows(r.trial)),
                  note("Kept when no loop overshoots, errs or wanders much further than predicted, with room for the noise, which looks like "
                       "overshoot (docs/inside/commissioning.md has the bounds).")]
        parts += [drawing(pictures["trial"])] if "trial" in pictures else []
    return parts


def margins_part(r: Record) -> list[Content]:
    """Gain margin, phase margin and Ms of the proposed loops on the model."""
    found = closed_loops.of_proposal(r)
    if not found:
        return [note(f"No margins: {closed_loops.why_not(r) or 'the model has no loops'}.")]
    doubts = closed_loops.doubts(r, found)
    rows: list[list[Content]] = []
    for name, m in found:
        marked = {cell for doubt in doubts.get(name, []) for cell in doubt.cells}
        rows.append([name, *(badge(False, no=cell) if k in marked else cell for k, cell in enumerate(m.cells()))])
    return [grid(["loop", *margins.HEADER], rows, text_columns=1),
            listed([doubt.words for said in doubts.values() for doubt in said]),
            note("Of the model above, without its uncertainty. The list above the loops has Ms of the worst of the plants drawn: models whose gains and times "
                 "differ from the fitted ones as their standard deviations allow. Both of its values are with the other loops closed; with them in manual "
                 "Ms may be larger. ", margins.NOTE)]


def events_part(r: Record) -> Markup:
    rows = [[f"{e.at_s:.10g}", e.level, event_sentences.sentence(e.level, e.code, f"{e.subject} {e.value!r} {e.text}", r.names)] for e in r.events]
    return grid(["plant time [s]", "level", "what"], rows, text_columns=3)


def slow_loops(r: Record) -> list[str]:
    """Kept loops that are far slower than their plant."""
    if not r.kept:
        return []
    return [name for name, said in closed_loops.doubts(r, closed_loops.of_proposal(r)).items() if any(doubt.slow for doubt in said)]


def verdict(r: Record) -> Markup:
    """Green only where tools/commission ends with status 0."""
    if r.kept and (r.pairing.left or slow_loops(r)):
        return doubtful("loops kept, with doubts")
    return badge(r.kept, "loops kept", "no loops")


def outcome(r: Record) -> str:
    slow = slow_loops(r)
    far = f"; far slower than {'its' if len(slow) == 1 else 'their'} plant: {', '.join(slow)}" if slow else ""
    return r.outcome + far


def page(r: Record, pictures: list[plotting.Plot]) -> str:
    by_name = {p.name: p for p in pictures}
    title = f"Start-up of {r.plant.name}" if r.plant else "Start-up"
    parts = [element("h1", title),
             element("p", verdict(r), f" {outcome(r)}", class_="what"),
             element("h2", "What was run"), facts(r), *tests_part(r, by_name), *model_part(r), *analysis_part(r, by_name),
             *proposal_part(r, by_name), element("h2", "What happened"), events_part(r)]
    if r.answers:
        parts += [element("h2", "Answers"), element("pre", r.answers),
                  note(element("code", f"{tool('commission')} ... --file answers.toml"), " runs it again; ",
                       element("code", f"{tool('commission')} --report FOLDER"), " makes this page again.")]
    return markup.page(title, CSS, parts)


def write(folder: Path) -> Path:
    """report.html and its plots as PNG files, from transcript.txt and telemetry.csv; returns the report."""
    r = load(folder)
    pictures = figures.plots(r)
    plotting.write_pngs(pictures, folder)
    path = folder / "report.html"
    path.write_text(page(r, pictures), encoding="utf-8")
    return path
