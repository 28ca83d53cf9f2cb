#!/usr/bin/python3
"""Bias and scatter of difference models against noise of the measurements, by method: the table of
docs/difference-models.md, on the column of Kotyk and Machacek (1995). Noise, amplitude and lengths are ours.

    cmake --preset host && cmake --build --preset host --target libreflux
    tools/figures/arx_bias.py [--seeds N]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux_tools import identification, libreflux, table  # noqa: E402

A = np.array([[-0.80338, 0.02616], [-1.06726, 0.14709]])
B = np.array([[[0.03851, -0.00386], [-0.01062, -0.00192]], [[0.01262, 0.00316], [-0.01990, 0.00157]]])
GAIN = B.sum(axis=2) / (1 + A.sum(axis=1))[:, None]
NOISE = (0.002, 0.005, 0.01, 0.02)
LENGTHS = (511, 1022, 4088)  # 1, 2, 8 periods of nine bits
NAMES = ("least squares", "instruments", "extended")
MOST_EXTENDED = 1022  # samples: many passes over longer ones take minutes


def outputs(u: np.ndarray) -> np.ndarray:
    y = np.zeros((len(u), 2))
    for k in range(2, len(u)):
        for i in range(2):
            y[k, i] = -A[i] @ y[[k - 1, k - 2], i] + sum(B[i, j] @ u[[k - 1, k - 2], j] for j in range(2))
    return y


def errors(method: str, length: int, noise: float, seeds: int) -> tuple[np.ndarray, np.ndarray, int]:
    """Of every seed: the first coefficient of A2 less its own, the larger relative error of the gains of y2; how many were refused."""
    u = identification.prbs(2, length, 1.0, bits=9)[0]
    y, orders = outputs(u), identification.Orders(2, ((1, 2), (1, 2)), 2 if method == "els" else 0)
    of_a, of_gain, refused = [], [], 0
    for seed in range(seeds):
        record = identification.Record(u, y + noise * np.random.default_rng(seed).standard_normal(y.shape))
        try:
            model = identification.fit(record, 1, orders, method)
        except libreflux.Refused:
            refused += 1
            continue
        of_a.append(model.a()[0] - A[1, 0])
        gain = np.array([sum(row) for row in model.b()]) / (1 + sum(model.a()))
        of_gain.append((gain / GAIN[1] - 1)[np.argmax(abs(gain / GAIN[1] - 1))])
    return np.array(of_a), np.array(of_gain), refused


def main() -> None:
    p = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    p.add_argument("--seeds", type=int, default=10)
    p.add_argument("--library", type=Path)
    options = p.parse_args()
    libreflux.load(options.library)
    rows = []
    for length in LENGTHS:
        for noise in NOISE:
            row = [str(length), f"{noise:g}"]
            for method in identification.METHODS:
                if method == "els" and length > MOST_EXTENDED:
                    row += ["-", "-"]
                    continue
                a, gain, refused = errors(method, length, noise, options.seeds)
                row += [f"{a.mean():+.3f} ± {a.std():.3f}" + (f" ({refused} refused)" if refused else ""), f"{100 * np.sqrt(np.mean(gain**2)):.1f}"]
            rows.append(row)
            print(f"{length} samples, noise {noise:g}", file=sys.stderr)
    print(table.markdown(["samples", "noise, V", *(word for name in NAMES for word in (f"{name}: first of A2", "gains, %"))], rows))


if __name__ == "__main__":
    main()
