"""The proposed loops on the model of the start-up: their margins, and what the trial should have looked like."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from reflux import margins, scenario_settings, table
from reflux.commission import frequency
from reflux.commission.progress import span_of_time
from reflux.commission.record import Record
from reflux.commission.results import Element, Loop


STEP_SHARE = 0.5  # of the largest move of a setpoint: what counts as a step of the trial
SENSITIVITY_MOST = 2.5  # above it, and below the gain margin, a loop is named to whoever keeps it
GAIN_MARGIN_LEAST = 1.7
GAIN_MARGIN_SLOW = 20.0  # from here on a loop is far slower than its plant, where it also settles later than the plant by itself
SETTLED_TIMES = 3.0  # time constants until a first-order response is within 5 % of its end


@dataclass
class StateSpace:
    """One element of the model without its dead time, gain 1."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: float


def state_space(e: Element) -> StateSpace:
    """(zero s + 1) / (square s2 + time s + 1)"""
    if not e.has_gain or (e.time_s <= 0 and e.square_s2 <= 0):
        return StateSpace(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), 1.0)
    if e.square_s2 <= 0:
        share = e.zero_s / e.time_s
        return StateSpace(np.array([[-1 / e.time_s]]), np.array([[1.0]]), np.array([[(1 - share) / e.time_s]]), share)
    a = np.array([[0.0, 1.0], [-1 / e.square_s2, -e.time_s / e.square_s2]])
    return StateSpace(a, np.array([[0.0], [1.0]]), np.array([[1 / e.square_s2, e.zero_s / e.square_s2]]), 0.0)


def why_not(r: Record) -> str:
    """Why the model says nothing about the loops as they run; empty where it does."""
    p = r.proposal
    if not p.decoupler.startswith("none"):
        return "a decoupler stands between the loops and the inputs"
    if p.inner:
        return "cascades are among the loops"
    if any((x.measurement, x.input) not in r.model.elements for x in p.loops) or not r.plant:
        return "the model lacks an element of a loop"
    return ""


def law(loop: Loop, tick_s: float) -> margins.Law:
    return margins.Law(loop.gain, loop.ti_s, loop.td_s, -1.0 if loop.action == "direct" else 1.0, step_s=tick_s)


def of_proposal(r: Record) -> list[tuple[str, margins.Margins]]:
    """Margins of each proposed loop, by its measurement."""
    if why_not(r) or r.plant is None or not r.proposal.loops:
        return []
    loops, h = r.proposal.loops, r.plant.tick_s
    slowest = max((e.time_s + e.dead_s for e in r.model.elements.values() if e.has_gain), default=h)
    omega = margins.frequencies(slowest, h)
    plant = np.zeros((len(omega), len(loops), len(loops)), complex)
    for i, y in enumerate(loops):
        for j, u in enumerate(loops):
            if e := r.model.elements.get((y.measurement, u.input)):
                s = state_space(e)
                dead = np.array([[e.dead_s if e.has_gain else 0.0]])
                plant[:, i, j] = frequency.in_spans(r, e) * margins.sampled(s.a, s.b, s.c, np.array([[s.d]]), dead, h, omega)[:, 0, 0]
    return [(loop.measurement, m) for loop, m in zip(loops, margins.of_loops(omega, plant, [law(x, h) for x in loops]))]


@dataclass(frozen=True)
class Doubt:
    """Why a loop is named. cells: columns of its row of margins. slow: it is far slower than its plant."""

    words: str
    cells: tuple[int, ...]
    slow: bool = False


def doubts(r: Record, found: list[tuple[str, margins.Margins]]) -> dict[str, list[Doubt]]:
    """What there is to say about margins of proposed loops, by measurement."""
    edited = " These are the margins as proposed, before the edits." if "[proposal.set]" in r.answers else ""
    manual = "with the other loops in manual " if len(found) > 1 else ""
    out = {}
    for (name, m), loop in zip(found, r.proposal.loops, strict=True):
        said = [x for x in (_too_near(name, m, manual), _too_slow(name, m, loop, r.model.elements[loop.measurement, loop.input])) if x]
        if said:
            out[name] = [Doubt(x.words + edited, x.cells, x.slow) for x in said]
    return out


def _too_near(name: str, m: margins.Margins, manual: str) -> Doubt | None:
    advice = ": it may oscillate while they are in manual. Lower its gain, or keep them in automatic." if manual else ": it may oscillate. Lower its gain."
    if not m.stable:
        return Doubt(f"{name}: {manual}it is unstable on the model{advice}", (0,))
    poor, cells = [], []
    if m.sensitivity > SENSITIVITY_MOST:
        poor.append(f"its Ms is {table.figure(m.sensitivity)} (up to 2 is usual)")
        cells.append(2)
    if m.gain < GAIN_MARGIN_LEAST:
        poor.append(f"its gain margin is {table.figure(m.gain)} (less than {GAIN_MARGIN_LEAST:g})")
        cells.append(0)
    return Doubt(f"{name}: {manual}{' and '.join(poor)}{advice}", tuple(cells)) if poor else None


def _too_slow(name: str, m: margins.Margins, loop: Loop, e: Element) -> Doubt | None:
    """A plant of one lag bears any gain, so that its loop is slow only where it settles later than the plant by itself."""
    alone_s = e.dead_s + SETTLED_TIMES * e.time_s
    if not (m.stable and GAIN_MARGIN_SLOW < m.gain < math.inf and loop.settles_s > alone_s):
        return None
    return Doubt(f"{name}: its gain margin is {table.figure(m.gain)}, so it is far slower than its plant: a setpoint step settles in "
                 f"{span_of_time(loop.settles_s)} on the model, while the plant by itself takes {span_of_time(alone_s)}. The doubts of the tests made it slow. "
                 "Another start-up, or `commission repeat` during it, may help.", (0,), slow=True)


def predicted(r: Record, setpoints: list[np.ndarray], inputs: list[np.ndarray]) -> list[np.ndarray] | None:
    """The measurements of the loops, in their units, as the model has them when it follows these setpoints from rest under the proposed
    settings. One sample a tick; inputs: as they were, of which the first value is where the plant rested. None: no model of the loops.

    From its second setpoint step on a loop has its gain raised by the probe of the trial until the next loop is stepped."""
    if why_not(r) or r.plant is None:
        return None
    loops, h, count = r.proposal.loops, r.plant.tick_s, len(setpoints[0])
    spans = [r.channels[x.measurement].span for x in loops]
    w = np.array([(sp - sp[0]) / span for sp, span in zip(setpoints, spans)])
    room = [((r.channels[x.input].lo - u[0]) / r.channels[x.input].span, (r.channels[x.input].hi - u[0]) / r.channels[x.input].span)
            for x, u in zip(loops, inputs)]
    gains = _gains(r, w)
    weights = _setpoint_weights(r)
    elements = [[_Sampled(r, e, h) if (e := r.model.elements.get((y.measurement, u.input))) else None for u in loops] for y in loops]
    y, u = np.zeros((len(loops), count)), np.zeros((len(loops), count))
    laws = [law(x, h) for x in loops]
    before = np.zeros(len(loops))  # the derivative's value
    for k in range(count):
        for i, row in enumerate(elements):
            y[i, k] = sum(e.step(u[j], k) for j, e in enumerate(row) if e)
        for i, c in enumerate(laws):
            if k == 0:
                continue
            gain = c.sign * gains[i, k]
            move = gain * (weights[i] * (w[i, k] - w[i, k - 1]) - (y[i, k] - y[i, k - 1]))
            move += gain * h / c.ti_s * (w[i, k - 1] - y[i, k - 1]) if c.ti_s > 0 else 0.0
            if c.td_s > 0:
                tf = c.td_s / c.n
                now = tf / (tf + h) * before[i] - gain * c.td_s / (tf + h) * (y[i, k] - y[i, k - 1])
                move, before[i] = move + now - before[i], now
            u[i, k] = min(max(u[i, k - 1] + move, room[i][0]), room[i][1])
    return [sp[0] + span * values for sp, span, values in zip(setpoints, spans, y)]


def _gains(r: Record, w: np.ndarray) -> np.ndarray:
    """The gain of each loop at each sample."""
    out = np.array([[loop.gain] * w.shape[1] for loop in r.proposal.loops])
    steps = [_steps(row) for row in w]
    for i, own in enumerate(steps):
        if len(own) > 1:
            others = [k for j, found in enumerate(steps) if j != i for k in found if k > own[1]]
            out[i, own[1]:min(others, default=w.shape[1])] *= r.probe
    return out


def _steps(setpoint: np.ndarray) -> list[int]:
    """Samples at which the setpoint is stepped. It moves a little where a loop is closed, because it follows the measurement until then."""
    moves = np.abs(np.diff(setpoint))
    return [int(k) + 1 for k in np.flatnonzero(moves > STEP_SHARE * moves.max(initial=0.0))]


def _setpoint_weights(r: Record) -> list[float]:
    """b of each proposed loop, from the configuration that the board had in the end; 1 where it is not known."""
    path = r.folder / "board.conf"
    if not path.is_file():
        return [1.0] * len(r.proposal.loops)
    loops = scenario_settings.loops(scenario_settings.values_of(path.read_text(encoding="latin-1").splitlines()))
    found = {(x.pv, x.out): x.b for x in loops}
    return [found.get((x.measurement, x.input), 1.0) for x in r.proposal.loops]


class _Sampled:
    """An element in spans, stepped once a tick; u holds from its sample on."""

    def __init__(self, r: Record, e: Element, h: float):
        s = state_space(e)
        self.gain, self.c, self.d = frequency.in_spans(r, e), s.c, s.d
        dead = e.dead_s if e.has_gain else 0.0
        self.whole = int(dead / h + 1e-9)
        rest = max(dead - self.whole * h, 0.0)
        phi, self.late = margins.held(s.a, s.b, h - rest)
        begun, early = margins.held(s.a, s.b, rest)
        self.phi, self.early, self.x = phi @ begun, phi @ early, np.zeros((len(s.a), 1))

    def step(self, u: np.ndarray, k: int) -> float:
        """Output at sample k; then the state goes on to the next one."""
        if k > 0:
            self.x = self.phi @ self.x + self.late * _at(u, k - 1 - self.whole) + self.early * _at(u, k - 2 - self.whole)
        return self.gain * (float((self.c @ self.x).sum()) + self.d * _at(u, k - 1 - self.whole))


def _at(u: np.ndarray, k: int) -> float:
    return float(u[k]) if k >= 0 else 0.0
