#!/usr/bin/env python3
"""Loss of a Kalman filter whose covariance is kept in a band (firmware/kinds/composition/covariance_band.h), beside the whole one.

    tests/reference/covariance_band_loss.py [--forms]

Both filters run for hours on the linear model of a column, with as much noise as they were told. Of each the covariance that its
errors really have is carried along, under the gains that it computes from its own; so nothing is drawn at random. Printed are, for each
fraction of the products, standard deviations with the banded gain over those with the best one: the largest ratio on the way
and the last; and what the banded form believes over what is. --forms: other ways to keep a band, and their results.

All in double precision and with full matrices: this is about what is left out, not about rounding. reflux-sim is needed for the tables.
"""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import composition_reference as reference

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
HOURS = 6.0
FIRST = 1e-2  # standard deviation of a fraction in the beginning
FEED = {"fraction": (0.02, 4.0), "flow": (0.03, 1.0)}  # standard deviation, hours of correlation


@dataclass
class Case:
    plant: str
    components: str | None
    stages: tuple[int, ...]  # thermometers, counted from 1
    step_s: float
    model: float  # noise of a fraction, in an hour
    noise_k: float = 0.2


CASES = (
    Case("splitter", "C3,iC4,nC4", (5, 30, 31, 33), 10.0, 0.1),
    Case("splitter", "C3,iC4,nC4", (5, 30, 31, 33), 10.0, 0.02),
    Case("splitter", "C3,iC4,nC4", (5, 30, 31, 33), 10.0, 0.005),
    Case("splitter", "C3,iC4,nC4", (5, 30, 31, 33), 2.0, 0.02),
    Case("splitter", "C3,iC4,nC4", (5, 30, 31, 33), 60.0, 0.02),
    Case("splitter", "C3,iC4,nC4", (5, 33), 10.0, 0.02),
    Case("splitter", "C3,iC4,nC4", (30,), 10.0, 0.02),
    Case("pilot", None, (2, 6), 10.0, 0.02),
    Case("pilot", None, (2, 3, 6, 11, 12), 10.0, 0.02),
    Case("methanol-water", None, (4, 12), 10.0, 0.02),
)


class Model:
    """x and extras of a case: the transition in its two sweeps, noise, slopes of the thermometers."""

    def __init__(self, case):
        command = [str(ROOT / "build/host/reflux-sim"), "--table", "--plant", case.plant]
        if case.components:
            command += ["--components", case.components]
        lines = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout.splitlines()
        self.table = reference.Table(lines)
        self.names = [part["name"] for part in self.table.file["components"]][:-1]
        estimator = reference.Estimator(self.table, [], case.step_s)
        s = estimator.look({})
        h, self.m, self.stages = case.step_s, estimator.free, estimator.n
        self.n = self.m * self.stages
        self.phi = np.linalg.inv(np.eye(self.n) - h * estimator.jacobian(s))
        self.down, self.up = self.sweeps(estimator, s, h)
        assert np.abs(self.up @ self.down - self.phi).max() < 1e-12
        self.push = h * self.feed_slopes(estimator, s)
        self.q = len(self.push)
        sd, hours = np.array([FEED["fraction"]] * self.m + [FEED["flow"]]).T
        self.keep = np.exp(-h / (3600 * hours))
        self.extras = sd**2
        self.grown = self.extras * (1 - self.keep**2)
        self.noise = np.full(self.n, case.model**2 * h / 3600)
        self.slopes = np.zeros((len(case.stages), self.n))
        for row, stage in zip(self.slopes, case.stages):
            row[(stage - 1) * self.m : stage * self.m] = s.dt[stage - 1]
        self.variance = case.noise_k**2
        stage_of = np.arange(self.n) // self.m
        self.apart = np.abs(stage_of[:, None] - stage_of)

    def sweeps(self, estimator, s, h):
        """The factors of firmware/model/column_transition.h, as matrices: elimination from the condenser down, and back."""
        n, m = self.stages, self.m
        each, one = estimator.efficiencies(s), np.eye(m)
        first, ratio = [None] * n, [None] * n
        liquid = [max(s.down[i + 1], 0.0) if i < n - 1 else 0.0 for i in range(n)]
        for i in reversed(range(n)):
            gathers, rises = s.moles[i] / h, s.up[i - 1] if i else 0.0
            own = gathers + liquid[i] + rises - s.up[i] + (s.feed if i == estimator.column.feed else 0.0)
            leaves = s.up[i] * one - (liquid[i] * ratio[i + 1] if i < n - 1 else 0.0)
            inverse = np.linalg.inv(own * one + each[i] * leaves @ s.dy[i])
            first[i], liquid[i] = inverse * gathers, liquid[i] / gathers
            ratio[i] = inverse @ (rises * one - (1 - each[i]) * leaves)
        down, up, vapour = np.zeros((n * m, n * m)), np.eye(n * m), np.zeros((m, n * m))
        for i in reversed(range(n)):
            rows = slice(i * m, i * m + m)
            down[rows, rows] = one
            if i < n - 1:
                down[rows] += liquid[i] * down[(i + 1) * m : (i + 2) * m]
            down[rows] = first[i] @ down[rows]
        for i in range(n):
            rows = slice(i * m, i * m + m)
            up[rows] += ratio[i] @ vapour
            vapour = (1 - each[i]) * vapour + each[i] * s.dy[i] @ up[rows]
        return down, up

    def feed_slopes(self, estimator, s):
        slopes = np.zeros((self.m + 1, self.n))
        feed, part = estimator.column.feed, 1e-4
        for j in range(self.m):
            slopes[j, feed * self.m + j] = s.feed / s.moles[feed]
        nominal = self.table.nominal
        sides = [
            estimator.column.evaluate(estimator.x.ravel(), nominal | {"feed": nominal["feed"] * (1 + side)}).rates
            for side in (part, -part)
        ]
        slopes[self.m] = (sides[0] - sides[1]) / (2 * part)
        return slopes

    def whole(self):
        """Transition, noise and slopes of x and extras together."""
        size = self.n + self.q
        a, h = np.zeros((size, size)), np.zeros((len(self.slopes), size))
        a[: self.n, : self.n], a[: self.n, self.n :] = self.phi, self.phi @ self.push.T
        a[self.n :, self.n :] = np.diag(self.keep)
        h[:, : self.n] = self.slopes
        return a, np.diag(np.r_[self.noise, self.grown]), h


def complete(model, s, width):
    """Completes the band: entries beyond it follow from those in it."""
    m, s = model.m, s * (model.apart <= width)
    for t in range(width + 1, model.stages):
        known, column, rows = slice((t - width) * m, t * m), slice(t * m, (t + 1) * m), slice(0, (t - width) * m)
        s[rows, column] = s[rows, known] @ np.linalg.solve(s[known, known], s[known, column])
        s[column, rows] = s[rows, column].T
    return s


def cut(model, s, width):
    return s * (model.apart <= width)


def taper(model, s, width):
    return s * np.maximum(0.0, 1 - model.apart / (width + 1))


class Whole:
    def __init__(self, model):
        self.model = model
        self.a, self.q, self.h = model.whole()
        self.p = np.diag(np.r_[np.full(model.n, FIRST**2), model.extras])

    def step(self):
        self.p = self.a @ self.p @ self.a.T + self.q
        gains = []
        for h in self.h:
            g = self.p @ h
            alpha = h @ g + self.model.variance
            gains.append(g / alpha)
            self.p = self.p - np.outer(g, g) / alpha
        return gains


class Arrow(Whole):
    """Covariances of the fractions in a band, 0 beyond; those with extras whole."""

    def __init__(self, model, width, forget):
        super().__init__(model)
        self.forget = lambda p: np.block(
            [[forget(model, p[: model.n, : model.n], width), p[: model.n, model.n :]], [p[model.n :]]]
        )

    def step(self):
        n, model = self.model.n, self.model
        sweep = [np.eye(n + model.q) for _ in range(3)]
        sweep[0][:n, n:], sweep[0][n:, n:] = model.push.T, np.diag(model.keep)
        sweep[1][:n, :n], sweep[2][:n, :n] = model.down, model.up
        for matrix in sweep:
            self.p = self.forget(matrix @ self.p @ matrix.T)
        self.p = self.p + self.q
        gains = []
        for h in self.h:
            g = self.p @ h
            alpha = h @ g + model.variance
            gains.append(g / alpha)
            self.p = self.forget(self.p - np.outer(g, g) / alpha)
        return gains


class Band:
    """x = M t + e; the covariance S of e in a band."""

    def __init__(self, model, width, forget):
        self.model, self.forget = model, lambda s: forget(model, s, width)
        self.s, self.by = np.eye(model.n) * FIRST**2, np.zeros((model.n, model.q))
        self.t = np.diag(model.extras)

    @property
    def p(self):
        cross = self.by @ self.t
        return np.block([[self.s + cross @ self.by.T, cross], [cross.T, self.t]])

    def step(self):
        model = self.model
        said = self.by + model.push.T
        t = self.t * np.outer(model.keep, model.keep) + np.diag(model.grown)
        old = self.t * model.keep @ np.linalg.inv(t)  # the extras of before, by those of now
        self.s = self.forget(self.s + said @ (self.t - old @ t @ old.T) @ said.T)
        self.s = self.forget(model.down @ self.s @ model.down.T)
        self.s = self.forget(model.up @ self.s @ model.up.T + np.diag(model.noise))
        self.t, self.by = t, model.phi @ said @ old
        gains = []
        for h in model.slopes:
            g, f = self.s @ h, self.by.T @ h
            told, bound = self.t @ f, h @ g + model.variance
            alpha = bound + f @ told
            gains.append(np.r_[g + self.by @ told, told] / alpha)
            self.s, self.by = self.s - np.outer(g, g) / bound, self.by - np.outer(g, f) / bound
            self.t = self.t - np.outer(told, told) / alpha
        self.s = self.forget(self.s)  # what is completed stays so
        return gains


class Truth:
    """The covariance that the errors have under some gains."""

    def __init__(self, model):
        self.a, self.q, self.h = model.whole()
        self.variance = model.variance
        self.p = np.diag(np.r_[np.full(model.n, FIRST**2), model.extras])

    def step(self, gains):
        self.p = self.a @ self.p @ self.a.T + self.q
        for gain, h in zip(gains, self.h):
            g = self.p @ h
            self.p = self.p - np.outer(gain, g) - np.outer(g, gain)
            self.p += np.outer(gain, gain) * (h @ g + self.variance)
        return np.sqrt(np.diag(self.p))


def compare(case, model, form):
    """Rows of (largest ratio, last ratio, believed over actual) of each product's fractions; None: no number any more."""
    best, actual = Whole(model), Truth(model)
    most, products = 0.0, np.r_[np.arange(model.m), np.arange(model.n - model.m, model.n)]
    for _ in range(round(HOURS * 3600 / case.step_s)):
        best.step()
        with np.errstate(all="ignore"):
            is_now = actual.step(form.step())
        if not np.isfinite(is_now).all() or is_now.max() > 1e3 or np.diag(form.p).min() < 0:
            return None
        ratio = is_now / np.sqrt(np.diag(best.p))
        most = np.maximum(most, ratio)
    believed = np.sqrt(np.diag(form.p)) / is_now
    sd = np.sqrt(np.diag(best.p))
    return [(sd[i], most[i], ratio[i], believed[i]) for i in products], most[: model.n].max(), most[model.n :].max()


def row(case, model, what, found):
    where = ", ".join(map(str, case.stages))
    head = f"| {case.plant} | {where} | {case.step_s:g} | {case.model:g} | {what} |"
    if found is None:
        return head + " a variance below 0, or no number | | |"
    names = [f"{name} bottom" for name in model.names] + [f"{name} top" for name in model.names]
    products, fraction, extra = found
    cells = "; ".join(
        f"{name} {sd:.4f}: {most:.3f}, {last:.3f}, {believed:.2f}" for name, (sd, most, last, believed) in zip(names, products)
    )
    return f"{head} {cells} | {fraction:.2f} | {extra:.2f} |"


def main():
    forms = [("neighbours, completed", Band, 1, complete)]
    cases = CASES
    if "--forms" in sys.argv[1:]:
        cases = CASES[:3]
        forms += [(f"band of {w}, completed", Band, w, complete) for w in (2, 3)]
        forms += [(f"M, band of {w}, 0 beyond", Band, w, cut) for w in (1, 2, 3, 5, 8)]
        forms += [(f"M, band of {w}, tapered", Band, w, taper) for w in (1, 2, 3, 5, 8)]
        forms += [(f"P, band of {w}, 0 beyond", Arrow, w, cut) for w in (1, 2, 3, 5, 8)]
        forms += [(f"P, band of {w}, tapered", Arrow, w, taper) for w in (1, 2, 3, 5, 8)]
    print("| column | thermometers | step, s | noise in an hour | form | sd of the best: most, last ratio, believed | any fraction | any extra |")
    print("|---|---|---|---|---|---|---|---|")
    for case in cases:
        model = Model(case)
        for what, kind, width, forget in forms:
            print(row(case, model, what, compare(case, model, kind(model, width, forget))), flush=True)


if __name__ == "__main__":
    main()
