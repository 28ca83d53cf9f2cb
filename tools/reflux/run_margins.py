"""Margins of the loops of a scenario, on the plant's linearisation at its steady state and with the settings before the first sample."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from reflux import margins, scenario_settings, simulator
from reflux.errors import RunFailed, UserError
from reflux.scenario import Scenario
from reflux.scenario_settings import LoopSettings

TICK = re.compile(r"^\s*tick: ([\d.e+-]+) s", re.MULTILINE)
LEAST_GAIN = 1e-3  # span per span
UNSTABLE = 1e-9  # 1/s: poles right of this count as unstable, because a linearisation puts integrators near 0
# Kinds of blocks that only compute channels and leave the control law alone.
ONLY_LOOK = ("column", "composition")


@dataclass
class Found:
    """why_not: the reason where there are none."""

    loops: list[tuple[str, margins.Margins]] = field(default_factory=list)
    why_not: str = ""


def of_scenario(scenario: Scenario, plant: str) -> Found:
    """plant: as reflux-sim takes it."""
    lines = scenario_settings.lines_of(scenario)
    values = scenario_settings.values_of(lines)
    judged = [loop.name for loop in scenario.loops]
    if reason := other_law(values, judged):
        return Found(why_not=reason)
    loops = [loop for loop in scenario_settings.loops(values) if loop.name in judged]
    if not loops:
        return Found(why_not="no loop of this scenario is set up before the first sample")
    try:
        model = simulator.linearised(plant)
        tick = scenario.tick_s or float(TICK.search(simulator.ask("--list", plant))[1])  # type: ignore[index]
        return on_model(model, loops, tick)
    except (UserError, RunFailed) as error:
        return Found(why_not=str(error))
    except (KeyError, ValueError, TypeError, np.linalg.LinAlgError) as error:
        return Found(why_not=f"the plant's linearisation does not carry these loops ({error})")


def other_law(values: dict[str, str], judged: list[str]) -> str:
    """What acts beside the PID, so that its settings alone say nothing; empty without it."""
    for k in scenario_settings.numbered(values, "block"):
        kind = values.get(f"{k}.kind", "-")
        if kind != "-" and kind not in ONLY_LOOK:
            return f"a block of kind {kind} may act for the loops"
    for k in scenario_settings.numbered(values, "loop"):
        if values.get(f"{k}.algorithm") == "two_position" and values.get(f"{k}.name") in judged:
            return f"loop {values[f'{k}.name']} is two-position control"
        if values.get(f"{k}.decouple") == "on":
            return "the static decoupler stands between the loops and the outputs"
    for k in scenario_settings.numbered(values, "meas"):
        if scenario_settings.number(values.get(f"{k}.every"), 1.0) > 1:
            return f"{values.get(f'{k}.name', k)} is an analyser, whose delays the plant's linearisation does not hold"
    return ""


def on_model(model: dict, loops: list[LoopSettings], tick_s: float) -> Found:
    rows, columns = [model["outputs"].index(loop.pv) for loop in loops], [model["inputs"].index(loop.out) for loop in loops]
    a, b, c, d = (np.array(model[k], float) for k in "ABCD")
    period = float(model.get("period_s") or 0.0)
    dead = np.array(model["dead_s"], float)[np.ix_(rows, columns)] if model.get("dead_s") else np.zeros((len(rows), len(columns)))
    poles = np.linalg.eigvals(a) if a.size else np.zeros(0)
    if period > 0:
        poles = np.log(poles[np.abs(poles) > 0].astype(complex)) / period
    speeds = np.abs(poles[np.abs(poles) > UNSTABLE])
    steps = [tick_s * loop.divisor for loop in loops]
    omega = margins.frequencies(1.0 / speeds.min() if speeds.size else 1000 * tick_s, max(steps))
    spans = np.array([[u.out_span / y.pv_span for u in loops] for y in loops])
    if period > 0:  # a plant in discrete time is its own hold
        at = np.exp(1j * omega * period)
        plant = np.array([c[rows] @ np.linalg.solve(z * np.eye(len(a)) - a, b[:, columns]) + d[np.ix_(rows, columns)] for z in at])
    else:
        plant = margins.sampled(a, b[:, columns], c[rows], d[np.ix_(rows, columns)], dead, max(steps), omega)
    plant = plant * spans
    deaf = [loop.name for k, loop in enumerate(loops) if np.abs(plant[:, k, k]).max() < LEAST_GAIN]
    if deaf:
        return Found(why_not=f"at the plant's steady state the output of {' and of '.join(deaf)} has no effect")
    laws = [margins.Law(loop.gain, loop.ti_s, loop.td_s, loop.sign, loop.n, loop.filter_s, step) for loop, step in zip(loops, steps)]
    found = margins.of_loops(omega, plant, laws, int(np.count_nonzero(poles.real > UNSTABLE)))
    return Found([(loop.name, m) for loop, m in zip(loops, found)])
