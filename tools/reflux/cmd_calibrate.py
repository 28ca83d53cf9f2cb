"""tools/calibrate: gain and zero of a measurement from one or two points, as console lines."""

from __future__ import annotations

import argparse
import math
import re

from reflux.errors import UserError
from reflux.paths import tool


def point(text: str) -> tuple[float, float]:
    """READING=TRUE: what the board shows, and what is true."""
    try:
        reading, true = (float(part) for part in text.split("="))
    except ValueError:
        raise UserError(f'"{text}": a point is READING=TRUE, two numbers as in 98.9=100') from None
    if not (math.isfinite(reading) and math.isfinite(true)):
        raise UserError(f'"{text}": both numbers of a point must be finite')
    return reading, true


def correction(points: list[tuple[float, float]]) -> tuple[float, float]:
    """Gain and zero that make the true values of the readings."""
    (first, true_first), (last, true_last) = points[0], points[-1]
    if len(points) == 1:
        return 1.0, true_first - first
    if first == last:
        raise UserError("the two points have the same reading; take them far apart, near both ends of the range in use")
    gain = (true_last - true_first) / (last - first)
    if gain <= 0.0:
        raise UserError("the true value falls while the reading rises; look for a swapped point or crossed wires")
    return gain, true_first - gain * first


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(prog=tool("calibrate"), description="Prints the console lines that calibrate a measurement.")
    p.add_argument("measurement", metavar="meas<i>", help="the measurement's name in the board's parameters")
    p.add_argument("points", nargs="+", metavar="READING=TRUE",
                   help="value the board shows, and the true value: two points, or one for the zero alone")
    p.add_argument("--gain", type=float, default=1.0, help="calibration in force while the readings were taken (default: 1)")
    p.add_argument("--zero", type=float, default=0.0, help="zero in force while the readings were taken (default: 0)")
    options = p.parse_args(arguments)
    if not re.fullmatch(r"meas[1-9]\d?", options.measurement):
        raise UserError(f'"{options.measurement}": the measurement is called meas1, meas2 and so on; `list all` at the console shows them')
    if len(options.points) > 2:
        raise UserError("one or two points, not more")
    gain, zero = correction([point(text) for text in options.points])
    zero += gain * options.zero
    gain *= options.gain
    if not (1e-6 <= gain <= 1e6 and abs(zero) <= 1e9):
        raise UserError(f"gain {gain:g}, zero {zero:g}: the board takes gains from 1e-06 to 1e+06 and zeros up to 1e+09")
    print("begin")
    print(f"set {options.measurement}.gain {gain:.7g}")
    print(f"set {options.measurement}.zero {zero:.7g}")
    print("apply")
    return 0
