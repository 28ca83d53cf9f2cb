#!/usr/bin/python3
"""References for firmware/num (linear algebra) and firmware/interact, by numpy and scipy.

Matrices are not written down but drawn on both sides from the same bits: Random is tests/support/random_source.h, and
matrix() is tests/support/random_matrix.h, line by line. Writes

  algebra.csv      seed, rows, cols, kind, sign and log of the determinant (0, 0 where there is none), 16 singular
                   values (0 past the last)
  pairing.csv      seed, n, input of outputs 1 to 5 (-1: none), how many cheaper pairings have a subset of loops whose
                   Niederlinski index is not positive; by trying every permutation and every subset
  assignment.csv   seed, rows, cols, total cost of the best assignment (-1: needs a forbidden element)

The plants: interact_plants.py.

usage: tests/reference/interact_reference.py
"""
import itertools
from pathlib import Path

import numpy as np
import scipy.optimize

HERE = Path(__file__).resolve().parent
MASK = (1 << 64) - 1
KINDS = 4


class Random:
    def __init__(self, seed):
        self.state = seed

    def next(self):
        self.state = (self.state + 0x9E3779B97F4A7C15) & MASK
        z = self.state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
        return z ^ (z >> 31)

    def below(self, n):
        return self.next() % n

    def fraction(self):
        """-1 to 1 in steps of 2^-23."""
        return (self.next() >> 40) / 2.0**23 - 1.0


def matrix(seed):
    """kind 0: uniform; 1: columns from 1 down to 2^-15; 2: rank deficient, of small whole numbers; 3: rows likewise
    from 1 up to 2^15. All elements are exact in float."""
    r = Random(seed)
    rows, cols, kind = 1 + r.below(16), 1 + r.below(16), r.below(KINDS)
    if kind == 2:
        rank = r.below(min(rows, cols) + 1)
        b = np.array([[float(r.below(9)) - 4.0 for _ in range(rank)] for _ in range(rows)]).reshape(rows, rank)
        c = np.array([[float(r.below(9)) - 4.0 for _ in range(cols)] for _ in range(rank)]).reshape(rank, cols)
        return kind, b @ c
    a = np.array([[r.fraction() for _ in range(cols)] for _ in range(rows)])
    if kind == 1:
        a = a * 2.0 ** -np.arange(cols)
    if kind == 3:
        a = (a.T * 2.0 ** np.arange(rows)).T
    return kind, a


def algebra():
    for seed in range(1, 301):
        kind, a = matrix(seed)
        sign = log = 0.0
        if a.shape[0] == a.shape[1] and kind != 2:
            sign, log = np.linalg.slogdet(a)
        s = np.zeros(16)
        s[:min(a.shape)] = np.linalg.svd(a, compute_uv=False)
        if kind == 2:
            s[s < 1e-11 * max(s[0], 1.0)] = 0.0
        yield ",".join([str(seed), str(a.shape[0]), str(a.shape[1]), str(kind), f"{sign:.0f}", f"{log:.17g}",
                        *(f"{x:.17g}" for x in s)])


def costs(seed):
    """Sizes to 16 x 16; every third matrix has forbidden elements, every fourth few different costs (ties)."""
    r = Random(seed)
    rows, cols = 1 + r.below(16), 1 + r.below(16)
    limit = 5 if seed % 4 == 0 else 1000001
    c = np.array([[r.below(limit) for _ in range(cols)] for _ in range(rows)], float)
    if seed % 3 == 0:
        for i in range(rows):
            for j in range(cols):
                if r.below(2) == 0:
                    c[i, j] = np.inf
    return c


def assignments():
    for seed in range(1, 1001):
        c = costs(seed)
        try:
            i, j = scipy.optimize.linear_sum_assignment(c)
            best = int(c[i, j].sum())
        except ValueError:  # infeasible
            best = -1
        yield f"{seed},{c.shape[0]},{c.shape[1]},{best}"


def square(seed):
    """n x n, 2 to 5, as random_square() of tests/unit/test_pairing.c."""
    r = Random(seed)
    n = 2 + r.below(4)
    return np.array([[r.fraction() for _ in range(n)] for _ in range(n)])


def negative_subset(g):
    """Is there a subset of the loops on the diagonal whose Niederlinski index is not positive?"""
    n, own = len(g), np.diag(g)
    subsets = itertools.chain.from_iterable(itertools.combinations(range(n), k) for k in range(1, n + 1))
    return any(np.linalg.det(g[np.ix_(s, s)]) / np.prod(own[list(s)]) <= 0.0 for s in subsets)


def pairings():
    for seed in range(1, 501):
        g = square(seed)
        n = len(g)
        lam = g * np.linalg.inv(g).T
        found, rejected = [-1] * n, 0
        cost = lambda p: sum(np.floor(np.abs(np.log(lam[i, p[i]])) * 1e4 + 0.5) for i in range(n))
        allowed = [p for p in itertools.permutations(range(n)) if all(lam[i, p[i]] >= 0.02 for i in range(n))]
        for p in sorted(allowed, key=cost)[:16]:
            if not negative_subset(g[:, p]):
                found = list(p)
                break
            rejected += 1
        yield ",".join(map(str, [seed, n, *found, *[-1] * (5 - n), rejected]))


def table(name, header, rows, remark, maker="interact_reference"):
    with open(HERE / name, "w") as f:
        f.write(f"# {remark}\n# made by tests/reference/{maker}.py\n{header}\n")
        f.writelines(row + "\n" for row in rows)


def main():
    table("algebra.csv", "seed,rows,cols,kind,sign,log_det," + ",".join(f"s{k}" for k in range(1, 17)), algebra(),
          "Determinants and singular values of matrices drawn from the seeds, by numpy")
    table("pairing.csv", "seed,n,p1,p2,p3,p4,p5,rejected", pairings(),
          "Best pairings of random square gain matrices, by trying every one")
    table("assignment.csv", "seed,rows,cols,total", assignments(),
          "Best assignments by scipy.optimize.linear_sum_assignment")


if __name__ == "__main__":
    main()
