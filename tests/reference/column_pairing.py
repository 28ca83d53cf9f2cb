#!/usr/bin/python3
"""Steady-state gains of the columns' measured temperatures and the pairings that follow from them.

    tests/reference/column_pairing.py

writes next to this file

  column_gains.csv     plant, output, input, gain: K per unit of the input, by central differences of steady states
  column_pairing.csv   plant, output, input, relative gain: as linear_pairing.csv (see linear_reference.py); of the
                       outputs, more than the two inputs can hold, the assignment leaves over those that pair worst

for the plants `pilot` and `splitter` at their nominal steady states, for `pilot-2x2` with Folami's two temperatures alone,
and for `splitter-ss2`, which is `splitter` at its second published steady state (R 32.2787 m3/h, Q 2804.458 Mcal/h). The
models are those of pilot_reference.py and
splitter_reference.py, numpy and scipy; nothing of the C sources is called. Spans are those of the plants' channels.
"""
import os

import numpy as np
from scipy.optimize import fsolve

import pilot_reference as pilot
import splitter_reference as splitter
from linear_reference import assignment

HERE = os.path.dirname(os.path.abspath(__file__))
SPLITTER_STAGES = (1, 5, 7, 12, 17, 19, 23, 27, 30, 31, 33, 34, 37)
PILOT_TRAYS = (1, 2, 7, 9, 10)


def gains(steady, outputs, values, x, names):
    """Columns over the inputs; steps of 1e-4 of the value."""
    columns = []
    for name in names:
        h = 1e-4 * values[name]
        ends = [dict(values, **{name: values[name] + sign * h}) for sign in (1, -1)]
        above, below = (outputs(steady(v, x), v) for v in ends)
        columns.append((above - below) / (2 * h))
    return np.array(columns).T


def near(values, x):
    """Steady state of the splitter near another one."""
    u = splitter.drive(values)
    x, info, _, message = fsolve(lambda y: 3600 * splitter.COLUMN.evaluate(y, u)[0], x, xtol=1e-13, full_output=True)
    assert np.abs(info["fvec"]).max() < 1e-8, message
    return x


def splitter_case(values, x):
    return gains(near, lambda y, v: splitter.COLUMN.evaluate(y, splitter.drive(v))[1][np.array(SPLITTER_STAGES) - 1],
                 values, x, ("R", "Q"))


def pilot_case():
    x = pilot.steady(pilot.NOMINAL, pilot.start())
    return gains(pilot.steady, lambda y, v: pilot.trays(y, v)[np.array(PILOT_TRAYS) - 1], pilot.NOMINAL, x, ("Lr", "Qrb"))


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
