#!/usr/bin/python3
"""Draws docs/figures/commissioning.png from what `tools/commission --plant wood-berry --yes` leaves.

usage: tools/figures/commissioning_figure.py [FOLDER] [PICTURE.png]     (default out/commission-wood-berry,
       docs/figures/commissioning.png)
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import numpy as np  # noqa: E402

from reflux import paths  # noqa: E402
from reflux.commission import figures, record  # noqa: E402
from reflux.plots import BLUE, GREEN, GREY, ORANGE, STYLE, plt  # noqa: E402


def tests(r: record.Record, column: list) -> None:
    """Both tests after each other, the model over what was measured."""
    begin = r.time[r.experiments[0].first]
    for ax, name in zip(column, r.model.measurements()):
        for e in r.experiments:
            t = np.array(r.time)[e.first:e.last]
            y = np.array(r.column(name))[e.first:e.last]
            model = figures.response(t, np.array(r.column(f"{e.input}.cmd"))[e.first:e.last],
                                     r.model.elements[name, e.input])
            model += figures.baseline(t, y - model)
            ax.plot((t - begin) / 3600, y, color=BLUE, lw=0.8, label="measured" if e is r.experiments[0] else None)
            ax.plot((t - begin) / 3600, model, color=ORANGE, lw=1.2, label="model" if e is r.experiments[0] else None)
        ax.set_ylabel(f"{name} [{r.channels[name].unit}]")
    column[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, borderpad=0.1)
    column[0].set_title("tests")
    inputs(r, column[2], slice(r.experiments[0].first, r.experiments[-1].last), begin)


def trial(r: record.Record, column: list) -> None:
    begin = next(e.at_s for e in r.events if e.code == "TRIAL_BEGUN")
    rows = slice(record.row_at(r.time, begin), len(r.time))
    hours = (np.array(r.time)[rows] - begin) / 3600
    for ax, name in zip(column, r.model.measurements()):
        ax.plot(hours, np.array(r.column(name))[rows], color=BLUE, lw=0.8)
        ax.step(hours, np.array(r.column(f"{name}.sp"))[rows], where="post", color=GREY, lw=1.1, label="setpoint")
    column[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, borderpad=0.1)
    column[0].set_title("trial of the proposal")
    inputs(r, column[2], rows, begin)


def inputs(r: record.Record, ax, rows: slice, begin: float) -> None:
    for name, colour in zip(r.model.tested(), (GREEN, "#8e2d2d")):
        ax.step((np.array(r.time)[rows] - begin) / 3600, np.array(r.column(f"{name}.cmd"))[rows], where="post",
                color=colour, lw=1.1, label=f"{name} [{r.channels[name].unit}]")
    ax.set_ylabel("inputs")
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, borderpad=0.1)
    ax.set_xlabel("plant time [h]")


def main() -> int:
    if len(sys.argv) > 3 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0 if "--help" in sys.argv or "-h" in sys.argv else 2
    r = record.load(Path(sys.argv[1]) if len(sys.argv) > 1 else paths.out_root() / "commission-wood-berry")
    picture = Path(sys.argv[2]) if len(sys.argv) > 2 else paths.figures() / "commissioning.png"
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(3, 2, figsize=(9.6, 5.6), sharex="col")
        tests(r, [row[0] for row in axes])
        trial(r, [row[1] for row in axes])
        figure.align_ylabels()
        figure.savefig(picture, dpi=90)
    return 0


if __name__ == "__main__":
    sys.exit(main())
