"""tools/coverage: which lines and branches of firmware/ the unit and loop tests reach."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
from collections import defaultdict
from pathlib import Path

from reflux import build, packages, table
from reflux.errors import RunFailed, UserError
from reflux.paths import ROOT, out_root, shown
from dev.testing import reach, reach_measure

AIM_LINES, AIM_BRANCHES = 95.0, 90.0
LACKING_MOST = 0.005  # A busy machine can send a test another way: a few sources are reached in some runs only.


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/coverage",
        description="Builds with gcc --coverage, runs all unit and loop tests in C, and prints the lines and branches "
        f"of firmware/ they reach, by layer. Exit status 1 below {AIM_LINES:g} % of lines or {AIM_BRANCHES:g} % of "
        "branches. The report with every line goes to out/coverage/index.html.")
    p.add_argument("-j", "--jobs", type=int, default=max(2, os.cpu_count() or 2), metavar="N")
    p.add_argument("--files", action="store_true", help="list each file as well")
    p.add_argument("--reach", action="store_true",
                   help="instead: run every test of the default tier once and write the sources that it runs to tests/reach.txt")
    p.add_argument("--check", action="store_true", help="with --reach: write nothing; exit status 1 where the file lacks more than half a percent")
    options = p.parse_args(arguments)
    if options.check and not options.reach:
        raise UserError("--check goes with --reach")
    packages.need("host", *(() if options.reach else ("coverage",)))  # gcov comes with gcc
    if options.reach:
        return measure_reach(options.jobs, options.check)
    folder = build.build("coverage")
    for old in folder.rglob("*.gcda"):
        old.unlink()
    run_tests(folder, options.jobs)
    summary = report(folder)
    layers: dict[str, list[dict[str, int]]] = defaultdict(list)
    for entry in summary["files"]:
        layers[layer_of(entry["filename"])].append(entry)
    rows = [row(layer, entries) for layer, entries in sorted(layers.items())]
    print(table.columns(["layer", "lines", "of", "%", "branches", "of", "%"],
                        [*rows, row("firmware", summary["files"])]))
    if options.files:
        print()
        print(table.columns(["file", "lines", "of", "%", "branches", "of", "%"],
                            [row(entry["filename"], [entry]) for entry in summary["files"]]))
    lines, branches = share(summary["files"], "line"), share(summary["files"], "branch")
    print(f"\ncoverage: lines {lines:.1f} % (aim {AIM_LINES:g}), branches {branches:.1f} % (aim {AIM_BRANCHES:g}); "
          f"{shown(out_root() / 'coverage' / 'index.html')}")
    return 0 if lines >= AIM_LINES and branches >= AIM_BRANCHES else 1


def measure_reach(jobs: int, check: bool) -> int:
    """tests/reach.txt, made anew or checked. A source too many in it only makes tools/test --changed run more."""
    reached = reach_measure.measure(jobs)
    if not check:
        reach.store(reached)
        print(f"{shown(reach.TABLE)}: {len(reached)} tests, {len(set().union(*reached.values()))} sources")
        return 0
    known = reach.load()
    lacking = {name: sorted(sources - known.get(name, frozenset())) for name, sources in sorted(reached.items())}
    lacking = {name: sources for name, sources in lacking.items() if sources}
    for name, sources in lacking.items():
        print(f"{name} runs {', '.join(sources[:5])}{' ...' if len(sources) > 5 else ''}")
    share = sum(map(len, lacking.values())) / sum(map(len, reached.values()))
    print(f"{shown(reach.TABLE)} lacks {100 * share:.2f} % of what tests run, in {len(lacking)} tests; up to {100 * LACKING_MOST:g} % is "
          "allowed. tools/coverage --reach writes it anew")
    return 1 if share > LACKING_MOST else 0


def layer_of(name: str) -> str:
    """firmware/LAYER/FILE; headers are seen through build/coverage/layers/LAYER/LAYER/FILE."""
    return Path(name).parent.name


def run_tests(folder: Path, jobs: int) -> None:
    command = ["ctest", "--test-dir", str(folder), "-L", "unit|loop", "-j", str(jobs), "--output-on-failure"]
    progress = build.Progress("running the tests")
    answer = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if answer.returncode != 0:
        progress.end("failed")
        print(answer.stdout[-4000:])
        raise RunFailed("tests failed, so there is no coverage to report; the last of their output is above")
    progress.end("all passed")


def report(folder: Path) -> dict:
    out = out_root() / "coverage"
    out.mkdir(parents=True, exist_ok=True)
    # --gcov-ignore-parse-errors is not given: what gcovr cannot read is an error.
    command = ["gcovr", "--root", str(ROOT), "--filter", "firmware/", "--object-directory", str(folder),
               "--html-details", str(out / "index.html"), "--json-summary", str(out / "summary.json"), str(folder)]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        raise RunFailed(f"gcovr: {answer.stderr.strip().splitlines()[-1]}")
    return json.loads((out / "summary.json").read_text(encoding="utf-8"))


def share(entries: list[dict[str, int]], what: str) -> float:
    total = sum(entry[f"{what}_total"] for entry in entries)
    return 100.0 * sum(entry[f"{what}_covered"] for entry in entries) / total if total else 100.0


def row(name: str, entries: list[dict[str, int]]) -> list[str]:
    out = [name]
    for what in ("line", "branch"):
        out += [str(sum(e[f"{what}_covered"] for e in entries)), str(sum(e[f"{what}_total"] for e in entries)),
                f"{share(entries, what):.1f}"]
    return out
