#!/usr/bin/python3
"""The figure of docs/methods/experiment.md: docs/figures/experiment.png.

    cmake --preset host && cmake --build --preset host --target reflux-sim-memory reflux-plant
    tools/figures/experiment_figure.py

The scenario kotyk-experiment with the firmware in the simulator's own process; the model is the one that the block shows at the console.
"""
import pathlib
import re
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from reflux import paths, runner, scenario  # noqa: E402

BLUE, RED, GREY = "#2166ac", "#b2182b", "#888888"


def run():
    """Log, and the last of each of the block's inner values."""
    of = scenario.load(ROOT / "host_sim" / "scenarios" / "kotyk-experiment.toml")
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        log = runner.run(of, runner.Options(pathlib.Path(folder), quiet=True)).log
        said = (pathlib.Path(folder) / "transcript.txt").read_text(encoding="utf-8")
    return log, {name: float(value) for name, value in re.findall(r"<\s+(\w+) = (\S+)$", said, re.M)}


def simulated(found, i, u):
    """Output i of the model with the inputs alone, from rest."""
    a = [found.get(f"a{i}_{k}", 0) for k in range(1, 5)]
    b = [[found.get(f"b{i}{j}_{k}", 0) for k in range(1, 9)] for j in (1, 2)]
    y = np.zeros(len(u))
    for t in range(len(u)):
        y[t] = sum(-a[k] * y[t - 1 - k] for k in range(4) if t > k) + sum(b[j][k] * u[t - 1 - k, j] for j in (0, 1) for k in range(8) if t > k)
    return y


def main():
    if len(sys.argv) > 1:
        print(__doc__.strip())
        return
    log, found = run()
    hours = np.array(log.numbers("time")) / 3600
    applied = np.array([log.numbers(f"{name}.applied") for name in ("u1", "u2")]).T
    applied[:60] = 0  # from the safe values to where it rests
    acts = np.vstack([applied[1:], applied[-1:]])
    figure, axes = plt.subplots(4, 1, figsize=(10, 8), sharex=True, height_ratios=(2, 2, 1, 1))
    for i, axis in enumerate(axes[:2], 1):
        axis.plot(hours, log.numbers(f"y{i}.meas"), color="#c4c4c4", lw=3.0, label="measured")
        axis.plot(hours, simulated(found, i, acts), color=BLUE, lw=1.0, label="the model with the inputs alone")
        axis.set_ylabel(f"y{i}, V")
    axes[0].legend(loc="upper right", ncols=2, frameon=False)
    for j, axis in enumerate(axes[2:]):
        axis.step(hours, applied[:, j], color=RED, lw=0.8)
        axis.set_ylabel(f"u{j + 1}, V")
        axis.set_ylim(-1.4, 1.4)
    axes[3].set_xlabel("h")
    axes[3].set_xlim(1, 40)
    for axis, lo, hi in zip(axes, (-0.3, -0.45), (0.35, 0.45)):
        axis.set_ylim(lo, hi)
    figure.tight_layout()
    picture = paths.figures() / "experiment.png"
    figure.savefig(picture, dpi=110)
    print(paths.shown(picture))


if __name__ == "__main__":
    main()
