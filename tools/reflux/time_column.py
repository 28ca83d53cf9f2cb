"""The column of a table that holds the times of its rows: how it may be called, and what it may hold."""

from __future__ import annotations

import datetime
import math
import re

import numpy as np

from reflux.errors import UserError
from reflux.logs import Log, number

NAME = re.compile(r"(?:(?i:date[ _]?time|timestamp|date|time)|t)(?:(?:[ _]+|[ _]*[\[(] *)([A-Za-z]+) *[\])]?)?")
SECONDS = {"ms": 0.001, **dict.fromkeys(("", "s", "sec", "second", "seconds"), 1.0), **dict.fromkeys(("min", "minute", "minutes"), 60.0),
           **dict.fromkeys(("h", "hr", "hour", "hours"), 3600.0)}
WORDS = "time, Time, time_s, time (min), timestamp or date"


def find(log: Log) -> tuple[int, float] | None:
    """Returns the place of the first column that is called like one of times, and the seconds of its unit. None: there is no such
    column, or its unit is none of time. T is a temperature."""
    for place, column in enumerate(log.columns):
        match = NAME.fullmatch(column.strip())
        if match and (match[1] or "").lower() in SECONDS:
            return place, SECONDS[(match[1] or "").lower()]
    return None


def seconds(log: Log, place: int, unit_s: float) -> np.ndarray:
    """Times of all rows: numbers in the unit, or dates of ISO 8601."""
    cells = [row[place] for row in log.rows]
    dates = bool(cells) and "-" in cells[0][1:] and "e" not in cells[0].lower()
    times = np.array([date(cell) if dates else number(cell) * unit_s for cell in cells])
    if not np.isfinite(times).all():
        row = int(np.argmin(np.isfinite(times)))
        raise UserError(f"the rows of the log are not evenly spaced in time: row {row + 1} has no time, \"{cells[row]}\"")
    return times


def date(cell: str) -> float:
    """Seconds since 1970; a time without a zone is taken as UTC. NaN: no date."""
    try:
        moment = datetime.datetime.fromisoformat(cell.strip())
    except ValueError:
        return math.nan
    return (moment if moment.tzinfo else moment.replace(tzinfo=datetime.timezone.utc)).timestamp()
