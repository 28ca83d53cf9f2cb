#!/usr/bin/python3
"""Draws docs/figures/decoupling.png from the table that tools/campaign decoupling writes: how much of the interaction each way of decoupling
leaves, beside the loops alone.

usage: tools/figures/decoupling_figure.py [TABLE.csv] [PICTURE.png]
       (default tests/campaign/results/decoupling.csv, docs/figures/decoupling.png)
"""

import csv
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from reflux import paths  # noqa: E402
from reflux.plots import BLUE, GREEN, GREY, ORANGE, STYLE  # noqa: E402

METHODS = ("static", "partial", "one-way", "ina", "polynomial")
COLOURS = (BLUE, "#6fa3d8", GREEN, ORANGE, "#8e2d2d")
PARTS = (("free", "gains as they are"), ("wrong", "gains wrong by 20 %"), ("clipped", "an input held back"))
LOST, LEAST = 30.0, 0.01


def main() -> int:
    if len(sys.argv) > 3 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0 if "--help" in sys.argv or "-h" in sys.argv else 2
    table = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "tests" / "campaign" / "results" / "decoupling.csv"
    picture = Path(sys.argv[2]) if len(sys.argv) > 2 else paths.figures() / "decoupling.png"
    with table.open(encoding="utf-8", newline="") as text:
        rows = {(row["plant"], row["method"]): row for row in csv.DictReader(text)}
    plants = list(dict.fromkeys(plant for plant, _ in rows))
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(len(PARTS), 1, sharex=True, figsize=(9, 7.2))
        for axis, (part, title) in zip(axes, PARTS):
            for p, plant in enumerate(plants):
                alone = rows[plant, "none"][f"{part}_cross"]
                if part == "wrong" and rows[plant, "none"]["lost"] == "1":
                    axis.annotate("all lost", (p, 1.3), ha="center", fontsize=7, color=GREY)
                    continue
                for m, (method, colour) in enumerate(zip(METHODS, COLOURS)):
                    at, found = p + 0.16 * (m - 2), rows[plant, method][f"{part}_cross"]
                    label = method if p == 0 else None
                    if not found:
                        axis.annotate("r", (at, LEAST * 1.3), ha="center", fontsize=7, color=colour)
                        continue
                    times = min(max(float(found) / float(alone), LEAST), LOST)
                    axis.plot([at, at], [1.0, times], color=colour, lw=5, solid_capstyle="butt", label=label)
            axis.axhline(1.0, color=GREY, lw=1.0)
            axis.set_yscale("log")
            axis.set_ylim(LEAST, LOST)
            axis.set_title(f"{title}: IAE of the other loops over that of loops alone")
        axes[0].legend(ncols=5, fontsize=8, loc="upper left")
        axes[-1].set_xticks(range(len(plants)), plants, fontsize=8)
        figure.savefig(picture, dpi=90)
    return 0


if __name__ == "__main__":
    sys.exit(main())
