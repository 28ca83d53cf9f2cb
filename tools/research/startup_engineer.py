"""The engineer's method: what a competent engineer would make of a plant from one reference test, as an oracle in double for start-ups.

Every input in turn does +a, -a and waits for rest, at 60 % of the limit and for the right length. Each element gets the shape that the
Bayesian information criterion chooses. Of the admissible pairings the best is taken, with decentralised PIs found by search so that the largest
sensitivity is 2 on the model, each loop broken at its input with the others closed. The verdict is on the true plant. The test is simulated
here, with noise of its own stream; the engineer knows the right length and the largest step from the plant, which start-up must find out.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from research import startup_plants, startup_shapes
from research.startup_judge import PI, Judge, Verdict
from research.startup_linear import Linear

LIMIT = 0.2  # of span
SHARE = 0.6  # of the limit
AMPLITUDE_MOST = 0.4  # of an input's span
SETTLED = 0.01  # of the largest response
CLIMB_TIMES, CLIMB_LEAST = 4, 40  # length of a level of what integrates: times the response so far, and samples
POINTS = 60  # windows of a level
MS = 2.0
PAIRINGS_MOST = 6
FREQUENCIES = 110
COARSE, FINE = (1.6, 1.25), (1.1, 1.04)  # factors of the search
ROUNDS_MOST = 60
BATCH = 6  # settings that are looked at together
NOISE_MOVES = 0.05  # of an input's span: standard deviation of its moves by the noise alone, at most
INTEGRAL_LEAST = 0.3  # shortest integral time over dead time and lags of the element


@dataclass(frozen=True)
class Design:
    loops: tuple[PI, ...]
    cost: float


@dataclass(frozen=True)
class Outcome:
    """loops: empty where there is no design. shapes: one row an output."""

    loops: tuple[PI, ...]
    verdict: Verdict | None
    shapes: list[list[startup_shapes.Shape]]


# ---- the reference test ----

def half_samples(plant: Linear, steps: np.ndarray, source: int) -> int:
    """Length of a level: until every response is at rest, or climbs at its last rate."""
    longest = 1
    for i in range(plant.shape[0]):
        y = steps[:, i, source]
        slope = y[-1] - y[-2]
        line = y[-1] - slope * (len(y) - 1 - np.arange(len(y)))
        late = np.flatnonzero(np.abs(y - line) > SETTLED * max(np.abs(y - line).max(), 1e-12))
        longest = max(longest, int(late[-1]) + 2 if len(late) else 1)
        if abs(slope) > 0.1 * np.abs(y).max() / len(y):
            longest = max(longest, CLIMB_TIMES * (int(late[-1]) if len(late) else 1), CLIMB_LEAST)
    return longest


def play(u: np.ndarray, width: float) -> np.ndarray:
    """What an actuator with backlash does."""
    out, at = np.empty(len(u)), u[0]
    for k, command in enumerate(u):
        at = min(max(at, command - 0.5 * width), command + 0.5 * width)
        out[k] = at
    return out


def windows(count: int) -> np.ndarray:
    """Limits of windows over count samples: one sample at first, then a share of the time that has passed."""
    limits = [0]
    while limits[-1] < count:
        limits.append(min(count, limits[-1] + max(1, int(limits[-1] * 3.2 / POINTS))))
    return np.array(limits)


def reference_test(case: startup_plants.PlantCase, noise: float, seed: int) -> list[list[startup_shapes.Record]] | None:
    """Records by output and input; None where the plant runs away."""
    plant = case.linear(seed)
    if plant.unstable_poles():
        return None
    h = plant.h
    length = int(np.ceil(8.0 * plant.slowest_s() / h)) + plant.dead_samples() + 20
    steps = plant.steps(length)
    random = np.random.default_rng(startup_plants.stream("reference", case.name, noise, seed))
    slopes = [random.choice((-1.0, 1.0)) * startup_plants.DRIFT / plant.slowest_s() if case.kind == "drift" else 0.0 for _ in plant.outputs]
    out: list[list[startup_shapes.Record]] = [[] for _ in plant.outputs]
    for j in range(plant.shape[1]):
        half = half_samples(plant, steps, j)
        total = 3 * half
        response = plant.steps(total)[:, :, j]
        up_down = response.copy()
        up_down[half:] -= 2.0 * response[:-half]
        up_down[2 * half:] += response[:-2 * half]
        amplitude = min(SHARE * LIMIT / max(np.abs(up_down).max(), 1e-9), AMPLITUDE_MOST)
        true = amplitude * up_down
        if case.kind == "backlash":
            u = np.repeat([amplitude, -amplitude, 0.0], half)
            moves = np.diff(play(np.concatenate([[0.0], u]), 0.01))
            true = sum(moves[k] * np.concatenate([np.zeros((k, plant.shape[0])), response[:total - k]]) for k in np.flatnonzero(moves))
        limits = np.concatenate([level * half + windows(half)[:-1] for level in range(3)] + [[total]])
        # The first point is the mean of as many samples before the step.
        for i in range(plant.shape[0]):
            measured = true[:, i] + slopes[i] * h * np.arange(total) + random.normal(0.0, noise, total)
            count = np.diff(limits)
            y = np.add.reduceat(measured, limits[:-1]) / count
            t = (limits[:-1] + 0.5 * (count - 1)) * h
            rest = random.normal(0.0, noise / np.sqrt(half))
            out[i].append(startup_shapes.Record(np.concatenate([[-0.5 * half * h], t]), np.concatenate([[rest - slopes[i] * 0.5 * half * h], y]),
                                                np.concatenate([[noise / np.sqrt(half)], noise / np.sqrt(count)]), amplitude, half * h))
    return out


# ---- the design ----

class Model:
    """The fitted elements along the frequency, sampled and held."""

    def __init__(self, shapes: list[list[startup_shapes.Shape]], h: float, noise: float):
        times = [e.time_s() for row in shapes for e in row if e.kind != "none"]
        self.h, self.shapes, self.gain_most = h, shapes, NOISE_MOVES / max(noise, 1e-6)
        known = np.array([[abs(e.gain) for e in row] for row in shapes])
        singular = np.linalg.svd(known * np.sign([[e.gain for e in row] for row in shapes]), compute_uv=False)
        # Loops of large relative gains have a mode that is slower by as much.
        slow = min(singular[0] / max(singular[-1], 1e-9), 1e3)
        low = 0.03 / max(max(times, default=h), h) / max(slow, 3.0)
        self.w = np.geomspace(low, np.pi / h, FREQUENCIES)
        s = 1j * self.w
        hold = (1.0 - np.exp(-s * h)) / (s * h)
        self.g = np.stack([np.stack([e.at(s) * hold for e in row], axis=-1) for row in shapes], axis=-2)
        self.rest = np.array([[e.at(np.array([1e-4 * low + 0j]))[0].real for e in row] for row in shapes])
        self.z = np.exp(s * h)

    def usable(self, i: int, j: int) -> bool:
        e = self.shapes[i][j]
        return e.kind != "none" and abs(e.gain) > 2.0 * e.gain_sd

    def largest(self, pairs: list[tuple[int, int]], kc: np.ndarray, ti: np.ndarray) -> np.ndarray:
        """Largest sensitivity over loops and frequencies of each set of settings (rows); infinite where unstable."""
        g = self.g[:, [i for i, _ in pairs]][:, :, [j for _, j in pairs]]
        c = kc[:, None, :] * (1.0 + self.h / ti[:, None, :] / (self.z[None, :, None] - 1.0))
        matrix = np.eye(len(pairs)) + c[:, :, :, None] * g[None]
        det = np.linalg.det(matrix)
        ms = np.abs(np.einsum("cwii->cwi", np.linalg.inv(matrix))).max(axis=(1, 2))
        return np.where(self._stable(pairs, det), ms, np.inf)

    def _stable(self, pairs: list[tuple[int, int]], det: np.ndarray) -> np.ndarray:
        """The phase of det(I + G C) runs from that of its integrators, -90 degrees for each pole at 0, to 0."""
        poles = len(pairs) + self._integrators(pairs)
        turned = np.angle(det[:, 1:] / det[:, :-1]).sum(axis=1)
        # The end at half the sampling frequency is real; the beginning is sign times (1 / j)^poles.
        begin = np.angle(det[:, 0])
        error = begin + turned - np.angle(det[:, -1])
        wanted = poles * np.pi / 2.0
        return (np.abs(turned - wanted) < 1.0) & (np.abs(np.round(error / (2 * np.pi)) * 2 * np.pi - error) < 0.1)

    def _integrators(self, pairs: list[tuple[int, int]]) -> int:
        """Poles at 0 of the determinant besides those of the controllers, by its slope at low frequency."""
        g = self.g[:2, [i for i, _ in pairs]][:, :, [j for _, j in pairs]]
        det = np.abs(np.linalg.det(g))
        return int(round(np.log(det[0] / det[1]) / np.log(self.w[1] / self.w[0])))

    def effective(self, pairs: list[tuple[int, int]]) -> np.ndarray:
        """Gain at rest of every loop with the others closed."""
        square = self.rest[[i for i, _ in pairs]][:, [j for _, j in pairs]]
        inverse = np.linalg.inv(square)
        return 1.0 / np.diag(inverse)


def admissible(model: Model) -> list[list[tuple[int, int]]]:
    """Pairings of positive Niederlinski index, the nearest to relative gains of 1 first."""
    p, m = model.rest.shape
    found = []
    for columns in itertools.permutations(range(m), min(p, m)):
        pairs = list(zip(range(p), columns))
        if not all(model.usable(i, j) for i, j in pairs):
            continue
        square = model.rest[:, list(columns)]
        product = np.prod(np.diag(square))
        det = np.linalg.det(square)
        if product == 0.0 or det / product <= 0.0:
            continue
        relative = np.diag(square * np.linalg.inv(square).T)
        found.append((float(np.abs(np.log(np.maximum(np.abs(relative), 1e-9))).sum() + 5.0 * np.sum(relative <= 0.0)), pairs))
    return [pairs for _, pairs in sorted(found)[:PAIRINGS_MOST]]


def begin(model: Model, pairs: list[tuple[int, int]]) -> Design | None:
    """Loops slow enough for the bound, if there are such."""
    elements = [model.shapes[i][j] for i, j in pairs]
    times = np.array([max(e.time_s(), model.h) for e in elements])
    ti = np.array([t if e.kind != "integrator" else 8.0 * t for e, t in zip(elements, times)])
    size = np.array([abs(e.at(np.array([1j / t]))[0]) for e, t in zip(elements, times)])
    kc = 0.3 * np.sign([e.gain for e in elements]) / np.maximum(size, 1e-9)
    for _ in range(14):
        if model.largest(pairs, kc[None], ti[None])[0] <= MS:
            return _design(model, pairs, kc, ti)
        kc, ti = kc * 0.5, ti * 1.2
    return None


def improve(model: Model, of: Design, factors: tuple[float, ...]) -> Design:
    """PIs of least cost under the bound on the sensitivity, by a search along single loops."""
    pairs = [(loop.output, loop.input) for loop in of.loops]
    kc, ti = np.array([loop.kc for loop in of.loops]), np.array([loop.ti_s for loop in of.loops])
    effective = model.effective(pairs)
    least = INTEGRAL_LEAST * np.array([max(model.shapes[i][j].time_s(), model.h) for i, j in pairs])
    moves = [(k, gain, time) for k in range(len(pairs)) for gain, time in ((1, 0), (0, -1), (1, 1), (1, -1), (-1, -1), (0.5, -0.5))]
    for factor in factors:
        for _ in range(ROUNDS_MOST):
            kcs, tis = np.repeat(kc[None], len(moves), axis=0), np.repeat(ti[None], len(moves), axis=0)
            for row, (k, gain, time) in enumerate(moves):
                kcs[row, k] *= factor**gain
                tis[row, k] *= factor**time
            allowed = (tis >= least).all(axis=1) & (np.abs(kcs) <= model.gain_most).all(axis=1)
            value = np.where(allowed, cost(kcs, tis, effective), np.inf)
            present = cost(kc[None], ti[None], effective)[0] - 1e-6
            better = np.flatnonzero(value < present)
            better = better[np.argsort(value[better])]
            found = next((row for k in range(0, len(better), BATCH) for row in _sound(model, pairs, kcs, tis, better[k:k + BATCH])), None)
            if found is None:
                break
            kc, ti = kcs[found], tis[found]
    return _design(model, pairs, kc, ti)


def _sound(model: Model, pairs: list[tuple[int, int]], kc: np.ndarray, ti: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Those of the rows that keep the bound."""
    return rows[model.largest(pairs, kc[rows], ti[rows]) <= MS]


def _design(model: Model, pairs: list[tuple[int, int]], kc: np.ndarray, ti: np.ndarray) -> Design:
    loops = tuple(PI(i, j, float(k), float(t)) for (i, j), k, t in zip(pairs, kc, ti))
    return Design(loops, float(cost(kc[None], ti[None], model.effective(pairs))[0]))


def cost(kc: np.ndarray, ti: np.ndarray, effective: np.ndarray) -> np.ndarray:
    """Sum of the logarithms of the integrals of the error after a setpoint step; long integral times cost a little more."""
    return np.log(ti / np.abs(kc * effective)).sum(axis=1) + 0.15 * np.log(ti).sum(axis=1)


def engineer(case: startup_plants.PlantCase, noise: float, seed: int, judge: Judge | None = None) -> Outcome:
    """judge: of the true plant, if there is one already."""
    records = reference_test(case, noise, seed)
    if records is None:
        return Outcome((), None, [])
    plant = case.linear(seed, np.inf)
    shortest = 1.5 * plant.h
    shapes = [[startup_shapes.choose(r, shortest) for r in row] for row in records]
    model = Model(shapes, plant.h, noise)
    designs = [improve(model, d, COARSE) for pairs in admissible(model) if (d := begin(model, pairs))]
    if not designs:
        return Outcome((), None, shapes)
    best = improve(model, min(designs, key=lambda d: d.cost), FINE)
    return Outcome(best.loops, (judge or Judge(plant)).judge(best.loops), shapes)


def reaches(outcome: Outcome, most: float) -> bool:
    """Whether the engineer's loops are sound on the true plant."""
    return outcome.verdict is not None and outcome.verdict.stable and outcome.verdict.ms <= most

