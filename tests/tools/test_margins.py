"""Margins of loops, and the trial as the model predicts it, beside what can be worked out on paper."""

import math
import unittest
from unittest import mock

import support
import numpy as np

from reflux import margins, run_margins, scenario_settings
from reflux.commission import closed_loops
from reflux.commission.figures import step_response
from reflux.commission.results import Element

STEP_S = 0.05


def first_order(dead_s: float, omega: np.ndarray, gain: float = 1.0, time_s: float = 60.0) -> np.ndarray:
    a = np.array([[-1 / time_s]])
    return margins.sampled(a, np.array([[gain / time_s]]), np.array([[1.0]]), np.array([[0.0]]), np.array([[dead_s]]), STEP_S, omega)


def element(**more: float) -> Element:
    return Element("T", "h", "degC/kW", **{"gain": 1.0, "gain_sd": 0.0, "time_s": 60.0, "time_sd_s": 0.0, "dead_s": 20.0, "dead_sd_s": 0.0, "flags": [], **more})


class Margins(unittest.TestCase):
    def test_a_pi_that_cancels_the_lag_has_the_margins_of_an_integrator_with_dead_time(self) -> None:
        """L = K exp(-20 s) / (60 s): gain margin pi 60 / (2 K 20), phase margin 90 degrees less K 20 / 60 rad."""
        omega = margins.frequencies(80.0, STEP_S)
        (found,) = margins.of_loops(omega, first_order(20.0, omega), [margins.Law(1.5, 60.0, step_s=STEP_S)])
        self.assertTrue(found.stable)
        self.assertAlmostEqual(found.gain, math.pi, delta=0.01)
        self.assertAlmostEqual(found.phase_deg, 90 - math.degrees(0.5), delta=0.1)
        self.assertAlmostEqual(found.sensitivity, 1.591, delta=0.002)
        self.assertAlmostEqual(found.together, found.sensitivity, places=9)

    def test_a_dead_time_of_a_fraction_of_a_step_is_exact(self) -> None:
        """G(z) of exp(-0.03 s)/(60 s + 1) at z = -1, from the two parts of the step in which an input acts."""
        omega = np.array([math.pi / STEP_S])
        lag = math.exp(-STEP_S / 60)
        new, old = 1 - math.exp(-0.02 / 60), math.exp(-0.02 / 60) - lag
        self.assertAlmostEqual(complex(first_order(0.03, omega)[0, 0, 0]).real, (new - old) / (-1 - lag), places=12)

    def test_too_much_gain_is_called_unstable(self) -> None:
        omega = margins.frequencies(80.0, STEP_S)
        (found,) = margins.of_loops(omega, first_order(20.0, omega), [margins.Law(5.0, 60.0, step_s=STEP_S)])
        self.assertEqual(found.cells(), ["unstable", "-", "-", "-"])

    def test_the_wrong_action_is_called_unstable(self) -> None:
        omega = margins.frequencies(80.0, STEP_S)
        (found,) = margins.of_loops(omega, first_order(20.0, omega), [margins.Law(0.5, 60.0, sign=-1.0, step_s=STEP_S)])
        self.assertFalse(found.stable)

    def test_another_loop_counts_only_where_it_interacts(self) -> None:
        omega = margins.frequencies(80.0, STEP_S)
        g = first_order(20.0, omega)[:, 0, 0]
        laws = [margins.Law(1.5, 60.0, step_s=STEP_S)] * 2
        for across, same in ((0.0, True), (0.5, False)):
            plant = np.array([[g, across * g], [across * g, g]]).transpose(2, 0, 1)
            found = margins.of_loops(omega, plant, laws)[0]
            self.assertEqual(abs(found.together - found.sensitivity) < 1e-9, same)

    def test_a_plants_linearisation_becomes_margins_and_a_foreign_law_a_reason(self) -> None:
        model = {"period_s": 0, "outputs": ["T"], "inputs": ["h"], "A": [[-1 / 60]], "B": [[1 / 60]], "C": [[2.0]], "D": [[0.0]], "dead_s": [[20]]}
        lines = ["set meas1.name T", "set meas1.lo 0", "set meas1.hi 200", "set mv1.name h", "set mv1.lo 0", "set mv1.hi 100", "set loop1.name one",
                 "set loop1.pv T", "set loop1.out h", "set loop1.gain 1.5", "set loop1.ti 60"]
        values = scenario_settings.values_of(lines)
        found = run_margins.on_model(model, scenario_settings.loops(values), STEP_S)
        self.assertEqual([name for name, _ in found.loops], ["one"])
        self.assertAlmostEqual(found.loops[0][1].gain, math.pi, delta=0.01)  # gain 2 x 100/200 is 1 span per span
        self.assertEqual(run_margins.other_law(values, ["one"]), "")
        self.assertIn("kind gmv", run_margins.other_law({**values, "block1.kind": "gmv"}, ["one"]))
        self.assertIn("two-position", run_margins.other_law({**values, "loop1.algorithm": "two_position"}, ["one"]))
        self.assertIn("decoupler", run_margins.other_law({**values, "loop1.decouple": "on"}, ["one"]))
        self.assertIn("analyser", run_margins.other_law({**values, "meas1.every": "5"}, ["one"]))


class Shapes(unittest.TestCase):
    def test_a_response_with_two_lags_and_a_zero_is_that_of_its_differential_equation(self) -> None:
        t = np.arange(0.0, 400.0, 0.01)
        for square, time, zero in ((900.0, 70.0, 0.0), (900.0, 60.0, -20.0), (900.0, 20.0, 15.0), (0.0, 60.0, 0.0), (0.0, 60.0, 20.0)):
            with self.subTest((square, time, zero)):
                s = closed_loops.state_space(element(square_s2=square, time_s=time, zero_s=zero))
                x, y = np.zeros((len(s.a), 1)), []
                for _ in t:
                    y.append(float((s.c @ x).sum()) + s.d)
                    x = x + 0.01 * (s.a @ x + s.b)
                self.assertLess(float(np.abs(np.array(y) - step_response(element(square_s2=square, time_s=time, zero_s=zero), t)).max()), 2e-3)


class Doubts(unittest.TestCase):
    """Two loops with the margins given, of elements that settle within 200 s by themselves."""

    GOOD = margins.Margins(4.0, 60.0, 1.4, 1.5, True)

    def words(self, *found: margins.Margins, settles_s: float = 150.0, answers: str = "") -> list[str]:
        from types import SimpleNamespace as Bag
        from reflux.commission.results import Loop, Model, Proposal
        names = ["T", "x"][:len(found)]
        loops = [Loop(name, "h", 2.0, 60.0, 0.0, "reverse", 1.0, 0.0, 0.0, settles_s) for name in names]
        record = Bag(model=Model(elements={(name, "h"): element() for name in names}), proposal=Proposal(loops=loops), answers=answers)
        said = closed_loops.doubts(record, list(zip(names, found)))
        self.cells = {name: [x.cells for x in doubts] for name, doubts in said.items()}
        self.slow = [name for name, doubts in said.items() if any(x.slow for x in doubts)]
        return [x.words for doubts in said.values() for x in doubts]

    def test_a_loop_near_its_limit_is_named_and_its_cells_are_marked(self) -> None:
        self.assertEqual(self.words(self.GOOD, self.GOOD), [])
        (words,) = self.words(self.GOOD, margins.Margins(1.25, 20.0, 5.06, 1.8, True))
        self.assertEqual(words, "x: with the other loops in manual its Ms is 5.06 (up to 2 is usual) and its gain margin is 1.25 (less than 1.7): it may "
                         "oscillate while they are in manual. Lower its gain, or keep them in automatic.")
        self.assertEqual(self.cells, {"x": [(2, 0)]})
        (words,) = self.words(margins.Margins(1.6, 60.0, 2.4, 2.4, True), answers='[proposal.set]\n"loop1.gain" = "1"\n')
        self.assertEqual(words, "T: its gain margin is 1.6 (less than 1.7): it may oscillate. Lower its gain. These are the margins as proposed, before "
                         "the edits.")
        (words,) = self.words(self.GOOD, margins.Margins(math.inf, 0.0, 9.0, 1.8, False))
        self.assertIn("x: with the other loops in manual it is unstable on the model", words)

    def test_a_loop_far_slower_than_its_plant_is_named_where_it_settles_later_than_the_plant(self) -> None:
        slow = margins.Margins(25.0, 80.0, 1.05, 1.1, True)
        self.assertEqual(self.words(slow, self.GOOD), [])  # 150 s: faster than 20 s and three times 60 s
        (words,) = self.words(slow, self.GOOD, settles_s=900.0)
        self.assertIn("T: its gain margin is 25, so it is far slower than its plant: a setpoint step settles in 15 min on the model, while the plant by "
                      "itself takes 3 min.", words)
        self.assertEqual((self.cells, self.slow), ({"T": [(0,)]}, ["T"]))
        self.words(self.GOOD, margins.Margins(1.25, 20.0, 5.06, 1.8, True))
        self.assertEqual(self.slow, [])

    def test_only_loops_that_keep_up_with_their_plant_have_a_green_badge_and_status_0(self) -> None:
        from types import SimpleNamespace as Bag
        from reflux import cmd_commission
        from reflux.commission import record, report
        near, slow = closed_loops.Doubt("x: it may oscillate.", (2,)), closed_loops.Doubt("T: it is far slower than its plant.", (0,), slow=True)
        for kept, left, said, badge, words, status in (
                (True, [], {}, "pass", "2 loops kept", 0), (True, [], {"x": [near]}, "pass", "2 loops kept", 0),
                (True, [("input", "u2", "")], {}, "doubt", "2 loops kept", 3),
                (True, [], {"x": [near], "T": [near, slow]}, "doubt", "2 loops kept; far slower than its plant: T", 3),
                (True, [], {"x": [slow], "T": [slow]}, "doubt", "2 loops kept; far slower than their plant: x, T", 3),
                (False, [], {"T": [slow]}, "fail", "2 loops kept", 1)):
            r = Bag(kept=kept, outcome="2 loops kept", pairing=Bag(left=left))
            with self.subTest(badge=badge, words=words), mock.patch.object(closed_loops, "doubts", lambda *_: said), \
                    mock.patch.object(closed_loops, "of_proposal", lambda _: []), mock.patch.object(record, "load", lambda _: r):
                self.assertIn(f'class="verdict {badge}"', report.verdict(r).html)
                self.assertEqual(report.outcome(r), words)
                if kept:  # the tool ends with an error of its own where nothing is
                    self.assertEqual(cmd_commission.status(cmd_commission.margin_doubts(support.ROOT), left), status)


class Trial(unittest.TestCase):
    """predicted(), with a record that has only what it asks for."""

    def record(self, ti_s: float, probe: float = 1.0):
        from types import SimpleNamespace as Bag
        from reflux.commission.record import Channel
        from reflux.commission.results import Loop, Model, Proposal
        loop = Loop("T", "h", 2.0, ti_s, 0.0, "reverse", 1.0, 0.0, 0.0, 0.0)
        return Bag(model=Model(elements={("T", "h"): element(dead_s=20.0)}), proposal=Proposal(decoupler="none: single loops are enough", loops=[loop]),
                   plant=Bag(tick_s=10.0), channels={"T": Channel("T", "degC", 0, 100), "h": Channel("h", "kW", 0, 100)}, probe=probe,
                   folder=support.ROOT / "none")

    def predicted(self, record, setpoint: np.ndarray) -> np.ndarray:
        (y,) = closed_loops.predicted(record, [setpoint], [np.full(len(setpoint), 50.0)])
        return y

    def test_the_measurement_begins_to_move_after_the_dead_time_and_comes_to_the_setpoint(self) -> None:
        setpoint = np.full(300, 40.0)
        setpoint[5:] = 42.0
        y = self.predicted(self.record(60.0), setpoint)
        self.assertTrue(np.all(y[:8] == 40.0))  # 20 s of dead time are two ticks
        self.assertAlmostEqual(y[8], 40 + 2 * 2.0 * (1 - math.exp(-10 / 60)), places=9)
        self.assertAlmostEqual(y[-1], 42.0, places=3)

    def test_the_way_back_is_made_with_the_gain_of_the_probe(self) -> None:
        setpoint = np.full(300, 40.0)
        setpoint[1:] = 40.01  # a loop's setpoint follows the measurement until it is closed: no step
        setpoint[5:150], setpoint[150:] = 42.0, 40.01
        plain, probed = self.predicted(self.record(60.0), setpoint), self.predicted(self.record(60.0, 1.5), setpoint)
        self.assertTrue(np.array_equal(plain[:153], probed[:153]))
        self.assertAlmostEqual((probed[153] - probed[152]) / (plain[153] - plain[152]), 1.5, places=3)

    def test_an_input_stops_at_its_limit(self) -> None:
        setpoint = np.full(400, 40.0)
        setpoint[5:] = 99.0  # needs 59 kW more, and there are 50
        self.assertAlmostEqual(self.predicted(self.record(60.0), setpoint)[-1], 90.0, places=3)

    def test_behind_a_decoupler_there_is_no_prediction(self) -> None:
        record = self.record(60.0)
        record.proposal.decoupler = "of two loops"
        self.assertIn("decoupler", closed_loops.why_not(record))
        self.assertIsNone(closed_loops.predicted(record, [np.zeros(3)], [np.zeros(3)]))


if __name__ == "__main__":
    unittest.main()
