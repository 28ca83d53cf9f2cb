#!/usr/bin/python3
"""Are the deviations of identify/shape_fit honest? The real C code on random elements of seven classes, and a table.

    cmake --build --preset host --target shape_records
    tests/bench/shape_deviations.py --program build/host/tests/unit/shape_records            210 elements a class
    tests/bench/shape_deviations.py --program ... --draws 30 --check                         judges: what the test runs
    tests/bench/shape_deviations.py --program ... --study                                    BIC against AICc
    tests/bench/shape_deviations.py --program ... --members                                  the plausible members

An element is drawn at random, moved by a double step (+a, -a, 0) or by +a, 0, -a, 0, and answers with 4 to 12 % of span. White
noise of 0.1, 0.3 and 0.5 % of span in rotation, a drift of up to 1 % of span over the record and 12 bits come on top. A level
lasts as long as the element needs to come within 0.2 to 6 % of its end, in half of the tests up to 8 times as long. The baseline is free, or a line through the rest
before. Same seed, same records.
"""
import argparse
import math
import subprocess
import sys

import numpy as np

EDGES = 12
HEAD = np.dtype([("samples", "u4"), ("edges", "u4"), ("known", "u4"), ("units", "u4"), ("h_s", "f8"),
                 ("offset", "f8"), ("slope_per_s", "f8"), ("offset_sd", "f8"), ("slope_sd_per_s", "f8"), ("noise_sd", "f8"),
                 ("edge", "f8", (EDGES, 2))])
NOISES = (0.001, 0.003, 0.005)
COUNT = 1.0 / 4096
OTHERS = ("no response", "three lags", "integrating", "short level")
CLASSES = ("first order", "two lags", "damped", "inverse", "overshoot", "fast and slow", "dead time")
KINDS = ("unknown", "no response", "one lag", "two lags", "two with zero", "integrating", "slow")
UNKNOWN, NO_RESPONSE, ONE, TWO, ZERO, INTEGRATING, SLOW = range(7)
FORMULAS = ("one", "two", "zero", "ramp")
PARAMETERS = (3, 4, 5, 3)


class Element:
    """gain (zero s + 1) exp(-dead s) / ((first s + 1)(second s + 1)); damped: first and second are conjugate. Samples."""

    def __init__(self, gain, dead, lag, square, zero=0.0):
        self.gain, self.dead, self.lag, self.square, self.zero = gain, dead, lag, square, zero

    def residence(self):
        return self.dead + self.lag - self.zero

    def step(self, t):
        """Unit step response at times t from the step, samples."""
        t = np.asarray(t, float) - self.dead
        after = np.maximum(t, 0.0)
        if self.square == 0.0:
            rest = np.exp(-after / self.lag)
            rest = rest - self.zero / self.lag * rest
        else:
            root = np.sqrt(complex(self.lag ** 2 - 4.0 * self.square))
            if abs(root) < 1e-6 * self.lag:
                root = 1e-6 * self.lag + 0j
            a, b = 0.5 * (self.lag + root), 0.5 * (self.lag - root)
            rest = (((a - self.zero) * np.exp(-after / a) - (b - self.zero) * np.exp(-after / b)) / (a - b)).real
        return self.gain * np.where(t > 0.0, 1.0 - rest, 0.0)

    def settled(self, share):
        """First time from which the response stays within a share of its end."""
        # the slowest exponential or envelope
        slowest = self.lag if self.square == 0.0 else max(-1.0 / r.real for r in np.roots([self.square, self.lag, 1.0]))
        t = self.dead + slowest * np.linspace(0.0, 14.0, 2801)
        off = np.abs(self.step(t) / self.gain - 1.0) > share
        return t[min(int(np.flatnonzero(off)[-1]) + 1, len(t) - 1)] if off.any() else self.dead


class Integrator(Element):
    """slope exp(-dead s) / (s (lag s + 1)), seen for a number of its dead time and lag."""

    def step(self, t):
        after = np.maximum(np.asarray(t, float) - self.dead, 0.0)
        return self.gain * (after + self.lag * np.expm1(-after / self.lag))

    def settled(self, share):
        return self.level


class ThreeLags(Element):
    """A third lag, which no formula has."""

    def step(self, t):
        t = np.asarray(t, float) - self.dead
        after = np.maximum(t, 0.0)
        lags = self.lags
        rest = 0.0
        for i, a in enumerate(lags):
            others = [b for j, b in enumerate(lags) if j != i]
            rest = rest + a * a * np.exp(-after / a) / ((a - others[0]) * (a - others[1]))
        return self.gain * np.where(t > 0.0, 1.0 - rest, 0.0)

    def settled(self, share):
        t = np.linspace(0.0, 12.0 * sum(self.lags), 2401) + self.dead
        off = np.flatnonzero(np.abs(self.step(t) / self.gain - 1.0) > share)
        return t[min(int(off[-1]) + 1, len(t) - 1)]


class Short(Element):
    """A level that ends early."""

    def settled(self, share):
        return self.dead + self.part * super().settled(0.05)


def other_element_of(name, random):
    u = random.uniform
    scale = math.exp(u(math.log(6.0), math.log(60.0)))
    gain = random.choice((-1.0, 1.0)) * math.exp(u(-1.0, 1.0))
    if name == "no response":
        e = Element(gain, u(0.05, 1.0) * scale, scale, 0.0)
        e.silent = True
    elif name == "three lags":
        e = ThreeLags(gain, u(0.05, 0.5) * scale, 0.0, 0.0)
        e.lags = [scale, scale * u(0.5, 0.9), scale * u(0.2, 0.45)]
        e.lag = sum(e.lags)
    elif name == "integrating":
        e = Integrator(gain, u(0.1, 1.0) * scale, u(0.2, 1.0) * scale, 0.0)
        e.level = e.dead + e.lag * u(4.5, 12.0)
    else:
        name = CLASSES[int(u(0.0, 7.0))]
        base = element_of(name, random)
        e = Short(base.gain, base.dead, base.lag, base.square, base.zero)
        e.name = name
        e.part = math.exp(u(math.log(0.08), math.log(0.5)))
    return e


def element_of(name, random):
    scale = math.exp(random.uniform(math.log(6.0), math.log(120.0)))
    u = random.uniform
    gain = random.choice((-1.0, 1.0)) * math.exp(u(-1.0, 1.0))
    if name == "first order":
        return Element(gain, u(0.05, 1.0) * scale, scale, 0.0)
    if name == "dead time":
        return Element(gain, 3.0 * scale / 2, scale / 2, 0.0)
    if name == "two lags":
        second = u(0.1, 1.0) * scale
        return Element(gain, u(0.05, 0.6) * scale, scale + second, scale * second)
    if name == "damped":
        zeta = u(0.15, 0.7)
        return Element(gain, u(0.05, 1.0) * scale, 2.0 * zeta * scale, scale * scale)
    second = u(0.3, 1.0) * scale
    dead = u(0.05, 0.4) * scale
    if name == "inverse":
        return Element(gain, dead, scale + second, scale * second, -u(0.3, 1.5) * scale)
    if name == "overshoot":
        return Element(gain, dead, scale + second, scale * second, u(1.3, 3.0) * scale)
    fast = 0.5 * scale
    slow = fast * math.exp(u(math.log(5.0), math.log(40.0)))
    part = u(0.2, 0.7)
    return Element(gain, u(0.1, 1.0) * fast, fast + slow, fast * slow, part * fast + (1.0 - part) * slow)


def record_of(element, noise, random, number):
    """A test of the element: head and samples as bytes."""
    share = math.exp(random.uniform(math.log(0.002), math.log(0.06)))
    half = int(element.settled(share)) + 4
    if number // 4 % 2 and type(element) is Element:  # a slower output of the same input makes the test longer
        half = int(half * math.exp(random.uniform(0.0, math.log(8.0))))
    window = int(random.choice((32, 64, 128)))
    top = element.step(np.array([half]))[0] if type(element) in (Integrator, Short) else element.gain
    amplitude = random.uniform(0.04, 0.12) / max(abs(top), 0.05 * abs(element.gain))
    if getattr(element, "silent", False):
        element.gain = 0.0
    levels = (1.0, -1.0, 0.0) if number % 2 else (1.0, 0.0, -1.0, 0.0)
    samples = len(levels) * half + 8
    start = 2
    k = np.arange(-window, samples)
    y = np.zeros(len(k))
    edges = np.zeros((EDGES, 2))
    before = 0.0
    for n, level in enumerate(levels):
        at = start + n * half
        y += amplitude * (level - before) * element.step(k - at)
        edges[n] = at, amplitude * level
        before = level
    slope = random.uniform(-0.01, 0.01) / samples
    y += slope * k + noise * random.standard_normal(len(k))
    y = np.round((0.5 + y) / COUNT) * COUNT - 0.5
    rest, t = y[:window], np.arange(-window, 0)
    fit = np.polyfit(t, rest, 1)
    sd = float(np.std(np.diff(rest)) / math.sqrt(2.0))
    mean_sd, slope_sd = sd / math.sqrt(window), sd * math.sqrt(12.0 / window ** 3)
    head = np.zeros(1, HEAD)
    head["samples"], head["edges"], head["known"], head["units"], head["h_s"] = samples, len(levels), number // 2 % 2, 7, 2.0
    head["offset"], head["slope_per_s"] = fit[1], fit[0] / 2.0
    head["offset_sd"] = math.hypot(mean_sd, slope_sd * window / 2.0)
    head["slope_sd_per_s"] = slope_sd / 2.0
    head["noise_sd"] = sd
    head["edge"] = edges
    return head.tobytes() + y[window:].tobytes()


class Found:
    """One line of the program."""

    def __init__(self, line, element):
        v = [float(x) for x in line.split()]
        self.element = element
        self.kind, self.evaluations, self.points = int(v[0]), int(v[1]), int(v[2])
        self.gain, self.dead, self.lag, self.square, self.zero = v[3:8]
        self.sd = v[8:13]
        self.residence_sd, self.other, self.one_gain, self.one_sd, self.total = v[13:18]
        self.formulas = np.array(v[18:54]).reshape(4, 9)
        self.members = np.array(v[54:]).reshape(-1, 5)
        self.times = 2.0

    def residence(self):
        return self.dead + self.lag - self.zero

    def z(self):
        return ((self.gain - self.element.gain) / self.sd[0],
                (self.residence() - self.times * self.element.residence()) / self.residence_sd)


def run(program, name, draws, seed, members=0):
    random = np.random.default_rng([seed, (CLASSES + OTHERS).index(name)])
    elements = [(element_of if name in CLASSES else other_element_of)(name, random) for _ in range(draws)]
    data = b"".join(record_of(e, NOISES[i % 3], random, i) for i, e in enumerate(elements))
    out = subprocess.run([program, "--members", str(members)], input=data, stdout=subprocess.PIPE, check=True).stdout.decode().splitlines()
    return [Found(line, e) for line, e in zip(out, elements, strict=True)]


def table(results):
    print(f"{'class':14} {'n':>4} {'known':>6} | gain beyond 2 sd  3 sd | residence 2 sd  3 sd | median sd: gain  residence |"
          f" one lag beyond 2 sd | kinds")
    rows = []
    for name, found in results.items():
        known = [f for f in found if f.kind in (ONE, TWO, ZERO)]
        z = np.abs(np.array([f.z() for f in known]))
        beyond = [100.0 * np.mean(z[:, k] > s) for k in range(2) for s in (2.0, 3.0)]
        sd = np.median([f.sd[0] / abs(f.gain) for f in known]), np.median([f.residence_sd / f.residence() for f in known])
        one = 100.0 * np.mean([abs(f.one_gain - f.element.gain) > 2.0 * f.one_sd for f in known])
        kinds = " ".join(f"{KINDS[k]}: {sum(f.kind == k for f in found)}" for k in range(7) if any(f.kind == k for f in found))
        print(f"{name:14} {len(found):4} {len(known):6} | {beyond[0]:14.1f} % {beyond[1]:4.1f} % | {beyond[2]:12.1f} % {beyond[3]:4.1f} % |"
              f" {100 * sd[0]:15.2f} % {100 * sd[1]:8.2f} % | {one:17.1f} % | {kinds}")
        rows.append((name, len(found), len(known), beyond))
    print("most evaluations:", max(f.evaluations for found in results.values() for f in found))
    return rows


def other_table(results):
    """Elements whose end is not seen, that have none, or whose shape no formula has."""
    print(f"{'other':14} {'n':>4} {'known':>6} | known: gain beyond 2 sd  3 sd | slow: true gain below the bound | kinds")
    for name, found in results.items():
        known = [f for f in found if f.kind in (ONE, TWO, ZERO)]
        z = np.abs(np.array([f.z() for f in known])) if known else np.zeros((1, 2))
        slow = [f for f in found if f.kind == SLOW]
        below = sum(abs(f.element.gain) < abs(f.gain) * 0.8 or f.gain * f.element.gain < 0.0 for f in slow)
        kinds = " ".join(f"{KINDS[k]}: {sum(f.kind == k for f in found)}" for k in range(7) if any(f.kind == k for f in found))
        print(f"{name:14} {len(found):4} {len(known):6} | {100 * np.mean(z[:, 0] > 2):21.1f} % {100 * np.mean(z[:, 0] > 3):4.1f} % |"
              f" {below:30} | {kinds}")
        if name == "integrating":
            off = np.array([(f.gain / f.lag / (f.element.gain / 2.0) - 1.0) for f in found if f.kind == INTEGRATING])
            z = np.array([(f.gain / f.lag - f.element.gain / 2.0) / (f.sd[0] / f.lag) for f in found if f.kind == INTEGRATING])
            print(f"    slopes of integrators: rms error {100 * np.sqrt(np.mean(off ** 2)):.2f} %, {100 * np.mean(np.abs(z) > 2):.1f} % beyond 2 sd")
        if name == "no response":
            z = np.array([f.gain / f.sd[0] for f in found if f.kind == NO_RESPONSE])
            print(f"    gains: {100 * np.mean(np.abs(z) > 2):.1f} % beyond 2 sd")


def member_table(program, draws, seed):
    """Are the plausible members as far from the chosen shape as the true one is? Largest difference of the step responses over the
    gain, within the level. Honest members: the true one is beyond the farthest of 24 in 1 of 25."""
    print(f"{'class':14} | true shape, median | median of 24 members | farthest of 24 | true one beyond the farthest")
    for name in CLASSES:
        ratios = []
        for f in run(program, name, draws, seed, 24):
            if f.kind not in (ONE, TWO, ZERO):
                continue
            e, h = f.element, f.times
            t = np.linspace(0.0, e.settled(0.02), 160)
            chosen = Element(f.gain, f.dead / h, f.lag / h, f.square / h ** 2, f.zero / h).step(t)
            far = [np.max(np.abs(Element(g, d / h, lag / h, q / h ** 2, z / h).step(t) - chosen)) / abs(f.gain)
                   for g, d, lag, q, z in f.members]
            ratios.append((np.max(np.abs(e.step(t) - chosen)) / abs(f.gain), np.median(far), max(far)))
        r = np.array(ratios)
        print(f"{name:14} | {100 * np.median(r[:, 0]):15.2f} % | {100 * np.median(r[:, 1]):18.2f} % | {100 * np.median(r[:, 2]):12.2f} % |"
              f" {100 * np.mean(r[:, 0] > r[:, 2]):10.1f} %")


def weights(found, criterion, penalty=None):
    """penalty: of a parameter, in place of the criterion's."""
    n = found.points
    best = int(np.argmin(found.formulas[:, 0]))
    r = found.formulas[best, 1]
    n *= (1.0 - r) / (1.0 + r)
    value = []
    for squares, k in zip(found.formulas[:, 0], PARAMETERS, strict=True):
        cost = penalty * k if penalty else k * math.log(n) if criterion == "BIC" else 2.0 * k + 2.0 * k * (k + 1.0) / max(n - k - 1.0, 1.0)
        value.append(n * math.log(max(squares, 1e-10 * found.total)) + cost)
    w = np.exp(-0.5 * (np.array(value) - min(value)))
    return w / w.sum()


def study(results):
    """What the criterion and the mixture change: on the same fits, in double."""
    true = dict(zip(CLASSES, (0, 1, 1, 2, 2, 2, 0), strict=True))
    print(f"{'criterion':24} | true formula  too small  too large | gain: beyond 2 sd  3 sd | residence 2 sd  3 sd | rms error: gain  residence")
    for criterion in ("BIC", "AICc"):
        for mixed in (True, 3.0, 2.0, False):
            z, right, error = [], [], []
            for name, found in results.items():
                for f in found:
                    if f.kind not in (ONE, TWO, ZERO):
                        continue
                    w = weights(f, criterion)[:3]
                    gain, variance, residence_variance = f.formulas[:3, 2], f.formulas[:3, 7], f.formulas[:3, 8]
                    residence = f.formulas[:3, 3] + f.formulas[:3, 4] - f.formulas[:3, 6]
                    best = int(np.argmax(w))
                    if not mixed:
                        w = np.eye(3)[best]
                    elif mixed > 1.0:
                        w = weights(f, criterion, mixed)[:3]
                        w = w / w.sum()
                    sd = math.sqrt(np.sum(w * (variance + (gain - gain[best]) ** 2)))
                    residence_sd = math.sqrt(np.sum(w * (residence_variance + (residence - residence[best]) ** 2)))
                    off = residence[best] - f.times * f.element.residence()
                    z.append((abs(gain[best] - f.element.gain) / sd, abs(off) / residence_sd))
                    error.append((gain[best] / f.element.gain - 1.0, off / (f.times * (f.element.dead + f.element.lag))))
                    right.append(best - true[name])
            z, right, error = np.array(z), np.array(right), np.sqrt(np.mean(np.square(error), 0))
            b = [100.0 * np.mean(z[:, k] > s) for k in range(2) for s in (2.0, 3.0)]
            print(f"{criterion + (', mixed' if mixed is True else f', mixed with {mixed}' if mixed else ', the best alone'):24} | {100 * np.mean(right == 0):10.1f} % {100 * np.mean(right < 0):8.1f} %"
                  f" {100 * np.mean(right > 0):8.1f} % | {b[0]:15.1f} % {b[1]:4.1f} % | {b[2]:12.1f} % {b[3]:4.1f} % |"
                  f" {100 * error[0]:14.2f} % {100 * error[1]:8.2f} %")


def judge(rows, others):
    """Acceptance of issue 35: at most 7 % beyond 2 deviations, 1 % beyond 3, in every class of 200 elements and more. A class of
    fewer may have two more than that; all classes together may not."""
    faults = []
    limits = (7.0, 1.0, 7.0, 1.0)
    texts = ("gains beyond 2 sd", "gains beyond 3 sd", "residence times beyond 2 sd", "residence times beyond 3 sd")
    count = sum(known for _, _, known, _ in rows)
    for k, (limit, text) in enumerate(zip(limits, texts, strict=True)):
        number = [b[k] * known / 100.0 for _, _, known, b in rows]
        for (name, n, known, _), m in zip(rows, number, strict=True):
            if m > limit * known / 100.0 + (0.0 if n >= 200 else 2.0) + 1e-6:
                faults.append(f"{name}: {m:.0f} of {known} {text}")
        if sum(number) > limit * count / 100.0:
            faults.append(f"all classes: {sum(number):.0f} of {count} {text}")
    faults += [f"{name}: only {known} of {n} are known" for name, n, known, _ in rows if known < 0.97 * n]
    known = sum(f.kind in (ONE, TWO, ZERO, INTEGRATING) for f in others["no response"])
    if known > 0.01 * len(others["no response"]):
        faults.append(f"no response: {known} have a shape")
    if any(f.kind in (ONE, TWO, ZERO) for f in others["integrating"]):
        faults.append("integrating: an integrator has an end")
    for fault in faults:
        print("NOT MET:", fault)
    return 1 if faults else 0


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--program", required=True)
    options.add_argument("--draws", type=int, default=210)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--check", action="store_true")
    options.add_argument("--members", action="store_true")
    options.add_argument("--study", action="store_true")
    options.add_argument("--worst", action="store_true")
    o = options.parse_args()
    print("seed", o.seed)
    results = {name: run(o.program, name, o.draws, o.seed) for name in CLASSES}
    rows = table(results)
    others = {name: run(o.program, name, o.draws, o.seed) for name in OTHERS}
    other_table(others)
    if o.members:
        member_table(o.program, o.draws, o.seed)
    if o.study:
        study(results)
    if o.worst:
        for name, found in (results | others).items():
            bad = sorted((f for f in found if f.kind in (ONE, TWO, ZERO)), key=lambda f: -max(map(abs, f.z())))[:5]
            for f in bad:
                e, h = f.element, f.times
                print(f"{name}: {f.z()[0]:.1f} and {f.z()[1]:.1f} sd, {KINDS[f.kind]}; true {e.gain:.3f} {h * e.dead:.1f} {h * e.lag:.1f}"
                      f" {h * h * e.square:.0f} {h * e.zero:.1f}, found {f.gain:.3f} {f.dead:.1f} {f.lag:.1f} {f.square:.0f} {f.zero:.1f}")
    return judge(rows, others) if o.check else 0


if __name__ == "__main__":
    sys.exit(main())
