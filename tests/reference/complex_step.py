"""Exact derivatives of the columns, independent of the C sources.

The model of tests/reference/column-equations.md is written here once more with numpy, for columns with perfect levels and constant holdups, so
that it takes complex numbers: the imaginary part of f(x + i h e_j) / h is the derivative along x_j, without any difference
being taken, so h can be 1e-30 (Squire and Trapp, SIAM Review 40 (1998) 110). All directions are worked out side by side: arrays
carry them in front. Where a limit is just setting in the derivative is that of the side which the real part stands on.

The property data and dimensions are those of the reference models in pilot_reference.py and splitter_reference.py.
"""
import numpy as np

import pilot_reference as pilot
import splitter_reference as splitter

TINY = 1e-30


def soft(a, b, softness):
    """The lesser of a and b, rounded off."""
    w = softness * b
    with np.errstate(all="ignore"):
        between = a - (a - b + w) ** 2 / (4 * w)
    return np.where(a.real <= (b - w).real, a, np.where(a.real >= (b + w).real, b, between))


def positive(a, w):
    """The greater of a and 0, rounded off."""
    with np.errstate(all="ignore"):
        between = (a + w) ** 2 / (4 * w)
    return np.where(a.real >= w.real, a, np.where(a.real <= -w.real, 0, between))


def watson(m, x, t):
    return (x * m.latent * ((m.tc - t[..., None]) / (m.tc - m.tb)) ** 0.38).sum(axis=-1)


def volume(m, x, t):
    return (x * m.mass / (m.rho0 + m.rho1 * t[..., None])).sum(axis=-1)


class Model:
    """A pilot_reference.Column; pressures(mixture, T): those of the components, and the derivatives of their logarithms."""

    def __init__(self, column, pressures, softness=0.02):
        self.c, self.m, self.pressures, self.softness = column, column.m, pressures, softness

    def bubbles(self, x, pressure):
        """Newton, first for the real parts; from their solution one step makes the imaginary parts right."""
        t = np.full(np.broadcast(x[..., 0], pressure).shape, 360.0)
        for _ in range(60):
            step = self.newton(t, x.real, pressure.real)
            t = t + np.clip(step, -20, 20)
            if np.abs(step).max() < 1e-11:
                break
        for _ in range(2):
            t = t + self.newton(t, x, pressure)
        return t

    def newton(self, t, x, pressure):
        each, slope = self.pressures(self.m, t[..., None])
        total = (x * each).sum(axis=-1)
        return -np.log(total / pressure) * total / (x * each * slope).sum(axis=-1)

    def evaluate(self, flat, u):
        """flat: states [directions, n]; u: the keys of pilot_reference.Column.evaluate, each [directions] (z: [directions, C]).
        Rates, compositions, temperatures, vapours and flows."""
        c, m, n, nf, soft_by = self.c, self.m, self.c.n, self.c.feed_stage, self.softness
        x = flat.reshape(len(flat), n, -1)
        x = np.concatenate([x, 1 - x.sum(axis=2, keepdims=True)], axis=2)
        pressure = u["pressure"][:, None] + c.drop * (1 - np.arange(n) / (n - 1))
        t = self.bubbles(x, pressure)
        v = x * self.pressures(m, t[..., None])[0] / pressure[..., None]
        for i in range(1, n - 1):
            v[:, i] = (1 - c.efficiency) * v[:, i - 1] + c.efficiency * v[:, i]

        feed = u["feed"] / volume(m, u["z"], u["t_feed"])
        wanted = u["reflux"] / volume(m, x[:, -1], t[:, -1] - u["subcooling"])
        boilup = np.where(u["heat"].real > 0, u["heat"], 0) / watson(m, x[:, 0], t[:, 0])
        by_feed = feed * (x[:, nf] @ m.cp) * (t[:, nf] - u["t_feed"]) / watson(m, x[:, nf], t[:, nf])
        g = 1 + (x[:, -1] @ m.cp) * u["subcooling"] / watson(m, x[:, -1], t[:, -1])
        by_feed = np.where(by_feed.real > 0, soft(by_feed, boilup, soft_by), -soft(-by_feed, (1 - soft_by) * feed, soft_by))
        a = boilup - by_feed
        a = np.where(a.real > 0, a, 0)
        w = positive(a - g * wanted, soft_by * a)
        reflux, d = (a - w) / g, soft(w, feed, soft_by)
        enriching = d + g * reflux
        stripping = enriching + by_feed
        d = d + np.where(stripping.real < 0, -stripping, 0)
        stripping = np.where(stripping.real < 0, 0, stripping)

        up = np.repeat(enriching[:, None], n, axis=1)
        up[:, :nf] = stripping[:, None]
        up[:, n - 2] = d + reflux
        up[:, n - 1] = 0
        down = np.zeros_like(up)
        down[:, n - 1] = reflux
        down[:, nf + 1:n - 1] = (g * reflux)[:, None]
        down[:, 1:nf + 1] = (g * reflux + feed + by_feed)[:, None]
        rates = np.zeros_like(x)
        for i in reversed(range(n)):
            held = c.holdup[i]
            if c.form != "molar":
                each = m.mass / (m.rho0 + m.rho1 * c.hold_t[i])
                held = held / (x[:, i] @ each)
            gain = np.zeros_like(x[:, i])
            total = np.zeros_like(feed)
            for there, flow, what in ((i < n - 1, down[:, min(i + 1, n - 1)], x[:, min(i + 1, n - 1)]),
                                      (i > 0, up[:, i - 1], v[:, i - 1]), (i == nf, feed, u["z"])):
                if there:
                    total = total + flow
                    forwards = (flow.real > 0) | ((flow.real == 0) & (flow.imag > 0))
                    gain = gain + np.where(forwards, flow, 0)[:, None] * (what - x[:, i])
            rates[:, i] = (gain - up[:, i, None] * (v[:, i] - x[:, i])) / np.reshape(held, (-1, 1))
            if c.form == "conservative":
                grown = -held * (rates[:, i] @ each) / (x[:, i] @ each)
                out = total - up[:, i] - grown
                short = (out.real < 0) & (0 < i < n - 1)
                if short.any():
                    mean, below = x[:, i] @ each, x[:, i - 1] @ each
                    drawn = np.where(short, -out * mean / below, 0)
                    rates[:, i] += (drawn / held)[:, None] * (x[:, i - 1] - x[:, i])
                    out = np.where(short, -drawn, out)
                if i == n - 1:
                    d = out - reflux
                else:
                    down[:, i] = out
        b = down[:, 0] if c.form == "conservative" else feed - d
        return {"rates": rates[:, :, :-1].reshape(flat.shape), "x": x, "t": t, "v": v, "d": d, "b": b, "reflux": reflux,
                "boilup": up[:, 0]}


def antoine(m, t):
    return np.exp(m.a - m.b / (m.c + t)), m.b / (m.c + t) ** 2


def dippr(m, t):
    part = m.c4 * t ** m.c5
    return (np.exp(m.c1 - m.c2 / t + m.c3 * np.log(t) + part), m.c2 / t ** 2 + (m.c3 + m.c5 * part) / t)


def flow_volume(m, flow, x, t):
    return flow * volume(m, x, t)


class Plant:
    """A model with the channels of a plant: u and y as reflux-sim names and scales them."""

    def __init__(self, model, drive, outputs):
        self.model, self.drive, self.outputs = model, drive, outputs

    def derivatives(self, x, u, inputs, outputs):
        """A, B, C, D at states x and inputs {name: value}, for the inputs and outputs named."""
        n, k = len(x), len(inputs)
        states = np.repeat(np.array(x, complex)[None], n + k, axis=0)
        states[np.arange(n), np.arange(n)] += TINY * 1j
        given = {name: np.full(n + k, float(value), complex) for name, value in u.items()}
        for j, name in enumerate(inputs):
            given[name][n + j] += TINY * 1j
        found = self.model.evaluate(states, self.drive(given))
        rates = found["rates"].imag.T / TINY
        seen = self.outputs(self.model.m, found, given)
        seen = np.array([np.broadcast_to(seen[name], n + k).imag for name in outputs]) / TINY
        return rates[:, :n], rates[:, n:], seen[:, :n], seen[:, n:]


def pilot_drive(u):
    w = np.stack([u["xF"], 100 - u["xF"]], axis=1) / pilot.MIXTURE.mass
    lit = pilot.L_PER_H
    return {"feed": u["F"] * lit, "z": w / w.sum(axis=1, keepdims=True), "t_feed": u["TF"] + 273.15, "reflux": u["Lr"] * lit,
            "subcooling": u["dTr"], "heat": (u["Qrb"] - u["Qloss"]) * 1e3, "pressure": u["P"] * 133.322}


def pilot_outputs(m, f, u):
    lit = pilot.L_PER_H
    cold = f["t"][:, -1] - u["dTr"]
    weight = [100 * f["x"][:, s, 0] * m.mass[0] / (f["x"][:, s] @ m.mass) for s in (-1, 0)]
    return {**{f"T{k}": f["t"][:, 11 - k] - 273.15 for k in range(1, 11)}, "TB": f["t"][:, 0] - 273.15, "xD": weight[0],
            "xB": weight[1], "D": flow_volume(m, f["d"], f["x"][:, -1], cold) / lit,
            "B": flow_volume(m, f["b"], f["x"][:, 0], f["t"][:, 0]) / lit,
            "Lr_eff": flow_volume(m, f["reflux"], f["x"][:, -1], cold) / lit, "V": f["boilup"] * 3600}


FRACTIONS = ("zC2", "zC3", "ziC4", "ziC5", "znC5", "znC4")  # in the order of the components


def splitter_drive(u):
    z = np.stack([u[name] for name in FRACTIONS], axis=1)
    return {"feed": u["F"] / 3600, "z": z / z.sum(axis=1, keepdims=True), "t_feed": u["TF"], "reflux": u["R"] / 3600,
            "subcooling": u["dTr"], "heat": u["Q"] * 4.184e6 / 3600, "pressure": u["P"] * 1e5}


def splitter_outputs(m, f, u):
    return {**{f"T{k + 1}": f["t"][:, k] for k in range(splitter.STAGES)}, "iC4_D": f["x"][:, -1, 2], "C3_B": f["x"][:, 0, 1],
            "D": f["d"] * 3.6, "B": f["b"] * 3.6, "V": f["boilup"] * 3.6,
            "R_eff": flow_volume(m, f["reflux"], f["x"][:, -1], f["t"][:, -1] - u["dTr"]) * 3600, "Fm": u["F"], "TFm": u["TF"]}


PLANTS = {"pilot": Plant(Model(pilot.PILOT, antoine), pilot_drive, pilot_outputs),
          "splitter": Plant(Model(splitter.COLUMN, dippr), splitter_drive, splitter_outputs)}
