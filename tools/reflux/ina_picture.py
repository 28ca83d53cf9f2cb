"""Nyquist arrays with Gershgorin's bands, characteristic loci, and dominance against frequency."""

from __future__ import annotations

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first
import numpy as np  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.ticker import MaxNLocator  # noqa: E402

from reflux import arrays  # noqa: E402
from reflux.ina_plant import SquarePlant  # noqa: E402
from reflux.plots import BLUE, GREEN, GREY, ORANGE, STYLE, finish  # noqa: E402

CIRCLES, BELOW = 60, 2.4
NAMES = {"inverse": "inverse Nyquist array", "direct": "direct Nyquist array", "loci": "characteristic loci"}
COLOURS = (BLUE, ORANGE, GREEN, "#7b4fa3", "#b2182b", "#4d9221", "#8c6d31", GREY)


def draw(plant: SquarePlant, omega: np.ndarray, f: np.ndarray, g: np.ndarray, by: str, view: str, done: list[str]) -> bytes:
    """PNG."""
    with plt.rc_context(STYLE):
        figure = Figure(figsize=size(plant.n))  # none of pyplot's: a window has those
        fill(figure, plant, omega, f, g, by, view, done)
        return finish(figure, "ina", NAMES[view], with_svg=False).png


def size(n: int) -> tuple[float, float]:
    """In inches: the array above, dominance below."""
    return max(6.4, 2.9 * n), max(6.4, 2.9 * n) * 0.92 + BELOW


def fill(figure, plant: SquarePlant, omega: np.ndarray, f: np.ndarray, g: np.ndarray, by: str, view: str, done: list[str]) -> None:
    """An empty figure of size(n), in the style of plots."""
    n = plant.n
    found = arrays.array(f, g, inverse=view == "inverse")
    upper, lower = figure.subfigures(2, 1, height_ratios=(size(n)[1] - BELOW, BELOW))
    if view == "loci":
        _loci(upper.subplots(1, 1), arrays.loci(f, g))
    else:
        _array(upper.subplots(n, n, squeeze=False), plant, found, by, view)
    _dominance(lower.subplots(1, 1), plant, omega, f, g, by, view)
    figure.suptitle(f"{plant.name}: {NAMES[view]}, {'z' if plant.period_s else 's'}-plane; " + ("G = 1" if not done else ", ".join(done[-3:])), x=0.01,
                    ha="left", fontsize=10, fontweight="bold")


def _array(axes, plant: SquarePlant, found: arrays.Array, by: str, view: str) -> None:
    n = plant.n
    for i in range(n):
        for k in range(n):
            ax, z = axes[i][k], found.values[:, i, k]
            ax.axhline(0, color=GREY, linewidth=0.6)
            ax.axvline(0, color=GREY, linewidth=0.6)
            if i == k:
                _band(ax, z, found.radius[by][:, i], bool((found.ratio[by][:, i] >= 1).any()))
            ax.plot(z.real, z.imag, color=BLUE, linewidth=1.4)
            if plant.period_s:  # the other half of the closed curve
                ax.plot(z.real, -z.imag, color=BLUE, linewidth=0.8, linestyle=(0, (4, 3)))
            ax.plot(z.real[0], z.imag[0], "o", color=BLUE, markersize=3.5)
            ax.plot(0, 0, "+", color="black", markersize=7)
            ax.set_aspect("equal", adjustable="datalim")
            ax.tick_params(labelsize=7)
            ax.xaxis.set_major_locator(MaxNLocator(5 if n < 3 else 3))
            first, second = (plant.inputs[i].name, plant.outputs[k].name) if view == "inverse" else (plant.outputs[i].name, plant.inputs[k].name)
            ax.set_title(f"{i + 1},{k + 1}: {first}, {second}", fontsize=8)


def _band(ax, z: np.ndarray, radius: np.ndarray, reaches: bool) -> None:
    """Circles at even distances along the curve; orange where the band holds the origin."""
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(z)))])
    at = np.unique(np.searchsorted(length, np.linspace(0.0, length[-1], CIRCLES)).clip(0, len(z) - 1))
    width = 2.0 * radius[at]
    circles = EllipseCollection(width, width, np.zeros(len(at)), units="xy", offsets=np.column_stack([z.real[at], z.imag[at]]),
                                transOffset=ax.transData, facecolors="none", edgecolors=ORANGE if reaches else GREEN, linewidths=0.6, alpha=0.7)
    ax.add_collection(circles)
    corners = np.concatenate([z[at] + radius[at] * way for way in (1, -1, 1j, -1j)])
    ax.update_datalim(np.column_stack([corners.real, corners.imag]))
    ax.autoscale_view()


def _loci(ax, loci: np.ndarray) -> None:
    for k in range(loci.shape[1]):
        z, colour = loci[:, k], COLOURS[k % len(COLOURS)]
        ax.plot(z.real, z.imag, color=colour, linewidth=1.4, label=f"locus {k + 1}")
        ax.plot(z.real, -z.imag, color=colour, linewidth=0.7, alpha=0.5)
        ax.plot(z.real[0], z.imag[0], "o", color=colour, markersize=3.5)
    ax.plot(-1, 0, "+", color="black", markersize=9)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set(xlabel="real", ylabel="imaginary")
    ax.legend(fontsize=8)


def _dominance(ax, plant: SquarePlant, omega: np.ndarray, f: np.ndarray, g: np.ndarray, by: str, view: str) -> None:
    """Sum off the diagonal over the diagonal; thin: without compensator."""
    inverse = view != "direct"
    now, before = arrays.array(f, g, inverse), arrays.array(f, np.eye(plant.n), inverse)
    compensated = bool(np.abs(g - np.eye(plant.n)).max() > 0)
    for k in range(plant.n):
        colour = COLOURS[k % len(COLOURS)]
        if compensated:
            ax.plot(omega, before.ratio[by][:, k], color=colour, linewidth=0.9, linestyle=(0, (4, 3)))
        ax.plot(omega, now.ratio[by][:, k], color=colour, linewidth=1.6, label=f"{by[:-1]} {k + 1}")
    ax.axhline(1, color="black", linewidth=0.9)
    ax.set_xscale("linear" if plant.period_s else "log")
    ax.set_yscale("log")
    for ticks in (ax.yaxis.set_major_formatter, ax.yaxis.set_minor_formatter):
        ticks(lambda x, _: f"{x:g}" if f"{x:e}"[0] in "125" else "")
    ax.set_xlim(omega[0], omega[-1])
    ax.set(xlabel="frequency, rad/s", ylabel="off / on the diagonal")
    ax.set_title(f"{'inverse' if inverse else 'direct'} array by {by}" + ("; dashed: without compensator" if compensated else ""), fontsize=9)
    ax.legend(fontsize=8, ncols=plant.n)
