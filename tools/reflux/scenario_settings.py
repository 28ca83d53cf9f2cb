"""The settings that the console lines of a scenario make before its first sample: channels, loops and interlocks."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Iterable

from reflux.scenario import Scenario


@dataclass(frozen=True)
class LoopSettings:
    """A loop's control law in spans and seconds, as docs/methods/pid.md has it."""

    name: str
    pv: str
    out: str
    sign: float  # +1 reverse, -1 direct
    gain: float
    ti_s: float
    td_s: float
    n: float
    b: float
    filter_s: float  # of the measurement
    pv_span: float
    out_span: float
    divisor: float


@dataclass(frozen=True)
class Interlock:
    meas: str
    mv: str
    side: str
    limit: float


def lines_of(scenario: Scenario) -> list[str]:
    """Lines before the first sample."""
    return [line.text for line in [*scenario.config, *(line for line in scenario.lines if line.at_s == 0)]]


def values_of(lines: Iterable[str]) -> dict[str, str]:
    """Parameter and last value of each `set` line."""
    return {words[1]: words[2] for words in (line.split() for line in lines) if len(words) >= 3 and words[0] == "set"}


def numbered(values: dict[str, str], group: str) -> list[str]:
    """loop1, loop2, ... that the lines set, in order."""
    found = {int(m[1]) for name in values if (m := re.fullmatch(rf"{group}(\d+)\.\w+", name))}
    return [f"{group}{k}" for k in sorted(found)]


def in_use(values: dict[str, str], group: str) -> dict[str, str]:
    """Channels or loops that have a name, in order: the name, and the parameters' prefix, such as loop1."""
    return {name: k for k in numbered(values, group) if (name := values.get(f"{k}.name", "-")) != "-"}


def has_sequence(values: dict[str, str]) -> bool:
    return any(value not in ("-", "") for name, value in values.items() if re.fullmatch(r"step\d+\.seq", name))


def interlocks(scenario: Scenario) -> list[Interlock]:
    values = values_of(lines_of(scenario))
    found = [Interlock(values.get(f"{k}.meas", "-"), values.get(f"{k}.mv", "-"), values.get(f"{k}.side", "above"), number(values.get(f"{k}.limit")))
             for k in numbered(values, "lock")]
    return [lock for lock in found if lock.meas != "-" and math.isfinite(lock.limit)]


def number(text: str | None, otherwise: float = math.nan) -> float:
    try:
        return float(text) if text is not None else otherwise
    except ValueError:
        return math.nan


def loops(values: dict[str, str]) -> list[LoopSettings]:
    """Loops whose measurement and output are channels with a span. Defaults are those of docs/reference/parameters.md."""
    channels = {values[f"{k}.name"]: k for group in ("meas", "mv") for k in numbered(values, group) if f"{k}.name" in values}
    out = []
    for k in numbered(values, "loop"):
        def of(field: str, otherwise: float) -> float:
            return number(values.get(f"{k}.{field}"), otherwise)

        pv, mv = values.get(f"{k}.pv", "-"), values.get(f"{k}.out", "-")
        if pv not in channels or mv not in channels:
            continue
        spans = [number(values.get(f"{channels[c]}.hi"), 100.0) - number(values.get(f"{channels[c]}.lo"), 0.0) for c in (pv, mv)]
        out.append(LoopSettings(values.get(f"{k}.name", k), pv, mv, -1.0 if values.get(f"{k}.action") == "direct" else 1.0, of("gain", 1.0),
                                of("ti", 0.0), of("td", 0.0), of("n", 8.0), of("b", 1.0), number(values.get(f"{channels[pv]}.filter"), 0.0),
                                spans[0], spans[1], of("divisor", 1.0)))
    return out
