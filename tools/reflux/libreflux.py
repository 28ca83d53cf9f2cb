"""The firmware's analysis and design, in double: libreflux.so by ctypes. What is drawn is what the firmware computes.

    from reflux import libreflux
    plant = libreflux.Plant(gain, dead_time, time_constant)      # p x m arrays, gains in spans, times in s
    libreflux.rga(plant)
    pairing = libreflux.pairing(plant)
    loops = libreflux.detune(plant, pairing["pairs"], interval=1.0)

Channels count from 0. Every function raises Refused with the firmware's own words.
"""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np

from reflux import given
from reflux.errors import RunFailed, UserError
from reflux.paths import build_dir

ROOM = 16
REASON_BYTES = 200
TIMEOUT = -18
VERDICTS = ("determined", "undetermined", "singular", "impossible")

_doubles = ctypes.POINTER(ctypes.c_double)
_ints = ctypes.POINTER(ctypes.c_int32)


class Refused(RunFailed):
    """An error of the firmware; code is the one of base/error.h."""

    def __init__(self, code: int, text: str):
        super().__init__(text)
        self.code = code


class _Plant(ctypes.Structure):
    _fields_ = [("outputs", ctypes.c_int32), ("inputs", ctypes.c_int32), ("gain", _doubles), ("dead", _doubles),
                ("constant", _doubles), ("sd", _doubles)]


class _Loops(ctypes.Structure):
    _fields_ = [("n", ctypes.c_int32), ("output", _ints), ("input", _ints), ("gain", _doubles), ("ti", _doubles),
                ("interval", ctypes.c_double), ("decoupler", _doubles)]


_library: ctypes.CDLL | None = None


def load(path: Path | str | None = None) -> ctypes.CDLL:
    """The library of the host build, or the one named. Called by everything else."""
    global _library
    if _library is None or path:
        path = Path(path) if path else build_dir("host") / "libreflux.so"
        if not path.is_file():
            raise RunFailed(f"there is no {path}: cmake --preset host && cmake --build --preset host --target libreflux")
        _library = ctypes.CDLL(str(path))
        _library.reflux_error_text.restype = ctypes.c_char_p
    return _library


def _check(code: int, why: ctypes.Array | None = None, allowed: tuple[int, ...] = ()) -> int:
    if code and code not in allowed:
        text = load().reflux_error_text(code).decode()
        detail = why.value.decode() if why is not None else ""
        raise Refused(code, f"{text}: {detail}" if detail else text)
    return code


def _array(values, shape=None) -> np.ndarray:
    a = np.ascontiguousarray(values, dtype=np.float64)
    return a if shape is None else np.ascontiguousarray(np.broadcast_to(a, shape))


def _d(a: np.ndarray | None):
    return None if a is None else a.ctypes.data_as(_doubles)


def _i(a: np.ndarray):
    return a.ctypes.data_as(_ints)


class Plant:
    """p outputs x m inputs; anything that broadcasts to the gains' shape for the rest."""

    def __init__(self, gain, dead_time=0.0, time_constant=0.0, gain_sd=0.0):
        self.gain = _array(gain)
        if self.gain.ndim != 2:
            raise ValueError("gains are a matrix")
        self.dead_time, self.time_constant, self.gain_sd = (_array(x, self.gain.shape)
                                                            for x in (dead_time, time_constant, gain_sd))
        self.outputs, self.inputs = self.gain.shape

    def _c(self):
        return ctypes.byref(_Plant(self.outputs, self.inputs, _d(self.gain), _d(self.dead_time),
                                   _d(self.time_constant), _d(self.gain_sd)))


class Loops:
    """Loop k: output and input of pairs[k], gain with the action's sign, integral time (s)."""

    def __init__(self, pairs, gain, ti, interval: float, decoupler=None):
        self.pairs = [(int(a), int(b)) for a, b in pairs]
        self.gain, self.ti, self.interval = _array(gain), _array(ti), float(interval)
        self.decoupler = None if decoupler is None else _array(decoupler)
        self._output, self._input = _pair_arrays(self.pairs)

    def _c(self):
        return ctypes.byref(_Loops(len(self.pairs), _i(self._output), _i(self._input), _d(self.gain), _d(self.ti),
                                   self.interval, _d(self.decoupler)))


def _pair_arrays(pairs):
    return (np.array([a for a, _ in pairs], dtype=np.int32), np.array([b for _, b in pairs], dtype=np.int32))


def rga(plant: Plant) -> np.ndarray:
    out = np.zeros_like(plant.gain)
    _check(load().reflux_rga(plant._c(), _d(out)))
    return out


def rga_at(plant: Plant, omega) -> tuple[np.ndarray, np.ndarray]:
    """Modulus and real part, each len(omega) x p x m."""
    omega = _array(omega)
    shape = (len(omega), plant.outputs, plant.inputs)
    modulus, real = np.zeros(shape), np.zeros(shape)
    _check(load().reflux_rga_at(plant._c(), len(omega), _d(omega), _d(modulus), _d(real)))
    return modulus, real


def gains(plant: Plant, floor: float = 0.005) -> dict:
    singular, numbers = np.zeros(ROOM), np.zeros(5)
    inputs, outputs = np.zeros(ROOM * plant.inputs), np.zeros(ROOM * plant.outputs)
    _check(load().reflux_gains(plant._c(), ctypes.c_double(floor), _d(singular), _d(numbers), _d(inputs), _d(outputs)))
    rank = int(numbers[2])
    return {"singular": singular[:min(plant.gain.shape)], "condition": numbers[0], "condition_scaled": numbers[1],
            "rank": rank, "rank_exact": int(numbers[3]), "smallest_in_sd": numbers[4],
            "null_inputs": inputs.reshape(ROOM, -1)[:plant.inputs - rank],
            "null_outputs": outputs.reshape(ROOM, -1)[:plant.outputs - rank]}


def pairing(plant: Plant, **settings) -> dict:
    """settings: smallest_lambda, floor, confidence, draws, seed, outputs_out, inputs_out (bits)."""
    names = ("smallest_lambda", "floor", "confidence", "draws", "seed", "outputs_out", "inputs_out")
    values = _settings("reflux_pairing_defaults", names, settings)
    n, output, inputs = ctypes.c_int32(), np.zeros(ROOM, np.int32), np.zeros(ROOM, np.int32)
    lam, numbers, share, rival = np.zeros(ROOM), np.zeros(4), np.zeros(ROOM), np.zeros(ROOM, np.int32)
    why = ctypes.create_string_buffer(REASON_BYTES)
    _check(load().reflux_pairing(plant._c(), _d(values), ctypes.byref(n), _i(output), _i(inputs), _d(lam), _d(numbers),
                                 _d(share), _i(rival), why), why)
    return {"pairs": [(int(output[k]), int(inputs[k])) for k in range(n.value)], "lambda": lam[:n.value],
            "verdict": VERDICTS[int(numbers[0])], "niederlinski": numbers[1], "cost": numbers[2],
            "probability": numbers[3], "share": share[:plant.outputs], "rival": rival[:plant.outputs]}


def measure(plant: Plant, pairs, shortest: float = 1.0) -> dict:
    """Relative gains, RNGA and RARTA of the paired square plant, in the order of the pairs."""
    n = len(pairs)
    output, inputs = _pair_arrays(pairs)
    out = [np.zeros((n, n)) for _ in range(3)]
    _check(load().reflux_measure(plant._c(), n, _i(output), _i(inputs), ctypes.c_double(shortest), *map(_d, out)))
    return dict(zip(("lambda", "phi", "gamma"), out))


def structure(plant: Plant, pairs) -> dict:
    n = len(pairs)
    output, inputs = _pair_arrays(pairs)
    effect, uncertain = (np.zeros(plant.gain.shape, np.int32) for _ in range(2))
    part, block, mimo = (np.zeros(ROOM, np.int32) for _ in range(3))
    worst = np.zeros(ROOM)
    _check(load().reflux_structure(plant._c(), n, _i(output), _i(inputs), _i(effect), _i(uncertain), _i(part), _i(block),
                                   _i(mimo), _d(worst)))
    return {"effect": effect.astype(bool), "uncertain": uncertain.astype(bool), "part": part[:plant.outputs],
            "block": block[:n], "mimo": mimo[:n].astype(bool), "worst_lambda": worst[:int(block[:n].max(initial=-1)) + 1]}


def cascades(plant: Plant) -> list[dict]:
    found, which, between = ctypes.c_int32(), np.zeros(2 * ROOM, np.int32), np.zeros(4 * ROOM)
    _check(load().reflux_cascades(plant._c(), ctypes.byref(found), _i(which), _d(between)))
    return [{"inner": int(which[2 * k]), "outer": int(which[2 * k + 1]),
             **dict(zip(("gain", "dead_time", "time_constant", "misfit_sd"), between[4 * k:4 * k + 4]))}
            for k in range(found.value)]


def detune(plant: Plant, pairs, interval: float, decoupler=None, **settings) -> tuple[Loops, dict]:
    """Loops and figures. settings: db_per_loop, db_most, gain_margin, factor_hi, gain_hi. The figure `kept` says whether
    the distance from instability was reached."""
    names = ("db_per_loop", "db_most", "gain_margin", "factor_hi", "gain_hi")
    values = _settings("reflux_detune_defaults", names, settings)
    n = len(pairs)
    output, inputs = _pair_arrays(pairs)
    gain, ti, numbers = np.zeros(n), np.zeros(n), np.zeros(4)
    d = None if decoupler is None else _array(decoupler)
    why = ctypes.create_string_buffer(REASON_BYTES)
    code = _check(load().reflux_detune(plant._c(), n, _i(output), _i(inputs), ctypes.c_double(interval), _d(d),
                                       _d(values), _d(gain), _d(ti), _d(numbers), why), why, (TIMEOUT,))
    return Loops(pairs, gain, ti, interval, d), {"factor": numbers[0], "log_modulus_db": numbers[1],
                                                 "omega": numbers[2], "tried": int(numbers[3]), "kept": code == 0}


def nyquist(plant: Plant, loops: Loops, gain_times: float = 1.0) -> dict:
    numbers = np.zeros(4)
    _check(load().reflux_nyquist(plant._c(), loops._c(), ctypes.c_double(gain_times), _d(numbers)))
    return {"stable": bool(numbers[0]), "log_modulus_db": numbers[1], "omega": numbers[2], "points": int(numbers[3])}


def open_loop(plant: Plant, loops: Loops, omega: float) -> np.ndarray:
    n = len(loops.pairs)
    out = np.zeros((n, n), np.complex128)
    _check(load().reflux_open_loop(plant._c(), loops._c(), ctypes.c_double(omega), out.ctypes.data_as(_doubles)))
    return out


def trial(plant: Plant, loops: Loops, loop: int = 0, load_step: bool = False, size: float = 0.01, duration: float = 0.0,
          setpoint_weight: float = 1.0) -> dict:
    """A step on the model: times, outputs (times x loops), and the figures of every loop."""
    n, room = len(loops.pairs), 2600
    settings = _array([loop, load_step, size, duration, setpoint_weight])
    rows, n_rows, numbers = np.zeros((room, n + 1)), ctypes.c_int32(), np.zeros(4 * n + 3)
    _check(load().reflux_trial(plant._c(), loops._c(), _d(settings), room, _d(rows), ctypes.byref(n_rows), _d(numbers)))
    rows = rows[:n_rows.value]
    by_loop = numbers[:4 * n].reshape(n, 4)
    return {"time": rows[:, 0], "y": rows[:, 1:], "iae": by_loop[:, 0], "peak": by_loop[:, 1], "settled": by_loop[:, 2],
            "moved": by_loop[:, 3], "bounded": bool(numbers[4 * n]), "coarse": bool(numbers[4 * n + 1]),
            "sample": numbers[4 * n + 2]}


def decoupler(plant: Plant, pairs, **settings) -> dict:
    """settings: element_hi, lambda_hi, significance, floor, left_hi."""
    names = ("element_hi", "lambda_hi", "significance", "floor", "left_hi")
    values = _settings("reflux_decoupler_defaults", names, settings)
    n = len(pairs)
    output, inputs = _pair_arrays(pairs)
    d, gain, sd, left = np.zeros((n, n)), np.zeros(n), np.zeros(n), ctypes.c_double()
    why = ctypes.create_string_buffer(REASON_BYTES)
    _check(load().reflux_decoupler(plant._c(), n, _i(output), _i(inputs), _d(values), _d(d), _d(gain), _d(sd),
                                   ctypes.byref(left), why), why)
    return {"d": d, "gain": gain, "gain_sd": sd, "left_sd": left.value}


def _settings(defaults: str, names: tuple[str, ...], settings: dict) -> np.ndarray:
    values = np.zeros(len(names))
    getattr(load(), defaults)(_d(values))
    for name, value in settings.items():
        if name not in names:
            raise UserError(f"there is no setting {name}; there are {', '.join(names)}")
        values[names.index(name)] = given.number(value, name)
    return values
