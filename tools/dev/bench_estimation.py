"""Cost of estimators and the self-tuner on the board: the part of tools/bench about them.

tests/bench/estimation is an image for the emulated STM32F405, built with the product's flags. It counts each step with a
timer that counts one for each instruction, and writes a line for each figure: what, n, mean, most, bytes.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

from reflux import build
from reflux.boards import BOARDS
from reflux.errors import RunFailed
from reflux.paths import build_dir

PROGRAM = "estimation-cost"
PRESETS = (("float", "stm32f405"), ("Q7.24", "stm32f405-fixed"))
SIZES = ("6", "9", "12", "24")
LAST = "done"

UPDATE_TITLE = "Instructions of recursive least squares, STM32F405 in the emulator, n parameters"
UPDATE_HEADER = ["what", "number format", *[f"n = {n}: mean, most" for n in SIZES], "bytes of P or all, n = 9"]
UPDATE_NAMES = {
    "update": "UDU', measurement alone",
    "step": "UDU', whole step: forgetting, parameters, limits",
    "covariance": "covariance form, measurement alone",
    "joseph": "Joseph's form, multiplied out, measurement alone",
    "dense": "dense (I - KH)P(I - KH)' + KRK', measurement alone",
}
TUNER_TITLE = "Instructions of the self-tuner's law a sample, STM32F405 in the emulator"
TUNER_HEADER = ["design", "number format", "mean", "most", "bytes of state", "bytes of stack"]
TUNERS = ("PSV", "ISV", "PMD1", "IMD1")
TRAYS_TITLE = "Instructions of tray temperature control a tick, STM32F405 in the emulator: step and back-calculation"
TRAYS_HEADER = ["law", "loops", "number format", "mean", "most", "bytes of state", "bytes of stack"]
TRAYS = ("PI", "conventional", "cascade", "CLF")

Lines = list[tuple[str, str, int, int, int]]


def parts() -> list[tuple[str, list[str], list[list[str]]]]:
    """Titles, headers and rows of both tables."""
    updates: list[list[str]] = []
    tuners: list[list[str]] = []
    trays: list[list[str]] = []
    for name, preset in PRESETS:
        try:
            lines = counted(preset)
        except RunFailed as error:
            updates.append(["all", name, f"not measured: {error}", "", "", "", ""])
            continue
        updates += update_rows(name, lines)
        tuners += tuner_rows(name, lines)
        trays += tray_rows(name, lines)
    return [(UPDATE_TITLE, UPDATE_HEADER, updates), (TUNER_TITLE, TUNER_HEADER, tuners), (TRAYS_TITLE, TRAYS_HEADER, trays)]


def update_rows(name: str, lines: Lines) -> list[list[str]]:
    out = []
    for what, words in UPDATE_NAMES.items():
        found = {n: (mean, most, size) for kind, n, mean, most, size in lines if kind == what}
        if found:
            out.append([words, name, *[f"{found[n][0]:,}, {found[n][1]:,}" for n in SIZES], f"{found['9'][2]:,}"])
    return out


def tuner_rows(name: str, lines: Lines) -> list[list[str]]:
    out = []
    for k, (kind, _, mean, most, size) in enumerate(lines):
        if kind in TUNERS:
            out.append([kind, name, f"{mean:,}", f"{most:,}", f"{size:,}", f"{lines[k + 1][2]:,}"])
    return out


def tray_rows(name: str, lines: Lines) -> list[list[str]]:
    """The loop's own PID with a PI's settings stands first."""
    return [[kind, n, name, f"{mean:,}", f"{most:,}", f"{size:,}", f"{lines[k + 1][2]:,}"]
            for k, (kind, n, mean, most, size) in enumerate(lines) if kind in TRAYS]


def counted(preset: str, program: str = PROGRAM) -> Lines:
    build.build(preset, (program,))
    image = build_dir(preset) / f"{program}.elf"
    out: Lines = []
    for line in written_by(image):
        word = line.split()
        if len(word) != 5 or not all(w.isdigit() for w in word[1:]):
            raise RunFailed(f"{program} wrote {line!r}")
        out.append((word[0], word[1], int(word[2]), int(word[3]), int(word[4])))
    return out


def written_by(image: Path) -> list[str]:
    """The image's lines up to the last."""
    command = ["qemu-system-arm", "-M", BOARDS["stm32f405"].machine, "-display", "none", "-monitor", "none",
               "-kernel", str(image), "-serial", "stdio", "-icount", "shift=0"]
    try:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    except FileNotFoundError:
        raise RunFailed("there is no program qemu-system-arm") from None
    lines: list[str] = []
    try:
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith(LAST):
                return lines
            lines.append(line)
        raise RunFailed(f"{image.name} ended without its last line")
    finally:
        process.kill()
        process.wait()
