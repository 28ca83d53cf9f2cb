#!/usr/bin/python3
"""Steady-state gains of the columns' measured temperatures and the pairings that follow from them.

    tests/reference/column_pairing.py

writes next to this file

  column_gains.csv     plant, output, input, gain: K per unit of the input, D - C A^-1 B by complex steps
  column_pairing.csv   plant, output, input, relative gain: the pairing of least sum of |ln|, none negative; of the
                       outputs, more than the two inputs can hold, the assignment leaves over those that pair worst

for the plants `pilot` and `splitter` at their nominal steady states, for `pilot-2x2` with Folami's two temperatures alone,
and for `splitter-ss2`, which is `splitter` at its second published steady state (R 32.2787 m3/h, Q 2804.458 Mcal/h). The
steady states are those of pilot_reference.py and splitter_reference.py, the derivatives those of complex_step.py, numpy
and scipy; nothing of the C sources is called. Spans are those of the plants' channels.
"""
import os

import numpy as np
from scipy.optimize import linear_sum_assignment

import complex_step
import pilot_reference as pilot
import splitter_reference as splitter

HERE = os.path.dirname(os.path.abspath(__file__))
SPLITTER_STAGES = (1, 5, 7, 12, 17, 19, 23, 27, 30, 31, 33, 34, 37)
PILOT_TRAYS = (1, 2, 7, 9, 10)


def gains(plant, x, values, inputs, outputs):
    a, b, c, d = complex_step.PLANTS[plant].derivatives(x, values, inputs, outputs)
    return d - c @ np.linalg.solve(a, b)


def splitter_case(values, x):
    fractions = dict(zip(complex_step.FRACTIONS, values["z"]))
    u = {name: values[name] for name in ("R", "Q", "F", "TF")} | fractions | {"dTr": 5.0, "P": 17.0}
    return gains("splitter", x, u, ("R", "Q"), ["T%d" % s for s in SPLITTER_STAGES])


def pilot_case():
    x = pilot.steady(pilot.NOMINAL, pilot.start())
    return gains("pilot", x, pilot.NOMINAL, ("Lr", "Qrb"), ["T%d" % k for k in PILOT_TRAYS])


def assignment(k):
    """[(output, input, relative gain)] in the non-square relative gains of gains in spans."""
    rga = k * np.linalg.pinv(k).T
    cost = np.where(rga > 0.0, np.abs(np.log(np.maximum(rga, 1e-9))), 1e3)
    return [(i, j, float(rga[i, j])) for i, j in zip(*linear_sum_assignment(cost))]


def main():
    first = splitter.steady(splitter.NOMINAL, splitter.start())
    second = splitter.steady(splitter.SS2, first)
    trays = ["T%d" % k for k in PILOT_TRAYS]
    stages = ["T%d" % k for k in SPLITTER_STAGES]
    column = pilot_case()
    cases = (("pilot", trays, ("Lr", "Qrb"), column, 60.0, (12.0, 1.5)),
             ("pilot-2x2", ["T1", "T10"], ("Lr", "Qrb"), column[[0, 4]], 60.0, (12.0, 1.5)),
             ("splitter", stages, ("R", "Q"), splitter_case(splitter.NOMINAL, first), 120.0, (120.0, 6000.0)),
             ("splitter-ss2", stages, ("R", "Q"), splitter_case(splitter.SS2, second), 120.0, (120.0, 6000.0)))
    head = "# made by tests/reference/column_pairing.py\n"
    with open(os.path.join(HERE, "column_gains.csv"), "w", encoding="utf-8") as file:
        file.write("# Steady-state gains of the columns\n" + head + "plant,output,input,gain\n")
        for name, outputs, inputs, g, _, _ in cases:
            for i, y in enumerate(outputs):
                for j, u in enumerate(inputs):
                    file.write(f"{name},{y},{u},{g[i, j]:.9g}\n")
    with open(os.path.join(HERE, "column_pairing.csv"), "w", encoding="utf-8") as file:
        file.write("# Pairings of the columns: RGA of the gains in spans, least sum of |ln|, none negative\n" + head +
                   "plant,output,input,relative_gain\n")
        for name, outputs, inputs, g, span, spans in cases:
            for i, j, r in assignment(g * np.array(spans) / span):
                file.write(f"{name},{outputs[i]},{inputs[j]},{r:.6g}\n")
                print(name, outputs[i], inputs[j], r)


if __name__ == "__main__":
    main()
