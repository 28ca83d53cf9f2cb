"""The campaign of a Kalman filter's covariance: the program endurance_kalman of tests/campaign/endurance, and the table of what it prints."""

from __future__ import annotations

import argparse
import csv
import io
import subprocess
from dataclasses import dataclass

from reflux import build, table
from reflux.errors import RunFailed
from reflux.paths import shown
from reflux.schema import Table

PROGRAM = "endurance_kalman"
PRESET = "host"
OURS = "UDU'"
COURSES = {
    "plain": "Thermometers with 0.2 K of noise, fractions known to 0.05 and extras to 0.1 to begin with, fractions gather 0.02 in an hour.",
    "stiff": "Thermometers with 0.001 K, fractions and extras known to 1 to begin with: their temperatures to a hundred kelvins.",
    "quiet": "As stiff, but nothing gathers any variance, ever, and extras are kept entirely.",
}
HEADER = ["states", "form", "variance below 0 at", "eigenvalue below 0 at", "no number at", "smallest eigenvalue or D",
          "error of sd: most", "last tenth", "error of gains: most", "last tenth"]
NOTES = """The splitter with 12 and with 37 stages, three components, steps of 30 s at four working points in turn; four extras: the feed's two
unknown fractions, its flow, the offset of an analysed place. Each of four thermometers is there three times out of four, an analysis every
20 steps; eight fractions at a time get their noise, going round. All forms are in single precision and have the same numbers: ours
(`firmware/kinds/composition/covariance_ud.h`), and P as a matrix with A P A' as two products and (I - K h) P or Joseph's form, each as printed and with
P = (P + P')/2 after every operation. Beside them one in double.

*At*: the update at which it happened first. Eigenvalues are looked at in the first 50 updates and in each hundredth (37 stages: tenth) of the
others; the smallest is over the sum of all variances, of U D U' it is the smallest D. Errors are those of the largest of all states: of standard
deviations relative to those in double, of gains relative to sd/sqrt(alpha), which no gain exceeds.

As to errors the matrices do as well under *plain*, and in the end better with 37 stages, where U D U' goes through more roundings: what they lose at once is
that P is positive, by as much as rounding is. Under *stiff* they are off by 0.5 to 3 % at first, Joseph's form no less than the printed one.
Without any variance gathered, ever, every form loses what a million updates add to it one rounding after the other; U D U' stays positive."""


@dataclass(frozen=True)
class Kalman:
    name: str
    title: str
    updates: int
    seed: int


def load(top: Table, name: str) -> Kalman:
    campaign = Kalman(name, top.text("title", name), top.integer("updates", low=10000, high=10**9), top.integer("seed", low=0, high=2**32))
    top.done()
    return campaign


def execute(campaign: Kalman, options: argparse.Namespace) -> int:
    updates = max(10000, round(campaign.updates * options.fraction))
    if not options.no_build:
        build.build(PRESET, (PROGRAM,))
    rows = run(updates, campaign.seed)
    text = [f"# {campaign.title}\n", f"Written by `tools/campaign {campaign.name}`: {updates:,} updates with 12 stages, a hundredth of it with 37, "
            f"seed {campaign.seed}.\n", NOTES + "\n"]
    for course, what in COURSES.items():
        lines = [line_of(r) for r in rows if r["course"] == course]
        print(f"\n{course}\n{table.columns(HEADER, lines)}")
        text += [f"## {course}\n", what + "\n", table.markdown(HEADER, lines) + "\n"]
    if not options.check and options.fraction == 1.0:
        place = options.results / f"{campaign.name}.md"
        place.write_text("\n".join(text), encoding="utf-8")
        print(f"\n{shown(place)}")
    missed = [r for r in rows if r["form"] == OURS and not held(r)]
    for r in missed:
        print(f"NOT REACHED  {r['course']}, {r['states']} states: {OURS} did not stay positive")
    return 1 if missed else 0


def held(row: dict[str, str]) -> bool:
    return all(row[key] == "0" for key in ("negative_at", "indefinite_at", "broke_at"))


def line_of(row: dict[str, str]) -> list[str]:
    at = ["-" if row[key] == "0" else f"{int(row[key]):,}" for key in ("negative_at", "indefinite_at", "broke_at")]
    gone = row["broke_at"] != "0"
    least = "above 0" if row["least"] == "0" else row["least"]
    errors = [row["sd_error"], row["sd_error_last"], row["gain_error"], row["gain_error_last"]]
    return [row["states"], row["form"], *at, least, *("-" if gone and k % 2 else e for k, e in enumerate(errors))]


def run(updates: int, seed: int) -> list[dict[str, str]]:
    progress = build.Progress("endurance of covariances")
    program = build.find_program(PRESET, f"tests/unit/{PROGRAM}")
    answer = subprocess.run([str(program), str(updates), str(seed)], capture_output=True, text=True, check=False)
    if answer.returncode not in (0, 1):
        raise RunFailed(f"{PROGRAM} ended with {answer.returncode}: {answer.stderr.strip()}")
    progress.end("done")
    return list(csv.DictReader(io.StringIO(answer.stdout)))
