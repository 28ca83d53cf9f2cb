#!/usr/bin/python3
"""References for firmware/identify/relay.[ch] and the settings made of it (design/tuning.h).

relay.csv: the limit cycle that an ideal relay of amplitude d with hysteresis +-eps makes of
    exp(-L s)/((T1 s + 1)(T2 s + 1)(T3 s + 1)), lags of 0 left out,
exactly: each partial fraction c/(T s + 1) answers a square wave of half period tau, up from 0 on, by
    c d (1 - 2 exp(-t/T)/(1 + exp(-tau/T))), 0 <= t < tau, and its negative in the other half,
and tau is such that the output is -eps on its way down when the input turns up.
    columns: T1, T2, T3, L, d, eps; period, peak; gain by the describing function 4 d/(pi sqrt(peak^2 - eps^2));
    -1/Re G at that frequency; the true ultimate gain and period (G = -1/Ku)

relay_family.csv: PI by Tyreus and Luyben on 1/(T s + 1) exp(-L s), L/T over the family that the trial of relay settings is
    bounded for: after a setpoint step of 1 the integral of |e| over Pu, the overshoot, the time after which |e| stays within
    5 %, over Pu, the largest input over Ku, and the mean error between 9 and 12 Pu (the last quarter of such a trial).

usage: tests/reference/relay_reference.py
"""
import numpy as np
from scipy.optimize import brentq

from interact_reference import table

PLANTS = [((10, 0, 0), 1.0), ((10, 0, 0), 3.0), ((10, 0, 0), 10.0), ((10, 0, 0), 30.0), ((10, 4, 0), 0.5),
          ((10, 4, 0), 6.0), ((10, 7, 3), 0.0), ((10, 7, 3), 4.0), ((40, 3, 1), 0.2)]
FAMILY = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)


def parts(lags):
    lags = [t for t in lags if t > 0]
    return [(np.prod([t / (t - q) for q in lags if q != t]), t) for t in lags]


def output(lags, dead, tau, t):
    """At t after the input has turned up, d = 1."""
    t = np.asarray(t, float) - dead
    turns = np.floor(t / tau)
    t, sign = t - turns * tau, np.where(turns % 2, -1.0, 1.0)
    return sign * sum(c * (1 - 2 * np.exp(-t / T) / (1 + np.exp(-tau / T))) for c, T in parts(lags))


def G(lags, dead, w):
    s = 1j * w
    return np.exp(-dead * s) / np.prod([T * s + 1 for T in lags if T > 0])


def ultimate(lags, dead):
    phase = lambda w: -dead * w - sum(np.arctan(T * w) for T in lags if T > 0) + np.pi
    w = brentq(phase, 1e-6, 1e3)
    return 1 / abs(G(lags, dead, w)), 2 * np.pi / w


def cycle(lags, dead, d, eps):
    """The longest half period at which the output is at -eps, on its way down: the one a relay at rest comes to."""
    _, pu = ultimate(lags, dead)
    taus = np.geomspace(3.0 * pu, 0.3 * pu, 4000)
    at = np.array([d * output(lags, dead, tau, 0.0) + eps for tau in taus])
    k = np.nonzero((at[:-1] < 0) & (at[1:] >= 0))[0][0]
    tau = brentq(lambda x: d * output(lags, dead, x, 0.0) + eps, taus[k + 1], taus[k], xtol=1e-13)
    peak = np.abs(d * output(lags, dead, tau, np.linspace(0, tau, 200001))).max()
    w = np.pi / tau
    return 2 * tau, peak, 4 * d / (np.pi * np.sqrt(peak**2 - eps**2)), -1 / G(lags, dead, w).real


def cycles():
    for lags, dead in PLANTS:
        for eps in (0.0005, 0.005):
            d = 0.1
            yield [*lags, dead, d, eps, *cycle(lags, dead, d, eps), *ultimate(lags, dead)]


def step(ratio):
    """T = 1, sampled finely: e after a step of the setpoint of 1."""
    ku, pu = ultimate((1.0,), ratio)
    gain, ti = ku / 3.2, 2.2 * pu
    h = ratio / 200
    n = int(60 * pu / h)
    y, u, total, late = 0.0, np.zeros(n + 201), 0.0, 200
    e, decay = np.zeros(n), np.exp(-h)
    for k in range(n):
        e[k] = 1 - y
        u[k + late] = gain * (e[k] + total / ti)
        total += h * e[k]
        y = decay * y + (1 - decay) * u[k]
    outside = np.nonzero(np.abs(e) > 0.05)[0][-1] + 1
    late = abs(e[int(9 * pu / h):int(12 * pu / h)].mean())
    return [ratio, np.abs(e).sum() * h / pu, max(0.0, -e.min()), outside * h / pu, u.max() / ku, late]


def line(values):
    return ",".join(f"{x:.12g}" for x in values)


if __name__ == "__main__":
    table("relay.csv", "t1,t2,t3,dead,d,eps,period,peak,described,gain,ku,pu", [line(r) for r in cycles()],
          "Exact limit cycles under a relay with hysteresis, and the true ultimate gains and periods", "relay_reference")
    table("relay_family.csv", "dead,iae,overshoot,settled,moved,left", [line(step(r)) for r in FAMILY],
          "Setpoint steps of PI by Tyreus and Luyben on exp(-dead s)/(s + 1), in Pu and Ku", "relay_reference")
