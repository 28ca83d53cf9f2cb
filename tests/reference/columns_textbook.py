#!/usr/bin/python3
"""The textbook columns: published figures beside those of their files, by the independent model.

    tests/reference/columns_textbook.py

prints the table of columns-textbook.md (tests/unit/test_columns.py holds them together).
"""
import json
import os

from columns_reference import Column, gains, relative_gains

import numpy as np

PLANTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "host_sim", "plants")
MINUTE = 60.0
# K. Kurihara et al., J. Chem. Eng. Data 40 (1995) 679, methanol and water at 333.15 K: x and y of methanol, kPa.
KURIHARA = ((0.0, 0.0, 19.953), (0.1686, 0.5714, 39.223), (0.2167, 0.6268, 42.984), (0.3039, 0.6943, 48.852),
            (0.3681, 0.7345, 52.784), (0.4461, 0.7742, 56.652), (0.5282, 0.8085, 60.614), (0.6804, 0.8733, 67.924),
            (0.7255, 0.8922, 70.229), (0.7776, 0.9141, 72.832), (1.0, 1.0, 84.562))


def read(name):
    with open(os.path.join(PLANTS, name + ".json"), encoding="utf-8") as file:
        return json.load(file)


def twin(file):
    """An LV file as DV: the drum's level moves the reflux, and the distillate is the input."""
    file = json.loads(json.dumps(file))
    reflux = next(c for c in file["inputs"] if c["is"] == "reflux")
    file["inputs"].remove(reflux)
    file["inputs"].insert(0, {"name": "D", "is": "distillate", "unit": reflux["unit"], "lo": 0, "hi": 2, "safe": 0.5})
    file["truths"] = [t for t in file["truths"] if t["name"] != "D"]
    file["levels"]["condenser"]["by"] = "reflux"
    file["constants"]["reflux"] = {"value": reflux["nominal"], "unit": reflux["unit"]}
    for goal in file["steady_state"]:
        goal["trim"] = "reflux" if goal["trim"] == reflux["name"] else goal["trim"]
    return file


def products(column):
    """Gains of xD and xB by the two inputs."""
    names = [c["name"] for c in column.outputs]
    k = gains(*column.linearise())
    return k[[names.index("xD"), names.index("xB")]][:, :2]


def slowest(column):
    return -1 / np.max(np.linalg.eigvals(column.linearise()[0]).real) / MINUTE


def rows():
    """(column, quantity, published, ours)"""
    lv = Column(read("column-a"))
    dv = Column(twin(read("column-a")))
    k, d = 100 * products(lv), 100 * products(dv)
    out = [("column-a", "reflux, kmol/min", "2.70629", "%.6f" % lv.nominal["L"]),
           ("column-a", "boil-up, kmol/min", "3.20629", "%.6f" % lv.nominal["V"]),
           ("column-a", "slowest time constant, LV, min", "193.9", "%.1f" % slowest(lv)),
           ("column-a", "gains of xD and xB by L and V, in 0.01 per kmol/min", "87.8, -86.4; 108.2, -109.6", "%.1f, %.1f; %.1f, %.1f" % tuple(k.ravel())),
           ("column-a", "relative gain, LV", "35.1", "%.1f" % relative_gains(k)[0, 0]),
           ("column-a", "condition number, LV", "141.7", "%.1f" % np.linalg.cond(k)),
           ("column-a", "gains by D and V", "-87.8, 1.4; -108.2, -1.4", "%.1f, %.1f; %.1f, %.1f" % tuple(d.ravel())),
           ("column-a", "relative gain, DV", "0.45", "%.2f" % relative_gains(d)[0, 0])]
    # xD of this file is propane, in %
    c = Column(read("c3-splitter"))
    reflux = c.fixed["reflux"]
    out += [("c3-splitter", "reflux, kmol/min", "11.8615732", "%.7g" % reflux),
            ("c3-splitter", "boil-up, kmol/min", "12.476099", "%.7g" % c.nominal["V"]),
            ("c3-splitter", "distillate, kmol/min", "0.614525139", "%.6g" % c.nominal["D"]),
            ("c3-splitter", "slowest time constant, DV, min", "", "%.0f" % slowest(c)),
            ("c3-splitter", "relative gain, DV", "", "%.3f" % relative_gains(products(c))[0, 0])]
    m = Column(read("methanol-water"))
    pressures, fractions = [], []
    for x, y, p in KURIHARA:
        at = np.array([x, 1 - x])
        partial = at * m.mixture.partial(at, 333.15)
        pressures.append(abs(partial.sum() / 1e3 / p - 1))
        fractions.append(abs(partial[0] / partial.sum() - y))
    seen = m.values(m.start, m.nominal)
    s = m.evaluate(m.start, m.nominal)
    out += [("methanol-water", "pressures at 333.15 K, 11 compositions", "19.953 to 84.562 kPa", "at most %.1f %% off" % (100 * max(pressures))),
            ("methanol-water", "methanol in their vapours", "0 to 1", "at most %.3f off" % max(fractions)),
            ("methanol-water", "reflux ratio in moles", "", "%.2f" % (s.reflux / s.distillate)),
            ("methanol-water", "reboiler duty, MW", "", "%.2f" % seen["Qb"]),
            ("methanol-water", "relative gain", "", "%.2f" % relative_gains(products(m))[0, 0])]
    return out


def table():
    lines = ["| column | quantity | published | ours |", "|---|---|---|---|"]
    return lines + ["| " + " | ".join(r) + " |" for r in rows()]


if __name__ == "__main__":
    print("\n".join(table()))
