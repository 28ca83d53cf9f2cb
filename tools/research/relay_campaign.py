"""A campaign of ways to tune all loops of a plant: automatic start-up, against relay tests of one loop after the other."""

from __future__ import annotations

import argparse
import csv
import hashlib
import re
import statistics
import subprocess
import tempfile
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reflux import build, table
from research import commissioning, known_plants
from reflux.errors import UserError
from reflux.paths import shown
from reflux.schema import Table

METHODS = {"start-up": "automatic start-up", "alone": "relay, the others in manual",
           "sequential": "relay, those before in automatic", "tried": "the same, every loop on trial first"}
QUIET, NOISY, DRIFT = "quiet", "noise", "drift"
SETTLED = 0.2  # of the step: largest error of any loop in the last quarter of a window


@dataclass(frozen=True)
class Comparison:
    name: str
    title: str
    start: commissioning.Start  # plants, seeds, noise, limits
    step: float  # share of span, of the setpoints once all loops are closed
    window: float  # slowest time constants, after each of them

    def jobs(self, fraction: float) -> list[dict[str, Any]]:
        count = max(1, round(len(self.start.seeds) * fraction))
        return [{"plant": p.name, "method": m, "noise": noise, "seed": seed} for p in self.start.plants
                for m in METHODS for noise, seeds in ((QUIET, self.start.seeds[:1]), (NOISY, self.start.seeds[:count]),
                                     (DRIFT, self.start.seeds[:count]))
                for seed in seeds]


def load(top: Table, name: str) -> Comparison:
    step, window = top.number("step", low=1e-3, high=0.1), top.number("window", low=1.0, high=100.0)
    return Comparison(name, top.text("title", name), commissioning.load(top, name), step, window)


def fingerprint(campaign: Comparison) -> str:
    digest = hashlib.sha256(repr((campaign.step, campaign.window)).encode())
    digest.update(Path(__file__).read_bytes())
    return commissioning.fingerprint(campaign.start) + digest.hexdigest()


# ---- one run ----

def action(name: str, y: str, u: str) -> str:
    return "direct" if known_plants.gains(name)[y, u] < 0 else "reverse"


def at_rest(plant: dict[str, Any]) -> list[str]:
    """The plant is at its operating point when the firmware starts: no way of tuning is to wait for it."""
    return [f"0 set mv{i}.safe {u['nominal']}" for i, u in enumerate(commissioning.inputs_of(plant), 1)]


def tuning_script(plant: dict[str, Any], start: commissioning.Start, known: commissioning.Known, method: str) -> str:
    """The channels and the operating point as in the start-ups' campaign; for relays the loops of the right pairing."""
    whole = commissioning.script(plant, start, []).splitlines()
    at, patience_s = 5 * plant["tick_s"], 300 * known.slowest_s
    until_set = [line for line in whole if line.startswith("0 ") and not line.endswith(" apply")]
    until_set += at_rest(plant)
    outs = [line for line in whole if " out " in line]
    if method == "start-up":
        lines = [*until_set, "0 apply", *outs, f"{at} commission begin",
                 f"{at} ~until PROPOSAL|NOT_DETERMINED|COMMISSION_ENDED", f"{at} ?commission edit", f"{at} ?apply",
                 f"{at} dump", f"{at} ?commission accept", f"{at} ~until TRIAL_KEPT|TRIAL_FAILED {patience_s:g}"]
        return "\n".join([*lines, f"{at} ~end"]) + "\n"
    pairs = known_plants.pairing(known.name)
    loops = {u: f"L{k}" for k, (_, u) in enumerate(pairs, 1)}
    lines = list(until_set)
    for k, (y, u) in enumerate(pairs, 1):
        lines += [f"0 set loop{k}.{key} {value}" for key, value in (("name", f"L{k}"), ("pv", y), ("out", u), ("action", action(known.name, y, u)))]
    lines.append("0 apply")
    for line in outs:
        time, _, u, value = line.split()
        lines.append(f"{time} out {loops.get(u, u)} {value}")
    for k in range(1, len(pairs) + 1):
        lines += [f"{at} ?commission relay L{k}", f"{at} ~until RELAY_DONE|COMMISSION_ENDED|REQUEST_REFUSED",
                  f"{at} commission relay"]
        if method == "tried":
            lines += [f"{at} ?commission accept", f"{at} ~until TRIAL_KEPT|TRIAL_FAILED {patience_s:g}"]
        else:
            lines += [f"{at} ?commission edit", f"{at} ?apply"]
            lines += [f"{at} ?mode L{k} auto"] if method == "sequential" else []
    return "\n".join([*lines, f"{at} dump", f"{at} ~end"]) + "\n"


def simulate(where: Path, name: str, script: str, seed: int, noise: bool, events: list[str]) -> str:
    (where / "script").write_text(script, encoding="utf-8")
    command = [str(build.find_program("host", "reflux-sim-memory")), "--plant", name, "--port", "memory", "--console",
               "memory", "--duration", "1e8", "--script", str(where / "script"), "--transcript", str(where / "said"),
               "--log", str(where / "log"), "--seed", str(seed), "--noise", "1" if noise else "0", "--timeout", "60"]
    for event in events:
        command += ["--event", event]
    subprocess.run(command, capture_output=True, text=True, timeout=commissioning.LONGEST_S)
    return (where / "said").read_text(encoding="utf-8", errors="replace")


def run_one(campaign: Comparison, job: dict[str, Any]) -> dict[str, Any]:
    """In a process of its own. Whatever comes of it is a result."""
    start = campaign.start
    known = next(p for p in start.plants if p.name == job["plant"])
    plant = known_plants.read(known.name)
    noise, seed = job["noise"] != QUIET, int(job["seed"])
    quiet = [f"0:{o['name']}.resolution=0" for o in plant["outputs"]]
    events = commissioning.events(plant, known, start, seed) if noise else quiet
    if job["noise"] == NOISY:
        events = [e for e in events if ".drift=" not in e]
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        where = Path(folder)
        try:
            said = simulate(where, known.name, tuning_script(plant, start, known, job["method"]), seed, noise, events)
            out = {"job": job, **read(said, known, job["method"])}
            if out["whole"]:
                script, windows = closed_script(campaign, plant, known, said)
                simulate(where, known.name, script, 1, False, quiet)
                out.update(judge(campaign, plant, known, windows, where / "log"))
        except (subprocess.TimeoutExpired, OSError) as error:
            return {"job": job, "whole": False, "why": str(error)[:200]}
    return out


def read(said: str, known: commissioning.Known, method: str) -> dict[str, Any]:
    """Plant time from the beginning of the first test to the end of the last, with and without the trial."""
    def times(codes: str) -> list[float]:
        return [float(t) for t in re.findall(rf"< ! (\S+) \w+ (?:{codes}) ", said)]
    begun = times("COMMISSION_BEGUN")
    ended = re.findall(r"COMMISSION_ENDED (\S+) .*: (.*)$", said, re.M)
    failed = re.findall(r"TRIAL_FAILED (\S+) .*: (.*)$", said, re.M)
    kept = len(times("TRIAL_KEPT"))
    out: dict[str, Any] = {"kept": kept, "back": len(failed)}
    if not begun:
        return {**out, "whole": False, "why": "did not begin"}
    if method == "start-up":
        done = times("PROPOSAL|NOT_DETERMINED|COMMISSION_ENDED")
        found, wanted = int(bool(re.search(r" PROPOSAL - ", said))), 1
        out["right"] = sorted(pairs_of(said)) == known_plants.pairing(known.name)
    else:
        done = times("RELAY_DONE|COMMISSION_ENDED")
        found, wanted = len(times("RELAY_DONE")), len(known_plants.pairing(known.name))
    settings = len(re.findall(r"< set loop\d+\.gain ", said.split("> dump")[-1]))
    out["whole"] = found == wanted and not (method == "tried" and failed) and settings > 0
    out["why"] = (f"{ended[0][0]} {ended[0][1]}" if ended else f"{failed[0][0]} {failed[0][1]}" if failed and
                  method == "tried" else "" if out["whole"] else "not determined")
    if done and len(done) == len(begun) or (done and method == "start-up"):
        out["time"] = (done[-1] - begun[0]) / known.slowest_s
        after = times("TRIAL_KEPT|TRIAL_FAILED")
        out["with_trial"] = (max([done[-1], *after]) - begun[0]) / known.slowest_s
    return out


def settings_of(said: str) -> list[str]:
    """The configuration as it stood in the end, or when it was dumped before a trial."""
    return re.findall(r"< (set \S+ \S.*)$", said.split("> dump")[-1], re.M)


def loops_of(said: str) -> dict[str, tuple[str, str, str]]:
    """Measurement, output and name of every loop."""
    fields: dict[str, dict[str, str]] = {}
    for n, key, value in re.findall(r"< set loop(\d+)\.(name|pv|out) (\S+)$", said.split("> dump")[-1], re.M):
        fields.setdefault(n, {})[key] = value
    return {n: (f["pv"], f["out"], f["name"]) for n, f in fields.items() if {"pv", "out", "name"} <= set(f)}


def pairs_of(said: str) -> list[tuple[str, str]]:
    return [(pv, out) for pv, out, _ in loops_of(said).values()]


def closed_script(campaign: Comparison, plant: dict[str, Any], known: commissioning.Known,
                  said: str) -> tuple[str, list[tuple[float, str, float]]]:
    """All loops in automatic from rest, then every setpoint up and back, one after the other. Second: beginning of each
    window, measurement stepped, its setpoint in it."""
    loops = list(loops_of(said).values())
    names = {out: name for _, out, name in loops}
    span = {o["name"]: o["hi"] - o["lo"] for o in plant["outputs"]}
    rest = {o["name"]: o["nominal"] for o in plant["outputs"]}
    tick = plant["tick_s"]
    lines = ["0 begin", *(f"0 ?{line}" for line in settings_of(said)), *at_rest(plant), "0 apply"]
    lines += [f"{tick} out {names.get(u['name'], u['name'])} {u['nominal']}" for u in commissioning.inputs_of(plant)]
    at = 5 * tick
    lines += [f"{at:g} mode {name} auto" for _, _, name in loops]
    lines += [f"{at + 2 * tick:g} sp {name} {rest[pv]:.9g}" for pv, _, name in loops]
    windows = []
    for pv, _, name in loops:
        for up in (True, False):
            at += campaign.window * known.slowest_s
            value = rest[pv] + (campaign.step * span[pv] if up else 0.0)
            lines.append(f"{at:g} sp {name} {value:.9g}")
            windows.append((at, pv, value))
    return "\n".join([*lines, f"{at + campaign.window * known.slowest_s:g} ~end"]) + "\n", windows


def judge(campaign: Comparison, plant: dict[str, Any], known: commissioning.Known,
          windows: list[tuple[float, str, float]], log: Path) -> dict[str, Any]:
    """Integral of the errors of all loops, in steps and slowest time constants, a window; and do they come to rest?"""
    rows = csv.reader(line for line in log.open(encoding="utf-8") if line[0] != "#")
    head = [re.sub(r"\[.*", "", cell) for cell in next(rows)]
    loops = sorted({pv for _, pv, _ in windows})
    column = {pv: head.index(f"{pv}.true") for pv in loops}
    span = {o["name"]: o["hi"] - o["lo"] for o in plant["outputs"]}
    target = {o["name"]: o["nominal"] for o in plant["outputs"]}
    length = campaign.window * known.slowest_s
    total, worst, now, left = 0.0, 0.0, -1, list(windows)
    for row in rows:
        t = float(row[1])
        while left and t >= left[0][0]:
            now, (_, pv, value) = now + 1, left.pop(0)
            target[pv] = value
        if now < 0:
            continue
        errors = [abs(float(row[column[pv]]) - target[pv]) / span[pv] / campaign.step for pv in loops]
        total += sum(errors) * plant["tick_s"] / known.slowest_s
        if t > windows[now][0] + 0.75 * length:
            worst = max(worst, *errors)
    return {"iae": total / len(windows), "left": worst, "settles": worst <= SETTLED and now == len(windows) - 1}


# ---- results ----

HEADER = ["plant", "", "way", "runs", "with settings", "time", "time 95 %", "with trial", "settle", "left", "IAE"]


def middle(values: list[float]) -> str:
    return table.figure(statistics.median(values)) if values else "-"


def distribution(campaign: Comparison, results: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    rows = []
    for plant in campaign.start.plants:
        for noise in (QUIET, NOISY, DRIFT):
            for method in METHODS:
                chosen = [r for r in results if r["job"]["plant"] == plant.name and r["job"]["noise"] == noise and
                          r["job"]["method"] == method]
                if not chosen:
                    continue
                whole = [r for r in chosen if r["whole"]]
                times = [r["time"] for r in whole if "time" in r]
                trials = [r["with_trial"] for r in whole if "with_trial" in r and r["kept"] + r["back"] > 0]
                settle = sum(bool(r.get("settles")) for r in whole)
                rows.append([plant.name, noise, method, str(len(chosen)), str(len(whole)),
                             middle(times) if method != "tried" else "-",
                             table.figure(commissioning.high(times)) if times and method != "tried" else "-",
                             middle(trials), f"{settle} of {len(whole)}",
                             middle([r["left"] for r in whole if "left" in r]),
                             middle([r["iae"] for r in whole if r.get("settles")])])
    return HEADER, rows


def reasons(results: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    found: dict[tuple[str, str, str], dict[str, int]] = {}
    for r in results:
        if not r["whole"]:
            ways = found.setdefault((r["job"]["plant"], r["job"]["noise"], r["why"]), {})
            ways[r["job"]["method"]] = ways.get(r["job"]["method"], 0) + 1
    return ["plant", "", "why there are no settings", *METHODS], [
        [*key, *(str(ways.get(m, 0)) for m in METHODS)] for key, ways in sorted(found.items())]


def write_results(campaign: Comparison, results: list[dict[str, Any]], folder: Path) -> None:
    start = campaign.start
    ways = "\n".join(f"- *{m}*: {text}" for m, text in METHODS.items())
    text = f"""# {campaign.title}

Written by `tools/campaign {campaign.name}`: {len(start.plants)} plants, each tuned in four ways on the firmware `memory`.

{ways}

The start-up has to find the pairs as well; the relay tests are given those of `tests/reference/linear_pairing.csv`. A relay
test begins at rest and ends with its limit cycle; the next begins when the plant is at rest again. Settings by Tyreus and
Luyben (docs/methods/relay.md). *quiet*: exact sensors, one run. *noise*: {len(start.seeds)} seeds with noise of {start.noise:.1%} of span and
{start.bits} bits. *drift*: the same with the drift that the campaign of start-ups has, {start.drift:.0%} of span per slowest
time constant.

Time is plant time from the beginning of the first test to the end of the last one, in slowest time constants, median of the
runs that ended with settings for every loop; *with trial* includes the trial of the whole proposal, or of every loop by
itself. Then, without noise and from rest, all loops with those settings are closed together, and every setpoint is moved by
{campaign.step:.1%} of span and back, {campaign.window:g} slowest time constants each: *settle* counts the sets with which every
error was below {SETTLED:.0%} of the step in the last quarter of every window, *left* is the largest of these errors in
steps, median. IAE is the integral of the errors of all loops
after one such step, in steps times slowest time constants, median of those that settle.

{table.markdown(*distribution(campaign, results))}

Where there were no settings:

{table.markdown(*reasons(results))}
"""
    (folder / f"{campaign.name}.md").write_text(text, encoding="utf-8")
    with (folder / f"{campaign.name}.csv").open("w", encoding="utf-8", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["plant", "noise", "way", "seed", "settings", "time", "with_trial", "settles", "left", "iae", "why"])
        for r in results:
            numbers = ["" if r.get(k) is None else f"{r[k]:.4g}" for k in ("time", "with_trial")]
            closed = ["" if r.get(k) is None else f"{float(r[k]):.4g}" for k in ("settles", "left", "iae")]
            writer.writerow([r["job"]["plant"], r["job"]["noise"], r["job"]["method"], r["job"]["seed"], int(r["whole"]),
                             *numbers, *closed, r["why"]])
    print(f"results: {shown(folder / campaign.name)}.md and .csv")


def execute(campaign: Comparison, options: argparse.Namespace, state: Any) -> int:
    jobs = campaign.jobs(options.fraction)
    missing = [job for job in jobs if state.get(job) is None]
    progress = build.Progress(campaign.name)
    with ProcessPoolExecutor(options.jobs) as pool:
        waiting = [pool.submit(run_one, campaign, job) for job in missing]
        for count, future in enumerate(as_completed(waiting), 1):
            state.add(future.result())
            progress.show(f"{count} of {len(missing)} runs")
    progress.end(f"{len(missing)} runs")
    results = [state.get(job) for job in jobs]
    if any(r is None for r in results):
        raise UserError("a run has left no result")
    if not options.check and options.fraction == 1.0:
        write_results(campaign, results, options.results)
    print("\n" + table.columns(*distribution(campaign, results)))
    silent = [r for r in results if not r["whole"] and not r["why"]]
    for r in silent[:10]:
        print(f"FAILED  {' '.join(str(v) for v in r['job'].values())}: neither settings nor a reason")
    return 1 if silent else 0
