"""Difference models from records, as the firmware finds them (firmware/identify/arx.h): libreflux.so by ctypes.

    record = Record(u, y)                       # samples x inputs, samples x outputs; u acts from its sample on
    trials = select(record, 0, na=3, nb=4)
    model = fit(record, 0, trials.best.orders, "iv")

Channels count from 0. Every function raises Refused with the firmware's own words.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np

from reflux.libreflux import REASON_BYTES, _array, _check, _d, _doubles, _i, load

METHODS = ("ls", "iv", "els")
CRITERIA = ("bic", "aicc")
INDEPENDENCE = ("shifts", "registers")
TRIALS, PARAMETERS = 300, 41


class _Record(ctypes.Structure):
    _fields_ = [("samples", ctypes.c_int32), ("outputs", ctypes.c_int32), ("inputs", ctypes.c_int32), ("u", _doubles), ("y", _doubles)]


class Record:
    def __init__(self, u, y):
        self.u, self.y = _array(u), _array(y)
        if self.u.ndim != 2 or self.y.ndim != 2 or len(self.u) != len(self.y):
            raise ValueError("a record is two tables with a row for each sample")

    @property
    def samples(self) -> int:
        return len(self.u)

    @property
    def inputs(self) -> int:
        return self.u.shape[1]

    @property
    def outputs(self) -> int:
        return self.y.shape[1]

    def _c(self) -> _Record:
        return _Record(self.samples, self.outputs, self.inputs, _d(self.u), _d(self.y))


@dataclass(frozen=True)
class Orders:
    """Orders of the model of one output. lags: first and last power of z^-1 of each input, (0, 0) where it has no part."""

    na: int
    lags: tuple[tuple[int, int], ...]
    nc: int = 0
    constant: bool = False

    def _c(self) -> np.ndarray:
        return np.array([self.na, self.nc, int(self.constant), *(n for lag in self.lags for n in lag)], dtype=np.int32)

    def __str__(self) -> str:
        lags = " ".join("-" if not last else str(first) if first == last else f"{first}..{last}" for first, last in self.lags)
        return f"na {self.na}, B {lags}" + (f", nc {self.nc}" if self.nc else "")


@dataclass(frozen=True)
class Trial:
    orders: Orders
    parameters: int
    squares: float
    criterion: float
    known: bool  # could be told from the record


@dataclass(frozen=True)
class Trials:
    all: list[Trial]
    best: Trial
    rows: int


@dataclass(frozen=True)
class Fit:
    orders: Orders
    theta: np.ndarray
    sd: np.ndarray
    variance: float
    rows: int
    passes: int
    settled: bool

    def a(self) -> list[float]:
        """A_ii without the 1."""
        return [float(x) for x in self.theta[: self.orders.na]]

    def b(self) -> list[list[float]]:
        """B_ij of every input from z^-1 on, dead time as leading zeros."""
        rows, at = [], self.orders.na
        for first, last in self.orders.lags:
            count = last - first + 1 if last else 0
            rows.append([0.0] * (first - 1 if last else 0) + [float(x) for x in self.theta[at : at + count]])
            at += count
        return rows


@dataclass(frozen=True)
class Judgement:
    """Mean squares: of the error one sample ahead, of that of the simulation, of y about its mean."""

    rows: int
    step: float
    simulated: float
    about: float

    def fit(self) -> float:
        """1: the simulation is y; 0: no better than its mean."""
        return 1 - float(np.sqrt(self.simulated / self.about)) if self.about > 0 else float("nan")


def _range(record: Record, part: tuple[int, int] | None) -> np.ndarray:
    return np.array(part or (0, record.samples), dtype=np.int32)


def prbs(inputs: int, samples: int, amplitude, bits: int = 9, clock: int = 1, independence: str = "shifts") -> tuple[np.ndarray, int, int]:
    """u, its period and the lag up to which inputs are uncorrelated, in samples."""
    u, why = np.zeros((samples, inputs)), ctypes.create_string_buffer(REASON_BYTES)
    settings = np.array([bits, INDEPENDENCE.index(independence), clock], dtype=np.int32)
    period, memory = ctypes.c_int32(), ctypes.c_int32()
    _check(load().reflux_prbs(inputs, _i(settings), _d(_array(amplitude, (inputs,))), samples, _d(u), ctypes.byref(period), ctypes.byref(memory), why), why)
    return u, period.value, memory.value


def decimate(x, ratio: int, cutoff: float) -> np.ndarray:
    x = _array(x)
    kept = np.zeros(len(x) if ratio < 1 else -(-len(x) // ratio))
    _check(load().reflux_decimate(ratio, ctypes.c_double(cutoff), len(x), _d(x), _d(kept)))
    return kept


def select(record: Record, output: int, na: int, nb: int, constant: bool = False, criterion: str = "bic", part: tuple[int, int] | None = None) -> Trials:
    limits = np.array([na, nb, int(constant), CRITERIA.index(criterion)], dtype=np.int32)
    orders, numbers = np.zeros((TRIALS, 3 + 2 * record.inputs), dtype=np.int32), np.zeros((TRIALS, 4))
    n, best, rows = ctypes.c_int32(), ctypes.c_int32(), ctypes.c_int32()
    _check(load().reflux_arx_select(ctypes.byref(record._c()), output, _i(limits), _i(_range(record, part)), ctypes.byref(n), _i(orders), _d(numbers),
                                    ctypes.byref(best), ctypes.byref(rows)))
    trials = []
    for o, (parameters, squares, value, known) in zip(orders[: n.value].tolist(), numbers):
        lags = tuple((o[k], o[k + 1]) for k in range(3, len(o), 2))
        trials.append(Trial(Orders(o[0], lags, 0, bool(o[2])), int(parameters), float(squares), float(value), bool(known)))
    return Trials(trials, trials[best.value], rows.value)


def fit(record: Record, output: int, orders: Orders, method: str = "ls", part: tuple[int, int] | None = None) -> Fit:
    theta, sd, numbers, why = np.zeros(PARAMETERS), np.zeros(PARAMETERS), np.zeros(5), ctypes.create_string_buffer(REASON_BYTES)
    _check(load().reflux_arx_fit(ctypes.byref(record._c()), output, _i(orders._c()), METHODS.index(method), _i(_range(record, part)), _d(theta), _d(sd),
                                 _d(numbers), why), why)
    n, nc = int(numbers[0]), orders.nc if method == "els" else 0
    return Fit(Orders(orders.na, orders.lags, nc, orders.constant), theta[:n], sd[:n], float(numbers[1]), int(numbers[2]), int(numbers[3]), bool(numbers[4]))


def judge(record: Record, output: int, model: Fit, part: tuple[int, int] | None = None) -> Judgement:
    numbers = np.zeros(4)
    _check(load().reflux_arx_judge(ctypes.byref(record._c()), output, _i(model.orders._c()), _d(_array(model.theta)), _i(_range(record, part)), _d(numbers)))
    return Judgement(int(numbers[0]), *(float(x) for x in numbers[1:]))


def simulate(record: Record, output: int, model: Fit) -> np.ndarray:
    """Output of the model with u alone, from rest at the level that its constant gives."""
    a, b = np.array(model.a()), model.b()
    constant, at_one = float(model.theta[-1]) if model.orders.constant else 0.0, 1 + a.sum()
    level = constant / at_one if abs(at_one) > 1e-9 else 0.0
    x = np.zeros(record.samples)  # from the level
    for j, row in enumerate(b):
        for m, factor in enumerate(row, 1):
            x[m:] += factor * record.u[: record.samples - m, j]
    for k in range(record.samples):
        x[k] -= sum(a[m] * x[k - 1 - m] for m in range(len(a)) if k > m)
    return level + x
