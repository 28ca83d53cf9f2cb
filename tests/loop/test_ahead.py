#!/usr/bin/python3
"""The kind `ahead` on the nonlinear pilot column and on a second one, beside the loops' own PIs and a self-tuner in the same run: lines of the
campaign `state-ahead`, in both number formats. Every bound is what something else came to in that run, or half of it; what came out
stands in docs/methods/ahead.md."""

import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from research import cmd_campaign, self_tuning_campaign  # noqa: E402

CAMPAIGN = cmd_campaign.load("state-ahead")
FIRMWARES = ("memory", "host-fixed")
LOADS = ("feed flow", "feed composition", "weak heater")
AHEAD = "ahead, estimated states, tau 33, miss 85"


class Ahead(unittest.TestCase):
    done: dict = {}

    def result(self, part: str, name: str, firmware: str = "memory") -> dict:
        key = (part, name, firmware)
        if key not in self.done:
            variant = next(v for v in CAMPAIGN.variants if (v.part, v.name) == (part, name))
            self.done[key] = self_tuning_campaign.simulate(CAMPAIGN, variant, 1, (), firmware)
        return self.done[key]

    def cost(self, part: str, name: str, kind: str, firmware: str = "memory") -> float:
        """Integral of the absolute error of both loops, K min."""
        return sum(self.result(part, name, firmware)[kind])

    def acted_to_the_end(self, part: str, name: str, firmware: str = "memory") -> None:
        self.assertEqual(self.result(part, name, firmware)["gave_up"], [], (part, name, firmware))

    def test_setpoints_cost_less_than_half_of_the_pis_and_less_than_the_best_self_tuner_without_noise_and_with_it(self) -> None:
        for part in ("pilot", "pilot-noise"):
            for firmware in FIRMWARES:
                with self.subTest(part=part, firmware=firmware):
                    mine = self.cost(part, AHEAD, "setpoints", firmware)
                    self.assertLess(mine, self.cost(part, "PI", "setpoints", firmware) / 2)
                    self.assertLess(mine, self.cost(part, "self-tuner IMD1, lambda 0.05 g0", "setpoints", firmware))
                    self.acted_to_the_end(part, AHEAD, firmware)

    def test_changes_of_a_feed_that_nobody_measures_cost_less_than_half_of_the_pis(self) -> None:
        for firmware in FIRMWARES:
            for kind in LOADS[:2]:
                with self.subTest(firmware=firmware, kind=kind):
                    self.assertLess(self.cost("pilot", AHEAD, kind, firmware), self.cost("pilot", "PI", kind, firmware) / 2)

    def test_no_load_costs_more_than_under_the_pis_with_noise_either(self) -> None:
        for part in ("pilot", "pilot-noise"):
            for firmware in FIRMWARES:
                for kind in LOADS:
                    with self.subTest(part=part, firmware=firmware, kind=kind):
                        self.assertLess(self.cost(part, AHEAD, kind, firmware), self.cost(part, "PI", kind, firmware))

    def test_on_another_plant_than_its_model_it_is_better_than_the_pis(self) -> None:
        for part in ("pilot-other", "pilot-other-noise"):
            self.acted_to_the_end(part, AHEAD)
            for kind in ("setpoints", *LOADS):
                with self.subTest(part=part, kind=kind):
                    self.assertLess(self.cost(part, AHEAD, kind), self.cost(part, "PI", kind))

    def test_the_linear_law_of_the_nominal_point_does_not_hold_this_column(self) -> None:
        for kind in ("setpoints", "weak heater"):
            self.assertGreater(self.cost("pilot", "linear law of the nominal point", kind), 2 * self.cost("pilot", "PI", kind), kind)

    def test_a_second_column_is_held_better_than_by_its_pis(self) -> None:
        name = "ahead, estimated states, tau 60, miss 100"  # in float: with Q7.24 estimator and controller are 24 bytes too many for the arena
        self.acted_to_the_end("methanol", name)
        for kind in ("setpoints", "feed flow", "feed composition", "colder feed"):
            with self.subTest(kind=kind):
                self.assertLess(self.cost("methanol", name, kind), self.cost("methanol", "PI", kind))

    def test_where_it_oscillates_it_gives_up_and_the_pis_take_over(self) -> None:
        name = "ahead, estimated states, tau 60, miss 0"
        self.assertEqual([reason for _, reason in self.result("methanol", name)["gave_up"]], ["model"])
        for kind in ("feed flow", "feed composition", "colder feed"):  # after that
            self.assertAlmostEqual(self.cost("methanol", name, kind), self.cost("methanol", "PI", kind), delta=0.02 * self.cost("methanol", "PI", kind))

    def test_a_thermometer_of_the_estimator_that_fails_does_not_end_it(self) -> None:
        for name in ("thermometer frozen from 100 min on", "thermometer 1 K off from 100 min on", "thermometer reported bad from 100 min on"):
            with self.subTest(name):
                self.acted_to_the_end("pilot-amiss", name)
                self.assertLess(self.cost("pilot-amiss", name, "setpoints"), self.cost("pilot-noise", "PI", "setpoints"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
