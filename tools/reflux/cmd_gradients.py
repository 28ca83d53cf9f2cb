"""tools/gradients: where to put thermometers, from the steady state of a column."""

from __future__ import annotations

import argparse
import json
import math
import re
from pathlib import Path
from typing import Any

from reflux import build, column_file, column_slopes, estimate_lines, gradients, plant_file, sensor_rules, simulator, table
from reflux.errors import UserError
from reflux.gradients import Diagram
from reflux.paths import named, out_root, shown, tool
from reflux.sensor_rules import Choice, Steps, Thresholds

STEP_PARTS = (
    0.001,
    0.01,
)  # of each input: the source takes the first at its first steady state, the second at the other


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog=tool("gradients"),
        description="Draws the gradient diagram of a column at a steady state, from the simulator or from a profile of "
        "your own, and proposes which temperatures to control with and to estimate from, with reasons (docs/methods/gradients.md).",
    )
    p.add_argument(
        "column",
        metavar="NAME_OR_FILE",
        nargs="?",
        help="a column of host_sim/plants by name, or the path of a file (docs/use/columns.md)",
    )
    p.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="value of an input instead of its nominal one; repeatable"
    )
    p.add_argument(
        "--profile",
        type=named,
        metavar="CSV",
        help="a profile of your own: stage, T[K] or T[degC], x.NAME; with K.NAME no column is needed",
    )
    p.add_argument("--feed", type=int, metavar="STAGE", help="feed stage of that profile, where no column gives it")
    p.add_argument(
        "--keys",
        type=_two,
        metavar="LIGHT,HEAVY",
        help="key components (default: the neighbours between which the column cuts)",
    )
    p.add_argument(
        "--loop",
        action="append",
        default=[],
        metavar="MV:STAGE[,STAGE]",
        help="prints the console lines of a loop of the kind inferential: input, primary, secondary stage; repeatable",
    )
    p.add_argument(
        "--estimate",
        action="append",
        default=[],
        metavar="COMPONENT:STAGE",
        help="prints the console lines of a block of the kind composition that estimates this; repeatable",
    )
    for name, value in Thresholds().__dict__.items():
        p.add_argument(
            f"--{name.replace('_', '-')}",
            type=type(value),
            default=value,
            metavar="X",
            help=f"threshold, docs/methods/gradients.md; default {value:g}",
        )
    p.add_argument(
        "--step",
        type=float,
        default=STEP_PARTS[0],
        metavar="PART",
        help="of the input steps, part of their value; default 0.001",
    )
    p.add_argument("--no-steps", action="store_true", help="leave the other methods out")
    p.add_argument("--format", choices=("text", "json"), default="text")
    p.add_argument("--out", type=named, metavar="PNG", help="the picture; default: out/gradients/NAME.png")
    options = p.parse_args(arguments)
    t = Thresholds(**{name: getattr(options, name) for name in Thresholds().__dict__})
    if options.column is None and options.profile is None:
        raise UserError(f"names no column and no --profile; as: {tool('gradients')} splitter")
    if not 0 < options.step < 0.5:
        raise UserError("--step must be above 0 and below 0.5")
    found = from_csv(options) if options.profile else from_simulator(options)
    report = judge(found, options, t)
    place = options.out or out_root() / "gradients" / f"{found.name}.png"
    draw(found, report, place)
    if options.format == "json":
        print(json.dumps(report, indent=1))
    else:
        print_report(found, report)
        print(f"\n{shown(place)}")
    return 0


def _two(text: str) -> tuple[str, str]:
    names = text.split(",")
    if len(names) != 2 or not all(names):
        raise argparse.ArgumentTypeError(f"{text}: must be two names with a comma between them")
    return names[0], names[1]


class Found:
    """A diagram and what belongs to it."""

    def __init__(self, name: str, title: str, diagram: Diagram, feed: int, profile: gradients.Profile, heavier: list[float]):
        self.name, self.title, self.diagram, self.feed, self.profile, self.heavier = name, title, diagram, feed, profile, heavier
        self.steady: column_slopes.Steady | None = None
        self.plant: dict[str, Any] = {}
        self.inputs: dict[str, float] = {}  # manipulated variables at the steady state


def read_plant(name: str) -> dict[str, Any]:
    column_file.read(name)  # says what is wrong
    return plant_file.load(name)[0]


def from_simulator(options: argparse.Namespace) -> Found:
    plant = read_plant(options.column)
    build.build("host", ("reflux-sim",), quiet=True)
    at = column_slopes.steady(options.column, simulator.numbers(options.set))
    of = gradients.diagram(at.temperature, at.x, at.names, gradients.liquid_of(plant, at.names))
    out = Found(
        str(plant["name"]),
        str(plant["title"]),
        of,
        int(plant["feed_stage"]),
        gradients.Profile(at.temperature, at.x, at.names),
        gradients.heaviness(plant, at.names, at.temperature),
    )
    rest = simulator.at_rest(options.column, options.set)
    out.steady, out.plant, out.inputs = at, plant, {c["name"]: rest[c["name"]] for c in plant["inputs"]}
    return out


def from_csv(options: argparse.Namespace) -> Found:
    profile = gradients.read_csv(options.profile)
    plant = read_plant(options.column) if options.column else {}
    feed = options.feed or int(plant.get("feed_stage", 0))
    if not 2 <= feed < len(profile.temperature):
        raise UserError(f"--feed: the stage that is fed is needed, 2 to {len(profile.temperature) - 1}")
    if profile.k:
        of, heavier = gradients.diagram_of_k(profile), [-k for k in profile.k[0]]
    elif plant:
        known = gradients.constants_of(plant)
        missing = [n for n in profile.names if n not in known]
        if missing:
            raise UserError(
                f"{shown(options.profile)}: {', '.join(missing)}: no component of {options.column}, which has {', '.join(known)}"
            )
        of = gradients.diagram(profile.temperature, profile.x, profile.names, gradients.liquid_of(plant, profile.names))
        heavier = gradients.heaviness(plant, profile.names, profile.temperature)
    else:
        of, heavier = gradients.diagram(profile.temperature, profile.x, profile.names, None), []
    return Found(options.profile.stem, f"profile of {shown(options.profile)}", of, feed, profile, heavier)


# ---- what is found ----


def judge(found: Found, options: argparse.Namespace, t: Thresholds) -> dict[str, Any]:
    of, x = found.diagram, found.profile.x
    for name in options.keys or ():
        if name not in of.names:
            raise UserError(f"--keys: {name} is not a component; there are {', '.join(of.names)}")
    keys = options.keys or (sensor_rules.keys_of(x[-1], x[0], of.names, found.heavier) if found.heavier else None)
    choices = [
        sensor_rules.choose(of, found.feed, section, keys or of.names, t) for section in ("enriching", "stripping")
    ]
    for_estimates = sensor_rules.estimation(of, found.feed, t)
    report: dict[str, Any] = {
        "name": found.name,
        "feed_stage": found.feed,
        "components": of.names,
        "keys": list(keys or ()),
        "stages": [
            {
                "stage": s,
                "T": found.profile.temperature[s - 1],
                "gradient": of.gradient[s - 1] if s < of.stages else None,
                "shares": dict(zip(of.names, of.share[s - 1])) if of.share and s < of.stages else None,
                "keys": none_of_nan(of.part_of(s, keys or of.names)) if s < of.stages else None,
            }
            for s in range(1, of.stages + 1)
        ],
        "control": [choice.__dict__ for choice in choices],
        "estimation": {**for_estimates.__dict__, "innovated": {str(s): n for s, n in for_estimates.innovated.items()}},
        "notes": notes(of, keys),
        "steps": [],
        "lines": lines_of(found, options.loop) if options.loop else [],
        "estimate_lines": estimate_of(options, found, t) if options.estimate else [],
    }
    if found.steady and not options.no_steps:
        report["steps"], report["singular"] = other_methods(found, options)
    return report


def none_of_nan(x: float) -> float | None:
    return None if math.isnan(x) else x


def notes(of: Diagram, keys: tuple[str, str] | None) -> list[str]:
    out = []
    if not of.share:
        out.append(
            "I do not know what each component has to do with the gradient: no vapour pressures (give a column, or columns K.NAME)."
        )
    elif keys is None:
        out.append(
            "I do not know the key components: there is no pair of neighbours of which one goes up and the other down. All count as keys; "
            "--keys LIGHT,HEAVY names them."
        )
    return out


def other_methods(found: Found, options: argparse.Namespace) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    assert found.steady is not None
    progress = build.Progress("input steps", quiet=options.format == "json")
    moved = []
    for name, value in found.inputs.items():
        progress.show(name)
        if not value:
            continue
        both = []
        for sign in (1, -1):
            try:
                there = column_slopes.steady(
                    options.column, {**found.steady.inputs, name: value * (1 + sign * options.step)}
                )
                both.append([a - b for a, b in zip(there.temperature, found.steady.temperature)])
            except UserError:
                both.append([])
        if all(both):
            moved.append(Steps(name, both[0], both[1]))
    progress.end(f"{len(moved)} inputs, {100 * options.step:g} % either way")
    steps = [
        {
            "input": s.input,
            "best": best,
            "mean_K": s.mean(best) if best else None,
            "asymmetry": s.asymmetry(best) if best else None,
        }
        for s, best in ((s, s.best()) for s in moved)
    ]
    moved = [s for s in moved if s.best()]  # others have no gain
    if len(moved) < 2:
        return steps, {}
    chosen, values = sensor_rules.singular(moved)
    return steps, {
        "stages": chosen,
        "values_K": values,
        "condition": values[0] / values[-1] if values[-1] else None,
        "condition_of_stages": sensor_rules.condition(moved, chosen),
    }


# ---- console lines ----


def lines_of(found: Found, loops: list[str]) -> list[str]:
    """Lines with the numbers from which the board works out slopes: rows of the kind inferential."""
    if found.steady is None:
        raise UserError("--loop needs a column, whose flows and holdups the slopes come from; not a profile alone")
    kinds = {c["name"]: c["is"] for c in found.plant["inputs"]}
    out = ["set block1.kind inferential", f"set block1.parts {len(found.diagram.names)}"]
    for k, text in enumerate(loops, 1):
        match = re.fullmatch(r"(\w+):(\d+)(?:,(\d+))?", text)
        if not match:
            raise UserError(f"--loop {text}: must be MV:STAGE or MV:STAGE,STAGE, as Q:5,7")
        mv, stages = match[1], [int(s) for s in match.groups()[1:] if s]
        moves = {"reflux": "reflux", "heat": "heat", "boilup": "heat"}.get(kinds.get(mv, ""), "")
        value = found.inputs.get(mv)
        if not moves or not value:
            raise UserError(
                f"--loop {text}: {mv} is not a reflux, heat or boil-up of this column; it has {', '.join(kinds)}"
            )
        both = (*stages, stages[-1])[:2]
        at = found.steady
        out += [
            f"set block1.moves.{k} {moves}",
            f"set block1.stage.{k} {','.join(str(s) for s in (*stages, 0)[:2])}",
            f"set block1.gradient.{k} {','.join(f'{at.gradient(s):.6g}' for s in both)}",
            f"set block1.holdup.{k} {','.join(f'{at.holdup[s - 1]:.6g}' for s in both)}",
            f"set block1.lv.{k} {','.join(f'{at.liquid_to_vapour(s):.6g}' for s in both)}",
            f"set block1.flow.{k} {at.flow(moves, value):.6g}",
        ]
    return out


def estimate_of(options: argparse.Namespace, found: Found, t: Thresholds) -> list[str]:
    if found.steady is None:
        raise UserError("--estimate needs a column, whose inputs drive the model; not a profile alone")
    seen = (*found.plant.get("outputs", []), *found.plant.get("truths", []))
    column = estimate_lines.Column(options.column, tuple(options.set), found.plant, found.diagram, t, seen)
    return estimate_lines.lines(column, options.estimate)


# ---- shown ----


def draw(found: Found, report: dict[str, Any], place: Path) -> None:
    from reflux import gradients_picture  # matplotlib takes a second to load

    picture = gradients_picture.draw(found.name, found.title, found.diagram, found.feed, report)
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(picture)
    except OSError as error:
        raise UserError(f"{shown(place)} cannot be written: {error.strerror}") from None


def print_report(found: Found, report: dict[str, Any]) -> None:
    of = found.diagram
    header = [
        "stage",
        "T, K",
        "gradient, K",
        *(f"{n}, K" for n in (of.names if of.share else [])),
        *(["keys"] if of.share else []),
    ]
    rows = []
    for row in reversed(report["stages"]):
        cells = [str(row["stage"]), f"{row['T']:.2f}"]
        if row["gradient"] is not None:
            cells += [f"{row['gradient']:+.2f}", *(f"{v:+.2f}" for v in (row["shares"] or {}).values())]
            cells += [f"{100 * row['keys']:.0f} %"] if of.share and row["keys"] is not None else []
        rows.append([*cells, *["-"] * (len(header) - len(cells))])
    print(
        f"{found.name}: {found.title}\n{of.stages} stages, feed on {found.feed}"
        + (f"; keys {' and '.join(report['keys'])}" if report["keys"] else "")
        + "\n"
    )
    print(table.columns(header, rows))
    for note in report["notes"]:
        print(f"\nnote: {note}")
    print("\nControl")
    for choice in report["control"]:
        print_choice(Choice(**choice))
    print_estimation(report["estimation"], bool(of.share))
    if report["steps"]:
        print("\nOther methods")
        for step in report["steps"]:
            if not step["best"]:
                print(
                    f"  input steps of {step['input']}: I do not know; up and down do not move the temperatures in opposite ways"
                )
                continue
            print(
                f"  input steps of {step['input']}: largest and most symmetric on stage {step['best']} ({step['mean_K']:.2f} K either way, asymmetry {step['asymmetry']:.2f})"
            )
    if report.get("singular"):
        s = report["singular"]
        print(
            f"  singular values {', '.join(f'{v:.3g}' for v in s['values_K'])} K per step: stages {' and '.join(str(x) for x in s['stages'])}; condition of all stages "
            f"{s['condition']:.1f}, of these {s['condition_of_stages']:.1f}"
        )
    if report["lines"]:
        print("\nFor the console, between begin and apply:\n  " + "\n  ".join(report["lines"]))
    if report["estimate_lines"]:
        print(
            "\nFor the console, with the table and between begin and apply:\n  " + "\n  ".join(report["estimate_lines"])
        )


def print_choice(choice: Choice) -> None:
    print(f"  {choice.section}: {choice.reason}")
    if choice.second:
        print(
            f"    secondary: stage {choice.second}, {'most due to the keys' if choice.by_keys else 'steepest'} of the others a third as steep or more"
            + (f"; or stage {choice.near_feed}, which the feed reaches first." if choice.near_feed else ".")
        )


def print_estimation(e: dict[str, Any], shares: bool) -> None:
    print("\nEstimation")
    if not shares:
        print("  I do not know: what the components have to do with the gradient is needed for it.")
    else:
        told = ", ".join(f"{name} {100 * part:.1f} %" for name, part in sorted(e["parts"].items(), key=lambda p: -p[1]))
        print(f"  model {', '.join(e['modelled'])} (of all shares: {told})")
        by = {
            name: [int(s) for s, n in e["innovated"].items() if n == name]
            for name in dict.fromkeys(e["innovated"].values())
        }
        for name, stages in by.items():
            print(f"  sensors on stages {sensor_rules.runs(stages)}: innovate {name}, the largest share there")
        if not by:
            print("  I do not know a stage to measure: nowhere is it steep and free of what is not modelled.")
    regions = ", ".join(f"{a} to {b}" for a, b in e["averaged"])
    print(f"  one temperature may stand for stages {regions}" if regions else "  no stages have nearly one temperature")
