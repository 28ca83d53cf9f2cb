"""Other explanations of a log than a model of tools/identify: readings that stand apart, a drift, an integrator, a dead time beyond the
powers that are tried. Each has an option that takes it into account, and a test of whether it is the likelier story."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Callable

import numpy as np

from reflux import identification, libreflux
from reflux.identification import Fit, Judgement, Orders, Record

GOOD_FIT = 0.8  # with a model as good as this nothing else is looked for
LIKELIER = 0.25  # of the squares that the model leaves on the validation data
BESIDE = 7  # readings of a running median
APART = 10  # times what nine tenths of the readings are off their running median at most
POWERS = 4  # of B in the models that other stories are told with
DELAYS = (6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60)  # rows


# ---- options ----


def running_median(y: np.ndarray) -> np.ndarray:
    padded = np.pad(y, BESIDE // 2, "edge")
    return np.median(np.lib.stride_tricks.sliding_window_view(padded, BESIDE), axis=1)


def apart(y: np.ndarray) -> np.ndarray:
    """Which readings stand apart from those beside them."""
    off = np.abs(y - running_median(y))
    return off > APART * max(float(np.quantile(off, 0.9)), 1e-9 * float(np.ptp(y)))


def despiked(y: np.ndarray) -> np.ndarray:
    return np.where(apart(y), running_median(y), y)


def straightened(record: Record, output: int, border: int) -> np.ndarray:
    """The output without a drift along a straight line, whose slope is found together with a model of the rows before the border."""
    line = np.arange(record.samples) / record.samples - 0.5
    orders = Orders(1, (*((1, POWERS),) * record.inputs, (1, 1)), 0, True)
    model = identification.fit(Record(np.column_stack([record.u, line]), record.y), output, orders, "iv", (0, border))
    return record.y[:, output] - line * sum(model.b()[-1]) / (1 + sum(model.a()))


def with_output(record: Record, output: int, y: np.ndarray) -> Record:
    """The record with other readings of one output."""
    table = record.y.copy()
    table[:, output] = y
    return Record(record.u, table)


def of_differences(record: Record, output: int) -> Record:
    """The record with the steps of one output in its place."""
    y = record.y[:, output]
    return with_output(record, output, np.diff(y, prepend=y[0]))


def integrated(model: Fit) -> Fit:
    """The model of an output from that of its steps: A times 1 - z^-1."""
    a, na = np.concatenate([[1.0], model.a()]), model.orders.na
    sd = np.concatenate([[0.0], model.sd[:na]])
    return replace(model, orders=replace(model.orders, na=na + 1), theta=np.concatenate([np.convolve(a, [1.0, -1.0])[1:], model.theta[na:]]),
                   sd=np.concatenate([np.sqrt(np.convolve(sd**2, [1.0, 1.0]))[1:], model.sd[na:]]))


def delayed(record: Record, rows: int) -> Record:
    """The record with inputs that come so many rows later."""
    return Record(record.u[:-rows], record.y[rows:])


# ---- the likelier story ----

Story = tuple[float, str, str] | None  # fit, words, option


def slowest(model: Fit) -> float:
    """Rows of the slowest time constant; infinite of an integrator."""
    largest = max((abs(p) for p in np.roots([1.0, *model.a()])), default=0.0)
    return math.inf if largest >= 1 else 0.0 if largest == 0 else -1 / math.log(largest)


def of(record: Record, output: int, model: Fit, judged: Judgement, border: int, name: str, every: int) -> str:
    """Names an explanation that is likelier than this model, with the option that takes it into account; nothing where the model is as good as any."""
    if judged.fit() < GOOD_FIT:
        stories = [story for story in (spikes(record, output, model, border), drift(record, output, model, border),
                                       integrator(record, output, judged, border, name), dead_time(record, output, judged, border, every)) if story]
        if stories:
            fit, words, option = max(stories)
            return f"{name}: probably {words} (fit {100 * fit:.0f} % when that is taken into account, {100 * judged.fit():.0f} % now): use {option}"
    if judged.fit() <= 0:
        return no_better(name, judged)
    if slowest(model) > border:
        return (f"{name}: an integrator, or slower than the log can tell: its slowest time constant is {slowest(model):.4g} rows, the model is made of "
                f"{border}; the gains at rest are not known. Use --integrates {name}, or a longer log")
    return ""


def no_better(name: str, judged: Judgement) -> str:
    return f"{name}: the model is no better than the mean of the readings (fit {100 * judged.fit():.1f} %): do not use it"


def rival(record: Record, output: int, border: int, make: Callable[[Fit], Fit] = lambda model: model, source: Record | None = None) -> Judgement | None:
    """Error of the best of a few plain models on the validation data. source: the record they are made of, where that is another record."""
    found = []
    for na, method in ((1, "iv"), (2, "iv"), (1, "ls"), (2, "ls")):
        try:
            model = identification.fit(source or record, output, Orders(na, ((1, POWERS),) * record.inputs, 0, True), method, (0, border))
            found.append(identification.judge(record, output, make(model), (border, record.samples)))
        except libreflux.Refused:  # an unstable model on the way, or too few rows
            continue
    return min(found, key=lambda judged: judged.simulated, default=None)


def better(found: Judgement | None, squares: float, words: str, option: str) -> Story:
    """The story, if its model leaves less than LIKELIER of the squares of the other one."""
    return (found.fit(), words, option) if found and found.simulated < LIKELIER * squares and found.fit() > 0 else None


def cleared(clean: Record, output: int, model: Fit, border: int, words: str, option: str) -> Story:
    """Both models are judged on the record without what the story says."""
    left = identification.judge(clean, output, model, (border, clean.samples)).simulated
    return better(rival(clean, output, border), left, words, option)


def spikes(record: Record, output: int, model: Fit, border: int) -> Story:
    y = record.y[:, output]
    count = int(apart(y).sum())
    words = f"{count} readings that stand apart from those beside them"
    return cleared(with_output(record, output, despiked(y)), output, model, border, words, "--despike") if count else None


def drift(record: Record, output: int, model: Fit, border: int) -> Story:
    try:
        return cleared(with_output(record, output, straightened(record, output, border)), output, model, border, "a drift", "--drift")
    except libreflux.Refused:
        return None


def integrator(record: Record, output: int, judged: Judgement, border: int, name: str) -> Story:
    found = rival(record, output, border, integrated, of_differences(record, output))
    return better(found, judged.simulated, "an integrator", f"--integrates {name}")


def dead_time(record: Record, output: int, judged: Judgement, border: int, every: int) -> Story:
    found = [better(rival(delayed(record, rows), output, border - rows), judged.simulated, f"a dead time of some {rows * every} rows", f"--every {rows * every}")
             for rows in DELAYS if rows < record.samples // 10]
    return max((story for story in found if story), default=None)
