"""Adaptive feedforward (R. Siddha 2003) in his nine regimes: each of the four ways to find Gd/Gp, by the firmware's identification and search in the
arithmetic of a board (libreflux_board.so; float32 or Q7.24) or in double as the source does it, all seeds of a campaign in one array. The loop, the
source's parameters and the exact optimum are in tests/reference/siddha_simulation.py and siddha_identification.py."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cache
from typing import Any

from reflux.errors import UserError
from reflux.paths import ROOT

sys.path.insert(0, str(ROOT / "tests" / "reference"))
import siddha_identification as si  # noqa: E402
import siddha_simulation as sim  # noqa: E402

from reflux import high_order  # noqa: E402

import numpy as np  # noqa: E402

CORES = ("firmware", "fixed", "double")
SEARCHES = ("firmware", "exact", "simplex")
DISTURBANCES = ("square", "noise")
SKIP = 60  # samples after a change: what is in the filters and the past belongs to before
PAST = 400  # samples that fill the filters
BEGIN = 100  # first sample of the first stage
SCALE = 0.1  # of signals on the board
FF_TUNED_S = 120.0
ROOM_S = 0.5  # dead time of the element at most


@dataclass(frozen=True)
class Case:
    method: str = "A"
    core: str = "firmware"  # of the identification, in float32; fixed: in Q7.24
    lags_s: float = 0.0  # time constant of the two lags in series on all signals
    forget: float = 1.0
    p0: float = 1e4  # of signals as they are
    carry: bool = False  # theta and P go on from regime to regime; else they begin anew
    search: str = "firmware"
    dead: bool = False  # the element has a dead time
    every_s: float = 0.0  # method A: tuned so often; 0: when a regime's data are read
    disturbance: str = "square"
    noise: float = sim.NOISE
    learn_s: float = sim.LEARN_S


def check(case: Case) -> None:
    if case.method not in si.METHODS or case.core not in CORES or case.search not in SEARCHES or case.disturbance not in DISTURBANCES:
        raise UserError(f"{case}: method is one of {si.METHODS}, core of {CORES}, search of {SEARCHES}, disturbance of {DISTURBANCES}")
    if case.carry and case.core != "double":
        raise UserError(f"{case}: carry wants core=double")
    if case.every_s and not (case.method == "A" and case.carry):
        raise UserError(f"{case}: every_s wants method A and carry")
    if case.dead and case.search != "firmware":
        raise UserError(f"{case}: a dead time is found by the firmware's search only")


@cache
def ratios() -> np.ndarray:
    return np.array([sim.ratio(r) for r in sim.REGIMES])


def preset_of(case: Case) -> str:
    """The build whose identification and search are used."""
    return "host-fixed" if case.core == "fixed" else "host"


# ---- identification ----


def responses(case: Case, model: si.Model, record: sim.Record, first: int, last: int) -> np.ndarray:
    """Response to the model's only input, or the ratio of two [seeds, frequencies], begun at sample first."""
    joint = len(model.inputs) > 1
    if case.core == "double":
        theta = si.batch(model, record, first, last, case.forget, case.p0, case.lags_s, PAST)
        found = si.response(model, theta)
        return found[1] / found[0] if joint else found[0]
    low = max(0, first - PAST)
    shape = high_order.Shape(model.na, tuple((nb, delay) for _, nb, delay in model.inputs))
    settings = high_order.Settings(SCALE, case.lags_s, sim.TS, case.forget, min(1e9, case.p0 / SCALE**2))
    y = si.signal(record, model.output)[:, low:last]
    inputs = np.stack([si.signal(record, name)[:, low:last] for name, _, _ in model.inputs], axis=-1)
    return np.array([high_order.response(shape, y[s], inputs[s], sim.GRID * sim.TS, settings=settings, first=first - low, what=-1 if joint else 0,
                                           preset=preset_of(case))[0]
                     for s in range(len(y))])


class Carried:
    """Recursive least squares of all seeds that go on from regime to regime."""

    def __init__(self, case: Case, model: si.Model, seeds: int):
        self.model, self.rls = model, si.Rls(model, seeds, case.forget, case.p0)

    def step(self, k: int, record: sim.Record) -> None:
        y, *inputs = (getattr(record, name) for name in (self.model.output, *(name for name, _, _ in self.model.inputs)))
        # a window of the past is enough, and d and r are the same for all seeds
        low = k - 40
        cut = [x[:, low : k + 1] if x.ndim == 2 else np.broadcast_to(x[low : k + 1], (len(record.y), k + 1 - low)) for x in (y, *inputs)]
        self.rls.step(40, cut[0], cut[1:])

    def response(self) -> np.ndarray:
        found = si.response(self.model, self.rls.theta)
        return found[1] / found[0] if len(found) > 1 else found[0]


# ---- tuning ----


def tune(case: Case, ratio: np.ndarray) -> np.ndarray:
    """(lead, lag, K, dead time) of each ratio [seeds, frequencies]."""
    if case.search == "firmware":
        found = [high_order.search(sim.GRID, r, sim.WEIGHT, sim.TS, dead_most_s=ROOM_S if case.dead else 0.0, preset=preset_of(case)) for r in ratio]
        return np.array([(f.lead_s, f.lag_s, f.gain, f.dead_s) for f in found])
    three = sim.exact(ratio) if case.search == "exact" else np.array([sim.simplex(r) for r in ratio])
    return np.hstack([three, np.zeros((len(three), 1))])


# ---- the nine regimes ----


def _signals(case: Case) -> tuple[np.ndarray, np.ndarray]:
    r, d = sim.signals_together() if case.method == "A" else sim.signals_in_turn()
    if case.disturbance == "noise":
        white = np.random.default_rng(0).standard_normal(len(d))
        coloured = si.lagged(white, 0.25)  # to about 4 rad/s
        d = np.where(d == 0.0, 0.0, coloured / coloured[len(d) // 2 :].std())
    return r, d


class Adapter:
    """Adapts the feedforward: called at each sample with what was recorded before it."""

    def __init__(self, case: Case, seeds: int):
        self.case, self.seeds = case, seeds
        self.joint = case.method == "A"
        self.second = si.SECOND[case.method]
        self.first: np.ndarray | None = None
        self.carried = Carried(case, self.second, seeds) if case.carry else None
        self.tuning: np.ndarray | None = None
        self.ratios: list[np.ndarray] = []
        self.tunings: list[np.ndarray] = []
        self.start, self.each = round(sim.START_S / sim.TS), round(sim.WINDOW_S / sim.TS)
        self.learn, self.on = round(case.learn_s / sim.TS), round(sim.FF_ON_S / sim.TS)
        self.adapts, self.every = round(FF_TUNED_S / sim.TS), round(case.every_s / sim.TS)

    def __call__(self, k: int, record: sim.Record) -> np.ndarray | None:
        inside = (k - self.start) % self.each
        regime = (k - self.start) // self.each
        if self.joint and k == self.on:
            self.tuning = np.tile([*sim.FIXED, 0.0], (self.seeds, 1))
        if not self.joint and k == self.start:
            self.first = responses(self.case, si.FIRST[self.case.method], record, BEGIN, self.start)
        if not self.joint and k >= self.start and inside == 0:
            self.tuning = None  # the source identifies with the feedforward off
        if self.carried and k > BEGIN and (self.joint or k > self.start and 0 < inside <= self.learn):
            self.carried.step(k - 1, record)
        if self.every and k >= self.adapts and (k - self.adapts) % self.every == 0 and k < self.start:
            self.tuning = tune(self.case, self.ratio(k, record))
        if k >= self.start and (inside == self.learn or (self.every and inside % self.every == 0)):
            ratio = self.ratio(k, record)
            self.tuning = tune(self.case, ratio)
            if inside == self.learn:
                self.ratios.append(ratio)
                self.tunings.append(self.tuning)
        return self.tuning

    def ratio(self, k: int, record: sim.Record) -> np.ndarray:
        if self.carried:
            second = self.carried.response()
        else:
            second = responses(self.case, self.second, record, k - self.learn + SKIP, k)
        return second if self.joint else si.ratio_of(self.case.method, self.first, second)


@dataclass
class Played:
    tunings: np.ndarray  # lead, lag, K, dead time [regimes, seeds, 4]
    ratios: np.ndarray  # as identified [regimes, seeds, frequencies]


def play(case: Case, seeds: list[int]) -> Played:
    check(case)
    adapter = Adapter(case, len(seeds))
    sim.run(seeds, *_signals(case), case.noise, adapter)
    return Played(np.array(adapter.tunings), np.array(adapter.ratios))


def measured(case: Case, seeds: list[int]) -> dict[str, Any]:
    """For the campaign's record: the tunings, and by regime the error of the ratio, medians of seeds: at 0.5, 2 and 6 rad/s, dB and degrees; its largest on
    the grid and H2 as sim.misses() has them."""
    p = play(case, seeds)
    at = [int(np.argmin(abs(sim.GRID - w))) for w in sim.ERRORS_AT]
    off = p.ratios / ratios()[:, None, :]
    db, degrees = 20 * np.log10(abs(off)), np.degrees(np.angle(off))
    summed = np.stack([*(abs(e).max(axis=-1) for e in (db, degrees)), *(np.sqrt(np.sum(e[..., at] ** 2, axis=-1)) for e in (db, degrees))], axis=-1)
    return {"tunings": np.round(p.tunings, 6).tolist(), "dB": np.round(np.median(db[..., at], axis=1), 4).tolist(),
            "degrees": np.round(np.median(degrees[..., at], axis=1), 4).tolist(), "misses": np.round(np.median(summed, axis=1), 4).tolist()}
