#!/usr/bin/python3
"""Self-tuning control worked out apart from the firmware, from docs/methods/self-tuning.md alone, in double. Writes

  rls_settings.csv   a row for each case of the estimator: case, n, forgetting and correction (numbers of the words in
                     rls.h), forget, forget_least, memory, trace, rate, error_most, normalise, p0, size of theta where it
                     begins (all alike), lo and hi of the first parameter, samples
  rls_cases.csv      case, sample, y, error, v, trace of P, phi_1 .. phi_12, theta_1 .. theta_12 after it (0 where a case
                     has fewer); phi and y are whole multiples of 2^-24, so that both number formats read them exactly
  gmv_settings.csv   a row for each closed loop: case, then the settings in the order of GMV_COLUMNS, and start values of
                     the parameters, seven of each loop
  gmv_cases.csv      case, step, loops that act (bits), y_1, y_2, w_1, w_2, measured disturbance, u_1, u_2 as applied, whether
                     the loops were solved one by one, and the parameters of each loop (7 at most); y and u are whole multiples
                     of 2^-24

usage: tests/reference/self_tuning_reference.py
"""
from pathlib import Path

import numpy as np

from self_tuning_gmv import Gmv
from self_tuning_rls import Rls, check_square_root

HERE = Path(__file__).resolve().parent
SEED = 19890113
FORGETTING = ("constant", "fortescue", "ydstie", "ydstie_trace", "held_trace", "reset", "directional", "bounded")
CORRECTION = ("none", "pc", "spc")


def whole(x):
    return np.round(np.asarray(x, float) * 2**24) / 2**24


def data(kind, n, samples, random):
    """phi and y of one case. The parameters lie in +-0.7."""
    truth = random.uniform(-0.7, 0.7, n)
    phi = random.uniform(-0.8, 0.8, (samples, n))
    noise = 0.01 * random.standard_normal(samples)
    if kind == "stiff":
        phi[:, 1::2] *= 1e-2
    elif kind == "still":  # excited at first, then the same regressor for ever
        phi[samples // 3:] = phi[samples // 3]
        noise[samples // 3:] = 0
    elif kind == "outlier":
        noise[::11] += 0.4
    elif kind == "large":
        phi *= 4
    phi = whole(phi)
    return phi, whole(phi @ truth + noise)


# kind of data, n, samples, settings
CASES = [
    ("plain", 1, 40, dict(p0=10, forget=0.97)),
    ("plain", 3, 40, dict(p0=10, forget=0.95)),
    ("stiff", 4, 60, dict(p0=100, forget=0.98)),
    ("plain", 9, 50, dict(p0=10, forget=0.98)),
    ("plain", 12, 50, dict(p0=10, forget=0.99)),
    ("outlier", 4, 50, dict(p0=10, forgetting="fortescue", memory=0.5, least=0.4)),
    ("outlier", 4, 50, dict(p0=10, forgetting="ydstie", memory=0.5)),
    ("outlier", 3, 50, dict(p0=1, forgetting="ydstie_trace", forget=0.9)),
    ("plain", 4, 50, dict(p0=10, forgetting="held_trace", trace=20)),
    ("plain", 3, 60, dict(p0=10, forgetting="reset", forget=0.99, trace=30)),
    ("plain", 6, 50, dict(p0=10, forgetting="directional", forget=0.9, trace=1e6)),
    ("still", 4, 60, dict(p0=10, forgetting="directional", forget=0.9, trace=1e6)),
    ("plain", 3, 60, dict(p0=10, forgetting="directional", forget=0.8, trace=10)),
    ("still", 4, 60, dict(p0=10, forgetting="bounded", forget=0.9, trace=50)),
    ("still", 3, 50, dict(p0=10, forgetting="constant", forget=0.95)),
    ("plain", 3, 40, dict(p0=10, forget=0.98, correction="pc", rate=0.15, lo=[0.1, 0, 0], hi=[0.3, 0, 0], theta=-0.5)),
    ("plain", 3, 40, dict(p0=10, forget=0.98, correction="spc", rate=0.2, lo=[0.1, 0, 0], hi=[0.3, 0, 0], theta=-0.5)),
    ("outlier", 4, 50, dict(p0=10, forget=0.98, error_most=0.05)),
    ("large", 4, 50, dict(p0=10, forget=0.98, normalise=True)),
    ("large", 4, 50, dict(p0=10, forget=0.98, normalise=True, error_most=0.1)),
    ("large", 4, 50, dict(p0=10, forgetting="ydstie", memory=0.5, normalise=True)),
]


def line(values):
    return ",".join(f"{float(v):.9g}" for v in values)


def write_rls():
    random = np.random.default_rng(SEED)
    head = "# made by tests/reference/self_tuning_reference.py"
    settings = [head, "case,n,forgetting,correction,forget,least,memory,trace,rate,error_most,normalise,p0,theta,lo,hi,samples"]
    rows = [head, "case,sample,y,error,v,trace," + ",".join(f"phi{i + 1}" for i in range(12)) + ","
            + ",".join(f"theta{i + 1}" for i in range(12))]
    for case, (kind, n, samples, given) in enumerate(CASES):
        given = dict(given)
        start = given.pop("theta", 0.0)
        rls = Rls(np.full(n, start), **given)
        settings.append(line([case, n, FORGETTING.index(rls.forgetting), CORRECTION.index(rls.correction), rls.forget, rls.least,
                              rls.memory, rls.trace, rls.rate, rls.error_most, rls.normalise, given["p0"], start, rls.lo[0],
                              rls.hi[0], samples]))
        phi, y = data(kind, n, samples, random)
        pad = np.zeros(12 - n)
        for k in range(samples):
            error = rls.step(phi[k], y[k])
            rows.append(line([case, k, y[k], error, rls.v, np.trace(rls.P), *phi[k], *pad, *rls.theta, *pad]))
    (HERE / "rls_settings.csv").write_text("\n".join(settings) + "\n")
    (HERE / "rls_cases.csv").write_text("\n".join(rows) + "\n")


ONE = dict(loops=1, form=0, way=0, weight=0, bias=0, na=1, nb=1, nc=0, delay=[[1, 0], [0, 0]], loads=0, load_delay=0, average=1,
           tau_p=0.0, tau_r=0.0, forget=0.99, p0=10.0, lo=-100.0, hi=100.0, lo2=-100.0, hi2=100.0)
ONE["lambda"] = [0.0, 0.0]
PAIR = {**ONE, "loops": 2, "delay": [[1, 1], [1, 1]]}
MD2, MD3, LATE = [[1, 2], [2, 1]], [[1, 0], [0, 1]], [[2, 3], [4, 3]]
GMV_COLUMNS = ("loops", "form", "way", "weight", "bias", "na", "nb", "nc", "delay11", "delay12", "delay21", "delay22", "loads",
               "load_delay", "average", "tau_p", "tau_r", "lambda1", "lambda2", "forget", "p0", "lo", "hi", "lo2", "hi2")
SMALL = {"lambda": [-0.1, 0.1]}

# Settings, and the steps during which the second loop is in manual. The plants: plant() below.
LOOPS = [
    ({**ONE, **SMALL}, ()),
    ({**ONE, **SMALL, "form": 1}, ()),
    ({**ONE, **SMALL, "weight": 1, "tau_p": 60.0, "tau_r": 45.0}, ()),
    ({**ONE, **SMALL, "weight": 1, "form": 1, "tau_p": 60.0, "delay": [[2, 0], [0, 0]], "na": 2, "nb": 2}, ()),
    ({**ONE, **SMALL, "bias": 1}, ()),
    ({**ONE, **SMALL, "bias": 2, "loads": 1, "load_delay": 2}, ()),
    ({**ONE, **SMALL, "form": 1, "loads": 1, "load_delay": 1, "average": 3}, ()),
    ({**ONE, **SMALL, "form": 1, "nc": 1, "delay": [[2, 0], [0, 0]]}, ()),
    ({**ONE, **SMALL, "nc": 2, "bias": 2}, ()),
    ({**ONE, **SMALL, "way": 1, "delay": [[2, 0], [0, 0]], "na": 2, "tau_p": 60.0}, ()),
    ({**ONE, **SMALL, "way": 1, "form": 1, "delay": [[3, 0], [0, 0]], "nb": 2, "tau_p": 30.0}, ()),
    ({**PAIR, **SMALL}, ()),
    ({**PAIR, **SMALL, "form": 1, "tau_p": 30.0}, range(52, 62)),
    ({**PAIR, **SMALL, "form": 1, "lo": -0.06, "hi": 0.06}, ()),
    ({**PAIR, **SMALL, "delay": MD2, "lo": -0.06, "hi": 0.06}, range(52, 62)),
    ({**PAIR, **SMALL, "form": 1, "delay": MD2, "na": 2, "nb": 2}, ()),
    ({**PAIR, **SMALL, "delay": MD3, "bias": 1, "tau_p": 30.0}, ()),
    ({**PAIR, **SMALL, "way": 1, "form": 1, "delay": LATE, "tau_p": 30.0}, ()),
    ({**PAIR, **SMALL, "way": 1, "delay": LATE, "bias": 0}, ()),
    ({**PAIR, **SMALL, "form": 1, "delay": LATE, "average": 2}, ()),
    ({**PAIR, "form": 1, "singular": 1, "p0": 1e-6, "lo": -0.5, "hi": 0.5, "lo2": -0.5, "hi2": 0.5}, ()),
    ({**PAIR, "form": 1, "singular": 1, "p0": 1e-6, "lo": -0.06, "hi": 0.06, "lo2": -0.5, "hi2": 0.5}, ()),
    ({**PAIR, **SMALL, "lo": -0.06, "hi": 0.06, "lo2": -0.04, "hi2": 0.04}, ()),
    ({**ONE, **SMALL, "form": 1, "bias": 3}, ()),
    ({**ONE, **SMALL, "form": 1, "bias": 3, "tau_p": 60.0, "delay": [[2, 0], [0, 0]], "na": 2, "nb": 2}, ()),
    ({**PAIR, **SMALL, "form": 1, "bias": 3, "delay": MD2, "tau_p": 30.0}, range(52, 62)),
    ({**ONE, **SMALL, "form": 1, "tau_p": 60.0, "tau_r": -1.0, "delay": [[2, 0], [0, 0]], "nb": 2}, ()),
    ({**PAIR, **SMALL, "tau_p": 30.0, "tau_r": -1.0}, range(52, 62)),
]
GAIN = np.array([[-0.4, 0.25], [-0.3, 0.6]])
AT_REST, STEPS = 30, 45


def begin_theta(s, i):
    """Roughly the plant's: half of a, 0.7 of the gains."""
    theta = [0.5] + [0.0] * (s["na"] - 1)
    gain = np.array([[-0.4, 0.2], [-0.4, 0.2002]]) if s.get("singular") else GAIN
    for j in (i, 1 - i):
        if j < s["loops"] and s["delay"][i][j]:
            theta += [0.7 * gain[i, j]] + [0.0] * (s["nb"] - 1)
    theta += [0.0] * (s["loads"] + s["nc"])
    return theta + ([0.0] if not s["form"] and s["bias"] < 2 else [])


def plant(s, i, y, u, load, t, e):
    """y_i(t) = 0.8 (0.7) y_i(t-1) + sum of GAIN u_j(t - k_ij) + load/2 + 0.03 + noise with c = 0.5 where it is estimated."""
    out = (0.8, 0.7)[i] * y[i][t - 1] + 0.5 * load + 0.03 + e[i][t] + (0.5 * e[i][t - 1] if s["nc"] else 0.0)
    return out + sum(GAIN[i, j] * u[j][t - s["delay"][i][j]] for j in range(s["loops"]) if s["delay"][i][j])


def closed_loop(case, s, manual, random):
    """Rows of one case: at rest at 0 for AT_REST steps, nothing learnt; then load, noise, setpoints and the law at once."""
    gmv, rows, u = Gmv(s, [begin_theta(s, i) for i in range(s["loops"])]), [], np.zeros(2)
    e = np.zeros((2, AT_REST + STEPS))
    e[:, AT_REST:] = 0.01 * random.standard_normal((2, STEPS))
    for t in range(AT_REST + STEPS):
        on = t >= AT_REST
        load = float(whole(0.1 * (on and s["loads"]) * ((t // 7) % 2)))
        w = whole([0.2 * on * ((t // 9) % 2), 0.15 * on * ((t // 14) % 2)])
        y = [float(whole(plant(s, i, gmv.y, gmv.u, load, t, e))) if on and i < s["loops"] else 0.0 for i in range(2)]
        acting = (0 if not on else 1 if s["loops"] == 1 or t in manual else 3)
        gmv.take(y, w, load)
        alone = 0
        for i in range(s["loops"]):
            gmv.learn(i, acting >> i & 1)
        if on:
            u, alone = gmv.solve(acting, [0, u[1]], [s["lo"], s["lo2"]], [s["hi"], s["hi2"]])
            u = whole(u) * (np.arange(2) < s["loops"])
        gmv.applied(u)
        theta = [list(gmv.rls[i].theta) if i < s["loops"] else [] for i in range(2)]
        if not on:
            continue
        rows.append(line([case, t, acting, *y, *w, load, *u, alone, *(x for th in theta for x in th + [0.0] * (7 - len(th)))]))
    return rows


def write_gmv():
    random = np.random.default_rng(SEED + 1)
    head = "# made by tests/reference/self_tuning_reference.py"
    settings = [head, "case," + ",".join(GMV_COLUMNS) + "," + ",".join(f"theta{i}_{p}" for i in (1, 2) for p in range(1, 8))]
    rows = [head, "case,step,acting,y1,y2,w1,w2,load,u1,u2,alone," + ",".join(f"theta{i}_{p}" for i in (1, 2) for p in range(1, 8))]
    for case, (s, manual) in enumerate(LOOPS):
        flat = {**s, **{f"delay{i + 1}{j + 1}": s["delay"][i][j] for i in range(2) for j in range(2)},
                "lambda1": s["lambda"][0], "lambda2": s["lambda"][1]}
        start = [begin_theta(s, i) if i < s["loops"] else [] for i in range(2)]
        settings.append(line([case, *(flat[c] for c in GMV_COLUMNS), *(x for th in start for x in th + [0.0] * (7 - len(th)))]))
        rows += closed_loop(case, s, manual, random)
    (HERE / "gmv_settings.csv").write_text("\n".join(settings) + "\n")
    (HERE / "gmv_cases.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    difference = check_square_root(SEED)
    assert difference < 1e-10, difference
    print(f"square-root form (A5.1) against the dense one: {difference:.1e}")
    write_rls()
    write_gmv()
