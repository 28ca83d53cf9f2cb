#!/usr/bin/python3
"""References for firmware/num/ceigen and firmware/interact/ina, by numpy. Writes

  ceigen.csv   seed, n, then for each of n eigenvalues re, im and its condition number 1/|y' x|, x and y its right and left
               vectors of unit length. The matrix is drawn on both sides: complex_matrix() is that of tests/unit/test_ceigen.c.
  ina.csv      plant (0: Kotyk and Machacek in z; others: number in interact_plants.csv, in s), compensator (0: 1; 1: that of the
               source; 2: drawn), omega, condition number of F G, then re and im of F and of (F G)^-1, row by row

Rows are filled with zeros to the length of the longest.

usage: tests/reference/ina_reference.py
"""
import csv
from pathlib import Path

import numpy as np
from interact_reference import Random

HERE = Path(__file__).resolve().parent
WOOD_BERRY, LUYBEN_4X4 = 12, 7  # PLANT_ of tests/support/interact_plants.h
A = np.array([[-0.80338, 0.02616], [-1.06726, 0.14709]])
B = np.array([[[0.03851, -0.00386], [-0.01062, -0.00192]], [[0.01262, 0.00316], [-0.01990, 0.00157]]])
PERIOD = 120.0
SOURCE = np.array([[1.0, 0.33], [0.64, 1.2112]])
OMEGA_H = (0.001, 0.05, 0.4, 1.3, 2.6, 3.1415926)
OMEGA_S = (0.0, 1e-4, 1e-3, 5e-3, 0.02)


def complex_matrix(seed):
    """Every third with rows from 1 up to 2^n, every fourth Hermitian but for rounding."""
    r = Random(seed)
    n = 1 + r.below(16)
    a = np.array([[complex(r.fraction(), r.fraction()) for _ in range(n)] for _ in range(n)])
    if seed % 3 == 0:
        a = (a.T * 2.0 ** np.arange(n)).T
    if seed % 4 == 0:
        a = 0.5 * (a + a.conj().T)
    return a


def eigenvalues():
    for seed in range(1, 201):
        a = complex_matrix(seed)
        values, right = np.linalg.eig(a)
        left = np.linalg.inv(right)  # rows, left[i] right[:, i] = 1
        condition = np.linalg.norm(left, axis=1) * np.linalg.norm(right, axis=0)
        yield ",".join([str(seed), str(len(a)), *(f"{v.real:.17g},{v.imag:.17g},{c:.6g}" for v, c in zip(values, condition))])


def drawn(n):
    r = Random(n)
    return np.eye(n) + 0.25 * np.array([[r.fraction() for _ in range(n)] for _ in range(n)])


def plants():
    """number: gains, dead times, time constants"""
    found = {}
    with open(HERE / "interact_plants.csv", encoding="utf-8") as f:
        for row in csv.reader(line for line in f if line[0].isdigit()):
            number, what, i, j = map(int, row[:4])
            if number in (WOOD_BERRY, LUYBEN_4X4) and what == 0:
                found[number] = np.zeros((3, i, j))
            elif number in found and what in (1, 2, 3):
                found[number][what - 1, i, j] = float(row[4])
    return found


def row(plant, compensator, omega, f, g):
    h = f @ g
    numbers = [*f.ravel(), *np.linalg.inv(h).ravel()]
    return ",".join([str(plant), str(compensator), f"{omega:.17g}", f"{np.linalg.cond(h):.6g}",
                     *(f"{z.real:.17g},{z.imag:.17g}" for z in numbers)])


def arrays():
    for x in OMEGA_H:
        z = np.exp(-1j * x)
        f = (B @ [z, z**2]) / (1.0 + A @ [z, z**2])[:, None]
        for k, g in enumerate((np.eye(2), SOURCE, drawn(2))):
            yield row(0, k, x / PERIOD, f, g)
    for number, (gain, dead, lag) in sorted(plants().items()):
        for w in OMEGA_S:
            f = gain * np.exp(-1j * w * dead) / (1.0 + 1j * w * lag)
            for k in (0, 2):
                yield row(number, k, w, f, np.eye(len(f)) if k == 0 else drawn(len(f)))


def main():
    for name, numbers, rows in (("ceigen", 50, eigenvalues()), ("ina", 68, arrays())):
        filled = (r + ",0" * (numbers - 1 - r.count(",")) for r in rows)
        text = "\n".join(["# made by tests/reference/ina_reference.py", *filled, ""])
        (HERE / f"{name}.csv").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
