"""Runs of the campaign `decoupling`: the whole firmware, inside the simulator, on a linear plant under one way of decoupling; and the experiment on the same plant that
the polynomial decoupler is designed from."""

from __future__ import annotations

import argparse
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reflux import arrays, board_model, cmd_identify, decoupled_loops, decoupling, ina_plant, runner, sampled_plant
from research import decoupling_plants, decoupling_tuning
from research.decoupling_plants import Bench
from research.decoupling_tuning import Pi
from reflux.errors import RunFailed, UserError
from reflux.libreflux import Refused
from reflux.logs import FIRMWARE_PREFIX, Log
from reflux.sampled_plant import SampledPlant
from reflux.scenario import Event, Line, Scenario

METHODS = ("none", "static", "partial", "one-way", "directions", "ina", "polynomial")
PLACED = "polynomial placed"  # poles placed, 10 % overshoot as the source has it; the settling time is ours
SETTLING_S = 3600.0
ZERO_MOST = 1e3  # zeros of det B outside the unit circle stay in the loops; here that is allowed, and told
SETTLED = 12  # times what the slowest element takes, between steps: slow loops have to end as well


@dataclass(frozen=True)
class Case:
    plant: str
    method: str
    noise: float = 0.0  # times the sensors' own
    error: str = ""  # of decoupling_plants.ERRORS
    clipped: bool = False  # the MV of the first loop has half the way it would go
    seed: int = 1


@dataclass(frozen=True)
class Design:
    lines: list[str]
    pis: list[Pi]  # also what takes over
    about: str


@dataclass(frozen=True)
class Measured:
    """In minutes of a whole setpoint step, mean over the loops that are stepped."""

    own: float
    cross: float
    rest: float  # largest distance of another loop from its setpoint at the end of a step, in steps


# ---- models ----


def square(bench: Bench) -> tuple[ina_plant.SquarePlant, np.ndarray, np.ndarray]:
    """The plant, frequencies, its response in fractions of span."""
    plant = ina_plant.read(str(bench.path()), bench.pairs)
    omega = decoupling_tuning.frequencies(bench.period_s, bench.settles * bench.period_s / 4)
    return plant, omega, plant.response(omega) * plant.spans()


def gains(bench: Bench) -> np.ndarray:
    plant, _, _ = square(bench)
    return (plant.response(np.array([1e-9])) * plant.spans())[0].real


def step_of(bench: Bench) -> float:
    return float(min(decoupling_plants.STEP, decoupling_plants.MOVE / np.abs(np.linalg.inv(gains(bench))).max()))


_models: dict[str, SampledPlant] = {}


def identified(bench: Bench) -> SampledPlant:
    """By the kind `experiment`: its settings where the model is small, else from the log of the same run by tools/identify."""
    if bench.name not in _models:
        _models[bench.name] = experiment(bench)
    return _models[bench.name]


def experiment(bench: Bench) -> SampledPlant:
    j, rows, columns = decoupling_plants.ordered(bench)
    ys, us = [j["outputs"][i] for i in rows], [j["inputs"][k] for k in columns]
    n, sequence = len(rows), (2 ** bench.bits - 1) * bench.clock
    lines = [*channel_lines(bench), "set block1.kind experiment", f"set block1.inputs {','.join(c['name'] for c in [*ys, *us])}", f"set block1.bits {bench.bits}",
             f"set block1.clock {bench.clock}", "set block1.periods 2", f"set block1.na {bench.na}", "set block1.adopt at_once"]
    for k, (y, u) in enumerate(zip(ys, us), 1):
        lines += [f"set block1.amplitude.{k} {bench.amplitude * (u['hi'] - u['lo']):g}", f"set block1.band.{k} {y['hi'] - y['lo']:g}"]
    begins = bench.settles * bench.period_s
    ends = begins + (2 * sequence + 50) * bench.period_s + max(200 * bench.period_s, 2000.0)  # so long it may look for the model
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        place = Path(folder)
        told = Scenario(file=place / "case.toml", name="case", title=bench.name, plant=str(bench.path()), duration_s=ends + 20 * bench.period_s,
                        tick_s=bench.period_s, seed=3, noise=1.0, firmware="memory",
                        lines=(*by_hand(bench), Line(begins, "block 1 start"), Line(ends, "block 1"), Line(ends, "list block1")), config=transaction(lines))
        log = runner.run(told, runner.Options(place / "out", quiet=True)).log
        if n == 2:
            return of_settings(bench, place / "out" / "transcript.txt")
        return from_log(bench, log, begins, 2 * sequence + 22)


def of_settings(bench: Bench, transcript: Path) -> SampledPlant:
    """In fractions of span."""
    j, rows, columns = decoupling_plants.ordered(bench)
    try:
        outputs, inputs, a, b, period, _ = board_model.read(transcript, bench.period_s)
    except UserError:
        verdict = re.findall(r" verdict = (\d+)", transcript.read_text(encoding="utf-8"))
        raise RunFailed(f"no model, verdict {verdict[-1] if verdict else '-'} of the experiment (docs/methods/experiment.md)") from None
    spans = [np.array([float(j[side][k]["hi"]) - float(j[side][k]["lo"]) for k in which]) for side, which in (("outputs", rows), ("inputs", columns))]
    return SampledPlant(bench.name, tuple(outputs), tuple(inputs), sampled_plant.shortened(a), sampled_plant.shortened(b), period, *spans).in_spans()


def from_log(bench: Bench, log: Log, begins: float, samples: int) -> SampledPlant:
    """Model that tools/identify finds from the same record, in fractions of span."""
    j, rows, columns = decoupling_plants.ordered(bench)
    at = int(round(begins / bench.period_s))
    y = np.array([scaled(log.numbers(f"{j['outputs'][i]['name']}.meas"), j["outputs"][i]) for i in rows]).T[at : at + samples]
    u = np.array([scaled(log.numbers(f"{j['inputs'][k]['name']}.cmd"), j["inputs"][k]) for k in columns]).T[at : at + samples]
    record = cmd_identify.Record(u - u[:20].mean(axis=0), y - y[:20].mean(axis=0))
    options = argparse.Namespace(method="iv", na=3, nb=6, orders=None, nc=None, criterion="bic", no_constant=False, integrates=[], outputs=[j["outputs"][i]["name"] for i in rows])
    a, b = [], []
    for i in range(len(rows)):
        try:
            model = cmd_identify.identify(record, i, record.samples * 2 // 3, options).model
        except Refused as refused:
            raise RunFailed(f"no model of {j['outputs'][rows[i]]['name']}: {refused}") from None
        a.append(model.a())
        b.append(model.b())
    length = max(len(x) for row in b for x in row)
    ones = np.ones(len(rows))
    return SampledPlant(bench.name, tuple(j["outputs"][i]["name"] for i in rows), tuple(j["inputs"][k]["name"] for k in columns),
                        sampled_plant.shortened(sampled_plant.padded(a)), sampled_plant.shortened(np.array([sampled_plant.padded(row, length) for row in b])),
                        bench.period_s, ones, ones)


def scaled(x: list[float], channel: dict[str, Any]) -> np.ndarray:
    return (np.array(x) - channel["lo"]) / (channel["hi"] - channel["lo"])


# ---- designs ----


def constant(method: str, k: np.ndarray, response: np.ndarray) -> tuple[np.ndarray, str]:
    """u = D v."""
    n = len(k)
    if method == "none":
        return np.eye(n), ""
    if method == "ina":
        g, found = arrays.search(response, np.eye(n), "rows", 8, 1)
        return g / np.diag(g)[None, :], f"largest ratio {found['after']:.2f} by rows"
    if method == "partial":
        return decoupling.partial(k, 0.5).d, "half of it"
    if method == "one-way":
        # The loop with the larger part of interaction in its row is the one that is freed.
        part = (np.abs(k).sum(axis=1) - np.abs(np.diag(k))) / np.abs(np.diag(k))
        order = np.argsort(-part)
        return decoupling.one_way(k, order).d, f"loop {order[0] + 1} first"
    if method == "directions":
        shape = decoupling.by_directions(k, 10.0)
        return shape.d, f"condition 10, {shape.limited} limited"
    return decoupling.partial(k, 1.0).d, ""


def design(bench: Bench, method: str) -> Design:
    _, omega, response = square(bench)
    k = gains(bench)
    numbers = list(range(1, len(k) + 1))
    if method.startswith("polynomial"):
        return polynomial(bench, omega, response, method.endswith("placed"))
    d, about = constant(method, k, response)
    pis = decoupling_tuning.tune_pis(response, d[None].astype(complex), omega, bench.period_s)
    lines = [] if method == "none" else decoupled_loops.static_lines(d, numbers)
    return Design([*loop_lines(bench, pis), *lines], pis, about)


def polynomial(bench: Bench, omega: np.ndarray, response: np.ndarray, placed: bool) -> Design:
    """PIs by the same rule behind it, or controllers by pole placement as the source has them."""
    model = identified(bench)
    found = decoupling.polynomial(model.a, model.b, model.period, zero_hi=ZERO_MOST)
    compensator = decoupled_loops.Compensator(found.g, found=found)
    names = [f"l{k + 1}" for k in range(model.n)]
    pis = decoupling_tuning.tune_pis(response, decoupling_tuning.of_z(found.g, omega, model.period), omega, bench.period_s)
    about = f"{found.g.shape[2]} coefficients, outermost zero {found.outermost:.2f}{'' if found.recursive else ', moves scaled'}"
    loops = decoupled_loops.place_all(model, compensator, 0.1, [SETTLING_S] * model.n, 0.0) if placed else []
    return Design([*loop_lines(bench, pis), *decoupled_loops.lines(model, compensator, loops, names, [], 1)], pis, about)


# ---- lines for the board ----


def transaction(lines: list[str]) -> tuple[Line, ...]:
    return tuple(Line(0.0, line) for line in ["begin", *lines, "apply"])


def channel_lines(bench: Bench) -> list[str]:
    j, rows, columns = decoupling_plants.ordered(bench)
    out = [f"set tick.base {bench.period_s:g}"]
    for k, i in enumerate(rows, 1):
        c = j["outputs"][i]
        out += [f"set meas{k}.name {c['name']}", f"set meas{k}.unit {c['unit']}", f"set meas{k}.lo {c['lo']:g}", f"set meas{k}.hi {c['hi']:g}"]
    for k, i in enumerate(columns, 1):
        c = j["inputs"][i]
        out += [f"set mv{k}.name {c['name']}", f"set mv{k}.unit {c['unit']}", f"set mv{k}.lo {c['lo']:g}", f"set mv{k}.hi {c['hi']:g}",
                f"set mv{k}.min {c['lo']:g}", f"set mv{k}.max {c['hi']:g}", f"set mv{k}.safe {c['nominal']:g}"]
    return out


def loop_lines(bench: Bench, pis: list[Pi]) -> list[str]:
    j, rows, columns = decoupling_plants.ordered(bench)
    out = []
    for k, (i, c, pi) in enumerate(zip(rows, columns, pis), 1):
        out += [f"set loop{k}.name l{k}", f"set loop{k}.pv {j['outputs'][i]['name']}", f"set loop{k}.out {j['inputs'][c]['name']}",
                f"set loop{k}.action {'reverse' if pi.gain > 0 else 'direct'}", f"set loop{k}.gain {abs(pi.gain):.6g}", f"set loop{k}.ti {pi.ti_s:.6g}"]
    return out


def by_hand(bench: Bench) -> tuple[Line, ...]:
    j, _, columns = decoupling_plants.ordered(bench)
    return tuple(Line(0.0, f"out {j['inputs'][k]['name']} {j['inputs'][k]['nominal']:g}") for k in columns)


# ---- a run ----


def scenario(case: Case, made: Design, folder: Path) -> tuple[Scenario, list[float], float]:
    """Also when each loop is stepped, and how long a step has."""
    bench = decoupling_plants.named(case.plant)
    j, rows, _ = decoupling_plants.ordered(bench)
    hold = SETTLED * bench.settles * bench.period_s
    begin = 10 * bench.period_s
    plant = str(bench.path())
    if case.error:
        plant = str(folder / "wrong.json")
        decoupling_plants.write_wrong(bench, case.error, folder / "wrong.json")
    lines = [*by_hand(bench)]
    at, times = begin + hold, []
    for k, i in enumerate(rows, 1):
        lines += [Line(begin, f"mode l{k} auto"), Line(begin, f"sp l{k} {j['outputs'][i]['nominal']:.7g}")]
    for k, i in enumerate(rows, 1):
        if case.clipped and k > 1:
            break
        c = j["outputs"][i]
        if case.clipped:
            lines += [Line(at, clip(bench, case)), Line(at, f"sp l{k} {c['nominal'] + step_of(bench) * (c['hi'] - c['lo']):.7g}")]
        else:
            lines.append(Line(at, f"sp l{k} {c['nominal'] + step_of(bench) * (c['hi'] - c['lo']):.7g}"))
        times.append(at)
        at += hold
    events = tuple(Event(0.0, f"{c['name']}.resolution", 0.0) for c in j["outputs"]) if not case.noise else ()
    config = transaction([*channel_lines(bench), *made.lines])
    return Scenario(file=folder / "case.toml", name="case", title=case.method, plant=plant, duration_s=at, tick_s=bench.period_s, seed=case.seed,
                    noise=case.noise, firmware="memory", lines=tuple(lines), events=events, config=config), times, hold


def clip(bench: Bench, case: Case) -> str:
    """Half the way that the first MV has to go for a step of its loop."""
    j, _, columns = decoupling_plants.ordered(bench)
    c = j["inputs"][columns[0]]
    way = np.linalg.solve(gains(bench), step_of(bench) * np.eye(len(columns))[:, 0])[0] * (c["hi"] - c["lo"])
    side, value = ("max", c["nominal"] + way / 2) if way > 0 else ("min", c["nominal"] + way / 2)
    return f"set mv1.{side} {value:.6g}"


def measure(case: Case, made: Design) -> Measured:
    bench = decoupling_plants.named(case.plant)
    j, rows, _ = decoupling_plants.ordered(bench)
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        told, times, hold = scenario(case, made, Path(folder))
        log = runner.run(told, runner.Options(Path(folder) / "out", quiet=True)).log
    t = np.array(log.numbers("time"))
    own, cross, rest = [], [], []
    for k, at in enumerate(times):
        inside = (t > at) & (t < at + hold)
        away = []
        for m, i in enumerate(rows, 1):
            c = j["outputs"][i]
            setpoint = np.array(log.numbers(f"{FIRMWARE_PREFIX}l{m}.sp"))[inside]
            off = np.abs(np.array(log.numbers(f"{c['name']}.true"))[inside] - setpoint) / (step_of(bench) * (c["hi"] - c["lo"]))
            away.append(off)
        minutes = [float(x.sum()) * bench.period_s / 60 for x in away]
        own.append(minutes[k])
        cross.append(sum(minutes) - minutes[k])
        rest.append(max((float(x[-len(x) // 10 :].mean()) for m, x in enumerate(away) if m != k), default=0.0))
    return Measured(float(np.mean(own)), float(np.mean(cross)), max(rest))
