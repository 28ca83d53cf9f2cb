#!/usr/bin/python3
"""Temperatures of platinum thermometers behind a MAX31865, from the equation of IEC 60751 in double, solved by bisection.

  rtd.csv   nominal and reference resistance (ohm), code, temperature (degC)

usage: tests/reference/rtd_reference.py
"""
from pathlib import Path

A, B, C = 3.9083e-3, -5.775e-7, -4.183e-12  # IEC 60751:2008, per degC, degC^2, degC^4
PAIRS = [(100.0, 400.0), (100.0, 430.0), (1000.0, 4000.0), (1000.0, 4300.0)]


def ratio(t: float) -> float:
    """R/R0 at t degC."""
    return 1 + A * t + B * t * t + (C * (t - 100) * t ** 3 if t < 0 else 0.0)


def temperature(wanted: float) -> float:
    lo, hi = -200.0, 850.0  # the ratio rises all over this range
    for _ in range(80):
        middle = (lo + hi) / 2
        if ratio(middle) < wanted:
            lo = middle
        else:
            hi = middle
    return (lo + hi) / 2


def rows():
    for nominal, reference in PAIRS:
        unit = 32768 * nominal / reference
        inside = range(int(ratio(-40.0) * unit), int(ratio(250.0) * unit) + 2)
        wide = range(int(ratio(-199.9) * unit) + 1, int(ratio(849.9) * unit), 211)
        for code in sorted({*inside[::41], inside[-1], *range(int(unit) - 3, int(unit) + 4), *wide}):
            yield nominal, reference, code, temperature(code / unit)


def main() -> None:
    path = Path(__file__).with_name("rtd.csv")
    lines = ["# Temperatures of platinum thermometers by code", "# made by tests/reference/rtd_reference.py", "nominal,reference,code,temperature"]
    lines += [f"{nominal:g},{reference:g},{code},{t:.6f}" for nominal, reference, code, t in rows()]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
