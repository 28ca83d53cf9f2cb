"""Use of the manipulated variables in a run: how often one sat at a limit of its own, and how far they travelled."""

from __future__ import annotations

from typing import Any

from reflux import metrics, runner
from research import best_inputs

NEAR = 1e-4  # of the range between the limits: what counts as at one


def told(result: runner.Result, spans: list[tuple[float, float]]) -> dict[str, Any]:
    """spans: s, from and to. `at_limit`: part of the samples in which a command of any loop's MV is at its limit; `moves`: by MV, sum of the
    magnitudes of the changes of its command, in its unit."""
    numbers = {line.text.split()[1]: line.text.split()[2] for line in result.scenario.config if line.text.startswith("set ")}
    t = result.log.numbers("time")
    inside = [k for k, now in enumerate(t) if any(first <= now <= last for first, last in spans)]
    held: set[int] = set()
    moves = {}
    for loop in result.scenario.loops:
        lo, hi = (best_inputs.value_of(numbers, loop.mv, what) for what in ("min", "max"))
        u, near = result.log.numbers(f"{loop.mv}.cmd"), NEAR * (hi - lo)
        held |= {k for k in inside if u[k] <= lo + near or u[k] >= hi - near}
        moves[loop.mv] = sum(metrics.travel([u[k] for k in inside if first <= t[k] <= last]) for first, last in spans)
    return {"at_limit": len(held) / max(1, len(inside)), "moves": moves}
