"""The nonlinear form of decoupling by state feedback on a second column: methanol and water, 32 stages, the temperatures of stages 12 and 4
by reflux and reboiler duty, every 20 s. Beside it the best PIs that a search finds on the same run."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from reflux import simulator
from research import state_study
from research.state_study import MINUTE, Case, Measured

PLANT, PERIOD_S, SUBSTEPS, SENSOR_S = "methanol-water", 20.0, 4, 10.0
SEEN = (2, 3, 4, 5, 6, 8, 10, 12)  # stages with a thermometer
UPPER, LOWER = SEEN.index(12), SEEN.index(4)
LO, HI = np.array([3.0, 3.0]), np.array([25.0, 13.0])  # t/h, MW
KELVIN = 273.15
# Off the temperatures at rest, K: stage 12, stage 4.
SETPOINTS = ((60, 0.0, 0.0), (1800, 1.0, 0.0), (5400, 1.0, -3.0), (9000, -1.0, -3.0), (12600, -1.0, 3.0), (16200, 0.0, 0.0))
LOADS = ((19800, "F", 1479.5), (23400, "F", 1345.0), (27000, "zF", 26.0), (30600, "zF", 23.5), (34200, "heater", 0.95), (37800, "heater", 1.0))
END_S = 41400.0
WINDOWS = {"setpoints": (1800.0, 19800.0), "feed flow": (19800.0, 27000.0), "feed composition": (27000.0, 34200.0), "weak heater": (34200.0, END_S)}
# t/h per K, MW per K, min, min: where the search begins, and the steps of its factors.
FIRST_PI, FACTORS = np.array([-0.8, 0.2, 10.0, 10.0]), (2.0, 1.4, 1.2)


@cache
def nominal() -> np.ndarray:
    data = simulator.linearised(PLANT)
    return np.array([data["u"][data["inputs"].index(name)] for name in ("R", "Q")])


def _form(case: Case) -> tuple[Any, Any]:
    ref = state_study._reference()
    lines = simulator.table_lines(PLANT, 1)
    known = ref.Table(lines).nominal
    scale = tuple(known[name] / u for name, u in zip(("reflux", "heat"), nominal()))
    rows = np.array([SEEN[UPPER] - 1, SEEN[LOWER] - 1])
    model = ref.Model(lines, PERIOD_S, ("reflux", "heat"), scale, known["feed"] / 1345.0, rows)
    p = float(np.exp(-case.pole * PERIOD_S / MINUTE))
    return ref.Ahead(model, [p, p], case.keep, LO, HI), ref.Estimator(model, SEEN, max(case.noise, 0.01))


def run(case: Case, pi: np.ndarray | None) -> Measured:
    """pi: both gains, both integral times; None: the nonlinear form with estimated states."""
    bench = state_study.Column(PLANT, ["R", "Q"], [f"T{s}" for s in SEEN], len(SEEN), nominal(), PERIOD_S, SUBSTEPS, SENSOR_S)
    random = np.random.default_rng(case.seed)
    ahead, estimator = (None, None) if pi is not None else _form(case)
    rest = bench.readings[[UPPER, LOWER]].copy()
    w, before, u, beyond, log = rest, np.zeros(2), bench.u.copy(), 0, []
    setpoints, loads = list(SETPOINTS), list(LOADS)
    for k in range(round(END_S / PERIOD_S) + 1):
        t = k * PERIOD_S
        while loads and loads[0][0] <= t:
            bench.change(*loads.pop(0)[1:])
        while setpoints and setpoints[0][0] <= t:
            w = rest + np.array(setpoints.pop(0)[1:])
        readings = bench.readings + case.noise * random.standard_normal(len(SEEN))
        if case.resolution:
            readings = np.round(readings / case.resolution) * case.resolution
        y = readings[[UPPER, LOWER]]
        log.append((t, *bench.readings[[UPPER, LOWER]], *w, *u))
        if pi is not None:
            e = w - y
            asked = u + pi[:2] * ((e - before if k else 0.0) + PERIOD_S / MINUTE / pi[2:] * e)
            before = e
        else:
            x, feed, z = estimator.step(u, readings - KELVIN)
            asked = ahead.step(x, feed, z, y - KELVIN, w - KELVIN, u)
        u = np.clip(asked, LO, HI)
        beyond += bool(np.any((u <= LO) | (u >= HI)))
        bench.move(u)
    bench.plant.close()
    return state_study.measured(np.array(log), beyond / len(log), WINDOWS)


def play(case: Case) -> Measured:
    if case.law == "ahead":
        return run(case, None)
    # One factor after the other, as long as the whole becomes less.
    def cost(pi: np.ndarray) -> float:
        return sum(run(case, pi).iae.values())
    pi, least = FIRST_PI.copy(), cost(FIRST_PI)
    for factor in FACTORS:
        better = True
        while better:
            better = False
            for place in range(4):
                for by in (factor, 1.0 / factor):
                    tried = pi.copy()
                    tried[place] *= by
                    found = cost(tried)
                    if found < 0.995 * least:
                        pi, least, better = tried, found, True
    return run(case, pi)
