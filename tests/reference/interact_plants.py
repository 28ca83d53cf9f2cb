#!/usr/bin/python3
"""Interaction figures of every plant of host_sim/plants, by numpy and scipy, for tests/unit/test_interact_*.c.

Gains are in spans. A higher-order element is reduced to first order with dead time by its moments about t = 0 (mean
residence time mu, variance s2): T = sqrt(s2), at most mu, L = mu - T; T = mu where s2 is negative, as with a slow inverse
response. That model is what the tests feed to the firmware. The RGA and so on below are of its gains, which are those of
the plant itself.

Writes interact_plants.csv: plant (number), what, i, j, value, where what is
   0 size: i outputs, j inputs          1 gain        2 dead time, s       3 time constant, s
   4 relative gain                      5 singular value i                 6 condition number
   7 least condition number over all scalings, square plants (found by scipy; of a 2 x 2 by the formula)
   8 Niederlinski index of the pairing  9 pair: output i, input j, value its relative gain in the square plant
  10 rank                              11 frequency i, rad/s
  20 + k modulus, 30 + k real part of the dynamic relative gain at frequency k
  12 share of 20000 draws of gains with 3 % standard deviation that give the pairing, i.e. its probability
  40 RNGA, 41 RARTA of the paired square plant, rows and columns in the order of the pairs

usage: tests/reference/interact_plants.py
"""
import csv

import numpy as np
import scipy.optimize

from interact_reference import table
from linear_reference import HERE, Plant, linear_files

OMEGA = (0.1, 1.0, 10.0)  # over the slowest time constant


def moments(q):
    """gain, mean and variance of every impulse response, s."""
    p, m = len(q.outputs), len(q.j["inputs"])
    g, mean, var = np.zeros((p, m)), np.zeros((p, m)), np.zeros((p, m))
    if q.j["model"] == "transfer":
        for i in range(p):
            for j in range(m):
                e = q.elements[i][j]
                if not e:
                    continue
                lags = [-1.0 / s for s in e.poles]
                g[i, j] = e.gain
                mean[i, j] = e.dead + np.sum(lags).real - e.zero
                var[i, j] = np.sum(np.square(lags)).real - e.zero**2
        return g, mean, var
    if q.j["model"] == "state_space":  # G(s) = D - C A^-1 B - s C A^-2 B - s^2 C A^-3 B ...
        inv = np.linalg.inv(q.A)
        B, D = q.B[:, :m], q.D[:, :m]
        g = D - q.C @ inv @ B
        first, second = q.C @ inv @ inv @ B, -2.0 * q.C @ inv @ inv @ inv @ B
    else:  # sums over the impulse response of the difference equation
        period, n = q.j["period"] * q.unit, 4000
        if q.j["model"] == "polynomial":
            a, b = np.array(q.j["A"]), np.array(q.j["B"])[:, :, :m]
            h = np.zeros((n, p, m))
            for k in range(n):
                h[k] = (b[k] if k < len(b) else 0) - sum(a[i] @ h[k - 1 - i] for i in range(len(a)) if i < k)
        else:
            h, x = np.zeros((n, p, m)), q.B[:, :m].copy()
            h[0] = q.D[:, :m]
            for k in range(1, n):
                h[k], x = q.C @ x, q.A @ x
        t = period * (np.arange(n) + 0.5)[:, None, None]
        g, first, second = h.sum(0), (t * h).sum(0), (t * t * h).sum(0)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(np.abs(g) > 1e-9 * np.abs(g).max(), first / g, 0.0)
        var = np.where(np.abs(g) > 1e-9 * np.abs(g).max(), second / g - mean**2, 0.0)
    g = np.where(np.abs(g) > 1e-9 * np.abs(g).max(), g, 0.0)
    return g, mean, var


def fopdt(q):
    """gains in spans, dead times, time constants."""
    g, mean, var = moments(q)
    span = lambda c: c["hi"] - c["lo"]
    g = g * np.array([[span(u) / span(y) for u in q.inputs[:g.shape[1]]] for y in q.outputs])
    mean = np.maximum(mean, 0.0)
    T = np.where(var > 0.0, np.minimum(np.sqrt(np.maximum(var, 0.0)), mean), mean)
    return g, mean - T, T


def response(g, L, T, w):
    return g * np.exp(-1j * w * L) / (1 + 1j * w * T)


def rga(g):
    return g * np.linalg.pinv(g).T


def least_condition(g):
    """Over all diagonal scalings of inputs and outputs."""
    if g.shape == (2, 2):
        one = np.abs(rga(g)).sum(axis=0).max()
        return one + np.sqrt(max(one**2 - 1.0, 0.0))
    p, m = g.shape
    scale = lambda x: np.exp(np.clip(x, -30.0, 30.0))
    cond = lambda x: np.log(np.linalg.cond(scale(x[:p])[:, None] * g * scale(x[p:])[None, :]))
    start = np.concatenate([-np.log(np.abs(g).max(1)), np.zeros(m)])
    best = np.inf
    for _ in range(6):
        found = scipy.optimize.minimize(cond, start, method="Powell", options={"maxiter": 4000, "xtol": 1e-8, "ftol": 1e-12})
        start, best = found.x, min(best, found.fun)
    return np.exp(best)


def figures():
    """name, dictionary of what is known, for every plant with two inputs or more that does not integrate."""
    with open(HERE / "linear_pairing.csv") as f:
        committed = list(csv.DictReader(line for line in f if not line.startswith("#")))
    for q in (Plant(p) for p in linear_files()):
        if q.integrates() or len(q.j["inputs"]) < 2:
            continue
        g, L, T = fopdt(q)
        names = [y["name"] for y in q.outputs], [u["name"] for u in q.inputs]
        pairs = [(names[0].index(r["output"]), names[1].index(r["input"]))
                 for r in committed if r["plant"] == q.name and r["output"] != "none"]
        yield q, g, L, T, pairs


def best_pairs(g):
    """The rule of linear_reference.Plant.pairing(), which no draw has a plant for; a Niederlinski index below 0 counts
    as no pairs, for the next best is hardly ever the committed pairing."""
    m = g.shape[1]
    kept = np.sort(np.argsort(-np.round(rga(g).sum(axis=1), 9), kind="stable")[:m])
    square = g[kept]
    lam = rga(square)
    cost = np.where(lam > 0.02, np.abs(np.log(np.maximum(lam, 1e-9))), 1e3)
    i, j = scipy.optimize.linear_sum_assignment(cost)
    if cost[i, j].max() > 100.0 or np.linalg.det(square[:, j]) / np.prod(np.diag(square[:, j])) <= 0.0:
        return None
    return [(int(kept[a]), int(b)) for a, b in zip(i, j)]


def probability(g, pairs, sd=0.03, draws=20000):
    rng = np.random.default_rng(1)
    return np.mean([best_pairs(g * (1.0 + sd * rng.normal(size=g.shape))) == pairs for _ in range(draws)])


def rows():
    for number, (q, g, L, T, pairs) in enumerate(figures(), 1):
        p, m = g.shape
        yield f"# {number}: {q.name}"
        line = lambda what, i, j, value: f"{number},{what},{i},{j},{value:.17g}"
        grid = lambda what, a: [line(what, i, j, a[i, j]) for i in range(a.shape[0]) for j in range(a.shape[1])]
        yield line(0, p, m, 0)
        yield from grid(1, g)
        yield from grid(2, L)
        yield from grid(3, T)
        s = np.linalg.svd(g, compute_uv=False)
        rank = np.linalg.matrix_rank(g, tol=1e-9 * s[0])
        yield from (line(5, i, 0, x if i < rank else 0.0) for i, x in enumerate(s))
        yield line(10, 0, 0, rank)
        if rank < min(p, m):
            continue
        yield from grid(4, rga(g))
        yield line(6, 0, 0, s[0] / s[-1])
        if p == m:
            yield line(7, 0, 0, least_condition(g))
        w = np.array(OMEGA) / T.max()
        for k, omega in enumerate(w):
            yield line(11, k, 0, omega)
            dynamic = rga(response(g, L, T, omega))
            yield from grid(20 + k, np.abs(dynamic))
            yield from grid(30 + k, dynamic.real)
        out, inp = [a for a, _ in pairs], [b for _, b in pairs]
        square = g[np.ix_(out, inp)]
        lam = rga(square)
        yield from (line(9, a, b, lam[k, k]) for k, (a, b) in enumerate(pairs))
        yield line(8, 0, 0, np.linalg.det(square) / np.prod(np.diag(square)))
        yield line(12, 0, 0, probability(g, pairs))
        residence = np.maximum((L + T)[np.ix_(out, inp)], 1.0)
        phi = rga(square / residence)
        yield from grid(40, phi)
        yield from grid(41, phi / lam)


if __name__ == "__main__":
    table("interact_plants.csv", "plant,what,i,j,value", rows(), "Interaction figures of the plants, by numpy",
          maker="interact_plants")
