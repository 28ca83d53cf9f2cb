"""Reference tables for the tests of num, signal, design and control, in double precision.

    /usr/bin/python3 tests/reference/control_reference.py          writes the tables beside this script
    /usr/bin/python3 tests/reference/control_reference.py --check  compares them with the committed ones

Written from the equations, not from the firmware: the derivative here is the state-space form of the filter,
the firmware's is the washout recursion; the continuous responses are closed forms.
"""
import argparse
import fractions
import io
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent


def table(name, columns, rows):
    out = io.StringIO()
    out.write(f"# {name}: written by tests/reference/control_reference.py (numpy, float64); do not edit\n")
    out.write(",".join(columns) + "\n")
    for row in rows:
        out.write(",".join(f"{v:.17g}" if isinstance(v, float) else str(v) for v in row) + "\n")
    return out.getvalue()


def num_operations():
    """a, b exact in Q7.24 and in float32; the products and quotients rounded once, to double."""
    rng = np.random.default_rng(20240501)
    rows = []
    for i in range(400):
        scale = 2.0 ** rng.integers(-12, 4)
        a, b = (float(np.round(v * 2**20) / 2**20) for v in rng.uniform(-scale, scale, 2))
        if abs(b) < 2**-14:
            continue
        fa, fb = fractions.Fraction(a), fractions.Fraction(b)
        rows.append((a, b, float(fa * fb), float(fa / fb)))
    return table("num_operations", ["a", "b", "product", "quotient"], rows)


def signal_response():
    """Continuous step responses, from rest, of 1/(Ts+1) and (Ts_lead+1)/(Ts_lag+1) at t; and of the
    filtered derivative Td s/(Tf s+1) with Td = 2 Tf to a unit ramp of slope 1/T."""
    rows = []
    T, lead, lag = 60.0, 90.0, 30.0
    for t in np.arange(0.0, 301.0, 10.0):
        rows.append((float(t),
                     float(1 - np.exp(-t / T)),
                     float(1 + (lead / lag - 1) * np.exp(-t / lag)),
                     float(2 * 20.0 / T * (1 - np.exp(-t / 20.0)))))
    return table("signal_response", ["t", "lag", "lead_lag", "washout"], rows)


def tuning():
    rows = []
    for k in (0.3, -2.0, 25.0):
        for T in (2.0, 60.0, 3600.0):
            for ratio in (0.05, 0.3, 1.0, 3.0):
                L = ratio * T
                rho = L / T
                cc_pi = (abs((0.9 + rho / 12) / (k * rho)), L * (30 + 3 * rho) / (9 + 20 * rho))
                cc_pid = (abs((4 / 3 + rho / 4) / (k * rho)), L * (32 + 6 * rho) / (13 + 8 * rho),
                          4 * L / (11 + 2 * rho))
                tc = 1.5 * L
                T2 = 0.4 * T
                kc, ti = T / (abs(k) * (tc + L)), min(T, 4 * (tc + L))
                # the series controller kc (1 + 1/(ti s))(T2 s + 1) multiplied out
                ideal = (kc * (ti + T2) / ti, ti + T2, ti * T2 / (ti + T2))
                rows.append((k, L, T, tc, T2, *cc_pi, *cc_pid, kc, ti, *ideal))
    names = ["k", "theta", "t", "tc", "t2", "ccpi_k", "ccpi_ti", "ccpid_k", "ccpid_ti", "ccpid_td",
             "simc_k", "simc_ti", "simcpid_k", "simcpid_ti", "simcpid_td"]
    return table("tuning", names, rows)


CASE_FIELDS = ["id", "gain", "ti", "td", "n", "b", "c", "tt", "lo", "hi", "direct", "velocity", "h", "steps",
               "stride", "kp", "tp", "delay", "r0", "r1", "u0", "load"]
CASES = [
    # PI, setpoint step and load step, unsaturated
    dict(gain=2.0, ti=60.0, delay=10, kp=1.0),
    # PID, setpoint weight, derivative on the measurement only; the output saturates on the setpoint step
    dict(gain=4.0, ti=30.0, td=4.0, b=0.7, hi=0.62, delay=6, kp=1.0),
    # direct acting, velocity algorithm, saturating
    dict(gain=3.0, ti=50.0, direct=1, velocity=1, hi=0.8, lo=0.25, delay=4, kp=-0.8),
    # full two-degree-of-freedom PID, positional, own tracking time
    dict(gain=2.5, ti=40.0, td=5.0, n=5.0, b=0.5, c=0.3, tt=12.0, hi=0.7, delay=5, kp=1.2),
    # half an hour of 0.05 s ticks with an hour-long integral time
    dict(gain=1.5, ti=3600.0, td=20.0, h=0.05, steps=36000, stride=600, tp=600.0, delay=40, kp=1.5),
]


def complete(case, i):
    full = dict(id=i, gain=1.0, ti=0.0, td=0.0, n=8.0, b=1.0, c=0.0, tt=0.0, lo=0.0, hi=1.0, direct=0,
                velocity=0, h=1.0, steps=900, stride=5, kp=1.0, tp=60.0, delay=10, r0=0.4, r1=0.55, u0=0.45,
                load=0.08)
    full.update(case)
    return full


def closed_loop(p):
    """r0 -> r1 after a tenth of the run, load at the plant input after half of it."""
    h, s = p["h"], -1.0 if p["direct"] else 1.0
    sk = s * p["gain"]
    tf = p["td"] / p["n"]
    tt = p["tt"] or (np.sqrt(p["ti"] * p["td"]) if p["td"] else p["ti"])
    track = min(1.0, h / tt)
    decay = np.exp(-h / p["tp"])
    line = [p["u0"]] * (p["delay"] + 1)
    y, r = p["r0"], p["r0"]
    slow = p["c"] * r - y                                # filtered derivative input
    integral = p["u0"] - sk * (p["b"] * r - y)
    u_whole, last_p, last_d = p["u0"], p["b"] * r - y, 0.0
    rows = []
    for k in range(p["steps"]):
        r = p["r1"] if k >= p["steps"] // 10 else p["r0"]
        load = p["load"] if k >= p["steps"] // 2 else 0.0
        prop, v = p["b"] * r - y, p["c"] * r - y
        d = 0.0
        if p["td"]:
            slow += h / (tf + h) * (v - slow)
            d = sk * p["n"] * (v - slow)
        if p["velocity"]:
            raw = u_whole + sk * (prop - last_p) + d - last_d
        else:
            raw = sk * prop + integral + d
        u = min(max(raw, p["lo"]), p["hi"])
        if k % p["stride"] == 0:
            rows.append((p["id"], k, y, u))
        increment = sk * h / p["ti"] * (r - y) if p["ti"] else 0.0
        u_whole = u + increment
        integral += increment + track * (u - raw)
        last_p, last_d = prop, d
        line = [u + load] + line[:-1]
        target = p["r0"] + p["kp"] * (line[-1] - p["u0"])
        y = target + decay * (y - target)
    return rows


def pid_tables():
    cases = [complete(c, i) for i, c in enumerate(CASES)]
    rows = [row for c in cases for row in closed_loop(c)]
    return (table("pid_cases", CASE_FIELDS, [[c[f] for f in CASE_FIELDS] for c in cases]),
            table("pid_trajectories", ["id", "k", "y", "u"], rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare with the committed tables, write nothing")
    check = parser.parse_args().check
    cases, trajectories = pid_tables()
    tables = {"num_operations": num_operations(), "signal_response": signal_response(), "tuning": tuning(),
              "pid_cases": cases, "pid_trajectories": trajectories}
    differing = 0
    for name, text in tables.items():
        path = HERE / f"{name}.csv"
        if check:
            if path.read_text() != text:
                print(f"{path.name} differs from what this script computes")
                differing += 1
        else:
            path.write_text(text)
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
