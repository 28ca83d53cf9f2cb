"""Adaptive feedforward away from the nine regimes: the experiment of Siddha (2003), chapter 4, on his fitted rig, and one like it on the simulated
pilot column. Method A by the firmware's identification and search (libreflux_board.so)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from reflux_tools import high_order
from reflux_tools.errors import UserError

CYCLE = 80  # samples of the rig's square waves, 1200 s


@dataclass(frozen=True)
class Rig:
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
RIG_SHAPE = high_order.Shape(2, ((3, 1), (3, 1)))
# Samples at which what is done changes (4.3), and the cycles whose errors are added up.
RIG_ENDS = {1: (("PI alone", 84, 164), ("fixed", 164, 244), ("tuned", 244, 324), ("Shinskey", 324, 404)),
            2: (("fixed", 84, 164), ("fixed", 164, 244), ("tuned", 244, 324))}


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


def play_rig(case: Rig, seed: int) -> dict[str, Any]:
    """Deviations from 97 degC, 40 % of feed and steam at rest. The source says how long and in which order; that both square waves are a part of
    a cycle apart, and that steam has no limits, is ours."""
    if case.run not in RIG_PI:
        raise UserError(f"{case}: run is one of {tuple(RIG_PI)}")
    kp, per_min = RIG_PI[case.run]
    n, rng = 404, np.random.default_rng(seed)
    am, aq = np.exp(-RIG_TS / TM), np.exp(-RIG_TS / TQ)
    r, d, y, u, true = (np.zeros(n) for _ in range(5))
    xp = xq = integral = 0.0
    tuning: tuple[float, ...] | None = None
    element, found = Element(RIG_TS), None
    for k in range(n):
        r[k] = float(k >= 4 and (k - 4) % CYCLE < CYCLE // 2)
        d[k] = 5.0 * float(k >= 84 + case.apart and (k - 84 - case.apart) % CYCLE < CYCLE // 2)
        fixed_from = 164 if case.run == 1 else 84
        if k == fixed_from:
            tuning = RIG_FIXED[case.run]
        if k == 244:
            ratio, _ = high_order.response(
                RIG_SHAPE, y[:k], np.stack([u[:k], d[:k]], axis=1), RIG_OMEGA * RIG_TS, first=fixed_from, what=-1,
                settings=high_order.Settings(scale=0.02, lags_s=case.lags_s, h_s=RIG_TS, forget=0.999, p0=1e6))
            found = high_order.search(RIG_OMEGA, ratio, 1 / (RIG_OMEGA * RIG_TS), RIG_TS, kick=10.0, lag_most_s=400.0, dead_most_s=60.0)
            tuning = (found.lead_s, found.lag_s, found.gain, found.dead_s)
        if k == 324:
            tuning = RIG_SHINSKEY
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
    for i, (name, first, last) in enumerate(RIG_ENDS[case.run]):
        iae[f"{i + 1} {name}"] = float(np.abs(true[first:last] - alone[first:last]).sum() * RIG_TS)
    return {"tuning": [found.lead_s, found.lag_s, found.gain, found.dead_s], "iae": iae}


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
PILOT_SHAPE = high_order.Shape(8, ((8, 1), (12, 1)))
PILOT_LEARN_S, PILOT_STEP_S = 5 * 3600.0, 3600.0


@dataclass(frozen=True)
class Pilot:
    noise: float = 0.05  # K
    lags_s: float = 200.0


def _column(noise: float, folder: Path) -> Any:
    from reflux_tools import state_study
    return state_study.Bench(state_study.Case(period_s=PILOT_TS, noise=noise), folder)


class _Column:
    """The loops of tests/campaign/self-tuning.toml on T1 and T10, and a feedforward from the feed to the heater."""

    def __init__(self, noise: float, seed: int, folder: Path):
        from reflux_tools import state_study
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


def play_pilot(case: Pilot, seed: int) -> dict[str, Any]:
    """Setpoint of T10 and feed as square waves of 60 and 48 min for 5 h, tuned, then a step of the feed up and one down, an hour each: without, with the
    gain alone and with all."""
    rows = []
    with TemporaryDirectory(prefix="reflux-") as name:
        column = _Column(case.noise, seed, Path(name))
        for k in range(round(PILOT_LEARN_S / PILOT_TS)):
            t = k * PILOT_TS
            w = PILOT_SETPOINT * (1 if t % 3600 < 1800 else -1)
            feed = 5.0 * (1 + PILOT_FEED * (1 if t % 2880 < 1440 else -1))
            rows.append(column.step(w, feed, None))
        column.bench.plant.close()
    log = np.array(rows)
    y, u, d = log[:, 0], log[:, 1] / 0.85, log[:, 2] / 5.0  # parts of spans: 10 K, 0.85 kW, 5 l/h
    ratio, sd = high_order.response(
        PILOT_SHAPE, y / 10, np.stack([u, d], axis=1), PILOT_BAND * PILOT_TS, first=40, what=-1,
        settings=high_order.Settings(scale=1.0, lags_s=case.lags_s, h_s=PILOT_TS, forget=1.0, p0=1e6))
    weight = 1 / (PILOT_BAND * PILOT_TS) / (1 + (sd / np.maximum(abs(ratio), 1e-9) / 0.3) ** 2)  # less where it is uncertain
    found = high_order.search(PILOT_BAND, ratio, weight, PILOT_TS, kick=5.0, lag_most_s=1500.0, dead_most_s=300.0)
    tuning = (found.lead_s, found.lag_s, found.gain * 0.85 / 5.0, found.dead_s)
    iae = {}
    for what, of in (("PI alone", None), ("gain alone", (0.0, 0.0, tuning[2])), ("tuned", tuning)):
        with TemporaryDirectory(prefix="reflux-") as name:
            column, errors = _Column(0.0, seed, Path(name)), []
            for part in (1 + PILOT_FEED, 1 - PILOT_FEED):
                errors += [abs(column.step(0.0, 5.0 * part, of)[3]) for _ in range(round(PILOT_STEP_S / PILOT_TS))]
            column.bench.plant.close()
        iae[what] = float(np.sum(errors) * PILOT_TS / MINUTE)
    return {"tuning": list(tuning), "iae": iae, "j": found.j / found.j0 if found.j0 else 0.0}
