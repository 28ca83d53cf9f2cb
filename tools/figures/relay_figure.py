#!/usr/bin/python3
"""The worked example of docs/methods/relay.md: numbers on the terminal, docs/figures/relay.png.

    cmake --preset host && cmake --build --preset host --target reflux-sim-memory
    tools/figures/relay_figure.py

Wood and Berry's column with the firmware in the simulator's own process; everything is asked for at its console.
"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))
sys.path.insert(0, str(ROOT / "tools"))
from reflux import paths  # noqa: E402
from commissioning import Run, configuration, plant  # noqa: E402

PAIRS = (("xD", "R", "reverse"), ("xB", "S", "direct"))
HOUR = 3600.0


def script(of):
    lines = [line for line in configuration(of)]
    for k, (y, u, action) in enumerate(PAIRS, 1):
        lines += [f"set loop{k}.name L{k}", f"set loop{k}.pv {y}", f"set loop{k}.out {u}", f"set loop{k}.action {action}"]
    lines += [f"set mv{i}.safe {u['nominal']}" for i, u in enumerate(of.inputs, 1)]
    out = [(0.0, line) for line in [*lines, "apply"]]
    out += [(of.tick_s, f"out L{k} {u['nominal']}") for k, u in enumerate(of.inputs, 1)]
    at = 5 * of.tick_s
    for k in (1, 2):
        out += [(at, f"commission relay L{k}"), (at, "~until RELAY_DONE|COMMISSION_ENDED"), (at, "commission relay"),
                (at, "commission accept"), (at, "~until TRIAL_KEPT|TRIAL_FAILED"), (at, f"commission trial")]
    return [*out, (at, "~end")]


def main() -> int:
    if len(sys.argv) > 1:
        print(__doc__)
        return 0 if sys.argv[1] in ("--help", "-h") else 2
    of = plant("wood-berry")
    run = Run(of, script(of), noise=1.0, seed=1, log=True)
    for n, line in enumerate(run.said):
        if any(f"< {word} " in line for word in ("relay", "settings", "trial")):
            print(line.split("< ", 1)[1])
    print(*(f"{e.time_s / HOUR:.2f} h {e.code} {e.subject}" for e in run.all("TEST_STEP", "RELAY_DONE", "TRIAL_KEPT",
                                                                           "TRIAL_FAILED")), sep="\n")
    t = [r["time"] / HOUR for r in run.rows]
    figure, axes = plt.subplots(2, 2, figsize=(10, 5), sharex="col", width_ratios=(1, 1))
    steps, done = run.all("TEST_STEP"), run.all("RELAY_DONE")
    for column, (first, last) in enumerate(((0.0, done[0].time_s / HOUR + 0.3),
                                            (0.0, t[-1]))):
        keep = [k for k, x in enumerate(t) if first <= x <= last]
        for row, (names, label) in enumerate(((("xD.meas", "xB.meas"), "%w"), (("R.cmd", "S.cmd"), "lb/min"))):
            for name, colour in zip(names, ("#b2182b", "#2166ac")):
                axes[row][column].plot([t[k] for k in keep], [run.rows[k][name] - run.rows[0][name] for k in keep],
                                       color=colour, lw=1.0, drawstyle="steps-post" if row else None,
                                       label=name.split(".")[0])
            axes[row][column].set_ylabel(f"change, {label}")
            axes[row][column].grid(alpha=0.3)
            axes[row][column].legend(loc="upper left", fontsize=8)
            axes[row][column].set_ylim((-0.35, 0.35) if row else (-3.5, 3.5))
        axes[1][column].set_xlabel("plant time, h")
    axes[0][0].set_title("relay test of xD by R")
    axes[0][1].set_title("both loops, each on trial after its test")
    for column in (0, 1):
        for e in steps + done:
            axes[0][column].axvline(e.time_s / HOUR, color="k", lw=0.5, ls=":")
    axes[0][0].set_xlim(0.0, done[0].time_s / HOUR + 0.3)
    figure.tight_layout()
    figure.savefig(paths.figures() / "relay.png", dpi=110)
    return 0


if __name__ == "__main__":
    sys.exit(main())
