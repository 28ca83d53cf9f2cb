#!/usr/bin/python3
"""References for firmware/design/robust.h: plants, the best decentralised PI on each that a random search finds, and
sensitivities in double.

  robust_plants.csv  plant, loops, interval, duration, then elements row by row of a 3 x 3 (gain, dead time, time constant,
                     square, zero; 0 where there is none), integrals of |e| of the best PI: all loops and setpoint steps of 1
                     added up, and all steps of 1 of the inputs; its signed gains and integral times. Best: the least product of both
                     integrals with |S_kk| at most 2 and |T_kk| at most 1.5.
  peaks.csv          plant, signed gains and integral times of three loops, largest |S_kk| and |T_kk| of each on a fine grid

usage: tests/reference/robust_reference.py
"""
import numpy as np

from shaped_loops import Element, Loops, one_lag as LAG, write

SEED = 35


def two_modes(slow, fast):
    """Column A, LV configuration: slow/(194 s + 1) + fast/(15 s + 1), minutes, and 1 min of dead time."""
    gain = slow + fast
    return (gain / 100.0, 1.0, 194.0 + 15.0, 194.0 * 15.0, (slow * 15.0 + fast * 194.0) / gain)


# interval, duration, elements. Wood and Berry, Chem. Eng. Sci. 28 (1973) 1707; Skogestad and Morari, AIChE J. 34 (1988) 1620
PLANTS = {
    "wood-berry": (0.25, 200.0, [[LAG(12.8, 1.0, 16.7), LAG(-18.9, 3.0, 21.0)], [LAG(6.6, 7.0, 10.9), LAG(-19.4, 3.0, 14.4)]]),
    "relative gain 5": (0.5, 500.0, [[LAG(1.0, 2.0, 20.0), LAG(0.8944, 4.0, 25.0)], [LAG(0.8944, 4.0, 18.0), LAG(1.0, 3.0, 22.0)]]),
    "dead time": (2.0, 1200.0, [[LAG(1.0, 30.0, 10.0), LAG(0.4, 20.0, 10.0)], [LAG(0.3, 25.0, 12.0), LAG(1.0, 24.0, 8.0)]]),
    "column-a": (0.5, 1500.0, [[two_modes(87.8, 0.0), two_modes(-87.8, 1.4)], [two_modes(108.2, 0.0), two_modes(-108.2, -1.4)]]),
    "inverse response": (0.5, 400.0, [[(1.0, 1.0, 20.0, 96.0, -8.0), LAG(0.5, 5.0, 20.0)], [LAG(-0.4, 4.0, 15.0), (1.0, 3.0, 24.0, 0.0, -6.0)]]),
    "damping 0.25": (0.5, 600.0, [[(1.0, 1.0, 10.0, 400.0, 0.0), LAG(0.3, 5.0, 8.0)], [LAG(0.2, 4.0, 15.0), (1.0, 3.0, 25.0, 100.0, 0.0)]]),
    "slow tail, three loops": (0.5, 600.0, [
        [(1.0, 2.0, 44.0, 160.0, 18.0), LAG(0.3, 6.0, 30.0), LAG(-0.2, 4.0, 20.0)],
        [LAG(0.4, 5.0, 25.0), LAG(-1.2, 3.0, 18.0), LAG(0.3, 7.0, 22.0)],
        [LAG(0.1, 8.0, 30.0), LAG(0.5, 5.0, 15.0), LAG(0.8, 4.0, 26.0)]]),
}


class Search:
    """Many settings side by side: columns are settings, then steps."""

    def __init__(self, h, duration, elements):
        self.h, self.n, self.steps = h, len(elements), int(round(duration / h))
        self.parts = [(i, j, Element(*elements[i][j], h)) for i in range(self.n) for j in range(self.n)
                      if elements[i][j][0] != 0.0]
        self.length = 2 + max(e.whole for _, _, e in self.parts)
        slowest = max(e[1] + e[2] for row in elements for e in row)
        self.w = np.geomspace(0.02 / slowest, np.pi / h, 400)
        self.G = np.zeros((len(self.w), self.n, self.n), complex)
        for i, j, e in self.parts:
            self.G[:, i, j] = [e.response(z) for z in np.exp(1j * self.w * h)]
        self.a = h / (np.exp(1j * self.w * h) - 1.0)

    def sensitivities(self, gain, ti):
        """Largest |S| and |T| over loops and frequencies, for settings in rows."""
        c = gain[:, None, :] * (1.0 + self.a[None, :, None] / ti[:, None, :])
        s = np.linalg.inv(np.eye(self.n) + self.G[None] * c[:, :, None, :])
        s = np.diagonal(s, axis1=2, axis2=3)
        return np.abs(s).max(axis=(1, 2)), np.abs(1.0 - s).max(axis=(1, 2))

    def integrals(self, gain, ti):
        """Sums of the integrals of |e| after setpoints and after loads, for settings in rows; infinite where a step runs away."""
        m, n, h = len(gain), self.n, self.h
        cols = m * 2 * n
        K, I = np.repeat(gain.T, 2 * n, axis=1), np.repeat(h * (gain / ti).T, 2 * n, axis=1)
        setpoint = np.tile(np.concatenate([np.eye(n), np.zeros((n, n))], axis=1), (1, m))
        load = np.tile(np.concatenate([np.zeros((n, n)), np.eye(n)], axis=1), (1, m))
        x = [np.zeros((len(e.A), cols)) for _, _, e in self.parts]
        past, y, integral = np.zeros((self.length, n, cols)), np.zeros((n, cols)), np.zeros((n, cols))
        total = np.zeros(cols)
        for k in range(self.steps):
            error = setpoint - y
            u = K * error + integral + load
            integral += I * error
            past[k % self.length] = u
            y = np.zeros((n, cols))
            for p, (i, j, e) in enumerate(self.parts):
                new, old = past[(k - e.whole) % self.length, j], past[(k - e.whole - 1) % self.length, j]
                x[p] = e.A @ x[p] + e.new[:, None] * new + e.old[:, None] * old
                y[i] += e.C @ x[p] + e.direct * new
            total += h * np.abs(y - setpoint).sum(axis=0)
            if k % 200 == 0 and np.abs(y).max() > 1e6:
                wild = np.abs(y).max(axis=0) > 1e5
                total[wild] = np.inf
                y[:, wild], integral[:, wild], past[:, :, wild] = 0.0, 0.0, 0.0
                for state in x:
                    state[:, wild] = 0.0
        far = np.abs(y - setpoint).max(axis=0) > 0.5
        total[far] = np.inf
        total = total.reshape(m, 2, n).sum(axis=2)
        return total[:, 0], total[:, 1]


def best_settings(search, elements, rng, s_most=2.0, t_most=1.5):
    n = search.n
    sign = np.array([np.sign(elements[k][k][0]) for k in range(n)])
    centre, best = [], np.inf
    for k in range(n):  # to begin with: a slow PI
        gain, dead, lag, square, zero = elements[k][k]
        late = dead + search.h / 2 + max(-zero, 0.0) + (square / lag if lag else 0.0)
        centre += [np.log(0.15 * lag / abs(gain) / (2 * late)), np.log(lag)]
    centre = np.array(centre)
    spread = 0.6
    for generation in range(90):
        tried = centre + spread * rng.standard_normal((48, 2 * n))
        tried[0] = centre
        gain, ti = sign * np.exp(tried[:, 0::2]), np.exp(tried[:, 1::2])
        s, t = search.sensitivities(gain, ti)
        good = (s <= s_most) & (t <= t_most)
        if not good.any():
            centre = centre + np.tile([-0.3, 0.1], n)
            continue
        setpoints, loads = search.integrals(gain[good], ti[good])
        score = np.log(setpoints) + np.log(loads)
        at = np.argmin(score)
        if score[at] < best - 1e-4:
            best, centre = score[at], tried[good][at]
            result = gain[good][at], ti[good][at], setpoints[at], loads[at]
        else:
            spread = max(0.8 * spread, 0.003)
    return result


def padded(values, size=3):
    return [*values, *[0.0] * (size - len(values))]


def plants():
    rng = np.random.default_rng(SEED)
    for number, (name, (h, duration, elements)) in enumerate(PLANTS.items()):
        search = Search(h, duration, elements)
        gain, ti, setpoints, loads = best_settings(search, elements, rng)
        n = len(elements)
        flat = [x for i in range(3) for j in range(3) for x in (elements[i][j] if i < n and j < n else (0.0,) * 5)]
        print(name, gain, ti, setpoints, loads, flush=True)
        yield [number, n, h, duration, *flat, setpoints, loads, *padded(gain), *padded(ti)]


def peaks(rows):
    for row in rows:
        number, n, h, _ = row[:4]
        elements = PLANTS[list(PLANTS)[number]][2]
        gain, ti = np.array(row[-6:][:n]), np.array(row[-3:][:n])
        for times, slower in ((0.3, 1.0), (0.6, 2.0), (1.0, 1.0), (1.2, 1.0), (0.8, 0.7)):
            loops = Loops(elements, h, gain * times, ti * slower)
            if loops.radius() >= 1.0:
                continue
            s, t = np.zeros(n), np.zeros(n)
            for w in np.geomspace(1e-5 / h, np.pi / h, 3000):
                at = loops.sensitivities(w)
                s, t = np.maximum(s, at[0]), np.maximum(t, at[1])
            yield [number, *padded(gain * times), *padded(ti * slower), *padded(s), *padded(t)]


def main():
    rows = list(plants())
    settings = "gain1,gain2,gain3,ti1,ti2,ti3"
    elements = ",".join(f"{x}{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3) for x in ("gain", "dead", "lag", "square", "zero"))
    write(__file__, "robust_plants.csv", "Plants and the best decentralised PI with |S| up to 2 and |T| up to 1.5",
          f"plant,loops,interval_s,duration_s,{elements},setpoints,loads,{settings}", rows)
    write(__file__, "peaks.csv", "Largest sensitivities of PI loops on the plants of robust_plants.csv",
          f"plant,{settings},s1,s2,s3,t1,t2,t3", peaks(rows))


if __name__ == "__main__":
    main()
