#!/usr/bin/python3
"""Draws the figures of docs/methods/pid.md and docs/methods/feedforward.md from the firmware's own controller.

    cmake --preset host && cmake --build --preset host --target pid_trace
    tools/figures/pid_figures.py                 writes docs/figures/pid-*.png and prints their key numbers
"""
import argparse
import csv
import io
import pathlib
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from reflux import paths  # noqa: E402

COLOURS = ("#b2182b", "#2166ac", "#4d9221")


def table(program, name):
    text = subprocess.run([program, name], check=True, capture_output=True, text=True).stdout
    rows = list(csv.reader(io.StringIO(text)))
    return {head: [float(r[i]) for r in rows[1:]] for i, head in enumerate(rows[0])}


def numbers(name, label, t, sp, y):
    iae = sum(abs(a - b) for a, b in zip(sp, y)) * (t[1] - t[0])
    line = f"{name:12s} {label:18s} IAE {iae:6.2f} s"
    step = max(sp) - sp[0]
    if name != "windup" and step:
        until = len(t) if name != "response" else 450  # before the load
        line += f"   overshoot {100 * max((max(y[:until]) - max(sp)) / step, 0):5.1f} %"
    else:
        line += f"   largest error {max(abs(a - b) for a, b in zip(sp, y)):.4f}"
    print(line)


def draw(name, data, folder):
    fig, (upper, lower) = plt.subplots(2, 1, figsize=(7, 4.6), sharex=True, height_ratios=(3, 2))
    upper.step(data["t"], data["sp"], color="0.5", linewidth=1, where="post", label="setpoint")
    labels = [head[2:] for head in data if head.startswith("y ")]
    for label, colour in zip(labels, COLOURS):
        upper.plot(data["t"], data["y " + label], color=colour, linewidth=1.4, label=label)
        lower.step(data["t"], data["u " + label], color=colour, linewidth=1.1, where="post")
        numbers(name, label, data["t"], data["sp"], data["y " + label])
    upper.set_ylabel("measurement\n(fraction of span)")
    lower.set_ylabel("output\n(fraction of span)")
    lower.set_xlabel("time, s")
    upper.legend(frameon=False, fontsize=8)
    for axis in (upper, lower):
        axis.grid(color="0.9")
        axis.spines[["top", "right"]].set_visible(False)
    fig.tight_layout()
    fig.savefig(folder / f"pid-{name}.png", dpi=80, metadata={"Software": None})
    plt.close(fig)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=paths.build_dir("host") / "tests/unit/pid_trace", type=pathlib.Path,
                        help="the built pid_trace (default: that of the host preset)")
    parser.add_argument("--out", default=paths.figures(), type=pathlib.Path)
    options = parser.parse_args()
    if not options.program.exists():
        print(f"{options.program} does not exist: build the target pid_trace first (--help)", file=sys.stderr)
        return 1
    options.out.mkdir(parents=True, exist_ok=True)
    names = subprocess.run([options.program, "--list"], check=True, capture_output=True, text=True).stdout.split()
    for name in names:
        draw(name, table(options.program, name), options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
