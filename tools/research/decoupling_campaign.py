"""The campaign `decoupling`: ways to decouple loops beside none, on linear plants with and without noise, with wrong gains, and with an input
held back."""

from __future__ import annotations

import argparse
import csv
import hashlib
import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from reflux import build, libreflux, table
from research import decoupling_plants, decoupling_runs, decoupling_tuning, trays_campaign
from research.decoupling_plants import ERRORS
from research.decoupling_runs import METHODS, PLACED, Case
from reflux.errors import RunFailed, UserError
from reflux.paths import build_dir
from reflux.schema import Table

COLUMNS = ("free", "noisy", "wrong", "clipped")
HEADER = ["method", "design", "own", "cross", "noise: own", "cross", "wrong gains: own", "cross", "input held back: cross", "rests off by"]
# A loop that ends a step and more from its setpoint is lost: unstable, or its setpoint is out of reach of the inputs.
LOST = 1.0


@dataclass(frozen=True)
class Comparison:
    name: str
    title: str
    about: str
    plants: tuple[str, ...]
    seeds: tuple[int, ...]

    def methods(self, plant: str) -> tuple[str, ...]:
        return (*METHODS, PLACED) if plant == "kotyk-column" else METHODS

    def cases(self) -> list[Case]:
        out = []
        for plant in self.plants:
            for method in self.methods(plant):
                base = Case(plant, method)
                out += [base, replace(base, clipped=True), *(replace(base, error=e) for e in ERRORS), *(replace(base, noise=1.0, seed=s) for s in self.seeds)]
        return out


def load(top: Table, name: str) -> Comparison:
    first = top.integer("first_seed", 1)
    out = Comparison(name, top.text("title", name), " ".join(top.texts("about")), tuple(top.texts("plants")),
                     tuple(range(first, first + top.integer("seeds", low=1, high=1000))))
    top.done()
    for plant in out.plants:
        decoupling_plants.named(plant)
    return out


def job_of(case: Case) -> dict[str, Any]:
    return {key: int(value) if isinstance(value, bool) else value for key, value in asdict(case).items()}


def fingerprint(campaign: Comparison) -> str:
    digest = hashlib.sha256()
    files = [Path(module.__file__) for module in (decoupling_plants, decoupling_runs, decoupling_tuning)]
    files += [build.find_program("host", "reflux-sim-memory"), build.find_program("host", "reflux-sim"), build_dir("host") / "libreflux.so"]
    files += [decoupling_plants.named(plant).path() for plant in campaign.plants]
    for file in files:
        digest.update(file.read_bytes())
    return digest.hexdigest()


def run_one(case: Case) -> dict[str, Any]:
    """In a process of its own. A design that is refused, or settings that the board refuses, are a result too."""
    try:
        bench = decoupling_plants.named(case.plant)
        made = decoupling_runs.design(bench, case.method)
        return {"job": job_of(case), "about": made.about, **asdict(decoupling_runs.measure(case, made))}
    except (RunFailed, UserError, libreflux.Refused) as error:
        return {"job": job_of(case), "failed": str(error)}


# ---- tables ----


def found_of(campaign: Comparison, state: Any, plant: str, method: str) -> dict[str, Any]:
    """Own and cross of every column; the worst of wrong gains, the mean of the seeds."""
    base = Case(plant, method)
    free = state.get(job_of(base))
    if free is None or "failed" in free:
        return {"failed": "not run" if free is None else free["failed"]}
    wrong = [state.get(job_of(replace(base, error=e))) for e in ERRORS]
    noisy = [state.get(job_of(replace(base, noise=1.0, seed=s))) for s in campaign.seeds]
    clipped = state.get(job_of(replace(base, clipped=True)))
    known = [r for r in (*wrong, *noisy, clipped) if r is None or "failed" in r]
    if known:
        return {"failed": "a run is missing" if known[0] is None else known[0]["failed"]}
    worst = max(wrong, key=lambda r: r["own"] + r["cross"])
    return {"about": free["about"], "free": (free["own"], free["cross"]), "wrong": (worst["own"], worst["cross"]), "lost": worst["rest"] > LOST,
            "noisy": (float(np.mean([r["own"] for r in noisy])), float(np.mean([r["cross"] for r in noisy]))),
            "clipped": (math.nan, clipped["cross"]), "rest": clipped["rest"]}


def figure(value: float, beside: float | None) -> str:
    """Bold where the loops alone do better."""
    text = f"{value:.3g}"
    return f"**{text}**" if beside is not None and value > 1.02 * beside else text


def rows_of(campaign: Comparison, state: Any, plant: str) -> list[list[str]]:
    alone = found_of(campaign, state, plant, "none")
    rows = []
    for method in campaign.methods(plant):
        found = found_of(campaign, state, plant, method)
        if "failed" in found:
            rows.append([method, f"refused: {found['failed']}", *["-"] * 8])
            continue
        row = [method, found["about"] or "-"]
        for column in COLUMNS:
            for k in (0, 1):
                value, beside = found[column][k], None if "failed" in alone or method == "none" else alone[column][k]
                if not math.isnan(value):
                    lost = (column == "wrong" and found["lost"]) or (column == "clipped" and found["rest"] > LOST)
                    row.append("**lost**" if lost else figure(value, beside))
        row.append("-" if found["rest"] < 0.005 or found["rest"] > LOST else f"{100 * found['rest']:.0f} %")
        rows.append(row)
    return rows


def heading(plant: str) -> str:
    bench = decoupling_plants.named(plant)
    k = decoupling_runs.gains(bench)
    relative = np.diag(k * np.linalg.inv(k).T)
    return (f"{plant}: {len(k)} x {len(k)}, relative gains {', '.join(f'{x:.2f}' for x in relative)}, condition {np.linalg.cond(k):.0f}; every {bench.period_s:g} s, "
            f"steps of {100 * decoupling_runs.step_of(bench):.2g} % of span")


def write_results(campaign: Comparison, state: Any, folder: Path) -> None:
    text = [f"# {campaign.title}\n\nWritten by `tools/campaign {campaign.name}`. {campaign.about}\n"]
    for plant in campaign.plants:
        text.append(f"\n## {heading(plant)}\n\n{table.markdown(HEADER, rows_of(campaign, state, plant))}\n")
    (folder / f"{campaign.name}.md").write_text("".join(text), encoding="utf-8")
    with (folder / f"{campaign.name}.csv").open("w", encoding="utf-8", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["plant", "method", *(f"{column}_{which}" for column in COLUMNS for which in ("own", "cross")), "lost"])
        for plant in campaign.plants:
            for method in campaign.methods(plant):
                found = found_of(campaign, state, plant, method)
                numbers = [""] * 9 if "failed" in found else [*(f"{x:.5g}" for column in COLUMNS for x in found[column]), str(int(found["lost"]))]
                writer.writerow([plant, method, *numbers])


def execute(campaign: Comparison, options: argparse.Namespace, state: Any) -> int:
    cases = campaign.cases()
    chosen = cases[:: max(1, round(1 / options.fraction))]
    trays_campaign.run_missing(chosen, state, options.jobs, job_of, run_one)
    if not options.check and options.fraction == 1.0:
        write_results(campaign, state, options.results)
        for plant in campaign.plants:
            print(f"\n{heading(plant)}\n{table.columns(HEADER, rows_of(campaign, state, plant))}")
    results = [state.get(job_of(c)) for c in chosen]
    # A loop tuned with its own gains and no limit has to come to rest.
    bad = [r for r in results if "failed" not in r and not r["job"]["error"] and not r["job"]["clipped"] and not r["job"]["noise"] and r["rest"] > 0.05]
    for r in bad[:10]:
        print(f"FAILED  {r['job']['plant']} {r['job']['method']}: rests {100 * r['rest']:.0f} % of a step beside a setpoint")
    print(f"\n{len(results)} runs, {sum('failed' in r for r in results)} refused, {len(bad)} failed")
    return 1 if bad else 0
