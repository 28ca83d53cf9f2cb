"""Normalised innovations of each thermometer over time, and how they go together from tick to tick."""

from __future__ import annotations

import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first
import numpy as np  # noqa: E402

from reflux.innovations import Series, Statistics, autocorrelation  # noqa: E402
from reflux.plots import BLUE, GREY, ORANGE, STYLE, finish  # noqa: E402

LAGS = 40
RUNNING = 60  # ticks of the running mean


def draw(title: str, series: list[Series], statistics: list[Statistics | None], time_s: list[float]) -> bytes:
    """PNG."""
    at = np.array(time_s) / 3600
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(len(series), 2, figsize=(9.6, 0.8 + 1.9 * len(series)), squeeze=False, sharex="col", width_ratios=(3, 1))
        for (left, right), s, known in zip(axes, series, statistics):
            left.set_ylabel(f"{s.sensor.name}, sd")
            if known is None:
                continue
            u = s.e / np.sqrt(s.variance)
            left.plot(at[s.tick], u, ".", color=BLUE, alpha=0.35, markersize=2)
            width = min(RUNNING, len(u))
            left.plot(at[s.tick][width - 1 :], np.convolve(u, np.full(width, 1 / width), "valid"), color=ORANGE, linewidth=1.3)
            for y in (-2, 2):
                left.axhline(y, color=GREY, linewidth=0.9, linestyle=(0, (4, 3)))
            left.set_title(f"NIS {known.nis:.2f}, mean {known.mean:+.2f}", fontsize=8)
            lags = min(LAGS, len(u) // 4)
            right.bar(range(1, lags + 1), autocorrelation(u, s.tick, lags), width=0.8, color=BLUE)
            for y in (-2, 2):
                right.axhline(y / math.sqrt(len(u)), color=GREY, linewidth=0.9, linestyle=(0, (4, 3)))
            right.set_ylim(-1.05, 1.05)
            right.set_title(f"correlation {known.rho:+.2f}", fontsize=8)
        axes[-1][0].set_xlabel("plant time, h")
        axes[-1][1].set_xlabel("lag, ticks")
        figure.suptitle(title, x=0.01, ha="left", fontsize=10, fontweight="bold")
        return finish(figure, "consistency", title, with_svg=False).png
