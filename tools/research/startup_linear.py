"""A linear plant of the simulator's JSON, sampled exactly: step responses, frequency responses and gains in spans, with numpy alone.

An input is held from one sample to the next, as the firmware holds it. A dead time of d + f samples (0 <= f < 1) makes an input act with
its value before for the part f of a sample. Disturbances do not count; where an element has cases the first is in force.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0}
NEAR_ZERO = 1e-6  # real s, in units of the slowest rate, at which the gains of an integrating plant are compared
INTEGRATES = 1e-9  # a pole this close to 0, 1/s, integrates


@dataclass(frozen=True)
class Part:
    """x' = A x + B u(t - dead), y = C x + D u(t - dead): one element, or a whole state space. Spans and seconds."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    dead_s: float
    inputs: tuple[int, ...]
    outputs: tuple[int, ...]


@dataclass(frozen=True)
class Sampled:
    """x(k+1) = A x(k) + new u(k - whole) + old u(k - whole - 1); y(k) = C x(k) + D u(k - whole - 1)."""

    a: np.ndarray
    new: np.ndarray
    old: np.ndarray
    c: np.ndarray
    d: np.ndarray
    whole: int
    inputs: tuple[int, ...]
    outputs: tuple[int, ...]


def exponential(a: np.ndarray) -> np.ndarray:
    """Matrix exponential by scaling, a Taylor series and squaring."""
    halvings = max(0, int(np.ceil(np.log2(max(np.abs(a).sum(axis=1).max(), 1e-300)))) + 2)
    scaled = a / 2.0**halvings
    total = term = np.eye(len(a))
    for k in range(1, 18):
        term = term @ scaled / k
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return total


def sampled(part: Part, h: float) -> Sampled:
    n, m = part.b.shape
    whole = int(np.floor(part.dead_s / h + 1e-9))
    fraction = min(max(part.dead_s / h - whole, 0.0), 1.0)
    both = np.zeros((n + m, n + m))
    both[:n, :n], both[:n, n:] = part.a, part.b
    all_of_it, late = exponential(both * h), exponential(both * (h * (1.0 - fraction)))
    new = late[:n, n:]
    return Sampled(all_of_it[:n, :n], new, all_of_it[:n, n:] - new, part.c, part.d, whole, part.inputs, part.outputs)


def element_part(e: dict[str, Any], unit: float, scale: float, output: int, source: int) -> Part:
    """One element of a `transfer` plant as a chain of lags, an oscillator, and an integrator behind them. scale: gain in spans over gain."""
    gain, zero = e["gain"] * scale / (unit if e.get("integrator") else 1.0), e.get("zero", 0.0) * unit
    lags = e.get("lags", [])
    times = [t * unit for t in (lags if isinstance(lags, list) else [lags])]
    integrator = bool(e.get("integrator"))
    n = (2 if "quadratic" in e else len(times)) + integrator
    a, b, c, d = np.zeros((n, n)), np.zeros((n, 1)), np.zeros((1, n)), np.zeros((1, 1))
    if "quadratic" in e:
        a2, a1 = e["quadratic"][0] * unit**2, e["quadratic"][1] * unit
        w = 1.0 / np.sqrt(a2)
        a[:2, :2], b[1, 0] = [[0.0, w], [-w, -a1 * w * w]], w
        last, slope, slope_by_input = np.array([1.0, 0.0]), np.array([0.0, w]), 0.0
    elif times:
        for k, t in enumerate(times):
            a[k, k] = -1.0 / t
            if k:
                a[k, k - 1] = 1.0 / t
        b[0, 0] = 1.0 / times[0]
        size = len(times)
        last, slope = np.eye(size)[-1], a[size - 1, :size].copy()
        slope_by_input = b[size - 1, 0]
    else:
        last, slope, slope_by_input = np.zeros(0), np.zeros(0), 0.0
    size = n - integrator
    if integrator:
        a[size, :size] = last
        b[size, 0] = 0.0 if size else 1.0
        c[0, size] = gain
        c[0, :size] = gain * zero * last
    else:
        c[0, :size] = gain * (last + zero * slope)
        d[0, 0] = gain * (zero * slope_by_input if size else 1.0)
    return Part(a, b, c, d, e.get("dead_time", 0.0) * unit, (source,), (output,))


class Linear:
    """actuator_gains: what each input does, as a multiple of what the file says (a valve with another trim)."""

    def __init__(self, data: dict[str, Any], actuator_gains: dict[str, float] | None = None):
        unit, self.h = UNITS[data.get("time_unit", "s")], float(data["tick_s"])
        self.outputs = [y["name"] for y in data["outputs"]]
        self.inputs = [u["name"] for u in data["inputs"]]
        span_y = np.array([float(y["hi"] - y["lo"]) for y in data["outputs"]])
        span_u = np.array([float(u["hi"] - u["lo"]) for u in data["inputs"]])
        span_u = span_u * np.array([(actuator_gains or {}).get(name, 1.0) for name in self.inputs])
        p, m = len(self.outputs), len(self.inputs)
        self.elements: list[list[dict[str, Any] | None]] | None = None
        self.unit = unit
        if data["model"] == "transfer":
            self.elements = [[e and (e["cases"][0] if "cases" in e else e) for e in row[:m]] for row in data["elements"]]
            self.parts = [element_part(e, unit, span_u[j] / span_y[i], i, j)
                          for i, row in enumerate(self.elements) for j, e in enumerate(row) if e]
        elif data["model"] == "state_space":
            d = np.array(data.get("D", np.zeros((p, m))), float)
            self.parts = [Part(np.array(data["A"], float) / unit, np.array(data["B"], float) / unit * span_u,
                               np.array(data["C"], float) / span_y[:, None], d * span_u / span_y[:, None], 0.0,
                               tuple(range(m)), tuple(range(p)))]
        else:
            raise ValueError(f"{data['name']}: a {data['model']} plant has a period of its own")
        self.sampled = [sampled(part, self.h) for part in self.parts]
        self.shape = (p, m)

    def poles(self) -> np.ndarray:
        """1/s, those of every element by itself."""
        found = [np.linalg.eigvals(part.a) for part in self.parts if len(part.a)]
        return np.concatenate(found) if found else np.zeros(0)

    def stable(self) -> bool:
        return bool(np.all(self.poles().real < -INTEGRATES))

    def unstable_poles(self) -> int:
        return int(np.sum(self.poles().real > INTEGRATES))

    def slowest_s(self) -> float:
        """Slowest time constant of what neither integrates nor runs away, s."""
        rates = -self.poles().real
        return float(1.0 / min((r for r in rates if r > INTEGRATES), default=1.0 / self.h))

    def dead_samples(self) -> int:
        return max(s.whole for s in self.sampled) + 1

    def at(self, z: np.ndarray) -> np.ndarray:
        """The sampled plant, in spans, at points z: one matrix a point."""
        out = np.zeros((len(z), *self.shape), complex)
        for s in self.sampled:
            shift = np.exp(-s.whole * np.log(z))[:, None, None]
            value = s.d * shift / z[:, None, None]
            if len(s.a):
                right = s.new * shift + s.old * (shift / z[:, None, None])
                if len(s.a) == 1:
                    value = value + s.c * right / (z[:, None, None] - s.a)
                else:
                    value = value + s.c @ np.linalg.solve(z[:, None, None] * np.eye(len(s.a)) - s.a, right)
            out[np.ix_(range(len(z)), s.outputs, s.inputs)] += value
        return out

    def gains(self) -> np.ndarray:
        """Gains at rest; of a plant that integrates those at a very low real frequency, of which signs and ratios hold."""
        rates = np.abs(self.poles())
        s = 0.0 if np.all(rates > INTEGRATES) else NEAR_ZERO * min((r for r in rates if r > INTEGRATES), default=1.0 / self.h)
        out = np.zeros(self.shape)
        for part in self.parts:
            value = part.d + (part.c @ np.linalg.solve(s * np.eye(len(part.a)) - part.a, part.b) if len(part.a) else 0.0)
            out[np.ix_(part.outputs, part.inputs)] += value
        return out

    def residences(self) -> np.ndarray:
        """Average residence time of every element, s: lags less zeros, and dead time; not a number where there is none."""
        out = np.full(self.shape, np.nan)
        for part in self.parts:
            if not len(part.a) or np.any(np.abs(np.linalg.eigvals(part.a)) < INTEGRATES):
                continue
            inverse = np.linalg.inv(part.a)
            gain, moment = part.d - part.c @ inverse @ part.b, part.c @ inverse @ inverse @ part.b
            for k, i in enumerate(part.outputs):
                for n, j in enumerate(part.inputs):
                    if gain[k, n] != 0.0:
                        out[i, j] = moment[k, n] / gain[k, n] + part.dead_s
        return out

    def steps(self, count: int) -> np.ndarray:
        """Responses at samples 0 .. count - 1 to a step of each input at sample 0, one matrix a sample."""
        out = np.zeros((count, *self.shape))
        for s in self.sampled:
            x = _constant_input(s, count - s.whole)
            if not len(x):
                continue
            y = np.einsum("pn,knm->kpm", s.c, x)
            y[1:] += s.d
            out[np.ix_(range(s.whole, count), s.outputs, s.inputs)] += y
        return out


def _constant_input(s: Sampled, count: int) -> np.ndarray:
    """States at samples 0 .. count - 1 after a step of each input, by doubling: x(k + m) = A^m x(k) + x(m) for m > 0."""
    n, m = s.new.shape
    if count <= 0:
        return np.zeros((0, n, m))
    x = np.zeros((count, n, m))
    if count == 1 or n == 0:
        return x
    x[1] = s.new
    # From sample 1 on the input is constant: y(k) = x(k + 1) has y(k + m) = A^m y(k) + f(m), f(m) the response from 0 to new + old.
    power, forced, known = s.a, s.new + s.old, 1
    while known < count - 1:
        take = min(known, count - 1 - known)
        x[1 + known:1 + known + take] = power @ x[1:1 + take] + forced
        forced = power @ forced + forced
        power = power @ power
        known *= 2
    return x
