"""Plots of a run: one picture per loop, one of what was done to the plant, one of what the board estimated."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import median
from typing import Any

from reflux import logs
from reflux.logs import FIRMWARE_PREFIX, Log, bare, channel_unit
from reflux.metrics import trace
from reflux.plots import BLUE, GREEN, GREY, ORANGE, PALE_BLUE, PALE_GREEN, RED, Plot, Size, drawn, from_to, hours, legend_beside, plt, thinned
from reflux.scenario import Loop, Scenario, is_stimulus
from reflux.scenario_settings import Interlock, interlocks

MAX_MARKER = 26
FAR = 2.0  # ranges of the true value beyond which a measurement is left out of a picture
LABEL_ROOM = 0.025  # of the run, between two labels
LABEL_ROOM_NARROW = 0.08
BAD = 2  # quality from which on the board does not rely on a value
ESTIMATE = "_est"  # ends the name of a channel that the board computes (docs/methods/composition-estimation.md)


@dataclass(frozen=True)
class Trip:
    """An interlock held an output from here to there, in s of plant time."""

    output: str
    from_s: float
    to_s: float


def trips_of(events: list[tuple[float, str, str, str]], end_s: float) -> list[Trip]:
    """From the events of a transcript: time, level, code, subject and the rest. An event names the output and not the entry; each entry that holds has said
    ON and not yet OFF, so an output is free when as many have said OFF as ON. After a start the board says ON again for those that hold."""
    held: dict[str, list[float]] = {}
    out = []
    for at_s, _level, code, text in events:
        output = text.split(" ")[0]
        if code == "INTERLOCK_ON":
            held.setdefault(output, []).append(at_s)
        elif code == "INTERLOCK_OFF" and output in held:
            began = held[output][0]
            held[output].pop()
            if not held[output]:
                out.append(Trip(output, began, at_s))
                del held[output]
        elif code == "STARTED":
            out += [Trip(output, began[0], at_s) for output, began in held.items()]
            held.clear()
    return sorted([*out, *(Trip(output, began[0], end_s) for output, began in held.items())], key=lambda trip: trip.from_s)


def scenario_plots(log: Log, scenario: Scenario, events: list[tuple[float, str, str, str]] | None = None) -> list[Plot]:
    trips = trips_of(events or [], log.numbers("time")[-1] if log.rows else 0.0)
    plots = [_loop_plot(log, scenario, loop, trips) for loop in scenario.loops]
    plots += [_estimates_plot(log, scenario, found)] if (found := estimates(log)) else []
    plots += [_inputs_plot(log, scenario, changed)] if (changed := changing_columns(log, scenario)) else []
    return plots


def markers(scenario: Scenario) -> list[tuple[float, str, bool]]:
    """Time in seconds, text, and whether it was done to the plant (not by the operator)."""
    texts: dict[tuple[float, bool], list[str]] = {}
    for event in scenario.events:
        texts.setdefault((event.at_s, True), []).append(f"{event.name} = {event.value:g}")
    for line in scenario.lines:
        if is_stimulus(line) or line.text.startswith("seq "):
            texts.setdefault((line.at_s, False), []).append(line.text)
    return [(t, "; ".join(words), plant) for (t, plant), words in sorted(texts.items())]


def _mark(axes: list[Any], scenario: Scenario, size: Size) -> None:
    """A line for everything that happened, and its text where there is room for it."""
    labelled = -math.inf
    room = (LABEL_ROOM_NARROW if size.narrow else LABEL_ROOM) * scenario.duration_s
    most = MAX_MARKER // 2 if size.narrow else MAX_MARKER
    for at_s, text, plant in markers(scenario):
        for ax in axes:
            ax.axvline(at_s / 3600, color=ORANGE if plant else GREY, linewidth=0.9, linestyle=(0, (4, 3)), zorder=1)
        if at_s - labelled >= room:
            labelled = at_s
            short = text if len(text) <= most else text[: most - 1] + "…"
            axes[0].annotate(short, (at_s / 3600, 1.02), xycoords=("data", "axes fraction"), rotation=50 if size.narrow else 22,
                             fontsize=7.5, color=ORANGE if plant else "#5c6670", ha="left", va="bottom")


def _trip_marks(upper: Any, lower: Any, loop: Loop, locks: list[Interlock], trips: list[Trip], shown: tuple[float, float]) -> None:
    """Limits of interlocks as red lines where they are near the curve, and the time in which an interlock held an output as a red ground."""
    low, high = shown
    for lock in locks:
        if lock.meas == loop.pv and low - (high - low) <= lock.limit <= high + (high - low):
            upper.axhline(lock.limit, color=RED, linewidth=1.0, linestyle="--", label=f"{lock.mv} trips {lock.side} {lock.limit:g}")
    mine = [trip for trip in trips if trip.output == loop.mv]
    for ax in (upper, lower):
        for k, trip in enumerate(mine):
            ax.axvline(trip.from_s / 3600, color=RED, linewidth=0.9, zorder=1)  # a short one is seen too
            ax.axvspan(trip.from_s / 3600, trip.to_s / 3600, color=RED, alpha=0.13, linewidth=0, zorder=0,
                       label="interlock holds" if k == 0 and ax is lower else None)


def near(measured: list[float], real: list[float], setpoint: list[float]) -> tuple[list[float], list[float]]:
    """The measurement for a picture, without what a broken sensor reads far from all that the plant did; and what was left out."""
    known = [v for v in [*real, *setpoint] if math.isfinite(v)]
    errors = [abs(m - y) for m, y in zip(measured, real) if math.isfinite(m) and math.isfinite(y)]
    if not known or not errors:
        return measured, []
    low, high = min(known), max(known)
    room = FAR * max(high - low, 10 * median(errors))
    far = [m for m in measured if math.isfinite(m) and not low - room <= m <= high + room] if room > 0 else []
    return [m if not far or low - room <= m <= high + room else math.nan for m in measured], far


def acted_on(log: Log, loop: Loop, setpoint: list[float]) -> list[float]:
    mode = f"{FIRMWARE_PREFIX}{loop.name}.mode"
    return logs.acted_on(setpoint, log.numbers(mode)) if log.has(mode) else setpoint


def _loop_plot(log: Log, scenario: Scenario, loop: Loop, trips: list[Trip]) -> Plot:
    data = trace(log, loop)
    t = [x / 3600 for x in data.t]
    y_unit, u_unit = channel_unit(log, loop.pv), channel_unit(log, loop.mv)
    has_true = log.has(f"{loop.pv}.true")
    measured = log.numbers(f"{loop.pv}.meas") if has_true and log.has(f"{loop.pv}.meas") else None
    seen, far = near(measured, data.y, data.r) if measured else ([], [])
    mine = [trip for trip in trips if trip.output == loop.mv]

    def draw(size: Size) -> Any:
        figure, (upper, lower) = plt.subplots(2, 1, figsize=(size.inches, 5.4 if size.narrow else 5.6), sharex=True, height_ratios=(3, 2))
        if seen:
            upper.plot(*thinned(t, seen, size.points), color=PALE_BLUE, linewidth=1.0, label=f"{loop.pv} measured")
        upper.plot(*thinned(t, data.y, size.points), color=BLUE, linewidth=1.5, label=f"{loop.pv} true" if has_true else loop.pv)
        upper.step(*thinned(t, acted_on(log, loop, data.r), size.points), where="post", color=ORANGE, linewidth=1.3, label="setpoint")
        known = [v for v in [*data.y, *data.r] if math.isfinite(v)] or [0.0]
        _output(lower, log, loop, t, data.u, size, scenario.wiring is not None)
        _trip_marks(upper, lower, loop, interlocks(scenario), trips, (min(known), max(known)))
        upper.set_ylabel(f"{loop.pv} [{y_unit}]")
        lower.set_ylabel(f"{loop.mv} [{u_unit}]")
        lower.set_xlabel("plant time [h]")
        legend_beside(upper, size, labelled=False)
        legend_beside(lower, size)
        lower.set_xlim(t[0], t[-1])
        _mark([upper, lower], scenario, size)
        return figure

    held = f" Red ground: an interlock holds {loop.mv}." if mine else ""
    held += f" Not drawn: {from_to(f'{loop.pv} measured', far, y_unit)}, {len(far)} of {len(t)} samples." if far else ""
    alt = (f"Loop {loop.name} over {t[-1] - t[0]:.4g} h: {from_to(loop.pv, data.y, y_unit)}, {from_to('setpoint', data.r, y_unit)}, "
           f"{from_to(loop.mv, data.u, u_unit)}." + (f" {from_to(f'{loop.pv} measured', far, y_unit)} is not drawn." if far else "") + "".join(
               f" An interlock holds {loop.mv} from {trip.from_s:.4g} s to {trip.to_s:.4g} s." for trip in mine[:4]))
    return drawn(draw, f"loop-{loop.name}", f"Loop {loop.name}: {loop.pv} follows its setpoint by {loop.mv}. "
                 f"Grey: the operator's lines, orange: what was done to the plant.{held}", alt)


def _output(ax: Any, log: Log, loop: Loop, t: list[float], applied: list[float], size: Size, at_pins: bool) -> None:
    told = f"{FIRMWARE_PREFIX}{loop.mv}.cmd"
    if at_pins and log.has(told):  # a relay is on or off in each tick: the board's own command says more
        ax.step(*thinned(t, applied, size.points), where="pre", color=PALE_GREEN, linewidth=0.8, label=f"{loop.mv} applied")
        ax.step(*thinned(t, log.numbers(told), size.points), where="post", color=GREEN, linewidth=1.4, label="commanded")
        return
    if log.has(f"{loop.mv}.cmd"):
        ax.step(*thinned(t, log.numbers(f"{loop.mv}.cmd"), size.points), where="post", color=PALE_GREEN, linewidth=1.1,
                label="commanded")
    # The log's applied value is the mean over the interval before its sample.
    ax.step(*thinned(t, applied, size.points), where="pre", color=GREEN, linewidth=1.4, label=f"{loop.mv} applied")


def estimates(log: Log) -> list[tuple[str, str, str]]:
    """What the board estimated: name, column, and the column of the plant's true value, empty where the log has none."""
    out = []
    for column in map(bare, log.columns):
        name = column.removeprefix(FIRMWARE_PREFIX)
        if name.endswith(ESTIMATE) and log.has(f"{column}.q"):
            real = name.removesuffix(ESTIMATE)
            out.append((name, column, next((c for c in (f"{real}.true", real) if log.has(c)), "")))
    return out


def _estimates_plot(log: Log, scenario: Scenario, found: list[tuple[str, str, str]]) -> Plot:
    t = hours(log)

    def draw(size: Size) -> Any:
        figure, axes = plt.subplots(len(found), 1, figsize=(size.inches, 1.0 + 1.8 * len(found)), sharex=True, squeeze=False)
        rows = [row[0] for row in axes]
        for ax, (name, column, real) in zip(rows, found):
            if real:
                ax.plot(*thinned(t, log.numbers(real), size.points), color=BLUE, linewidth=1.3, label=f"{name.removesuffix(ESTIMATE)} true")
            trusted, doubted = by_quality(log, column)
            ax.plot(*thinned(t, trusted, size.points), color=ORANGE, linewidth=1.1, label="estimated")
            if any(map(math.isfinite, doubted)):
                ax.plot(*thinned(t, doubted, size.points), color=GREY, linewidth=1.1, linestyle=(0, (3, 2)), label="estimated, quality bad")
            ax.set_ylabel(f"{name.removesuffix(ESTIMATE)} [{log.unit(column)}]")
            legend_beside(ax, size, labelled=ax is rows[-1])
        rows[-1].set_xlabel("plant time [h]")
        rows[-1].set_xlim(t[0], t[-1])
        _mark(rows, scenario, size)
        return figure

    alt = "Estimates of the board: " + "; ".join(
        from_to(name.removesuffix(ESTIMATE), log.numbers(column), log.unit(column)) + (f", {distance(log, column, real)}" if real else "") + bad_share(log, column)
        for name, column, real in found) + "."
    words = "What the board estimated, beside the plant's true value where the simulator logs it."
    if any(bad_share(log, column) for _, column, _ in found):
        words += " Grey dashes: the board calls its estimate bad. Do not rely on it there."
    return drawn(draw, "estimates", words, alt)


def by_quality(log: Log, column: str) -> tuple[list[float], list[float]]:
    """An estimate while the board relies on it, and while it does not; NaN elsewhere. The second begins and ends where it meets the first."""
    values, bad = log.numbers(column), [q >= BAD for q in log.numbers(f"{column}.q")]
    meets = [any(bad[max(k - 1, 0) : k + 2]) for k in range(len(bad))]
    return [math.nan if x else v for v, x in zip(values, bad)], [v if x else math.nan for v, x in zip(values, meets)]


def bad_share(log: Log, column: str) -> str:
    bad = sum(q >= BAD for q in log.numbers(f"{column}.q"))
    return f", of bad quality in {bad} of {len(log.rows)} samples" if bad else ""


def distance(log: Log, column: str, real: str) -> str:
    apart = [abs(a - b) for a, b in zip(log.numbers(column), log.numbers(real)) if math.isfinite(a) and math.isfinite(b)]
    return f"at most {max(apart):.4g} {log.unit(column)} from the true value" if apart else "without a value"


def changing_columns(log: Log, scenario: Scenario) -> list[str]:
    """The plant's inputs that the scenario changes, which the log carries."""
    names = dict.fromkeys(event.name for event in scenario.events)
    return [name for name in names if log.has(name)]


def _inputs_plot(log: Log, scenario: Scenario, names: list[str]) -> Plot:
    t = hours(log)

    def draw(size: Size) -> Any:
        figure, axes = plt.subplots(len(names), 1, figsize=(size.inches, 1.0 + 1.15 * len(names)), sharex=True, squeeze=False)
        rows = [row[0] for row in axes]
        for ax, name in zip(rows, names):
            ax.step(*thinned(t, log.numbers(name), size.points), where="post", color=GREY, linewidth=1.5)
            ax.set_ylabel(f"{name} [{log.unit(name)}]")
            ax.margins(y=0.2)
        rows[-1].set_xlabel("plant time [h]")
        rows[-1].set_xlim(t[0], t[-1])
        return figure

    alt = "What was done to the plant: " + "; ".join(from_to(name, log.numbers(name), log.unit(name)) for name in names) + "."
    return drawn(draw, "inputs", "What was done to the plant.", alt)
