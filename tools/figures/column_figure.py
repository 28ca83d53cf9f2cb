#!/usr/bin/python3
"""Draws docs/figures/column.png: the profile of the splitter, as tools/column does.

usage: tools/figures/column_figure.py [PICTURE.png]
       (default docs/figures/column.png)
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import build, cmd_column, column_file, paths  # noqa: E402


def main() -> int:
    if len(sys.argv) > 2 or "--help" in sys.argv or "-h" in sys.argv:
        print(__doc__.strip())
        return 0 if "--help" in sys.argv or "-h" in sys.argv else 2
    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else paths.figures() / "column.png"
    build.build("host", ("reflux-sim",), quiet=True)
    cmd_column.draw(column_file.read("splitter"), cmd_column.profile("splitter", []), picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
