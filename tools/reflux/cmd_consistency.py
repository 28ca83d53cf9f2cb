"""tools/consistency: covariances of an estimator's filter from physical quantities, and whether a recorded run bears them out."""

from __future__ import annotations

import argparse
import json
import math
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

from reflux import build, consistency, consistency_lines, recorded_run, table
from reflux.consistency_search import Look, Run, Search, look, search
from reflux.errors import UserError
from reflux.paths import named, shown, tool

METHODS = ("ekf", "kalman", "rekf")


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog=tool("consistency"),
        description="Covariances for the filters of a block of the kind composition: `lines` makes them from physical quantities, `check` replays a recorded run to "
        "the firmware and says whether the innovations are as the filter expects them, and what to change (docs/methods/consistency.md).",
    )
    what = p.add_subparsers(dest="what", required=True, metavar="lines|check")
    _lines_parser(what.add_parser("lines", help="the block's parameters from sensor, feed and model", description="Prints the block's lines for the console."))
    _check_parser(what.add_parser("check", help="innovations of a recorded run", description="Replays a run, as fast as it goes, and judges the innovations."))
    return p


def _lines_parser(p: argparse.ArgumentParser) -> None:
    p.add_argument("--sd", type=float, required=True, metavar="K", help="standard deviation of a thermometer's readings at rest")
    p.add_argument("--resolution", type=float, default=0.0, metavar="K", help="resolution of the readings (default 0)")
    p.add_argument("--feed-range", type=float, default=0.0, metavar="X", help="range of the feed's mole fraction, highest less lowest (default 0: as the table has it)")
    p.add_argument("--feed-stays", type=float, default=4.0, metavar="H", help="mean hours from one change of the feed to the next (default 4)")
    p.add_argument("--flow-accuracy", type=float, default=0.0, metavar="PART", help="accuracy of the feed's flow meter: 0.02 is +-2 %% (default 0)")
    p.add_argument("--model-error", type=float, default=0.01, metavar="X", help="standard deviation of the model's error with the right feed, mole fraction "
                   "(default 0.01)")
    p.add_argument("--model-time", type=float, default=1.0, metavar="H", help="slowest time constant of the column, hours (tools/column prints it; default 1)")
    p.add_argument("--analyser", type=float, metavar="X", help="standard deviation of an analysis, mole fraction")
    p.add_argument("--analyser-resolution", type=float, default=0.0, metavar="X", help="resolution of the analyses (default 0)")
    p.add_argument("--offset", type=float, metavar="X", help="largest error of the model at the analyser's place, mole fraction")
    p.add_argument("--method", choices=METHODS, default="ekf", help="filter of the block (default ekf)")
    p.add_argument("--block", type=int, default=3, metavar="N", help="number of the block (default 3)")


def _check_parser(p: argparse.ArgumentParser) -> None:
    p.add_argument("run", type=named, metavar="RUN", help="a folder that tools/run has written, or telemetry of a board's console (tools/console --log)")
    p.add_argument("--conf", type=named, action="append", default=[], metavar="FILE", help="console lines of the configuration, in place of the run's; repeatable")
    p.add_argument("--block", type=int, metavar="N", help="number of the block, where several are of the kind composition")
    p.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="a parameter of the block in the replay, as method=ekf or noise=0.3; repeatable")
    p.add_argument("--from", dest="first", type=float, metavar="H", help="begin at this hour of plant time (default: half an hour after the block's monitor begins to count)")
    p.add_argument("--to", dest="last", type=float, metavar="H", help="end at this hour (default: the end of the run)")
    p.add_argument("--try", dest="tries", action="store_true", help="replay with the proposed numbers as well, until they fit or none do")
    p.add_argument("--format", choices=("text", "json"), default="text")
    p.add_argument("--out", type=named, metavar="PNG", help="file of the picture (default: consistency.png beside the log; with --format json none)")
    p.add_argument("--no-build", action="store_true", help="do not build; use what is there")


def main(arguments: list[str]) -> int:
    options = parser().parse_args(arguments)
    return lines(options) if options.what == "lines" else check(options)


# ---- from physical quantities ----


def lines(options: argparse.Namespace) -> int:
    for name, low in (("sd", 0.0), ("resolution", 0.0), ("feed_range", 0.0), ("flow_accuracy", 0.0), ("model_error", 0.0), ("analyser_resolution", 0.0)):
        if not low <= getattr(options, name) < math.inf:
            raise UserError(f"--{name.replace('_', '-')} must be a number of {low:g} or more")
    if options.feed_range > 1 or options.flow_accuracy > 1:
        raise UserError("--feed-range is in mole fractions and --flow-accuracy a part of the flow: both at most 1")
    if not options.model_time > 0 or not options.feed_stays > 0:
        raise UserError("--model-time and --feed-stays must be more than 0 h")
    if options.method == "rekf" and (options.flow_accuracy or options.analyser is not None or options.offset is not None):
        raise UserError("--flow-accuracy, --analyser and --offset have no place in rekf, which estimates neither; --method ekf or kalman has")
    known = consistency_lines.Known(options.method, options.sd, options.resolution, options.feed_range, options.feed_stays, options.flow_accuracy,
                                    options.model_error, options.model_time, options.analyser, options.analyser_resolution, options.offset)
    rows = consistency_lines.rows(known)
    limits = {"noise": consistency.NOISE_LIMITS, "model": consistency.MODEL_LIMITS}
    for row in rows:
        low, high = limits.get(row.name, (0.0, math.inf))
        if not low <= row.value <= high:
            raise UserError(f"{row.name} would be {row.value:.3g}, and the block takes {low:g} to {high:g}; look at --{'sd' if row.name == 'noise' else 'model-error'}")
    print(f"set block{options.block}.method {options.method}")
    for r in rows:
        print(f"# {r.why}\nset block{options.block}.{r.name} {consistency_lines.figure(r.value)}")
    return 0


# ---- on a recorded run ----


def check(options: argparse.Namespace) -> int:
    given = pairs(options.set)
    of, block = recorded_run.read(options.run, options.conf, options.block)
    if not options.no_build:
        build.build("host", ("reflux-host",), quiet=True)
    run = Run(of, block, given, options.first, options.last)
    replays = [0]
    progress = build.Progress("replay", quiet=options.format == "json" or not sys.stdout.isatty())
    run.show = lambda text: progress.show(f"{replays[0] + 1}, {text}")

    def told(one: Look) -> None:
        replays[0] += 1
        if options.format == "text" and replays[0] == 1:
            print_head(run, one)
            print_look(one)
        elif options.format == "text":
            print_line(one, replays[0])

    first = look(run)
    told(first)
    found = search(run, first, told) if options.tries else Search([first], consistent=first.judgement.consistent)
    place = options.out or (options.run if options.run.is_dir() else options.run.parent) / "consistency.png"
    if options.format == "text" or options.out:
        draw(found.best, run, place)
    if options.format == "json":
        print(json.dumps(as_dict(found, run), indent=1))
        return 0
    if len(found.looks) > 1:
        print_look(found.best)
    print_words(found.best)
    print_end(found, run, options.tries)
    print(f"\n{shown(place)}")
    return 0


def pairs(texts: list[str]) -> dict[str, str]:
    out = {}
    for text in texts:
        name, sign, value = text.partition("=")
        if not sign or not name or not value or " " in text:
            raise UserError(f"--set {text}: must be NAME=VALUE, a parameter of the block as noise=0.3")
        out[name] = value
    return out


def draw(one: Look, run: Run, place: Path) -> None:
    from reflux import consistency_picture  # matplotlib takes a second to load

    title = f"block {run.block.number}, {one.setting.method}, noise {one.setting.noise:.3g} K, model {one.setting.model:.3g}"
    try:
        place.write_bytes(consistency_picture.draw(title, one.series, one.statistics, run.recorded.time_s))
    except OSError as error:
        raise UserError(f"{shown(place)} cannot be written: {error.strerror}") from None


# ---- shown ----

HEADER = ["thermometer", "stage", "innovations", "independent", "NIS", "expected", "correlation", "mean, sd", "mean, K", "noise, K"]


def print_head(run: Run, one: Look) -> None:
    print(f"{run.recorded.source}: block {run.block.number}, {len(run.block.sensors)} thermometers, ticks of {run.recorded.tick_s:g} s, from {one.first_s / 3600:.2f} h to "
          f"{one.last_s / 3600:.2f} h")
    for text in run.recorded.not_played:
        print(f"note: {text} is not replayed; the run is judged with the settings of its beginning")


def told_setting(one: Look) -> str:
    feed = "".join(f", {name} {sd:.3g} (found {one.setting.found[name]:.2g})" for name, sd in one.setting.feed.items() if one.setting.method in consistency.WITH_FEED)
    without = "".join(f", {name} {-x:+.2f} K taken off" for name, x in one.shift.items())
    return f"noise {one.setting.noise:.3g} K, model {one.setting.model:.3g}{feed}{without}"


def print_look(one: Look) -> None:
    print(f"\n{one.setting.method}, {told_setting(one)}")
    print(table.columns(HEADER, [row_of(s) for s in one.known()]))


def print_line(one: Look, number: int) -> None:
    print(("\n" if number == 2 else "") + f"replay {number}: {told_setting(one)}: NIS {' '.join(f'{s.nis:.2f}' for s in one.known())}, correlation "
          f"{' '.join(f'{s.rho:+.2f}' for s in one.known())}", flush=True)


def row_of(s: Any) -> list[str]:
    own = f"{s.own_noise:.3f}" if math.isfinite(s.own_noise) else "-"
    return [s.sensor.name, str(s.sensor.stage), str(s.ticks), f"{s.independent:.0f}", f"{s.nis:.2f}", f"{s.low:.2f}..{s.high:.2f}", f"{s.rho:+.2f}", f"{s.mean:+.2f}",
            f"{s.mean_k:+.3f}", own]


def print_words(one: Look) -> None:
    print()
    for v in one.judgement.each:
        print(f"{v.name}: {v.words}")
    for s in one.known():
        if s.left_out > s.ticks / 10:
            print(f"note: {s.left_out} ticks of {s.sensor.name} are left out: not good, beyond `gate`, or the block did not take them")
    for note in one.judgement.notes:
        print(note)


def console_lines(run: Run, changes: dict[str, float]) -> list[str]:
    return [f"  set block{run.block.number}.{name} {x:.3g}" for name, x in changes.items()]


def print_end(found: Search, run: Run, tries: bool) -> None:
    print()
    if found.offset:
        name, amount = found.offset
        sensor = next(s for s in run.block.sensors if s.name == name)
        print(f"{name} reads about {amount:+.2f} K too much beside the others of its section, if these are right. Calibrate it; until then")
        print(f"  set block{run.block.number}.si.{sensor.number} {si_without(run, sensor.number, amount)}")
    if found.consistent:
        print("consistent" + (", with" if found.best.changes else "."))
        print("\n".join(console_lines(run, found.best.changes)) if found.best.changes else "", end="\n" if found.best.changes else "")
        return
    if not tries:
        changes = found.best.judgement.changes
        print("not consistent; " + ("to be tried (--try does):" if changes else "and I do not know a covariance that would make it so."))
        print("\n".join(console_lines(run, changes)), end="\n" if changes else "")
        return
    print(f"no covariance makes it so: {'; '.join(found.reasons) or 'I do not know why'}.")
    if found.best.setting.method not in consistency.WITH_FEED and any(v.kind in ("biased", "correlated") for v in found.best.judgement.each):
        print("The method has no states for the feed: --set method=ekf replays the run by one that has.")
    if found.best.changes:
        print("The nearest, which leaves this as it is:")
        print("\n".join(console_lines(run, found.best.changes)))


def si_without(run: Run, number: int, amount: float) -> str:
    factor, zero = (*map(float, run.block.get(f"si.{number}", "0,0").split(",")), 0.0)[:2]
    return f"{factor or 1.0:.9g},{zero - amount:.6g}"


def as_dict(found: Search, run: Run) -> dict[str, Any]:
    def of(one: Look) -> dict[str, Any]:
        return {"setting": asdict(one.setting), "changes": one.changes, "shift_K": one.shift,
                "thermometers": [{"name": s.sensor.name, **{k: none_of_nan(v) for k, v in asdict(s).items() if k != "sensor"}} for s in one.known()],
                "verdicts": [asdict(v) for v in one.judgement.each], "notes": one.judgement.notes, "odd": one.judgement.odd, "proposed": one.judgement.changes}

    offset = {"thermometer": found.offset[0], "K": found.offset[1]} if found.offset else None
    return {"run": run.recorded.source, "block": run.block.number, "from_h": found.best.first_s / 3600, "to_h": found.best.last_s / 3600, "consistent": found.consistent,
            "offset": offset, "reasons": found.reasons, "replays": [of(one) for one in found.looks]}


def none_of_nan(x: Any) -> Any:
    return None if isinstance(x, float) and not math.isfinite(x) else x
