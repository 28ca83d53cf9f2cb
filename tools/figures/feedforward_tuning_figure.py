#!/usr/bin/python3
"""The figure of docs/methods/adaptive-feedforward.md on tuning: docs/figures/feedforward-tuning.png.

    cmake --preset host && cmake --build --preset host --target libreflux_board
    tools/figures/feedforward_tuning_figure.py

Siddha's loop with noise, method A, identified and tuned by the firmware's code as in tests/campaign/adaptive-feedforward.toml (seed 1), beside the
ideal -Gd/Gp, Shinskey's rules and the parameters that the source prints: responses over frequency, and y after a unit step of the
disturbance.
"""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from reflux import paths  # noqa: E402
from research import feedforward_study  # noqa: E402
from research.feedforward_study import Case, sim  # noqa: E402

BLUE, RED, GREY, ORANGE = "#2166ac", "#b2182b", "#888888", "#d98c00"
CASES = ("III c", "II c", "II a")
LAGS_S = 1 / 3


def main():
    if sys.argv[1:]:
        print(__doc__.strip())
        return
    with_dead = feedforward_study.play(Case("A", lags_s=LAGS_S, dead=True), [1]).tunings[:, 0]
    omega = np.geomspace(0.3, 10, 200)
    back = np.exp(-1j * omega * sim.TS)
    figure, axes = plt.subplots(3, len(CASES), figsize=(11, 8.5), sharex="row")
    for column, name in enumerate(CASES):
        i = next(k for k, r in enumerate(sim.REGIMES) if r.name == name)
        regime, size, phase, time = sim.REGIMES[i], *axes[:, column]
        ideal = sim.ratio(regime, back)
        known = (
            ("Shinskey's rules", sim.PUBLISHED["Shinskey"][i], ORANGE),
            ("as published (A)", sim.PUBLISHED["A"][i], GREY),
            ("tuned here (A)", with_dead[i], BLUE),
        )
        size.semilogx(omega, 20 * np.log10(abs(ideal)), color="k", ls="--", lw=1.2, label="Gd/Gp")
        phase.semilogx(omega, np.degrees(np.unwrap(np.angle(ideal))), color="k", ls="--", lw=1.2)
        seconds = np.arange(round(8 / 0.005)) * 0.005
        time.plot(seconds, sim.step_response(None, regime, 8.0), color=RED, lw=1.0, label="PI alone")
        for label, tuning, colour in known:
            dead = tuning[3] if len(tuning) > 3 else 0.0
            f = -sim.feedforward(tuning[0], tuning[1], tuning[2], dead, back)
            size.semilogx(omega, 20 * np.log10(abs(f)), color=colour, lw=1.2, label=label)
            phase.semilogx(omega, np.degrees(np.unwrap(np.angle(f))), color=colour, lw=1.2)
            time.plot(seconds, sim.step_response(tuning, regime, 8.0), color=colour, lw=1.2)
        size.set_title(name)
        time.set_ylim(-1, 2.1)
        for axis in (size, phase):
            axis.axvspan(0.5, 6, color=GREY, alpha=0.12)
            axis.grid(alpha=0.3, which="both")
        time.grid(alpha=0.3)
        phase.set_xlabel("rad/s (band shaded)")
        time.set_xlabel("s after a unit step of the disturbance")
    for axis, what in zip(axes[:, 0], ("-F and Gd/Gp, dB", "degrees", "y")):
        axis.set_ylabel(what)
    axes[0, 0].legend(fontsize=8)
    axes[2, 0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(paths.figures() / "feedforward-tuning.png", dpi=100, metadata={"Software": None})


if __name__ == "__main__":
    main()
