#!/usr/bin/python3
"""The figure of docs/methods/composition-estimation.md: docs/figures/kalman.png.

    cmake --preset host && cmake --build --preset host --target reflux-sim reflux-sim-memory
    tools/figures/kalman_figure.py

host_sim/scenarios/pilot-kalman.toml, with the firmware in the simulator's own process: once as it is, once with a linear filter that has
no disturbance states.
"""

import dataclasses
import json
import pathlib
import re
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from reflux import paths, runner, scenario  # noqa: E402

RED, BLUE, GREY, ORANGE = "#b2182b", "#2166ac", "#888888", "#d98c00"
HOUR, EVERY_S = 3600.0, 120.0
LIGHT, HEAVY = 0.13138834, 0.1658334  # kg/mol
LINEAR = ("set block2.method kalman", "set block2.feed_z 0", "set block2.feed_f 0")
# Curves: the point and its number, its stage, and what it is.
SHOWN = (("x8_est", 2, 4, "tray 8"), ("xB_est", 3, 1, "bottoms"))


def plant(folder):
    """The pilot column with the fraction of tray 8 among its truths."""
    whole = json.loads((ROOT / "host_sim" / "plants" / "pilot.json").read_text(encoding="utf-8"))
    for point, _, stage, _ in SHOWN:
        whole["truths"].append(
            {"name": point[:2] + "_true", "is": "fraction", "of": "TCE", "stage": stage, "unit": "%w", "lo": 0, "hi": 100}
        )
    file = folder / "pilot.json"
    file.write_text(json.dumps(whole), encoding="utf-8")
    return str(file)


def play(more=()):
    base = scenario.load(ROOT / "host_sim" / "scenarios" / "pilot-kalman.toml")
    config = [line for line in base.config if line.text != "apply"]
    config += [scenario.Line(0.0, text) for text in (*more, "set block2.doubt uncertain", "apply")]
    asked = [scenario.Line(k * EVERY_S, "block 2") for k in range(1, int(base.duration_s / EVERY_S))]
    lines = sorted([*(x for x in base.lines if x.text != "block 2"), *asked], key=lambda line: line.at_s)
    with tempfile.TemporaryDirectory(prefix="reflux-") as name:
        folder = pathlib.Path(name)
        played = dataclasses.replace(
            base, firmware="memory", plant=plant(folder), config=tuple(config), lines=tuple(lines)
        )
        log = runner.run(played, runner.Options(folder / "out", quiet=True)).log
        said = (folder / "out" / "transcript.txt").read_text(encoding="utf-8")
    return log, said


def slope(w):
    """d(percent by weight)/d(mole fraction) at so many percent."""
    w /= 100
    x = (w / LIGHT) / (w / LIGHT + (1 - w) / HEAVY)
    return 100 * LIGHT * HEAVY / (x * LIGHT + (1 - x) * HEAVY) ** 2


def deviations(said, number):
    """Hours and standard deviations of a point, mole fraction."""
    found = [(float(m[1]) / HOUR, float(m[2])) for m in re.finditer(rf"([\d.]+) <   sd_{number} = (\S+)", said)]
    return [t for t, _ in found], [sd for _, sd in found]


def main():
    if sys.argv[1:]:
        print(__doc__)
        return
    log, said = play()
    linear, _ = play(LINEAR)
    t = [x / HOUR for x in log.numbers("time")]
    figure, axes = plt.subplots(4, 1, figsize=(10, 9), sharex=True, height_ratios=(2, 1, 2, 1))
    for k, (point, number, _, what) in enumerate(SHOWN):
        truth, upper, lower = log.numbers(point[:2] + "_true"), axes[2 * k], axes[2 * k + 1]
        at, sd = deviations(said, number)
        middle = [truth[min(range(len(t)), key=lambda i: abs(t[i] - x))] for x in at]
        band = [2 * s * slope(w) for s, w in zip(sd, middle)]
        names = ("extended Kalman filter, the feed unknown", "linear Kalman filter, the feed as it was")
        for of, colour, name in ((linear, ORANGE, names[1]), (log, BLUE, names[0])):
            estimate = of.numbers(f"fw.{point}")
            upper.plot(t, estimate, color=colour, lw=1.2, label=name)
            lower.plot(t, [a - b for a, b in zip(estimate, truth)], color=colour, lw=0.9)
        upper.plot(t, truth, color=RED, lw=1.0, ls="--", label="true")
        upper.set_ylabel(f"{what}, %w")
        lower.fill_between(at, [-b for b in band], band, color=GREY, alpha=0.25, label="two of its standard deviations")
        lower.axhline(0, color="k", lw=0.5)
        lower.set_ylabel("error, %w")
    axes[0].legend(fontsize=8, loc="lower right")
    axes[1].legend(fontsize=8, loc="upper left")
    axes[3].set_xlabel("plant time, h (1 h: a quarter more feed; 3.5 h: 50 %w of the lighter component in it, not 36; nobody tells the board)")
    axes[3].set_xlim(0, 6)
    for axis in axes:
        axis.grid(alpha=0.3)
        for change in (1, 3.5):
            axis.axvline(change, color="k", lw=0.5, ls=":")
    figure.tight_layout()
    figure.savefig(paths.figures() / "kalman.png", dpi=100, metadata={"Software": None})


if __name__ == "__main__":
    main()
