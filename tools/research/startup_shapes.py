"""Shapes of a response fitted to a double step, in double: one lag, two lags or an oscillation, these with a zero of either sign, and an
integrator with a lag, all with dead time. The Bayesian information criterion chooses. Part of the engineer's method, the host's oracle of start-ups.

A shape is linear in its gains; offset and a drift along a straight line are fitted with them. The dead time, the time constant and the damping
are looked for on a grid, and then by Gauss and Newton's method with the step limited (Levenberg and Marquardt).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

STEPS_MOST = 25
STARTS = 2  # points of the grid from which the search begins
DAMPINGS = (0.15, 0.4, 0.8, 1.3, 2.5)
DAMPING_LEAST, DAMPING_MOST = 0.03, 12.0
LAGS = 10  # time constants of the grid
DEADS = 6


@dataclass(frozen=True)
class Shape:
    """(gain + gain_zero s) exp(-dead s) over 1, lag s + 1, or lag^2 s^2 + 2 damping lag s + 1, or s (lag s + 1). kind "none": nothing seen."""

    kind: str
    gain: float = 0.0
    gain_zero: float = 0.0
    lag_s: float = 0.0
    damping: float = 0.0
    dead_s: float = 0.0
    gain_sd: float = 0.0

    def at(self, s: np.ndarray) -> np.ndarray:
        if self.kind == "none":
            return np.zeros(len(s), complex)
        top = (self.gain + self.gain_zero * s) * np.exp(-self.dead_s * s)
        if self.kind == "lag":
            return top / (self.lag_s * s + 1.0)
        if self.kind == "integrator":
            return top / (s * (self.lag_s * s + 1.0))
        return top / ((self.lag_s * s) ** 2 + 2.0 * self.damping * self.lag_s * s + 1.0)

    def time_s(self) -> float:
        """Dead time and lags together."""
        return self.dead_s + (2.0 * self.damping * self.lag_s if self.kind in ("second", "zero") else self.lag_s)


@dataclass(frozen=True)
class Record:
    """Means over windows of one output while one input does a double step. sd: of each mean. half_s: of the double step, which begins at 0."""

    t: np.ndarray
    y: np.ndarray
    sd: np.ndarray
    amplitude: float
    half_s: float


def basis(kind: str, t: np.ndarray, lag: np.ndarray, damping: np.ndarray, dead: np.ndarray) -> np.ndarray:
    """Step responses of unit gains, (parameters, columns, times). lag, damping, dead: one for each set of parameters."""
    x = t[None, :] - dead[:, None]
    on = x > 0.0
    x = np.where(on, x, 0.0)
    lag, damping = lag[:, None], damping[:, None]
    if kind == "lag":
        return (on * (1.0 - np.exp(-x / lag)))[:, None, :]
    if kind == "integrator":
        return (on * (x - lag * (1.0 - np.exp(-x / lag))))[:, None, :]
    step, slope = np.empty_like(x), np.empty_like(x)
    damped = damping[:, 0] < 1.0
    if damped.any():
        step[damped], slope[damped] = oscillation(x[damped], lag[damped], damping[damped])
    if not damped.all():
        step[~damped], slope[~damped] = two_lags(x[~damped], lag[~damped], damping[~damped])
    step *= on
    return step[:, None, :] if kind == "second" else np.stack([step, slope * on * lag], axis=1)


def oscillation(x: np.ndarray, lag: np.ndarray, damping: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Step response and its slope, damping below 1."""
    a, b = damping / lag, np.sqrt(np.maximum(1.0 - damping**2, 1e-8)) / lag
    decay, sine = np.exp(-a * x), np.sin(b * x)
    return 1.0 - decay * (np.cos(b * x) + a / b * sine), decay * sine * ((a * a + b * b) / b)


def two_lags(x: np.ndarray, lag: np.ndarray, damping: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Likewise, damping 1 or more."""
    root = np.sqrt(np.maximum(damping**2 - 1.0, 1e-8))
    slow, fast = (damping - root) / lag, (damping + root) / lag
    e1, e2 = np.exp(-slow * x), np.exp(-fast * x)
    return 1.0 - (fast * e1 - slow * e2) / (fast - slow), slow * fast * (e1 - e2) / (fast - slow)


def double_step(kind: str, r: Record, lag: np.ndarray, damping: np.ndarray, dead: np.ndarray) -> np.ndarray:
    """Columns of the regression: the shape's, offset, drift; each divided by the deviation of its mean."""
    n, m, k = len(lag), 2 if kind == "zero" else 1, len(r.t)
    out = np.zeros((n, m + 2, k))
    for weight, begin in ((1.0, 0.0), (-2.0, r.half_s), (1.0, 2.0 * r.half_s)):
        first = int(np.searchsorted(r.t, begin))
        out[:, :m, first:] += (weight * r.amplitude) * basis(kind, r.t[first:] - begin, lag, damping, dead)
    out[:, m], out[:, m + 1] = 1.0, r.t / r.t[-1]
    return out / r.sd


def solve(columns: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coefficients, sums of squares and residuals of each set of parameters."""
    size = np.sqrt(np.einsum("nmk,nmk->nm", columns, columns)) + 1e-12
    scaled = columns / size[:, :, None]
    normal = scaled @ scaled.transpose(0, 2, 1) + 1e-10 * np.eye(columns.shape[1])
    found = np.linalg.solve(normal, (scaled @ y)[:, :, None])[:, :, 0]
    left = y - np.einsum("nm,nmk->nk", found, scaled)
    return found / size, np.einsum("nk,nk->n", left, left), left


def fit(kind: str, r: Record, shortest_s: float) -> tuple[Shape, float]:
    """The shape and its sum of squares, residuals over their deviations."""
    y = r.y / r.sd
    second = kind in ("second", "zero")
    lags = np.geomspace(shortest_s, 3.0 * r.half_s, LAGS)
    shares = np.linspace(0.0, 0.8, DEADS)
    dampings = np.array(DAMPINGS if second else (1.0,))
    lag, damping, dead = (a.ravel() for a in np.meshgrid(lags, dampings, shares, indexing="ij"))
    dead = dead * np.minimum(4.0 * lag, 0.6 * r.half_s)
    _, squares, _ = solve(double_step(kind, r, lag, damping, dead), y)
    best: tuple[float, np.ndarray] | None = None
    for start in np.argsort(squares)[:STARTS if second else 1]:
        p = np.array([np.log(lag[start]), np.log(damping[start]), dead[start] / r.half_s])
        found = search(kind, r, y, p, second, shortest_s)
        if best is None or found[0] < best[0]:
            best = found
    squares_best, p = best
    arguments = (np.exp(p[:1]), np.exp(p[1:2]), p[2:] * r.half_s)
    columns = double_step(kind, r, *arguments)
    c = solve(columns, y)[0][0]
    sd = float(np.sqrt(np.linalg.pinv(columns[0] @ columns[0].T)[0, 0]))
    lag_s = float(arguments[0][0])
    return Shape(kind, float(c[0]), float(c[1] * lag_s) if kind == "zero" else 0.0, lag_s, float(arguments[1][0]) if second else 0.0,
                 float(arguments[2][0]), sd), squares_best


def search(kind: str, r: Record, y: np.ndarray, p: np.ndarray, second: bool, shortest_s: float) -> tuple[float, np.ndarray]:
    low = np.array([np.log(0.3 * shortest_s), np.log(DAMPING_LEAST), 0.0])
    high = np.array([np.log(10.0 * r.half_s), np.log(DAMPING_MOST), 0.9])
    free = [0, 1, 2] if second else [0, 2]
    widths = np.array([1e-4, 1e-4, 1e-4])

    def look(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        _, squares, left = solve(double_step(kind, r, np.exp(points[:, 0]), np.exp(points[:, 1]), points[:, 2] * r.half_s), y)
        return squares, left

    damp = 1e-2
    squares, left = look(p[None, :])
    squares, left = squares[0], left[0]
    for _ in range(STEPS_MOST):
        around = np.repeat(p[None, :], len(free), axis=0)
        for k, at in enumerate(free):
            around[k, at] += widths[at]
        slopes = (look(around)[1] - left) / widths[free][:, None]
        normal, right = slopes @ slopes.T, -slopes @ left
        steps = np.stack([np.linalg.solve(normal + d * np.diag(np.diag(normal) + 1e-9), right) for d in (damp, 30.0 * damp)])
        tries = np.repeat(p[None, :], 2, axis=0)
        tries[:, free] += np.clip(steps, -0.7, 0.7)
        tries = np.clip(tries, low, high)
        found, lefts = look(tries)
        best = int(np.argmin(found))
        if found[best] >= squares:
            damp *= 100.0
            if damp > 1e6:
                break
            continue
        gained = squares - found[best]
        p, squares, left = tries[best], found[best], lefts[best]
        damp = max(1e-6, damp * (0.1, 10.0)[best])
        if gained < 1e-3:
            break
    return float(squares), p


PARAMETERS = {"none": 2, "lag": 5, "second": 6, "zero": 7, "integrator": 5}


def choose(r: Record, shortest_s: float) -> Shape:
    """The shape of the least BIC. shortest_s: shortest time constant that is looked for."""
    n = len(r.y)
    flat = np.stack([np.ones(n), r.t / r.t[-1]])[None] / r.sd
    best, least = Shape("none"), solve(flat, r.y / r.sd)[1][0] + PARAMETERS["none"] * np.log(n)
    for kind in ("lag", "second", "zero", "integrator"):
        shape, squares = fit(kind, r, shortest_s)
        value = squares + PARAMETERS[kind] * np.log(n)
        if value < least:
            best, least = shape, value
    return best
