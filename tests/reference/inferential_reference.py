#!/usr/bin/python3
"""Composition control from tray temperatures worked out apart from the firmware, from docs/methods/inferential.md alone, in double.

  /usr/bin/python3 tests/reference/inferential_reference.py          checks itself and writes the tables beside this script
  /usr/bin/python3 tests/reference/inferential_reference.py --check  checks itself and compares them with the committed ones

inferential_settings.csv   a row for each closed loop: case and COMMON, then PER_LOOP of each of two loops. EU and hours; rate is in
                           spans of the MV per hour; t1, t2, u are where everything has been at rest before the first step. The
                           plants: dT/dt = a u + cross u_other + load, integrated exactly, u from the lower end of its span
inferential_cases.csv      case, step, then of each loop COURSE; setpoint and loads hold from this row to the next (`every` steps later)
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from inferential_checks import all_checks
from inferential_laws import CASCADE, CLF, CONVENTIONAL, EULER, HOLD, JOINT, Loop

HERE = Path(__file__).resolve().parent
SEED = 20101123
COMMON = ("loops", "form", "ts", "every", "rows", "seconds")
PER_LOOP = (
    "law",
    "second",
    "a1",
    "a2",
    "kc",
    "kc2",
    "ko",
    "pv_lo",
    "pv_hi",
    "s_lo",
    "s_hi",
    "mv_lo",
    "mv_hi",
    "lim_lo",
    "lim_hi",
    "rate",
    "t1",
    "t2",
    "u",
    "cross1",
    "cross2",
)
COURSE = ("setpoint", "load1", "load2", "t1", "t2", "out", "applied", "b1", "b2", "e2", "ut")

# By reflux, m3/h: enriching section of a column. By heat, MW: stripping section.
REFLUX = dict(
    law=CONVENTIONAL,
    second=0,
    a1=-0.625,
    a2=-0.3125,
    kc=2.0,
    kc2=4.0,
    ko=20.0,
    pv_lo=300.0,
    pv_hi=340.0,
    s_lo=310.0,
    s_hi=330.0,
    mv_lo=0.0,
    mv_hi=80.0,
    lim_lo=0.0,
    lim_hi=80.0,
    rate=0.0,
    t1=320.25,
    t2=317.5,
    u=35.0,
    cross1=0.0,
    cross2=0.0,
)
HEAT = dict(
    law=CONVENTIONAL,
    second=0,
    a1=12.5,
    a2=20.0,
    kc=4.0,
    kc2=8.0,
    ko=20.0,
    pv_lo=340.0,
    pv_hi=370.0,
    s_lo=340.0,
    s_hi=380.0,
    mv_lo=1.0,
    mv_hi=5.0,
    lim_lo=1.0,
    lim_hi=5.0,
    rate=0.0,
    t1=357.0,
    t2=353.0,
    u=1.75,
    cross1=0.0,
    cross2=0.0,
)
SLOW = dict(kc=0.1, kc2=0.2, ko=1.0)

# Form, seconds of a step, steps of a row, rows; loops; by row: {what of which loop: what is added to it}.
CASES = [
    (EULER, 10, 9, 80, [REFLUX], {5: {"load1.0": 8.0}, 40: {"setpoint.0": -1.5}, 60: {"load1.0": -12.0}}),
    (JOINT, 300, 1, 80, [REFLUX], {5: {"load1.0": 4.0}, 40: {"setpoint.0": -1.5}, 60: {"load1.0": -6.0}}),
    (EULER, 20, 6, 120, [{**REFLUX, "lim_lo": 30.0, "lim_hi": 40.0}], {5: {"load1.0": 5.0}, 35: {"load1.0": -5.0}}),
    (
        EULER,
        10,
        9,
        80,
        [{**REFLUX, "law": CASCADE}],
        {5: {"load1.0": 8.0, "load2.0": 3.0}, 40: {"setpoint.0": 1.0}, 60: {"load2.0": -2.0}},
    ),
    (JOINT, 300, 1, 90, [{**REFLUX, "law": CASCADE}], {5: {"load1.0": 4.0, "load2.0": 2.5}, 50: {"setpoint.0": 1.0}}),
    (
        EULER,
        30,
        4,
        90,
        [{**REFLUX, "law": CASCADE, "lim_lo": 30.0, "lim_hi": 40.0}],
        {5: {"load1.0": 6.0, "load2.0": 4.0}, 40: {"load1.0": -6.0, "load2.0": -4.0}, 65: {"setpoint.0": 1.0}},
    ),
    (
        EULER,
        10,
        9,
        80,
        [{**HEAT, "law": CLF}],
        {5: {"load1.0": -8.0, "load2.0": -10.0}, 40: {"setpoint.0": 1.0}, 60: {"load2.0": 3.0}},
    ),
    (
        JOINT,
        120,
        1,
        120,
        [{**HEAT, "law": CLF}],
        {5: {"load1.0": -8.0, "load2.0": -10.0}, 60: {"setpoint.0": 1.0}, 90: {"load2.0": 3.0}},
    ),
    (
        JOINT,
        60,
        2,
        120,
        [{**HEAT, "law": CLF, "lim_lo": 2.5, "lim_hi": 3.25}],
        {5: {"load1.0": -12.0, "load2.0": -15.0}, 50: {"load1.0": 12.0, "load2.0": 15.0}, 80: {"setpoint.0": -1.0}},
    ),
    (
        EULER,
        30,
        4,
        90,
        [
            {**REFLUX, "law": CASCADE, "cross1": 6.0, "cross2": 3.0},
            {**HEAT, "law": CLF, "cross1": -0.125, "cross2": -0.25},
        ],
        {5: {"load1.0": 5.0, "load2.0": 4.0}, 30: {"load1.1": -6.0, "load2.1": -9.0}, 60: {"setpoint.1": 0.5}},
    ),
    (
        JOINT,
        60,
        2,
        90,
        [
            {**REFLUX, "cross1": 6.0},
            {**HEAT, "law": CASCADE, "second": 1, "rate": 6.0, "cross1": -0.125, "cross2": -0.25},
        ],
        {5: {"load1.0": 5.0, "load2.0": 2.0}, 30: {"load1.1": -8.0, "load2.1": -11.0}, 60: {"setpoint.0": 0.5}},
    ),
    (EULER, 1, 300, 140, [{**REFLUX, **SLOW}], {5: {"load1.0": 0.25}, 70: {"setpoint.0": -1.0}}),
    (
        JOINT,
        1,
        300,
        140,
        [{**HEAT, **SLOW, "law": CLF}],
        {5: {"load1.0": -0.25, "load2.0": -0.375}, 70: {"setpoint.0": -1.0}},
    ),
    (
        EULER,
        30,
        4,
        60,
        [{**REFLUX, "law": HOLD}, {**HEAT, "law": CASCADE}],
        {5: {"load1.1": -6.0, "load2.1": -9.0}, 30: {"setpoint.0": 2.0}},
    ),
    (
        JOINT,
        10,
        9,
        60,
        [{**REFLUX, "law": CLF, "rate": 1.5}],
        {5: {"load1.0": 6.0, "load2.0": 4.0}, 30: {"setpoint.0": 2.0}},
    ),
    (
        EULER,
        30,
        4,
        90,
        [{**HEAT, "law": CLF, "lim_lo": 2.5, "lim_hi": 3.25}],
        {5: {"load1.0": -10.0, "load2.0": -12.0}, 45: {"load1.0": 10.0, "load2.0": 12.0}},
    ),
]


def line(values):
    return ",".join(f"{float(v):.10g}" for v in values)


class Course:
    """One closed loop of a case: plant, limits and law."""

    def __init__(self, s, form, h):
        self.s, self.h, self.width = s, h, s["mv_hi"] - s["mv_lo"]
        self.law = (
            None
            if s["law"] == HOLD
            else Loop(s["law"], form, h, (s["a1"], s["a2"]), s["kc"], s["kc2"], s["ko"], self.width)
        )
        self.t, self.applied, self.out = [s["t1"], s["t2"]], s["u"], s["u"]
        self.given = {"setpoint": s["t1"], "load1": 0.0, "load2": 0.0}

    def begin(self, other):
        """Rest: the loads make up for both MVs."""
        for i in (0, 1):
            self.given[f"load{i + 1}"] -= self.s[f"a{i + 1}"] * self.applied + self.s[f"cross{i + 1}"] * other
        if self.law:
            self.law.rest(*self.t, self.applied)

    def step(self):
        s = self.s
        if self.law:
            self.out = self.law.step(*self.t, self.given["setpoint"])
        most = s["rate"] * self.width * self.h if s["rate"] else np.inf
        us = min(max(self.out, s["lim_lo"] - s["mv_lo"]), s["lim_hi"] - s["mv_lo"])
        self.before, self.applied = self.applied, min(max(us, self.applied - most), self.applied + most)

    def row(self):
        inner = [self.law.b1, self.law.b2, self.law.e2, self.law.ut] if self.law else [0.0] * 4
        return [*self.given.values(), *self.t, self.out, self.applied, *inner]

    def go_on(self, other):
        if self.law:
            self.law.took_effect(self.applied)
        for i in (0, 1):
            s = self.s
            self.t[i] += self.h * (
                s[f"a{i + 1}"] * self.applied + s[f"cross{i + 1}"] * other + self.given[f"load{i + 1}"]
            )


def course(case, form, ts, every, rows, loops, events):
    loops = [Course(s, form, ts / 3600) for s in loops]
    for i, c in enumerate(loops):
        c.begin(loops[1 - i].applied if len(loops) > 1 else 0.0)
    for k in range(every * rows):
        if k % every == 0:
            for what, much in events.get(k // every, {}).items():
                loops[int(what[-1])].given[what[:-2]] += much
        for c in loops:
            c.step()
        if k % every == 0:
            yield line([case, k, *(x for c in loops for x in c.row()), *[0.0] * (len(COURSE) * (2 - len(loops)))])
        for i, c in enumerate(loops):
            c.go_on(loops[1 - i].applied if len(loops) > 1 else 0.0)


def tables():
    head = "# made by tests/reference/inferential_reference.py"
    settings = [head, ",".join(("case", *COMMON, *(f"{p}_{i}" for i in (1, 2) for p in PER_LOOP)))]
    cases = [head, ",".join(("case", "step", *(f"{c}_{i}" for i in (1, 2) for c in COURSE)))]
    for case, (form, ts, every, rows, loops, events) in enumerate(CASES):
        # Without a secondary temperature where none is wanted; second = 1: the other loop goes without.
        seconds = 1 if any(s["second"] for s in loops) else len(loops) if any(s["law"] >= CASCADE for s in loops) else 0
        padded = [*loops, *[dict.fromkeys(PER_LOOP, 0.0)] * (2 - len(loops))]
        settings.append(
            line([case, len(loops), form, ts, every, rows, seconds, *(s[p] for s in padded for p in PER_LOOP)])
        )
        cases += course(case, form, ts, every, rows, loops, events)
    return {"inferential_settings.csv": settings, "inferential_cases.csv": cases}


def numbers(text):
    return np.array([[float(v) for v in row.split(",")] for row in text if row[0] not in "#c"])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--check", action="store_true", help="compare with the committed tables")
    check = parser.parse_args().check
    all_checks(SEED)
    for name, rows in tables().items():
        if not check:
            (HERE / name).write_text("\n".join(rows) + "\n")
            continue
        kept, now = numbers((HERE / name).read_text().splitlines()), numbers(rows)
        if kept.shape != now.shape or np.abs(kept - now).max() > 1e-6:
            sys.exit(f"{name} is not what this script makes")
    print("tables", "as committed" if check else "written")


if __name__ == "__main__":
    main()
