"""Decouplers and controllers by pole placement, designed by the firmware's code in double (libreflux.so):

    found = decoupling.polynomial(a, b, period)               # B G = det(B) times the unit matrix
    placed = decoupling.place([1, *a[0]], found.h[0], period, overshoot=0.1, settling=3600)
    shape = decoupling.one_way(k, [1, 0])                     # a static one; loop 2 first, which no other one disturbs

a is outputs x na, b outputs x inputs x nb, coefficients of z^-1 on, as in arrays.response_sampled. Loops count from 0. Every function
raises Refused with the firmware's own words; what they say of outputs and inputs counts from 1.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np

from reflux.arrays import _Sampled
from reflux.libreflux import REASON_BYTES, Refused, _array, _check, _d, _doubles, _i, _settings, load

MOST = 4  # loops of a polynomial decoupler
SHAPE_MOST = 8  # loops of a static one
COEFFICIENTS = 32


class DecouplerRefused(Refused):
    """zeros and radii: those of det B, as far as they were found before."""

    def __init__(self, refused: Refused, zeros: np.ndarray, radii: np.ndarray):
        super().__init__(refused.code, str(refused))
        self.zeros, self.radii = zeros, radii


@dataclass(frozen=True)
class Decoupled:
    """u = G v; y_i = h_i/A_ii v_i."""

    g: np.ndarray  # n x n x taps, in z^-1, coefficient 0 first
    h: list[np.ndarray]  # by loop, with its dead time as leading zeros
    zeros: np.ndarray  # of det B, in z
    radii: np.ndarray  # within so much of each there is one
    outermost: float  # largest |zero| with its radius; 0: there is none
    recursive: bool  # what was limited may be taken into G's past
    delay: int  # of det B, samples


@dataclass(frozen=True)
class Placed:
    """(1 - z^-1) P u = R w - Q y; coefficient 0 first."""

    p: np.ndarray
    q: np.ndarray
    r: np.ndarray
    poles: np.ndarray  # polynomial of the closed loop
    radius: float  # of the pair of poles that are placed, angle with it
    angle: float
    condition: float  # of the equations
    residual: float
    overshoot: float  # of the sampled step response
    input_peak: float  # largest |u| on a setpoint step of 1
    sensitivity: float


@dataclass(frozen=True)
class Shape:
    """A static decoupler u = D v with a diagonal of 1. left: largest element of K D off the diagonal of a row over that on it."""

    d: np.ndarray
    gain: np.ndarray  # of each loop with D
    left: np.ndarray
    limited: int = 0  # directions that got no more than the bound


def polynomial(a, b, period: float, **settings) -> Decoupled:
    """settings: element_hi, determinant_lo, zero_hi, recursion_hi."""
    a, b = _array(a), _array(b)
    if a.ndim != 2 or b.ndim != 3 or len(a) != len(b):
        raise ValueError("a is outputs x na, b is outputs x inputs x nb")
    values = _settings("reflux_polynomial_decoupler_defaults", ("element_hi", "determinant_lo", "zero_hi", "recursion_hi"), settings)
    n = max(b.shape[:2])
    g, h = np.zeros((n, n, COEFFICIENTS)), np.zeros((n, COEFFICIENTS))
    taps, h_taps, n_zeros = np.zeros((n, n), np.int32), np.zeros(n, np.int32), ctypes.c_int32()
    zeros, radii, numbers = np.zeros(COEFFICIENTS, np.complex128), np.zeros(COEFFICIENTS), np.zeros(3)
    why = ctypes.create_string_buffer(REASON_BYTES)
    model = _Sampled(b.shape[0], b.shape[1], a.shape[1], b.shape[2], float(period), _d(a), _d(b))
    code = load().reflux_polynomial_decoupler(ctypes.byref(model), _d(values), _d(g), _i(taps), _d(h), _i(h_taps), ctypes.byref(n_zeros),
                                              zeros.ctypes.data_as(_doubles), _d(radii), _d(numbers), why)
    zeros, radii = zeros[: n_zeros.value], radii[: n_zeros.value]
    try:
        _check(code, why)
    except Refused as refused:
        raise DecouplerRefused(refused, zeros, radii) from None
    rows = [h[i, : h_taps[i]] for i in range(n)]
    return Decoupled(g[:, :, : taps.max()], rows, zeros, radii, float(numbers[0]), bool(numbers[1]), int(numbers[2]))


def place(a, b, period: float, overshoot: float, settling_s: float, observer: float = 0.0, condition_hi: float | None = None) -> Placed:
    """a: 1 first; b: 0 first."""
    a, b = _array(a), _array(b)
    if a.ndim != 1 or b.ndim != 1:
        raise ValueError("a and b are polynomials")
    goal = {"overshoot": overshoot, "settling_s": settling_s, "observer": observer}
    if condition_hi is not None:
        goal["condition_hi"] = condition_hi
    values = _settings("reflux_pole_placement_defaults", ("overshoot", "settling_s", "observer", "condition_hi"), goal)
    out, counts, numbers = np.zeros((4, COEFFICIENTS)), np.zeros(4, np.int32), np.zeros(7)
    why = ctypes.create_string_buffer(REASON_BYTES)
    _check(load().reflux_pole_placement(len(a), _d(a), len(b), _d(b), ctypes.c_double(period), _d(values), *map(_d, out), _i(counts), _d(numbers), why), why)
    return Placed(*(row[:n] for row, n in zip(out, counts)), *map(float, numbers))


# ---- static ones, from gains at rest: row k and column k are output and input of loop k ----


def _gains(k) -> np.ndarray:
    k = _array(k)
    if k.ndim != 2 or k.shape[0] != k.shape[1]:
        raise ValueError("gains are a square matrix")
    return k


def partial(k, factors) -> Shape:
    """factors: one number, or one for each element; 0 is none of the decoupler, 1 all of it."""
    k = _gains(k)
    factors, d, gain, left = _array(factors, k.shape), np.zeros_like(k), np.zeros(len(k)), np.zeros(len(k))
    _check(load().reflux_decoupler_partial(len(k), _d(k), _d(factors), _d(d), _d(gain), _d(left)))
    return Shape(d, gain, left)


def one_way(k, ranks) -> Shape:
    """ranks[0] is the loop that no other one disturbs, ranks[1] is disturbed by that alone, and so on."""
    k = _gains(k)
    ranks, d, gain, left = np.array(ranks, np.int32), np.zeros_like(k), np.zeros(len(k)), np.zeros(len(k))
    if ranks.shape != (len(k),):
        raise ValueError("ranks are as many as loops")
    _check(load().reflux_decoupler_one_way(len(k), _d(k), _i(ranks), _d(d), _d(gain), _d(left)))
    return Shape(d, gain, left)


def by_directions(k, condition_hi: float) -> Shape:
    k = _gains(k)
    d, gain, left, limited = np.zeros_like(k), np.zeros(len(k)), np.zeros(len(k)), ctypes.c_int32()
    _check(load().reflux_decoupler_by_directions(len(k), _d(k), ctypes.c_double(condition_hi), _d(d), _d(gain), _d(left), ctypes.byref(limited)))
    return Shape(d, gain, left, limited.value)
