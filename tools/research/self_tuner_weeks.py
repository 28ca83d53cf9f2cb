"""The campaign of weeks under a self-tuner: the program of tests/campaign/self_tuner in both number formats, and tables of what it prints."""

from __future__ import annotations

import argparse
import csv
import io
import statistics
import subprocess
from dataclasses import dataclass

from reflux import build, table
from reflux.errors import RunFailed
from reflux.paths import shown
from reflux.schema import Table

PROGRAM = "self_tuner"
FORMATS = (("float32", "host"), ("Q7.24", "host-fixed"))
BEYOND_MOST, WORSE, WORSE_SHARE, MEDIAN = 4, 1.3, 0.03, 0.8  # windows; IAE ratios
MEDIAN_OF = "grid"  # the set for which MEDIAN is wanted
SETS = {
    "grid": "lags 120 and {0, 30, 60, 120} s, dead time {0, 15, 30, 60} s, right-half-plane zero {none, 30, 60} s, steps {10, 20, 30} s, noise 0.05 %",
    "noisy": "the same plants, noise 0.2 %",
    "choose": "150 drawn plants, lags 60 to 600 s, noise 0.05 to 0.5 %, half of them with loads",
    "confirm": "150 others, lags 300 to 3000 s",
    "pairs": "Wood and Berry's column and 19 drawn pairs, setpoint moves of 5 %, noise 0.05 to 0.4 %",
    "named": "cases that once cycled or drifted, named below",
}
NOTES = """Noise and moves are % of span. Setpoints move by 5 to 10 % one after the other on the first day and in the last quarter of a day, and
every six hours between; in sets with *-rest* not at all between. The PI has SIMC settings with tau_c = theta (half rule, half a step
as dead time), on a plant of its own with the same noise. `delay` is one step more than the dead time, the zero's time constant and
half of the second lag together, in whole steps, rounded up; plants for which that is more than eight are left out. Ratios are IAE of the PVs themselves to the PI's; *measured* is with noise;
never adopted counts as 1. *First* and *last* are the last quarters of the first day and of the week, at the median.
*Beyond* are runs that were beyond the limits of the PI's record for longer than four windows of 64 steps; *drift* those whose g0
changed by more than 30 % at rest without a return to the PI."""
HEADER = ["set", "runs", "adopted", "given up", "median", "measured", "above 1.3", "measured above 1.3", "worst", "first", "last", "beyond", "drift"]


@dataclass(frozen=True)
class Weeks:
    name: str
    title: str
    seed: int
    sets: tuple[str, ...]


def load(top: Table, name: str) -> Weeks:
    campaign = Weeks(name, top.text("title", name), top.integer("seed", low=0, high=2**32), tuple(top.list("sets")))
    top.done()
    return campaign


def execute(campaign: Weeks, options: argparse.Namespace) -> int:
    text = [f"# {campaign.title}\n", f"Written by `tools/campaign {campaign.name}`: seed {campaign.seed}.\n", NOTES + "\n"]
    text += ["\n".join(f"- *{name}*: {what}." for name, what in SETS.items()) + "\n"]
    missed: list[str] = []
    stride = max(1, round(1 / options.fraction))
    for name, preset in FORMATS:
        if not options.no_build:
            build.build(preset, (PROGRAM,))
        progress = build.Progress(f"weeks, {name}")
        runs = {s: weeks(preset, s, campaign.seed, stride) for s in campaign.sets}
        progress.end("done")
        lines = [summary(s, rows) for s, rows in runs.items()]
        print(f"\n{name}\n{table.columns(HEADER, lines)}")
        text += [f"## {name}\n", table.markdown(HEADER, lines) + "\n"]
        for s in ("named", "named-rest", "pairs-rest"):
            if s in runs:
                text += [f"### {s}, {name}\n", table.markdown(*single(runs[s])) + "\n"]
        missed += [f"{name}, {s}: {miss}" for s, rows in runs.items() for miss in misses(s, rows)]
    text += ["## Not reached\n", "\n".join(f"- {m}" for m in missed) + "\n" if missed else "Nothing.\n"]
    for miss in missed:
        print(f"NOT REACHED  {miss}")
    if not options.check and options.fraction == 1.0:
        place = options.results / f"{campaign.name}.md"
        place.write_text("\n".join(text), encoding="utf-8")
        print(f"\n{shown(place)}")
    return 1 if any("beyond" in m for m in missed) else 0


def weeks(preset: str, which: str, seed: int, stride: int) -> list[dict[str, str]]:
    program = build.find_program(preset, f"tests/unit/{PROGRAM}")
    answer = subprocess.run([str(program), which, str(seed), "0", str(stride)], capture_output=True, text=True, check=False)
    if answer.returncode:
        raise RunFailed(f"{PROGRAM} {which} ended with {answer.returncode}: {answer.stderr.strip()}")
    return list(csv.DictReader(io.StringIO(answer.stdout)))


def adopted(row: dict[str, str]) -> bool:
    return float(row["adopted_s"]) > 0


def ratios(rows: list[dict[str, str]], which: str) -> list[float]:
    return sorted(float(r[which]) if adopted(r) else 1.0 for r in rows)


def drifts(row: dict[str, str]) -> bool:
    begun = float(row["g0_begun"])
    return begun != 0 and row["returns"] == "0" and abs(float(row["g0_rest"]) / begun - 1) > 0.3


def summary(name: str, rows: list[dict[str, str]]) -> list[str]:
    ratio, measured = ratios(rows, "ratio"), ratios(rows, "measured")
    beyond = sum(int(r["beyond"]) > BEYOND_MOST for r in rows)
    drift = str(sum(map(drifts, rows))) if name.endswith("-rest") else "-"
    return [name, str(len(rows)), str(sum(map(adopted, rows))), str(sum(float(r["ended_s"]) > 0 for r in rows)),
            f"{statistics.median(ratio):.2f}", f"{statistics.median(measured):.2f}", str(sum(x > WORSE for x in ratio)),
            str(sum(x > WORSE for x in measured)), f"{ratio[-1]:.2f}", f"{statistics.median(ratios(rows, 'first')):.2f}",
            f"{statistics.median(ratios(rows, 'last')):.2f}", str(beyond), drift]


def single(rows: list[dict[str, str]]) -> tuple[list[str], list[list[str]]]:
    header = ["case", "adopted after, h", "ratio", "first", "last", "g0 after a day", "g0 before the last moves", "returns to the PI", "given up after, h"]
    return header, [[r["case"], hours(r["adopted_s"]), f"{float(r['ratio']):.2f}", f"{float(r['first']):.2f}", f"{float(r['last']):.2f}",
                     r["g0_begun"], r["g0_rest"], r["returns"], hours(r["ended_s"])] for r in rows]


def hours(seconds: str) -> str:
    return f"{float(seconds) / 3600:.1f}" if float(seconds) else "-"


def misses(name: str, rows: list[dict[str, str]]) -> list[str]:
    ratio = ratios(rows, "ratio")
    worse, beyond = sum(x > WORSE for x in ratio), sum(int(r["beyond"]) > BEYOND_MOST for r in rows)
    found = []
    if beyond:
        found.append(f"{beyond} runs beyond the record of the PI for longer than four windows")
    if name.endswith("-rest"):
        drift = sum(map(drifts, rows))
        return found + ([f"g0 of {drift} of {len(rows)} drifted"] if drift else [])
    if worse > WORSE_SHARE * len(rows):
        found.append(f"{worse} of {len(rows)} above {WORSE}, {WORSE_SHARE:.0%} allowed")
    if name == MEDIAN_OF and statistics.median(ratio) > MEDIAN:
        found.append(f"median {statistics.median(ratio):.2f}, {MEDIAN} wanted")
    return found
