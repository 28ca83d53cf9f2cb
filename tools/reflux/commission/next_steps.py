"""Advice where a start-up could not determine the pairs: longer tests, what else may settle it, and relay tests."""

from __future__ import annotations

import json
from typing import Iterable

from reflux.commission.progress import span_of_time
from reflux.commission.results import Model, Pairing
from reflux.paths import tool

Pair = tuple[str, str]


def lines(model: Model, pairing: Pairing, known: list[Pair], parameters: dict[str, str], places: int) -> list[str]:
    """known: the pairs that were stated; else the likeliest are proposed for relay tests."""
    pairs = known or [(measurement, source) for measurement, source, _, _ in pairing.pairs]
    out = [f"- {words}" for words in (*_longer(pairing), *_surer(model, pairing))]
    if not known:
        example = json.dumps(pairs or [("MEASUREMENT", "INPUT")])
        out.append("- Where you know which input belongs to which measurement, state it and begin anew: "
                   f"`[known]`, `pairs = {example}`")
    if not pairs:
        return [*out, "- Or tune one loop at a time by a relay test, which takes a pair for given: docs/methods/relay.md"]
    whose = "the pairs you stated" if known else "the likeliest pairs, which you must know to be right"
    out += [f"- Or tune one loop at a time by a relay test, which is much faster ({whose}), at the board's console",
            f"  ({tool('console')} PORT), one loop after the other; `commission` says how far it is, accept once it is ready:", ""]
    return out + [f"    {line}" for line in relay_lines(model, pairs, parameters, places)]


def _longer(pairing: Pairing) -> Iterable[str]:
    needed: dict[str, float] = {}
    for _, source, half_s in pairing.short:
        needed[source] = max(half_s, needed.get(source, 0.0))
    for source, half_s in needed.items():
        yield (f"Test {source} for longer: `[input.{source}]`, `time = {half_s:.4g}` ({span_of_time(half_s)}) or more; or leave "
               "out (`tested = false`) what answers so slowly")


def _surer(model: Model, pairing: Pairing) -> Iterable[str]:
    if not pairing.open or (pairing.short and not pairing.rivals):
        return
    cut = [i.name for i in model.inputs if "cut by" in i.remarks]
    if cut:
        yield f"The tests of {', '.join(cut)} were cut short by a limit: give the measurement a wider `limit`"
    yield (f"Make {', '.join(name for name, _, _ in pairing.open)} surer: larger steps (`step`), more `rounds`, or fewer "
           "measurements (`tested = false`)")


def relay_lines(model: Model, pairs: list[Pair], parameters: dict[str, str], places: int) -> list[str]:
    """Lines of the console. A pair that has a loop keeps it."""
    taken = {i for i in range(1, places + 1) if f"loop{i}.name" in parameters}
    free = iter(i for i in range(1, places + 1) if i not in taken)
    out = []
    for measurement, source in pairs:
        own = next((i for i in sorted(taken) if parameters.get(f"loop{i}.pv") == measurement
                    and parameters.get(f"loop{i}.out") == source), None)
        number = own or next(free, None)
        if number is None:
            continue  # no loop left for it
        name = parameters[f"loop{own}.name"] if own else measurement
        element = model.elements.get((measurement, source))
        action = "direct" if element and element.gain < 0 else "reverse"
        settings = {} if own else {"name": name, "pv": measurement, "out": source}
        sets = [f"set loop{number}.{key} {value}" for key, value in {**settings, "action": action}.items()]
        out += ["begin", *sets, "apply", f"commission relay {name}", "commission accept", ""]
    return out[:-1]
