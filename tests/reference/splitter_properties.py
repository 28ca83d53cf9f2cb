"""Property constants of the C3-C4 splitter's six components, from public handbook tables.

    python3 -m venv properties && properties/bin/pip install chemicals==1.5.2
    properties/bin/python tests/reference/splitter_properties.py

Prints the components that stand in host_sim/plants/splitter.json, and how well they fit. The PyPI package `chemicals` carries the tables of
Perry's Chemical Engineers' Handbook, 8th edition; it is needed only to run this script again.

Vapour pressures are the handbook's equation itself. Liquid densities and heats of vaporisation are fitted
to the handbook's equations over the working range in the simpler forms of the model, because a component
above its critical temperature has neither: see the notes printed with them.
"""
import csv
import math
import os

import chemicals

# Name, CAS number, range (K) of the density and of the heat of vaporisation: where the component is a
# liquid and matters in this column; for the heat of butane, which is most of it, the stripping section.
COMPONENTS = (
    ("C2", "74-84-0", (240.0, 280.0), (240.0, 280.0)),
    ("C3", "74-98-6", (300.0, 350.0), (300.0, 330.0)),
    ("iC4", "75-28-5", (300.0, 365.0), (364.0, 378.0)),
    ("iC5", "78-78-4", (300.0, 365.0), (300.0, 365.0)),
    ("nC5", "109-66-0", (300.0, 365.0), (300.0, 365.0)),
    ("nC4", "106-97-8", (300.0, 365.0), (364.0, 378.0)),
)
HIGHEST = 440.0  # K, the column's temperature_max: every constant must be usable up to here
STANDARD = 288.71  # K, 60 degF
CAPACITY = 320.0  # K, the feed's temperature


def table(folder, name):
    """Rows of one of the package's tables by CAS number."""
    path = os.path.join(os.path.dirname(chemicals.__file__), folder, name)
    with open(path, encoding="utf-8") as file:
        return {row["CAS"]: row for row in csv.DictReader(file, delimiter="\t")}


PRESSURE = table("Vapor Pressure", "Table 2-8 Vapor Pressure of Inorganic and Organic Liquids.tsv")
DENSITY = table("Density", "Perry Parameters 105.tsv")
VAPORISATION = table("Phase Change", "Table 2-150 Heats of Vaporization of Inorganic and Organic Liquids.tsv")
CAPACITY_100 = table("Heat Capacity", "Perry_Table_2-153_DIPPR_100.tsv")
CAPACITY_114 = table("Heat Capacity", "Perry_Table_2-153_DIPPR_114.tsv")


def numbers(row, *keys):
    return [float(row[k]) for k in keys]


def density(cas, t):
    """DIPPR equation 105, kg/m3 (the table is in mol/m3, without the handbook's factor 1000)."""
    a, b, c, d = numbers(DENSITY[cas], "C1", "C2", "C3", "C4")
    return a / b ** (1 + (1 - t / c) ** d) * chemicals.MW(cas) / 1000


def vaporisation(cas, t):
    """DIPPR equation 106, J/mol."""
    row = VAPORISATION[cas]
    tc, a, b, c, d = numbers(row, "Tc", "C1", "C2", "C3", "C4")
    tr = t / tc
    return a * (1 - tr) ** (b + c * tr + d * tr * tr)


def capacity(cas, t):
    """Liquid heat capacity, J/(mol K), DIPPR equations 100 and 114, not beyond the end of the table."""
    if cas in CAPACITY_100:
        row = CAPACITY_100[cas]
        t = min(t, float(row["Tmax"]))
        return sum(k * t**i for i, k in enumerate(numbers(row, *"ABCDE"))) / 1000, t
    row = CAPACITY_114[cas]
    t = min(t, float(row["Tmax"]))
    a, b, c, d = numbers(row, *"ABCD")
    u = 1 - t / float(DENSITY[cas]["C3"])
    value = (a * a / u + b - 2 * a * c * u - a * d * u**2 - c * c * u**3 / 3 - c * d * u**4 / 2
             - d * d * u**5 / 5)
    return value / 1000, t


def grid(lo, hi):
    return [lo + (hi - lo) * i / 100 for i in range(101)]


def line(cas, lo, hi):
    """Least-squares line through the density: intercept, slope, worst relative error."""
    t = grid(lo, hi)
    r = [density(cas, ti) for ti in t]
    tm, rm = sum(t) / len(t), sum(r) / len(r)
    slope = sum((a - tm) * (b - rm) for a, b in zip(t, r)) / sum((a - tm) ** 2 for a in t)
    intercept = rm - slope * tm
    worst = max(abs((intercept + slope * a) / b - 1) for a, b in zip(t, r))
    return round(intercept, 3), round(slope, 6), worst


def watson(cas, lo, hi):
    """Heat at the middle of the range and the parameter of Watson's rule that fits the rest best."""
    middle = 0.5 * (lo + hi)
    heat = vaporisation(cas, middle)
    t = grid(lo, hi)

    def worst(tc):
        return max(abs(heat * ((tc - a) / (tc - middle)) ** 0.38 / vaporisation(cas, a) - 1) for a in t)

    best = min((HIGHEST + 1 + 0.1 * i for i in range(600)), key=worst)
    return round(heat, 1), middle, round(best, 2), worst(best)


def main():
    print("All from Perry's Chemical Engineers' Handbook, 8th edition, as carried by the PyPI package chemicals 1.5.2:")
    print("vapour_pressure    table 2-8, DIPPR equation 101 as it stands, used beyond the critical temperature too")
    print("density            DIPPR equation 105, straight line over the range named; ethane, which is above its")
    print("                   critical temperature here, keeps its density at 60 degF (%.2f K)" % STANDARD)
    print("vaporisation_heat, boiling_point, critical_temperature   table 2-150. The model's Watson rule must hold")
    print("                   up to %g K for every component, so the three are its parameters, no physical" % HIGHEST)
    print("                   constants: the handbook's heat at the middle of the range named (\"boiling_point\"),")
    print("                   and the \"critical temperature\", at least %g K, that fits the range best" % (HIGHEST + 1))
    print("heat_capacity      table 2-153 at %g K, or at the end of the table below that" % CAPACITY)
    print("molar_mass         standard atomic weights")
    for name, cas, liquid, vapour in COMPONENTS:
        c1, c2, c3, c4, c5 = numbers(PRESSURE[cas], "C1", "C2", "C3", "C4", "C5")
        tc = float(VAPORISATION[cas]["Tc"])
        if tc < 310:
            intercept, slope = round(density(cas, STANDARD), 3), 0.0
            fit = "density constant"
        else:
            intercept, slope, worst = line(cas, *liquid)
            fit = "density over %g to %g K within %.1f %%" % (*liquid, 100 * worst)
        heat, at, parameter, worst = watson(cas, *vapour)
        cp, cp_at = capacity(cas, CAPACITY)
        assert intercept + slope * HIGHEST > 50 and math.isfinite(cp)
        print("# CAS %s, truly critical at %g K; %s," % (cas, tc, fit))
        print("# heat over %g to %g K within %.1f %%, heat capacity at %g K" % (*vapour, 100 * worst, cp_at))
        print('{"name": "%s", "vapour_pressure": [%.9g, %.9g, 0, 0, %.9g, %.9g, %.9g],' % (name, c1, -c2, c3, c4, c5))
        print(' "molar_mass": %.8g, "density": [%.8g, %.8g],' % (chemicals.MW(cas) / 1000, intercept, slope))
        print(' "vaporisation_heat": %.6g, "boiling_point": %.5g, "critical_temperature": %.5g, "heat_capacity": %.4g}'
              % (heat, at, parameter, cp))


if __name__ == "__main__":
    main()
