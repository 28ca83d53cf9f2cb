#!/usr/bin/python3
"""Draws docs/figures/sequence.png from the log that tools/run cold-sequence leaves.

usage: tools/figures/sequence_figure.py [LOG.csv] [PICTURE.png]     (default out/cold-sequence/log.csv,
       docs/figures/sequence.png)
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from reflux import logs, paths  # noqa: E402

FIRMWARE = logs.FIRMWARE_PREFIX
TEMPERATURES = [("T1.true", "T1", "#1f5fa8"), ("T10.true", "T10", "#d2691e"), ("TB.true", "reboiler", "#8e2d2d")]
LEVELS = [("LB.true", "reboiler, as the instrument reads it", "#d2691e"), (f"{FIRMWARE}LB", "less its offset", "#8e2d2d"),
          ("LD.true", "drum", "#1f5fa8")]
VALVES = [("vLr.applied", "reflux", "#2e7d4f"), ("vD.applied", "distillate", "#1f5fa8"),
          ("vB.applied", "bottoms", "#8e2d2d"), ("vF.applied", "feed", "#d2691e"), ("vCW.applied", "cooling", "0.6")]


def main() -> int:
    if len(sys.argv) > 3 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0 if "--help" in sys.argv or "-h" in sys.argv else 2
    log = logs.read_csv(Path(sys.argv[1]) if len(sys.argv) > 1 else paths.out_root() / "cold-sequence" / "log.csv")
    picture = Path(sys.argv[2]) if len(sys.argv) > 2 else paths.figures() / "sequence.png"
    minutes = [t / 60 for t in log.numbers("time")]
    steps = [int(s) for s in log.numbers(f"{FIRMWARE}step")]
    running = [int(s) in (1, 2, 3) for s in log.numbers(f"{FIRMWARE}seq")]
    figure, columns = plt.subplots(4, 2, sharex="col", sharey="row", figsize=(10, 8), height_ratios=(3, 2.2, 2.2, 1.4),
                                   width_ratios=(3, 2))
    for column, window in ((0, (0, 75)), (1, (195, 440))):
        shown = [i for i, t in enumerate(minutes) if window[0] <= t <= window[1]]
        times = [minutes[i] for i in shown]
        for row, lines in enumerate((TEMPERATURES, LEVELS, VALVES)):
            for name, label, colour in lines:
                values = log.numbers(name)
                columns[row][column].plot(times, [values[i] for i in shown], color=colour, lw=1.1, label=label)
        heat = log.numbers("Qrb.applied")
        columns[2][column].plot(times, [100 * heat[i] for i in shown], color="k", lw=1.1, ls=":", label="heater, 1 kW = 100")
        columns[3][column].step(times, [steps[i] if running[i] else float("nan") for i in shown], where="post",
                                color="k", lw=1.1)
        columns[3][column].set_xlim(*window)
        columns[3][column].set_xlabel("plant time [min]")
    for axis, label in zip((row[0] for row in columns), ("temperature [°C]", "level [cm]", "open [%]", "step")):
        axis.set_ylabel(label)
    columns[0][0].set_title("seq start", fontsize=9, loc="left")
    columns[0][1].set_title("seq stop", fontsize=9, loc="left")
    for row in range(3):
        columns[row][0].legend(loc=("upper left", "upper right", "center left")[row], frameon=False, fontsize=7)
    figure.tight_layout()
    figure.savefig(picture, dpi=90)
    return 0


if __name__ == "__main__":
    sys.exit(main())
