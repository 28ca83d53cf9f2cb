"""The page on plant files, from the tables that the simulator's reader takes."""

from __future__ import annotations

from dev.reference.markdown import code, contents, page, table
from dev.reference.tables import Rows

HEADER = ("key", "what", "unit", "allowed", "default", "type")


def object_rows(rows: Rows, title: str) -> list[tuple[str, ...]]:
    """A row for each key of an object."""
    out = []
    for of, name, kind, unit, allowed, default, about, models in rows["key"]:
        if of == title:
            models = f"model {', '.join(models.split())}: " if models else ""
            out.append((code(name), models + about, unit, allowed, default, kind))
    return out


def unit_rows(rows: Rows) -> list[tuple[str, ...]]:
    """A row for each measure: its units with what one of them is in SI."""
    found: dict[tuple[str, str], list[str]] = {}
    for name, measure, si, factor, offset in rows["unit"]:
        same = factor == "1" and offset == "0"
        note = "" if same else f" (x + {offset} {si})" if offset != "0" else f" ({factor} {si})"
        found.setdefault((measure, si), []).append(code(name) + note.replace(" -)", ")"))
    return [(measure, si, ", ".join(units)) for (measure, si), units in found.items()]


def _limits(low: str, high: str) -> str:
    return f"{low} or more" if float(high) >= 1e12 else f"{low} .. {high}"


def plant_files(rows: Rows) -> str:
    titles = {kind: [title for of, title, _ in rows["object"] if of == kind] for kind in ("linear", "column")}
    about = {title: words for _, title, words in rows["object"]}
    drives = [(code(name), measures, si, _limits(low, high), default, what) for name, measures, si, low, high, what, default, _ in rows["drive"]]
    sights = [(code(name), measures, si, ", ".join(map(code, keys.split())) or "-", what) for name, measures, si, _, _, what, _, keys in rows["sight"]]
    parts = []
    for heading, kind in (("Linear plants", "linear"), ("Columns", "column")):
        parts.append([f"## {heading}"])
        for title in titles[kind]:
            parts += [[f"### {title}"], [about[title]], table(HEADER, object_rows(rows, title))]
    return page(
        ["# Plant files"],
        ["Look up here a key of a plant's JSON file: its type, unit, limits and default. [linear-plants.md](../use/linear-plants.md) and",
         "[columns.md](../use/columns.md) say how to write one, with an example of each, and what is computed from it. A key that is not here is refused, and so is",
         "one given twice. What is not JSON is refused with `FILE:LINE:COLUMN`, what has the wrong type, size or value with the key's path:",
         "`$.elements[1][0].lags: 0 must be 1e-09 to 1e+06`. A unit `of the channel`, or `time_unit`, is the one that the file gives."],
        contents([("Linear plants", titles["linear"]), ("Columns", titles["column"]), ("Quantities that drive a column", []),
                  ("Quantities that are seen", []), ("Units of columns", [])]),
        *parts,
        ["## Quantities that drive a column"],
        ["`is` of an input or a disturbance, or a name in `constants`. Limits are in SI; the units that the file may give are [below](#units-of-columns)."],
        table(("is", "measure", "SI unit", "allowed", "needed, or default", "what"), drives),
        ["## Quantities that are seen"],
        ["`is` of an output or a truth, with the keys that say where."],
        table(("is", "measure", "SI unit", "with", "what"), sights),
        ["## Units of columns"],
        ["In brackets what one is in SI. Signs are transliterated: °C is read as degC, m³/h as m3/h. Mass and volume of a flow are at the stream's own composition."],
        table(("measure", "SI", "units"), unit_rows(rows)))
