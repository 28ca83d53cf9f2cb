#!/usr/bin/python3
"""Runs one scenario on two firmwares and asks whether their logs are the same, bit for bit.

usage: same_log.py SCENARIO.toml FIRMWARE FIRMWARE      (firmwares as for tools/run; nothing is built here)
"""

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux_tools import compare, runner, scenario  # noqa: E402
from reflux_tools.errors import RunFailed, UserError  # noqa: E402


def main() -> int:
    if len(sys.argv) != 4:
        print(__doc__.strip().splitlines()[-1], file=sys.stderr)
        return 2
    wanted = scenario.load(Path(sys.argv[1]))
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        places = []
        for number, firmware in enumerate(sys.argv[2:4]):
            place = Path(folder) / f"{number}-{firmware}"
            result = runner.run(replace(wanted, firmware=firmware), runner.Options(place, quiet=True))
            print(f"{firmware}: {result.facts['samples']} samples in {result.facts['wall_s']} s", flush=True)
            places.append(str(place))
        return compare.compare_command(*places)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (RunFailed, UserError) as error:
        print(f"same_log.py: {error}", file=sys.stderr)
        sys.exit(1)
