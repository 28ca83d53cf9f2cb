"""Loops of a column from its step responses at a steady state: which measurement gets which manipulated variable, and PI settings (docs/use/columns.md,
Onto a board). Pairing and detuning are the firmware's."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg

from reflux import libreflux, simulator
from reflux import linear_analysis as linear
from reflux.errors import UserError
from reflux.gradients import Diagram
from reflux.sensor_rules import Thresholds, section_stages

FLAT_K = Thresholds().flat  # of the step beside a thermometer, as far as the keys make it: with less it says nothing of a product
TI_MOST_S = 1e6  # of a loop of the board
LEVEL_GAIN = 2.0  # output span per span of a level: 10 % of the level move the flow by 20 %
NOISE_MOST = 0.01  # standard deviation of an output that comes of the noise of its measurement, part of the span
PARTS = (0.283, 0.632)  # of its end that a first-order lag has reached after a third of its time constant, and after all of it
MARGIN = 1.7  # times all gains: docs/methods/tuning.md
SLOWER_STEP, SLOWER_MOST = 1.25, 1000.0
DEAF = 1e-3  # gain in spans of a measurement that cannot be controlled
FINER = 15  # from one grid of a step response to the next
SAME = 20.0  # relative gain from which two measurements see the same, nearly
SMALL = 1e-6  # of the largest gain in spans: a smaller one has no times


@dataclass(frozen=True)
class Loop:
    name: str
    pv: str
    mv: str
    action: str
    gain: float  # output span per measurement span
    ti_s: float
    divisor: int = 1


@dataclass(frozen=True)
class Found:
    loops: list[Loop]
    remarks: list[str]


def model_of(column: str, settings: tuple[str, ...]) -> linear.Model:
    data = simulator.linearised(column, settings)
    n = len(data["x"])
    a, b, c, d = (np.array(data[key], float) for key in "ABCD")
    return linear.Model(a.reshape(n, n), b.reshape(n, -1), c.reshape(-1, n), d.reshape(len(c), -1), tuple(data["inputs"]), tuple(data["outputs"]))


def design(column: str, settings: tuple[str, ...], plant: dict[str, Any], of: Diagram, keys: Sequence[str], rest: dict[str, float]) -> Found:
    """of: at the steady state. rest: the value of each channel there."""
    channels = {c["name"]: c for c in (*plant["inputs"], *plant["outputs"])}
    model = model_of(column, settings)
    levels = level_loops(model, plant, channels)
    for loop in levels:
        model = closed(model, loop, channels)
    obstacle = linear.obstacle(linear.poles(model))
    seen = [c for c in plant["outputs"] if c["lo"] < rest[c["name"]] < c["hi"]]
    pvs = controlled(plant, seen, of, keys)
    mvs, spared = movers([c for c in plant["inputs"] if c["name"] not in {loop.mv for loop in levels}], len(pvs))
    if obstacle or not pvs or not mvs:
        return Found([renamed(loop, channels) for loop in levels], [f"# no more loops: {obstacle or 'no temperature and no product composition that is measured says anything'}"])
    loops, words = paired(model.only(tuple(mvs), tuple(pvs.values())), dict(zip(pvs.values(), pvs)), channels, float(plant["tick_s"]))
    return Found([renamed(loop, channels) for loop in (*levels, *loops)], [*spared, *words])


def movers(inputs: list[dict[str, Any]], wanted: int) -> tuple[list[str], list[str]]:
    """What loops may move, and remarks. What concerns the feed is left to the operator while the other inputs are enough."""
    feed = [c["name"] for c in inputs if c["is"].startswith("feed")]
    others = [c["name"] for c in inputs if c["name"] not in feed]
    if not feed:
        return others, []
    if len(others) >= wanted:
        return others, [f"# no loop moves {', '.join(feed)}: the feed is yours to set, and {' and '.join(others)} are enough"]
    return [*others, *feed], [f"# a loop may move {', '.join(feed)}, because other inputs are too few; make it a disturbance in the column's file if it must not"]


def renamed(loop: Loop, channels: dict[str, Any]) -> Loop:
    """A loop and a channel cannot have the same name."""
    return dataclasses.replace(loop, name=f"{loop.name}_loop") if loop.name in channels else loop


# ---- levels that no flow of the file holds ----


def level_loops(model: linear.Model, plant: dict[str, Any], channels: dict[str, Any]) -> list[Loop]:
    """A level integrates: SIMC with the closed-loop time that makes the gain LEVEL_GAIN."""
    loops, levels = [], plant.get("levels", {})
    for vessel, stage, name, flows in (("condenser", plant["stages"], "drum", ("distillate", "reflux")), ("reboiler", 1, "sump", ("bottoms", "boilup"))):
        if levels.get(vessel, {}).get("by") != "none":
            continue
        pv = next((c["name"] for c in plant["outputs"] if c["is"] == "level" and c.get("stage") == stage), None)
        mv = next((c["name"] for flow in flows for c in plant["inputs"] if c["is"] == flow), None)
        if pv is None or mv is None:
            raise UserError(f"no flow holds the level of the {vessel}, and the column has no {'level output' if pv is None else 'input'} to hold it with")
        i, j = model.outputs.index(pv), model.inputs.index(mv)
        slope = float(model.c[i] @ model.b[:, j]) * span(channels[mv]) / span(channels[pv])
        loops.append(Loop(name, pv, mv, "direct" if slope < 0 else "reverse", LEVEL_GAIN, min(4 / (LEVEL_GAIN * abs(slope)), TI_MOST_S)))
    return loops


def closed(model: linear.Model, loop: Loop, channels: dict[str, Any]) -> linear.Model:
    """With the loop's proportional part."""
    i, j = model.outputs.index(loop.pv), model.inputs.index(loop.mv)
    gain = loop.gain * span(channels[loop.mv]) / span(channels[loop.pv]) * (-1 if loop.action == "reverse" else 1)
    return dataclasses.replace(model, a=model.a + gain * np.outer(model.b[:, j], model.c[i]), c=model.c + gain * np.outer(model.d[:, j], model.c[i]))


# ---- temperatures and compositions ----


def controlled(plant: dict[str, Any], seen: list[dict[str, Any]], of: Diagram, keys: Sequence[str]) -> dict[str, str]:
    """Name of a loop: its measurement. Of each section the thermometer beside the largest step that comes of the keys (rule B of
    docs/methods/gradients.md), away from feed, reboiler and condenser before others; where all are small, the composition of the product, if that is
    measured."""
    chosen = {}
    for name, end, stages in (("top", of.stages, range(plant["feed_stage"] + 1, of.stages + 1)), ("bottom", 1, range(1, plant["feed_stage"] + 1))):
        there = {c["name"]: c["stage"] for c in seen if c["is"] == "temperature" and c.get("stage") in stages}
        step = {pv: by_keys(of, stage, keys) for pv, stage in there.items()}
        inner = section_stages(of, plant["feed_stage"], "enriching" if name == "top" else "stripping", Thresholds().margin)
        away = [pv for pv in there if there[pv] in inner and step[pv] >= FLAT_K]
        best = max(away or step, key=lambda pv: step[pv], default=None)
        product = [c["name"] for c in seen if c["is"] in ("fraction", "log_fraction") and c.get("stage") == end]
        if best is not None and step[best] >= FLAT_K:
            chosen[name] = best
        elif product:
            chosen[name] = product[0]
    return chosen


def by_keys(of: Diagram, stage: int, keys: Sequence[str]) -> float:
    """The larger of the steps to the stages beside it, K, as far as the keys make it."""
    return max(abs(of.gradient[s - 1]) * of.part_of(s, keys) for s in (stage - 1, stage) if 1 <= s < of.stages)


def paired(model: linear.Model, names: dict[str, str], channels: dict[str, Any], tick_s: float) -> tuple[list[Loop], list[str]]:
    spans = np.array([[span(channels[u]) / span(channels[y]) for u in model.inputs] for y in model.outputs])
    gain, dead, lag = first_orders(model, spans)
    dead = dead + np.array([[instrument_s(channels[y])] for y in model.outputs])
    moves = [i for i in range(len(model.outputs)) if np.abs(gain[i]).max() >= DEAF]
    words = [f"# no loop for {y}: the whole span of an input moves it by less than {100 * DEAF:g} % of its own" for i, y in enumerate(model.outputs) if i not in moves]
    if not moves:
        return [], words
    outputs, gain, dead, lag = [model.outputs[i] for i in moves], gain[moves], dead[moves], lag[moves]
    plant = libreflux.Plant(gain, dead, lag)
    try:
        pairs = libreflux.pairing(plant)
        loops, figures = libreflux.detune(plant, pairs["pairs"], tick_s)
    except libreflux.Refused as error:
        return [], [*words, f"# no more loops: {error}"]
    out = []
    for (i, j), k, ti in zip(loops.pairs, loops.gain, loops.ti):
        y, u = outputs[i], model.inputs[j]
        k, ti = quiet(float(k), float(ti), gain[i, j], lag[i, j], channels[y])
        out.append(Loop(names[y], y, u, "reverse" if k > 0 else "direct", abs(k), min(ti, TI_MOST_S), max(1, round(channels[y].get("every_s", 0) / tick_s))))
    factor = slower(model, out, channels, tick_s)
    slowed = factor * figures["factor"]
    words += [
        f"# {loop.name}: {loop.pv} by {loop.mv}, relative gain {lam:.3g}; SIMC{f', slowed {slowed:.3g} times for all loops together' if slowed > 1.005 else ''}"
        for loop, lam in zip(out, pairs["lambda"])
    ]
    if max(pairs["lambda"], default=0.0) > SAME:
        words.append(f"# a relative gain above {SAME:g}: the measurements see nearly the same. Leave the slower loop in manual, or measure elsewhere")
    if not figures["kept"] or factor > SLOWER_MOST:
        words.append("# the loops together do not keep the distance from instability that docs/methods/tuning.md asks for: close one at a time")
    return [dataclasses.replace(loop, gain=loop.gain / factor, ti_s=min(loop.ti_s * factor, TI_MOST_S)) for loop in out], words


# ---- the loops on the whole linear model ----


def slower(model: linear.Model, loops: list[Loop], channels: dict[str, Any], tick_s: float) -> float:
    """By how much all loops must be slower to be stable together, sampled, with all gains MARGIN times as large. A first-order lag does not
    show that a temperature moves a part of its way within seconds."""
    sampled = sample(model, loops, channels, tick_s)
    factor = 1.0
    while factor <= SLOWER_MOST and not stable(sampled, loops, channels, tick_s, factor):
        factor *= SLOWER_STEP
    return factor


def sample(model: linear.Model, loops: list[Loop], channels: dict[str, Any], tick_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A, B and C from tick to tick, in engineering units: inputs and outputs of the loops, each output behind its instrument as a lag."""
    part = model.only(tuple(loop.mv for loop in loops), tuple(loop.pv for loop in loops))
    lags = np.array([max(instrument_s(channels[loop.pv]), 1e-3 * tick_s) for loop in loops])
    n, p = len(part.a), len(loops)
    both = np.zeros((n + 2 * p, n + 2 * p))
    both[:n, :n], both[:n, n + p :] = part.a, part.b
    both[n : n + p, :n], both[n : n + p, n : n + p], both[n : n + p, n + p :] = part.c / lags[:, None], np.diag(-1 / lags), part.d / lags[:, None]
    step = scipy.linalg.expm(both * tick_s)
    return step[: n + p, : n + p], step[: n + p, n + p :], np.hstack([np.zeros((p, n)), np.eye(p)])


def stable(sampled: tuple[np.ndarray, np.ndarray, np.ndarray], loops: list[Loop], channels: dict[str, Any], tick_s: float, factor: float) -> bool:
    a, b, c = sampled
    sign = [1 if loop.action == "reverse" else -1 for loop in loops]
    k = np.diag([MARGIN * way * loop.gain / factor * span(channels[loop.mv]) / span(channels[loop.pv]) for loop, way in zip(loops, sign)])
    integral = np.diag([tick_s / (loop.ti_s * factor) for loop in loops])
    whole = np.block([[a - b @ k @ c, -b @ k], [integral @ c, np.eye(len(loops))]])
    return bool(np.abs(np.linalg.eigvals(whole)).max() < 1)


def first_orders(model: linear.Model, spans: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gains in spans, dead times and time constants of a first-order lag with dead time through two points of each step response. What is
    fast is seen on a finer grid."""
    k = linear.gains(model)
    longest = -12.0 / linear.poles(model)[0].real / linear.GRID
    gain, dead, lag = k * spans, np.zeros(k.shape), np.full(k.shape, longest)
    left = set(zip(*np.nonzero(np.abs(gain) > SMALL * np.abs(gain).max())))
    for dt in (longest / FINER**2, longest / FINER, longest):
        responses, times = linear.step_responses(model, dt), dt * np.arange(linear.GRID + 1)
        for i, j in sorted(left):
            response = responses[:, i, j] / k[i, j]
            if response.max() < PARTS[1]:
                continue
            left.remove((i, j))
            first, second = (crossing(times, response, part) for part in PARTS)
            lag[i, j] = max(1.5 * (second - first), dt)
            dead[i, j] = max(second - lag[i, j], 0.0)
    return gain, dead, lag


def crossing(times: np.ndarray, response: np.ndarray, part: float) -> float:
    after = int(np.argmax(response >= part))
    if after == 0:
        return 0.0
    a, b = response[after - 1], response[after]
    return float(times[after - 1] + (part - a) / (b - a) * (times[after] - times[after - 1]))


def quiet(k: float, ti: float, process: float, lag: float, pv: dict[str, Any]) -> tuple[float, float]:
    """A smaller gain where noise would shake the output, with SIMC's integral time for it."""
    most = NOISE_MOST * span(pv) / pv["noise"] if pv.get("noise") else math.inf
    if abs(k) <= most:
        return k, ti
    return math.copysign(most, k), max(ti, min(lag, 4 * lag / (abs(process) * most)))


def instrument_s(channel: dict[str, Any]) -> float:
    """Dead time of an instrument: its lag, its delay, and of an analyser half the interval."""
    return float(channel.get("lag_s", 0) + channel.get("delay_s", 0) + channel.get("every_s", 0) / 2)


def span(channel: dict[str, Any]) -> float:
    return float(channel["hi"]) - float(channel["lo"])
