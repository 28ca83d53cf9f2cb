"""A week alone: settings that start-up has kept, beside a plain PI that an engineer designs for the same plant, both run by the real firmware.

Each of the two sets runs twice on the true plant, with its instruments, its noise and whatever changes in it: a week at rest, and a week in which
setpoints and loads step at random times. Seed, noise, steps and loads are the same for both sets. The plain PI is the decentralised one of
startup_engineer.py: one good test, shapes by the Bayesian criterion, PIs of a largest sensitivity of 2 on that model.
"""

from __future__ import annotations

import csv
import itertools
import json
import math
import random
import re
import statistics
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterable, Sequence

import numpy as np

from reflux import table
from research import startup_engineer, startup_judge, startup_plants, startup_runs
from research.startup_judge import PI

EVERY = 12  # kept run of a class
WEEK_S = 7 * 86400.0
BEGIN_S = 6 * 3600.0  # until the figures count
APART_S, APART_TIMES = 4 * 3600.0, 10.0  # least mean time between steps; and in slowest time constants
SETPOINT, LOAD = 0.05, 0.05  # of a span: largest steps
LIMIT = 0.2  # of a span: distance from the setpoint that counts as past the limit
ASKED = 1.3  # ratio that is looked at
LONGEST_S = 600.0  # of a run, on the clock
FIELDS = ("plant", "kind", "seed", "noise", "week", "settings", "engineer", "kept_ms", "iae_kept", "iae_pi", "moves_kept", "moves_pi", "beyond_kept",
          "beyond_pi", "late_kept", "late_pi", "manual_kept", "manual_pi", "swings_kept", "swings_pi", "clock_s", "error")
WEEKS = ("rest", "busy")
Row = dict[str, str]


@dataclass(frozen=True)
class Week:
    """iae: mean over the outputs, spans times s. moves: of all outputs together, spans. beyond: share of the time past the limit. late: ratio of the
    last day's error to the first's. manual: loops that did not stay in automatic. period_s: of a lasting oscillation, 0: none."""

    iae: float
    moves: float
    beyond: float
    late: float
    manual: int
    period_s: float


# ---- what happens in a week ----

def sample(rows: Iterable[Row], every: int = EVERY) -> list[Row]:
    """Every n-th kept run of each class, with settings that a plain set of loops describes."""
    chosen = []
    kept = sorted((r for r in rows if r["outcome"] == "kept" and r["settings"] and not r["extras"]), key=lambda r: r["kind"])
    for _, group in itertools.groupby(kept, key=lambda r: r["kind"]):
        chosen += list(group)[::every]
    return chosen


def with_loads(case: startup_plants.PlantCase) -> tuple[dict[str, Any], list[tuple[str, float, float]]]:
    """The simulator's file with a load beside every input, and the loads: name, value at rest, size of a whole step. A column has its feed."""
    data = json.loads(startup_plants.text(case))
    if data.get("model") == "transfer":
        data["disturbances"] = [{"name": f"load_{u['name']}", "unit": "%", "lo": -100, "hi": 100, "nominal": 0} for u in data["inputs"]]
        data["elements"] = [row + row for row in data["elements"]]
    elif data.get("model") == "state_space":
        data["disturbances"] = [{"name": f"load_{u['name']}", "unit": "%", "lo": -100, "hi": 100, "nominal": 0} for u in data["inputs"]]
        data["E"] = data["B"]
    else:
        return data, [(d["name"], d["nominal"], d["nominal"]) for d in data["disturbances"] if d["name"] in ("F", "zF")]
    return data, [(d["name"], 0.0, 100.0) for d in data["disturbances"]]


def busy(case: startup_plants.PlantCase, loads: list[tuple[str, float, float]], seed: int) -> tuple[list[tuple[float, str, float]], list[str]]:
    """Setpoints (time, output, value) and events of the loads, in turn, at random times."""
    chance = random.Random(f"week {case.name} {seed}")
    apart = max(APART_S, APART_TIMES * case.linear(seed).slowest_s())
    setpoints, events = [], []
    at = BEGIN_S + chance.expovariate(1.0 / apart)
    while at < WEEK_S:
        if chance.random() < 0.5 or not loads:
            y = chance.choice(case.data["outputs"])
            setpoints.append((at, y["name"], y["nominal"] + chance.uniform(-SETPOINT, SETPOINT) * (y["hi"] - y["lo"])))
        else:
            name, rest, whole = chance.choice(loads)
            events.append(f"{at:.3f}:{name}={rest + chance.uniform(-LOAD, LOAD) * whole:g}")
        at += chance.expovariate(1.0 / apart)
    return setpoints, events


# ---- a run ----

def script(case: startup_plants.PlantCase, loops: Sequence[PI], decoupler: np.ndarray | None, setpoints: Sequence[tuple[float, str, float]]) -> str:
    data, tick, lines = case.data, case.data["tick_s"], ["0 begin"]
    for kind, channels in (("meas", data["outputs"]), ("mv", data["inputs"])):
        for i, c in enumerate(channels, 1):
            lines += [f"0 set {kind}{i}.{key} {c[key]}" for key in ("name", "unit", "lo", "hi")]
            if kind == "mv":
                lines += [f"0 set mv{i}.min {c['lo']}", f"0 set mv{i}.max {c['hi']}", f"0 set mv{i}.safe {c['nominal']}"]
    for k, loop in enumerate(loops, 1):
        y, u = data["outputs"][loop.output]["name"], data["inputs"][loop.input]["name"]
        lines += [f"0 set loop{k}.{key} {value}" for key, value in (
            ("name", y), ("pv", y), ("out", u), ("gain", f"{abs(loop.kc):.7g}"), ("ti", f"{loop.ti_s:.7g}"), ("td", f"{loop.td_s:.7g}"),
            ("action", "reverse" if loop.kc > 0.0 else "direct"), ("decouple", "off" if decoupler is None else "on"))]
    if decoupler is not None:
        lines += [f"0 set decouple{i}.d{j} {d:.7g}" for i, row in enumerate(decoupler, 1) for j, d in enumerate(row, 1)]
    lines.append("0 apply")
    lines += [f"{tick:g} out {u['name']} {u['nominal']}" for u in data["inputs"]]
    lines += [f"{5 * tick:g} mode {data['outputs'][loop.output]['name']} auto" for loop in loops]
    lines += [f"{6 * tick:g} sp {y['name']} {y['nominal']}" for y in (data["outputs"][loop.output] for loop in loops)]
    names = {data["outputs"][loop.output]["name"] for loop in loops}
    lines += [f"{at:.3f} sp {name} {value:.6g}" for at, name, value in setpoints if name in names]
    return "\n".join(lines) + "\n"


def alone(case: startup_plants.PlantCase, noise: float, seed: int, loops: Sequence[PI], decoupler: np.ndarray | None, week: str,
          length_s: float = WEEK_S) -> Week:
    data, loads = with_loads(case)
    setpoints, events = busy(case, loads, seed) if week == "busy" else ([], [])
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        where = Path(folder)
        (where / "plant.json").write_text(json.dumps(data), encoding="utf-8")
        (where / "script").write_text(script(case, loops, decoupler, setpoints), encoding="utf-8")
        command = [str(startup_runs.program()), "--plant", str(where / "plant.json"), "--port", "memory",
                   "--console", "memory", "--duration", f"{length_s:g}", "--script", str(where / "script"), "--transcript", str(where / "said"),
                   "--log", str(where / "log"), "--seed", str(seed), "--noise", "1", "--timeout", f"{LONGEST_S:g}"]
        for event in [*case.all_events(noise, seed), *events]:
            if float(event.split(":")[0]) <= length_s:
                command += ["--event", event]
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S)
        if done.returncode:
            raise RuntimeError((done.stderr.strip().splitlines() or ["the simulator said nothing"])[-1])
        said = (where / "said").read_text(encoding="utf-8", errors="replace")
        return figures(where / "log", case, loops, setpoints, len(set(re.findall(r"! \S+ \w+ MODE (\S+) 0 ", said))))


# ---- figures ----

def figures(log: Path, case: startup_plants.PlantCase, loops: Sequence[PI], setpoints: Sequence[tuple[float, str, float]], manual: int) -> Week:
    """setpoints: time, output and value, in the order of time."""
    with log.open(encoding="utf-8") as lines:
        head = next(csv.reader(line for line in lines if line[0] != "#"))
    names = [re.sub(r"\[.*", "", cell) for cell in head]
    # A drift of an instrument cannot be told from the plant: the reading counts there.
    what = ".meas" if case.kind == "drift" else ".true"
    outputs = [case.data["outputs"][loop.output] for loop in loops]
    inputs = [case.data["inputs"][loop.input] for loop in loops]
    wanted = [names.index("time"), *(names.index(y["name"] + what) for y in outputs), *(names.index(f"{u['name']}.cmd") for u in inputs)]
    rows = np.loadtxt(log, delimiter=",", comments="#", skiprows=_skipped(log), usecols=wanted, ndmin=2)
    n, rows = len(loops), rows[rows[:, 0] >= BEGIN_S]
    spans = np.array([y["hi"] - y["lo"] for y in outputs], float)
    error = np.stack([asked(rows[:, 0], y, setpoints) for y in outputs], axis=1) / spans - rows[:, 1:1 + n] / spans
    u = rows[:, 1 + n:1 + 2 * n] / np.array([c["hi"] - c["lo"] for c in inputs], float)
    h = float(np.median(np.diff(rows[:, 0])))
    size, day = np.abs(error), max(1, int(86400.0 / h))
    return Week(float(size.sum() * h / n), float(np.abs(np.diff(u, axis=0)).sum()), float((size > LIMIT).any(axis=1).mean()),
                float(size[-day:].sum() / max(size[:day].sum(), 1e-12)), manual, lasting(error, h))


def asked(time_s: np.ndarray, y: dict[str, Any], setpoints: Sequence[tuple[float, str, float]]) -> np.ndarray:
    """The setpoint of an output at each time."""
    out = np.full(len(time_s), float(y["nominal"]))
    for at, name, value in setpoints:
        if name == y["name"]:
            out[np.searchsorted(time_s, at):] = value
    return out


def _skipped(log: Path) -> int:
    """Lines before the numbers, with the head."""
    with log.open(encoding="utf-8") as lines:
        return next(n for n, line in enumerate(lines) if line[0] != "#") + 1


def lasting(error: np.ndarray, h: float) -> float:
    """Period of an oscillation that takes more than half of the last two days' variance of a loop, in s; 0: there is none. Slower ones than the
    steps of a busy week are those steps."""
    worst, period = 0.5, 0.0
    tail = error[-max(64, int(2 * 86400.0 / h)):]
    for e in (tail - tail.mean(axis=0)).T:
        power = np.abs(np.fft.rfft(e * np.hanning(len(e))))**2
        if len(power) < 32 or power.sum() <= 0.0:
            continue
        first = max(4, math.ceil(len(e) * h / APART_S))
        top = first + int(np.argmax(power[first:]))
        near = power[max(top - 2, 0):top + 3].sum() / power.sum()
        if near > worst:
            worst, period = near, len(e) * h / top
    return period


# ---- a row ----

def loops_of(row: Row, case: startup_plants.PlantCase) -> tuple[list[PI], np.ndarray | None]:
    outputs, inputs = [y["name"] for y in case.data["outputs"]], [u["name"] for u in case.data["inputs"]]
    loops, decoupler = [], None
    for cell in row["settings"].split():
        if cell.startswith("decoupler:"):
            values = [float(d) for d in cell.split(":")[1:]]
            decoupler = np.array(values).reshape(math.isqrt(len(values)), -1)
            continue
        pair, kc, ti, td = cell.split(":")
        y, u = pair.split("/")
        loops.append(PI(outputs.index(y), inputs.index(u), float(kc), float(ti), float(td)))
    return loops, decoupler


def engineers(case: startup_plants.PlantCase, noise: float, seed: int) -> tuple[PI, ...]:
    return startup_engineer.engineer(case, noise, seed, startup_judge.Judge(case.linear(seed))).loops


def week_of(row: Row) -> list[Row]:
    """In a process of its own: a row for each week."""
    case, noise, seed = startup_plants.case(row["plant"]), float(row["noise"]), int(row["seed"])
    loops, decoupler = loops_of(row, case)
    plain, out = engineers(case, noise, seed), []
    for week in WEEKS:
        begun, made = time.monotonic(), {key: row[key] for key in ("plant", "kind", "seed", "noise", "settings")}
        made.update({key: "" for key in FIELDS if key not in made}, week=week, kept_ms=row["ms"],
                    engineer=" ".join(f"{c.output}/{c.input}:{c.kc:.5g}:{c.ti_s:.5g}" for c in plain))
        try:
            for name, controllers, d in (("kept", loops, decoupler), ("pi", plain, None)):
                if not controllers:
                    continue
                w = alone(case, noise, seed, controllers, d, week)
                made.update({f"iae_{name}": f"{w.iae:.5g}", f"moves_{name}": f"{w.moves:.5g}", f"beyond_{name}": f"{w.beyond:.4g}",
                             f"late_{name}": f"{w.late:.3g}", f"manual_{name}": str(w.manual), f"swings_{name}": f"{w.period_s:.4g}"})
        except (RuntimeError, ValueError, KeyError, subprocess.TimeoutExpired) as fault:
            made["error"] = repr(fault)[-120:]
        out.append({**made, "clock_s": f"{time.monotonic() - begun:.1f}"})
    return out


# ---- rows that are kept ----

def key(row: Row) -> tuple[str, str, str]:
    return row["plant"], row["seed"], row["noise"]


def add(path: Path, rows: list[Row]) -> None:
    begins = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as out:
        writer = csv.DictWriter(out, FIELDS, lineterminator="\n")
        if begins:
            writer.writeheader()
        writer.writerows(rows)


def whole(rows: Iterable[Row]) -> dict[tuple[str, str, str], list[Row]]:
    """Runs of which both weeks are there."""
    found: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        found.setdefault(key(row), []).append(row)
    return {of: some for of, some in found.items() if [row["week"] for row in some] == list(WEEKS)}


# ---- the tables ----

def ratio(row: Row, what: str) -> float:
    if not row[f"{what}_kept"] or not row[f"{what}_pi"] or float(row[f"{what}_pi"]) <= 0.0:
        return math.nan
    return float(row[f"{what}_kept"]) / float(row[f"{what}_pi"])


def _summary(rows: list[Row], what: str) -> list[str]:
    values = [v for v in (ratio(row, what) for row in rows) if not math.isnan(v)]
    if not values:
        return ["-", "-", "-"]
    return [f"{statistics.median(values):.2f}", f"{max(values):.2f}", f"{sum(v > ASKED for v in values)} of {len(values)}"]


def name(row: Row) -> str:
    return f"{row['plant']} seed {row['seed']} noise {row['noise']}"


def to_look_at(rows: Iterable[Row]) -> list[list[str]]:
    found = []
    for row in rows:
        words = []
        if ratio(row, "iae") > ASKED:
            words.append(f"error {ratio(row, 'iae'):.2f}")
        if row["beyond_kept"] and float(row["beyond_kept"]) > 0.0:
            words.append(f"beyond the limit {float(row['beyond_kept']):.2%}, PI {float(row['beyond_pi'] or 'nan'):.2%}")
        if row["manual_kept"] not in ("", "0"):
            words.append(f"{row['manual_kept']} loops in manual")
        if row["swings_kept"] not in ("", "0"):
            words.append(f"oscillates with {float(row['swings_kept']):.0f} s" + (", so does the PI" if row["swings_pi"] not in ("", "0") else ""))
        if row["late_kept"] and row["week"] == "rest" and float(row["late_kept"]) > 2.0:
            words.append(f"last day {float(row['late_kept']):.1f} times the first")
        if row["error"]:
            words.append(row["error"])
        if words:
            found.append([name(row), row["week"], row["kept_ms"], "; ".join(words)])
    return found


def text(rows: list[Row]) -> str:
    if not rows:
        return "# A week alone\n\nThere are no runs yet.\n"
    runs = {(r["plant"], r["seed"], r["noise"]) for r in rows}
    head = ["class", "runs", "week", "error: median", "worst", f"above {ASKED:g}", "moves: median", "worst ", f"above {ASKED:g} ", "beyond the limit, kept",
            "PI"]
    body = []
    for kind in ["all", *dict.fromkeys(r["kind"] for r in rows)]:
        for week in WEEKS:
            some = [r for r in rows if r["week"] == week and kind in ("all", r["kind"])]
            beyond = [max((float(r[key]) for r in some if r[key]), default=math.nan) for key in ("beyond_kept", "beyond_pi")]
            body.append([kind, str(len(some)), week, *_summary(some, "iae"), *_summary(some, "moves"), *(f"{100.0 * b:.2f} %" for b in beyond)])
    parts = ["# A week alone", f"Written by `tools/campaign startup --week`: {len(runs)} kept runs, every {EVERY}th of each class, by the real firmware on the "
             "true plant. Each figure is that of the kept settings over that of a plain PI: an engineer's, from one good test of the same plant, with a largest "
             "sensitivity of 2 on the model of that test. `rest`: nothing is asked for a week. `busy`: setpoints and loads step at random times, the same for both.",
             table.markdown(head, body)]
    bad = to_look_at(rows)
    if bad:
        parts += ["## Weeks to look at", table.markdown(["run", "week", "Ms", "what"], bad)]
    return "\n\n".join(parts) + "\n"
