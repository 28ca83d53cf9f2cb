"""The profile of a column: compositions, temperature, and how much it changes from stage to stage."""

from __future__ import annotations

import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first

from reflux.column_file import ColumnFile  # noqa: E402
from reflux.plots import BLUE, GREY, ORANGE, STYLE  # noqa: E402


def draw(column: ColumnFile, profile: dict[str, list[float]]) -> bytes:
    """PNG. Stages stand upwards, as in the column."""
    stages = profile["stage"]
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, 3, figsize=(9.6, 5.4), sharey=True, width_ratios=(4, 3, 3))
        for key in (key for key in profile if key.startswith("x.")):
            axes[0].plot(profile[key], stages, marker=".", markersize=4, linewidth=1.3, label=key.removeprefix("x."))
        axes[0].set_xlabel("mole fraction in the liquid [-]")
        axes[0].set_ylabel("stage (1 reboiler, %d condenser)" % column.stages)
        axes[0].legend(fontsize=8)
        axes[1].plot(profile["T[K]"], stages, marker=".", markersize=4, linewidth=1.3, color=BLUE)
        axes[1].set_xlabel("temperature [K]")
        axes[2].barh([s - 0.5 for s in stages[1:]], [-d for d in profile["dT[K]"][1:]], height=0.8, color=ORANGE)
        axes[2].set_xlabel("warmer than the stage above [K]")
        for ax in axes:
            ax.axhline(column.feed_stage, color=GREY, linewidth=1.0, linestyle=(0, (4, 3)), zorder=1)
        axes[2].annotate(f"feed, stage {column.feed_stage}", (1.0, column.feed_stage), xycoords=("axes fraction", "data"),
                         xytext=(0, 3), textcoords="offset points", ha="right", fontsize=8, color="#5c6670")
        axes[0].set_ylim(0, column.stages + 1)
        figure.suptitle(f"{column.name}: {column.title}", x=0.01, ha="left", fontsize=10, fontweight="bold")
        png = io.BytesIO()
        figure.savefig(png, format="png", dpi=110, metadata={"Software": None})
        plt.close(figure)
        return png.getvalue()
