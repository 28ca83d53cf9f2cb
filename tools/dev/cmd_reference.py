"""tools/reference: the pages of docs/reference, from the tables of the code."""

from __future__ import annotations

import argparse
from pathlib import Path

from dev.reference import firmware_pages
from dev.reference.board_page import virtual_board
from dev.reference.named_boards_page import named_boards
from dev.reference.pins_page import pins
from dev.reference.plant_page import plant_files
from dev.reference.scenario_page import scenario_files
from dev.reference.tables import rows_of, said_by
from reflux import build
from reflux.errors import UserError
from reflux.paths import ROOT, named, shown

FOLDER = ROOT / "docs" / "reference"
PROGRAMS = ("reference_tables", "plant_tables", "pin_tables")


def pages(folder: Path) -> dict[str, str]:
    """Text of each page by its name. folder: a build tree with the programs."""
    program = folder / PROGRAMS[0]
    rows, simulated, at_pins = rows_of(said_by(program)), rows_of(said_by(folder / PROGRAMS[1])), rows_of(said_by(folder / PROGRAMS[2]))
    return {
        "commands.md": firmware_pages.commands(rows),
        "parameters.md": firmware_pages.parameters(rows),
        "events.md": firmware_pages.events(rows, program),
        "errors.md": firmware_pages.errors(rows),
        "plant-files.md": plant_files(simulated),
        "scenario-files.md": scenario_files(simulated),
        "pins.md": pins(at_pins),
        "named-boards.md": named_boards(at_pins),
        "virtual-board.md": virtual_board(),
    }


def differing(made: dict[str, str], folder: Path) -> list[str]:
    """Names of pages that are not in the folder as they are made today."""
    return [name for name, text in made.items() if not (folder / name).is_file() or (folder / name).read_text(encoding="utf-8") != text]


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/reference",
        description="Writes the pages of docs/reference (commands, parameters, events, refusals, plant and scenario files, pins, boards to buy, virtual board) from the tables "
        "and comments of the code and from the notes in docs/reference/notes. Builds what prints the tables first.")
    p.add_argument("--check", action="store_true", help="write nothing; name the pages that differ, status 1 where there are any")
    p.add_argument("--out", type=named, metavar="FOLDER", default=FOLDER, help="where the pages are put (default docs/reference)")
    options = p.parse_args(arguments)
    if options.out.exists() and not options.out.is_dir():
        raise UserError(f"--out {shown(options.out)} is a file; name a folder")
    made = pages(build.build("host", PROGRAMS, quiet=True))
    wrong = differing(made, options.out)
    if options.check:
        for name in wrong:
            print(f"{shown(options.out / name)} differs from the code; tools/reference writes it anew")
        return 1 if wrong else 0
    options.out.mkdir(parents=True, exist_ok=True)
    for name in wrong:
        (options.out / name).write_text(made[name], encoding="utf-8")
    print(f"{len(made)} pages, {len(wrong)} changed: {shown(options.out)}")
    return 0
