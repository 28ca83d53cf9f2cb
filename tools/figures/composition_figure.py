#!/usr/bin/python3
"""The figure of docs/methods/composition-estimation.md: docs/figures/composition-estimation.png.

    cmake --preset host && cmake --build --preset host --target reflux-sim-memory
    tools/figures/composition_figure.py

host_sim/scenarios/splitter-estimate.toml, with the firmware in the simulator's own process.
"""

import dataclasses
import pathlib
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from reflux import paths, runner, scenario  # noqa: E402

RED, BLUE, GREY = "#b2182b", "#2166ac", "#888888"
BAND = 15  # 1e-3


def main():
    if sys.argv[1:]:
        print(__doc__)
        return
    played = dataclasses.replace(
        scenario.load(ROOT / "host_sim" / "scenarios" / "splitter-estimate.toml"), firmware="memory"
    )
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        log = runner.run(played, runner.Options(pathlib.Path(folder) / "out", quiet=True)).log
    t = [x / 3600 for x in log.numbers("time")]
    truth = [1000 * v for v in log.numbers("iC4_D")]
    estimate = [1000 * v for v in log.numbers("fw.est_iC4")]
    figure, axes = plt.subplots(3, 1, figsize=(10, 7), sharex=True, height_ratios=(2, 1, 2))
    band = ([v - BAND for v in truth], [v + BAND for v in truth])
    axes[0].fill_between(t, *band, color=GREY, alpha=0.15, label="0.015 about it")
    axes[0].plot(t, truth, color=RED, lw=1.0, label="in the distillate")
    axes[0].plot(t, estimate, color=BLUE, lw=1.0, label="estimated from T30, T31 and T33")
    axes[0].set_ylabel("isobutane, 1e-3")
    axes[0].legend(fontsize=8)
    axes[1].plot(t, [a - b for a, b in zip(estimate, truth)], color=BLUE, lw=1.0)
    axes[1].axhline(0, color="k", lw=0.5)
    axes[1].set_ylabel("error, 1e-3")
    axes[2].plot(t, log.numbers("T23.meas"), color=RED, lw=0.8, label="T23 as read; the estimator does not have it")
    axes[2].plot(t, log.numbers("fw.est_T23"), color=BLUE, lw=1.0, label="as it predicts it")
    axes[2].set_ylabel("K")
    axes[2].legend(fontsize=8, loc="upper right")
    axes[2].set_xlabel(
        "plant time, h (1 h: less feed, hotter and lighter, of which only flow and temperature are measured)"
    )
    axes[2].set_xlim(0, 8)
    for axis in axes:
        axis.grid(alpha=0.3)
        axis.axvline(1, color="k", lw=0.5, ls=":")
    figure.tight_layout()
    figure.savefig(paths.figures() / "composition-estimation.png", dpi=100, metadata={"Software": None})


if __name__ == "__main__":
    main()
