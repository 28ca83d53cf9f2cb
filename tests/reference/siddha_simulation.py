"""The simulated example of R. Siddha (2003), chapters 2 and 3, in numpy: one loop with a measured disturbance in nine dynamic regimes, the
four ways to find Gd/Gp while the loop is closed (here A, B, C, D) by recursive least squares, and the tuning of K, lead and lag from it.
All seeds run as one array; axis 0 is the seed. Times in s, frequencies in rad/s, dB and degrees where a name says so.

What the source does not say (amplitudes, noise in the feedback, discrete PI) is stated at each place as ours. Used by
tools/research/feedforward_study.py; what it has to reproduce is in tests/tools/test_siddha_simulation.py.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

TS = 0.05  # sampling period, s (chapter 2)
PROCESS_GAIN, PROCESS_DEAD, PROCESS_LAG = 2.0, 12, 0.4  # dead time in samples: 0.6 s
DISTURBANCE_GAIN = 2.0
KP, KI = 0.325, 0.4924  # PI of section 2.17
NOISE = 0.05
SETPOINT_PERIOD_S, DISTURBANCE_PERIOD_S = 20.0, 15.0
GRID = np.arange(1, 13) * 0.5  # band 0.5 to 6 rad/s; the number of points is ours
BACK = np.exp(-1j * GRID * TS)  # z^-1 on the grid
WEIGHT = 1.0 / (GRID * TS)


@dataclass(frozen=True)
class Regime:
    name: str
    dead: int  # samples
    lag: float  # s


REGIMES = (
    Regime("III c", 8, 0.25), Regime("I c", 12, 0.25), Regime("II c", 16, 0.25),
    Regime("III b", 8, 0.4), Regime("I b", 12, 0.4), Regime("II b", 16, 0.4),
    Regime("III a", 8, 0.5), Regime("I a", 12, 0.5), Regime("II a", 16, 0.5),
)
START = Regime("equal", 12, 0.4)

# (lead s, lag s, K) as published: tables 2.7, 3.5, 3.8, 3.13. Test oracles.
PUBLISHED = {
    "Shinskey": ((0.40, 0.05, -1.0), (0.40, 0.25, -1.0), (1.0, 1.05, -1.0), (0.22, 0.022, -1.0), (0.40, 0.40, -1.0),
                 (-0.10, 0.10, -1.0), (1.0, 0.9, -1.0), (0.40, 0.50, -1.0), (0.12, 0.42, -1.0)),
    "A": ((0.29, 0.0003, -0.98), (0.24, 0.12, -1.00), (-0.09, 0.0002, -0.99), (0.22, 0.008, -0.86), (0.43, 0.42, -0.99),
          (-0.12, 0.08, -1.00), (0.53, 0.40, -0.94), (0.12, 0.18, -0.98), (-0.13, 0.11, -0.99)),
    "B": ((0.29, 0.0006, -0.96), (0.55, 0.37, -0.94), (-0.18, 0.0003, -0.93), (0.573, 0.42, -0.91), (0.48, 0.48, -0.97),
          (-0.12, 0.09, -0.94), (0.61, 0.51, -0.92), (0.43, 0.55, -0.97), (-0.075, 0.18, -0.91)),
    "C": ((0.33, 0.004, -0.88), (0.59, 0.36, -0.93), (0.43, 0.51, -0.97), (0.18, 0.002, -0.91), (0.46, 0.45, -0.95),
          (-0.14, 0.08, -0.88), (0.56, 0.56, -0.92), (0.47, 0.59, -0.96), (-0.11, 0.14, -0.88)),
    "D": ((0.44, 0.02, -0.75), (0.53, 0.34, -0.98), (0.43, 0.51, -1.00), (0.19, 0.002, -0.92), (0.49, 0.49, -0.99),
          (-0.15, 0.06, -0.98), (0.47, 0.41, -0.98), (0.48, 0.59, -0.99), (-0.14, 0.14, -0.97)),
}


def path(gain: float, dead: int, lag: float, back: np.ndarray = BACK) -> np.ndarray:
    """First order with dead time, sampled with its input held; back: z^-1."""
    a = np.exp(-TS / lag)
    return gain * (1 - a) * back ** (dead + 1) / (1 - a * back)


def process(back: np.ndarray = BACK) -> np.ndarray:
    return path(PROCESS_GAIN, PROCESS_DEAD, PROCESS_LAG, back)


def disturbance(regime: Regime, back: np.ndarray = BACK) -> np.ndarray:
    return path(DISTURBANCE_GAIN, regime.dead, regime.lag, back)


def ratio(regime: Regime, back: np.ndarray = BACK) -> np.ndarray:
    """Gd/Gp without noise."""
    return disturbance(regime, back) / process(back)


def controller(back: np.ndarray = BACK) -> np.ndarray:
    """The PI by backward Euler (ours)."""
    return KP + KI * TS / (1 - back)


def feedforward(lead, lag, gain, dead=0.0, back: np.ndarray = BACK) -> np.ndarray:
    """K (lead s + 1)/(lag s + 1) by the backward difference (2.6), after a dead time; the arguments may be arrays [...], the frequencies are
    the last axis."""
    lead, lag, gain, dead = (np.asarray(x, dtype=float)[..., None] for x in (lead, lag, gain, dead))
    s = (1 - back) / TS
    return gain * (lead * s + 1) / (lag * s + 1) * back ** (dead / TS)


def objective(tuning, of: np.ndarray, weight: np.ndarray = WEIGHT, back: np.ndarray = BACK) -> np.ndarray:
    """J of (lead, lag, K) or (lead, lag, K, dead time) [..., 3 or 4] for the ratio of."""
    t = np.asarray(tuning, dtype=float)
    dead = t[..., 3] if t.shape[-1] > 3 else 0.0
    return np.sum(weight * np.abs(feedforward(t[..., 0], t[..., 1], t[..., 2], dead, back) + of), axis=-1)


# ---- tuning ----

LAGS = np.concatenate([[0.0], np.geomspace(0.004, 6.0, 36)])  # s, where the exact search begins


def _linear(lag: np.ndarray, of: np.ndarray, weight: np.ndarray, back: np.ndarray, passes: int = 80) -> tuple[np.ndarray, np.ndarray]:
    """For a given lag Gff = (x + y s)/(lag s + 1) is linear in x = K, y = K lead: the weighted sum of distances is convex and its minimum is
    found by reweighted least squares. lag [...], of [..., n]; x, y [..., 2] and J [...]."""
    s = (1 - back) / TS
    d = 1 / (lag[..., None] * s + 1)
    f, g = d, d * s
    w = np.broadcast_to(weight, np.broadcast_shapes(d.shape, of.shape)).copy()
    floor = 1e-7
    for _ in range(passes):
        aff, agg = (w * abs(f) ** 2).sum(-1), (w * abs(g) ** 2).sum(-1)
        afg = (w * (f.conj() * g).real).sum(-1)
        bf, bg = -(w * (f.conj() * of).real).sum(-1), -(w * (g.conj() * of).real).sum(-1)
        det = aff * agg - afg**2
        x, y = (bf * agg - bg * afg) / det, (bg * aff - bf * afg) / det
        miss = abs(x[..., None] * f + y[..., None] * g + of)
        w = weight / np.maximum(miss, floor)
    return np.stack([x, y], -1), (weight * miss).sum(-1)


def exact(of: np.ndarray, weight: np.ndarray = WEIGHT, back: np.ndarray = BACK, lags: np.ndarray = LAGS, passes: int = 80) -> np.ndarray:
    """The (lead, lag, K) [..., 3] of least J: convex for each lag, the lag by a grid and then by thirds."""
    of = np.asarray(of)
    _, j = _linear(np.broadcast_to(lags, (*of.shape[:-1], len(lags))), of[..., None, :], weight, back, passes // 2)
    best = np.argmin(j, -1)
    low, high = lags[np.maximum(best - 1, 0)], lags[np.minimum(best + 1, len(lags) - 1)]
    for _ in range(24):
        one, two = low + (high - low) / 3, high - (high - low) / 3
        _, jj = _linear(np.stack([one, two], -1), of[..., None, :], weight, back, passes // 2)
        first = jj[..., 0] < jj[..., 1]
        low, high = np.where(first, low, one), np.where(first, two, high)
    lag = np.stack([np.zeros_like(low), (low + high) / 2], -1)
    xy, j = _linear(lag, of[..., None, :], weight, back, passes)
    pick = np.argmin(j, -1)[..., None]
    lag = np.take_along_axis(lag, pick, -1)[..., 0]
    xy = np.take_along_axis(xy, pick[..., None], -2)[..., 0, :]
    return np.stack([xy[..., 1] / xy[..., 0], lag, xy[..., 0]], -1)


def simplex(of: np.ndarray, start=(0.4, 0.4, -1.0), edge: float = 0.5, evaluations: int = 200, tolerance: float = 0.01,
            weight: np.ndarray = WEIGHT, back: np.ndarray = BACK) -> np.ndarray:
    """The source's search (2.12): regular tetrahedron, standard coefficients and relative tolerance (ours), penalty for lag below 0. Of
    one ratio [n]."""

    def cost(p):
        if p[1] <= 0:
            return 1e6 * (1 - p[1])
        return float(objective(p, of, weight, back))

    # a regular tetrahedron with one vertex at the start
    n, p, q = 3, edge / (3 * np.sqrt(2)) * (np.sqrt(4) + 2), edge / (3 * np.sqrt(2)) * (np.sqrt(4) - 1)
    v = [np.array(start, dtype=float)]
    for i in range(n):
        x = np.array(start, dtype=float) + q
        x[i] += p - q
        v.append(x)
    f = [cost(x) for x in v]
    used = 4
    while used < evaluations:
        order = np.argsort(f, kind="stable")
        v, f = [v[i] for i in order], [f[i] for i in order]
        if 2 * abs(f[3] - f[0]) <= tolerance * (abs(f[3]) + abs(f[0])):
            break
        c = (v[0] + v[1] + v[2]) / 3
        r = 2 * c - v[3]
        fr = cost(r)
        used += 1
        if fr < f[0]:
            e = 3 * c - 2 * v[3]
            fe = cost(e)
            used += 1
            v[3], f[3] = (e, fe) if fe < fr else (r, fr)
        elif fr < f[2]:
            v[3], f[3] = r, fr
        else:
            k = (1.5 * c - 0.5 * v[3]) if fr < f[3] else (0.5 * c + 0.5 * v[3])
            fk = cost(k)
            used += 1
            if fk < min(fr, f[3]):
                v[3], f[3] = k, fk
            else:
                for i in (1, 2, 3):
                    v[i] = (v[0] + v[i]) / 2
                    f[i] = cost(v[i])
                used += 3
    return v[int(np.argmin(f))]


# ---- the loop ----

START_S, WINDOW_S, LEARN_S = 300.0, 200.0, 150.0  # when the regimes begin, how long each is, when its data are read
FF_ON_S = 60.0  # method A: disturbance and a fixed feedforward
FIXED = (0.4, 0.5, -1.0)
SAMPLES = round((START_S + WINDOW_S * len(REGIMES)) / TS)
HISTORY = 64  # samples


def square(t: np.ndarray, period: float) -> np.ndarray:
    """+1 in the first half of each period, then -1 (amplitude 1 is ours)."""
    return np.where(np.mod(t + 1e-9, period) < period / 2, 1.0, -1.0)


def window(regime: int, skip: int = 0) -> tuple[int, int]:
    """First sample of a regime's data and the one behind the last."""
    start = round((START_S + WINDOW_S * regime) / TS)
    return start + skip, start + round(LEARN_S / TS)


class Loop:
    """The loop of all seeds at a sample: exact at samples, since inputs are held and dead times are whole. u follows from the measured y."""

    def __init__(self, seeds: int, regime: Regime = START):
        self.xp, self.xd, self.integral = np.zeros(seeds), np.zeros(seeds), np.zeros(seeds)
        self.u, self.d = np.zeros((HISTORY, seeds)), np.zeros((HISTORY, seeds))
        self.ff, self.last_d, self.k = np.zeros(seeds), np.zeros(seeds), 0
        self.aged, self.each = np.exp(-TS / PROCESS_LAG), np.arange(seeds)
        self.change(regime)

    def change(self, regime: Regime) -> None:
        self.dead, self.a = regime.dead, np.exp(-TS / regime.lag)

    def step(self, r: float, d: float, noise: np.ndarray, tuning: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """Measured y and u; tuning (lead, lag, K) or (lead, lag, K, dead time) [seeds, 3 or 4], or none."""
        now = self.k % HISTORY
        self.d[now] = d
        y = self.xp + self.xd + noise
        e = r - y
        self.integral = self.integral + KI * TS * e
        u = KP * e + self.integral
        if tuning is None:
            self.ff, self.last_d = np.zeros_like(u), self.d[now].copy()
        else:
            seen = self.d[now] if tuning.shape[1] < 4 else self._delayed(tuning[:, 3] / TS)
            lead, lag, gain = tuning[:, 0] / TS, tuning[:, 1] / TS, tuning[:, 2]
            self.ff = (lag * self.ff + gain * (lead + 1) * seen - gain * lead * self.last_d) / (lag + 1)
            self.last_d = seen
            u = u + self.ff
        self.u[now] = u
        self.xp = self.aged * self.xp + PROCESS_GAIN * (1 - self.aged) * self.u[(self.k - PROCESS_DEAD) % HISTORY]
        self.xd = self.a * self.xd + DISTURBANCE_GAIN * (1 - self.a) * self.d[(self.k - self.dead) % HISTORY]
        self.k += 1
        return y, u

    def _delayed(self, samples: np.ndarray) -> np.ndarray:
        """Between two samples by the line through them, as the element does it."""
        whole = np.minimum(np.floor(samples).astype(int), HISTORY - 2)
        part = samples - whole
        at = [self.d[(self.k - whole - i) % HISTORY, self.each] for i in (0, 1)]
        return (1 - part) * at[0] + part * at[1]


@dataclass
class Record:
    """Recorded signals: r, d [samples]; y, u [seeds, samples]."""

    r: np.ndarray
    d: np.ndarray
    y: np.ndarray
    u: np.ndarray


def noises(seeds, samples: int, sd: float = NOISE) -> np.ndarray:
    return sd * np.stack([np.random.default_rng(s).standard_normal(samples) for s in seeds])


def run(seeds, r: np.ndarray, d: np.ndarray, noise: float, adapt=None) -> Record:
    """The nine regimes one after the other. adapt(k, record), record as far as sample k - 1, is the tuning at sample k or None."""
    n = noises(seeds, len(r), noise)
    loop, record = Loop(len(seeds)), Record(r, d, np.zeros_like(n), np.zeros_like(n))
    start, each = round(START_S / TS), round(WINDOW_S / TS)
    for k in range(len(r)):
        if k >= start and (k - start) % each == 0:
            loop.change(REGIMES[(k - start) // each])
        tuning = adapt(k, record) if adapt else None
        record.y[:, k], record.u[:, k] = loop.step(r[k], d[k], n[:, k], tuning)
    return record


def signals_in_turn() -> tuple[np.ndarray, np.ndarray]:
    """r and d of methods B, C, D (2.19): the setpoint until 300 s, then the disturbance with the setpoint held at 0 (ours)."""
    t = np.arange(SAMPLES) * TS
    first = t < START_S - TS / 2
    return np.where(first, square(t, SETPOINT_PERIOD_S), 0.0), np.where(first, 0.0, square(t - START_S, DISTURBANCE_PERIOD_S))


def signals_together() -> tuple[np.ndarray, np.ndarray]:
    """r and d of method A: the setpoint all the time, the disturbance from 60 s on."""
    t = np.arange(SAMPLES) * TS
    return square(t, SETPOINT_PERIOD_S), np.where(t < FF_ON_S - TS / 2, 0.0, square(t - FF_ON_S, DISTURBANCE_PERIOD_S))


# ---- how good it is ----

ERRORS_AT = np.array([0.5, 2.0, 6.0])
SCAN = np.linspace(0.5, 6.0, 111)  # rad/s, where the largest error is looked for


def controller_error(tuning, regime: Regime, omega: np.ndarray = ERRORS_AT) -> tuple[np.ndarray, np.ndarray]:
    """Error of the continuous form (1.3) against -Gd/Gp of the continuous plants, tuned less ideal: dB and degrees at each omega."""
    t, s = np.asarray(tuning, dtype=float), 1j * omega
    lead, lag, gain = (t[..., i, None] for i in range(3))
    dead = t[..., 3, None] if t.shape[-1] > 3 else 0.0
    ideal = (PROCESS_LAG * s + 1) / (regime.lag * s + 1) * np.exp(-s * (regime.dead - PROCESS_DEAD) * TS)
    off = -gain * (lead * s + 1) / (lag * s + 1) * np.exp(-s * dead) / ideal
    return 20 * np.log10(np.abs(off)), np.degrees(np.angle(off))


def misses(tuning, regime: Regime) -> np.ndarray:
    """Controller errors as the source sums them up (2.5): the largest over the band (H-infinity), dB and degrees, and the root of the sum of squares of
    those at 0.5, 2 and 6 rad/s (H2), dB and degrees [..., 4]. As feedforward_misses() of firmware/design/feedforward_rules.h has them."""
    over, at = controller_error(tuning, regime, SCAN), controller_error(tuning, regime)
    return np.stack([*(np.abs(e).max(axis=-1) for e in over), *(np.sqrt(np.sum(e**2, axis=-1)) for e in at)], axis=-1)


def ideal(regime: Regime) -> tuple[float, float, float, float]:
    """-Gd/Gp as far as it can be had, (lead, lag, K, dead time): exact unless the process is the slower to start; then without the prediction."""
    return (_equivalent(PROCESS_LAG), _equivalent(regime.lag), -DISTURBANCE_GAIN / PROCESS_GAIN, max(0, regime.dead - PROCESS_DEAD) * TS)


def step_response(tuning, regime: Regime, duration_s: float = 30.0, substep_s: float = 0.005) -> np.ndarray:
    """y in substeps [substeps, tunings] after a unit step of d at 0, setpoint 0, no noise (8.5). tuning: one, [tunings, 3 or 4], or None for
    the PI alone."""
    count, sub = round(duration_s / TS), round(TS / substep_s)
    t = None if tuning is None else np.atleast_2d(np.asarray(tuning, dtype=float))
    n = 1 if t is None else len(t)
    loop, zero, y = Loop(n, regime), np.zeros(n), np.zeros((count * sub, n))
    ap, ad = (np.exp(-np.arange(sub) * substep_s / lag)[:, None] for lag in (PROCESS_LAG, regime.lag))
    for k in range(count):
        p, q = loop.xp.copy(), loop.xd.copy()
        loop.step(0.0, 1.0, zero, t)
        to_p = PROCESS_GAIN * loop.u[(k - PROCESS_DEAD) % HISTORY]
        to_q = DISTURBANCE_GAIN * loop.d[(k - regime.dead) % HISTORY]
        y[k * sub : (k + 1) * sub] = to_p + (p - to_p) * ap + to_q + (q - to_q) * ad
    return y


def step_iae(tuning, regime: Regime, duration_s: float = 30.0, substep_s: float = 0.005) -> np.ndarray:
    """Integrals of |y| of step_response, one for each tuning."""
    return np.abs(step_response(tuning, regime, duration_s, substep_s)).sum(axis=0) * substep_s


def _equivalent(lag_s: float) -> float:
    """The time constant whose backward difference is a sampled lag."""
    a = np.exp(-TS / lag_s)
    return TS * a / (1 - a)


def shinskey(km: float, kq: float, tm: float, tq: float, tdm: float, tdq: float) -> tuple[float, float, float]:
    """(lead, lag, K) by the rules of table 1.2."""
    ahead, lag = tdm - tdq, tm - tq
    near = 1e-9
    if abs(ahead) < near:
        lead_lag = (tm, tq)
    elif ahead > 0:
        lead_lag = ((0.8 * tm + 0.4 * ahead, tq - 0.2 * tm - 0.6 * ahead) if lag > near else
                    (1.1 * ahead, 0.11 * ahead) if lag > -near else (tm + tdm, tq + tdq))
    else:
        lead_lag = ((tm + tdm, tq + tdq) if lag > near else
                    (ahead / 2, -ahead / 2) if lag > -near else (tm + 1.4 * ahead, tq + 0.4 * ahead))
    return (*lead_lag, -kq / km)
