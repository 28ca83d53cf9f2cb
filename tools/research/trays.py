"""Structures of temperature control on the splitter by the name that the source gives them, sC[Q,33,34]: what is configured on
the board, what the column goes through, and what is measured of it."""

from __future__ import annotations

import math
import re
import statistics
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from reflux import column_slopes, runner
from reflux.errors import UserError
from reflux.logs import Log
from reflux.scenario import Event, Line, Loop, Scenario

HOUR = 3600.0
HOURS = 12.0
BAND, GOAL = 0.005, 0.02  # of both impurities
PARTS = 6
MVS = {"R": ("m3/h", 0, 120, 10, 110), "Q": ("Mcal/h", 0, 6000, 1500, 5800)}
MOVES = {"R": "reflux", "Q": "heat"}
FEED_STAGE = 19
# Inputs of the two steady states (docs/methods/column-model.md, The splitter).
STATES: dict[str, dict[str, float]] = {"SS1": {"R": 61.62, "Q": 4143.046}, "SS2": {"R": 32.2787, "Q": 2804.458}}
# Frau's gains, 1/h: kc, kc2, ko of the enriching and of the stripping section at SS2; at SS1 those of the first everywhere.
ENRICHING, STRIPPING = (2.0, 4.0, 20.0), (4.0, 8.0, 20.0)
# Changes of the feed in her scenarios at 1 h: new middle, amplitude of a sine of 20 min.
SCENARIOS: dict[str, dict[str, tuple[float, float]]] = {
    "SC1": {
        "F": (95.0, 10),
        "TF": (317, 10),
        "zC2": (0.002, 0),
        "zC3": (0.27, 0.02),
        "ziC4": (0.2232, 0.02),
        "znC4": (0.5, 0.04),
    },
    "SC2": {
        "F": (66.0, 10),
        "TF": (330, 10),
        "zC2": (0.002, 0),
        "zC3": (0.324, 0.02),
        "ziC4": (0.257, 0.02),
        "znC4": (0.4042, 0.04),
    },
}
NOMINAL = {"F": 88.2, "TF": 320, "zC2": 0.0036, "zC3": 0.281, "ziC4": 0.236, "znC4": 0.4746}
BACK_H, LIMIT = 6.0, 0.1  # of the saturation test: the feed is nominal again; Q within so much of its nominal value


@dataclass(frozen=True)
class Pairing:
    mv: str
    stages: tuple[int, ...]  # primary, or primary and secondary


@dataclass(frozen=True)
class Structure:
    pairings: tuple[Pairing, ...]
    ratio: bool = False  # R/F held


def structure(name: str) -> Structure:
    """sC[Q,33], sC[Q,5][R,33], sC[Q,33,34], sC[Q,33]_{R/F}"""
    match = re.fullmatch(r"sC((?:\[[RQ](?:,\d+){1,2}\])+)(_\{R/F\})?", name)
    if not match:
        raise UserError(f'"{name}" is not a structure; use one such as sC[Q,33], sC[Q,5][R,33], sC[Q,33,34] or sC[Q,33]_{{R/F}}')
    pairings = []
    for inner in re.findall(r"\[([^]]*)\]", match[1]):
        mv, *stages = inner.split(",")
        pairings.append(Pairing(mv, tuple(int(s) for s in stages)))
    if len({p.mv for p in pairings}) < len(pairings) or (match[2] and any(p.mv == "R" for p in pairings)):
        raise UserError(f'"{name}": an input can be used once')
    return Structure(tuple(pairings), bool(match[2]))


@dataclass(frozen=True)
class Case:
    """One run."""

    structure: str
    law: str = "conventional"
    scaling: str = "consistent"
    state: str = "SS1"
    scenario: str = "SC1"
    saturation: bool = False
    form: str = "euler"
    tick_s: float = 30.0
    noise: float = 0.0  # of every thermometer, K
    lag_s: float = -1.0  # of every thermometer; below 0: the plant's
    stiction: float = 0.0  # of both valves, parts of their span
    band: float = 0.0  # how far a read-back may be from its command and count as it; 0: as it is
    slope_times: float = 1.0
    gains_times: float = 1.0
    seed: int = 1
    firmware: str = "memory"
    pi: bool = False  # the loops' own PIs by a tuning rule, in place of the block


@lru_cache(maxsize=None)
def steady(state: str) -> column_slopes.Steady:
    return column_slopes.steady("splitter", STATES[state])


STEP_AT_S = 60.0


def open_loop(state: str, mv: str, part: float, stages: tuple[int, ...], hours: float) -> Log:
    """The board in manual, one input moved by this part of its value at STEP_AT_S."""
    start = STATES[state]
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        lines = tuple(
            Line(at, f"out {name} {value:.9g}")
            for at, name, value in (
                *((0.0, name, value) for name, value in start.items()),
                (STEP_AT_S, mv, (1 + part) * start[mv]),
            )
        )
        scenario = Scenario(
            file=Path(folder) / "step.toml",
            name="step",
            title="step",
            plant="splitter",
            duration_s=hours * HOUR,
            measure=more_measured(stages),
            tick_s=30.0,
            noise=0.0,
            firmware="memory",
            start=tuple(start.items()),
            lines=lines,
            config=config_lines((*channel_rows(list(stages)), "apply")),
        )
        return runner.run(scenario, runner.Options(Path(folder) / "out", quiet=True)).log


@lru_cache(maxsize=None)
def step_slope(stage: int, mv: str, state: str) -> float:
    """Slope of a stage that has none above it: the fastest change in the first hour after a step of 1 % of the input, K/h per unit."""
    log = open_loop(state, mv, 0.01, (stage,), 1.0)
    t, y = log.numbers("time"), log.numbers(f"T{stage}.true")
    fastest = max(((b - a) / (tb - ta) for a, b, ta, tb in zip(y, y[1:], t, t[1:])), key=abs)
    return fastest * HOUR / (0.01 * STATES[state][mv])


def slope(stage: int, mv: str, state: str, scaling: str) -> float:
    if stage == steady(state).stages:
        return step_slope(stage, mv, state) * (PARTS if scaling == "printed" else 1)
    return steady(state).slope(stage, MOVES[mv], STATES[state][mv], scaling)


def gains(case: Case, stage: int) -> tuple[float, float, float]:
    chosen = STRIPPING if case.state == "SS2" and stage < FEED_STAGE else ENRICHING
    kc, kc2, ko = (x * case.gains_times for x in chosen)
    return kc, kc2, ko


# ---- the plant ----

MEASURED = (1, 5, 7, 12, 17, 19, 23, 27, 30, 31, 33, 34, 37)  # stages with a thermometer


def more_measured(stages: Iterable[int], feed: bool = False) -> tuple[str, ...]:
    """Truths of the plant that a case measures as well."""
    return (*(f"T{s}" for s in sorted(set(stages) - set(MEASURED))), *(("Fm",) if feed else ()))


def as_the_others(stages: Iterable[int]) -> list[Event]:
    """A thermometer that the plant does not have is as those it has."""
    return [
        Event(0.0, f"T{s}.{option}", value)
        for s in sorted(set(stages) - set(MEASURED))
        for option, value in (("lag", 10), ("resolution", 0.01))
    ]


# ---- what the board is told ----


def channel_rows(stages: list[int], feed: bool = False, band: float = 0.0) -> list[str]:
    rows = ["begin"]
    for k, stage in enumerate(stages, 1):
        rows += [f"set meas{k}.name T{stage}", f"set meas{k}.unit K", f"set meas{k}.lo 280", f"set meas{k}.hi 400"]
    if feed:
        k = len(stages) + 1
        rows += [f"set meas{k}.name Fm", f"set meas{k}.unit m3/h", f"set meas{k}.lo 0", f"set meas{k}.hi 150"]
    for k, (name, (unit, lo, hi, least, most)) in enumerate(MVS.items(), 1):
        rows += [
            f"set mv{k}.name {name}",
            f"set mv{k}.unit {unit}",
            f"set mv{k}.lo {lo}",
            f"set mv{k}.hi {hi}",
            f"set mv{k}.min {least}",
            f"set mv{k}.max {most}",
        ]
        if band:
            rows.append(f"set mv{k}.band {band:g}")
    return rows


def config_lines(rows: Any) -> tuple[Line, ...]:
    return tuple(Line(0.0, row) for row in rows)


def loop_name(pairing: Pairing) -> str:
    return "top" if pairing.mv == "R" else "bottom"


def pi_rows(k: int, case: Case, pairing: Pairing) -> list[str]:
    """SIMC for a process that integrates (docs/methods/tuning.md): dead time 35 s, closed loop 150 s, as docs/use/splitter.md has it."""
    a = slope(pairing.stages[0], pairing.mv, case.state, "consistent")
    dead_h, closed_h = (35 + 0.5 * (case.tick_s - 30) + max(case.lag_s - 10, 0)) / HOUR, 150 / HOUR
    closed_h = max(closed_h, dead_h)
    _, lo, hi, _, _ = MVS[pairing.mv]
    gain = 120 / (hi - lo) / (abs(a) * case.slope_times * (closed_h + dead_h)) * case.gains_times
    return [f"set loop{k}.gain {gain:.6g}", f"set loop{k}.ti {4 * (closed_h + dead_h) * HOUR:.6g}"]


def loop_rows(k: int, case: Case, pairing: Pairing) -> list[str]:
    rows = [
        f"set loop{k}.name {loop_name(pairing)}",
        f"set loop{k}.pv T{pairing.stages[0]}",
        f"set loop{k}.out {pairing.mv}",
        f"set loop{k}.action {'direct' if pairing.mv == 'R' else 'reverse'}",
    ]
    return rows + pi_rows(k, case, pairing)


def slope_rows(k: int, case: Case, pairing: Pairing) -> list[str]:
    """From the gradients where there are some, so that the board works it out."""
    at, mv = steady(case.state), pairing.mv
    both = (*pairing.stages, pairing.stages[-1])[:2]
    if case.slope_times != 1.0 or at.stages in both:
        a = [slope(s, mv, case.state, case.scaling) * case.slope_times for s in both]
        return [f"set block1.a.{k} {a[0]:.7g},{a[1]:.7g}"]
    pair = [(at.gradient(s), at.holdup[s - 1], at.liquid_to_vapour(s)) for s in both]
    columns = [",".join(f"{p[i]:.7g}" for p in pair) for i in range(3)]
    return [
        f"set block1.moves.{k} {MOVES[mv]}",
        f"set block1.gradient.{k} {columns[0]}",
        f"set block1.holdup.{k} {columns[1]}",
        f"set block1.lv.{k} {columns[2]}",
        f"set block1.flow.{k} {at.flow(MOVES[mv], STATES[case.state][mv]):.7g}",
    ]


def block_rows(case: Case, of: Structure, loops: list[Pairing]) -> list[str]:
    seconds = [p.stages[1] for p in of.pairings if len(p.stages) > 1]
    if seconds and len(seconds) < len(of.pairings):
        raise UserError(f"{case.structure}: all loops have a secondary temperature, or none")
    inputs = [*(f"T{s}" for s in seconds), *(p.mv for p in loops)]
    rows = [
        "set block1.kind inferential",
        f"set block1.loops {','.join(loop_name(p) for p in loops)}",
        f"set block1.inputs {','.join(inputs)}",
        f"set block1.form {case.form}",
        f"set block1.scaling {case.scaling}",
        f"set block1.parts {PARTS}",
    ]
    for k, pairing in enumerate(loops, 1):
        if pairing not in of.pairings:
            rows += [f"set block1.law.{k} hold"]
            continue
        kc, kc2, ko = gains(case, pairing.stages[0])
        rows += [
            f"set block1.law.{k} {case.law}",
            f"set block1.stage.{k} {','.join(str(s) for s in (*pairing.stages, 0)[:2])}",
            f"set block1.kc.{k} {kc:g}",
            f"set block1.kc2.{k} {kc2:g}",
            f"set block1.ko.{k} {ko:g}",
            *slope_rows(k, case, pairing),
        ]
    if of.ratio:
        rows += [
            "set block2.kind ratio",
            "set block2.loops top",
            "set block2.inputs Fm",
            f"set block2.at {NOMINAL['F']:g}",
        ]
    return rows


def configuration(case: Case) -> list[str]:
    of = structure(case.structure)
    stages = sorted({s for p in of.pairings for s in p.stages})
    loops = list(of.pairings)
    if of.ratio:  # the reflux follows the feed: its loop only holds
        loops.append(Pairing("R", of.pairings[0].stages))
    rows = channel_rows(stages, of.ratio, case.band)
    for k, pairing in enumerate(loops, 1):
        rows += loop_rows(k, case, pairing)
    if case.saturation:
        rows += [
            f"set mv2.{key} {factor * STATES[case.state]['Q']:.9g}"
            for key, factor in (("min", 1 - LIMIT), ("max", 1 + LIMIT))
        ]
    if not case.pi:
        rows += block_rows(case, of, loops)
    return [*rows, "apply"]


# ---- one run ----


def feed_events(case: Case) -> list[Event]:
    events = []
    for name, (middle, amplitude) in SCENARIOS[case.scenario].items():
        events.append(Event(HOUR, name, middle))
        if amplitude:
            events += [Event(HOUR, f"{name}.swing", amplitude), Event(HOUR, f"{name}.period", HOUR / 3)]
    if case.saturation:
        for name, nominal in NOMINAL.items():
            events.append(Event(BACK_H * HOUR, name, nominal))
            if SCENARIOS[case.scenario][name][1]:
                events.append(Event(BACK_H * HOUR, f"{name}.swing", 0.0))
    return events


def instrument_events(case: Case) -> list[Event]:
    of = structure(case.structure)
    events = []
    for stage in sorted({s for p in of.pairings for s in p.stages}):
        if case.noise:
            events.append(Event(0.0, f"T{stage}.noise", case.noise))
        if case.lag_s >= 0:
            events.append(Event(0.0, f"T{stage}.lag", case.lag_s))
    if case.stiction:
        events += [Event(0.0, f"{mv}.stiction", case.stiction * (row[2] - row[1])) for mv, row in MVS.items()]
    return events


def scenario(case: Case, folder: Path) -> Scenario:
    of, start = structure(case.structure), STATES[case.state]
    loops = [*of.pairings, *([Pairing("R", of.pairings[0].stages)] if of.ratio else [])]
    begin = max(300.0, case.tick_s)
    lines = [Line(0.0, f"out {mv} {value:.9g}") for mv, value in start.items()]
    for p in loops:
        lines += [
            Line(begin, f"mode {loop_name(p)} auto"),
            Line(begin, f"sp {loop_name(p)} {steady(case.state).temperature[p.stages[0] - 1]:.7g}"),
        ]
    judged = tuple(Loop(loop_name(p), f"T{p.stages[0]}", p.mv, 0.5) for p in loops)
    stages = [s for p in of.pairings for s in p.stages]
    return Scenario(
        file=folder / "case.toml",
        name="case",
        title=case.structure,
        plant="splitter",
        duration_s=HOURS * HOUR,
        measure=more_measured(stages, of.ratio),
        tick_s=case.tick_s,
        seed=case.seed,
        noise=0.0,
        firmware=case.firmware,
        start=tuple(start.items()),
        lines=tuple(lines),
        events=tuple(feed_events(case) + as_the_others(stages) + instrument_events(case)),
        loops=judged,
        config=config_lines(configuration(case)),
    )


def run(case: Case) -> runner.Result:
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        return runner.run(scenario(case, Path(folder)), runner.Options(Path(folder) / "out", quiet=True))


# ---- what is measured ----


@dataclass(frozen=True)
class Impurity:
    iae: float  # mole fraction h, after 1 h
    low: float
    peak: float
    final: float  # mean of the last hour, three periods of the feed
    outside_h: float  # of the goal's band


@dataclass(frozen=True)
class Measured:
    impurity: dict[str, Impurity] = field(default_factory=dict)
    travel: dict[str, float] = field(default_factory=dict)  # total variation of the inputs, units
    leaves_h: float = math.nan  # saturation test: last time at a limit


def impurity_of(log: Log, name: str) -> Impurity:
    t = [x / HOUR for x in log.numbers("time")]
    after = [k for k, x in enumerate(t) if x > 1.0]
    step, y = t[1] - t[0], log.numbers(name)
    inside = [y[k] for k in after]
    return Impurity(
        step * sum(abs(x - GOAL) for x in inside),
        min(inside),
        max(inside),
        statistics.fmean(y[k] for k in after if t[k] > t[-1] - 1.0),
        step * sum(abs(x - GOAL) > BAND for x in inside),
    )


def measure(case: Case, result: runner.Result) -> Measured:
    log = result.log
    t = [x / HOUR for x in log.numbers("time")]
    after = [k for k, x in enumerate(t) if x > 1.0]
    out = Measured({name: impurity_of(log, name) for name in ("iC4_D", "C3_B")})
    for mv in MVS:
        u = log.numbers(f"{mv}.applied")
        out.travel[mv] = sum(abs(u[k] - u[k - 1]) for k in after)
    if case.saturation:
        nominal = STATES[case.state]["Q"]
        u = log.numbers("Q.applied")
        at = [t[k] for k in after if abs(abs(u[k] / nominal - 1) - LIMIT) < 1e-4]
        out = replace(out, leaves_h=max(at, default=math.nan))
    return out
