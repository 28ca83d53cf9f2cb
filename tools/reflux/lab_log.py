"""What Lab.run() returns: a pandas DataFrame where pandas is installed, else a small table with the same column access.

Columns are those of log.csv (docs/use/logs.md) without their units, which are in attrs["units"]. A name that people use finds its column:
T1 is T1.meas, bottom.sp is fw.bottom.sp.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Iterator, Sequence

import numpy as np

from reflux import logs
from reflux.errors import UserError

APART = 5.0  # times the wider range of two curves: with a larger gap between them both look flat on one axis

try:
    import pandas
except ModuleNotFoundError:
    pandas = None  # type: ignore[assignment]


def numbers(log: logs.Log) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Columns and their units. The board's numbers are float32, as in logs.Log.numbers()."""
    columns, units = {}, {}
    for place, name in enumerate(log.columns):
        bare = logs.bare(name)
        if bare in columns:
            continue
        values = np.array([logs.number(row[place]) for row in log.rows])
        if bare.startswith(logs.FIRMWARE_PREFIX):
            with np.errstate(over="ignore"):
                values = values.astype(np.float32).astype(float)
        columns[bare], units[bare] = values, logs.unit(name)
    return columns, units


def resolved(name: str, columns: Sequence[str]) -> str:
    """The column that a person means."""
    if not isinstance(name, str):
        raise KeyError(f"a column is asked for by its name, not by {name!r}")
    for other in (name, *logs.aliases(name)):
        if other in columns:
            return other
    raise KeyError(f"no column {name}; there are {', '.join(columns)}")


class Table:
    """Columns of numbers by name, each a numpy array."""

    def __init__(self, columns: dict[str, np.ndarray], units: dict[str, str]):
        self._columns, self.attrs = columns, {"units": units}

    @property
    def columns(self) -> list[str]:
        return list(self._columns)

    def __len__(self) -> int:
        return len(next(iter(self._columns.values()), ()))

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def __getitem__(self, name: str) -> np.ndarray:
        return self._columns[resolved(name, self.columns)]

    def __repr__(self) -> str:
        return f"<log of {len(self)} samples: {', '.join(self.columns)}>"

    def plot(self, *columns: str) -> Any:
        """Draws these columns over time, one axis for each unit; without names the board's measurements, setpoints and
        outputs. Returns matplotlib's figure."""
        return draw(self, columns)


def of(columns: dict[str, np.ndarray], units: dict[str, str]) -> Any:
    """The log as people get it."""
    if pandas is None:
        return Table(columns, units)
    frame = _frame_class()(columns)
    frame.attrs["units"] = units
    return frame


_made: Any = None


def _frame_class() -> Any:
    """A DataFrame whose plot() draws a run and whose columns have the names that people use. Made once: pandas is optional."""
    global _made
    if _made is None:
        class LogFrame(pandas.DataFrame):
            """The log of a run."""

            @property
            def _constructor(self):  # type: ignore[no-untyped-def]
                return LogFrame

            def __getitem__(self, key):  # type: ignore[no-untyped-def]
                if isinstance(key, str) and key not in self.columns:
                    key = resolved(key, list(self.columns))
                return super().__getitem__(key)

            def plot(self, *columns: str) -> Any:
                """As Table.plot()."""
                return draw(self, columns)

        _made = LogFrame
    return _made


def drawn_by_default(names: Sequence[str]) -> list[str]:
    """What the board sees and does: measurements, setpoints and outputs as applied."""
    own = [n.removeprefix(logs.FIRMWARE_PREFIX) for n in names if n.startswith(logs.FIRMWARE_PREFIX)] or list(names)
    measured = [n for n in own if f"{n}.q" in own]
    wanted = [*measured, *(n for n in own if n.endswith((".sp", ".app")))]
    return [resolved(n, names) for n in wanted] or [n for n in names if n.endswith((".meas", ".applied"))]


def together(curves: dict[str, np.ndarray]) -> list[list[str]]:
    """Curves of one unit that share an axis. Curves so far apart that both would look flat get axes of their own; a setpoint stays with the
    nearest curve."""
    known = {name: values[np.isfinite(values)] for name, values in curves.items()}
    ranges = {name: (float(v.min()), float(v.max())) for name, v in known.items() if len(v)}
    free = {name: r for name, r in ranges.items() if not name.endswith(".sp")} or ranges
    groups: list[tuple[float, float, list[str]]] = []
    for name, (low, high) in sorted(free.items(), key=lambda item: item[1]):
        if groups:
            first, last, members = groups[-1]
            widest = max(last - first, high - low)
            if not widest > 0 or low - last <= APART * widest:
                groups[-1] = (first, max(last, high), [*members, name])
                continue
        groups.append((low, high, [name]))
    for name in curves:
        if name not in free:
            low, high = ranges.get(name, (0.0, 0.0))
            min(groups, key=lambda g: max(g[0] - high, low - g[1]), default=(0.0, 0.0, []))[2].append(name)
    found = [[name for name in curves if name in members] for _, _, members in groups] or [list(curves)]
    return sorted(found, key=lambda members: list(curves).index(members[0]))


def drawn_values(log: Any, name: str) -> np.ndarray:
    """The column; of a setpoint only where its loop acts on it."""
    values, mode = np.asarray(log[name], dtype=float), logs.mode_of(name)
    return np.array(logs.acted_on(values, log[mode])) if name.endswith(".sp") and mode in log.columns else values


def draw(log: Any, wanted: Sequence[str]) -> Any:
    import matplotlib.pyplot as plt

    names, units = list(log.columns), log.attrs["units"]
    try:
        chosen = [resolved(name, names) for name in wanted] or drawn_by_default(names)
    except KeyError as error:
        raise UserError(str(error.args[0])) from None
    groups = [(unit, members) for unit in dict.fromkeys(units.get(name, "") for name in chosen)
              for members in together({name: drawn_values(log, name) for name in chosen if units.get(name, "") == unit})]
    figure, axes = plt.subplots(max(1, len(groups)), 1, sharex=True, squeeze=False, layout="constrained", figsize=(8, 2.4 * max(1, len(groups))))
    time = np.asarray(log[resolved("time", names)])
    scale, word = (3600.0, "h") if len(time) and time[-1] - time[0] > 7200 else (1.0, "s")
    for axis, (unit, members) in zip(axes[:, 0], groups):
        for name in members:
            step = name.endswith((".app", ".applied", ".cmd", ".sp"))
            axis.plot(time / scale, drawn_values(log, name), drawstyle="steps-post" if step else "default", label=logs.label(name))
        axis.set_ylabel(unit)
        axis.legend(loc="best")
        axis.grid(alpha=0.3)
    axes[-1, 0].set_xlabel(f"time, {word}")
    return figure


def write(log: logs.Log, path: Path | str) -> None:
    """As the log.csv of tools/run."""
    logs.write_csv(log, Path(path))
