"""Innovations of thermometers: how large they are beside what a filter expects, whether each can be told from the one before, whether they
stay on one side. docs/methods/consistency.md has the formulas. Kelvin."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from reflux.recorded_run import GOOD, Block, Recorded, Sensor
from reflux.replay import Replay

CONFIDENCE = 0.99
LAGS_MOST = 400
PERIOD_SHARE = 0.3  # of the variance, within a peak this wide: they swing
SWING_TICKS = 20  # a swing as short as that counts as noise
PEAK_LINES = 2  # of the spectrum, either side


@dataclass
class Series:
    """Innovations of one thermometer. tick: which ticks, for neighbours only are compared; variance: what the filter expects of e^2."""

    sensor: Sensor
    tick: np.ndarray
    e: np.ndarray
    variance: np.ndarray
    reading: np.ndarray
    left_out: int = 0  # ticks within the time looked at without an innovation that counts


@dataclass
class Statistics:
    sensor: Sensor
    ticks: int
    left_out: int
    nis: float  # mean of e^2 over what is expected
    low: float  # within which it lies where the filter is right
    high: float
    spread: float  # the same about the mean of e: nis less mean^2
    rho: float  # of neighbours, about the mean
    rho_limit: float
    independent: float  # so many independent squares say as much
    mean: float  # in standard deviations
    mean_k: float
    mean_error: float  # standard deviation of the mean, in the same unit as mean
    expected: float  # K^2, mean of what is expected
    noise_share: float  # of the set noise's variance in it; less it 1: how far a reading draws the estimate
    own_noise: float  # K, of the readings
    period: float  # ticks of a swing, or 0


def series(of: Recorded, block: Block, replay: Replay, first_s: float, last_s: float, shift: dict[str, float]) -> list[Series]:
    gate = float(replay.settings.get("gate", "0"))
    at = np.array(of.time_s)
    place = {c.name: i for i, c in enumerate(of.measured)}
    out = []
    for sensor in block.sensors:
        e, nis = np.array(replay.values_of(f"e_{sensor.number}")), np.array(replay.values_of(f"nis_{sensor.number}"))
        column = [row[place[sensor.name]] for row in of.readings]
        good = np.array([quality == GOOD for _, quality in column])
        reading = sensor.factor * (np.array([x for x, _ in column]) + shift.get(sensor.name, 0.0))
        within = (at >= first_s) & (at <= last_s)
        # A value that did not count in a tick stands where it was.
        moved = np.concatenate([[False], (np.diff(e) != 0) & (np.diff(nis) != 0)])
        counts = within & good & moved & (nis > 0) & (e != 0)
        if gate > 0:
            counts &= np.abs(e) <= gate
        k = np.flatnonzero(counts)
        with np.errstate(divide="ignore", invalid="ignore"):
            out.append(Series(sensor, k, e[k], e[k] ** 2 / nis[k], reading[k], int(within.sum()) - len(k)))
    return out


def begins_s(of: Recorded, block: Block, replay: Replay) -> float:
    """When the monitor counts for the first time; infinite: never."""
    nis = np.array([replay.values_of(f"nis_{s.number}") for s in block.sensors])
    counted = np.flatnonzero((nis > 0).any(0))
    return of.time_s[counted[0]] if len(counted) else math.inf


# ---- numbers ----


def autocorrelation(u: np.ndarray, tick: np.ndarray, lags: int) -> np.ndarray:
    """About the mean, of lags 1 and up. Gaps between ticks are filled with the mean, and their pairs not counted."""
    first = tick[0]
    line, there = np.zeros(tick[-1] - first + 1), np.zeros(tick[-1] - first + 1)
    line[tick - first], there[tick - first] = u - u.mean(), 1.0
    size = 2 ** math.ceil(math.log2(2 * len(line)))

    def products(x: np.ndarray) -> np.ndarray:
        f = np.fft.rfft(x, size)
        return np.fft.irfft(f * np.conj(f), size)[: lags + 1]

    found, pairs = products(line), np.maximum(np.round(products(there)), 1.0)
    variance = found[0] / pairs[0]
    return found[1:] / pairs[1:] / variance if variance > 0 else np.zeros(lags)


def until_noise(r: np.ndarray, n: int) -> np.ndarray:
    """The lags up to the first of three in a row that chance alone could give."""
    small = np.abs(r) < 2 / math.sqrt(n)
    together = np.flatnonzero(small[:-2] & small[1:-1] & small[2:])
    return r[: together[0] if len(together) else len(r)]


def swing(u: np.ndarray, tick: np.ndarray) -> float:
    """Ticks of the period in which a large part of the variance is, or 0."""
    if len(u) < 64 or tick[-1] - tick[0] + 1 > 1.2 * len(u):
        return 0.0
    line = np.zeros(tick[-1] - tick[0] + 1)
    line[tick - tick[0]] = u - u.mean()
    power = np.abs(np.fft.rfft(line * np.hanning(len(line)))) ** 2
    drift = 4 * PEAK_LINES  # fewer swings in all are none
    peak = drift + int(power[drift:].argmax())
    around = power[max(drift, peak - PEAK_LINES) : peak + PEAK_LINES + 1].sum()
    clear = around > power[:drift].sum() and around > PERIOD_SHARE * power.sum()
    return len(line) / peak if clear else 0.0


def own_noise(reading: np.ndarray, tick: np.ndarray) -> float:
    """Standard deviation of white noise upon what moves evenly over three ticks: second differences have six times its variance."""
    together = np.flatnonzero((np.diff(tick)[1:] == 1) & (np.diff(tick)[:-1] == 1))
    if len(together) < 8:
        return math.nan
    second = reading[together] - 2 * reading[together + 1] + reading[together + 2]
    return math.sqrt(float((second**2).mean()) / 6)


def swinging_noise(reading: np.ndarray, period: float) -> float:
    """With a swing of few ticks, which no model follows: what is left of readings without their mean over a period."""
    width = max(2, round(period))
    mean = np.convolve(reading, np.full(width, 1 / width), "valid")
    return float((reading[width // 2 :][: len(mean)] - mean).std())


def statistics(s: Series, noise: float) -> Statistics | None:
    """None: there are too few of them for any number."""
    n = len(s.e)
    if n < 16:
        return None
    u = s.e / np.sqrt(s.variance)
    r = autocorrelation(u, s.tick, min(LAGS_MOST, n // 4))
    kept = until_noise(r, n)
    independent = n / (1 + 2 * float((kept**2).sum()))
    for_mean = n / max(1.0, 1 + 2 * float(kept.sum()))
    low, high = (float(chi2.ppf(p, independent)) / independent for p in ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2))
    expected = float(s.variance.mean())
    mean = float(u.mean())
    period = swing(u, s.tick)
    noise_k = swinging_noise(s.reading, period) if 0 < period <= SWING_TICKS else own_noise(s.reading, s.tick)
    return Statistics(
        sensor=s.sensor,
        ticks=n,
        left_out=s.left_out,
        nis=float((u**2).mean()),
        low=low,
        high=high,
        spread=float(u.var()),
        rho=float(r[0]),
        rho_limit=float(chi2.ppf(CONFIDENCE, 1)) ** 0.5 / math.sqrt(n),
        independent=independent,
        mean=mean,
        mean_k=float(s.e.mean()),
        mean_error=math.sqrt(float(u.var()) / for_mean),
        expected=expected,
        noise_share=min(1.0, noise * noise / expected),
        own_noise=noise_k,
        period=period,
    )
