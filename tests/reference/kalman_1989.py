#!/usr/bin/python3
"""The Kalman filter of 1989 (Folami, PhD thesis, Aston, chapter 7), as far as what is left of the thesis says how it was, and what it
takes to make one of it that works: dense, in double precision, from recorded readings.

    kalman_1989.py TABLE LOG ESTIMATES [--method kalman|ekf] [--step implicit|explicit|exact] ...

TABLE: lines of reflux-sim --table; LOG: log.csv of a run (tools/research/kalman_1989.py plays it); ESTIMATES: what is written,
mole fractions x1 (reboiler) to x12 (drum) for each of its rows. Nothing of the C sources was read; the column's equations are those
of columns_reference, its Jacobian is composition_reference's. The thesis has a linear model of twelve states, discretised at 30 s by
a transition matrix, thermometers on five trays and four inputs that the filter is told: feed flow, feed composition, reflux, heat.
How the matrix was made, and the covariances, are lost. With A the Jacobian at the table's profile and h the interval:

    --step explicit   Phi = I + h A            the column's trays have 3 s: h times the fastest eigenvalue is -9.5 at 30 s
           exact      Phi = exp(h A)
           implicit   Phi = (I - h A)^-1
    --gains g         what inputs do to the linear model is g times what it should be

States besides the mole fractions, as in the firmware: what the feed's composition (--feed-z, its standard deviation) and its flow
(--feed-f, relative) are off; they keep an hour. Noise of a mole fraction x in a tick: (4 x (1 - x) model)^2 h / 3600, added to P before
Phi; P <- A P A' for the whole, then each thermometer one after the other, r = noise^2. The extended filter has A, slopes and rates at
its estimate, with --step explicit x + h f(x).
"""

import argparse
import csv

from composition_reference import Estimator, Table  # before numpy
from columns_reference import STEP

import numpy as np
from scipy.linalg import expm

STAGES = {"T1": 11, "T2": 10, "T7": 5, "T9": 3, "T10": 2}  # from 1, the reboiler
HOUR, KELVIN, L_H, KW = 3600.0, 273.15, 1e-3 / 3600, 1000.0
PURE = 0.01


class Filter:
    def __init__(self, table, h, chosen):
        self.chosen, self.h, self.table = chosen, h, table
        self.model = Estimator(table, [], h)
        self.n = self.model.n
        self.rows = np.array([s - 1 for s in STAGES.values()])
        self.fractions = [c for c in self.model.column.constants if c["is"] == "feed_fraction"]
        self.known = self.fractions[0]["value"]
        self.sd = np.array([sd for sd in (chosen.feed_z, chosen.feed_f) if sd > 0])
        self.with_z, self.with_f = chosen.feed_z > 0, chosen.feed_f > 0
        self.extras = np.zeros(len(self.sd))
        self.x0 = self.model.x[:, 0].copy()
        self.p = np.diag(np.concatenate([self.noise(self.x0, HOUR), self.sd**2]))
        self.frozen = self.look(self.x0, dict(table.nominal), self.known)
        self.fixed = self.phi(self.frozen[1]), self.over(self.frozen[1])
        self.given, self.drive = None, None

    @property
    def x(self):
        return self.model.x[:, 0]

    def noise(self, x, h):
        spread = 4 * np.maximum(x * (1 - x), PURE * (1 - PURE))
        return (self.chosen.model * spread) ** 2 * h / HOUR

    def tell_feed(self, z):
        z = min(max(z, 0.0), 1.0)
        self.fractions[0]["value"], self.fractions[1]["value"] = float(z), float(1 - z)

    def driven(self, values, z):
        """By how much the rates at the profile are other than at the nominal inputs."""
        told = (tuple(sorted(values.items())), z)
        if self.given != told:
            self.tell_feed(z)
            rates = self.model.column.evaluate(self.x0 + 0j, self.table.nominal | values).rates.real
            self.given, self.drive = told, rates - self.frozen[0]
        return self.chosen.gains * self.drive

    def look(self, x, values, z):
        """Rates, Jacobian, slopes of rates by the extras, temperatures and their slopes."""
        self.tell_feed(z)
        kept, self.model.x = self.model.x, x[:, None].copy()
        s = self.model.look(values)
        jacobian = self.model.jacobian(s)
        self.model.x = kept
        by = []
        if self.with_z:
            column = np.zeros(self.n)
            column[self.model.column.feed] = s.feed / s.moles[self.model.column.feed]
            by.append(column)
        if self.with_f:
            more = (self.table.nominal | values)["feed"] * STEP
            moved = self.table.nominal | values
            moved = moved | {"feed": moved["feed"] + 1j * more}
            by.append(self.model.column.evaluate(x + 0j, moved, guess=s.t).rates.imag / STEP)
        return s.rates.real.copy(), jacobian, np.array(by).T.reshape(self.n, len(by)), s.t.copy(), s.dt[:, 0].copy()

    def phi(self, a):
        unit = np.eye(self.n)
        if self.chosen.step == "explicit":
            return unit + self.h * a
        return expm(self.h * a) if self.chosen.step == "exact" else np.linalg.inv(unit - self.h * a)

    def over(self, a):
        """The integral of the transition over the interval: what a steady rate comes to."""
        unit = np.eye(self.n)
        if self.chosen.step == "explicit":
            return self.h * unit
        if self.chosen.step == "exact":
            return np.linalg.solve(a, expm(self.h * a) - unit)
        return self.h * np.linalg.inv(unit - self.h * a)

    def carry(self, phi, push, x):
        n, q, h = self.n, len(self.sd), self.h
        keep = np.full(q, 1 - h / HOUR)
        a = np.block([[phi, push], [np.zeros((q, n)), np.diag(keep)]])
        self.p[range(n), range(n)] += self.noise(x, h)
        self.p = a @ self.p @ a.T
        self.p[range(n, n + q), range(n, n + q)] += self.sd**2 * (1 - keep**2)

    def predict(self, values, z):
        """The change over a tick; temperatures before it and their slopes, as the filter has them."""
        if self.chosen.method == "ekf":
            seen = dict(values)
            if self.with_f:
                seen["feed"] = seen["feed"] * (1 + self.extras[-1])
            rates, a, by, t, slope = self.look(self.x, seen, z + (self.extras[0] if self.with_z else 0.0))
            over = self.over(a)
            self.carry(self.phi(a), over @ by, self.x)
            return over @ rates, t, slope
        _, _, by, t, slope = self.frozen
        xi, (phi, over) = self.x - self.x0, self.fixed
        self.carry(phi, over @ by, self.x0)
        return phi @ xi + over @ (self.driven(values, z) + by @ self.extras) - xi, t + slope * xi, slope

    def step(self, values, z, readings):
        change, t, slope = self.predict(values, z)
        n = self.n
        for row, reading in zip(self.rows, readings):
            b = np.zeros(n + len(self.sd))
            b[row] = slope[row]
            e = reading - t[row] - slope[row] * change[row]
            seen = self.p @ b
            expected = b @ seen + self.chosen.noise**2
            gain = seen / expected
            self.p = self.p - np.outer(seen, seen) / expected
            change = change + gain[:n] * e
            self.extras = self.extras + gain[n:] * e
        self.p = 0.5 * (self.p + self.p.T)
        if self.with_z:
            self.extras[0] = np.clip(self.extras[0], -self.known, 1 - self.known)
        if self.with_f:
            self.extras[-1] = np.clip(self.extras[-1], -0.75, 1.0)
        self.model.x = np.clip(self.x + change, 0.0, 1.0)[:, None]


def mole_fraction(mass_percent, table):
    w = mass_percent / 100
    light, heavy = (part["molar_mass"] for part in table.file["components"])
    return (w / light) / (w / light + (1 - w) / heavy)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table")
    parser.add_argument("log")
    parser.add_argument("estimates")
    parser.add_argument("--method", choices=("kalman", "ekf"), default="kalman")
    parser.add_argument("--step", choices=("implicit", "explicit", "exact"), default="implicit")
    parser.add_argument("--gains", type=float, default=1.0)
    parser.add_argument("--noise", type=float, default=0.05)
    parser.add_argument("--model", type=float, default=0.1)
    parser.add_argument("--feed-z", type=float, default=0.0)
    parser.add_argument("--feed-f", type=float, default=0.0)
    parser.add_argument("--flow-known", action="store_true")
    parser.add_argument("--feed-known", action="store_true")
    chosen = parser.parse_args()
    with open(chosen.table, encoding="utf-8") as file:
        table = Table(file.read().splitlines())
    with open(chosen.log, encoding="utf-8", newline="") as file:
        lines = csv.reader(line for line in file if not line.startswith("#"))
        names = [name.partition("[")[0] for name in next(lines)]
        log = [dict(zip(names, row)) for row in lines]
    h = float(log[1]["time"]) - float(log[0]["time"])
    one = Filter(table, h, chosen)
    with open(chosen.estimates, "w", encoding="utf-8", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["time", *(f"x{s + 1}" for s in range(one.n))])
        for before, row in zip([log[0], *log], log):
            if row is not log[0]:
                values = {"reflux": float(row["Lr.applied"]) * L_H, "heat": float(row["Qrb.applied"]) * KW}
                values["feed"] = float(before["F"]) * L_H if chosen.flow_known else table.nominal["feed"]
                z = mole_fraction(float(before["xF"]), table) if chosen.feed_known else one.known
                one.step(values, z, [float(row[f"{name}.meas"]) + KELVIN for name in STAGES])
            out.writerow([row["time"], *(f"{x:.9g}" for x in one.x)])


if __name__ == "__main__":
    main()
