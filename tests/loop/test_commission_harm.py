#!/usr/bin/python3
"""Automatic start-up must not harm: plants that it was not made for - the wrong way first, hardly damped, integrating, running
away, slower than it waits - and sensors at the end of their span. How far the plant itself goes, without noise, from
the operating point, until the start-up has come to an end.

usage: test_commission_harm.py      (needs reflux-sim-memory of the host build; nothing is built here)
"""

import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from commissioning import Plant, Run, whole  # noqa: E402
from made_plants import FIRST, SECOND, MadePlants, element  # noqa: E402

LIMIT = 0.2  # of span, by default
# A drift as fast as three deviations of the slope before the first test is none of the tests' doing.
HIDDEN = 0.05


class Harm(MadePlants):
    def runaway(self, name: str, time_s: float, gains: tuple[float, float]) -> Plant:
        """A slow real pole to the right of the axis."""
        rate = [g / time_s for g in gains]
        return self.plant(name, "state_space", A=[[1.0 / time_s, 0], [0, -0.005]], B=[rate, [0.001, 0.004]],
                          C=[[1, 0], [0, 1]])

    def started(self, of: Plant, noise: float = 0.0, settings: list[str] = (), events: list[str] = ()) -> Run:
        """... up to the proposal, or to the end."""
        events = list(events) + ([] if noise else of.perfect_sensors())
        run = Run(of, whole(of, accept=False, settings=settings), noise=noise, events=events, log=True)
        run.end = run.first("PROPOSAL", "NOT_DETERMINED", "COMMISSION_ENDED")
        self.assertIsNotNone(run.end, f"{of.path.stem}: {run.events[-2:]}")
        return run

    def excursion(self, of: Plant, run: Run, limit: float = LIMIT) -> float:
        return max(abs(row[f"{y['name']}.true"] - y["nominal"]) / (limit * (y["hi"] - y["lo"]))
                   for row in run.rows if row["time"] <= run.end.time_s for y in of.outputs)

    def stays(self, of: Plant, most: float = 1.0, limit: float = LIMIT, settings: list[str] = (), **more) -> Run:
        limits = [f"set meas{i}.test_limit {100 * limit:g}" for i in (1, 2)]
        run = self.started(of, settings=[*limits, *settings], **more)
        worst = self.excursion(of, run, limit)
        print(f"harm {of.path.stem}: {worst:.2f} of a limit, {run.end.code} {run.end.subject} "
              f"{run.end.text.split(': ')[-1]}")
        self.assertLessEqual(worst, most, of.path.stem)
        return run

    # ---- how far ----

    def test_what_goes_the_wrong_way_first_stays_within_its_limit_at_the_reversal_too(self):
        for zero, noise in ((-100, 1.0), (-200, 0.0), (-200, 1.0)):
            with self.subTest(zero=zero, noise=noise):
                self.stays(self.beside(f"inverse{-zero}", element(2.0, [100, 100], 10, zero=zero)), noise=noise)

    def test_large_gains_stay_within_their_limit_whatever_the_shape(self):
        """... with a lag of 15 and of 40 samples, and noise of 0.5 % of span."""
        def shapes(gain: float, lag: float) -> dict[str, dict]:
            half = [lag / 2, lag / 2]
            return {"lag": element(gain, lag), "late": element(gain, lag, 0.3 * lag), "two": element(gain, half),
                    "inverse": element(gain, half, zero=-lag / 2),
                    "damped": {"gain": gain, "quadratic": [lag * lag / 4, 0.15 * lag], "dead_time": 0.0}}
        for gain in (5.0, 50.0, 100.0):
            for lag in (150.0, 400.0):
                for name, e in shapes(gain, lag).items():
                    with self.subTest(gain=gain, lag=lag, shape=name):
                        of = self.beside(f"{name}{gain:.0f}-{lag:.0f}", e)
                        self.stays(of, 1.05, noise=1.0, settings=["set test.rounds 1"],
                                   events=[f"0:{y['name']}.noise=0.5" for y in of.outputs])

    def test_two_inputs_that_act_nearly_alike_with_large_gains_stay_within_their_limit(self):
        """Gains of Skogestad's column A in its LV configuration, spans per span (Trans IChemE 75A, 1997)."""
        gains = ((87.8, -86.4), (108.2, -109.6))
        for lag in (150.0, 400.0):
            with self.subTest(lag=lag):
                of = self.plant(f"lv-{lag:.0f}", "transfer", elements=[[element(g, lag, 10) for g in row] for row in gains])
                self.stays(of, 1.05, noise=1.0, settings=["set test.rounds 1"])

    def test_what_is_hardly_damped_stays_within_its_limit(self):
        for damping, noise in ((0.05, 1.0), (0.25, 0.0)):
            with self.subTest(damping=damping, noise=noise):
                e = {"gain": 1.5, "quadratic": [1e4, 200 * damping], "dead_time": 10}
                self.stays(self.beside(f"damping{100 * damping:.0f}", e), noise=noise)

    def test_an_integrator_stays_within_its_limit_over_all_tests(self):
        of = self.beside("integrator", {"gain": 5e-3, "integrator": True})
        run = self.stays(of)
        self.assertEqual((run.end.code, run.end.subject), ("COMMISSION_ENDED", "y1"))
        run = self.stays(of, noise=1.0, limit=0.05)
        self.assertEqual(run.end.code, "PROPOSAL")
        found = run.elements()["y1", "u1"]
        self.assertAlmostEqual(found["gain"] / found["T"], 5e-3, delta=2e-4)

    def test_a_plant_that_runs_away_is_left_at_its_limit_and_not_taken_for_a_drift(self):
        for time_s, gains, noise, limit in ((1200, (0.5, 0.2), 1.0, LIMIT), (5000, (10, 2.5), 0.0, LIMIT),
                                            (5000, (10, 2.5), 0.0, 0.05), (20000, (0.5, 0.2), 1.0, LIMIT)):
            with self.subTest(time_s=time_s, gains=gains, noise=noise):
                of = self.runaway(f"runaway{time_s}", time_s, gains)
                run = self.stays(of, 1.0 + HIDDEN, noise=noise, limit=limit)
                self.assertIn(run.end.code, ("COMMISSION_ENDED", "NOT_DETERMINED"))

    # ---- sensors ----

    def test_a_sensor_at_the_end_of_its_span_is_a_fault_and_no_rest(self):
        of = self.beside("clipped", element(1.5, 100, 10))
        run = self.started(of, events=["3000:y1.bias=60"])  # it reads 100 from there on
        self.assertEqual((run.end.code, run.end.subject), ("COMMISSION_ENDED", "y1"))
        self.assertIn("reads an end of its span", run.end.text)
        self.assertLess(run.end.time_s, 3000 + 3 * of.tick_s)

    def test_it_does_not_begin_where_a_sensor_is_at_the_end_of_its_span(self):
        of = self.beside("ended", element(1.5, 100, 10))
        script = [(t, line) for t, line in whole(of, accept=False) if not line.startswith(("~until", "commission "))]
        begin = 5 * of.tick_s
        run = Run(of, [*script[:-1], (begin, "?commission begin"), (begin, "~end")], events=["0:y1.dead=1"])
        self.assertTrue(any("y1: reads an end of its span" in line for line in run.said), run.said[-5:])

    # ---- words ----

    def test_a_stable_plant_that_is_too_slow_does_not_integrate(self):
        run = self.stays(self.beside("slow", element(2.0, 30000, 50)), settings=["set test.longest 10000"])
        self.assertIn("is too slow for `test.longest`", run.end.text)

    def test_the_time_allowed_is_taken_at_its_word(self):
        """No test is done again for as long as it took."""
        run = self.stays(self.beside("slow", element(2.0, 30000, 50)), settings=["set test.longest 3000"])
        self.assertRegex(run.end.text, "slow(er)? (than|for) `test.longest`")
        halves = [e.value for e in run.all("TEST_DONE")]
        self.assertEqual(len(halves), len(set(halves)), halves)

    def test_a_fast_integrator_does_not_get_a_step_that_the_fits_refuse(self):
        run = self.started(self.beside("fast", {"gain": 0.1, "integrator": True}), noise=1.0, settings=["set meas1.test_limit 1"])
        self.assertIn("integrates", run.end.text)
        self.assertGreater(min(e.value for e in run.all("TEST_STEP")), 1e-6)

    # ---- lengths ----

    def test_a_slow_plant_is_tested_for_as_long_as_it_takes_in_one_start_up(self):
        of = self.beside("slow", element(2.0, 30000, 50))
        free, given = self.stays(of), self.stays(of, settings=["set test.longest 90100"])
        self.assertLess(abs(free.elements()["y1", "u1"]["gain"] / 2.0 - 1.0), 0.05)
        self.assertLessEqual(free.end.time_s, 1.2 * given.end.time_s)

    def test_a_slow_plant_whose_first_step_the_guard_cuts_gets_a_smaller_one(self):
        of = self.plant("slow-pair", "transfer", tick_s=2, elements=[[element(1.2, 1200, 160), element(0.5, 1600, 320)],
                                                                     [element(0.4, 1440, 240), element(1.0, 960, 200)]])
        run = self.stays(of, noise=3.0)
        self.assertEqual(run.end.code, "PROPOSAL")
        self.assertTrue(run.all("TEST_CUT"))
        self.assertTrue(run.all("TEST_SMALLER"))

    def test_a_drift_that_little_noise_hides_is_taken_off(self):
        of = self.plant("drifting", "transfer", elements=[[element(1.2, 150, 20), element(0.5, 200, 40)],
                                                          [element(0.4, 180, 30), element(1.0, 120, 25)]])
        # In % of span an hour; over a window of rest that is 0.24 of the limit.
        turns = [f"{t}:{y}.drift={rate}" for y, rate in (("y1", 17), ("y2", -17))
                 for t, rate in ((0, rate), (5000, -rate), (15000, rate))]
        run = self.started(of, noise=1.0, events=turns)
        self.assertEqual(run.end.code, "PROPOSAL")

    # ---- integrators ----

    def test_an_input_that_integrates_gets_a_loop_once_its_slope_is_known(self):
        of = self.plant("integrating", "transfer", elements=[[{"gain": 5e-4, "integrator": True}, element(0.3, 80)],
                                                             [FIRST, SECOND]])
        for noise in (0.0, 1.0):
            run = self.started(of, noise=noise)
            self.assertEqual(run.end.code, "PROPOSAL", noise)
            found = run.elements()["y1", "u1"]
            self.assertEqual(found["flags"], {"integrates"})
            self.assertLess(abs(found["gain"] / found["T"] / 5e-4 - 1.0), 0.02)

    # ---- cut ----

    def test_a_step_that_the_guard_cuts_is_made_again_with_a_smaller_one(self):
        run = self.stays(self.beside("large", element(200.0, 300, 0)))
        first, again = [e.value for e in run.all("TEST_STEP")][:2]
        self.assertEqual(run.first("TEST_CUT").subject, "y1")
        self.assertLess(again, 0.61 * first)
        self.assertEqual(run.end.code, "PROPOSAL")
        found = run.elements()["y1", "u1"]
        self.assertLess(abs(found["gain"] / 200.0 - 1.0), 0.02)

    def test_the_gain_of_a_cut_test_is_as_sure_as_it_says(self):
        """A step that is given stays as it is."""
        of = self.beside("large", element(20.0, 300, 0))
        run = self.stays(of, settings=["set mv1.test_step 2", "set test.rounds 1"], noise=1.0)
        self.assertIsNotNone(run.first("TEST_CUT"))
        self.assertEqual(len([e for e in run.all("TEST_STEP") if e.subject == "u1"]), 1)
        found = run.elements()["y1", "u1"]
        half_s = next(e.value for e in run.all("TEST_DONE") if e.subject == "u1")
        self.assertGreater(2.718281828 ** (-half_s / 300), 0.1)
        self.assertLess(abs(found["gain"] - 20.0), 3.0 * found["gain_sd"])
        self.assertLess(found["gain_sd"], 2.0)


if __name__ == "__main__":
    unittest.main()
