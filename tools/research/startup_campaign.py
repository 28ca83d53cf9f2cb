"""The campaign of start-ups on plants that they were not made for: jobs, rows of the table, and what is asked of them.

Every run is a row of startup.csv in the folder of --out, every engineer's verdict one of startup-engineer.csv. A campaign goes on where it was
stopped: what has a row is not run again.
"""

from __future__ import annotations

import argparse
import csv
import functools
import hashlib
import math
import multiprocessing
import os
import random
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Callable

from reflux import build, table
from reflux.errors import UserError
from reflux.paths import CAMPAIGNS, out_root, shown
from reflux.schema import Table
from research import startup_engineer, startup_iae, startup_plants, startup_runs, startup_table, startup_week
from research.startup_judge import Judge, Verdict

FIELDS = ("plant", "kind", "seed", "noise", "program", "outcome", "reason", "doubts", "events", "starts", "hours_tests", "hours", "proposed",
          "settings", "extras", "stable", "ms", "gain_margin", "niederlinski", "excursion_tests", "excursion_trial", "slow", "flags",
          "deviations", "advice", "clock_s")
ENGINEER_FIELDS = ("plant", "seed", "noise", "version", "pairs", "stable", "ms", "gain_margin")
KEPT_ENGINEER = CAMPAIGNS / "results" / "startup-engineer.csv"
Row = dict[str, str]


@dataclass(frozen=True)
class Job:
    plant: str
    seed: int
    noise: float

    def key(self) -> tuple[str, str, str]:
        return self.plant, str(self.seed), f"{self.noise:g}"


@dataclass(frozen=True)
class Startup:
    name: str
    title: str
    seeds: int  # of every named plant, with every noise
    random: int  # random plants, one seed each
    starts: int  # start-ups of a run at most, each with what the one before has advised
    longest_s: float  # of one start-up, on the clock
    checked: tuple[Job, ...]  # the fixed sample of --check
    preset: str = "host"  # of the build whose program runs

    def jobs(self) -> list[Job]:
        """In the order in which a sample takes them: each named plant once, in an order of seeds and noises of its own, and so many random
        plants that both end together."""
        lists = []
        for name in startup_plants.names():
            jobs = [Job(name, seed, noise) for seed in range(1, self.seeds + 1) for noise in startup_plants.NOISES]
            random.Random(f"sample {name}").shuffle(jobs)
            lists.append(jobs)
        rounds = self.seeds * len(startup_plants.NOISES)
        out, given = [], 0
        for n in range(rounds):
            out += [jobs[n] for jobs in lists]
            due = round(self.random * (n + 1) / rounds)
            for k in range(given, due):
                noises = startup_plants.NOISES
                out.append(Job(f"random-{k}", 1, noises[k % len(noises)]))
            given = due
        return out


def load(top: Table, name: str) -> Startup:
    checked = []
    for t in top.tables("checked"):
        checked.append(Job(t.text("plant"), t.integer("seed", low=1), t.number("noise", low=0, high=0.1)))
        t.done()
        if checked[-1].plant not in startup_plants.names() and not checked[-1].plant.startswith("random-"):
            raise UserError(f'{top.path("checked")}: there is no plant "{checked[-1].plant}"')
    found = Startup(name, top.text("title", name), top.integer("seeds", 12, 1, 1000), top.integer("random", 300, 0, 100000),
                    top.integer("starts", 1, 1, 10), top.number("longest_s", 600.0, low=1, high=1e5), tuple(checked))
    top.done()
    return found


# ---- one run ----

@functools.lru_cache(maxsize=64)
def judge_of(name: str, seed: int, until_s: float) -> Judge:
    return Judge(startup_plants.case(name).linear(seed, until_s))


def judge_at(job: Job, until_s: float) -> Judge:
    """Plants that do not change are one for all seeds and times."""
    case = startup_plants.case(job.plant)
    if case.gain_change is None:
        return judge_of(job.plant, 0, 0.0)
    return judge_of(job.plant, job.seed, math.inf if until_s > case.gain_change[2](job.seed) else 0.0)


def run_one(job: Job, starts: int, longest_s: float, given: tuple[str, ...] = ()) -> Row:
    """In a process of its own. Whatever comes of it is a row. given: "NAME VALUE", set from the first start-up on."""
    begun = time.monotonic()
    case = startup_plants.case(job.plant)
    settings: list[str] = list(given)
    tests_s = whole_s = 0.0
    excursions: list[float] = []
    for count in range(1, starts + 1):
        said = startup_runs.start_up(case, job.noise, job.seed, settings, longest_s)
        tests_s, whole_s = tests_s + said.tested_s, whole_s + said.end_s
        excursions.append(said.excursion_tests)
        if said.proposed or not said.advice or count == starts:
            break
        changed = {s.split()[0] for s in said.advice}
        settings = [s for s in settings if s.split()[0] not in changed] + said.advice
    plant = case.linear(job.seed)
    verdict: Verdict | None = None
    if said.loops and not any(e.startswith("cascade") for e in said.extras):
        verdict = judge_at(job, said.end_s).judge(startup_runs.loops(said, plant), said.decoupler)
    stated = startup_runs.deviations(said, plant) if plant.stable() and not case.fault else []
    return {
        "plant": job.plant, "kind": case.kind, "seed": str(job.seed), "noise": f"{job.noise:g}", "program": program(),
        "outcome": said.outcome, "reason": said.reason, "doubts": " ".join(said.doubts),
        "events": " ".join(f"{code}:{n}" for code, n in sorted(said.events.items())), "starts": str(count), "hours_tests": f"{tests_s / 3600:.4g}",
        "hours": f"{whole_s / 3600:.4g}", "proposed": yes(said.proposed),
        "settings": " ".join(f"{y}/{u}:{kc:.6g}:{ti:.6g}:{td:.6g}" for y, u, kc, ti, td in said.loops)
        + ("" if said.decoupler is None else " decoupler:" + ":".join(f"{d:.5g}" for d in said.decoupler.ravel())),
        "extras": " ".join(said.extras), **verdict_cells(verdict), "niederlinski": "" if verdict is None else f"{verdict.niederlinski:.4g}",
        "excursion_tests": number(max(excursions)), "excursion_trial": number(said.excursion_trial),
        "slow": " ".join(startup_runs.slow_elements(said, case)),
        "flags": " ".join(f"{y}/{u}:{'+'.join(sorted(f))}" for (y, u), f in said.flags.items() if f),
        "deviations": " ".join(f"{y}/{u}:{gain:.3g}:{residence:.3g}:{int(is_open)}" for y, u, gain, residence, is_open in stated),
        "advice": ", ".join(said.advice), "clock_s": f"{time.monotonic() - begun:.2f}"}


def engineer_one(job: Job) -> Row:
    outcome = startup_engineer.engineer(startup_plants.case(job.plant), job.noise, job.seed, judge_at(job, math.inf))
    names = startup_plants.case(job.plant).data
    pairs = " ".join(f"{names['outputs'][loop.output]['name']}/{names['inputs'][loop.input]['name']}" for loop in outcome.loops)
    return {"plant": job.plant, "seed": str(job.seed), "noise": f"{job.noise:g}", "version": engineer_version(), "pairs": pairs,
            **verdict_cells(outcome.verdict)}


def verdict_cells(v: Verdict | None) -> Row:
    return {"stable": "", "ms": "", "gain_margin": ""} if v is None else {
        "stable": yes(v.stable), "ms": number(v.ms), "gain_margin": number(v.gain_margin)}


def yes(value: bool) -> str:
    return "yes" if value else "no"


def number(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.4g}"


@functools.cache
def program() -> str:
    return hashlib.sha256(startup_runs.program().read_bytes()).hexdigest()[:8]


@functools.cache
def engineer_version() -> str:
    digest = hashlib.sha256()
    for name in ("engineer", "shapes", "judge", "linear", "plants", "columns"):
        digest.update(Path(__file__).with_name(f"startup_{name}.py").read_bytes())
    return digest.hexdigest()[:8]


# ---- rows that are kept ----

class Rows:
    """A CSV to which finished rows are added at once. mark: a column, and the value that rows must have to count. more: rows from elsewhere."""

    def __init__(self, path: Path, fields: tuple[str, ...], mark: tuple[str, str], again: bool = False, more: Path | None = None):
        self.path, self.fields = path, fields
        self.done: dict[tuple[str, str, str], Row] = {}
        self.others = 0
        if again:
            path.unlink(missing_ok=True)
        for row in [*(read_rows(more) if more else []), *read_rows(path)]:
            if row.get(mark[0]) == mark[1]:
                self.done[row["plant"], row["seed"], row["noise"]] = row
            else:
                self.others += 1

    def add(self, row: Row) -> None:
        with self.path.open("a+b") as file:
            size = file.tell()
            file.seek(max(size - 1, 0))
            torn = size > 0 and file.read() != b"\n"
        with self.path.open("a", encoding="utf-8", newline="") as out:
            writer = csv.DictWriter(out, self.fields, lineterminator="\n")
            if size == 0:
                writer.writeheader()
            elif torn:
                out.write("\n")
            writer.writerow(row)
        self.done[row["plant"], row["seed"], row["noise"]] = row


def read_rows(path: Path) -> list[Row]:
    """The last line of an interrupted campaign may be cut off: it does not count."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as lines:
        return [row for row in csv.DictReader(lines) if None not in row and None not in row.values()]


def processes(workers: int, preset: str) -> ProcessPoolExecutor:
    """They run the program of the preset. In them numpy's library has one thread: with small matrices several only wait for each other."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"),
                               initializer=startup_runs.use, initargs=(preset,))


def run_missing(what: str, jobs: list[Job], rows: Rows, workers: int, preset: str, call: Callable[..., Row], *arguments: Any) -> None:
    missing = [job for job in jobs if job.key() not in rows.done]
    if len(missing) < len(jobs):
        print(f"{what}: {len(jobs) - len(missing)} of {len(jobs)} are finished already")
    if not missing:
        return
    progress, begun = build.Progress(what), time.monotonic()
    with processes(workers, preset) as pool:
        waiting = [pool.submit(call, job, *arguments) for job in missing]
        try:
            for count, future in enumerate(as_completed(waiting), 1):
                rows.add(future.result())
                left = (time.monotonic() - begun) / count * (len(missing) - count)
                progress.show(f"{count} of {len(missing)}, about {left:.0f} s left")
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    progress.end(f"{len(missing)} in {time.monotonic() - begun:.0f} s")


# ---- the campaign ----

def chosen(start: Startup, options: argparse.Namespace) -> list[Job]:
    jobs = start.jobs()
    if options.only:
        jobs = [job for job in jobs if job.plant == options.only or startup_plants.case(job.plant).kind == options.only]
        if not jobs:
            raise UserError(f'there is no plant and no class "{options.only}"; plants: {", ".join(startup_plants.names())}, random-0 ...')
    if options.sample is not None:
        return jobs[:options.sample]
    return jobs[:max(1, round(len(jobs) * options.fraction))]


def execute(start: Startup, options: argparse.Namespace) -> int:
    if options.fixed:
        start = replace(start, name=f"{start.name}-fixed", title=f"{start.title}, in fixed point", preset="host-fixed")
    startup_runs.use(start.preset)
    if any(n is not None and n < 1 for n in (options.sample, options.starts)):
        raise UserError("--sample and --starts must be 1 or more")
    if options.check:
        return check(start)
    if options.iae:
        return compare(start, options.jobs)
    if options.week:
        return weeks(start, options)
    folder = out_root() / "campaign" if options.keep else options.results
    folder.mkdir(parents=True, exist_ok=True)
    files = folder / f"{start.name}.csv", folder / f"{start.name}-engineer.csv"
    if options.table:
        engineers = Rows(files[1], ENGINEER_FIELDS, ("version", engineer_version()), more=KEPT_ENGINEER)
        print(startup_table.text(start.title, read_rows(files[0]), list(engineers.done.values())))
        return 0
    jobs = chosen(start, options)
    rows = Rows(files[0], FIELDS, ("program", program()), options.again)
    if rows.others:
        raise UserError(f"{shown(files[0])} holds {rows.others} rows of another program: --again forgets them, --out names another folder")
    run_missing(f"{start.name}: runs", jobs, rows, options.jobs, start.preset, run_one, options.starts or start.starts, start.longest_s,
                tuple(options.set))
    engineers = Rows(files[1], ENGINEER_FIELDS, ("version", engineer_version()), more=KEPT_ENGINEER)
    run_missing(f"{start.name}: engineer", jobs, engineers, options.jobs, start.preset, engineer_one)
    keys = [job.key() for job in jobs]
    page = startup_table.text(start.title, [rows.done[key] for key in keys], [engineers.done[key] for key in keys])
    (options.results / f"{start.name}.md").write_text(page, encoding="utf-8")
    if options.keep:
        keep_engineers([engineers.done[key] for key in sorted(keys)])
    print("\n" + page)
    return 0 if not startup_table.harmful(rows.done[key] for key in keys) else 1


def weeks(start: Startup, options: argparse.Namespace) -> int:
    """A week alone of every n-th kept run in the folder. What has rows in startup-week.csv there is not run again."""
    folder = out_root() / "campaign" if options.keep else options.results
    kept = startup_week.sample(read_rows(folder / f"{start.name}.csv"))
    if not kept:
        raise UserError(f"{shown(folder)} holds no kept runs: run the campaign first")
    path = folder / f"{start.name}-week.csv"
    if options.again:
        path.unlink(missing_ok=True)
    done = startup_week.whole(read_rows(path))
    missing = [row for row in kept if startup_week.key(row) not in done]
    with processes(options.jobs, start.preset) as pool:
        progress = build.Progress(f"{start.name}: weeks")
        waiting = [pool.submit(startup_week.week_of, row) for row in missing]
        for count, future in enumerate(as_completed(waiting), 1):
            found = future.result()
            startup_week.add(path, found)
            done[startup_week.key(found[0])] = found
            progress.show(f"{count} of {len(missing)}")
        progress.end(f"{len(missing)}")
    page = startup_week.text([week for row in kept for week in done[startup_week.key(row)]])
    (options.results / f"{start.name}-week.md").write_text(page, encoding="utf-8")
    print("\n" + page)
    return 0


def compare(start: Startup, workers: int) -> int:
    """Settings beside the best of equal sensitivity."""
    jobs = [(name, seed) for name in startup_iae.PLANTS for seed in startup_iae.SEEDS]
    with processes(workers, start.preset) as pool:
        waiting = [pool.submit(startup_iae.compare, name, seed, start.longest_s) for name, seed in jobs]
        rows = [future.result() for future in waiting]
    print("Integral of the absolute error over the least at equal Ms, after steps of setpoints and loads:\n")
    print(table.markdown(startup_iae.HEADER, rows))
    return 0 if startup_iae.worst(rows) <= startup_iae.ASKED else 1


def keep_engineers(rows: list[Row]) -> None:
    """They depend on no firmware: a campaign that has them need not find them again."""
    with KEPT_ENGINEER.open("w", encoding="utf-8", newline="") as out:
        writer = csv.DictWriter(out, ENGINEER_FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def check(start: Startup) -> int:
    """The fixed sample: what must always hold of it."""
    rows = [run_one(job, 1, start.longest_s) for job in start.checked]
    for row in rows:
        print(f"{row['plant']} seed {row['seed']} noise {row['noise']}: {row['outcome']} {row['reason']} "
              f"{'' if not row['ms'] else 'Ms ' + row['ms']}".rstrip())
    bad = [*startup_table.harmful(rows), *(f"{row['plant']} came to no end: {row['reason']}" for row in rows if row["outcome"] == "no end")]
    for words in bad:
        print(f"FAILED  {words}")
    return 1 if bad else 0


