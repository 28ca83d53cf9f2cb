#!/usr/bin/python3
"""Draws docs/figures/splitter.png from the log that tools/run splitter leaves.

usage: tools/figures/splitter_figure.py [LOG.csv] [PICTURE.png]
       (default out/splitter/log.csv, docs/figures/splitter.png)
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from reflux import logs, paths  # noqa: E402

HAPPENINGS = [(1, "stage 30\n1.5 K colder"), (4, "feed of\nscenario 1"), (8, "nominal\nfeed")]


def main() -> int:
    if len(sys.argv) > 3 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0 if "--help" in sys.argv or "-h" in sys.argv else 2
    log = logs.read_csv(Path(sys.argv[1]) if len(sys.argv) > 1 else paths.out_root() / "splitter" / "log.csv")
    picture = Path(sys.argv[2]) if len(sys.argv) > 2 else paths.figures() / "splitter.png"
    hours = [t / 3600 for t in log.numbers("time")]
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(9, 7.6), height_ratios=(3, 3, 2, 2))
    for axis, pv, loop in ((axes[0], "T30", "top"), (axes[1], "T19", "bottom")):
        axis.plot(hours, log.numbers(f"{pv}.true"), color="#1f5fa8", lw=1.2, label=f"{pv}, true")
        axis.step(hours, log.numbers(f"{logs.FIRMWARE_PREFIX}{loop}.sp"), where="post", color="#d2691e", lw=1.2,
                  label="setpoint")
        axis.set_ylabel(f"{pv} [K]")
        axis.legend(loc="lower right", frameon=False, fontsize=8)
    pair(axes[2], hours, log, ("R.applied", "reflux R [m³/h]"), ("Q.applied", "duty Q [Mcal/h]"))
    pair(axes[3], hours, log, ("iC4_D", "iC4 in distillate"), ("C3_B", "C3 in bottoms"))
    for hour, what in HAPPENINGS:
        for axis in axes:
            axis.axvline(hour, color="0.6", lw=0.8, ls="--")
        axes[0].annotate(what, (hour, 1.02), xycoords=("data", "axes fraction"), fontsize=8, color="0.3")
    axes[3].set_xlabel("plant time [h]")
    axes[3].set_xlim(0, hours[-1])
    figure.tight_layout()
    figure.savefig(picture, dpi=90)
    return 0


def pair(axis, hours, log, left, right) -> None:
    """Two columns of the log, each on its own scale."""
    other = axis.twinx()
    for place, (column, label), colour in ((axis, left, "#2e7d4f"), (other, right, "#8e2d2d")):
        place.step(hours, log.numbers(column), where="pre", color=colour, lw=1.0)
        place.set_ylabel(label, color=colour, fontsize=8)


if __name__ == "__main__":
    sys.exit(main())
