"""An independent model of columns as data, written from docs/use/columns.md and column-equations.md alone.

    import columns_reference
    column = columns_reference.Column("host_sim/plants/column-a.json")
    column.nominal, column.values(column.start, column.nominal)

Nothing of the C sources is called or was read. Whatever is computed takes complex numbers, so that derivatives are
found by complex steps to the last digit: limits branch on the real part, and no absolute value stands in the model.
All arrays may have axes in front of those named here, so that a whole Jacobian is one evaluation.

Units are SI throughout: mol, s, K, Pa, W, m3, kg. Stages count from 0 here, the reboiler.
"""
import json

from columns_mixture import FRACTION, MASS, MOLAR, POWER, PRESSURE, VOLUME, ZERO_CELSIUS, Mixture  # before numpy

import numpy as np
from scipy.integrate import solve_ivp

OVERFLOW = 0.1  # 1/s
EMPTY = 1e-4  # of the nominal holdup: the least that counts in the equation of composition
STEP = 1e-30  # imaginary step of a derivative


def soft(a, b, softness):
    """The lesser of a and b."""
    a, b = np.asarray(a), np.asarray(b)
    w = softness * b
    with np.errstate(all="ignore"):
        between = a - (a - b + w) ** 2 / (4 * w)
    return np.where(a.real <= (b - w).real, a, np.where(a.real >= (b + w).real, b, between))


def positive(a, w):
    """The greater of a and 0."""
    a, w = np.asarray(a), np.asarray(w)
    with np.errstate(all="ignore"):
        between = (a + w) ** 2 / (4 * w)
    return np.where(a.real >= w.real, a, np.where(a.real <= -w.real, 0 * a, between))


def lesser(a, b):
    return np.where(np.real(a) < np.real(b), a, b)


def not_negative(a):
    a = np.asarray(a)
    return np.where(a.real > 0, a, 0 * a)


class State:
    """Results of one evaluation; arrays over the stages have them last."""


class Column:
    def __init__(self, path, nominal=True):
        if isinstance(path, dict):
            self.file = path
        else:
            with open(path, encoding="utf-8") as text:
                self.file = json.load(text)
        f = self.file
        self.mixture = Mixture(f)
        self.n, self.parts = f["stages"], len(f["components"])
        self.feed = f["feed_stage"] - 1
        self.softness = f.get("limit_softness", 0.02)
        hold = f["holdup"]
        self.form = hold["form"]
        self.holdup = np.array([hold["reboiler"]] + [hold["tray"]] * (self.n - 2) + [hold["condenser"]], float)
        if self.form != "molar":
            self.hold_volumes = self.mixture.volumes(np.linspace(*hold["temperatures"], self.n))
        self.hydraulics, self.levels = hold.get("hydraulics"), f.get("levels")
        self.capacity = (self.levels or {}).get("capacity", 2.0)
        moving = np.zeros(self.n, bool)
        moving[1:-1] = self.hydraulics is not None
        moving[[0, -1]] = self.levels is not None
        self.moving = np.flatnonzero(moving)

        self.inputs = f["inputs"] + f.get("disturbances", [])
        self.outputs = f["outputs"] + f.get("truths", [])
        self.constants = []
        for kind, given in f.get("constants", {}).items():
            self.constants += [dict(one, **{"is": kind}) for one in (given if isinstance(given, list) else [given])]
        self.nominal = {c["name"]: c["nominal"] for c in self.inputs if "nominal" in c}
        self.fixed = {c["is"]: c["value"] for c in self.constants if c["is"] != "feed_fraction"}
        self.rest = {}  # flows 0, V0, L0 of the nominal state, once it is known
        if nominal:
            self._find_nominal()

    # Inputs

    def drive(self, values, fixed=None):
        """The quantities in their own units by `is`, as (value, unit), and the mole fractions of the feed."""
        fixed = self.fixed if fixed is None else fixed
        found, fractions = {}, [None] * self.parts
        unit = "-"
        for c in self.constants + self.inputs:
            value = values.get(c["name"]) if "name" in c else fixed.get(c["is"], c["value"])
            if c["is"] == "feed_fraction":
                fractions[self.mixture.names.index(c["of"])] = value * FRACTION[c["unit"]]
                unit = "%w" if c["unit"] == "%w" else "-"
            elif value is not None:
                found[c["is"]] = (value, c.get("unit"))
        if None in fractions:
            fractions[fractions.index(None)] = 1 - sum(z for z in fractions if z is not None)
        z = np.stack(np.broadcast_arrays(*fractions), -1)
        if unit == "%w":
            z = z / self.mixture.mass
        return found, z / z.sum(-1, keepdims=True)

    def flow(self, quantity, x, t):
        """A flow in mol/s, at the composition and temperature of the stream."""
        value, unit = quantity
        if unit in MOLAR:
            return value * MOLAR[unit]
        return value / self.per_mole(unit, x, t)

    def per_mole(self, unit, x, t):
        """Value of a mol/s of a stream in a unit."""
        if unit in MOLAR:
            return 1 / MOLAR[unit]
        if unit in MASS:
            return (x * self.mixture.mass).sum(-1) / MASS[unit]
        return self.mixture.volume(x, t) / VOLUME[unit]

    @staticmethod
    def plain(quantity, table=None):
        value, unit = quantity
        if unit == "degC":
            return value + ZERO_CELSIUS
        return value * table[unit] if table else value

    # The equations

    def split(self, state):
        """Mole fractions of all components and holdups over nominal ones, on every stage."""
        k = self.n * (self.parts - 1)
        x = state[..., :k].reshape(state.shape[:-1] + (self.n, self.parts - 1))
        r = np.ones(state.shape[:-1] + (self.n,), state.dtype)
        if state.shape[-1] > k:
            r[..., self.moving] = state[..., k:]
        return np.concatenate([x, 1 - x.sum(-1, keepdims=True)], -1), r

    def evaluate(self, state, values, perfect=False, fixed=None, guess=None):
        """perfect: levels and tray holdups stand still, as in the nominal state."""
        m, n, f, s = self.mixture, self.n, self.feed, State()
        drive, z = self.drive(values, fixed)
        levels = self.levels if not perfect else None
        moving = self.hydraulics if not perfect else None
        s.x, s.r = x, r = self.split(state)
        top = np.asarray(self.plain(drive["pressure"], PRESSURE))[..., None]
        s.pressure = top + self.file.get("pressure_drop", 0.0) * (n - 1 - np.arange(n)) / (n - 1)
        s.t = t = m.bubble(x, s.pressure, guess)
        s.y = x * m.partial(x, t)
        s.y = s.y / s.y.sum(-1, keepdims=True)  # the sum is the pressure, to rounding

        # Wanted flows
        s.subcooling = self.plain(drive.get("reflux_subcooling", (0.0, "K")))
        xb, xd = x[..., 0, :], x[..., -1, :]
        td = t[..., -1] - s.subcooling
        g = m.subcooling(xd, t[..., -1], s.subcooling) if "reflux_subcooling" in drive else 1.0
        feed_t = self.plain(drive["feed_temperature"]) if "feed_temperature" in drive else np.nan
        s.feed = feed = self.flow(drive["feed"], z, feed_t)
        s.z, s.feed_t = z, feed_t
        ratio = r / self.softness
        a = np.where(ratio.real < 1, ratio, 1.0)
        excess = self.holdup * (r - 1)
        reflux = self.flow(drive["reflux"], xd, td)
        if "heat" in drive:
            loss = self.plain(drive.get("heat_loss", (0.0, "W")), POWER)
            boilup = not_negative(self.plain(drive["heat"], POWER) - loss) / m.heat(xb, t[..., 0])
        else:
            boilup = self.flow(drive["boilup"], None, None)
        if levels:
            def moved(end, flow, stage, wanted):
                if levels[end]["by"] != flow:
                    return wanted
                return not_negative(self.rest[flow] + levels[end]["gain"] * excess[..., stage])

            reflux = moved("condenser", "reflux", -1, reflux)
            boilup = moved("reboiler", "boilup", 0, boilup)
            over = OVERFLOW * self.holdup * not_negative(r - self.capacity)
            flow = self.flow(drive["distillate"], xd, td) if "distillate" in drive else self.rest["distillate"]
            s.distillate = a[..., -1] * not_negative(moved("condenser", "distillate", -1, flow)) + over[..., -1]
            flow = self.flow(drive["bottoms"], xb, t[..., 0]) if "bottoms" in drive else self.rest["bottoms"]
            s.bottoms = a[..., 0] * not_negative(moved("reboiler", "bottoms", 0, flow)) + over[..., 0]
            reflux, boilup = a[..., -1] * reflux, a[..., 0] * boilup

        # Feed
        if "feed_temperature" in drive:
            by_feed = feed * m.capacity(x[..., f, :]) * (t[..., f] - feed_t) / m.heat(x[..., f, :], t[..., f])
            hot = -soft(-by_feed, (1 - self.softness) * feed, self.softness)
        else:
            by_feed = (self.plain(drive.get("feed_quality", (1.0, "-"))) - 1) * feed
            hot = by_feed
        by_feed = np.where(np.real(by_feed) > 0, soft(by_feed, boilup, self.softness), hot)

        if levels:
            vs = boilup
            ve = vs - by_feed
            by_reflux = soft((g - 1) * reflux, ve, self.softness)
            vt = ve - by_reflux
        else:
            above = not_negative(boilup - by_feed)
            w = positive(above - g * reflux, self.softness * above)
            reflux = (above - w) / g
            s.distillate = soft(w, feed, self.softness)
            ve = s.distillate + g * reflux
            vs = ve + by_feed
            missing = not_negative(-vs)
            s.distillate, ve, vs = s.distillate + missing, ve + missing, vs + missing
            by_reflux = (g - 1) * reflux
            vt = s.distillate + reflux
            s.bottoms = feed - s.distillate
        s.reflux = reflux

        def column(value):  # one number a state, as an array with one axis for stages
            return np.broadcast_to(np.asarray(value)[..., None], s.t.shape[:-1] + (1,))

        s.up = np.concatenate([column(vs)] * f + [column(ve)] * (n - 2 - f) + [column(vt), column(0 * vt)], -1)
        low = reflux + by_reflux + feed + by_feed
        s.down = np.concatenate([column(0 * vs)] + [column(low)] * f + [column(reflux + by_reflux)] * (n - 2 - f)
                                + [column(reflux)], -1)
        s.down[..., 0] = s.bottoms
        if moving:
            wanted = (self.rest["down"] + excess / moving["time"])[..., 1:-1] + moving.get("vapour", 0.0) * (
                s.up - self.rest["up"])[..., :-2]
            s.down[..., 1:-1] = a[..., 1:-1] * not_negative(wanted)
            if not levels:
                s.bottoms = s.down[..., 1] - vs
                s.down[..., 0] = s.bottoms

        s.v = self._leaving(s.y, vs, ve)
        s.moles = self.holdup * r if self.form == "molar" else self.holdup / (x * self.hold_volumes).sum(-1)
        fed = np.zeros(n)
        fed[f] = 1.0
        s.change = (column(feed) * fed)[..., None] * (z[..., None, :] - x) - s.up[..., None] * (s.v - x)
        s.change[..., 1:, :] += s.up[..., :-1, None] * (s.v[..., :-1, :] - x[..., 1:, :])
        if self.form == "conservative":
            self._conservative(s)
        else:
            s.change[..., :-1, :] += s.down[..., 1:, None] * (x[..., 1:, :] - x[..., :-1, :])
            s.change = s.change / np.where(s.r.real > EMPTY, s.moles, EMPTY * self.holdup)[..., None] if (
                self.form == "molar") else s.change / s.moles[..., None]
        rates = [s.change[..., :-1].reshape(s.change.shape[:-2] + (-1,))]
        if state.shape[-1] > rates[0].shape[-1]:
            growth = column(feed) * fed - s.up - s.down
            growth[..., 1:] += s.up[..., :-1]
            growth[..., :-1] += s.down[..., 1:]
            growth[..., -1] -= s.distillate
            rates.append((growth / self.holdup)[..., self.moving])
        s.rates = np.concatenate(rates, -1)
        return s

    def _leaving(self, y, below, above):
        """Vapour leaving every stage, by Murphree's efficiency; below and above the feed."""
        efficiency = self.file.get("efficiency", 1.0)
        if efficiency == 1.0:
            return y
        with np.errstate(all="ignore"):
            least = np.where(np.real(above) > 0, 1 - below / above, 0.0)
        at_feed = np.where(least.real > efficiency, least, efficiency)[..., None]
        v = np.array(y)
        for i in range(1, self.n - 1):
            v[..., i, :] = v[..., i - 1, :] + (at_feed if i == self.feed else efficiency) * (y[..., i, :] - v[..., i - 1, :])
        return v

    def _conservative(self, s):
        """Liquid from the top down: what leaves a stage carries what its holdup gives up."""
        v = self.hold_volumes
        total = s.feed * (np.arange(self.n) == self.feed)[..., :] if np.ndim(s.feed) == 0 else (
            s.feed[..., None] * (np.arange(self.n) == self.feed))
        for i in reversed(range(self.n)):
            inside = total[..., i] - s.up[..., i] + (s.up[..., i - 1] if i else 0.0)
            if i < self.n - 1:
                down = s.down[..., i + 1]
                arriving = np.where((down.real > 0)[..., None], down[..., None] * (s.x[..., i + 1, :] - s.x[..., i, :]), 0.0)
                s.change[..., i, :] = s.change[..., i, :] + arriving  # what is drawn upwards changes nothing here
                inside = inside + down
            s.change[..., i, :] = s.change[..., i, :] / s.moles[..., i, None]
            own = (s.x[..., i, :] * v[i]).sum(-1)
            growth = -s.moles[..., i] * (v[i] * s.change[..., i, :]).sum(-1) / own
            if i == self.n - 1:
                s.distillate = inside - growth - s.reflux
                continue
            left = inside - growth
            if i > 0:  # what is missing is drawn from the stage below, of its composition
                below = s.x[..., i - 1, :]
                drawn = np.where(left.real < 0, -left * own / (below * v[i]).sum(-1), 0.0)
                s.change[..., i, :] += drawn[..., None] * (below - s.x[..., i, :]) / s.moles[..., i, None]
                left = np.where(left.real < 0, -drawn, left)
            s.down[..., i] = left
        s.bottoms = s.down[..., 0]

    # Outputs

    def value(self, s, spec):
        kind, unit = spec["is"], spec.get("unit", "-")
        stages = [i - 1 for i in (spec["stages"] if "stages" in spec else [spec.get("stage", 1)])]
        m = self.mixture
        if kind == "temperature":
            return s.t[..., stages].mean(-1) - (ZERO_CELSIUS if unit == "degC" else 0.0)
        if kind == "temperature_difference":
            return s.t[..., stages[0]] - s.t[..., stages[1]]
        if kind in ("fraction", "log_fraction", "vapour_fraction"):
            of = [m.names.index(o) for o in (spec["of"] if isinstance(spec["of"], list) else [spec["of"]])]
            x = (s.v if kind == "vapour_fraction" else s.x)[..., stages, :]
            if unit == "%w":
                x = x * m.mass / (x * m.mass).sum(-1, keepdims=True)
            x = x[..., of].sum(-1).mean(-1)
            if kind == "log_fraction":
                x = np.where(x.real < 1e-12, 1e-12, np.where(x.real > 1 - 1e-12, 1 - 1e-12, x))
                return np.log(x / (1 - x))
            return x / FRACTION[unit]
        if kind == "level":
            i = stages[0]
            if unit == "%":
                return 100 * s.r[..., i] / self.capacity
            return s.moles[..., i] / (1e3 if unit == "kmol" else 1.0)
        if kind in ("distillate", "reflux"):
            return getattr(s, kind) * self.per_mole(unit, s.x[..., -1, :], s.t[..., -1] - s.subcooling)
        if kind == "bottoms":
            return s.bottoms * self.per_mole(unit, s.x[..., 0, :], s.t[..., 0])
        if kind == "pressure":
            return s.pressure[..., -1] / PRESSURE[unit]
        if kind == "feed":
            return s.feed * self.per_mole(unit, s.z, s.feed_t)
        if kind == "feed_temperature":
            return s.feed_t - (273.15 if unit == "degC" else 0.0)
        if kind == "heat":
            return s.up[..., 0] * m.heat(s.x[..., 0, :], s.t[..., 0]) / POWER[unit]
        flow = {"boilup": s.up[..., 0], "liquid_flow": s.down[..., stages[0]], "vapour_flow": s.up[..., stages[0]]}[kind]
        return flow / MOLAR[unit]

    def values(self, state, values, **options):
        """{name: value} of outputs and truths."""
        s = self.evaluate(np.asarray(state), values, **options)
        return {spec["name"]: self.value(s, spec) for spec in self.outputs}

    # Solutions

    def jacobian(self, state, values, **options):
        """Rates by states, and the evaluation itself."""
        base = self.evaluate(state, values, **options)
        states = state + 1j * STEP * np.eye(len(state))
        moved = self.evaluate(states, values, guess=np.broadcast_to(base.t, states.shape[:1] + base.t.shape), **options)
        return moved.rates.imag.T / STEP, base

    def integrate(self, state, values, times, rtol=1e-9, atol=1e-12, **options):
        """States at times, s. Where BDF stumbles over rounding, as where a level moves and nothing else, LSODA."""
        first = self.evaluate(state, values, **options)
        if np.max(np.abs(first.rates)) * times[-1] < 1e-10:  # at rest
            return np.tile(state, (len(times), 1))
        for method, patience in (("BDF", 6000), ("LSODA", 200000)):
            guess, calls = [first.t], [0]

            def rates(_, y, guess=guess, calls=calls, patience=patience):
                calls[0] += 1
                if calls[0] > patience:
                    raise ArithmeticError("more than %d evaluations" % patience)
                s = self.evaluate(y, values, guess=guess[0], **options)
                guess[0] = s.t
                return s.rates

            try:
                run = solve_ivp(rates, (0.0, times[-1]), state, method=method, t_eval=times, rtol=rtol, atol=atol,
                                jac=lambda _, y: self.jacobian(y, values, **options)[0])
            except ArithmeticError:
                continue
            if run.success:
                return run.y.T
        raise ArithmeticError("no way found from this state")

    def steady(self, values, state, **options):
        """The steady state that the column comes to from a state."""
        turnover = self.holdup.sum() if self.form == "molar" else (self.holdup / self.hold_volumes.mean(-1)).sum()
        turnover /= self.evaluate(state, values, **options).feed.real
        for _ in range(8):
            state = self.integrate(state, values, [30 * turnover], rtol=1e-6, atol=1e-9, **options)[-1]
            found = self._newton(values, state, **options)
            if found is not None:
                return found
        raise ArithmeticError("no steady state reached")

    def _newton(self, values, state, **options):
        for _ in range(12):
            jacobian, s = self.jacobian(state, values, **options)
            step = np.linalg.solve(jacobian, -s.rates)
            if not np.isfinite(step).all() or np.max(np.abs(step)) > 0.3:
                return None
            state = state + step
            if np.max(np.abs(step)) < 1e-13:
                return state
        return state if np.max(np.abs(step)) < 1e-10 else None

    def _find_nominal(self):
        up = np.linspace(0.1, 0.9, self.n)[:, None]
        pure = np.eye(self.parts)
        mid = 0.5 * (self.mixture.low + self.mixture.high)
        order = np.argsort(self.mixture.log_pressure(mid))
        _, z = self.drive(self.nominal)
        ends = [0.5 * z + 0.5 * pure[order[0]], 0.5 * z + 0.5 * pure[order[-1]]]
        first = ((1 - up) * ends[0] + up * ends[1])[:, :-1].ravel()
        state = self.steady(self.nominal, first, perfect=True)
        goals = self.file.get("steady_state", [])
        if goals:
            state = self._trim(goals, state)
        self.rest_at(state)

    def rest_at(self, state):
        """Takes a state of the compositions for the nominal one, with the flows there."""
        s = self.evaluate(state, self.nominal, perfect=True)
        xd, td, xb = s.x[-1], s.t[-1] - s.subcooling, s.x[0]
        self.rest = {"distillate": s.distillate, "bottoms": s.bottoms, "reflux": s.reflux, "boilup": s.up[0],
                     "down": s.down, "up": s.up}
        for c in self.inputs:
            if c["is"] in ("distillate", "bottoms") and c["name"] not in self.nominal:
                at = (xd, td) if c["is"] == "distillate" else (xb, s.t[0])
                self.nominal[c["name"]] = float(self.rest[c["is"]] * self.per_mole(c["unit"], *at))
        self.start = np.concatenate([state, np.ones(len(self.moving))])

    def _trim(self, goals, state):
        """State and trims together by Newton, in steps cut to a tenth of a trim's value."""
        channels = {c["name"] for c in self.inputs}
        trims = [g["trim"] for g in goals]
        specs = [next(o for o in self.outputs if o["name"] == g["channel"]) for g in goals]
        wanted = np.array([g["value"] for g in goals], float)
        at = np.array([self.nominal[t] if t in channels else self.fixed[t] for t in trims], float)

        def both(u):
            values, fixed = dict(self.nominal), dict(self.fixed)
            for t, v in zip(trims, u):
                (values if t in channels else fixed)[t] = v
            return values, fixed

        def sensed(x, u):
            values, fixed = both(u)
            s = self.evaluate(x, values, perfect=True, fixed=fixed)
            return np.concatenate([s.rates, [self.value(s, spec) for spec in specs]])

        for _ in range(60):
            values, fixed = both(at)
            f = sensed(state, at)
            f[len(state):] -= wanted
            n = len(state) + len(at)
            jacobian = np.empty((n, n))
            joint = np.concatenate([state, at])
            for k in range(n):
                moved = joint + 0j
                moved[k] += 1j * STEP
                jacobian[:, k] = sensed(moved[:len(state)], moved[len(state):]).imag / STEP
            step = np.linalg.solve(jacobian, -f)
            part = min(1.0, 0.1 / max(np.max(np.abs(step[len(state):] / at)), 1e-300))
            at = at + part * step[len(state):]
            values, fixed = both(at)
            state = state + step[:len(state)] if part == 1.0 and np.max(np.abs(step[:len(state)])) < 0.05 else self.steady(
                values, state, perfect=True, fixed=fixed)
            if part == 1.0 and np.max(np.abs(step[len(state):] / at)) < 1e-12:
                break
        else:
            raise ArithmeticError("no trims found")
        rounded = [float("%.7g" % v) for v in at]
        self.nominal, self.fixed = both(rounded)
        return self.steady(self.nominal, state, perfect=True)

    def linearise(self, state=None, values=None):
        """A, B, C, D: states, inputs and disturbances, outputs and truths, in their units."""
        state, values = self.start if state is None else state, self.nominal if values is None else values
        names = [c["name"] for c in self.inputs]
        rates, seen = [], []
        guess = self.evaluate(state, values).t
        for k in range(len(state) + len(names)):
            moved, inputs = state + 0j, dict(values)
            if k < len(state):
                moved[k] += 1j * STEP
            else:
                inputs[names[k - len(state)]] = inputs[names[k - len(state)]] + 1j * STEP
            s = self.evaluate(moved, inputs, guess=guess)
            rates.append(np.imag(s.rates) / STEP)
            seen.append([np.imag(self.value(s, spec)) / STEP for spec in self.outputs])
        n, rates, seen = len(state), np.array(rates).T, np.array(seen).T
        return rates[:, :n], rates[:, n:], seen[:, :n], seen[:, n:]


def gains(a, b, c, d):
    return d - c @ np.linalg.solve(a, b)


def relative_gains(k):
    return k * np.linalg.inv(k).T
