"""A campaign of automatic start-ups: linear plants, noise, drift and converter steps, many seeds."""

from __future__ import annotations

import csv
import hashlib
import itertools
import random
import re
import statistics
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reflux import build, table
from research import commissioning_columns, commissioning_stability, known_plants
from reflux.errors import UserError
from reflux.paths import shown
from reflux.schema import Table

UNITS = {"s": 1.0, "min": 60.0, "h": 3600.0}
HORIZON = 3000  # slowest time constants after which the drift turns no more
EVENTS_MOST = 1000
LONGEST_S = 300  # of one run, on the clock
PROPOSED = ("right", "other", "wrong")  # verdicts on pairs that were proposed
FEW_LEAST = 0.5  # determined: share asked of a few seeds, where one more or less counts for much


@dataclass(frozen=True)
class Known:
    """Prior knowledge of a plant, and the demands on its campaign."""

    name: str
    slowest_s: float
    determined: float  # of the seeds, at least


@dataclass(frozen=True)
class Start:
    name: str
    title: str
    firmware: str
    seeds: tuple[int, ...]
    plants: tuple[Known, ...]
    noise: float  # all in shares of a span
    drift: float  # ... per slowest time constant
    band: float
    bits: int
    limit: float
    rounds: int

    def jobs(self, fraction: float) -> list[dict[str, Any]]:
        count = max(1, round(len(self.seeds) * fraction))
        return [{"plant": plant.name, "seed": seed} for seed in self.seeds[:count] for plant in self.plants]


def load(top: Table, name: str) -> Start:
    first = top.integer("first_seed", 1)
    plants = []
    for t in top.tables("plants"):
        plants.append(Known(t.text("name"), t.number("slowest_s", low=1e-3), t.number("determined", 0.0, 0.0, 1.0)))
        t.done()
        if not known_plants.exists(plants[-1].name):
            raise UserError(f'{top.path("plants")}: there is no linear plant and no column "{plants[-1].name}"')
    start = Start(name, top.text("title", name), top.text("firmware", "memory", choices=("memory",)),
                  tuple(range(first, first + top.integer("seeds", low=1, high=100000))), tuple(plants),
                  top.number("noise", low=0, high=0.1), top.number("drift", low=0, high=0.1),
                  top.number("drift_band", low=0.01, high=0.5), top.integer("bits", 12, 4, 24),
                  top.number("limit", low=0.01, high=0.5), top.integer("rounds", 4, 1, 16))
    top.done()
    return start


def fingerprint(start: Start) -> str:
    digest = hashlib.sha256(repr((start.noise, start.drift, start.band, start.bits, start.limit, start.rounds,
                                  start.plants)).encode())
    digest.update(build.find_program("host", "reflux-sim-memory").read_bytes())
    return digest.hexdigest()


# ---- one run ----

def inputs_of(plant: dict[str, Any]) -> list[dict[str, Any]]:
    return [u for u in plant["inputs"] if u.get("kind", "mv") == "mv" and not u.get("disturbance")]


def script(plant: dict[str, Any], start: Start, changes: list[str]) -> str:
    """The console's side of a start-up: the channels, the operating point by hand, all defaults but the limits; and what
    is changed of the proposal before it is accepted."""
    lines = ["0 begin"]
    for i, o in enumerate(plant["outputs"], 1):
        lines += [f"0 set meas{i}.{key} {o[key]}" for key in ("name", "unit", "lo", "hi")]
        lines.append(f"0 set meas{i}.test_limit {start.limit * (o['hi'] - o['lo']):g}")
        if o.get("every_s"):  # an analyser: too slow to tell when a test is over
            samples = {key: round(o.get(f"{key}_s", 0) / plant["tick_s"]) for key in ("every", "delay")}
            lines += [f"0 set meas{i}.{key} {n}" for key, n in samples.items()] + [f"0 set meas{i}.test off"]
    for i, u in enumerate(inputs_of(plant), 1):
        lines += [f"0 set mv{i}.{key} {u[key]}" for key in ("name", "unit", "lo", "hi")]
        lines += [f"0 set mv{i}.min {u['lo']}", f"0 set mv{i}.max {u['hi']}",
                  f"0 set mv{i}.safe {u.get('safe', u['nominal'])}"]
    lines += [f"0 set test.rounds {start.rounds}", "0 apply"]
    lines += [f"{plant['tick_s']} out {u['name']} {u['nominal']}" for u in inputs_of(plant)]
    at = 5 * plant["tick_s"]
    lines += [f"{at} commission begin", f"{at} ~until PROPOSAL|NOT_DETERMINED|COMMISSION_ENDED"]
    lines += [f"{at} commission{what}" for what in ("", " model", " pairing")]
    lines += [f"{at} ?commission edit", f"{at} diff", *(f"{at} set {change}" for change in changes)]
    lines += [f"{at} ?commission accept", f"{at} ~until TRIAL_KEPT|TRIAL_FAILED 3000000", f"{at} ~end"]
    return "\n".join(lines) + "\n"


def events(plant: dict[str, Any], known: Known, start: Start, seed: int) -> list[str]:
    """Noise, converter steps, and a ramp on every measurement: sign by the seed, turned at the ends of its band. All
    turn together, since a test that meets a turn is spoilt by it whichever output turns."""
    chance = random.Random(f"{known.name} {seed}")
    turn = start.band / start.drift * known.slowest_s
    first = chance.uniform(0.8, 1.0) * turn
    out = []
    for o in plant["outputs"]:
        span, sign = o["hi"] - o["lo"], chance.choice((-1, 1))
        rate = start.drift * span / known.slowest_s * 3600.0
        out += [(0.0, f"{o['name']}.noise={start.noise * span}"),
                (0.0, f"{o['name']}.resolution={span / 2 ** start.bits}"), (0.0, f"{o['name']}.drift={sign * rate}")]
        for n in range(int(min(HORIZON * known.slowest_s / turn / 2, EVENTS_MOST / len(plant["outputs"]) - 3))):
            sign = -sign
            out.append((first + 2 * n * turn, f"{o['name']}.drift={sign * rate}"))
    return ["0:noise=1", *(f"{t:.3f}:{what}" for t, what in sorted(out, key=lambda e: e[0]))]


def run_one(start: Start, job: dict[str, Any]) -> dict[str, Any]:
    """In a process of its own. Whatever comes of it is a result."""
    return start_up(start, job, [])[0]


def start_up(start: Start, job: dict[str, Any], changes: list[str]) -> tuple[dict[str, Any], str]:
    """One start-up of job's plant and seed, `set CHANGE` before the proposal is accepted: the result, and what went over
    the console's line."""
    known = next(p for p in start.plants if p.name == job["plant"])
    plant = known_plants.read(known.name)
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        where = Path(folder)
        (where / "script").write_text(script(plant, start, changes), encoding="utf-8")
        command = [str(build.find_program("host", "reflux-sim-memory")), "--plant", known.name, "--port", "memory",
                   "--console", "memory", "--duration", "1e8", "--script", str(where / "script"), "--transcript",
                   str(where / "said"), "--log", str(where / "log"), "--seed", str(job["seed"]), "--noise", "1",
                   "--timeout", "60"]
        for event in events(plant, known, start, int(job["seed"])):
            command += ["--event", event]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S)
            said = (where / "said").read_text(encoding="utf-8", errors="replace")
        except (subprocess.TimeoutExpired, OSError) as error:
            return {"job": job, "verdict": "no end", "failures": [str(error)[:200]]}, ""
        return {"job": job, "failures": [], **read(said, plant, known, start, where / "log",
                                                   done.stderr.strip().splitlines()[-1:])}, said


def read(said: str, plant: dict[str, Any], known: Known, start: Start, log: Path, last: list[str]) -> dict[str, Any]:
    out: dict[str, Any] = {}
    asked = re.search(r"^([\d.]+) > commission$", said, re.M)
    tested_s = float(asked.group(1)) if asked else None
    ended = re.search(r"COMMISSION_ENDED (\S+) .*: (.*)$", said, re.M)
    pairs = sorted(re.findall(r"< pair (\S+) (\S+) lambda", said))
    if re.search(r"! .* PROPOSAL ", said):
        out["verdict"] = verdict_on([tuple(p) for p in pairs], known.name)
    elif ended:
        out["verdict"], out["why"] = "ended", ended.group(2)
    else:
        out["verdict"] = "open" if "NOT_DETERMINED" in said else "no end"
    failed = re.search(r"TRIAL_FAILED \S+ .*: (.*)$", said, re.M)
    out["trial"] = "kept" if "TRIAL_KEPT" in said else "back" if failed else "-"
    if failed:
        out["trial_why"] = failed.group(1)
    if out["verdict"] in PROPOSED:
        out["radius"] = commissioning_stability.radius(said, known.name)
    if out["verdict"] in PROPOSED and out["trial"] == "-":
        out["trial_why"] = last[0].replace(f"{log.parent}/", "")[-120:] if last else ""
    found = [int(n) for n in re.findall(r"< input .* rounds (\d+)", said)]
    out["rounds"] = max(found, default=0)
    out["time"] = tested_s / known.slowest_s if tested_s else None
    out["worst"] = worst_fraction(log, plant, start, tested_s)
    elements(said, plant, known, out)
    return out


def verdict_on(pairs: list[tuple[str, str]], name: str) -> str:
    """right: the committed pairing; other: one that would do as well, by the true gains; wrong: one whose loops run away."""
    if pairs == known_plants.pairing(name):
        return "right"
    gains = known_plants.gains(name)
    k = np.array([[gains[y, u] for _, u in pairs] for y, _ in pairs])
    own = np.prod(np.diag(k))
    return "other" if own and np.linalg.det(k) / own > 0 else "wrong"


def worst_fraction(log: Path, plant: dict[str, Any], start: Start, until_s: float | None) -> float:
    """Largest share of a limit, by the plant itself: no noise, no drift of the instrument. From the operating point."""
    worst = 0.0
    with log.open(encoding="utf-8") as lines:
        rows = csv.reader(line for line in lines if line[0] != "#")
        head = [re.sub(r"\[.*", "", cell) for cell in next(rows)]
        channels = [(head.index(f"{o['name']}.true"), o["nominal"], start.limit * (o["hi"] - o["lo"]))
                    for o in plant["outputs"] if not o.get("every_s")]
        for row in rows:
            if until_s is not None and float(row[1]) > until_s:
                break
            for column, rest, limit in channels:
                worst = max(worst, abs(float(row[column]) - rest) / limit)
    return worst


def elements(said: str, plant: dict[str, Any], known: Known, out: dict[str, Any]) -> None:
    """Errors of the first-order elements, and what the moments alone would have paired."""
    rows, columns = [o["name"] for o in plant["outputs"]], [u["name"] for u in inputs_of(plant)]
    moments = np.zeros((len(rows), len(columns)))
    seen = 0
    for y, u, gain in re.findall(r"< moments (\S+) (\S+) gain (\S+)", said):
        moments[rows.index(y), columns.index(u)] = float(gain)
        seen += 1
    if out["verdict"] != "ended" and seen == moments.size:
        pairs = pair(moments)
        out["moments"] = "none" if pairs is None else "right" if sorted(
            (rows[i], columns[j]) for i, j in pairs) == known_plants.pairing(known.name) else "wrong"
    errors: dict[str, list[float]] = {"gain": [], "lag": [], "dead": []}
    for y, u, gain, lag, dead in re.findall(
            r"< element (\S+) (\S+) gain (\S+) sd \S+ \S+ T (\S+) sd \S+ s L (\S+)", said):
        if out["verdict"] == "ended" or "elements" not in plant:
            break
        e = plant["elements"][rows.index(y)][columns.index(u)]
        if not e or not isinstance(e.get("lags"), (int, float)) or "lead" in e:
            continue
        unit = UNITS[plant.get("time_unit", "s")]
        true_lag, true_dead = e["lags"] * unit, e.get("dead_time", 0.0) * unit
        errors["gain"].append(abs(float(gain) / e["gain"] - 1.0))
        errors["lag"].append(abs(float(lag) - true_lag) / (true_lag + true_dead))
        errors["dead"].append(abs(float(dead) - true_dead) / (true_lag + true_dead))
    out["errors"] = errors


def pair(gains: np.ndarray) -> list[tuple[int, int]] | None:
    """As the committed pairings: outputs by the row sums of the RGA, then the least sum of |ln|, none negative."""
    def rga(k: np.ndarray) -> np.ndarray:
        return k * np.linalg.pinv(k).T
    try:
        p, m = gains.shape
        scale = np.abs(gains).max() or 1.0
        rows = sorted(np.argsort(-rga(gains / scale).sum(axis=1), kind="stable")[:m]) if p > m else list(range(p))
        lam = rga(gains[rows] / scale)
    except np.linalg.LinAlgError:
        return None
    best = None
    for columns in itertools.permutations(range(m), len(rows)):
        chosen = [lam[k, columns[k]] for k in range(len(rows))]
        if min(chosen) <= 0.02:
            continue
        cost = float(np.abs(np.log(chosen)).sum())
        if best is None or cost < best[0]:
            best = cost, [(int(rows[k]), int(columns[k])) for k in range(len(rows))]
    return best[1] if best else None


# ---- results ----

HEADER = ["plant", "seeds", "right", "other", "not determined", "wrong", "ended early", "rounds", "time", "time 95 %",
          "worst limit", "kept", "rolled back", "stable", "moments wrong"]
ERROR_HEADER = ["plant", "K", "K 95 %", "T", "T 95 %", "L", "L 95 %"]


def of_plant(plant: Known, results: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [r for r in results if r["job"]["plant"] == plant.name]


def high(values: list[float], share: float = 0.95) -> float:
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))]


def unstable(results: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [r for r in results if r.get("radius") is not None and not r["radius"] < 1.0]


def stable(results: list[dict[str, Any]]) -> str:
    """Results of the proposals that were accepted, whatever their trial said of them."""
    accepted = sum(r.get("radius") is not None for r in results)
    return f"{accepted - len(unstable(results))} of {accepted}"


def distribution(start: Start, results: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    rows = []
    for plant in start.plants:
        chosen = of_plant(plant, results)
        if not chosen:
            continue
        def count(key: str, value: str) -> str:
            return str(sum(r.get(key) == value for r in chosen))
        whole = [r for r in chosen if r["verdict"] in (*PROPOSED, "open")]
        times = [r["time"] for r in whole if r.get("time")]
        rows.append([plant.name, str(len(chosen)), *(count("verdict", v) for v in ("right", "other", "open", "wrong")),
                     str(sum(r["verdict"] in ("ended", "no end") for r in chosen)),
                     table.figure(statistics.fmean([r["rounds"] for r in whole]) if whole else None),
                     table.figure(statistics.fmean(times) if times else None),
                     table.figure(high(times) if times else None),
                     table.figure(max(r.get("worst", 0.0) for r in chosen)), count("trial", "kept"),
                     count("trial", "back"), stable(chosen),
                     f"{count('moments', 'wrong')} of {sum('moments' in r for r in chosen)}"])
    return HEADER, rows


def error_table(start: Start, results: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    rows = []
    for plant in start.plants:
        row = [plant.name]
        for key in ("gain", "lag", "dead"):
            values = [v for r in of_plant(plant, results) for v in r.get("errors", {}).get(key, [])]
            row += [table.figure(100 * v) for v in (statistics.median(values), high(values))] if values else ["-", "-"]
        rows.append(row)
    return ERROR_HEADER, rows


def reasons(start: Start, results: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """Why start-ups ended early and trials were rolled back, each with its count."""
    rows = []
    for plant in start.plants:
        found: dict[tuple[str, str], int] = {}
        for r in of_plant(plant, results):
            for what, why in (("ended early", r.get("why")), ("rolled back", r.get("trial_why")),
                              ("no end", (r["failures"] or [None])[0])):
                if why:
                    found[what, why] = found.get((what, why), 0) + 1
        rows += [[plant.name, what, why, str(n)] for (what, why), n in sorted(found.items())]
    return ["plant", "what", "why", "runs"], rows


def shortfalls(start: Start, results: list[dict[str, Any]]) -> list[str]:
    """Demands that are not reached: a wrong pairing, a limit passed, too few determined."""
    out = []
    for plant in start.plants:
        chosen = of_plant(plant, results)
        wrong = sum(r["verdict"] == "wrong" for r in chosen)
        right = sum(r["verdict"] in ("right", "other") for r in chosen)
        if wrong:
            out.append(f"{plant.name}: {wrong} of {len(chosen)} pairings are wrong")
        asked = plant.determined if len(chosen) == len(start.seeds) else min(plant.determined, FEW_LEAST)
        if chosen and right < asked * len(chosen):
            out.append(f"{plant.name}: {right} of {len(chosen)} determined rightly, {asked:.0%} asked for")
        for r in unstable(chosen):
            out.append(f"{plant.name}: seed {r['job']['seed']}: the accepted loops are unstable on the plant, trial "
                       f"{r['trial']}, largest eigenvalue {r['radius']:.6f}")
        endless = sum(r["verdict"] in PROPOSED and r["trial"] == "-" for r in chosen)
        if endless:
            out.append(f"{plant.name}: {endless} trials without an end")
        if chosen and max(r.get("worst", 0.0) for r in chosen) > 1.0:
            out.append(f"{plant.name}: the plant went past a limit")
    return out


def write_results(start: Start, results: list[dict[str, Any]], folder: Path) -> None:
    missed = shortfalls(start, results)
    text = f"""# {start.title}

Written by `tools/campaign {start.name}`: {len(start.seeds)} seeds of {len(start.plants)} plants, firmware
`{start.firmware}`, everything at its default but the limits ({100 * start.limit:g} % of span) and the rounds
({start.rounds}). Every measurement has noise of {100 * start.noise:g} % of its span (standard deviation), {start.bits}-bit
steps, and a ramp of {100 * start.drift:g} % of span per slowest time constant of its plant. A ramp without end would leave the
span long before a start-up is over: it turns where it has gone {100 * start.band:g} % of span from the middle, all outputs at
the same time, each with a sign of its own. The plants are those of `host_sim/plants`, the right pairings those of
the exact gains (`tests/reference/linear_pairing.csv` has those of the linear plants); *other* pairs would do as well, by the
Niederlinski index of the exact gains, *wrong* ones would not. Analysers are not tested.

Time is plant time of the tests in slowest time constants, for start-ups that came to a verdict; the worst limit is the
largest share of a limit that the plant itself (without noise and drift of the instruments) has reached during the
tests; *moments wrong* counts how often the moments of the last round alone, paired by the same rule, give another
pairing than the right one. Kept and rolled back: the trial of what was accepted; a plant whose proposal is rolled back
is in manual again, as it was before. *Stable* counts the accepted proposals, kept or not, whose sampled loops are stable
on the plant itself with its own orders and dead times: all eigenvalues of the closed loop are inside the unit circle.

{table.markdown(*distribution(start, results))}

Why start-ups ended early, and trials were rolled back:

{table.markdown(*reasons(start, results))}

Errors of the elements that are of first order in the plant, in per cent: median and 95 % over all elements and seeds; K
of the true gain, T and L of the true L + T.

{table.markdown(*error_table(start, results))}

"""
    text += ("## The two columns\n\n`tools/figures/column_table.py` starts up the pilot column and the splitter at an operating "
             f"point: [{commissioning_columns.RESULT.name}]({commissioning_columns.RESULT.name}).\n\n")
    text += "## What was asked for\n\n"
    if missed:
        text += "Not reached:\n\n" + "\n".join(f"- {m}" for m in missed) + "\n"
    else:
        text += "Everything asked for is reached.\n"
    (folder / f"{start.name}.md").write_text(text, encoding="utf-8")
    with (folder / f"{start.name}.csv").open("w", encoding="utf-8", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["plant", "seed", "verdict", "rounds", "time", "worst", "moments", "trial", "radius", "why"])
        for r in results:
            numbers = ["" if r.get(k) is None else f"{r[k]:.4g}" for k in ("rounds", "time", "worst")]
            radius = "" if r.get("radius") is None else f"{r['radius']:.6f}"
            writer.writerow([r["job"]["plant"], r["job"]["seed"], r["verdict"], *numbers, r.get("moments", ""),
                             r.get("trial", ""), radius,
                             r.get("why") or r.get("trial_why") or "; ".join(r["failures"])])
    print(f"results: {shown(folder / start.name)}.md and .csv")
