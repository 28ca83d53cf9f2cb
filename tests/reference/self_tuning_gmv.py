"""Regressions and laws of a self-tuner as docs/methods/self-tuning.md ("Model", "Control laws") has them, in double; written from the
page. The firmware was read afterwards, for one thing that the page left open: the order in which MVs are put to their limits.
Everything has been at rest at 0 before the first step: a signal of the past is 0.

Used by self_tuning_reference.py, which writes the tables.
"""
import numpy as np

from self_tuning_rls import Rls

INTERVAL = 30.0


class Signal(dict):
    """By the step; 0 where nothing is known."""

    def __missing__(self, t):
        return 0.0


def pole(tau):
    return np.exp(-INTERVAL / tau) if tau > 0 else 0.0


class Gmv:
    """s: a case's settings (a dict); theta: start values, a list for each loop."""

    def __init__(self, s, theta):
        self.s, self.loops, self.t = s, s["loops"], 0
        self.y, self.w, self.u = ([Signal() for _ in range(2)] for _ in range(3))
        self.load, self.m, self.guess = Signal(), [Signal(), Signal()], [Signal(), Signal()]
        self.p, self.r = pole(s["tau_p"]), pole(s["tau_r"])
        self.rls = [Rls(theta[i], s["p0"], forget=s["forget"]) for i in range(self.loops)]
        self.filtered, self.error = [0.0, 0.0], [0.0, 0.0]

    def horizon(self, i):
        return 1 if self.s["way"] else self.s["delay"][i][i]

    def taken(self, x, t, k):
        return x[t] - x[t - k] if self.s["form"] else x[t]

    def weighted(self, i, t):
        """P y, or y itself where the regression is the explicit one."""
        p = 0.0 if self.s["way"] else self.p
        return (self.y[i][t] - p * self.y[i][t - 1]) / (1 - p)

    def target(self, i, t):
        k = self.horizon(i)
        return self.weighted(i, t) - (self.weighted(i, t - k) if self.s["form"] else 0.0)

    def order(self, i):
        """MVs in loop i's model, itself first."""
        return [j for j in (i, 1 - i) if j < self.loops and self.s["delay"][i][j]]

    def phi(self, i, t):
        s, k = self.s, self.horizon(i)
        row = [self.taken(self.y[i], t - a, k) for a in range(s["na"])]
        for j in self.order(i):
            row += [self.taken(self.u[j], t - (s["delay"][i][j] - k) - b, k) for b in range(s["nb"])]
        if s["loads"]:
            row.append(self.taken(self.load, t - s["load_delay"], k))
        row += [self.guess[i][t + k - c] for c in range(1, s["nc"] + 1)]
        if not s["form"] and s["bias"] != 2:
            row.append(1.0 if s["bias"] == 0 else self.m[i][t])
        return np.array(row)

    def learn(self, i, mask):
        k, steps = self.horizon(i), range(self.s["average"])
        phi = np.mean([self.phi(i, self.t - k - n) for n in steps], axis=0)
        y = float(np.mean([self.target(i, self.t - n) for n in steps]))
        error = self.rls[i].step(phi, y) if mask else y - phi @ self.rls[i].theta
        self.m[i][self.t] = self.m[i][self.t - 1] + 0.8 * error
        self.error[i] = error

    def law(self, i):
        """Coefficients of u_1(t), u_2(t), and what they have to add up to."""
        s, t, k = self.s, self.t, self.s["delay"][i][i]
        f, g, rest = self.explicit(i) if s["way"] else self.implicit(i)
        left, right = np.zeros(2), self.filtered[i] - rest
        if s["form"]:
            right -= (self.y[i][t] - self.p * self.y[i][t - 1]) / (1 - self.p)
        if s["bias"] == 3:
            right += self.error[i]
        right -= sum(c * self.taken(self.y[i], t - a, k) for a, c in enumerate(f))
        for j in self.order(i):
            for b, c in enumerate(g[j]):
                at = t - (s["delay"][i][j] - k) - b
                if at < t:
                    right -= c * self.taken(self.u[j], at, k)
                    continue
                left[j] += c
                right += c * self.u[j][t - k] if s["form"] else 0.0
        weight = s["lambda"][i]
        left[i] += weight
        if s["weight"] == 0:
            right += weight * self.u[i][t - 1]
        elif s["form"]:
            right += weight * self.u[i][t - k]
        return left, right

    def implicit(self, i):
        s, theta = self.s, self.rls[i].theta
        g, at = {}, s["na"]
        for j in self.order(i):
            g[j], at = theta[at: at + s["nb"]], at + s["nb"]
        return theta[: s["na"]], g, float(theta[at:] @ self.phi(i, self.t)[at:])

    def explicit(self, i):
        """P = E A + z^-k F by long division; G_ij = E B_ij; d = E(1) d."""
        s, theta, k = self.s, self.rls[i].theta, self.s["delay"][i][i]
        a = np.concatenate([[1.0], -theta[: s["na"]]])
        rest = np.zeros(k + s["na"] + 2)
        rest[:2] = np.array([1.0, -self.p]) / (1 - self.p)
        e = np.zeros(k)
        for n in range(k):
            e[n] = rest[n]
            rest[n: n + len(a)] -= e[n] * a
        g, at = {}, s["na"]
        for j in self.order(i):
            g[j], at = np.convolve(e, theta[at: at + s["nb"]]), at + s["nb"]
        return rest[k:], g, float(np.sum(e) * (theta[at:] @ self.phi(i, self.t)[at:]))

    def solve(self, acting, fixed, lo, hi):
        """u of every loop, and whether the determinant made them be solved one by one."""
        rows = [self.law(i) for i in range(self.loops)]
        u, alone = np.array(fixed, float), 0
        free = [i for i in range(self.loops) if acting >> i & 1]
        while free:
            alone |= self.solve_free(rows, free, u)
            beyond = {i: max(u[i] - hi[i], lo[i] - u[i]) for i in free}
            worst = max(free, key=beyond.get)
            if beyond[worst] <= 0:
                break
            u[worst] = min(max(u[worst], lo[worst]), hi[worst])
            free = [i for i in free if i != worst]
        return u, alone

    def solve_free(self, rows, free, u):
        """u of those in `free`, the others' as they are in it. 1: one by one."""
        held = [j for j in range(2) if j not in free]
        A = np.array([rows[i][0][free] for i in free])
        b = np.array([rows[i][1] - rows[i][0][held] @ u[held] for i in free])
        scaled = A / np.max(np.abs(A), axis=1, keepdims=True)
        if len(free) == 1 or abs(np.linalg.det(scaled)) >= 0.01:
            u[free] = np.linalg.solve(A, b)
            return 0
        for i in free:
            u[i] = (rows[i][1] - rows[i][0][1 - i] * self.u[1 - i][self.t - 1]) / rows[i][0][i]
        return 1

    def take(self, y, w, load):
        for i in range(self.loops):
            self.y[i][self.t], self.w[i][self.t] = y[i], w[i]
            if self.s["tau_r"] < 0:
                self.filtered[i] = (w[i] - self.p * self.w[i][self.t - 1]) / (1 - self.p)
            else:
                self.filtered[i] = self.r * self.filtered[i] + (1 - self.r) * w[i]
        self.load[self.t] = load

    def applied(self, u):
        """u(t) is known; so is what the model says of the time a horizon ahead."""
        for j in range(self.loops):
            self.u[j][self.t] = u[j]
        for i in range(self.loops):
            self.guess[i][self.t + self.horizon(i)] = float(self.phi(i, self.t) @ self.rls[i].theta)
        self.t += 1
