"""tools/identify: a difference model of several inputs and outputs, from a log."""

from __future__ import annotations

import argparse
import csv
import json
import math
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reflux import identification, identify_doubts, libreflux, table, textfile, time_column
from reflux.compare import log_of
from reflux.errors import RunFailed, UserError
from reflux.identification import Fit, Judgement, Orders, Record, Trials
from reflux.logs import Log, bare, number, read_if_log
from reflux.paths import named, shown, tool

MOST = 4  # of each kind
NA_MOST, NB_MOST, NC_MOST = 4, 8, 4
SHOWN = 8  # trials
LEAST = 20  # samples; a search of orders asks for more
SINGULAR, EMPTY = -15, -9  # of base/error.h
JITTER, LOST = 0.01, 0.5  # of a period, between a row's time and the row before: without --period, and with it


@dataclass
class Looked:
    trial: identification.Trial
    model: Fit
    judged: Judgement  # on validation data, as is the criterion
    criterion: float


@dataclass
class Found:
    """Result for one output. trials: None where the orders were given."""

    name: str
    trials: Trials | None
    looked: list[Looked]  # the best first
    model: Fit
    judged: Judgement
    doubt: str = ""  # what else the log may be; nothing: the model may be used


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog=tool("identify"),
        description="Finds A(z^-1) y = B(z^-1) u, A diagonal, from a log in which all inputs were excited at once (docs/methods/difference-models.md).")
    p.add_argument("log", type=named, metavar="LOG", help="a log.csv of tools/run, a folder that holds one, or another CSV with a header")
    p.add_argument("--inputs", type=names, required=True, metavar="U,U", help="manipulated variables, up to 4")
    p.add_argument("--outputs", type=names, required=True, metavar="Y,Y", help="measurements, up to 4")
    p.add_argument("--period", type=float, metavar="S", help="seconds between rows (default: from the column time)")
    p.add_argument("--every", type=int, default=1, metavar="N", help="rows in a control interval; the tool keeps one row in N")
    p.add_argument("--cutoff", type=float, default=0.0, help="cutoff of a filter on the outputs, as a part of half the control frequency (default 0: no filter)")
    p.add_argument("--method", choices=identification.METHODS, default="iv",
                   help="least squares (ls), instrumental variables (iv, default; any noise), extended least squares (els)")
    p.add_argument("--na", type=int, default=3, help="largest order of A to try (default 3)")
    p.add_argument("--nb", type=int, default=4, help="largest power in B to try (default 4)")
    p.add_argument("--orders", type=pair, metavar="NA,NB", help="use these orders instead of searching")
    p.add_argument("--nc", type=int, metavar="N", help="coefficients of C with els (default: as many as A has)")
    p.add_argument("--integrates", type=names, default=[], metavar="Y,Y", help="outputs that integrate: find models of their steps")
    p.add_argument("--drift", action="store_true", help="outputs drift along straight lines: find these with the model and remove them")
    p.add_argument("--despike", action="store_true", help="replace readings that stand apart from their neighbours by the median of seven")
    p.add_argument("--criterion", choices=identification.CRITERIA, default="bic", help="criterion for the orders (default bic)")
    p.add_argument("--validation", type=float, default=1 / 3, metavar="PART", help="part at the end of the log by which models are judged (default 1/3)")
    p.add_argument("--no-constant", action="store_true", help="the log is in deviations: no levels, no constant")
    p.add_argument("--format", choices=("text", "json"), default="text")
    p.add_argument("-o", "--out", type=named, metavar="PNG", help="file of the picture (default: identify.png beside the log)")
    options = p.parse_args(arguments)
    check(options)
    path = log_of(options.log)
    log = read_table(path)
    period = period_of(log, options.period) * options.every
    record, levels = record_of(log, options)
    border = border_of(record, options)
    found = [doubted(identify(record, i, border, options), record, i, border, options) for i in range(record.outputs)]
    out = options.out or path.parent / "identify.png"
    if options.format == "text" or options.out:
        draw(out, record, found, border, period)
    if options.format == "json":
        print(json.dumps(as_dict(found, options, period, levels), indent=1))
        return verdict(found)
    print(f"{shown(path)}: {record.samples} samples of {period:g} s, judged on the last {record.samples - border}")
    if options.every > 1 and (moving := moved_within(log, options)):
        print(f"note: {', '.join(moving)} move within control intervals of {options.every} rows, and are taken as they are at their beginning")
    for one in found:
        print_output(one, options)
    print_model(found, options, period)
    print(f"\n{shown(out)}")
    return verdict(found)


def doubted(one: Found, record: Record, i: int, border: int, options: argparse.Namespace) -> Found:
    if one.name not in options.integrates:
        one.doubt = identify_doubts.of(record, i, one.model, one.judged, border, one.name, options.every)
    elif one.judged.fit() <= 0:
        one.doubt = identify_doubts.no_better(one.name, one.judged)
    return one


def verdict(found: list[Found]) -> int:
    """Exit status 1, with a reason for each output whose model should not be used."""
    doubts = [one.doubt for one in found if one.doubt]
    if doubts:
        raise RunFailed("; ".join(doubts))
    return 0


def check(options: argparse.Namespace) -> None:
    if not 0.05 <= options.validation <= 0.8:
        raise UserError("--validation must be 0.05 to 0.8 of the log")
    if not 0 <= options.na <= NA_MOST or not 1 <= options.nb <= NB_MOST:
        raise UserError(f"--na must be 0 to {NA_MOST}, --nb 1 to {NB_MOST}")
    if options.orders and not (options.orders[0] <= NA_MOST and 1 <= options.orders[1] <= NB_MOST):
        raise UserError(f"--orders must be 0 to {NA_MOST} and 1 to {NB_MOST}")
    if options.nc is not None and (options.method != "els" or not 1 <= options.nc <= NC_MOST):
        raise UserError(f"--nc must be 1 to {NC_MOST}, and goes with --method els")
    if options.every < 1 or not 0 <= options.cutoff < 1:
        raise UserError("--every must be 1 or more, --cutoff 0 or more and below 1")
    channels = [*options.inputs, *options.outputs]
    for name in channels:
        if channels.count(name) > 1:
            raise UserError(f"{name} is named twice among --inputs and --outputs")
    if lost := [name for name in options.integrates if name not in options.outputs]:
        raise UserError(f"--integrates {lost[0]}: is none of --outputs")
    if options.integrates and (options.na if options.orders is None else options.orders[0]) < 1:
        raise UserError("--integrates needs a coefficient of A: --na or --orders of 1 and more")
    if options.drift and len(options.inputs) == MOST:
        raise UserError(f"--drift takes the place of an input, of which there may be {MOST}: name {MOST - 1} at most")


# ---- the record ----


def names(text: str) -> list[str]:
    found = [word.strip() for word in text.split(",")]
    if not 1 <= len(found) <= MOST or not all(found):
        raise argparse.ArgumentTypeError(f"{text}: must be 1 to {MOST} names with commas between them")
    return found


def pair(text: str) -> tuple[int, int]:
    words = text.split(",")
    if len(words) != 2 or not all(word.strip().isdigit() for word in words):
        raise argparse.ArgumentTypeError(f"{text}: must be two whole numbers, as 2,2")
    return int(words[0]), int(words[1])


def read_table(path: Path) -> Log:
    """A log of a tool, or any table with names in its first line, cells between commas."""
    log = read_if_log(path)
    if log is not None:
        return log
    lines = [line for line in textfile.read(path).splitlines() if line.strip() and not line.startswith("#")]
    if not lines:
        raise UserError(f"{shown(path)}: empty; expected a header line with names of columns")
    if not any(math.isnan(number(cell)) for cell in lines[0].split(",")):
        raise UserError(f"{shown(path)}: has no header: its first line holds numbers only; put a line with names of columns before it")
    if "," not in lines[0] and (";" in lines[0] or "\t" in lines[0]):
        raise UserError(f"{shown(path)}: cells must have commas between them, and the header has none")
    try:
        columns, *rows = ([cell.strip() for cell in row] for row in csv.reader(lines))
    except csv.Error as error:
        raise UserError(f"{shown(path)}: {error}") from None
    for n, row in enumerate(rows, 1):
        if len(row) != len(columns):
            raise UserError(f"{shown(path)}: row {n} has {len(row)} cells, the header {len(columns)}")
    plain = [bare(c) for c in columns]
    for name in plain:
        if name and plain.count(name) > 1:
            raise UserError(f"{shown(path)}: two columns {name}")
    return Log(columns, rows, [], shown(path))


def input_of(log: Log, name: str) -> list[float]:
    """Inputs that act from each row on. A simulator's `applied` is the mean over the interval before its row."""
    if log.has(f"{name}.applied"):
        applied = log.numbers(f"{name}.applied")
        return applied[1:] + applied[-1:]
    for suffix in (".app", ".cmd", ""):
        if log.has(name + suffix):
            return log.numbers(name + suffix)
    log.place(name)
    return []


def record_of(log: Log, options: argparse.Namespace) -> tuple[Record, dict[str, float]]:
    """Deviations from the means, which are given as well."""
    channels = [*options.inputs, *options.outputs]
    table_of = [input_of(log, name) for name in options.inputs] + [log.numbers(name + ".meas" if log.has(name + ".meas") else name) for name in options.outputs]
    all_of = np.array(table_of, float).T
    bad = np.argwhere(~np.isfinite(all_of))
    if len(bad):
        raise UserError(f"{log.source or 'log'}: row {bad[0][0] + 1} has no number for {channels[bad[0][1]]}")
    u, y = all_of[:, : len(options.inputs)], all_of[:, len(options.inputs) :]
    if options.despike and len(y):
        y = np.array([identify_doubts.despiked(column) for column in y.T]).T
    if options.every != 1:
        y = np.array([identification.decimate(column, options.every, options.cutoff) for column in y.T]).T if len(y) else y
        u = u[:: options.every]
    if len(u) < LEAST:
        raise UserError(f"{log.source or 'log'}: {len(u)} samples; at least {LEAST} are needed, and a search of orders wants more")
    for name, column in zip(channels, [*u.T, *y.T]):
        if np.ptp(column) == 0:
            raise UserError(f"{log.source or 'log'}: {name} never moves; every input has to be excited, and every output has to answer")
    at = np.zeros(u.shape[1] + y.shape[1]) if options.no_constant else np.concatenate([u.mean(axis=0), y.mean(axis=0)])
    levels = dict(zip(channels, map(float, at)))
    record = Record(u - at[: u.shape[1]], y - at[u.shape[1] :])
    if options.drift:
        try:
            lines = [record.y[:, i] if name in options.integrates else identify_doubts.straightened(record, i, border_of(record, options))
                     for i, name in enumerate(options.outputs)]
        except libreflux.Refused as error:
            raise RunFailed(f"--drift: {error}") from None
        record = Record(record.u, np.array(lines).T)
    return record, levels


def border_of(record: Record, options: argparse.Namespace) -> int:
    return round(record.samples * (1 - options.validation))


def moved_within(log: Log, options: argparse.Namespace) -> list[str]:
    """Inputs that do not stand still for the rows of a control interval, of which only the first one counts."""
    n = options.every
    found = []
    for name in options.inputs:
        u = np.array(input_of(log, name))
        whole = u[: len(u) // n * n].reshape(-1, n)
        if np.ptp(whole, axis=1).max(initial=0.0) > 1e-6 * np.ptp(u):
            found.append(name)
    return found


def period_of(log: Log, given: float | None) -> float:
    """s. A row that is lost or there twice would be a sample at the wrong time, so a given period is compared with the column time as well."""
    if given is not None and not 0 < given <= 1e6:
        raise UserError("--period must be above 0, to 1e6 s")
    at = time_column.find(log)
    if at is None:
        if given is None:
            unit = log.unit("time") if log.has("time") else ""
            raise UserError(f"the log has {f'a column time in {unit}' if unit else 'no column time'}: --period says how far its rows are apart, s; "
                            f"a column of times is called {time_column.WORDS}")
        return given
    times = time_column.seconds(log, *at)
    if len(times) < 2:
        raise UserError(f"{log.source or 'log'}: {len(times)} samples; at least {LEAST} are needed")
    steps = np.diff(times)
    period = float(np.median(steps)) if given is None else given
    wrong = np.flatnonzero(~(np.abs(steps - period) <= (JITTER if given is None else LOST) * period))
    if not period > 0:
        raise UserError("the rows of the log are not evenly spaced in time: it stands still or goes back")
    if len(wrong):
        row = int(wrong[0]) + 2
        raise UserError(f"the rows of the log are not evenly spaced in time: row {row} is {steps[row - 2]:g} s after the one before, and the period is {period:g} s")
    off = float(np.abs(steps - period).max()) / period
    if off > JITTER:
        print(f"note: the rows are not evenly spaced in time, but up to {100 * off:.2g} % of a period early or late; they are taken as even", file=sys.stderr)
    return period if given is not None or np.allclose(steps, period, rtol=1e-6) else float(f"{steps.mean():.6g}")


# ---- the models ----


def identify(record: Record, i: int, border: int, options: argparse.Namespace) -> Found:
    try:
        return given(record, i, border, options) if options.orders else searched(record, i, border, options)
    except libreflux.Refused as error:
        words = {SINGULAR: "; inputs that do not move on their own, or too few samples", EMPTY: "; too few samples for these orders"}.get(error.code, "")
        raise RunFailed(f"{options.outputs[i]}: {error}{words}") from None


def given(record: Record, i: int, border: int, options: argparse.Namespace) -> Found:
    na, nb = options.orders
    na -= options.outputs[i] in options.integrates
    chosen = fitted(record, i, Orders(na, ((1, nb),) * record.inputs, 0, not options.no_constant), border, options)
    return Found(options.outputs[i], None, [], chosen, identification.judge(record, i, chosen, (border, record.samples)))


def searched(record: Record, i: int, border: int, options: argparse.Namespace) -> Found:
    rest = (border, record.samples)
    integrates = options.outputs[i] in options.integrates
    source = identify_doubts.of_differences(record, i) if integrates else record
    trials = identification.select(source, i, options.na - integrates, options.nb, not options.no_constant, options.criterion, (0, border))
    looked = []
    for trial in candidates(trials):
        try:
            model = fitted(record, i, trial.orders, border, options)
        except libreflux.Refused:  # an unstable model on the way: the method has none of these orders
            continue
        judged = identification.judge(record, i, model, rest)
        looked.append(Looked(trial, model, judged, on_validation(trial, judged, options)))
    if not looked:
        raise RunFailed(f"{options.outputs[i]}: {options.method} finds a stable model of none of the orders; does it integrate (--integrates {options.outputs[i]})?")
    looked.sort(key=lambda one: one.criterion)
    return Found(options.outputs[i], trials, looked, looked[0].model, looked[0].judged)


def candidates(trials: Trials) -> list[identification.Trial]:
    """The best by the criterion of least squares on the data that models are made of, and the whole grid: noise that is not white
    has least squares ask for orders that the plant does not have."""
    known = sorted((t for t in trials.all if t.known), key=lambda t: t.criterion)
    return [t for k, t in enumerate(known) if k < SHOWN or len(set(t.orders.lags)) == 1]


def fitted(record: Record, i: int, orders: Orders, border: int, options: argparse.Namespace) -> Fit:
    nc = (max(1, orders.na) if options.nc is None else options.nc) if options.method == "els" else 0
    orders = Orders(orders.na, orders.lags, nc, orders.constant)
    if options.outputs[i] not in options.integrates:
        return identification.fit(record, i, orders, options.method, (0, border))
    return identify_doubts.integrated(identification.fit(identify_doubts.of_differences(record, i), i, orders, options.method, (0, border)))


def on_validation(trial: identification.Trial, judged: Judgement, options: argparse.Namespace) -> float:
    """The criterion of the errors of the simulation (of ls: one sample ahead) on data that the model has not seen."""
    n, p, square = judged.rows, trial.parameters, judged.step if options.method == "ls" else judged.simulated
    penalty = p * math.log(n) if options.criterion == "bic" else 2 * p + 2 * p * (p + 1) / (n - p - 1) if n > p + 1 else math.inf
    return n * math.log(max(square, 1e-24 * judged.about, 1e-300)) + penalty


# ---- shown ----


def polynomial(coefficients: list[float], sd: list[float], first: int, lead: str) -> str:
    words = [lead] if lead else []
    for power, (x, s) in enumerate(zip(coefficients, sd), first):
        if x or s:
            words.append(f"{'-' if x < 0 else '+' if words else ''} {abs(x):.6g} (sd {s:.2g}) z^-{power}".strip())
    return " ".join(words) or "0"


def print_output(one: Found, options: argparse.Namespace) -> None:
    print(f"\n{one.name}: {one.model.orders}, {options.method} on {one.model.rows} rows")
    if one.trials:
        rows = [["*" if look is one.looked[0] else "", str(look.trial.orders), str(look.trial.parameters), f"{look.trial.criterion:.1f}",
                 f"{look.criterion:.1f}", f"{math.sqrt(look.judged.step):.4g}", f"{100 * look.judged.fit():.1f}"] for look in one.looked[:SHOWN]]
        name = options.criterion.upper()
        print(table.columns(["", "orders", "parameters", f"{name} fitted", f"{name} validation", "rms one ahead", "fit simulated, %"], rows))
        print(f"{len(one.trials.all)} tried with ls, {len(one.looked)} of them with {options.method} on the validation data; the least {name} there is taken")
    if not one.model.settled:
        print(f"note: {options.method} had not settled after {one.model.passes} passes")
    print(f"validation: error one sample ahead {math.sqrt(one.judged.step):.4g}, simulated {math.sqrt(one.judged.simulated):.4g}, fit {100 * one.judged.fit():.1f} %")


def print_model(found: list[Found], options: argparse.Namespace, period: float) -> None:
    print()
    for i, one in enumerate(found, 1):
        sd, at = list(one.model.sd), one.model.orders.na
        print(f"A{i} = {polynomial(one.model.a(), sd[:at], 1, '1')}")
        for j, (row, (first, last)) in enumerate(zip(one.model.b(), one.model.orders.lags), 1):
            count = last - first + 1 if last else 0
            print(f"B{i}{j} = {polynomial(row[first - 1 :] if last else [], sd[at : at + count], first, '')}")
            at += count
    print("\ngains at rest")
    print(table.columns(["", *options.inputs], [[label(one, options), *(f"{g:.4g}" for g in gains(one.model, period))] for one in found]))


def label(one: Found, options: argparse.Namespace) -> str:
    return f"{one.name}, per s" if one.name in options.integrates else one.name


def integrates(model: Fit) -> bool:
    return abs(1 + sum(model.a())) < 1e-9


def gains(model: Fit, period: float) -> list[float]:
    """At rest; of an output that integrates per second."""
    a = np.array([1.0, *model.a()])
    at_one = period * float(np.cumsum(a)[:-1].sum()) if integrates(model) else float(a.sum())
    return [sum(row) / at_one if at_one else math.nan for row in model.b()]


def as_dict(found: list[Found], options: argparse.Namespace, period: float, levels: dict[str, float]) -> dict[str, Any]:
    return {"period_s": period, "method": options.method, "inputs": options.inputs, "levels": levels, "outputs": [
        {"name": one.name, "A": [1.0, *one.model.a()], "B": [[0.0, *row] for row in one.model.b()], "sd": [float(x) for x in one.model.sd],
         "constant": float(one.model.theta[-1]) if one.model.orders.constant else 0.0, "settled": one.model.settled, "gains": [g if math.isfinite(g) and not integrates(one.model) else None for g in gains(one.model, period)], "doubt": one.doubt,
         "validation": {**asdict(one.judged), "fit": one.judged.fit()},
         "trials": [{"orders": asdict(t.orders), "criterion": t.criterion, "parameters": t.parameters} for t in one.trials.all if t.known] if one.trials else [],
         "looked": [{"orders": asdict(look.trial.orders), "criterion": look.criterion, "fit": look.judged.fit()} for look in one.looked]}
        for one in found]}


def draw(place: Path, record: Record, found: list[Found], border: int, period: float) -> None:
    from reflux import identify_picture  # matplotlib takes a second to load

    series = [(one.name, record.y[:, i], identification.simulate(record, i, one.model)) for i, one in enumerate(found)]
    try:
        place.write_bytes(identify_picture.draw(series, border, period))
    except OSError as error:
        raise UserError(f"{shown(place)} cannot be written: {error.strerror}") from None
