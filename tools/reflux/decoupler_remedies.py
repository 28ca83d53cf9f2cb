"""What to do where tools/decouple has no polynomial decoupler: other designs of the same plant are tried, and those that there are named."""

from __future__ import annotations

import argparse
import math

import numpy as np

from reflux import decoupling, libreflux, sampled_plant
from reflux.errors import RunFailed, UserError
from reflux.sampled_plant import SampledPlant

FACTORS = (1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 1 / 1.5, 1 / 2, 1 / 3, 1 / 4, 1 / 5, 1 / 7, 1 / 10)  # of the period
ZERO_MOST = 10.0  # a zero that far out is worth no decoupler
ROUND_UP = 1.05


def found(spanned: SampledPlant, bounds: dict[str, float], options: argparse.Namespace, why: str) -> str:
    """A clause behind the refusal `why`; nothing where the model itself is wrong. bounds: of the design, as given."""
    if not any(word in why for word in ("determinant", "zero", "element")) or why.startswith(tuple(bounds)):
        return ""
    ways = [*_period(bounds, options), *_zero(spanned, bounds), *_static(spanned)]
    if ways:
        return f"; there is one with {' or '.join(ways)}"
    again = "identify again with another period" if options.period is None else "neither has another period one"
    return f"; --method static and partial have none either, and {again}; decouple fewer pairs (--pairs)"


def designs(plant: SampledPlant, bounds: dict[str, float]) -> bool:
    try:
        decoupling.polynomial(plant.a, plant.b, plant.period, **bounds)
    except libreflux.Refused:
        return False
    return True


def _period(bounds: dict[str, float], options: argparse.Namespace) -> list[str]:
    """The nearest one, of a continuous plant alone; a whole number of ticks, where the tick is given."""
    if options.period is None:
        return []
    for factor in sorted(FACTORS, key=lambda f: abs(math.log(f))):
        period = float(f"{factor * options.period:.3g}")
        if options.tick is not None and abs(round(period / options.tick) * options.tick - period) > 1e-3 * options.tick:
            continue
        try:
            plant = sampled_plant.read(options.model, options.pairs, period)
            if options.spans:
                plant = sampled_plant.with_spans(plant, options.spans)
        except (UserError, RunFailed):
            continue
        if designs(plant.in_spans(), bounds):
            return [f"--period {period:g}"]
    return []


def _zero(spanned: SampledPlant, bounds: dict[str, float]) -> list[str]:
    """A bound that lets the outermost zero in, where that alone is in the way."""
    try:
        outermost = decoupling.polynomial(spanned.a, spanned.b, spanned.period, **{**bounds, "zero_hi": ZERO_MOST}).outermost
    except libreflux.Refused:
        return []
    return [f"--zero-hi {ROUND_UP * outermost:.3g} (the zero stays in every loop)"]


def _static(spanned: SampledPlant) -> list[str]:
    if np.any(spanned.integrates()):
        return []
    gains, pairs = spanned.gains(), [(i, i) for i in range(spanned.n)]
    try:
        libreflux.decoupler(libreflux.Plant(gains), pairs)
        return ["--method static"]
    except libreflux.Refused:
        pass
    try:
        decoupling.partial(gains, 0.5)
        return ["--method partial --factor 0.5"]
    except libreflux.Refused:
        return []
