"""Bytes of a linked image by layer, from the linker's map file."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from reflux.errors import RunFailed

OUTPUT = re.compile(r"^(\.\w+|/DISCARD/)(?:\s+0x([0-9a-f]+)\s+0x([0-9a-f]+))?")
INPUT = re.compile(r"^ (\S+)\s+0x([0-9a-f]+)\s+0x([0-9a-f]+)(?: (.*))?$")
NAME_ONLY = re.compile(r"^ ([.\w*][^\s]*)$")
PLACE_ONLY = re.compile(r"^\s+0x([0-9a-f]+)\s+0x([0-9a-f]+) (\S.*)$")
KINDS = {".text": "text", ".data": "data", ".tdata": "data", ".bss": "bss", ".tbss": "bss", ".noinit": "bss",
         ".stack": "stack", ".ccm": "ccm"}
MEMORY = re.compile(r"^(\w+) +0x([0-9a-f]+) +0x([0-9a-f]+)", re.MULTILINE)


WORKSPACE = ".bss.workspace_memory"  # what is leased: no layer owns it (firmware/base/workspace.h)


@dataclass
class Sizes:
    text: int = 0
    data: int = 0
    bss: int = 0
    stack: int = 0
    ccm: int = 0  # core-coupled memory

    def flash(self) -> int:
        return self.text + self.data

    def ram(self) -> int:
        """Of the SRAM, without the stack."""
        return self.data + self.bss

    def add(self, kind: str, size: int) -> None:
        setattr(self, kind, getattr(self, kind) + size)


def layer_of(path: str) -> str:
    """`service` for .../libreflux_service.a(console.c.obj), `hal` for the port, `libc`, `libgcc`."""
    match = re.search(r"libreflux_(\w+)\.a\(", path)
    if match:
        return match[1]
    match = re.search(r"/lib(\w+)\.a\(", path)
    if match:
        return "libc" if match[1] in ("c", "m") else f"lib{match[1]}"
    return "hal" if "/hal/" in path or path.startswith("hal/") else "other"


@dataclass(frozen=True)
class Placed:
    """Share of one object file in the image: an input section, or the padding of an alignment (no owner)."""

    kind: str  # of KINDS' values
    name: str
    address: int
    size: int
    owner: str


def memories(path: Path) -> dict[str, range]:
    """Addresses of each memory of the linker script."""
    head = text_of(path).partition("Memory Configuration")[2].partition("*default*")[0]
    return {name: range(int(at, 16), int(at, 16) + int(size, 16)) for name, at, size in MEMORY.findall(head)}


def text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise RunFailed(f"{path}: {error.strerror}; the linker writes it when the image is built") from None


def placed(path: Path) -> tuple[list[Placed], dict[str, int]]:
    """Every input section in the order of the map, and the whole of each kind."""
    lines = text_of(path).splitlines()
    try:
        lines = lines[lines.index("Linker script and memory map"):]
    except ValueError:
        raise RunFailed(f"{path} is not a map file") from None
    found: list[Placed] = []
    whole = dict.fromkeys(set(KINDS.values()), 0)
    kind: str | None = None
    name = ""
    for line in lines:
        output = OUTPUT.match(line)
        if output:
            kind = KINDS.get(output[1])
            if kind and output[3]:
                whole[kind] += int(output[3], 16)
            continue
        if kind is None:
            continue
        match = INPUT.match(line)
        if match is None and NAME_ONLY.match(line):
            name = line.strip()
            continue
        if match:
            name, at, size, owner = match[1], int(match[2], 16), int(match[3], 16), match[4] or ""
        elif name and (place := PLACE_ONLY.match(line)):
            at, size, owner = int(place[1], 16), int(place[2], 16), place[3]
        else:
            continue
        if size and (owner or name == "*fill*"):
            found.append(Placed(kind, name, at, size, owner))
        name = ""
    return found, whole


def read(path: Path) -> dict[str, Sizes]:
    """Layer -> bytes; `fill` is what alignment costs, `stack` what the linker script sets aside, `workspace` what is
    leased."""
    found, whole = placed(path)
    out: dict[str, Sizes] = {}
    for k, part in enumerate(found):
        size = part.size
        # Strings that were merged away are still listed, at the place of what follows them.
        if k + 1 < len(found) and found[k + 1].kind == part.kind and part.address <= found[k + 1].address:
            size = min(size, found[k + 1].address - part.address)
        layer = {"*fill*": "fill", WORKSPACE: "workspace"}.get(part.name) or layer_of(part.owner)
        out.setdefault(layer, Sizes()).add(part.kind, size)
    for kind, total in whole.items():  # room the script makes without an input section
        rest = total - sum(getattr(s, kind) for s in out.values())
        if rest:
            out.setdefault("script", Sizes()).add(kind, rest)
    return out
