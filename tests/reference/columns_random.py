#!/usr/bin/python3
"""Twenty small columns of all kinds that docs/use/columns.md knows, made from a fixed seed.

    tests/reference/columns_random.py

writes tests/reference/columns/random-NN.json. Every column has one steady state with two products, by the reference;
what has none or two is drawn again. The main kinds go round in turn, so that all of them occur; the rest is drawn.
"""
import json
import os

from columns_mixture import FRACTION, POWER
from columns_reference import Column

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
FOLDER = os.path.join(HERE, "columns")
SEED, COUNT = 12, 20
FORMS = ("molar", "conservative", "molar", "volumetric", "molar")
LEVELS = (None, ("distillate", "bottoms"), ("reflux", "bottoms"), ("distillate", "boilup"), ("reflux", "boilup"), ("none", "none"))
LETTERS = "abcd"


def digits(value, n=4):
    return float("%.*g" % (n, value))


def component(rng, name, boiling, dippr):
    slope = rng.uniform(0.030, 0.040)  # of ln P at the boiling point
    if dippr:
        e, f, g = -5.5, 1e-5, 2
        b = digits((slope - e / boiling - g * f * boiling) * boiling ** 2, 6)
        curve = [digits(np.log(101325) + b / boiling - e * np.log(boiling) - f * boiling ** g, 7), b, 0, 0, e, f, g]
    else:
        c = digits(rng.uniform(-60, -30))
        b = digits(slope * (boiling + c) ** 2, 6)
        curve = [digits(np.log(101325) + b / (boiling + c), 7), b, c]
    return {"name": name, "vapour_pressure": curve, "molar_mass": digits(rng.uniform(0.02, 0.15)),
            "density": [digits(rng.uniform(900, 1400)), digits(rng.uniform(-1.4, -0.5))] if rng.random() < 0.7 else digits(rng.uniform(600, 1100)),
            "vaporisation_heat": digits(rng.uniform(25e3, 40e3)), "boiling_point": digits(boiling),
            "critical_temperature": digits(max(boiling * rng.uniform(1.45, 1.65), 505)), "heat_capacity": digits(rng.uniform(80, 250))}


def activity(rng, kind, n):
    def table(size):
        t = np.round(rng.uniform(-size, size, (n, n)), 3)
        np.fill_diagonal(t, 0.0)
        return t.tolist()

    if kind == "wilson":
        return {"model": "wilson", "a": table(0.3)} | ({"b": table(80)} if rng.random() < 0.7 else {})
    alpha = np.round(rng.uniform(0.2, 0.47, (n, n)), 3)
    alpha = np.triu(alpha, 1)
    return {"model": "nrtl", "a": table(0.3), "b": table(100), "alpha": (alpha + alpha.T).tolist()}


def channel(name, kind, unit, nominal, span, **more):
    return {"name": name, "is": kind, "unit": unit, "lo": 0, "hi": digits(span, 2), "nominal": digits(nominal)} | more


def feed_fractions(rng, names):
    """Channels and constants, of every component or of all but one, by mole or by mass."""
    z = rng.dirichlet(np.full(len(names), 4.0))
    unit = str(rng.choice(["-", "%", "%w"]))
    all_but_one = rng.random() < 0.5
    given = list(range(len(names)))
    if all_but_one:
        given.remove(int(rng.integers(len(names))))
    channels, constants = [], []
    for j in given:
        value = digits(z[j] / FRACTION[unit], 3)
        if rng.random() < 0.7:
            channels.append({"name": "z" + names[j], "is": "feed_fraction", "of": names[j], "unit": unit, "lo": 0,
                             "hi": 1 / FRACTION[unit], "nominal": value})
        else:
            constants.append({"of": names[j], "value": value, "unit": unit})
    return channels, constants


def draw(rng, i):
    n, parts = int(rng.integers(4, 16)), int(rng.integers(2, 5))
    names = list(LETTERS[:parts])
    form = FORMS[i % len(FORMS)]
    moving = form == "molar"
    levels = LEVELS[(i * 3 // 5) % len(LEVELS)] if moving else None
    by_volatility = i % 4 == 1
    heat = i % 2 == 0 and not (levels and levels[1] == "boilup")
    boiling = 310.0 + np.sort(rng.uniform(0, 80, parts))
    boiling += 10.0 * np.arange(parts)
    f = {"column": 1, "name": "random-%02d" % i, "title": "a small column drawn at random", "source": "tests/reference/columns_random.py",
         "ours": "everything", "tick_s": 20.0}
    f["components"] = [component(rng, name, t, rng.random() < 0.3) for name, t in zip(names, boiling)]
    if by_volatility:
        f["reference_vapour_pressure"] = f["components"][-1]["vapour_pressure"]
        a = np.round(np.cumprod(np.concatenate([[1.0], rng.uniform(1.4, 2.5, parts - 1)]))[::-1], 3)
        for c, v in zip(f["components"], a):
            del c["vapour_pressure"]
            c["relative_volatility"] = float(v)
    kind = (None, "wilson", "nrtl")[int(rng.integers(3))]
    if kind:
        f["activity"] = activity(rng, kind, parts)
    f |= {"stages": n, "feed_stage": int(rng.integers(2, n - 1)), "efficiency": digits(rng.choice([1.0, rng.uniform(0.5, 1.0)]), 3),
          "pressure_drop": digits(rng.uniform(0, 800)) * n, "temperature_range": [240, 500]}
    if rng.random() < 0.3:
        f["limit_softness"] = digits(rng.uniform(0.005, 0.1), 2)

    feed = digits(10 ** rng.uniform(-1, 2))
    times = [rng.uniform(300, 1500), rng.uniform(10, 60), rng.uniform(200, 900)]
    scale = 1.0 if form == "molar" else 1e-4
    f["holdup"] = dict(zip(("reboiler", "tray", "condenser"), (digits(t * feed * scale) for t in times))) | {"form": form}
    if form != "molar":
        f["holdup"]["temperatures"] = [digits(boiling[-1] - 5, 3), digits(boiling[0] + 5, 3)]
    if moving and rng.random() < 0.6:
        f["holdup"]["hydraulics"] = {"time": digits(rng.uniform(3, 20), 2), "vapour": digits(rng.choice([0.0, rng.uniform(-0.3, 0.8)]), 2)}
    if levels:
        f["levels"] = {"capacity": digits(rng.uniform(1.5, 3), 2)} | {
            end: {"by": by} | ({} if by == "none" else {"gain": digits(rng.uniform(0.003, 0.02), 2)})
            for end, by in zip(("condenser", "reboiler"), levels)}

    # Flows: a boil-up of 1.5 to 3 times the feed, of which part goes out as distillate
    boilup, out = feed * rng.uniform(1.5, 3), feed * rng.uniform(0.35, 0.65)
    quality = digits(rng.uniform(0.2, 1.2), 3)
    by_quality = rng.random() < 0.5
    above = boilup + (feed * (1 - quality) if by_quality else 0.0)
    reflux = above - out
    volume = 1.0e-4  # m3/mol, roughly
    flow_unit = str(rng.choice(["mol/s", "kmol/h", "kg/h", "l/h"]))
    per = {"mol/s": 1.0, "kmol/h": 3.6, "kg/h": 3600 * np.mean([c["molar_mass"] for c in f["components"]]), "l/h": 3.6e6 * volume}
    feed_unit = str(rng.choice(["mol/min", "kg/h"] if by_quality else ["mol/min", "kg/h", "l/h"]))
    per_feed = per | {"mol/min": 60.0}
    inputs, disturbances, constants = [], [], {}
    if levels and levels[0] == "reflux":
        constants["reflux"] = {"value": digits(reflux * per[flow_unit]), "unit": flow_unit}
    else:
        inputs.append(channel("R", "reflux", flow_unit, reflux * per[flow_unit], 2 * reflux * per[flow_unit], slew=0))
    if heat:
        unit = str(rng.choice(["kW", "Mcal/h", "MJ/h"]))
        power = boilup * 31e3 / POWER[unit]
        inputs.append(channel("Q", "heat", unit, power, 2 * power))
        if rng.random() < 0.5:
            disturbances.append(channel("Ql", "heat_loss", unit, 0.05 * power, 0.3 * power))
    elif levels and levels[1] == "boilup":
        constants["boilup"] = {"value": digits(boilup), "unit": "mol/s"}
    else:
        inputs.append(channel("V", "boilup", "kmol/h", 3.6 * boilup, 7.2 * boilup))
    if levels and levels[0] in ("reflux", "none"):
        inputs.append({"name": "D", "is": "distillate", "unit": flow_unit, "lo": 0, "hi": digits(2 * feed * per[flow_unit], 2)})
    if levels and levels[1] in ("boilup", "none"):
        inputs.append({"name": "B", "is": "bottoms", "unit": "kmol/h", "lo": 0, "hi": digits(7.2 * feed, 2)})
    disturbances.append(channel("F", "feed", feed_unit, feed * per_feed[feed_unit], 2 * feed * per_feed[feed_unit]))
    channels, fixed = feed_fractions(rng, names)
    disturbances += channels
    if fixed:
        constants["feed_fraction"] = fixed
    if by_quality:
        disturbances.append(channel("q", "feed_quality", "-", quality, 1.5))
    else:
        disturbances.append(channel("TF", "feed_temperature", "degC", boiling.mean() - 273.15 - rng.uniform(0, 40), 150))
    if rng.random() < 0.6:
        disturbances.append(channel("dT", "reflux_subcooling", "K", rng.uniform(0, 20), 40))
    if rng.random() < 0.5:
        disturbances.append(channel("P", "pressure", "kPa", rng.uniform(80, 140), 200, lo=50))
    else:
        constants["pressure"] = {"value": digits(rng.uniform(0.8, 1.5), 3), "unit": "bar"}
    f |= {"constants": constants, "inputs": inputs, "disturbances": disturbances}
    f["outputs"], f["truths"] = seen(rng, n, names, form, levels)
    return f


def seen(rng, n, names, form, levels):
    mid = n // 2 + 1
    outputs = [{"is": "temperature", "stage": s, "unit": u} for s, u in ((1, "K"), (mid, "degC"), (n - 1, "K"))]
    outputs += [{"is": "temperature", "stages": [2, mid, n], "unit": "K"}, {"is": "temperature_difference", "stages": [1, mid], "unit": "K"},
                {"is": "fraction", "of": names[0], "stage": 1, "unit": str(rng.choice(["-", "%", "ppm", "%w"]))},
                {"is": "fraction", "of": names[:-1], "stages": [n, n - 1], "unit": "%w"},
                {"is": "log_fraction", "of": names[-1], "stage": n, "unit": "-"},
                {"is": "vapour_fraction", "of": names[0], "stage": mid, "unit": "%"}]
    truths = [{"is": "distillate", "unit": "kg/h"}, {"is": "bottoms", "unit": "l/h"}, {"is": "reflux", "unit": "kmol/h"},
              {"is": "boilup", "unit": "mol/s"}, {"is": "liquid_flow", "stage": 2, "unit": "mol/s"},
              {"is": "vapour_flow", "stage": n - 1, "unit": "mol/h"}, {"is": "heat", "unit": "kW"},
              {"is": "level", "stage": 2, "unit": "mol"}]
    if levels:
        outputs += [{"is": "level", "stage": 1, "unit": "%"}, {"is": "level", "stage": n, "unit": "mol"}]
    spans = {"temperature": (200, 600), "temperature_difference": (-200, 200), "log_fraction": (-30, 30)}
    for k, o in enumerate(outputs + truths):
        o["name"] = "y%d" % k
        o["lo"], o["hi"] = spans.get(o["is"], (0, 1 / FRACTION[o["unit"]] if o["unit"] in FRACTION and o["is"] != "level" else 1e7))
    return outputs, truths


def trimmed(f, column):
    """A steady state to be met, near the one there is: the upper temperature by the reflux."""
    value = digits(column.values(column.start, column.nominal)["y2"] + 0.2, 6)
    trim = "R" if any(c["name"] == "R" for c in f["inputs"]) else "reflux"
    return f | {"steady_state": [{"channel": "y2", "value": value, "trim": trim}]}


def alone(column):
    """True if the nominal state is reached from a column full of the lightest and of the heaviest component as well."""
    nominal = column.start[:column.n * (column.parts - 1)]
    for most in (0, column.parts - 1):
        full = np.full((column.n, column.parts), 0.1 / (column.parts - 1))
        full[:, most] = 0.9
        other = column.steady(column.nominal, full[:, :-1].ravel(), perfect=True)
        if np.max(np.abs(other - nominal)) > 1e-8:
            return False
    return True


def text(f):
    """JSON with a line for each component and channel."""
    lines = []
    for key, value in f.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            value = "[\n%s\n ]" % ",\n".join("  " + json.dumps(v) for v in value)
        else:
            value = json.dumps(value)
        lines.append(" %s: %s" % (json.dumps(key), value))
    return "{\n%s\n}\n" % ",\n".join(lines)


def main():
    os.makedirs(FOLDER, exist_ok=True)
    rng = np.random.default_rng(SEED)
    for i in range(COUNT):
        for attempt in range(100):
            f = draw(rng, i)
            try:
                column = Column(json.loads(json.dumps(f)))
                if i % 3 == 2:
                    f = trimmed(f, column)
                    column = Column(json.loads(json.dumps(f)))
            except (ArithmeticError, ValueError, np.linalg.LinAlgError):
                continue
            s = column.evaluate(column.start, column.nominal)
            share = s.distillate / s.feed
            try:
                if 0.15 < share < 0.85 and s.x[-1].max() < 1 - 1e-9 and alone(column):
                    break
            except ArithmeticError:
                continue
        with open(os.path.join(FOLDER, f["name"] + ".json"), "w", encoding="utf-8") as file:
            file.write(text(f))
        print(f["name"], "after", attempt + 1, "draws:", f["stages"], "stages,", len(f["components"]), "components, D/F %.3f" % share)


if __name__ == "__main__":
    main()
