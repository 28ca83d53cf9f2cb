"""Cost of adaptive feedforward on the board: the part of tools/bench about it.

tests/bench/estimation/feedforward.c is an image for the emulated STM32F405, counted as bench_estimation tells. The second word is the
parameters of the larger model.
"""

from __future__ import annotations

from dev.bench_estimation import PRESETS, counted
from reflux.errors import RunFailed

PROGRAM = "feedforward-cost"
TICK_TITLE = "Instructions of a tick of `ff_tune`, STM32F405 in the emulator"
TICK_HEADER = ["stage", "parameters", "number format", "mean", "most", "bytes of state", "bytes of stack"]
TICKS = {"learn": "identifies", "test": "tests a candidate", "run": "runs, watched"}
WORK_TITLE = "Instructions of `ff_tune` between ticks: 16 responses with their deviations, ratio, model, search; STM32F405 in the emulator"
WORK_HEADER = ["parameters", "number format", "all of it", "largest piece", "pieces", "bytes of stack"]


def parts() -> list[tuple[str, list[str], list[list[str]]]]:
    ticks: list[list[str]] = []
    work: list[list[str]] = []
    for name, preset in PRESETS:
        try:
            lines = counted(preset, PROGRAM)
        except RunFailed as error:
            ticks.append(["all", "", name, f"not measured: {error}", "", "", ""])
            continue
        stacks = [k for k, line in enumerate(lines) if line[0] == "stack"]
        for k, (kind, n, mean, most, size) in enumerate(lines):
            stack = f"{lines[next(s for s in stacks if s > k)][2]:,}" if k < stacks[-1] else ""
            if kind in TICKS:
                ticks.append([TICKS[kind], n, name, f"{mean:,}", f"{most:,}", f"{size:,}", stack])
            elif kind == "tune":
                work.append([n, name, f"{mean:,}", f"{most:,}", f"{size:,}", stack])
    return [(TICK_TITLE, TICK_HEADER, ticks), (WORK_TITLE, WORK_HEADER, work)]
