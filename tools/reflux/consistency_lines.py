"""Parameters of a filter's covariances from what people know: data sheets, the feed's range, how good the model is (docs/methods/consistency.md)."""

from __future__ import annotations

import math
from dataclasses import dataclass

HOUR = 3600.0
EVENLY = math.sqrt(12.0)  # of an interval, over the standard deviation of what lies anywhere in it


@dataclass(frozen=True)
class Known:
    method: str
    sd: float  # K, of a thermometer at rest
    resolution: float = 0.0  # K
    feed_range: float = 0.0  # mole fraction, highest less lowest
    feed_stays_h: float = 4.0
    flow_accuracy: float = 0.0  # part, either way
    model_error: float = 0.01  # mole fraction
    model_time_h: float = 1.0
    analyser: float | None = None  # mole fraction
    analyser_resolution: float = 0.0
    offset: float | None = None


@dataclass(frozen=True)
class Row:
    name: str
    value: float
    why: str


def noise_of(sd: float, resolution: float) -> float:
    return math.hypot(sd, resolution / EVENLY)


def rows(k: Known) -> list[Row]:
    noise = noise_of(k.sd, k.resolution)
    feed_z, feed_f = k.feed_range / EVENLY, 2 * k.flow_accuracy / EVENLY
    out = [Row("noise", noise, f"{k.sd:g} K, and a resolution of {k.resolution:g} K over the root of 12")]
    if k.method == "rekf":
        error = math.hypot(k.model_error, feed_z)
        why = f"{k.model_error:g} that the model is off, and {feed_z:.3g} of the feed, which rekf does not estimate; times the root of 2 over {k.model_time_h:g} h"
        return [*out, Row("model", error * math.sqrt(2 / k.model_time_h), why)]
    out.append(Row("model", k.model_error * math.sqrt(2 / k.model_time_h), f"{k.model_error:g} that the model is off, times the root of 2 over {k.model_time_h:g} h"))
    out.append(Row("feed_z", feed_z, f"a range of {k.feed_range:g} over the root of 12" if feed_z else "the table's composition is right"))
    out.append(Row("feed_f", feed_f, f"{k.flow_accuracy:g} either way over the root of 3" if feed_f else "the meter is right"))
    if feed_z or feed_f:
        out.append(Row("feed_time", k.feed_stays_h * HOUR, f"{k.feed_stays_h:g} h from one change to the next, in the mean"))
    if k.analyser is not None:
        out.append(Row("analyser", noise_of(k.analyser, k.analyser_resolution), f"{k.analyser:g}, and a resolution of {k.analyser_resolution:g} over the root of 12"))
    if k.offset is not None:
        out.append(Row("offset", k.offset, "as given"))
    return out


def figure(x: float) -> str:
    return f"{x:.4g}" if x < 1000 else f"{x:.0f}"
