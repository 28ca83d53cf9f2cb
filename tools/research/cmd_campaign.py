"""tools/campaign: one scenario many times over, and what its results scatter."""

from __future__ import annotations

import argparse
import csv
import hashlib
import itertools
import json
import os
import statistics
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from reflux import build, launch, runner, table
from research import (
    commissioning,
    composition_campaign,
    decoupling_campaign,
    endurance_campaign,
    estimates_campaign,
    feedforward_alone_campaign,
    feedforward_campaign,
    kalman_1989_campaign,
    kalman_campaign,
    relay_campaign,
    self_tuner_weeks,
    self_tuning_campaign,
    startup_campaign,
    state_campaign,
    trays_campaign,
)
from reflux import scenario as scenarios
from reflux.errors import RunFailed, UserError
from reflux.paths import CAMPAIGNS, build_root, named, out_root, shown
from reflux.schema import Table, load_toml

METRICS = ("iae", "overshoot_percent", "settling_s", "tv", "max_error")
VARIED = ("noise",)


@dataclass(frozen=True)
class Campaign:
    name: str
    title: str
    scenario: scenarios.Scenario
    seeds: tuple[int, ...]
    vary: dict[str, list[float]]

    def jobs(self, fraction: float) -> list[dict[str, float]]:
        """The first part of the seeds, at least one, with every combination of what is varied."""
        count = max(1, round(len(self.seeds) * fraction))
        names = list(self.vary)
        return [{"seed": seed, **dict(zip(names, values))}
                for seed in self.seeds[:count] for values in itertools.product(*self.vary.values())]


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/campaign",
        description="Runs a campaign of tests/campaign: one scenario over many seeds. Runs that are finished are "
        "kept in the build folder, so that an interrupted campaign goes on where it was. A whole campaign writes "
        "its tables into out/campaign. Exit status 1 when a run fails or misses its limits.")
    p.add_argument("name", metavar="NAME", help=f"one of: {', '.join(known())}")
    p.add_argument("--fraction", type=float, default=1.0, metavar="X", help="run only this part of the seeds")
    p.add_argument("--check", action="store_true", help="write no tables; only say whether all limits hold")
    p.add_argument("--out", type=named, metavar="FOLDER", help="folder for the tables (default out/campaign)")
    p.add_argument("--keep", action="store_true", help="write the tables into tests/campaign/results, to be committed")
    p.add_argument("--again", action="store_true", help="forget the finished runs")
    p.add_argument("-j", "--jobs", type=int, default=os.cpu_count() or 1, metavar="N")
    p.add_argument("--no-build", action="store_true", help="do not build; use what is there")
    p.add_argument("--sample", type=int, metavar="N", help="startup: the first N runs of a fixed order, which takes all plants in turn")
    p.add_argument("--only", metavar="NAME", help="startup: runs of this plant or class alone")
    p.add_argument("--starts", type=int, metavar="N", help="startup: up to N start-ups of a run, each with the changes that the board advises")
    p.add_argument("--set", action="append", default=[], metavar="'NAME VALUE'", help="startup: a setting of the firmware besides channels and limits")
    p.add_argument("--fixed", action="store_true", help="startup: the firmware in fixed point; tables and rows are named startup-fixed")
    p.add_argument("--iae", action="store_true", help="startup: compare kept settings with the best of equal sensitivity instead")
    p.add_argument("--week", action="store_true", help="startup: let a sample of the kept runs in the folder run for a week, beside a plain PI")
    p.add_argument("--table", action="store_true", help="startup: run nothing; print the tables of the runs in the folder")
    options = p.parse_args(arguments)
    if not 0 < options.fraction <= 1:
        raise UserError("--fraction must be more than 0 and at most 1")
    if options.jobs < 1:
        raise UserError("--jobs must be 1 or more")
    if options.keep and (options.out or options.check or options.fraction < 1):
        raise UserError("--keep keeps a whole campaign, and goes without --out, --check and --fraction")
    campaign = load(options.name)
    if not isinstance(campaign, startup_campaign.Startup) and (
            options.sample is not None or options.starts is not None or options.only or options.set or options.iae or options.table or
            options.week or options.fixed):
        raise UserError("--sample, --only, --starts, --set, --fixed, --iae, --week and --table belong to the campaign startup")
    options.results = CAMPAIGNS / "results" if options.keep else options.out or out_root() / "campaign"
    if not options.check:
        options.results.mkdir(parents=True, exist_ok=True)
    if isinstance(campaign, endurance_campaign.Endurance):
        return endurance_campaign.execute(campaign, options)
    if isinstance(campaign, self_tuner_weeks.Weeks):
        return self_tuner_weeks.execute(campaign, options)
    if isinstance(campaign, kalman_campaign.Kalman):
        return kalman_campaign.execute(campaign, options)
    if isinstance(campaign, composition_campaign.Composition):
        return composition_campaign.execute(campaign, options)
    if isinstance(campaign, feedforward_alone_campaign.Alone):
        return feedforward_alone_campaign.execute(campaign, options)
    if not options.no_build:
        launch.build_for(campaign.scenario.firmware if isinstance(campaign, Campaign) else "memory")
        if options.fixed:
            build.build("host-fixed", ("reflux-sim-memory",))
    if isinstance(campaign, startup_campaign.Startup):
        return startup_campaign.execute(campaign, options)
    if isinstance(campaign, relay_campaign.Comparison):
        state = State(build_root() / "campaign" / f"{campaign.name}.jsonl", relay_campaign.fingerprint(campaign),
                      options.again)
        return relay_campaign.execute(campaign, options, state)
    if isinstance(campaign, self_tuning_campaign.Comparison):
        state = State(build_root() / "campaign" / f"{campaign.name}.jsonl", self_tuning_campaign.fingerprint(campaign),
                      options.again)
        return self_tuning_campaign.execute(campaign, options, state)
    if isinstance(campaign, estimates_campaign.Estimates):
        if not options.no_build:
            for kind in sorted({case.firmware for case in campaign.cases(options.fraction)} - {"memory"}):
                launch.build_for(kind)
        state = State(build_root() / "campaign" / f"{campaign.name}.jsonl", estimates_campaign.fingerprint(campaign), options.again)
        return estimates_campaign.execute(campaign, options, state)
    if isinstance(campaign, kalman_1989_campaign.PilotKalman):
        state = State(build_root() / "campaign" / f"{campaign.name}.jsonl", kalman_1989_campaign.fingerprint(campaign), options.again)
        return kalman_1989_campaign.execute(campaign, options, state)
    if isinstance(campaign, decoupling_campaign.Comparison):
        if not options.no_build:
            build.build("host", ("libreflux",))
        state = State(build_root() / "campaign" / f"{campaign.name}.jsonl", decoupling_campaign.fingerprint(campaign), options.again)
        return decoupling_campaign.execute(campaign, options, state)
    if isinstance(campaign, state_campaign.StateDecoupling):
        state = State(build_root() / "campaign" / f"{campaign.name}.jsonl", state_campaign.fingerprint(campaign), options.again)
        return state_campaign.execute(campaign, options, state)
    if isinstance(campaign, feedforward_campaign.Feedforward):
        if not options.no_build:
            build.build("host", ("libreflux_board", "reflux-plant", "reflux-sim"))
            build.build("host-fixed", ("libreflux_board",))
        state = State(build_root() / "campaign" / f"{campaign.name}.jsonl", feedforward_campaign.fingerprint(campaign), options.again)
        return feedforward_campaign.execute(campaign, options, state)
    if isinstance(campaign, trays_campaign.Trays):
        state = State(build_root() / "campaign" / f"{campaign.name}.jsonl", trays_campaign.fingerprint(campaign), options.again)
        return trays_campaign.execute(campaign, options, state)
    return execute(campaign, options)


def known() -> list[str]:
    return sorted(f.stem for f in CAMPAIGNS.glob("*.toml"))


def load(name: str) -> (Campaign | commissioning.Start | relay_campaign.Comparison | endurance_campaign.Endurance |
                        self_tuning_campaign.Comparison | trays_campaign.Trays | estimates_campaign.Estimates |
                        kalman_campaign.Kalman | composition_campaign.Composition | kalman_1989_campaign.PilotKalman | decoupling_campaign.Comparison |
                        state_campaign.StateDecoupling | feedforward_campaign.Feedforward | feedforward_alone_campaign.Alone |
                        self_tuner_weeks.Weeks | startup_campaign.Startup):
    path = CAMPAIGNS / f"{name}.toml"
    if name not in known():
        raise UserError(f'no campaign "{name}"; there are: {", ".join(known()) or "none"}')
    top = Table(load_toml(path), path)
    if top.text("name") != name:
        raise UserError(f"{top.path('name')} must be the file's own name, {name}")
    kind = top.text("kind", "scenario", choices=("scenario", "commissioning", "relay", "endurance", "self-tuning", "trays", "estimates",
                                            "kalman", "composition", "pilot-kalman", "decoupling", "state-decoupling", "feedforward",
                                            "feedforward-alone", "self-tuner-weeks", "startup"))
    if kind == "startup":
        return startup_campaign.load(top, name)
    if kind == "endurance":
        return endurance_campaign.load(top, name)
    if kind == "self-tuner-weeks":
        return self_tuner_weeks.load(top, name)
    if kind == "composition":
        return composition_campaign.load(top, name)
    if kind == "kalman":
        return kalman_campaign.load(top, name)
    if kind == "feedforward-alone":
        return feedforward_alone_campaign.load(top, name)
    if kind == "pilot-kalman":
        return kalman_1989_campaign.load(top, name)
    if kind == "state-decoupling":
        return state_campaign.load(top, name)
    if kind == "feedforward":
        return feedforward_campaign.load(top, name)
    if kind == "estimates":
        return estimates_campaign.load(top, name)
    if kind == "decoupling":
        return decoupling_campaign.load(top, name)
    if kind == "trays":
        return trays_campaign.load(top, name)
    if kind == "self-tuning":
        return self_tuning_campaign.load(top, name)
    if kind == "relay":
        return relay_campaign.load(top, name)
    if kind == "commissioning":
        return commissioning.load(top, name)
    scenario = scenarios.load((path.parent / top.text("scenario")).resolve())
    scenario = scenario.with_options(firmware=top.text("firmware", "memory", choices=scenarios.FIRMWARES[:-1]))
    first = top.integer("first_seed", 1)
    seeds = tuple(range(first, first + top.integer("seeds", low=1, high=100000)))
    vary: dict[str, list[float]] = {}
    if top.has("vary"):
        inner = top.table("vary")
        for key in VARIED:
            if inner.has(key):
                vary[key] = [float(x) for x in inner.list(key)]
        inner.known = list(VARIED)
        inner.done()
    campaign = Campaign(name, top.text("title", name), scenario, seeds, vary)
    top.done()
    return campaign


def fingerprint(campaign: Campaign) -> str:
    """Changes with everything a result depends on: the scenario and the programs."""
    digest = hashlib.sha256(repr(replace(campaign.scenario, seed=0, file=Path(), console=())).encode())
    programs = [build.find_program("host", "reflux-sim-memory" if campaign.scenario.firmware == "memory"
                                   else "reflux-sim")]
    if campaign.scenario.firmware.startswith("stm32"):
        programs.append(build.find_image(campaign.scenario.firmware))
    elif campaign.scenario.firmware != "memory":
        programs.append(build.find_program(campaign.scenario.firmware, "reflux-host"))
    for program in programs:
        digest.update(program.read_bytes())
    return digest.hexdigest()


def execute(campaign: Campaign | commissioning.Start, options: argparse.Namespace) -> int:
    starts = isinstance(campaign, commissioning.Start)
    jobs = campaign.jobs(options.fraction)
    mark = commissioning.fingerprint(campaign) if starts else fingerprint(campaign)
    state = State(build_root() / "campaign" / f"{campaign.name}.jsonl", mark, options.again)
    missing = [job for job in jobs if state.get(job) is None]
    if len(missing) < len(jobs):
        print(f"{campaign.name}: {len(jobs) - len(missing)} of {len(jobs)} runs are finished already")
    run_missing(campaign, missing, state, options.jobs)
    results = [state.get(job) for job in jobs]
    if starts:
        return judge_starts(campaign, results, options)
    if not options.check and options.fraction == 1.0:
        write_results(campaign, results, options.results)
    print("\n" + table.columns(*distribution(campaign, results)))
    bad = [r for r in results if r["failures"]]
    for r in bad[:10]:
        print(f"FAILED  {label(r['job'])}: {r['failures'][0]}")
    print(f"\n{len(results)} runs, {len(bad)} failed or missed limits")
    return 1 if bad else 0


def judge_starts(campaign: commissioning.Start, results: list[dict[str, Any]], options: argparse.Namespace) -> int:
    if not options.check and options.fraction == 1.0:
        commissioning.write_results(campaign, results, options.results)
    print("\n" + table.columns(*commissioning.distribution(campaign, results)))
    missed = commissioning.shortfalls(campaign, results)
    for text in missed:
        print(f"NOT REACHED  {text}")
    return 1 if missed else 0


class State:
    """One line of JSON for each finished run; lines of other programs or scenarios do not count."""

    def __init__(self, path: Path, mark: str, again: bool):
        self.path, self.mark = path, mark
        self.done: dict[str, dict[str, Any]] = {}
        path.parent.mkdir(parents=True, exist_ok=True)
        if again:
            path.unlink(missing_ok=True)
        for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
            try:
                entry = json.loads(line)
                if entry["mark"] == mark:
                    self.done[label(entry["job"])] = entry
            except (ValueError, KeyError):
                continue  # the last line of an interrupted campaign may be cut off

    def get(self, job: dict[str, float]) -> dict[str, Any] | None:
        return self.done.get(label(job))

    def add(self, entry: dict[str, Any]) -> None:
        entry = {"mark": self.mark, **entry}
        self.done[label(entry["job"])] = entry
        with self.path.open("a", encoding="utf-8") as out:
            out.write(json.dumps(entry) + "\n")


def label(job: dict[str, float]) -> str:
    return ", ".join(f"{key} {value}" if isinstance(value, str) else f"{key} {value:g}" for key, value in job.items())


def run_missing(campaign: Campaign | commissioning.Start, jobs: list[dict[str, Any]], state: State,
                workers: int) -> None:
    if not jobs:
        return
    progress = build.Progress(campaign.name)
    started = time.monotonic()
    with ProcessPoolExecutor(workers) as pool:
        if isinstance(campaign, commissioning.Start):
            waiting = [pool.submit(commissioning.run_one, campaign, job) for job in jobs]
        else:
            waiting = [pool.submit(run_one, campaign.scenario, job) for job in jobs]
        try:
            for count, future in enumerate(as_completed(waiting), 1):
                state.add(future.result())
                left = (time.monotonic() - started) / count * (len(jobs) - count)
                progress.show(f"{count} of {len(jobs)} runs, about {left:.0f} s left")
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    progress.end(f"{len(jobs)} runs in {time.monotonic() - started:.0f} s")


def run_one(scenario: scenarios.Scenario, job: dict[str, float]) -> dict[str, Any]:
    """In a process of its own. A run that fails is a result too."""
    scenario = replace(scenario, seed=int(job["seed"]), noise=job.get("noise", scenario.noise))
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        try:
            result = runner.run(scenario, runner.Options(Path(folder), quiet=True))
        except (RunFailed, UserError) as error:
            return {"job": job, "failures": [str(error)], "loops": {}}
    loops = {}
    for window in result.windows:
        if window.kind == "overall":
            steps = [w for w in result.windows if w.loop == window.loop and w.kind == "setpoint"]
            values = {m: getattr(window, m) for m in METRICS}
            for m in ("overshoot_percent", "settling_s"):
                known = [getattr(w, m) for w in steps if getattr(w, m) is not None]
                values[m] = max(known) if known and all(v == v for v in known) else None
            loops[window.loop] = values
    return {"job": job, "failures": result.failures(), "loops": loops}


def distribution(campaign: Campaign, results: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    header = ["loop", "metric", *campaign.vary, "runs", "mean", "deviation", "5 %", "median", "95 %", "largest"]
    rows = []
    for values in itertools.product(*campaign.vary.values()):
        chosen = [r for r in results if all(r["job"][n] == v for n, v in zip(campaign.vary, values))]
        for loop in (known_loop.name for known_loop in campaign.scenario.loops):
            for metric in METRICS:
                found = sorted(v for r in chosen if (v := r["loops"].get(loop, {}).get(metric)) is not None)
                if found:
                    rows.append([loop, metric, *(f"{v:g}" for v in values), str(len(found)), *summary(found)])
    return header, rows


def summary(values: list[float]) -> list[str]:
    deviation = statistics.stdev(values) if len(values) > 1 else 0.0
    at = [values[min(len(values) - 1, int(q * len(values)))] for q in (0.05, 0.5, 0.95)]
    return [table.figure(v, 4) for v in (statistics.fmean(values), deviation, *at, values[-1])]


def write_results(campaign: Campaign, results: list[dict[str, Any]], folder: Path) -> None:
    bad = sum(1 for r in results if r["failures"])
    text = (f"# {campaign.title}\n\nWritten by `tools/campaign {campaign.name}`: {len(results)} runs of "
            f"`{scenarios.relative(campaign.scenario.file)}` on the firmware `{campaign.scenario.firmware}`; {bad} "
            "failed or missed limits. Metrics over the whole run; overshoot and settling time of the worst "
            "setpoint step of a run (docs/use/scenarios.md).\n\n" + table.markdown(*distribution(campaign, results)) + "\n")
    (folder / f"{campaign.name}.md").write_text(text, encoding="utf-8")
    with (folder / f"{campaign.name}.csv").open("w", encoding="utf-8", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        names = [f"{loop.name}.{m}" for loop in campaign.scenario.loops for m in METRICS]
        writer.writerow(["seed", *campaign.vary, *names, "failure"])
        for r in results:
            values = [r["loops"].get(n.split(".")[0], {}).get(n.split(".")[1]) for n in names]
            cells = ["" if v is None else f"{v:.6g}" for v in values]
            writer.writerow([*(f"{v:g}" for v in r["job"].values()), *cells, "; ".join(r["failures"])])
    print(f"results: {shown(folder / campaign.name)}.md and .csv")


