"""Outputs as measured and as a model that was given the inputs alone."""

from __future__ import annotations

import io
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend has to be chosen first

from reflux.plots import BLUE, GREY, ORANGE, STYLE  # noqa: E402


def draw(series: list[tuple[str, Any, Any]], border: int, period: float) -> bytes:
    """PNG. series: name, measured, simulated; border: the first sample of the validation."""
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(len(series), 1, figsize=(9.6, 1.2 + 2.4 * len(series)), sharex=True, squeeze=False)
        for ax, (name, measured, simulated) in zip((row[0] for row in axes), series):
            t = [k * period / 3600 for k in range(len(measured))]
            ax.plot(t, measured, color=BLUE, linewidth=0.8, alpha=0.6, label=f"{name} measured")
            ax.plot(t, simulated, color=ORANGE, linewidth=1.1, label="model, from the inputs alone")
            ax.axvline(border * period / 3600, color=GREY, linewidth=0.9, linestyle=(0, (4, 3)))
            ax.set_ylabel(name)
            ax.legend(loc="best", ncols=2, fontsize=8)
        axes[-1][0].set_xlabel("time [h]; right of the dashed line: data the model has not seen")
        png = io.BytesIO()
        figure.savefig(png, format="png", dpi=110, metadata={"Software": None})
        plt.close(figure)
    return png.getvalue()
