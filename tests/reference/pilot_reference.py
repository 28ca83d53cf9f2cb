"""Independent reference of the column model and of the pilot column.

    python3 tests/reference/pilot_reference.py

writes pilot_steady.csv, pilot_gains.csv, pilot_steps.csv, pilot_day.csv and column_points.csv next to this file. The equations
are written here a second time, with numpy and scipy (Radau at tight tolerances), from the balances themselves:
nothing of the C sources is called. The property constants alone are shared: they are read from
host_sim/plants/pilot.json, frozen handbook data.
"""
import json
import os

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

HERE = os.path.dirname(os.path.abspath(__file__))
PLANT = os.path.join(HERE, "..", "..", "host_sim", "plants", "pilot.json")


def read_properties(plant=PLANT):
    """Component constants from a column's file, as arrays over the components."""
    with open(plant, encoding="utf-8") as file:
        components = json.load(file)["components"]
    names = {"antoine": "vapour_pressure", "molar_mass": "molar_mass", "density": "density",
             "vaporisation_heat": "vaporisation_heat", "boiling_point": "boiling_point",
             "critical_temperature": "critical_temperature", "heat_capacity": "heat_capacity"}
    out = {n: [np.atleast_1d(c[key]) for c in components] for n, key in names.items()}
    out["antoine"] = [np.pad(row, (0, 7 - len(row))) for row in out["antoine"]]
    return {n: np.array(rows, float) for n, rows in out.items()}


class Mixture:
    """Ideal liquid and vapour; compositions are rows over the components, temperatures in K."""

    def __init__(self, p, order=(0, 1)):
        order = list(order)
        self.a, self.b, self.c = p["antoine"][order, :3].T
        self.mass = p["molar_mass"][order, 0]
        self.rho0, self.rho1 = p["density"][order].T
        self.latent = p["vaporisation_heat"][order, 0]
        self.tb = p["boiling_point"][order, 0]
        self.tc = p["critical_temperature"][order, 0]
        self.cp = p["heat_capacity"][order, 0]

    def pressures(self, t):
        return np.exp(self.a - self.b / (self.c + t))

    def bubble(self, x, pressure):
        return brentq(lambda t: x @ self.pressures(t) - pressure, 250.0, 450.0, xtol=1e-12, rtol=1e-15)

    def volume(self, x, t):
        return x @ (self.mass / (self.rho0 + self.rho1 * t))

    def heat(self, x, t):
        return x @ (self.latent * ((self.tc - t) / (self.tc - self.tb)) ** 0.38)


class Column:
    """Stages 0 (reboiler) to n-1 (total condenser). Written as balances over streams, not per section."""

    def __init__(self, mixture, stages, feed_stage, efficiency, drop, holdup, form):
        self.m, self.n, self.feed_stage = mixture, stages, feed_stage
        self.efficiency, self.drop, self.holdup, self.form = efficiency, drop, np.asarray(holdup), form
        self.hold_t = np.linspace(380.0, 360.0, stages)  # where liquid volumes of holdups are taken

    def states(self, flat):
        x = np.reshape(flat, (self.n, -1))
        return np.column_stack([x, 1 - x.sum(axis=1)])

    def equilibrium(self, x, top_pressure):
        pressure = top_pressure + self.drop * (1 - np.arange(self.n) / (self.n - 1))
        t = np.array([self.m.bubble(xi, pi) for xi, pi in zip(x, pressure)])
        y = x * np.array([self.m.pressures(ti) for ti in t]) / pressure[:, None]
        v = y.copy()
        for i in range(1, self.n - 1):
            v[i] = (1 - self.efficiency) * v[i - 1] + self.efficiency * y[i]
        return t, v

    def evaluate(self, flat, u):
        """dx/dt of all components but the last, temperatures, distillate and bottoms flow."""
        m, n, nf = self.m, self.n, self.feed_stage
        x = self.states(flat)
        t, v = self.equilibrium(x, u["pressure"])
        feed = u["feed"] / m.volume(u["z"], u["t_feed"])
        reflux = u["reflux"] / m.volume(x[-1], t[-1] - u["subcooling"])
        boilup = u["heat"] / m.heat(x[0], t[0])
        by_feed = feed * (x[nf] @ m.cp) * (t[nf] - u["t_feed"]) / m.heat(x[nf], t[nf])
        by_reflux = reflux * (x[-1] @ m.cp) * u["subcooling"] / m.heat(x[-1], t[-1])

        up = np.empty(n)  # vapour leaving each stage
        up[:nf] = boilup
        up[nf:n - 2] = boilup - by_feed
        up[n - 2] = boilup - by_feed - by_reflux
        up[n - 1] = 0.0
        down = np.zeros(n)  # liquid leaving each stage downwards, the top one as reflux
        down[n - 1] = reflux
        holdup, dh_dx = self.molar_holdup(x)
        dx = np.zeros_like(x)
        distillate = 0.0
        for i in reversed(range(n)):
            inflow = np.zeros(x.shape[1])
            if i < n - 1:
                inflow += down[i + 1] * x[i + 1]
            if i > 0:
                inflow += up[i - 1] * v[i - 1]
            if i == nf:
                inflow += feed * u["z"]
            total = inflow.sum()
            # d(H x)/dt = in - out with the liquid leaving at x: H dx/dt = in - x sum(in) - up (v - x)
            dx[i] = (inflow - x[i] * total - up[i] * (v[i] - x[i])) / holdup[i]
            growth = dh_dx[i] @ dx[i] if self.form == "conservative" else 0.0
            leaving = total - up[i] - growth
            if i == n - 1:
                distillate = leaving - reflux
            else:
                down[i] = leaving
        return dx[:, :-1].ravel(), t, distillate, down[0]

    def molar_holdup(self, x):
        """Moles on each stage and their gradient by the full composition."""
        if self.form == "molar":
            return self.holdup, np.zeros_like(x)
        h, g = np.empty(self.n), np.empty_like(x)
        for i in range(self.n):
            vm = self.m.mass / (self.m.rho0 + self.m.rho1 * self.hold_t[i])
            h[i] = self.holdup[i] / (x[i] @ vm)
            g[i] = -self.holdup[i] * vm / (x[i] @ vm) ** 2
        return h, g


L_PER_H = 1e-3 / 3600
NOMINAL = {"Lr": 4.5, "Qrb": 0.8, "F": 5.0, "xF": 36.0, "TF": 60.0, "dTr": 5.0, "Qloss": 0.15, "P": 760.0}
MIXTURE = Mixture(read_properties())
PILOT = Column(MIXTURE, 12, 4, 0.9, 1000.0, [1.5 * 9.1] + [0.025 * 9.7] * 10 + [0.15 * 10.3], "molar")


def drive(values):
    """Column inputs in SI units from the pilot's channels."""
    w = np.array([values["xF"], 100 - values["xF"]]) / MIXTURE.mass
    return {"feed": values["F"] * L_PER_H, "z": w / w.sum(), "t_feed": values["TF"] + 273.15,
            "reflux": values["Lr"] * L_PER_H, "subcooling": values["dTr"],
            "heat": (values["Qrb"] - values["Qloss"]) * 1e3, "pressure": values["P"] * 133.322}


def steady(values, guess):
    u = drive(values)
    x, info, ok, message = fsolve(lambda x: PILOT.evaluate(x, u)[0] * 3600, guess, xtol=1e-14, full_output=True)
    assert np.abs(info["fvec"]).max() < 1e-8, message
    return x


def trays(x, values):
    """Temperatures of trays 1 to 10 and of the reboiler, degC."""
    t = PILOT.evaluate(x, drive(values))[1] - 273.15
    return np.concatenate([t[10:0:-1], t[:1]])


def percent(x):
    m = MIXTURE.mass
    return 100 * x * m[0] / (x * m[0] + (1 - x) * m[1])


CODES = ("Lr", "Qrb", "F", "xF")
INPUTS = "input (0 Lr, 1 Qrb, 2 F, 3 xF),"
HEAD = ",".join("T%d" % k for k in range(1, 11)) + ",TB"


def write(name, head, rows):
    with open(os.path.join(HERE, name), "w", encoding="utf-8") as file:
        file.write("# made by tests/reference/pilot_reference.py\n# " + head + "\n")
        for row in rows:
            file.write(",".join("%.9g" % v for v in row) + "\n")


def column_points(rng):
    """Rates and temperatures at scattered states, for both scalar types of the C model."""
    rows = []
    for form, holdup in (("molar", [8.0] + [0.3] * 8 + [1.5]), ("conservative", [1e-3] + [3e-5] * 8 + [1.5e-4])):
        # three components: the third is the heavy one moved up by 20 K, a made-up homologue
        p = read_properties()
        p = {k: np.vstack([v, v[1]]) for k, v in p.items()}
        p["antoine"][2, 2] -= 20.0
        mixture = Mixture(p, (0, 1, 2))
        column = Column(mixture, 10, 3, 0.7, 3000.0, holdup, form)
        u = {"feed": 1.5e-6, "z": np.array([0.3, 0.45, 0.25]), "t_feed": 335.0, "reflux": 1.1e-6,
             "subcooling": 8.0, "heat": 700.0, "pressure": 1.0e5}
        for _ in range(4):
            x = rng.dirichlet([1.0, 1.0, 1.0], 10).round(6)[:, :2]
            dx, t, d, b = column.evaluate(x.ravel(), u)
            assert d > 0.05 * b > 0
            rows.append([0 if form == "molar" else 2, *x.ravel(), *dx, *t, d, b])
    write("column_points.csv", "form (0 molar, 2 conservative)," + ",".join(["x%d" % i for i in range(20)] + ["r%d" % i for i in range(20)]
                                                   + ["T%d" % i for i in range(10)]) + ",D,B", rows)


# A day: heater, reflux and feed move one after the other, far enough to bend every gain.
DAY = ({}, {"Qrb": 0.84}, {"Lr": 5.0}, {"F": 5.6}, {"xF": 31.0}, {"Qrb": 0.76, "Lr": 4.2}, {"F": 4.5, "xF": 42.0}, {"Qrb": 0.80})
STRETCH = 3 * 3600.0


def day(x):
    """One row for each reading: time, the inputs that led there, temperatures."""
    rows, values = [], dict(NOMINAL)
    for k, change in enumerate(DAY):
        values.update(change)
        u = drive(values)
        times = [300.0, 1800.0, STRETCH]
        run = solve_ivp(lambda t, y: PILOT.evaluate(y, u)[0], [0, STRETCH], x, method="Radau", t_eval=times, rtol=1e-9,
                        atol=1e-11)
        x = run.y[:, -1]
        for time, y in zip(times, run.y.T):
            rows.append([k * STRETCH + time, *(values[name] for name in CODES), *trays(y, values)])
    return rows


def start():
    """A state near the nominal steady state."""
    return solve_ivp(lambda t, x: PILOT.evaluate(x, drive(NOMINAL))[0], [0, 40000], np.linspace(0.05, 0.95, 12),
                     method="BDF", rtol=1e-5, atol=1e-7).y[:, -1]


def main():
    x0 = steady(NOMINAL, start())
    _, _, d, b = PILOT.evaluate(x0, drive(NOMINAL))
    t0 = trays(x0, NOMINAL)
    write("pilot_steady.csv", HEAD + ",xD,xB,D_mol_h,B_mol_h",
          [[*t0, percent(x0[-1]), percent(x0[0]), d * 3600, b * 3600]])

    rows = []
    for name, h in (("Lr", 0.002), ("Qrb", 0.0002), ("F", 0.002), ("xF", 0.01)):
        hi, lo = dict(NOMINAL), dict(NOMINAL)
        hi[name] += h
        lo[name] -= h
        rows.append([CODES.index(name), *(trays(steady(hi, x0), hi) - trays(steady(lo, x0), lo)) / (2 * h)])
    write("pilot_gains.csv", INPUTS + HEAD, rows)

    rows = []
    times = np.array([30.0, 60.0, 120.0, 300.0, 600.0, 1200.0, 2400.0, 4800.0])
    for name, step in (("Lr", 0.2), ("Lr", -0.2), ("Qrb", 0.03), ("Qrb", -0.03), ("F", 0.5), ("F", -0.5),
                       ("xF", 4.0), ("xF", -4.0)):
        values = dict(NOMINAL)
        values[name] += step
        u = drive(values)
        run = solve_ivp(lambda t, x: PILOT.evaluate(x, u)[0], [0, times[-1]], x0, method="Radau", t_eval=times,
                        rtol=1e-9, atol=1e-11)
        for k, time in enumerate(times):
            rows.append([CODES.index(name), step, time, *trays(run.y[:, k], values)])
    write("pilot_steps.csv", INPUTS + "step,t_s," + HEAD, rows)
    write("pilot_day.csv", "t_s," + ",".join(CODES) + "," + HEAD, day(x0))
    column_points(np.random.default_rng(20))


if __name__ == "__main__":
    main()
