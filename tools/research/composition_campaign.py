"""The campaign of estimated compositions: the program of tests/campaign/composition on columns of its own, and the table of what it prints."""

from __future__ import annotations

import argparse
import csv
import io
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from reflux import build, table
from reflux.errors import RunFailed
from reflux.paths import CAMPAIGNS, shown
from reflux.schema import Table

PROGRAM, SIMULATOR, PRESET = "composition_campaign", "reflux-sim", "host"
COLUMNS = CAMPAIGNS / "composition" / "columns"
APART = ("efficiency 80 %", "+2 K on the first")
GOOD_CASES = ("rest", "changes of the feed", "changes of the feed, metered")
WRONG_MOST, GOOD_LEAST, RATIO_MOST = 0.005, 0.9, 3.0
HEADER = ["case", "good, %: least", "mean", "wrong, %: most", "mean", "largest error called good, part of the impurity", "IAE of the estimate's loop over the temperature's: most", "mean"]
NOTES = """A `composition` block with `method ekf` and nothing else set but inputs, places and points, in ticks of 10 s; four thermometers, two in each section;
a PI holds the lowest by the heat. From 12 h on the column differs from what the block is told, in one way for each line; *changes of the feed* are a new
composition (+-0.05) and flow (+-10 %) every 8 h. Thermometers have 0.05 K of noise and a lag of 5 s where nothing else is said.

*Good* is the part of the time from 3 h on in which a product is called good, *wrong* that in which it is called good and is off by more than three of its standard
deviations or half the true impurity: of both products of all columns, the worst of them and the mean. *IAE* is that of the bottoms' impurity in a second run, in which a slow
loop on its estimate moves the setpoint of the temperature and gives it back after 60 s of an estimate that is not good, over that with the temperature alone."""


@dataclass(frozen=True)
class Composition:
    name: str
    title: str
    hours: int
    sets: dict[str, tuple[str, ...]]


def load(top: Table, name: str) -> Composition:
    sets = {key: tuple(str(x) for x in top.list(key)) for key in ("chosen", "confirmed")}
    campaign = Composition(name, top.text("title", name), top.integer("hours", low=15, high=10000), sets)
    top.done()
    return campaign


def execute(campaign: Composition, options: argparse.Namespace) -> int:
    if not options.no_build:
        build.build(PRESET, (PROGRAM, SIMULATOR))
    hours = max(15, round(campaign.hours * options.fraction))
    names = [n for of in campaign.sets.values() for n in of][:: max(1, round(1 / options.fraction))]
    with ThreadPoolExecutor(options.jobs) as pool:
        results = dict(zip(names, pool.map(lambda n: run(n, hours), names)))
    text = [f"# {campaign.title}\n", f"Written by `tools/campaign {campaign.name}`: {hours} h of each case.\n", NOTES + "\n"]
    missed = []
    for title, every in campaign.sets.items():
        of = [n for n in every if n in results]
        if not of:
            continue
        lines = lines_of([results[n] for n in of])
        heading = f"Columns on which the defaults were {title}: {', '.join(of)}"
        print(f"\n{heading}\n{table.columns(HEADER, lines)}")
        text += [f"## {heading}\n", table.markdown(HEADER, lines) + "\n"]
        missed += [f"{n}, {row['case']}: {why}" for n in of for row in results[n] for why in reasons(row)]
    share = [x for rows in results.values() for row in rows if row["case"] not in APART for x in wrong(row)]
    total = f"Of all cases but the last two {100 * sum(share) / len(share):.3f} % of the time is called good and wrong."
    text += [total + "\n", "Not reached in single cases: " + ("; ".join(missed) or "none") + ".\n"]
    if not options.check and options.fraction == 1.0:
        place = options.results / f"{campaign.name}.md"
        place.write_text("\n".join(text), encoding="utf-8")
        print(f"\n{shown(place)}")
    print(total)
    for m in missed:
        print(f"NOT REACHED  {m}")
    return 1 if missed else 0


def wrong(row: dict[str, str]) -> list[float]:
    return [float(row[f"wrong_{end}"]) for end in ("top", "bottom")]


def good(row: dict[str, str]) -> list[float]:
    return [float(row[f"good_{end}"]) for end in ("top", "bottom")]


def ratio(row: dict[str, str]) -> float:
    return float(row["iae_estimate"]) / float(row["iae_temperature"])


def reasons(row: dict[str, str]) -> list[str]:
    if row["case"] in APART:
        return []
    out = [f"{100 * max(wrong(row)):.1f} % wrong"] if max(wrong(row)) > WRONG_MOST else []
    if row["case"] in GOOD_CASES and min(good(row)) < GOOD_LEAST:
        out.append(f"{100 * min(good(row)):.0f} % good")
    return [*out, f"IAE {ratio(row):.1f} times the temperature's"] if ratio(row) > RATIO_MOST else out


def lines_of(columns: list[list[dict[str, str]]]) -> list[list[str]]:
    out = []
    for rows in zip(*columns):
        goods, wrongs, ratios = [x for r in rows for x in good(r)], [x for r in rows for x in wrong(r)], [ratio(r) for r in rows]
        out.append([rows[0]["case"], f"{100 * min(goods):.0f}", f"{100 * sum(goods) / len(goods):.0f}", f"{100 * max(wrongs):.2f}", f"{100 * sum(wrongs) / len(wrongs):.3f}",
                    f"{max(float(r['worst']) for r in rows):.2f}", f"{max(ratios):.2f}", f"{sum(ratios) / len(ratios):.2f}"])
    return out


def run(name: str, hours: int) -> list[dict[str, str]]:
    made = answer_of([build.find_program(PRESET, SIMULATOR), "--table", "--plant", COLUMNS / f"{name}.json"], (0,))
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        place = Path(folder) / "table.txt"
        place.write_text(made, encoding="utf-8")
        rows = answer_of([build.find_program(PRESET, f"tests/unit/{PROGRAM}"), place, hours], (0, 1))
    return list(csv.DictReader(io.StringIO(rows)))


def answer_of(command: list[object], allowed: tuple[int, ...]) -> str:
    answer = subprocess.run([str(x) for x in command], capture_output=True, text=True, check=False)
    if answer.returncode not in allowed:
        raise RunFailed(f"{command[0]} ended with {answer.returncode}: {answer.stderr.strip()}")
    return answer.stdout
