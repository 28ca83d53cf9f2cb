"""The gradient diagram of a column at a steady state (docs/methods/gradients.md): how much the temperature changes from stage to stage, and
what each component has to do with it."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reflux import textfile
from reflux.errors import UserError
from reflux.paths import shown

KELVIN = 273.15
SUM_OFF = 0.01  # by how much the fractions of a stage may miss 1
STEP_K, STEP_X = 1e-3, 1e-6  # of the differences behind slopes with activity coefficients


@dataclass(frozen=True)
class Diagram:
    """Stage i stands for the step from stage i to the one above it; the last stage has none."""

    gradient: list[float]  # K, Frau (3.11)
    share: list[list[float]]  # [stage][component], K; they add up to about the gradient. Empty: not known
    names: list[str]

    @property
    def stages(self) -> int:
        return len(self.gradient) + 1

    def step_beside(self, stage: int) -> float:
        """The larger of the steps to the stages above and below it, K."""
        return max(abs(g) for g in self.gradient[max(stage - 2, 0) : stage])

    def part_of(self, stage: int, names: Sequence[str]) -> float:
        """Part of the shares' sizes that comes of these components; 0 where nothing changes."""
        if not self.share:
            return math.nan
        sizes = [abs(s) for s in self.share[stage - 1]]
        return sum(s for s, name in zip(sizes, self.names) if name in names) / sum(sizes) if sum(sizes) else 0.0


@dataclass(frozen=True)
class Profile:
    """From the reboiler up; K, mole fractions of the liquid."""

    temperature: list[float]
    x: list[list[float]]
    names: list[str]
    k: list[list[float]] | None = None  # y/x of each component, where a file says so


def vapour_pressure(constants: Sequence[float], t: float) -> tuple[float, float]:
    """P and dP/dT, Pa and Pa/K, of ln P = A - B/(C + T) + D T + E ln T + F T^G; what is left out is 0."""
    a, b, c, d, e, f, g = [*constants, 0.0, 0.0, 0.0, 0.0][:7]
    p = math.exp(a - b / (c + t) + d * t + e * math.log(t) + (f * t**g if f else 0.0))
    return p, p * (b / (c + t) ** 2 + d + e / t + (f * g * t ** (g - 1) if f else 0.0))


@dataclass(frozen=True)
class Liquid:
    """Properties that give the bubble point of a mixture."""

    constants: list[list[float]]  # of each component's vapour pressure
    activity: dict[str, Any] | None = None  # as in a column's file, rows and columns in the same order; None: an ideal liquid

    def slopes(self, x: Sequence[float], t: float) -> list[float]:
        """The derivatives of the bubble point by each mole fraction alone, K. Activity coefficients are those of the mixture with its
        fractions divided by their sum, so that with and without them a fraction has the same meaning."""
        if self.activity is None:
            both = [vapour_pressure(c, t) for c in self.constants]
            by_t = sum(xj * dp for xj, (_, dp) in zip(x, both))
            return [-p / by_t for p, _ in both]
        by_t = (self.pressure(x, t + STEP_K) - self.pressure(x, t - STEP_K)) / (2 * STEP_K)
        moved = [[xk + (STEP_X if k == j else 0.0) for k, xk in enumerate(x)] for j in range(len(x))]
        here = self.pressure(x, t)
        return [-(self.pressure(there, t) - here) / STEP_X / by_t for there in moved]

    def pressure(self, x: Sequence[float], t: float) -> float:
        gamma = activity_coefficients(self.activity, x, t) if self.activity else [1.0] * len(x)
        return sum(xj * g * vapour_pressure(c, t)[0] for xj, g, c in zip(x, gamma, self.constants))


def activity_coefficients(activity: dict[str, Any], x: Sequence[float], t: float) -> list[float]:
    """tests/reference/column-equations.md, Activity."""
    n, total = range(len(x)), sum(x)
    x = [xj / total for xj in x]
    a, b = activity["a"], activity.get("b") or [[0.0] * len(x) for _ in n]
    linear = [[a[i][j] + b[i][j] / t if i != j else 0.0 for j in n] for i in n]
    if activity["model"] == "wilson":
        big = [[math.exp(linear[i][j]) for j in n] for i in n]
        sums = [sum(x[j] * big[i][j] for j in n) for i in n]
        return [math.exp(1 - math.log(sums[i]) - sum(x[k] * big[k][i] / sums[k] for k in n)) for i in n]
    big = [[math.exp(-activity["alpha"][i][j] * linear[i][j]) for j in n] for i in n]
    s = [sum(x[k] * big[k][j] for k in n) for j in n]
    c = [sum(x[k] * linear[k][j] * big[k][j] for k in n) for j in n]
    return [math.exp(c[i] / s[i] + sum(x[j] * big[i][j] / s[j] * (linear[i][j] - c[j] / s[j]) for j in n)) for i in n]


def diagram(
    temperature: Sequence[float], x: Sequence[Sequence[float]], names: Sequence[str], liquid: Liquid | None
) -> Diagram:
    """The share of component j is the derivative of the bubble point by x_j alone times its step, so that the closing component has its
    share too. None: the liquid's properties are not known."""
    if len(temperature) != len(x) or len(temperature) < 3:
        raise UserError("a profile needs the temperature and the fractions of three stages or more")
    gradient = [above - below for below, above in zip(temperature, temperature[1:])]
    share = []
    for i in range(len(gradient)) if liquid else ():
        slopes = liquid.slopes(x[i], temperature[i])
        share.append([slope * (above - below) for slope, below, above in zip(slopes, x[i], x[i + 1])])
    return Diagram(gradient, share, list(names))


def diagram_of_k(profile: Profile) -> Diagram:
    """With K-values in place of vapour pressures: d ln K/dT of a component is what lies between the two stages."""
    assert profile.k is not None
    t, k = profile.temperature, profile.k
    gradient = [above - below for below, above in zip(t, t[1:])]
    share = []
    for i, g in enumerate(gradient):
        if g == 0:
            share.append([0.0] * len(profile.names))
            continue
        slope = sum(xj * kj * math.log(ka / kj) / g for xj, kj, ka in zip(profile.x[i], k[i], k[i + 1]))
        share.append(
            [
                -(kj / slope) * (above - below) if slope else 0.0
                for kj, below, above in zip(k[i], profile.x[i], profile.x[i + 1])
            ]
        )
    return Diagram(gradient, share, list(profile.names))


def constants_of(plant: dict[str, Any]) -> dict[str, list[float]]:
    """Constants of each component's vapour pressure from a column's file."""
    out = {}
    for c in plant["components"]:
        if "vapour_pressure" in c:
            out[str(c["name"])] = [float(v) for v in c["vapour_pressure"]]
        else:
            a, *rest = plant["reference_vapour_pressure"]
            out[str(c["name"])] = [float(a) + math.log(float(c["relative_volatility"])), *(float(v) for v in rest)]
    return out


def liquid_of(plant: dict[str, Any], names: Sequence[str]) -> Liquid:
    """Liquid of these components of a column, in this order."""
    known = constants_of(plant)
    activity = plant.get("activity")
    if activity is None:
        return Liquid([known[n] for n in names])
    rows = [list(known).index(n) for n in names]
    chosen = {key: [[activity[key][i][j] for j in rows] for i in rows] for key in ("a", "b", "alpha") if key in activity}
    return Liquid([known[n] for n in names], {"model": activity["model"], **chosen})


def heaviness(plant: dict[str, Any], names: Sequence[str], temperature: Sequence[float]) -> list[float]:
    """A number that rises with the boiling point of each component, at the middle of a profile."""
    known, middle = constants_of(plant), temperature[len(temperature) // 2]
    return [-math.log(vapour_pressure(known[n], middle)[0]) for n in names]


# ---- a user's profile ----


def read_csv(path: Path) -> Profile:
    """Columns stage, T[K] or T[degC], x.NAME of every component, and K.NAME of all of them or none; further columns do not matter."""
    lines = [line for line in textfile.read(path).splitlines() if line.strip() and not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    head = [h.strip() for h in (csv.DictReader(lines).fieldnames or [])]
    units = [h for h in head if h in ("T[K]", "T[degC]")]
    names = [h.removeprefix("x.") for h in head if h.startswith("x.")]
    if "stage" not in head or len(units) != 1 or len(names) < 2:
        raise UserError(
            f"{shown(path)}: needs columns stage, T[K] or T[degC], and x.NAME of two components or more; it has {', '.join(head)}"
        )
    k_names = [h.removeprefix("K.") for h in head if h.startswith("K.")]
    if k_names and sorted(k_names) != sorted(names):
        raise UserError(
            f"{shown(path)}: needs K.NAME of every component or of none; it has them of {', '.join(k_names)}"
        )

    def number(row: dict[str, str], key: str, line: int) -> float:
        text = row.get(key) or ""
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise UserError(f'{shown(path)}: stage {line}, {key}: "{text}" is not a number')
        return value

    temperature, x, k = [], [], []
    for n, row in enumerate(rows, 1):
        row = {str(key).strip(): value for key, value in row.items() if isinstance(value, str)}
        if number(row, "stage", n) != n:
            raise UserError(
                f"{shown(path)}: line {n} is stage {row['stage']}; stages are 1 (the reboiler), 2, 3 and so on upwards"
            )
        t = number(row, units[0], n) + (KELVIN if units[0] == "T[degC]" else 0.0)
        fractions = [number(row, f"x.{name}", n) for name in names]
        if not 50 <= t <= 1500:
            raise UserError(f"{shown(path)}: stage {n}: {t:g} K is not a temperature of a column; is the unit right?")
        if min(fractions) < 0 or abs(sum(fractions) - 1) > SUM_OFF:
            raise UserError(
                f"{shown(path)}: stage {n}: mole fractions are 0 or more and add up to 1, these to {sum(fractions):g}"
            )
        temperature.append(t)
        x.append(fractions)
        if k_names:
            k.append([number(row, f"K.{name}", n) for name in names])
            if min(k[-1]) <= 0:
                raise UserError(f"{shown(path)}: stage {n}: K-values are above 0")
    if len(temperature) < 4:
        raise UserError(f"{shown(path)}: has {len(temperature)} stages; a column has 4 or more")
    return Profile(temperature, x, names, k or None)
