"""Plants whose elements have one or two lags and a zero, with sampled PI loops, in double and without the firmware's own
way of splitting an element into lags. Used by shapes_reference.py and robust_reference.py; shape_reference.py takes exponential().

An element is (K, L, T, q, z): K (z s + 1) e^{-L s} / (q s^2 + T s + 1). Inputs are held between samples; the element is a
state space that is stepped with its matrix exponential.
"""
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


def one_lag(gain, dead, lag):
    """An element of one lag."""
    return (gain, dead, lag, 0.0, 0.0)


def write(script, name, head, columns, rows):
    """A table of references beside the scripts, with the name of the one that made it."""
    with open(HERE / name, "w") as f:
        f.write(f"# {head}\n# made by tests/reference/{Path(script).name}\n{columns}\n")
        for row in rows:
            f.write(",".join(f"{float(x):.12g}" for x in row) + "\n")


def exponential(a):
    """Matrix exponential by scaling, Taylor series and squaring."""
    halvings = max(0, int(np.ceil(np.log2(max(np.abs(a).sum(axis=1).max(), 1e-300)))) + 6)
    a = a / 2.0 ** halvings
    total, term = np.eye(len(a)), np.eye(len(a))
    for k in range(1, 14):
        term = term @ a / k
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return total


class Element:
    def __init__(self, gain, dead, lag, square, zero, h):
        self.whole = int(np.floor(dead / h + 1e-12))
        fraction = min(max(dead / h - self.whole, 0.0), 1.0)
        self.direct = 0.0
        if square > 0.0:
            A, B = np.array([[0.0, 1.0], [-1.0 / square, -lag / square]]), np.array([0.0, 1.0 / square])
            self.C = gain * np.array([1.0, zero])
        else:
            lag = max(lag, 1e-3 * h)
            A, B = np.array([[-1.0 / lag]]), np.array([1.0 / lag])
            self.C = gain * np.array([1.0 - zero / lag])
            self.direct = gain * zero / lag
        n = len(A)
        both = np.zeros((n + 1, n + 1))
        both[:n, :n], both[:n, n] = A, B
        e, late = exponential(both * h), exponential(both * h * (1.0 - fraction))
        self.A, self.new = e[:n, :n], late[:n, n]
        self.old = e[:n, n] - self.new

    def response(self, z):
        eye = np.eye(len(self.A))
        x = np.linalg.solve(z * eye - self.A, self.new + self.old / z)
        return (self.C @ x + self.direct / z) * z ** -self.whole


class Loops:
    """elements[i][j] = (K, L, T, q, z) or None, square; loop k holds output k with input k. gain: signed."""

    def __init__(self, elements, h, gain, ti, decoupler=None):
        self.n, self.h = len(elements), h
        self.gain, self.ti = np.array(gain, float), np.array(ti, float)
        self.D = np.eye(self.n) if decoupler is None else np.array(decoupler, float)
        self.parts = [(i, j, Element(*elements[i][j], h)) for i in range(self.n) for j in range(self.n)
                      if elements[i][j] and elements[i][j][0] != 0.0]
        self.length = 2 + max(e.whole for _, _, e in self.parts)
        self.order = sum(len(e.A) for _, _, e in self.parts) + self.n * self.length + self.n

    def plant(self, w):
        z, G = np.exp(1j * w * self.h), np.zeros((self.n, self.n), complex)
        for i, j, e in self.parts:
            G[i, j] = e.response(z)
        return G

    def controllers(self, w, gain=None, ti=None):
        gain, ti = self.gain if gain is None else gain, self.ti if ti is None else ti
        return gain * (1.0 + self.h / ti / (np.exp(1j * w * self.h) - 1.0))

    def step(self, s, setpoint, load):
        """One sample of the states side by side in the columns of s."""
        at, x = 0, []
        for _, _, e in self.parts:
            x.append(s[at:at + len(e.A)])
            at += len(e.A)
        past = s[at:at + self.n * self.length].reshape((self.length, self.n) + s.shape[1:])
        integral = s[at + self.n * self.length:]
        k = self.gain.reshape((-1,) + (1,) * (s.ndim - 1))
        error = setpoint - self.outputs(x, past)
        v = k * error + integral
        integral = integral + k * self.h / self.ti.reshape(k.shape) * error
        u = np.tensordot(self.D, v, 1) + load
        past = np.concatenate([u[None], past[:-1]])
        for m, (_, j, e) in enumerate(self.parts):
            x[m] = (np.tensordot(e.A, x[m], 1) + np.multiply.outer(e.new, past[e.whole][j]) +
                    np.multiply.outer(e.old, past[e.whole + 1][j]))
        return np.concatenate([*x, past.reshape((-1,) + s.shape[1:]), integral])

    def outputs(self, x, past):
        y = np.zeros((self.n,) + past.shape[2:])
        for (i, j, e), state in zip(self.parts, x):
            y[i] += np.tensordot(e.C, state, 1) + e.direct * past[e.whole][j]
        return y

    def radius(self):
        """Largest |eigenvalue| of the closed loop; below 1: stable."""
        zero = np.zeros((self.n, 1))
        return np.abs(np.linalg.eigvals(self.step(np.eye(self.order), zero, zero))).max()

    def simulate(self, steps, setpoint, load):
        """Outputs after each sample. load: at the inputs."""
        s, y = np.zeros(self.order), np.zeros((steps, self.n))
        for k in range(steps):
            s = self.step(s, np.array(setpoint, float), np.array(load, float))
            at, x = 0, []
            for _, _, e in self.parts:
                x.append(s[at:at + len(e.A)])
                at += len(e.A)
            y[k] = self.outputs(x, s[at:at + self.n * self.length].reshape(self.length, self.n))
        return y

    def sensitivities(self, w, gain=None, ti=None):
        """|S_kk| and |T_kk| at w, S = (I + G D C)^-1."""
        open_loop = self.plant(w) @ self.D * self.controllers(w, gain, ti)[None, :]
        s = np.diag(np.linalg.inv(np.eye(self.n) + open_loop))
        return np.abs(s), np.abs(1.0 - s)
