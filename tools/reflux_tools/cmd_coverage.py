"""tools/coverage: which lines and branches of firmware/ the unit and loop tests reach."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
from collections import defaultdict
from pathlib import Path

from reflux_tools import build, table
from reflux_tools.errors import RunFailed
from reflux_tools.paths import ROOT, build_dir, out_root, shown

AIM_LINES, AIM_BRANCHES = 95.0, 90.0


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/coverage",
        description="Builds with gcc --coverage, runs all unit and loop tests in C, and prints the lines and branches "
        f"of firmware/ they reach, by layer. Exit status 1 below {AIM_LINES:g} % of lines or {AIM_BRANCHES:g} % of "
        "branches. The report with every line goes to out/coverage/index.html.")
    p.add_argument("-j", "--jobs", type=int, default=max(2, os.cpu_count() or 2), metavar="N")
    p.add_argument("--files", action="store_true", help="also each file")
    options = p.parse_args(arguments)
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
