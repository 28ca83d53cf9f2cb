"""The engineer's method: shapes that are found again, pairs, and loops that are sound on the true plant."""

import csv
import json
import random
import unittest

import support  # noqa: F401 - finds the tools

import numpy as np

from research import known_plants, startup_campaign, startup_engineer, startup_plants, startup_shapes
from research.startup_judge import Judge
from research.startup_linear import Linear

TICK_S = 5.0
NOISE = 0.002


def fitted(element: dict) -> startup_shapes.Shape:
    case = startup_plants.PlantCase("case", "case", startup_plants.transfer("case", TICK_S, [[element]]))
    return startup_shapes.choose(startup_engineer.reference_test(case, NOISE, 1)[0][0], TICK_S)


class Shapes(unittest.TestCase):
    def test_one_lag(self) -> None:
        e = fitted(startup_plants.lag(-1.4, 90, dead=25))
        self.assertEqual(e.kind, "lag")
        self.assertAlmostEqual(e.gain, -1.4, delta=0.01)
        self.assertAlmostEqual(e.lag_s, 90, delta=3)
        self.assertAlmostEqual(e.dead_s, 25, delta=2)
        self.assertLess(abs(e.gain + 1.4), 4.0 * e.gain_sd)

    def test_an_oscillation(self) -> None:
        e = fitted(startup_plants.damped(0.8, 60, 0.25, dead=20))
        self.assertEqual(e.kind, "second")
        self.assertAlmostEqual(e.damping, 0.25, delta=0.02)
        self.assertAlmostEqual(e.lag_s, 60, delta=1.5)

    def test_the_wrong_way_first(self) -> None:
        e = fitted(startup_plants.lag(1.0, 80, 60, dead=10, zero=-50))
        self.assertEqual(e.kind, "zero")
        self.assertLess(e.gain_zero, 0.0)
        self.assertAlmostEqual(e.gain, 1.0, delta=0.02)

    def test_fast_and_slow_in_one(self) -> None:
        e = fitted(startup_plants.two_scales(1.0, 50, 800, 0.6, dead=10))
        self.assertEqual(e.kind, "zero")
        self.assertAlmostEqual(e.gain, 1.0, delta=0.05)

    def test_an_integrator(self) -> None:
        e = fitted(startup_plants.integrator(0.001, dead=30))
        self.assertEqual(e.kind, "integrator")
        self.assertAlmostEqual(e.gain, 0.001, delta=2e-5)

    def test_nothing_is_found_where_nothing_is(self) -> None:
        case = startup_plants.PlantCase("case", "case", startup_plants.transfer("case", TICK_S, [[startup_plants.lag(1.0, 90, dead=20), None],
                                                                                               [None, startup_plants.lag(1.0, 50)]]))
        records = startup_engineer.reference_test(case, NOISE, 1)
        self.assertEqual(startup_shapes.choose(records[0][1], TICK_S).kind, "none")

    def test_the_test_stays_below_its_share_of_the_limit(self) -> None:
        for name in ("inverse", "overshoot", "gain-20"):
            for row in startup_engineer.reference_test(startup_plants.case(name), 0.0001, 1):
                for record in row:
                    self.assertLess(np.abs(record.y).max(), 1.02 * startup_engineer.SHARE * startup_engineer.LIMIT)


class Method(unittest.TestCase):
    def test_wood_and_berrys_pairs_are_found_and_the_loops_are_sound(self) -> None:
        data = json.loads((known_plants.PLANTS / "wood-berry.json").read_text(encoding="utf-8"))
        case = startup_plants.PlantCase("wood-berry", "column", data)
        found = startup_engineer.engineer(case, 0.003, 1)
        names = sorted((data["outputs"][c.output]["name"], data["inputs"][c.input]["name"]) for c in found.loops)
        self.assertEqual(names, known_plants.pairing("wood-berry"))
        self.assertTrue(startup_engineer.reaches(found, 2.2), found.verdict)
        self.assertGreater(found.verdict.ms, 1.7)  # not slower than it has to be

    def test_the_wrong_diagonal_is_left_alone(self) -> None:
        found = startup_engineer.engineer(startup_plants.case("wrong-diagonal-80"), 0.003, 2)
        self.assertEqual([(c.output, c.input) for c in found.loops], [(0, 1), (1, 0)])
        self.assertTrue(startup_engineer.reaches(found, 2.2), found.verdict)

    def test_a_design_keeps_the_bound_on_its_own_model(self) -> None:
        """On a plant of the shapes that the model has, without noise: the judge and the search agree."""
        case = startup_plants.case("gain-5")
        found = startup_engineer.engineer(case, 1e-6, 1)
        self.assertAlmostEqual(Judge(Linear(case.data)).judge(found.loops).ms, startup_engineer.MS, delta=0.06)

    def test_what_runs_away_has_no_reference_test(self) -> None:
        self.assertIsNone(startup_engineer.engineer(startup_plants.case("unstable"), 0.003, 1).verdict)

    def test_verdicts_that_are_kept_come_out_again(self) -> None:
        """Else: tools/campaign startup, and startup-engineer.csv into tests/campaign/results. Far from the bound, which rounding may cross."""
        with startup_campaign.KEPT_ENGINEER.open(encoding="utf-8", newline="") as lines:
            rows = list(csv.DictReader(lines))
        self.assertEqual({row["version"] for row in rows}, {startup_campaign.engineer_version()})
        clear = [row for row in rows if row["ms"] and abs(float(row["ms"]) - startup_engineer.MS) < 0.1 and row["plant"] != "column"]
        for row in random.Random(1).sample(clear, 3):
            job = startup_campaign.Job(row["plant"], int(row["seed"]), float(row["noise"]))
            found = startup_campaign.engineer_one(job)
            self.assertEqual(found["stable"], "yes", job)
            self.assertAlmostEqual(float(found["ms"]), float(row["ms"]), delta=0.1, msg=str(job))


if __name__ == "__main__":
    unittest.main()
