"""What to do where tools/decouple has no polynomial decoupler, or no controllers for its loops: other designs of the same plant are tried, and
those that work are named."""

from __future__ import annotations

import argparse
import math
from typing import NamedTuple

import numpy as np

from reflux import decoupled_loops, decoupling, libreflux, sampled_plant
from reflux.decoupled_loops import Compensator
from reflux.errors import RunFailed, UserError
from reflux.sampled_plant import SampledPlant

FACTORS = (1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 1 / 1.5, 1 / 2, 1 / 3, 1 / 4, 1 / 5, 1 / 7, 1 / 10)  # of the period
ZERO_MOST = 10.0  # a zero that far out is worth no decoupler
ROUND_UP = 1.05
SENSITIVITY_MOST = 3.0  # of a loop that is worth naming


class Goal(NamedTuple):
    """What --loops pp asks of the controllers."""

    overshoot: float
    settling: list[float]
    observer: float
    condition_hi: float | None


def found(spanned: SampledPlant, bounds: dict[str, float], options: argparse.Namespace, why: str, goal: Goal | None) -> str:
    """A clause behind the refusal `why`; nothing where the model itself is wrong. bounds: of the design, as given. goal: None without --loops pp."""
    if not any(word in why for word in ("determinant", "zero", "element")) or why.startswith(tuple(bounds)):
        return ""
    ways = [*_period(bounds, options, goal), *_zero(spanned, bounds, goal), *_static(spanned, goal)]
    if ways:
        return f"; there {'are controllers' if goal else 'is one'} with {' or '.join(ways)}"
    if goal:
        return _none_closes(spanned)
    again = "identify again with another period" if options.period is None else "neither has another period one"
    return f"; --method static and partial have none either, and {again}; decouple fewer pairs (--pairs)"


def for_loops(spanned: SampledPlant, goal: Goal) -> str:
    """A clause behind the refusal of controllers for the loops."""
    ways = _static(spanned, goal)
    return f"; there are controllers with {' or '.join(ways)}" if ways else _none_closes(spanned)


def _none_closes(spanned: SampledPlant) -> str:
    alone = _static(spanned, None)
    pids = f", or PIDs on the loops: {alone[0]} without --loops pp" if alone else ""
    return f"; no other method has controllers for this goal: another --settling or --period{pids}"


def designs(plant: SampledPlant, bounds: dict[str, float], goal: Goal | None) -> bool:
    try:
        design = decoupling.polynomial(plant.a, plant.b, plant.period, **bounds)
    except libreflux.Refused:
        return False
    return closes(plant, Compensator(design.g, found=design), goal)


def closes(plant: SampledPlant, compensator: Compensator, goal: Goal | None) -> bool:
    """Are there controllers that the board takes, stable together and not too sensitive? Without a goal none are wanted."""
    if goal is None:
        return True
    try:
        placed = decoupled_loops.place_all(plant, compensator, *goal)
        decoupled_loops.lines(plant, compensator, placed, list(plant.outputs), list(range(1, plant.n + 1)), 1)
    except RunFailed:
        return False
    return decoupled_loops.closed_radius(plant, compensator, placed) < 1 and all(c.sensitivity <= SENSITIVITY_MOST for c in placed)


def _period(bounds: dict[str, float], options: argparse.Namespace, goal: Goal | None) -> list[str]:
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
        if designs(plant.in_spans(), bounds, goal):
            return [f"--period {period:g}"]
    return []


def _zero(spanned: SampledPlant, bounds: dict[str, float], goal: Goal | None) -> list[str]:
    """A bound that lets the outermost zero in, where that alone is in the way."""
    try:
        design = decoupling.polynomial(spanned.a, spanned.b, spanned.period, **{**bounds, "zero_hi": ZERO_MOST})
    except libreflux.Refused:
        return []
    if not closes(spanned, Compensator(design.g, found=design), goal):
        return []
    return [f"--zero-hi {ROUND_UP * design.outermost:.3g} (the zero stays in every loop)"]


def _static(spanned: SampledPlant, goal: Goal | None) -> list[str]:
    """The first that works, from all of the decoupler to less of it; with a goal at last none of it, which leaves each loop its controller."""
    if np.any(spanned.integrates()):
        return []
    gains = spanned.gains()
    try:
        libreflux.decoupler(libreflux.Plant(gains), [(i, i) for i in range(spanned.n)])
        factors = {"--method static": 1.0}
    except libreflux.Refused:
        factors = {}
    factors["--method partial --factor 0.5"] = 0.5
    if goal:
        factors["--method partial --factor 0 (no decoupler)"] = 0.0
    for way, factor in factors.items():
        try:
            shape = decoupling.partial(gains, factor)
        except libreflux.Refused:
            continue
        if closes(spanned, Compensator(shape.d[:, :, None], shape=shape), goal):
            return [way]
    return []
