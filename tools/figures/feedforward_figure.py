#!/usr/bin/python3
"""The figure of docs/methods/adaptive-feedforward.md: docs/figures/adaptive-feedforward.png.

    cmake --preset host && cmake --build --preset host --target reflux-sim-memory reflux-plant
    tools/figures/feedforward_figure.py

The scenario feedforward-siddha with the firmware in the simulator's own process: what is left of the disturbance in y, and the tuned element
beside the ratio Gd/Gp of the plant, which is known.
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
SPANS = 20 / 10  # of d per span of u: the element's gain is in spans


def run():
    """Log, and the last of each of the block's inner values and of the element's settings."""
    of = scenario.load(ROOT / "host_sim" / "scenarios" / "feedforward-siddha.toml")
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        log = runner.run(of, runner.Options(pathlib.Path(folder), quiet=True)).log
        said = (pathlib.Path(folder) / "transcript.txt").read_text(encoding="utf-8")
    return log, {name: float(value) for name, value in re.findall(r"<\s+([\w.]+) = (\S+)", said) if re.fullmatch(r"[-+.\de]+", value)}


def ratio(w):
    """Gd/Gp of case III c, times twenty times as long, continuous."""
    return (8j * w + 1) / (5j * w + 1) * np.exp(4j * w)


def element(found, w):
    s = 1 - np.exp(-1j * w)
    f = found["ff1.gain"] * SPANS * (found["ff1.lead"] * s + 1) / (found["ff1.lag"] * s + 1)
    return f * np.exp(-1j * w * found["ff1.dead"])


def main():
    if len(sys.argv) > 1:
        print(__doc__.strip())
        return
    log, found = run()
    minutes = np.array(log.numbers("time")) / 60
    figure = plt.figure(figsize=(11, 5.5))
    grid = figure.add_gridspec(2, 3)
    y, u = figure.add_subplot(grid[0, :2]), figure.add_subplot(grid[1, :2])
    y.plot(minutes, log.numbers("y.meas"), color=BLUE, lw=0.8)
    y.plot(minutes, log.numbers("fw.one.sp"), color=GREY, lw=0.6)
    u.step(minutes, log.numbers("u.applied"), color=RED, lw=0.6)
    y.set_ylabel("y, and its setpoint")
    u.set_ylabel("u")
    u.set_xlabel("min")
    w = np.geomspace(0.02, 0.5, 200)
    size, angle = figure.add_subplot(grid[0, 2]), figure.add_subplot(grid[1, 2])
    for z, color, label in ((ratio(w), GREY, "Gd/Gp of the plant"), (-element(found, w), BLUE, "-F, tuned")):
        size.semilogx(w, 20 * np.log10(abs(z)), color=color, label=label)
        angle.semilogx(w, np.degrees(np.unwrap(np.angle(z))), color=color)
    for axis in (size, angle):
        axis.axvspan(found["band_lo"], found["band_hi"], color="#eeeeee")
    size.set_ylabel("dB")
    size.legend(frameon=False, fontsize=8)
    angle.set_ylabel("deg")
    angle.set_xlabel("rad/s; grey: the band")
    figure.tight_layout()
    picture = paths.figures() / "adaptive-feedforward.png"
    figure.savefig(picture, dpi=100)
    print(paths.shown(picture))


if __name__ == "__main__":
    main()
