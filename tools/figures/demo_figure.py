#!/usr/bin/python3
"""Draws docs/figures/demo.png, the picture of the README, from the log that tools/demo leaves.

usage: tools/figures/demo_figure.py [LOG.csv] [PICTURE.png]     (default out/demo/log.csv, docs/figures/demo.png)
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from reflux import logs, paths  # noqa: E402

HAPPENINGS = [(0.25, "top\nsetpoint"), (0.75, "bottom\nsetpoint"), (1.25, "feed flow\n+10 %"),
              (1.75, "feed leaner\n36 to 33 %w"), (2.25, "heater weak"), (2.75, "heater whole")]


def main() -> int:
    if len(sys.argv) > 3 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0 if "--help" in sys.argv or "-h" in sys.argv else 2
    log = logs.read_csv(Path(sys.argv[1]) if len(sys.argv) > 1 else paths.out_root() / "demo" / "log.csv")
    picture = Path(sys.argv[2]) if len(sys.argv) > 2 else paths.figures() / "demo.png"
    hours = [t / 3600 for t in log.numbers("time")]
    figure, axes = plt.subplots(3, 1, sharex=True, figsize=(9, 6.4), height_ratios=(3, 3, 2))
    for axis, pv, loop in ((axes[0], "T1", "top"), (axes[1], "T10", "bottom")):
        axis.plot(hours, log.numbers(f"{pv}.true"), color="#1f5fa8", lw=1.2, label=f"{pv}, true")
        axis.step(hours, log.numbers(f"{logs.FIRMWARE_PREFIX}{loop}.sp"), where="post", color="#d2691e", lw=1.2,
                  label="setpoint")
        axis.set_ylabel(f"{pv} [°C]")
        axis.legend(loc="lower right", frameon=False, fontsize=8)
    axes[2].step(hours, log.numbers("Lr.applied"), where="pre", color="#2e7d4f", lw=1.0, label="reflux Lr")
    axes[2].set_ylabel("Lr [l/h]")
    heat = axes[2].twinx()
    heat.step(hours, log.numbers("Qrb.applied"), where="pre", color="#8e2d2d", lw=1.0, label="heat Qrb")
    heat.set_ylabel("Qrb [kW]")
    lines = axes[2].get_lines() + heat.get_lines()
    axes[2].legend(lines, [line.get_label() for line in lines], loc="upper right", frameon=False, fontsize=8)
    for hour, what in HAPPENINGS:
        for axis in axes:
            axis.axvline(hour, color="0.6", lw=0.8, ls="--")
        axes[0].annotate(what, (hour, 1.02), xycoords=("data", "axes fraction"), fontsize=8, color="0.3")
    axes[2].set_xlabel("plant time [h]")
    axes[2].set_xlim(0, hours[-1])
    figure.tight_layout()
    figure.savefig(picture, dpi=90)
    return 0


if __name__ == "__main__":
    sys.exit(main())
