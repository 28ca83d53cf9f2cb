"""The page on what can be at the board's own pins, and in a wiring file."""

from __future__ import annotations

from dev.reference.markdown import code, contents, page, table
from dev.reference.tables import Rows, check_same, notes
from reflux.io_check import ADVICE

SECTIONS = ("Pins", "Devices", "Faults", "Outputs", "Proof of outputs", "Wiring files")


def range_of(lo: str, hi: str, form: str) -> str:
    return form or f"{lo} .. {hi}"


def shared(rows: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Rows of several chips that differ in nothing but the chip, in one row."""
    chips: dict[tuple[str, ...], list[str]] = {}
    for chip, *rest in rows:
        chips.setdefault(tuple(rest), []).append(chip)
    return [(", ".join(names), *rest) for rest, names in chips.items()]


def pins(rows: Rows) -> str:
    noted = notes("pins")
    check_same("device", "pins", noted["device"], (name for name, *_ in rows["device"]))
    check_same("output", "pins", noted["output"], (name for name, *_ in rows["output"]))
    buses = [(code(name), what, ", ".join(map(code, at))) for name, what, *at in rows["bus"]]
    others = [("any other device or output", "", ", ".join(map(code, rows["free"][0]))), (code("analog"), "", ", ".join(map(code, rows["analog"][0])))]
    devices = [(code(name), code(bus), unit or "-", interval, noted["device"][name]) for name, bus, unit, interval in rows["device"]]
    outputs = [(code(name), noted["output"][name], ", ".join(map(code, at.split(", "))), ", ".join(map(code, numbers.split(", "))) if numbers else "-")
               for name, at, numbers in rows["output"]]
    properties = [(code(chip), code(name), unit or "-", range_of(lo, hi, form), first if first != "nan" else "by the seed")
                  for chip, name, unit, lo, hi, first, form in rows["property"]]
    inputs = [(code(chip), code(name), unit or "-", f"{lo} .. {hi}", what) for chip, name, unit, lo, hi, what in rows["input"]]
    return page(
        ["# At the board's own pins"],
        ["Look up here what the STM32F405 takes at its own pins, and how a simulated plant is wired to them. None of it has run on silicon.",
         "[parameters.md](parameters.md) has the settings `io`, `chan` and `out`."],
        contents([(section, []) for section in SECTIONS]),
        ["## Pins"], table(("bus", "lines", "pins"), buses + others),
        ["## Devices"], noted["about"]["devices"].strip().splitlines(),
        table(("`device`", "at", "measures", "least interval, ms", "settings"), devices),
        ["## Faults"], noted["about"]["faults"].strip().splitlines(), table(("reason", "look at"), [(text, ADVICE[text]) for (text,) in rows["fault"]]),
        ["## Outputs"], noted["about"]["outputs"].strip().splitlines(),
        table(("`kind`", "what it does", "pins", "numbers"), outputs),
        ["## Proof of outputs"], noted["about"]["proof"].strip().splitlines(),
        ["## Wiring files"], noted["about"]["wiring"].strip().splitlines(),
        table(("chip", "property", "unit", "range", "at first"), shared(properties)),
        table(("chip", "input or fault", "unit", "range", "what it is"), shared(inputs)))
