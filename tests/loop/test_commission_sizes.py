#!/usr/bin/python3
"""Automatic start-up of plants of any p x m up to 16 x 16: corners of a plant whose inputs each have an output of their own.
The whole firmware, over the bytes of both its lines. Sensors without noise.

usage: test_commission_sizes.py      (needs reflux-sim-memory of the host build; nothing is built here)
"""

import json
import random
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from commissioning import Plant, Run, whole  # noqa: E402

SIXTEEN = Path(__file__).resolve().parent / "data" / "sixteen.json"
DECOUPLED = 8       # loops that the decoupler spans
LEAST_GAIN = 0.01   # smaller ones are hardly above what 12 bits leave


def corner(folder: str, p: int, m: int) -> Plant:
    """Its first p outputs and m inputs."""
    plant = json.loads(SIXTEEN.read_text())
    plant["outputs"], plant["inputs"] = plant["outputs"][:p], plant["inputs"][:m]
    plant["elements"] = [row[:m] for row in plant["elements"][:p]]
    path = Path(folder) / f"corner-{p}x{m}.json"
    path.write_text(json.dumps(plant))
    return Plant(path)


class AnySize(unittest.TestCase):
    def started(self, p: int, m: int) -> None:
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            of = corner(folder, p, m)
            run = Run(of, whole(of), events=of.perfect_sensors())
        n = min(p, m)
        self.assertEqual(sorted(run.pairs()), sorted((f"y{k}", f"u{k}") for k in range(1, n + 1)))
        self.assertIsNotNone(run.first("TRIAL_KEPT"), run.first("TRIAL_FAILED"))
        self.assertEqual(run.first("TRIAL_KEPT").value, n)
        self.assertLessEqual(run.worst(), 1.0)
        decoupler = next(line for line in run.reply("commission proposal") if line.startswith("decoupler "))
        self.assertEqual("more loops than a decoupler spans" in decoupler, n > DECOUPLED, decoupler)
        found = run.elements()
        self.assertEqual(len(found), p * m)
        worst = [0.0, 0.0]
        for pair, (gain, lag, dead) in of.first_order().items():
            if abs(gain) < LEAST_GAIN:
                continue
            e = found[pair]
            worst[0] = max(worst[0], abs(e["gain"] / gain - 1.0))
            worst[1] = max(worst[1], abs(e["T"] - lag) / (lag + dead), abs(e["L"] - dead) / (lag + dead))
        self.assertLess(max(worst), 0.02, worst)
        print(f"commission {p} x {m}: {n} loops kept, {decoupler}; elements within {100 * worst[0]:.2f} % (gain), "
              f"{100 * worst[1]:.2f} % (times)")

    def test_sixteen_by_sixteen(self):
        self.started(16, 16)

    def test_one_input_or_one_output(self):
        for p, m in ((1, 1), (1, 16), (16, 1)):
            self.started(p, m)

    def test_as_many_loops_as_the_decoupler_spans_and_one_more(self):
        for p, m in ((8, 8), (9, 9), (9, 16), (16, 9)):
            self.started(p, m)

    def test_sizes_at_random(self):
        seed = random.randrange(1 << 30)
        print(f"seed {seed}")
        generator = random.Random(seed)
        for _ in range(6):
            self.started(generator.randint(1, 16), generator.randint(1, 16))


if __name__ == "__main__":
    unittest.main()
