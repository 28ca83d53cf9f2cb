#!/usr/bin/python3
"""Draws docs/figures/experiment.png from what tools/run kotyk-experiment leaves: signals, measurements, and step responses of the model
that the board found beside those of the plant.

usage: tools/figures/experiment_figure.py [FOLDER] [PICTURE.png]
       (default out/kotyk-experiment, docs/figures/experiment.png)
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from reflux_tools import board_model, logs, paths, sampled_plant  # noqa: E402
from reflux_tools.plots import BLUE, GREEN, GREY, ORANGE, STYLE  # noqa: E402

STEPS = 40


def steps(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of one element, from its sample 0 on."""
    y = np.zeros(STEPS)
    for k in range(1, STEPS):
        y[k] = b[: min(k, len(b))].sum() - sum(a[m] * y[k - 1 - m] for m in range(min(len(a), k)))
    return y


def main() -> int:
    if len(sys.argv) > 3 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0 if "--help" in sys.argv or "-h" in sys.argv else 2
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "out" / "kotyk-experiment"
    picture = Path(sys.argv[2]) if len(sys.argv) > 2 else paths.figures() / "experiment.png"
    log = logs.read_csv(folder / "log.csv")
    outputs, inputs, a, b, period = board_model.read(folder / "transcript.txt", None)
    plant = sampled_plant.read("kotyk-column", None, None)
    hours = [t / 3600 for t in log.numbers("time")]
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(9, 6.4))
        grid = figure.add_gridspec(2, 4, height_ratios=(3, 2.4))
        left = figure.add_subplot(grid[0, :])
        for k, (y, colour) in enumerate(zip(outputs, (BLUE, ORANGE))):
            left.plot(hours, log.numbers(f"{y}.meas"), color=colour, lw=0.9, label=f"{y} [V]")
        for k, (u, colour) in enumerate(zip(inputs, (GREEN, "#8e2d2d"))):
            left.step(hours, [0.25 * x - 1.2 - 0.7 * k for x in log.numbers(f"{u}.applied")], where="pre", color=colour, lw=0.9, label=f"{u}, ±1 V")
        left.set_xlabel("plant time [h]")
        left.set_xlim(0, hours[-1])
        left.legend(loc="upper right", ncols=4, fontsize=8)
        time = np.arange(STEPS) * period / 3600
        for i, y in enumerate(outputs):
            for j, u in enumerate(inputs):
                axis = figure.add_subplot(grid[1, 2 * i + j])
                axis.plot(time, steps(plant.a[i], plant.b[i, j]), color=GREY, lw=3, alpha=0.5, label="plant")
                axis.plot(time, steps(a[i], b[i, j]), color=BLUE, lw=1.2, label="found")
                axis.set_title(f"{y} by {u}")
                axis.set_xlabel("h after a step", fontsize=8)
                if i == j == 0:
                    axis.legend(fontsize=8)
                    axis.set_ylabel("V per V")
        figure.savefig(picture, dpi=90)
    return 0


if __name__ == "__main__":
    sys.exit(main())
