"""Analyses the matrices of a plant for control: gains, relative gains, directions, times."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

STANDS_STILL = 1e-11  # 1/s: a pole nearer to 0 counts as 0
GRID = 1500  # points of a step response
WEAK = 1e-4  # of the largest gain in spans: smaller ones have no settling time
BAND = 0.05  # of the final change


@dataclass(frozen=True)
class Model:
    """dx/dt = A x + B u, y = C x + D u, with the names and spans of inputs and outputs."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def only(self, inputs: tuple[str, ...], outputs: tuple[str, ...]) -> "Model":
        j = [self.inputs.index(name) for name in inputs]
        i = [self.outputs.index(name) for name in outputs]
        return Model(self.a, self.b[:, j], self.c[i], self.d[np.ix_(i, j)], inputs, outputs)


def poles(model: Model) -> np.ndarray:
    """The slowest first."""
    found = np.linalg.eigvals(model.a)
    return found[np.argsort(-found.real)]


def obstacle(found: np.ndarray) -> str | None:
    """Why there is no steady state to come to after a step."""
    growing = int((found.real > STANDS_STILL).sum())
    if growing:
        return f"the plant is unstable: {growing} of its poles grow"
    still = int((np.abs(found) <= STANDS_STILL).sum())
    if still:
        return f"{still} of its poles are 0: something runs away when an input is moved (a level that no flow holds?)"
    return None


def gains(model: Model) -> np.ndarray:
    return model.d - model.c @ np.linalg.solve(model.a, model.b)


def relative_gains(k: np.ndarray) -> np.ndarray:
    """Relative gains of a matrix in spans, square or not."""
    return k * np.linalg.pinv(k).T


def step_responses(model: Model, dt: float) -> np.ndarray:
    """[GRID + 1, outputs, inputs] at multiples of dt, by TR-BDF2 (Bank and others, IEEE Trans. Electron Devices 32 (1985) 1992):
    one matrix is factored, and what is fast dies out however long dt is."""
    n = len(model.a)
    gamma = 2.0 - np.sqrt(2.0)
    share = 0.5 * gamma * dt
    factors = linalg.lu_factor(np.eye(n) - share * model.a)
    start = np.eye(n) + share * model.a
    first, second = 1.0 / (gamma * (2.0 - gamma)), (1.0 - gamma) ** 2 / (gamma * (2.0 - gamma))
    x = np.zeros_like(model.b)
    found = np.empty((GRID + 1, *model.d.shape))
    for k in range(GRID + 1):
        found[k] = model.c @ x + model.d
        middle = linalg.lu_solve(factors, start @ x + gamma * dt * model.b, check_finite=False)
        x = linalg.lu_solve(factors, first * middle - second * x + share * model.b, check_finite=False)
    return found


def settling(model: Model, k: np.ndarray, in_spans: np.ndarray, slowest_s: float) -> np.ndarray:
    """Seconds after a step of an input until an output stays within BAND of its change; NaN where that is next to nothing."""
    times = np.full(k.shape, np.nan)
    matters = np.abs(in_spans) > WEAK * np.abs(in_spans).max()
    dt = 12.0 * slowest_s / GRID
    left = np.abs(step_responses(model, dt) - k)
    outside = left > BAND * np.abs(k)
    for i, j in zip(*np.nonzero(matters)):
        last = np.flatnonzero(outside[:, i, j])
        times[i, j] = dt * (last[-1] + 1) if len(last) else 0.0
    return times


@dataclass(frozen=True)
class Directions:
    """Singular values in spans, with what moves (rows of inputs) and what is moved (rows of outputs)."""

    values: np.ndarray
    inputs: np.ndarray
    outputs: np.ndarray

    @property
    def condition(self) -> float:
        return float(self.values[0] / self.values[-1]) if self.values[-1] > 0 else float("inf")


def directions(in_spans: np.ndarray) -> Directions:
    u, s, v = np.linalg.svd(in_spans, full_matrices=False)
    signs = np.sign(v[np.arange(len(v)), np.abs(v).argmax(axis=1)])
    return Directions(s, v * signs[:, None], (u * signs).T)
