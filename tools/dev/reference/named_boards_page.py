"""The page on boards that people can buy: what of their pins is taken, which buses and pins are left, and the wiring of the pilot column."""

from __future__ import annotations

from typing import Any

from dev.reference.markdown import code, contents, page, table
from dev.reference.tables import Rows, notes
from reflux.errors import RunFailed
from reflux.paths import SCENARIOS

SECTIONS = ("Boards", "Console and USB", "The pilot column", "Parts")
CONSOLE = ("PA9", "PA10")
CRYSTALS_MHZ = (8, 12, 16, 25)  # that the clock of the STM32F405 knows (hal/stm32f405/clock.c)
SETTINGS = "pilot-pins.conf"
USES = {"select": "select pin of {}", "pin": "output {}"}


def named_boards(rows: Rows) -> str:
    noted = notes("named-boards")
    free, buses = list(rows["free"][0]), {name: at for name, _, *at in rows["bus"]}
    wired = pilot_pins(buses)
    boards = [row(board, free, buses) for board in noted["board"]]
    for board in noted["board"]:
        if suits(board):
            check(board, wired)
    return page(
        ["# Boards to buy"], noted["about"]["head"].strip().splitlines(), contents([(section, []) for section in SECTIONS]),
        ["## Boards"], table(("board", "chip", "crystal, MHz", "suits", "taken pins", "buses without a taken pin", "other free pins", "read in"), boards),
        ["## Console and USB"], noted["about"]["usb"].strip().splitlines(),
        ["## The pilot column"], noted["about"]["pilot"].strip().splitlines(),
        ["![Wiring: two MAX31865 on spi1, two solid-state relays on PB0 and PB1](../figures/pilot-wiring.svg)"],
        table(("pin", "what is there"), [(code(pin), what) for pin, what in wired]),
        ["## Parts"], table(("part", "number", "note"), [tuple(part) for part in noted["about"]["parts"]]))


def suits(board: dict[str, Any]) -> bool:
    return str(board["suits"]).startswith("yes")


def row(board: dict[str, Any], free: list[str], buses: dict[str, list[str]]) -> tuple[str, ...]:
    taken = board["taken"]
    by_what: dict[str, list[str]] = {}
    for pin, what in taken.items():
        by_what.setdefault(what.replace("?", " (unverified)"), []).append(pin)
    words = "; ".join(f"{', '.join(map(code, pins))}: {what}" for what, pins in by_what.items())
    left = ", ".join(code(name) for name, at in buses.items() if not set(at) & set(taken))
    others = ", ".join(code(pin) for pin in free if pin not in taken)
    return (board["name"], board["chip"], str(board["crystal"]), board["suits"], words, *((left, others) if suits(board) else ("-", "-")), board["source"])


def pilot_pins(buses: dict[str, list[str]]) -> list[tuple[str, str]]:
    """Pins of the pilot column with what is at each, as its settings have them."""
    words = [line.split() for line in (SCENARIOS / SETTINGS).read_text(encoding="utf-8").splitlines() if line.startswith(("set chan", "set out"))]
    rows: dict[str, dict[str, str]] = {}
    for _, name, value in words:
        group, _, what = name.partition(".")
        rows.setdefault(group, {})[what] = value
    out = [(at, f"{line} of {name}") for name in dict.fromkeys(own["bus"] for own in rows.values() if "bus" in own)
           for line, at in zip(("clock", "data in", "data out"), buses[name])]
    return out + [(own[what], USES[what].format(own["name"])) for own in rows.values() for what in USES if what in own]


def check(board: dict[str, Any], wired: list[tuple[str, str]]) -> None:
    """A board that suits has a crystal that the firmware knows, and its console and the pilot column are at pins that nothing else has."""
    missing = [pin for pin in (*CONSOLE, *(pin for pin, _ in wired)) if not board["taken"].get(pin, "?").endswith("?")]
    if missing or board["crystal"] not in CRYSTALS_MHZ:
        raise RunFailed(f"{board['name']}: {', '.join(missing) or board['crystal']} does not suit")
