#!/usr/bin/python3
"""The figure of docs/use/analysers.md, Above a temperature loop: docs/figures/composition-cascade.png.

    cmake --preset host && cmake --build --preset host --target reflux-sim-memory
    tools/figures/composition_cascade_figure.py

host_sim/scenarios/composition-cascade.toml, with the firmware in the simulator's own process.
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


def main():
    if sys.argv[1:]:
        print(__doc__)
        return
    played = dataclasses.replace(
        scenario.load(ROOT / "host_sim" / "scenarios" / "composition-cascade.toml"), firmware="memory"
    )
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        log = runner.run(played, runner.Options(pathlib.Path(folder) / "out", quiet=True)).log
    t = [x / 3600 for x in log.numbers("time")]
    figure, axes = plt.subplots(3, 1, figsize=(10, 6), sharex=True, height_ratios=(2, 2, 1))
    axes[0].axhspan(15, 25, color=GREY, alpha=0.15)
    axes[0].plot(t, [1000 * v for v in log.numbers("iC4_D.true")], color=RED, lw=1.0, label="in the distillate")
    axes[0].plot(
        t,
        [1000 * v for v in log.numbers("iC4_D.meas")],
        color=BLUE,
        lw=0.8,
        drawstyle="steps-post",
        label="as the analyser shows it",
    )
    axes[0].set_ylabel("isobutane, 1e-3")
    axes[0].legend(fontsize=8)
    axes[1].plot(t, log.numbers("T33.meas"), color=BLUE, lw=0.8, label="T33 as read")
    axes[1].plot(
        t, log.numbers("fw.tray.sp"), color=GREY, lw=1.0, ls="--", drawstyle="steps-post", label="its setpoint"
    )
    axes[1].set_ylabel("K")
    axes[1].set_ylim(326.5, 331)
    axes[1].legend(fontsize=8)
    axes[2].plot(t, log.numbers("Q.applied"), color=RED, lw=1.0)
    axes[2].set_ylabel("Q, Mcal/h")
    axes[2].set_xlabel(
        "plant time, h (1 h: another feed, T33 reads 1 K too much; 6 h: the analyser's loop closes; 14 h: another feed)"
    )
    axes[2].set_xlim(0, 24)
    for axis in axes:
        axis.grid(alpha=0.3)
        for at in (1, 6, 14):
            axis.axvline(at, color="k", lw=0.5, ls=":")
    figure.tight_layout()
    figure.savefig(paths.figures() / "composition-cascade.png", dpi=100, metadata={"Software": None})


if __name__ == "__main__":
    main()
