"""Cost of the simulated columns: the part of tools/bench about host_sim, from tests/bench/plant_cost.c."""

from __future__ import annotations

import functools
import math
import re
import subprocess
import sys

from reflux import build
from reflux.errors import RunFailed
from reflux.paths import ROOT

Part = tuple[str, list[str], list[list[str]]]
SCIPY_MINUTES = "15"


def parts() -> list[Part]:
    """The tables, each with its title and header."""
    program = str(build.find_program("host", "tests/unit/plant_cost"))
    return [
        ("Plant time per wall time, both inputs at rest or moving by up to 1 % every tick",
         ["plant", "inputs", "30 s ticks", "10 s ticks", "1 s ticks"], speed_rows(program)),
        ("A day of the splitter beside scipy's BDF at equal error, inputs changing every 15 minutes, 30 s ticks",
         ["by", "tolerance", "largest error", "s of processor time", "times faster"], scipy_rows(program)),
        ("Cost of an integration step against the size of a column",
         ["column", "varied", "microseconds per step", "exponent fitted"], size_rows(program)),
        ("Plant time per wall time of 100 stages and 3 components, both inputs moving by up to 1 % every 30 s",
         ["column", "times real time"], hundred_rows(program)),
    ]


def facts(command: list[str]) -> list[str]:
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RunFailed(f"{command[0]}: {(done.stderr.strip().splitlines() or ['failed'])[-1]}")
    return done.stdout.splitlines()


def speed_rows(program: str) -> list[list[str]]:
    rows = []
    for plant in ("pilot", "splitter"):
        found: dict[str, list[str]] = {}
        for line in facts([program, plant]):
            words = line.split()
            found.setdefault(words[1], []).append(f"{int(words[-1]):,}")
        rows += [[plant, inputs, *found[inputs]] for inputs in ("steady", "moving")]
    return rows


def scipy_rows(program: str) -> list[list[str]]:
    script = str(ROOT / "tests" / "bench" / "splitter_scipy.py")
    text = facts([sys.executable, script, program, SCIPY_MINUTES])[-1]
    value = dict(zip(text.split()[::2], text.split()[1::2]))
    return [["this simulator", f"relative {value['plant_tolerance']}", f"{value['plant_error_K']} K", value["plant_s"],
             value["ratio"]],
            ["scipy's BDF, vectorised right-hand side, batched Jacobian of differences",
             f"relative {value['scipy_tolerance']}", f"{value['scipy_error_K']} K", value["scipy_s"], "1"]]


SIZES = re.compile(r"(\S+) stages (\d+) components (\d+) us_per_step ([\d.]+) .* times_real_time (\d+)")


@functools.lru_cache
def sizes(program: str) -> dict[str, list[tuple[int, int, float, int]]]:
    """Per sort of column: stages, components, microseconds per step, times real time."""
    points: dict[str, list[tuple[int, int, float, int]]] = {}
    for line in facts([program, "--sizes"]):
        found = SIZES.fullmatch(line)
        if found is None:
            raise RunFailed(f"plant_cost --sizes said: {line}")
        points.setdefault(found[1], []).append((int(found[2]), int(found[3]), float(found[4]), int(found[5])))
    return points


def size_rows(program: str) -> list[list[str]]:
    rows = []
    for sort, points in sizes(program).items():
        stages = [(n, us) for n, _, us, _ in points[:5]]
        components = [(c, us) for _, c, us, _ in points[5:9]]
        rows += [[sort, f"{what}: {', '.join(str(n) for n, _ in curve)}", ", ".join(f"{us:.1f}" for _, us in curve),
                  f"{exponent(curve):.2f}"]
                 for what, curve in (("stages, 3 components", stages), ("components, 40 stages", components))]
    return rows


def hundred_rows(program: str) -> list[list[str]]:
    return [[sort, f"{points[-1][3]:,}"] for sort, points in sizes(program).items()]


def exponent(curve: list[tuple[int, float]]) -> float:
    """Slope of the straight line through the logarithms."""
    x = [math.log(n) for n, _ in curve]
    y = [math.log(us) for _, us in curve]
    mx, my = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)
