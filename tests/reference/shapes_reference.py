#!/usr/bin/python3
"""References for elements of more than one lag (firmware/interact/plant.h, design/modes.h), by matrix exponentials.

  shapes.csv       gain, dead time, time constant, square, zero, interval, omega; response of the sampled element (real,
                   imaginary) and of the continuous one; standard deviation of the output for held white noise of 1
  shape_loops.csv  plant, times all gains, then the 2 x 2 elements row by row (five numbers each), interval, signed gains,
                   integral times, stable (1, 0), log modulus (dB), loop that is stepped, load (1, 0), duration; integral of
                   |e| and peak |e| of both loops. Cases in which 1 % of the gains decides are left out.

usage: tests/reference/shapes_reference.py
"""
import numpy as np

from shaped_loops import Element, Loops, one_lag as LAG, write

# gain, dead time, time constant, square, zero
ELEMENTS = [
    (2.0, 3.3, 30.0, 0.0, 0.0), (1.5, 7.0, 30.0, 200.0, 0.0), (-1.0, 0.0, 24.0, 144.0, 0.0), (1.0, 2.5, 2.0, 400.0, 0.0),
    (1.0, 2.5, 12.0, 400.0, -6.0), (0.5, 4.0, 40.0, 300.0, -15.0), (0.7, 1.0, 50.0, 400.0, 120.0), (1.2, 5.0, 20.0, 0.0, 8.0),
    (1.0, 0.4, 1000.0, 900.0, 0.0), (3.0, 12.0, 60.0, 899.0, 0.0), (1.0, 2.0, 0.5, 0.06, 0.0), (1.0, 3.0, 0.0, 0.0, 0.0),
    (1.0, 6.0, 4e4, 1e8, 1e4),
]
PLANTS = {
    "two lags": (1.0, [[(1.0, 2.0, 30.0, 125.0, 0.0), LAG(0.4, 5.0, 20.0)], [LAG(0.3, 4.0, 15.0), (-0.8, 3.0, 24.0, 80.0, 0.0)]],
                 [2.0, -2.0], [25.0, 20.0]),
    "damping 0.05": (1.0, [[(1.0, 1.0, 2.0, 400.0, 0.0), LAG(0.1, 5.0, 20.0)], [LAG(0.2, 4.0, 15.0), LAG(1.0, 3.0, 24.0)]],
                     [0.05, 2.0], [25.0, 20.0]),
    "damping 0.3": (2.0, [[(1.0, 1.0, 12.0, 400.0, 0.0), (0.3, 5.0, 8.0, 100.0, 0.0)], [LAG(0.2, 4.0, 15.0), (1.0, 3.0, 10.0, 60.0, 0.0)]],
                    [0.2, 0.7], [10.0, 9.0]),
    "inverse response": (1.0, [[(1.0, 1.0, 20.0, 96.0, -10.0), LAG(0.5, 5.0, 20.0)], [LAG(0.2, 4.0, 15.0), (1.0, 3.0, 24.0, 0.0, -6.0)]],
                         [0.5, 0.8], [15.0, 20.0]),
    "overshoot by a zero": (1.0, [[(1.0, 1.0, 40.0, 300.0, 90.0), LAG(0.5, 5.0, 20.0)], [LAG(-0.2, 4.0, 15.0), (1.0, 3.0, 30.0, 0.0, 25.0)]],
                            [0.4, 0.3], [15.0, 12.0]),
    "slow and fast": (1.0, [[(1.0, 1.0, 204.0, 800.0, 60.0), LAG(0.5, 50.0, 300.0)], [LAG(0.2, 4.0, 15.0), (1.0, 3.0, 110.0, 1000.0, 40.0)]],
                      [1.0, 1.2], [60.0, 40.0]),
}
SHAPES = "gain,dead_s,lag_s,square_s2,zero_s,interval_s,omega,re,im,exact_re,exact_im,noise"
SHAPE_LOOPS = ("plant,times," + ",".join(f"{x}{k}" for k in (11, 12, 21, 22) for x in ("gain", "dead", "lag", "square", "zero")) +
               ",interval_s,gain1,gain2,ti1,ti2,stable,log_modulus_db,loop,load,duration_s,iae1,iae2,peak1,peak2")
TIMES = (0.3, 1.0, 1.7, 3.0, 6.0, 12.0, 30.0)


def noise(e):
    x, total = e.new + e.old, 0.0
    for k in range(2000000):
        y = e.C @ x + (e.direct if k == 0 else 0.0)
        total += y * y
        x = e.A @ x
        if k > 100 and (np.abs(x) * np.abs(e.C)).max() < 1e-9 * np.sqrt(total):
            break
    return np.sqrt(total)


def shapes():
    for number, (gain, dead, lag, square, zero) in enumerate(ELEMENTS):
        h = (1.0, 0.25, 4.0)[number % 3]
        e, still = Element(gain, dead, lag, square, zero, h), Element(1.0, 0.0, lag, square, zero, h)
        for w in np.geomspace(1e-3 / max(lag, h), 0.9 * np.pi / h, 15):
            s = 1j * w
            exact = gain * (zero * s + 1.0) * np.exp(-dead * s) / (square * s * s + lag * s + 1.0)
            sampled = e.response(np.exp(1j * w * h))
            yield gain, dead, lag, square, zero, h, w, sampled.real, sampled.imag, exact.real, exact.imag, noise(still)


def log_modulus(loops, slowest):
    best = -np.inf
    for w in np.geomspace(0.02 / slowest, np.pi / loops.h, 4000):
        det = np.linalg.det(np.eye(loops.n) + loops.plant(w) * loops.controllers(w)[None, :])
        best = max(best, 20.0 * np.log10(abs(1.0 - 1.0 / det)))
    return best


def shape_loops():
    for number, (h, elements, gain, ti) in enumerate(PLANTS.values()):
        for times in TIMES:
            make = lambda x: Loops(elements, h, np.array(gain) * times * x, ti)
            if len({make(x).radius() < 1.0 for x in (0.99, 1.0, 1.01)}) > 1:
                continue
            loops = make(1.0)
            stable, db = loops.radius() < 1.0, 0.0
            if stable:
                db = log_modulus(loops, max(max(ti), max(e[1] + e[2] for row in elements for e in row)))
            step, load, steps = number % 2, number // 2 % 2, 800
            iae, peak = np.zeros(2), np.zeros(2)
            if stable:
                one = np.eye(2)[step] * 0.01
                y = loops.simulate(steps, np.zeros(2) if load else one, one if load else np.zeros(2))
                e = y - (0.0 if load else one)
                iae, peak = h * np.abs(e).sum(axis=0), np.abs(e).max(axis=0)
                if not load:
                    peak[step] = max(e[:, step].max(), 0.0)
            flat = [x for row in elements for e in row for x in e]
            yield [number, times, *flat, h, *(np.array(gain) * times), *ti, stable, db, step, load, h * (steps - 0.5), *iae,
                   *(peak / 0.01)]


def main():
    write(__file__, "shapes.csv", "Responses of sampled and continuous elements of one and two lags", SHAPES, shapes())
    write(__file__, "shape_loops.csv", "Stability and steps of two PI loops on such elements", SHAPE_LOOPS, shape_loops())


if __name__ == "__main__":
    main()
