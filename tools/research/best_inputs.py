"""Bound for any input within the limits: the MVs that make the integral of the absolute error least, with full knowledge of
the nonlinear plant and its state, searched by linear programs around the last trajectory.

Nothing is known of a change before it comes: a setpoint from its own sample on, a load from the sample after. So each change begins a
stretch of its own, from the state to which the best inputs before have led; beyond the next change it is looked on for ten minutes
as if nothing came, so that no stretch is paid for by the next."""

from __future__ import annotations

import subprocess
from typing import Any

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_matrix, hstack, identity

from reflux import build
from reflux.scenario import Scenario

LOOK_ON = 20  # samples beyond the next change
ROUNDS = 25
MINUTE = 60.0


class Plant:
    """reflux-plant."""

    def __init__(self, name: str, mvs: list[str], pvs: list[str], tick_s: float):
        self.process = subprocess.Popen([str(build.find_program("host", "reflux-plant"))], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        self.mvs, self.pvs, self.tick_s = mvs, pvs, tick_s
        self.ask(f"plant {name}")
        self.ask("keep")

    def ask(self, said: str) -> str:
        assert self.process.stdin and self.process.stdout
        self.process.stdin.write(said + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline().strip()
        if not answer or answer.startswith("err"):
            raise RuntimeError(f"reflux-plant, {said[:40]}: {answer}")
        return answer

    def attempt(self, u: Any) -> Any:
        """Outputs at the end of each interval, from the kept state."""
        values = " ".join(f"{x:.12g}" for x in u.ravel())
        said = f"try {self.tick_s} {len(u)} {' '.join(self.mvs)} : {' '.join(self.pvs)} : {values}"
        return np.array([float(x) for x in self.ask(said).split()]).reshape(len(u), -1)

    def close(self) -> None:
        self.process.stdin.close()  # type: ignore[union-attr]
        self.process.wait()


def least(plant: Plant, u: Any, y0: Any, targets: Any, lo: Any, hi: Any, scale: Any) -> Any:
    """Inputs of a stretch, found from u on. targets: one row, the setpoints."""
    n, m, p = len(u), u.shape[1], len(targets)
    weights = np.ones(n)  # of the errors at the end of each interval: trapezoids
    weights[-1] = 0.5
    def cost(y: Any) -> float:
        return float((weights[:, None] * np.abs(y - targets)).sum())
    y = plant.attempt(u)
    best, reach = cost(y), 0.25
    for _ in range(ROUNDS):
        step = 1e-3 * scale
        slopes = np.zeros((n * p, n * m))
        for k in range(n):
            for j in range(m):
                other = u.copy()
                sign = -1.0 if u[k, j] + step[j] > hi[j] else 1.0
                other[k, j] += sign * step[j]
                slopes[:, k * m + j] = (plant.attempt(other) - y).ravel() / (sign * step[j])
        # min sum of w s, s >= +-(y + slopes d - target)
        a, e = csr_matrix(slopes), (y - targets).ravel()
        both = csr_matrix(np.vstack([np.hstack([slopes, -np.eye(n * p)]), np.hstack([-slopes, -np.eye(n * p)])]))
        near = np.tile(reach * scale, n)
        low, high = np.maximum(-near, (lo - u).ravel()), np.minimum(near, (hi - u).ravel())
        bounds = [*zip(low, high), *[(0, None)] * (n * p)]
        c = np.concatenate([np.zeros(n * m), np.repeat(weights, p)])
        got = linprog(c, A_ub=both, b_ub=np.concatenate([-e, e]), bounds=bounds, method="highs")
        if got.x is None:
            break
        tried = np.clip(u + got.x[:n * m].reshape(n, m), lo, hi)
        there = plant.attempt(tried)
        if cost(there) < best - 1e-6:
            gain = best - cost(there)
            u, y, best = tried, there, cost(there)
            reach = min(reach * 1.5, 0.5)
            if gain < 1e-3 * best:
                break
        else:
            reach *= 0.3
            if reach < 1e-3:
                break
    return u


def bound(scenario: Scenario, windows: dict[str, tuple[float, float]]) -> dict[str, Any]:
    """IAE of each loop in each window, as self_tuning_campaign's judged() has them."""
    tick = scenario.tick_s or 30.0
    mvs, pvs = [loop.mv for loop in scenario.loops], [loop.pv for loop in scenario.loops]
    plant = Plant(scenario.plant, mvs, pvs, tick)
    numbers = {line.text.split()[1]: line.text.split()[2] for line in scenario.config if line.text.startswith("set ")}
    lo, hi, start = (np.array([value_of(numbers, mv, what) for mv in mvs]) for what in ("min", "max", "safe"))
    for line in scenario.lines:
        if line.text.startswith("out "):
            name, value = line.text.split()[1:3]
            plant.ask(f"set {name} {value}")
            start = np.array([float(value) if mv == name else x for mv, x in zip(mvs, start)])
    scale = hi - lo
    changes = changes_of(scenario, tick)
    end = int(round(max(last for _, last in windows.values()) * MINUTE / tick))
    u, y0 = start, plant.attempt(start[None, :])[-1]
    targets = y0.copy()
    time, record = [0.0], [(y0, targets.copy())]
    for place, (at, what) in enumerate(changes):
        if at >= end:
            break
        following = next((t for t, _ in changes[place + 1:] if t > at), end)
        for name, value in what:
            if name in [loop.name for loop in scenario.loops]:
                targets[[loop.name for loop in scenario.loops].index(name)] = value
            else:
                plant.ask(f"set {name} {value:.9g}")
        seen = [name for name, _ in what if name not in [loop.name for loop in scenario.loops]]
        n = following - at
        if n <= 0:
            continue
        stretches = [(1, False), (n - 1, True)] if seen else [(n, True)]
        for length, free in stretches:
            if length <= 0:
                continue
            inputs = np.tile(u, (length + (LOOK_ON if free else 0), 1))
            inputs = least(plant, inputs, record[-1][0], targets, lo, hi, scale) if free else inputs
            ys = plant.attempt(inputs[:length])
            plant.ask("keep")
            u = inputs[length - 1]
            record[-1] = (record[-1][0], targets.copy())
            for row in ys:
                time.append(time[-1] + tick)
                record.append((row, targets.copy()))
    plant.close()
    return {kind: iae_of(time, record, first * MINUTE, last * MINUTE) for kind, (first, last) in windows.items()}


def value_of(numbers: dict[str, str], mv: str, what: str) -> float:
    row = next(key.split(".")[0] for key, value in numbers.items() if key.endswith(".name") and value == mv)
    return float(numbers[f"{row}.{what}"])


def changes_of(scenario: Scenario, tick: float) -> list[tuple[int, list[tuple[str, float]]]]:
    """By sample: setpoints (name of the loop) and disturbances that change there."""
    found: dict[int, list[tuple[str, float]]] = {0: []}
    for line in scenario.lines:
        words = line.text.split()
        if words[0] == "sp":
            found.setdefault(int(round(line.at_s / tick)), []).append((words[1], float(words[2])))
    for event in scenario.events:
        if "." not in event.name:
            found.setdefault(int(round(event.at_s / tick)), []).append((event.name, event.value))
    return sorted(found.items())


def iae_of(time: list[float], record: list[Any], first: float, last: float) -> list[float]:
    inside = [k for k, t in enumerate(time) if first - 1e-6 <= t <= last + 1e-6]
    out = np.zeros(len(record[0][0]))
    for a, b in zip(inside, inside[1:]):
        out += (time[b] - time[a]) * (np.abs(record[a][1] - record[a][0]) + np.abs(record[a][1] - record[b][0])) / 2
    return [float(x) / MINUTE for x in out]
