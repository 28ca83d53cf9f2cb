"""Plots of a start-up."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from reflux.commission import frequency
from reflux.commission.record import Experiment, Record
from reflux.commission.results import Element
from reflux.plots import BLUE, GREEN, GREY, ORANGE, STYLE, Plot, finish, plt

ONE_COLUMN = 4       # outputs that stand one below the other
LEGEND_MOST = 10     # lines that are named
FEW = 16             # relative gains that are all drawn; of more, those of the pairs
SHOW_LIMIT = 0.35    # of a limit: from here on it is drawn beside the response
COLOURS = (*plt.get_cmap("tab20").colors[::2], *plt.get_cmap("tab20").colors[1::2])


def plots(r: Record) -> list[Plot]:
    with plt.rc_context(STYLE):
        out: list[Plot | None] = [overview(r)] if r.experiments else []
        out += [experiment(r, e) for e in r.experiments]
        if r.gains.singular:
            out += [rga(r), singular(r)]
        if r.trial:
            out.append(trial(r))
    return [p for p in out if p]


def picture(figure: Any, name: str, caption: str) -> Plot:
    """As a PNG alone: telemetry has too many points for drawings."""
    return finish(figure, name, caption, with_svg=False)


def scale(seconds: float) -> tuple[float, str]:
    return (60.0, "min") if seconds < 3 * 3600 else (3600.0, "h")


def rest(r: Record, e: Experiment, name: str) -> float:
    """Mean before the step: what the limits count from."""
    y = np.array(r.column(name))[e.first:e.step + 1]
    return float(np.mean(y[np.isfinite(y)])) if np.isfinite(y).any() else math.nan


def baseline(t: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Level and drift of what the model leaves over, as the fit has them too."""
    known = np.isfinite(left)
    at = t - t[0]
    return np.polyval(np.polyfit(at[known], left[known], 1), at) if np.count_nonzero(known) > 2 else np.zeros(len(t))


def response(t: np.ndarray, u: np.ndarray, e: Element) -> np.ndarray:
    """First order with dead time, from rest: the steps of u one by one."""
    out = np.zeros(len(t))
    moves = np.flatnonzero(np.diff(u)) + 1
    for k in moves:
        since = t - t[k] - e.dead_s
        lag = 1 - np.exp(-np.maximum(since, 0) / e.time_s) if e.time_s > 0 else 1.0
        out += np.where(since > 0, e.gain * (u[k] - u[k - 1]) * lag, 0.0)
    return out


# ---- experiments ----

def overview(r: Record) -> Plot:
    """Every output as a share of its limit, every input around where it was held."""
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(9.6, 5.4), sharex=True, height_ratios=(3, 2))
    t = np.array(r.time)
    first, last = r.experiments[0].first, r.experiments[-1].last
    by, unit = scale(t[last - 1] - t[first])
    names = r.model.measurements() or [n for n, c in r.channels.items() if not math.isnan(c.limit)]
    for k, name in enumerate(names):
        for n, e in enumerate(r.experiments):
            rows = slice(e.first, e.last)
            y = 100 * (np.array(r.column(name))[rows] - rest(r, e, name)) / r.channels[name].limit
            upper.plot((t[rows] - t[first]) / by, y, color=COLOURS[k % 20], linewidth=1.0,
                       label=name if n == 0 and k < LEGEND_MOST else None)
    for sign in (1, -1):
        upper.axhline(100 * sign, color=ORANGE, linewidth=1.0, linestyle="--",
                      label="limit" if sign > 0 else None)
    upper.set_ylabel("from rest [% of its limit]")
    upper.legend(loc="upper right", ncols=6, fontsize=7.5)
    for k, name in enumerate(dict.fromkeys(e.input for e in r.experiments)):
        c = r.channels[name]
        u = np.array(r.column(f"{name}.cmd"))[first:last]
        lower.step((t[first:last] - t[first]) / by, 100 * (u - u[0]) / c.span, where="post", linewidth=1.1,
                   color=COLOURS[k % 20], label=name if k < LEGEND_MOST else None)
    lower.set_ylabel("input, from where\nit was held [% of span]")
    lower.legend(loc="upper right", ncols=6, fontsize=7.5)
    lower.set_xlabel(f"plant time since the first step [{unit}]")
    for e in r.experiments:
        for ax in (upper, lower):
            ax.axvline((t[e.step] - t[first]) / by, color=GREY, linewidth=0.7, linestyle=(0, (4, 3)))
    return picture(figure, "tests", "All tests: each output as a share of its limit (dashed), each input around where it was "
                  "held. Grey: a test begins.")


def experiment(r: Record, e: Experiment) -> Plot:
    names = r.model.measurements() or [n for n, c in r.channels.items() if not math.isnan(c.limit)]
    columns = 1 if len(names) <= ONE_COLUMN else 2 if len(names) <= 10 else 3
    rows = -(-(len(names) + 1) // columns)
    figure, grid = plt.subplots(rows, columns, figsize=(9.6, 0.7 + (1.55 if columns == 1 else 1.35) * rows), sharex=True,
                                squeeze=False)
    axes = list(grid.flat)
    span = slice(e.first, e.last)
    t = np.array(r.time)[span]
    by, unit = scale(t[-1] - t[0])
    x = (t - r.time[e.step]) / by
    u = np.array(r.column(f"{e.input}.cmd"))[span]
    axes[0].step(x, u, where="post", color=GREEN, linewidth=1.3)
    axes[0].set_ylabel(f"{e.input}\n[{r.channels[e.input].unit}]")
    axes[0].margins(y=0.15)
    for ax, name in zip(axes[1:], names):
        _fit(ax, r, e, name, x, t, u)
    for ax in axes[len(names) + 1:]:
        ax.set_visible(False)
    for ax in axes[max(0, len(names) + 1 - columns):len(names) + 1]:
        ax.set_xlabel(f"since the step [{unit}]")
        ax.tick_params(labelbottom=True)
    figure.align_ylabels()
    words = "; ".join([*e.remarks, *([] if e.done else ["the start-up ended in this test"])])
    return picture(figure, f"test-{e.input}-{e.round}",
                  f"Test of {e.input}, round {e.round}: measured (blue), model of all rounds with level and drift of "
                  f"this test (orange), limits where they are near (dashed)"
                  f"{'; ' + words if words else ''}.")


def _fit(ax: Any, r: Record, e: Experiment, name: str, x: np.ndarray, t: np.ndarray, u: np.ndarray) -> None:
    channel = r.channels[name]
    y = np.array(r.column(name))[e.first:e.last]
    level = rest(r, e, name)
    ax.plot(x, y, color=BLUE, linewidth=0.9, alpha=0.8)
    element = r.model.elements.get((name, e.input))
    text = "no model"
    if element:
        model = response(t, u, element) if element.has_gain else np.zeros(len(t))
        model += baseline(t, y - model)
        ax.plot(x, model, color=ORANGE, linewidth=1.2)
        left = (y - model)[e.step - e.first:]
        left = float(np.sqrt(np.mean(left[np.isfinite(left)] ** 2))) if np.isfinite(left).any() else math.nan
        noise = r.model.noise.get(name, (0.0, ""))[0]
        what = f"left over {left:.2g} {channel.unit}"
        text = what + (f", {left / noise:.2g} x noise" if noise > 0 else "")
        if not element.has_gain:
            text = "no gain to be seen; " + text
    away = np.abs(y - level)
    worst = float(np.max(away[np.isfinite(away)], initial=0.0)) / channel.limit if channel.limit > 0 else 0.0
    if worst > SHOW_LIMIT:
        for sign in (1, -1):
            ax.axhline(level + sign * channel.limit, color=ORANGE, linewidth=0.9, linestyle="--")
    ax.set_ylabel(f"{name}\n[{channel.unit}]")
    ax.set_title(f"{text}; limit \u00b1{channel.limit:.3g}, reached {100 * worst:.0f} %", fontsize=7.5, fontweight="normal",
                 loc="right", color="#55606b")
    ax.margins(y=0.15)


# ---- analysis ----

def rga(r: Record) -> Plot | None:
    """Relative gains along the frequency; the pairs stand out."""
    found = frequency.relative_gains(r)
    if found is None:
        return None
    omega, outputs, inputs, table = found
    paired = {(m, i) for m, i, _, _ in r.pairing.pairs}
    figure, ax = plt.subplots(figsize=(9.6, 3.6))
    shown = [(m, i) for m in outputs for i in inputs]
    if len(shown) > FEW:
        shown = [p for p in shown if p in paired]
    for k, (m, i) in enumerate(shown):
        strong = (m, i) in paired
        ax.semilogx(omega, table[:, outputs.index(m), inputs.index(i)], color=COLOURS[k % 20],
                    linewidth=2.0 if strong else 1.0, linestyle="-" if strong else "--", label=f"{m} by {i}")
    ax.axhline(1.0, color=GREY, linewidth=0.8)
    ax.set_ylabel("|relative gain|")
    ax.set_xlabel("frequency [rad/s]")
    if ax.get_ylim()[1] > 20:
        ax.set_yscale("log")
    else:
        ax.set_ylim(0, max(2.0, ax.get_ylim()[1]))
    ax.legend(loc="best", ncols=4, fontsize=7.5)
    return picture(figure, "rga", "Relative gains of the model along the frequency, up to half the sampling frequency; full "
                  "lines are the pairs. A pair whose relative gain stays near 1 where its loop works is left alone by the "
                  "others.")


def singular(r: Record) -> Plot:
    omega, values = frequency.singular_values(r)
    figure, (upper, lower) = plt.subplots(2, 1, figsize=(9.6, 4.6), sharex=True)
    for k in range(values.shape[1]):
        upper.loglog(omega, np.maximum(values[:, k], 1e-12), color=COLOURS[k % 20], linewidth=1.2, label=f"{k + 1}")
    upper.set_ylim(bottom=max(upper.get_ylim()[0], 1e-6 * float(values.max())))
    upper.set_ylabel("singular values\n[span per span]")
    upper.legend(loc="best", ncols=8, fontsize=7.5)
    lower.loglog(omega, np.minimum(values[:, 0] / np.maximum(values[:, -1], 1e-12), 1e6), color=BLUE, linewidth=1.3)
    lower.set_ylabel("condition number")
    lower.set_xlabel("frequency [rad/s]")
    for ax in (upper, lower):
        low, high = ax.get_ylim()
        ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 200 * low else (1.0,)))
        ax.yaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        ax.yaxis.set_minor_formatter(NullFormatter())
    return picture(figure, "singular", "Singular values of the model and their ratio, gains in spans. A large ratio: some "
                  "directions of the outputs can hardly be moved.")


# ---- trial ----

def trial(r: Record) -> Plot | None:
    begun = next((e.at_s for e in reversed(r.events) if e.code == "TRIAL_BEGUN"), None)
    if begun is None:
        return None
    t = np.array(r.time)
    rows = slice(int(np.searchsorted(t, begun)), len(t))
    if len(t[rows]) < 2:
        return None
    by, unit = scale(t[-1] - begun)
    x = (t[rows] - begun) / by
    n = len(r.trial)
    figure, grid = plt.subplots(n, 2, figsize=(9.6, 0.8 + 1.7 * n), sharex=True, squeeze=False, width_ratios=(3, 2))
    for (left, right), loop in zip(grid, r.trial):
        y, u = r.channels[loop.measurement], r.channels[loop.input]
        left.plot(x, np.array(r.column(y.name))[rows], color=BLUE, linewidth=1.0)
        for name in _setpoints(r, loop.measurement, loop.input):
            left.step(x, np.array(r.column(name))[rows], where="post", color=ORANGE, linewidth=1.1)
        left.set_ylabel(f"{y.name}\n[{y.unit}]")
        right.step(x, np.array(r.column(f"{u.name}.cmd"))[rows], where="post", color=GREEN, linewidth=1.1)
        right.set_ylabel(f"{u.name}\n[{u.unit}]")
    for ax in grid[-1]:
        ax.set_xlabel(f"since the trial began [{unit}]")
    figure.align_ylabels()
    return picture(figure, "trial", "The trial: each loop's setpoint (orange) is stepped once; where nothing drifts "
                   "there and back, else with rests in between.")


def _setpoints(r: Record, measurement: str, input_name: str) -> list[str]:
    """The setpoint of the proposed loop: it is called after its measurement, or L<n>_<input>."""
    names = [f"{measurement}.sp", *(f"L{k}_{input_name}"[:15] + ".sp" for k in range(1, 9))]
    return [n for n in names if r.log.has(n)][:1]
