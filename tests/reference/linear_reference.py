#!/usr/bin/python3
"""Gains, poles, step responses and pairings of the linear plants, worked out apart from the simulator.

Reads host_sim/plants/*.json for the numbers of the models and nothing else: transfer functions by partial
fractions, matrices by scipy. Writes the tables that tests/unit/test_linear_plants.c compares with:

  linear_gains.csv     steady-state gains, output unit per input unit
  linear_poles.csv     poles; 1/s, discrete plants in the z plane
  linear_steps.csv     responses to a step of one unit at t = 0, at five times that are no multiples of dead times
  linear_pairing.csv   the pairing and its relative gains, of the gains in spans: of a tall plant the outputs of the
                       largest row sums of the non-square RGA (pseudo-inverse; Chang and Yu 1990), then the assignment
                       of least sum of |ln(relative gain)| with no negative element in the square RGA
  linear_exp.csv       matrix exponentials for dense_exp: n, then a and exp(a) row by row

usage: tests/reference/linear_reference.py
"""
import json
from pathlib import Path

import numpy as np
import scipy.linalg
import scipy.optimize

HERE = Path(__file__).resolve().parent
PLANTS = HERE.parent.parent / "host_sim" / "plants"
UNIT = {"s": 1.0, "min": 60.0, "h": 3600.0}
STEPS = (1, 2, 3, 5, 10)  # responses are taken at these multiples of the plant's step_interval()


class Element:
    """gain (zero s + 1) exp(-dead s) / denominator, times in seconds."""

    def __init__(self, e, unit):
        self.gain, self.zero = e["gain"], e.get("zero", 0.0) * unit
        self.dead = e.get("dead_time", 0.0) * unit
        if "quadratic" in e:
            a2, a1 = e["quadratic"]
            self.poles = list(np.roots([a2 * unit**2, a1 * unit, 1.0]))
        else:
            lags = e.get("lags", [])
            self.poles = [-1.0 / (x * unit) for x in (lags if isinstance(lags, list) else [lags])]

    def step(self, t):
        """Response to a unit step, by residues of G(s)/s."""
        t = t - self.dead
        if t < 0.0:
            return 0.0
        p, z = self.poles, self.zero
        if len(p) == 0:
            return self.gain
        if len(p) == 1:
            return self.gain * (1.0 - (1.0 + z * p[0]) * np.exp(p[0] * t)).real
        if abs(p[0] - p[1]) < 1e-12 * abs(p[0]):  # double pole -1/T
            T = -1.0 / p[0].real
            return self.gain * (1.0 - np.exp(-t / T) * (1.0 + t / T - z * t / T**2))
        # G = p0 p1 (z s + 1) / ((s - p0)(s - p1)); residue of G/s at p0: p1 (z p0 + 1) / (p0 - p1)
        sum_ = 1.0 + p[1] * (z * p[0] + 1.0) / (p[0] - p[1]) * np.exp(p[0] * t) \
            + p[0] * (z * p[1] + 1.0) / (p[1] - p[0]) * np.exp(p[1] * t)
        return self.gain * complex(sum_).real


class Plant:
    def __init__(self, path):
        self.j = j = json.loads(path.read_text())
        self.name, self.unit = j["name"], UNIT[j.get("time_unit", "s")]
        self.inputs = j["inputs"] + j.get("disturbances", [])
        self.outputs = j["outputs"]
        self.discrete = j["model"] in ("discrete", "polynomial")
        if j["model"] == "transfer":  # of cases the first is in force
            self.elements = [[e and Element(e["cases"][0] if "cases" in e else e, self.unit) for e in row]
                             for row in j["elements"]]
        elif j["model"] != "polynomial":
            n, p, q = len(j["A"]), len(self.outputs), len(j.get("disturbances", []))
            rate = 1.0 if self.discrete else 1.0 / self.unit
            self.A = np.array(j["A"], float) * rate
            self.B = np.hstack([np.array(j["B"], float), np.array(j.get("E", np.zeros((n, q))), float)]) * rate
            self.C = np.array(j["C"], float)
            D = np.array(j.get("D", np.zeros((p, len(j["inputs"])))), float)
            self.D = np.hstack([D, np.array(j.get("F", np.zeros((p, q))), float)])

    def poles(self):
        if self.j["model"] == "transfer":
            return [p for row in self.elements for e in row if e for p in e.poles]
        if self.j["model"] == "polynomial":  # A is diagonal in every plant there is: z^n + a1 z^(n-1) + ...
            a = np.array(self.j["A"])
            return [r for i in range(a.shape[1]) for r in np.roots(np.concatenate([[1.0], a[:, i, i]]))]
        return list(scipy.linalg.eigvals(self.A))

    def integrates(self):
        return not self.discrete and min(abs(p) for p in self.poles()) < 1e-8

    def gains(self):
        if self.j["model"] == "transfer":
            return np.array([[e.gain if e else 0.0 for e in row] for row in self.elements])
        if self.j["model"] == "polynomial":
            a, b = np.array(self.j["A"]), np.array(self.j["B"])
            return np.linalg.solve(np.eye(a.shape[1]) + a.sum(axis=0), b.sum(axis=0))
        M = np.eye(len(self.A)) - self.A if self.discrete else -self.A
        return self.C @ np.linalg.solve(M, self.B) + self.D

    def step_interval(self):
        """s; a length that cuts across dead times, up to about three slow time constants in ten of it."""
        if self.discrete:
            return self.j["period"] * self.unit
        slow = max(1.0 / abs(p) for p in self.poles()) if not self.integrates() else 10.0
        dead = max((e.dead for row in self.elements for e in row if e), default=0.0) \
            if self.j["model"] == "transfer" else 0.0
        return round(0.317 * slow + 0.113 * dead, 3)

    def responses(self):
        """times, and y[k][output][input] at them."""
        T = self.step_interval()
        times = [k * T for k in STEPS]
        p, m = len(self.outputs), len(self.inputs)
        y = np.zeros((len(times), p, m))
        if self.j["model"] == "transfer":
            for k, t in enumerate(times):
                y[k] = [[e.step(t) if e else 0.0 for e in row] for row in self.elements]
        elif self.j["model"] == "polynomial":  # the difference equation as it stands
            a, b = np.array(self.j["A"]), np.array(self.j["B"])
            for j in range(m):
                past = []
                for k in range(max(STEPS) + 1):
                    now = sum((b[i][:, j] for i in range(len(b)) if i <= k), np.zeros(p))
                    now = now - sum((a[i] @ past[k - 1 - i] for i in range(len(a)) if i < k), np.zeros(p))
                    past.append(now)
                for k, s in enumerate(STEPS):
                    y[k, :, j] = past[s]
        elif self.discrete:
            x = np.zeros((len(self.A), m))
            for s in range(1, max(STEPS) + 1):
                x = self.A @ x + self.B
                if s in STEPS:
                    y[STEPS.index(s)] = self.C @ x + self.D
        else:
            n = len(self.A)
            both = np.zeros((n + m, n + m))
            both[:n, :n], both[:n, n:] = self.A, self.B
            for k, t in enumerate(times):
                y[k] = self.C @ scipy.linalg.expm(both * t)[:n, n:] + self.D
        return times, y

    def pairing(self):
        """(output, input, relative gain) of the best assignment, or a remark why there is none."""
        if self.integrates():
            return "integrates: no steady-state gain"
        m = len(self.j["inputs"])
        span = lambda c: c["hi"] - c["lo"]
        G = self.gains()[:, :m] * np.array([[span(u) / span(y) for u in self.inputs[:m]] for y in self.outputs])
        rank = np.linalg.matrix_rank(G, tol=1e-9 * np.linalg.norm(G, 2))
        if rank < min(G.shape):
            return f"rank {rank} of {min(G.shape)}: undetermined"
        return assignment(G)


def assignment(G):
    """[(output, input, relative gain)] of gains in spans: outputs by the non-square RGA, then the square rest."""
    sums = (G * np.linalg.pinv(G).T).sum(axis=1)  # of a square plant all 1
    kept = np.sort(np.argsort(-np.round(sums, 9), kind="stable")[:G.shape[1]])
    rga = G[kept] * np.linalg.inv(G[kept]).T
    cost = np.where(rga > 0.0, np.abs(np.log(np.maximum(rga, 1e-9))), 1e3)  # 0.05 is as far from 1 as 20
    pairs = zip(*scipy.optimize.linear_sum_assignment(cost))
    return [(int(kept[i]), int(j), float(rga[i, j])) for i, j in pairs]


def table(name, header, rows, remark):
    with open(HERE / name, "w") as f:
        f.write(f"# {remark}\n# made by tests/reference/linear_reference.py\n{header}\n")
        f.writelines(row + "\n" for row in rows)


def exponentials():
    """Matrices that are hard in different ways: stiff, badly scaled, defective, rotating, nil."""
    rng = np.random.default_rng(7)
    stiff = rng.normal(size=(6, 6)) * np.logspace(-3, 2, 6)[:, None]
    scaled = np.array([[-0.3, 2e4, 0], [1e-5, -0.7, 3e3], [1e-8, 2e-4, -1.1]])
    jordan = -2.0 * np.eye(4) + np.diag([1.0] * 3, 1)
    turning = np.array([[0.0, 40.0], [-40.0, 0.0]])
    for a in (stiff - 40.0 * np.eye(6), scaled, jordan, turning, np.zeros((3, 3)), np.array([[-700.0]])):
        yield ",".join(f"{x:.17g}" for x in [len(a), *a.ravel(), *scipy.linalg.expm(a).ravel()])


def linear_files():
    """The plant files that are no columns."""
    return [p for p in sorted(PLANTS.glob("*.json")) if "column" not in json.loads(p.read_text())]


def main():
    plants = [Plant(p) for p in linear_files()]
    gains, poles, steps, pairings = [], [], [], []
    for q in plants:
        if not q.integrates():
            g = q.gains()
            gains += [f"{q.name},{y['name']},{u['name']},{g[i, j]:.17g}"
                      for i, y in enumerate(q.outputs) for j, u in enumerate(q.inputs)]
        poles += [f"{q.name},{complex(p).real:.17g},{complex(p).imag:.17g}"
                  for p in sorted(q.poles(), key=lambda p: (complex(p).real, complex(p).imag))]
        times, y = q.responses()
        steps += [f"{q.name},{o['name']},{u['name']},{t:.9g},{y[k, i, j]:.17g}" for j, u in enumerate(q.inputs)
                  for i, o in enumerate(q.outputs) for k, t in enumerate(times)]
        found = q.pairing()
        pairings += [f"{q.name},none,none,{found}"] if isinstance(found, str) else \
            [f"{q.name},{q.outputs[i]['name']},{q.inputs[j]['name']},{r:.10g}" for i, j, r in found]
    table("linear_gains.csv", "plant,output,input,gain", gains, "Steady-state gains of the linear plants")
    table("linear_poles.csv", "plant,re,im", poles, "Poles of the linear plants: 1/s, or in z; lags element by element")
    table("linear_steps.csv", "plant,output,input,time_s,value", steps, "Responses to a step of one unit")
    table("linear_pairing.csv", "plant,output,input,relative_gain", pairings,
          "Pairings by the exact model: outputs by the non-square RGA, RGA of the square rest, least sum of |ln|, none negative")
    table("linear_exp.csv", "n,a,exp_a", exponentials(), "Matrix exponentials by scipy.linalg.expm")
    for q in plants:
        print(q.name, q.pairing(), "slowest", max(1 / max(abs(p), 1e-30) for p in q.poles()))


if __name__ == "__main__":
    main()
