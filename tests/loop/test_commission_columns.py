#!/usr/bin/python3
"""Automatic start-up of the two columns at an operating point, everything at its default, with the noise of the plant: ends with
two temperature loops that hold a feed disturbance; how well beside those tuned by hand is printed. More seeds:
tests/campaign/results/commissioning-columns.md.

usage: test_commission_columns.py      (needs reflux-sim-memory of the host build; nothing is built here)
"""

import csv
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from research import commissioning_columns  # noqa: E402

SEED = 1
REFERENCE = ROOT / "tests" / "reference" / "column_pairing.csv"


def committed_pairing(name: str) -> list[tuple[str, str]]:
    with REFERENCE.open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return sorted((row["output"], row["input"]) for row in rows if row["plant"] == name)


class Columns(unittest.TestCase):
    def starts_up(self, plant: str, pairing: str, hours: float, compared: tuple[str, ...]) -> None:
        column = next(c for c in commissioning_columns.COLUMNS if c.plant == plant)
        self.assertEqual(column.settings, ())
        r = commissioning_columns.of_column(column, SEED)
        self.assertEqual(r["verdict"], "kept")
        self.assertEqual(sorted(r["pairs"]), committed_pairing(pairing))
        self.assertGreaterEqual(r["probability"], 0.975)
        self.assertLessEqual(r["hours"], hours)
        ratios = [ours / hand for ours, hand in zip(r["iae"], r["hand"])]
        print(f"commission {plant}, seed {SEED}: kept after {r['hours']:.1f} h, probability {r['probability']:.3f}; IAE after the "
              f"feed disturbance {', '.join(f'{x:.2f}' for x in ratios)} of that of the loops tuned by hand")
        for ours, hand, name in zip(r["iae"], r["hand"], column.controlled):
            self.assertGreater(ours, 0.0)
            if name in compared:
                self.assertLess(ours, 1.5 * hand, name)

    def test_the_pilot_column_within_38_hours(self):
        self.starts_up("pilot", "pilot-2x2", 38.0, ("T1", "T10"))

    def test_the_splitter_within_125_hours(self):
        """T30 answers up and down so differently that no linear shape fits both ways."""
        self.starts_up("splitter", "splitter", 125.0, ("T30", "T19"))


if __name__ == "__main__":
    unittest.main()
