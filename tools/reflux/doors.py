"""The firmware's own analysis and design for Python: relative gains, pairing and PI settings, difference models.

Doors onto libreflux.py and identification.py, which compute nothing themselves: libreflux.so is the firmware in double. Channels count
from 0. What the firmware refuses is raised as libreflux.Refused with its words.
"""

from __future__ import annotations

import numbers
import operator
from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np
from numpy.typing import ArrayLike

from reflux import given, identification, lab_log, libreflux
from reflux.errors import UserError

Pairs = list[tuple[int, int]]


def rga(gain: ArrayLike, *, dead_time: ArrayLike = 0.0, time_constant: ArrayLike = 0.0, omega: float | None = None) -> np.ndarray:
    """Relative gains of outputs x inputs. With omega (rad/s) their moduli there, for which dead times and time constants (s) count."""
    plant = _plant(gain, dead_time, time_constant)
    return libreflux.rga(plant) if omega is None else libreflux.rga_at(plant, [given.number(omega, "omega")])[0][0]


def _plant(gain: ArrayLike, dead_time: ArrayLike = 0.0, time_constant: ArrayLike = 0.0, gain_sd: ArrayLike = 0.0) -> libreflux.Plant:
    gains = given.table(gain, "gain")
    if gains.ndim != 2:
        raise UserError(f"gain must be a matrix, outputs x inputs, not {given.shown(gain)}")
    others = []
    for what, value in (("dead_time", dead_time), ("time_constant", time_constant), ("gain_sd", gain_sd)):
        try:
            others.append(np.broadcast_to(given.table(value, what), gains.shape))
        except ValueError:
            raise UserError(f"{what} must be one number, or {gains.shape[0]} x {gains.shape[1]} as gain, not {given.shown(value)}") from None
    return libreflux.Plant(gains, *others)


def _pairs(pairs: Sequence[tuple[int, int]], plant: libreflux.Plant) -> Pairs:
    """Whole numbers that are channels of the plant: an index that is cut or wraps would design another loop."""
    try:
        found = [tuple(operator.index(k) for k in pair) for pair in pairs]
    except TypeError:
        found = [()]
    if not all(len(pair) == 2 and 0 <= pair[0] < plant.outputs and 0 <= pair[1] < plant.inputs for pair in found):
        raise UserError(f"pairs are (output, input), which count from 0 and are less than {plant.outputs} and {plant.inputs}, not {given.shown(pairs)}")
    return [(pair[0], pair[1]) for pair in found]


@dataclass(frozen=True)
class Design:
    """PI loops for a plant. pairs: (output, input) of each loop. gain has the action's sign: positive where the process gain is."""

    pairs: Pairs
    gain: np.ndarray
    ti_s: np.ndarray
    factor: float  # by which the loops were slowed together
    log_modulus_db: float
    kept: bool  # the distance from instability was reached
    verdict: str  # of the pairing: determined, undetermined, singular, impossible


def pair(gain: ArrayLike, *, gain_sd: ArrayLike = 0.0, **settings: float) -> dict[str, Any]:
    """Which input for which output: libreflux.pairing() of a matrix of gains in spans, with what it says of the pairing."""
    return libreflux.pairing(_plant(gain, gain_sd=gain_sd), **settings)


def design(gain: ArrayLike, dead_time: ArrayLike, time_constant: ArrayLike, *, interval_s: float, gain_sd: ArrayLike = 0.0,
           pairs: Sequence[tuple[int, int]] | None = None, **settings: float) -> Design:
    """Pairs outputs with inputs and finds PI settings: SIMC, slowed until all loops together keep their distance from instability.

    Automatic start-up uses another method (docs/methods/tuning.md). Gains in spans, times in s. pairs: keeps these. settings: those of
    libreflux.detune(), as gain_margin=3.
    """
    plant = _plant(gain, dead_time, time_constant, gain_sd)
    found = libreflux.pairing(plant) if pairs is None else {"pairs": _pairs(pairs, plant), "verdict": "determined"}
    loops, numbers = libreflux.detune(plant, found["pairs"], given.number(interval_s, "interval_s"), **settings)
    return Design([(int(a), int(b)) for a, b in found["pairs"]], loops.gain, loops.ti,
                  float(numbers["factor"]), float(numbers["log_modulus_db"]), bool(numbers["kept"]), found["verdict"])


@dataclass(frozen=True)
class Model:
    """A(z^-1) y = B(z^-1) u of one output, in deviations from the means of the record."""

    output: str
    a: list[float]  # without the leading 1
    b: list[list[float]]  # of each input from z^-1 on
    orders: identification.Orders
    fit: float  # on the rows that the model has not seen: 1 is all of it, 0 no better than the mean
    found: identification.Fit


def identify(log: Any = None, inputs: Sequence[str] = (), outputs: Sequence[str] = (), *, u: ArrayLike | None = None, y: ArrayLike | None = None,
             na: int = 3, nb: int = 4, method: str = "iv", validation: float = 1 / 3) -> list[Model]:
    """A difference model of each output, its orders chosen as tools/identify chooses them.

    From a log of Lab.run() with names of outputs of the board (inputs here) and measurements (outputs here); or from arrays u and y,
    samples x channels, u acting from its sample on. validation: part at the end by which the model is judged.
    """
    if method not in identification.METHODS:
        raise UserError(f"method must be one of {', '.join(identification.METHODS)}, not {given.shown(method)}")
    if any(isinstance(order, bool) or not isinstance(order, numbers.Integral) for order in (na, nb)):
        raise UserError(f"na and nb must be whole numbers, not {given.shown(na)} and {given.shown(nb)}")
    if log is not None and not (inputs and outputs):
        raise UserError("a log needs the names of its channels: inputs= and outputs=")
    if log is not None:
        u = np.column_stack([np.asarray(log[lab_log.resolved(f"{name}.cmd", list(log.columns))]) for name in inputs])
        y = np.column_stack([np.asarray(log[name]) for name in outputs])
    elif u is None or y is None:
        raise UserError("a log with inputs= and outputs=, or the arrays u= and y=")
    if not 0.05 <= given.number(validation, "validation") <= 0.8:
        raise UserError("validation must be 0.05 to 0.8 of the record")
    u, y = given.table(u, "u"), given.table(y, "y")
    if u.ndim != 2 or y.ndim != 2 or len(u) != len(y) or not len(u):
        raise UserError(f"u and y must be tables, samples x channels, with a row for each sample, not of the shapes {u.shape} and {y.shape}")
    if not (np.isfinite(u).all() and np.isfinite(y).all()):
        raise UserError("the record has samples that are no numbers")
    record = identification.Record(u - u.mean(axis=0), y - y.mean(axis=0))
    border = round(record.samples * (1 - validation))
    names = list(outputs) or [f"y{i + 1}" for i in range(record.outputs)]
    return [_model(record, i, name, border, na, nb, method) for i, name in enumerate(names)]


def _model(record: identification.Record, i: int, name: str, border: int, na: int, nb: int, method: str) -> Model:
    trials = identification.select(record, i, na, nb, part=(0, border))
    found = identification.fit(record, i, trials.best.orders, method, (0, border))
    judged = identification.judge(record, i, found, (border, record.samples))
    return Model(name, found.a(), found.b(), found.orders, judged.fit(), found)
