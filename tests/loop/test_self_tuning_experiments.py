#!/usr/bin/python3
"""Self-tuners on the nonlinear pilot column beside PIs: lines of the campaign `self-tuning`, in both number formats. The bounds are
those that the piece of work was given before anything was measured; what came out stands in docs/methods/self-tuning.md."""

import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from research import cmd_campaign, self_tuning_campaign  # noqa: E402

CAMPAIGN = cmd_campaign.load("self-tuning")
FIRMWARES = ("memory", "host-fixed")


class SelfTuning(unittest.TestCase):
    done: dict = {}

    def cost(self, part: str, name: str, kind: str, firmware: str = "memory", more: tuple = ()) -> float:
        """Integral of the absolute error of all loops, degC min."""
        key = (part, name, firmware, more)
        if key not in self.done:
            variant = next(v for v in CAMPAIGN.variants if (v.part, v.name) == (part, name))
            self.done[key] = self_tuning_campaign.simulate(CAMPAIGN, variant, 1, more, firmware)
        return sum(self.done[key][kind])

    def test_one_loop_is_a_quarter_better_than_the_pi_on_setpoints_and_four_fifths_on_loads(self) -> None:
        for firmware in FIRMWARES:
            with self.subTest(firmware):
                for kind, part in (("setpoints", 0.75), ("loads", 0.2)):
                    self.assertLess(self.cost("rule-one", "ISV", kind, firmware),
                                    part * self.cost("rule-one", "PI -2.0, 3 min", kind, firmware), kind)

    def test_two_loops_are_no_worse_than_two_pis_on_setpoints_and_two_fifths_better_on_loads(self) -> None:
        for firmware in FIRMWARES:
            with self.subTest(firmware):
                for kind, part in (("setpoints", 1.0), ("loads", 0.6)):
                    self.assertLess(self.cost("rule-pair", "IMD1", kind, firmware),
                                    part * self.cost("rule-pair", "PI", kind, firmware), kind)

    def test_after_the_gain_has_doubled_the_self_tuner_beats_the_pi_that_was_best_before(self) -> None:
        for part, name, best in (("gain-doubles-one", "ISV", ("loop1.gain 13.4", "loop1.ti 133")),
                                 ("gain-doubles-pair", "IMD1", ("loop1.gain 17.2", "loop1.ti 57", "loop2.gain 6.7",
                                                                "loop2.ti 34.3"))):
            for kind in ("setpoints", "loads"):
                pi = "PI -2.0, 3 min" if part.endswith("one") else "PI"
                self.assertLess(self.cost(part, name, kind), self.cost(part, pi, kind, more=best), (part, kind))

    def test_wrong_signs_at_the_start_are_recovered_by_simplified_correction_but_not_at_a_smaller_lambda(self) -> None:
        def beside_the_right_ones(part: str, name: str) -> float:
            return self.cost(part, name, "setpoints") / self.cost(part, "the right signs", "setpoints")

        self.assertGreater(beside_the_right_ones("start-0.5", "the wrong signs"), 20)
        self.assertLess(beside_the_right_ones("start-0.5", "the wrong signs, SPC 0.2 on all four G"), 1.1)
        self.assertGreater(beside_the_right_ones("start-0.2", "the wrong signs, SPC 0.2 on all four G"), 1.1)

    def test_a_static_decoupler_before_two_pis_makes_them_worse(self) -> None:
        for kind in ("setpoints", "loads"):
            self.assertGreater(self.cost("rule-pair", "PI + SS", kind), self.cost("rule-pair", "PI", kind))

    def test_without_cross_terms_the_incremental_design_is_better_than_the_positional_one(self) -> None:
        for kind in ("setpoints", "loads"):
            self.assertLess(self.cost("rule-pair", "IMD3", kind), self.cost("rule-pair", "PMD3, unsupervised", kind))


if __name__ == "__main__":
    unittest.main()
