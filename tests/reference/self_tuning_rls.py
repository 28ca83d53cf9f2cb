"""Recursive least squares as docs/methods/self-tuning.md ("Estimator") has it, dense, in double; written from the page, without the
firmware. Where the limit of the error stands when there is normalisation was open and has been compared with the firmware.

Used by self_tuning_reference.py, which writes the tables.
"""
import numpy as np


class Rls:
    """One regression. forgetting, correction: the words of the block's parameters."""

    def __init__(self, theta, p0, forgetting="constant", forget=1.0, least=0.2, memory=1.0, trace=1.0, correction="none",
                 rate=0.0, error_most=0.0, normalise=False, lo=None, hi=None):
        self.theta = np.array(theta, float)
        self.n = len(self.theta)
        self.P = np.eye(self.n) * p0
        self.forgetting, self.forget, self.least, self.memory, self.trace = forgetting, forget, least, memory, trace
        self.correction, self.rate, self.error_most, self.normalise = correction, rate, error_most, normalise
        self.lo = np.zeros(self.n) if lo is None else np.array(lo, float)
        self.hi = np.zeros(self.n) if hi is None else np.array(hi, float)
        self.v = 1.0
        self.sized, self.size_of_error, self.sizes = 0, 0.0, np.zeros(self.n)

    def outside(self):
        """f of Folami 8.50; no bound where hi is not above lo."""
        f = np.where(self.theta > self.hi, self.theta - self.hi, np.where(self.theta < self.lo, self.theta - self.lo, 0.0))
        return np.where(self.hi > self.lo, f, 0.0)

    def factor(self, e, told, phi):
        """v, from P before the measurement; told = phi'P phi."""
        tr = np.trace(self.P)
        if self.forgetting == "fortescue":
            v = 1 - (1 - told / (1 + told)) * e * e / self.memory
        elif self.forgetting == "ydstie":
            v = self.memory / (self.memory + e * e / (1 + told))
        elif self.forgetting == "ydstie_trace":
            self.sized = min(200, self.sized + 1)
            self.size_of_error += (e * e - self.size_of_error) / self.sized
            self.sizes += (phi * phi - self.sizes) / self.sized
            tr = float(np.diag(self.P) @ self.sizes)
            v = tr / (tr + self.n * ((1 - self.forget) / self.forget) ** 2 * e * e / self.size_of_error / (1 + told))
        elif self.forgetting == "bounded":  # what comes out is at most tr P/v, so v = tr P/trace is near enough to 1
            v = min(1.0, max(self.forget, tr / self.trace))
        else:
            return self.forget
        return max(v, self.least)

    def step(self, phi, y):
        """Error with the parameters of before, as it is measured (not normalised, not clipped)."""
        phi, P = np.array(phi, float), self.P
        raw = y - phi @ self.theta
        scale = max(1.0, np.max(np.abs(phi))) if self.normalise else 1.0
        e = float(np.clip(raw, -self.error_most, self.error_most)) if self.error_most else raw
        phi, e = phi / scale, e / scale  # the limit is one of the error in y, before it is normalised
        told = float(phi @ P @ phi)
        v, divisor = self.factor(e, told, phi), None
        pull = self.outside()
        if self.forgetting == "directional":
            P = self.forget_along(phi)
            alpha, divisor = 1 + phi @ P @ phi, 1.0
        elif self.forgetting == "held_trace":
            alpha = 1 + told
            divisor = np.trace(P - np.outer(P @ phi, P @ phi) / alpha) / self.trace
            v = divisor
        else:
            alpha, divisor = v + told, v
        gain = P @ phi / alpha
        change = gain * e
        if self.correction == "pc":
            change = change - self.rate * self.P @ pull
        elif self.correction == "spc":
            change = change - self.rate * pull
        self.theta = self.theta + change
        after = (P - np.outer(P @ phi, P @ phi) / alpha) / divisor
        self.P = (after + after.T) / 2
        if self.forgetting == "reset" and np.trace(self.P) < self.trace / 100:
            self.P = np.eye(self.n) * self.trace / self.n
        self.v = v
        return raw

    def forget_along(self, phi):
        """P before a measurement of the directional rule: grown along phi, its trace not past `trace`."""
        if not np.any(phi):
            return self.P
        grow = (1 - self.forget) / self.forget / float(phi @ np.linalg.solve(self.P, phi))
        room = max(0.0, self.trace - np.trace(self.P)) / float(phi @ phi)
        return self.P + min(grow, room) * np.outer(phi, phi)


def square_root_step(S, phi, v):
    """Folami A5.1 (P = S S', S upper triangular): S and K after one measurement."""
    n, s, before = len(phi), np.zeros(len(phi)), v
    new = np.zeros_like(S)
    for j in range(n):
        f = S[: j + 1, j] @ phi[: j + 1]
        after = before + f * f
        for i in range(j + 1):
            new[i, j] = np.sqrt(before) * (S[i, j] - f * s[i] / before) / np.sqrt(after * v)
            s[i] += S[i, j] * f
        before = after
    return new, s / before


def check_square_root(seed):
    """A5.1 and the dense form give the same P and K; returns the largest difference, relative to P."""
    random, worst = np.random.default_rng(seed), 0.0
    for n in (1, 3, 4, 6, 9, 12):
        S, dense = np.eye(n) * 3.0, np.eye(n) * 9.0
        for _ in range(100):
            phi, v = random.uniform(-1, 1, n), random.uniform(0.9, 1)
            alpha = v + phi @ dense @ phi
            gain = dense @ phi / alpha
            dense = (dense - np.outer(dense @ phi, dense @ phi) / alpha) / v
            S, K = square_root_step(S, phi, v)
            worst = max(worst, np.max(np.abs(S @ S.T - dense)) / np.max(np.abs(dense)), np.max(np.abs(K - gain)) / np.max(np.abs(gain)))
    return worst
