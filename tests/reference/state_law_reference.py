"""References for the kind `state_law` (firmware/kinds/state_law/state_law.h) on the pilot column: its matrices, and the laws of two sets of inputs.

    python3 tests/reference/state_law_reference.py > tests/reference/state_law.csv

Matrices are those of `reflux-sim --linearise`, differences in long double; the law is written out here in numpy, not the firmware's: F = B*^-1 (M0 C - C A), G = B*^-1 (1 - M0) of
the sampled model (scipy's matrix exponential), as near to F as the inputs let it by least squares, Tf = -B*^-1 C E. Inputs and outputs in fractions of span, states mole fractions, per
second. A line: what, row, values.
"""

import sys
from pathlib import Path

import numpy as np
from scipy.linalg import expm

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from reflux import simulator  # noqa: E402
from reflux.cmd_state_feedback import spans_of  # noqa: E402

PERIOD, TAU = 30.0, 100.0 / 3
OUTPUTS, MOVED = ["T1", "T10"], ["Lr", "Qrb"]
STATES = [*OUTPUTS, "xD", "T2", "xB", "T3", "T4", "T8"]
KNOWN = ["F", "xF"]


def main():
    data, span = simulator.linearised("pilot"), spans_of("pilot")
    n, names = len(data["x"]), data["inputs"]
    a = np.array(data["A"], float).reshape(n, n)
    b = np.array(data["B"], float).reshape(n, len(names))
    c = np.array(data["C"], float).reshape(-1, n)

    def by(inputs):
        return np.column_stack([b[:, names.index(u)] * span[u] for u in inputs])

    def seen(outputs):
        return np.array([c[data["outputs"].index(y)] / span[y] for y in outputs])

    def put(what, rows):
        for i, row in enumerate(np.atleast_2d(rows)):
            print(f"{what},{i}," + ",".join(f"{v:.12g}" for v in row))

    def law(states, known):
        bu, e, z, k = by(MOVED), by(known) if known else np.zeros((n, 0)), seen(states), seen(OUTPUTS)
        whole = np.zeros((n + bu.shape[1] + e.shape[1],) * 2)
        whole[:n] = np.hstack([a, bu, e])
        sampled = expm(whole * PERIOD)[:n]
        ad, bd, ed = sampled[:, :n], sampled[:, n:n + 2], sampled[:, n + 2:]
        pole = np.exp(-PERIOD / TAU)
        inverse = np.linalg.inv(k @ bd)
        f, g, tf = inverse @ (pole * k - k @ ad), inverse * (1 - pole), -inverse @ (k @ ed)
        scale = np.abs(z).max(axis=1, keepdims=True)
        weights = np.linalg.lstsq((z / scale).T, f.T, rcond=None)[0].T / scale.T
        radius = np.abs(np.linalg.eigvals(ad + bd @ (weights @ z))).max()
        left = 100 * np.abs(f - weights @ z).max() / np.abs(f).max()
        return np.hstack([weights, tf]), g, left, radius

    print("# by state_law_reference.py")
    print("what,row,values")
    put("a", a)
    put("b", by(MOVED))
    put("e", by(KNOWN))
    put("seen", seen(STATES))
    for what, states, known in (("temperatures", STATES, []), ("feed", STATES[:6], KNOWN)):
        f, g, left, radius = law(states, known)
        put(f"f_{what}", f)
        put(f"g_{what}", g)
        put(f"left_{what}", [[left, radius]])


if __name__ == "__main__":
    main()
