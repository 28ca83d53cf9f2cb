"""Decoupling by state feedback on the nonlinear model of a column, in numpy: the form that holds the pilot column, beside the linear one of
1989 (Folami, PhD thesis, Aston, chapter 6). Ours; tools/research/state_study.py plays it against the simulated plant.

The linear law in discrete time asks that y(k + 1) be M0 y(k) + K* w(k), K* = I - M0, and finds u by what a model fixed at one point says
of y(k + 1). Here the model is the column's own equations (columns_reference, numbers of the compact table that the board has), carried
one interval on from where the column is now, and B* = C times the integral of its Jacobian's transition times its slopes by the inputs, found
at each tick anew. What the last prediction missed is added to the next one, a part of it a tick: the integral. An input at its limit
leaves its loop to the other one's best.
"""

import argparse

import kalman_1989
from composition_reference import Table  # before numpy

import numpy as np
from scipy.linalg import expm

KELVIN, TINY = 273.15, 1e-30


class Model:
    """scale: SI per unit of the plant's inputs, in their order; what: their names in the table."""

    def __init__(self, lines, h, what, scale, feed_scale, rows):
        self.table = Table(lines)
        none = argparse.Namespace(method="ekf", step="exact", gains=1.0, noise=0.05, model=0.1, feed_z=0.0, feed_f=0.0)
        self.filter = kalman_1989.Filter(self.table, h, none)
        self.column, self.n, self.h = self.filter.model.column, self.filter.n, h
        self.what, self.scale, self.feed_scale, self.rows = what, scale, feed_scale, rows

    @property
    def profile(self):
        return self.filter.x0.copy()

    def driven(self, u, feed):
        told = {name: value * s for name, value, s in zip(self.what, u, self.scale)}
        return self.table.nominal | told | {"feed": feed * self.feed_scale}

    def look(self, x, u, feed, z):
        """Jacobian and slopes by the inputs, temperatures (K) and their slopes."""
        values = self.driven(u, feed)
        _, a, _, t, slope = self.filter.look(x, values, z)
        b = np.zeros((self.n, len(u)))
        for j, (name, s) in enumerate(zip(self.what, self.scale)):
            moved = values | {name: values[name] + 1j * TINY * s}
            b[:, j] = self.column.evaluate(x + 0j, moved, guess=t).rates.imag / TINY
        return a, b, t, slope

    def integral(self, a, h):
        both = np.zeros((2 * self.n, 2 * self.n))
        both[: self.n, : self.n], both[: self.n, self.n :] = a, np.eye(self.n)
        return expm(both * h)[: self.n, self.n :]

    def ahead(self, x, u, feed, z, over, t, parts):
        """State and temperatures an interval later: exponential Euler in parts, with the Jacobian of its beginning."""
        values = self.driven(u, feed)
        self.filter.tell_feed(z)
        for _ in range(parts):
            s = self.column.evaluate(x + 0j, values, guess=t)
            t = s.t.real
            x = np.clip(x + over @ s.rates.real, TINY, 1.0)
        t = self.column.evaluate(x + 0j, values, guess=t).t.real
        return x, t


class Ahead:
    """u from a state and w. pole: by loop, in z; keep: part of a miss that is added a tick; weight: by input, on its moves."""

    PARTS, PASSES = 3, 2

    def __init__(self, model, pole, keep, lo, hi, weight=0.0):
        self.m, self.pole, self.keep, self.lo, self.hi = model, np.asarray(pole), keep, lo, hi
        self.weight = np.full(len(lo), float(weight))
        self.missed = np.zeros(len(model.rows))
        self.said = None

    def best(self, e, m, u, asked):
        """Holds each input in turn at a limit; the other does what is left."""
        held = np.clip(asked, self.lo, self.hi)
        if np.array_equal(held, asked):
            return asked
        found = None
        for j in range(2):
            o = 1 - j
            rest, column = e - m[:, j] * (held[j] - u[j]), m[:, o]
            size = column @ column
            other = u[o] + (column @ rest / size if size > 0 else 0.0)
            tried = held.copy()
            tried[o] = np.clip(other, self.lo[o], self.hi[o])
            cost = np.sum((e - m @ (tried - u)) ** 2)
            if found is None or cost < found[0]:
                found = (cost, tried)
        return found[1]

    def step(self, x, feed, z, y, w, u):
        """y: measured, of the controlled outputs. Returns the inputs until the next tick."""
        a, b, t, slope = self.m.look(x, u, feed, z)
        rows = self.m.rows
        if self.said is not None:
            self.missed = self.missed + self.keep * (y - self.said)
        now = t[rows] - KELVIN
        asked = now + (1.0 - self.pole) * (w - now)
        over = self.m.integral(a, self.m.h / self.PARTS)
        b_star = slope[rows, None] * (self.m.integral(a, self.m.h) @ b)[rows]
        first = u.copy()
        for _ in range(self.PASSES):
            e = asked - self.missed - (self.m.ahead(x, u, feed, z, over, t, self.PARTS)[1][rows] - KELVIN)
            square = b_star.T @ b_star + np.diag(self.weight) + 1e-12 * np.eye(2)
            move = np.linalg.solve(square, b_star.T @ e - self.weight * (u - first))
            u = self.best(e, b_star, u, u + move)
        self.said = self.m.ahead(x, u, feed, z, over, t, self.PARTS)[1][rows] - KELVIN + self.missed
        return u


class Estimator:
    """States, feed flow and composition by the extended filter with disturbance states, from thermometers (degC) at `stages`."""

    def __init__(self, model, stages, noise, feed_z=0.1, feed_f=0.2):
        chosen = argparse.Namespace(method="ekf", step="exact", gains=1.0, noise=noise, model=0.1, feed_z=feed_z, feed_f=feed_f)
        self.f = kalman_1989.Filter(model.table, model.h, chosen)
        self.f.rows = np.array([s - 1 for s in stages])
        self.model = model

    def step(self, u, readings):
        nominal = self.model.table.nominal
        told = {name: value * s for name, value, s in zip(self.model.what, u, self.model.scale)}
        self.f.step(told | {"feed": nominal["feed"]}, self.f.known, np.asarray(readings) + KELVIN)
        feed = nominal["feed"] * (1.0 + self.f.extras[1]) / self.model.feed_scale
        return np.clip(self.f.x, TINY, 1.0).copy(), feed, float(np.clip(self.f.known + self.f.extras[0], 0.0, 1.0))
