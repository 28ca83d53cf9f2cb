"""Judges PI loops on a linear plant: stable or not, the largest sensitivity, the gain margin, and the Niederlinski index of the true gains.

The loops are those that the firmware runs: the positional PI of docs/methods/pid.md at every tick of the plant, inputs held between. Each loop is
broken at its input while the others stay closed. Stability is exact: det(I + G C) is followed along a circle just outside the unit circle and
its turns about 0 are counted, which gives the number of closed-loop poles outside.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence

import numpy as np

from research.startup_linear import INTEGRATES, Linear

OUTSIDE = 1e-8  # distance of the circle from the unit circle: poles at 1 stay inside
TURN_MOST = np.pi / 4.0  # between two points of the curve
REFINEMENTS = 30
PER_DECADE = 60
DERIVATIVE_FILTER = 8.0  # N of docs/methods/pid.md


@dataclass(frozen=True)
class PI:
    """A loop. kc: signed, output span per measurement span; ti_s and td_s in seconds, 0: none."""

    output: int
    input: int
    kc: float
    ti_s: float
    td_s: float = 0.0


@dataclass(frozen=True)
class Verdict:
    stable: bool
    ms: float  # worst loop; infinite where unstable
    gain_margin: float  # worst loop, also downwards: 1 where unstable
    niederlinski: float


def controllers(loops: Sequence[PI], z: np.ndarray, h: float) -> np.ndarray:
    """One row a point, one column a loop."""
    out = np.zeros((len(z), len(loops)), complex)
    for k, loop in enumerate(loops):
        out[:, k] = loop.kc
        if loop.ti_s > 0.0:
            out[:, k] += loop.kc * h / loop.ti_s / (z - 1.0)
        if loop.td_s > 0.0:
            filter_s = loop.td_s / DERIVATIVE_FILTER
            out[:, k] += loop.kc * loop.td_s / (filter_s + h) * (1.0 - 1.0 / z) / (1.0 - filter_s / (filter_s + h) / z)
    return out


class Judge:
    """Of one plant: what depends on the plant alone is computed once."""

    def __init__(self, plant: Linear):
        self.plant = plant
        dead = plant.dead_samples()
        rates = np.abs(plant.poles())
        self.slowest_rate = min((r for r in rates if r > INTEGRATES), default=1.0 / plant.h) * plant.h
        low = min(self.slowest_rate * 1e-3, 1e-4)
        # The curve turns with every dead time: the upper end needs points at equal distances.
        even = np.pi / (16.0 * dead)
        log = np.geomspace(low, np.pi, int(PER_DECADE * np.log10(np.pi / low)) + 2)
        fine = np.arange(even, np.pi, even) if dead < 2000 else np.zeros(0)
        self.angles = np.unique(np.concatenate([log, fine]))
        self.g = plant.at(np.exp(1j * self.angles))

    def judge(self, loops: Sequence[PI], decoupler: np.ndarray | None = None) -> Verdict:
        """decoupler: inputs of the loops by the controllers' outputs, in spans; None: each drives its own."""
        if not loops:
            return Verdict(True, 1.0, np.inf, np.nan)
        rows, columns = [loop.output for loop in loops], [loop.input for loop in loops]
        d = np.eye(len(loops)) if decoupler is None else np.asarray(decoupler, float)
        index = niederlinski(self.plant.gains(), loops)
        if poles_outside(self.plant, loops, d) != 0:
            return Verdict(False, np.inf, 1.0, index)
        angles, g = self.angles, self.g[:, rows][:, :, columns]
        sensitivity = self._sensitivities(angles, g, loops, d)
        around = self._around_peaks(angles, np.abs(sensitivity))
        if len(around):
            more = self.plant.at(np.exp(1j * around))[:, rows][:, :, columns]
            sensitivity = np.concatenate([sensitivity, self._sensitivities(around, more, loops, d)])
            order = np.argsort(np.concatenate([angles, around]))
            sensitivity = sensitivity[order]
        return Verdict(True, float(np.abs(sensitivity).max()), gain_margin(1.0 / sensitivity - 1.0), index)

    def _sensitivities(self, angles: np.ndarray, g: np.ndarray, loops: Sequence[PI], d: np.ndarray) -> np.ndarray:
        """1 / (1 + L) of every loop broken at its controller's output, the others closed: the diagonal of (I + C G D)^-1."""
        c = controllers(loops, np.exp(1j * angles), self.plant.h)
        inverse = np.linalg.inv(np.eye(len(loops)) + c[:, :, None] * (g @ d))
        return np.einsum("kii->ki", inverse)

    @staticmethod
    def _around_peaks(angles: np.ndarray, size: np.ndarray) -> np.ndarray:
        """More points about the highest peak of each loop."""
        more = []
        for k in range(size.shape[1]):
            top = int(np.argmax(size[:, k]))
            more.append(np.linspace(angles[max(top - 1, 0)], angles[min(top + 1, len(angles) - 1)], 12)[1:-1])
        return np.unique(np.concatenate(more))


def gain_margin(loop: np.ndarray) -> float:
    """Smallest factor, up or down, by which one loop alone may change before it reaches -1. loop: one row a frequency, one column a loop."""
    worst = np.inf
    for k in range(loop.shape[1]):
        re, im = loop[:, k].real, loop[:, k].imag
        at = np.flatnonzero(np.signbit(im[1:]) != np.signbit(im[:-1]))
        share = im[at] / (im[at] - im[at + 1])
        crossing = re[at] + share * (re[at + 1] - re[at])
        # At half the sampling frequency the loop is real, and so is one without integral action at the lowest.
        crossing = np.concatenate([crossing, re[-1:], re[:1] if abs(im[0]) < 0.01 * abs(re[0]) else []])
        crossing = -crossing[crossing < 0.0]
        if len(crossing):
            worst = min(worst, float(np.exp(np.abs(np.log(np.maximum(crossing, 1e-12))).min())))
    return worst


def niederlinski(gains: np.ndarray, loops: Sequence[PI]) -> float:
    """det of the paired gains over the product of the pairs; negative: no tuning with integral action is stable with integrity."""
    square = gains[[loop.output for loop in loops]][:, [loop.input for loop in loops]]
    product = float(np.prod(np.diag(square)))
    return float(np.linalg.det(square)) / product if product else -np.inf


def poles_outside(plant: Linear, loops: Sequence[PI], decoupler: np.ndarray | None = None) -> int:
    """Closed-loop poles outside the unit circle, by the argument principle."""
    rows, columns = [loop.output for loop in loops], [loop.input for loop in loops]
    d = np.eye(len(loops)) if decoupler is None else decoupler

    def curve(angles: np.ndarray) -> np.ndarray:
        z = np.exp(OUTSIDE + 1j * angles)
        c = controllers(loops, z, plant.h)
        return np.linalg.det(np.eye(len(loops)) + plant.at(z)[:, rows][:, :, columns] @ (d * c[:, None, :]))

    even = np.pi / (8.0 * len(loops) * plant.dead_samples())
    angles = np.unique(np.concatenate([[0.0], np.geomspace(OUTSIDE * 0.05, np.pi, 500), np.arange(even, np.pi, even)]))
    values = curve(angles)
    for _ in range(REFINEMENTS):
        turns = np.abs(np.angle(values[1:] / values[:-1]))
        long = np.flatnonzero(turns > TURN_MOST)
        if not len(long):
            break
        between = 0.5 * (angles[long] + angles[long + 1])
        angles = np.insert(angles, long + 1, between)
        values = np.insert(values, long + 1, curve(between))
    turned = float(np.sum(np.angle(values[1:] / values[:-1])))
    # From 0 to pi is half of the circle, and the other half is its mirror image.
    return plant.unstable_poles() - int(round(turned / np.pi))
