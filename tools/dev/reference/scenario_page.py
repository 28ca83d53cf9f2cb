"""The page on scenario files, from the table that their reader takes."""

from __future__ import annotations

import json
import math

from dev.reference.markdown import code, contents, page, table
from dev.reference.tables import Rows
from reflux import scenario_keys
from reflux.schema import REQUIRED, Key

HEADER = ("key", "what", "unit", "allowed", "default", "type")
SECTIONS = (
    ("", "Keys of the file", "These stand at the head of the file."),
    ("line", "Table line", "`[[line]]`: one console line. Lines of one time are sent in the order of the file."),
    ("event", "Table event", "`[[event]]`: one change of the plant."),
    ("loop", "Table loop", "`[[loop]]`: one loop that the report judges."),
    ("limit", "Table limit", "`[[limit]]`: limits of one loop; give one at least. A run that misses one ends with status 1."),
)


def allowed(key: Key) -> str:
    """Limits of a number, or the words to choose from."""
    if key.choices:
        return "|".join(key.choices)
    if key.kind not in ("number", "whole number"):
        return "-"
    words = []
    if key.above is not None:
        words.append(f"above {key.above:g}")
    if key.low > -math.inf:
        words.append(f"{key.low:g} or more")
    if key.high < math.inf or key.high_words:
        words.append(f"at most {key.high_words or f'{key.high:g}'}")
    return ", ".join(words) or "any"


def default(key: Key) -> str:
    if key.kind == "tables":
        return "none"
    if key.default is REQUIRED:
        return "required"
    return key.default_words or ("none" if key.default is None else code(json.dumps(key.default)))


FAULTS = "Faults of a board's hardware"


WIRING = "Faults of a wiring"
OF_WIRING = (
    ("a chip", "`missing`", "no chip is there; one that is back has just got power"),
    ("a chip", "`dead`", "the chip does not answer, and keeps its registers"),
    ("a sensor on `spi` or `i2c`", "`wrong`", "another chip is in its place"),
    ("a sensor on `i2c`, an `analog`", "`frozen`", "its result stays as it is"),
    ("a sensor behind a voltage", "`open`", "the wire is broken: 0 V, no current"),
    ("a sensor", "any other input or fault of its chip", "[pins.md](pins.md#wiring-files)"),
    ("a bus: `spi1`, `i2c1`, `wire1`", "`noise`", "probability that a bit is wrong"),
    ("a bus", "`stuck`", "the data line is low"),
    ("an `spi` bus", "`floats_low`", "a data line that nobody drives reads 0"),
    ("a load, not a stepper or a valve with two pins", "`shorted`", "on, whatever the pin does"),
    ("a load", "`broken`", "off, whatever the pin does; a valve stays where it is"),
    ("a load behind `ad5422`", "`missing`, `dead`, or another fault of its chip", "as those of a sensor's chip; [pins.md](pins.md#wiring-files)"),
)


def fault_rows(rows: Rows) -> list[tuple[str, ...]]:
    """rows: of the program that prints the simulator's tables."""
    return [(code(f"board.{name}"), about, unit or "-", limits, kind) for name, unit, limits, kind, about in rows["fault"]]


def scenario_files(simulated: Rows) -> str:
    parts = []
    for name, title, about in SECTIONS:
        rows = [(code(f"[[{key.name}]]" if key.kind == "tables" else key.name), key.about, key.unit, allowed(key), default(key), key.kind)
                for key in scenario_keys.TABLES[name].values()]
        parts += [[f"## {title}"], [about], table(HEADER, rows)]
    return page(
        ["# Scenario files"],
        ["Look up here a key of a scenario: a TOML file that `tools/run` runs. [scenarios.md](../use/scenarios.md) says how to write one, and what its report",
         "measures. A key that is not here is refused with the keys that are known, and so are wrong types, NaN, and times outside the run."],
        contents([(title, []) for title in (*(title for _, title, _ in SECTIONS), WIRING, FAULTS)]), *parts, [f"## {WIRING}"],
        ["In a run with `wiring` an event may set a fault by the names of the wiring file: `set = { \"T1.open\" = 1 }`, or `--event 900:T1.open=1` of",
         "`reflux-sim`. 1 sets it, 0 takes it back. The options of the instruments that go before the pins remain, `T1.bias` for example. `quality`, `nan`,",
         "`dropout` and `readback` are refused, because only the plant link can carry them; `dead` is that of the chip."],
        table(("of", "fault", "what it is"), OF_WIRING), [f"## {FAULTS}"],
        ["Keys of `set` in an `[[event]]`, and of `--event` of `reflux-sim`, with `--firmware board`",
         "([scenarios.md](../use/scenarios.md#faults-of-a-boards-hardware)). The last ones are settings of the faults that follow, with the value that holds",
         "without them in brackets."],
        table(("key", "what", "unit", "allowed", "type"), fault_rows(simulated)))
