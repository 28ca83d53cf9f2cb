#!/usr/bin/python3
"""The figures of docs/methods/inferential.md: docs/figures/trays-one-end.png, trays-two-ends.png, trays-limit.png.

    cmake --preset host && cmake --build --preset host --target reflux-sim reflux-sim-memory
    tools/figures/trays_figure.py
    tools/figures/trays_figure.py --all out/trays      # every table of the campaign `trays`, one picture each

Lines of tests/campaign/trays.toml, with the firmware in the simulator's own process.
"""

import dataclasses
import pathlib
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from reflux import paths  # noqa: E402
from research import cmd_campaign, trays  # noqa: E402

COLOURS = ("#2166ac", "#1b7837", "#b2182b", "#762a83", "#b8860b", "#5c6670", "#16a085", "#d2691e", "#8e44ad", "#2c3e50")
COMMITTED = {
    "trays-one-end": ("SS1, SC2: cascade and CLF", ("conventional sC[Q,33]", "cascade sC[Q,33,34]", "clf sC[Q,33,34]")),
    "trays-two-ends": (
        "SS2, SC1",
        ("conventional sC[Q,5][R,33]", "cascade sC[Q,5,7][R,33,34]", "clf sC[Q,5,7][R,33,34]"),
    ),
    "trays-limit": ("Saturation", ("conventional sC[Q,33]", "cascade sC[Q,33,34]", "clf sC[Q,33,34]")),
}


def panels(cases):
    """Curves of these runs: column of the log, label, goal."""
    both = cases[0].state == "SS2"
    out = [("iC4_D", "iC4 in distillate, 1e-3", 1000)] + ([("C3_B", "C3 in bottoms, 1e-3", 1000)] if both else [])
    stages = sorted({p.stages[0] for c in cases for p in trays.structure(c.structure).pairings})
    out += [(f"T{s}.true", f"T{s}, K", 1) for s in (stages if len(stages) <= 3 else stages[-3:])]
    moved = {p.mv for c in cases for p in trays.structure(c.structure).pairings} | (
        {"R"} if any(trays.structure(c.structure).ratio for c in cases) else set()
    )
    return out + [(f"{mv}.applied", f"{mv}, {trays.MVS[mv][0]}", 1) for mv in trays.MVS if mv in moved]


def draw(cases, title, place):
    rows = panels(cases)
    figure, axes = plt.subplots(len(rows), 1, figsize=(10, 1.6 * len(rows) + 0.6), sharex=True)
    for case, colour in zip(cases, COLOURS):
        log = trays.run(case).log
        t = [x / 3600 for x in log.numbers("time")]
        for axis, (column, _, factor) in zip(axes, rows):
            if log.has(column):
                axis.plot(
                    t,
                    [factor * v for v in log.numbers(column)],
                    color=colour,
                    lw=0.9,
                    label=f"{case.law} {case.structure}",
                )
    for axis, (column, label, factor) in zip(axes, rows):
        axis.set_ylabel(label, fontsize=8)
        axis.grid(alpha=0.3)
        if factor == 1000:
            axis.axhspan(
                1000 * (trays.GOAL - trays.BAND), 1000 * (trays.GOAL + trays.BAND), color="#888888", alpha=0.15
            )
            low, high = axis.get_ylim()
            axis.set_ylim(max(low, 0), min(high, 100) if high > 300 else high)
    axes[0].legend(fontsize=7, ncols=3, loc="upper right")
    axes[-1].set_xlabel("plant time, h (grey: 0.02 +- 0.005)")
    axes[-1].set_xlim(0, trays.HOURS)
    axes[0].set_title(title, fontsize=9, loc="left")
    figure.tight_layout()
    figure.savefig(place, dpi=100, metadata={"Software": None})
    plt.close(figure)


def main(arguments):
    tables = [part for part in cmd_campaign.load("trays").parts if not part.is_map]
    if arguments[:1] == ["--all"] and len(arguments) == 2:
        folder = pathlib.Path(arguments[1])
        folder.mkdir(parents=True, exist_ok=True)
        for part in tables:
            for scaling in ("printed", "consistent"):
                name = re.sub(r"\W+", "-", f"{part.title} {scaling}").strip("-").lower()
                print(folder / f"{name}.png", flush=True)
                draw(
                    [dataclasses.replace(c, scaling=scaling) for c in part.cases],
                    f"{part.title}, slopes {scaling}",
                    folder / f"{name}.png",
                )
    elif arguments == ["--help"]:
        print(__doc__)
    elif arguments:
        sys.exit(f"usage: {pathlib.Path(__file__).name} [--all FOLDER]")
    else:
        for name, (title, lines) in COMMITTED.items():
            like = next(part for part in tables if part.title.startswith(title)).cases[0]
            cases = [dataclasses.replace(like, law=line.split()[0], structure=line.split()[1]) for line in lines]
            what = f"{like.state}, {like.scenario}" + (
                ", Q within 10 % of its nominal value" if like.saturation else ""
            )
            draw(cases, f"{what}, slopes consistent", paths.figures() / f"{name}.png")


if __name__ == "__main__":
    main(sys.argv[1:])
