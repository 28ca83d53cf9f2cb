#!/usr/bin/python3
"""Results of columns_reference for every column file, kept for tests/unit/test_columns.py.

    tests/reference/columns_results.py [NAME ...]

writes columns_steady.csv, columns_profiles.csv and columns_steps.csv next to this file: the nominal state, and another
one with all inputs moved; the nominal state stage by stage; and the deviations of the measurements after a step of each input. With names, only these are worked out anew.
"""
import csv
import glob
import json
import os
import sys
import time

from columns_reference import Column

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
PLANTS = os.path.join(HERE, "..", "..", "host_sim", "plants")
STEADY, PROFILES, STEPS = (os.path.join(HERE, "columns_%s.csv" % what) for what in ("steady", "profiles", "steps"))
TICKS = (1, 3, 10, 50)  # when the responses are looked at
TICK = {"pilot": 120, "splitter": 600, "column-a": 300, "c3-splitter": 600, "methanol-water": 300}  # s; others 20
# Steps in % of the span: with large ones the limits on flows act.
SIZE = {"random-03": 40, "random-06": 30, "random-10": 40, "random-16": 30}  # others 5
MOVED = (0.02, -0.015, 0.03, 0.01, -0.02)  # inputs of the other state, in spans from nominal, in turn


def files():
    """{name: path} of the columns shipped and drawn."""
    paths = sorted(glob.glob(os.path.join(PLANTS, "*.json"))) + sorted(glob.glob(os.path.join(HERE, "columns", "*.json")))
    found = {}
    for path in paths:
        with open(path, encoding="utf-8") as file:
            content = json.load(file)
        if "column" in content:
            found[content["name"]] = path
    return found


def tick(name):
    return TICK.get(name, 20)


def size(name):
    return SIZE.get(name, 5)


def moved(column):
    """Inputs of the other state, of seven digits; None where a level runs away."""
    if column.levels and "none" in (column.levels["condenser"]["by"], column.levels["reboiler"]["by"]):
        return None
    inputs = {}
    for c, share in zip(column.inputs, MOVED * len(column.inputs)):
        value = column.nominal[c["name"]] + share * (c["hi"] - c["lo"])
        inputs[c["name"]] = float("%.7g" % min(max(value, c["lo"]), c["hi"]))
    return inputs


def step(column, name):
    """Next value of an input: above where there is room."""
    c = next(c for c in column.inputs if c["name"] == name)
    change = size(column.file["name"]) / 100 * (c["hi"] - c["lo"])
    at = column.nominal[name]
    return at + change if at + change <= c["hi"] else at - change


def profile(column):
    """As --profile has it: stage, K, mol/s down and up, mol, mole fractions of the liquid and of the vapour leaving."""
    s = column.evaluate(column.start, column.nominal)
    return [[column.file["name"], i + 1] + ["%.12g" % v for v in (s.t[i], s.down[i], s.up[i], s.moles[i], *s.x[i], *s.v[i])]
            for i in range(column.n)]


def again(name):
    """A column at its nominal state as kept, found without a search."""
    column = Column(files()[name], nominal=False)
    for row in kept(STEADY):
        if row[:2] == [name, "nominal"] and row[2] in column.nominal:
            column.nominal[row[2]] = float(row[3])
    stages = [[float(v) for v in row[2:]] for row in kept(PROFILES) if row[0] == name]
    for goal in column.file.get("steady_state", []):  # a constant that is trimmed is the flow there
        if goal["trim"] in column.fixed:
            unit = next(c["unit"] for c in column.constants if c["is"] == goal["trim"])
            end = -1 if goal["trim"] == "reflux" else 0
            colder = column.plain(column.drive(column.nominal)[0].get("reflux_subcooling", (0.0, "K")))
            per = column.per_mole(unit, np.array(stages[end][4:4 + column.parts]), stages[end][0] - colder)
            column.fixed[goal["trim"]] = float("%.7g" % (stages[end][1 if end else 2] * per))
    column.rest_at(np.array([row[4:3 + column.parts] for row in stages]).ravel())
    return column


def work(column):
    name = column.file["name"]
    measured = [c["name"] for c in column.file["outputs"]]
    base = column.values(column.start, column.nominal)
    steady = [[name, "nominal", k, "%.12g" % v] for k, v in (column.nominal | base).items()]
    other = moved(column)
    if other:
        state = column.steady(other, column.start)
        steady += [[name, "moved", k, "%.12g" % v] for k, v in (other | column.values(state, other)).items()]
    steps = []
    for c in column.inputs:
        values = column.nominal | {c["name"]: step(column, c["name"])}
        times = [k * tick(name) for k in TICKS]
        for k, state in zip(times, column.integrate(column.start, values, times, rtol=1e-8, atol=1e-11)):
            after = column.values(state, values)
            steps.append([name, c["name"], k] + ["%.9g" % (after[m] - base[m]) for m in measured])
    return steady, profile(column), steps


def kept(path):
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8", newline="") as file:
        return [row for row in csv.reader(file) if not row[0].startswith("#")]


def write(path, head, rows):
    with open(path, "w", encoding="utf-8", newline="") as file:
        file.write("# made by tests/reference/columns_results.py\n# " + head + "\n")
        csv.writer(file, lineterminator="\n").writerows(rows)


def main():
    found = files()
    order = list(found)
    for name in sys.argv[1:] or order:
        began = time.time()
        new = work(Column(found[name]))
        for path, rows, head in ((STEADY, new[0], "column,state,channel,value"),
                                 (PROFILES, new[1], "column,stage,K,mol/s down,mol/s up,mol,mole fractions of the liquid and of the vapour leaving"),
                                 (STEPS, new[2], "column,input,s after its step,deviations of the measurements in their order")):
            rows = [row for row in kept(path) if row[0] in found and row[0] != name] + rows
            write(path, head, sorted(rows, key=lambda row: order.index(row[0])))
        print(name, "%.1f s" % (time.time() - began), flush=True)


if __name__ == "__main__":
    main()
