#!/usr/bin/python3
"""A composition loop on an analyser: it holds its setpoint, analyses that stand are no fault, and a chromatograph
that really stops is found out by its own samples.

usage: test_analyser.py      (needs reflux-sim-memory of the build folder the test runs for; nothing is built here)
"""

import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import logs, runner, scenario  # noqa: E402

SCENARIO = scenario.load(ROOT / "host_sim" / "scenarios" / "analyser.toml")
GOOD, UNCERTAIN, BAD = 0, 1, 2
MANUAL, AUTO = 0, 1


class Analyser(unittest.TestCase):
    def run_it(self, until, *events, lines=(), **changes):
        """The scenario up to a time, with events (s, name, value) and lines (s, text) added."""
        wanted = replace(SCENARIO, firmware="memory", duration_s=until, limits=(),
                         lines=tuple(sorted((*(line for line in SCENARIO.lines if line.at_s <= until),
                                             *(scenario.Line(*line) for line in lines)), key=lambda line: line.at_s)),
                         events=SCENARIO.events + tuple(scenario.Event(*event) for event in events), **changes)
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            runner.run(wanted, runner.Options(Path(folder), quiet=True))
            self.transcript = (Path(folder) / "transcript.txt").read_text()
            return logs.read_csv(Path(folder) / "log.csv")

    def column(self, log, name, begin, end=1e9):
        return [v for t, v in zip(log.numbers("time"), log.numbers(name)) if begin <= t <= end]

    def first(self, log, name, value, begin):
        return next(t for t, v in zip(log.numbers("time"), log.numbers(name)) if t >= begin and v == value)

    def test_the_scenario_keeps_its_limits_with_other_noise_too(self):
        for seed in (1, 2, 3):
            with self.subTest(seed=seed), tempfile.TemporaryDirectory(prefix="reflux-") as folder:
                wanted = replace(SCENARIO, firmware="memory", seed=seed)
                result = runner.run(wanted, runner.Options(Path(folder), quiet=True))
                self.assertEqual([c.sentence() for c in result.checks if not c.passed], [])
                log = result.log
                self.assertLess(max(abs(x - 2.5) for x in self.column(log, "xB.true", 36000)), 0.3)
                transcript = (Path(folder) / "transcript.txt").read_text()
                for word in ("MEASUREMENT_BAD", "LOOP_DIVISOR", "ALARM_ON"):
                    self.assertNotIn(word, transcript)
                # Good all the while, new in every fifth tick, and it stands in between.
                self.assertEqual(set(self.column(log, "fw.xB.q", 0)), {GOOD})
                news = self.column(log, "fw.xB.new", 60)
                self.assertEqual(news, [1.0 if k % 5 == 0 else 0.0 for k in range(len(news))])
                values = self.column(log, "fw.xB[%w]", 60)
                for k in range(0, len(values) - 4, 5):
                    self.assertEqual(len(set(values[k:k + 5])), 1)
                # The reading was true three minutes before.
                true = self.column(log, "xB.true", 0)
                late = self.column(log, "fw.xB[%w]", 0)
                for k in range(1 + 5 * 3, len(true), 5):
                    self.assertAlmostEqual(late[k], true[k - 3], delta=0.25)

    def test_an_analyser_that_repeats_itself_is_found_frozen_by_its_own_samples(self):
        log = self.run_it(16000, (10000, "xB.frozen", 1))
        last = 9960  # its last analysis; the same number comes three times more until `frozen` has passed
        self.assertEqual(set(self.column(log, "fw.xB.q", 0, last + 1199)), {GOOD})
        self.assertEqual(self.first(log, "fw.xB.q", UNCERTAIN, last), last + 1200)
        self.assertIn("MEASUREMENT_BAD xB", self.transcript)
        # Held for `hold`, from where the sample failed; then the loop goes to manual, and the output stays.
        self.assertEqual(self.first(log, "fw.bottom.mode", MANUAL, 2000), last + 1200 + 600)
        self.assertEqual(set(self.column(log, "fw.xB.q", last + 1800)), {BAD})

    def test_an_analyser_that_is_silent_is_missed_when_its_sample_is_due(self):
        log = self.run_it(14000, (10000, "xB.quality", 3), (10800, "xB.quality", 0))
        self.assertEqual(set(self.column(log, "fw.xB.q", 0, 10259)), {GOOD})
        self.assertEqual(set(self.column(log, "fw.xB.q", 10260, 10799)), {UNCERTAIN})
        self.assertEqual(set(self.column(log, "fw.xB.q", 10800)), {GOOD})
        self.assertEqual(set(self.column(log, "fw.bottom.mode", 2000)), {AUTO})

    def test_one_that_the_firmware_takes_for_a_sensor_trips_its_frozen_check(self):
        log = self.run_it(6000, lines=((600, "set meas2.phase 0"), (600, "set meas2.every 1"),
                                       (660, "set meas2.frozen 240")))
        self.assertIn("MEASUREMENT_BAD xB", self.transcript)
        self.assertIn(UNCERTAIN, self.column(log, "fw.xB.q", 0))

    def test_a_loop_that_runs_between_its_analyses_is_told_of(self):
        self.run_it(3000, lines=((600, "set loop1.divisor 3"),))
        self.assertIn("LOOP_DIVISOR bottom 5", self.transcript)


if __name__ == "__main__":
    unittest.main()
