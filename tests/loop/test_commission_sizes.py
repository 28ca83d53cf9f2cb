#!/usr/bin/python3
"""Automatic start-up of plants of any p x m up to 16 x 16: corners of a plant whose inputs each have an output of their own,
and columns side by side that do not act on each other. The whole firmware, over the bytes of both its lines. Sensors
without noise where nothing else is said.

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
from reflux.commission import results  # noqa: E402

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
        self.assertEqual("too many loops for a decoupler" in decoupler, n > DECOUPLED, decoupler)
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


# (gain in spans, lag, dead time): host_sim/plants/wood-berry.json, with seconds for its minutes
COLUMN = (((1.6, 16.7, 1.0), (-2.3625, 21.0, 3.0)), ((0.66, 10.9, 7.0), (-1.94, 14.4, 3.0)))


def columns(folder: str, times: list[float]) -> Plant:
    """One column for each of times, that many times as slow."""
    channel = {"unit": "%", "lo": 0, "hi": 100, "nominal": 50}
    n = 2 * len(times)
    elements = [[None] * n for _ in range(n)]
    for b, slower in enumerate(times):
        for j, row in enumerate(COLUMN):
            for i, (gain, lag, dead) in enumerate(row):
                elements[2 * b + j][2 * b + i] = {"gain": gain, "lags": [lag * slower], "dead_time": dead * slower}
    plant = {"name": "columns", "title": f"{len(times)} columns side by side", "source": "Wood and Berry's, several times",
             "ours": "everything but the elements", "time_unit": "s", "tick_s": 1,
             "inputs": [{"name": f"u{k + 1}", **channel} for k in range(n)],
             "outputs": [{"name": f"y{k + 1}", **channel, "noise": 0.02, "resolution": 0.01} for k in range(n)],
             "model": "transfer", "elements": elements}
    path = Path(folder) / "columns.json"
    path.write_text(json.dumps(plant))
    return Plant(path)


class SideBySide(unittest.TestCase):
    def started(self, times: list[float], **how) -> results.Proposal:
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            of = columns(folder, times)
            run = Run(of, whole(of), **({"events": of.perfect_sensors()} | how))
        self.assertIsNotNone(run.first("TRIAL_KEPT"), run.first("TRIAL_FAILED"))
        self.assertEqual(run.first("TRIAL_KEPT").value, 2 * len(times))
        proposal = results.proposal_of(run.reply("commission proposal"))
        worst, nominal, *_ = proposal.sensitivity
        print(f"commission {len(times)} columns, times {times}: Ms {worst:.2f}, of the model {nominal:.2f}, gains lowered to "
              f"{proposal.lowered:.2f}; IAE {sorted(round(x.iae) for x in proposal.loops)}")
        return proposal

    def test_columns_that_do_not_act_on_each_other_get_the_settings_of_one_alone(self):
        one = self.started([1.0])
        for n in (2, 4, 8):
            several = self.started([1.0] * n)
            self.assertLessEqual(several.sensitivity[0], 2.0)
            self.assertEqual(len(several.loops), 2 * n)
            for x in several.loops:
                alone = one.loops[(int(x.measurement[1:]) - 1) % 2]
                for have, want in ((x.gain, alone.gain), (x.ti_s, alone.ti_s), (x.iae, alone.iae)):
                    self.assertAlmostEqual(have / want, 1.0, delta=0.15, msg=x.measurement)

    def test_noise_joins_no_columns(self):
        one = self.started([1.0])
        for seed in (1, 2, 3):
            several = self.started([1.0] * 4, events=[], noise=1.0, seed=seed)
            self.assertLessEqual(several.sensitivity[0], 2.05)
            for x in several.loops:
                alone = one.loops[(int(x.measurement[1:]) - 1) % 2]
                self.assertLess(x.iae / alone.iae, 1.5, x.measurement)

    def test_each_has_the_settings_that_it_has_alone(self):
        """Sampled every second, half a second is dead time to the fast one and nothing to the slow one."""
        alone = [x for t in (0.2, 4.0) for x in self.started([t]).loops]
        for have, want in zip(sorted(self.started([0.2, 4.0]).loops, key=lambda x: int(x.measurement[1:])), alone):
            self.assertAlmostEqual(have.gain / want.gain, 1.0, delta=0.05)
            self.assertAlmostEqual(have.ti_s / want.ti_s, 1.0, delta=0.05)


if __name__ == "__main__":
    unittest.main()
