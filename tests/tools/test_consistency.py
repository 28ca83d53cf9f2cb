"""tools/consistency without a firmware: parameters from physical quantities, known sequences of innovations and what is said of them, and
what is refused."""

import math
import unittest

import numpy as np

from support import FolderTest, call

from reflux import consistency, consistency_lines, innovations, recorded_run
from reflux.consistency import Setting
from reflux.consistency_lines import Known
from reflux.errors import UserError
from reflux.innovations import Series
from reflux.recorded_run import Sensor

NOISE, MODEL, N = 0.2, 0.1, 2000
EXPECTED = 0.05  # K^2; so a reading draws the estimate by a fifth
SETTING = Setting("rekf", NOISE, MODEL)


def normal(seed: int, n: int = N) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(n)


def correlated(rho: float, seed: int, n: int = N) -> np.ndarray:
    """Draws values of variance 1, each with that part of the one before."""
    w, x = normal(seed, n + 100), 0.0
    out = []
    for value in w:
        x = rho * x + math.sqrt(1 - rho * rho) * value
        out.append(x)
    return np.array(out[100:])


def numbers(u: np.ndarray, name: str = "T30", own: float = NOISE, above: bool = True, moves: bool = True, tick: np.ndarray | None = None):
    """Makes the series of normalised innovations; own: K, noise of the readings."""
    sensor = Sensor(int(name[1:]), name, int(name[1:]), moves, above, 1.0)
    at = np.arange(len(u)) if tick is None else tick
    found = innovations.statistics(
        Series(sensor, at, u * math.sqrt(EXPECTED), np.full(len(u), EXPECTED), 330 + own * normal(int(name[1:]) + 1000, len(u))), NOISE)
    assert found is not None
    return found


def judged(*of, setting: Setting = SETTING) -> consistency.Judgement:
    return consistency.judge(list(of), [], setting, 10.0)


class Numbers(unittest.TestCase):
    def test_white_innovations_of_the_right_size_lie_within_the_interval_in_99_of_100_sequences(self) -> None:
        outside = 0
        for seed in range(400):
            s = numbers(normal(seed, 200))
            outside += not s.low <= s.nis <= s.high
        self.assertLessEqual(outside, 14)  # 4 in the mean; more than that in one case of 10^4

    def test_correlated_ones_are_worth_as_many_independent_ones_as_theory_says(self) -> None:
        """Effective number of squares n (1 - rho^2)/(1 + rho^2) where each has rho of the one before."""
        for rho in (0.5, 0.8):
            found = np.mean([numbers(correlated(rho, seed)).independent for seed in range(20)])
            theory = N * (1 - rho**2) / (1 + rho**2)
            self.assertLess(abs(found / theory - 1), 0.1)

    def test_a_gap_between_ticks_makes_no_neighbours(self) -> None:
        u = np.tile([1.0, -1.0], 200)
        apart = numbers(u, tick=np.arange(400) * 2)
        self.assertAlmostEqual(numbers(u).rho, -1.0, delta=0.01)
        self.assertAlmostEqual(apart.rho, 0.0, delta=0.01)

    def test_noise_of_readings_is_found_upon_what_moves_slowly(self) -> None:
        """The relative error of the second differences' root is 0.99 over the root of n: four of these."""
        at = np.arange(N)
        reading = 330 + 5 * np.sin(at / 200) + 0.3 * normal(3)
        self.assertLess(abs(innovations.own_noise(reading, at) / 0.3 - 1), 4 * 0.99 / math.sqrt(N))

    def test_a_swing_is_found_with_its_period_and_a_step_is_none(self) -> None:
        at = np.arange(N)
        self.assertAlmostEqual(innovations.swing(np.sin(2 * np.pi * at / 6.0) + 0.5 * normal(4), at), 6.0, delta=0.05)
        self.assertEqual(innovations.swing(normal(5), at), 0.0)
        self.assertEqual(innovations.swing(np.where(at < 700, 0.0, 3.0) + 0.3 * normal(6), at), 0.0)

    def test_fewer_than_sixteen_are_no_numbers(self) -> None:
        sensor = Sensor(1, "T1", 1, True, False, 1.0)
        self.assertIsNone(innovations.statistics(Series(sensor, np.arange(9), np.ones(9), np.ones(9), np.ones(9)), NOISE))


class Verdicts(unittest.TestCase):
    def kind(self, s, setting: Setting = SETTING) -> tuple[str, str]:
        v = judged(s, setting=setting).each[0]
        return v.kind, v.words

    def test_what_is_as_expected_is_called_consistent(self) -> None:
        found = judged(numbers(normal(1)), numbers(normal(2), "T31"))
        self.assertTrue(found.consistent)
        self.assertEqual(found.changes, {})

    def test_large_and_white_with_noisy_readings_is_too_little_noise_and_says_how_much(self) -> None:
        own = 2 * math.sqrt(EXPECTED)
        s = numbers(2 * normal(1), own=own)
        kind, words = self.kind(s)
        self.assertEqual(kind, "high")
        self.assertIn("`noise` is too small", words)
        self.assertLess(abs(judged(s).changes["noise"] / own - 1), 4 * 0.99 / math.sqrt(N))

    def test_large_and_white_with_quiet_readings_is_too_little_model(self) -> None:
        s = numbers(2 * normal(1), own=0.05)
        self.assertIn("`model` is too small", self.kind(s)[1])
        self.assertGreater(judged(s).changes["model"], MODEL)

    def test_large_and_correlated_is_too_little_model(self) -> None:
        s = numbers(2 * correlated(0.6, 1))
        kind, words = self.kind(s)
        self.assertEqual(kind, "correlated")
        self.assertIn("follows too slowly; `model` is too small, or the model is wrong", words)
        self.assertGreater(judged(s).changes["model"], MODEL)

    def test_where_the_feed_is_found_wider_than_it_is_said_to_be_its_uncertainty_is_named(self) -> None:
        setting = Setting("ekf", NOISE, MODEL, {"feed_z": 0.01, "feed_f": 0.05}, {"feed_z": 0.06, "feed_f": 0.01})
        s = numbers(2 * correlated(0.6, 1))
        self.assertIn("`feed_z` is too small", self.kind(s, setting)[1])
        self.assertEqual(judged(s, setting=setting).changes["feed_z"], 0.06)

    def test_small_innovations_are_too_much_noise(self) -> None:
        s = numbers(0.4 * normal(1), own=0.08)
        self.assertIn("`noise` is too large", self.kind(s)[1])
        self.assertLess(judged(s).changes["noise"], NOISE)

    def test_what_takes_back_the_one_before_follows_the_noise(self) -> None:
        s = numbers(0.7 * correlated(-0.4, 1))
        self.assertIn("follows the noise", self.kind(s)[1])
        self.assertLess(judged(s).changes["model"], MODEL)

    def test_a_swing_is_told_and_not_covered(self) -> None:
        at = np.arange(N)
        words = self.kind(numbers(1.4 * np.sin(2 * np.pi * at / 6) + 0.2 * normal(1)))[1]
        self.assertIn("neither the model nor its covariances describe", words)
        self.assertIn("swing with a period of 60 s", words)

    def test_one_of_three_that_is_off_is_named_and_no_covariance_widened(self) -> None:
        found = judged(numbers(normal(1) - 1, "T30"), numbers(normal(2) + 2, "T31"), numbers(normal(3) - 1, "T33"))
        self.assertEqual(found.odd, "T31")
        self.assertAlmostEqual(found.odd_k, 3 * math.sqrt(EXPECTED), delta=0.1)
        self.assertIn("an offset of this one", found.each[1].words)
        self.assertNotIn("model", found.changes)

    def test_all_that_are_off_to_one_side_are_the_models_affair(self) -> None:
        found = judged(*(numbers(normal(k) - 2, f"T3{k}") for k in range(3)))
        self.assertEqual(found.odd, "")
        self.assertTrue(any("rather the model" in note for note in found.notes))

    def test_two_that_contradict_each_other_or_one_alone_are_not_decided(self) -> None:
        two = judged(numbers(normal(1) - 1, "T30"), numbers(normal(2) + 1, "T31"))
        one = judged(numbers(normal(1) - 1, "T30"), numbers(normal(2), "T5", above=False))
        for found in (two, one):
            self.assertEqual(found.odd, "")
            self.assertTrue(any("I do not know" in note for note in found.notes))

    def test_three_that_all_differ_accuse_none(self) -> None:
        self.assertEqual(judged(*(numbers(normal(k) + x, f"T3{k}") for k, x in enumerate((-2.0, 0.0, 2.2)))).odd, "")

    def test_a_noisy_one_among_quiet_ones_is_named(self) -> None:
        found = judged(numbers(normal(1), own=0.1), numbers(normal(2), "T31", own=0.25), numbers(normal(3), "T33", own=0.1))
        self.assertTrue(any(note.startswith("T31 is noisier than T3") for note in found.notes))

    def test_of_few_innovations_nothing_is_known(self) -> None:
        kind, words = self.kind(numbers(normal(1, 40)))
        self.assertEqual(kind, "few")
        self.assertIn("I do not know", words)


class Lines(unittest.TestCase):
    def value(self, name: str, **known) -> float:
        return {r.name: r.value for r in consistency_lines.rows(Known(**{"method": "ekf", "sd": 0.1, **known}))}[name]

    def test_what_lies_anywhere_in_an_interval_has_its_width_over_the_root_of_twelve(self) -> None:
        spread = np.random.default_rng(1).uniform(0, 1, 200000).std()
        self.assertAlmostEqual(self.value("feed_z", feed_range=0.1), 0.1 * spread, delta=2e-4)
        self.assertAlmostEqual(self.value("feed_f", flow_accuracy=0.02), 0.04 * spread, delta=1e-4)
        self.assertAlmostEqual(self.value("noise", resolution=0.5), math.hypot(0.1, 0.5 * spread), delta=1e-3)

    def test_a_fraction_that_gathers_model_and_forgets_has_the_error_it_was_asked_for(self) -> None:
        """x' = -x/tau + white noise of that density: variance model^2 tau/2."""
        model, tau, h = self.value("model", model_error=0.02, model_time_h=0.5), 0.5, 0.01
        part, x, sum2, n = math.exp(-h / tau), 0.0, 0.0, 200000
        driven = model * math.sqrt(tau / 2 * (1 - part**2))
        for w in normal(1, n):
            x = part * x + driven * w
            sum2 += x * x
        self.assertAlmostEqual(math.sqrt(sum2 / n), 0.02, delta=0.001)

    def test_rekf_has_the_feeds_range_in_its_model(self) -> None:
        self.assertGreater(self.value("model", method="rekf", feed_range=0.1), self.value("model", method="ekf", feed_range=0.1))

    def test_lines_can_be_pasted(self) -> None:
        status, out, err = call("consistency", "lines", "--sd", "0.1", "--feed-range", "0.1", "--block", "2")
        self.assertEqual((status, err), (0, ""))
        for line in out.splitlines():
            self.assertRegex(line, r"^(# .+|set block2\.\w+ [\w.e+-]+)$")

    def test_what_cannot_be_is_refused_in_words(self) -> None:
        for arguments, why in ((("--sd", "0"), "noise would be 0"), (("--sd", "-1"), "--sd must be"), (("--sd", "0.1", "--feed-range", "3"), "mole fractions"),
                               (("--sd", "0.1", "--method", "rekf", "--flow-accuracy", "0.1"), "no place in rekf"), (("--sd", "0.1", "--model-time", "0"), "more than 0")):
            status, out, err = call("consistency", "lines", *arguments)
            self.assertEqual((status, out), (2, ""))
            self.assertIn(why, err)


CONF = """begin
set meas1.name T1
set meas2.name T2
set mv1.name Q
set loop1.name bottom
set loop1.out Q
set block1.kind column
set block1.value.1 1,2,0,0,10,2,5,1
set block2.kind composition
set block2.column 1
set block2.inputs T1,T2,Q
set block2.place.1 7,1
set block2.place.2 3,1
set block2.is.3 heat
apply
"""
HEADER = "number,time[s],T1.meas[K],T1.quality,T2.meas[K],T2.quality,Q.applied[kW]\n"


def rows(*more: str) -> str:
    return HEADER + "".join(f"{k},{10 * k},350,0,360,0,5\n" for k in range(4)) + "".join(more)


class Recorded(FolderTest):
    def read(self, log: str, conf: str = CONF):
        return recorded_run.read(self.file("log.csv", log), [self.file("a.conf", conf)], None)

    def refused(self, log: str, conf: str = CONF) -> str:
        with self.assertRaises(UserError) as caught:
            self.read(log, conf)
        return str(caught.exception)

    def test_channels_sections_and_owners_come_from_the_configuration(self) -> None:
        of, block = self.read(rows())
        self.assertEqual([c.name for c in of.measured], ["T1", "T2"])
        self.assertEqual([(s.name, s.above, s.moves) for s in block.sensors], [("T1", True, True), ("T2", False, True)])
        self.assertEqual((of.tick_s, of.owner), (10.0, {"Q": "bottom"}))

    def test_a_plants_log_has_outputs_of_the_interval_before_and_telemetry_those_from_then_on(self) -> None:
        log = HEADER + "".join(f"{k},{10 * k},350,0,360,0,{k}\n" for k in range(4))
        self.assertEqual([x for x, in self.read(log)[0].applied], [1, 2, 3, 3])
        told = "H,1,number,time[s],T1[K],T1.q,T2[K],T2.q,Q.app[kW]\n" + "".join(f"T,1,{k},{10 * k},350,0,360,0,{k}\n" for k in range(4))
        self.assertEqual([x for x, in self.read(told)[0].applied], [0, 1, 2, 3])
        self.assertEqual([x for x, in self.read("> log on\n" + "".join(f"< {line}\n" for line in told.splitlines()))[0].applied], [0, 1, 2, 3])

    def test_filters_of_a_board_do_not_act_twice(self) -> None:
        told = "H,1,number,time[s],T1[K],T1.q,T2[K],T2.q,Q.app[kW]\n" + "".join(f"T,1,{k},{10 * k},350,0,360,0,{k}\n" for k in range(4))
        conf = CONF.replace("set meas2.name T2", "set meas2.name T2\nset meas2.filter 60")
        self.assertEqual(self.read(told, conf)[0].config[-3:], ["begin", "set meas2.filter 0", "apply"])

    def test_a_missing_channel_is_named_with_those_that_are_there(self) -> None:
        words = self.refused(rows().replace("T2.", "T9."))
        self.assertIn("no column T2.meas", words)
        self.assertIn("T9.meas", words)

    def test_no_number_that_is_called_good_is_refused_with_its_time_and_one_that_is_called_bad_is_not(self) -> None:
        self.assertIn("T1.meas is not a number in the sample at 40 s", self.refused(rows("4,40,nan,0,360,0,5\n")))
        self.assertIn("T1.meas is not a number in the sample at 40 s", self.refused(rows("4,40,,0,360,0,5\n")))
        self.assertIn("Q.applied is not a number in the sample at 40 s", self.refused(rows("4,40,350,0,360,0,nan\n")))
        self.assertEqual(self.read(rows("4,40,nan,3,360,0,5\n"))[0].readings[4][0], (0.0, 3))

    def test_times_that_are_no_ticks_are_refused(self) -> None:
        self.assertIn("not a multiple of the tick", self.refused(rows("4,43,350,0,360,0,5\n")))
        self.assertIn("no two samples", self.refused(HEADER + "0,0,350,0,360,0,5\n"))

    def test_a_configuration_without_an_estimator_is_refused(self) -> None:
        self.assertIn("no block of the kind composition", self.refused(rows(), CONF.replace("composition", "gmv")))

    def test_wrong_places_are_refused_by_the_command(self) -> None:
        for place, why in (((self.folder,), "no log.csv there"), ((self.folder / "nothing",), "no such file"),
                           ((self.file("words.txt", "hello\n"),), "nor telemetry"), ((self.file("log2.csv", rows()),), "--conf FILE"),
                           ((self.file("log3.csv", rows()), "--conf", self.folder / "none.conf"), "no such file")):
            status, _, err = call("consistency", "check", *map(str, place), "--no-build")
            self.assertEqual(status, 2)
            self.assertIn(why, err)
            self.assertEqual(err.count("\n"), 1)


if __name__ == "__main__":
    unittest.main()
