"""Cost of the plant link per tick, instruction by instruction: the part of tools/bench about reception and answer.

The emulator runs one instruction at a time and writes down the address of each (only those of the link's files, of the
checksum and of copying). Counted is what the tick's context runs from the interrupt that starts it to its end, where it
took bytes, up to the answer to the sample they made; not where it looked in vain, nor the interrupts that receive and send
single bytes. Checksums and copies count where a file of the link calls them.
"""

from __future__ import annotations

import os
import re
import tempfile
import threading
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable, Iterable

from dev import elf_image
from reflux import build, memory_map
from reflux.boards import BOARDS
from reflux.errors import RunFailed

FRAMES = "frame.c"
FILES = (FRAMES, "messages.c", "plant_link.c", "uart.c")
HELPERS = ("crc32.c", "memory.c")
ENTRIES = ("crc32_update", "memcpy", "memset")
TABLES = {256: "of_byte", 16: "of_half_byte", 0: ""}  # entries, and the symbol of such a table
SETTLING = 2  # ticks that are not counted: the configuration has not come yet
ANSWER = "pack_command"
ANSWERS = "answers"
TICK = 14  # PendSV
ONE_BY_ONE = ("-icount", "shift=0", "-singlestep", "-d", "exec,nochain,int")
ADDRESS = re.compile(r"([0-9a-f]{8})\b")


@dataclass
class Watched:
    """Addresses of an image that are looked at."""

    column: dict[int, str] = field(default_factory=dict)  # of each instruction
    entry: set[int] = field(default_factory=set)  # where helpers begin
    call: set[int] = field(default_factory=set)  # instructions of the link's files that call or jump to one
    answer: int = 0
    ranges: list[tuple[int, int]] = field(default_factory=list)


def watched(folder: Path, name: str) -> Watched:
    """From the symbols and the map of the image NAME in a build tree."""
    image = elf_image.Image(folder / f"{name}.elf")
    parts, _ = memory_map.placed(folder / f"{name}.map")
    file_at = {p.address: match[1] for p in parts if p.kind == "text" and (match := re.search(r"(\w+\.c)\.obj\)?$", p.owner))}
    out = Watched()
    for f in image.functions.values():
        column = file_at.get(f.start, "")
        if column not in FILES + HELPERS:
            continue
        out.ranges.append((f.start, f.end))
        out.column.update({at: column for at in range(f.start, f.end, 2)})
        if f.plain() in ENTRIES:
            out.entry.add(f.start)
        if f.plain() == ANSWER:
            out.answer = f.start
    if not out.answer or not out.entry:
        raise RunFailed(f"{name}.elf has no {ANSWER}, or nothing that it calls")
    for at, column in out.column.items():
        instruction = image.instructions.get(at)
        if column in FILES and instruction and instruction.name.startswith("b"):
            target = re.match(r"\s*([0-9a-f]{7,8})\b", instruction.operands)
            if target and int(target[1], 16) in out.entry:
                out.call.add(at)
    return out


class Ticks:
    """Reads the emulator's log. An instruction that is written down and then taken back is not counted."""

    def __init__(self, what: Watched):
        self.what = what
        self.answered: list[Counter[str]] = []
        self.running: list[int] = []  # interrupts, the innermost last
        self.current: Counter[str] = Counter()  # since the tick's context was entered
        self.sample: Counter[str] = Counter()  # since the last answer
        self.last = 0  # address counted last in the tick's context
        self.last_column: str | None = None
        self.in_helper = False

    def read(self, lines: Iterable[str]) -> None:
        for line in lines:
            if line.startswith("Trace"):
                if self.running and self.running[-1] == TICK:
                    self._instruction(int(line.split("/", 2)[1], 16))
            elif line.startswith(("cpu_io_recompile", "Stopped")):
                self._take_back(line)
            elif line.startswith("...taking pending"):
                self.running.append(int(line.rsplit(None, 1)[1]))
            elif line.startswith("Exception return") and self.running.pop() == TICK:
                self._tick_context_ends()

    def _tick_context_ends(self) -> None:
        if self.current[FRAMES]:
            self.sample.update(self.current)
        if self.current[ANSWERS]:
            self.answered.append(self.sample)
            self.sample = Counter()
        self.current = Counter()

    def _instruction(self, at: int) -> None:
        column = self.what.column.get(at)
        if at in self.what.entry:
            self.in_helper = self.last in self.what.call
        if at == self.what.answer:
            self.current[ANSWERS] += 1
        helper = column not in FILES
        if helper and not self.in_helper:
            column = None
        self.last, self.last_column = at, column
        if column:
            self.current[column] += 1

    def _take_back(self, line: str) -> None:
        match = ADDRESS.search(line.rsplit(None, 1)[1])
        if match and int(match[1], 16) == self.last and self.last_column:
            self.current[self.last_column] -= 1
            self.last_column = None


Run = Callable[[str, tuple[str, ...]], object]
TITLE = "Cost of the plant link per tick, instructions in the emulator"
HEADER = ["image", "entries of the CRC's table", "flash", "least", "mean", "most", *HELPERS, *FILES]


def rows(run: Run) -> list[list[str]]:
    """Each image with its own table and, where that shows what a size buys, with the others. run(kind, options) runs the
    image of a build tree under the emulator with more options."""
    out = []
    for kind in BOARDS:
        own = table_of(build.build(kind, quiet=True), f"reflux-{kind}")
        for entries in TABLES:
            tree = f"{kind}-tables"
            folder = build.variant(kind, tree, (f"-DREFLUX_CRC32_TABLE={entries}",))
            out.append(row(kind, entries, entries == own, folder, f"reflux-{kind}", lambda more, tree=tree: run(tree, more)))
    folder = build.build("stm32f405-base", quiet=True)
    out.insert(len(TABLES), row("stm32f405-base", table_of(folder, "reflux-stm32f405"), True, folder, "reflux-stm32f405",
                                lambda more: run("stm32f405-base", more)))
    return out


def table_of(folder: Path, name: str) -> int:
    symbols = elf_image.Image(folder / f"{name}.elf").symbols
    return next(entries for entries, symbol in TABLES.items() if symbol in symbols or not symbol)


def row(kind: str, entries: int, own: bool, folder: Path, name: str, run: Callable[[tuple[str, ...]], object]) -> list[str]:
    flash = sum(s.flash() for s in memory_map.read(folder / f"{name}.map").values())
    ticks = measure(folder, name, run)[SETTLING:]
    whole = [sum(t[c] for c in (*HELPERS, *FILES)) for t in ticks]
    return [kind, f"{entries or 'none'}{' (its own)' if own else ''}", f"{flash:,}", f"{min(whole):,}",
            f"{sum(whole) / len(whole):,.0f}", f"{max(whole):,}",
            *(f"{sum(t[c] for t in ticks) / len(ticks):,.0f}" for c in (*HELPERS, *FILES))]


def measure(folder: Path, name: str, run: Callable[[tuple[str, ...]], object]) -> list[Counter[str]]:
    """Instructions of each answered tick by column. run() is to run the image with the emulator's options it is given."""
    what = watched(folder, name)
    with tempfile.TemporaryDirectory(prefix="reflux-") as place:
        pipe = Path(place) / "log"
        os.mkfifo(pipe)
        ticks = Ticks(what)

        def follow() -> None:
            with pipe.open(encoding="ascii", errors="replace") as lines:
                ticks.read(lines)

        reader = threading.Thread(target=follow, daemon=True)
        reader.start()
        ranges = ",".join(f"{start:#x}..{end - 1:#x}" for start, end in what.ranges)
        run((*ONE_BY_ONE, "-D", str(pipe), "-dfilter", ranges))
        reader.join(60)
    if not ticks.answered:
        raise RunFailed("the emulator's log shows no tick that answered a sample")
    return ticks.answered
