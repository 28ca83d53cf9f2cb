"""Cost of the Kalman filters of `composition`, and of other ways to carry their covariance: the part of tools/bench about them.

tests/bench/estimation has them: filters-cost, whole filters as the kind runs them, and covariances-cost, the covariance alone and
Thornton's, for the emulated STM32F405; and the program for the host that bench_composition counts with.
"""

from __future__ import annotations

import re
import subprocess
from typing import Callable

from dev import bench_estimation
from reflux import build
from dev.bench_composition import DENSE_STAGES, HOST, IMAGES, MEGAHERTZ, PRESET, STAGES, host_step, milliseconds
from dev.bench_estimation import Lines
from reflux.errors import RunFailed, UserError
from reflux.paths import build_dir

FILTERS = "filters-cost"
COVARIANCES = "covariances-cost"
CONFIG = re.compile(r"(ekf|kalman)-(full|band)-(\d)$")
ROUND = {12: 74, 37: 74, 100: 75}  # ticks in which noise has gone round a whole number of times
FIRST = 20
ON_HOST = ("ekf-full-2", "ekf-band-2", "kalman-full-2")
ON_HOST_MORE = ("ekf-full-0", "ekf-band-0", "ekf-full-3", "ekf-band-3")  # with 37 stages alone
PHASES = ("model", "factors", "feed", "carry", "sensors", "analyses", "points")

WHOLE_TITLE = (
    "Instructions of Kalman filters of `composition`: tick and job; 3 components, 4 temperatures, float, extras of the feed: 2 its composition, "
    f"3 with its flow; ms of both at one instruction a cycle of {MEGAHERTZ:.0f} MHz"
)
WHOLE_HEADER = [
    "where",
    "method",
    "covariance",
    "stages",
    "extras",
    "tick: mean",
    "most",
    "times that of the reduced EKF",
    "job: mean",
    "most",
    "its largest piece",
    "ms: tick",
    "ms: both, most",
    "bytes of state",
    "bytes of workspace",
    "bytes of stack: tick, job",
]
BOARD = "STM32F405 in the emulator"
X86 = "host"
NO_ROOM = "host alone: no room on the board"
PHASES_TITLE = f"What the job of such a filter is about, {DENSE_STAGES} stages, STM32F405 in the emulator, instructions: mean"
PHASES_HEADER = ["method", "covariance", "extras", "model", "factors of the transition", "feed", "carrying", "temperatures", "analyses", "points"]
BESIDE_TITLE = (
    f"Kalman filters beside dense ones, {DENSE_STAGES} stages, 74 mole fractions, 4 temperatures, STM32F405 in the emulator, instructions a sample: "
    "the whole filter (tick and job), and the covariance alone (factors, feed, carrying, temperatures)"
)
BESIDE_HEADER = [
    "covariance",
    "extras",
    "whole filter",
    "covariance alone",
    "whole: times fewer than F P F' with F as a matrix",
    "than by the factors of a band",
    "covariance: times fewer than F P F' with F as a matrix",
    "than by the factors of a band",
]
ALONE_TITLE = "Instructions of a Kalman filter's covariance alone, 3 components, 3 extras, 4 temperatures, STM32F405 in the emulator"
ALONE_HEADER = [
    "form",
    "stages",
    "a step: mean",
    "most",
    "largest piece",
    "4 temperatures",
    "step and temperatures: times fewer than Thornton's",
    "bytes",
    "bytes of stack",
]

Counted = Callable[[str, list[str]], int]
Parts = list[tuple[str, list[str], list[list[str]]]]
Filter = dict[str, tuple[int, int, int]]  # mean, most, bytes of what is said of one


def parts(counted: Counted) -> Parts:
    """Titles, headers and rows. counted(function, command) counts the instructions of a function and what it calls."""
    try:
        filters = filters_of(bench_estimation.counted(PRESET, FILTERS))
        columns = bench_estimation.counted(PRESET, IMAGES[0][0])
        alone = bench_estimation.counted(PRESET, COVARIANCES)
        build.build("host", (HOST,))
        host = [
            host_row(counted, what, n)
            for n in STAGES
            for what in (*ON_HOST, *(ON_HOST_MORE if n == DENSE_STAGES else ()))
        ]
    except (RunFailed, UserError) as error:
        return [(WHOLE_TITLE, WHOLE_HEADER, [[f"not measured: {error}", *[""] * (len(WHOLE_HEADER) - 1)]])]
    return [
        (WHOLE_TITLE, WHOLE_HEADER, [*board_rows(filters, columns), *host]),
        (PHASES_TITLE, PHASES_HEADER, phase_rows(filters)),
        (BESIDE_TITLE, BESIDE_HEADER, beside_rows(filters, columns)),
        (ALONE_TITLE, ALONE_HEADER, alone_rows(alone)),
    ]


def filters_of(lines: Lines) -> dict[tuple[str, int], Filter]:
    """A filter's first line is its tick's; those behind it, up to the next filter's, are what else there is of it."""
    out: dict[tuple[str, int], Filter] = {}
    for what, n, mean, most, size in lines:
        if CONFIG.match(what):
            last = out.setdefault((what, int(n)), {})
            what = "tick"
        last[what] = (mean, most, size)
    return out


def words_of(what: str) -> tuple[str, str, str]:
    found = CONFIG.match(what)
    if not found:
        raise RunFailed(f"no filter is called {what}")
    return found.group(1), found.group(2), found.group(3)


def board_rows(filters: dict[tuple[str, int], Filter], columns: Lines) -> list[list[str]]:
    reduced = {int(n): mean for what, n, mean, _, _ in columns if what == "rekf"}
    out = []
    for (what, n), found in filters.items():
        method, covariance, extras = words_of(what)
        tick, job = found["tick"], found["job"]
        out.append(
            [
                BOARD,
                method,
                covariance,
                str(n),
                extras,
                f"{tick[0]:,}",
                f"{tick[1]:,}",
                f"{tick[0] / reduced[n]:.2f}",
                f"{job[0]:,}",
                f"{job[1]:,}",
                f"{found['piece'][1]:,}",
                milliseconds(tick[0]),
                milliseconds(tick[1] + job[1]),
                f"{tick[2]:,}",
                f"{job[2]:,}",
                f"{found['tick-stack'][0]:,}, {found['job-stack'][0]:,}",
            ]
        )
    return out


def host_row(counted: Counted, what: str, n: int) -> list[str]:
    """Means alone; memory is that of a build for 100 stages."""
    program = str(build_dir("host") / HOST)
    last = FIRST + ROUND[n]

    def mean(function: str) -> int:
        few, many = (counted(function, [program, what, str(n), str(steps)]) for steps in (FIRST, last))
        return round((many - few) / ROUND[n])

    tick, job = mean("measured_tick"), mean("measured_job")
    method, covariance, extras = words_of(what)
    state, workspace = memory_of([program, what, str(n), str(FIRST)])
    times = f"{tick / host_step(counted, 'rekf', n):.2f}"
    where = NO_ROOM if n == max(STAGES) else X86
    return [where, method, covariance, str(n), extras, f"{tick:,}", "", times, f"{job:,}", *[""] * 4, f"{state:,}", f"{workspace:,}", ""]


def memory_of(command: list[str]) -> tuple[int, int]:
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    found = re.search(r"state (\d+), workspace (\d+)", answer.stdout)
    if answer.returncode != 0 or not found:
        raise RunFailed(f"{HOST}: {(answer.stderr.strip().splitlines() or ['failed'])[-1]}")
    return int(found.group(1)), int(found.group(2))


def phase_rows(filters: dict[tuple[str, int], Filter]) -> list[list[str]]:
    return [
        [*words_of(what), *[f"{found[f'phase-{phase}'][0]:,}" for phase in PHASES]]
        for (what, n), found in filters.items()
        if n == DENSE_STAGES
    ]


def beside_rows(filters: dict[tuple[str, int], Filter], columns: Lines) -> list[list[str]]:
    """The covariance of a dense form is on the second line behind its own."""
    dense = {
        what: (mean, columns[k + 2][2]) for k, (what, _, mean, _, _) in enumerate(columns) if what.startswith("dense-")
    }
    matrix, band = dense["dense-transition"], dense["dense-band"]
    rows = [("dense, F P F', F as a matrix", "0", *matrix), ("dense, F P F', F by the factors of a band", "0", *band)]
    for (what, n), found in filters.items():
        method, covariance, extras = words_of(what)
        if n != DENSE_STAGES or method != "ekf":
            continue
        own = sum(found[f"phase-{phase}"][0] for phase in ("factors", "feed", "carry", "sensors"))
        rows.append((f"`covariance {covariance}`", extras, found["tick"][0] + found["job"][0], own))
    return [
        [
            words,
            extras,
            f"{whole:,}",
            f"{own:,}",
            f"{matrix[0] / whole:.1f}",
            f"{band[0] / whole:.1f}",
            f"{matrix[1] / own:.1f}",
            f"{band[1] / own:.1f}",
        ]
        for words, extras, whole, own in rows
    ]


def alone_rows(lines: Lines) -> list[list[str]]:
    found: dict[tuple[str, str], tuple[int, int, int]] = {}
    for what, n, *counts in lines:
        found.setdefault((what, n), (counts[0], counts[1], counts[2]))  # behind them those of other numbers of components
    stacks = {(lines[k - 1][0], line[1]): line[2] for k, line in enumerate(lines) if line[0] == "stack"}
    out = []
    for what, n in found:
        if what != "thornton-carry":
            continue
        taken = found["ud-measurements", n][0]
        step = found[what, n][0] + found["thornton-matrix", n][0]
        thornton = [f"{step:,}", f"{step:,}", f"{step:,}", f"{taken:,}", "1.0", f"{found[what, n][2]:,}", ""]
        for form, name in (("U D U', whole", "ud"), ("banded", "band")):
            carry, piece, temperatures = (found[f"{name}-{part}", n] for part in ("carry", "piece", "measurements"))
            times = (step + taken) / (carry[0] + temperatures[0])
            counts = [f"{carry[0]:,}", f"{carry[1]:,}", f"{piece[1]:,}", f"{temperatures[0]:,}", f"{times:.1f}"]
            stack = stacks.get((f"{name}-measurements" if name == "band" else "transition", n), 0)
            out.append([form, n, *counts, f"{carry[2]:,}", f"{stack:,}"])
        out.append(["U D U', Thornton's: the transition as a matrix", n, *thornton])
    return out
