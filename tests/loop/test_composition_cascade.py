#!/usr/bin/python3
"""docs/use/analysers.md, Above a temperature loop: the scenario, and what becomes of it when the analyser stops."""

import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import runner, scenario  # noqa: E402
from reflux.scenario import Event  # noqa: E402

HOUR, GOAL = 3600.0, 0.02
SCENARIO = ROOT / "host_sim" / "scenarios" / "composition-cascade.toml"


class Cascade(unittest.TestCase):
    kept: dict = {}

    def run_with(self, *events: Event, drop: tuple = ()) -> object:
        key = (events, drop)
        if key not in self.kept:
            base = scenario.load(SCENARIO)
            played = replace(
                base, firmware="memory", limits=(), events=(*(e for e in base.events if e.name not in drop), *events)
            )
            with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
                self.kept[key] = runner.run(played, runner.Options(Path(folder) / "out", quiet=True)).log
        return self.kept[key]

    def values(self, log: object, column: str, first_h: float, last_h: float) -> list:
        t = log.numbers("time")
        y = log.numbers(column)
        return [y[k] for k in range(len(t)) if first_h * HOUR <= t[k] <= last_h * HOUR]

    def mean(self, log: object, column: str, first_h: float, last_h: float) -> float:
        values = self.values(log, column, first_h, last_h)
        return sum(values) / len(values)

    def test_the_temperature_alone_leaves_an_offset_and_the_analyser_takes_it_away(self) -> None:
        log = self.run_with()
        self.assertGreater(abs(self.mean(log, "iC4_D.true", 4, 6) - GOAL), 0.003)
        for first, last in ((10, 14), (20, 24)):
            self.assertLess(abs(self.mean(log, "iC4_D.true", first, last) - GOAL), 0.0005)

    def test_while_the_analyser_repeats_itself_the_setpoint_stays_and_afterwards_the_offset_goes(self) -> None:
        """Frozen from 12 h to 18 h: found an hour after its first equal number, held for half an hour, then the loop on it goes to manual and the
        tray keeps the setpoint it has, which is not the one that is right for the new feed of 14 h."""
        log = self.run_with(Event(12 * HOUR, "iC4_D.frozen", 1.0), Event(18 * HOUR, "iC4_D.free", 1.0))
        setpoint = self.values(log, "fw.tray.sp", 14.5, 18)
        self.assertLess(max(setpoint) - min(setpoint), 0.01)
        self.assertLess(max(abs(x - GOAL) for x in self.values(log, "iC4_D.true", 15, 24)), 0.01)

    def test_an_analyser_that_says_too_much_moves_the_tray_no_further_than_its_setpoint_limits(self) -> None:
        log = self.run_with(Event(12 * HOUR, "iC4_D.bias", 0.05))
        self.assertAlmostEqual(min(self.values(log, "fw.tray.sp", 12, 24)), 326.0, places=3)
        self.assertGreater(self.mean(log, "iC4_D.true", 22, 24), 0.002)

    def test_off_its_setpoint_limit_it_comes_back_at_once(self) -> None:
        """The bias ends at 18 h; the next sample is on its way 35 min at most, and the loop's own times are 25 min of dead time and as much again."""
        log = self.run_with(Event(12 * HOUR, "iC4_D.bias", 0.05), Event(18 * HOUR, "iC4_D.bias", 0.0))
        self.assertLess(abs(self.mean(log, "iC4_D.true", 22, 24) - GOAL), 0.001)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
