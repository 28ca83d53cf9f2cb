"""Columns from Python: their steady states, profiles and gains, as tools/column has them. A column is a name of host_sim/plants or a file
(docs/use/columns.md).

    reflux.columns.steady("splitter").temperature          # K, from the reboiler up
    reflux.columns.gains("splitter", outputs=["T5", "T27"], inputs=["R", "Q"])
"""

from __future__ import annotations

from typing import Sequence

import numpy as np

from reflux import cmd_column, column_file, column_slopes, linear_analysis, simulator
from reflux.column_file import ColumnFile
from reflux.column_slopes import Steady
from reflux.errors import RunFailed, UserError


def read(name: str) -> ColumnFile:
    """Stages, feed, and which output sees which stage."""
    return column_file.read(name)


def steady(name: str, **inputs: float) -> Steady:
    """The steady state of the nominal inputs, or with some of them set: temperatures, flows, holdups and compositions of all stages."""
    return column_slopes.steady(name, inputs)


def profile(name: str, **inputs: float) -> dict[str, list[float]]:
    """Columns of reflux-sim --profile, from the reboiler up; NaN where a stage has no such thing."""
    return cmd_column.profile(name, simulator.setting_words(f"{key}={value:.17g}" for key, value in inputs.items()))


def gains(name: str, *, outputs: Sequence[str], inputs: Sequence[str], at: dict[str, float] | None = None) -> np.ndarray:
    """Steady-state gains, outputs x inputs, in engineering units. RunFailed where the column does not come to rest after a step."""
    model = linearised(name, at)
    for what, names, known in (("input", inputs, model.inputs), ("output", outputs, model.outputs)):
        if unknown := [other for other in names if other not in known]:
            raise UserError(f"{name} has no {what} {unknown[0]}; there are {', '.join(known)}")
    model = model.only(tuple(inputs), tuple(outputs))
    if reason := linear_analysis.obstacle(linear_analysis.poles(model)):
        raise RunFailed(f"{name} has no steady-state gains: {reason}")
    return linear_analysis.gains(model)


def linearised(name: str, at: dict[str, float] | None = None) -> linear_analysis.Model:
    """dx/dt = A x + B u, y = C x + D u about a steady state."""
    data = simulator.linearised(name, [f"{key}={value:.17g}" for key, value in (at or {}).items()])
    x, y = len(data["x"]), len(data["outputs"])
    a, b, c, d = (np.array(data[key], float).reshape(rows, -1) for key, rows in (("A", x), ("B", x), ("C", y), ("D", y)))
    return linear_analysis.Model(a, b, c, d, tuple(data["inputs"]), tuple(data["outputs"]))
