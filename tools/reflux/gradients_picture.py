"""The gradient diagram: how much colder each stage's neighbour above is, and the components' shares in it."""

from __future__ import annotations

import io
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first

from reflux.gradients import Diagram  # noqa: E402
from reflux.plots import BLUE, GREY, ORANGE, STYLE  # noqa: E402

COLOURS = ("#1f5fa8", "#d2691e", "#2e7d4f", "#8e44ad", "#b8860b", "#c0392b", "#16a085", "#7f8c8d", "#2c3e50", "#e67e22")


def draw(name: str, title: str, of: Diagram, feed: int, report: dict[str, Any]) -> bytes:
    """PNG."""
    stages = list(range(1, of.stages))
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            2 if of.share else 1, 1, figsize=(9.6, 6.2 if of.share else 3.4), sharex=True, squeeze=False
        )
        top = axes[0][0]
        top.bar(stages, of.gradient, width=0.75, color=GREY)
        mark(top, of, report)
        top.set_ylabel("T above less T, K")
        top.set_title("gradient")
        if of.share:
            stack(axes[1][0], of, stages)
        for ax in (row[0] for row in axes):
            ax.set_axisbelow(True)
            ax.axvline(feed, color="#5c6670", linewidth=1.0, linestyle=(0, (4, 3)), zorder=1)
            ax.axhline(0, color="#5c6670", linewidth=0.8)
        axes[-1][0].xaxis.get_major_locator().set_params(integer=True)
        axes[-1][0].set_xlabel(f"stage (1 reboiler, {of.stages} condenser; dashed: feed, stage {feed})")
        figure.suptitle(f"{name}: {title}", x=0.01, ha="left", fontsize=10, fontweight="bold")
        png = io.BytesIO()
        figure.savefig(png, format="png", dpi=110, metadata={"Software": None})
        plt.close(figure)
        return png.getvalue()


def mark(ax: Any, of: Diagram, report: dict[str, Any]) -> None:
    candidates = [s for choice in report["control"] for s in choice["candidates"]]
    ax.bar(candidates, [of.gradient[s - 1] for s in candidates], width=0.75, color=BLUE, label="candidates")
    for key, label, marker in (
        ("by_keys", "primary, rule A", "v"),
        ("by_product", "primary, rule B", "s"),
        ("second", "secondary", "o"),
    ):
        chosen = [choice[key] for choice in report["control"] if choice[key]]
        if chosen:
            ax.plot(
                chosen,
                [of.gradient[s - 1] for s in chosen],
                marker,
                color=ORANGE,
                markersize=7,
                linestyle="none",
                markerfacecolor="none" if marker == "o" else ORANGE,
                label=label,
            )
    if candidates:
        ax.legend(fontsize=8, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, borderpad=0.1)


def stack(ax: Any, of: Diagram, stages: list[int]) -> None:
    """Shares of one sign on top of one another, upwards and downwards."""
    up, down = [0.0] * len(stages), [0.0] * len(stages)
    for j, name in enumerate(of.names):
        share = [of.share[s - 1][j] for s in stages]
        base = [up[i] if v > 0 else down[i] for i, v in enumerate(share)]
        ax.bar(stages, share, width=0.75, bottom=base, color=COLOURS[j % len(COLOURS)], label=name)
        up = [u + max(v, 0.0) for u, v in zip(up, share)]
        down = [d + min(v, 0.0) for d, v in zip(down, share)]
    ax.plot(stages, of.gradient, color="black", linewidth=1.0, marker=".", markersize=3, label="gradient")
    ax.set_ylabel("K")
    ax.set_title("shares of the components")
    ax.legend(fontsize=8, ncols=min(len(of.names) + 1, 7), loc="lower right", bbox_to_anchor=(1.0, 1.0), borderpad=0.1)
