"""Tables for a terminal and for Markdown, and numbers as people write them."""

from __future__ import annotations

import math
import re

from reflux.metrics import Window


def figure(value: float | None, digits: int = 3) -> str:
    """Three significant digits, - where there is no such number."""
    if value is None:
        return "-"
    if math.isnan(value):
        return "never"
    if value != 0 and (abs(value) >= 10 ** 6 or abs(value) < 10 ** -4):
        return f"{value:.{digits - 1}e}"
    if abs(value) >= 10 ** (digits - 1):
        return f"{value:.0f}"
    return f"{value:.{digits}g}"


LONG_NUMBER = re.compile(r"(?<![\w.:-])-?\d+\.\d+(?:e[+-]?\d+)?(?![\w.:])")


def rounded(text: str) -> str:
    """A line of the board for people: four significant digits in each number that has a decimal point."""
    return LONG_NUMBER.sub(lambda found: f"{float(found[0]):.4g}", text)


def columns(header: list[str], rows: list[list[str]]) -> str:
    """Left-aligned first two columns, right-aligned numbers."""
    widths = [max(len(row[i]) for row in [header, *rows]) for i in range(len(header))]
    text = [i for i in range(len(header)) if not any(_numeric(row[i]) for row in rows)]
    out = []
    for row in [header, *rows]:
        cells = [cell.ljust(w) if i in text else cell.rjust(w) for i, (cell, w) in enumerate(zip(row, widths))]
        out.append("  ".join(cells).rstrip())
    out.insert(1, "  ".join("-" * w for w in widths))
    return "\n".join(out)


def markdown(header: list[str], rows: list[list[str]]) -> str:
    numbers = [bool(rows) and all(_numeric(row[i]) for row in rows) for i in range(len(header))]
    lines = ["| " + " | ".join(header) + " |", "|" + "|".join("--:" if n else "---" for n in numbers) + "|"]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def _numeric(cell: str) -> bool:
    try:
        float(cell.rstrip("%"))
    except ValueError:
        return cell in ("-", "never")
    return True


def loop_header(units: dict[str, tuple[str, str]]) -> list[str]:
    """Units are in the cells' heading where all loops agree; they are told per loop otherwise."""
    ys = {y for y, _ in units.values()}
    iae = f"IAE [{ys.pop()} s]" if len(ys) == 1 else "IAE"
    return ["loop", "window", iae, "overshoot [%]", "settling [s]", "total variation", "largest error"]


def loop_rows(windows: list[Window], units: dict[str, tuple[str, str]], overall: bool = False) -> list[list[str]]:
    rows = []
    for w in windows:
        if overall and w.kind != "overall":
            continue
        over, settled = w.overshoot_percent, w.settling_s
        if w.kind == "overall":
            steps = [x for x in windows if x.loop == w.loop and x.kind == "setpoint"]
            over, settled = _worst([x.overshoot_percent for x in steps]), _worst([x.settling_s for x in steps])
        what = "whole run" if w.kind == "overall" else f"{w.from_s:g} s: {w.what}"
        unit = units.get(w.loop, ("", ""))[1]
        rows.append([w.loop, what, figure(w.iae), figure(over), figure(settled),
                     f"{figure(w.tv)} {unit}".strip(), figure(w.max_error)])
    return rows


def _worst(values: list[float | None]) -> float | None:
    """NaN (never settled) is worse than anything."""
    known = [v for v in values if v is not None]
    if any(math.isnan(v) for v in known):
        return math.nan
    return max(known, default=None)
