"""Which stages to measure, by rules that can be said in a sentence (docs/methods/gradients.md). The source chooses by eye; its words became
rules with thresholds, which are ours."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reflux.gradients import Diagram


@dataclass(frozen=True)
class Thresholds:
    half: float = 0.5  # of the section's steepest step: candidates for control and estimation
    second: float = 0.35  # the same for a secondary temperature
    margin: int = 2  # stages kept away from reboiler, condenser and feed
    near_feed: int = 4  # stages from the feed for a secondary that sees disturbances early
    flat: float = 0.3  # K: a section whose steepest step is less has nothing to measure
    even: float = 0.2  # of the column's steepest step: stages below it have one temperature, nearly
    run: int = 3  # stages that such a region has at least
    model: float = 0.05  # part of all shares that a component has at least to be modelled
    alien: float = 0.02  # part of a stage's shares that components which are not modelled may have


@dataclass(frozen=True)
class Choice:
    section: str  # "stripping" or "enriching"
    candidates: tuple[int, ...]
    by_keys: int | None  # rule A: of the candidates the one whose gradient is most due to the keys
    by_product: int | None  # rule B: largest gradient times that part
    second: int | None  # beside it, by rule A with a lower threshold
    near_feed: int | None
    reason: str


def keys_of(
    top: Sequence[float], bottom: Sequence[float], names: Sequence[str], heavier: Sequence[float]
) -> tuple[str, str] | None:
    """Light and heavy key: neighbours in volatility of which one goes mostly up and the other mostly down. heavier: any number that rises
    with the boiling point. None where there is no such pair."""
    order = sorted(range(len(names)), key=lambda j: heavier[j])
    for light, heavy in zip(order, order[1:]):
        if top[light] > bottom[light] and top[heavy] < bottom[heavy]:
            return names[light], names[heavy]
    return None


def section_stages(of: Diagram, feed: int, section: str, margin: int) -> range:
    """Stages whose step lies in the section, away from its ends."""
    if section == "stripping":
        return range(1 + margin, feed - margin + 1)
    return range(feed + margin, of.stages - margin)


def choose(of: Diagram, feed: int, section: str, keys: Sequence[str], t: Thresholds) -> Choice:
    def size(s: int) -> float:
        return abs(of.gradient[s - 1])

    def part(s: int) -> float:
        return of.part_of(s, keys)

    def none(reason: str) -> Choice:
        return Choice(section, (), None, None, None, None, f"I do not know: {reason}.")

    stages = section_stages(of, feed, section, t.margin)
    if len(stages) == 0:
        return none(f"the {section} section has no stage that is {t.margin} away from its ends")
    peak = max(size(s) for s in stages)
    steepest = max(stages, key=size)
    if peak < t.flat:
        return none(
            f"nowhere in the {section} section does the temperature change by {t.flat:g} K from stage to stage (at most {peak:.2g} K, "
            f"stage {steepest}); a temperature there says nothing of a composition"
        )
    candidates = tuple(s for s in stages if size(s) >= t.half * peak)
    if not of.share:
        return Choice(
            section,
            candidates,
            None,
            steepest,
            None,
            None,
            f"steepest on stage {steepest} ({of.gradient[steepest - 1]:+.2f} K); what components have to do with it is not known, so only the "
            "gradient counts.",
        )
    by_product = max(stages, key=lambda s: size(s) * part(s))
    all_keys = set(keys) >= set(of.names)  # nothing is lost to others, and only rounding would tell stages apart
    by_keys = None if all_keys else max(candidates, key=part)
    others = [s for s in stages if size(s) >= t.second * peak and s != (by_keys or by_product)]
    second = max(others, key=size if all_keys else part, default=None)
    close = feed + t.near_feed if section == "enriching" else feed - t.near_feed
    near = close if close in stages and close != second and size(close) >= 0.1 * peak else None
    if by_keys is None:
        return Choice(
            section,
            candidates,
            None,
            by_product,
            second,
            near,
            f"steepest on stage {steepest} ({of.gradient[steepest - 1]:+.2f} K); candidates, half as steep or more: {runs(candidates)}. All components are "
            "keys, so that only the gradient counts.",
        )
    words = (
        f"steepest on stage {steepest} ({of.gradient[steepest - 1]:+.2f} K); candidates, half as steep or more: {runs(candidates)}. Rule A, most due to "
        f"the keys: stage {by_keys} ({100 * part(by_keys):.0f} %, {of.gradient[by_keys - 1]:+.2f} K). Rule B, gradient times that part: stage {by_product} "
        f"({100 * part(by_product):.0f} %, {of.gradient[by_product - 1]:+.2f} K)."
    )
    if abs(by_keys - by_product) > 1:
        words += " The rules disagree: A says less is lost to other components, B that more is seen; both are worth a simulation."
    return Choice(section, candidates, by_keys, by_product, second, near, words)


def runs(stages: Sequence[int]) -> str:
    """3 to 6, 8"""
    out: list[list[int]] = []
    for s in stages:
        if out and s == out[-1][-1] + 1:
            out[-1].append(s)
        else:
            out.append([s])
    return ", ".join(f"{r[0]} to {r[-1]}" if len(r) > 1 else str(r[0]) for r in out) or "none"


# ---- estimation ----


@dataclass(frozen=True)
class Estimation:
    modelled: tuple[str, ...]
    parts: dict[str, float]  # of all shares over the column
    sensors: tuple[int, ...]
    innovated: dict[int, str]  # at each sensor the component with the largest share
    averaged: tuple[tuple[int, int], ...]  # first and last stage of regions of nearly one temperature


def steep_stages(of: Diagram, feed: int, above: bool, t: Thresholds) -> list[int]:
    """Returns the stages of a section whose step is at least `half` of its steepest; none where it has one temperature, nearly. The reboiler's step and
    the one into the condenser do not count."""
    stages = [s for s in range(2, of.stages - 1) if s != feed and (s > feed) == above]
    steepest = max((abs(of.gradient[s - 1]) for s in stages), default=0.0)
    return [s for s in stages if abs(of.gradient[s - 1]) >= t.half * steepest] if steepest >= t.flat else []


def estimation(of: Diagram, feed: int, t: Thresholds) -> Estimation:
    """Thermometers that an estimator needs; nothing where the shares are not known."""
    peak = max(abs(g) for g in of.gradient)
    averaged = even_regions(of, feed, t.even * peak, t.run)
    if not of.share:
        return Estimation((), {}, (), {}, averaged)
    sizes = [sum(abs(row[j]) for row in of.share) for j in range(len(of.names))]
    parts = {name: size / sum(sizes) for name, size in zip(of.names, sizes)} if sum(sizes) else {}
    modelled = tuple(name for name in of.names if parts.get(name, 0.0) >= t.model)
    sensors = [s for above in (False, True) for s in steep_stages(of, feed, above, t) if 1 - of.part_of(s, modelled) <= t.alien]
    innovated = {s: of.names[max(range(len(of.names)), key=lambda j: abs(of.share[s - 1][j]))] for s in sensors}
    return Estimation(modelled, parts, tuple(sensors), innovated, averaged)


def even_regions(of: Diagram, feed: int, most: float, least: int) -> tuple[tuple[int, int], ...]:
    """Runs of stages between which the temperature hardly changes; never across the feed."""
    out, first = [], None
    for s in range(1, of.stages + 1):
        even = s < of.stages and abs(of.gradient[s - 1]) <= most and s != feed and s + 1 != feed
        if even and first is None:
            first = s
        if not even and first is not None:
            if s - first + 1 >= least:
                out.append((first, s))
            first = None
    return tuple(out)


# ---- other methods ----


@dataclass(frozen=True)
class Steps:
    """Steady temperatures after a step of one input up and down, less those before it, K."""

    input: str
    up: list[float]
    down: list[float]

    def mean(self, stage: int) -> float:
        return (abs(self.up[stage - 1]) + abs(self.down[stage - 1])) / 2

    def asymmetry(self, stage: int) -> float:
        """0: the same up and down; 1: only one of them moves it."""
        both = abs(self.up[stage - 1]) + abs(self.down[stage - 1])
        return abs(self.up[stage - 1] + self.down[stage - 1]) / both if both else 0.0

    def best(self) -> int | None:
        """Largest and most symmetric; None where steps up and down do not move any stage in opposite ways."""
        stage = max(range(1, len(self.up) + 1), key=lambda s: self.mean(s) * (1 - self.asymmetry(s)))
        return stage if self.mean(stage) > 0 and self.asymmetry(stage) < 0.9 else None


def singular(steps: Sequence[Steps]) -> tuple[list[int], list[float]]:
    """Moore: SVD of what a step of each input does to all stages; of each direction the stage that sees most
    of it, and the singular values, K."""
    import numpy as np

    gain = np.array([[(u - d) / 2 for u, d in zip(s.up, s.down)] for s in steps]).T
    u, values, _ = np.linalg.svd(gain, full_matrices=False)
    chosen: list[int] = []
    for k in range(len(values)):
        order = np.argsort(-np.abs(u[:, k]))
        chosen.append(int(next(s for s in order if int(s) + 1 not in chosen)) + 1)
    return chosen, [float(v) for v in values]


def condition(steps: Sequence[Steps], stages: Sequence[int]) -> float:
    import numpy as np

    gain = np.array([[(s.up[k - 1] - s.down[k - 1]) / 2 for s in steps] for k in stages])
    values = np.linalg.svd(gain, compute_uv=False)
    return float(values[0] / values[-1]) if values[-1] else math.inf
