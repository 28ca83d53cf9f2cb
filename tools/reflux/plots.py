"""Plots of a run: one picture per loop, one of what was done to the plant."""

from __future__ import annotations

import io
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first

from reflux.logs import FIRMWARE_PREFIX, Log, bare, channel_unit, unit  # noqa: E402
from reflux.metrics import trace  # noqa: E402
from reflux.scenario import Loop, Scenario, is_stimulus  # noqa: E402

BLUE, ORANGE, GREY, GREEN = "#1f5fa8", "#d2691e", "#8a929c", "#2e7d4f"
STYLE = {
    "font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "grid.color": "#e4e7eb", "grid.linewidth": 0.8, "axes.edgecolor": "#5c6670", "axes.titlesize": 10,
    "axes.titleweight": "bold", "axes.titlelocation": "left", "legend.frameon": False, "svg.fonttype": "path",
    "figure.constrained_layout.use": True, "svg.hashsalt": "reflux",
}
MAX_MARKER = 26
LABEL_ROOM = 0.025  # of the run, between two labels


@dataclass(frozen=True)
class Plot:
    name: str
    caption: str
    svg: str
    png: bytes


def scenario_plots(log: Log, scenario: Scenario) -> list[Plot]:
    with plt.rc_context(STYLE):
        plots = [_loop_plot(log, scenario, loop) for loop in scenario.loops]
        changed = changing_columns(log, scenario)
        if changed:
            plots.append(_inputs_plot(log, scenario, changed))
    return plots


def hours(log: Log) -> list[float]:
    return [t / 3600 for t in log.numbers("time")]


def markers(scenario: Scenario) -> list[tuple[float, str, bool]]:
    """Time in seconds, text, and whether it was done to the plant (not by the operator)."""
    texts: dict[tuple[float, bool], list[str]] = {}
    for event in scenario.events:
        texts.setdefault((event.at_s, True), []).append(f"{event.name} = {event.value:g}")
    for line in scenario.lines:
        if is_stimulus(line):
            texts.setdefault((line.at_s, False), []).append(line.text)
    return [(t, "; ".join(words), plant) for (t, plant), words in sorted(texts.items())]


def _mark(axes: list[Any], scenario: Scenario) -> None:
    """A line for everything that happened, and its text where there is room for it."""
    labelled = -math.inf
    for at_s, text, plant in markers(scenario):
        for ax in axes:
            ax.axvline(at_s / 3600, color=ORANGE if plant else GREY, linewidth=0.9, linestyle=(0, (4, 3)), zorder=1)
        if at_s - labelled >= LABEL_ROOM * scenario.duration_s:
            labelled = at_s
            short = text if len(text) <= MAX_MARKER else text[: MAX_MARKER - 1] + "…"
            axes[0].annotate(short, (at_s / 3600, 1.02), xycoords=("data", "axes fraction"), rotation=22,
                             fontsize=7.5, color=ORANGE if plant else "#5c6670", ha="left", va="bottom")


def _loop_plot(log: Log, scenario: Scenario, loop: Loop) -> Plot:
    data = trace(log, loop)
    t = [x / 3600 for x in data.t]
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(9.6, 5.2), sharex=True, height_ratios=(3, 2))
    if log.has(f"{loop.pv}.meas") and log.has(f"{loop.pv}.true"):
        upper.plot(t, log.numbers(f"{loop.pv}.meas"), color=BLUE, alpha=0.3, linewidth=0.8,
                   label=f"{loop.pv} measured")
    upper.plot(t, data.y, color=BLUE, linewidth=1.5, label=f"{loop.pv} true" if log.has(f"{loop.pv}.true") else loop.pv)
    upper.step(t, data.r, where="post", color=ORANGE, linewidth=1.3, label="setpoint")
    upper.set_ylabel(f"{loop.pv} [{channel_unit(log, loop.pv)}]")
    upper.legend(loc="best", ncols=3, fontsize=8)
    _output(lower, log, loop, t, data.u)
    lower.set_xlabel("plant time [h]")
    lower.set_xlim(t[0], t[-1])
    _mark([upper, lower], scenario)
    return finish(figure, f"loop-{loop.name}", f"Loop {loop.name}: {loop.pv} follows its setpoint by {loop.mv}. "
                   "Grey: the operator's lines, orange: what was done to the plant.")


def _output(ax: Any, log: Log, loop: Loop, t: list[float], applied: list[float]) -> None:
    if log.has(f"{loop.mv}.cmd"):
        ax.step(t, log.numbers(f"{loop.mv}.cmd"), where="post", color=GREEN, alpha=0.45, linewidth=0.9,
                label="commanded")
    # The log's applied value is the mean over the interval before its sample.
    ax.step(t, applied, where="pre", color=GREEN, linewidth=1.4, label=f"{loop.mv} applied")
    ax.set_ylabel(f"{loop.mv} [{channel_unit(log, loop.mv)}]")
    ax.legend(loc="best", ncols=2, fontsize=8)


def changing_columns(log: Log, scenario: Scenario) -> list[str]:
    """The plant's inputs that the scenario changes, which the log carries."""
    names = dict.fromkeys(event.name for event in scenario.events)
    return [name for name in names if log.has(name)]


def _inputs_plot(log: Log, scenario: Scenario, names: list[str]) -> Plot:
    figure, axes = plt.subplots(len(names), 1, figsize=(9.6, 1.0 + 1.15 * len(names)), sharex=True, squeeze=False)
    rows = [row[0] for row in axes]
    t = hours(log)
    for ax, name in zip(rows, names):
        ax.step(t, log.numbers(name), where="post", color=GREY, linewidth=1.5)
        ax.set_ylabel(f"{name} [{log.unit(name)}]")
        ax.margins(y=0.2)
    rows[-1].set_xlabel("plant time [h]")
    rows[-1].set_xlim(t[0], t[-1])
    return finish(figure, "inputs", "What was done to the plant.")


def column_plot(log: Log, names: list[str], title: str) -> Plot:
    """tools/plot: the columns named, those of one unit in one frame."""
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(log.unit(name), []).append(name)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(len(groups), 1, figsize=(9.6, 1.0 + 2.4 * len(groups)), sharex=True,
                                    squeeze=False)
        t = hours(log)
        for (row,), (name_of_unit, members) in zip(axes, groups.items()):
            for name in members:
                row.plot(t, log.numbers(name), linewidth=1.2, label=bare(name))
            row.set_ylabel(f"[{name_of_unit or '-'}]")
            row.legend(loc="best", fontsize=8)
        axes[0][0].set_title(title)
        axes[-1][0].set_xlabel("plant time [h]")
        return finish(figure, "columns", title)


def finish(figure: Any, name: str, caption: str, with_svg: bool = True) -> Plot:
    svg, png = io.StringIO(), io.BytesIO()
    if with_svg:
        figure.savefig(svg, format="svg", metadata={"Date": None})
    figure.savefig(png, format="png", dpi=130)
    plt.close(figure)
    return Plot(name, caption, svg.getvalue(), png.getvalue())


def write_pngs(plots: list[Plot], folder: Path) -> list[Path]:
    """A name may come from a board: what is not a letter, digit, dot or hyphen becomes an underscore in the file's."""
    paths = []
    for plot in plots:
        path = folder / f"plot-{re.sub(r'[^A-Za-z0-9.-]', '_', plot.name)}.png"
        path.write_bytes(plot.png)
        paths.append(path)
    return paths


def default_columns(log: Log) -> list[str]:
    """Curves that a person wants to see first: measurements, setpoints, applied outputs."""
    wanted = [c for c in map(bare, log.columns)
              if c.endswith((".meas", ".applied")) or (c.startswith(FIRMWARE_PREFIX) and c.endswith(".sp"))]
    of_board = [c for c in map(bare, log.columns) if log.has(f"{c}.q") or c.endswith((".sp", ".app"))]
    return wanted or of_board or [bare(c) for c in log.columns[2:8] if unit(c)]
