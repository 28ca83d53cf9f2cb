"""Decoupling by state feedback, designed by the firmware's code in double (libreflux.so):

    found = state_decoupler.design(a, b, c, e, [[-0.3], [-0.3]], feedforward="states")
    u = found.f @ x + found.g @ w + found.tf @ d

a is n x n, b n x loops, c loops x n, e n x disturbances, per second (or for a period). Poles are a list for each loop, as many as its index
and one more. A refusal is raised as StateRefused with the firmware's own words, and what was found before.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np

from reflux.libreflux import REASON_BYTES, Refused, _array, _check, _d, _doubles, _i, _ints, _settings, load

POLES = 4
FEEDFORWARDS = ("none", "states", "outputs")


class _Model(ctypes.Structure):
    _fields_ = [("n", ctypes.c_int32), ("loops", ctypes.c_int32), ("disturbances", ctypes.c_int32), ("period", ctypes.c_double),
                ("a", _doubles), ("b", _doubles), ("c", _doubles), ("e", _doubles)]


class _Goal(ctypes.Structure):
    _fields_ = [("poles", _doubles), ("integral", _doubles), ("derivative", _doubles), ("feedforward", ctypes.c_int32),
                ("hold", ctypes.c_double)]


class _Found(ctypes.Structure):
    _fields_ = [("index", _ints), ("n_zeros", _ints), ("needed", _ints), *((name, _doubles) for name in (
        "f", "g", "tf", "b_star", "m", "k_star", "zeros", "numbers"))]


@dataclass(frozen=True)
class Design:
    index: np.ndarray
    f: np.ndarray
    g: np.ndarray
    tf: np.ndarray
    b_star: np.ndarray
    m: list[np.ndarray]  # of each loop m_0 to m_index
    k_star: np.ndarray
    zeros: np.ndarray
    needed: list[int]  # states that count, from 0
    condition: float  # of B*
    neglected: float  # largest cosine that counted as 0
    radius: float  # of the loop as sampled; 0: not judged


class StateRefused(Refused):
    """found: as far as it went; loops that were not come to have index 0 and no gains."""

    def __init__(self, refused: Refused, found: Design):
        super().__init__(refused.code, str(refused))
        self.found = found


def _model(a: Any, b: Any, c: Any, e: Any, period: float) -> tuple[_Model, tuple[np.ndarray, ...]]:
    a, b, c = _array(a), _array(b), _array(c)
    e = np.zeros((len(a), 0)) if e is None else _array(e)
    if a.ndim != 2 or b.shape[:1] != a.shape[:1] or c.shape[1:] != a.shape[1:] or len(e) != len(a) or len(c) != b.shape[1]:
        raise ValueError("a is n x n, b n x loops, c loops x n, e n x disturbances")
    return _Model(len(a), b.shape[1], e.shape[1], float(period), _d(a), _d(b), _d(c), _d(e)), (a, b, c, e)


def design(a: Any, b: Any, c: Any, e: Any, poles: Any, *, period: float = 0.0, integral: Any = 0.0, derivative: Any = 0.0,
           feedforward: str = "none", hold: float = 0.0, **settings: float) -> Design:
    """settings: row_lo, condition_hi, weight_lo. integral and derivative: times in s, of all loops or by loop, 0: none."""
    model, (a, b, c, e) = _model(a, b, c, e, period)
    n, loops, room = len(a), len(c), e.shape[1] if feedforward != "none" else 0
    asked = np.full((loops, POLES), poles[0][0], np.complex128)
    for i, row in enumerate(poles):
        asked[i, : len(row)] = row
    integral, derivative = _array(integral, (loops,)), _array(derivative, (loops,))
    goal = _Goal(asked.ctypes.data_as(_doubles), _d(integral), _d(derivative), FEEDFORWARDS.index(feedforward), float(hold))
    index, n_zeros, needed = np.zeros(loops, np.int32), np.zeros(1, np.int32), np.zeros(1, np.int32)
    shapes = ((loops, n), (loops, loops), (loops, room), (loops, loops), (loops, POLES), (loops,), (2 * n,), (5,))
    out = [np.zeros(shape) for shape in shapes]
    f, g, tf, b_star, m, k_star, zeros, numbers = out
    why = ctypes.create_string_buffer(REASON_BYTES)
    values = _settings("reflux_state_decoupler_defaults", ("row_lo", "condition_hi", "weight_lo"), settings)
    found = _Found(_i(index), _i(n_zeros), _i(needed), *map(_d, out))
    code = load().reflux_state_decoupler(ctypes.byref(model), _d(values), ctypes.byref(goal), ctypes.byref(found), why)
    result = Design(index, f, g, tf, b_star, [m[i, : index[i] + 1] for i in range(loops)], k_star,
                    zeros.view(np.complex128)[: n_zeros[0]], [k for k in range(n) if needed[0] >> k & 1], *numbers[[0, 1, 4]].tolist())
    try:
        _check(code, why)
    except Refused as refused:
        raise StateRefused(refused, result) from None
    return result


def sample(a: Any, b: Any, e: Any, period: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A, B and E of a continuous model as samples see it."""
    b = _array(b)
    model, (a, b, _, e) = _model(a, b, np.zeros((b.shape[1], len(b))), e, 0.0)
    out = [np.zeros_like(x) for x in (a, b, e)]
    _check(load().reflux_state_sample(ctypes.byref(model), ctypes.c_double(period), *map(_d, out)))
    return out[0], out[1], out[2]
