"""Decoupling by state feedback on the pilot column (Folami, PhD thesis, Aston, 1989, chapters 6 and 11): what it does on the linear model, how
often it sits at a limit on the nonlinear one, and a form that holds that. The linear laws are the firmware's (libreflux.so); the
nonlinear form is tests/reference/state_ahead.py. The plant is reflux-plant, true or seen through thermometers."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from reflux import simulator, state_decoupler
from research import best_inputs, changed_plant
from reflux.errors import UserError
from reflux.paths import ROOT

MINUTE = 60.0
LAWS = ("linear", "sampled", "ahead", "pi")
STATES = ("true", "thermometers", "estimated")
RUNS = ("rest", "feed", "fraction", "step", "pair")
PERIOD_S = 30.0
SENSOR_S = 5.0  # lag of the thermometers
SUB_S = 5.0  # steps in which it is followed
NOMINAL = {"F": 5.0, "xF": 36.0}
TOP, BOTTOM = 11, 2  # stages of the end trays
# Setpoints of host_sim/scenarios/self-tuning-pair.toml, then its loads, then a heater that gives less.
SETPOINTS = ((60, 88.2, 108.0), (1200, 88.7, 106.0), (2400, 88.7, 110.0), (3600, 87.7, 110.0), (4800, 87.7, 106.0), (6000, 88.7, 106.0),
             (7200, 88.7, 110.0), (8400, 87.7, 110.0), (9600, 87.7, 106.0), (10800, 88.2, 108.0))
LOADS = ((12000, "F", 6.0), (13200, "F", 5.0), (14400, "xF", 43.2), (15600, "xF", 36.0), (16800, "heater", 0.85), (18000, "heater", 1.0))
PAIR_S = 19200.0
WINDOWS = {"setpoints": (3600.0, 10800.0), "feed flow": (12000.0, 14400.0), "feed composition": (14400.0, 16800.0),
           "weak heater": (16800.0, 19200.0)}


@dataclass(frozen=True)
class Case:
    column: str = "pilot"  # or methanol-water, with the laws ahead (estimated states) and pi (the best)
    law: str = "ahead"
    run: str = "pair"
    pole: float = 1.8  # 1/min, of both loops; less its sign
    period_s: float = PERIOD_S
    states: str = "true"
    noise: float = 0.0  # K
    resolution: float = 0.0  # K
    integral: float = 0.0  # min, of the linear laws
    keep: float = 0.3  # of the nonlinear form
    efficiency: float = 0.9  # of the plant; the model has 0.9
    holdups: float = 1.0  # of the plant over the model's
    known: bool = False  # the feed is told
    point: str = "nominal"  # of the linear laws
    seed: int = 1


@dataclass(frozen=True)
class Linear:
    """Matrices of the pilot column at its nominal point: per minute, mole fractions, l/h, kW; disturbances F (l/h) and xF (%w)."""

    a: np.ndarray
    b: np.ndarray
    e: np.ndarray
    x: np.ndarray
    u: np.ndarray
    slope: np.ndarray  # K per mole fraction of the stages' temperatures
    y: np.ndarray  # degC, of the end trays


POINTS = {"nominal": (), "middle": ("Lr=2.435", "Qrb=0.612")}  # middle: where the setpoints of the pair are in the middle


@cache
def linear(point: str = "nominal") -> Linear:
    data = simulator.linearised("pilot", POINTS[point])
    n = len(data["x"])
    a, b = np.array(data["A"]).reshape(n, n) * MINUTE, np.array(data["B"]).reshape(n, -1) * MINUTE
    c, names, inputs = np.array(data["C"]).reshape(-1, n), data["outputs"], data["inputs"]
    of_stage = ["TB", "T10", "T9", "T8", "T7", "T6", "T5", "T4", "T3", "T2", "T1"]
    slope = np.array([c[names.index(name), i] for i, name in enumerate(of_stage)] + [0.0])
    slope[-1] = slope[-2]  # the drum has no thermometer; it is as pure as the top tray
    column = [inputs.index(name) for name in ("Lr", "Qrb", "F", "xF")]
    return Linear(a, b[:, column[:2]], b[:, column[2:]], np.array(data["x"]), np.array([data["u"][k] for k in column[:2]]), slope,
                  np.array([data["y"][names.index(name)] for name in ("T1", "T10")]))


def outputs(stages: tuple[int, ...] = (TOP, BOTTOM)) -> np.ndarray:
    return np.eye(12)[[s - 1 for s in stages]]


def design(pole: float, *, stages: tuple[int, ...] = (TOP, BOTTOM), scale: np.ndarray | None = None, period: float = 0.0,
           a: np.ndarray | None = None, point: str = "nominal", **more: Any) -> state_decoupler.Design:
    """Law of the firmware, in minutes. period: min, of the form in discrete time."""
    m = linear(point)
    a, b, e, c = m.a if a is None else a, m.b, m.e, outputs(stages)
    if scale is not None:
        c = c * scale[:, None]
    if period:
        a, b, e = state_decoupler.sample(a, b, e, period)
        pole = float(np.exp(-pole * period))
    else:
        pole = -pole
    return state_decoupler.design(a, b, c, e, [[pole] * 4] * 2, period=period, **more)


# ---- the nonlinear column ----


def _plant_file(case: Case, folder: Path) -> str:
    whole = changed_plant.read("pilot")
    for s in range(1, 13):
        whole["truths"].append({"name": f"x{s}", "is": "fraction", "of": "TCE", "stage": s, "unit": "-", "lo": 0, "hi": 1, "help": "of a stage"})
    changed_plant.change(whole, f"efficiency={case.efficiency} holdups={case.holdups}")
    return changed_plant.write(whole, folder)


SEEN = ("T1", "T2", "T7", "T9", "T10")
STAGES_SEEN = (11, 10, 5, 3, 2)


class Column:
    """A plant, its heater (the second input), the lag of its thermometers (the first `seen` outputs)."""

    def __init__(self, plant: str, inputs: list[str], outputs: list[str], seen: int, u: np.ndarray, period_s: float, substeps: int, lag_s: float):
        self.substeps, self.seen = substeps, seen
        step = period_s / substeps
        self.plant = best_inputs.Plant(plant, inputs, outputs, step)
        self.left, self.heater = float(np.exp(-step / lag_s)), 1.0
        self.u = u.copy()
        row = self.plant.attempt(self.u[None, :])[-1]
        self.readings, self.x = row[:seen].copy(), row[seen:]

    def change(self, name: str, value: float) -> None:
        if name == "heater":
            self.heater = value
        else:
            self.plant.ask(f"set {name} {value}")

    def move(self, u: np.ndarray) -> None:
        felt = np.array([u[0], u[1] * self.heater])
        rows = self.plant.attempt(np.tile(felt, (self.substeps, 1)))
        self.plant.ask("keep")
        for row in rows:
            self.readings = self.left * self.readings + (1.0 - self.left) * row[:self.seen]
        self.u, self.x = u, rows[-1][self.seen:]


class Bench(Column):
    """The pilot column; x: the compositions of its stages."""

    def __init__(self, case: Case, folder: Path):
        super().__init__(_plant_file(case, folder), ["Lr", "Qrb"], [*SEEN, *(f"x{s}" for s in range(1, 13))], len(SEEN), linear().u, case.period_s,
                         max(1, round(case.period_s / SUB_S)), SENSOR_S)


class PI:
    """The pair of tests/campaign/self-tuning.toml: -2 l/h per K and 3 min, 0.08 kW per K and 1.2 min; velocity form."""

    def __init__(self, period_s: float):
        self.gain, self.per = np.array([-2.0, 0.08]), period_s / MINUTE / np.array([3.0, 1.2])
        self.e: np.ndarray | None = None

    def step(self, y: np.ndarray, w: np.ndarray, u: np.ndarray) -> np.ndarray:
        e = w - y
        before, self.e = e if self.e is None else self.e, e
        return u + self.gain * (e - before + self.per * e)


class LinearLaw:
    """u = u0 + F (x - x0) + G (w + q), with the integral's back-calculation: where an input is at its limit q is what would have asked for
    no more."""

    def __init__(self, case: Case, scale: np.ndarray):
        period = case.period_s / MINUTE
        self.rest = linear(case.point).u
        self.found = design(case.pole, scale=scale, point=case.point, period=period if case.law == "sampled" else 0.0)
        self.q, self.part = np.zeros(2), period / case.integral if case.integral else 0.0

    def step(self, x: np.ndarray, y: np.ndarray, w: np.ndarray, lo: np.ndarray, hi: np.ndarray) -> np.ndarray:
        """x, y, w: deviations."""
        u = self.rest + self.found.f @ x + self.found.g @ (w + self.q)
        if self.part:
            self.q = self.q + self.part * (w - y)
            excess = np.clip(u, lo, hi) - u
            self.q = self.q + self.part * np.linalg.solve(self.found.g, excess)
        return u


def _reference() -> Any:
    folder = str(ROOT / "tests" / "reference")
    if folder not in sys.path:
        sys.path.insert(0, folder)
    import state_ahead
    return state_ahead


def _mole(percent: float) -> float:
    light, heavy = 0.13138834, 0.1658334  # kg/mol, of pilot.json
    w = percent / 100.0
    return (w / light) / (w / light + (1.0 - w) / heavy)


@dataclass(frozen=True)
class Measured:
    at_limit: float  # part of the ticks in which what was asked for was beyond a limit
    iae: dict[str, float]  # K min, or mole fraction min
    moves: tuple[float, float]  # sums of the magnitudes of moves, l/h and kW
    left: tuple[float, float]  # what is left at the end, top and bottom


def _events(case: Case) -> tuple[list[tuple[float, str, float]], float]:
    if case.run == "pair":
        return list(LOADS), PAIR_S
    if case.run == "feed":
        return [(300.0, "F", 6.25)], 3900.0
    if case.run == "fraction":
        return [(300.0, "xF", 45.0)], 3900.0
    return [], 3900.0


def _setpoints(case: Case, at_rest: np.ndarray) -> list[tuple[float, np.ndarray]]:
    if case.run == "pair":
        return [(t, np.array([a, b])) for t, a, b in SETPOINTS]
    if case.run == "step":
        return [(0.0, at_rest), (300.0, at_rest + np.array([0.0, 0.03]))]
    return [(0.0, at_rest)]


def play(case: Case) -> Measured:
    if case.law not in LAWS or case.states not in STATES or case.run not in RUNS or case.point not in POINTS:
        raise UserError(f"{case}: law is one of {LAWS}, states of {STATES}, run of {RUNS}, point of {tuple(POINTS)}")
    if case.column != "pilot":
        from research import state_other_plants  # which uses this module
        return state_other_plants.play(case)
    with TemporaryDirectory(prefix="reflux-") as name:
        bench = Bench(case, Path(name))
        try:
            return _played(case, bench)
        finally:
            bench.plant.close()


def _played(case: Case, bench: Bench) -> Measured:
    m, random = linear(case.point), np.random.default_rng(case.seed)
    pair = case.run == "pair"
    lo, hi = np.array([1.0, 0.4]), np.array([9.0, 1.25])  # of host_sim/scenarios/pilot.conf
    ends = np.array([TOP - 1, BOTTOM - 1])
    scale = m.slope[ends] if pair else np.ones(2)
    rest_y = m.y if pair else m.x[ends]
    pi = PI(case.period_s) if case.law == "pi" else None
    law = LinearLaw(case, scale) if case.law in ("linear", "sampled") else None
    ahead = estimator = None
    if case.law == "ahead":
        ref = _reference()
        lines = simulator.table_lines("pilot", 1)
        model = ref.Model(lines, case.period_s, ("reflux", "heat"), (1e-3 / 3600, 1000.0), 1e-3 / 3600, ends)
        p = float(np.exp(-case.pole * case.period_s / MINUTE))
        ahead = ref.Ahead(model, [p, p], case.keep, lo, hi)
        if case.states == "estimated":
            estimator = ref.Estimator(model, STAGES_SEEN, max(case.noise, 0.01))
    events, end = _events(case)
    setpoints, w, started = _setpoints(case, rest_y), rest_y, not pair
    feed, u, beyond, log = dict(NOMINAL), bench.u.copy(), 0, []
    ticks = round(end / case.period_s)
    for k in range(ticks + 1):
        t = k * case.period_s
        while events and events[0][0] <= t:
            bench.change(*events[0][1:])
            feed[events[0][1]] = events[0][2]
            events.pop(0)
        while setpoints and setpoints[0][0] <= t:
            w, started = setpoints.pop(0)[1], True
        noise = case.noise * random.standard_normal(17)
        readings = bench.readings + noise[:5]
        if case.resolution:
            readings = np.round(readings / case.resolution) * case.resolution
        y = np.array([readings[0], readings[4]]) if pair else bench.x[ends]
        true_y = np.array([bench.readings[0], bench.readings[4]]) if pair else bench.x[ends]
        log.append((t, *true_y, *w, *u))
        if started:
            x = bench.x.copy()
            if case.states == "thermometers":  # each tray's own says its composition, by the slope at the nominal point
                shown = m.slope * (x - m.x) + noise[5:]
                if case.resolution:
                    base = 80.0031 + 0.3717 * np.arange(12)  # temperatures are no multiples of a step
                    shown = np.round((base + shown) / case.resolution) * case.resolution - base
                x = m.x + shown / m.slope
            if pi:
                asked = pi.step(y, w, u)
            elif law:
                dx = x - m.x
                asked = law.step(dx, scale * dx[ends], w - rest_y, lo, hi)
            else:
                f, z = (feed["F"], _mole(feed["xF"])) if case.known else (NOMINAL["F"], _mole(NOMINAL["xF"]))
                if estimator:
                    x, f, z = estimator.step(u, readings)
                asked = ahead.step(x, f, z, y, w, u)
            u = np.clip(asked, lo, hi)
            at_limit = np.any(asked != u) if not ahead else np.any((u <= lo) | (u >= hi))
            beyond += bool(at_limit)
        bench.move(u)
    return measured(np.array(log), beyond / (ticks + 1), WINDOWS if pair else {"all": (0.0, end)})


def measured(log: np.ndarray, at_limit: float, windows: dict[str, tuple[float, float]]) -> Measured:
    """log: time, both outputs, both setpoints, both inputs."""
    t, e = log[:, 0], np.abs(log[:, 1:3] - log[:, 3:5]).sum(axis=1)
    iae = {}
    for name, (first, last) in windows.items():
        inside = (t >= first) & (t <= last)
        x, v = t[inside] / MINUTE, e[inside]
        iae[name] = float(np.sum(0.5 * (v[1:] + v[:-1]) * np.diff(x)))
    moves = np.abs(np.diff(log[:, 5:7], axis=0)).sum(axis=0)
    left = log[-1, 1:3] - log[-1, 3:5]
    return Measured(at_limit, iae, (float(moves[0]), float(moves[1])), (float(left[0]), float(left[1])))
