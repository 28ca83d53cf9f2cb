#!/usr/bin/python3
"""References for firmware/interact/direction, by numpy. Writes

  direction.csv   what (0: a row measured along a direction; 1: a matrix whose rows were), n, then
                  0: floor, measured sum, its deviation, n gains, n deviations, n shares; n means and n x n covariances by Bayes' rule
                     with the inverse of D (not by the formula of the firmware); n x n covariances of the row once its means are known
                  1: n x n gains, deviations and common parts q; |determinant| in deviations, by the gradient of the determinant

Rows are filled with zeros to the length of the longest.

usage: tests/reference/direction_reference.py
"""
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent


def posterior(gains, deviations, shares, measured, error):
    """Mean and covariance of independent normal gains, given the measured sum along the shares."""
    precision = np.diag(1 / deviations**2) + np.outer(shares, shares) / error**2
    covariance = np.linalg.inv(precision)
    return covariance @ (gains / deviations**2 + shares * measured / error**2), covariance


def with_floor(values, deviations, floor):
    return np.hypot(deviations, floor * values)


def row(r):
    n = r.integers(1, 7)
    floor = r.choice((0.0, 0.005))
    gains, deviations = r.normal(size=n), r.uniform(0.003, 0.1, n)
    shares = r.uniform(-1, 1, n)
    shares[r.integers(n)] = r.choice((-1.0, 1.0))
    own = with_floor(gains, deviations, floor)
    measured = shares @ gains + r.normal() * np.sqrt(shares**2 @ own**2)
    sd = 10 ** r.uniform(-3, -0.5)
    mean, covariance = posterior(gains, own, shares, measured, with_floor(measured, sd, floor))
    after = posterior(mean, with_floor(mean, deviations, floor), shares, 0.0, with_floor(shares @ mean, sd, floor))[1]
    return [0, n, floor, measured, sd, *gains, *deviations, *shares, *mean, *covariance.ravel(), *after.ravel()]


def matrix(r):
    n = r.integers(2, 6)
    gains, deviations = r.normal(size=(n, n)), r.uniform(0.003, 0.1, (n, n))
    common = np.zeros((n, n))
    for i in range(n):
        if r.uniform() < 0.3:
            continue
        shares, variance = r.uniform(-1, 1, n), deviations[i]**2
        common[i] = shares * variance / np.sqrt(shares**2 @ variance + 1e-6)
    slope = np.linalg.det(gains) * np.linalg.inv(gains).T
    variance = sum(slope[i] @ (np.diag(deviations[i]**2) - np.outer(common[i], common[i])) @ slope[i] for i in range(n))
    return [1, n, *gains.ravel(), *deviations.ravel(), *common.ravel(), abs(np.linalg.det(gains)) / np.sqrt(variance)]


def main():
    r = np.random.default_rng(1)
    rows = [row(r) for _ in range(60)] + [matrix(r) for _ in range(40)]
    longest = max(map(len, rows))
    text = "\n".join(["# made by tests/reference/direction_reference.py",
                      *(",".join(f"{x:.9g}" for x in [*one, *[0] * (longest - len(one))]) for one in rows), ""])
    (HERE / "direction.csv").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
