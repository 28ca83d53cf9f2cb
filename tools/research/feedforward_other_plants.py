"""Adaptive feedforward away from the nine regimes: the experiment of Siddha (2003), chapter 4, on his fitted rig, and one like it on the simulated
pilot column. Each of the four methods by the firmware's identification and search (libreflux_board.so). The source has played A only, on the rig: orders
of B, C and D, and how long each of their stages is, are ours."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy.linalg import expm

from reflux import high_order
from reflux.errors import UserError

CYCLE = 80  # samples of the rig's square waves, 1200 s
METHODS = ("A", "B", "C", "D")


# ---- Gd/Gp by each method ----


@dataclass(frozen=True)
class Shapes:
    """Shapes of the models: y by u and d, y by u, y by r, y by d, u by d."""

    joint: high_order.Shape
    process: high_order.Shape
    tracking: high_order.Shape
    sensitivity: high_order.Shape
    through: high_order.Shape


@dataclass(frozen=True)
class Log:
    """Samples of what was recorded, and which of them are for each stage."""

    y: np.ndarray
    u: np.ndarray
    d: np.ndarray
    r: np.ndarray
    first: slice  # of B, C, D: the setpoint moves
    second: slice  # the disturbance does; of A both do


def ratio_by(method: str, log: Log, shapes: Shapes, omega_h: np.ndarray, controller: np.ndarray,
             settings: high_order.Settings) -> tuple[np.ndarray, np.ndarray]:
    """Gd/Gp and its standard deviation, in the spans of the log. controller: response of the PI."""

    def model(shape: high_order.Shape, of: slice, y: np.ndarray, *inputs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        columns = np.stack([x[: of.stop] for x in inputs], axis=1)
        g, sd = high_order.response(shape, y[: of.stop], columns, omega_h, first=of.start, what=-1 if len(inputs) > 1 else 0, settings=settings)
        return g, sd / np.maximum(abs(g), 1e-12)

    if method == "A":
        ratio, part = model(shapes.joint, log.second, log.y, log.u, log.d)
        return ratio, part * abs(ratio)
    by_setpoint = model(shapes.process, log.first, log.y, log.u) if method == "B" else model(shapes.tracking, log.first, log.y, log.r)
    by_disturbance = model(shapes.through, log.second, log.u, log.d) if method == "D" else model(shapes.sensitivity, log.second, log.y, log.d)
    (one, one_part), (two, two_part) = by_setpoint, by_disturbance
    if method == "B":
        opened = 1 + one * controller
        ratio, one_part = two * opened / one, one_part / np.maximum(abs(opened), 1e-12)
    else:
        ratio = two * controller / one if method == "C" else -two / one
    return ratio, np.hypot(one_part, two_part) * abs(ratio)


# ---- the rig of chapter 4 ----


@dataclass(frozen=True)
class Rig:
    method: str = "A"
    run: int = 1  # of the source: settings of the PI and of the fixed feedforward
    apart: int = 20  # samples that the square wave of the feed comes after that of the setpoint
    noise: float = 0.02  # degC
    lags_s: float = 20.0


RIG_TS = 15.0
KM, TM, KQ, TQ, DEAD = 0.052, 63.0, -0.063, 67.0, 1  # degC per %, s, samples
RIG_PI = {1: (25.0, 9.0), 2: (18.0, 9.0)}  # KP in % per degC; KI per minute, the likely reading
RIG_FIXED = {1: (80.0, 110.0, 1.20), 2: (50.0, 100.0, 2.5)}  # lead s, lag s, K
RIG_SHINSKEY = (63.0, 67.0, 1.21)
RIG_PUBLISHED = {1: (124.44, 124.88, 1.17), 2: (29.0, 36.0, 1.34)}
RIG_OMEGA = np.geomspace(0.001, 0.1, 13)
RIG_AT = np.array([0.001, 0.003, 0.01, 0.03, 0.1])
RIG_SHAPES = Shapes(joint=high_order.Shape(2, ((3, 1), (3, 1))), process=high_order.Shape(2, ((3, 1),)), tracking=high_order.Shape(4, ((4, 1),)),
                    sensitivity=high_order.Shape(6, ((6, 1),)), through=high_order.Shape(6, ((6, 1),)))
# Samples at which what is done changes (4.3), and the cycles whose errors are added up.
RIG_ENDS = {1: (("PI alone", 84, 164), ("fixed", 164, 244), ("tuned", 244, 324), ("Shinskey", 324, 404)),
            2: (("fixed", 84, 164), ("fixed", 164, 244), ("tuned", 244, 324))}
RIG_MORE = ("gain alone", 404, 484)  # ours: K of the tuned element without lead and lag
RIG_IN_TURN = (("PI alone", 164, 244), ("tuned", 244, 324), ("Shinskey", 324, 404), RIG_MORE)  # B, C, D


def rig_ratio(omega: np.ndarray) -> np.ndarray:
    """Gd/Gp of the fitted models, sampled with inputs held."""
    back = np.exp(-1j * omega * RIG_TS)
    am, aq = np.exp(-RIG_TS / TM), np.exp(-RIG_TS / TQ)
    return KQ / KM * (1 - aq) / (1 - am) * (1 - am * back) / (1 - aq * back)


def error_of(tuning: tuple[float, ...], omega: np.ndarray = RIG_AT) -> tuple[np.ndarray, np.ndarray]:
    """dB and degrees against -Gd/Gp of the fitted models, continuous forms."""
    s, (lead, lag, gain) = 1j * omega, tuning[:3]
    off = gain * (lead * s + 1) / (lag * s + 1) / (-KQ / KM * (TM * s + 1) / (TQ * s + 1))
    if len(tuning) > 3:
        off = off * np.exp(-s * tuning[3])
    return 20 * np.log10(abs(off)), np.degrees(np.angle(off))


class Element:
    """Lead-lag by the backward difference, after a dead time of whole or part samples."""

    def __init__(self, h_s: float):
        self.h, self.out, self.last, self.past = h_s, 0.0, 0.0, [0.0] * 64

    def step(self, d: float, tuning: tuple[float, ...] | None) -> float:
        self.past = [d, *self.past[:-1]]
        if tuning is None:
            self.out, self.last = 0.0, d
            return 0.0
        lead, lag, gain = (tuning[0] / self.h, tuning[1] / self.h, tuning[2])
        samples = tuning[3] / self.h if len(tuning) > 3 else 0.0
        whole = min(int(samples), len(self.past) - 2)
        seen = self.past[whole] + (samples - whole) * (self.past[whole + 1] - self.past[whole])
        self.out = (lag * self.out + gain * ((lead + 1) * seen - lead * self.last)) / (lag + 1)
        self.last = seen
        return self.out


def _rig_signals(case: Rig, k: int) -> tuple[float, float]:
    """Setpoint and feed, deviations. B, C and D: two cycles of the setpoint, one of the feed with the setpoint at rest, then both as for A."""
    in_turn, feed_from = case.method != "A", 84 + case.apart
    r = float(k >= 4 and (k - 4) % CYCLE < CYCLE // 2)
    d = 5.0 * float(k >= feed_from and (k - feed_from) % CYCLE < CYCLE // 2)
    if in_turn and k < 244:
        r, d = (r, 0.0) if k < 164 else (0.0, 5.0 * float((k - 164) % CYCLE < CYCLE // 2))
    return r, d


def play_rig(case: Rig, seed: int) -> dict[str, Any]:
    """Deviations from 97 degC, 40 % of feed and steam at rest. The source says how long and in which order for method A; that both square waves are a
    part of a cycle apart, and that steam has no limits, is ours, and the last cycle."""
    if case.run not in RIG_PI or case.method not in METHODS:
        raise UserError(f"{case}: run is one of {tuple(RIG_PI)}, method of {METHODS}")
    kp, per_min = RIG_PI[case.run]
    ends = (*RIG_ENDS[case.run], RIG_MORE) if case.method == "A" else RIG_IN_TURN
    n, rng = RIG_MORE[2], np.random.default_rng(seed)
    am, aq = np.exp(-RIG_TS / TM), np.exp(-RIG_TS / TQ)
    r, d, y, u, true = (np.zeros(n) for _ in range(5))
    xp = xq = integral = 0.0
    tuning: tuple[float, ...] | None = None
    element, found = Element(RIG_TS), None
    fixed_from = 164 if case.run == 1 else 84
    for k in range(n):
        r[k], d[k] = _rig_signals(case, k)
        if case.method == "A" and k == fixed_from:
            tuning = RIG_FIXED[case.run]
        if k == 244:
            log = Log(y[:k], u[:k], d[:k], r[:k], slice(4, 164), slice(fixed_from if case.method == "A" else 164, k))
            controller = kp + per_min / 60 * RIG_TS / (1 - np.exp(-1j * RIG_OMEGA * RIG_TS))
            ratio, _ = ratio_by(case.method, log, RIG_SHAPES, RIG_OMEGA * RIG_TS, controller,
                                high_order.Settings(scale=0.02, lags_s=case.lags_s, h_s=RIG_TS, forget=0.999, p0=1e6))
            found = high_order.search(RIG_OMEGA, ratio, 1 / (RIG_OMEGA * RIG_TS), RIG_TS, kick=10.0, lag_most_s=400.0, dead_most_s=60.0)
            tuning = (found.lead_s, found.lag_s, found.gain, found.dead_s)
        if k == 324:
            tuning = RIG_SHINSKEY
        if k == RIG_MORE[1] and found:
            tuning = (0.0, 0.0, found.gain)
        true[k] = xp + xq
        y[k] = round((true[k] + case.noise * rng.standard_normal()) / 0.01) * 0.01
        e = r[k] - y[k]
        integral += kp * e * RIG_TS / (60 * kp / per_min)
        u[k] = kp * e + integral + element.step(d[k], tuning)
        xp = am * xp + KM * (1 - am) * (u[k - DEAD] if k >= DEAD else 0.0)
        xq = aq * xq + KQ * (1 - aq) * (d[k - DEAD] if k >= DEAD else 0.0)
    assert found is not None
    alone = reference_rig(case, r)
    iae = {}
    for i, (name, first, last) in enumerate(ends):
        iae[f"{i + 1} {name}"] = float(np.abs(true[first:last] - alone[first:last]).sum() * RIG_TS)
    tuned = (found.lead_s, found.lag_s, found.gain, found.dead_s)
    return {"tuning": list(tuned), "iae": iae, "rest": {"tuned": rig_iae(case.run, tuned), "gain alone": rig_iae(case.run, (0.0, 0.0, found.gain))}}


def rig_iae(run: int, tuning: tuple[float, ...] | None) -> float:
    """K s, of a cycle of the feed from rest, setpoint at rest, no noise, nothing switched on its way."""
    kp, per_min = RIG_PI[run]
    am, aq = np.exp(-RIG_TS / TM), np.exp(-RIG_TS / TQ)
    d = 5.0 * (np.arange(CYCLE) < CYCLE // 2)
    u, element, total, xp, xq, integral = np.zeros(CYCLE), Element(RIG_TS), 0.0, 0.0, 0.0, 0.0
    for k in range(CYCLE):
        y = xp + xq
        total += abs(y) * RIG_TS
        integral -= y * RIG_TS * per_min / 60
        u[k] = -kp * y + integral + element.step(d[k], tuning)
        xp = am * xp + KM * (1 - am) * (u[k - DEAD] if k >= DEAD else 0.0)
        xq = aq * xq + KQ * (1 - aq) * (d[k - DEAD] if k >= DEAD else 0.0)
    return float(total)


def reference_rig(case: Rig, r: np.ndarray) -> np.ndarray:
    """y of the same loop without disturbance and noise: what is left is due to the disturbance."""
    kp, per_min = RIG_PI[case.run]
    am, xp, integral = np.exp(-RIG_TS / TM), 0.0, 0.0
    y, u = np.zeros(len(r)), np.zeros(len(r))
    for k, w in enumerate(r):
        y[k] = xp
        integral += (w - xp) * RIG_TS * per_min / 60
        u[k] = kp * (w - xp) + integral
        xp = am * xp + KM * (1 - am) * (u[k - DEAD] if k >= DEAD else 0.0)
    return y


# ---- the pilot column ----

PILOT_TS, MINUTE = 15.0, 60.0
PILOT_FEED, PILOT_SETPOINT = 0.12, 0.5  # of 5 l/h either way, degC either way
PILOT_BAND = np.geomspace(0.0005, 0.01, 12)  # rad/s
PILOT_SHAPES = Shapes(joint=high_order.Shape(8, ((8, 1), (12, 1))), process=high_order.Shape(8, ((8, 1),)), tracking=high_order.Shape(10, ((8, 1),)),
                      sensitivity=high_order.Shape(10, ((12, 1),)), through=high_order.Shape(10, ((12, 1),)))
PILOT_LEARN_S, PILOT_STEP_S, PILOT_REST_S = 5 * 3600.0, 3600.0, 1200.0
PILOT_AT = np.array([0.0005, 0.002, 0.01])  # rad/s
SPANS = np.array([10.0, 0.85, 5.0])  # K, kW, l/h
KW_PER_FEED = SPANS[1] / SPANS[2]


@dataclass(frozen=True)
class Pilot:
    method: str = "A"  # or exact: the search on the column's own responses; or Shinskey: his rules on models fitted to those
    noise: float = 0.05  # K
    lags_s: float = 200.0


@cache
def pilot_paths(omega: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Responses of T10 to heater and feed about the nominal point, the loop of T1 closed, per unit of spans: from the linearised column with the
    thermometers' lag as state_study.Bench follows it."""
    from research import state_study
    m = state_study.linear()
    n = len(m.a)
    inside, sub = np.hstack([m.b, m.e[:, :1]]), round(PILOT_TS / state_study.SUB_S)
    whole = expm(np.block([[m.a, inside], [np.zeros((3, n + 3))]]) * state_study.SUB_S / MINUTE)
    seen, left = np.zeros((2, n)), np.exp(-state_study.SUB_S / state_study.SENSOR_S)
    seen[0, 10], seen[1, 1] = m.slope[10], m.slope[1]  # T1, T10
    a = np.block([[whole[:n, :n], np.zeros((n, 2))], [(1 - left) * seen @ whole[:n, :n], left * np.eye(2)]])
    b = np.vstack([whole[:n, n:], (1 - left) * seen @ whole[:n, n:]])
    step = np.linalg.matrix_power(a, sub)
    held = sum(np.linalg.matrix_power(a, i) @ b for i in range(sub))
    back = np.exp(-1j * np.array(omega) * PILOT_TS)
    g = np.array([np.linalg.solve(np.eye(n + 2) / z - step, held)[n:] for z in back])  # [.., T1 and T10, reflux, heater, feed]
    c = pilot_controllers(back)[0]
    closed = g[:, 1, 1:] - (g[:, 1, 0] * c / (1 + g[:, 0, 0] * c))[:, None] * g[:, 0, 1:]
    return closed[:, 0] * SPANS[1] / SPANS[0], closed[:, 1] * SPANS[2] / SPANS[0]


def pilot_controllers(back: np.ndarray) -> np.ndarray:
    """Controllers of T1 and T10, in their units."""
    from research import state_study
    pi = state_study.PI(PILOT_TS)
    return np.array([gain * (1 + per / (1 - back)) for gain, per in zip(pi.gain, pi.per)])


def _column(noise: float, folder: Path) -> Any:
    from research import state_study
    return state_study.Bench(state_study.Case(period_s=PILOT_TS, noise=noise), folder)


class _Column:
    """The loops of tests/campaign/self-tuning.toml on T1 and T10, and a feedforward from the feed to the heater."""

    def __init__(self, noise: float, seed: int, folder: Path):
        from research import state_study
        self.bench = _column(noise, folder)
        self.pi, self.u = state_study.PI(PILOT_TS), self.bench.u.copy()
        self.own = self.u.copy()
        self.rest_u, self.rest = self.u.copy(), self.bench.readings[[0, 4]].copy()
        self.noise, self.rng, self.feed = noise, np.random.default_rng(seed), 5.0
        self.element = Element(PILOT_TS)
        self.lo, self.hi = np.array([1.0, 0.4]), np.array([9.0, 1.25])

    def step(self, w10: float, feed: float, tuning: tuple[float, ...] | None) -> tuple[float, float, float, float]:
        """Deviations: measured T10, u2, feed; and T10 without noise."""
        if feed != self.feed:
            self.bench.change("F", feed)
            self.feed = feed
        true = self.bench.readings[[0, 4]]
        y = true + self.noise * self.rng.standard_normal(2)
        ff = self.element.step(feed - 5.0, tuning)
        self.own = self.pi.step(y, self.rest + np.array([0.0, w10]), self.own)
        asked = self.own + np.array([0.0, ff])
        self.u = np.clip(asked, self.lo, self.hi)
        self.own = self.u - np.array([0.0, ff])  # back-calculation
        self.bench.move(self.u)
        return y[1] - self.rest[1], self.u[1] - self.rest_u[1], feed - 5.0, float(true[1] - self.rest[1])


def _pilot_signals(method: str, t: float) -> tuple[float, float]:
    """Setpoint of T10, deviation, and feed: square waves of 60 and 48 min, together (A) or one after the other."""
    w = PILOT_SETPOINT * (1 if t % 3600 < 1800 else -1)
    feed = 5.0 * (1 + PILOT_FEED * (1 if t % 2880 < 1440 else -1))
    if method == "A":
        return w, feed
    return (w, 5.0) if t < PILOT_LEARN_S / 2 else (0.0, feed)


def _pilot_identified(case: Pilot, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Gd/Gp on PILOT_BAND, parts of spans, and its standard deviation."""
    rows, count = [], round(PILOT_LEARN_S / PILOT_TS)
    with TemporaryDirectory(prefix="reflux-") as name:
        column = _Column(case.noise, seed, Path(name))
        for k in range(count):
            w, feed = _pilot_signals(case.method, k * PILOT_TS)
            rows.append((*column.step(w, feed, None)[:3], w))
        column.bench.plant.close()
    y, u, d, r = np.array(rows).T / np.array([*SPANS, SPANS[0]])[:, None]
    half, rest = count // 2, round(PILOT_REST_S / PILOT_TS)
    log = Log(y, u, d, r, slice(40, half), slice(40 if case.method == "A" else half + rest, count))
    controller = pilot_controllers(np.exp(-1j * PILOT_BAND * PILOT_TS))[1] * SPANS[0] / SPANS[1]
    return ratio_by(case.method, log, PILOT_SHAPES, PILOT_BAND * PILOT_TS, controller,
                    high_order.Settings(scale=1.0, lags_s=case.lags_s, h_s=PILOT_TS, forget=1.0, p0=1e6))


def _pilot_tuned(ratio: np.ndarray, sd: np.ndarray) -> tuple[float, ...]:
    weight = 1 / (PILOT_BAND * PILOT_TS) / (1 + (sd / np.maximum(abs(ratio), 1e-9) / 0.3) ** 2)  # less where it is uncertain
    found = high_order.search(PILOT_BAND, ratio, weight, PILOT_TS, kick=5.0, lag_most_s=1500.0, dead_most_s=300.0)
    return found.lead_s, found.lag_s, found.gain * KW_PER_FEED, found.dead_s


def pilot_iae(tuning: tuple[float, ...] | None, seed: int = 1) -> float:
    """K min, of T10 without noise, after a step of the feed up and one down, an hour each."""
    with TemporaryDirectory(prefix="reflux-") as name:
        column, errors = _Column(0.0, seed, Path(name)), []
        for part in (1 + PILOT_FEED, 1 - PILOT_FEED):
            errors += [abs(column.step(0.0, 5.0 * part, tuning)[3]) for _ in range(round(PILOT_STEP_S / PILOT_TS))]
        column.bench.plant.close()
    return float(np.sum(errors) * PILOT_TS / MINUTE)


def play_pilot(case: Pilot, seed: int) -> dict[str, Any]:
    """5 h of setpoint of T10 and feed, together or one after the other, tuned, then a step of the feed up and one down: without, with the gain alone and
    with all. off: of the ratio against that of the linearised column at PILOT_AT, dB and degrees."""
    if case.method not in (*METHODS, "exact", "Shinskey"):
        raise UserError(f"{case}: method is one of {METHODS}, exact or Shinskey")
    process, disturbance = pilot_paths(tuple(PILOT_BAND))
    exact, more = disturbance / process, {}
    ratio, sd = (exact, np.zeros(len(exact))) if case.method not in METHODS else _pilot_identified(case, seed)
    if case.method == "Shinskey":
        rule, *models = high_order.shinskey(PILOT_BAND, process, disturbance, dead_most_s=300.0)
        tuning: tuple[float, ...] = (rule[0], rule[1], rule[2] * KW_PER_FEED, 0.0)
        more["models"] = [[m.gain, m.dead_s, m.lag_s, m.error] for m in models]
    else:
        tuning = _pilot_tuned(ratio, sd)
    off = (ratio / exact)[[int(np.argmin(abs(np.log(PILOT_BAND / w)))) for w in PILOT_AT]]
    iae = {what: pilot_iae(of, seed) for what, of in (("PI alone", None), ("gain alone", (0.0, 0.0, tuning[2])), ("tuned", tuning))}
    return {"tuning": list(tuning), "iae": iae, "off": [(20 * np.log10(abs(off))).tolist(), np.degrees(np.angle(off)).tolist()], **more}
