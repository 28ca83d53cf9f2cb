"""What callers of reflux hand over: numbers, tables of them, lines for the console. Anything else is refused in words."""

from __future__ import annotations

import math
import numbers
from typing import Any

import numpy as np

from reflux.errors import UserError


def number(value: Any, what: str) -> float:
    """A number of Python or numpy, also one that is not finite: the board refuses that in its own words. True and False are none."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise UserError(f"{what} must be a number, not {shown(value)}")
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def finite(value: Any, what: str, least: float = -math.inf) -> float:
    x = number(value, what)
    if not (math.isfinite(x) and x >= least):
        raise UserError(f"{what} must be a number{'' if least == -math.inf else f' from {least:g}'}, not {shown(value)}")
    return x


def whole(value: Any, what: str, most: int) -> int:
    """From 1. 2.0 is no whole number here, because 2.5 would be none either."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral) or not 1 <= value <= most:
        raise UserError(f"{what} must be a whole number from 1 to {most}, not {shown(value)}")
    return int(value)


def table(value: Any, what: str) -> np.ndarray:
    """Numbers in any shape."""
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = np.array(None)
    if array.dtype.kind not in "fiu":
        raise UserError(f"{what} must be numbers, in rows of one length, not {shown(value)}")
    return array.astype(float)


def line(text: Any) -> str:
    """One line that the console takes: printable ASCII. A newline or a control character would end or edit the line, and a second command
    could follow it."""
    if not isinstance(text, str):
        raise UserError(f"a command is a text, not {shown(text)}")
    if "\n" in text or "\r" in text:
        raise UserError(f"a command is one line, not {shown(text)}")
    wrong = next((c for c in text if not " " <= c <= "~"), None)
    if wrong is not None:
        raise UserError(f"the console takes printable ASCII only, not {wrong!a} in {text!a}")
    return text


def shown(value: Any) -> str:
    text = ascii(value)
    return text if len(text) <= 60 else f"{text[:60]} ..."
