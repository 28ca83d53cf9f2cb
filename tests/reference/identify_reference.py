#!/usr/bin/python3
"""Elements and double-step responses for the tests of firmware/identify, worked out apart from it.

Reads the first-order elements with dead time of host_sim/plants/*.json (inputs only), gives every input a double step of
five times the longest L + T of its column, and simulates each element as a state space with scipy's matrix exponential:
the delayed input changes between samples, so a sample interval is split there. Writes

  identify_elements.csv   plant (number in the order below), output, input, then in samples: L, T; gain in output spans
                          per input span, samples of one half of the double step, samples of the whole record, and the
                          response to a double step of height 1 at six samples: index, value
  identify_sums.csv       weighted moments of such a record straight from their definition, in double: L, T, half,
                          samples, alpha h, and M0, M1, M2 of the output

usage: tests/reference/identify_reference.py
"""
import json
import math
from pathlib import Path

import numpy as np
import scipy.linalg

HERE = Path(__file__).resolve().parent
PLANTS = HERE.parent.parent / "host_sim" / "plants"
NAMES = ("furnace", "air-compressor", "wood-berry", "luyben-vinante", "packed-bed", "lime-kiln", "shell-fractionator")
UNIT = {"s": 1.0, "min": 60.0, "h": 3600.0}


def first_order(element):
    if not element or "cases" in element or "quadratic" in element or "zero" in element or "integrator" in element:
        return False
    return not isinstance(element.get("lags", 0.0), list)


def elements(name):
    """Rows of (output, input, gain in spans, T, L in samples) of one plant."""
    plant = json.loads((PLANTS / f"{name}.json").read_text())
    scale = UNIT[plant["time_unit"]] / plant["tick_s"]
    for i, row in enumerate(plant["elements"]):
        out = plant["outputs"][i]["hi"] - plant["outputs"][i]["lo"]
        for j, u in enumerate(plant["inputs"]):
            if first_order(row[j]):
                gain = row[j]["gain"] * (u["hi"] - u["lo"]) / out
                yield i, j, gain, row[j].get("lags", 0.0) * scale, row[j].get("dead_time", 0.0) * scale


def column_half(rows, j):
    """Half of the double step: 5 times the longest L + T of the column, whole samples."""
    return math.ceil(5 * max(T + L for _, jj, _, T, L in rows if jj == j))


def simulate(gain, T, L, half, samples):
    """x' = (u(t - L) - x)/T with u piecewise constant; y = gain x at every sample. T > 0."""
    edges = [(L, 1.0), (half + L, -1.0), (2 * half + L, 0.0)]
    x, u, t = 0.0, 0.0, 0.0
    y = np.empty(samples)
    for k in range(samples):
        while edges and edges[0][0] <= k:
            at, level = edges.pop(0)
            x, t, u = advance(x, u, T, at - t), at, level
        x, t = advance(x, u, T, k - t), float(k)
        y[k] = gain * x
    return y


def advance(x, u, T, dt):
    """Exact over dt by the exponential of the augmented matrix."""
    e = scipy.linalg.expm(np.array([[-1.0 / T, 1.0 / T], [0.0, 0.0]]) * dt)
    return e[0, 0] * x + e[0, 1] * u


def write_elements():
    lines = ["# made by tests/reference/identify_reference.py",
             "plant,output,input,L,T,gain,half,samples,k1,y1,k2,y2,k3,y3,k4,y4,k5,y5,k6,y6"]
    for number, name in enumerate(NAMES):
        rows = list(elements(name))
        for i, j, gain, T, L in rows:
            half = column_half(rows, j)
            samples = 2 * half + math.ceil(6 * half / 5)
            y = simulate(gain, T, L, half, samples)
            at = [round(f * half + L) for f in (0.05, 0.4, 0.99, 1.1, 1.7, 2.2)]
            values = [number, i, j, repr(L), repr(T), repr(gain), half, samples]
            for k in at:
                values += [k, repr(float(y[k]))]
            lines.append(",".join(str(v) for v in values))
    (HERE / "identify_elements.csv").write_text("\n".join(lines) + "\n")


def write_sums():
    lines = ["# made by tests/reference/identify_reference.py",
             "lag,dead,half,samples,eta,m0,m1,m2"]
    for T, L, half, samples in ((12.0, 4.25, 70, 240), (3.0, 0.0, 15, 60), (1.84, 50.76, 270, 860), (150.0, 30.0, 300, 1900)):
        y = simulate(1.0, T, L, half, samples)
        k = np.arange(samples)
        for eta in (0.5 / 2**n for n in (1, 3, 5, 7)):
            tau = eta * k
            weight = np.exp(-tau)
            sums = [float(np.sum(tau**n * weight * y)) for n in range(3)]
            lines.append(",".join(repr(v) for v in (T, L, half, samples, eta, *sums)))
    (HERE / "identify_sums.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    write_elements()
    write_sums()
