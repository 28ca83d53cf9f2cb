#!/usr/bin/python3
"""Channels of the kind `derived` from their equations (firmware/kinds/derived/derived.h), in double. Inputs are exact in both formats of num_t.

  derived_forms.csv  sums, means and readings compensated for a pressure, of three inputs drawn at random: settings, inputs, value, quality, and
                     the sum of the sizes of what is added, which bounds the rounding; a value that is not usable is 0
  derived_boil.csv   the shift of the bubble point with the pressure, K: column (0 pilot, 1 splitter), stage, pressure `at` (Pa), slope and bend that
                     meet the bubble points at exp(+-0.25) times that, pressure, shift; bubble points by bisection, of the tables in
                     tests/support/composition_tables.h

usage: tests/reference/derived_reference.py
"""
import math
import random
import re
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
SEED = 20261130
SUM, MEAN, BOIL = 0, 1, 4
GOOD, UNCERTAIN, BAD, MISSING = range(4)
# Places of the compact table (firmware/model/column_table_form.h).
STAGES, COMPONENTS, PRESSURE, FIXED, ANTOINE, VALUES = 4, 5, 29, 32, 4, 19


def single(x: float) -> float:
    return float(np.float32(x))


# ---- forms ----


def draw(rng: random.Random, form: int) -> dict:
    lo = [single(rng.choice([0.0, 20.0, 273.15, 900.0]) if form != SUM or i == 2 else rng.uniform(-50, 1000)) for i in range(3)]
    hi = [single(x + rng.choice([1.0, 10.0, 150.0, 400.0])) for x in lo]
    quality = [rng.choices([GOOD, UNCERTAIN, BAD, MISSING], [10, 2, 1, 1])[0] for _ in range(3)]
    weight = [rng.choice([1.0, 0.5, 2.0, single(rng.uniform(0.01, 3.0)), 0.0]) for _ in range(3)]
    if form != MEAN:
        weight = [w * rng.choice([1, -1]) for w in weight]
    if not any(weight):
        weight[0] = 1.0
    by = rng.choice([0, 3]) if form == SUM else 3 if form == BOIL else 0
    used = sum(w != 0 for w in weight)
    return {
        "form": form, "lo": lo, "hi": hi, "weight": weight, "quality": quality,
        "fraction": [rng.randrange(-6000, 72000) / 65536 for _ in range(3)],
        "zero": single(rng.choice([0.0, rng.uniform(-20, 20)])),
        "by": by, "at": single(rng.uniform(0.5, 1.5) * (hi[2] if form == SUM else (lo[2] + hi[2]) / 2)), "power": rng.choice([1, 2]),
        "least": rng.randrange(0, used + 1) if form == MEAN else 0,
        "slope": single(rng.uniform(0.01, 0.05)) if form == BOIL else 0.0,
    }  # fmt: skip


def worst(case: dict) -> int:
    named = [q for q, w in zip(case["quality"], case["weight"]) if w]
    return max(named + ([case["quality"][case["by"] - 1]] if case["by"] else []))


def value_of(case: dict) -> tuple[float, int, float]:
    x = [lo + f * (hi - lo) for lo, hi, f in zip(case["lo"], case["hi"], case["fraction"])]
    sizes = [abs(w) * (abs(lo) + abs(f) * (hi - lo)) for w, lo, hi, f in zip(case["weight"], case["lo"], case["hi"], case["fraction"])]
    if case["form"] == MEAN:
        named = [i for i in range(3) if case["weight"][i]]
        usable = [i for i in named if case["quality"][i] <= UNCERTAIN]
        if not usable or len(usable) < (case["least"] or len(named)):
            return 0.0, worst(case), 0.0
        weights = sum(case["weight"][i] for i in usable)
        y = case["zero"] + sum(case["weight"][i] * x[i] for i in usable) / weights
        quality = max(case["quality"][i] for i in usable) if usable == named else UNCERTAIN
        return y, quality, abs(case["zero"]) + sum(sizes[i] for i in usable) / weights
    quality = worst(case)
    if quality > UNCERTAIN:
        return 0.0, quality, 0.0
    total = sum(w * v for w, v in zip(case["weight"], x))
    if case["form"] == BOIL:
        if x[2] <= 0:
            return 0.0, max(quality, BAD), 0.0
        far = math.log(x[2] / case["at"])
        near = min(max(far, -0.41), 0.41)
        y = case["zero"] + total - case["slope"] * case["at"] * near / (1 - 0.1 * near)
        return y, quality if far == near else UNCERTAIN, abs(case["zero"]) + sum(sizes) + case["slope"] * case["at"]
    divisor = 1.0
    if case["by"]:
        divisor = x[case["by"] - 1] / case["at"]
        if divisor < 0.1:
            divisor, quality = 0.1, UNCERTAIN
        divisor **= case["power"]
    return case["zero"] + total / divisor, quality, abs(case["zero"]) + sum(sizes) / divisor


def forms() -> list[str]:
    rng = random.Random(SEED)
    three = [f"{name}{i}" for name in ("lo", "hi", "weight", "fraction", "quality") for i in (1, 2, 3)]
    alone = ["zero", "by", "at", "power", "least", "slope"]
    lines = [f"# Channels computed from three inputs, seed {SEED}", "# made by tests/reference/derived_reference.py",
             ",".join(["form", *three, *alone, "value", "value_quality", "size"])]  # fmt: skip
    for n in range(360):
        case = draw(rng, (SUM, MEAN, BOIL)[n % 3])
        numbers = [case["form"], *(v for name in ("lo", "hi", "weight", "fraction", "quality") for v in case[name]), *(case[name] for name in alone)]
        lines.append(",".join([*(f"{v:.9g}" for v in numbers), *(f"{v:.12g}" for v in value_of(case))]))
    return lines


# ---- boiling ----


def table(name: str) -> list[float]:
    text = (HERE.parent / "support" / "composition_tables.h").read_text(encoding="utf-8")
    body = re.search(rf"{name}_values\[\] = \{{(.*?)\}};", text, re.S).group(1)
    return [single(float(v)) for v in re.findall(r"([-+.e\d]+)f", body)]


def bubble_point(antoine: list[list[float]], x: list[float], p: float) -> float:
    def excess(t: float) -> float:
        return sum(xj * math.exp(a - b / (c + t) + d * t + e * math.log(t) + f * t**g) for xj, (a, b, c, d, e, f, g) in zip(x, antoine)) - p

    lo, hi = 150.0, 460.0
    for _ in range(100):
        middle = (lo + hi) / 2
        lo, hi = (middle, hi) if excess(middle) < 0 else (lo, middle)
    return (lo + hi) / 2


def fit(antoine: list[list[float]], x: list[float], at: float) -> tuple[float, float]:
    """slope (K/Pa) and bend with which slope at L/(1 - bend L) is the shift at L = +-0.25."""
    low, middle, high = (bubble_point(antoine, x, at * math.exp(by)) for by in (-0.25, 0.0, 0.25))
    above, below = 1 / (high - middle), 1 / (middle - low)
    rise = 2 / (0.25 * (above + below))
    return single(rise / at), single(rise * (below - above) / 2)


def boil() -> list[str]:
    lines = ["# Shift of the bubble point with the pressure", "# made by tests/reference/derived_reference.py", "column,stage,at,slope,bend,pressure,shift"]
    for number, name in enumerate(("pilot", "splitter")):
        v = table(name)
        stages, n = int(v[STAGES]), int(v[COMPONENTS])
        antoine = [v[FIXED + j * VALUES + ANTOINE : FIXED + j * VALUES + ANTOINE + 7] for j in range(n)]
        profile = v[FIXED + n * VALUES :]
        for stage in (1, 2, stages // 2, stages - 1, stages):
            x = profile[(stage - 1) * (n - 1) : stage * (n - 1)]
            x = [*x, 1 - sum(x)]
            at = single(v[PRESSURE])
            slope, bend = fit(antoine, x, at)
            for share in (0.67, 0.75, 0.9, 0.95, 0.99, 1.0, 1.01, 1.05, 1.1, 1.3, 1.5):
                p = single(at * share)
                shift = bubble_point(antoine, x, p) - bubble_point(antoine, x, at)
                lines.append(f"{number},{stage},{at:.9g},{slope:.9g},{bend:.9g},{p:.9g},{shift:.9g}")
    return lines


def main() -> None:
    for name, lines in (("derived_forms", forms()), ("derived_boil", boil())):
        (HERE / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
