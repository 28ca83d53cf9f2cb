#!/usr/bin/python3
"""References for firmware/design on several loops: stability by eigenvalues, log modulus on a fine grid, step responses by
an exact simulation of their own (sampled_loops.py), of the reduced plants of interact_plants.py.

  nyquist.csv   plant, interval (s), factor on all gains, gains of four loops (signed; 0: no such loop), integral times,
                stable (1, 0), largest log modulus (dB; 0 where unstable). Cases in which 1 % of the gains decides are
                left out.
  trial.csv     plant, interval, loop, load (1, 0), duration, gains, integral times as above; then for each of the four
                loops integral of |e|, peak, settled, moved, as firmware/design/trial.h defines them

usage: tests/reference/loops_reference.py
"""
import numpy as np

from interact_plants import figures
from interact_reference import table
from sampled_loops import Loop, fopdt_parts

TIMES = (0.2, 1.0, 2.0, 4.0, 8.0, 20.0)


def simc(g, L, T, pairs, h, factor=2.0):
    gain, ti = [], []
    for a, b in pairs:
        theta, tau = L[a, b] + h / 2, max(T[a, b], h / 2)
        tau_c = factor * max(theta, tau / 8)
        gain.append(tau / (g[a, b] * (tau_c + theta)))
        ti.append(min(tau, 4 * (tau_c + theta)))
    return np.array(gain), np.array(ti)


def log_modulus(parts, pairs, gain, ti, h, slowest):
    """Largest 20 log10 |1 - 1/det(I + G(z) C(z))| over a fine grid."""
    n, best = len(pairs), -np.inf
    row, col = {a: k for k, (a, _) in enumerate(pairs)}, {b: k for k, (_, b) in enumerate(pairs)}
    for w in np.geomspace(0.02 / slowest, np.pi / h, 6000):
        z, G = np.exp(1j * w * h), np.zeros((n, n), complex)
        for q in parts:
            i, j = q.outputs[0], q.inputs[0]
            if i in row and j in col:
                G[row[i], col[j]] = (q.C[0] @ (q.new[:, 0] + q.old[:, 0] / z)) / (z - q.Ad[0, 0]) * z ** -q.whole
        det = np.linalg.det(np.eye(n) + G * (gain * (1 + h / ti / (z - 1)))[None, :])
        best = max(best, 20 * np.log10(abs(1 - 1 / det)))
    return best


def four(a):
    return [*a, *[0.0] * (4 - len(a))]


def line(values):
    return ",".join(f"{x:.12g}" for x in values)


def loops():
    for number, (q, g, L, T, pairs) in enumerate(figures(), 1):
        if pairs:
            h = q.j["tick_s"]
            yield number, g, L, T, pairs, h, *simc(g, L, T, pairs, h)


def nyquist():
    for number, g, L, T, pairs, h, gain, ti in loops():
        parts = fopdt_parts(g, L, T, h)
        stable = lambda times: Loop(parts, pairs, gain * times, ti, h).radius() < 1.0
        for times in TIMES:
            if len({stable(times * x) for x in (0.99, 1.0, 1.01)}) > 1:
                continue
            good = stable(times)
            slowest = max((T + L).max(), ti.max())
            db = log_modulus(parts, pairs, gain * times, ti, h, slowest) if good else 0.0
            yield line([number, h, times, *four(gain), *four(ti), good, db])


def trials():
    for number, g, L, T, pairs, h, gain, ti in loops():
        n, steps = len(pairs), 1600
        if L.max() > 125 * h:  # the firmware would take longer samples
            continue
        loop = Loop(fopdt_parts(g, L, T, h), pairs, gain, ti, h)
        for load in (0, 1):
            for k in (0, n - 1):
                sp, dist = np.zeros(n), np.zeros(loop.m)
                if load:
                    dist[pairs[k][1]] = 0.01
                else:
                    sp[k] = 0.01
                y, u = loop.simulate(steps, sp, dist, b=0.7)
                e = y[:, loop.outputs] - sp
                iae = h * np.abs(e).sum(axis=0)
                peak = np.abs(e).max(axis=0) / 0.01
                if not load:
                    peak[k] = max(e[:, k].max() / 0.01, 0.0)
                late = [np.flatnonzero(np.abs(e[:, i]) > 0.05 * 0.01) for i in range(n)]
                settled = [h * (x[-1] + 1) if len(x) else 0.0 for x in late]
                moved = np.abs(u[:, loop.inputs]).max(axis=0)
                duration = h * (steps - 0.5)  # steps samples, whichever way it is rounded
                settled = np.minimum(settled, duration)
                yield line([number, h, k, load, duration, *four(gain), *four(ti), *four(iae), *four(peak), *four(settled),
                            *four(moved)])


def main():
    gains = "g1,g2,g3,g4,ti1,ti2,ti3,ti4"
    table("nyquist.csv", f"plant,interval_s,times,{gains},stable,log_modulus_db", nyquist(),
          "Stability of SIMC loops together, by eigenvalues; log modulus on a fine grid", maker="loops_reference")
    by_loop = ",".join(f"{x}{k}" for x in ("iae", "peak", "settled", "moved") for k in range(1, 5))
    table("trial.csv", f"plant,interval_s,loop,load,duration_s,{gains},{by_loop}", trials(),
          "Steps of 0.01 with SIMC loops and setpoint weight 0.7, by an exact simulation", maker="loops_reference")


if __name__ == "__main__":
    main()
