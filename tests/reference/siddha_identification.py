"""Identification of Siddha (2003) in numpy and double, all seeds as one array: recursive least squares of over-parameterised models, their
frequency responses, and Gd/Gp from them by the four ways A, B, C, D (siddha_simulation.py has the loop). The firmware's own is
firmware/identify/high_order.c."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from siddha_simulation import BACK, TS, Record, controller

METHODS = ("A", "B", "C", "D")


@dataclass(frozen=True)
class Model:
    """na coefficients of A; inputs: how many of B and the smallest dead time in samples, of each."""

    output: str  # of a Record
    inputs: tuple[tuple[str, int, int], ...]
    na: int

    @property
    def parameters(self) -> int:
        return self.na + sum(nb for _, nb, _ in self.inputs)


JOINT = Model("y", (("u", 3, 12), ("d", 14, 8)), 5)  # 2.1, 2.2
PROCESS = Model("y", (("u", 3, 12),), 2)  # 3.3
SENSITIVITY = Model("y", (("d", 15, 8),), 20)  # 3.4
TRACKING = Model("y", (("r", 3, 12),), 13)  # 3.7
INPUT = Model("u", (("d", 10, 8),), 15)  # 3.10
FIRST = {"B": PROCESS, "C": TRACKING, "D": TRACKING}
SECOND = {"A": JOINT, "B": SENSITIVITY, "C": SENSITIVITY, "D": INPUT}


def lagged(x: np.ndarray, lags_s: float) -> np.ndarray:
    """Two lags in series, backward Euler, over the last axis."""
    if lags_s <= 0:
        return x
    k = TS / (lags_s + TS)
    return lfilter([k], [1, k - 1], lfilter([k], [1, k - 1], x, axis=-1), axis=-1)


def signal(record: Record, name: str) -> np.ndarray:
    """[seeds, samples]"""
    x = getattr(record, name)
    return x if x.ndim == 2 else np.broadcast_to(x, record.y.shape)


class Rls:
    """2.4, a model of every seed."""

    def __init__(self, model: Model, seeds: int, forget: float = 0.999, p0: float = 100.0):
        self.model, self.forget, self.p0 = model, forget, p0
        self.theta = np.zeros((seeds, model.parameters))
        self.p = np.tile(p0 * np.eye(model.parameters), (seeds, 1, 1))

    def reset(self) -> None:
        self.theta[:], self.p[:] = 0.0, self.p0 * np.eye(self.model.parameters)

    def step(self, k: int, y: np.ndarray, inputs: list[np.ndarray]) -> None:
        """Sample k of signals [seeds, samples], of which samples up to k are there."""
        m = self.model
        parts = [-y[:, k - m.na : k][:, ::-1]]
        parts += [x[:, k - delay - nb + 1 : k - delay + 1][:, ::-1] for x, (_, nb, delay) in zip(inputs, m.inputs)]
        phi = np.concatenate(parts, axis=1)
        g = np.matmul(self.p, phi[:, :, None])[:, :, 0]
        alpha = self.forget + np.sum(phi * g, axis=1)
        self.theta += g * ((y[:, k] - np.sum(phi * self.theta, axis=1)) / alpha)[:, None]
        # symmetric to the last bit: what is not grows by 1/forget a step, e^42 over the nine regimes
        self.p = (self.p - g[:, :, None] * g[:, None, :] / alpha[:, None, None]) / self.forget


def batch(model: Model, record: Record, first: int, last: int, forget: float = 1.0, p0: float = 1e4, lags_s: float = 0.0,
          past: int = 400) -> np.ndarray:
    """Result of Rls from theta = 0 after samples first to last - 1, by the normal equations: theta [seeds, parameters]."""
    low = max(0, first - past)
    y = lagged(signal(record, model.output)[:, low:last], lags_s)
    columns = [-y[:, first - low - i : last - low - i] for i in range(1, model.na + 1)]
    for name, nb, delay in model.inputs:
        x = lagged(signal(record, name)[:, low:last], lags_s)
        columns += [x[:, first - low - delay - j : last - low - delay - j] for j in range(nb)]
    phi = np.stack(columns, axis=-1)
    count, n = phi.shape[1:]
    weighted = phi * (forget ** np.arange(count - 1, -1, -1.0))[None, :, None]
    h = np.matmul(weighted.transpose(0, 2, 1), phi) + np.eye(n) * forget**count / p0
    return np.linalg.solve(h, np.matmul(weighted.transpose(0, 2, 1), y[:, first - low :, None]))[..., 0]


def response(model: Model, theta: np.ndarray, back: np.ndarray = BACK) -> list[np.ndarray]:
    """Response to each input [seeds, frequencies]."""
    a = 1 + theta[:, : model.na] @ back[None, :] ** np.arange(1, model.na + 1)[:, None]
    found, at = [], model.na
    for _, nb, delay in model.inputs:
        found.append(theta[:, at : at + nb] @ back[None, :] ** (delay + np.arange(nb))[:, None] / a)
        at += nb
    return found


def ratio_of(method: str, first: np.ndarray | None, second: np.ndarray | list[np.ndarray], back: np.ndarray = BACK) -> np.ndarray:
    """Gd/Gp. first: Gp (B) or T (C, D); second: Sd (B, C), u/d (D), or Gp and Gd (A)."""
    c = controller(back)
    if method == "A":
        return second[1] / second[0]
    if method == "B":
        return second * (1 + first * c) / first
    return second * c / first if method == "C" else -second / first
