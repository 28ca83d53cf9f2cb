"""Arrays of frequency responses, computed by the firmware's code in double (libreflux.so): direct and inverse Nyquist arrays,
Gershgorin's radii, constant compensators, characteristic loci.

    f = arrays.response_sampled(a, b, period, omega)        # points x n x n
    found = arrays.array(f, g)                              # (F G)^-1 and how dominant it is
    g, numbers = arrays.search(f, g)
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np

from reflux import libreflux
from reflux.libreflux import Refused, _check, _d, _doubles

KINDS = ("add", "scale", "swap")
BY = ("rows", "columns")


class _Sampled(ctypes.Structure):
    _fields_ = [("outputs", ctypes.c_int32), ("inputs", ctypes.c_int32), ("na", ctypes.c_int32), ("nb", ctypes.c_int32),
                ("period", ctypes.c_double), ("a", _doubles), ("b", _doubles)]


@dataclass(frozen=True)
class Array:
    """At each frequency: the array, points x n x n; of its diagonal elements radius and ratio by rows and by columns, points x n."""

    values: np.ndarray
    radius: dict[str, np.ndarray]
    ratio: dict[str, np.ndarray]

    def worst(self, by: str) -> np.ndarray:
        """Returns for each row (column) the largest ratio over frequency."""
        return self.ratio[by].max(axis=0)


def response(plant: libreflux.Plant, omega) -> np.ndarray:
    """First-order elements with exact dead time at s = i omega."""
    omega = np.ascontiguousarray(omega, float)
    out = np.zeros((len(omega), plant.outputs, plant.inputs), np.complex128)
    _check(libreflux.load().reflux_response(plant._c(), len(omega), _d(omega), out.ctypes.data_as(_doubles)))
    return out


def response_sampled(a, b, period: float, omega) -> np.ndarray:
    """a: outputs x na, b: outputs x inputs x nb, coefficients of z^-1 on; at z = exp(i omega period)."""
    a, b, omega = (np.ascontiguousarray(x, float) for x in (a, b, omega))
    out = np.zeros((len(omega), *b.shape[:2]), np.complex128)
    model = _Sampled(b.shape[0], b.shape[1], a.shape[1], b.shape[2], float(period), _d(a), _d(b))
    _check(libreflux.load().reflux_response_sampled(ctypes.byref(model), len(omega), _d(omega), out.ctypes.data_as(_doubles)))
    return out


def array(f: np.ndarray, g: np.ndarray, inverse: bool = True) -> Array:
    f, g = np.ascontiguousarray(f, np.complex128), np.ascontiguousarray(g, float)
    points, n = f.shape[:2]
    at, failed = np.zeros_like(f), ctypes.c_int32()
    tables = [np.zeros((points, n)) for _ in range(4)]
    code = libreflux.load().reflux_array(n, points, f.ctypes.data_as(_doubles), _d(g), int(inverse), at.ctypes.data_as(_doubles), *map(_d, tables),
                                         ctypes.byref(failed))
    if code:
        raise Refused(code, f"{libreflux.load().reflux_error_text(code).decode()} at frequency {failed.value + 1} of {points}")
    return Array(at, dict(zip(BY, tables[:2])), dict(zip(BY, tables[2:])))


def operate(g: np.ndarray, kind: str, row: int, other: int = 0, by: float = 1.0) -> np.ndarray:
    """G after an elementary operation on the rows of the inverse; rows from 0."""
    g = np.array(g, float)
    _check(libreflux.load().reflux_array_operate(len(g), _d(g), KINDS.index(kind), row, other, ctypes.c_double(by)))
    return g


def align(f: np.ndarray) -> np.ndarray:
    """The real G that makes F G most like a diagonal of phases, F at one frequency."""
    f = np.ascontiguousarray(f, np.complex128)
    g = np.zeros(f.shape)
    _check(libreflux.load().reflux_array_align(len(f), f.ctypes.data_as(_doubles), _d(g)))
    return g


def normalise(g: np.ndarray) -> tuple[np.ndarray, bool]:
    """Columns over their diagonal elements, and whether all could be."""
    g, whole = np.array(g, float), ctypes.c_int32()
    _check(libreflux.load().reflux_array_normalise(len(g), _d(g), ctypes.byref(whole)))
    return g, bool(whole.value)


def search(f: np.ndarray, g: np.ndarray, by: str = "rows", starts: int = 8, seed: int = 1) -> tuple[np.ndarray, dict[str, float]]:
    """The constant G with the least of the largest ratio, and that ratio before and after."""
    f, g, numbers = np.ascontiguousarray(f, np.complex128), np.array(g, float), np.zeros(4)
    _check(libreflux.load().reflux_array_search(len(g), len(f), f.ctypes.data_as(_doubles), BY.index(by), starts, seed, _d(g), _d(numbers)))
    return g, dict(zip(("before", "after", "looks", "lambda"), numbers))


def loci(f: np.ndarray, g: np.ndarray) -> np.ndarray:
    """Eigenvalues of F G, points x n, each column one locus."""
    f, g = np.ascontiguousarray(f, np.complex128), np.ascontiguousarray(g, float)
    out = np.zeros(f.shape[:2], np.complex128)
    _check(libreflux.load().reflux_loci(len(g), len(f), f.ctypes.data_as(_doubles), _d(g), out.ctypes.data_as(_doubles)))
    return out
