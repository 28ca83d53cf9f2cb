"""The limits of a scenario against what was measured."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from reflux.metrics import Window
from reflux.scenario import Limit, Scenario

UNITS = {"iae": "{y} s", "overshoot_percent": "%", "settling_s": "s", "tv": "{u}", "max_error": "{y}"}
TITLES = {"iae": "IAE", "overshoot_percent": "overshoot", "settling_s": "settling time",
          "tv": "total variation", "max_error": "largest error"}


@dataclass(frozen=True)
class Check:
    loop: str
    at_s: float | None
    metric: str
    value: float | None  # None: there is no such number (no step, never settled)
    most: float
    passed: bool

    def as_dict(self) -> dict[str, object]:
        return asdict(self)

    def sentence(self) -> str:
        when = "over the whole run" if self.at_s is None else f"in the window from {self.at_s:g} s"
        got = ("never reached" if self.metric == "settling_s" else "none") if self.value is None else f"{self.value:.4g}"
        return f"loop {self.loop}: {TITLES[self.metric]} {when} is {got}, at most {self.most:g} allowed"


def check(scenario: Scenario, windows: list[Window]) -> list[Check]:
    return [one for limit in scenario.limits for one in _check_limit(limit, windows)]


def _check_limit(limit: Limit, windows: list[Window]) -> list[Check]:
    window = _find(limit, windows)
    out = []
    for metric, most in limit.most.items():
        value = getattr(window, metric) if window else None
        if window and window.kind == "overall" and metric in ("overshoot_percent", "settling_s"):
            value = _worst(limit.loop, metric, windows)
        if value is not None and value != value:
            value = None
        out.append(Check(limit.loop, limit.at_s, metric, value, most, value is not None and value <= most))
    return out


def _find(limit: Limit, windows: list[Window]) -> Window | None:
    for window in windows:
        if window.loop == limit.loop:
            if limit.at_s is None and window.kind == "overall":
                return window
            if limit.at_s is not None and window.kind != "overall" and window.from_s == limit.at_s:
                return window
    return None


def _worst(loop: str, metric: str, windows: list[Window]) -> float | None:
    """Over the whole run these two mean the worst setpoint step."""
    values = [getattr(w, metric) for w in windows if w.loop == loop and w.kind == "setpoint"]
    values = [v for v in values if v is not None]
    if not values or any(v != v for v in values):
        return None
    return max(values)
