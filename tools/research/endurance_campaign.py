"""The campaign of endurance: a program of tests/campaign/endurance in both number formats, and the table of what it prints."""

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

PROGRAM = "endurance"
FORMATS = (("float32", "host"), ("Q7.24", "host-fixed"))
COURSES = {
    "rest": "After 600 samples with setpoint steps nothing moves that a converter of 12 bits would see, until the last thousand "
            "samples. One loop, y(t) = 0.9 y(t-1) + 0.2 u(t-1).",
    "stiff": "Setpoint steps of 10 % of span and a measured disturbance of 0.01 % side by side among the regressors, with a "
             "constant 1: six parameters. Positional form.",
    "noise": "The sensor's noise is 0.5 % of span. After 600 samples with setpoint steps no setpoint moves until the last thousand "
             "samples. The plant is that of rest.",
    "drift": "The gain goes from 1 to 4 times its size in 100,000 samples and back, with setpoint steps every 60 samples.",
}
NOTES = """Every estimator begins at parameters that are wrong by a half. The bare ones have lambda 0.2 g0 and P = 1, their
parameters are used as they come; forgetting 0.98 where it is constant. *Covariance form* is P = (P - K phi'P)/v as it is printed, in
the format of the build, every operation rounded to it. *Double, dense* is the same in double with one half of P kept, with
and without a bound on the trace. *Supervised* is the whole block with its defaults: the P of two steps that these include
follows a setpoint in several steps where the bare ones need one, which is most of its error.

*Failed at* is the sample at which first: a D or a variance was not positive, P passed 1e30, D had to be kept within 1e-12 to
1e12 (the last resort), a parameter passed 50, y left the span, or moves of the MV burst at rest to a hundred times their mean
square; for the supervised block also that g0 changed by
more than 30 % while only noise moved, that it gave up, that a PI acted for more than half of the time, or that it went back to
the PI more than a hundred times. *Error* is the mean of |setpoint - PV| over the last tenth, % of span."""


@dataclass(frozen=True)
class Endurance:
    name: str
    title: str
    samples: int
    seed: int


def load(top: Table, name: str) -> Endurance:
    campaign = Endurance(name, top.text("title", name), top.integer("samples", low=5000, high=10**9),
                         top.integer("seed", low=0, high=2**32))
    top.done()
    return campaign


def execute(campaign: Endurance, options: argparse.Namespace) -> int:
    samples = max(5000, round(campaign.samples * options.fraction))
    rows: list[dict[str, str]] = []
    for name, preset in FORMATS:
        if not options.no_build:
            build.build(preset, (PROGRAM,))
        rows += run(name, preset, samples, campaign.seed)
    text = [f"# {campaign.title}\n", f"Written by `tools/campaign {campaign.name}`: {samples:,} samples, seed {campaign.seed}.\n", NOTES + "\n"]
    for course, what in COURSES.items():
        header, lines = course_table(course, rows)
        print(f"\n{course}\n{table.columns(header, lines)}")
        text += [f"## {course}\n", what + "\n", table.markdown(header, lines) + "\n"]
    if not options.check and options.fraction == 1.0:
        place = options.results / f"{campaign.name}.md"
        place.write_text("\n".join(text), encoding="utf-8")
        print(f"\n{shown(place)}")
    missed = [r for r in rows if r["estimator"] == "supervised" and r["failed_at"] != "0"]
    for r in missed:
        print(f"NOT REACHED  {r['course']}, {r['format']}: the supervised block: {r['what']} at {r['failed_at']}")
    return 1 if missed else 0


def run(name: str, preset: str, samples: int, seed: int) -> list[dict[str, str]]:
    progress = build.Progress(f"endurance, {name}")
    program = build.find_program(preset, f"tests/unit/{PROGRAM}")
    answer = subprocess.run([str(program), str(samples), str(seed)], capture_output=True, text=True, check=False)
    if answer.returncode not in (0, 1):
        raise RunFailed(f"{PROGRAM} ended with {answer.returncode}: {answer.stderr.strip()}")
    progress.end("done")
    return list(csv.DictReader(io.StringIO(answer.stdout)))


def course_table(course: str, rows: list[dict[str, str]]) -> tuple[list[str], list[list[str]]]:
    header = ["estimator"]
    for name, _ in FORMATS:
        header += [f"{name}: failed at", "what", "error, %"]
    lines = []
    for estimator in dict.fromkeys(r["estimator"] for r in rows):
        line = [estimator]
        for name, _ in FORMATS:
            found = next(r for r in rows if (r["course"], r["estimator"], r["format"]) == (course, estimator, name))
            held = found["failed_at"] == "0"
            error = 100 * float(found["last_tenth_error"]) / (int(found["samples"]) / 10)
            line += ["-" if held else f"{int(found['failed_at']):,}", found["what"], f"{error:.4f}" if held else "-"]
        lines.append(line)
    return header, lines
