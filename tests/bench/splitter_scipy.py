#!/usr/bin/python3
"""A day of the splitter by scipy's BDF beside the same day by the simulated plant, in one run on one machine.

    tests/bench/splitter_scipy.py PLANT_COST [MINUTES]

PLANT_COST is the built program of tests/bench/plant_cost.c, which says what the inputs are and when they change (every
MINUTES) and what temperatures and time the plant came to. scipy gets the balances of tests/reference/splitter_reference.py,
independent of the C sources, written for many states at once: no Python loop over components or states, bubble points by
Newton from the last ones, and a Jacobian of differences from one call. It starts afresh at every change.

Both are compared with a tight run. scipy's tolerance is the loosest of a row with which its largest error is no larger than
the plant's: so both times buy the same accuracy.
"""
import os
import subprocess
import sys
import time

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # a second thread only costs, on matrices of 185
import numpy as np  # noqa: E402
from scipy.integrate import solve_ivp  # noqa: E402

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "reference"))
import splitter_reference as reference  # noqa: E402

OURS = 3e-6  # the plant's own relative tolerance; absolute ones are a hundredth of the relative, here and there
TIGHT = 1e-9
ROW = (2e-5, 1.3e-5, 9e-6, 7e-6, 5.4e-6, 4.2e-6, 3.3e-6, 2.5e-6, 1.5e-6, 7e-7, 3e-7)  # each tighter than the one before


class Batched:
    """The right-hand side of reference.COLUMN over many states at once: x is states by runs, as solve_ivp has them."""

    def __init__(self, column):
        self.c, self.m = column, column.m
        self.t = None  # where bubble points are looked for
        volume = self.m.mass / (self.m.rho0 + self.m.rho1 * column.hold_t[:, None])
        self.volume = volume[None]  # runs, stages, components
        self.fraction = 1 - np.arange(column.n) / (column.n - 1)

    def bubbles(self, x, pressure):
        m = self.m
        t = np.full(x.shape[:2], 340.0) if self.t is None else np.broadcast_to(self.t, x.shape[:2]).copy()
        for _ in range(50):
            p = x * m.pressures(t)
            total = p.sum(axis=2)
            warm = t[..., None]
            slope = (p * (m.c2 / warm**2 + m.c3 / warm + m.c4 * m.c5 * warm ** (m.c5 - 1))).sum(axis=2) / total
            step = np.log(pressure / total) / slope
            t += np.clip(step, -20.0, 20.0)
            if np.max(np.abs(step)) < 1e-10:
                break
        return t

    def begin_from(self, x, u):
        """Bubble points of this state are where the next are looked for: the same for every state, so that a state always
        has the same rates."""
        self.t = None
        self.t = self(x, u)[1][0]

    def __call__(self, flat, u):
        """dx/dt for flat of (states,) or (states, runs), and the temperatures."""
        c, m, n, nf = self.c, self.m, self.c.n, self.c.feed_stage
        states = np.atleast_2d(flat.T)
        part = states.reshape(len(states), n, -1)
        x = np.concatenate([part, 1 - part.sum(axis=2, keepdims=True)], axis=2)
        pressure = u["pressure"] + c.drop * self.fraction
        t = self.bubbles(x, pressure)
        y = x * m.pressures(t) / pressure[:, None]
        v = y.copy()
        e = c.efficiency
        for i in range(1, n - 1):
            v[:, i] = (1 - e) * v[:, i - 1] + e * y[:, i]

        def heat(stage):
            return (x[:, stage] * (m.latent * ((m.tc - t[:, stage, None]) / (m.tc - m.tb)) ** 0.38)).sum(axis=1)

        feed = u["feed"] / m.volume(u["z"], u["t_feed"])
        top = t[:, -1] - u["subcooling"]
        reflux = u["reflux"] / (x[:, -1] * (m.mass / (m.rho0 + m.rho1 * top[:, None]))).sum(axis=1)
        boilup = u["heat"] / heat(0)
        by_feed = feed * (x[:, nf] @ m.cp) * (t[:, nf] - u["t_feed"]) / heat(nf)
        by_reflux = reflux * (x[:, -1] @ m.cp) * u["subcooling"] / heat(-1)
        up = np.empty(x.shape[:2])
        up[:, :nf] = boilup[:, None]
        up[:, nf:n - 2] = (boilup - by_feed)[:, None]
        up[:, n - 2] = boilup - by_feed - by_reflux
        up[:, n - 1] = 0.0
        # a is the rate of a stage without the liquid from above; each mole of that liquid adds b.
        rest = np.zeros(x.shape[:2])
        rest[:, 1:] = up[:, :-1]
        a = -rest[..., None] * x - up[..., None] * (v - x)
        a[:, 1:] += up[:, :-1, None] * v[:, :-1]
        a[:, nf] += feed * (u["z"] - x[:, nf])
        rest[:, nf] += feed
        room = (x * self.volume).sum(axis=2)
        holdup = c.holdup / room
        a /= holdup[..., None]
        b = np.zeros_like(x)
        b[:, :-1] = (x[:, 1:] - x[:, :-1]) / holdup[:, :-1, None]
        slope = -(holdup / room)[..., None] * self.volume  # of the moles on a stage by its composition
        ga, gb = (slope * a).sum(axis=2), (slope * b).sum(axis=2)
        down = np.zeros(x.shape[:2])
        down[:, -1] = reflux
        gain, offset = 1 - gb, rest - up - ga
        for i in range(n - 2, -1, -1):
            down[:, i] = gain[:, i] * down[:, i + 1] + offset[:, i]
        dx = a
        dx[:, :-1] += b[:, :-1] * down[:, 1:, None]
        return dx[..., :-1].reshape(len(states), -1).T.reshape(flat.shape), t

    def jacobian(self, x, u):
        step = 1e-7 * np.maximum(np.abs(x), 1e-3)
        many = np.repeat(x[:, None], len(x) + 1, axis=1)
        many[np.arange(len(x)), np.arange(len(x))] += step
        rates, _ = self(many, u)
        return (rates[:, :-1] - rates[:, -1:]) / step


def spoken(program, minutes):
    """[(time, drive)], {time: temperatures}, seconds of the C program."""
    changes, temperatures, seconds = [], {}, 0.0
    done = subprocess.run([program, "--day", minutes], capture_output=True, text=True, check=True)
    for line in done.stdout.splitlines():
        word, *rest = line.split()
        numbers = [float(v) for v in rest]
        if word == "inputs":
            flow, warmth, c2, c3, ic4, nc4 = numbers[1:]
            z = np.array([c2, c3, ic4, reference.FEED[3], reference.FEED[4], nc4])
            changes.append((numbers[0], reference.drive(dict(reference.NOMINAL, F=flow, TF=warmth, z=z / z.sum()))))
        elif word == "temperatures":
            order = np.argsort(numbers[1::2])
            temperatures[numbers[0]] = np.array(numbers[2::2])[order]
        elif word == "seconds":
            seconds = numbers[0]
    return changes, temperatures, seconds


def day(column, changes, start, tolerance):
    """{time: temperatures}, seconds of processor time, evaluations."""
    x, temperatures, evaluations = start, {}, 0
    began = time.process_time()
    for (t, u), end in zip(changes, [t for t, _ in changes[1:]] + [86400.0]):
        column.begin_from(x, u)
        run = solve_ivp(lambda _, y: column(y, u)[0], (t, end), x, method="BDF", rtol=tolerance, atol=0.01 * tolerance,
                        jac=lambda _, y: column.jacobian(y, u))
        assert run.success, run.message
        x, evaluations = run.y[:, -1], evaluations + run.nfev
        temperatures[end] = column(x, u)[1][0]
    return temperatures, time.process_time() - began, evaluations


def apart(one, other):
    return max(np.max(np.abs(one[t] - other[t])) for t in other)


def main():
    program, minutes = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "15"
    changes, plant, ours = spoken(program, minutes)
    start = reference.steady(reference.NOMINAL, reference.start())
    column = Batched(reference.COLUMN)
    moved = start + 1e-4 * np.sin(np.arange(len(start)))
    for _, u in changes[:3]:  # the same equations as the reference's
        want, temperatures, *_ = reference.COLUMN.evaluate(moved, u)
        got, t = column(moved, u)
        assert np.max(np.abs(got - want)) < 1e-12 and np.max(np.abs(t[0] - temperatures)) < 1e-8
    # scipy's Newton iteration gives up where nothing moves but the last digit.
    start *= 1 + 1e-7 * np.sin(np.arange(len(start)))
    exact, _, _ = day(column, changes, start, TIGHT)
    our_error = apart(plant, exact)
    for tolerance in ROW:
        found, theirs, evaluations = day(column, changes, start, tolerance)
        error = apart(found, exact)
        if error <= our_error:
            break
    print(f"changes {len(changes)} plant_s {ours:.3f} scipy_s {theirs:.2f} ratio {theirs / ours:.0f} plant_tolerance {OURS:g} "
          f"scipy_tolerance {tolerance:g} evaluations {evaluations} plant_error_K {our_error:.2g} scipy_error_K {error:.2g}")


if __name__ == "__main__":
    main()
