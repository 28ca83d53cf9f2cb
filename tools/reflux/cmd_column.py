"""tools/column: the profile of a column as a picture, and what its linearisation says about controlling it."""

from __future__ import annotations

import argparse
import csv
import json
import math
import textwrap
from dataclasses import dataclass
from pathlib import Path

from reflux import build, column_file, plant_file, simulator
from reflux.errors import UserError
from reflux.paths import named, out_root, shown, tool
from reflux.table import columns, figure

SLOWEST = 5
TEMPERATURES = ("K", "degC")  # of stages without a thermometer: the picture has them
UNBROKEN = "\u00a0"
SWINGS = 0.5  # imaginary over real part of a pole: below it what swings is gone before one sees it


@dataclass(frozen=True)
class Channel:
    kind: str
    name: str
    unit: str
    span: float


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog=tool("column"), description="Draws a column's profile and prints its steady-state gains, relative gains, "
        "directions and times at the steady state of its inputs, outputs and inputs in spans where they are compared.")
    p.add_argument("column", metavar="NAME_OR_FILE", help="a column of host_sim/plants by name, or the path of a file (docs/use/columns.md)")
    p.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="value of an input instead of its nominal one; repeatable")
    p.add_argument("--outputs", type=_names, metavar="NAME,...",
                   help="outputs to use (default: in each section the temperature nearest its steepest place; the compositions of both products)")
    p.add_argument("--inputs", type=_names, metavar="NAME,...", help="inputs to use (default: all manipulated variables)")
    p.add_argument("--out", type=named, metavar="PNG", help="file of the picture (default: out/column/NAME.png)")
    p.add_argument("--board", action="store_true", help="prints all console lines of a board for this column, as one paste: channels, loops, interlock, "
                   "table, estimator (docs/use/columns.md); draws nothing")
    options = p.parse_args(arguments)

    column = column_file.read(options.column)
    if options.board and (options.outputs or options.inputs or options.out):
        raise UserError("--board goes with --set alone")
    build.build("host", ("reflux-sim", *(("libreflux",) if options.board else ())), quiet=True)
    if options.board:
        from reflux import board_lines  # numpy and scipy likewise
        print("\n".join(board_lines.lines(options.column, tuple(options.set), plant_file.load(options.column)[0])))
        return 0
    settings = [word for value in options.set for word in ("--set", value)]
    known = _channels(options.column)
    inputs = options.inputs or tuple(c.name for c in known.values() if c.kind == "manipulated")
    _check(inputs, known, ("manipulated", "disturbance"), "input", column.name)
    _check(options.outputs or (), known, ("measurement", "internal"), "output", column.name)
    seen = profile(options.column, settings)
    place = options.out or out_root() / "column" / f"{column.name}.png"
    draw(column, seen, place)
    temperatures = () if options.outputs else column_file.steepest(column, seen["T[K]"])
    groups = [options.outputs] if options.outputs else [group for group in (temperatures, column.products) if group]
    print(f"{column.name}: {column.title}\n{column.stages} stages, feed on {column.feed_stage}\n")
    _print_rest(options.column, tuple(options.set), known)
    for words in [] if options.outputs else column_file.without_temperature(column, temperatures):
        print(f"{words}\n")
    _analysis(options.column, settings, known, inputs, groups)
    print(f"\n{shown(place)}")
    return 0


def _names(text: str) -> tuple[str, ...]:
    names = tuple(text.split(","))
    if not all(names) or len(set(names)) < len(names):
        raise argparse.ArgumentTypeError(f"{text}: must be names, each once, with commas between them")
    return names


def _channels(name: str) -> dict[str, Channel]:
    rows = [line.split() for line in simulator.ask("--list", name).splitlines() if line.startswith("  ")]
    found = [Channel(w[0], w[1], w[2], float(w[5]) - float(w[3])) for w in rows if len(w) > 5 and w[4] == "to"]
    return {c.name: c for c in found}


def profile(name: str, settings: list[str]) -> dict[str, list[float]]:
    """Columns of reflux-sim --profile, from the reboiler up; NaN where a stage has no such thing."""
    text = simulator.ask("--profile", "--plant", name, *settings)
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    return {key: [float(row[key]) if row[key] else math.nan for row in rows] for key in rows[0]}


def draw(column: column_file.ColumnFile, seen: dict[str, list[float]], place: Path) -> None:
    from reflux import column_picture  # matplotlib takes a second to load
    picture = column_picture.draw(column, seen)
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(picture)
    except OSError as error:
        raise UserError(f"{shown(place)} cannot be written: {error.strerror}") from None


def _analysis(name: str, settings: list[str], known: dict[str, Channel], inputs: tuple[str, ...],
              groups: list[tuple[str, ...]]) -> None:
    from reflux import linear_analysis as linear  # and scipy likewise
    progress = build.Progress("linearisation")
    progress.show("differences")
    data = json.loads(simulator.ask("--linearise", "--plant", name, "--format", "json", *settings))
    model = linear.Model(*(linear.np.array(data[key], float).reshape(shape) for key, shape in (
        ("A", (len(data["x"]), -1)), ("B", (len(data["x"]), -1)), ("C", (len(data["outputs"]), -1)),
        ("D", (len(data["outputs"]), -1)))), tuple(data["inputs"]), tuple(data["outputs"]))
    progress.show("poles")
    found = linear.poles(model)
    obstacle = linear.obstacle(found)
    every = tuple(dict.fromkeys(name for group in groups for name in group))
    if every and not obstacle:
        part = model.only(inputs, every)
        k = linear.gains(part)
        spans = k * linear.np.array([known[u].span for u in inputs]) / linear.np.array([[known[y].span] for y in every])
        progress.show("step responses")
        settle = linear.settling(part, k, spans, -1.0 / found[0].real)
    progress.end(f"{len(found)} states")
    for note in data["notes"]:
        print(f"note: {note}")
    _print_times(found)
    if obstacle or not every:
        print(f"\nNo steady-state gains: {obstacle or 'no temperature or product is seen; --outputs names others'}.")
        return
    for group in groups:
        rows = [every.index(name) for name in group]
        _print_group(linear, inputs, group, known, k[rows], spans[rows], settle[rows])


def _check(names: tuple[str, ...], known: dict[str, Channel], kinds: tuple[str, ...], what: str, column: str) -> None:
    there = [c.name for c in known.values() if c.kind in kinds]
    for name in names:
        if name not in there:
            raise UserError(f"--{what}s {name}: {column} has no such {what}; there is {' '.join(there)}")


def _duration(seconds: float) -> str:
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if abs(seconds) >= 2 * size:
            return f"{figure(seconds / size)} {unit}"
    return f"{figure(seconds)} s"


def _print_rest(name: str, settings: tuple[str, ...], known: dict[str, Channel]) -> None:
    """The steady state: what the inputs must be, and what the column then does."""
    rest = simulator.at_rest(name, settings)
    print("At rest")
    for title, kinds in (("inputs", ("manipulated",)), ("disturbances", ("disturbance",)), ("outputs", ("measurement",)), ("truths", ("internal",))):
        words = [f"{c.name} {figure(rest[c.name], 4)} {c.unit}".removesuffix(" -").replace(" ", UNBROKEN) for c in known.values()
                 if c.kind in kinds and c.name in rest and (c.kind != "internal" or c.unit not in TEMPERATURES)]
        if words:
            print(textwrap.fill(", ".join(words), 120, initial_indent=f"  {title}: ", subsequent_indent="    ").replace(UNBROKEN, " "))
    print()


def _print_times(found) -> None:  # type: ignore[no-untyped-def]
    words, seen = [], 0
    for pole in found:
        if pole.imag < 0:
            continue  # the other one of a pair
        if seen == SLOWEST:
            break
        seen += 1
        size = "for ever" if pole.real == 0 else _duration(1 / abs(pole.real))
        word = f"{size}, growing" if pole.real > 0 else size
        if pole.imag > SWINGS * abs(pole.real):
            word += f" (swings, period {_duration(2 * math.pi / pole.imag)})"
        words.append(word)
    print(f"slowest time constants: {', '.join(words)}")


def _print_group(linear, inputs, outputs, known, k, spans, settle) -> None:  # type: ignore[no-untyped-def]
    relative = linear.relative_gains(spans)
    print(f"\nOutputs {', '.join(outputs)} by {', '.join(inputs)}: gains in engineering units, time until a step's response is "
          "within 5 % of its end\n")
    head = ["output", "unit", *(f"by {u} [{known[u].unit}]" for u in inputs), *(f"settles {u}" for u in inputs)]
    print(columns(head, [[y, known[y].unit, *(figure(v, 4) for v in k[i]),
                          *("-" if math.isnan(t) else _duration(t) for t in settle[i])] for i, y in enumerate(outputs)]))
    square = len(inputs) == len(outputs)
    print(f"\nRelative gains{'' if square else ' (not square: sums of rows and columns)'}\n")
    rows = [[y, *(f"{v:.3f}" for v in relative[i]), *([] if square else [f"{relative[i].sum():.3f}"])]
            for i, y in enumerate(outputs)]
    if not square:
        rows.append(["sum", *(f"{v:.3f}" for v in relative.sum(axis=0)), f"{relative.sum():.3f}"])
    print(columns(["output", *inputs, *([] if square else ["sum"])], rows))
    d = linear.directions(spans)
    print(f"\nIn spans: singular values {', '.join(figure(v) for v in d.values)}; condition number {figure(d.condition)}")
    for which, at in (("strong", 0), ("weak", -1)):
        if len(d.values) > 1 or at == 0:
            print(f"  {which} direction: {_direction(d.inputs[at], inputs)} moves {_direction(d.outputs[at], outputs)}")


def _direction(vector, names) -> str:  # type: ignore[no-untyped-def]
    return ", ".join(f"{name} {value:+.2f}" for value, name in zip(vector, names))
