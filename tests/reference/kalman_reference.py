"""Independent Kalman filters of compositions from temperatures, dense and in double precision.

    table = composition_reference.Table(lines)                 # those that reflux-sim --table prints
    one = kalman_reference.Filter(table, [(29, 0.2), (30, 0.2)], 10.0, Settings())   # stage, standard deviation in K
    one.step(inputs, temperatures)                             # inputs by what they are: feed, reflux, heat ...
    one.analysis((36, 1), 0.021, 0.002, 1200.0)                # stage and component, mole fraction, its sd, its age
    history = kalman_reference.run(one, inputs, readings)      # step over arrays of readings

Nothing of the C sources was read. The column is that of composition_reference, so of columns_reference with the numbers of a
compact table. Stages and components count from 0. Units are SI; all times are in s.

States: the mole fractions of all components but the last, stage by stage from the reboiler, n of them; then the extras:

    theta    for each component but the last, what its mole fraction in the feed is more than the table says (`feed_sd` > 0)
    flow     by how much of itself the feed is more than its measurement or nominal value (`flow_sd` > 0)
    offsets  of each place that is analysed: composition = model's + offset

Mole fractions and extras over a step of h, with J = df/dx at flows and holdups that are held and S = df/d(extras):

    ekf     (I - h J) d = h f(x, u, extras),            x  <- x + d            J and S at the estimate
    kalman  (I - h J) d = h (f(x0, u) + S e + J xi),    xi <- xi + d, x = x0 + xi   J and S at the table's profile, for good

The estimates of the extras stay. S has the feed stage's balance for theta, and for the flow all that moves with it, flows of
the column too. Covariance, Phi = (I - h J)^-1:

    P <- A (P + N) A' + E        A = [Phi, h Phi S; 0, keep]
    N = diag((model w)^2 h / 3600, 0)                         unknown rates of change, standing over the step as f does
    E = diag(0, sd^2 (1 - keep^2)), keep = exp(-h / time)     extras wander, but never further than their sd

so a fraction that nothing else moved would gather model w in an hour. w = max(4 x (1 - x), least) with `shape` bulge: less is
unknown where there is hardly anything but one component. With `noise_at` after, N is added behind A (.) A'. Then each sensor,
one after the other, of slope b (of the bubble point, at the state before the step) and variance r:

    a = b P b' + r,   k = P b' / a,   P <- P - a k k';   e = reading - (t + b (d + what went before)),   states += k e
"""

from dataclasses import dataclass, field

from composition_reference import Estimator  # before numpy
from columns_reference import STEP

import numpy as np

HOUR = 3600.0


@dataclass
class Settings:
    method: str = "ekf"  # or kalman
    steady: bool = False  # the gain that the covariance comes to at the profile, for good
    model: float = 0.05  # mole fraction per square root of an hour
    shape: str = "bulge"  # or flat: w = 1
    least: float = 0.1
    noise_at: str = "before"  # or after
    start: float = 0.05  # sd of the mole fractions to begin with
    feed_sd: float = 0.1  # mole fraction; 0: no theta
    feed_time: float = HOUR
    flow_sd: float = 0.0  # of the feed flow; 0: no such state
    flow_time: float = HOUR
    places: tuple = ()  # (stage, component) of each analysis
    offset_sd: float = 0.005
    offset_time: float = 24 * HOUR
    cycle: int = 1  # steps over which the covariance goes at once; see Filter.work
    gains: str = "same"  # as the covariance was corrected; or ahead


# ---- covariances: dense forms that need no column ----


def transition(jacobian, h):
    """Phi of a step."""
    return np.linalg.inv(np.eye(len(jacobian)) - h * jacobian)


def carry(p, phi, push, keep, noise, grown, noise_at="before"):
    """P over a step. push: h df/d(extras), n by q, before Phi; keep, grown: of the extras; noise: of the n fractions."""
    n, q = push.shape
    a = np.zeros((n + q, n + q))
    a[:n, :n], a[:n, n:], a[n:, n:] = phi, phi @ push, np.diag(keep)
    wide = np.diag(np.concatenate([noise, np.zeros(q)]))
    p = a @ (p + wide) @ a.T if noise_at == "before" else a @ p @ a.T + wide
    p[n:, n:] += np.diag(grown)
    return 0.5 * (p + p.T)


def take(p, slope, variance):
    """One scalar measurement: P after it, gain, variance of its innovation."""
    seen = p @ slope
    a = slope @ seen + variance
    p = p - np.outer(seen, seen) / a
    return 0.5 * (p + p.T), seen / a, a


def take_all(p, slopes, variances):
    """One after the other, without those of infinite variance: P, gains [states, sensors], variances of the innovations."""
    gains, expected = np.zeros((len(p), len(slopes))), np.full(len(slopes), np.inf)
    for i, (slope, variance) in enumerate(zip(slopes, variances)):
        if np.isfinite(variance):
            p, gains[:, i], expected[i] = take(p, slope, variance)
    return p, gains, expected


# ---- the filter ----


@dataclass
class Gains:
    """Results of a job, for the steps to come."""

    gain: np.ndarray
    expected: np.ndarray


@dataclass
class Look:
    """The model at a state: all that a step needs."""

    rates: np.ndarray
    jacobian: np.ndarray
    extras: np.ndarray  # d(rates)/d(extras)
    temperatures: np.ndarray  # of all stages
    bubbles: np.ndarray  # their slopes by the stage's mole fractions
    slopes: np.ndarray  # of the sensors by all states


class Filter:
    def __init__(self, table, sensors, step_s, settings=None):
        self.table, self.h = table, step_s
        self.settings = s = settings or Settings()
        self.stages = [stage for stage, _ in sensors]
        self.variances = np.array([sd**2 for _, sd in sensors])
        self.model = Estimator(table, [], step_s)
        self.m = self.model.free
        self.n = self.model.n * self.m
        self.fractions = [c for c in self.model.column.constants if c["is"] == "feed_fraction"]
        self.known = np.array([c["value"] for c in self.fractions])

        thetas = self.m if s.feed_sd > 0 else 0
        flows = 1 if s.flow_sd > 0 else 0
        self.theta = slice(0, thetas)
        self.flow = slice(thetas, thetas + flows)
        self.first_offset = thetas + flows
        self.q = self.first_offset + len(s.places)
        parts = (thetas, flows, len(s.places))
        self.sd = np.repeat([s.feed_sd, s.flow_sd, s.offset_sd], parts)
        self.time = np.repeat([s.feed_time, s.flow_time, s.offset_time], parts)
        self.extras = np.zeros(self.q)

        self.p = np.diag(np.concatenate([np.full(self.n, s.start**2), self.sd**2]))
        self.profile = self.x.copy()
        self.frozen = self.look(dict(table.nominal))
        self.gains = self.next = None  # gains
        self.ticks = 0
        self.past = []  # mole fractions after each step
        self.innovations = np.full(len(sensors), np.nan)
        self.expected = np.full(len(sensors), np.nan)  # their variances
        if s.steady:
            self.settle()

    @property
    def x(self):
        return self.model.x

    # The model with its extras

    def values(self, inputs, extras):
        """Inputs of the model; its feed fractions are told to it, kept within 0..1 as those of a stage are."""
        room, z = 1.0, self.known.copy()
        z[:-1] += extras[self.theta] if self.theta.stop else 0.0
        for j in range(self.m):
            z[j] = max(0.0, min(z[j], room))
            room -= z[j]
        z[-1] = room
        for fraction, value in zip(self.fractions, z):
            fraction["value"] = float(value)
        values = self.table.nominal | inputs
        for share in extras[self.flow]:
            values["feed"] = values["feed"] * max(0.0, 1 + share)
        return values

    def look(self, inputs):
        """At the estimate, extras and all."""
        values = self.values(inputs, self.extras)
        s = self.model.look(values)
        by_extras = np.zeros((self.n, self.q))
        row = self.model.column.feed * self.m
        for j in range(self.theta.stop):
            by_extras[row + j, j] = s.feed / s.moles[self.model.column.feed]
        for j in range(self.flow.start, self.flow.stop):
            more = (self.table.nominal | inputs)["feed"] * STEP
            moved = values | {"feed": values["feed"] + 1j * more}
            change = self.model.column.evaluate(self.x.ravel() + 0j, moved, guess=s.t)
            by_extras[:, j] = change.rates.imag / STEP
        slopes = np.zeros((len(self.stages), self.n + self.q))
        for i, stage in enumerate(self.stages):
            slopes[i, stage * self.m : (stage + 1) * self.m] = s.dt[stage]
        return Look(s.rates, self.model.jacobian(s), by_extras, s.t, s.dt, slopes)

    def noise(self, h):
        x = self.x.ravel()
        w = np.maximum(4 * x * (1 - x), self.settings.least) if self.settings.shape == "bulge" else np.ones(self.n)
        return (self.settings.model * w) ** 2 * h / HOUR

    # Covariance

    def carried(self, p, at, h):
        keep = np.exp(-h / self.time)
        grown = self.sd**2 * (1 - keep**2)
        phi = transition(at.jacobian, h)
        return carry(p, phi, h * at.extras, keep, self.noise(h), grown, self.settings.noise_at)

    def work(self, at, good):
        """The covariance over a cycle of steps, and gains for each step of the next cycle.

        same: the covariance is corrected as by one reading a cycle, and each step uses the gain of that. It counts on fewer
        readings than there are, so that it is rather too careful.
        ahead: as by one of variance r / cycle, and each step uses the gain that a single step from there on would have. Where
        the cycle is long beside what the column does in it this one is unstable (error_matrix tells): on the splitter at 5 min.
        """
        s, r = self.settings, np.where(good, self.variances, np.inf)
        p = self.carried(self.p, at, self.h * s.cycle)
        if s.cycle == 1 or s.gains == "same":
            self.p, gain, expected = take_all(p, at.slopes, r)
        else:
            self.p = take_all(p, at.slopes, r / s.cycle)[0]
            _, gain, expected = take_all(self.carried(self.p, at, self.h), at.slopes, r)
        return Gains(gain, expected)

    def settle(self, steps=100000, part=1e-12):
        """The gain that stands, at the profile."""
        for _ in range(steps):
            before = np.diag(self.p)
            self.gains = self.work(self.frozen, np.ones(len(self.stages), bool))
            if np.max(np.abs(np.diag(self.p) / before - 1)) < part:
                return
        raise ArithmeticError("the covariance does not come to rest")

    # A step

    def step(self, inputs, temperatures):
        """inputs: SI by what they are; temperatures: K, NaN where there is no good reading."""
        temperatures = np.asarray(temperatures, float)
        good = np.isfinite(temperatures)
        n, h = self.n, self.h
        if self.settings.method == "ekf":
            at = self.look(inputs)
            change = np.linalg.solve(np.eye(n) - h * at.jacobian, h * at.rates)
            seen = at.temperatures
        else:
            at = self.frozen
            nominal = self.values(inputs, np.zeros(self.q))
            s = self.model.column.evaluate(self.profile.ravel(), nominal, guess=at.temperatures)
            xi = self.x.ravel() - self.profile.ravel()
            right = s.rates + at.extras @ self.extras + at.jacobian @ xi
            change = np.linalg.solve(np.eye(n) - h * at.jacobian, h * right)
            seen = s.t + (at.bubbles * xi.reshape(self.x.shape)).sum(-1)
        if not self.settings.steady:
            if self.settings.cycle == 1:
                self.gains = self.work(at, good)
            elif self.ticks % self.settings.cycle == 0:
                self.gains, self.next = self.next, self.work(at, good)
        self.ticks += 1
        moved = np.zeros(n + self.q)
        moved[:n] = change
        self.innovations[:] = np.nan
        for i in np.flatnonzero(good):
            e = temperatures[i] - seen[self.stages[i]] - at.slopes[i] @ moved
            self.innovations[i] = e
            if self.gains is not None:
                moved += self.gains.gain[:, i] * e
        self.expected = self.gains.expected.copy() if self.gains else np.full(len(good), np.nan)
        self.move(moved)
        self.past.append(self.x.copy())

    def move(self, by):
        by_stages = by[: self.n].reshape(self.x.shape)
        if self.settings.method == "ekf":
            self.model.move(by_stages)  # stays within 0..1
        else:
            self.model.x = self.x + by_stages
        self.extras = self.extras + by[self.n :]

    # Analyses and what is asked of the filter

    def analysis(self, place, value, sd, age_s):
        """A composition that was taken age_s ago: compared with what the model said then, with the offset that stands now."""
        at = self.settings.places.index(place)
        back = min(round(age_s / self.h), len(self.past) - 1)
        slope = np.zeros(self.n + self.q)
        slope[place[0] * self.m + place[1]] = slope[self.n + self.first_offset + at] = 1.0
        e = value - self.past[-1 - back][place] - self.extras[self.first_offset + at]
        self.p, gain, a = take(self.p, slope, sd**2)
        self.move(gain * e)
        return e, a

    def composition(self, stage, part):
        x = self.model.fraction(stage, part)
        if (stage, part) in self.settings.places:
            x += self.extras[self.first_offset + self.settings.places.index((stage, part))]
        return x

    def composition_sd(self, stage, part):
        slope = np.zeros(self.n + self.q)
        slope[stage * self.m : (stage + 1) * self.m] = np.eye(self.m)[part] if part < self.m else -1.0
        if (stage, part) in self.settings.places:
            slope[self.n + self.first_offset + self.settings.places.index((stage, part))] = 1.0
        return np.sqrt(slope @ self.p @ slope)


def error_matrix(of, gain):
    """Transition of the estimates' error in a step at the profile, with a constant gain: stable where all eigenvalues are
    inside the unit circle."""
    n, q, at = of.n, of.q, of.frozen
    phi = transition(at.jacobian, of.h)
    moved = np.eye(n + q)
    moved[:n, :n], moved[:n, n:] = phi, phi @ (of.h * at.extras)
    for i, slope in enumerate(at.slopes):
        moved = moved - np.outer(gain[:, i], slope @ moved)
    return moved


@dataclass
class History:
    x: list = field(default_factory=list)  # mole fractions [stage, component]
    extras: list = field(default_factory=list)
    innovations: list = field(default_factory=list)
    expected: list = field(default_factory=list)  # variances of the innovations
    sd: list = field(default_factory=list)  # of all states


def run(of, inputs, readings):
    """Steps of a filter: inputs a list of dicts, readings [steps, sensors]. Arrays over the steps."""
    h = History()
    for values, row in zip(inputs, readings):
        of.step(values, row)
        h.x.append(of.x.copy())
        h.extras.append(of.extras.copy())
        h.innovations.append(of.innovations.copy())
        h.expected.append(of.expected.copy())
        h.sd.append(np.sqrt(np.diag(of.p)))
    for key, rows in vars(h).items():
        setattr(h, key, np.array(rows))
    return h


def nis(history, since=0):
    """Squares of the innovations over what is expected of them, in the mean, for each sensor; 1 where the settings fit."""
    return np.nanmean(history.innovations[since:] ** 2 / history.expected[since:], 0)
