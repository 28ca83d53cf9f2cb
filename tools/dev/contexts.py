"""The wall between main loop and tick, on the linked image: which layers' functions each context reaches.

The main loop enters the tick context through doors that hold the tick off (docs/inside/two-contexts.md); what a door runs counts as
the tick's. The work of blocks (jobs) belongs to the main loop. Which functions are the roots and the doors, and which layers must not
run where, stands in the table [contexts] of the budget file.
"""

from __future__ import annotations

from dev import stack_use
from dev.elf_image import Image
from reflux import memory_map

Rules = dict[str, list[str]]  # the table [contexts] of the budget file


def reach(graph: stack_use.Graph, starts: list[int], closed: set[int]) -> dict[int, int | None]:
    """Function -> who calls it, for all that can be reached from here without passing through `closed`."""
    caller: dict[int, int | None] = dict.fromkeys(starts)
    todo = list(starts)
    while todo:
        start = todo.pop()
        for _, callee in graph.edges.get(start, []):
            if callee not in caller and callee not in closed:
                caller[callee] = start
                todo.append(callee)
    return caller


def way(graph: stack_use.Graph, caller: dict[int, int | None], start: int) -> str:
    names = []
    step: int | None = start
    while step is not None:
        names.append(graph.nodes[step].function.plain())
        step = caller[step]
    return " <- ".join(names)


def check(image: Image, graph: stack_use.Graph, parts: list[memory_map.Placed], rules: Rules) -> list[str]:
    """A line for each function that runs where its layer must not."""
    text = sorted((p.address, p.address + p.size, memory_map.layer_of(p.owner)) for p in parts if p.kind == "text" and p.owner)
    out: list[str] = []

    def layer(address: int) -> str:
        return next((name for begin, end, name in text if begin <= address < end), "?")

    def starts(what: str) -> list[int]:
        lost = [name for name in rules[what] if name not in image.symbols]
        if lost:
            out.append(f"contexts: the image has no function {', '.join(lost)}, which [contexts] has under {what}")
        return [image.symbols[name] & ~1 for name in rules[what] if name in image.symbols]

    doors, main_loop, tick = starts("doors"), starts("main_loop"), starts("tick")
    for where, found, banned in (
            ("the main loop", reach(graph, main_loop, set(doors)), rules["not_in_the_main_loop"]),
            ("the tick", reach(graph, [*tick, *doors], set(main_loop)), rules["not_in_the_tick"])):
        for start in sorted(found):
            if layer(start) in banned:
                out.append(f"contexts: {layer(start)}/ must not run in {where}: {way(graph, found, start)}")
    return out
