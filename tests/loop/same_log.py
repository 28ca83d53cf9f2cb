#!/usr/bin/python3
"""Runs one scenario on two firmwares and asks whether their logs are the same, bit for bit.

usage: same_log.py [--until SECONDS] SCENARIO.toml FIRMWARE FIRMWARE [LINE ...]

Firmwares are named as for tools/run, LINEs are sent at 0 s, and it may end before the scenario does; nothing is built here.
"""

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import compare, runner, scenario  # noqa: E402
from reflux.errors import RunFailed, UserError  # noqa: E402


def main() -> int:
    given = sys.argv[1:]
    until = None
    if given[:1] == ["--until"]:
        until = float(given[1])
        given = given[2:]
    if len(given) < 3:
        print(__doc__.strip().splitlines()[2], file=sys.stderr)
        return 2
    wanted = scenario.load(Path(given[0]))
    lines = (*(scenario.Line(0.0, line) for line in given[3:]), *wanted.lines)
    if until is not None:
        wanted = replace(wanted, duration_s=until, events=tuple(e for e in wanted.events if e.at_s < until))
        lines = tuple(line for line in lines if line.at_s < until)
    wanted = replace(wanted, lines=lines)
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        places = []
        for number, firmware in enumerate(given[1:3]):
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
