#!/usr/bin/python3
"""References for firmware/design/state_decoupler.h and firmware/lti/state_model.h: state_decoupler.csv.

Plants are made of chains of integrators and of zeros of their own, turned by unimodular whole-number matrices, so that all elements, and
the zeros in C A^k B, are exact in float. Independent of the firmware's ways: zeros from the generalised eigenvalues of
[A B; C 0] - s [I 0; 0 0], F and G checked by the eigenvalues of A + B F (poles and zeros, nothing else) and by the gain at rest,
sampling by scipy's matrix exponential of the model with inputs as states.

A row, 2 outputs, up to 6 states, 2 disturbances, matrices padded to 6: n, h, A, B, C, E, poles (2 x 3), indices, F, G, Tf by states, Tf by
outputs, number of zeros, zeros (re, im; 6), radius with F and G computed every h, A and B and E sampled at h.

usage: tests/reference/state_decoupler_reference.py
"""
from pathlib import Path

import numpy as np
import scipy.linalg

HERE = Path(__file__).resolve().parent
N, M, ND = 6, 2, 2


def dyadic(rng, low, high, shape=None):
    return rng.integers(low * 16, high * 16 + 1, shape) / 16.0


def plant(rng, n, index):
    a, b, c = np.zeros((n, n)), np.zeros((n, M)), np.zeros((M, n))
    b_star = dyadic(rng, -2, 2, (M, M)) + 3 * np.eye(M)
    at, rest = 0, sum(index) + M
    for i, d in enumerate(index):
        c[i, at] = 1.0
        for k in range(d):
            a[at + k, at + k + 1] = 1.0
        a[at + d] = dyadic(rng, -1, 1, n)
        b[at + d] = b_star[i]
        at += d + 1
    hidden = n - rest
    if hidden:
        q = np.triu(dyadic(rng, -1, 1, (hidden, hidden)), 1) - np.diag(rng.choice([1.5, 2.0, 2.5, 3.0], hidden, replace=False))
        if hidden >= 2:  # a complex pair
            q[:2, :2] = [[-1.0, 1.5], [-1.5, -1.0]]
        a[rest:, rest:] = q
        a[rest:, [0, index[0] + 1]] = dyadic(rng, -1, 1, (hidden, M))
    t, back = np.eye(n), np.eye(n)
    for _ in range(n):
        i, j = rng.choice(n, 2, replace=False)
        s = rng.choice([-1.0, 1.0])
        step, undo = np.eye(n), np.eye(n)
        step[i, j], undo[i, j] = s, -s
        t, back = step @ t, back @ undo
    assert np.array_equal(t @ back, np.eye(n))
    return t @ a @ back, t @ b, c @ back, dyadic(rng, -1, 1, (n, ND))


def zeros_of(a, b, c):
    n = len(a)
    left = np.block([[a, b], [c, np.zeros((M, M))]])
    right = np.zeros_like(left)
    right[:n, :n] = np.eye(n)
    alpha, beta = scipy.linalg.eigvals(left, right, homogeneous_eigvals=True)
    finite = np.abs(beta) > 1e-5 * np.abs(alpha)
    return alpha[finite] / beta[finite]


def sampled(a, be, h):
    n, m = be.shape
    both = np.zeros((n + m, n + m))
    both[:n, :n], both[:n, n:] = a, be
    e = scipy.linalg.expm(both * h)
    return e[:n, :n], e[:n, n:]


def close(found, wanted, bound):
    """Each of one list has a partner of its own in the other."""
    rest = list(wanted)
    for z in found:
        k = int(np.argmin([abs(z - w) for w in rest]))
        assert abs(z - rest.pop(k)) < bound, (found, wanted)


def case(rng, n, index):
    a, b, c, e = plant(rng, n, index)
    poles = -dyadic(rng, 1, 4, (M, 3))
    rows = [[c[i] @ np.linalg.matrix_power(a, k) for k in range(d + 2)] for i, d in enumerate(index)]
    b_star = np.array([rows[i][d] @ b for i, d in enumerate(index)])
    a_star = np.array([rows[i][d + 1] for i, d in enumerate(index)])
    m = [-np.poly(poles[i, : d + 1])[::-1][:-1] for i, d in enumerate(index)]
    asked = np.array([sum(m[i][k] * rows[i][k] for k in range(d + 1)) for i, d in enumerate(index)])
    f = np.linalg.solve(b_star, asked - a_star)
    g = np.linalg.solve(b_star, np.diag([-m[i][0] for i in range(M)]))
    assert np.allclose(c @ np.linalg.solve(-(a + b @ f), b @ g), np.eye(M), atol=1e-9)
    found = zeros_of(a, b, c)
    hidden = n - sum(index) - M
    assert len(found) == hidden, (len(found), hidden)
    every = np.concatenate([*(poles[i, : d + 1] for i, d in enumerate(index)), found])
    close(np.linalg.eigvals(a + b @ f), every, 1e-2)  # several of one value: a root of rounding
    tf = -np.linalg.lstsq(b, e, rcond=None)[0]
    tf_out = -np.linalg.solve(b_star, np.array([rows[i][d] @ e for i, d in enumerate(index)]))
    h = float(rng.choice([0.0625, 0.125, 0.25]))
    ad, bed = sampled(a, np.hstack([b, e]), h)
    radius = np.abs(np.linalg.eigvals(ad + bed[:, :M] @ f)).max()
    wide = np.zeros((N, N))
    parts = [[n, h]]
    for x, shape in ((a, (N, N)), (b, (N, M)), (c, (M, N)), (e, (N, ND)), (poles, (M, 3))):
        wide = np.zeros(shape)
        wide[: x.shape[0], : x.shape[1]] = x
        assert np.array_equal(wide.astype(np.float32).astype(float), wide)
        parts.append(wide.ravel())
    parts.append(index)
    pairs = np.zeros((N, 2))
    pairs[:hidden, 0], pairs[:hidden, 1] = found.real, found.imag
    for x, shape in ((f, (M, N)), (g, (M, M)), (tf, (M, ND)), (tf_out, (M, ND))):
        wide = np.zeros(shape)
        wide[: x.shape[0], : x.shape[1]] = x
        parts.append(wide.ravel())
    parts += [[hidden], pairs.ravel(), [radius]]
    for x, shape in ((ad, (N, N)), (bed[:, :M], (N, M)), (bed[:, M:], (N, ND))):
        wide = np.zeros(shape)
        wide[: x.shape[0], : x.shape[1]] = x
        parts.append(wide.ravel())
    return np.concatenate([np.asarray(p, float) for p in parts])


def main():
    rng = np.random.default_rng(18)
    sizes = [(2, (0, 0)), (3, (0, 0)), (4, (0, 0)), (6, (0, 0)), (3, (1, 0)), (4, (0, 1)), (5, (1, 0)), (4, (1, 1)), (6, (1, 1)),
             (5, (2, 0)), (6, (2, 1)), (6, (0, 2))]
    with open(HERE / "state_decoupler.csv", "w", encoding="utf-8") as f:
        f.write("# tests/reference/state_decoupler_reference.py\n"
                "n,h,a,b,c,e,poles,index,f,g,tf,tf_out,hidden,zeros,radius,ad,bd,ed\n")
        for n, index in sizes * 3:
            f.write(",".join(f"{x:.17g}" for x in case(rng, n, index)) + "\n")


main()
