#!/usr/bin/python3
"""Draws docs/figures/cold-start.png from the log that tools/run cold-start leaves.

usage: tools/figures/cold_start_figure.py [LOG.csv] [PICTURE.png]     (default out/cold-start/log.csv,
       docs/figures/cold-start.png)
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from reflux import logs, paths  # noqa: E402

END_H = 4.0
HAPPENINGS = [(1, "heater"), (20, "total\nreflux"), (32, "feed,\nproducts"), (52, "control"), (180, "shut\ndown")]
TEMPERATURES = [("T1.true", "T1", "#1f5fa8"), ("T5", "T5", "#5b8fc9"), ("T10.true", "T10", "#d2691e"),
                ("TB.true", "reboiler", "#8e2d2d"), ("Theater.true", "heater", "0.5")]


def main() -> int:
    if len(sys.argv) > 3 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0 if "--help" in sys.argv or "-h" in sys.argv else 2
    log = logs.read_csv(Path(sys.argv[1]) if len(sys.argv) > 1 else paths.out_root() / "cold-start" / "log.csv")
    picture = Path(sys.argv[2]) if len(sys.argv) > 2 else paths.figures() / "cold-start.png"
    hours = [t / 3600 for t in log.numbers("time")]
    figure, axes = plt.subplots(3, 1, sharex=True, figsize=(9, 7), height_ratios=(4, 2.5, 2.5))
    for name, label, colour in TEMPERATURES:
        axes[0].plot(hours, log.numbers(name), color=colour, lw=1.2, label=label)
    axes[0].set_ylabel("temperature [°C]")
    axes[0].legend(loc="lower right", frameon=False, fontsize=8, ncols=2)
    for name, label, colour in (("LB.true", "reboiler as read", "#d2691e"), ("LB_true", "reboiler", "#8e2d2d"),
                                ("LD.true", "drum", "#1f5fa8")):
        axes[1].plot(hours, log.numbers(name), color=colour, lw=1.2, label=label)
    axes[1].set_ylabel("level [cm]")
    axes[1].legend(loc="upper right", frameon=False, fontsize=8)
    for name, label, colour in (("Lr.true", "reflux [l/h]", "#2e7d4f"), ("D.true", "distillate [l/h]", "#1f5fa8"),
                                ("B", "bottoms [l/h]", "#8e2d2d")):
        axes[2].plot(hours, log.numbers(name), color=colour, lw=1.2, label=label)
    heat = axes[2].twinx()
    heat.step(hours, log.numbers("Qrb.applied"), where="pre", color="0.5", lw=1.0, label="heater [kW]")
    heat.set_ylim(0, 1.5)
    lines = axes[2].get_lines() + heat.get_lines()
    axes[2].legend(lines, [line.get_label() for line in lines], loc="upper right", frameon=False, fontsize=8)
    for minute, what in HAPPENINGS:
        for axis in axes:
            axis.axvline(minute / 60, color="0.6", lw=0.8, ls="--")
        axes[0].annotate(what, (minute / 60, 1.02), xycoords=("data", "axes fraction"), fontsize=8, color="0.3")
    axes[2].set_xlabel("plant time [h]")
    axes[2].set_xlim(0, END_H)
    figure.tight_layout()
    figure.savefig(picture, dpi=90)
    return 0


if __name__ == "__main__":
    sys.exit(main())
