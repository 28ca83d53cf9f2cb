#!/usr/bin/python3
"""Runs one scenario on several firmwares and asks whether their logs are the same, bit for bit.

Firmwares are named as for tools/run; nothing is built here. A plant sends a sample again when a busy
machine, or a new board that erases its flash, is late with the answer: of the events that a log counts, these are left out.
"""

import argparse
import re
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import compare, logs, runner, scenario  # noqa: E402
from reflux.errors import RunFailed, UserError  # noqa: E402


def leave_out_repeats(result: runner.Result) -> int:
    """Counts no events of samples that were sent again in log.csv; returns how many there were."""
    repeated = [int(number) for number in re.findall(r" SAMPLE_TWICE \S+ (\d+) ", (result.out / "transcript.txt").read_text())]
    number, events = result.log.columns.index("number"), result.log.columns.index("fw.ev")
    for row in (row for row in result.log.rows if row[events]):
        row[events] = str(int(row[events]) - sum(sample < int(row[number]) for sample in repeated))
    logs.write_csv(result.log, result.out / "log.csv")
    return len(repeated)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--until", type=float, help="plant time at which the run ends, s (default: the scenario's)")
    parser.add_argument("--line", action="append", default=[], help="console line that is sent at 0 s")
    parser.add_argument("scenario", type=scenario.find, help="a .toml file, or the name of one in host_sim/scenarios")
    parser.add_argument("twin", help="firmware whose log the others shall have")
    parser.add_argument("firmware", nargs="+")
    options = parser.parse_args()
    wanted = scenario.load(options.scenario)
    wanted = replace(wanted, lines=(*(scenario.Line(0.0, line) for line in options.line), *wanted.lines))
    if end := options.until:
        wanted = replace(wanted, duration_s=end, lines=tuple(line for line in wanted.lines if line.at_s < end),
                         events=tuple(event for event in wanted.events if event.at_s < end))
    firmwares = [options.twin, *options.firmware]
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        places = [Path(folder) / f"{number}-{firmware}" for number, firmware in enumerate(firmwares)]
        for firmware, place in zip(firmwares, places):
            result = runner.run(replace(wanted, firmware=firmware), runner.Options(place, quiet=True))
            repeats = leave_out_repeats(result)
            print(f"{firmware}: {result.facts['samples']} samples in {result.facts['wall_s']} s, {repeats} sent again", flush=True)
        return max(compare.compare_command(str(places[0]), str(place)) for place in places[1:])


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (RunFailed, UserError) as error:
        print(f"same_log.py: {error}", file=sys.stderr)
        sys.exit(1)
