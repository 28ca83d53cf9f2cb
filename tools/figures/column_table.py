#!/usr/bin/python3
"""Starts both columns up at an operating point over thirty seeds, and writes the results and how the loops do after a feed
disturbance to tests/campaign/results/commissioning-columns.md; with another number of seeds only to the terminal.

usage: column_table.py [SEEDS]      (needs reflux-sim-memory of the host build; nothing is built here)
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from research import commissioning_columns  # noqa: E402

SEEDS = 30


def main() -> int:
    if len(sys.argv) > 2 or not all(a.isdigit() and int(a) for a in sys.argv[1:]):
        print(__doc__)
        return 0 if sys.argv[1] in ("--help", "-h") else 2
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else SEEDS
    text = commissioning_columns.text(seeds)
    if seeds == SEEDS:
        commissioning_columns.RESULT.write_text(text, encoding="utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
