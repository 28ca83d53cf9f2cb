"""A board and a plant in this process: libreflux_lab.so by ctypes (tools/libreflux/lab.h). reflux.Lab is what people use.

The firmware has one instance for each copy of the library, so every bench loads a copy of its own.
"""

from __future__ import annotations

import ctypes
import math
import os
import shutil
import tempfile
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Sequence

import numpy as np

from reflux import logs
from reflux.errors import RunFailed, UserError
from reflux.paths import build_dir
from reflux.session import ASYNCHRONOUS, Refused

LIBRARY = "libreflux_lab.so"
DONE, FAILED, REFUSED = range(3)
LOG, TELEMETRY, CONSOLE = range(3)
LOOSE_MAX = 2000
CHUNK = 500  # samples in one call: Ctrl-C is heard between two

_library_functions = {"time_s": ctypes.c_double, "tick_s": ctypes.c_double, "value": ctypes.c_double, "number": ctypes.c_uint32,
                      "error": ctypes.c_char_p, "channel": ctypes.c_char_p, "text": ctypes.c_void_p}


class Kind(IntEnum):
    """What a channel of the plant is."""

    MV = 0
    DISTURBANCE = 1
    MEASUREMENT = 2
    INTERNAL = 3


@dataclass(frozen=True)
class Channel:
    """A channel of the plant, in engineering units."""

    name: str
    unit: str
    kind: Kind
    lo: float
    hi: float
    nominal: float


def library() -> Path:
    """The library of the host build."""
    path = build_dir("host") / LIBRARY
    if not path.is_file():
        raise RunFailed(f"there is no {path}: cmake --preset host && cmake --build --preset host --target libreflux_lab")
    return path


@dataclass(frozen=True)
class Taken:
    """Samples as text: rows of the simulator, and H, and T, lines of the board."""

    comments: list[str]
    columns: list[str]
    rows: list[str]
    telemetry: list[str]

    def log(self) -> logs.Log | None:
        """As tools/run writes it. None: there were no samples."""
        if not self.rows:
            return None
        simulator = logs.Log(self.columns, [row.split(",") for row in self.rows], self.comments, "the lab's samples")
        if not any(line.startswith("T,") for line in self.telemetry):
            return simulator  # the log is off
        telemetry = logs.telemetry_in(self.telemetry, "the board's telemetry")
        if len(telemetry.rows) < len(simulator.rows):  # `log on N`, or off for a while: empty where there is none
            by_number = dict(zip(telemetry.text("number"), telemetry.rows))
            place, width = telemetry.place("number"), len(telemetry.columns)
            telemetry.rows = [by_number.get(key, ["" if k != place else key for k in range(width)]) for key in simulator.text("number")]
        return logs.join(simulator, telemetry)

    def numbers(self) -> tuple[dict[str, np.ndarray], dict[str, str]] | None:
        """Columns and units, as lab_log.numbers(log()) and much faster. None: it takes log(), as where the columns changed on the way."""
        heads = [line for line in self.telemetry if line.startswith("H,")]
        if len(heads) != 1 or len(self.telemetry) != len(self.rows) + 1 or not self.rows:
            return None
        names = heads[0].split(",")[2:]
        try:
            own = np.loadtxt(self.rows, delimiter=",", ndmin=2)
            board = np.loadtxt([line.split(",", 2)[2] for line in self.telemetry[1:]], delimiter=",", ndmin=2)
        except ValueError:
            return None
        if own.shape[1] != len(self.columns) or board.shape[1] != len(names) or not np.array_equal(own[:, 0], board[:, 0]):
            return None
        with np.errstate(over="ignore"):
            board = board.astype(np.float32).astype(float)
        columns = {logs.bare(name): own[:, k] for k, name in enumerate(self.columns)}
        columns |= {logs.FIRMWARE_PREFIX + logs.bare(name): board[:, k] for k, name in enumerate(names) if k > 0}
        units = {logs.bare(name): logs.unit(name) for name in self.columns}
        return columns, units | {logs.FIRMWARE_PREFIX + logs.bare(name): logs.unit(name) for name in names[1:]}


class InProcess:
    """Firmware and plant, moved sample by sample."""

    def __init__(self, plant: str, options: Sequence[str] = ()):
        self._c: ctypes.CDLL | None = _copy(library())
        try:
            words = [os.fsencode(word) for word in ("--plant", plant, *options)]
            self._check(self._call("open", len(words), (ctypes.c_char_p * len(words))(*words)))
            self.channels = self._channels()
        except BaseException:
            self.close()
            raise
        self._loose = 0  # samples that nobody wants
        self._header = ""
        self._columns: list[str] = []
        self._comments: list[str] = []

    # ---- calls ----

    def _call(self, name: str, *arguments):  # type: ignore[no-untyped-def]
        if self._c is None:
            raise RunFailed("the lab is closed")
        return getattr(self._c, f"reflux_lab_{name}")(*arguments)

    def _check(self, code: int) -> None:
        if code != DONE:
            raise (UserError if code == REFUSED else RunFailed)(self._call("error").decode(errors="replace"))

    def _text(self, which: int) -> str:
        length = ctypes.c_size_t()
        place = self._call("text", which, ctypes.byref(length))
        return ctypes.string_at(place, length.value).decode("latin-1")

    def _channels(self) -> dict[str, Channel]:
        out: dict[str, Channel] = {}
        unit, kind, numbers = ctypes.c_char_p(), ctypes.c_int32(), [ctypes.c_double() for _ in range(3)]
        while name := self._call("channel", len(out), ctypes.byref(unit), ctypes.byref(kind), *map(ctypes.byref, numbers)):
            out[name.decode()] = Channel(name.decode(), (unit.value or b"-").decode(), Kind(kind.value), *(x.value for x in numbers))
        return out

    # ---- what reflux.Lab calls ----

    def say(self, text: str) -> list[str]:
        """The lines of the reply; Refused with the console's words."""
        self._text(CONSOLE)  # what the board said before is no part of the reply
        code = self._call("say", text.encode("latin-1", "replace"))
        if code == REFUSED:
            raise Refused(self._call("error").decode(errors="replace"))
        self._check(code)
        said = [line.split(" ", 2)[2] for line in self._text(CONSOLE).splitlines() if " < " in line[:24]]
        return [line for line in said if line != "ok" and not line.startswith(ASYNCHRONOUS)]

    def event(self, at_s: float, name: str, value: float) -> None:
        text = f"{at_s:.17g}:{name}={value:.17g}"
        try:
            self._check(self._call("event", text.encode("utf-8", "replace").replace(b"\0", b"?")))
        except UserError as error:  # the option is none of the caller's words
            raise UserError(str(error).removeprefix(f"--event {text}: ")) from None

    def step(self, samples: int, keep: bool = True) -> None:
        """keep: the samples are for take(). Those that are not kept are gone by then."""
        if keep and self._loose:
            self.take()
        while samples > 0:
            part = min(samples, CHUNK)
            self._loose += 0 if keep else part
            self._check(self._call("step", part))
            samples -= part
            if self._loose > LOOSE_MAX:
                self.take()

    def take(self) -> Taken:
        """Samples since the last call."""
        self._loose = 0
        self._text(CONSOLE)
        rows = self._text(LOG).splitlines()
        telemetry = self._text(TELEMETRY).splitlines()
        headers = [line for line in telemetry if line.startswith("H,")]
        self._comments += [line for line in rows if line.startswith("#")]
        rows = [line for line in rows if line and line[0] != "#"]
        if rows and not rows[0][0].isdigit():
            self._columns = rows.pop(0).split(",")
        if self._header and not telemetry[:1] == headers[:1]:
            telemetry.insert(0, self._header)
        self._header = headers[-1] if headers else self._header
        return Taken(list(self._comments), self._columns, rows, telemetry)

    def value(self, name: str) -> float:
        """NaN: the plant has no such channel, or there was no sample yet."""
        return float(self._call("value", name.encode())) if name in self.channels else math.nan

    @property
    def names(self) -> list[str]:
        return list(self.channels)

    @property
    def time_s(self) -> float:
        return float(self._call("time_s"))

    @property
    def tick_s(self) -> float:
        return float(self._call("tick_s"))

    def samples_before(self, time_s: float) -> int:
        """Samples still to come before this plant time."""
        return max(0, math.ceil((time_s - self.time_s) / self.tick_s - 1e-9))

    def close(self) -> None:
        if self._c is not None:
            self._call("close")
            handle, self._c = self._c._handle, None
            _unload(handle)


def _copy(path: Path) -> ctypes.CDLL:
    """The file may go as soon as it is loaded."""
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        try:
            ctypes.CDLL(str(path))  # with what it needs, which in a wheel is found from its own folder only
            c = ctypes.CDLL(shutil.copy(path, folder))
        except OSError as error:
            raise RunFailed(f"{path} cannot be loaded: {error}") from None
    for name, result in _library_functions.items():
        getattr(c, f"reflux_lab_{name}").restype = result
    return c


def _unload(handle: int) -> None:
    close = ctypes.CDLL(None).dlclose
    close.argtypes = [ctypes.c_void_p]
    close(handle)
