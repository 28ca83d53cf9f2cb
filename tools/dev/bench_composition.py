"""Cost of the estimator `composition` and of a dense Kalman filter of the same model: the part of tools/bench about them.

tests/bench/estimation has the columns: in two images for the emulated STM32F405, of 40 stages at most as the product and of 100,
and in a program for the host that callgrind counts.
"""

from __future__ import annotations

from typing import Callable

import numpy

from dev import bench_estimation
from reflux import build
from dev.bench_estimation import Lines
from reflux.errors import RunFailed, UserError
from reflux.paths import build_dir

PRESET = "stm32f405"
IMAGES = (("columns-cost-40", 40), ("columns-cost-100", 100))
MEGAHERTZ = 168.0
HOST = "estimation_cost"
STEPS = (20, 70)  # two runs, so that the start does not count
STAGES = (12, 37, 100)
DENSE_STAGES = 37

METHODS = {
    "geometric": "geometric",
    "rekf": "reduced EKF",
    "geometric-truncated": "geometric, 11 stages truncated",
    "rekf-truncated": "reduced EKF, 11 stages truncated",
    "geometric-mean": "geometric, 11 stages truncated, at the mean temperature of their ends",
}
UNSTABLE = "dense-euler"
FORMS = {
    UNSTABLE: "J P + P J', band, one step of Euler's of 0.3 s: no sample",
    "dense-steps": "J P + P J', band, a sample of 30 s in as many steps of Euler's as are stable",
    "dense-band": "F P F', F = (I - h J)^-1 by the factors of a band",
    "dense-transition": "F P F', F as a matrix",
}
STEP_TITLE = (
    "Instructions of a step of the estimator `composition`, STM32F405 in the emulator; 3 components, 4 temperatures, float, inputs moving by up to 1 % a step; "
    f"ms at one instruction a cycle of {MEGAHERTZ:.0f} MHz"
)
STEP_HEADER = [
    "method",
    "stages",
    "stages the build holds",
    "mean",
    "most",
    "the very first",
    "ms: mean",
    "ms: first",
    "bytes of state",
    "bytes of stack",
]
LINE_TITLE = "Instructions of a step of `composition` by the number of stages: straight line through 12, 37 and 100"
LINE_HEADER = ["where", "method", "12", "37", "100", "a stage", "and besides", "largest deviation"]
DENSE_TITLE = "Instructions of a sample of a dense EKF of the same column, 37 stages, 74 states, 4 temperatures, beside `composition` (reduced EKF)"
DENSE_HEADER = [
    "covariance carried by",
    "emulator: mean",
    "most",
    "ms of the mean",
    "times `composition`",
    "bytes of state",
    "bytes of stack",
    "host: mean",
    "times `composition`, host",
]

Counted = Callable[[str, list[str]], int]
Parts = list[tuple[str, list[str], list[list[str]]]]


def parts(counted: Counted) -> Parts:
    """Titles, headers and rows. counted(function, command) counts the instructions of a function and what it calls."""
    try:
        lines = {most: bench_estimation.counted(PRESET, image) for image, most in IMAGES}
        build.build("host", (HOST,))
        host = {
            (what, n): host_step(counted, what, n)
            for n in STAGES
            for what in ("geometric", "rekf", *FORMS)
            if what not in FORMS or n == DENSE_STAGES
        }
    except (RunFailed, UserError) as error:
        return [(STEP_TITLE, STEP_HEADER, [[f"not measured: {error}", *[""] * (len(STEP_HEADER) - 1)]])]
    return [
        (STEP_TITLE, STEP_HEADER, step_rows(lines)),
        (LINE_TITLE, LINE_HEADER, line_rows(lines[100], host)),
        (DENSE_TITLE, DENSE_HEADER, dense_rows(lines[40], host)),
    ]


def host_step(counted: Counted, what: str, stages: int) -> int:
    """The mean of a step on the host."""
    program = str(build_dir("host") / HOST)
    few, many = (counted("measured", [program, what, str(stages), str(steps)]) for steps in STEPS)
    return round((many - few) / (STEPS[1] - STEPS[0]))


def milliseconds(instructions: int) -> str:
    return f"{instructions / MEGAHERTZ / 1000:.2f}"


def step_rows(lines: dict[int, Lines]) -> list[list[str]]:
    """A line of a step is followed by those of its first one and of its stack. Of the larger image, what the other has not."""
    there = [(at_most, k) for at_most, found in lines.items() for k, line in enumerate(found) if line[0] in METHODS]
    out = []
    for at_most, k in there:
        what, n, mean, most, size = lines[at_most][k]
        if any(size_of < at_most and lines[size_of][other][:2] == (what, n) for size_of, other in there):
            continue
        first, stack = lines[at_most][k + 1][2], lines[at_most][k + 2][2]
        counts = [f"{mean:,}", f"{most:,}", f"{first:,}", milliseconds(mean), milliseconds(first)]
        out.append([METHODS[what], n, str(at_most), *counts, f"{size:,}", f"{stack:,}"])
    return out


def line_rows(lines: Lines, host: dict[tuple[str, int], int]) -> list[list[str]]:
    board = {(what, int(n)): mean for what, n, mean, _, _ in lines}
    out = []
    for where, found in ((f"{PRESET.upper()} in the emulator", board), ("host, x86-64", host)):
        for what in ("geometric", "rekf"):
            counts = [found[what, n] for n in STAGES]
            slope, rest = numpy.polyfit(STAGES, counts, 1)
            off = max(abs(slope * n + rest - count) / count for n, count in zip(STAGES, counts))
            out.append(
                [
                    where,
                    METHODS[what],
                    *[f"{c:,}" for c in counts],
                    f"{slope:,.0f}",
                    f"{rest:,.0f}",
                    f"{100 * off:.2f} %",
                ]
            )
    return out


def dense_rows(lines: Lines, host: dict[tuple[str, int], int]) -> list[list[str]]:
    own = next(mean for what, n, mean, _, _ in lines if what == "rekf" and n == str(DENSE_STAGES))
    steps = next(mean for what, _, mean, _, _ in lines if what == "steps")
    out = []
    for k, (what, _, mean, most, size) in enumerate(lines):
        if what not in FORMS:
            continue
        there = host[what, DENSE_STAGES]
        words = FORMS[what] + (f": {steps}" if what == "dense-steps" else "")
        times = [f"{mean / own:.1f}", f"{there / host['rekf', DENSE_STAGES]:.1f}"]
        out.append(
            [
                words,
                f"{mean:,}",
                f"{most:,}",
                milliseconds(mean),
                times[0],
                f"{size:,}",
                f"{lines[k + 1][2]:,}",
                f"{there:,}",
                times[1],
            ]
        )
    return out
