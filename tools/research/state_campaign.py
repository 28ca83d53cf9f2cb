"""The campaign of decoupling by state feedback (tools/research/state_study.py): the thesis' conclusions one by one on the linear model,
limits on the nonlinear column, and the form that holds it."""

from __future__ import annotations

import argparse
import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import expm

from reflux import build, simulator, state_decoupler, table
from research import state_study, trays_campaign
from reflux.errors import RunFailed, UserError
from research.kalman_1989_campaign import changed_in
from reflux.paths import ROOT
from reflux.schema import Table
from research.state_study import BOTTOM, MINUTE, NOMINAL, PERIOD_S, TOP, Case, design, linear, outputs

PRODUCTS = (12, 1)
POLES = (0.1, 0.3, 0.8, 5.0)
MORE_FLOW, MORE_LIGHT = 0.25 * NOMINAL["F"], 0.25 * NOMINAL["xF"]
SMALL = 1e-9


@dataclass(frozen=True)
class Line:
    case: Case
    name: str
    note: str


@dataclass(frozen=True)
class Part:
    title: str
    text: str
    lines: tuple[Line, ...]


@dataclass(frozen=True)
class StateDecoupling:
    name: str
    title: str
    about: str
    parts: tuple[Part, ...]

    def cases(self, fraction: float) -> list[Case]:
        wanted = list(dict.fromkeys(line.case for part in self.parts for line in part.lines))
        return wanted[:: max(1, round(1 / fraction))]


def load(top: Table, name: str) -> StateDecoupling:
    title, about, parts = top.text("title", name), " ".join(top.texts("about")), []
    for one in top.tables("table"):
        heading, text = one.text("title"), " ".join(one.texts("text"))
        base = changed_in(Case(), one.text("all", ""))
        lines = []
        for line in one.tables("line"):
            words = line.text("with", "")
            lines.append(Line(changed_in(base, words), line.text("name"), words))
            line.done()
        one.done()
        parts.append(Part(heading, text, tuple(lines)))
    top.done()
    return StateDecoupling(name, title, about, tuple(parts))


def fingerprint(_: StateDecoupling) -> str:
    digest = hashlib.sha256()
    tests = ROOT / "tests" / "reference"
    for file in (Path(state_study.__file__), Path(state_study.__file__).with_name("state_other_plants.py"), tests / "state_ahead.py", tests / "kalman_1989.py", ROOT / "host_sim" / "plants" / "pilot.json",
                 build.find_program("host", "reflux-sim"), build.find_program("host", "reflux-plant")):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def run_one(case: Case) -> dict[str, Any]:
    """In a process of its own. A run that fails is a result too."""
    try:
        return {"job": asdict(case), **asdict(state_study.play(case))}
    except (RunFailed, UserError, RuntimeError, np.linalg.LinAlgError) as error:
        return {"job": asdict(case), "failed": str(error)}


# ---- the linear model: mole fractions in 1e-3 ----


def thousandths(x: float) -> str:
    return "0" if abs(x) < SMALL else f"{1000 * x:+.3g}"


def at_rest(a: np.ndarray, drive: np.ndarray, stages: tuple[int, ...] = (TOP, BOTTOM)) -> np.ndarray:
    """By output and disturbance, after a quarter more of each."""
    return np.asarray(-outputs(stages) @ np.linalg.solve(a, drive)) * [MORE_FLOW, MORE_LIGHT]


def loop_with_integral(found: state_decoupler.Design, minutes: float, gain: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A, drive of (F, xF) and of the setpoints, with q' = (w - y)/T_I and u = F x + G (w + q)."""
    m, g, c = linear(), found.g if gain is None else gain, outputs()
    a = np.block([[m.a + m.b @ found.f, m.b @ g], [-c / minutes, np.zeros((2, 2))]])
    return a, np.vstack([m.e, np.zeros((2, 2))]), np.vstack([m.b @ g, np.eye(2) / minutes])


def overshoot(a: np.ndarray, drive: np.ndarray, row: int) -> float:
    """Overshoot of an output after a unit step, over its final value; 0.05 min apart for 100 min."""
    n = len(a)
    step = expm(np.block([[a, drive[:, None]], [np.zeros((1, n + 1))]]) * 0.05)
    c = np.zeros(n + 1)
    c[[TOP, BOTTOM][row] - 1] = 1.0
    x, most = np.append(np.zeros(n), 1.0), 0.0
    for _ in range(2000):
        x = step @ x
        most = max(most, float(c @ x))
    return most - 1.0


def indices_table() -> str:
    m = linear()
    narrow = np.where(np.abs(np.subtract.outer(np.arange(12), np.arange(12))) <= 1, m.a, 0.0)
    rows = []
    for name, stages in (("end trays", (TOP, BOTTOM)), ("products", PRODUCTS)):
        whole, three = design(0.8, stages=stages), design(0.8, stages=stages, a=narrow)
        some = design(0.8, stages=stages, weight_lo=0.01)
        rows.append([name, ", ".join(map(str, whole.index)), f"{whole.condition:.2f}", str(len(three.needed)), str(len(whole.needed)), str(len(some.needed)),
                     f"{np.abs(whole.f[0]).max():.0f}", f"{np.abs(whole.f[1]).max():.0f}", f"{np.abs(whole.g[0]).max():.0f}",
                     f"{len(whole.zeros)}, slowest {whole.zeros.real.max():.3f}"])
    return table.markdown(["outputs", "indices", "cond(B*)", "states in F, tridiagonal A", "whole A", "whole A, 1 % of a row", "largest in F: Lr, l/h", "Qrb, kW",
                           "in G: Lr, l/h", "zeros, 1/min"], rows)


def offsets_table() -> str:
    m = linear()
    rows = [["none", *map(thousandths, at_rest(m.a, m.e).T.ravel()), "", ""]]
    for pole in POLES:
        found = design(pole)
        by_formula = outputs() @ m.e[:, 0] * MORE_FLOW / pole
        rows.append([f"F, {-pole:g}", *map(thousandths, at_rest(m.a + m.b @ found.f, m.e).T.ravel()), *map(thousandths, by_formula)])
    for pole in (0.3, 0.8):
        a, drive, _ = loop_with_integral(design(pole), 5.0)
        wide = -np.linalg.solve(a, drive)[[TOP - 1, BOTTOM - 1]] * [MORE_FLOW, MORE_LIGHT]
        rows.append([f"F, {-pole:g}, integral 5 min", *map(thousandths, wide.T.ravel()), "", ""])
    for feedforward, words in (("states", "Tf"), ("outputs", "Tf by outputs (ours)")):
        tf = design(0.8, feedforward=feedforward).tf
        rows.append([f"{words} alone", *map(thousandths, at_rest(m.a, m.e + m.b @ tf).T.ravel()), "", ""])
        for pole in (0.3, 0.8):
            rows.append([f"{words} and F, {-pole:g}", *map(thousandths, at_rest(m.a + m.b @ design(pole).f, m.e + m.b @ tf).T.ravel()), "", ""])
    return table.markdown(["law, 1/min", "F +25 %: top", "bottom", "xF +25 %: top", "bottom", "C D z/abs(m0), F +25 %: top", "bottom"], rows)


def tracking_table() -> str:
    """Setpoints of one after the other by a unit: what is left of it, in %."""
    m, rows = linear(), []
    for poles in ((0.8, 0.8), (5.0, 5.0), (0.8, 5.0), (5.0, 10.0)):
        found = state_decoupler.design(m.a, m.b, outputs(), m.e, [[-p] for p in poles])
        closed, inverse = m.a + m.b @ found.f, np.linalg.inv(found.b_star)
        def gain(k: np.ndarray) -> np.ndarray:
            return np.asarray(-outputs() @ np.linalg.solve(closed, m.b @ inverse @ k))
        needed = np.linalg.inv(gain(np.eye(2)))
        rows.append([f"{-poles[0]:g}, {-poles[1]:g}", ", ".join(f"{x:.6g}" for x in np.diag(needed)), f"{np.abs(needed - np.diag(found.k_star)).max():.1e}",
                     *(f"{100 * (1 - gain(np.eye(2))[i, i]):.1f}" for i in range(2))])
    return table.markdown(["M0, 1/min", "K* from the gain at rest", "off -M0 by", "left with K* = I, %: top", "bottom"], rows)


def modes_table() -> str:
    rows = []
    for pole, minutes in ((0.3, 10.0), (0.3, 5.0), (0.3, 2.0), (0.8, 5.0), (0.8, 2.0), (5.0, 2.0)):
        found = design(pole)
        a, _, drive = loop_with_integral(found, minutes)
        wrong, _, _ = loop_with_integral(found, minutes, np.linalg.inv(found.b_star))
        share = pole / minutes - pole**2 / 4
        rows.append([f"{-pole:g}", f"{minutes:g}", f"{100 * overshoot(a, drive[:, 1], 1):.1f}", "yes" if share > 0 else "no",
                     f"{np.linalg.eigvals(a).real.max():.3f}", f"{np.linalg.eigvals(wrong).real.max():.3f}"])
    return table.markdown(["pole, 1/min", "T_I, min", "overshoot of the bottom, %", "complex poles", "slowest mode, 1/min", "with K* = I"], rows)


def sampled_table() -> str:
    rows = []
    for pole in (*POLES, 10.0):
        cells = [f"{-pole:g}"]
        for seconds in (1.0, 5.0, PERIOD_S):
            try:
                cells.append(f"{design(pole, hold=seconds / MINUTE).radius:.3f}")
            except state_decoupler.StateRefused as refused:
                cells.append(f"**{refused.found.radius:.3f}**, refused")
        found = design(pole, period=PERIOD_S / MINUTE)
        cells += [f"{np.exp(-pole * PERIOD_S / MINUTE):.4f}", f"{found.k_star[0]:.4f}", f"{found.radius:.3f}", f"{np.abs(found.f).max():.0f}", f"{np.abs(design(pole).f).max():.0f}"]
        rows.append(cells)
    return table.markdown(["pole, 1/min", "radius at 1 s", "5 s", "30 s", "in z at 30 s", "K* = I - M0", "radius", "largest in F", "of the continuous one"], rows)


def other_points_table() -> str:
    """The law of the nominal point on the linear model of another one."""
    rows = []
    for words, settings in (("F 6.25 l/h", ("F=6.25",)), ("F 3.75 l/h", ("F=3.75",)), ("Lr 2.4, Qrb 0.61", ("Lr=2.4", "Qrb=0.61"))):
        data = simulator.linearised("pilot", settings)
        a = np.array(data["A"]).reshape(12, 12) * MINUTE
        b = (np.array(data["B"]).reshape(12, -1) * MINUTE)[:, [data["inputs"].index(k) for k in ("Lr", "Qrb")]]
        cells = [words]
        for pole in (0.3, 0.8, 5.0):
            found = design(pole)
            closed = a + b @ found.f
            largest = np.linalg.eigvals(closed).real.max()
            gain = -outputs() @ np.linalg.solve(closed, b @ found.g)
            cells += [f"{largest:+.3f}", f"{100 * (1 - gain[1, 1]):.0f}" if largest < 0 else "-"]
        rows.append(cells)
    header = ["other point"]
    for pole in (0.3, 0.8, 5.0):
        header += [f"{-pole:g}: slowest mode, 1/min", "left of a step of the bottom, %"]
    return table.markdown(header, rows)


SECTIONS = (
    ("Outputs, indices, measured states", indices_table,
     "Thesis: one pole an end tray; 6 states fed back without the terms off the three diagonals, all 12 with them, though their weights are small; 4 states for product compositions, but F and G so "
     "large that inputs saturate whatever the poles. Ours: the same 6; 11 with the whole A, 7 with more than 1 % of the largest weight of a row; for product compositions 5 in place of 4, since the drum has index 1 (neither "
     "reflux nor heat move it at rest, where its vapour is as pure as it is), and three times the weight in G."),
    ("Offsets after a quarter more feed, and a quarter more of the light component in it", offsets_table,
     "Thesis: F alone leaves an offset in the bottom tray after more feed, smaller with larger poles and with less effort; the integral removes it; Tf alone leaves offsets for both disturbances; Tf "
     "and F together are worse. Ours, mole fraction in 1e-3: the offset is C D z/abs(m0), so that up to a pole of -0.8 1/min it is larger than without any control; Tf alone leaves nothing after more feed, because "
     "Tf there is the ratio of all flows to the feed, and an offset after richer feed; with F that one becomes larger, as in the thesis. Tf by outputs leaves none with F."),
    ("K*", tracking_table, "Thesis: K* = -M0, not I, for no offset. Ours: the same."),
    ("Integral", modes_table,
     "Thesis: the integral makes responses oscillate, its time is to be tuned with the poles, it also removes the offset of a wrong K*. Ours: oscillation from T_I = 4/abs(m0) down, by the "
     "line s^2 + abs(m0) s + abs(m0)/T_I that is left of the loop."),
    ("Sampled", sampled_table,
     "The continuous law computed every so many seconds, and the one designed for 30 s. In the thesis trays of 2 to 4 s are named as a reason for what happened on the nonlinear model; sampled at 30 s they are not seen, and "
     "the largest weight is about half."),
    ("At another operating point, linear", other_points_table, "Thesis: large offsets, but stable. Ours: what is left of a setpoint step with the law of the nominal point; where the column separates less than there the loop is not stable with slow poles."),
)


# ---- runs ----


def header_of(part: Part) -> list[str]:
    if part.lines[0].case.run == "pair":
        return ["law", "with", *(f"{name}, K min" for name in state_study.WINDOWS), "at a limit, %", "moves of the first input", "of the second"]
    return ["law", "with", "at a limit, %", "left at the end, 1e-3: top", "bottom"]


def row_of(line: Line, result: dict[str, Any] | None) -> list[str]:
    pair = line.case.run == "pair"
    if result is None or "failed" in result:
        said = "not run" if result is None else f"failed: {result['failed'][:60]}"
        return [line.name, line.note, said, *[""] * (6 if pair else 2)]
    limit = f"{100 * result['at_limit']:.1f}"
    if pair:
        return [line.name, line.note, *(f"{result['iae'][k]:.2f}" for k in state_study.WINDOWS), limit, *(f"{x:.3g}" for x in result["moves"])]
    return [line.name, line.note, limit, *(thousandths(x) if abs(x) > 5e-5 else "0" for x in result["left"])]


def write_results(campaign: StateDecoupling, state: Any, folder: Path) -> None:
    text = [f"# {campaign.title}\n\nWritten by `tools/campaign {campaign.name}`. {campaign.about}\n"]
    for title, make, words in SECTIONS:
        text.append(f"\n## {title}\n\n{words}\n\n{make()}\n")
    for part in campaign.parts:
        rows = [row_of(line, state.get(asdict(line.case))) for line in part.lines]
        text.append(f"\n## {part.title}\n\n{part.text}\n\n" + table.markdown(header_of(part), rows) + "\n")
    (folder / f"{campaign.name}.md").write_text("".join(text), encoding="utf-8")


def execute(campaign: StateDecoupling, options: argparse.Namespace, state: Any) -> int:
    cases = campaign.cases(options.fraction)
    trays_campaign.run_missing(cases, state, options.jobs, asdict, run_one)
    if not options.check and options.fraction == 1.0:
        write_results(campaign, state, options.results)
    for part in campaign.parts if options.fraction == 1.0 else ():
        print(f"\n{part.title}\n" + table.columns(header_of(part), [row_of(line, state.get(asdict(line.case))) for line in part.lines]))
    failed = [r for c in cases if "failed" in (r := state.get(asdict(c)))]
    for r in failed[:10]:
        print(f"FAILED  {r['job']}: {r['failed']}")
    return 1 if failed else 0
