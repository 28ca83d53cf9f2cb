"""Plots of a start-up."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from reflux import logs
from reflux.commission import closed_loops, frequency
from reflux.commission.record import Experiment, Record
from reflux.commission.results import Element
from reflux.plots import BLUE, GREEN, GREY, ORANGE, RED, Plot, Size, drawn, from_to, legend_beside, plt, thinned

DARK = "#22292f"
AFTER_TRIAL = 0.15  # of its time, drawn after it
SAME_LAGS = 1e-6    # relative
ONE_COLUMN = 4       # outputs that stand one below the other
LEGEND_MOST = 10     # lines that are named
FEW = 16             # relative gains that are all drawn; of more, those of the pairs
SHOW_LIMIT = 0.35    # of a limit: from here on it is drawn beside the response
COLOURS = (*plt.get_cmap("tab20").colors[::2], *plt.get_cmap("tab20").colors[1::2])


def plots(r: Record) -> list[Plot]:
    out: list[Plot | None] = [overview(r)] if r.experiments else []
    out += [experiment(r, e) for e in r.experiments]
    if r.gains.singular:
        out += [rga(r), singular(r)]
    if r.trial:
        out.append(trial(r))
    return [p for p in out if p]


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
    """The element from rest: the steps of u one by one."""
    out = np.zeros(len(t))
    moves = np.flatnonzero(np.diff(u)) + 1
    for k in moves:
        since = t - t[k] - e.dead_s
        out += np.where(since > 0, e.gain * (u[k] - u[k - 1]) * step_response(e, np.maximum(since, 0)), 0.0)
    return out


def step_response(e: Element, since: np.ndarray) -> np.ndarray:
    """Of (zero s + 1)/(square s2 + time s + 1), gain 1."""
    if e.time_s <= 0 and e.square_s2 <= 0:
        return np.ones(len(since))
    square = e.square_s2
    if abs(e.time_s**2 - 4 * square) < SAME_LAGS * e.time_s**2:
        square *= 1 - SAME_LAGS  # two equal lags: the sum below wants two poles
    poles = np.roots([square, e.time_s, 1.0] if square > 0 else [e.time_s, 1.0]).astype(complex)
    parts = [(e.zero_s * p + 1) / (p * (2 * square * p + e.time_s)) * np.exp(p * since) for p in poles]
    return 1 + np.real(sum(parts))


# ---- experiments ----

def moved_in(r: Record, e: Experiment) -> list[str]:
    """The input of the test, or all inputs where they are moved together."""
    return [e.input] if e.input in r.channels else [name for name in r.channels if r.log.has(f"{name}.cmd")]


def overview(r: Record) -> Plot:
    """Every output as a share of its limit, every input around where it was held."""
    t = np.array(r.time)
    first, last = r.experiments[0].first, r.experiments[-1].last
    by, unit = scale(t[last - 1] - t[first])
    names = r.model.measurements() or [n for n, c in r.channels.items() if not math.isnan(c.limit)]

    def draw(size: Size) -> Any:
        figure, (upper, lower) = plt.subplots(2, 1, figsize=(size.inches, 5.4), sharex=True, height_ratios=(3, 2))
        legend = {"loc": "upper right", "ncols": 3 if size.narrow else 6, "fontsize": 7.5}
        for k, name in enumerate(names):
            for n, e in enumerate(r.experiments):
                rows = slice(e.first, e.last)
                y = 100 * (np.array(r.column(name))[rows] - rest(r, e, name)) / r.channels[name].limit
                upper.plot(*thinned((t[rows] - t[first]) / by, y, size.points), color=COLOURS[k % 20], linewidth=1.0,
                           label=name if n == 0 and k < LEGEND_MOST else None)
        for sign in (1, -1):
            upper.axhline(100 * sign, color=RED, linewidth=1.0, linestyle="--", label="limit" if sign > 0 else None)
        rows_of_names = -(-(min(len(names), LEGEND_MOST) + 1) // int(legend["ncols"]))
        upper.set_ylim(top=max(upper.get_ylim()[1], 115 + 18 * rows_of_names))  # the legend lies above the limit
        upper.set_ylabel("from rest [% of its limit]")
        upper.legend(**legend)
        for k, name in enumerate(dict.fromkeys(name for e in r.experiments for name in moved_in(r, e))):
            c = r.channels[name]
            u = np.array(r.column(f"{name}.cmd"))[first:last]
            lower.step(*thinned((t[first:last] - t[first]) / by, 100 * (u - u[0]) / c.span, size.points), where="post", linewidth=1.1,
                       color=COLOURS[k % 20], label=name if k < LEGEND_MOST else None)
        lower.set_ylabel("input, from where\nit was held [% of span]")
        lower.set_xlabel(f"plant time since the first step [{unit}]")
        legend_beside(lower, size, columns=6, points=7.5)
        for e in r.experiments:
            for ax in (upper, lower):
                ax.axvline((t[e.step] - t[first]) / by, color=GREY, linewidth=0.7, linestyle=(0, (4, 3)))
        return figure

    nearest = [f"{i.name} brought an output to {100 * i.worst:.0f} % of its limit" for i in r.model.inputs if i.rounds > 0]
    return drawn(draw, "tests", "All tests: each output as a share of its limit (dashed), each input around where it was "
                 "held. Grey: a test begins.", f"All {len(r.experiments)} tests over {(t[last - 1] - t[first]) / by:.4g} {unit}. "
                 + "; ".join(nearest[:LEGEND_MOST]))


def experiment(r: Record, e: Experiment) -> Plot:
    names = r.model.measurements() or [n for n, c in r.channels.items() if not math.isnan(c.limit)]
    span = slice(e.first, e.last)
    t = np.array(r.time)[span]
    by, unit = scale(t[-1] - t[0])
    x = (t - r.time[e.step]) / by
    moves = {name: np.array(r.column(f"{name}.cmd"))[span] for name in moved_in(r, e)}
    together = e.input not in r.channels
    tested = "all inputs together" if together else e.input

    def draw(size: Size) -> Any:
        columns = 1 if size.narrow or len(names) <= ONE_COLUMN else 2 if len(names) <= 10 else 3
        rows = -(-(len(names) + 1) // columns)
        figure, grid = plt.subplots(rows, columns, figsize=(size.inches, 0.7 + (1.55 if columns == 1 else 1.35) * rows), sharex=True,
                                    squeeze=False)
        axes = list(grid.flat)
        if together:
            for k, (name, u) in enumerate(moves.items()):
                axes[0].step(x, 100 * (u - u[0]) / r.channels[name].span, where="post", color=COLOURS[k % 20], linewidth=1.3, label=name)
            axes[0].set_ylabel("inputs\n[% of span]")
            legend_beside(axes[0], size, above=True, points=7.5)
        else:
            axes[0].step(x, moves[e.input], where="post", color=GREEN, linewidth=1.3)
            axes[0].set_ylabel(f"{e.input}\n[{r.channels[e.input].unit}]")
        axes[0].margins(y=0.15)
        for ax, name in zip(axes[1:], names):
            _fit(ax, r, e, name, x, t, moves, size.points // columns)
        for ax in axes[len(names) + 1:]:
            ax.set_visible(False)
        for ax in axes[max(0, len(names) + 1 - columns):len(names) + 1]:
            ax.set_xlabel(f"since the step [{unit}]")
            ax.tick_params(labelbottom=True)
        figure.align_ylabels()
        return figure

    words = "; ".join([*e.remarks, *([] if e.done else ["the start-up ended in this test"])])
    moved = [from_to(name, r.column(name)[e.first:e.last], r.channels[name].unit) for name in names[:LEGEND_MOST]]
    return drawn(draw, f"test-{e.input}-{e.round}",
                 f"Test of {tested}, round {e.round}: measured (blue), model of all rounds with level and drift of "
                 f"this test (orange), limits where they are near (dashed)"
                 f"{'; ' + words if words else ''}.",
                 f"Test of {tested}, round {e.round}: "
                 f"{'; '.join([*(from_to(n, list(u), r.channels[n].unit) for n, u in list(moves.items())[:LEGEND_MOST]), *moved])}.")


def _fit(ax: Any, r: Record, e: Experiment, name: str, x: np.ndarray, t: np.ndarray, moves: dict[str, np.ndarray],
         points: int) -> None:
    channel = r.channels[name]
    y = np.array(r.column(name))[e.first:e.last]
    level = rest(r, e, name)
    ax.plot(*thinned(x, y, points), color=BLUE, linewidth=0.9, alpha=0.8)
    elements = {i: r.model.elements[(name, i)] for i in moves if (name, i) in r.model.elements}
    text = "no model"
    if elements:
        model = np.zeros(len(t))
        for i, element in elements.items():
            model += response(t, moves[i], element) if element.has_gain else 0.0
        model += baseline(t, y - model)
        ax.plot(*thinned(x, model, points), color=ORANGE, linewidth=1.2)
        left = (y - model)[e.step - e.first:]
        left = float(np.sqrt(np.mean(left[np.isfinite(left)] ** 2))) if np.isfinite(left).any() else math.nan
        noise = r.model.noise.get(name, (0.0, ""))[0]
        what = f"residual {left:.2g} {channel.unit}"
        text = what + (f", {left / noise:.2g} x noise" if noise > 0 else "")
        if not any(element.has_gain for element in elements.values()):
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
    shown = [(m, i) for m in outputs for i in inputs]
    if len(shown) > FEW:
        shown = [p for p in shown if p in paired]

    def draw(size: Size) -> Any:
        figure, ax = plt.subplots(figsize=(size.inches, 3.6))
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
        legend_beside(ax, size, above=True, points=7.5)
        return figure

    pairs = [from_to(f"{m} by {i}", table[:, outputs.index(m), inputs.index(i)], "") for m, i in shown if (m, i) in paired]
    return drawn(draw, "rga", "Relative gains of the model along the frequency, up to half the sampling frequency; full "
                 "lines are the pairs. A pair whose relative gain stays near 1 where its loop works is left alone by the "
                 "others.", f"Relative gains along the frequency: {'; '.join(pairs) or 'there are no pairs'}.")


def singular(r: Record) -> Plot:
    omega, values = frequency.singular_values(r)
    condition = np.minimum(values[:, 0] / np.maximum(values[:, -1], 1e-12), 1e6)

    def draw(size: Size) -> Any:
        figure, (upper, lower) = plt.subplots(2, 1, figsize=(size.inches, 4.6), sharex=True)
        for k in range(values.shape[1]):
            upper.loglog(omega, np.maximum(values[:, k], 1e-12), color=COLOURS[k % 20], linewidth=1.2, label=f"{k + 1}")
        upper.set_ylim(bottom=max(upper.get_ylim()[0], 1e-6 * float(values.max())))
        upper.set_ylabel("singular values\n[span per span]")
        legend_beside(upper, size, above=True, columns=8, points=7.5)
        lower.loglog(omega, condition, color=BLUE, linewidth=1.3)
        lower.set_ylabel("condition number")
        lower.set_xlabel("frequency [rad/s]")
        for ax in (upper, lower):
            low, high = ax.get_ylim()
            ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 200 * low else (1.0,)))
            ax.yaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
            ax.yaxis.set_minor_formatter(NullFormatter())
        return figure

    return drawn(draw, "singular", "Singular values of the model and their ratio, gains in spans. A large ratio: some "
                 "directions of the outputs can hardly be moved.", f"{from_to('Condition number', condition, '')} along the frequency.")


# ---- trial ----

def trial(r: Record) -> Plot | None:
    begun = next((e.at_s for e in reversed(r.events) if e.code == "TRIAL_BEGUN"), None)
    if begun is None:
        return None
    t = np.array(r.time)
    over = next((e.at_s for e in r.events if e.code in ("TRIAL_KEPT", "TRIAL_FAILED") and e.at_s > begun), t[-1])
    rows = slice(int(np.searchsorted(t, begun)), int(np.searchsorted(t, over + AFTER_TRIAL * (over - begun), "right")))
    if len(t[rows]) < 2:
        return None
    by, unit = scale(t[rows][-1] - begun)
    x = (t[rows] - begun) / by
    n = len(r.trial)
    model = _predicted(r, rows)

    def draw(size: Size) -> Any:
        down, across = (2 * n, 1) if size.narrow else (n, 2)
        figure, grid = plt.subplots(down, across, figsize=(size.inches, 0.8 + 1.7 * down), sharex=True, squeeze=False,
                                    width_ratios=(1,) if size.narrow else (3, 2))
        for (left, right), loop in zip(grid.reshape(n, 2), r.trial):
            y, u = r.channels[loop.measurement], r.channels[loop.input]
            left.plot(*thinned(x, np.array(r.column(y.name))[rows], size.points), color=BLUE, linewidth=1.0, label="measured")
            if y.name in model:
                left.plot(*thinned(x, model[y.name], size.points), color=DARK, linewidth=1.1, linestyle="--", label="predicted")
            for name in _setpoints(r, loop.measurement, loop.input):
                setpoint = logs.acted_on(r.column(name)[rows], _modes(r, name)[rows])
                left.step(*thinned(x, setpoint, size.points), where="post", color=ORANGE, linewidth=1.1, label="setpoint")
            left.set_ylabel(f"{y.name}\n[{y.unit}]")
            legend_beside(left, size, above=True, points=7.5)
            right.step(*thinned(x, np.array(r.column(f"{u.name}.cmd"))[rows], size.points), where="post", color=GREEN, linewidth=1.1)
            right.set_ylabel(f"{u.name}\n[{u.unit}]")
        for ax in grid[-1]:
            ax.set_xlabel(f"since the trial began [{unit}]")
        figure.align_ylabels()
        return figure

    told = " Dashed: predicted by the model." if model else ""
    moved = [from_to(loop.measurement, r.column(loop.measurement)[rows], r.channels[loop.measurement].unit)
             + f", overshoot {100 * loop.overshoot:.0f} % where {100 * loop.overshoot_predicted:.0f} % was predicted" for loop in r.trial]
    return drawn(draw, "trial", "The trial: each loop's setpoint (orange) is stepped once; where nothing drifts "
                 f"there and back, else with rests in between.{told}", f"The trial: {'; '.join(moved)}.")


def _predicted(r: Record, rows: slice) -> dict[str, np.ndarray]:
    """What the model makes of the setpoints of the trial, from the moment at which all loops are closed; not a number before. Empty without
    a model of the loops, or where rows of the telemetry are missing."""
    count = len(np.array(r.time)[rows])
    names = [_setpoints(r, x.measurement, x.input) for x in r.proposal.loops]
    if not all(names) or r.plant is None:
        return {}
    setpoints = [np.array(r.column(found[0]))[rows] for found in names]
    closed = [np.flatnonzero(np.isfinite(sp)) for sp in setpoints]
    if not all(len(k) for k in closed) or len(closed) == 0:
        return {}
    modes = [_modes(r, found[0])[rows] for found in names]
    ready = np.flatnonzero(np.all([np.isfinite(sp) & (mode > 0) for sp, mode in zip(setpoints, modes)], axis=0))
    if not len(ready) or abs(np.diff(np.array(r.time)[rows][ready[0]:]) - r.plant.tick_s).max(initial=0.0) > 1e-3 * r.plant.tick_s:
        return {}
    at = ready[0]
    inputs = [np.array(r.column(f"{x.input}.cmd"))[rows][at:] for x in r.proposal.loops]
    found = closed_loops.predicted(r, [sp[at:] for sp in setpoints], inputs)
    return {} if found is None else {x.measurement: np.concatenate([np.full(at, math.nan), y[:count - at]])
                                     for x, y in zip(r.proposal.loops, found)}


def _modes(r: Record, setpoint: str) -> np.ndarray:
    """Modes of the loop with this column of setpoints; 1 where the log has none."""
    mode = logs.mode_of(setpoint)
    return np.array(r.column(mode) if r.log.has(mode) else [1.0] * len(r.time))


def _setpoints(r: Record, measurement: str, input_name: str) -> list[str]:
    """The setpoint of the proposed loop: it is called after its measurement, or L<n>_<input>."""
    names = [f"{measurement}.sp", *(f"L{k}_{input_name}"[:15] + ".sp" for k in range(1, 9))]
    return [n for n in names if r.log.has(n)][:1]
