"""Reads a linked image: functions, their instructions, words that are addresses of functions.

Read from the ELF file by the cross binutils: the image as linked, with the C library and the compiler's own
helpers in it, which no compiler output of single files can show.
"""

from __future__ import annotations

import bisect
import re
import struct
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from reflux.errors import RunFailed

PREFIX = "arm-none-eabi-"
INSTRUCTION = re.compile(r"^ *([0-9a-f]+):\t(\S+)(?:\t([^@;]*))?")
CLONE = re.compile(r"\.(isra|constprop|part|cold|lto_priv)\b.*$")


@dataclass(frozen=True)
class Instruction:
    address: int
    name: str
    operands: str


@dataclass
class Function:
    """[start, end) under its first name; aliases have the same start."""

    name: str
    start: int
    end: int
    names: list[str] = field(default_factory=list)

    def plain(self) -> str:
        """The name in the source, without what the compiler hung on to a copy of it."""
        return CLONE.sub("", self.name)


class Image:
    def __init__(self, path: Path):
        self.path = path
        self.symbols: dict[str, int] = {}  # every name, for data the last one wins
        self.functions: dict[int, Function] = {}
        self.unaligned: list[tuple[int, int]] = []  # [start, end) of objects that can hold no address
        self._read_symbols()
        self._read_texts()
        self.instructions: dict[int, Instruction] = {}
        self.literals: dict[int, int] = {}  # words among the code
        self._disassemble()
        self.sorted_addresses = sorted(self.instructions)
        self.position = {address: k for k, address in enumerate(self.sorted_addresses)}

    def _read_symbols(self) -> None:
        rows = []
        for line in tool("readelf", "-sW", str(self.path)).splitlines():
            parts = line.split()
            if len(parts) < 8 or not parts[0][:-1].isdigit() or parts[6] in ("UND", "ABS"):
                if len(parts) >= 8 and parts[6] == "ABS" and parts[0][:-1].isdigit():
                    self.symbols[parts[7]] = int(parts[1], 16)
                continue
            value, size, kind, name = int(parts[1], 16), int(parts[2], 0), parts[3], parts[7]
            self.symbols[name] = value
            if kind == "FUNC":
                rows.append((value & ~1, size, name))
            elif kind == "OBJECT" and value % 4:
                self.unaligned.append((value, value + size))
        starts = sorted({start for start, _, _ in rows})
        if not starts:
            raise RunFailed(f"{self.path}: no functions in its symbol table")
        for start, size, name in rows:
            known = self.functions.setdefault(start, Function(name, start, start + size))
            known.end = max(known.end, start + size)
            known.names.append(name)
        for f in self.functions.values():
            if f.end == f.start:  # assembly without a size: to the next function
                k = bisect.bisect_right(starts, f.start)
                f.end = starts[k] if k < len(starts) else f.start + 64
            f.name = min(f.names, key=lambda n: (n.startswith("_"), len(n), n))

    def _read_texts(self) -> None:
        """Constant texts hold no address, whatever four of their characters read like. Their places are in the linker's map."""
        place = self.path.with_suffix(".map")
        if not place.exists():
            return
        for match in re.finditer(r"^ \.rodata\.[\w.]*str1\.\d+\s+0x([0-9a-f]+)\s+0x([0-9a-f]+) ", place.read_text(errors="replace"), re.M):
            start = int(match[1], 16)
            self.unaligned.append((start, start + int(match[2], 16)))

    def _disassemble(self) -> None:
        for line in tool("objdump", "-d", "--no-show-raw-insn", str(self.path)).splitlines():
            match = INSTRUCTION.match(line)
            if match and match[2] == ".word":
                self.literals[int(match[1], 16)] = int((match[3] or "").strip(), 16)
            elif match and not match[2].startswith("."):
                address = int(match[1], 16)
                self.instructions[address] = Instruction(address, match[2], (match[3] or "").strip())

    def containing(self, address: int) -> Function | None:
        found = [f for f in self.functions.values() if f.start <= address < f.end]
        return max(found, key=lambda f: f.start) if found else None

    def body(self, f: Function) -> list[int]:
        low = bisect.bisect_left(self.sorted_addresses, f.start)
        return self.sorted_addresses[low:bisect.bisect_left(self.sorted_addresses, f.end)]

    def words(self) -> dict[int, int]:
        """Every aligned word of the sections that are loaded, instructions too."""
        data = self.path.read_bytes()
        header = struct.unpack_from("<IIIHHHHHH", data, 0x1C)
        program_offset, entry_size, count = header[0], header[4], header[5]
        out = {}
        for k in range(count):
            kind, offset, _, at, size = struct.unpack_from("<IIIII", data, program_offset + k * entry_size)
            if kind != 1:
                continue
            whole = size - size % 4
            for i, (word,) in enumerate(struct.iter_unpack("<I", data[offset:offset + whole])):
                out[at + 4 * i] = word
        return out

    def address_taken(self) -> set[int]:
        """Functions whose address lies somewhere as a word (constant tables, literal pools) or is put together
        by movw and movt."""
        thumb = {start | 1: start for start in self.functions}
        # Two halves of instructions can read like an address by chance; literal pools are no instructions.
        taken = {thumb[word] for at, word in self.words().items()
                 if word in thumb and at not in self.instructions and not any(start <= at < end for start, end in self.unaligned)}
        low: dict[str, int] = {}
        for address in self.sorted_addresses:
            instruction = self.instructions[address]
            match = re.match(r"(\w+), #(\d+)", instruction.operands)
            if match and instruction.name == "movw":
                low[match[1]] = int(match[2])
            elif match and instruction.name == "movt" and match[1] in low:
                value = int(match[2]) << 16 | low[match[1]]
                if value in thumb:
                    taken.add(thumb[value])
            else:  # a half that something else has overwritten belongs to no address
                low.pop(instruction.operands.split(",")[0], None)
        return taken

    def has_fpu(self) -> bool:
        return "Tag_FP_arch" in tool("readelf", "-A", str(self.path))

    def source_functions(self, addresses: list[int]) -> dict[int, tuple[str, str]]:
        """Innermost function of the source, after the compiler's inlining, and file:line; the symbol's name
        where there is no debug information."""
        out = {}
        if not addresses:
            return out
        text = tool("addr2line", "-e", str(self.path), "-a", "-f", "-i", "-s", *map(hex, addresses))
        for block in re.split(r"^0x", text, flags=re.M)[1:]:
            lines = block.splitlines()
            address, name, place = int(lines[0], 16), lines[1], lines[2].split(" ")[0]
            if name == "??" or place.startswith("?"):
                owner = self.containing(address)
                name, place = (owner.plain() if owner else "?"), "?"
            out[address] = (CLONE.sub("", name), place)
        return out

    def member_bytes(self, name: str) -> int | None:
        """Bytes of the array of words that is the struct member of this name, from the debug information."""
        text = tool("objdump", "--dwarf=info", str(self.path))
        member = re.search(rf"\(DW_TAG_member\)(?:\n +<[0-9a-f]+> .*?)*? DW_AT_name +: .*?\b{name}\n(?:.*\n)*?"
                           rf".*DW_AT_type +: <0x([0-9a-f]+)>", text)
        if member is None:
            return None
        at = text.find(f"<{member[1]}>: Abbrev Number")
        bound = re.search(r"DW_AT_upper_bound +: (\d+)", text[at:at + 2000])
        return 4 * (int(bound[1]) + 1) if at >= 0 and bound else None

    def struct_bytes(self) -> dict[str, int]:
        """Bytes of every struct with a name, from the debug information."""
        text = tool("objdump", "--dwarf=info", str(self.path))
        return {name: int(size, 0) for name, size in re.findall(
            r"\(DW_TAG_structure_type\)\n.*DW_AT_name +: (?:.*: )?(\w+)\n.*DW_AT_byte_size +: (\w+)", text)}


def tool(name: str, *arguments: str) -> str:
    try:
        answer = subprocess.run([PREFIX + name, *arguments], capture_output=True, text=True, check=False,
                                errors="replace")
    except FileNotFoundError:
        raise RunFailed(f"there is no program {PREFIX}{name}; tools/bootstrap target installs it") from None
    if answer.returncode != 0:
        last = (answer.stderr.strip().splitlines() or ["no reason given"])[-1]
        raise RunFailed(f"{PREFIX}{name}: {last}")
    return answer.stdout
