#!/usr/bin/python3
"""The Kalman filter of 1989 put right: all trays of the pilot column from five thermometers (tools/research/kalman_1989.py, lines of
the campaign `pilot-kalman`); complete innovation beside partial on the splitter. The bounds are those of the task and of the
source, or a comparison; what came out stands in tests/campaign/results."""

import re
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import runner, scenario  # noqa: E402
from research import estimates, kalman_1989, kalman_1989_campaign  # noqa: E402
from reflux.errors import UserError  # noqa: E402
from research.kalman_1989 import BAND, BIAS, MEASURED, STAGES, UNMEASURED, Case, Measured, worst  # noqa: E402

EVERY = MEASURED + UNMEASURED
SPLITTER = "sE[C3,30,31,33]"


class Pilot(unittest.TestCase):
    done: dict[Case, Measured] = {}

    def measured(self, **what: object) -> Measured:
        case = Case(**what)
        if case not in self.done:
            self.done[case] = kalman_1989.measure(case)
        return self.done[case]

    def test_all_ten_trays_stay_within_the_band_whatever_the_feed_does(self) -> None:
        self.assertLess(abs(worst(self.measured().most, EVERY)), BAND)

    def test_no_bias_is_left_after_any_step_and_no_tray_is_restless(self) -> None:
        m = self.measured()
        self.assertLess(abs(worst(m.bias, EVERY)), BIAS)
        self.assertLess(worst(m.restless, EVERY), BAND / 4)

    def test_the_band_form_and_gains_of_the_steady_state_do_as_well(self) -> None:
        for covariance in ("band", "steady"):
            m = self.measured(covariance=covariance)
            self.assertLess(abs(worst(m.most, EVERY)), BAND)
            self.assertLess(abs(worst(m.bias, EVERY)), BIAS)

    def test_a_linear_filter_without_disturbance_states_keeps_a_bias_on_trays_with_and_without_a_thermometer(self) -> None:
        m = self.measured(method="kalman", feed_z=0.0, feed_f=0.0)
        for trays in (MEASURED, UNMEASURED):
            self.assertGreater(abs(worst(m.bias, trays)), 5 * BIAS)

    def test_it_takes_both_disturbance_states_and_the_nonlinear_model(self) -> None:
        for what in ({"method": "kalman"}, {"feed_z": 0.0, "feed_f": 0.0}):
            self.assertGreater(abs(worst(self.measured(**what).bias, EVERY)), 5 * BIAS)

    def test_an_explicit_transition_is_unstable_where_there_is_no_thermometer_and_biased_where_there_is_one(self) -> None:
        """In numpy: the firmware has none such. It knows all that his did."""
        told = {"by": "numpy", "method": "kalman", "feed_z": 0.0, "feed_f": 0.0, "flow": True, "feed": True}
        m = self.measured(step="explicit", **told)
        self.assertGreater(abs(worst(m.most, UNMEASURED)), 0.5)
        self.assertGreater(worst(m.restless, UNMEASURED), BAND)
        self.assertLess(worst(m.restless, MEASURED), BAND)
        self.assertGreater(abs(worst(m.bias, MEASURED)), BIAS)

    def test_the_linear_filter_is_that_of_an_independent_program(self) -> None:
        board, dense = self.measured(method="kalman"), self.measured(by="numpy", method="kalman")
        for s in range(STAGES):
            self.assertAlmostEqual(board.most[s], dense.most[s], delta=BIAS)
            self.assertAlmostEqual(board.bias[s], dense.bias[s], delta=BIAS)

    def test_words_that_are_no_field_of_a_case_are_refused(self) -> None:
        for words in ("feed_q=1", "feed_z", "feed_z="):
            with self.subTest(words), self.assertRaises(UserError):
                kalman_1989_campaign.changed_in(Case(), words)


class Splitter(unittest.TestCase):
    done: dict[str, estimates.Error] = {}

    def largest(self, method: str, covariance: str = "full") -> float:
        name = f"{method} {covariance}"
        if name not in self.done:
            case = estimates.Case(SPLITTER, method, scenario="SC2", covariance=covariance)
            self.done[name] = estimates.measure(case).error["iC4"]
        return max(abs(self.done[name].low), abs(self.done[name].high))

    def test_complete_innovation_is_within_the_band_with_half_the_error_of_partial(self) -> None:
        self.assertLess(self.largest("ekf"), estimates.BAND)
        self.assertLess(self.largest("ekf"), self.largest("geometric") / 2)

    def test_the_band_form_loses_no_more_than_half_as_much_again(self) -> None:
        self.assertLess(self.largest("ekf", "band"), 1.5 * self.largest("ekf"))


class Shipped(unittest.TestCase):
    def test_the_scenario_finds_the_feed_that_nobody_measures(self) -> None:
        played = scenario.load(ROOT / "host_sim" / "scenarios" / "pilot-kalman.toml")
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            out = Path(folder) / "out"
            log = runner.run(replace(played, firmware="memory"), runner.Options(out, quiet=True)).log
            said = (out / "transcript.txt").read_text(encoding="utf-8")
        flow = [float(x) for x in re.findall(r" feed_flow = (\S+)", said)]
        self.assertAlmostEqual(flow[0], 0.0, delta=0.05)
        self.assertAlmostEqual(flow[1], 0.25, delta=0.05)
        self.assertAlmostEqual(float(re.findall(r" feed_1 = (\S+)", said)[2]), 0.1427, delta=0.01)  # 36 to 50 %w
        for point, truth, bound in (("xB_est", "xB", 2.0), ("xD_est", "xD", 0.1), ("T3_est", "T3", 0.5), ("T8_est", "T8", 0.5)):
            self.assertAlmostEqual(log.numbers(f"fw.{point}")[-1], log.numbers(truth)[-1], delta=bound)
            self.assertEqual(log.text(f"fw.{point}.q")[-1], "0")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
