"""An independent estimator of compositions from temperatures, dense and in double precision.

    table = composition_reference.Table(lines)      # those that reflux-sim --table prints
    estimator = composition_reference.Estimator(table, sensors, step_s)
    estimator.step(inputs, temperatures)            # inputs by what they are: feed, feed_temperature, reflux, heat ...

Nothing of the C sources of the estimator was read. The column is that of columns_reference, with the numbers of a compact
table (docs/methods/column-table.md); what is solved block by block there is here one dense matrix. Stages and components count
from 0 here. Units are SI; lambda is in 1/s.
"""

import re
from dataclasses import dataclass

from columns_mixture import Mixture  # before numpy
from columns_reference import STEP, Column

import numpy as np
from scipy.integrate import solve_ivp

FIXED, EACH, ANTOINE = 32, 19, 4
LETTERS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ_abcdefghijklmnopqrstuvwxyz"
LIMIT = 100.0  # K: what the integral of a sensor may stand for, over its lambda
FLOWS = ("mol/s", "kg/s", "m3/s")


def word(values):
    text = ""
    for value in values:
        value = int(value)
        while value:
            text += LETTERS[value % 64 - 1]
            value //= 64
    return text


class Table:
    """The compact table: a column in the form of a column file, its nominal inputs and its profile."""

    def __init__(self, lines):
        found, size = {}, None
        for line in lines:
            if match := re.match(r"set block\d+\.value\.(\d+) (\S+)", line):
                found[int(match[1])] = [float(np.float32(v)) for v in match[2].split(",")]
            elif match := re.match(r"set block\d+\.size (\d+)", line):
                size = int(match[1])
        v = [x for k in sorted(found) for x in found[k]]
        assert size is not None and len(v) >= size
        self.stages, self.parts = int(v[4]), int(v[5])
        parts, at = [], FIXED
        for _ in range(self.parts):
            c = v[at : at + EACH]
            part = {"name": word(c[:4]), "vapour_pressure": c[4:11], "fraction": c[18]}
            given = {
                "molar_mass": c[11],
                "density": c[12:14],
                "vaporisation_heat": c[14],
                "boiling_point": c[15],
                "critical_temperature": c[16],
                "heat_capacity": c[17],
            }
            parts.append(part | {key: value for key, value in given.items() if value not in (0, [0, 0])})
            at += EACH
        activity, square = int(v[18]), self.parts**2
        file = {
            "components": parts,
            "stages": self.stages,
            "feed_stage": int(v[6]),
            "efficiency": v[7],
            "pressure_drop": v[8],
            "temperature_range": v[15:17],
            "limit_softness": v[17],
            "holdup": {
                "form": ("molar", "volumetric", "conservative")[int(v[9])],
                "reboiler": v[10],
                "tray": v[11],
                "condenser": v[12],
                "temperatures": v[13:15],
            },
        }
        if activity:
            tables = [
                np.reshape(v[at + i * square : at + (i + 1) * square], (self.parts, self.parts)).tolist()
                for i in range(activity + 1)
            ]
            at += (activity + 1) * square
            file["activity"] = {"model": ("wilson", "nrtl")[activity - 1]} | dict(zip(("a", "b", "alpha"), tables))
        self.profile = np.array(v[at : at + self.stages * (self.parts - 1)])
        self.truncated = np.array([bool(int(v[30 + s // 24]) >> (s % 24) & 1) for s in range(self.stages)])
        feed_by = ("feed_temperature", "feed_quality")[int(v[21])]
        boiling = ("heat", "boilup")[int(v[26])]
        self.nominal = {
            "feed": v[20],
            feed_by: v[22],
            "reflux": v[24],
            boiling: v[27] + v[28],
            "pressure": v[29],
        }
        units = {
            "feed": FLOWS[int(v[19])],
            "feed_temperature": "K",
            "feed_quality": "-",
            "reflux": FLOWS[int(v[23])],
            "heat": "W",
            "boilup": "mol/s",
            "pressure": "Pa",
        }
        file["inputs"] = [{"name": n, "is": n, "unit": units[n], "nominal": x} for n, x in self.nominal.items()]
        file["outputs"] = []
        file["constants"] = {
            "feed_fraction": [{"of": p["name"], "value": p["fraction"], "unit": "-"} for p in parts],
            "heat_loss": {"value": v[28], "unit": "W"},
            "reflux_subcooling": {"value": v[25], "unit": "K"},
        }
        self.file = file


class Interpolating(Mixture):
    """Temperatures of some stages are interpolated between the nearest that are not among them."""

    def between(self, truncated, how):
        stages = np.arange(len(truncated))
        self.kept = stages[~truncated]
        self.to = np.eye(len(stages))[:, self.kept]  # all temperatures from those that are bubble points
        for s in stages[truncated]:
            above = np.searchsorted(self.kept, s)
            below, top = self.kept[above - 1], self.kept[above]
            part = 0.5 if how == "mean" else (s - below) / (top - below)
            self.to[s, above - 1], self.to[s, above] = 1 - part, part
        return self

    def bubble(self, x, pressure, guess=None):
        guess = None if guess is None else guess[..., self.kept]
        t = super().bubble(x[..., self.kept, :], pressure[..., self.kept], guess)
        return t @ self.to.T


@dataclass
class Sensor:
    stage: int
    part: int  # the mole fraction that is innovated
    rate: float  # lambda, 1/s
    damping: float
    sum: float = 0.0
    variance: float = 0.0

    @property
    def kp(self):
        return 2 * self.damping * self.rate

    @property
    def ki(self):
        return self.rate**2


@dataclass
class Settings:
    method: str = "geometric"
    noise: float = 0.2  # K
    model: float = 0.1  # of a mole fraction, in an hour
    between: str = "line"


class Estimator:
    def __init__(self, table, sensors, step_s, settings=None):
        self.table, self.sensors, self.h = table, sensors, step_s
        self.settings = settings or Settings()
        self.column = column = Column(table.file, nominal=False)
        column.mixture = Interpolating(table.file).between(table.truncated, self.settings.between)
        self.n, self.free = column.n, column.parts - 1
        self.x = table.profile.reshape(self.n, self.free).copy()
        self.guess = None
        self.clipped = 0
        for sensor in sensors:
            sensor.variance = self.settings.model**2

    # The model at a state

    def algebraic(self, x, values):
        """The last but one mole fraction of truncated stages, from the bubble point that is interpolated."""
        table, column = self.table, self.column
        if not table.truncated.any():
            return x
        pressure = values["pressure"] + table.file["pressure_drop"] * (self.n - 1 - np.arange(self.n)) / (self.n - 1)
        full = np.concatenate([x, 1 - x.sum(-1, keepdims=True)], -1)
        t = column.mixture.bubble(full, pressure, self.guess)
        k = np.exp(column.mixture.log_pressure(t)) / pressure[:, None]
        a = self.free - 1
        x = x.copy()
        for s in np.flatnonzero(table.truncated):
            rest = sum(x[s, j] * (k[s, j] - k[s, -1]) for j in range(a))
            found = (1 - rest - k[s, -1]) / (k[s, a] - k[s, -1])
            x[s, a] = max(0.0, min(found, max(0.0, 1 - x[s, :a].sum())))
        return x

    def look(self, inputs):
        """All that the model says at the state, with the slopes of the vapours and of the bubble points."""
        values = self.table.nominal | inputs
        self.x = self.algebraic(self.x, values)
        s = self.column.evaluate(self.x.ravel(), values, guess=self.guess)
        self.guess = s.t
        log = self.column.mixture
        pressures = np.exp(log.log_pressure(s.t) + log.log_activity(s.x, s.t))
        s.k = pressures / s.pressure[:, None]
        warm = s.t + 1j * STEP
        s.dk = s.k * (log.log_pressure(warm) + log.log_activity(s.x, warm)).imag / STEP
        m = self.free
        # Bubble points by the mole fractions but the last, which closes; temperatures of truncated stages stand.
        s.dt = -(s.k[:, :m] - s.k[:, m:]) / (s.x * s.dk).sum(-1)[:, None]
        s.dt[self.table.truncated] = 0.0
        # Where the temperature is interpolated and a mole fraction kept within its limits the sum of k x is not 1; that it
        # is divided by its sum is left out of these slopes.
        s.dy = s.k[:, :m, None] * np.eye(m) + (s.x * s.dk)[:, :m, None] * s.dt[:, None, :]
        return s

    def efficiencies(self, s):
        column = self.column
        each = np.full(self.n, column.file["efficiency"])
        below, above = s.up[column.feed - 1], s.up[column.feed]
        each[column.feed] = max(each[column.feed], 1 - below / above if above > 0 else 0.0)
        each[0] = each[-1] = 1.0
        return each

    def jacobian(self, s):
        """Rates by states: flows and holdups held, the vapour with all it remembers of the stages below."""
        n, m, f = self.n, self.free, self.column.feed
        each = self.efficiencies(s)
        memory = np.zeros((n, n))  # of the vapour that leaves a stage, of the equilibrium of another
        for i in range(n):
            if i:
                memory[i] = (1 - each[i]) * memory[i - 1]
            memory[i, i] = each[i]
        by_vapour = -s.up[:, None] * memory
        by_vapour[1:] += s.up[:-1, None] * memory[:-1]
        by_liquid = np.zeros((n, n))
        for i in range(n):
            by_liquid[i, i] = s.up[i] - (s.feed if i == f else 0.0) - (s.up[i - 1] if i else 0.0)
            if i < n - 1:
                down = s.down[i + 1]
                down = max(down, 0.0) if self.column.form == "conservative" else down
                by_liquid[i, i] -= down
                by_liquid[i, i + 1] += down
            if 0 < i < n - 1 and self.column.form == "conservative" and s.down[i] < 0:
                by_liquid[i, i] += s.down[i]
                by_liquid[i, i - 1] -= s.down[i]
        whole = np.einsum("st,tij->sitj", by_vapour, s.dy)
        for j in range(m):
            whole[:, j, :, j] += by_liquid
        return (whole / s.moles[:, None, None, None]).reshape(n * m, n * m)

    # A step

    def step(self, inputs, temperatures):
        """inputs: SI by what they are; temperatures: K, NaN where there is no good reading."""
        n, m, h = self.n, self.free, self.h
        s = self.look(inputs)
        jacobian = self.jacobian(s)
        matrix = np.eye(n * m) - h * jacobian
        right = h * s.rates
        slopes, left = [], []
        for sensor, reading in zip(self.sensors, temperatures):
            b = np.zeros(n * m)
            b[sensor.stage * m : sensor.stage * m + m] = s.dt[sensor.stage]
            slopes.append(b)
            left.append(reading - s.t[sensor.stage])
            if self.settings.method == "geometric" and np.isfinite(reading):
                row = sensor.stage * m + sensor.part
                gain = sensor.kp + h * sensor.ki
                matrix[row] += h * gain / b[row] * b
                right[row] += h * (gain * left[-1] + sensor.ki * sensor.sum) / b[row]
        for stage in np.flatnonzero(self.table.truncated):
            row, last = stage * m + m - 1, s.k[stage, m]
            matrix[row], right[row] = 0.0, 0.0
            matrix[row, stage * m : row + 1] = (s.k[stage, :m] - last) / (s.k[stage, m - 1] - last)
        change = np.linalg.solve(matrix, right)
        for sensor, b, e in zip(self.sensors, slopes, left):
            row = sensor.stage * m + sensor.part
            after = e - b @ change if self.settings.method == "geometric" else e
            if self.settings.method == "geometric":
                if np.isfinite(e):
                    wanted = self.x[sensor.stage, sensor.part] + change[row]
                    if not 0 <= wanted <= 1 and after * sensor.sum > 0:
                        continue  # at a limit it gathers nothing more
                    most = LIMIT / np.sqrt(sensor.ki)
                    sensor.sum = float(np.clip(sensor.sum + h * after, -most, most))
                else:
                    sensor.sum *= 1 - min(1.0, h * sensor.ki / sensor.kp)
        if self.settings.method == "rekf":
            for sensor, e, b in zip(self.sensors, left, slopes):
                self.correct(sensor, e - b @ change, b, jacobian, change)
        self.move(change.reshape(n, m))

    def integrate(self, inputs, temperatures, span_s, rtol=1e-7, atol=1e-9):
        """The geometric estimator as it is meant, flows and holdups moving along, over a span in which nothing else changes."""
        values, size, free = self.table.nominal | inputs, self.x.size, self.free
        assert self.settings.method == "geometric" and not self.table.truncated.any()

        def rates(_, state):
            s = self.column.evaluate(state[:size], values, guess=self.guess)
            self.guess = s.t
            mixture = self.column.mixture
            log = mixture.log_pressure(s.t + 1j * STEP)
            change = np.concatenate([s.rates, np.zeros(len(self.sensors))])
            for i, (sensor, reading) in enumerate(zip(self.sensors, temperatures)):
                at, part = sensor.stage, sensor.part
                k = np.exp(log[at].real) / s.pressure[at]
                slope = -(k[part] - k[-1]) / (s.x[at] * k * log[at].imag / STEP).sum()
                e = reading - s.t[at]
                change[at * free + part] += (sensor.kp * e + sensor.ki * state[size + i]) / slope
                change[size + i] = e
            return change

        start = np.concatenate([self.x.ravel(), [sensor.sum for sensor in self.sensors]])
        end = solve_ivp(rates, (0.0, span_s), start, method="RK45", rtol=rtol, atol=atol).y[:, -1]
        self.x = end[:size].reshape(self.x.shape)
        for sensor, reached in zip(self.sensors, end[size:]):
            sensor.sum = float(reached)

    def correct(self, sensor, e, b, jacobian, change):
        row = sensor.stage * self.free + sensor.part
        f, h = jacobian[row, row], self.h
        q, r = self.settings.model**2 / 3600, self.settings.noise**2
        growth = np.exp(2 * f * h)
        sensor.variance = sensor.variance * growth + q * (np.expm1(2 * f * h) / (2 * f) if f else h)
        if not np.isfinite(e):
            return
        b = b[row]
        gain = sensor.variance * b / (b * sensor.variance * b + r)
        change[row] += gain * e
        sensor.variance *= 1 - gain * b

    def move(self, change):
        moved = self.x + change
        self.clipped = 0
        for s in range(self.n):
            room = 1.0
            for j in range(self.free):
                within = max(0.0, min(moved[s, j], max(room, 0.0)))
                self.clipped += within != moved[s, j]
                moved[s, j] = within
                room -= within
        self.x = moved

    def fraction(self, stage, part):
        return self.x[stage, part] if part < self.free else 1 - self.x[stage].sum()
