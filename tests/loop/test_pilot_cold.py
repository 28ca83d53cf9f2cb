#!/usr/bin/python3
"""The cold pilot column with the whole firmware around it: started by hand, controlled, and its interlocks when cooling or
the reboiler's liquid is lost.

usage: test_pilot_cold.py      (needs reflux-sim-memory of the build folder the test runs for; nothing is built here)
"""

import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import logs, runner, scenario  # noqa: E402

SCENARIO = scenario.load(ROOT / "host_sim" / "scenarios" / "cold-start.toml")


def run(until, *events):
    """The scenario's log up to a time, with events (s, name, value) added."""
    lines = tuple(line for line in SCENARIO.lines if line.at_s <= until)
    wanted = replace(SCENARIO, firmware="memory", duration_s=until, lines=lines,
                     events=tuple(scenario.Event(*event) for event in events))
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        runner.run(wanted, runner.Options(Path(folder), quiet=True))
        return logs.read_csv(Path(folder) / "log.csv")


class ColdPilot(unittest.TestCase):
    def between(self, log, name, begin, end):
        return [v for t, v in zip(log.numbers("time"), log.numbers(name)) if begin <= t <= end]

    def test_a_start_by_hand_ends_in_two_temperature_control(self):
        log = run(10790)
        self.assertEqual(max(self.between(log, "V", 0, 600)), 0.0)
        for name, target, error in (("T1.true", 87.15, 0.1), ("T10.true", 106.0, 0.3), ("LB_true", 15.2, 0.3)):
            for value in self.between(log, name, 9000, 10790):
                self.assertAlmostEqual(value, target, delta=error, msg=name)

    def test_lost_cooling_cuts_the_heater_before_much_vapour_is_lost(self):
        log = run(8000, (7000, "supply", 0))
        self.assertGreater(min(self.between(log, "Qrb.applied", 6000, 7000)), 0.5)
        self.assertEqual(max(self.between(log, "Qrb.applied", 7030, 8000)), 0.0)
        self.assertLess(sum(self.between(log, "vent", 7000, 8000)) * 10 / 3600, 0.2)  # mol

    def test_a_dry_reboiler_cuts_the_heater_before_its_thermostat_does(self):
        log = run(8000, (7000, "leak", 60))
        self.assertLess(min(self.between(log, "LB_true", 7000, 8000)), 5.0)
        self.assertEqual(max(self.between(log, "Qrb.applied", 7150, 8000)), 0.0)
        self.assertLess(max(self.between(log, "Theater.true", 7000, 8000)), 240.0)

    def test_a_dry_reboiler_behind_a_broken_heater_thermometer_is_still_noticed(self):
        log = run(8000, (6990, "Theater.quality", 2), (7000, "leak", 60))
        self.assertEqual(max(self.between(log, "Qrb.applied", 7200, 8000)), 0.0)
        self.assertLess(max(self.between(log, "Theater.true", 7000, 8000)), 240.0)


if __name__ == "__main__":
    unittest.main()
