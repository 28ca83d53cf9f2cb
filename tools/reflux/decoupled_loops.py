"""Loops with a decoupler, for tools/decouple: controllers by pole placement, what the closed loops do on the model, and the lines for the
board. All in fractions of span, loop k output k by input k."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from reflux import decoupling
from reflux.errors import RunFailed
from reflux.sampled_plant import SampledPlant

TAPS = 8  # of the kinds polynomial and rst
ELEMENT_MOST, P_MOST, QR_MOST = 100.0, 100.0, 1000.0  # their parameters' ranges
STEPS_MOST = 3000
HIDDEN = 1e-6  # between a pole and a zero that are one but for rounding
SINGULAR = 1e-3  # determinant of a part of a static decoupler, whose diagonal is 1


@dataclass(frozen=True)
class Compensator:
    """u = G v. found: of the polynomial decoupler; shape: of a static one, whose G has one coefficient."""

    g: np.ndarray  # n x n x taps, coefficient 0 first
    found: decoupling.Decoupled | None = None
    shape: decoupling.Shape | None = None

    def recursive(self) -> bool:
        """May what was limited be taken into G's past? A static one has none, and needs an inverse, whichever loops are in manual."""
        if self.found:
            return self.found.recursive
        d = self.g[:, :, 0]
        parts = [np.ix_(which, which) for k in range(len(d)) for which in combinations(range(len(d)), k + 1)]
        return min(abs(np.linalg.det(d[part])) for part in parts) > SINGULAR

    def seen(self, plant: SampledPlant) -> np.ndarray:
        """B G, n x n x coefficients, coefficient 0 first: y_i = sum of seen_ij / A_ii v_j."""
        n, length = plant.n, plant.b.shape[2] + self.g.shape[2]
        out = np.zeros((n, n, length))
        for i in range(n):
            for j in range(n):
                for k in range(n):
                    out[i, j, 1:] += np.convolve(plant.b[i, k], self.g[k, j])
        return out


@dataclass(frozen=True)
class Moves:
    """On a setpoint step of 1 of one loop, on the model."""

    overshoot: float
    inputs: np.ndarray  # largest magnitude of each
    others: np.ndarray  # largest magnitude of each output, of the own one 0


def place_all(plant: SampledPlant, compensator: Compensator, overshoot: float, settling: list[float], observer: float,
              condition_hi: float | None = None) -> list[decoupling.Placed]:
    """One controller for each loop, as if the others were not there."""
    placed = []
    for k in range(plant.n):
        a, b, _ = loop_of(plant, compensator, k)
        try:
            placed.append(decoupling.place(a, b, plant.period, overshoot, settling[k], observer, condition_hi))
        except decoupling.Refused as refused:
            raise RunFailed(f"no controller for {plant.outputs[k]}: {refused}") from None
    return placed


def loop_of(plant: SampledPlant, compensator: Compensator, k: int) -> tuple[np.ndarray, np.ndarray, list[complex]]:
    """A and B of loop k with the others open, coefficient 0 first, without poles that a zero hides, which are told as well. Elements of a continuous
    plant share the denominator of their output, and so a loop has poles of other elements. Only those go that die away by themselves."""
    a, b = np.array([1.0, *plant.a[k]]), compensator.found.h[k] if compensator.found else compensator.seen(plant)[k, k]
    at = np.flatnonzero(b)
    if compensator.found or not len(at):
        return a, b, []
    zeros, poles, hidden = list(np.roots(b[at[0] : at[-1] + 1])), [], []
    for p in np.roots(np.trim_zeros(a, "b")):
        near = next((i for i, z in enumerate(zeros) if abs(z - p) <= HIDDEN and abs(p) < 1 - HIDDEN), None)
        if near is None:
            poles.append(p)
        else:
            hidden.append(complex(zeros.pop(near)))
    if not hidden or abs(sum(z.imag for z in hidden)) > HIDDEN:  # none, or half a pair
        return a, b, []
    # Of no roots at all numpy.poly makes a number and no polynomial.
    left = [np.atleast_1d(np.real(np.poly(roots))) for roots in (poles, zeros)]
    return left[0], np.concatenate([np.zeros(at[0]), b[at[0]] * left[1]]), hidden


def closed_radius(plant: SampledPlant, compensator: Compensator, placed: list[decoupling.Placed]) -> float:
    """Largest magnitude of the poles of all loops together, with the interaction that is left: with y = K P x, v = -Q x of each loop,
    (A K P + B G Q) x = 0, a monic polynomial in z^-1 with matrices for coefficients, whose poles are those of its companion."""
    n, seen = plant.n, compensator.seen(plant)
    longest = seen.shape[2] + plant.a.shape[1] + max(len(c.p) + len(c.q) for c in placed) + 2
    m = np.zeros((longest, n, n))
    for j, c in enumerate(placed):
        own = np.convolve(np.convolve([1.0, *plant.a[j]], [1.0, -1.0]), c.p)
        m[: len(own), j, j] += own
        for i in range(n):
            part = np.convolve(seen[i, j], c.q)
            m[: len(part), i, j] += part
    while len(m) > 2 and not np.any(m[-1]):
        m = m[:-1]
    size = n * (len(m) - 1)
    whole = np.zeros((size, size))
    whole[:n] = -np.concatenate(m[1:], axis=1)
    whole[n:, :-n] = np.eye(size - n)
    return float(np.abs(np.linalg.eigvals(whole)).max())


def step_of(plant: SampledPlant, compensator: Compensator, placed: list[decoupling.Placed], loop: int, settling: float) -> Moves:
    """No limits, no noise: what the model does."""
    n, na, nb, taps = plant.n, plant.a.shape[1], plant.b.shape[2], compensator.g.shape[2]
    steps = int(min(STEPS_MOST, 4 * settling / plant.period + 60))
    lead = max(na, nb, taps, *(len(x) for c in placed for x in (c.p, c.q, c.r))) + 1  # at rest before
    y, u, v = (np.zeros((lead + steps, n)) for _ in range(3))
    w = np.zeros((lead + steps, n))
    w[lead:, loop] = 1.0
    kp = [np.convolve(c.p, [1.0, -1.0]) for c in placed]
    for t in range(lead, lead + steps):
        past_y, past_u = y[t - na : t][::-1], u[t - nb : t][::-1]
        y[t] = np.einsum("ijk,kj->i", plant.b, past_u) - np.einsum("ik,ki->i", plant.a, past_y)
        for k, c in enumerate(placed):
            v[t, k] = c.r @ back(w[:, k], t, len(c.r)) - c.q @ back(y[:, k], t, len(c.q)) - kp[k][1:] @ back(v[:, k], t - 1, len(kp[k]) - 1)
        u[t] = np.einsum("ijk,kj->i", compensator.g, v[t - taps + 1 : t + 1][::-1])
    others = np.abs(y).max(axis=0)
    others[loop] = 0.0
    return Moves(float(y[:, loop].max() - 1.0), np.abs(u).max(axis=0), others)


def back(x: np.ndarray, t: int, count: int) -> np.ndarray:
    """x(t), x(t - 1) and so on."""
    return x[t - count + 1 : t + 1][::-1]


# ---- for the board ----


def lines(plant: SampledPlant, compensator: Compensator, placed: list[decoupling.Placed], names: list[str], numbers: list[int], first: int,
          divisor: int | None = None) -> list[str]:
    """`set` lines. names: of the loops on the board, numbers: theirs, first: block, divisor: base ticks in a period; a remark where it is not known."""
    # The board's static decoupler takes no loops with controllers of their own: then a matrix is a polynomial of one coefficient.
    as_block = bool(compensator.found or placed)
    out = polynomial_lines(plant, compensator, names, first) if as_block else static_lines(compensator.g[:, :, 0], numbers)
    block = first + 1 if as_block else first
    if placed and divisor is None:
        out.append(f"# the loops have to run every {plant.period:g} s: --tick S prints their divisors")
    elif placed:
        out += [f"set loop{number}.divisor {divisor}" for number in numbers]
    for k, c in enumerate(placed):
        out += rst_lines(plant, c, names[k], block + k)
    return out


def polynomial_lines(plant: SampledPlant, compensator: Compensator, names: list[str], block: int) -> list[str]:
    g = compensator.g
    if g.shape[2] > TAPS:
        raise RunFailed(f"G has elements of {g.shape[2]} coefficients, and the kind polynomial takes {TAPS}: a longer period, or a static decoupler")
    if np.abs(g).max() > ELEMENT_MOST:
        raise RunFailed(f"G has a coefficient of {np.abs(g).max():.4g}, and the kind polynomial takes {ELEMENT_MOST:g}")
    out = [f"set block{block}.kind polynomial", f"set block{block}.loops {','.join(names)}", f"set block{block}.period {plant.period:.9g}",
           f"set block{block}.limits {'recurse' if compensator.recursive() else 'scale'}"]
    return out + [f"set block{block}.g.{i * plant.n + j + 1} {row(g[i, j])}" for i in range(plant.n) for j in range(plant.n)]


def static_lines(d: np.ndarray, numbers: list[int]) -> list[str]:
    if np.abs(d).max() > ELEMENT_MOST:
        raise RunFailed(f"the decoupler has an element of {np.abs(d).max():.4g}, and the board takes {ELEMENT_MOST:g}")
    out = []
    for i, loop in enumerate(numbers):
        out.append(f"set loop{loop}.decouple on")
        out += [f"set decouple{loop}.d{other} {d[i, k] + 0.0:.7g}" for k, other in enumerate(numbers)]
    return out


def rst_lines(plant: SampledPlant, c: decoupling.Placed, name: str, block: int) -> list[str]:
    parts = {"p": (c.p[1:], P_MOST), "q": (c.q, QR_MOST), "r": (c.r, QR_MOST)}
    for what, (x, most) in parts.items():
        if len(x) > TAPS:
            raise RunFailed(f"{name}: {what.upper()} has {len(x)} coefficients, and the kind rst takes {TAPS}: a longer period, or a static decoupler")
        if np.abs(x).max(initial=0.0) > most:
            raise RunFailed(f"{name}: {what.upper()} has a coefficient of {np.abs(x).max():.4g}, and the kind rst takes {most:g}: a longer settling time")
    return [f"set block{block}.kind rst", f"set block{block}.loops {name}", f"set block{block}.period {plant.period:.9g}",
            *(f"set block{block}.{what}.1 {row(x)}" for what, (x, _) in parts.items())]


def row(x: np.ndarray) -> str:
    return ",".join(f"{value + 0.0:.7g}" for value in [*x, *[0.0] * (TAPS - len(x))])
