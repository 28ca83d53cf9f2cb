#!/usr/bin/python3
"""Responses of elements of two lags with a zero, for the tests of firmware/identify/shape_response, worked out apart from it.

The element gain 1, (zero s + 1) exp(-dead s)/(square s^2 + lag s + 1), is simulated as a state space in double: the delayed input
changes between samples, so a sample interval is split there, and each part is one matrix exponential (Taylor series of a
matrix halved until it is small, squared again). Points are means of blocks of samples. Writes

  shape_response.csv      lag, square, zero, dead, block, points, three edges (sample, change), then six points: index, value of
                          the response, value of its derivative by the dead time (a difference over a thousandth of a sample)

usage: tests/reference/shape_reference.py [--check]       --check compares with the file instead of writing it
"""
import math
import sys
from pathlib import Path

import numpy as np

from shaped_loops import exponential

FILE = Path(__file__).resolve().parent / "shape_response.csv"
DEAD_STEP = 1e-3


def simulate(lag, square, zero, dead, edges, samples):
    """Values at every sample; sample k is read before an edge at k acts."""
    # companion form in units of the lag, for numbers near 1
    unit = math.sqrt(square) if square > 0.0 else lag
    if square > 0.0:
        a = np.array([[0.0, 1.0], [-unit ** 2 / square, -unit * lag / square]])
        b = np.array([0.0, unit ** 2 / square])
        c = np.array([1.0, zero / unit])
    else:
        a, b = np.array([[-1.0]]), np.array([1.0])
        c = np.array([1.0 - zero / lag])
    n = len(b)
    whole = np.zeros((n + 1, n + 1))
    whole[:n, :n], whole[:n, n] = a, b
    step = exponential(whole / unit)
    moves = [(at + dead, change) for at, change in edges]
    x, u, t = np.zeros(n + 1), 0.0, 0.0
    y = np.zeros(samples)
    for k in range(samples):
        while moves and moves[0][0] < k:
            at, change = moves.pop(0)
            x[n] = u
            x = exponential(whole * (at - t) / unit) @ x
            t, u = at, u + change
        x[n] = u
        x = (step if k - t == 1.0 else exponential(whole * (k - t) / unit)) @ x
        t = float(k)
        y[k] = c @ x[:n] + (zero / lag * u if square == 0.0 else 0.0)
    return y


def cases():
    random = np.random.default_rng(20261129)
    for i in range(64):
        block = int(random.choice((1, 2, 8, 32)))
        points = int(random.integers(66, 129))
        level = points * block // 3 - 2
        slow = level * math.exp(random.uniform(math.log(0.02), math.log(1.5)))
        dead = level * random.choice((0.0, random.uniform(0.0, 0.5)))
        zero = slow * random.choice((0.0, random.uniform(-2.0, 2.0)))
        kind = i % 6
        if kind == 0:
            lag, square, zero = slow, 0.0, 0.0
        elif kind == 1:  # two lags
            ratio = random.uniform(0.02, 0.9)
            lag, square = slow * (1.0 + ratio), slow * slow * ratio
        elif kind == 2:  # nearly equal, as near as they may be
            ratio = 0.98 / 1.02
            lag, square = slow * (1.0 + ratio), slow * slow * ratio
        elif kind == 3:  # damped
            zeta = random.uniform(0.1, 0.9)
            lag, square = 2.0 * zeta * slow, slow * slow
        elif kind == 4:  # hardly damped any more
            zeta = 1.0 / math.sqrt(1.0 + 0.02 ** 2)
            lag, square = 2.0 * zeta * slow, slow * slow
        else:  # an integrator with a lag
            long = 300.0 * level
            lag, square, zero = long + slow, long * slow, 0.0
        edges = ((random.integers(0, 4), 0.05), (level, -0.1 if i % 2 else -0.05), (2 * level, 0.05 if i % 2 else -0.05))
        yield lag, square, zero, dead, block, points, edges


def rows():
    lines = ["# made by tests/reference/shape_reference.py",
             "lag,square,zero,dead,block,points,at1,change1,at2,change2,at3,change3" + "".join(f",i{n},y{n},d{n}" for n in range(6))]
    random = np.random.default_rng(7)
    for lag, square, zero, dead, block, points, edges in cases():
        means = [simulate(lag, square, zero, d, edges, block * points).reshape(points, block).mean(1)
                 for d in (dead, max(dead - DEAD_STEP, 0.0), dead + DEAD_STEP)]
        slope = (means[2] - means[1]) / (dead + DEAD_STEP - max(dead - DEAD_STEP, 0.0))
        row = [lag, square, zero, dead, block, points] + [float(v) for e in edges for v in e]
        for i in sorted(random.choice(points, 6, replace=False)):
            row += [int(i), means[0][i], slope[i]]
        lines.append(",".join(format(v, ".12g") for v in row))
    return "\n".join(lines) + "\n"


def main():
    text = rows()
    if "--check" not in sys.argv[1:]:
        FILE.write_text(text)
        return 0
    old = [[float(x) for x in line.split(",")] for line in FILE.read_text().splitlines() if line[0].isdigit()]
    new = [[float(x) for x in line.split(",")] for line in text.splitlines() if line[0].isdigit()]
    worst = max(abs(a - b) / max(abs(a), 1e-3) for r, s in zip(old, new, strict=True) for a, b in zip(r, s, strict=True))
    print(f"{len(new)} cases, largest relative difference {worst:.2g}")
    return 0 if worst < 1e-6 else 1


if __name__ == "__main__":
    sys.exit(main())
