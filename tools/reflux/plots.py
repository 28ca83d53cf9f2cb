"""What all plots of the tools have in common: colours, sizes for wide and narrow screens, files; and the plot of tools/plot."""

from __future__ import annotations

import io
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Sequence

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first
from matplotlib.transforms import ScaledTranslation  # noqa: E402

from reflux.logs import FIRMWARE_PREFIX, Log, bare, label, unit  # noqa: E402

BLUE, ORANGE, GREY, GREEN, RED = "#1f5fa8", "#d2691e", "#8a929c", "#2e7d4f", "#b3261e"
# Beside a stronger line of the same colour. Curves are opaque, so that each stands out from the page by 3:1, also where a dark page inverts it.
PALE_BLUE, PALE_GREEN = "#6a8fbf", "#659a7b"
UNDER_TICKS_PT = 30.0  # ticks and label of an axis
LEGEND_WIDE = 20       # characters of a name that take half of a phone's width
STYLE = {
    "font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "grid.color": "#e4e7eb", "grid.linewidth": 0.8, "axes.edgecolor": "#5c6670", "axes.titlesize": 10,
    "axes.titleweight": "bold", "axes.titlelocation": "left", "legend.frameon": False, "svg.fonttype": "path",
    "figure.constrained_layout.use": True, "svg.hashsalt": "reflux",
}


@dataclass(frozen=True)
class Plot:
    name: str
    caption: str
    svg: str
    png: bytes
    alt: str = ""  # what a reader who cannot see the picture hears
    narrow: str = ""  # SVG for a phone


@dataclass(frozen=True)
class Size:
    """The width for which a picture is drawn. Letters have the same size in all of them."""

    inches: float
    points: int  # of a curve at most
    narrow: bool


WIDE, NARROW = Size(9.6, 1000, False), Size(3.9, 400, True)


def drawn(draw: Callable[[Size], Any], name: str, caption: str, alt: str = "") -> Plot:
    """draw makes the figure for a size. The narrow one is an SVG alone."""
    with plt.rc_context(STYLE):
        wide = finish(draw(WIDE), name, caption)
        narrow = svg_of(draw(NARROW))
    return Plot(name, caption, wide.svg, wide.png, alt, narrow)


def finish(figure: Any, name: str, caption: str, with_svg: bool = True) -> Plot:
    png = io.BytesIO()
    if with_svg:  # laid out once for both files: that takes longer than drawing
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
    figure.savefig(png, format="png", dpi=130)
    plot = Plot(name, caption, svg_of(figure) if with_svg else "", png.getvalue())
    plt.close(figure)
    return plot


def svg_of(figure: Any) -> str:
    """With a transparent ground, because the page may be dark, and with coordinates to a hundredth of a point."""
    svg = io.StringIO()
    figure.savefig(svg, format="svg", metadata={"Date": None}, transparent=True)
    plt.close(figure)
    return re.sub(r' d="[^"]*"', lambda path: re.sub(r"(\.\d\d)\d+", r"\1", path[0]), svg.getvalue())


def thinned(t: Sequence[float], y: Sequence[float], most: int) -> tuple[list[float], list[float]]:
    """At most about `most` points that look the same: of each stretch the smallest and the largest value, in order of time."""
    if len(t) <= most:
        return list(t), list(y)
    stretch = math.ceil(2 * len(t) / most)
    kept = {0, len(t) - 1}
    for first in range(0, len(t), stretch):
        inside = range(first, min(first + stretch, len(t)))
        known = [k for k in inside if math.isfinite(y[k])]
        kept |= {min(known, key=lambda k: y[k]), max(known, key=lambda k: y[k])} if known else {first}
    return [t[k] for k in sorted(kept)], [y[k] for k in sorted(kept)]


def legend_beside(ax: Any, size: Size, above: bool = False, labelled: bool = True, columns: int = 4, points: float = 8.0) -> None:
    """A legend outside of the axes, where no curve is: below them, or above. labelled: the axis of time has its numbers and its label here."""
    names = ax.get_legend_handles_labels()[1]
    if not names:
        return
    if size.narrow:
        columns = 1 if max(map(len, names)) > LEGEND_WIDE else 2 if max(map(len, names)) > LEGEND_WIDE // 2 else 3
    down = 2.0 if above else -UNDER_TICKS_PT if labelled else -2.0
    place = ax.transAxes + ScaledTranslation(0, down / 72, ax.figure.dpi_scale_trans)
    ax.legend(loc="lower left" if above else "upper left", bbox_to_anchor=(0.0, 1.0 if above else 0.0), bbox_transform=place, borderaxespad=0.0,
              ncols=columns, fontsize=points)


def from_to(name: str, values: Sequence[float], unit_name: str) -> str:
    """A curve in words, for a picture's alternative text."""
    known = [v for v in values if math.isfinite(v)]
    if not known:
        return f"{name} without a value"
    low, high = min(known), max(known)
    words = f"{name} from {low:.4g} to {high:.4g}" if f"{low:.4g}" != f"{high:.4g}" else f"{name} at {low:.4g}"
    return f"{words} {unit_name}".rstrip(" -")


def hours(log: Log) -> list[float]:
    return [t / 3600 for t in log.numbers("time")]


# ---- tools/plot ----

# Columns that hold from a sample to the next one, and those whose value is of the interval before their sample (docs/use/logs.md).
HELD = (".cmd", ".app", ".sp", ".mode", ".q", ".quality", ".new", ".off")
MEANS = (".applied",)
HELD_ALONE = ("state", "safe", "seq", "step", "ev")


def curve_style(column: str) -> dict[str, str]:
    """Steps for what is held, a straight line between the samples of what moves."""
    name = column.removeprefix(FIRMWARE_PREFIX)
    if name.endswith(HELD) or name in HELD_ALONE:
        return {"drawstyle": "steps-post"}
    return {"drawstyle": "steps-pre"} if name.endswith(MEANS) else {}


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
            labels = [label(name) for name in members]
            for name, short in zip(members, labels):
                shown = short if labels.count(short) == 1 else bare(name)
                row.plot(t, log.numbers(name), linewidth=1.2, label=shown, **curve_style(name))
            row.set_ylabel(f"[{name_of_unit or '-'}]")
            row.legend(loc="best", fontsize=8)
        axes[0][0].set_title(title)
        axes[-1][0].set_xlabel("plant time [h]")
        return finish(figure, "columns", title)


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
