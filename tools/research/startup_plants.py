"""Plants on which automatic start-up is judged and which it was not made for: named ones of every class, and random ones by their seed.

All are the simulator's JSON (docs/use/linear-plants.md). Channels are 0 to 100 % about 50 %, so that gains are those in spans. What the format does
not have, an instrument does (docs/inside/faults.md): backlash, stiction, drift, and a valve whose gain doubles. One is a column (startup_columns.py).
"""

from __future__ import annotations

import functools
import json
import random
import zlib
from dataclasses import dataclass, field
from typing import Any, Callable

import numpy as np

from research import startup_columns
from research.startup_linear import Linear

NOISES = (0.001, 0.003, 0.005)  # shares of a span
DRIFT = 0.01  # of a span, per slowest time constant
DRIFT_BAND = 0.25  # of a span, to where the drift goes before it turns
DRIFT_TURNS = 300
RANDOM_CLASSES = ("first-order", "two-lags", "damped", "inverse", "overshoot", "dead-time", "two-scales", "slow-cross", "one-way")
RENEWED_SAMPLES = 15
RANDOM_LARGEST_GAIN = 30.0  # largest relative gain of a random plant's best pairs

Element = dict[str, Any]
Events = Callable[[int], list[tuple[float, str]]]


@dataclass(frozen=True)
class PlantCase:
    """A plant of the campaign. data: its channels, with nominal values. file: what the simulator gets, where that is another; twin: what it
    is judged on, likewise. events: by the seed, what its instruments do besides noise. gain_change: input, factor, and by the seed the time
    in s at which it does so many times as much."""

    name: str
    kind: str
    data: dict[str, Any]
    fault: bool = False  # an instrument or actuator that is not linear, or not the same to the end
    events: Events = field(default=lambda seed: [])
    gain_change: tuple[str, float, Callable[[int], float]] | None = None
    file: dict[str, Any] | None = None
    twin: dict[str, Any] | None = None

    def linear(self, seed: int = 0, until_s: float = 0.0) -> Linear:
        """The true plant, as it is after until_s."""
        if self.gain_change and until_s > self.gain_change[2](seed):
            return Linear(self.data, {self.gain_change[0]: self.gain_change[1]})
        return Linear(self.twin or self.data)

    def all_events(self, noise: float, seed: int) -> list[str]:
        """Of the simulator: noise in shares of a span, and what else happens."""
        out = [(0.0, f"{y['name']}.noise={noise * (y['hi'] - y['lo']):g}") for y in self.data["outputs"]]
        out += self.events(seed)
        return ["0:noise=1", *(f"{t:.3f}:{what}" for t, what in sorted(out, key=lambda e: e[0]))]


def lag(gain: float, *times: float, dead: float = 0.0, zero: float = 0.0) -> Element:
    e: Element = {"gain": gain, "lags": list(times) if len(times) > 1 else times[0]}
    return _delayed(e, dead, zero)


def damped(gain: float, time: float, damping: float, dead: float = 0.0, zero: float = 0.0) -> Element:
    return _delayed({"gain": gain, "quadratic": [time * time, 2.0 * damping * time]}, dead, zero)


def integrator(rate: float, dead: float = 0.0) -> Element:
    """rate: spans per span and second."""
    return _delayed({"gain": rate, "integrator": True}, dead, 0.0)


def two_scales(gain: float, fast: float, slow: float, share: float, dead: float = 0.0) -> Element:
    """gain (share / (fast s + 1) + (1 - share) / (slow s + 1))."""
    return lag(gain, fast, slow, dead=dead, zero=share * slow + (1.0 - share) * fast)


def _delayed(e: Element, dead: float, zero: float) -> Element:
    return {**e, **({"dead_time": dead} if dead else {}), **({"zero": zero} if zero else {})}


def channels(letter: str, count: int) -> list[dict[str, Any]]:
    return [{"name": f"{letter}{k}", "unit": "%", "lo": 0, "hi": 100, "nominal": 50} for k in range(1, count + 1)]


def transfer(name: str, tick_s: float, elements: list[list[Element | None]]) -> dict[str, Any]:
    return {"name": name, "title": name, "source": "made up for the campaign of start-ups", "ours": "everything", "time_unit": "s",
            "tick_s": tick_s, "inputs": channels("u", len(elements[0])), "outputs": channels("y", len(elements)), "model": "transfer",
            "elements": elements}


def states(name: str, tick_s: float, a: list, b: list, c: list) -> dict[str, Any]:
    return {"name": name, "title": name, "source": "made up for the campaign of start-ups", "ours": "everything", "time_unit": "s",
            "tick_s": tick_s, "inputs": channels("u", len(b[0])), "outputs": channels("y", len(c)), "model": "state_space",
            "A": a, "B": b, "C": c}


# ---- named ----

PLAIN = [[lag(1.2, 150, dead=20), lag(0.5, 200, dead=40)], [lag(0.4, 180, dead=30), lag(1.0, 120, dead=25)]]
NAMED: dict[str, tuple[str, float, list[list[Element | None]]]] = {
    "plain": ("first-order", 10, PLAIN),
    "plain-four": ("first-order", 10, [[lag(k * (1.0 if i == j else 0.35), 100 + 30 * ((i + 2 * j) % 4), dead=15 + 5 * ((i + j) % 3))
                                        for j, k in enumerate((1.2, -0.9, 1.0, 1.4))] for i in range(4)]),
    "two-lags": ("two-lags", 10, [[lag(1.1, 120, 60, dead=15), lag(-0.4, 150, 80, dead=20)],
                                  [lag(0.5, 160, 50, dead=20), lag(1.3, 90, 70, dead=10)]]),
    "damping-015": ("damped", 5, [[damped(1.2, 60, 0.15, dead=10), lag(0.3, 120, dead=20)],
                                  [lag(0.25, 100, dead=15), lag(0.9, 150, dead=20)]]),
    "damping-03": ("damped", 5, [[damped(1.0, 70, 0.3, dead=10), damped(0.4, 90, 0.5, dead=20)],
                                 [lag(0.3, 130, dead=20), damped(-1.3, 60, 0.35, dead=10)]]),
    "damping-07": ("damped", 5, [[damped(1.1, 80, 0.7, dead=10), damped(-0.5, 100, 0.7, dead=20)],
                                 [damped(0.6, 90, 0.7, dead=15), damped(0.9, 70, 0.7, dead=10)]]),
    "inverse": ("inverse", 10, [[lag(1.2, 80, 100, dead=10, zero=-60), lag(0.4, 120, dead=20)],
                                [lag(0.5, 90, 60, dead=10, zero=-80), lag(1.0, 60, 90, dead=10, zero=-40)]]),
    "whole-inverse": ("whole-inverse", 5, [[lag(1.5, 65), lag(2.4, 40, 65)], [lag(2.5, 55, 90), lag(1.6, 90)]]),
    "fast-cross": ("whole-inverse", 10, [[lag(1.0, 300, dead=20), lag(0.8, 40, dead=10)], [lag(0.7, 40, dead=10), lag(1.2, 300, dead=20)]]),
    "integrating": ("integrating", 10, [[integrator(0.002, dead=20), integrator(-0.0005, dead=30)],
                                        [lag(0.3, 150, dead=20), lag(1.1, 200, dead=20)]]),
    "near-integrating": ("near-integrating", 10, [[lag(20.0, 4000, dead=20), lag(3.0, 3000, dead=40)],
                                                  [lag(0.3, 150, dead=20), lag(1.2, 150, dead=20)]]),
    "dead-time": ("dead-time", 10, [[lag(1.0, 60, dead=180), lag(0.4, 80, dead=200)], [lag(-0.5, 70, dead=190), lag(1.2, 60, dead=180)]]),
    "two-scales": ("two-scales", 10, [[two_scales(1.2, 60, 1200, 0.7, dead=10), lag(0.3, 200, dead=20)],
                                      [lag(0.4, 150, dead=20), two_scales(1.0, 80, 1000, 0.5, dead=15)]]),
    "two-scales-plain": ("two-scales", 10, [[two_scales(1.0, 50, 800, 0.3, dead=10), two_scales(0.4, 90, 700, 0.6, dead=20)],
                                            [lag(-0.3, 150, dead=20), lag(1.1, 120, dead=15)]]),
    "one-way": ("one-way", 10, [[lag(1.2, 150, dead=20), None], [lag(0.9, 180, dead=30), lag(1.0, 120, dead=25)]]),
    "near-singular": ("near-singular", 10, [[lag(1.0, 150, dead=15), lag(0.8, 180, dead=20), lag(0.3, 120, dead=20)],
                                            [lag(0.7, 160, dead=20), lag(1.1, 140, dead=15), lag(0.4, 130, dead=20)],
                                            [lag(0.85, 200, dead=20), lag(0.95, 170, dead=20), lag(0.385, 110, dead=10)]]),
    "wrong-diagonal-80": ("wrong-diagonal", 10, [[lag(1.0, 60, dead=10), lag(1.5, 4800, dead=20)],
                                                 [lag(1.35, 4800, dead=20), lag(0.9, 60, dead=10)]]),
    "wrong-diagonal-10": ("wrong-diagonal", 10, [[lag(1.0, 60, dead=10), lag(1.5, 600, dead=20)],
                                                 [lag(1.33, 600, dead=20), lag(1.0, 60, dead=10)]]),
    "gain-5": ("relative-gain", 10, [[lag(1.0, 150, dead=15), lag(0.8, 170, dead=20)], [lag(1.0, 180, dead=20), lag(1.0, 140, dead=15)]]),
    "gain-20": ("relative-gain", 10, [[lag(1.0, 150, dead=15), lag(0.95, 160, dead=15)], [lag(1.0, 160, dead=15), lag(1.0, 150, dead=15)]]),
    "gain-60": ("relative-gain", 10, [[lag(1.0, 150, dead=15), lag(0.9833, 155, dead=15)], [lag(1.0, 155, dead=15), lag(1.0, 150, dead=15)]]),
    "overshoot": ("overshoot", 10, [[lag(0.8, 60, 120, dead=10, zero=250), lag(0.3, 120, dead=20)],
                                    [lag(0.4, 150, dead=20), lag(1.0, 80, 100, dead=10, zero=180)]]),
    "one-slow": ("two-speeds", 10, [[lag(1.0, 80, dead=10), lag(0.4, 90, dead=15)], [lag(0.5, 900, dead=40), lag(1.2, 1000, dead=30)]]),
    "mixed-three": ("mixed", 10, [[damped(1.0, 80, 0.35, dead=10), lag(0.3, 150, dead=20), lag(-0.2, 100, dead=20)],
                                  [lag(0.4, 120, dead=20), lag(1.1, 90, 60, dead=10, zero=-50), lag(0.3, 200, dead=40)],
                                  [None, lag(0.3, 150, dead=20), lag(0.9, 60, dead=150)]]),
}
NAMED["wrong-diagonal-160"] = ("wrong-diagonal", 10, [[lag(1.0, 60, dead=10), lag(1.5, 9600, dead=20)],
                                                      [lag(1.2, 9600, dead=20), lag(1.0, 60, dead=10)]])
for _times in (10, 40, 160):
    NAMED[f"slow-cross-{_times}"] = ("slow-cross", 10, [[lag(1.0, 60, dead=10), lag(0.5, 60 * _times, dead=20)],
                                                       [lag(0.45, 60 * _times, dead=20), lag(1.1, 60, dead=10)]])


def scaled(elements: list[list[Element | None]], times: float = 1.0, gain: float = 1.0) -> list[list[Element | None]]:
    """First-order elements, all times and gains as many times as large."""
    return [[e and lag(e["gain"] * gain, e["lags"] * times, dead=e["dead_time"] * times) for e in row] for row in elements]


# More samples in a response than `test.longest` has by default; and outputs that hardly move in their spans.
NAMED["slow"] = ("slow", 2, scaled(PLAIN, times=8))
NAMED["very-slow"] = ("slow", 5, scaled(PLAIN, times=50))
NAMED["huge-span"] = ("huge-span", 10, scaled(PLAIN, gain=0.05))


def _faulty(name: str) -> PlantCase:
    data = transfer(name, 10, PLAIN)
    inputs, outputs = [u["name"] for u in data["inputs"]], [y["name"] for y in data["outputs"]]
    slowest = Linear(data).slowest_s()
    if name in ("backlash", "stiction"):
        # No position is read back: a valve without a positioner.
        size = 1.0 if name == "backlash" else 0.3
        happens = [(0.0, f"{u}.{name}={size}") for u in inputs] + [(0.0, f"{u}.readback=2") for u in inputs]
        return PlantCase(name, name, data, True, lambda seed: happens)
    if name in ("coarse", "renewed"):
        what = "resolution=1" if name == "coarse" else f"every={RENEWED_SAMPLES}"
        # On average a reading that is renewed every n-th sample is (n - 1) / 2 samples old.
        late = transfer(name, 10, [[lag(e["gain"], e["lags"], dead=e["dead_time"] + 5.0 * (RENEWED_SAMPLES - 1)) for e in row] for row in PLAIN])
        return PlantCase(name, name, data, True, lambda seed: [(0.0, f"{y}.{what}") for y in outputs], twin=late if name == "renewed" else None)
    if name == "drift":
        return PlantCase(name, name, data, True, lambda seed: drifts(outputs, slowest, seed))
    at = functools.partial(_change_s, slowest)
    return PlantCase(name, name, data, True, lambda seed: [(at(seed), "u1.gain=2")], ("u1", 2.0, at))


def _change_s(slowest: float, seed: int) -> float:
    return slowest * random.Random(f"gain-doubles {seed}").uniform(10.0, 60.0)


def drifts(outputs: list[str], slowest: float, seed: int) -> list[tuple[float, str]]:
    """A ramp on every measurement, 100 % of span, that turns at the ends of its band, all at the same time, each with a sign of its own."""
    chance = random.Random(f"drift {seed}")
    turn = DRIFT_BAND / DRIFT * slowest
    first = chance.uniform(0.8, 1.0) * turn
    out = []
    for name in outputs:
        rate = chance.choice((-1, 1)) * DRIFT * 100.0 / slowest * 3600.0
        out.append((0.0, f"{name}.drift={rate:g}"))
        out += [(first + 2 * n * turn, f"{name}.drift={rate * (-1) ** (n + 1):g}") for n in range(DRIFT_TURNS)]
    return out


def _of_states(name: str) -> PlantCase:
    if name == "unstable":
        # One slow pole to the right of the axis, 1500 s.
        return PlantCase(name, name, states(name, 10, [[1 / 1500, 0], [0, -1 / 150]], [[1.5 / 1500, 0.4 / 1500], [0.3 / 150, 1.1 / 150]],
                                            [[1, 0], [0, 1]]))
    # A reactor and a separator whose bottoms go back to the reactor.
    return PlantCase(name, name, states(name, 10, [[-1 / 100, 0.85 / 100, 0], [0.9 / 120, -1 / 120, 0], [0, 1 / 40, -1 / 40]],
                                        [[0.5 / 100, 0.1 / 100], [0, -0.5 / 120], [0, 0]], [[1, 0, 0], [0, 0, 1]]))


FAULTY = ("backlash", "stiction", "drift", "gain-doubles", "coarse", "renewed")
OF_STATES = ("unstable", "recycle")


def names() -> list[str]:
    return [*NAMED, *OF_STATES, *FAULTY, "column"]


# ---- random ----

def randomly(seed: int) -> PlantCase:
    """Classes in rotation, 2 x 2 to 4 x 4. Pairs are anywhere; the largest relative gain of the best pairs is bounded."""
    kind = RANDOM_CLASSES[seed % len(RANDOM_CLASSES)]
    n = 2 + seed // len(RANDOM_CLASSES) % 3
    chance = random.Random(f"start-up {kind} {seed}")
    while True:
        order = list(range(n))
        chance.shuffle(order)
        elements = [[_random_element(kind, chance, j == order[i], i, order.index(j)) for j in range(n)] for i in range(n)]
        fastest = min(_span_s(e) for row in elements for e in row if e)
        data = transfer(f"random-{seed}", float(max(1, round(fastest / 12))), elements)
        gains = Linear(data).gains()
        if _bounded(gains, order):
            return PlantCase(data["name"], f"random {kind}", data)


def _bounded(gains: Any, order: list[int]) -> bool:
    if abs(np.linalg.det(gains)) < 1e-9:
        return False
    relative = gains * np.linalg.inv(gains).T
    return all(0.3 < relative[i, j] < RANDOM_LARGEST_GAIN for i, j in enumerate(order))


def _random_element(kind: str, chance: random.Random, paired: bool, row: int, column: int) -> Element | None:
    """column: of the pairs' order, so that `one-way` is triangular in it."""
    if not paired and (kind == "one-way" and column > row or chance.random() < 0.1):
        return None
    gain = chance.choice((-1, 1)) * (10 ** chance.uniform(-0.3, 0.3) if paired else 10 ** chance.uniform(-1.0, -0.05))
    time = round(10 ** chance.uniform(1.75, 2.5), 1)
    dead = round(time * chance.uniform(0.05, 0.5), 1)
    second = round(time * chance.uniform(0.3, 0.9), 1)
    gain = round(gain, 4)
    shaped = chance.random() < 0.6 or paired  # the others are first order
    if kind == "two-lags" and shaped:
        return lag(gain, time, second, dead=dead)
    if kind == "damped" and shaped:
        return damped(gain, round(0.5 * time, 1), round(chance.uniform(0.15, 0.7), 3), dead=round(0.5 * dead, 1))
    if kind == "inverse" and shaped:
        return lag(gain, time, second, dead=dead, zero=-round(time * chance.uniform(0.2, 0.8), 1))
    if kind == "overshoot" and shaped:
        return lag(gain, time, second, dead=dead, zero=round(time * chance.uniform(1.2, 2.5), 1))
    if kind == "dead-time" and shaped:
        return lag(gain, round(0.4 * time, 1), dead=round(0.4 * time * chance.uniform(1.5, 3.5), 1))
    if kind == "two-scales" and shaped:
        return two_scales(gain, round(0.5 * time, 1), round(time * chance.uniform(4, 12), 1), round(chance.uniform(0.3, 0.8), 3), dead=dead)
    if kind == "slow-cross" and not paired:
        return lag(gain, round(time * chance.uniform(10, 60), 1), dead=dead)
    return lag(gain, time, dead=dead)


def _span_s(e: Element) -> float:
    lags = e.get("lags", [])
    whole = sum(lags) if isinstance(lags, list) else lags
    return whole + (e["quadratic"][1] + e["quadratic"][0] ** 0.5 if "quadratic" in e else 0.0) + e.get("dead_time", 0.0)


# ---- all ----

@functools.cache
def case(name: str) -> PlantCase:
    if name.startswith("random-"):
        return randomly(int(name.removeprefix("random-")))
    if name == "column":
        return PlantCase(name, name, startup_columns.with_nominal(name), True, file=startup_columns.file_of(name),
                         twin=startup_columns.twin(name))
    if name in OF_STATES:
        return _of_states(name)
    if name in FAULTY:
        return _faulty(name)
    kind, tick_s, elements = NAMED[name]
    return PlantCase(name, kind, transfer(name, tick_s, elements))


def text(of: PlantCase) -> str:
    return json.dumps(of.file or of.data)


def stream(*what: Any) -> int:
    """A number for a generator of random numbers, the same on every machine."""
    return zlib.crc32(" ".join(map(str, what)).encode())
