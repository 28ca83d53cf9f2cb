#!/usr/bin/python3
"""Independent reference of plant pilot-cold: start, running, loss of cooling, dry reboiler, shut-down.

    tests/reference/pilot_cold_reference.py

writes pilot_cold_run.csv and pilot_cold_steady.csv next to this file. The equations are written here a second time from
the balances: states are composition, holdup and temperature of every stage (the C code has moles and energies), every
stream is an object that knows where it comes from and goes to, and scipy's Radau integrates at tight tolerances. Nothing of
the C sources is called; the handbook constants alone are shared (host_sim/plants/pilot.json). The numbers of the plant are those
at the head of host_sim/plants/pilot_cold.c.
"""
import os

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from pilot_reference import L_PER_H, Mixture, percent, read_properties

HERE = os.path.dirname(os.path.abspath(__file__))
N = 12  # 0 reboiler, 1..10 trays from the bottom, 11 drum
MIX = Mixture(read_properties())
LATENT = 34196.0
METAL = np.array([6000.0] + [300.0] * 10 + [100.0])
LOSS = np.array([1.6] + [0.02] * 10 + [0.1])
FILM = np.array([0.5] + [0.005] * 10 + [0.05])
WET = np.array([0.2] + [0.01] * 10 + [0.02])
AREA = {0: 0.01, 11: 0.0025}
KELVIN = 273.15


def ramp(z):
    z = min(max(z, 0.0), 1.0)
    return 3 * z**2 - 2 * z**3


def bend(z, width):
    return z * z / (z + width) if z > 0 else 0.0


def lesser(value, limit):
    edge = 0.02 * limit
    if abs(value - limit) >= edge:
        return min(value, limit)
    return value - (value - limit + edge) ** 2 / (4 * edge)


def valve(percent_open):
    return percent_open / 100 if percent_open >= 2.5 else 0.0


class Stream:
    """Mole flows of both components and the enthalpy they carry, from the boiling points of the pure liquids."""

    def __init__(self, flow, x, t, vapour=False):
        self.n = flow * np.array([x, 1 - x])
        self.h = self.n @ (MIX.cp * (t - MIX.tb)) + (flow * LATENT if vapour else 0.0)

    def scaled(self, part):
        out = Stream(0.0, 0.0, 0.0)
        out.n, out.h = part * self.n, part * self.h
        return out


def volume(x, t):
    return MIX.volume(np.array([x, 1 - x]), t)


def unpack(y):
    return y[:N], y[N:2 * N], y[2 * N:3 * N], y[3 * N], y[3 * N + 1]


def flows(y, u):
    """Levels, and the streams that valves decide."""
    x, m, t, _, _ = unpack(y)
    level = {s: m[s] * volume(x[s], t[s]) / AREA[s] for s in (0, 11)}

    def product(s, opening, size, nominal, outlet, brim):
        return (opening * size * L_PER_H * np.sqrt(level[s] / nominal) * ramp((level[s] - outlet) / 0.01)
                + 0.02 * max(level[s] - brim, 0.0) ** 1.5)

    q = {"B": product(0, valve(u["vB"]), 10.0, 0.15, 0.01, 0.35), "D": product(11, valve(u["vD"]), 3.3, 0.06, 0.005, 0.12),
         "Lr": valve(u["vLr"]) * 12.0 * L_PER_H * ramp((level[11] - 0.005) / 0.01), "F": valve(u["vF"]) * 10.0 * L_PER_H,
         "water": valve(u["vCW"]) * u["supply"] * 60.0 * L_PER_H}
    return level, q


def derivative(y, u):
    x, m, t, t_heater, t_water = unpack(y)
    level, q = flows(y, u)
    gain = np.zeros((N, 2))
    heat = -LOSS * u["loss"] * (t - u["Tamb"] - KELVIN)

    def move(stream, source, target):
        for s, sign in ((source, -1.0), (target, 1.0)):
            if s is not None:
                gain[s] += sign * stream.n
                heat[s] += sign * stream.h

    # vapour, from below
    rising, above_drum = None, []
    through = np.zeros(N)  # vapour entering a tray from below, mol/s
    for s in range(N):
        pressure = u["P"] * 133.322 + 1000.0 * (1 - s / (N - 1))
        partial = np.array([x[s], 1 - x[s]]) * MIX.pressures(t[s])
        liquid = max(m[s] - FILM[s], 0.0)
        excess = max(partial.sum() / pressure - 1, 0.0)
        own = 20.0 * liquid / (liquid + WET[s]) * excess**2 / (excess + 1e-4 + excess**2 / 0.02)
        stream = Stream(own, partial[0] / partial.sum(), t[s], vapour=True)
        if s == N - 1:
            move(stream, s, None)
            above_drum.append(stream)
            break
        move(stream, s, None)
        if s > 0:  # nine tenths of what comes from below stay here
            move(rising.scaled(0.9), None, s)
            through[s] = rising.n.sum()
            stream.n = stream.n + 0.1 * rising.n
            stream.h += 0.1 * rising.h
        rising = stream
    above_drum.append(rising)

    # condenser
    gap = bend(t[N - 2] - t_water, 1.0)
    arriving = sum(v.n.sum() for v in above_drum)
    part = lesser(arriving, 50.0 * gap / LATENT) / arriving if arriving > 0 else 0.0
    taken = 0.0
    for v in above_drum:
        moles = v.n.sum()
        condensate = Stream(part * moles, v.n[0] / moles if moles > 0 else 0.0, t[N - 2] - 0.04 * gap)
        move(condensate, None, N - 1)
        taken += part * v.h - condensate.h
    cooled = q["water"] * 4.18e6 * (t_water - u["Tcw_in"] - KELVIN)
    d_water = (taken - cooled - 0.5 * u["loss"] * (t_water - u["Tamb"] - KELVIN)) / (0.3 * 4180.0)

    # liquid, from above
    move(Stream(q["Lr"] / volume(x[11], t[11]), x[11], t[11]), 11, 10)
    for s in range(1, N - 1):
        leaving = 2.3 * max(m[s] - 0.2, 0.0) ** 1.5
        leaving += max(m[s] - FILM[s], 0.0) / 10.0 * max(1 - through[s] / 5e-3, 0.0) ** 2
        move(Stream(leaving, x[s], t[s]), s, s - 1)
    z = np.array([u["xF"], 100 - u["xF"]]) / MIX.mass
    z = z[0] / z.sum()
    move(Stream(q["F"] / volume(z, u["TF"] + KELVIN), z, u["TF"] + KELVIN), None, 4)
    move(Stream(q["B"] / volume(x[0], t[0]), x[0], t[0]), 0, None)
    move(Stream(q["D"] / volume(x[11], t[11]), x[11], t[11]), 11, None)
    wet = max(m[0] - FILM[0], 0.0)
    move(Stream(u["leak"] * L_PER_H / volume(x[0], t[0]) * wet / (wet + WET[0]), x[0], t[0]), 0, None)

    # heater
    given = (1.0 + 29.0 * ramp((level[0] - 0.03) / 0.02)) * (t_heater - t[0])
    heat[0] += given
    d_heater = (1e3 * u["Qrb"] * ramp((300.0 + KELVIN - t_heater) / 20.0) - given) / 400.0

    dm = gain.sum(axis=1)
    dx = (gain[:, 0] - x * dm) / m
    content = np.column_stack([x * m, (1 - x) * m])
    dt = (heat - (gain * MIX.cp * (t[:, None] - MIX.tb)).sum(axis=1)) / (METAL + content @ MIX.cp)
    return np.concatenate([dx, dm, dt, [d_heater, d_water]])


OFF = {"Qrb": 0.0, "vLr": 0.0, "vD": 0.0, "vB": 0.0, "vF": 0.0, "vCW": 0.0, "xF": 36.0, "TF": 60.0, "Tamb": 20.0,
       "Tcw_in": 15.0, "supply": 1.0, "loss": 1.0, "leak": 0.0, "P": 760.0}
RUNNING = {"Qrb": 0.823, "vLr": 37.5, "vD": 40.0, "vB": 39.6, "vF": 50.0, "vCW": 100.0}
SCHEDULE = [  # s, what changes; tests/unit/test_pilot_cold_reference.c has the same
    (0, {"vCW": 100.0}), (60, {"Qrb": 1.0}), (1080, {"vLr": 100.0}), (1920, RUNNING),
    (10800, {"supply": 0.0}), (11400, {"supply": 1.0}), (16200, {"leak": 60.0}), (16500, {"leak": 0.0}),
    (16800, {"Qrb": 0.0, "vF": 0.0, "vD": 0.0, "vB": 0.0, "vLr": 100.0}), (18600, {"vCW": 0.0}), (28800, {})]


def cold():
    z = np.array([36.0, 64.0]) / MIX.mass
    x = np.full(N, z[0] / z.sum())
    t = np.full(N, 20.0 + KELVIN)
    m = FILM.copy()
    m[0] = 0.18 * AREA[0] / volume(x[0], t[0])
    return np.concatenate([x, m, t, t[:2]])


def row(time, y, u):
    x, m, t, t_heater, t_water = unpack(y)
    level, q = flows(y, u)
    return [time, *(t[10:0:-1] - KELVIN), t[0] - KELVIN, t[11] - KELVIN, t_heater - KELVIN, t_water - KELVIN,
            100 * level[0], 100 * level[11], percent(x[11]), percent(x[0])] + [q[k] / L_PER_H for k in ("Lr", "D", "B")]


HEAD = ["T%d" % k for k in range(1, 11)] + ["TB", "TD", "Theater", "Tcw", "LB_true", "LD", "xD", "xB", "Lr", "D", "B"]


def write(name, rows):
    with open(os.path.join(HERE, name), "w", encoding="utf-8") as file:
        file.write("# made by tests/reference/pilot_cold_reference.py\n# t," + ",".join(HEAD) + "\n")
        for r in rows:
            file.write(",".join("%.8g" % v for v in r) + "\n")


def run():
    y, u, rows = cold(), dict(OFF), []
    scale = np.concatenate([np.full(N, 1e-9), 1e-9 * FILM, np.full(N, 1e-7), [1e-6, 1e-6]])
    for (begin, change), (end, _) in zip(SCHEDULE, SCHEDULE[1:]):
        u.update(change)
        times = np.arange(begin, end + 1, 120.0) if begin % 120 == 0 else np.arange(begin + 60, end + 1, 120.0)
        done = solve_ivp(lambda t, y: derivative(y, u), (begin, end), y, method="Radau", rtol=1e-8, atol=scale,
                         t_eval=np.union1d(times, [end]))
        assert done.success, done.message
        for t, state in zip(done.t, done.y.T):
            if t % 120 == 0 and t > begin:
                rows.append(row(t, state, u))
        y = done.y[:, -1]
        print(begin, end, done.nfev, flush=True)
    return rows


def steady(guess):
    u = dict(OFF, **RUNNING)
    scale = np.concatenate([np.full(N, 1.0), FILM, np.full(N, 100.0), [100.0, 100.0]])
    y, info, _, message = fsolve(lambda v: derivative(v * scale, u) / scale * 3600, guess / scale, xtol=1e-13,
                                 full_output=True)
    assert np.abs(info["fvec"]).max() < 1e-6, message
    return row(0, y * scale, u)


def near_running():
    """Four hours after the start without faults: near enough for Newton."""
    y, u = cold(), dict(OFF)
    for begin, end, change in ((0, 60, {"vCW": 100.0}), (60, 1080, {"Qrb": 1.0}), (1080, 1920, {"vLr": 100.0}),
                               (1920, 3e4, RUNNING)):
        u.update(change)
        y = solve_ivp(lambda t, y: derivative(y, u), (begin, end), y, method="BDF", rtol=1e-6, atol=1e-9).y[:, -1]
    return y


if __name__ == "__main__":
    write("pilot_cold_steady.csv", [steady(near_running())])
    write("pilot_cold_run.csv", run())
