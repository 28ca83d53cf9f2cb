"""Composition estimation on the splitter by the structures of the source (docs/methods/composition-estimation.md): a scenario for each, and what
becomes of the estimates. Names are hers: sE[C3,30,31,33] moves C3 at stages 30, 31 and 33; ...T[1,12] interpolates the temperatures
between stages 1 and 12."""

from __future__ import annotations

import json
import math
import re
import statistics
import tempfile
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from reflux import runner, simulator
from research import trays
from reflux.errors import UserError
from reflux.paths import ROOT
from reflux.scenario import Event, Line, Scenario

HOUR = 3600.0
BAND = 0.015  # of the estimates, mole fraction
SETTLE_S = 60.0
PERIOD_S = 60.0  # of the sine on the thermometers
ANTOINE = "320-375"  # K: where the three constants are fitted
WATCH_S = 1800.0
LINK_CHANNELS = 16  # measurements
M3_H, MCAL_H = 1 / 3600, 4184e3 / 3600  # in SI units
GOAL = f"sp purity {trays.GOAL:g}"
IMPURITY = {"iC4": (37, "iC4_D"), "C3": (1, "C3_B")}
GAINS = {"enriching": (10.0, 3.0), "stripping": (20.0, 3.0)}  # lambda 1/h, zeta


@dataclass(frozen=True)
class Sensing:
    component: str
    stages: tuple[int, ...]
    regions: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True)
class Case:
    structure: str
    method: str = "geometric"
    state: str = "SS1"
    scenario: str = "SC1"
    control: str = ""  # sC[...]: the one of the state where it is empty
    law: str = "conventional"
    between: str = "line"
    components: str = "C3,iC4,nC4"
    antoine: bool = True
    hum: float = 0.2  # K, a sine on every thermometer of the estimator
    noise: float = 0.0  # K, normal, on all
    bias: tuple[int, float] = (0, 0.0)  # stage, K, from the fourth hour on
    lost: int = 0  # stage whose thermometer is missing from the fourth to the fifth hour
    tick_s: float = 10.0
    hours: float = 8.0
    firmware: str = "memory"
    apart: float = 0.0  # K/h, alarm
    use: str = (
        ""  # at SS1: "setpoint", a loop on the estimate moves the temperature's setpoint; "pv", it moves Q itself
    )
    seed: int = 1
    covariance: str = "full"  # of ekf and kalman
    model: float = 0.0  # of the filters; 0: 0.1
    set: str = ""  # further parameters of the block, NAME:VALUE, by /
    analysis: bool = False  # iC4 of the distillate, every 30 min, 20 min late


def sensing(name: str) -> Sensing:
    match = re.fullmatch(r"sE\[(\w+)((?:,\d+)+)\](?:T\[((?:\d+,\d+)(?:,\d+,\d+)*)\])?", name)
    if not match:
        raise UserError(f'"{name}" is not a structure; use one such as sE[C3,30,31,33] or sE[C3,30]T[1,12]')
    ends = [int(x) for x in match[3].split(",")] if match[3] else []
    return Sensing(
        match[1],
        tuple(int(x) for x in match[2][1:].split(",")),
        tuple(zip(ends[::2], ends[1::2])),
    )


def truncated(of: Sensing) -> str:
    """Stages inside the regions; the feed stage always has its own temperature."""
    stages = [s for first, last in of.regions for s in range(first + 1, last) if s != trays.FEED_STAGE]
    return ",".join(str(s) for s in sorted(set(stages)))


@cache
def table_lines(state: str, components: str, stages: str, antoine: bool, more: tuple[str, ...] = ()) -> tuple[str, ...]:
    """more: inputs of the nominal state besides R and Q, NAME=VALUE."""
    words = ["--components", components]
    for text in (*(f"{name}={value}" for name, value in trays.STATES[state].items()), *more):
        words += ["--set", text]
    if stages:
        words += ["--truncated", stages]
    if antoine:
        words += ["--antoine", ANTOINE]
    return simulator.table_lines("splitter", 2, *words)


def control_of(case: Case) -> str:
    return case.control or ("sC[Q,33]" if case.state == "SS1" else "sC[Q,5][R,33]")


def tuned(stage: int) -> tuple[float, float]:
    return GAINS["stripping" if stage < trays.FEED_STAGE else "enriching"]


def points(case: Case) -> tuple[str, ...]:
    return ("iC4",) if case.state == "SS1" else ("iC4", "C3")


def channel_rows(case: Case, stages: list[int]) -> list[str]:
    rows = trays.channel_rows(stages)
    more = [("Fm", "m3/h", 0, 150), ("TFm", "K", 280, 345), *((f"est_{p}", "-", 0, 1) for p in points(case))]
    for k, (name, unit, lo, hi) in enumerate(more, len(stages) + 1):
        rows += [f"set meas{k}.name {name}", f"set meas{k}.unit {unit}", f"set meas{k}.lo {lo}", f"set meas{k}.hi {hi}"]
    return rows


def block_rows(case: Case) -> list[str]:
    of, components = sensing(case.structure), case.components.split(",")
    inputs = [*(f"T{s}" for s in of.stages), "Fm", "TFm", "R", "Q"]
    rows = [
        "set block3.kind composition",
        "set block3.column 2",
        f"set block3.inputs {','.join(inputs)}",
        f"set block3.points {','.join(f'est_{p}' for p in points(case))}",
        f"set block3.method {case.method}",
        f"set block3.between {case.between}",
        f"set block3.watch {WATCH_S:g}",
        f"set block3.apart {case.apart:g}",
        "set block3.doubt uncertain",
    ]
    if case.method in ("ekf", "kalman"):
        rows.append(f"set block3.covariance {case.covariance}")
    if case.method != "geometric":
        rows += ["set block3.noise 0.2", f"set block3.model {case.model or 0.1:g}"]
    rows += [f"set block3.{name} {value}" for name, _, value in (x.partition(":") for x in case.set.split("/") if x)]
    for k, stage in enumerate(of.stages, 1):
        rows.append(f"set block3.place.{k} {stage},{components.index(of.component) + 1}")
        rows.append("set block3.tune.{} {:g},{:g}".format(k, *tuned(stage)))
    n = len(of.stages)
    rows += [
        f"set block3.is.{n + 1} feed",
        f"set block3.si.{n + 1} {M3_H:.9g},0",
        f"set block3.is.{n + 2} feed_temperature",
        f"set block3.is.{n + 3} reflux",
        f"set block3.si.{n + 3} {M3_H:.9g},0",
        f"set block3.is.{n + 4} heat",
        f"set block3.si.{n + 4} {MCAL_H:.9g},0",
    ]
    for k, p in enumerate(points(case), 1):
        rows.append(f"set block3.point.{k} {IMPURITY[p][0]},{components.index(p) + 1}")
    return rows


def events(case: Case, of: Sensing, stages: list[int]) -> list[Event]:
    out = [*trays.feed_events(control_case(case)), *trays.as_the_others(stages)]
    out += [Event(0.0, f"T{s}.hum", case.hum) for s in of.stages if case.hum]
    out += [Event(0.0, f"T{s}.hum_period", PERIOD_S) for s in of.stages if case.hum]
    out += [Event(0.0, f"T{s}.noise", case.noise) for s in stages if case.noise]
    if case.bias[0]:
        out.append(Event(4 * HOUR, f"T{case.bias[0]}.bias", case.bias[1]))
    if case.lost:
        out += [Event(4 * HOUR, f"T{case.lost}.quality", 3.0), Event(5 * HOUR, f"T{case.lost}.quality", 0.0)]
    return out


# At SS1 the impurity rises by so much with a kelvin more on stage 33; the temperature's loop is a lag of half an hour, and what is
# estimated comes two minutes late.
IMPURITY_PER_K, LATE_S, LOOP_S, CLOSE_S = 0.0042, 120.0, 1800.0, 2400.0


def use_rows(case: Case, pairing: trays.Pairing, k: int) -> list[str]:
    """A loop on the estimated impurity, by SIMC."""
    if case.use == "setpoint":
        gain = LOOP_S / (IMPURITY_PER_K * 120.0 * (LOOP_S / 2 + LATE_S))
        out, ti = trays.loop_name(pairing), LOOP_S
    else:
        _, lo, hi, _, _ = trays.MVS[pairing.mv]
        slope = trays.slope(pairing.stages[0], pairing.mv, case.state, "consistent") / HOUR * IMPURITY_PER_K
        gain, out, ti = 1 / (slope * (hi - lo) * 4 * LATE_S), pairing.mv, 4 * 4 * LATE_S
    rows = [("name", "purity"), ("pv", "est_iC4"), ("out", out), ("action", "reverse")]
    return [f"set loop{k}.{key} {text}" for key, text in (*rows, ("gain", f"{gain:.6g}"), ("ti", f"{ti:g}"))]


def use_lines(case: Case, lines: tuple[Line, ...]) -> list[Line]:
    if case.use == "pv":
        return [
            *(x for x in lines if x.text.startswith("out ")),
            Line(CLOSE_S, "mode purity auto"),
            Line(CLOSE_S, GOAL),
        ]
    more = (f"mode {trays.loop_name(trays.structure(control_of(case)).pairings[0])} cascade", "mode purity auto", GOAL)
    return [*lines, *(Line(CLOSE_S, text) for text in more if case.use)]


def control_case(case: Case) -> trays.Case:
    return trays.Case(control_of(case), case.law, "consistent", case.state, case.scenario, tick_s=case.tick_s)


def plant_with(stages: list[int], folder: Path) -> str:
    """The splitter; where its thermometers and those that are wanted besides are more than the link carries, without those that
    nobody reads."""
    if len(trays.MEASURED) + len(set(stages) - set(trays.MEASURED)) + 2 <= LINK_CHANNELS:
        return "splitter"
    whole = json.loads((ROOT / "host_sim" / "plants" / "splitter.json").read_text(encoding="utf-8"))
    whole["outputs"] = [o for o in whole["outputs"] if int(o["name"][1:]) in stages]
    file = folder / "splitter.json"
    file.write_text(json.dumps(whole), encoding="utf-8")
    return str(file)


def scenario(case: Case, folder: Path) -> Scenario:
    of, control = sensing(case.structure), control_case(case)
    base = trays.scenario(control, folder)
    pairings = list(trays.structure(control.structure).pairings)
    stages = sorted({s for p in pairings for s in p.stages} | set(of.stages))
    rows = channel_rows(case, stages)
    for k, pairing in enumerate(pairings, 1) if case.use != "pv" else ():
        rows += trays.loop_rows(k, control, pairing)
    if case.use != "pv":
        rows += trays.block_rows(control, trays.structure(control.structure), pairings)
    if case.use:
        rows += use_rows(case, pairings[0], 1 if case.use == "pv" else 2)
    rows += [*table_lines(case.state, case.components, truncated(of), case.antoine), *block_rows(case), "apply"]
    lines = [*use_lines(case, base.lines), Line(SETTLE_S, "block 3 settle"), Line(case.hours * HOUR - 60, "block 3")]
    return replace(
        base,
        name="estimate",
        plant=plant_with(stages, folder),
        title=case.structure,
        duration_s=case.hours * HOUR,
        measure=(*trays.more_measured(stages), "Fm", "TFm"),
        seed=case.seed,
        firmware=case.firmware,
        loops=() if case.use else base.loops,
        lines=tuple(sorted(lines, key=lambda line: line.at_s)),
        events=tuple(events(case, of, stages)),
        config=trays.config_lines(rows),
    )


# ---- what is measured ----


@dataclass(frozen=True)
class Error:
    """Estimated less true mole fraction."""

    initial: float  # mean of the five minutes before the feed changes at 1 h
    low: float  # from then on
    high: float
    final: float  # mean of the last hour
    outside_h: float  # of the band, from 1 h on


@dataclass(frozen=True)
class Measured:
    error: dict[str, Error] = field(default_factory=dict)
    said: tuple[str, ...] = ()  # events of the block, with the hour of the first of each
    good: float = math.nan  # part of the time after 1 h in which the estimate was called good
    impurity: dict[str, trays.Impurity] = field(default_factory=dict)  # what the control came to


def error_of(log: object, point: str) -> Error:
    t = [x / HOUR for x in log.numbers("time")]
    e = [a - b for a, b in zip(log.numbers(f"fw.est_{point}"), log.numbers(IMPURITY[point][1]))]
    after = [k for k, x in enumerate(t) if x > 1.0]
    step = t[1] - t[0]
    return Error(
        statistics.fmean(e[k] for k, x in enumerate(t) if 11 / 12 <= x < 1.0),
        min(e[k] for k in after),
        max(e[k] for k in after),
        statistics.fmean(e[k] for k in after if t[k] > t[-1] - 1.0),
        step * sum(abs(e[k]) > BAND for k in after),
    )


def measure(case: Case) -> Measured:
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        out = Path(folder) / "out"
        log = runner.run(scenario(case, Path(folder)), runner.Options(out, quiet=True)).log
        told = runner.events_in(out / "transcript.txt")
    said: dict[str, float] = {}
    for at, _, code, text in told:
        if text.startswith("block3.") and code != "BLOCK_VERB" or code == "BLOCK_GAVE_UP":
            said.setdefault(text.split()[0].removeprefix("block3."), at / HOUR)
    t, q = log.numbers("time"), log.text(f"fw.est_{points(case)[0]}.q")
    after = [q[k] == "0" for k, x in enumerate(t) if x > HOUR]
    return Measured(
        {p: error_of(log, p) for p in points(case)},
        tuple(f"{name} {at:.1f} h" for name, at in said.items()),
        sum(after) / len(after),
        {p: trays.impurity_of(log, IMPURITY[p][1]) for p in points(case)},
    )
