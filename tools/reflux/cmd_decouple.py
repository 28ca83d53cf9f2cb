"""tools/decouple: a decoupler of a sampled model and a controller for each of its loops, designed by the firmware's code, as settings of the
board."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from reflux import board_settings, build, decoupled_loops, decoupler_remedies, decoupling, libreflux, sampled_plant, table
from reflux.decoupled_loops import Compensator, Moves
from reflux.errors import RunFailed, UserError
from reflux.paths import tool
from reflux.sampled_plant import SampledPlant

METHODS = ("polynomial", "static", "partial", "one-way", "directions")
BLOCKS_MOST, LOOPS_MOST, DIVISOR_MOST = 99, 8, 10000


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog=tool("decouple"),
        description="Designs a decoupler, and with --loops pp a controller for each loop, from a model in discrete time, and prints the settings of the board "
        "(docs/methods/polynomial-decoupler.md).")
    p.add_argument("model", help="output of tools/identify --format json (NAME.json), a board's listing of an experiment (NAME.txt), or a "
                   "linear plant of host_sim/plants by name or file")
    p.add_argument("--method", choices=METHODS, default="polynomial", help="polynomial (default): removes all of the interaction; static: K^-1; partial, one-way "
                   "and directions: less of it")
    p.add_argument("--factor", metavar="F[,F...]", help="with partial: part of the decoupler, 0 to 1; one number, or one for every element, row by row")
    p.add_argument("--rank", metavar="Y,Y", help="with one-way: outputs, first the one that no other loop disturbs")
    p.add_argument("--condition", type=float, metavar="X", help="with directions: largest input of a weak direction, as a multiple of the strongest one's")
    p.add_argument("--loops", choices=("none", "pp"), default="none", help="pp: a controller for each loop by pole placement (kind rst)")
    p.add_argument("--overshoot", type=float, default=0.1, help="overshoot after a setpoint step, 0 to 0.5 (default 0.1)")
    p.add_argument("--settling", metavar="S[,S...]", help="settling time after a setpoint step, s; one for all loops or one for each")
    p.add_argument("--observer", type=float, default=0.0, help="pole that filters measurements, 0 to 0.95 (default 0)")
    p.add_argument("--condition-hi", type=float, metavar="X", help="largest condition number of a controller's equations, 10 to 1e6 (default 1e4)")
    p.add_argument("--period", type=float, metavar="S", help="sampling period for a continuous plant")
    p.add_argument("--pairs", metavar="Y=U,...", help="pairs of output and input, in the order of the loops (default: the order of the model)")
    p.add_argument("--spans", metavar="NAME=SPAN,...|PLANT", help="spans of all channels where the model has none, or a plant that has them")
    p.add_argument("--units", choices=("spans", "eu"), default="spans", help="units of the output: fractions of span as on the board, or engineering units. The lines "
                   "for the board are always in spans")
    p.add_argument("--zero-hi", type=float, metavar="X", help="largest allowed zero of det B (default 1)")
    p.add_argument("--determinant-lo", type=float, metavar="X", help="smallest det B at rest, as a part of its terms (default 0.02)")
    p.add_argument("--element-hi", type=float, metavar="X", help="largest element of G (default 100)")
    p.add_argument("--first-block", type=int, default=1, metavar="N", help="number of the first block (default 1)")
    p.add_argument("--loop-names", metavar="NAME,...", help="names of the board's loops, for blocks (default: names of the outputs)")
    p.add_argument("--loop-numbers", metavar="N,...", help="numbers of the board's loops, for static decouplers and --tick (default 1, 2, ..)")
    p.add_argument("--tick", type=float, metavar="S", help="with --loops pp: base tick of the board, from which the divisors of the loops follow")
    board_settings.add_options(p)
    p.add_argument("--format", choices=("text", "json"), default="text")
    p.add_argument("--no-build", action="store_true", help="do not build; use what is there")
    return p


@dataclass
class Design:
    """plant as in the file, spanned in fractions of span (or as in the file, where there are no spans)."""

    plant: SampledPlant
    spanned: SampledPlant
    compensator: Compensator
    lam: np.ndarray
    placed: list[decoupling.Placed]
    moves: list[Moves]
    radius: float | None
    lines: list[str]


def main(arguments: list[str]) -> int:
    options = parser().parse_args(arguments)
    check(options)
    if not options.no_build:
        build.build("host", ("libreflux",), quiet=True)
    plant = sampled_plant.read(options.model, options.pairs, options.period)
    if options.spans:
        plant = sampled_plant.with_spans(plant, options.spans)
    need_spans(plant, options)
    design = make(plant, options)
    if options.format == "json":
        print(json.dumps(as_dict(design, options), indent=1))
    else:
        show(design, options)
    board_settings.hand_over(options, design.lines, print if options.format == "text" else lambda _: None)
    return 0


def check(options: argparse.Namespace) -> None:
    """Refuses options of another method instead of passing over them."""
    for name, method in (("factor", "partial"), ("rank", "one-way"), ("condition", "directions")):
        given = getattr(options, name) is not None
        if given and options.method != method:
            raise UserError(f"--{name} goes with --method {method}")
        if not given and options.method == method:
            raise UserError(f"--method {method} needs --{name}")
    for name in ("zero_hi", "determinant_lo", "element_hi"):
        if getattr(options, name) is not None and options.method != "polynomial":
            raise UserError(f"--{name.replace('_', '-')} goes with --method polynomial")
    if options.loops == "pp" and options.settling is None:
        raise UserError("--loops pp needs --settling S")
    if options.loops != "pp" and options.settling is not None:
        raise UserError("--settling goes with --loops pp")
    if options.loops != "pp" and options.condition_hi is not None:
        raise UserError("--condition-hi goes with --loops pp")
    if options.tick is not None and (options.loops != "pp" or not 0.05 <= options.tick <= 3600):
        raise UserError("--tick must be 0.05 to 3600 s, and goes with --loops pp")
    if not 1 <= options.first_block <= BLOCKS_MOST:
        raise UserError(f"--first-block must be 1 to {BLOCKS_MOST}")
    board_settings.check_options(options)


def need_spans(plant: SampledPlant, options: argparse.Namespace) -> None:
    if plant.output_spans is not None:
        return
    if options.units == "spans" or options.out or options.to or options.method == "directions":
        raise UserError(f"{plant.name} says no spans of {', '.join((*plant.outputs, *plant.inputs))}: --spans NAME=SPAN,... or --spans PLANT; --units eu without them "
                        "prints a design without lines for the board")


def words(text: str | None, default: list[str], n: int, option: str) -> list[str]:
    found = default if text is None else [w.strip() for w in text.split(",")]
    if len(found) != n or len(set(found)) < n or not all(w and not set(w) & set(' \t#') for w in found):
        raise UserError(f"{option} {','.join(found)}: {n} different ones without blanks in them")
    return found


def numbers_of(text: str, option: str) -> list[float]:
    try:
        found = [float(x) for x in text.split(",")]
    except ValueError:
        found = []
    if not found or not np.isfinite(found).all():
        raise UserError(f"{option} {text}: must be a number, or numbers with commas between them")
    return found


# ---- the design ----


def make(plant: SampledPlant, options: argparse.Namespace) -> Design:
    spanned, n = plant.in_spans(), plant.n
    names = words(options.loop_names, list(plant.outputs), n, "--loop-names")
    numbers = words(options.loop_numbers, [str(k + 1) for k in range(n)], n, "--loop-numbers")
    if not all(x.isdecimal() and 1 <= int(x) <= LOOPS_MOST for x in numbers):
        raise UserError(f"--loop-numbers {options.loop_numbers}: {n} different numbers, 1 to {LOOPS_MOST}")
    settling = numbers_of(options.settling, "--settling") if options.settling else []
    if len(settling) not in (0, 1, n):
        raise UserError(f"--settling {options.settling}: one for all loops or {n}")
    settling = settling * n if len(settling) == 1 else settling
    goal = decoupler_remedies.Goal(options.overshoot, settling, options.observer, options.condition_hi) if options.loops == "pp" else None
    compensator = decoupler(spanned, options, goal)
    try:
        lam = libreflux.rga(libreflux.Plant(spanned.gains()))
    except libreflux.Refused:
        lam = np.full((n, n), np.nan)
    placed, moves, radius = [], [], None
    if goal:
        placed, radius = controllers(spanned, compensator, goal, options.method)
        moves = [decoupled_loops.step_of(spanned, compensator, placed, k, settling[k]) for k in range(n)]
    lines = []
    if plant.output_spans is not None:
        lines = decoupled_loops.lines(spanned, compensator, placed, names, [int(x) for x in numbers], options.first_block, divisor_of(plant, options.tick))
    return Design(plant, spanned, compensator, lam, placed, moves, radius, lines)


def controllers(spanned: SampledPlant, compensator: Compensator, goal: decoupler_remedies.Goal, method: str) -> tuple[list[decoupling.Placed], float]:
    """With the largest pole of all loops together."""
    try:
        placed = decoupled_loops.place_all(spanned, compensator, *goal)
    except RunFailed as refused:
        raise RunFailed(f"{refused}{decoupler_remedies.for_loops(spanned, goal) if 'zero' in str(refused) else ''}") from None
    radius = decoupled_loops.closed_radius(spanned, compensator, placed)
    if not radius < 1:
        raise RunFailed(f"with all loops closed the model has a pole at {radius:.4g}: the interaction that {method} leaves is too much for controllers designed "
                        f"one by one{decoupler_remedies.for_loops(spanned, goal)}")
    return placed, radius


def divisor_of(plant: SampledPlant, tick: float | None) -> int | None:
    if tick is None:
        return None
    found = round(plant.period / tick)
    if not 1 <= found <= DIVISOR_MOST or abs(found * tick - plant.period) > 1e-3 * tick:
        raise UserError(f"--tick {tick:g}: the period of {plant.period:g} s has to be 1 to {DIVISOR_MOST} whole ticks")
    return found


def decoupler(spanned: SampledPlant, options: argparse.Namespace, goal: decoupler_remedies.Goal | None = None) -> Compensator:
    if options.method == "polynomial":
        given = {k: getattr(options, k) for k in ("zero_hi", "determinant_lo", "element_hi") if getattr(options, k) is not None}
        try:
            found = decoupling.polynomial(spanned.a, spanned.b, spanned.period, **given)
        except decoupling.DecouplerRefused as refused:
            zeros = f"; zeros of det B {', '.join(zero_text(z) for z in refused.zeros)}" if len(refused.zeros) else ""
            advice = f"; the filter before the samples ({spanned.filtered}) brings zeros: identify again with 0" if spanned.filtered else ""
            remedies = decoupler_remedies.found(spanned, given, options, str(refused), goal)
            raise RunFailed(f"no polynomial decoupler of {spanned.name}: {refused}{zeros}{advice}{remedies}") from None
        return Compensator(found.g, found=found)
    try:
        shape = static(spanned, options)
    except libreflux.Refused as refused:
        raise RunFailed(f"no {options.method} decoupler of {spanned.name}: {refused}") from None
    return Compensator(shape.d[:, :, None], shape=shape)


def static(spanned: SampledPlant, options: argparse.Namespace) -> decoupling.Shape:
    k, n = spanned.gains(), spanned.n
    if options.method == "one-way":
        asked = [w.strip() for w in options.rank.split(",")]
        if sorted(asked) != sorted(spanned.outputs):
            raise UserError(f"--rank {options.rank}: each of {', '.join(spanned.outputs)} once")
        return decoupling.one_way(k, [spanned.outputs.index(y) for y in asked])
    if options.method == "directions":
        if np.any(spanned.integrates()):
            raise UserError(f"--method directions compares gains at rest, and {spanned.outputs[int(np.argmax(spanned.integrates()))]} integrates")
        if not 1 <= options.condition <= 1e4:
            raise UserError("--condition must be 1 to 1e4")
        return decoupling.by_directions(k, options.condition)
    factors = np.ones((n, n))
    if options.method == "partial":
        given = numbers_of(options.factor, "--factor")
        if len(given) not in (1, n * n) or not all(0 <= x <= 1 for x in given):
            raise UserError(f"--factor {options.factor}: one number or {n * n}, 0 to 1")
        factors = np.full((n, n), given[0]) if len(given) == 1 else np.reshape(given, (n, n))
    else:
        # Its bounds: relative gains to 10, elements to 100.
        libreflux.decoupler(libreflux.Plant(k), [(i, i) for i in range(n)])
    return decoupling.partial(k, factors)


# ---- shown ----


def scales(design: Design, options: argparse.Namespace) -> tuple[np.ndarray, np.ndarray]:
    """Factors that turn outputs and inputs in spans into what is printed."""
    plant = design.plant
    if options.units == "eu" and plant.output_spans is not None and plant.input_spans is not None:
        return plant.output_spans, plant.input_spans
    return np.ones(plant.n), np.ones(plant.n)


def zero_text(z: complex) -> str:
    return f"{z.real:.5g}" if abs(z.imag) <= 1e-9 * max(1.0, abs(z)) else f"{z.real:.5g}{z.imag:+.5g}i"


def show(design: Design, options: argparse.Namespace) -> None:
    plant, spanned, compensator = design.plant, design.spanned, design.compensator
    y, u = scales(design, options)
    print(f"{plant.name}, {plant.n} loops: {', '.join(f'{a} by {b}' for a, b in zip(plant.outputs, plant.inputs))}; every {plant.period:g} s, in "
          f"{'fractions of span' if options.units == 'spans' else 'engineering units'}\n")
    gains = spanned.gains() * y[:, None] / u[None, :]
    integrates = spanned.integrates()
    print("gains at rest (of what integrates: of a sample)" if integrates.any() else "gains at rest")
    print(table.columns(["", *plant.inputs], [[name, *(f"{x:.5g}" for x in row)] for name, row in zip(plant.outputs, gains)]))
    print("\nrelative gains")
    print(table.columns(["", *plant.inputs], [[name, *(f"{x:.4g}" for x in row)] for name, row in zip(plant.outputs, design.lam)]))
    print()
    if compensator.found:
        show_polynomial(compensator.found)
    elif compensator.shape:
        show_static(design, compensator.shape, options, y, u)
    if design.placed:
        show_loops(design, y, u)
    if design.lines:
        print("\n".join(design.lines))
    else:
        print("# no lines for the board without spans")


def show_polynomial(found: decoupling.Decoupled) -> None:
    if len(found.zeros):
        print(f"zeros of det B, delay {found.delay}")
        print(table.columns(["zero", "magnitude", "within"], [[zero_text(z), f"{abs(z):.5g}", f"{r:.1e}"] for z, r in zip(found.zeros, found.radii)]))
    else:
        print(f"det B has no zeros but its delay of {found.delay}")
    print(f"{found.g.shape[2]} coefficients; the past of limited MVs {'is taken into G (recurse)' if found.recursive else 'cannot be run backwards: moves are scaled'}\n")


def show_static(design: Design, shape: decoupling.Shape, options: argparse.Namespace, y: np.ndarray, u: np.ndarray) -> None:
    plant = design.plant
    d = shape.d * u[:, None] / u[None, :]
    rows = [[plant.inputs[k], *(f"{x:.5g}" for x in d[k]), f"{shape.gain[k] * y[k] / u[k]:.5g}", f"{shape.left[k]:.3g}"] for k in range(plant.n)]
    print(f"static decoupler, {options.method}" + (f"; directions limited: {shape.limited}" if options.method == "directions" else ""))
    print(table.columns(["", *(f"d.{k + 1}" for k in range(plant.n)), "loop's gain", "interaction left"], rows))
    print()


def show_loops(design: Design, y: np.ndarray, u: np.ndarray) -> None:
    plant = design.plant
    rows = []
    for k, (c, m) in enumerate(zip(design.placed, design.moves)):
        rows.append([plant.outputs[k], f"{100 * c.overshoot:.3f}", f"{100 * m.overshoot:.3f}", f"{c.input_peak * u[k] / y[k]:.4g}",
                     *(f"{x:.4g}" for x in m.inputs * u / y[k]), f"{(m.others * y / y[k]).max():.2g}", f"{c.sensitivity:.3f}", f"{c.condition:.3g}"])
    print("steps of a setpoint by 1 on the model, without limits")
    print(table.columns(["loop", "overshoot, %", "with all loops", "asked for, to", *(f"{name} to" for name in plant.inputs), "others to", "sensitivity",
                         "condition"], rows))
    for k, name in enumerate(plant.outputs):
        if hidden := decoupled_loops.loop_of(design.spanned, design.compensator, k)[2]:
            print(f"{name}: poles that the loop does not move: {', '.join(zero_text(p) for p in hidden)}")
    print(f"largest pole with all loops closed: {design.radius:.4f}\n")


def as_dict(design: Design, options: argparse.Namespace) -> dict[str, Any]:
    plant, compensator = design.plant, design.compensator
    y, u = scales(design, options)
    out: dict[str, Any] = {
        "name": plant.name, "period_s": plant.period, "units": options.units, "method": options.method, "outputs": plant.outputs, "inputs": plant.inputs,
        "gains": (design.spanned.gains() * y[:, None] / u[None, :]).tolist(), "integrates": design.spanned.integrates().tolist(),
        "relative_gains": [[x if np.isfinite(x) else None for x in row] for row in design.lam.tolist()],
        "g": (compensator.g * (u[:, None] / u[None, :])[:, :, None]).tolist()}
    if compensator.found:
        found = compensator.found
        out |= {"h": [(h * y[k] / u[k]).tolist() for k, h in enumerate(found.h)], "zeros": [[z.real, z.imag] for z in found.zeros.tolist()],
                "radii": found.radii.tolist(), "outermost": found.outermost, "recursive": found.recursive, "delay": found.delay}
    if compensator.shape:
        out |= {"gain": (compensator.shape.gain * y / u).tolist(), "left": compensator.shape.left.tolist(), "limited": compensator.shape.limited}
    if design.placed:
        out["largest_pole"] = design.radius
        out["loops"] = [{**{k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in asdict(c).items()}, "q": (c.q * u[k] / y[k]).tolist(),
                         "r": (c.r * u[k] / y[k]).tolist(), "input_peak": c.input_peak * u[k] / y[k], "with_all_loops": m.overshoot,
                         "inputs_to": (m.inputs * u / y[k]).tolist(), "others_to": (m.others * y / y[k]).tolist()}
                        for k, (c, m) in enumerate(zip(design.placed, design.moves))]
    return {**out, "lines": design.lines}
