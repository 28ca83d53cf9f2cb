"""Property constants of the pilot column's two components, from public handbook tables.

    python3 -m venv properties && properties/bin/pip install chemicals==1.5.2
    properties/bin/python tests/reference/pilot_properties.py

Prints the components that stand in host_sim/plants/pilot.json, and how well they fit. The PyPI package `chemicals` carries the tables; it
is needed only to run this script again. Nothing is fitted except the liquid density, a straight line
through the handbook's equation.
"""
import csv
import os

import chemicals

COMPONENTS = (("TCE", "79-01-6"), ("PCE", "127-18-4"))
DENSITY_RANGE = (290.0, 400.0)  # K


def table(folder, name):
    """Rows of one of the package's tables by CAS number."""
    path = os.path.join(os.path.dirname(chemicals.__file__), folder, name)
    with open(path, encoding="utf-8") as file:
        return {row["CAS"]: row for row in csv.DictReader(file, delimiter="\t")}


ANTOINE = table("Vapor Pressure", "Landolt_antoine_V20.tsv")
WAGNER = table("Vapor Pressure", "VDI PPDS Boiling temperatures at different pressures.tsv")
DENSITY = table("Density", "VDI PPDS Density of Saturated Liquids.tsv")
VAPORISATION = table("Phase Change", "CRC Handbook Heat of Vaporization.tsv")
THERMO = table("Heat Capacity", "CRC Standard Thermodynamic Properties of Chemical Substances.tsv")


def density(row, temperature):
    """VDI Heat Atlas equation for the density of the saturated liquid, kg/m3."""
    tau = 1 - temperature / float(row["Tc"])
    powers = (("A", 0.35), ("B", 2 / 3), ("C", 1.0), ("D", 4 / 3))
    return float(row["rhoc"]) + sum(float(row[k]) * tau**p for k, p in powers)


def line(row):
    """Least-squares line through the density over DENSITY_RANGE: intercept, slope, worst relative error."""
    lo, hi = DENSITY_RANGE
    t = [lo + (hi - lo) * i / 110 for i in range(111)]
    r = [density(row, ti) for ti in t]
    tm, rm = sum(t) / len(t), sum(r) / len(r)
    slope = sum((a - tm) * (b - rm) for a, b in zip(t, r)) / sum((a - tm) ** 2 for a in t)
    intercept = rm - slope * tm
    worst = max(abs((intercept + slope * a) / b - 1) for a, b in zip(t, r))
    return round(intercept, 3), round(slope, 6), worst


def main():
    print("vapour_pressure    Landolt-Boernstein, Vapor Pressure of Chemicals, volume IV/20: ln(P/Pa), K")
    print("density            VDI Heat Atlas (PPDS) equation, straight line over %g to %g K" % DENSITY_RANGE)
    print("vaporisation_heat, boiling_point   CRC Handbook of Chemistry and Physics, Enthalpy of Vaporization")
    print("critical_temperature               VDI Heat Atlas (PPDS)")
    print("heat_capacity      CRC Handbook, Standard Thermodynamic Properties, liquid at 298.15 K")
    print("molar_mass         standard atomic weights")
    for name, cas in COMPONENTS:
        antoine, heat = ANTOINE[cas], VAPORISATION[cas]
        intercept, slope, worst = line(DENSITY[cas])
        print("# CAS %s; Antoine data from %s to %s K; density line within %.2f %%"
              % (cas, antoine["Tmin"], antoine["Tmax"], 100 * worst))
        print('{"name": "%s", "vapour_pressure": [%.9g, %.9g, %.6g], "molar_mass": %.8g, "density": [%.8g, %.8g],'
              % (name, *(float(antoine[k]) for k in "ABC"), chemicals.MW(cas) / 1000, intercept, slope))
        print(' "vaporisation_heat": %.7g, "boiling_point": %.5g, "critical_temperature": %.5g, "heat_capacity": %.4g}'
              % (float(heat["HvapTb"]), float(heat["Tb"]), float(WAGNER[cas]["Tc"]), float(THERMO[cas]["Cpl"])))


if __name__ == "__main__":
    main()
