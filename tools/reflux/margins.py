"""Gain margin, phase margin and largest sensitivity of loops on a linear model of their plant.

The open loop is the sampled control law of docs/methods/pid.md times the plant as the sampler sees it: inputs held over a step, dead times of any
length.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Sequence

import numpy as np

from reflux import table

POINTS = 600
LOWEST = 1e-3  # of the slowest corner


@dataclass(frozen=True)
class Law:
    """PID in spans and seconds; sign: +1 reverse, -1 direct."""

    gain: float
    ti_s: float
    td_s: float = 0.0
    sign: float = 1.0
    n: float = 8.0
    filter_s: float = 0.0
    step_s: float = 1.0

    def response(self, omega: np.ndarray) -> np.ndarray:
        """C(z) on the unit circle, with the filter of the measurement."""
        h = self.step_s
        z = np.exp(1j * omega * h)
        c = np.ones_like(z)
        if self.ti_s > 0:
            c = c + h / self.ti_s / (z - 1)
        if self.td_s > 0:
            tf = self.td_s / self.n
            c = c + self.td_s / (tf + h) * (1 - 1 / z) / (1 - tf / (tf + h) / z)
        lag = math.exp(-h / self.filter_s) if self.filter_s > 0 else 0.0
        return self.sign * self.gain * c * (1 - lag) / (1 - lag / z)


@dataclass(frozen=True)
class Margins:
    """gain: factor that the loop's gain bears; phase_deg: at the frequency where the gain is 1; infinite where there is no such frequency.
    together: largest sensitivity with all other loops closed."""

    gain: float
    phase_deg: float
    sensitivity: float
    together: float
    stable: bool

    def cells(self) -> list[str]:
        f = table.figure
        if not self.stable:
            return ["unstable"] + ["-"] * 3
        return [_or_none(self.gain), "none" if math.isinf(self.phase_deg) else f"{f(self.phase_deg)}°", f(self.sensitivity), f(self.together)]


HEADER = ["gain margin", "phase margin", "Ms, other loops in manual", "Ms, other loops closed"]
NOTE = ("Gain margin: the factor that the loop's gain bears before it oscillates for ever; phase margin: the extra lag that it bears where the "
        "open loop's gain is 1. Both with the other loops in manual. Ms: the largest sensitivity, 1 over the smallest distance of the open loop "
        "from -1; up to 2 is usual. \"none\": the loop has no such limit on this model.")


def _or_none(value: float) -> str:
    return "none" if math.isinf(value) else table.figure(value)


def frequencies(slowest_s: float, step_s: float) -> np.ndarray:
    """Even steps of the logarithm, up to half the sampling frequency."""
    end = math.pi / step_s * (1 - 1e-9)
    return np.geomspace(min(LOWEST / max(slowest_s, step_s), 1e-3 * end), end, POINTS)


def sampled(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray, dead_s: np.ndarray, step_s: float, omega: np.ndarray) -> np.ndarray:
    """Responses of a state space behind a hold, points x outputs x inputs. dead_s: of each element."""
    out = np.zeros((len(omega), len(c), b.shape[1]), complex)
    z = np.exp(1j * omega * step_s)
    for dead in np.unique(dead_s):
        whole = math.floor(dead / step_s + 1e-9)
        rest = max(dead - whole * step_s, 0.0)
        phi, late = held(a, b, step_s - rest)  # the new input acts in the last part of the step
        begun, early = held(a, b, rest)
        step = phi @ begun
        new = np.array([c @ np.linalg.solve(x * np.eye(len(a)) - step, late + phi @ early / x) + (d / x if rest else d) for x in z])
        out += np.where(dead_s == dead, new * z[:, None, None] ** -whole, 0.0)
    return out


def held(a: np.ndarray, b: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
    """e^(A t), and what inputs of 1 for this time add."""
    from scipy.linalg import expm  # takes a part of a second to load

    n, m = b.shape
    both = np.zeros((n + m, n + m))
    both[:n, :n], both[:n, n:] = a, b
    found = expm(both * time)
    return found[:n, :n], found[:n, n:]


def of_loops(omega: np.ndarray, plant: np.ndarray, laws: Sequence[Law], unstable_poles: int = 0) -> list[Margins]:
    """plant: points x n x n in spans as sampled() has it, with loops in order of rows and columns. unstable_poles: of the plant."""
    control = np.array([law.response(omega) for law in laws]).T
    opened = plant * control[:, None, :]
    n = len(laws)
    whole = np.linalg.det(np.eye(n) + opened)
    out = []
    all_stable = _stable(omega, whole, unstable_poles)
    for k in range(n):
        own = opened[:, k, k]
        others = [j for j in range(n) if j != k]
        rest = np.linalg.det(np.eye(n - 1) + opened[np.ix_(range(len(omega)), others, others)]) if others else np.ones(len(omega))
        single = of_one(omega, own)
        together = float(np.max(np.abs(rest / whole)))
        out.append(Margins(*single, together if all_stable else math.nan, _stable(omega, own + 1, unstable_poles)))
    return out


def of_one(omega: np.ndarray, opened: np.ndarray) -> tuple[float, float, float]:
    """Gain margin, phase margin in degrees, largest sensitivity of one open loop."""
    size, phase = np.abs(opened), np.unwrap(np.angle(opened))
    gain = math.inf
    turns = np.floor((phase + math.pi) / (2 * math.pi))  # changes where the curve crosses the negative real axis
    for k in np.flatnonzero(np.diff(turns)):
        border = 2 * math.pi * max(turns[k], turns[k + 1]) - math.pi
        share = (border - phase[k]) / (phase[k + 1] - phase[k])
        at = size[k] ** (1 - share) * size[k + 1] ** share
        gain = min(gain, 1 / at) if at < 1 else gain
    if abs(opened[-1].imag) < 1e-6 * size[-1] and opened[-1].real < 0:  # half the sampling frequency
        gain = min(gain, 1 / size[-1]) if size[-1] < 1 else gain
    margin = math.inf
    for k in np.flatnonzero(np.diff(size > 1)):
        share = math.log(size[k]) / math.log(size[k] / size[k + 1])
        at = math.degrees(phase[k] + share * (phase[k + 1] - phase[k]))
        margin = min(margin, abs((at + 180 + 180) % 360 - 180))
    return gain, margin, float(np.max(1 / np.abs(1 + opened)))


def _stable(omega: np.ndarray, curve: np.ndarray, unstable_poles: int) -> bool:
    """Nyquist's criterion: along the frequencies the curve turns by 90 degrees for each integrator of the open loop, which its slope at
    the lowest frequency tells, and by 180 degrees for each unstable pole."""
    integrators = round(-math.log(abs(curve[1] / curve[0])) / math.log(omega[1] / omega[0]))
    turned = np.unwrap(np.angle(curve))
    return bool(abs(turned[-1] - turned[0] - integrators * math.pi / 2 - unstable_poles * math.pi) < math.pi / 2)
