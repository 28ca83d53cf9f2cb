"""Judges the covariances of a filter by its innovations, in words, and says what to set instead. docs/methods/consistency.md has the reasons."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from reflux.innovations import Statistics

FEW = 50  # innovations: nothing is known from fewer
FEW_INDEPENDENT = 20.0  # nor from fewer independent ones, but that they are correlated
NIS_NEAR = (0.8, 1.25)  # near enough to 1, however surely it is not 1
RHO_NEAR = 0.15
MEAN_NEAR = 0.3  # standard deviations
SURE = 3.0  # standard deviations of a mean
AGREE = 1 / 3  # the others of a section agree when they are apart by no more than that part of what the odd one is off
DRAWN = 1.5  # and one that is wrong does not draw them farther than that away; else the model is off
UNLIKE = 1.5  # noise of two thermometers, one over the other
LITTLE = 0.02  # of the noise's variance: less is left to the model by no proposal
STEP_MOST = 4.0  # by which `model` is changed at once
NOISE_LIMITS, MODEL_LIMITS = (0.001, 100.0), (1e-6, 100.0)
FEED_WIDE, FEED_MOST = 2.0, 0.3  # what is found of the feed over what it is said to be; more than the second is no feed's
WITH_FEED = ("ekf", "kalman")


@dataclass
class Setting:
    """Settings of the filter."""

    method: str
    noise: float
    model: float
    feed: dict[str, float] = field(default_factory=dict)  # feed_z, feed_f
    found: dict[str, float] = field(default_factory=dict)  # the same as the filter has found them, root of their mean square


@dataclass
class Verdict:
    name: str
    consistent: bool
    words: str
    kind: str  # few, compared, consistent, biased, high, low, correlated


@dataclass
class Judgement:
    each: list[Verdict]
    odd: str  # the thermometer that stands out, or nothing
    odd_k: float  # K, against the others of its section
    notes: list[str]
    changes: dict[str, float]  # parameter and its new value
    consistent: bool


def figure(x: float) -> str:
    return f"{x:.2g}" if abs(x) < 100 else f"{x:.0f}"


def says_something(s: Statistics) -> bool:
    return s.ticks >= FEW and (s.independent >= FEW_INDEPENDENT or not is_white(s))


def is_near(nis: float) -> bool:
    return NIS_NEAR[0] <= nis <= NIS_NEAR[1]


def is_level(s: Statistics) -> bool:
    return s.low <= s.spread <= s.high or is_near(s.spread)


def is_white(s: Statistics) -> bool:
    return abs(s.rho) <= max(RHO_NEAR, s.rho_limit)


def is_biased(s: Statistics) -> bool:
    return abs(s.mean) > MEAN_NEAR and abs(s.mean) > SURE * s.mean_error


# ---- what would be right ----


def noise_of(s: Statistics) -> float:
    """K. The readings' own, which cannot be more than the innovations have; without it, what the innovations say where a tick changes little."""
    whole = s.spread * s.expected
    if math.isfinite(s.own_noise):
        return math.sqrt(min(s.own_noise**2, whole))
    left = s.noise_share - s.rho  # of Mehra, 1970, for one state that stays as it is
    return math.sqrt(whole * left) if left > LITTLE else math.nan


def level(known: list[Statistics], one: Statistics, odd: Statistics | None) -> float:
    """Mean square of the innovations over what is expected, with the mean that a section has in common: that is the model's, and a covariance
    may cover it. Not where one thermometer contradicts the others, for it draws them."""
    section = [s for s in known if s.sensor.above == one.sensor.above]
    common = sum(s.mean_k for s in section) / len(section) if odd not in section else 0.0
    return one.spread + common * common / one.expected


def model_factor(s: Statistics, size: float, noise: float) -> float:
    """By what `model` has to be multiplied for innovations of this size (`level`) to be as expected, beside this noise."""
    def driven(drawn: float, readings: float) -> float:  # variance that a tick brings, of one state that stays as it is
        return drawn * drawn / (drawn + readings)

    had, wanted = s.expected * (1 - s.noise_share), size * s.expected - noise * noise
    was = driven(max(had, LITTLE * s.expected * s.noise_share), s.expected * s.noise_share)
    factor = math.sqrt(driven(max(wanted, LITTLE * noise * noise), noise * noise) / was)
    return within(factor, (1 / STEP_MOST, STEP_MOST))


def within(x: float, limits: tuple[float, float]) -> float:
    return min(max(x, limits[0]), limits[1])


def pooled_noise(known: list[Statistics]) -> float:
    values = [v for v in map(noise_of, known) if math.isfinite(v)]
    return within(math.sqrt(sum(v * v for v in values) / len(values)), NOISE_LIMITS) if values else math.nan


def geometric(values: list[float]) -> float:
    return math.exp(sum(math.log(max(v, 1e-12)) for v in values) / len(values))


def pooled_factor(known: list[Statistics], odd: Statistics | None, noise: float) -> float:
    return geometric([model_factor(s, level(known, s, odd), noise) for s in known])


# ---- one that contradicts the others ----


def odd_one(known: list[Statistics]) -> tuple[Statistics | None, float]:
    """The thermometer whose mean the others of its section do not have, while they agree; and by how many kelvin it is off them."""
    for above in (True, False):
        section = [s for s in known if s.sensor.above == above]
        if len(section) < 3:
            continue
        far = max(section, key=lambda s: abs(s.mean_k - mean_of_others(section, s)))
        away = far.mean_k - mean_of_others(section, far)
        others = [s.mean_k for s in section if s is not far]
        scale = math.sqrt(far.expected)
        sure = abs(away) > SURE * scale * math.sqrt(sum(s.mean_error**2 for s in section))
        alike = max(others) - min(others) <= AGREE * abs(away) and abs(sum(others)) / len(others) <= DRAWN * abs(away)
        if sure and abs(away) > MEAN_NEAR * scale and alike:
            return far, away
    return None, 0.0


def mean_of_others(section: list[Statistics], one: Statistics) -> float:
    return sum(s.mean_k for s in section if s is not one) / (len(section) - 1)


# ---- in words ----


def judge(all_of_them: list[Statistics], missing: list[str], setting: Setting, tick_s: float) -> Judgement:
    """missing: names of thermometers of which there is hardly an innovation."""
    known = [s for s in all_of_them if says_something(s)]
    moving = [s for s in known if s.sensor.moves]
    odd, away = odd_one(known)
    each = [Verdict(name, False, "I do not know: hardly a reading counts (missing, beyond the gate, or the run is too short).", "few") for name in missing]
    each += [verdict(s, odd, away, setting, tick_s) for s in all_of_them]
    notes = [*section_notes(known, odd), *likeness(moving)]
    changes = changes_for(moving, odd, each, setting)
    return Judgement(each, odd.sensor.name if odd else "", away, notes, changes, bool(each) and all(v.consistent for v in each))


def verdict(s: Statistics, odd: Statistics | None, away: float, setting: Setting, tick_s: float) -> Verdict:
    name = s.sensor.name
    if not says_something(s):
        return Verdict(name, False, f"I do not know: {s.ticks} innovations, worth {figure(s.independent)} independent ones, are too few; a longer run says it.", "few")
    swings = f" They swing with a period of {s.period * tick_s:.0f} s, which no noise does." if s.period and not is_white(s) else ""
    if odd is s:
        return Verdict(name, False, f"its innovations are {away:+.2f} K off those of the others of its section, which agree: an offset of this one. Do not widen a "
                       "covariance for it.", "biased")
    if is_biased(s):
        return Verdict(name, False, f"innovations stay on one side: {s.mean:+.2f} standard deviations, {s.mean_k:+.2f} K. No covariance takes that off.{swings}", "biased")
    if not s.sensor.moves:
        fits = is_level(s)
        return Verdict(name, fits, "is only compared: its squares are over `noise` alone" + (", and no larger." if fits else f", {figure(s.spread)} times that."), "compared")
    if is_level(s) and is_white(s):
        return Verdict(name, True, "consistent.", "consistent")
    return unbiased(s, setting, swings)


def unbiased(s: Statistics, setting: Setting, swings: str) -> Verdict:
    name, noise = s.sensor.name, noise_of(s)
    own = f"; its readings have a noise of {figure(noise)} K" if math.isfinite(noise) else ""
    what = uncertain_model(setting)
    if is_white(s):
        if s.spread > 1:
            explained = not math.isfinite(noise) or noise**2 >= s.spread * s.expected / 2
            cause = "`noise` is too small" if explained else f"{what} is too small"
            return Verdict(name, False, f"innovations are {figure(s.spread)} times what is expected, and white: {cause}{own}.", "high")
        cause = "`noise` is too large" if not math.isfinite(noise) or noise < 0.9 * setting.noise else f"{what} is too large"
        return Verdict(name, False, f"innovations are {figure(s.spread)} times what is expected, and white: {cause}{own}.", "low")
    if s.rho > 0 and s.spread <= max(1.0, s.high):
        told = f"innovations are {figure(s.spread)} times what is expected, no more, but correlated ({s.rho:+.2f})"
        if math.isfinite(noise) and noise < 0.8 * setting.noise:
            return Verdict(name, False, f"{told}: `noise` is too large for it{own}.{swings}", "correlated")
        return Verdict(name, False, f"{told}: something moves the readings that neither the model nor its covariances describe{own}.{swings}", "correlated")
    if s.rho > 0:
        told = f"innovations are {figure(s.spread)} times what is expected, and correlated ({s.rho:+.2f}): the estimate follows too slowly"
        return Verdict(name, False, f"{told}; {what} is too small, or the model is wrong there{own}.{swings}", "correlated")
    told = f"innovations are {figure(s.spread)} times what is expected, and each takes back a part of the one before ({s.rho:+.2f})"
    cause = "`noise` is too small" if math.isfinite(noise) and noise > 1.25 * setting.noise else f"{what} is too large beside `noise`"
    return Verdict(name, False, f"{told}: the estimate follows the noise; {cause}{own}.{swings}", "correlated")


def uncertain_model(setting: Setting) -> str:
    if setting.method not in WITH_FEED:
        return "`model`"
    wide = too_wide_feed(setting)
    return f"`{wide[0]}`" if wide else "`model`, or `feed_z` and `feed_f`,"


def too_wide_feed(setting: Setting) -> list[str]:
    """Words for a feed that moves more than its settings say."""
    return [name for name, sd in setting.feed.items() if sd > 0 and FEED_MOST > setting.found.get(name, 0.0) > FEED_WIDE * sd]


def section_notes(known: list[Statistics], odd: Statistics | None) -> list[str]:
    out = []
    for above, where in ((True, "above the feed"), (False, "below the feed")):
        section = [s for s in known if s.sensor.above == above]
        off = [s for s in section if is_biased(s)]
        if not off or odd in section:
            continue
        names = ", ".join(s.sensor.name for s in off)
        signs = {s.mean > 0 for s in section}
        if len(section) == 1:
            out.append(f"{names} is alone {where}: whether it or the model is off I do not know.")
        elif len(off) == len(section) and len(signs) == 1:
            out.append(f"All thermometers {where} ({names}) are off to the same side: rather the model, its feed, heat, reflux or pressure, than each of them.")
        elif len(section) == 2:
            out.append(f"The two thermometers {where} contradict each other or the model; which of the three is wrong I do not know. A third would say it.")
        else:
            out.append(f"{names} {where}: none stands out against the others, so the model is as likely to be wrong as a thermometer. I do not know which.")
    return out


def likeness(moving: list[Statistics]) -> list[str]:
    noises = {s.sensor.name: n for s in moving if math.isfinite(n := noise_of(s)) and n > 0}
    if len(noises) < 2:
        return []
    low, high = min(noises, key=noises.__getitem__), max(noises, key=noises.__getitem__)
    if noises[high] <= UNLIKE * noises[low]:
        return []
    return [f"{high} is noisier than {low} ({figure(noises[high])} and {figure(noises[low])} K), and a block has one `noise` for all: mend or filter {high}."]


def changes_for(moving: list[Statistics], odd: Statistics | None, each: list[Verdict], setting: Setting) -> dict[str, float]:
    wrong = {v.name for v in each if not v.consistent}
    if not any(s.sensor.name in wrong for s in moving) or all(is_near(level(moving, s, odd)) and is_level(s) and is_white(s) for s in moving):
        return {}
    out: dict[str, float] = {}
    noise = pooled_noise(moving)
    if math.isfinite(noise) and abs(noise / setting.noise - 1) > 0.1:
        out["noise"] = noise
    wide = too_wide_feed(setting)
    out |= {name: setting.found[name] for name in wide}
    factor = pooled_factor(moving, odd, out.get("noise", setting.noise))
    if not wide and abs(factor - 1) > 0.1:
        out["model"] = within(setting.model * factor, MODEL_LIMITS)
    return out
