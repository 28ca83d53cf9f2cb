"""Measures of how well a loop did. Definitions (also in docs/use/scenarios.md), for samples t_k, y_k and the
setpoint r_k that holds from t_k to t_k+1:

  iae        sum over the intervals of dt * (|r_k - y_k| + |r_k - y_k+1|) / 2          [unit s]
  overshoot  the furthest y goes beyond the new setpoint, in % of the setpoint step      [%]
  settling   from the step until |r - y| stays within the band: the loop's own `band`,
             or 5 % of the step; NaN when it never does                                  [s]
  tv         sum of |u_k - u_k-1|, the travel of the manipulated variable                [unit of u]
  max_error  the largest |r - y|                                                         [unit]
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

from reflux.logs import FIRMWARE_PREFIX, Log
from reflux.errors import RunFailed
from reflux.scenario import Loop, Scenario, is_stimulus, window_starts


ZERO_DEGC_K = 273.15


@dataclass(frozen=True)
class Trace:
    """Samples by which one loop is judged."""

    t: list[float]
    y: list[float]
    r: list[float]
    u: list[float]


@dataclass(frozen=True)
class Window:
    """One stretch of the run, from one change to the next, or the whole of it (kind "overall")."""

    loop: str
    kind: str  # start, setpoint, interaction, disturbance, overall
    what: str
    from_s: float
    to_s: float
    step: float | None
    iae: float
    overshoot_percent: float | None
    settling_s: float | None
    tv: float
    max_error: float

    def as_dict(self) -> dict[str, object]:
        """For JSON, which knows no NaN: never settled is written as text."""
        out: dict[str, object] = asdict(self)
        for key, value in out.items():
            if isinstance(value, float) and not math.isfinite(value):
                out[key] = "never" if key == "settling_s" else None
        return out


def iae(t: list[float], y: list[float], r: list[float]) -> float:
    total = 0.0
    for k in range(len(t) - 1):
        total += (t[k + 1] - t[k]) * (abs(r[k] - y[k]) + abs(r[k] - y[k + 1])) / 2
    return total


def travel(u: list[float]) -> float:
    return sum(abs(b - a) for a, b in zip(u, u[1:]))


def overshoot(y: list[float], before: float, after: float) -> float:
    step = after - before
    beyond = max((value - after if step > 0 else after - value) for value in y)
    return max(0.0, beyond) / abs(step) * 100


def settling(t: list[float], y: list[float], target: float, band: float) -> float:
    """Time from t[0] until y is inside for good; 0 when it never left, NaN when it is outside at the end."""
    last_outside = None
    for k, value in enumerate(y):
        if not abs(target - value) <= band:
            last_outside = k
    if last_outside is None:
        return 0.0
    if last_outside == len(y) - 1:
        return math.nan
    return t[last_outside + 1] - t[0]


def trace(log: Log, loop: Loop) -> Trace:
    """The true value where the simulator logged it, else the measurement; the setpoint the firmware reports;
    the output that was applied, else the commanded one. A chip measures in degC where the plant may have K: the setpoint is in the plant's unit."""
    pv = _first(log, f"{loop.pv}.true", f"{loop.pv}.meas", loop.pv)
    sp = _first(log, f"{FIRMWARE_PREFIX}{loop.name}.sp", f"{loop.name}.sp")
    u = _first(log, f"{loop.mv}.applied", f"{loop.mv}.app", f"{loop.mv}.cmd")
    shift = ZERO_DEGC_K if (log.unit(pv), log.unit(sp)) == ("K", "degC") else 0.0
    return Trace(log.numbers("time"), log.numbers(pv), [r + shift for r in log.numbers(sp)], log.numbers(u))


def _first(log: Log, *names: str) -> str:
    for name in names:
        if log.has(name):
            return name
    raise RunFailed(f"the log has none of the columns {', '.join(names)}")


def windows(log: Log, scenario: Scenario, loop: Loop) -> list[Window]:
    """The windows of one loop in order of time, then the whole run."""
    data = trace(log, loop)
    starts = [t for t in window_starts(scenario) if t <= data.t[-1]]
    out = []
    for number, start in enumerate(starts):
        end = starts[number + 1] if number + 1 < len(starts) else data.t[-1]
        kind, what = describe(scenario, loop, start)
        out.append(_window(data, loop, kind, what, start, end))
    out.append(_window(data, loop, "overall", "whole run", data.t[0], data.t[-1]))
    return out


def describe(scenario: Scenario, loop: Loop, start: float) -> tuple[str, str]:
    """Describes what begins a window, for this loop."""
    words = []
    kind = "start" if start == 0 else "interaction"
    for event in scenario.events:
        if event.at_s == start:
            words.append(f"{event.name} = {event.value:g}")
            kind = "disturbance"
    for line in scenario.lines:
        if line.at_s == start and is_stimulus(line):
            words.append(line.text)
            if line.text.split()[:2] == ["sp", loop.name]:
                kind = "setpoint"
    return kind, ", ".join(words) or "start"


def _window(data: Trace, loop: Loop, kind: str, what: str, start: float, end: float) -> Window:
    inside = [k for k, t in enumerate(data.t) if start <= t <= end]
    finite = [k for k in inside if math.isfinite(data.r[k]) and math.isfinite(data.y[k])]
    t = [data.t[k] for k in finite]
    y = [data.y[k] for k in finite]
    r = [data.r[k] for k in finite]
    # The input's move at the first sample answers what began the window, so the value before it counts;
    # the move at the last sample answers what begins the next one.
    last = inside[-1] + (1 if inside and inside[-1] == len(data.t) - 1 or kind == "overall" else 0)
    u = [value for value in data.u[max(0, inside[0] - 1):last] if math.isfinite(value)]
    if not t:
        return Window(loop.name, kind, what, start, end, None, math.nan, None, None, travel(u), math.nan)
    held = r[:-1] if len(r) > 1 and end < data.t[-1] else r  # at `end` the next window's setpoint stands
    target, over, settled, step = held[-1], None, None, None
    if kind == "setpoint":
        before = next((v for v in reversed(data.r[:inside[0]]) if math.isfinite(v)), math.nan)
        # A change smaller than the band is no step: noise would be all there is to see.
        if math.isfinite(before) and before != target and abs(target - before) >= loop.band:
            step = target - before
            over = overshoot(y, before, target)
    band = loop.band or (0.05 * abs(step) if step else 0.0)
    if kind in ("setpoint", "disturbance", "interaction") and band > 0:
        settled = settling(t, y, target, band)
    errors = [abs(a - b) for a, b in zip(held, y)]
    return Window(loop.name, kind, what, start, end, step, iae(t, y, r), over, settled, travel(u), max(errors))


HELD_BACK = 1e-3  # of the output's travel in the run: a larger share between command and applied is not rounding
OFTEN = 0.5  # of a window's samples


def why_never(log: Log, loop: Loop, window: Window, units: tuple[str, str]) -> str:
    """A sentence for a window whose settling time is "never": how far the loop was from its setpoint when the window ended, and what
    held its output back, where something did."""
    data = trace(log, loop)
    inside = [k for k, t in enumerate(data.t) if window.from_s <= t < window.to_s and math.isfinite(data.r[k]) and math.isfinite(data.y[k])]
    band = loop.band or 0.05 * abs(window.step or 0.0)
    words = f"{loop.name}, from {window.from_s:.4g} s: never within \u00b1{band:.4g} {units[0]} for good before the window ended at {window.to_s:.4g} s"
    if inside:
        words += f"; {loop.pv} was then {abs(data.r[inside[-1]] - data.y[inside[-1]]):.4g} {units[0]} from its setpoint"
    if log.has(f"{loop.mv}.cmd"):
        asked = log.numbers(f"{loop.mv}.cmd")
        span = max(asked) - min(asked)
        # A command holds from its sample on, so the plant's answer to it stands in the row after it.
        short = [k for k in inside if k + 1 < len(asked) and abs(asked[k] - data.u[k + 1]) > HELD_BACK * span]
        if inside and len(short) > OFTEN * len(inside):
            last = short[-1]
            return f"{words}. {loop.mv} did not follow: {asked[last]:.4g} {units[1]} was commanded, {data.u[last + 1]:.4g} {units[1]} applied."
    return f"{words}."
