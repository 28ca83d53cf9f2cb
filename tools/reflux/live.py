"""Telemetry as it comes: chosen channels as pictures or as lines of a terminal."""

from __future__ import annotations

import math
import os
import sys
import time
from collections import deque
from pathlib import Path

from reflux.errors import RunFailed, UserError
from reflux.logs import TELEMETRY_VERSION, bare, unit
from reflux.paths import shown

BARS = "▁▂▃▄▅▆▇█"
ROWS_KEPT = 20000


class Channels:
    """Takes telemetry lines, keeps the last rows of the channels asked for."""

    def __init__(self, names: list[str]):
        self.names = names
        self.units = {name: "" for name in names}
        self.times: deque[float] = deque(maxlen=ROWS_KEPT)
        self.values: dict[str, deque[float]] = {name: deque(maxlen=ROWS_KEPT) for name in names}
        self.columns: list[str] = []
        self.rows = 0

    def take(self, line: str) -> bool:
        """True when a row has been added."""
        cells = line.split(",")
        if line.startswith("H,"):
            self._header(cells)
        elif line.startswith("T,") and self.columns:
            return self._row(cells[2:])
        return False

    def _header(self, cells: list[str]) -> None:
        if cells[1] != TELEMETRY_VERSION:
            raise RunFailed(f"telemetry of version {cells[1]}; this program knows {TELEMETRY_VERSION}")
        self.columns = [bare(c) for c in cells[2:]]
        for name in self.names:
            if name not in self.columns:
                raise UserError(f"no channel {name}; there are {', '.join(self.columns)}")
            self.units[name] = unit(cells[2 + self.columns.index(name)])

    def _row(self, cells: list[str]) -> bool:
        if len(cells) != len(self.columns):
            return False  # lost its beginning or its end
        try:
            values = [float(cells[self.columns.index(name)] or "nan") for name in self.names]
            at = float(cells[self.columns.index("time")])
        except ValueError:
            return False
        if self.times and at < self.times[-1]:  # the plant began anew
            self.times.clear()
            for kept in self.values.values():
                kept.clear()
        self.times.append(at)
        for name, value in zip(self.names, values):
            self.values[name].append(value)
        self.rows += 1
        return True


def sparkline(values: list[float], width: int) -> str:
    """The last values, one character each, between the least and the largest of them."""
    last = values[-width:]
    known = [v for v in last if math.isfinite(v)]
    low, high = (min(known), max(known)) if known else (0.0, 0.0)
    step = (high - low) / (len(BARS) - 1)
    return "".join(" " if not math.isfinite(v) else BARS[round((v - low) / step) if step > 0 else 0] for v in last)


class SparkView:
    """One line a channel, written over on a terminal."""

    def __init__(self, channels: Channels):
        self.channels = channels
        self.drawn = 0
        self.last = 0.0
        self.terminal = sys.stdout.isatty()

    def text(self) -> list[str]:
        width = max((len(n) for n in self.channels.names), default=0)
        out = []
        for name in self.channels.names:
            values = list(self.channels.values[name])
            room = max(10, (os.get_terminal_size().columns if self.terminal else 80) - width - 26)
            now = f"{values[-1]:.4g}" if values else "-"
            out.append(f"{name:{width}s} {now:>9s} {self.channels.units[name]:8s} {sparkline(values, room)}")
        return out

    def update(self, final: bool = False) -> None:
        now = time.monotonic()
        if not self.channels.rows or not (final or (self.terminal and now - self.last > 0.2)):
            return
        self.last = now
        up = f"\033[{self.drawn}A" if self.drawn else ""
        clear = "\033[K" if self.terminal else ""
        lines = self.text()
        print(up + "\n".join(clear + line for line in lines), flush=True)
        self.drawn = len(lines) if self.terminal else 0


class PictureView:
    """matplotlib: a window where there is a display, else a PNG file that is written again and again."""

    def __init__(self, channels: Channels, png: Path | None, every_s: float):
        import matplotlib
        self.png = png
        if png is None and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
            self.png = Path("reflux-console.png")
        if self.png:
            matplotlib.use("Agg")
        import matplotlib.pyplot as plt
        self.plt = plt
        if not self.png and matplotlib.get_backend().lower() == "agg":
            self.png = Path("reflux-console.png")  # a display, but no toolkit for it
        self.channels, self.every_s, self.last = channels, every_s, 0.0
        self.figure, axes = plt.subplots(len(channels.names), 1, sharex=True, squeeze=False,
                                         figsize=(9, 1 + 2 * len(channels.names)))
        self.axes = [row[0] for row in axes]
        self.lines = [axis.plot([], [], lw=1.2)[0] for axis in self.axes]
        if not self.png:
            plt.ion()
            plt.show(block=False)

    def update(self, final: bool = False) -> None:
        now = time.monotonic()
        if not self.channels.rows or (not final and now - self.last < (self.every_s if self.png else 0.2)):
            return
        self.last = now
        for name, axis, line in zip(self.channels.names, self.axes, self.lines):
            line.set_data(list(self.channels.times), list(self.channels.values[name]))
            axis.relim()
            axis.autoscale_view()
            axis.set_ylabel(f"{name} [{self.channels.units[name]}]")
            axis.grid(True, color="#e4e7eb")
        self.axes[-1].set_xlabel("plant time [s]")
        if not self.png:
            self.figure.canvas.draw_idle()
            self.figure.canvas.flush_events()
            return
        fresh = self.png.with_name(self.png.name + ".new")
        try:
            self.figure.savefig(fresh, format="png", dpi=110)
            fresh.replace(self.png)  # a viewer never sees half a picture
        except OSError as error:
            raise UserError(f"{shown(self.png)} cannot be written: {error.strerror}") from None
