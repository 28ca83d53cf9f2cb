"""A column's file, as far as the tools look into it: where it is, its feed stage, which output sees which stage."""

from __future__ import annotations

from dataclasses import dataclass

from reflux import plant_file
from reflux.errors import UserError
from reflux.paths import shown


@dataclass(frozen=True)
class ColumnFile:
    name: str
    title: str
    stages: int
    feed_stage: int
    measured: dict[str, int]  # temperatures of one stage: name, stage
    unmeasured: dict[str, int]  # truths, likewise
    products: tuple[str, ...]  # the first composition of the distillate and of the bottoms; a truth where none is measured


def read(name: str) -> ColumnFile:
    data, path = plant_file.load(name)
    if "column" not in data:
        raise UserError(f"{shown(path)}: is not a column (docs/use/columns.md): it has no key \"column\"")
    try:
        return _column(data)
    except (KeyError, TypeError, ValueError) as error:
        raise UserError(f"{shown(path)}: is not a sound column; reflux-sim --list {shown(path)} says what is wrong "
                        f"({type(error).__name__} {error})") from None


def _column(data: dict) -> ColumnFile:
    top = int(data["stages"])
    temperatures: dict[str, dict[str, int]] = {"outputs": {}, "truths": {}}
    products: dict[int, str] = {}
    for kind in ("outputs", "truths"):
        for view in data.get(kind, []):
            stage = view.get("stage")
            if view["is"] == "temperature" and stage is not None:
                temperatures[kind][view["name"]] = int(stage)
            if view["is"] in ("fraction", "log_fraction") and stage in (1, top):
                products.setdefault(stage, view["name"])
    return ColumnFile(str(data["name"]), str(data["title"]), top, int(data["feed_stage"]),
                      temperatures["outputs"], temperatures["truths"], tuple(products[s] for s in (top, 1) if s in products))


def sections(column: ColumnFile) -> dict[str, tuple[int, int]]:
    """First and last stage; the feed stage is the stripping section's."""
    return {"enriching": (column.feed_stage + 1, column.stages), "stripping": (1, column.feed_stage)}


def without_temperature(column: ColumnFile, chosen: tuple[str, ...]) -> list[str]:
    """A sentence for each section of which steepest() has chosen none: why, and which thermometers of the other section it has left out."""
    out = []
    left = {name: stage for name, stage in column.measured.items() if name not in chosen}
    for name, (low, high) in sections(column).items():
        if any(low <= stage <= high for stage in (*column.measured.values(), *column.unmeasured.values())):
            continue
        words = f"No thermometer in the {name} section, stages {low} to {high}"
        if left:
            seen = ", ".join(f"{x} on {'the feed stage' if stage == column.feed_stage else 'stage'} {stage}" for x, stage in left.items())
            counts = "; the feed stage counts as stripping" if column.feed_stage in left.values() else ""
            words += f": left out {'are' if len(left) > 1 else 'is'} {seen}, because {' and '.join(chosen)} is nearer the steepest place of its section{counts}"
        out.append(words + (f". --outputs {','.join((*left, *chosen))} takes all." if left else "."))
    return out


def steepest(column: ColumnFile, temperature: list[float]) -> tuple[str, ...]:
    """The temperature nearest the steepest place of each section, a measured one where the section has any; the enriching
    section first. A place is as steep as the stages beside it differ."""
    slope = [abs(temperature[min(s + 1, column.stages - 1)] - temperature[max(s - 1, 0)]) for s in range(column.stages)]
    chosen = []
    for low, high in sections(column).values():
        best = max(range(max(low, 2), min(high, column.stages - 1) + 1), key=lambda s: slope[s - 1])
        for seen in (column.measured, column.unmeasured):
            there = {name: stage for name, stage in seen.items() if low <= stage <= high}
            if there:
                chosen.append(min(there, key=lambda name: abs(there[name] - best)))
                break
    return tuple(chosen)
