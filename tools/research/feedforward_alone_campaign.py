"""The campaign of adaptive feedforward left alone: the program feedforward_tuner of tests/campaign in both number formats, and the tables of what
it prints."""

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

PROGRAM = "feedforward_tuner"
FORMATS = (("float32", "host"), ("Q7.24", "host-fixed"))
METHODS = "ABCD"
CHECK_S = 1200
NOTES = """Linear plants of eight classes with SIMC's PI, gains and times drawn by the seed, a base tick of 1 s, `check` 1200 s, `learn` 3000 s,
test signals of 5 % of span with method A and of 15 % with the others, the disturbance 5 % of span, noise of the PV 0.1 % of span. In the
class *noisy* it is 0.5 %, and the sensor of the disturbance has noise of 0.2 %. Everything beside the same loop under its PI alone, with the same noise.

On the seeds called *chosen* the rules were chosen, on those called *confirmed* they were not looked at before. *Adopted*: within 12 h."""
WEEKS = """The disturbance moves and rests by turns of eight hours. *Worst*: mean square over six hours over that under feedback alone, where the block did not move the plant
itself. *Off*: how often an element was switched off, though nothing had changed. *Signals*: hours of test signals after adoption; *at rest*: of these,
later than an hour after the disturbance has come to rest. In the class *noisy with dead band* the plants and the noise are those of *noisy*, and the element has a
dead band of four times the noise of its sensor. *Moving*: mean square over all such windows while the disturbance moves, over that under feedback alone, mean of the plants."""
CHANGES = """An hour after adoption. *Worse*: the longest time in a row, windows of 300 s, in which the loop is worse than under feedback alone while an element acts, in the
twelve hours behind it; of all plants the median and the worst, and how many passed `check`."""
STEPS = """The disturbance moves all the time. *At once*: adopted with this test signal. *By what it says*: adopted after following the event `weak` up to three times."""


@dataclass(frozen=True)
class Alone:
    name: str
    title: str
    seeds: dict[str, list[int]]


def load(top: Table, name: str) -> Alone:
    campaign = Alone(name, top.text("title", name), {key: [int(x) for x in top.list(key)] for key in ("chosen", "confirmed")})
    top.done()
    return campaign


def execute(campaign: Alone, options: argparse.Namespace) -> int:
    sections = [f"# {campaign.title}\n", f"Written by `tools/campaign {campaign.name}`.\n", NOTES + "\n"]
    short = options.fraction < 1
    missed = []
    for what, title, notes, rows in (("stays", "A week", WEEKS, weeks), ("change", "Changes", CHANGES, changes), ("steps", "The size of the test signal", STEPS, steps)):
        sections += [f"## {title}\n", notes + "\n"]
        for name, preset in FORMATS[:1] if what == "steps" or short else FORMATS:
            if not options.no_build:
                build.build(preset, (PROGRAM,))
            for which, seeds in campaign.seeds.items():
                found = [r for seed in (seeds[:1] if short else seeds) for r in run(what, preset, name, seed, 2 if short else 6)]
                header, lines, late = rows(found)
                missed += [f"{name}, {which}: {x}" for x in late]
                print(f"\n{title}, {name}, {which}\n{table.columns(header, lines)}")
                sections += [f"{name}, {which}, seeds {', '.join(f'{s} to {s + 5}' for s in seeds)}:\n", table.markdown(header, lines) + "\n"]
    sections += ["## What was asked for\n", *([f"- Not reached: {x}" for x in missed] or ["Everything asked for is reached."]), ""]
    if not options.check and not short:
        place = options.results / f"{campaign.name}.md"
        place.write_text("\n".join(sections), encoding="utf-8")
        print(f"\n{shown(place)}")
    for line in missed:
        print(f"NOT REACHED  {line}")
    return 1 if missed and not short else 0


def run(what: str, preset: str, name: str, seed: int, seeds: int) -> list[dict[str, str]]:
    progress = build.Progress(f"{what}, {name}, seeds from {seed}")
    program = build.find_program(preset, f"tests/unit/{PROGRAM}")
    answer = subprocess.run([str(program), what, str(seed), str(seeds)], capture_output=True, text=True, check=False)
    if answer.returncode not in (0, 1):
        raise RunFailed(f"{PROGRAM} ended with {answer.returncode}: {answer.stderr.strip()}")
    progress.end("done")
    return list(csv.DictReader(io.StringIO(answer.stdout)))


def plants(rows: list[dict[str, str]]) -> list[str]:
    return list(dict.fromkeys(r["plant"] for r in rows))


def weeks(rows: list[dict[str, str]]) -> tuple[list[str], list[list[str]], list[str]]:
    lines, missed = [], []
    for plant in plants(rows):
        of = [r for r in rows if r["plant"] == plant]
        there = [r for r in of if r["adopted"] == "1"]
        worst = max((float(r["worst"]) for r in there), default=0.0)
        rest = sum(float(r["signals_at_rest_h"]) for r in there)
        moving = statistics.mean(float(r["moving"]) for r in there) if there else 1.0
        lines.append([plant, f"{len(there)} of {len(of)}", f"{worst:.2f}", f"{moving:.3f}", str(sum(int(r["offs"]) for r in there)),
                      f"{sum(float(r['signals_h']) for r in there):.1f}", f"{rest:.2f}"])
        if worst > 1.1:
            missed.append(f"week, {plant}: {worst:.2f} times the squares, 1.1 asked for")
        if rest > 0:
            missed.append(f"week, {plant}: {rest:.2f} h of test signals at rest")
    return ["plant", "adopted", "worst", "moving", "off", "signals, h", "at rest, h"], lines, missed


def changes(rows: list[dict[str, str]]) -> tuple[list[str], list[list[str]], list[str]]:
    lines, missed = [], []
    for change in dict.fromkeys(r["change"] for r in rows):
        of = [r for r in rows if r["change"] == change]
        worse = [int(r["longest_s"]) for r in of]
        late = [r for r in of if int(r["longest_s"]) > CHECK_S]
        lines.append([change, str(len(of)), f"{statistics.median(worse):.0f}", str(max(worse)), str(len(late))])
        missed += [f"{change}, {r['plant']}, method {METHODS[int(r['method'])]}, seed {r['seed']}: worse for {r['longest_s']} s" for r in late]
    return ["change", "plants", "worse, s, median", "worst", f"above {CHECK_S}"], lines, missed


def steps(rows: list[dict[str, str]]) -> tuple[list[str], list[list[str]], list[str]]:
    """Rows of one try follow each other: the first has a step of the list, the others what it said."""
    tries: list[list[dict[str, str]]] = []
    for r in rows:
        follows = tries and tries[-1][-1]["adopted"] == "0" and r["step"] == f"{min(0.5, float(tries[-1][-1]['wanted'])):.4f}" and len(tries[-1]) < 4 \
            and all(r[k] == tries[-1][0][k] for k in ("plant", "method", "seed"))
        if follows:
            tries[-1].append(r)
        else:
            tries.append([r])
    lines = []
    for method, letter in enumerate(METHODS):
        for step in dict.fromkeys(t[0]["step"] for t in tries):
            of = [t for t in tries if t[0]["step"] == step and t[0]["method"] == str(method)]
            lines.append([letter, f"{100 * float(step):g} %", f"{sum(t[0]['adopted'] == '1' for t in of)} of {len(of)}", f"{sum(t[-1]['adopted'] == '1' for t in of)}"])
    return ["method", "test signal", "at once", "by what it says"], lines, []
