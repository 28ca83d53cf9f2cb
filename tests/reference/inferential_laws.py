"""The controllers of docs/methods/inferential.md in double, written from the page alone, and the model plants they are for.

Units: hours, EU, and u counted from the lower end of the MV's span. Used by inferential_checks.py and inferential_reference.py.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

HOLD, CONVENTIONAL, CASCADE, CLF = range(4)
EULER, JOINT = range(2)


def transition_rate(law, kc, kc2, r):
    """d/dt of (y1, e2) while the loads are known, (4.28) and (4.57)."""
    if law == CONVENTIONAL:
        return np.array([[-kc, 0.0], [0.0, 0.0]])
    if law == CASCADE:
        return np.array([[-kc, -kc2 * r], [0.0, -kc2]])
    return np.array([[-kc - kc2 * r * r, -kc2 * r], [-kc2 * r, -kc2]])


class Loop:
    """One loop in steps of h hours. hi: span of the MV. ko2: only the algebra of Frau's general forms needs another."""

    def __init__(self, law, form, h, a, kc, kc2, ko, hi=np.inf, lo=0.0, ko2=None):
        self.law, self.form, self.h, self.lo, self.hi = law, form, h, lo, hi
        self.a1, self.a2 = a
        self.kc, self.kc2, self.ko = kc, kc2, ko
        self.ko2 = ko if ko2 is None else ko2
        if form == JOINT:
            self.ko = self.ko2 = -np.expm1(-ko * h) / h
            self.e = expm(transition_rate(law, kc, kc2, self.a1 / self.a2) * h)
        self.x1 = self.x2 = self.t2s = 0.0

    def rest(self, t1, t2, u):
        """Everything has stood still for long: the loads are what u makes up for."""
        self.x1, self.x2, self.t2s = -self.a1 * u - self.ko * t1, -self.a2 * u - self.ko2 * t2, t2

    def actions(self, y1, e2):
        """Primary and secondary action."""
        if self.form == JOINT:
            e = self.e
            ut = 0.0 if self.law == CONVENTIONAL else (e[1, 0] * y1 + (e[1, 1] - 1) * e2) / (self.h * self.a2)
            up = (-self.b1 - ((1 - e[0, 0]) * y1 - e[0, 1] * e2) / self.h) / self.a1 - ut
            return up, ut
        up = -(self.kc * y1 + self.b1) / self.a1
        if self.law == CONVENTIONAL:
            return up, 0.0
        cross = self.a1 * y1 / self.a2**2 if self.law == CLF else 0.0
        return up, -self.kc2 * (e2 / self.a2 + cross)

    def step(self, t1, t2, setpoint):
        """u before it is limited."""
        self.t1, self.t2, self.y1, self.e2 = t1, t2, t1 - setpoint, t2 - self.t2s
        self.b1, self.b2 = self.x1 + self.ko * t1, self.x2 + self.ko2 * t2
        self.up, self.ut = self.actions(self.y1, self.e2)
        self.u = self.up + self.ut
        return self.u

    def effective(self, us):
        """u* as far as the MV goes."""
        up = min(self.up, us) if us < self.u else max(self.up, us) if us > self.u else self.up
        return min(max(up, self.lo), self.hi)

    def took_effect(self, us):
        """All states with the values of the sample."""
        self.t2s += self.h * (self.a2 * self.effective(us) + self.b2)
        self.x1 -= self.h * self.ko * (self.x1 + self.a1 * us + self.ko * self.t1)
        self.x2 -= self.h * self.ko2 * (self.x2 + self.a2 * us + self.ko2 * self.t2)


def continuous(loop, t, b, limits=(-np.inf, np.inf), setpoint=0.0, x0=None, observer_knows=True):
    """Courses (t1, t2, x1, x2, t2s, u) of plant and controller without steps, at the times t. b: loads of both temperatures, which
    stand still. The limits hold for u and for u*."""

    def outputs(x):
        c = Loop(loop.law, EULER, 1.0, (loop.a1, loop.a2), loop.kc, loop.kc2, loop.ko, limits[1], limits[0], loop.ko2)
        c.x1, c.x2, c.t2s = x[2:5]
        c.step(x[0], x[1], setpoint)
        return c, min(max(c.u, limits[0]), limits[1])

    def rate(_, x):
        c, us = outputs(x)
        before = np.array([c.x1, c.x2, c.t2s])
        c.took_effect(us if observer_knows else c.u)
        return [c.a1 * us + b[0], c.a2 * us + b[1], *(np.array([c.x1, c.x2, c.t2s]) - before)]

    x = solve_ivp(
        rate,
        (0, t[-1]),
        np.zeros(5) if x0 is None else x0,
        method="DOP853",
        t_eval=t,
        rtol=1e-11,
        atol=1e-13,
        max_step=0.01 if np.isfinite(limits[1]) else np.inf,
    ).y.T
    return np.column_stack([x, [outputs(row)[1] for row in x]])


def stepped(loop, steps, b, limits=(-np.inf, np.inf), setpoint=0.0, t=(0.0, 0.0), observer_knows=True):
    """Courses (t1, t2, e2, u) at each sample with the plant integrated exactly; b: a function of the step."""
    rows, t = [], list(t)
    for k in range(steps):
        u = loop.step(t[0], t[1], setpoint)
        us = min(max(u, limits[0]), limits[1])
        rows.append((t[0], t[1], loop.e2, us))
        loop.took_effect(us if observer_knows else u)
        for i, a in enumerate((loop.a1, loop.a2)):
            t[i] += loop.h * (a * us + b(k)[i])
    return np.array(rows)
