#!/usr/bin/python3
"""A day of the splitter by scipy's BDF beside the same day by the simulated plant, in one run on one machine.

    tests/bench/splitter_scipy.py PLANT_COST [MINUTES]

PLANT_COST is the built program of tests/bench/plant_cost.c, which says what the inputs are and when they change (every
MINUTES) and what temperatures and time the plant came to. scipy gets the right-hand side of
tests/reference/splitter_reference.py, independent of the C sources, starts afresh at every change, and makes its
Jacobian by differences, as it does when nobody writes one.
"""
import os
import subprocess
import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "reference"))
import splitter_reference as reference  # noqa: E402

RELATIVE, ABSOLUTE = 3e-6, 3e-8  # the plant's own


def spoken(program, minutes):
    """[(time, drive)], {time: temperatures}, seconds of the C program."""
    changes, temperatures, seconds = [], {}, 0.0
    done = subprocess.run([program, "--day", minutes], capture_output=True, text=True, check=True)
    for line in done.stdout.splitlines():
        word, *rest = line.split()
        numbers = [float(v) for v in rest]
        if word == "inputs":
            flow, warmth, c2, c3, ic4, nc4 = numbers[1:]
            z = np.array([c2, c3, ic4, reference.FEED[3], reference.FEED[4], nc4])
            changes.append((numbers[0], reference.drive(dict(reference.NOMINAL, F=flow, TF=warmth, z=z / z.sum()))))
        elif word == "temperatures":
            order = np.argsort(numbers[1::2])
            temperatures[numbers[0]] = np.array(numbers[2::2])[order]
        elif word == "seconds":
            seconds = numbers[0]
    return changes, temperatures, seconds


def main():
    program, minutes = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "15"
    changes, temperatures, ours = spoken(program, minutes)
    x = reference.steady(reference.NOMINAL, reference.start())
    worst, evaluations = 0.0, 0
    ends = [t for t, _ in changes[1:]] + [86400.0]
    began = time.process_time()
    for (t, u), end in zip(changes, ends):
        run = solve_ivp(lambda _, y: reference.COLUMN.evaluate(y, u)[0], (t, end), x, method="BDF", rtol=RELATIVE,
                        atol=ABSOLUTE)
        assert run.success, run.message
        x, evaluations = run.y[:, -1], evaluations + run.nfev
        worst = max(worst, np.max(np.abs(reference.COLUMN.evaluate(x, u)[1] - temperatures[end])))
    theirs = time.process_time() - began
    print(f"changes {len(changes)} plant_s {ours:.3f} scipy_s {theirs:.1f} ratio {theirs / ours:.0f} "
          f"relative {RELATIVE:g} absolute {ABSOLUTE:g} evaluations {evaluations} worst_K {worst:.2g}")


if __name__ == "__main__":
    main()
