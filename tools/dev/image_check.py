"""The rules a linked image must keep, each a function that returns what breaks it, one line each.

The figures behind them are kept for printing. Limits: tests/target/budget.toml; calls through pointers:
tests/target/indirect_calls.txt.
"""

from __future__ import annotations

import json
import re
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dev import contexts, kind_tables, stack_use
from reflux import memory_map
from dev.elf_image import Image
from reflux.errors import RunFailed, UserError
from reflux.paths import ROOT, shown

BUDGET = ROOT / "tests" / "target" / "budget.toml"
CALLS = ROOT / "tests" / "target" / "indirect_calls.txt"
WORKSPACE = memory_map.WORKSPACE.removeprefix(".bss.")  # its symbol
STEP = 64  # bytes; limits of layers are multiples of it

# Run-time ABI for the Arm architecture (IHI 0043), chapter 5, and the compiler's own names for the same.
FORBIDDEN = {
    "heap": r"_?(malloc|calloc|realloc|reallocf|free|memalign|aligned_alloc|posix_memalign|sbrk|_sbrk|strdup)(_r)?",
    "double precision": r"__aeabi_(d(add|sub|rsub|mul|div|neg|cmp\w*|2\w+)|cd\w+|(i|ui|l|ul|f|h)2d)"
                        r"|__(add|sub|mul|div|neg|pow[is]+|cmp|eq|ne|lt|le|gt|ge|unord|trunc|extend|fix|fixuns|float"
                        r"|floatun)\w*df\w*|(exp|log|pow|sqrt|sin|cos|tan|fabs|floor|ceil|fmod|strtod|atof)",
    "streams": r"(fopen|fdopen|fclose|fread|fwrite|fflush|fputs|fputc|puts|putchar|printf|vprintf|fprintf|scanf"
               r"|getchar|stdin|stdout|stderr|__iob)",
    "setjmp": r"_?(setjmp|longjmp|sigsetjmp|siglongjmp)",
}


@dataclass
class Context:
    """Entry points that cannot interrupt each other."""

    entries: list[str]
    deepest: int
    path: list[tuple[str, int]]
    frame: int  # pushed by the processor before it starts


@dataclass
class Report:
    name: str
    image: Image
    layers: dict[str, memory_map.Sizes] = field(default_factory=dict)
    contexts: list[Context] = field(default_factory=list)
    stack_reserved: int = 0
    stack_needed: int = 0
    arena: int = 0
    memories: dict[str, range] = field(default_factory=dict)
    budget: dict[str, Any] = field(default_factory=dict)
    pointer_calls: int = 0
    functions: int = 0
    frames_agree: int = 0
    used_lines: set[str] = field(default_factory=set)
    findings: list[str] = field(default_factory=list)

    def flash(self) -> int:
        return sum(s.flash() for s in self.layers.values())

    def ram(self) -> int:
        """Owned for ever: without stack and workspace."""
        return sum(s.ram() for name, s in self.layers.items() if name != "workspace")

    def workspace(self) -> int:
        return self.layers["workspace"].ram() + self.layers["workspace"].ccm if "workspace" in self.layers else 0

    def ccm(self) -> int:
        """Bytes taken of the core-coupled memory."""
        return sum(s.ccm for s in self.layers.values())

    def sram(self) -> int:
        """Bytes of the SRAM; 0: the linker script names none."""
        return len(self.memories.get("ram", ()))

    def sram_free(self) -> int:
        """Bytes of the SRAM that nothing takes, neither the stack nor a workspace that lies there."""
        return self.sram() - self.stack_reserved - sum(s.ram() for s in self.layers.values())


def presets() -> list[str]:
    """Those of CMakePresets.json that make an image for a chip."""
    table = json.loads((ROOT / "CMakePresets.json").read_text(encoding="utf-8"))
    return [p["name"] for p in table["configurePresets"] if p["name"].startswith("stm32")]


def find_elf(folder: Path) -> Path:
    found = sorted(folder.glob("reflux-*.elf"))
    if not found:
        raise RunFailed(f"{folder}: no image reflux-*.elf there; tools/image builds one")
    return found[0]


def load_budget(path: Path, board: str, build: str) -> tuple[dict[str, Any], str]:
    """Table of the build (the name of its folder) where there is one, else of the board; and its name."""
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise UserError(f"{path.name}: {error}") from None
    for name in (build, board):
        if name in table:
            return table[name], name
    raise UserError(f"{path.name} has no table [{board}]")


def check(folder: Path, budget_file: Path = BUDGET, calls_file: Path = CALLS) -> Report:
    """All rules, on the image of one build folder."""
    elf = find_elf(folder)
    board = elf.stem.removeprefix("reflux-")
    budget, table = load_budget(budget_file, board, folder.name)
    report = Report(elf.name, Image(elf), budget=budget)
    report.findings += forbidden(report.image)
    graph = stack(report, folder, budget, stack_use.read_list(calls_file, kind_tables.sets()))
    rules = tomllib.loads(budget_file.read_text(encoding="utf-8")).get("contexts")
    if graph and rules:
        report.findings += contexts.check(report.image, graph, memory_map.placed(elf.with_suffix(".map"))[0], rules)
    report.layers = memory_map.read(elf.with_suffix(".map"))
    report.memories = memory_map.memories(elf.with_suffix(".map"))
    report.findings += core_coupled(report) + waits_in_ram(report)
    report.arena = report.image.member_bytes("arena") or 0
    report.findings += over_budget(report, budget, f"[{table}.layers] of {shown(budget_file)}")
    return report


def forbidden(image: Image) -> list[str]:
    out = [f"{what}: {name} is linked" for what, pattern in FORBIDDEN.items()
           for name in sorted(image.symbols) if re.fullmatch(pattern, name)]
    wide = [i for i in image.instructions.values() if ".f64" in i.name]
    return out + [f"double precision: `{i.name}` at {i.address:#x}" for i in wide[:3]]


def core_coupled(report: Report) -> list[str]:
    """Neither DMA nor the fetching of instructions reaches the core-coupled memory (hal/stm32f405/workspace.c), and nothing that is
    linked says which memory a DMA gets. So the workspace lies there, and nothing else."""
    there = report.memories.get("ccm", range(0))
    return [f"ccm: {name} lies in the core-coupled memory at {address:#x}, where only {WORKSPACE} may lie: neither DMA nor instruction "
            "fetches reach it" for name, address in sorted(report.image.symbols.items())
            if address & ~1 in there and name != WORKSPACE and name[0] not in "$."]  # names of sections and of kinds of bytes


def waits_in_ram(report: Report) -> list[str]:
    """Code lies in the SRAM because it runs while the flash is erased and answers no read: it reaches nothing in the flash."""
    image, flash, ram = report.image, report.memories.get("flash", range(0)), report.memories.get("ram", range(0))
    out = []
    for f in image.functions.values():
        if f.start not in ram:
            continue
        reached = {image.literals[at] for at in range(f.start, f.end, 2) if at in image.literals}
        for address in image.body(f):
            i = image.instructions[address]
            target = re.match(r"(?:\w+, )?([0-9a-f]{6,8})\b", i.operands)
            if i.name[0] in "bc" and target:
                reached.add(int(target[1], 16))
            elif i.name == "movt" and (half := re.match(r"\w+, #(\d+)", i.operands)):
                reached.add(int(half[1]) << 16)
        out += [f"ram code: {f.name} runs while the flash is erased and reaches {there:#x}, which lies in the flash"
                for there in sorted(reached) if there in flash]
    return out


def stack(report: Report, folder: Path, budget: dict[str, object], calls: stack_use.Indirect) -> stack_use.Graph | None:
    """One context of each level may be interrupted by one of the next: their depths add up. Each interrupt also
    costs what the processor pushes, with the floating-point registers if it has any, and a word of alignment."""
    image = report.image
    graph = stack_use.Graph(image, calls)
    levels: list[list[str]] = budget["levels"]  # type: ignore[assignment]
    entries = {name: image.symbols[name] & ~1 for level in levels for name in level if name in image.symbols}
    try:
        graph.build(list(entries.values()))
    except RunFailed as error:
        report.findings.append(f"stack: {error}")
        return None
    frame = (26 if image.has_fpu() else 8) * 4 + 4  # ARMv7-M B1.5.6 and B1.5.7
    for k, level in enumerate(levels):
        known = [name for name in level if name in entries]
        if not known:
            report.findings.append(f"stack: none of {', '.join(level)} is in the image")
            continue
        for name in known:
            graph.total(entries[name])
        # A handler that begins a fresh stack (a fault) costs the others nothing but what the processor pushes.
        deepest = {name: 0 if entries[name] in graph.fresh_stack else graph.total(entries[name]) for name in known}
        worst = max(known, key=lambda name: deepest[name])
        report.contexts.append(Context(level, deepest[worst], graph.deepest_path(entries[worst]), frame if k else 0))
    report.stack_needed = sum(c.deepest + c.frame for c in report.contexts)
    report.stack_reserved = image.symbols.get("stack_top", 0) - image.symbols.get("stack_bottom", 0)
    if report.stack_needed > report.stack_reserved:
        report.findings.append(f"stack: {report.stack_needed} bytes can be needed, {report.stack_reserved} are there")
    report.findings += [f"recursion: {cycle}" for cycle in graph.cycles]
    report.findings += [f"pointer: {line}" for line in sorted(set(graph.unlisted))]
    unused = graph.unlisted_addresses(handlers(image, entries, report.findings))
    report.findings += [f"pointer: the address of {name} is kept, but it is the target of no line in {calls.path.name}; "
                        f"add {name} there to the line of the function that calls it, or to the @set that this line names"
                        + (" (@listings for reply_list())" if name.endswith("_line") else "") for name in unused]
    report.frames_agree, differ = stack_use.compare_with_compiler(graph, folder)
    report.findings += [f"stack: {line}" for line in differ]
    report.functions, report.used_lines = len(graph.nodes), calls.used
    report.pointer_calls = sum(1 for node in graph.nodes.values() for site in node.sites if site.target is None)
    return graph


def handlers(image: Image, entries: dict[str, int], findings: list[str]) -> set[int]:
    """Handlers that the vector table leads to; each must be in a level."""
    words, at = image.words(), image.symbols.get("vectors")
    out: set[int] = set()
    if at is None:
        findings.append("stack: the image has no symbol `vectors`")
        return out
    address = at + 4
    while words.get(address, 0) == 0 or (words[address] & ~1) in image.functions:
        if address not in words or address - at >= 4 * 256:
            break
        if words[address]:
            out.add(words[address] & ~1)
        address += 4
    for start in sorted(out - set(entries.values())):
        findings.append(f"stack: the vector table leads to {image.functions[start].name}, which is in no level of "
                        "the budget file")
    return out


def over_budget(report: Report, budget: dict[str, object], section: str) -> list[str]:
    """section: where the limits of layers are written, for a layer that has none yet."""
    out = []
    limits: dict[str, list[int]] = budget.get("layers", {})  # type: ignore[assignment]
    for layer, sizes in report.layers.items():
        if layer in ("fill", "script", "workspace") or "layers" not in budget:
            continue
        if layer not in limits:
            row = ", ".join(str(-(-size // STEP) * STEP) for size in (sizes.text, sizes.data, sizes.bss))
            out.append(f"budget: layer {layer} has no row in {section}; it takes {sizes.text} bytes of text, {sizes.data} of data, "
                       f"{sizes.bss} of bss: write  {layer} = [{row}]")
            continue
        for what, have, limit in zip(("text", "data", "bss"), (sizes.text, sizes.data, sizes.bss), limits[layer]):
            if have > limit:
                out.append(f"budget: {what} of {layer} is {have}, {limit} allowed")
    for what, have in (("flash", report.flash()), ("ram", report.ram()), ("ccm", report.ccm())):
        if have > int(budget.get(what, have)):  # type: ignore[call-overload]
            out.append(f"budget: {what} is {have}, {budget[what]} allowed")
    promised = sum(budget.get("families", {}).values())  # type: ignore[attr-defined]
    if promised and report.flash() + promised > int(budget["flash"]):  # type: ignore[call-overload]
        out.append(f"budget: flash is {report.flash()}, and {promised} are kept for families to come; "
                   f"{budget['flash']} allowed")
    for what, have in (("workspace", report.workspace()), ("sram_free", report.sram_free())):
        if have < int(budget.get(what, have)):  # type: ignore[call-overload]
            out.append(f"budget: {what.replace('_', ' ')} is {have}, at least {budget[what]} wanted")
    return out


def unused_lines(reports: list[Report], calls_file: Path = CALLS) -> list[str]:
    """Lines of the list that no image needs any more."""
    used = set().union(*(r.used_lines for r in reports)) | {"nobody"}
    return [f"pointer: the line of {name} in {calls_file.name} is used by no image; delete it"
            for name in stack_use.read_list(calls_file, kind_tables.sets()).targets if name not in used]
