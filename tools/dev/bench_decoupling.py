"""Cost of decoupling on the board: the part of tools/bench about it.

tests/bench/estimation/decoupling.c is an image for the emulated STM32F405, counted as bench_estimation tells. Of a tick the second word
is ten times the loops and the coefficients, of a design the loops.
"""

from __future__ import annotations

from dev.bench_estimation import PRESETS, Lines, counted
from reflux.errors import RunFailed

PROGRAM, AHEAD_PROGRAM, LAW_PROGRAM = "decoupling-cost", "ahead-cost", "law-cost"
TICK_TITLE = "Instructions of a tick of decoupling and of pole placement, STM32F405 in the emulator: step and back-calculation"
TICK_HEADER = ["what", "loops", "coefficients", "number format", "mean", "most", "bytes of state", "bytes of stack"]
TICKS = {
    "polynomial": "`polynomial`, all MVs free",
    "limited": "`polynomial`, an MV at its limit",
    "sums": "the sums alone",
    "static": "static decoupler, all MVs free",
    "static_limited": "static decoupler, an MV at its limit",
    "experiment": "`experiment`, its signals moving",
    "rst": "`rst`",
    "state": "`state`; inputs for coefficients",
    "pid": "the loop's own PID",
}
AHEAD_TITLE = "Instructions of a tick of `ahead`, two loops, an interval in three parts, STM32F405 in the emulator"
AHEAD_HEADER = ["what", "stages, components", "number format", "mean", "most", "bytes of state", "bytes of stack"]
AHEAD = {"ahead": "step and back-calculation", "ahead_begins": "its beginning (follow)", "ahead_predicts": "one prediction"}
COMPONENTS = {"12": "12, 2", "37": "37, 3"}
DESIGN_TITLE = "Instructions of designs for decoupling, STM32F405 in the emulator, float"
DESIGN_HEADER = ["what", "loops", "all of it", "largest piece", "bytes of workspace", "bytes of stack"]
DESIGNS = {
    "decoupler": "polynomial decoupler with the zeros of det B",
    "placement": "pole placement, model of second order",
    "find": "`experiment`: orders and parameters, 252 samples, na to 2, nb to 5",
    "law": "`state_law`: law of the pilot column from its table, 12 stages",
    "law_model": "`experiment`: law of a model of first order",
    "search": "constant compensator, 50 frequencies, by rows, 8 starts",
}


def parts() -> list[tuple[str, list[str], list[list[str]]]]:
    ticks: list[list[str]] = []
    designs: list[list[str]] = []
    ahead: list[list[str]] = []
    for name, preset in PRESETS:
        try:
            lines, of_ahead = counted(preset, PROGRAM), counted(preset, AHEAD_PROGRAM)
        except RunFailed as error:
            ticks.append(["all", "", "", name, f"not measured: {error}", "", "", ""])
            continue
        ticks += tick_rows(name, lines)
        ahead += ahead_rows(name, of_ahead)
        if name == "float":  # Q7.24 is the number format of ticks alone
            designs = design_rows(lines) + design_rows(counted(preset, LAW_PROGRAM))
    return [(TICK_TITLE, TICK_HEADER, ticks), (AHEAD_TITLE, AHEAD_HEADER, ahead), (DESIGN_TITLE, DESIGN_HEADER, designs)]


def tick_rows(name: str, lines: Lines) -> list[list[str]]:
    out = []
    for k, (kind, size, mean, most, bytes_) in enumerate(lines):
        if kind in TICKS:
            loops, coefficients = divmod(int(size), 10)
            out.append([TICKS[kind], str(loops), str(coefficients) if coefficients else "-", name, f"{mean:,}", f"{most:,}", f"{bytes_:,}",
                        f"{lines[k + 1][2]:,}"])
    return out


def ahead_rows(name: str, lines: Lines) -> list[list[str]]:
    return [[AHEAD[kind], COMPONENTS[n], name, f"{mean:,}", f"{most:,}", f"{bytes_:,}", f"{lines[k + 1][2]:,}"]
            for k, (kind, n, mean, most, bytes_) in enumerate(lines) if kind in AHEAD]


def design_rows(lines: Lines) -> list[list[str]]:
    return [[DESIGNS[kind], n, f"{total:,}", f"{most:,}", f"{bytes_:,}", f"{lines[k + 1][2]:,}"]
            for k, (kind, n, total, most, bytes_) in enumerate(lines) if kind in DESIGNS]
