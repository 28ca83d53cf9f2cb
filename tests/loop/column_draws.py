"""Columns drawn at random, made up for tests of what a tool makes of a column's file: two to four components of constant relative
volatility, 12 to 40 stages, flows over three decades, one or two thermometers in each section. A draw whose products cannot be had is no
column; draws() leaves it out."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from reflux import simulator
from reflux.errors import UserError

KMOL_H = 1 / 3.6  # mol/s


def draw(seed: int) -> dict[str, Any]:
    r = random.Random(seed)
    stages = r.randint(12, 40)
    feed_stage = r.randint(4, stages - 5)
    names = "ABCE"[: r.choice((2, 2, 3, 3, 4))]
    volatility = [1.0]
    for _ in names[1:]:
        volatility.insert(0, volatility[0] * r.uniform(1.35, 2.6))
    boils, steep = r.uniform(330, 400), r.uniform(9.5, 11.5)  # of the heaviest: K, and B over that
    light = r.randrange(len(names) - 1)
    sizes = [r.uniform(0.5, 1) for _ in names]
    z = [size / sum(sizes) for size in sizes]
    feed = 10 ** r.uniform(0, 3)  # kmol/h
    distillate = feed * sum(z[: light + 1])
    reflux = distillate * r.uniform(1.5, 4)
    vapour = reflux + distillate
    tray = feed * 1000 / 3600 * r.uniform(15, 90)  # mol
    mass = r.random() < 0.5
    molar = sum(part * (0.05 + 0.012 * i) for i, part in enumerate(z))
    flow, unit = (reflux * molar * 1000, "kg/h") if mass else (reflux, "kmol/h")
    heat = vapour * KMOL_H * 33.0
    by_heat = r.random() < 0.7
    boilup = {"is": "heat", "unit": "kW", "hi": round(2.5 * heat, 3), "nominal": round(heat, 3)} if by_heat else {
        "is": "boilup", "unit": "kmol/h", "hi": round(2.5 * vapour, 3), "nominal": round(vapour, 3)}  # fmt: skip
    pure = [r.choice((5, 2, 1, 0.5)) for _ in range(2)]
    below = sorted(r.sample(range(2, feed_stage), min(2, feed_stage - 2)))
    above = sorted(r.sample(range(feed_stage + 1, stages - 1), min(2, stages - 2 - feed_stage)))
    others = [i for i in range(len(names)) if i != light][:-1]
    plant: dict[str, Any] = {
        "column": 1, "name": f"drawn{seed}", "title": "made up", "source": "ours: drawn at random", "tick_s": r.choice((2, 5, 10, 20)),
        "reference_vapour_pressure": [math.log(101325) + steep, steep * boils, 0],
        "components": [
            {"name": name, "relative_volatility": volatility[i], "molar_mass": 0.05 + 0.012 * i, "density": [1100, -0.9], "vaporisation_heat": 30000 + 2500 * i,
             "boiling_point": boils - 25 * (len(names) - 1 - i), "critical_temperature": boils + 170, "heat_capacity": 150 + 20 * i}
            for i, name in enumerate(names)
        ],
        "stages": stages, "feed_stage": feed_stage, "efficiency": r.choice((1, 0.8, 0.65)), "pressure_drop": r.choice((0, 5000, 15000)),
        "temperature_range": [max(200, boils - 150), boils + 160],
        "holdup": {"form": "molar", "reboiler": tray * r.uniform(8, 30), "tray": tray, "condenser": tray * r.uniform(5, 20)},
        "constants": {"pressure": {"value": 1, "unit": "atm"}},
        "inputs": [
            {"name": "R", "is": "reflux", "unit": unit, "lo": 0, "hi": round(2.5 * flow, 4), "nominal": round(flow * r.uniform(0.8, 1.3), 4)},
            {"name": "Q", "lo": 0, **boilup},
        ],
        "disturbances": [
            {"name": "F", "is": "feed", "unit": "kmol/h", "lo": 0, "hi": round(2 * feed, 4), "nominal": round(feed, 4)},
            {"name": "z", "is": "feed_fraction", "of": names[light], "unit": "%", "lo": 0, "hi": 95, "nominal": round(100 * z[light], 2)},
        ],
        "outputs": [
            {"name": f"T{s}", "is": "temperature", "stage": s, "unit": "K", "lo": round(boils - 120), "hi": round(boils + 120),
             "lag_s": r.choice((5, 20, 60)), "noise": r.choice((0.02, 0.05, 0.2))}
            for s in (*below, *above)
        ],
        "truths": [
            {"name": "xD", "is": "fraction", "of": names[light + 1], "stage": stages, "unit": "%", "lo": 0, "hi": 100},
            {"name": "xB", "is": "fraction", "of": names[light], "stage": 1, "unit": "%", "lo": 0, "hi": 100},
        ],
        "steady_state": [{"channel": "xD", "value": pure[0], "trim": "R"}, {"channel": "xB", "value": pure[1], "trim": "Q"}],
    }  # fmt: skip
    if others:
        plant["constants"]["feed_fraction"] = [{"of": names[i], "value": round(100 * z[i], 2), "unit": "%"} for i in others]
    if r.random() < 0.6:
        plant["outputs"].append({"name": "FM", "is": "feed", "unit": "kmol/h", "lo": 0, "hi": round(2 * feed, 4), "noise": 0.002 * feed})
    return plant


def draws(first_seed: int, folder: Path) -> Iterator[tuple[dict[str, Any], Path]]:
    """Columns from this seed on, with their files."""
    seed = first_seed
    while True:
        plant, file = draw(seed), folder / f"drawn{seed}.json"
        file.write_text(json.dumps(plant), encoding="utf-8")
        seed += 1
        try:
            simulator.at_rest(str(file))
        except UserError:
            continue
        yield plant, file
