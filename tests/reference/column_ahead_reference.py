"""References for what the kind `ahead` predicts (firmware/kinds/ahead/column_ahead_model.h): the pilot column an interval later, integrated to
1e-9 by an independent model in double precision (columns_reference).

    build/host/reflux-sim --table --plant pilot > lines.txt
    python3 tests/reference/column_ahead_reference.py lines.txt > tests/reference/column_ahead.csv

A line a case: reflux (m3/s), heat that is put in (W), feed (m3/s), its mole fraction, the twelve states, then the temperatures of the end trays
30 s later (K). States are where 10 to 30 min of random inputs lead.
"""

import sys

from state_ahead import Model  # before numpy

import numpy as np

CASES, SEED, INTERVAL_S = 60, 18, 30.0
TOP, BOTTOM = 10, 1  # stages from 0
LITRE_AN_HOUR = 1e-3 / 3600


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        model = Model(file.read().splitlines(), INTERVAL_S, ("reflux", "heat"), (LITRE_AN_HOUR, 1000.0), LITRE_AN_HOUR, np.array([TOP, BOTTOM]))
    random = np.random.default_rng(SEED)

    def drawn():
        told = {"reflux": random.uniform(1, 9) * LITRE_AN_HOUR, "heat": random.uniform(400.0, 1250.0), "feed": random.uniform(3.5, 6.5) * LITRE_AN_HOUR}
        return told, random.uniform(0.25, 0.6)

    def carried(x, told, z, seconds):
        model.filter.tell_feed(z)
        return model.column.integrate(x, model.table.nominal | told, [seconds])[-1]

    print(f"# by column_ahead_reference.py, seed {SEED}")
    print("reflux,heat,feed,z," + ",".join(f"x{s}" for s in range(1, 13)) + ",top,bottom")
    for _ in range(CASES):
        x = carried(model.profile, *drawn(), random.uniform(600, 1800))
        told, z = drawn()
        t = model.column.evaluate(carried(x, told, z, INTERVAL_S) + 0j, model.table.nominal | told).t.real
        print(",".join(f"{v:.9g}" for v in (told["reflux"], told["heat"], told["feed"], z, *x, t[TOP], t[BOTTOM])))


if __name__ == "__main__":
    main()
