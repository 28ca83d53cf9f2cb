#!/usr/bin/python3
"""Renews the table of parameters in docs/use/console.md from what the firmware declares.

    tools/figures/parameter_table.py [BUILD]      BUILD: a host build folder, build/host by default
"""
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "use" / "console.md"
BEGIN, END = "<!-- parameters: begin -->\n", "<!-- parameters: end -->"


def main() -> int:
    if len(sys.argv) > 2 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0
    build = pathlib.Path(sys.argv[1]) if len(sys.argv) == 2 else ROOT / "build" / "host"
    made = subprocess.run(["cmake", "--build", str(build), "--target", "parameter_table"],
                          stdout=subprocess.DEVNULL)
    if made.returncode:
        print(f"parameter_table.py: {build} is not a build folder that can make `parameter_table`; "
              "configure one with `cmake --preset host`", file=sys.stderr)
        return 1
    table = subprocess.run([str(build / "parameter_table")], check=True, capture_output=True,
                           text=True).stdout
    text = PAGE.read_text()
    if BEGIN not in text or END not in text:
        print(f"parameter_table.py: {PAGE} has no marks around the table", file=sys.stderr)
        return 1
    head, rest = text.split(BEGIN, 1)
    _, tail = rest.split(END, 1)
    PAGE.write_text(head + BEGIN + table + END + tail)
    return 0


if __name__ == "__main__":
    sys.exit(main())
