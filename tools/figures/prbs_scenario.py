#!/usr/bin/python3
"""A scenario for tools/run in which all inputs of a linear plant move at once, by the firmware's pseudorandom binary signals, for tools/identify
(docs/methods/difference-models.md).

    cmake --preset host && cmake --build --preset host --target libreflux
    tools/figures/prbs_scenario.py kotyk-column --amplitude 1 --out out/kotyk-prbs.toml

Writes the scenario and, beside it, the configuration of the board: channels alone, no loops. Inputs move by the amplitude about their nominal
values.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import identification, libreflux, plant_file  # noqa: E402
from reflux.errors import RunFailed, UserError  # noqa: E402
from reflux.paths import shown  # noqa: E402


def configuration(plant: dict) -> list[str]:
    lines = ["begin"]
    for kind, side in (("meas", "outputs"), ("mv", "inputs")):
        for k, c in enumerate(plant[side], 1):
            lines += [f"set {kind}{k}.{name} {c[name]}" for name in ("name", "unit", "lo", "hi")]
            if kind == "mv":
                lines += [f"set mv{k}.min {c['lo']}", f"set mv{k}.max {c['hi']}", f"set mv{k}.safe {c['nominal']}"]
    return [*lines, "apply"]


def scenario(name: str, plant: dict, console: str, u, clock: int) -> list[str]:
    tick = plant["tick_s"]
    lines = [f'name = "{name}"', f'title = "{plant["title"]}: all inputs excited at once"', f'plant = "{plant["name"]}"',
             f"duration_s = {len(u) * clock * tick}", f'console = ["{console}"]', "line = ["]
    before: list = [None] * u.shape[1]
    for step, row in enumerate(u):
        for k, (c, move) in enumerate(zip(plant["inputs"], row)):
            if move != before[k]:
                lines.append(f'    {{ at_s = {step * clock * tick}, send = "out {c["name"]} {c["nominal"] + move:g}" }},')
        before = list(row)
    return [*lines, "]"]


def main() -> int:
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("plant", help="a linear plant of host_sim/plants with tick_s, 4 inputs at most")
    p.add_argument("--amplitude", type=float, required=True, help="of every input, in its unit")
    p.add_argument("--bits", type=int, default=8, help="of the register: 2^bits - 1 steps are a period (default 8)")
    p.add_argument("--clock", type=int, default=2, help="samples in a step (default 2)")
    p.add_argument("--periods", type=int, default=1, help="(default 1)")
    p.add_argument("--out", type=Path, required=True, metavar="TOML")
    options = p.parse_args()
    try:
        plant = json.loads((plant_file.PLANTS / f"{options.plant}.json").read_text(encoding="utf-8"))
        steps = (2**options.bits - 1) * options.periods
        u = identification.prbs(len(plant["inputs"]), steps, options.amplitude, bits=options.bits)[0]
        options.out.parent.mkdir(parents=True, exist_ok=True)
        console = options.out.with_suffix(".conf")
        console.write_text("\n".join(configuration(plant)) + "\n", encoding="utf-8")
        options.out.write_text("\n".join(scenario(options.out.stem, plant, console.name, u, options.clock)) + "\n", encoding="utf-8")
    except (OSError, KeyError, libreflux.Refused, UserError, RunFailed) as error:
        print(f"prbs_scenario.py: {error}", file=sys.stderr)
        return 1
    print(f"{shown(options.out)}: {len(u)} steps of {options.clock * plant['tick_s']} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
