"""Replays of a run with other covariances, until the innovations are as a filter expects them or it is plain that no covariance makes them so."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Callable

from reflux import consistency, innovations, replay
from reflux.consistency import Judgement, Setting
from reflux.errors import RunFailed, UserError
from reflux.innovations import Series, Statistics
from reflux.recorded_run import Block, Recorded

SETTLES_S = 1800.0  # from where the monitor counts
REPLAYS_MOST = 10
EFFECT = 0.01  # of another `model` upon the logarithm of the innovations' size
ANSWERS = 0.1  # a thermometer whose offset taken off changes less of what it is off has another trouble
STILL = 1.05  # a proposal nearer than that to what there is changes nothing
FEED_FOUND = ("feed_1", "feed_2", "feed_3")


@dataclass
class Look:
    """One replay, judged."""

    changes: dict[str, float]
    shift: dict[str, float]
    series: list[Series]
    statistics: list[Statistics | None]
    setting: Setting
    judgement: Judgement
    first_s: float
    last_s: float

    def known(self) -> list[Statistics]:
        return [s for s in self.statistics if s is not None]

    def moving(self) -> list[Statistics]:
        return [s for s in self.known() if s.sensor.moves and consistency.says_something(s)]


@dataclass
class Run:
    recorded: Recorded
    block: Block
    given: dict[str, str]  # from the command line
    first_h: float | None = None
    last_h: float | None = None
    show: Callable[[str], None] = lambda text: None


def look(run: Run, changes: dict[str, float] | None = None, shift: dict[str, float] | None = None) -> Look:
    changes, shift = changes or {}, shift or {}
    in_channel = {s.name: shift[s.name] / s.factor for s in run.block.sensors if s.name in shift}
    candidates = {**run.given, **{name: f"{x:.6g}" for name, x in changes.items()}}
    played = replay.play(run.recorded, run.block, candidates, in_channel, run.show)
    method = played.settings.get("method", "")
    if method == "geometric":
        raise UserError(f"block {run.block.number} estimates by method geometric, which has no covariances; --set method=rekf (or ekf, kalman) replays the run by "
                        "a filter")
    if method in consistency.WITH_FEED and max((x for x in played.values_of("cycles") if math.isfinite(x)), default=0.0) == 0:
        raise RunFailed(f"{run.recorded.source}: block {run.block.number} estimates by {method}, and its covariance was never carried on in the replay (`cycles` stays 0): "
                        "`block N` says whether it has its workspace")
    begins = innovations.begins_s(run.recorded, run.block, played)
    if math.isinf(begins):
        raise RunFailed(f"{run.recorded.source}: the estimate never settled in this run: its thermometers were never all good for 3/lambda, or there was no vapour")
    first = begins + SETTLES_S if run.first_h is None else run.first_h * 3600
    last = run.recorded.time_s[-1] if run.last_h is None else run.last_h * 3600
    if first >= last:
        raise UserError(f"{run.recorded.source}: nothing is left between {first / 3600:.2f} h and {last / 3600:.2f} h; the run lasts {run.recorded.time_s[-1] / 3600:.2f} h. "
                        "--from and --to choose")
    series = innovations.series(run.recorded, run.block, played, max(first, begins), last, in_channel)
    setting = setting_of(played, first, last)
    found = [innovations.statistics(s, setting.noise) for s in series]
    missing = [s.sensor.name for s, numbers in zip(series, found) if numbers is None]
    judgement = consistency.judge([s for s in found if s], missing, setting, run.recorded.tick_s)
    return Look(changes, shift, series, found, setting, judgement, max(first, begins), last)


def automatic(method: str, covariance: str) -> tuple[float, float]:
    """`noise` and `model` of a block that has 0 for them (docs/methods/kalman.md); the noise that it finds is not known here, but its least."""
    return (0.05, 0.011) if method == "ekf" and covariance == "full" else (0.2, 0.1)


def setting_of(played: replay.Replay, first: float, last: float) -> Setting:
    def number(name: str) -> float:
        return float(played.settings.get(name, "nan"))

    def found(names: tuple[str, ...]) -> float:
        """Largest root mean square of them."""
        most = 0.0
        for name in names:
            values = [x for x, t in zip(played.values_of(name), played.time_s) if first <= t <= last and math.isfinite(x)]
            most = max(most, math.sqrt(sum(x * x for x in values) / len(values)) if values else 0.0)
        return most

    feed = {name: x for name in ("feed_z", "feed_f") if (x := number(name)) >= 0}
    method = played.settings.get("method", "")
    noise, model = automatic(method, played.settings.get("covariance", ""))
    return Setting(method, number("noise") or noise, number("model") or model, feed, {"feed_z": found(FEED_FOUND), "feed_f": found(("feed_flow",))})


# ---- search ----


@dataclass
class Search:
    looks: list[Look]
    offset: tuple[str, float] | None = None  # a thermometer and what it reads too much, K
    reasons: list[str] = field(default_factory=list)  # why no covariance does it
    consistent: bool = False

    @property
    def last(self) -> Look:
        return self.looks[-1]

    @property
    def best(self) -> Look:
        """The last where it is consistent; else that with the innovations nearest to what is expected, and the offset off."""
        if self.looks[-1].judgement.consistent:
            return self.looks[-1]
        return min((one for one in self.looks if one.shift == self.looks[-1].shift), key=distance)


def search(run: Run, first: Look, tell: Callable[[Look], None]) -> Search:
    out = Search([first])
    if first.judgement.consistent:
        out.consistent = True
        return out
    if first.judgement.odd:
        find_offset(run, out, tell)
    follow(run, out, tell)
    out.consistent = out.best.judgement.consistent
    out.reasons = [] if out.consistent else reasons(out)
    return out


def find_offset(run: Run, out: Search, tell: Callable[[Look], None]) -> None:
    """The innovations of a thermometer are off by less than its offset, since it draws the estimate: how much less says a replay without the
    first guess. Kept where it takes the contradiction away."""
    name, away = out.last.judgement.odd, out.last.judgement.odd_k
    trial = look(run, out.last.changes, {name: -away})
    left = contrast(trial, name)
    if abs(away - left) < ANSWERS * abs(away):
        return
    amount = away * away / (away - left)
    known = look(run, out.last.changes, {name: -amount})
    if known.judgement.odd:
        return
    out.offset = (name, amount)
    out.looks.append(known)
    tell(known)


def contrast(of: Look, name: str) -> float:
    one = next(s for s in of.known() if s.sensor.name == name)
    return one.mean_k - consistency.mean_of_others([s for s in of.known() if s.sensor.above == one.sensor.above], one)


def follow(run: Run, out: Search, tell: Callable[[Look], None]) -> None:
    """`noise` is what the readings have; then `model` (or the feed's uncertainty) until the innovations are as large as expected."""
    seen: list[tuple[float, float]] = []  # logarithms of `model` and of the innovations' size, since something else changed
    while len(out.looks) < REPLAYS_MOST and not out.last.judgement.consistent and out.last.moving():
        changes = other_changes(out.last)
        seen = [] if changes else [*seen, (math.log(out.last.setting.model), math.log(size(out.last)))]
        model = next_model(out.last, seen, changes)
        if model:
            changes["model"] = model
        if not changes or has_no_effect(seen):
            return
        out.looks.append(look(run, {**out.last.changes, **changes}, out.last.shift))
        tell(out.last)


def distance(of: Look) -> float:
    """Distance of sizes and neighbours from what is expected. Much that is left out is far as well."""
    moving = of.moving()
    if not moving:
        return math.inf
    off = [abs(math.log(max(consistency.level(moving, s, odd_of(of)), 1e-12))) + abs(s.rho) + s.left_out / s.ticks for s in moving]
    return sum(off) / len(off)


def has_no_effect(seen: list[tuple[float, float]]) -> bool:
    """True if another value of `model` changes nothing, or makes it worse in the direction in which it should be better."""
    if len(seen) < 2:
        return False
    (a, fa), (b, fb) = seen[-2:]
    return abs(fb - fa) < EFFECT or b > a and fb > fa > 0 or b < a and fb < fa < 0


def odd_of(of: Look) -> Statistics | None:
    return next((s for s in of.known() if s.sensor.name == of.judgement.odd), None)


def size(of: Look) -> float:
    """Size of the innovations of all thermometers that move the estimate, in the geometric mean."""
    moving = of.moving()
    return consistency.geometric([consistency.level(moving, s, odd_of(of)) for s in moving])


def other_changes(of: Look) -> dict[str, float]:
    """`noise`, and what is found of the feed."""
    changes = {name: of.setting.found[name] for name in consistency.too_wide_feed(of.setting)}
    noise = consistency.pooled_noise(of.moving())
    if math.isfinite(noise) and not 1 / STILL < noise / of.setting.noise < STILL:
        changes["noise"] = noise
    return changes


def next_model(of: Look, seen: list[tuple[float, float]], changes: dict[str, float]) -> float:
    """Larger where innovations are larger than expected; 0: as it is."""
    setting, moving = of.setting, of.moving()
    factor = consistency.pooled_factor(moving, odd_of(of), changes.get("noise", setting.noise))
    if len(seen) > 1:
        factor = math.exp(next_point(seen)) / setting.model
    elif seen and abs(seen[0][1]) < math.log(STILL):
        return 0.0
    model = consistency.within(setting.model * consistency.within(factor, (1 / consistency.STEP_MOST, consistency.STEP_MOST)), consistency.MODEL_LIMITS)
    counts = model > setting.model or any(1 - s.noise_share > consistency.LITTLE for s in moving)
    near = 1 / STILL < model / setting.model < STILL or len(seen) > 1 and abs(seen[-1][1]) < math.log(STILL)
    return model if counts and not near else 0.0


def next_point(seen: list[tuple[float, float]]) -> float:
    """Finds where the second is 0: between the nearest on either side, and not at its ends; else along the last two."""
    above, below = [p for p in seen if p[1] > 0], [p for p in seen if p[1] <= 0]
    if above and below:
        (a, fa), (b, fb) = max(above), min(below)
        part = min(max(fa / (fa - fb), 0.15), 0.85)
        return a + part * (b - a)
    (a, fa), (b, fb) = seen[-2:]
    slope = (fb - fa) / (b - a)
    return b - fb / slope if slope < -0.05 else b + math.copysign(math.log(consistency.STEP_MOST), fb)


def reasons(out: Search) -> list[str]:
    """Reasons that remain, by kind."""
    judged = out.best.judgement
    by = {kind: ", ".join(v.name for v in judged.each if v.kind == kind) for kind in ("few", "biased", "high", "low", "correlated", "compared")}
    told = []
    if by["few"]:
        told.append(f"of {by['few']} there are too few innovations")
    if judged.odd:
        told.append(f"{judged.odd} contradicts the others of its section")
    elif by["biased"]:
        told.append(f"{by['biased']}: innovations stay on one side")
    if by["correlated"]:
        told.append(f"{by['correlated']}: innovations are correlated")
    if by["high"] or by["low"]:
        told.append(f"{', '.join(x for x in (by['high'], by['low']) if x)}: one set of numbers does not fit all thermometers")
    if by["compared"]:
        told.append(f"{by['compared']}, which only compares, does not fit")
    return told
