"""The Kalman filter of 1989 on the pilot column (Folami, PhD thesis, Aston, chapters 7 and 11): thermometers on trays 1, 2, 7, 9 and 10
tell the compositions of all ten trays, of drum and reboiler, while feed, reflux and heat step one after the other. His filter was linear
and discretised at 30 s, had biased estimates where there was a thermometer and unstable ones where there was none."""

from __future__ import annotations

import csv
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from reflux import runner, simulator
from reflux.errors import RunFailed, UserError
from reflux.logs import Log
from reflux.paths import ROOT
from reflux.scenario import Event, Line, Scenario

HOUR = 3600.0
BAND, BIAS = 0.02, 0.002  # mole fraction: of every tray always, and of what is left when all is at rest
STAGES, TRAYS = 12, 10
DRUM, REBOILER = STAGES, 1
MEASURED = (1, 2, 7, 9, 10)  # trays, from the top
UNMEASURED = tuple(t for t in range(1, TRAYS + 1) if t not in MEASURED)
HALVES = (tuple(range(2, 10)), (10, 11, DRUM, REBOILER))  # stages of the points of a run: a block has eight
NOISE = 0.05  # K, of the plant's thermometers
PLANT = "pilot"
NOMINAL = {"F": 5.0, "xF": 36.0, "Lr": 4.5, "Qrb": 0.8}
REST_S, FIRST_S, EACH_S = HOUR / 2, 2 * HOUR, 2 * HOUR
# Events, one after the other, from FIRST_S on; after each everything is nominal again, likewise for EACH_S.
STEPS = (
    ("F +10 %", "F", 5.5),
    ("F -10 %", "F", 4.5),
    ("F +25 %", "F", 6.25),
    ("F -25 %", "F", 3.75),
    ("xF 30 %w", "xF", 30.0),
    ("xF 50 %w", "xF", 50.0),
    ("Lr +10 %", "Lr", 4.95),
    ("Qrb +10 %", "Qrb", 0.88),
)
DURATION_S = FIRST_S + 2 * len(STEPS) * EACH_S
REFERENCE = ROOT / "tests" / "reference" / "kalman_1989.py"


def stage_of(tray: int) -> int:
    return STAGES - tray


@dataclass(frozen=True)
class Case:
    """A filter, and what it has to do with. `by`: who computes it, the firmware or the reference in numpy."""

    by: str = "firmware"
    method: str = "ekf"
    covariance: str = "full"
    feed_z: float = 0.1
    feed_f: float = 0.2
    model: float = 0.0  # 0: 0.1
    noise: float = NOISE  # K, that the filter believes
    flow: bool = False  # the feed flow is measured
    set: str = ""  # further parameters of the block, NAME:VALUE, by /
    tick_s: float = 30.0
    seed: int = 1
    times: float = 1.0  # noise of the thermometers over their own
    efficiency: float = 0.9  # of the plant; the filter's table has 0.9
    holdups: float = 1.0  # of the plant over the table's
    pressure: float = 760.0  # mmHg, of the plant; the filter has 760
    loss: float = 0.15  # kW, that the plant loses; the filter has 0.15
    # numpy alone: what it knows of the feed, how it goes from tick to tick, and by what its model's gains are off
    feed: bool = False
    step: str = "implicit"  # or explicit, exact
    gains: float = 1.0


# ---- the scenario ----


def plant(case: Case, folder: Path) -> str:
    """The pilot column with the mole fractions of all stages and the feed flow among its truths, and with its errors."""
    whole = json.loads((ROOT / "host_sim" / "plants" / f"{PLANT}.json").read_text(encoding="utf-8"))
    common = {"unit": "-", "lo": 0, "hi": 1}
    for s in range(1, STAGES + 1):
        truth = {"name": f"x{s}", "is": "fraction", "of": "TCE", "stage": s, **common, "help": f"of stage {s}, by mole"}
        whole["truths"].append(truth)
    whole["truths"].append({"name": "Fm", "is": "feed", "unit": "l/h", "lo": 0, "hi": 10, "help": "feed flow"})
    whole["efficiency"] = case.efficiency
    for key in ("reboiler", "tray", "condenser"):
        whole["holdup"][key] *= case.holdups
    file = folder / f"{PLANT}.json"
    file.write_text(json.dumps(whole), encoding="utf-8")
    return str(file)


@cache
def table_lines() -> tuple[str, ...]:
    """Lines of the column as it is shipped: a plant that differs is not what the filter has."""
    return simulator.table_lines(PLANT, 1)


def block_rows(case: Case, points: tuple[int, ...]) -> list[str]:
    inputs = [*(f"T{t}" for t in MEASURED), "Lr", "Qrb", *(["Fm"] if case.flow else [])]
    rows = [
        "set block2.kind composition",
        "set block2.column 1",
        f"set block2.inputs {','.join(inputs)}",
        f"set block2.points {','.join(f'x{s}_est' for s in points)}",
        f"set block2.method {case.method}",
        f"set block2.noise {case.noise:g}",
        "set block2.doubt uncertain",  # a bad estimate would be held in the log
    ]
    if case.method in ("ekf", "kalman"):
        rows += [
            f"set block2.covariance {case.covariance}",
            f"set block2.feed_z {case.feed_z:g}",
            f"set block2.feed_f {case.feed_f:g}",
        ]
    rows.append(f"set block2.model {case.model or 0.1:g}")
    rows += [f"set block2.{name} {value}" for name, _, value in (x.partition(":") for x in case.set.split("/") if x)]
    for k, tray in enumerate(MEASURED, 1):
        rows += [f"set block2.place.{k} {stage_of(tray)},1", f"set block2.si.{k} 1,273.15", f"set block2.tune.{k} 20,3"]
    n = len(MEASURED)
    rows += [f"set block2.is.{n + 1} reflux", f"set block2.si.{n + 1} 2.7777778e-7,0"]
    rows += [f"set block2.is.{n + 2} heat", f"set block2.si.{n + 2} 1000,0"]
    if case.flow:
        rows += [f"set block2.is.{n + 3} feed", f"set block2.si.{n + 3} 2.7777778e-7,0"]
    return [*rows, *(f"set block2.point.{k} {s},1" for k, s in enumerate(points, 1))]


def config_rows(case: Case, points: tuple[int, ...]) -> list[str]:
    channels = [*((f"T{t}", "degC", 70, 130) for t in MEASURED), *((f"x{s}_est", "-", 0, 1) for s in points)]
    if case.flow:
        channels.append(("Fm", "l/h", 0, 10))
    rows = ["begin"]
    for k, (name, unit, lo, hi) in enumerate(channels, 1):
        rows += [f"set meas{k}.name {name}", f"set meas{k}.unit {unit}", f"set meas{k}.lo {lo}", f"set meas{k}.hi {hi}"]
    for k, (name, unit, hi) in enumerate((("Lr", "l/h", 12), ("Qrb", "kW", 1.5)), 1):
        rows += [f"set mv{k}.name {name}", f"set mv{k}.unit {unit}", f"set mv{k}.lo 0", f"set mv{k}.hi {hi}"]
        rows += [f"set mv{k}.min 0", f"set mv{k}.max {hi}"]
    return [*rows, *table_lines(), *block_rows(case, points), "apply"]


def changes() -> list[tuple[float, str, float]]:
    """At which time what becomes what."""
    out = []
    for k, (_, name, value) in enumerate(STEPS):
        at = FIRST_S + 2 * k * EACH_S
        out += [(at, name, value), (at + EACH_S, name, NOMINAL[name])]
    return out


def scenario(case: Case, points: tuple[int, ...], folder: Path) -> Scenario:
    lines = [Line(0.0, f"out {name} {NOMINAL[name]:g}") for name in ("Lr", "Qrb")]
    lines += [Line(at, f"out {name} {value:g}") for at, name, value in changes() if name in ("Lr", "Qrb")]
    events = [Event(at, name, value) for at, name, value in changes() if name in ("F", "xF")]
    off = (("P", case.pressure, 760.0), ("Qloss", case.loss, 0.15))
    events += [Event(0.0, name, value) for name, value, known in off if value != known]
    return Scenario(
        file=folder / "case.toml",
        name="pilot-kalman",
        title="pilot column: the filter of 1989",
        plant=plant(case, folder),
        duration_s=DURATION_S,
        tick_s=case.tick_s,
        seed=case.seed,
        noise=case.times,
        firmware="memory",
        measure=("Fm",) if case.flow else (),
        lines=(*lines, Line(DURATION_S - 60, "block 2")),
        events=tuple(sorted(events, key=lambda e: e.at_s)),
        config=tuple(Line(0.0, row) for row in config_rows(case, points)),
    )


def play(case: Case, points: tuple[int, ...]) -> Log:
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        return runner.run(scenario(case, points, Path(folder)), runner.Options(Path(folder) / "out", quiet=True)).log


# ---- what is measured ----


@dataclass(frozen=True)
class Measured:
    """Errors of stages 1 to 12: estimated less true mole fraction."""

    most: tuple[float, ...]  # the largest, from half an hour on
    bias: tuple[float, ...]  # the mean of the last half hour of a step that is farthest from 0
    restless: tuple[float, ...]  # the standard deviation in these half hours, the largest
    by_step: tuple[tuple[float, float, float], ...]  # of the steps: largest of all trays on the way there or back, bias of all trays
    outside_s: float  # time in which a tray is farther off than the band
    good: float = math.nan  # part of the time in which an estimate was called good, the least of all


Errors = dict[int, list[float]]  # by stage


def summary(t: list[float], errors: Errors, good: float) -> Measured:
    ends = [at for at, _, _ in changes()][1:] + [DURATION_S]
    begin = [k for k, x in enumerate(t) if x >= REST_S]
    rests = [[k for k, x in enumerate(t) if end - REST_S < x < end] for end in ends]
    stages = range(1, STAGES + 1)

    def bias_of(s: int, of: list[list[int]]) -> float:
        return max((statistics.fmean(errors[s][k] for k in rest) for rest in of), key=abs)

    trays, by_step = [stage_of(tray) for tray in range(1, TRAYS + 1)], []
    for i in range(len(STEPS)):
        at = FIRST_S + 2 * i * EACH_S
        during = [k for k, x in enumerate(t) if at < x <= at + 2 * EACH_S]
        by_step.append(
            (
                max(abs(errors[s][k]) for s in trays for k in during),
                max((bias_of(s, rests[2 * i : 2 * i + 1]) for s in trays), key=abs),
                max((bias_of(s, rests[2 * i + 1 : 2 * i + 2]) for s in trays), key=abs),
            )
        )
    return Measured(
        tuple(max(abs(errors[s][k]) for k in begin) for s in stages),
        tuple(bias_of(s, rests) for s in stages),
        tuple(max(statistics.pstdev([errors[s][k] for k in rest]) for rest in rests) for s in stages),
        tuple(by_step),
        (t[1] - t[0]) * sum(any(abs(errors[s][k]) > BAND for s in trays) for k in begin),
        good,
    )


def errors_by_firmware(case: Case) -> tuple[list[float], Errors, float]:
    errors: Errors = {}
    t: list[float] = []
    good = 1.0
    for points in HALVES:
        log = play(case, points)
        t = log.numbers("time")
        for s in points:
            quality = log.text(f"fw.x{s}_est.q")
            good = min(good, sum(q == "0" for q in quality) / len(quality))
            errors[s] = [a - b for a, b in zip(log.numbers(f"fw.x{s}_est"), log.numbers(f"x{s}"))]
    return t, errors, good


def errors_by_reference(case: Case) -> tuple[list[float], Errors, float]:
    """The same readings as the firmware had, given to a filter in numpy."""
    with tempfile.TemporaryDirectory(prefix="reflux-") as name:
        folder = Path(name)
        of_plant = scenario(replace(case, flow=False, method="geometric"), HALVES[0], folder)
        log = runner.run(of_plant, runner.Options(folder / "out", quiet=True)).log
        (folder / "table.txt").write_text("\n".join(table_lines()) + "\n", encoding="utf-8")
        files = (REFERENCE, folder / "table.txt", folder / "out" / "log.csv", folder / "estimates.csv")
        command = [sys.executable, *(str(file) for file in files)]
        command += ["--method", case.method, "--step", case.step, "--gains", f"{case.gains:g}", "--noise", f"{case.noise:g}"]
        command += ["--feed-z", f"{case.feed_z:g}", "--feed-f", f"{case.feed_f:g}", "--model", f"{case.model or 0.1:g}"]
        command += [option for option, given in (("--flow-known", case.flow), ("--feed-known", case.feed)) if given]
        one_thread = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        answer = subprocess.run(command, capture_output=True, text=True, env=one_thread)
        if answer.returncode:
            raise RunFailed(answer.stderr.strip())
        with (folder / "estimates.csv").open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    t = log.numbers("time")
    errors = {s: [float(row[f"x{s}"]) - x for row, x in zip(rows, log.numbers(f"x{s}"))] for s in range(1, STAGES + 1)}
    return t, errors, math.nan


def measure(case: Case) -> Measured:
    if case.by not in ("firmware", "numpy"):
        raise UserError(f"by={case.by}: must be firmware or numpy")
    return summary(*(errors_by_firmware if case.by == "firmware" else errors_by_reference)(case))


def worst(values: tuple[float, ...], trays: tuple[int, ...]) -> float:
    """Largest error of the trays, with its sign."""
    return max((values[stage_of(t) - 1] for t in trays), key=abs)


def reached(m: Measured) -> bool:
    every = MEASURED + UNMEASURED
    return worst(m.most, every) <= BAND and abs(worst(m.bias, every)) <= BIAS
