#!/usr/bin/python3
"""Draws docs/figures/kotyk-decoupled.png from the log that tools/run kotyk-decoupled leaves.

usage: tools/figures/decoupled_figure.py [LOG.csv] [PICTURE.png]
       (default out/kotyk-decoupled/log.csv, docs/figures/kotyk-decoupled.png)
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from reflux import logs, paths  # noqa: E402
from reflux.plots import BLUE, GREEN, GREY, ORANGE, STYLE  # noqa: E402

HAPPENINGS = [(4800, "one up"), (12000, "two up"), (18000, "u1 at most 1.5 V"), (24000, "two down"), (31200, "u1 free"), (36000, "one down")]


def main() -> int:
    if len(sys.argv) > 3 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0 if "--help" in sys.argv or "-h" in sys.argv else 2
    log = logs.read_csv(Path(sys.argv[1]) if len(sys.argv) > 1 else paths.out_root() / "kotyk-decoupled" / "log.csv")
    picture = Path(sys.argv[2]) if len(sys.argv) > 2 else paths.figures() / "kotyk-decoupled.png"
    hours = [t / 3600 for t in log.numbers("time")]
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(3, 1, sharex=True, figsize=(9, 6.4), height_ratios=(3, 3, 2))
        for axis, pv, loop in ((axes[0], "y1", "one"), (axes[1], "y2", "two")):
            axis.plot(hours, log.numbers(f"{pv}.true"), color=BLUE, lw=1.4, label=pv)
            axis.step(hours, log.numbers(f"{logs.FIRMWARE_PREFIX}{loop}.sp"), where="post", color=ORANGE, lw=1.2, label="setpoint")
            axis.set_ylabel(f"{pv} [V]")
            axis.legend(loc="upper left", fontsize=8)
        for mv, colour in (("u1", GREEN), ("u2", "#8e2d2d")):
            axes[2].step(hours, log.numbers(f"{mv}.applied"), where="pre", color=colour, lw=1.2, label=mv)
        axes[2].set_ylabel("inputs [V]")
        axes[2].legend(loc="upper left", fontsize=8)
        for at_s, what in HAPPENINGS:
            for axis in axes:
                axis.axvline(at_s / 3600, color=GREY, lw=0.9, ls=(0, (4, 3)))
            axes[0].annotate(what, (at_s / 3600, 1.02), xycoords=("data", "axes fraction"), fontsize=8, color="0.3")
        axes[2].set_xlabel("plant time [h]")
        axes[2].set_xlim(0, hours[-1])
        figure.savefig(picture, dpi=90)
    return 0


if __name__ == "__main__":
    sys.exit(main())
