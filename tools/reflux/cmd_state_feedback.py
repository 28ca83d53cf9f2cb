"""tools/state-feedback: decoupling by state feedback from a plant's linearisation, as settings of the board's kind `state`."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import Any

import numpy as np

from reflux import board_settings, build, plant_file, simulator, state_decoupler, table
from reflux.errors import RunFailed, UserError
from reflux.paths import tool

LOOPS_MOST, INPUTS_MOST = 4, 8  # of the kind (firmware/kinds/state/state_feedback.h)
ROW_MOST, WEIGHT_MOST = 16000.0, 1e4
SEEN = 1e-9  # a feedthrough, or dead time, below this is none


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog=tool("state-feedback"),
        description="Designs u = F x + G w + Tf d, each output with its own setpoint and pole, from the linearisation of a plant, and prints the settings of the kind `state` "
        "(docs/methods/state-decoupling.md). It is designed for samples with inputs held, by the firmware's code in double.")
    p.add_argument("plant", help="a plant of host_sim/plants by name, or a file NAME.json")
    p.add_argument("--outputs", required=True, metavar="Y,Y", help="measurements, in the order of the loops")
    p.add_argument("--inputs", required=True, metavar="U,U", help="MV of each loop")
    p.add_argument("--poles", required=True, metavar="P,P", help="poles of each loop, 1/s, below 0; several with / between them where its index is above 0")
    p.add_argument("--period", type=float, required=True, metavar="S", help="interval of the loops")
    p.add_argument("--states", metavar="Z,Z", help="measurements or points that stand for the states (default: those of the plant with the largest part of F)")
    p.add_argument("--disturbances", metavar="D,D", default="", help="inputs of the plant that are measured")
    p.add_argument("--ti", type=float, default=0.0, metavar="S", help="integral time of all loops; 0: none (default)")
    p.add_argument("--left", type=float, default=0.01, help="part of F that the chosen states may leave out, relative to its largest element (default 0.01)")
    p.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="value of an input of the plant instead of its nominal one; repeatable")
    p.add_argument("--loop-names", metavar="NAME,...", help="names of the board's loops (default: names of the outputs)")
    p.add_argument("--block", type=int, default=1, metavar="N", help="number of the block (default 1)")
    board_settings.add_options(p)
    p.add_argument("--no-build", action="store_true", help="do not build; use what is there")
    return p


@dataclass(frozen=True)
class Plant:
    """x' = A x + B u + E d, y = C x; per second, in the units of the channels."""

    a: np.ndarray
    b: np.ndarray
    e: np.ndarray
    c: np.ndarray  # of the controlled outputs
    z: np.ndarray  # of the states that are measured


def main(arguments: list[str]) -> int:
    options = parser().parse_args(arguments)
    outputs, inputs = words(options.outputs), words(options.inputs)
    disturbances = words(options.disturbances) if options.disturbances else []
    check(options, outputs, inputs)
    if not options.no_build:
        build.build("host", ("reflux-sim", "libreflux"), quiet=True)
    data = simulator.linearised(options.plant, options.set)
    if data["period_s"]:
        raise UserError(f"{options.plant} is sampled already, every {data['period_s']:g} s; a continuous plant is needed")
    named_states = words(options.states) if options.states else outputs
    plant = picked(data, outputs, inputs, disturbances, named_states)
    found = design(plant, options, outputs)
    states = named_states if options.states else chosen_states(data, outputs, [*inputs, *disturbances], found.f, INPUTS_MOST - len(disturbances))
    if not options.states:
        plant = picked(data, outputs, inputs, disturbances, states)
    weights, left = by_measurements(found.f, plant.z)
    show(options, outputs, inputs, states, disturbances, found, left)
    if left > options.left:
        raise RunFailed(f"{', '.join(states)} stand for too little of F: {100 * left:.2g} % of its largest element is left, and --left allows {100 * options.left:g} %")
    spans = spans_of(options.plant)
    lines = board_lines(options, found, weights, outputs, inputs, [*states, *disturbances], spans)
    print("\n" + "\n".join(lines))
    board_settings.hand_over(options, lines)
    return 0


def words(text: str) -> list[str]:
    out = [w.strip() for w in text.split(",")]
    if not all(out) or len(set(out)) < len(out):
        raise UserError(f"{text}: names with commas between them, none twice")
    return out


def check(options: argparse.Namespace, outputs: list[str], inputs: list[str]) -> None:
    if len(outputs) != len(inputs):
        raise UserError(f"--outputs and --inputs: {len(outputs)} and {len(inputs)}; each loop has one of both")
    if len(outputs) > LOOPS_MOST:
        raise UserError(f"--outputs: {len(outputs)} loops; the kind takes {LOOPS_MOST}")
    if not 1e-3 <= options.period <= 1e5:
        raise UserError("--period must be 0.001 to 100000 s")
    if not 0 <= options.ti <= 1e6:
        raise UserError("--ti must be 0 to 1000000 s")
    if not 0 <= options.left <= 1:
        raise UserError("--left must be 0 to 1")
    board_settings.check_options(options)
    if not 1 <= options.block <= 99:
        raise UserError("--block must be 1 to 99")


def matrix(data: dict[str, Any], name: str, columns: int) -> np.ndarray:
    return np.array(data[name], float).reshape(-1, columns)


def place(names: list[str], name: str, what: str) -> int:
    if name not in names:
        raise UserError(f"{name} is not an {what} of the plant; there are {', '.join(names)}")
    return names.index(name)


def chosen_states(data: dict[str, Any], outputs: list[str], moved: list[str], f: np.ndarray, room: int) -> list[str]:
    """The controlled outputs, and one after the other of those that are states what leaves least of F."""
    names = data["outputs"]
    c, d, dead = matrix(data, "C", len(data["x"])), matrix(data, "D", len(data["inputs"])), matrix(data, "dead_s", len(data["inputs"]))
    columns = [data["inputs"].index(u) for u in moved]
    able = [i for i, y in enumerate(names) if np.any(c[i]) and max(np.abs(d[i, columns]).max(), np.abs(dead[i, columns]).max()) <= SEEN and y not in outputs]
    chosen = [names.index(y) for y in outputs]
    left = by_measurements(f, c[chosen])[1]
    while able and len(chosen) < room and left > 1e-6:
        least, best = min((by_measurements(f, c[[*chosen, i]])[1], i) for i in able)
        if least > 0.98 * left:
            break
        left = least
        chosen.append(best)
        able.remove(best)
    return [names[i] for i in chosen]


def picked(data: dict[str, Any], outputs: list[str], inputs: list[str], disturbances: list[str], states: list[str]) -> Plant:
    n, names = len(data["x"]), data["inputs"]
    a, b = matrix(data, "A", n), matrix(data, "B", len(names))
    c, d, dead = matrix(data, "C", n), matrix(data, "D", len(names)), matrix(data, "dead_s", len(names))
    moved = [place(names, u, "input") for u in inputs]
    known = [place(names, u, "input") for u in disturbances]
    rows = [place(data["outputs"], y, "output") for y in outputs]
    seen = [place(data["outputs"], z, "output") for z in states]
    for i in {*rows, *seen}:
        for j in moved:
            if abs(d[i, j]) > SEEN or abs(dead[i, j]) > SEEN:
                raise UserError(f"{data['outputs'][i]} by {names[j]} has a dead time or acts at once: it is not a state")
    return Plant(a, b[:, moved], b[:, known], c[rows], c[seen])


def design(plant: Plant, options: argparse.Namespace, outputs: list[str]) -> state_decoupler.Design:
    poles = []
    for text in options.poles.split(","):
        try:
            rates = [float(x) for x in text.split("/")]
        except ValueError:
            raise UserError(f"--poles {options.poles}: numbers with commas between them, in 1/s") from None
        if not all(-1e6 < x < 0 for x in rates):
            raise UserError(f"--poles {options.poles}: 1/s, below 0")
        poles.append([float(np.exp(x * options.period)) for x in rates])
    if len(poles) != len(outputs):
        raise UserError(f"--poles has {len(poles)}, and there are {len(outputs)} loops")
    a, b, e = state_decoupler.sample(plant.a, plant.b, plant.e, options.period)
    try:
        return state_decoupler.design(a, b, plant.c, e, poles, period=options.period, integral=options.ti,
                                      feedforward="outputs" if plant.e.shape[1] else "none")
    except state_decoupler.Refused as refused:
        raise RunFailed(f"no law: {refused}") from None


def by_measurements(f: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, float]:
    """F_z with F_z z = F as far as the measurements tell, least squares; and what is left of F, of its largest element."""
    scale = np.abs(z).max(axis=1, keepdims=True)
    weights = np.linalg.lstsq((z / scale).T, f.T, rcond=1e-9)[0].T / scale.T
    return weights, float(np.abs(f - weights @ z).max() / np.abs(f).max())


def spans_of(plant: str) -> dict[str, float]:
    j, _ = plant_file.load(plant)
    return {c["name"]: float(c["hi"]) - float(c["lo"]) for side in ("inputs", "disturbances", "outputs", "truths") for c in j.get(side, []) if "hi" in c and "lo" in c}


def board_lines(options: argparse.Namespace, found: state_decoupler.Design, weights: np.ndarray, outputs: list[str], inputs: list[str], fed: list[str],
                spans: dict[str, float]) -> list[str]:
    lost = [name for name in {*outputs, *inputs, *fed} if name not in spans]
    if lost:
        raise UserError(f"{options.plant} has no span of {', '.join(sorted(lost))}")
    if len(fed) > INPUTS_MOST:
        raise RunFailed(f"{len(fed)} states and disturbances, and the kind takes {INPUTS_MOST}: name fewer with --states")
    names = words(options.loop_names) if options.loop_names else outputs
    if len(names) != len(outputs):
        raise UserError(f"--loop-names {options.loop_names}: {len(outputs)} names")
    span_u = np.array([spans[u] for u in inputs])
    f = np.hstack([weights, found.tf]) * np.array([spans[z] for z in fed])[None, :] / span_u[:, None]
    g = found.g * np.array([spans[y] for y in outputs])[None, :] / span_u[:, None]
    if max(np.abs(f).max(), np.abs(g).max()) > WEIGHT_MOST or (np.abs(f).sum(axis=1) + np.abs(g).sum(axis=1)).max() > ROW_MOST:
        raise RunFailed(f"a weight is {max(np.abs(f).max(), np.abs(g).max()):.4g} span per span, and the kind takes {WEIGHT_MOST:g}, rows that add up to {ROW_MOST:g}")
    block = f"set block{options.block}"
    return [f"{block}.kind state", f"{block}.loops {','.join(names)}", f"{block}.inputs {','.join(fed)}",
            *(f"{block}.f.{i + 1} {row(x, INPUTS_MOST)}" for i, x in enumerate(f)), *(f"{block}.g.{i + 1} {row(x, LOOPS_MOST)}" for i, x in enumerate(g)),
            *([f"{block}.ti.1 {row(np.full(len(outputs), options.ti), LOOPS_MOST)}"] if options.ti else [])]


def row(x: np.ndarray, columns: int) -> str:
    return ",".join(f"{value + 0.0:.7g}" for value in [*x, *[0.0] * (columns - len(x))])


def show(options: argparse.Namespace, outputs: list[str], inputs: list[str], states: list[str], disturbances: list[str], found: state_decoupler.Design,
         left: float) -> None:
    print(f"{options.plant}, {len(outputs)} loops: {', '.join(f'{y} by {u}' for y, u in zip(outputs, inputs))}; every {options.period:g} s\n")
    print(table.columns(["loop", "index", "pole, 1/s", "K*"], [[y, str(found.index[i]), options.poles.split(",")[i], f"{found.k_star[i]:.4g}"] for i, y in enumerate(outputs)]))
    zeros = sorted(found.zeros, key=abs, reverse=True)
    print(f"\ncondition of B* {found.condition:.3g}; {len(found.needed)} states count; modes that no output shows: "
          f"{', '.join(f'{abs(z):.4g}' for z in zeros) if zeros else 'none'} (magnitude in z)")
    print(f"{', '.join(states)} leave {100 * left:.2g} % of the largest element of F" + (f"; feedforward of {', '.join(disturbances)}" if disturbances else ""))
