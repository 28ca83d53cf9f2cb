"""Frequency responses of the plants of host_sim/plants, for tools/ina: sampled models on the unit circle, elements with exact dead times and
state spaces in s."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable

import numpy as np

from reflux import arrays, libreflux, plant_file
from reflux.errors import UserError
from reflux.paths import shown

UNIT = {"s": 1.0, "min": 60.0, "h": 3600.0}
MOST = 8  # loops


@dataclass(frozen=True)
class Channel:
    name: str
    unit: str
    span: float


@dataclass(frozen=True)
class SquarePlant:
    """As many outputs as inputs, paired in this order. response(omega) is points x n x n, in the units of the channels."""

    name: str
    outputs: tuple[Channel, ...]
    inputs: tuple[Channel, ...]
    response: Callable[[np.ndarray], np.ndarray]
    period_s: float | None  # of a sampled model
    times_s: tuple[float, float]  # slowest and fastest of a plant in s: lag and dead time together

    @property
    def n(self) -> int:
        return len(self.outputs)

    def spans(self) -> np.ndarray:
        """Factor that turns a gain into output span per input span."""
        return np.array([[u.span / y.span for u in self.inputs] for y in self.outputs])

    def omega(self, points: int, low: float | None, high: float | None) -> np.ndarray:
        """rad/s: of a sampled model even steps up to half its rate, else even steps of the logarithm."""
        if self.period_s is not None:
            end = np.pi / self.period_s
            low, high = low or 1e-3 / self.period_s, min(high or end, end)
        else:
            low, high = low or 0.01 / self.times_s[0], high or 10.0 / self.times_s[1]
        if not 0 < low < high < np.inf:
            raise UserError(f"frequencies from {low:g} to {high:g} rad/s: must be more than 0, and the first the lower"
                            + (f"; half the rate is {np.pi / self.period_s:.6g} rad/s" if self.period_s else ""))
        return np.linspace(low, high, points) if self.period_s is not None else np.geomspace(low, high, points)


def read(name: str, pairs: str | None) -> SquarePlant:
    j, path = plant_file.load(name)
    if "column" in j or j.get("model") not in MODELS:
        raise UserError(f"{path.stem} is not linear: identify it, or give its matrices as a plant (reflux-sim --linearise)")
    try:
        rows, columns = paired(j, pairs)
        response, period, times = MODELS[j["model"]](j, rows, columns)
        return SquarePlant(j["name"], tuple(channel(j["outputs"][i]) for i in rows), tuple(channel(j["inputs"][k]) for k in columns), response, period, times)
    except (AttributeError, KeyError, TypeError, ValueError, IndexError) as error:
        raise UserError(f"{shown(path)} is not as docs/use/linear-plants.md has it: {type(error).__name__} {error}") from None


def channel(c: dict[str, Any]) -> Channel:
    return Channel(c["name"], c.get("unit", ""), float(c["hi"]) - float(c["lo"]))


def paired(j: dict[str, Any], text: str | None) -> tuple[list[int], list[int]]:
    """Rows and columns: as asked, else in the order of the file."""
    outputs, inputs = [y["name"] for y in j["outputs"]], [u["name"] for u in j["inputs"]]
    if not outputs or not inputs:
        raise UserError(f"{j['name']} has {len(outputs)} outputs and {len(inputs)} inputs: it needs one of each")
    if text is None:
        if len(outputs) != len(inputs):
            raise UserError(f"{j['name']} has {len(outputs)} outputs and {len(inputs)} inputs; there is no inverse. Name as many: "
                            f"--pairs {outputs[0]}={inputs[0]},...")
        if len(outputs) > MOST:
            raise UserError(f"{j['name']} has {len(outputs)} loops, more than {MOST}: name some with --pairs")
        return list(range(len(outputs))), list(range(len(inputs)))
    rows, columns = [], []
    for pair in text.split(","):
        y, _, u = pair.partition("=")
        if y not in outputs or u not in inputs:
            raise UserError(f"--pairs {text}: {pair} must be OUTPUT=INPUT; outputs are {', '.join(outputs)}, inputs {', '.join(inputs)}")
        rows.append(outputs.index(y))
        columns.append(inputs.index(u))
    if len(set(rows)) < len(rows) or len(set(columns)) < len(columns) or len(rows) > MOST:
        raise UserError(f"--pairs {text}: every output and input once at most, {MOST} pairs at most")
    return rows, columns


# ---- models of docs/use/linear-plants.md ----


def of_polynomials(j, rows, columns):
    unit = UNIT[j.get("time_unit", "s")]
    a, b = np.array(j["A"], float), np.array(j["B"], float)
    if np.abs(a - np.einsum("kii->ki", a)[:, :, None] * np.eye(a.shape[1])).max(initial=0.0) > 0:
        raise UserError(f"{j['name']}: A is not diagonal; an output must not stand in another's equation")
    if np.abs(b[0]).max() > 0:
        raise UserError(f"{j['name']}: B[0] is not 0; an input must not act at once")
    poles, zeros = np.einsum("kii->ik", a)[rows], b[1:].transpose(1, 2, 0)[np.ix_(rows, columns)]
    period = j["period"] * unit
    return lambda omega: arrays.response_sampled(poles, zeros, period, omega), period, (period, period)


def of_elements(j, rows, columns):
    unit = UNIT[j.get("time_unit", "s")]
    elements = [[j["elements"][i][k] for k in columns] for i in rows]
    every = [e for row in elements for e in row if e]
    if any("cases" in e for e in every):
        raise UserError(f"{j['name']}: has elements with cases; write the one that is meant into a file of its own")
    plain = all(set(e) <= {"gain", "lags", "dead_time"} and not isinstance(e.get("lags", 0.0), list) for e in every)
    times = [t for e in every if (t := unit * (e.get("dead_time", 0.0) + sum(lags_of(e)))) > 0] or [1.0]
    if plain:
        table = [[(e["gain"], e.get("dead_time", 0.0) * unit, (e.get("lags") or 0.0) * unit) if e else (0.0, 0.0, 0.0) for e in row] for row in elements]
        plant = libreflux.Plant(*np.moveaxis(np.array(table, float), 2, 0))
        return lambda omega: arrays.response(plant, omega), None, (max(times), min(times))

    def response(omega: np.ndarray) -> np.ndarray:
        return np.moveaxis(np.array([[element(e, 1j * omega * unit, unit) for e in row] for row in elements]), 2, 0)

    return response, None, (max(times), min(times))


def lags_of(e: dict[str, Any]) -> list[float]:
    """Lags, or times that are about as long as those of a quadratic."""
    if "quadratic" in e:
        return [float(e["quadratic"][1]), float(e["quadratic"][0]) ** 0.5]
    lags = e.get("lags") or []
    return [float(x) for x in (lags if isinstance(lags, list) else [lags])]


def element(e: dict[str, Any] | None, s: np.ndarray, unit: float) -> np.ndarray:
    """s in radians per time unit of the file."""
    if not e:
        return np.zeros_like(s)
    out = e["gain"] * np.exp(-s * e.get("dead_time", 0.0)) * (1.0 + s * e.get("zero", 0.0))
    if "quadratic" in e:
        out = out / (e["quadratic"][0] * s**2 + e["quadratic"][1] * s + 1.0)
    else:
        for lag in lags_of(e):
            out = out / (lag * s + 1.0)
    return out / s if e.get("integrator") else out


def of_matrices(j, rows, columns):
    unit = UNIT[j.get("time_unit", "s")]
    sampled = j["model"] == "discrete"
    a, b, c = (np.array(j[k], float) for k in "ABC")
    d = np.array(j.get("D", np.zeros((len(c), b.shape[1]))), float)
    b, c, d = b[:, columns], c[rows], d[np.ix_(rows, columns)]
    period = j["period"] * unit if sampled else None

    def response(omega: np.ndarray) -> np.ndarray:
        at = np.exp(1j * omega * period) if sampled else 1j * omega * unit
        return np.array([c @ np.linalg.solve(s * np.eye(len(a)) - a, b) + d for s in at])

    if sampled:
        return response, period, (period, period)
    speeds = np.abs(np.linalg.eigvals(a)) / unit
    speeds = speeds[speeds > 1e-11]
    if not len(speeds):
        raise UserError(f"{j['name']}: all its poles are 0; name the frequencies with --from and --to")
    return response, None, (1.0 / speeds.min(), 1.0 / speeds.max())


MODELS = {"polynomial": of_polynomials, "transfer": of_elements, "state_space": of_matrices, "discrete": of_matrices}
