#!/usr/bin/python3
"""Draws docs/figures/pilot-ahead.png from the log that tools/run pilot-ahead leaves.

usage: tools/figures/pilot_ahead_figure.py [LOG.csv] [PICTURE.png]
       (default out/pilot-ahead/log.csv, docs/figures/pilot-ahead.png)
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from reflux import logs, paths  # noqa: E402

HAPPENINGS = [(200, "a fifth\nmore feed"), (240, "richer\nfeed"), (280, "weak\nheater")]


def main() -> int:
    if len(sys.argv) > 3 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0 if "--help" in sys.argv or "-h" in sys.argv else 2
    log = logs.read_csv(Path(sys.argv[1]) if len(sys.argv) > 1 else paths.out_root() / "pilot-ahead" / "log.csv")
    picture = Path(sys.argv[2]) if len(sys.argv) > 2 else paths.figures() / "pilot-ahead.png"
    minutes = [t / 60 for t in log.numbers("time")]
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(9, 7.6), height_ratios=(3, 3, 2, 2))
    for axis, pv, loop in ((axes[0], "T1", "top"), (axes[1], "T10", "bottom")):
        axis.plot(minutes, log.numbers(f"{pv}.true"), color="#1f5fa8", lw=1.2, label=f"{pv}, true")
        axis.step(minutes, log.numbers(f"{logs.FIRMWARE_PREFIX}{loop}.sp"), where="post", color="#d2691e", lw=1.2, label="setpoint")
        axis.set_ylabel(f"{pv} [°C]")
        axis.legend(loc="upper right", frameon=False, fontsize=8, ncols=2)
    pair(axes[2], minutes, log, ("Lr.applied", "reflux Lr [l/h]"), ("Qrb.applied", "heat Qrb [kW]"))
    pair(axes[3], minutes, log, ("F", "feed F [l/h]"), ("xF", "feed xF [%w]"))
    for minute, what in HAPPENINGS:
        for axis in axes:
            axis.axvline(minute, color="0.6", lw=0.8, ls="--")
        axes[0].annotate(what, (minute, 1.02), xycoords=("data", "axes fraction"), fontsize=8, color="0.3")
    axes[3].set_xlabel("plant time [min]")
    axes[3].set_xlim(0, minutes[-1])
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
