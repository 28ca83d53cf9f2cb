"""Independent reference of columns whose holdups move, with feed by quality, molar boil-up and activity coefficients.

    python3 tests/reference/column_holdups_reference.py

writes column_holdups.csv next to this file: rates, temperatures and flows of the column of tests/support/holdup_columns.h at random
states and inputs. The equations are written here from tests/reference/column-equations.md, with numpy and a bisection for every bubble point;
nothing of the C sources is called.
"""
import os

import numpy as np
from scipy.optimize import brentq

HERE = os.path.dirname(os.path.abspath(__file__))
N, C, FEED = 12, 3, 5  # stages, components, feed stage from 1
SOFT, EFFICIENCY, DROP, CAPACITY = 0.02, 0.8, 4000.0, 2.0
NOMINAL = np.array([300.0] + [12.0] * (N - 2) + [200.0])
GAIN = {"condenser": 0.03, "reboiler": 0.02}
TIME, VAPOUR = 4.0, 0.3
A = np.array([22.0702943611, 21.3771471806, 20.684])
INTERACTION_A = np.array([[0.0, 0.4, -0.3], [-0.7, 0.0, 0.25], [0.15, -0.5, 0.0]])
INTERACTION_B = np.array([[0.0, -250.0, 120.0], [80.0, 0.0, -180.0], [-90.0, 140.0, 0.0]])
ALPHA = np.array([[0.0, 0.3, 0.25], [0.3, 0.0, 0.4], [0.25, 0.4, 0.0]])
COLUMNS = ("condenser_by,reboiler_by,levels,trays,model,q,boilup,subcooling,reflux,distillate,bottoms,feed,z0,z1,"
           "R0,D0,B0,LE0,LS0,VS0,VE0")


def pressures(t):
    return np.exp(A - 3200.0 / (t - 48.0))


def wilson(x, t):
    big = np.exp(INTERACTION_A + INTERACTION_B / t)
    sums = big @ x
    return np.exp([1 - np.log(sums[i]) - sum(x[k] * big[k, i] / sums[k] for k in range(C)) for i in range(C)])


def nrtl(x, t):
    tau = INTERACTION_A + INTERACTION_B / t
    g = np.exp(-ALPHA * tau)
    s = [sum(x[k] * g[k, j] for k in range(C)) for j in range(C)]
    c = [sum(x[k] * tau[k, j] * g[k, j] for k in range(C)) for j in range(C)]
    return np.exp([c[i] / s[i] + sum(x[j] * g[i, j] / s[j] * (tau[i, j] - c[j] / s[j]) for j in range(C))
                   for i in range(C)])


GAMMA = {0: lambda x, t: np.ones(C), 1: wilson, 2: nrtl}


def soft(a, b):
    w = SOFT * b
    if a <= b - w:
        return a
    return b if a >= b + w else a - (a - b + w) ** 2 / (4 * w)


def positive(a, w):
    if a >= w:
        return a
    return 0.0 if a <= -w else (a + w) ** 2 / (4 * w)


def internal(u):
    """Reflux inside for each mole outside: heat capacity 150 J/(mol K), heat of vaporisation 30 kJ/mol at all temperatures."""
    return 1 + 150.0 * u["subcooling"] / 30000.0


def perfect_levels(u):
    """R, D, V_S, dV_F with perfect levels."""
    g = internal(u)
    by_feed = (u["q"] - 1) * u["feed"]
    if by_feed > 0:
        by_feed = soft(by_feed, u["boilup"])
    a = max(u["boilup"] - by_feed, 0.0)
    w = positive(a - g * u["reflux"], SOFT * a) if a > 0 else 0.0
    reflux, distillate = (a - w) / g, soft(w, u["feed"])
    boilup = distillate + g * reflux + by_feed
    if boilup < 0:
        distillate, boilup = distillate - boilup, 0.0
    return reflux, distillate, boilup, by_feed


def wanted(by, level, flow0, m, nominal, given):
    return max(flow0 + GAIN[level] * (m - nominal), 0.0) if by else given


def evaluate(u, ref, x, r):
    """Rates of mole fractions (stage by stage) and of relative holdups, and what flows."""
    m = r * NOMINAL
    a = np.minimum(1, r / SOFT)
    if u["levels"]:
        reflux = a[-1] * wanted(u["condenser_by"] == 2, "condenser", ref["R0"], m[-1], NOMINAL[-1], u["reflux"])
        distillate = (a[-1] * wanted(u["condenser_by"] == 1, "condenser", ref["D0"], m[-1], NOMINAL[-1], u["distillate"])
                      + 0.1 * max(m[-1] - CAPACITY * NOMINAL[-1], 0))
        boilup = a[0] * wanted(u["reboiler_by"] == 2, "reboiler", ref["VS0"], m[0], NOMINAL[0], u["boilup"])
        bottoms = (a[0] * wanted(u["reboiler_by"] == 1, "reboiler", ref["B0"], m[0], NOMINAL[0], u["bottoms"])
                   + 0.1 * max(m[0] - CAPACITY * NOMINAL[0], 0))
        by_feed = (u["q"] - 1) * u["feed"]
        if by_feed > 0:
            by_feed = soft(by_feed, boilup)
    else:
        reflux, distillate, boilup, by_feed = perfect_levels(u)
    by_reflux = (internal(u) - 1) * reflux
    if u["levels"]:
        by_reflux = soft(by_reflux, boilup - by_feed)
    up = np.array([boilup] * (FEED - 1) + [boilup - by_feed] * (N - FEED) + [0.0])
    up[N - 2] -= by_reflux
    down = np.zeros(N)
    down[N - 1] = reflux
    for s in reversed(range(1, N - 1)):
        down[s] = (down[s + 1] + (u["feed"] + by_feed if s == FEED - 1 else 0.0)
                   + (by_reflux if s == N - 2 else 0.0))
        if u["trays"]:
            low = s + 1 <= FEED
            flow = (ref["LS0" if low else "LE0"] + (m[s] - NOMINAL[s]) / TIME
                    + VAPOUR * (up[s - 1] - ref["VS0" if low else "VE0"]))
            down[s] = a[s] * max(flow, 0.0)
    if not u["levels"]:
        bottoms = down[1] - boilup

    pressure = 1e5 + DROP * (1 - np.arange(N) / (N - 1))
    gamma = GAMMA[u["model"]]
    t = np.array([brentq(lambda k: np.log(x[s] * gamma(x[s], k) @ pressures(k) / pressure[s]), 281, 439,
                         xtol=1e-12, rtol=1e-15) for s in range(N)])
    y = np.array([x[s] * gamma(x[s], t[s]) * pressures(t[s]) / pressure[s] for s in range(N)])
    v = y.copy()
    for s in range(1, N - 1):
        e = EFFICIENCY
        if s == FEED - 1 and up[s] > 0:
            e = max(e, 1 - up[s - 1] / up[s])
        v[s] = v[s - 1] + e * (y[s] - v[s - 1])

    z = np.array([u["z0"], u["z1"], 1 - u["z0"] - u["z1"]])
    dx, dr = np.zeros((N, C)), np.zeros(N)
    for s in range(N):
        streams = []  # (flow, composition) coming in
        if s < N - 1:
            streams.append((down[s + 1], x[s + 1]))
        if s > 0:
            streams.append((up[s - 1], v[s - 1]))
        if s == FEED - 1:
            streams.append((u["feed"], z))
        dx[s] = (sum(f * (c - x[s]) for f, c in streams) - up[s] * (v[s] - x[s])) / max(m[s], 1e-4 * NOMINAL[s])
        out = up[s] + (bottoms if s == 0 else down[s]) + (distillate if s == N - 1 else 0.0)
        dr[s] = (sum(f for f, _ in streams) - out) / NOMINAL[s]
    return dx, dr, t, (distillate, bottoms, reflux, boilup)


def main():
    rng = np.random.default_rng(12)
    structures = [(1, 1), (2, 1), (1, 2), (2, 2), (0, 0)]
    with open(os.path.join(HERE, "column_holdups.csv"), "w", encoding="utf-8") as out:
        out.write("# made by tests/reference/column_holdups_reference.py; r of what does not move is 1\n# " + COLUMNS
                  + ",x[24],r[12],dx[24],dr[12],T[12],D,B,R,V\n")
        for case in range(40):
            condenser, reboiler = structures[case % 5]
            nominal = {"feed": 1.0, "q": [0.9, 0.0, 1.0, 1.3, 2.0][case * 3 // 7 % 5], "reflux": 1.6, "boilup": 2.0,
                       "subcooling": [0.0, 8.0, 20.0][case // 3 % 3]}
            u = {"condenser_by": condenser, "reboiler_by": reboiler, "levels": int(case % 6 != 5), "subcooling": nominal["subcooling"],
                 "trays": int(case % 4 != 3), "model": case % 3,
                 "q": nominal["q"], "boilup": round(nominal["boilup"] * rng.uniform(0.7, 1.4), 4),
                 "reflux": round(nominal["reflux"] * rng.uniform(0.7, 1.3), 4),
                 "distillate": round(rng.uniform(0, 1), 4), "bottoms": round(rng.uniform(0, 1), 4),
                 "feed": 0.0 if case == 7 else round(rng.uniform(0.5, 1.5), 4),
                 "z0": round(rng.uniform(0.1, 0.5), 4), "z1": round(rng.uniform(0.1, 0.5), 4)}
            if case in (11, 12, 14, 17):  # feeds of dry vapour, little or none from below
                u["q"] = 0.0
                u["boilup"], u["reflux"] = {11: (0.0, 1.5), 12: (0.1, 1.6), 14: (0.12, 1.1), 17: (0.002, 0.001)}[case]
            if case == 24:  # a cold feed, and a reboiler that gives less than it is asked for
                u["q"], u["feed"], u["boilup"] = 2.0, 1.19, 2.0
            reflux, distillate, boilup, by_feed = perfect_levels(nominal)
            ref = {"R0": reflux, "D0": distillate, "B0": nominal["feed"] - distillate, "LE0": internal(u) * reflux,
                   "LS0": internal(u) * reflux + nominal["feed"] + by_feed, "VS0": boilup, "VE0": boilup - by_feed}
            x = np.round(rng.dirichlet(np.ones(C), N), 6)
            x[:, -1] = 1 - x[:, 0] - x[:, 1]
            r = np.round(rng.uniform(0.8, 1.25, N), 5)
            if case % 7 == 3:
                r[[0, 4, N - 1]] = [0.012, 0.008, 0.015]  # nearly empty
            if case % 7 == 5:
                r[[0, N - 1]] = [2.3, 2.1]  # above the capacity
            if not u["levels"]:
                r[[0, N - 1]] = 1
            if not u["trays"]:
                r[1:N - 1] = 1
            dx, dr, t, flows = evaluate(u, ref, x, r)
            row = ([u[k] if k in u else ref[k] for k in COLUMNS.split(",")] + list(x[:, :2].ravel()) + list(r)
                   + list(dx[:, :2].ravel()) + list(dr) + list(t) + list(flows))
            out.write(",".join("%.12g" % value for value in row) + "\n")


if __name__ == "__main__":
    main()
