"""Independent reference of the C3-C4 splitter.

    python3 tests/reference/splitter_reference.py

writes splitter_steady.csv, splitter_steps.csv and splitter_day.csv next to this file. The balances are those of
pilot_reference.Column, written with numpy from the streams and integrated by scipy's BDF at tight tolerances:
nothing of the C sources is called. The property constants alone are shared, frozen handbook data.
"""
import os

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from pilot_reference import HERE, Column, Mixture, read_properties

PLANT = os.path.join(HERE, "..", "..", "host_sim", "plants", "splitter.json")
STAGES = 37
FEED = np.array([0.0036, 0.281, 0.236, 0.004, 0.0008, 0.4746])  # C2 C3 iC4 iC5 nC5 nC4
NOMINAL = {"R": 61.62, "Q": 4143.046, "F": 88.2, "TF": 320.0, "z": FEED}
SS2 = dict(NOMINAL, R=32.2787, Q=2804.458)
# Steps from SS1: the mean of the source's first scenario, and a little more duty.
STEPS = (dict(NOMINAL, F=95.0, TF=317.0, z=np.array([0.002, 0.27, 0.2232, 0.004, 0.0008, 0.5])),
         dict(NOMINAL, Q=4200.0))
HOURS = (0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 24.0)


# A day: one thing after the other, each for three hours.
DAY = ({"Q": 4180.0}, {"R": 62.4}, {"F": 92.0}, {"TF": 325.0}, {"z": np.array([0.002, 0.27, 0.2232, 0.004, 0.0008, 0.5])},
       {"Q": 4250.0, "R": 61.0}, {"F": 84.0, "z": FEED}, NOMINAL)
STRETCH = 3.0


class Dippr(Mixture):
    """Vapour pressures by DIPPR equation 101, bubble points of a whole column at once."""

    def __init__(self, p):
        super().__init__(p, range(6))
        table = p["antoine"]
        assert not table[:, 2:4].any()
        self.c1, self.c2, self.c3, self.c4, self.c5 = table[:, [0, 1, 4, 5, 6]].T

    def pressures(self, t):
        t = np.asarray(t)[..., None]
        return np.exp(self.c1 - self.c2 / t + self.c3 * np.log(t) + self.c4 * t**self.c5)

    def bubbles(self, x, pressure):
        """Secants on ln(sum x P) - ln(pressure), all stages side by side."""
        def gap(t):
            return np.log((x * self.pressures(t)).sum(axis=1) / pressure)

        t0, t1 = np.full(len(x), 340.0), np.full(len(x), 345.0)
        g0, g1 = gap(t0), gap(t1)
        for _ in range(60):
            same = g1 == g0
            step = np.where(same, 0.0, -g1 * (t1 - t0) / np.where(same, 1.0, g1 - g0))
            t0, g0, t1 = t1, g1, np.clip(t1 + step, 200.0, 450.0)
            if np.max(np.abs(step)) < 1e-11:
                return t1
            g1 = gap(t1)
        assert np.max(np.abs(step)) < 1e-8
        return t1


class Splitter(Column):
    def __init__(self, mixture):
        super().__init__(mixture, STAGES, 18, 0.8, 0.252e5, [4.0] + [0.2] * 35 + [4.0], "conservative")
        self.hold_t = np.linspace(375.0, 322.0, STAGES)

    def equilibrium(self, x, top_pressure):
        pressure = top_pressure + self.drop * (1 - np.arange(self.n) / (self.n - 1))
        t = self.m.bubbles(x, pressure)
        y = x * self.m.pressures(t) / pressure[:, None]
        v = y.copy()
        for i in range(1, self.n - 1):
            v[i] = (1 - self.efficiency) * v[i - 1] + self.efficiency * y[i]
        return t, v


COLUMN = Splitter(Dippr(read_properties(PLANT)))


def drive(values):
    return {"feed": values["F"] / 3600, "z": values["z"], "t_feed": values["TF"], "reflux": values["R"] / 3600,
            "subcooling": 5.0, "heat": values["Q"] * 4.184e6 / 3600, "pressure": 17e5}


def integrate(x, values, hours, tolerance=1e-9):
    u = drive(values)
    end = solve_ivp(lambda t, y: 3600 * COLUMN.evaluate(y, u)[0], (0, hours[-1]), x, method="BDF", t_eval=hours,
                    rtol=tolerance, atol=0.01 * tolerance)
    assert end.success, end.message
    return end.y.T


def steady(values, x):
    x = integrate(x, values, [300.0], 1e-6)[-1]
    u = drive(values)
    x, _, ok, message = fsolve(lambda y: 3600 * COLUMN.evaluate(y, u)[0], x, xtol=1e-13, full_output=True)
    assert np.max(np.abs(COLUMN.evaluate(x, u)[0])) * 3600 < 1e-8, (ok, message)
    return x


def outputs(x, values):
    """Temperatures from the reboiler up, iC4 in distillate, C3 in bottoms, D and B in kmol/h."""
    _, t, d, b = COLUMN.evaluate(x, drive(values))
    full = COLUMN.states(x)
    return [*t, full[-1, 2], full[0, 1], 3.6 * d, 3.6 * b]


def day(x):
    """One row for each reading: hours, the inputs that led there, outputs."""
    rows, values, times = [], dict(NOMINAL), [0.1, 0.5, STRETCH]
    for n, change in enumerate(DAY):
        values.update(change)
        run = integrate(x, values, times)
        x = run[-1]
        given = [values["R"], values["Q"], values["F"], values["TF"], *values["z"]]
        rows += [[n * STRETCH + t, *given, *outputs(y, values)] for t, y in zip(times, run)]
    return rows


def write(name, rows, head):
    with open(os.path.join(HERE, name), "w", encoding="utf-8") as file:
        file.write(head + "\n")
        for row in rows:
            file.write(",".join("%.10g" % v for v in row) + "\n")
    print(name, len(rows), "rows")


def start():
    """A profile to begin with."""
    up = np.linspace(0, 1, STAGES)[:, None]
    return ((1 - up) * [0.0, 0.05, 0.3, 0.01, 0.002] + up * [0.01, 0.96, 0.02, 0.001, 0.001]).ravel()


def main():
    heads = ",".join("T%d" % (i + 1) for i in range(STAGES)) + ",iC4_D,C3_B,D,B"
    first = steady(NOMINAL, start())
    second = steady(SS2, first)
    write("splitter_steady.csv",
          [[v["R"], v["Q"], *outputs(x, v)] for x, v in ((first, NOMINAL), (second, SS2))], "# R,Q," + heads)
    rows = []
    for n, values in enumerate(STEPS):
        for hours, x in zip(HOURS, integrate(first, values, HOURS)):
            rows.append([n, hours, *outputs(x, values)])
    write("splitter_steps.csv", rows, "# step,hours," + heads)
    write("splitter_day.csv", day(first), "# hours,R,Q,F,TF,zC2,zC3,ziC4,ziC5,znC5,znC4," + heads)


if __name__ == "__main__":
    main()
