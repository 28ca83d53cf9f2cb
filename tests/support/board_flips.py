"""Flipped bits on the virtual board, each compared with the same run without it: masked, still there, told, stopped or silent."""

from __future__ import annotations

import random
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from board_faults import FAULT_S, STATES, Flash, Run, simulate
from dev.elf_image import tool
from reflux import build

MASKED, THERE, TOLD, STOPPED, SILENT = CLASSES = ("masked", "still there", "told", "stopped", "silent")
MEANING = {
    MASKED: "log, console and memory are those of the run without it",
    THERE: "log and console are those of the run without it, memory is not: nothing has read the bit with an effect, or a start has repaired the set",
    TOLD: "an event, a restart with its reason, or a refusal says so, or the board is silent from then on and the plant has gone safe",
    STOPPED: "the processor did what no chip takes, and the virtual board ended the run",
    SILENT: "log or console differ, and nothing says so",
}
PASS_S = 8.0  # docs/inside/boards.md: a pass of the check of the image; two in a row that differ count, and the flip may come behind the one under way
SEEDS = 20  # flips of a kind in a state
WINDOW_NS = {"start": (5_000_000, 200_000_000), "save": (1_000_000, 15_000_000)}  # after the event, in which the state lasts
WINDOW_INSTRUCTIONS = {"start": 20_000_000, "save": 1_500_000}
ELSE_NS, ELSE_INSTRUCTIONS = (0, 500_000_000), 1_700_000  # a sample and the time to the next


@dataclass(frozen=True)
class Kind:
    """What is hit; guarded: none may be silent. then: what makes the firmware look, so long after the flip."""

    name: str
    flip: str
    after_s: float = 3.0
    guarded: bool = False
    ranges: tuple[tuple[str, int, str, int], ...] = ()  # from a symbol and so many bytes to another, by seed; none: all of it
    then: tuple[str, ...] = ()
    then_ns: int = 0
    window_ns: tuple[int, int] | None = None  # after the event; none: that of the state
    flash: str = "stored"


# The record of the restart, the history as far as it reaches in these runs, counts of starts and wrong keys, what the port keeps (hal/retained.h).
RETAINED = (("retained", 0, "retained", 320), ("retained", 320, "retained", 320 + 12 * 32), ("retained", 3520, "retained", 3536),
            ("kept", 0, "startup_noise", 0))
KINDS = (
    Kind("image", "flip_flash", after_s=3 * PASS_S + 1.0, guarded=True),
    Kind("stored set", "flip_stored", guarded=True, then=("power_cut=0.1",), then_ns=1_000_000_000),
    Kind("retained memory", "flip_ram", guarded=True, ranges=RETAINED, then=("button=0.01",), then_ns=30_000_000,
         window_ns=(250_000_000, 400_000_000), flash="resume"),  # between two ticks, which write it anew
    Kind("RAM in use", "flip_ram", ranges=(("sram_start", 0, "bss_end", 0),)),
    Kind("CCM", "flip_ccm"),
    Kind("core registers", "flip_register"),
)


def symbols() -> dict[str, int]:
    """Addresses of the image's names."""
    found = re.findall(r"^([0-9a-f]+) \S (\S+)$", tool("nm", str(build.find_image("stm32f405").with_suffix(".elf"))), re.MULTILINE)
    return {name: int(address, 16) for address, name in found}


def settings_of(kind: Kind, state: str, seed: int, at: dict[str, int], flips: bool) -> tuple[str, ...]:
    """Of the run with the flip, or of the one that it is compared with."""
    instant = random.Random(f"{kind.name} {state} {seed}")
    place = f"place={instant.randrange(2**32)}"
    first, last = kind.window_ns or WINDOW_NS.get(state, ELSE_NS)
    out: list[str] = []
    if flips and kind.flip == "flip_register":  # the core sleeps most of the time
        out += [place, f"after_instructions={instant.randint(1, WINDOW_INSTRUCTIONS.get(state, ELSE_INSTRUCTIONS))}", f"{kind.flip}=1"]
    elif flips:
        if kind.ranges:
            first_name, first_bytes, last_name, last_bytes = kind.ranges[seed % len(kind.ranges)]
            begin = at[first_name] + first_bytes
            out += [f"flip_from={begin}", f"flip_bytes={at[last_name] + last_bytes - begin}"]
        out += [place, f"after_ns={instant.randint(first, last)}", f"{kind.flip}=1"]
    if kind.then:
        out += [f"after_ns={last + kind.then_ns}", *kind.then]
    return tuple(out)


def said(transcript: str) -> Counter[str]:
    """Warnings and alarms with their subjects, starts with their reasons, and refusals."""
    events = re.findall(r"^\S+ < !? *(?:boot \d+ +)?[\d.]+ (info|warning|alarm) ([A-Z_]+) (\S+)", transcript, re.MULTILINE)
    out = [f"{code} {subject}" for level, code, subject in events if level != "info" or code == "STARTED"]
    out += re.findall(r"\(([A-Z_]+)\)$", transcript, re.MULTILINE)  # to people, who get the code of these alone
    return Counter(out + re.findall(r"^\S+ < +(err \w+|damaged)", transcript, re.MULTILINE))


def results(transcript: str) -> str:
    """Without the room in the flash: a start that finds the newest set without its confirmation writes it once more."""
    return re.sub(r"room \d+", "room", transcript)


def classify(without: Run, r: Run) -> str:
    if r.verdict:
        return STOPPED
    if said(r.transcript) - said(without.transcript) or fell_silent(r):
        return TOLD
    if r.failed or r.log != without.log or results(r.transcript) != results(without.transcript):
        return SILENT
    return MASKED if r.memory == without.memory else THERE


def fell_silent(r: Run) -> bool:
    """No frame of the board came after the silence upon which the plant went safe."""
    return r.failed != "" and r.outputs[-1][1] == "silence"


@dataclass
class Flip:
    """What came of one."""

    kind: str
    state: str
    seed: int
    outcome: str
    place: str
    words: str = ""


def broken(flip: Flip) -> str:
    """What must not be; empty: all is well. A silent flip is broken only where the firmware guards what was hit."""
    guarded = next(kind.guarded for kind in KINDS if kind.name == flip.kind)
    return f"silent: {flip.place}, {flip.words}" if guarded and flip.outcome == SILENT else ""


class Flips:
    """Runs flips; each run without one is made once."""

    def __init__(self, flash: Flash) -> None:
        self.flash = flash
        self.symbols = symbols()
        self.without: dict[tuple[str, str], Run] = {}

    def run(self, kind: Kind, state: str, seed: int) -> Flip:
        nvm = self.flash.file(kind.flash)
        if (kind.name, state) not in self.without:
            self.without[kind.name, state] = simulate(state, settings_of(kind, state, seed, self.symbols, False), kind.after_s, nvm)
        without = self.without[kind.name, state]
        r = simulate(state, settings_of(kind, state, seed, self.symbols, True), kind.after_s, nvm)
        outcome = classify(without, r)
        place = next((what for _, what in r.diary if what.startswith("flip ")), "no flip")
        words = ", ".join(sorted(said(r.transcript) - said(without.transcript))) if outcome == TOLD else r.verdict or r.failed
        if outcome == TOLD and not words:
            words = "silence of the link"
        if outcome == SILENT and not words:
            words = first_difference(without, r)
        return Flip(kind.name, state, seed, outcome, place, words[-160:])


def first_difference(without: Run, r: Run) -> str:
    for a, b in ((results(without.transcript), results(r.transcript)), (without.log, r.log)):
        for x, y in zip(a.splitlines() + [""], b.splitlines() + [""]):
            if x != y:
                return f"{y[:70]!r} in place of {x[:70]!r}"
    return "one is longer"
