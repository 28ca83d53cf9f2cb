#!/usr/bin/python3
"""The splitter under its committed configuration: stable, inside the scenario's limits, with other noise too."""

import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import runner, scenario  # noqa: E402

SCENARIO = ROOT / "host_sim" / "scenarios" / "splitter.toml"


class SplitterScenarioTest(unittest.TestCase):
    def run_one(self, firmware: str, seed: int) -> runner.Result:
        wanted = replace(scenario.load(SCENARIO), firmware=firmware, seed=seed)
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            return runner.run(wanted, runner.Options(Path(folder), quiet=True))

    def good(self, result: runner.Result) -> None:
        self.assertEqual([c.sentence() for c in result.checks if not c.passed], [])
        log = result.log
        for pv, setpoint, band in (("T30", 336.38, 0.15), ("T19", 356.37, 0.08)):
            tail = log.numbers(f"{pv}.true")[-60:]  # half an hour
            self.assertLess(max(abs(t - setpoint) for t in tail), band, pv)
        self.assertAlmostEqual(log.numbers("iC4_D")[-1], 0.0165, delta=0.0002)
        # at rest again: the outputs only follow the noise
        self.assertLess(max(log.numbers("R.applied")[-60:]) - min(log.numbers("R.applied")[-60:]), 0.5)
        self.assertLess(max(log.numbers("Q.applied")[-60:]) - min(log.numbers("Q.applied")[-60:]), 25)

    def test_both_temperatures_are_held_through_setpoint_and_feed(self) -> None:
        for seed in (1, 2, 3):
            with self.subTest(seed=seed):
                self.good(self.run_one("memory", seed))

    def test_fixed_point_holds_them_too(self) -> None:
        self.good(self.run_one("host-fixed", 1))


if __name__ == "__main__":
    unittest.main()
