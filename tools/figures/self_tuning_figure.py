#!/usr/bin/python3
"""The figures of docs/methods/self-tuning.md: docs/figures/self-tuning.png and self-tuning-parameters.png.

    cmake --preset host && cmake --build --preset host --target reflux-sim-memory reflux-plant
    tools/figures/self_tuning_figure.py

Lines of tests/campaign/self-tuning.toml, with the firmware in the simulator's own process; parameters are asked for at its console.
"""
import dataclasses
import pathlib
import re
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from reflux import paths, runner  # noqa: E402
from research import cmd_campaign  # noqa: E402
from research import self_tuning_campaign as campaign  # noqa: E402

EVERY_MIN = 2
RED, BLUE, GREY = "#b2182b", "#2166ac", "#888888"


def run(part, name):
    """Log and, by name, (minute, value) of the block's inner values."""
    of = cmd_campaign.load("self-tuning")
    line = next(v for v in of.variants if (v.part, v.name) == (part, name))
    if "0 block 1 off" not in line.send:
        line = dataclasses.replace(line, send=line.send + tuple(f"{t} block 1" for t in range(2, 280, EVERY_MIN)))
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        log = runner.run(campaign.scenario_of(of, line, 1), runner.Options(pathlib.Path(folder), quiet=True)).log
        said = (pathlib.Path(folder) / "transcript.txt").read_text(encoding="utf-8")
    inner = {}
    for time, what, value in re.findall(r"^(\S+) <\s+(\w+) = (\S+)$", said, re.M):
        inner.setdefault(what, []).append((float(time) / 60, float(value)))
    return log, inner


def traces():
    figure, axes = plt.subplots(4, 1, figsize=(10, 8), sharex=True, height_ratios=(2, 2, 1, 1))
    for name, colour in (("PI", RED), ("IMD1", BLUE)):
        log, _ = run("rule-pair", name)
        t = [x / 60 for x in log.numbers("time")]
        for axis, column in zip(axes, ("T1.true", "T10.true", "Lr.applied", "Qrb.applied")):
            axis.plot(t, log.numbers(column), color=colour, lw=1.0, label=name)
    for axis, loop in zip(axes, ("top", "bottom")):
        axis.plot(t, log.numbers(f"fw.{loop}.sp"), color=GREY, lw=0.8, ls="--", drawstyle="steps-post", label="setpoint")
    for axis, label in zip(axes, ("T1, degC", "T10, degC", "reflux, l/h", "heat, kW")):
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
        for at in (200, 220, 240, 260):
            axis.axvline(at, color="k", lw=0.5, ls=":")
    axes[0].set_ylim(87, 90.5)
    axes[1].set_ylim(104, 112)
    axes[0].legend(loc="upper right", fontsize=8, ncols=3)
    axes[-1].set_xlabel("plant time, min (dotted: loads)")
    axes[-1].set_xlim(0, 280)
    figure.tight_layout()
    figure.savefig(paths.figures() / "self-tuning.png", dpi=110)


def parameters():
    figure, axes = plt.subplots(2, 2, figsize=(10, 6))
    for column, (part, name, title) in enumerate((("rule-one", "ISV, unsupervised", "ISV"),
                                                  ("rule-one", "PSV, unsupervised", "PSV"))):
        _, inner = run(part, name)
        axis = axes[0][column]
        axis.plot(*zip(*inner["est1_1"]), color=BLUE, lw=1.0, label="f")
        axis.set_ylim(0, 1.6)
        right = axis.twinx()
        right.plot(*zip(*inner["est1_2"]), color=RED, lw=1.0, label="g")
        right.set_ylim(-0.2, 0)
        axis.set_title(f"{title}: f (blue, left), g (red, right)", fontsize=10)
        axis.axvline(45, color="k", lw=0.5, ls=":")
    for column, (name, title) in enumerate((("the wrong signs", "IMD1, wrong signs at the start"),
                                            ("the wrong signs, SPC 0.2 on all four G", "the same with SPC on all four G"))):
        _, inner = run("start-0.5", name)
        for what, label, style in (("est1_2", "g11", "-"), ("est1_3", "g12", "--"), ("est2_2", "g22", "-"), ("est2_3", "g21", "--")):
            axes[1][column].plot(*zip(*inner[what]), color=BLUE if what.startswith("est1") else RED, ls=style, lw=1.0, label=label)
        axes[1][column].set_title(title, fontsize=10)
        axes[1][column].set_xlim(0, 180)
        axes[1][column].set_ylim(-0.3, 0.3)
        axes[1][column].legend(fontsize=8, ncols=4)
        axes[1][column].set_xlabel("plant time, min")
    for axis in axes.flat:
        axis.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(paths.figures() / "self-tuning-parameters.png", dpi=110)


def main() -> int:
    if len(sys.argv) > 1:
        print(__doc__)
        return 0 if sys.argv[1] in ("--help", "-h") else 2
    traces()
    parameters()
    return 0


if __name__ == "__main__":
    sys.exit(main())
