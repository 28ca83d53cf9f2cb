"""Property data and units of columns as data, from docs/use/columns.md; part of columns_reference.

Whatever is computed takes complex numbers. Compositions have the components last; temperatures lack that axis.
"""
import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # threads make small matrices slower by ten times

import numpy as np  # noqa: E402

CALORIE = 4.184
HOUR, MINUTE = 3600.0, 60.0
MOLAR = {"mol/s": 1.0, "mol/h": 1 / HOUR, "mol/min": 1 / MINUTE, "kmol/s": 1e3, "kmol/min": 1e3 / MINUTE, "kmol/h": 1e3 / HOUR}
MASS = {"kg/s": 1.0, "kg/h": 1 / HOUR, "t/h": 1e3 / HOUR}
VOLUME = {"l/s": 1e-3, "l/min": 1e-3 / MINUTE, "l/h": 1e-3 / HOUR, "m3/s": 1.0, "m3/h": 1 / HOUR}
POWER = {"W": 1.0, "kW": 1e3, "MW": 1e6} | {p + "cal/h": f * CALORIE / HOUR for p, f in (("k", 1e3), ("M", 1e6), ("G", 1e9))} | {
    p + "J/h": f / HOUR for p, f in (("k", 1e3), ("M", 1e6), ("G", 1e9))}
PRESSURE = {"Pa": 1.0, "kPa": 1e3, "bar": 1e5, "mbar": 1e2, "mmHg": 133.322, "atm": 101325.0}
FRACTION = {"-": 1.0, "%": 1e-2, "ppm": 1e-6, "%w": 1e-2}
ZERO_CELSIUS = 273.15


class Mixture:
    """Property data of the components of a file."""

    def __init__(self, file):
        parts = file["components"]
        self.names = [p["name"] for p in parts]
        self.low, self.high = file["temperature_range"]
        if "reference_vapour_pressure" in file:
            curves = [file["reference_vapour_pressure"]] * len(parts)
            self.volatility = np.array([p["relative_volatility"] for p in parts])
        else:
            curves = [p["vapour_pressure"] for p in parts]
            self.volatility = np.ones(len(parts))
        self.curve = np.array([c + [0.0] * (7 - len(c)) for c in curves]).T

        def of(key):
            return np.array([p.get(key, np.nan) for p in parts])

        self.mass, self.latent, self.cp = of("molar_mass"), of("vaporisation_heat"), of("heat_capacity")
        self.boiling, self.critical = of("boiling_point"), of("critical_temperature")
        density = [p.get("density", np.nan) for p in parts]
        self.density = np.array([d if isinstance(d, list) else [d, 0.0] for d in density]).T
        self.activity = file.get("activity")
        if self.activity:
            n = len(parts)
            self.a = np.array(self.activity["a"], float)
            self.b = np.array(self.activity.get("b", np.zeros((n, n))), float)
            if self.activity["model"] == "nrtl":
                self.alpha = np.array(self.activity["alpha"], float)

    def log_pressure(self, t):
        a, b, c, d, e, f, g = self.curve
        t = np.asarray(t)[..., None]
        with np.errstate(all="ignore"):
            power = np.where(f == 0, 0.0, f * t ** g)
        return a - b / (c + t) + d * t + e * np.log(t) + power + np.log(self.volatility)

    def log_activity(self, x, t):
        if not self.activity:
            return np.zeros_like(x)
        t = np.asarray(t)[..., None, None]
        pairs = self.a + self.b / t
        if self.activity["model"] == "wilson":
            w = np.exp(pairs)
            s = (w @ x[..., None])[..., 0]  # over i: sum_j x_j L_ij
            return 1 - np.log(s) - (np.swapaxes(w, -1, -2) @ (x / s)[..., None])[..., 0]
        g = np.exp(-self.alpha * pairs)
        s = (x[..., None, :] @ g)[..., 0, :]  # over j: sum_k x_k G_kj
        c = (x[..., None, :] @ (pairs * g))[..., 0, :]
        inside = g * (pairs - (c / s)[..., None, :])
        return c / s + (inside @ (x / s)[..., None])[..., 0]

    def partial(self, x, t):
        """Partial pressure over mole fraction."""
        return np.exp(self.log_pressure(t) + self.log_activity(x, t))

    def bubble(self, x, pressure, guess=None):
        """Newton on ln(sum x g P) = ln(pressure) in 1/T, then some steps more for the imaginary part."""
        def gap(at):
            return np.log((x * self.partial(x, at)).sum(-1) / pressure)

        t = np.full(np.broadcast(x[..., 0], pressure).shape, 0.5 * (self.low + self.high)) if guess is None else guess
        left = 40 if guess is None else 20
        more = 3 if np.iscomplexobj(x) or np.iscomplexobj(pressure) else 1
        while left > 0 and more > 0:
            slope = (gap(t.real + 1e-3) - gap(t.real - 1e-3)).real / 2e-3
            new = 1 / (1 / t + gap(t) / (t ** 2 * slope))
            new = np.where(new.real < self.low, self.low, np.where(new.real > self.high, self.high, new))
            if np.max(np.abs((new - t).real)) < 1e-9:
                more -= 1
            left -= 1
            t = new
        if more > 0:
            raise ArithmeticError("no bubble point found")
        return t

    def volumes(self, t):
        """Molar volumes of the components."""
        return self.mass / (self.density[0] + self.density[1] * np.asarray(t)[..., None])

    def volume(self, x, t):
        return (x * self.volumes(t)).sum(-1)

    def heat(self, x, t):
        ratio = (self.critical - np.asarray(t)[..., None]) / (self.critical - self.boiling)
        with np.errstate(all="ignore"):
            watson = np.where(ratio.real > 0, self.latent * ratio ** 0.38, 0.0)
        return (x * watson).sum(-1)

    def capacity(self, x):
        return (x * self.cp).sum(-1)

    def subcooling(self, x, t, kelvin):
        """Moles that a mole of reflux makes of itself: g of the page."""
        return 1 + self.capacity(x) * kelvin / self.heat(x, t)
