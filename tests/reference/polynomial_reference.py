#!/usr/bin/python3
"""References for firmware/num/polynomial.h: polynomial_roots.csv, polynomials and their zeros.

Zeros are those of numpy, polished by Newton's iteration in whole numbers of 240 bits behind the point, or those that the polynomial
was made of. Coefficients are exact in float. A row: kind, degree, 32 coefficients from x^0 on, 31 pairs of real and imaginary part.
Kinds: 0 uniform coefficients, 1 coefficients over many magnitudes, 2 made of zeros that are multiples of 1/4, some of them several
times, 3 small leading coefficient: a zero far outside.

usage: tests/reference/polynomial_reference.py
"""
from fractions import Fraction
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
ONE = 1 << 240


def polished(c, z):
    """One zero of the polynomial with Fractions c, near z."""
    re, im = Fraction(z.real), Fraction(z.imag)
    for _ in range(6):
        p = q = (Fraction(0), Fraction(0))
        for k in reversed(c):
            q = (q[0] * re - q[1] * im + p[0], q[0] * im + q[1] * re + p[1])
            p = (p[0] * re - p[1] * im + k, p[0] * im + p[1] * re)
        size = q[0] ** 2 + q[1] ** 2
        re -= (p[0] * q[0] + p[1] * q[1]) / size
        im -= (p[1] * q[0] - p[0] * q[1]) / size
        re, im = (Fraction(round(x * ONE), ONE) for x in (re, im))
    return complex(float(re), float(im))


def rows():
    rng = np.random.default_rng(17)
    for kind in (0, 1, 3):
        for degree in (1, 2, 3, 4, 6, 9, 13, 20, 31):
            for _ in range(4):
                c = rng.integers(-(1 << 22), 1 << 22, degree + 1) / float(1 << 22)
                if kind == 1:
                    c *= 2.0 ** rng.integers(-8, 9, degree + 1)
                c[0] = c[0] or 0.5
                c[-1] = (c[-1] or 0.5) * (2.0**-20 if kind == 3 else 1.0)
                exact = [Fraction(float(x)) for x in c]
                yield kind, c, [polished(exact, z) for z in np.roots(c[::-1])]
    for _ in range(40):
        zeros = rng.integers(-6, 7, int(rng.integers(1, 6))) / 4.0
        if rng.integers(2):
            zeros[-1] = zeros[0]
        yield 2, np.poly(zeros)[::-1], [complex(z) for z in zeros]


def main():
    with open(HERE / "polynomial_roots.csv", "w") as f:
        f.write("# tests/reference/polynomial_reference.py\nkind,degree,c,re,im\n")
        for kind, c, zeros in rows():
            values = [float(kind), float(len(c) - 1)] + list(c) + [0.0] * (32 - len(c))
            for k in range(31):
                z = zeros[k] if k < len(zeros) else 0j
                values += [z.real, z.imag]
            f.write(",".join(f"{x:.17g}" for x in values) + "\n")


if __name__ == "__main__":
    main()
