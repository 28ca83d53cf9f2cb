"""How good are settings that are kept? The integral of the absolute error beside that of the best decentralised PIs with the same pairs and at most
the same largest sensitivity, on the true plant, after steps of the setpoints and of loads at the inputs."""

from __future__ import annotations

import functools
import json
import math
from typing import Sequence

import numpy as np

from reflux import table
from reflux.paths import ROOT
from research import startup_plants, startup_runs
from research.startup_judge import PI, Judge
from research.startup_linear import Linear

PLANTS = ("wood-berry", "gain-5", "dead-time", "plain", "two-lags")
ASKED = 1.2
NOISE = 0.001
SEEDS = (1, 2)
HORIZON = 12.0  # slowest time constants and dead times
SAMPLES_MOST = 3000
FREQUENCIES = 240
GENERATIONS, DRAWS, CHECKED = 45, 14, 4  # of the search for the best settings; sets of a generation that the judge looks at
WIDTH_LEAST = 0.01
HEADER = ["plant", "seed", "outcome", "Ms", "setpoint", "load", "settings", "best for setpoints", "best for loads"]


@functools.cache
def case(name: str) -> startup_plants.PlantCase:
    if name != "wood-berry":
        return startup_plants.case(name)
    data = json.loads((ROOT / "host_sim" / "plants" / f"{name}.json").read_text(encoding="utf-8"))
    return startup_plants.PlantCase(name, "column", data)


def integrals(plant: Linear, loops: Sequence[PI], kc: np.ndarray, ti: np.ndarray, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Integrals of the absolute errors of all loops, s, after a step of each setpoint, and of a load at each paired input, summed over the steps; for
    each set of settings (rows)."""
    sets, n = kc.shape
    rows, columns = [c.output for c in loops], [c.input for c in loops]
    setpoint = np.concatenate([np.eye(n), np.zeros((n, n))])  # one row an experiment
    load = np.concatenate([np.zeros((n, n)), np.eye(n)])
    x = [np.zeros((sets, 2 * n, len(s.a))) for s in plant.sampled]
    past = np.zeros((plant.dead_samples() + 2, sets, 2 * n, plant.shape[1]))
    integral, total = np.zeros((sets, 2 * n, n)), np.zeros((sets, 2 * n))
    gain, rate = kc[:, None, :], (kc * plant.h / ti)[:, None, :]
    for k in range(samples):
        y = np.zeros((sets, 2 * n, plant.shape[0]))
        for s, state in zip(plant.sampled, x):
            y[..., s.outputs] += state @ s.c.T + past[(k - s.whole - 1) % len(past)][..., s.inputs] @ s.d.T
        error = setpoint - y[..., rows]
        total += np.abs(error).sum(axis=-1)
        u = np.zeros((sets, 2 * n, plant.shape[1]))
        u[..., columns] = gain * error + integral + load
        integral += rate * error
        past[k % len(past)] = u
        for i, s in enumerate(plant.sampled):
            x[i] = (x[i] @ s.a.T + past[(k - s.whole) % len(past)][..., s.inputs] @ s.new.T
                    + past[(k - s.whole - 1) % len(past)][..., s.inputs] @ s.old.T)
    total *= plant.h
    total[~np.isfinite(total)] = np.inf
    return total[:, :n].sum(axis=1), total[:, n:].sum(axis=1)


def samples_of(plant: Linear) -> int:
    return min(SAMPLES_MOST, int(HORIZON * (plant.slowest_s() / plant.h + plant.dead_samples())))


class Bound:
    """Scales sets of settings so that their largest sensitivity is ms, on a grid of frequencies."""

    def __init__(self, judge: Judge, loops: Sequence[PI], ms: float):
        plant = judge.plant
        self.ms, self.h = ms, plant.h
        low = min(judge.slowest_rate * 1e-2, 1e-3)
        self.z = np.exp(1j * np.geomspace(low, np.pi, FREQUENCIES))
        self.g = plant.at(self.z)[:, [c.output for c in loops]][:, :, [c.input for c in loops]]

    def largest(self, kc: np.ndarray, ti: np.ndarray) -> np.ndarray:
        c = kc[:, None, :] * (1.0 + self.h / ti[:, None, :] / (self.z[None, :, None] - 1.0))
        inverse = np.linalg.inv(np.eye(kc.shape[1]) + c[:, :, :, None] * self.g[None])
        return np.abs(np.einsum("swii->swi", inverse)).max(axis=(1, 2))

    def scaled(self, kc: np.ndarray, ti: np.ndarray) -> np.ndarray:
        """Gains up from a tenth, all of a set by one factor, to the first at which the bound is met: the loops are stable until there."""
        low = np.full(len(kc), 0.1)
        rising = np.ones(len(kc), bool)
        for _ in range(30):
            rising &= self.largest(kc * (1.25 * low)[:, None], ti) <= self.ms
            if not rising.any():
                break
            low[rising] *= 1.25
        high = 1.25 * low
        for _ in range(7):
            middle = np.sqrt(low * high)
            below = self.largest(kc * middle[:, None], ti) <= self.ms
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return kc * low[:, None]


def best(judge: Judge, loops: Sequence[PI], ms: float, which: int) -> tuple[float, list[PI]]:
    """The least integral at a largest sensitivity of ms: which 0 for setpoints, 1 for loads. Integral times and the ratios of gains are drawn about the
    best so far, wider after a success, and all gains scaled to the bound. The result is no worse than the given loops."""
    plant, samples = judge.plant, samples_of(judge.plant)
    bound, random = Bound(judge, loops, ms), np.random.default_rng(1)
    kc, ti = np.array([c.kc for c in loops]), np.array([c.ti_s for c in loops])
    least, width = float(integrals(plant, loops, kc[None], ti[None], samples)[which][0]), 0.5
    for _ in range(GENERATIONS):
        draws = random.normal(0.0, width, (DRAWS, 2 * len(loops)))
        tis = ti * np.exp(draws[:, :len(loops)])
        kcs = bound.scaled(kc * np.exp(draws[:, len(loops):]), tis)
        values = integrals(plant, loops, kcs, tis, samples)[which]
        width *= 0.8
        for row in np.argsort(values)[:CHECKED]:
            if not values[row] < least:
                break
            verdict = judge.judge(changed(loops, kcs[row], tis[row]))
            if verdict.stable and verdict.ms <= 1.005 * ms:
                kc, ti, least = kcs[row], tis[row], float(values[row])
                width = min(0.7, 1.6 * width)
                break
        if width < WIDTH_LEAST:
            break
    return least, changed(loops, kc, ti)


def changed(loops: Sequence[PI], kc: np.ndarray, ti: np.ndarray) -> list[PI]:
    return [PI(c.output, c.input, float(k), float(t)) for c, k, t in zip(loops, kc, ti)]


def compare(name: str, seed: int, longest_s: float) -> list[str]:
    """A row of the table: outcome, and by how much the integrals are larger than the best."""
    of = case(name)
    said = startup_runs.start_up(of, NOISE, seed, [], longest_s)
    plant = of.linear()
    loops = startup_runs.loops(said, plant)
    if not loops or said.decoupler is not None:
        return [name, str(seed), said.outcome if not loops else "decoupler", *["-"] * 6]
    judge = Judge(plant)
    verdict = judge.judge(loops)
    if not verdict.stable:
        return [name, str(seed), f"{said.outcome}, unstable", *["-"] * 6]
    found = [float(v[0]) for v in integrals(plant, loops, np.array([[c.kc for c in loops]]), np.array([[c.ti_s for c in loops]]), samples_of(plant))]
    optima = [best(judge, loops, verdict.ms, which) for which in (0, 1)]
    return [name, str(seed), said.outcome, f"{verdict.ms:.2f}", *(f"{value / least:.2f}" for value, (least, _) in zip(found, optima)),
            settings(loops), *(settings(chosen) for _, chosen in optima)]


def settings(loops: Sequence[PI]) -> str:
    return ", ".join(f"{table.figure(c.kc)} {table.figure(c.ti_s)} s" for c in loops)


def worst(rows: list[list[str]]) -> float:
    return max((float(cell) for row in rows for cell in row[4:6] if cell != "-"), default=math.nan)
