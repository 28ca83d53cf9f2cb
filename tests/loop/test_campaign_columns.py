#!/usr/bin/python3
"""Campaigns of start-ups take columns: what they hold true of them, and one start-up of a column that nobody tuned for.

usage: test_campaign_columns.py      (needs reflux-sim-memory of the host build; nothing is built here)
"""

import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True

from research import cmd_campaign, commissioning, commissioning_stability, known_plants  # noqa: E402


class Columns(unittest.TestCase):
    def test_a_column_stands_at_its_nominal_state(self):
        splitter = known_plants.read("splitter")
        q = next(u for u in splitter["inputs"] if u["name"] == "Q")
        self.assertEqual((q["nominal"], q["safe"]), (4143.046, 4143.046))
        top = next(y for y in splitter["outputs"] if y["name"] == "T37")
        self.assertAlmostEqual(top["nominal"], 321.7, delta=1.0)  # at 17 bar the distillate boils at 322 K

    def test_gains_and_pairing_are_those_of_the_exact_model(self):
        # tests/reference/column_gains.csv has the same, by another model
        self.assertAlmostEqual(known_plants.gains("splitter")["T30", "R"], -22.6, delta=0.05)
        self.assertEqual(known_plants.pairing("wood-berry"), [("xB", "S"), ("xD", "R")])
        self.assertEqual({u for _, u in known_plants.pairing("pilot")}, {"Lr", "Qrb"})

    def test_loops_of_a_column_are_judged_on_its_linear_twin(self):
        def radius(gain: float, action: str) -> float:
            said = "\n".join(["1 > commission edit", "1 < ok", "1 > diff", "1 < set loop1.name T10", "1 < set loop1.pv T10",
                              "1 < set loop1.out Qrb", f"1 < set loop1.gain {gain}", "1 < set loop1.ti 600",
                              f"1 < set loop1.action {action}", "1 < ok", ""])
            return commissioning_stability.radius(said, "pilot")
        self.assertLess(radius(0.2, "reverse"), 1.0)
        self.assertGreater(radius(0.2, "direct"), 1.0)
        self.assertGreater(radius(50.0, "reverse"), 1.0)

    def test_a_start_up_of_a_column_ends_with_an_answer_and_hurts_nothing(self):
        start = cmd_campaign.load("columns")
        result, _ = commissioning.start_up(start, {"plant": "methanol-water", "seed": 1}, [])
        print(f"campaign columns: {result['verdict']}, worst {result['worst']:.2f} of a limit")
        self.assertIn(result["verdict"], ("right", "open", "ended"))
        self.assertLess(result["worst"], 1.0)


if __name__ == "__main__":
    unittest.main()
