"""Tunings of the campaign `decoupling`, by one rule for all methods, so that none is favoured: all loops are slowed by one factor, as little
as possible, but so that the closed-loop log modulus of all of them together, 20 log |W/(1 + W)| with W = det(I + P G C) - 1, stays below 2 dB for
each loop and 6 dB in all (Luyben 1986, and docs/methods/tuning.md). PIs are those of SIMC (Skogestad 2003) for what each loop has before it with the
decoupler in place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable

import numpy as np

from reflux.errors import RunFailed

DB_PER_LOOP, DB_MOST = 2.0, 6.0
FACTORS = np.geomspace(100.0, 0.25, 61)  # from slow to fast


@dataclass(frozen=True)
class Pi:
    gain: float  # span per span, its sign the plant's
    ti_s: float


@dataclass(frozen=True)
class Seen:
    """Process of one loop: first order with dead time."""

    gain: float
    lag_s: float
    dead_s: float


def frequencies(period_s: float, slowest_s: float) -> np.ndarray:
    return np.geomspace(0.02 / slowest_s, np.pi / period_s, 240)


def seen(response: np.ndarray, omega: np.ndarray, period_s: float) -> Seen:
    """From the response of an element: gain at the lowest frequency, the lag where 1/sqrt 2 of it is left, and of the sum of lag and dead time,
    the slope of the phase at the lowest frequency, what that leaves. Half a sample of the hold is dead time."""
    gain = float(response[0].real)
    part = np.abs(response) / abs(response[0])
    below = np.flatnonzero(part < np.sqrt(0.5))
    lag = 1.0 / omega[below[0]] if len(below) else 1.0 / omega[-1]
    mean = -float(np.angle(response[0] / gain)) / omega[0]
    return Seen(gain, lag, max(mean - lag, 0.0) + period_s / 2)


def simc(of: Seen, factor: float) -> Pi:
    tau = factor * max(of.dead_s, of.lag_s / 8)
    return Pi(of.lag_s / (of.gain * (tau + of.dead_s)), min(of.lag_s, 4 * (tau + of.dead_s)))


def pi_response(pi: Pi, omega: np.ndarray, period_s: float) -> np.ndarray:
    """The board's, sampled."""
    z = np.exp(1j * omega * period_s)
    return pi.gain * (1 + period_s / pi.ti_s * z / (z - 1))


def log_modulus(plant: np.ndarray, compensator: np.ndarray, controllers: np.ndarray) -> float:
    """Largest, dB. plant, compensator: points x n x n; controllers: points x n."""
    loop = plant @ (compensator * controllers[:, None, :])
    w = np.linalg.det(np.eye(plant.shape[1]) + loop) - 1
    return float(20 * np.log10(np.abs(w / (1 + w))).max())


def most_of(n: int) -> float:
    return min(DB_PER_LOOP * n, DB_MOST)


def least_factor(at: Callable[[float], float], most: float) -> float:
    """From slow to fast, since what is unstable may look quiet, the last factor before the bound is passed."""
    best = None
    for factor in FACTORS:
        if at(float(factor)) > most:
            break
        best = float(factor)
    if best is None:
        raise RunFailed("no tuning, however slow, keeps the log modulus low enough")
    return best


def tune_pis(plant: np.ndarray, compensator: np.ndarray, omega: np.ndarray, period_s: float) -> list[Pi]:
    before = [seen((plant @ compensator)[:, k, k], omega, period_s) for k in range(plant.shape[1])]
    delayed = plant * np.exp(-0.5j * omega * period_s)[:, None, None]

    def at(factor: float) -> float:
        pis = np.stack([pi_response(simc(s, factor), omega, period_s) for s in before], axis=1)
        return log_modulus(delayed, compensator, pis)

    factor = least_factor(at, most_of(plant.shape[1]))
    return [simc(s, factor) for s in before]


def of_z(polynomials: np.ndarray, omega: np.ndarray, period_s: float) -> np.ndarray:
    """... x coefficients, 0 first: points x ..."""
    powers = np.exp(-1j * np.outer(omega * period_s, np.arange(polynomials.shape[-1])))
    return np.tensordot(powers, polynomials, axes=([1], [polynomials.ndim - 1]))
