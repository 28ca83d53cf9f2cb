"""Call graph of a linked image, and the deepest stack below each of its entry points.

Each function is walked along its branches with the stack pointer in hand, so that the depth at every call is
known, also in assembly and in the C library. What the walk does not understand is an error, never a guess.
Calls through pointers come from a list that people keep (tests/target/indirect_calls.txt); its sets of functions of the kinds of blocks
are found in their sources (kind_tables.py).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path

from dev.elf_image import Function, Image
from reflux.errors import RunFailed, UserError

REGISTERS = {"sl": 10, "fp": 11, "ip": 12, "sp": 13, "lr": 14, "pc": 15}
CONDITIONS = ("eq", "ne", "cs", "cc", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le")
BRANCH = re.compile(r"^b(?:(" + "|".join(CONDITIONS) + r"))?(?:\.[nw])?$")
TARGET = re.compile(r"\b([0-9a-f]{5,8}) <")
MANY = 64 * 1024  # a frame larger than this is a loop that pushes


@dataclass(frozen=True)
class Site:
    """A call: how deep the stack is at it, where it goes (None: through a pointer)."""

    address: int
    depth: int
    target: int | None


@dataclass
class Node:
    function: Function
    frame: int
    sites: list[Site]


@dataclass
class Indirect:
    """The list of calls through pointers: function of the source -> functions it may call."""

    targets: dict[str, list[str]]
    path: Path
    used: set[str] = field(default_factory=set)


def read_list(path: Path, known: dict[str, list[str]] | None = None) -> Indirect:
    """Lines `caller: target target ...  # reason`, or `@set = target target ...`; targets may be @sets, of this file or known."""
    sets = dict(known or {})
    out: dict[str, list[str]] = {}
    try:
        lines = path.read_text(encoding="utf-8").replace("\\\n", " ").splitlines()
    except OSError as error:
        raise UserError(f"{path.name} cannot be read: {error.strerror}") from None

    def resolve(words: list[str]) -> list[str]:
        names: list[str] = []
        for word in words:
            if word.startswith("@") and word not in sets:
                raise UserError(f"{path.name}: {word} is not defined above its use")
            names += sets.get(word, [word])
        return names

    for line in lines:
        text, _, reason = line.partition("#")
        if not text.strip():
            continue
        named = re.match(r"^(@\w+)\s*=\s*(.*)$", text.strip())
        call = re.match(r"^(\w+)\s*:\s*(.*)$", text.strip())
        if named:
            sets[named[1]] = resolve(named[2].split())
        elif call and call[2].split() and reason.strip():  # `nobody` is a caller too: kept, but never called
            out.setdefault(call[1], []).extend(resolve(call[2].split()))
        else:
            raise UserError(f'{path.name}: "{line.strip()}" is not `caller: targets  # reason` or `@set = targets`')
    return Indirect(out, path)


def _registers(text: str) -> int:
    """Bytes of a register list."""
    total = 0
    for part in re.sub(r"[{}\s]", "", text).split(","):
        low, _, high = part.partition("-")
        size = 8 if low.startswith("d") else 4
        total += size * (_number(high) - _number(low) + 1 if high else 1)
    return total


def _number(register: str) -> int:
    return REGISTERS[register] if register in REGISTERS else int(register[1:])


def _base(name: str) -> str:
    """Mnemonic without width and condition, for those that move the stack pointer."""
    name = re.sub(r"\.[nw]$", "", name)
    known = ("push", "pop", "vpush", "vpop", "stmdb", "ldmia", "vstmdb", "vldmia", "sub", "subw", "add", "addw",
             "str", "ldr", "strd", "ldrd", "mov", "subs", "adds", "bx", "blx", "vldr", "vstr", "msr", "stm", "ldm")
    for suffix in ("", *CONDITIONS):
        if suffix and name.endswith(suffix) and name[:-2] in known:
            return name[:-2]
    return name


def _conditional(name: str) -> bool:
    return _base(name) != re.sub(r"\.[nw]$", "", name)


def stack_effect(name: str, operands: str) -> int | None:
    """Bytes the instruction puts on the stack (negative: takes off); None where it cannot be told."""
    base = _base(name)
    if base in ("push", "vpush"):
        return _registers(operands)
    if base in ("pop", "vpop"):
        return -_registers(operands)
    if base in ("stmdb", "vstmdb") and operands.startswith("sp!"):
        return _registers(operands.split("{", 1)[1])
    if base in ("ldmia", "vldmia") and operands.startswith("sp!"):
        return -_registers(operands.split("{", 1)[1])
    if base in ("str", "strd") and (m := re.search(r"\[sp, #-(\d+)\]!", operands)):
        return int(m[1])
    if base in ("ldr", "ldrd") and (m := re.search(r"\[sp\], #(\d+)", operands)):
        return -int(m[1])
    if re.search(r"\[sp[^]]*\]!|\[sp\], |sp!", operands):
        return None
    if operands.split(",")[0].strip() == "sp" and base not in ("cmp", "cmn", "str", "stmia", "tst", "stm"):
        m = re.match(r"sp, (?:sp, )?#(\d+)$", operands.strip())
        if m and base in ("sub", "subw"):
            return int(m[1])
        if m and base in ("add", "addw"):
            return -int(m[1])
        return None
    return 0


class Graph:
    def __init__(self, image: Image, indirect: Indirect):
        self.image = image
        self.indirect = indirect
        self.nodes: dict[int, Node] = {}
        self.unlisted: list[str] = []  # what the list lacks, one line each
        self.fresh_stack: set[int] = set()  # functions that set the stack pointer anew
        self.by_name: dict[str, list[int]] = {}
        for f in image.functions.values():
            for name in {f.plain(), *f.names}:
                self.by_name.setdefault(name, []).append(f.start)
        self.edges: dict[int, list[tuple[int, int]]] = {}  # start -> (depth, callee)
        self.totals: dict[int, int] = {}
        self.next: dict[int, int | None] = {}
        self.cycles: list[str] = []

    def build(self, entries: list[int]) -> None:
        """Walks everything that can be reached from here."""
        todo = list(entries)
        while todo:
            start = todo.pop()
            if start in self.nodes:
                continue
            node = self.nodes[start] = self._walk(self._function(start))
            self.edges[start] = [(s.depth, s.target) for s in node.sites if s.target is not None]
            pointers = [s for s in node.sites if s.target is None]
            places = self.image.source_functions([s.address for s in pointers])
            for site in pointers:
                caller, place = places[site.address]
                self.edges[start] += [(site.depth, target) for target in self._listed(caller, place)]
            todo += [callee for _, callee in self.edges[start]]

    def _listed(self, caller: str, place: str) -> list[int]:
        names = self.indirect.targets.get(caller)
        if names is None:
            self.unlisted.append(f"{caller} ({place}) calls through a pointer and has no line in {self.indirect.path.name}; "
                                 f"write there `{caller}: TARGET ...  # why these and no others`")
            return []
        self.indirect.used.add(caller)
        return [start for name in names for start in self._starts(name)]

    def _starts(self, name: str) -> list[int]:
        if "*" not in name:
            return self.by_name.get(name, [])
        return [start for known, starts in self.by_name.items() if fnmatchcase(known, name) for start in starts]

    def _function(self, start: int) -> Function:
        if start in self.image.functions:
            return self.image.functions[start]
        around = self.image.containing(start)
        if around is None:
            raise RunFailed(f"a call goes to {start:#x}, where no function is")
        return Function(f"{around.name}+{start - around.start:#x}", start, around.end)

    def _walk(self, f: Function) -> Node:
        body = self.image.body(f)
        inside = set(body)
        depth_at: dict[int, int] = {}
        sites: dict[int, Site] = {}
        deepest = 0
        todo = [(f.start, 0)]
        table_depth: int | None = None
        # A jump table leads to no nop: one that nothing else reaches fills up to the constants behind the code.
        coded = [a for a in body if not self.image.instructions[a].name.startswith("nop")]
        while todo or (table_depth is not None and any(a not in depth_at for a in coded)):
            if not todo:  # what only a jump table leads to
                todo.append((next(a for a in coded if a not in depth_at), table_depth or 0))
            address, depth = todo.pop()
            if address not in inside or depth_at.get(address, -1) >= depth:
                continue
            if depth > MANY:
                raise RunFailed(f"{f.name}: the stack grows in a loop")
            depth_at[address] = depth
            i = self.image.instructions[address]
            base = _base(i.name)
            following = self._after(address)
            branch = BRANCH.match(i.name)
            goes = TARGET.search(i.operands)
            target = int(goes[1], 16) if goes else None
            if base == "msr" and "MSP" in i.operands.upper():
                self.fresh_stack.add(f.start)
                depth = depth_at[address] = 0
                effect: int | None = 0
            else:
                effect = stack_effect(i.name, i.operands)
            if effect is None:
                raise RunFailed(f"{f.name} at {address:#x}: cannot follow the stack pointer through "
                                f"`{i.name} {i.operands}`")
            after = depth + effect
            deepest = max(deepest, depth, after)
            if i.name in ("bl", "blx") and target is not None:
                sites[address] = Site(address, depth, target)
                todo.append((following, depth))
            elif base == "blx":
                sites[address] = Site(address, depth, None)
                todo.append((following, depth))
            elif branch or i.name.startswith("cbz") or i.name.startswith("cbnz"):
                if target in inside:
                    todo.append((target, depth))
                elif target is not None:
                    sites[address] = Site(address, depth, target)
                if not branch or branch[1] or self._in_it_block(i.name):
                    todo.append((following, depth))
            elif base == "bx":
                if i.operands.strip() != "lr":
                    sites[address] = Site(address, depth, None)
                if _conditional(i.name):
                    todo.append((following, depth))
            elif i.name.startswith(("tbb", "tbh")) or (base == "ldr" and re.match(r"pc, \[(?!sp)", i.operands)):
                table_depth = max(table_depth or 0, depth)
            elif "pc" in re.split(r"[\s,{}]+", i.operands.split("[")[0]) and effect is not None and (
                    effect < 0 or base == "mov" or base in ("add", "adds")) and not i.operands.startswith("r"):
                if base in ("add", "adds") or (base == "mov" and "lr" not in i.operands):
                    raise RunFailed(f"{f.name} at {address:#x}: jump by `{i.name} {i.operands}` is not understood")
                if _conditional(i.name):
                    todo.append((following, depth))
            elif base in ("pop", "ldmia") and re.search(r"\bpc\b", i.operands):
                if _conditional(i.name):
                    todo.append((following, depth))
            elif i.name == "udf":
                pass
            elif following == f.end or following not in inside:
                todo.append((following, after))
                if following in self.image.functions and following >= f.end:
                    sites[address] = Site(address, after, following)  # runs on into the next one
            else:
                todo.append((following, after))
        return Node(f, deepest, list(sites.values()))

    def _after(self, address: int) -> int:
        k = self.image.position[address] + 1
        return self.image.sorted_addresses[k] if k < len(self.image.sorted_addresses) else address + 4

    @staticmethod
    def _in_it_block(name: str) -> bool:
        return bool(BRANCH.match(name) and BRANCH.match(name)[1])

    def total(self, start: int) -> int:
        """Deepest stack from the entry of this function on. Cycles are collected and cut."""
        return self._total(start, [])

    def _total(self, start: int, path: list[int]) -> int:
        if start in self.totals:
            return self.totals[start]
        if start in path:
            names = [self.nodes[a].function.name for a in [*path[path.index(start):], start]]
            text = " -> ".join(names)
            if text not in self.cycles:
                self.cycles.append(text)
            return 0
        best, through = self.nodes[start].frame, None
        for depth, callee in self.edges[start]:
            below = self._total(callee, [*path, start])
            if callee not in self.fresh_stack and depth + below > best:
                best, through = depth + below, callee
        self.totals[start], self.next[start] = best, through
        return best

    def deepest_path(self, start: int) -> list[tuple[str, int]]:
        """Names along the deepest way, each with its own frame."""
        self.total(start)
        out = []
        at: int | None = start
        while at is not None:
            out.append((self.nodes[at].function.name, self.nodes[at].frame))
            at = self.next[at]
        return out

    def unlisted_addresses(self, handlers: set[int]) -> list[str]:
        """Functions whose address is kept somewhere though no line of the list says who calls them."""
        listed = {start for names in self.indirect.targets.values() for name in names for start in self._starts(name)}
        return sorted(self.image.functions[start].name for start in self.image.address_taken() - listed - handlers)


def split_arguments(image: Image, function: Function) -> int:
    """Bytes that a function makes room for before it pushes anything: an argument came half in registers and half on the
    stack, and is put together there. The compiler's figures leave them out."""
    first = image.instructions.get(function.start)
    match = re.fullmatch(r"sp, (?:sp, )?#(\d+)", first.operands.split("@")[0].strip()) if first and first.name.startswith("sub") else None
    second = image.instructions.get(function.start + 2)
    return int(match[1]) if match and second and second.name.startswith(("push", "stmdb")) else 0


def compare_with_compiler(graph: Graph, folder: Path) -> tuple[int, list[str]]:
    """The compiler's own frame sizes (*.su) against the walk: how many agree, and who does not. Names that occur
    more than once agree when one of them does."""
    said: dict[str, set[int]] = {}
    for path in folder.rglob("*.su"):
        for line in path.read_text(errors="replace").splitlines():
            parts = line.split("\t")
            if len(parts) >= 3 and parts[1].isdigit():
                said.setdefault(parts[0].rsplit(":", 1)[-1].split(".")[0], set()).add(int(parts[1]))
    agree, differ = 0, []
    for node in graph.nodes.values():
        known = said.get(node.function.plain())
        if known is None:
            continue
        if node.frame in known or node.frame - split_arguments(graph.image, node.function) in known:
            agree += 1
        else:
            differ.append(f"{node.function.name}: {node.frame} bytes in the image, {sorted(known)} by the compiler")
    return agree, differ

