#!/usr/bin/python3
"""Writes tests/loop/data/sixteen.json: a made-up plant of 16 x 16, for what a board must bear. Strong on the diagonal, a little
everywhere else; lags of 8 to 16 s, dead times of 0 to 3 s, so that the tests of 16 inputs take an hour of plant time."""

import json
import random
from pathlib import Path

OUT = Path(__file__).resolve().parents[1] / "loop" / "data" / "sixteen.json"
N = 16


def element(r: random.Random, j: int, k: int) -> dict:
    gain = 1.0 if j == k else round(r.uniform(-0.12, 0.12), 3)
    return {"gain": gain, "lags": [round(r.uniform(8, 16), 1)], "dead_time": round(r.uniform(0, 3), 1)}


def main() -> None:
    r = random.Random(16)
    channel = {"unit": "%", "lo": 0, "hi": 100, "nominal": 50}
    plant = {
        "name": "sixteen",
        "title": "16 x 16, first order with dead time",
        "source": "made up by tests/reference/sixteen_plant.py",
        "ours": "everything",
        "time_unit": "s",
        "tick_s": 1,
        "inputs": [{"name": f"u{k + 1}", **channel} for k in range(N)],
        "outputs": [{"name": f"y{j + 1}", **channel, "noise": 0.02, "resolution": 0.01} for j in range(N)],
        "model": "transfer",
        "elements": [[element(r, j, k) for k in range(N)] for j in range(N)],
    }
    head = json.dumps({k: v for k, v in plant.items() if k != "elements"}, indent=2).removesuffix("\n}")
    rows = ",\n".join("    " + json.dumps(row) for row in plant["elements"])
    OUT.write_text(f'{head},\n  "elements": [\n{rows}\n  ]\n}}\n')


if __name__ == "__main__":
    main()
