#!/usr/bin/python3
"""Renews the table of commands in docs/use/console.md: adds a row for each command of firmware/console/commands.h that has none, and
takes out the rows of commands that are gone. Rows that are there stay as they are written.

    tools/figures/command_table.py [BUILD]      BUILD: a host build folder, build/host by default
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "use" / "console.md"
BEGIN, END = "<!-- commands: begin -->\n", "<!-- commands: end -->"
HEADER = ["| command | what |\n", "|---|---|\n"]


def renewed(declared: list[str], page: list[str]) -> list[str]:
    """The rows of the page in the order of the declared commands; the declared row where the page has none."""
    def name(row: str) -> str:
        return re.match(r"\| `([\w-]+)", row)[1]
    rows: list[str] = []
    for row in declared:
        rows += [old for old in page if name(old) == name(row)] or [row]
    return rows


def main() -> int:
    if len(sys.argv) > 2 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0
    build = pathlib.Path(sys.argv[1]) if len(sys.argv) == 2 else ROOT / "build" / "host"
    made = subprocess.run(["cmake", "--build", str(build), "--target", "command_table"], stdout=subprocess.DEVNULL)
    if made.returncode:
        print(f"command_table.py: {build} is no build folder that can make `command_table`; "
              "configure one with `cmake --preset host`", file=sys.stderr)
        return 1
    declared = subprocess.run([str(build / "command_table")], check=True, capture_output=True, text=True).stdout
    text = PAGE.read_text()
    if BEGIN not in text or END not in text:
        print(f"command_table.py: {PAGE} has no marks around the table", file=sys.stderr)
        return 1
    head, rest = text.split(BEGIN, 1)
    table, tail = rest.split(END, 1)
    rows = [row for row in table.splitlines(keepends=True) if row.startswith("| `")]
    rows = renewed(declared.splitlines(keepends=True), rows)
    PAGE.write_text(head + BEGIN + "\n" + "".join(HEADER + rows) + "\n" + END + tail)
    return 0


if __name__ == "__main__":
    sys.exit(main())
