"""Identification for a feedforward and its tuning by the firmware's code in the arithmetic of a board (firmware/identify/high_order.h,
kinds/ff_tune/feedforward_search.h) and its rules (design/feedforward_rules.h): libreflux_board.so by ctypes.

    g = response(Shape(2, ((3, 12),)), y, u, omega_h, first=100)      # y(k) by u(k - 12) and so on, at omega_h (rad per sample)
    f = search(omega, ratio, weight, h=0.05)

Every function raises Refused with the firmware's own words.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np

from reflux.errors import RunFailed
from reflux.libreflux import REASON_BYTES, Refused, _array, _d, _i
from reflux.paths import build_dir

POINTS = 16  # of a search, FEEDFORWARD_POINTS
KICK, LAG_MOST_S = 40.0, 6.0


@dataclass(frozen=True)
class Shape:
    """na coefficients of A; of each input how many of B and the smallest dead time, samples."""

    na: int
    inputs: tuple[tuple[int, int], ...]

    def _c(self) -> np.ndarray:
        return np.array([self.na, len(self.inputs), *(n for pair in self.inputs for n in pair)], dtype=np.int32)


@dataclass(frozen=True)
class Settings:
    """scale: factor for all signals, which have to stay within 2; lags_s: time constant of both lags in series before the identification,
    0: none; h_s: sampling period; p0: of signals as scaled, output squared per input squared."""

    scale: float = 0.1
    lags_s: float = 0.0
    h_s: float = 0.05
    forget: float = 1.0
    p0: float = 1e6


@dataclass(frozen=True)
class Found:
    gain: float
    lead_s: float
    lag_s: float
    dead_s: float
    j: float
    j0: float  # of no feedforward
    pieces: int  # of work


_libraries: dict[str, ctypes.CDLL] = {}


def load(preset: str = "host") -> ctypes.CDLL:
    if preset not in _libraries:
        path = build_dir(preset) / "libreflux_board.so"
        if not path.is_file():
            raise RunFailed(f"there is no {path}: cmake --preset {preset} && cmake --build --preset {preset} --target libreflux_board")
        _libraries[preset] = ctypes.CDLL(str(path))
    return _libraries[preset]


def response(shape: Shape, y, u, omega_h, *, settings: Settings = Settings(), first: int = 0, what: int = 0,
             preset: str = "host") -> tuple[np.ndarray, np.ndarray]:
    """Response of input `what`, or with -1 the ratio of input 1 to input 0, and its standard deviation."""
    y, u, omega_h = _array(y), _array(u), _array(omega_h)
    u = u.reshape(len(y), -1)
    if u.shape[1] != len(shape.inputs):
        raise ValueError("u has a column for each input")
    out, why = np.zeros((len(omega_h), 3)), ctypes.create_string_buffer(REASON_BYTES)
    numbers = _array([settings.scale, settings.lags_s, settings.h_s, settings.forget, settings.p0])
    orders = shape._c()
    code = load(preset).reflux_high_order(_i(orders), _d(numbers), len(y), _d(y), _d(u), int(first), int(what), len(omega_h), _d(omega_h),
                                          _d(out), why)
    if code:
        raise Refused(code, why.value.decode() or f"error {code}")
    return out[:, 0] + 1j * out[:, 1], out[:, 2]


def search(omega, ratio, weight, h_s: float, *, kick: float = KICK, lag_most_s: float = LAG_MOST_S, dead_most_s: float = 0.0,
           preset: str = "host") -> Found:
    """K (lead s + 1)/(lag s + 1) e^(-dead s) of least J; lead is not below 0. kick: most of (lead + h)/(lag + h)."""
    omega, weight, ratio = _array(omega), _array(weight), np.asarray(ratio, dtype=complex)
    both, found = _array(np.stack([ratio.real, ratio.imag], axis=-1)), np.zeros(7)
    code = load(preset).reflux_feedforward_search(len(omega), _d(omega), _d(weight), _d(both), _d(_array([h_s, kick, lag_most_s, dead_most_s])),
                                                  _d(found))
    if code:
        raise Refused(code, f"error {code}")
    return Found(*(float(x) for x in found[:6]), int(found[6]))


@dataclass(frozen=True)
class Model:
    """First order with dead time; error: root mean square of |model/response - 1|."""

    gain: float
    dead_s: float
    lag_s: float
    error: float


def shinskey(omega, process, disturbance, *, dead_most_s: float, same: float = 0.02,
             preset: str = "host") -> tuple[tuple[float, float, float], Model, Model]:
    """(lead, lag, K) by Shinskey's rules, from first-order models that are fitted to the responses of process and disturbance, and those models."""
    omega, models, rule = _array(omega), np.zeros(8), np.zeros(3)
    both = [_array(np.stack([np.real(g), np.imag(g)], axis=-1)) for g in (process, disturbance)]
    code = load(preset).reflux_shinskey(len(omega), _d(omega), _d(both[0]), _d(both[1]), _d(_array([dead_most_s, same])), _d(models), _d(rule))
    if code:
        raise Refused(code, f"error {code}")
    return (float(rule[1]), float(rule[2]), float(rule[0])), Model(*models[:4].tolist()), Model(*models[4:].tolist())


def misses(db, degrees, preset: str = "host") -> np.ndarray:
    """The largest error and the root of the sum of squares: dB, degrees, dB, degrees."""
    db, degrees, out = _array(db), _array(degrees), np.zeros(4)
    code = load(preset).reflux_feedforward_misses(len(db), _d(db), _d(degrees), _d(out))
    if code:
        raise Refused(code, f"error {code}")
    return out
