"""Results of a start-up as tables and sentences, the same on a terminal and in the report."""

from __future__ import annotations

import re
from collections.abc import Mapping

from reflux import table
from reflux.commission.board import number
from reflux.commission.results import Feedforward, Gains, InnerLoop, Model, Pairing, Proposal, Structure, TrialLoop


def model_rows(m: Model) -> tuple[list[str], list[list[str]]]:
    header = ["measurement", "input", "gain", "+-", "unit", "T [s]", "+-", "L [s]", "+-", "flags and shape"]
    rows = []
    for e in m.elements.values():
        f = table.figure
        times = [f(e.time_s), f(e.time_sd_s), f(e.dead_s), f(e.dead_sd_s)] if e.has_gain else ["-"] * 4
        flags = e.flags + ([e.shape] if e.shape else [])
        rows.append([e.measurement, e.input, f(e.gain), f(e.gain_sd), e.unit, *times, ", ".join(flags) or "-"])
    return header, rows


def input_rows(m: Model) -> tuple[list[str], list[list[str]]]:
    header = ["input", "held", "amplitude", "unit", "half a double step [s]", "rounds", "nearest a limit", "remarks"]
    return header, [[i.name, f"{i.held:.4g}", table.figure(i.amplitude), i.unit, table.figure(i.half_s), str(i.rounds),
                     f"{100 * i.worst:.0f} %", i.remarks or "-"] for i in m.inputs]


def direction_rows(m: Model) -> tuple[list[str], list[list[str]]]:
    """What all inputs together do, beside the sum of what each of them does."""
    header = ["measurement", "answer to all together [span]", "+-", "sum of the single tests [span]", "+-", "flags"]
    found = [re.match(r"along (\S+) gain (\S+) sd (\S+) of single inputs (\S+) sd (\S+) flags (.*)", line) for line in m.direction]
    return header, [[f[1], *(table.figure(number(f[k])) for k in range(2, 6)), f[6]] for f in found if f]


def direction_words(m: Model) -> str:
    """Shares of the inputs, as the board lists them."""
    shares = re.match(r"direction (.*) amplitude (\S+ \S+) half (\S+) s", m.direction[0]) if m.direction else None
    if not shares:
        return ""
    words = shares[1].split()
    parts = ", ".join(f"{name} by {number(share):.4g}" for name, share in zip(words[::2], words[1::2], strict=True))
    return f"The inputs act nearly alike. All of them were moved together, in shares of their spans: {parts}; up to {shares[2]}."


def rga_rows(g: Gains) -> tuple[list[str], list[list[str]]]:
    return ["", *g.rga_inputs], [[name, *(f"{x:.2f}" for x in row)] for name, row in g.rga.items()]


def pairing_rows(p: Pairing) -> tuple[list[str], list[list[str]]]:
    header = ["measurement", "input", "relative gain", "share of draws"]
    return header, [[m, i, f"{x:.2f}", f"{share:.3g}"] for m, i, x, share in p.pairs]


LOOPS_NOTE = ("Gain: output span per measurement span, as the board takes it; beside it the same in units. Predicted on the model: after a step of the "
              "loop's own setpoint the integral of the error (IAE, measurement unit times s), the overshoot, and the time until it stays within 5 % of "
              "the step.")


def loop_rows(p: Proposal, spans: Mapping[str, tuple[float, str]]) -> tuple[list[str], list[list[str]]]:
    """spans: width and unit of each channel."""
    header = ["measurement", "input", "gain", "in units", "ti [s]", "td [s]", "action", "setpoint step", "IAE", "overshoot",
              "settles [s]"]
    f = table.figure
    return header, [[x.measurement, x.input, f(x.gain), gain_in_units(x.gain, spans.get(x.measurement), spans.get(x.input)), f(x.ti_s), f(x.td_s),
                     x.action, f(x.step), f(x.iae), f"{100 * x.overshoot:.0f} %", f(x.settles_s)] for x in p.loops]


def gain_in_units(gain: float, measurement: tuple[float, str] | None, output: tuple[float, str] | None) -> str:
    """What an engineer compares with a gain of their own."""
    if not (measurement and output):
        return "-"
    return f"{table.figure(gain * output[0] / measurement[0])} {output[1]} per {measurement[1]}"


def trial_rows(loops: list[TrialLoop]) -> tuple[list[str], list[list[str]]]:
    header = ["measurement", "input", "setpoint step", "IAE predicted", "found", "overshoot predicted", "found"]
    f = table.figure
    return header, [[x.measurement, x.input, f(x.step), f(x.iae_predicted), f(x.iae),
                     f"{100 * x.overshoot_predicted:.0f} %", f"{100 * x.overshoot:.0f} %"] for x in loops]


def gains_words(g: Gains) -> list[str]:
    """Rank and what follows from it."""
    out = [f"rank {g.rank} of {len(g.singular)} within the errors (exactly {g.rank_exact}); condition number "
           f"{table.figure(g.condition)}, {table.figure(g.condition_scaled)} at best scaling; singular values in spans "
           + ", ".join(table.figure(x) for x in g.singular)]
    if g.null_inputs:
        moved = ", ".join(f"{n} {x:.2f}" for n, x in g.null_inputs.items() if abs(x) >= 0.05)
        seen = ", ".join(f"{n} {x:.2f}" for n, x in g.null_outputs.items() if abs(x) >= 0.05)
        out.append(f"this combination of inputs (in spans) has no measurable effect: {moved}; and no input moves the outputs "
                   f"along: {seen}")
    return out


def pairing_words(p: Pairing) -> list[str]:
    out = [f"pairing {p.verdict}; probability {p.probability:.3g}, Niederlinski index {table.figure(p.niederlinski)}; the "
           f"determinant is {table.figure(p.determinant)} standard deviations from zero"]
    out += [f"against it: {words}" for words in p.doubts]
    out += [f"warning: {words}" for words in p.warnings]
    if p.choices:
        out.append(f"the fastest of {len(p.choices)} pairings that would do")
    out += [f"open: {name} keeps its input in {100 * share:.0f} % of draws{f', else {rival}' if rival != '-' else ''}"
            for name, share, rival in p.open]
    out += [f"second opinion {p.second_opinion}"] if p.second_opinion else []
    return out + left_words(p)


def left_words(p: Pairing) -> list[str]:
    return [f"left over: {what} {name}: {why}" for what, name, why in p.left]


def reasons(p: Pairing) -> list[str]:
    """Why these pairs."""
    return [f"{m} by {i}: when the other loops close, the plant's gain of this pair becomes {1 / x:.2g} times what it was"
            for m, i, x, _ in p.pairs if x > 0]


def structure_words(s: Structure) -> list[str]:
    if not s.blocks:
        return []
    out = [f"structure: {s.parts} independent part{'s' if s.parts != 1 else ''}, {len(s.blocks)} "
           f"block{'s' if len(s.blocks) != 1 else ''} of loops that act on each other"]
    for k, b in enumerate(s.blocks, 1):
        loops = ", ".join(f"{m} by {i}" for m, i, _ in b.members)
        poor = [m for m, _, served in b.members if not served]
        words = f"block {k}: {loops}; relative gain furthest from 1: {table.figure(b.worst_lambda)}"
        words += f"; single loops will not serve {', '.join(poor)} well" if poor else "; single loops serve"
        if k in s.multivariable:
            words += f": it wants a multivariable controller, and gets {s.multivariable[k]}"
        if b.driven_by:
            words += f"; disturbed by block {' and '.join(map(str, b.driven_by))} but not the other way round"
        out.append(words)
    for inner, outer, v, used in s.cascades:
        out.append(f"cascade: {outer} follows {inner} as {table.figure(v['gain'])} of span per span, lag "
                   f"{table.figure(v['lag'])} s, dead time {table.figure(v['dead'])} s, misfit {table.figure(v['misfit'])} "
                   f"standard deviations; used: {used}")
    for source, to, v in s.ways:
        words = (f"feedforward from {source} to {to} would be {table.figure(v['gain'])} of span per span, lead "
                 f"{table.figure(v['lead'])} s, lag {table.figure(v['lag'])} s, dead time {table.figure(v['dead'])} s")
        out.append(words + (f", {table.figure(v['late'])} s too late" if v.get("late") else ""))
    return out


def proposal_words(p: Proposal) -> list[str]:
    if p.why_not:
        return [f"no proposal: {p.why_not}"]
    f = table.figure
    if p.sensitivity:
        lowered = f"; for that the last step lowered every gain to {100 * p.lowered:.0f} % of what the search had found" if p.lowered < 1 else ""
        settings = f"settings {p.rule}: Ms {f(p.sensitivity[0])} there, {f(p.sensitivity[1])} on the fitted model{lowered}"
    else:
        most = f"{f(p.factor_least)} to {f(p.factor)}, each independent part by its own," if p.factor_least < p.factor else f(p.factor)
        settings = f"settings {p.rule}, detuned by {most} for joint stability (largest log modulus {f(p.log_modulus_db)} dB)"
    return [settings, f"decoupler {p.decoupler}", *map(inner_words, p.inner), *map(feedforward_words, p.feedforwards), *p.others]


def inner_words(x: InnerLoop) -> str:
    return (f"cascade: the loop on {x.below} drives the setpoint of one on {x.measurement} by {x.input}, gain "
            f"{table.figure(x.gain)}, ti {table.figure(x.ti_s)} s, {x.action}, which is faster and meets what disturbs "
            f"{x.input} first")


def feedforward_words(x: Feedforward) -> str:
    f, v = table.figure, x.numbers
    words = (f"feedforward from {x.source} to {x.to}: gain {f(v['gain'])}, lead {f(v['lead'])} s, lag {f(v['lag'])} s, dead "
             f"time {f(v['dead'])} s")
    if x.used != "yes":
        return f"{words}; {x.used}"
    return f"{words}; it leaves about {100 * v['left']:.0f} % of what {x.source} does to that loop"
