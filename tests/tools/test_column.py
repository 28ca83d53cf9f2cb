"""tools/column: numbers on matrices whose answers are known exactly, what it reads of a file, its refusals, a whole run."""

import json
import math
import os
import unittest
from unittest import mock

import numpy as np
from support import ROOT, FolderTest, call

from reflux import build, column_file, column_loops, linear_analysis as linear
from reflux.errors import UserError
from reflux.gradients import Diagram

HEXANES = ROOT / "tests" / "tools" / "data" / "hexanes.json"

TAU = (100.0, 40.0)
K = np.array([[2.0, -1.5], [1.0, -4.0]])


def first_orders(k: np.ndarray = K) -> linear.Model:
    """Each input through a lag of its own."""
    return linear.Model(np.diag([-1 / t for t in TAU]), np.diag([1 / t for t in TAU]), k, np.zeros_like(k), ("u1", "u2"),
                        tuple(f"y{i + 1}" for i in range(len(k))))


class Numbers(unittest.TestCase):
    def test_gains_and_the_relative_gain_of_two_by_two(self) -> None:
        np.testing.assert_allclose(linear.gains(first_orders()), K)
        right = K[0, 0] * K[1, 1] / np.linalg.det(K)
        np.testing.assert_allclose(linear.relative_gains(K), [[right, 1 - right], [1 - right, right]])

    def test_relative_gains_of_more_outputs_than_inputs_add_up_to_one_for_each_input(self) -> None:
        relative = linear.relative_gains(np.array([[2.0, 1.0], [1.0, 3.0], [0.5, -1.0]]))
        np.testing.assert_allclose(relative.sum(axis=0), [1, 1])
        self.assertTrue((0 <= relative.sum(axis=1)).all() and (relative.sum(axis=1) <= 1).all())

    def test_slow_poles_come_first(self) -> None:
        np.testing.assert_allclose(-1 / linear.poles(first_orders()).real, TAU)

    def test_a_lag_is_within_five_percent_after_three_time_constants(self) -> None:
        found = linear.settling(first_orders(), K, K, TAU[0])
        for j, tau in enumerate(TAU):
            np.testing.assert_allclose(found[:, j], tau * math.log(20), atol=12 * TAU[0] / linear.GRID)

    def test_an_output_that_hardly_moves_has_no_settling_time(self) -> None:
        k = np.array([[1.0, 1e-6], [1.0, 1.0]])
        found = linear.settling(first_orders(k), k, k, TAU[0])
        self.assertEqual(np.isnan(found).tolist(), [[False, True], [False, False]])

    def test_strong_and_weak_direction(self) -> None:
        s = math.sqrt(0.5)
        found = linear.directions(10 * np.outer([s, s], [s, -s]) + 0.5 * np.outer([s, -s], [s, s]))
        np.testing.assert_allclose(found.values, [10, 0.5])
        self.assertAlmostEqual(found.condition, 20)
        np.testing.assert_allclose(abs(found.inputs @ np.array([[s, s], [-s, s]])), np.eye(2), atol=1e-12)
        np.testing.assert_allclose(abs(found.outputs @ np.array([[s, s], [s, -s]])), np.eye(2), atol=1e-12)
        for i in range(2):  # what moves and what is moved have the signs that belong together
            matrix = sum(v * np.outer(o, u) for v, o, u in zip(found.values, found.outputs, found.inputs))
            np.testing.assert_allclose(matrix @ found.inputs[i], found.values[i] * found.outputs[i], atol=1e-12)

    def test_what_runs_away_has_no_steady_state(self) -> None:
        self.assertIsNone(linear.obstacle(np.array([-1e-5, -2.0])))
        self.assertIn("1 of its poles are 0", str(linear.obstacle(np.array([0.0, -2.0]))))
        self.assertIn("unstable", str(linear.obstacle(np.array([1e-3, -2.0]))))


SMALL = {"column": 1, "name": "small", "title": "a small one", "stages": 6, "feed_stage": 3, "outputs": [
    {"name": "T2", "is": "temperature", "stage": 2}, {"name": "T5", "is": "temperature", "stage": 5},
    {"name": "T4", "is": "temperature", "stage": 4}, {"name": "mean", "is": "temperature", "stages": [2, 3]}],
    "truths": [{"name": "xD", "is": "fraction", "of": "a", "stage": 6}, {"name": "T1", "is": "temperature", "stage": 1},
               {"name": "xB", "is": "log_fraction", "of": "a", "stage": 1}, {"name": "x3", "is": "fraction", "of": "a", "stage": 3}]}


class Files(FolderTest):
    def test_products_and_the_temperatures_at_the_steepest_places(self) -> None:
        column = column_file.read(str(self.file("small.json", json.dumps(SMALL))))
        self.assertEqual(column.products, ("xD", "xB"))
        self.assertEqual((column.measured, column.unmeasured), ({"T2": 2, "T5": 5, "T4": 4}, {"T1": 1}))
        self.assertEqual(column_file.steepest(column, [400, 399, 390, 389, 360, 340]), ("T5", "T2"))
        self.assertEqual(column_file.steepest(column, [400, 390, 389, 370, 360, 359]), ("T4", "T2"))
        bare = column_file.read(str(self.file("bare.json", json.dumps(SMALL | {"outputs": []}))))
        self.assertEqual(column_file.steepest(bare, [400, 390, 389, 370, 360, 359]), ("T1",))

    def test_a_section_without_a_thermometer_is_named_with_those_of_the_other_one_that_are_left_out(self) -> None:
        profile = [400, 390, 389, 370, 360, 359]  # the feed is on stage 3
        feed = column_file.ColumnFile("c", "", 6, 3, {"T2": 2, "T3": 3}, {}, ())
        chosen = column_file.steepest(feed, profile)
        self.assertEqual(column_file.without_temperature(feed, chosen), [
            "No thermometer in the enriching section, stages 4 to 6: left out is T2 on stage 2, because T3 is nearer the steepest place of its section. "
            "--outputs T2,T3 takes all."])
        profile[3] = 388  # now stage 2 is the steeper one
        chosen = column_file.steepest(feed, profile)
        self.assertEqual(column_file.without_temperature(feed, chosen), [
            "No thermometer in the enriching section, stages 4 to 6: left out is T3 on the feed stage 3, because T2 is nearer the steepest place of its "
            "section; the feed stage counts as stripping. --outputs T3,T2 takes all."])
        both = column_file.ColumnFile("c", "", 6, 3, {"T3": 3, "T5": 5, "T2": 2}, {}, ())
        self.assertEqual(column_file.without_temperature(both, column_file.steepest(both, profile)), [])
        alone = column_file.ColumnFile("c", "", 6, 3, {"T5": 5}, {}, ())
        self.assertEqual(column_file.without_temperature(alone, ("T5",)), ["No thermometer in the stripping section, stages 1 to 3."])

    def test_what_is_no_column_is_said_in_one_line(self) -> None:
        for text, words in (("{", "not JSON"), ("[]", "is not a plant"), ('{"plant": 1}', "is not a column"),
                            ('{"column": 1, "name": "x", "stages": {}}', "is not a sound column")):
            with self.assertRaises(UserError) as caught:
                column_file.read(str(self.file("bad.json", text)))
            self.assertIn(words, str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))
        with self.assertRaisesRegex(UserError, "nowhere.json: cannot be read: No such file"):
            column_file.read(str(self.folder / "nowhere.json"))
        with self.assertRaisesRegex(UserError, "no plant of that name"):
            column_file.read("wood-berries")

    def test_a_folder_of_ones_own_comes_first(self) -> None:
        self.file("pilot.json", json.dumps(SMALL))
        with mock.patch.dict(os.environ, {"REFLUX_PLANTS": str(self.folder)}):
            self.assertEqual(column_file.read("pilot").name, "small")


class Command(FolderTest):
    def test_the_pilot_as_a_picture_and_in_figures(self) -> None:
        picture = self.folder / "of" / "pilot.png"
        status, out, err = call("column", "pilot", "--outputs", "T1,T10", "--out", str(picture))
        self.assertEqual((status, err), (0, ""))
        self.assertTrue(picture.read_bytes().startswith(b"\x89PNG"))
        rows = [line.split() for line in out.splitlines()]
        relative = [row for row in rows if row and row[0] in ("T1", "T10") and len(row) == 3]
        self.assertAlmostEqual(sum(float(row[1]) for row in relative), 1, delta=2e-3)
        self.assertIn("slowest time constants: 20.8 min, 3.36 min", out)
        self.assertIn("\nAt rest\n  inputs: Lr 4.5 l/h, Qrb 0.8 kW\n", out)
        self.assertIn("condition number", out)

    def test_what_cannot_be_is_said_in_one_line(self) -> None:
        picture = str(self.folder / "x.png")
        for arguments, words in ((("pilot", "--outputs", "T99"), "--outputs T99: pilot has no such output; there is T1 "),
                                 (("pilot", "--inputs", "T1"), "--inputs T1: pilot has no such input; there is Lr "),
                                 (("pilot", "--set", "Lr=99"), "Lr = 99 l/h is outside 0 to 12"),
                                 (("wood-berry",), "is not a column")):
            status, _, err = call("column", *arguments, "--out", picture)
            self.assertEqual((status, err.count("\n")), (2, 1), err)
            self.assertIn(words, err)


def channel(**more: object) -> dict:
    return {"lo": 0, "hi": 100, **more}


class Loops(unittest.TestCase):
    """Lines that `--board` makes from step responses; how they do on a board is in tests/loop/test_column_board.py."""

    def test_a_first_order_lag_is_found_as_it_is(self) -> None:
        gain, dead, lag = column_loops.first_orders(first_orders(), np.ones((2, 2)))
        np.testing.assert_allclose(gain, K)
        np.testing.assert_allclose(lag, [TAU, TAU], rtol=0.02)
        np.testing.assert_allclose(dead, 0, atol=1)

    def test_a_chain_of_lags_has_a_dead_time(self) -> None:
        n = 4
        chain = linear.Model(np.diag([-0.01] * n) + np.diag([0.01] * (n - 1), -1), np.eye(n)[:, :1] * 0.01, np.eye(n)[-1:], np.zeros((1, 1)), ("u",), ("y",))
        _, dead, lag = column_loops.first_orders(chain, np.ones((1, 1)))
        self.assertTrue(100 < dead[0, 0] < 300 and 100 < lag[0, 0] < 400, (dead, lag))

    def test_noise_lowers_a_gain_and_lengthens_the_integral_time(self) -> None:
        self.assertEqual(column_loops.quiet(-8.0, 100.0, -0.5, 1000.0, channel()), (-8.0, 100.0))
        k, ti = column_loops.quiet(-8.0, 100.0, -0.5, 1000.0, channel(noise=0.5))
        self.assertAlmostEqual(k, -2.0)  # 0.5 % of noise, 1 % of the output
        self.assertAlmostEqual(ti, 1000.0)  # SIMC: the smaller of 1000 s and 4 * 1000 s / (0.5 * 2)

    def test_a_measurement_that_no_input_moves_has_no_loop_and_the_others_have(self) -> None:
        build.build("host", ("libreflux",), quiet=True)
        k = np.array([[2.0, -1.5], [1e-7, 1e-7]])
        channels = {name: channel() for name in ("u1", "u2", "y1", "y2")}
        loops, words = column_loops.paired(first_orders(k), {"y1": "top", "y2": "bottom"}, channels, 1.0)
        self.assertEqual([(loop.name, loop.pv) for loop in loops], [("top", "y1")])
        self.assertIn("# no loop for y2: the whole span of an input moves it by less than 0.1 % of its own", words)

    def test_loops_are_slowed_where_a_part_of_the_response_is_faster_than_the_tick(self) -> None:
        channels = {"u1": channel(), "y1": channel()}
        loop = column_loops.Loop("top", "y1", "u1", "reverse", 6.0, 500.0)
        for fast, least, most in ((0.0, 1.0, 1.0), (0.3, 1.5, 6.0)):  # stable is 0.3 * 6 * 1.7 / factor < 2 about, and a PI needs more
            model = linear.Model(np.diag([-0.1, -0.001]), np.array([[0.1], [0.001]]), np.array([[fast, 1 - fast]]), np.zeros((1, 1)), ("u1",), ("y1",))
            self.assertTrue(least <= column_loops.slower(model, [loop], channels, 20.0) <= most)

    def controlled(self, *outputs: dict) -> dict[str, str]:
        plant = {"stages": 12, "feed_stage": 6, "outputs": list(outputs)}
        of = Diagram([-0.1, -1.0, -4.0, -1.0, -1.0, -1.0, -2.0, -5.0, -2.0, -1.0, -0.1], [[-1.0, 0.0]] * 11, ["a", "b"])
        return column_loops.controlled(plant, plant["outputs"], of, ("a", "b"))

    def test_the_steepest_thermometer_of_a_section_is_controlled_and_not_one_beside_the_feed(self) -> None:
        t = [{"name": f"T{s}", "is": "temperature", "stage": s} for s in (3, 4, 6, 7, 8, 12)]
        self.assertEqual(self.controlled(*t), {"top": "T8", "bottom": "T3"})
        self.assertEqual(self.controlled(t[3]), {"top": "T7"})  # there is no other

    def test_without_a_thermometer_that_says_anything_the_product_is_controlled(self) -> None:
        analyser = {"name": "AD", "is": "fraction", "stage": 12, "of": "a"}
        self.assertEqual(self.controlled({"name": "T12", "is": "temperature", "stage": 12}, analyser), {"top": "AD"})


class Board(FolderTest):
    def board(self, change: object = None, *arguments: str) -> list[str]:
        plant = json.loads(HEXANES.read_text(encoding="utf-8"))
        if callable(change):
            change(plant)
        status, out, err = call("column", str(self.file("mine.json", json.dumps(plant))), "--board", *arguments)
        self.assertEqual(status, 0, err)
        return out.splitlines()

    def test_limits_and_safe_values_are_in_the_units_of_the_column(self) -> None:
        lines = self.board(lambda plant: plant["inputs"][0].pop("safe"))
        for line in ("set mv1.min 0", "set mv1.max 20", "set mv2.max 4000", "set mv2.safe 0", "set mv2.rate 40"):
            self.assertIn(line, lines)
        self.assertIn("set mv1.safe 5.467094", lines)  # the steady state's, not the 9 t/h of the file

    def lock(self, k: int, lines: list[str]) -> dict[str, str]:
        """Rows of an interlock."""
        return {line.split()[1].split(".")[1]: line.split()[2] for line in lines if line.startswith(f"set lock{k}.")}

    def test_the_interlock_is_above_what_composition_can_do_whatever_the_span(self) -> None:
        found = [self.lock(1, self.board(lambda plant: plant["outputs"][0].update(lo=lo, hi=hi))) for lo, hi in ((40, 160), (0, 300), (60, 140))]
        self.assertEqual(found, found[:1] * 3)
        self.assertEqual({x: found[0][x] for x in ("meas", "mv", "side", "value")}, {"meas": "TI1", "mv": "QC102", "side": "above", "value": "0"})
        # Octane boils at 134.5 degC at 1.1 times 1050 + 120 mbar by Antoine's equation with the constants of the file.
        self.assertAlmostEqual(float(found[0]["limit"]), 134.5, delta=0.2)
        lines = self.board(lambda plant: plant["outputs"][0].update(hi=120))
        self.assertEqual(self.lock(1, lines)["limit"], "119.5")
        self.assertIn("and the span of TI1 ends at 120: the limit is below its end. A wider span is better.", "\n".join(lines))

    def test_pressure_and_level_have_interlocks_where_they_are_measured(self) -> None:
        self.assertEqual(self.lock(2, self.board()), {})
        self.assertIn("No interlock sees the reboiler run dry: a thermometer there is then in vapour", "\n".join(self.board()))

        def gauges(plant: dict) -> None:
            plant["levels"] = {"capacity": 2, "condenser": {"by": "distillate", "gain": 0.02}, "reboiler": {"by": "bottoms", "gain": 0.02}}
            plant["outputs"] += [{"name": "PI", "is": "pressure", "unit": "bar", "lo": 0.9, "hi": 1.5},
                                 {"name": "LB", "is": "level", "stage": 1, "unit": "%", "lo": 0, "hi": 100}]

        lines = self.board(gauges)
        self.assertEqual(self.lock(2, lines), {"meas": "PI", "mv": "QC102", "side": "above", "limit": "1.155", "hysteresis": "0.0525", "value": "0"})
        self.assertEqual(self.lock(3, lines), {"meas": "LB", "mv": "QC102", "side": "below", "limit": "25", "hysteresis": "10", "value": "0"})
        self.assertNotIn("No interlock sees", "\n".join(lines))
        lines = self.board(lambda plant: (gauges(plant), plant["outputs"][-2].update(hi=1.1)))
        self.assertIn("# no interlock by pressure: the span of PI ends at 1.1 bar, below 1.155, 10 % above where it rests", lines)
        self.assertEqual(self.lock(2, lines)["meas"], "LB")

    def test_the_feed_has_a_loop_only_where_other_inputs_are_too_few(self) -> None:
        def feed(plant: dict) -> None:
            plant["inputs"].append(plant["disturbances"].pop(0))

        lines = self.board(feed)
        self.assertIn("# no loop moves F: the feed is yours to set, and FC101 and QC102 are enough", lines)
        self.assertEqual([line for line in lines if line.endswith(".out F")], [])
        self.assertEqual([line for line in lines if ".out " in line], [line for line in self.board() if ".out " in line])
        moved, words = column_loops.movers([{"name": "F", "is": "feed"}, {"name": "Q", "is": "heat"}], 2)
        self.assertEqual(moved, ["Q", "F"])
        self.assertIn("a loop may move F, because other inputs are too few", words[0])

    def test_a_span_that_begins_above_the_rooms_temperature_needs_a_limit_of_belief(self) -> None:
        def begins(lo: float) -> bool:
            return any(line.startswith("# Cold, ") for line in self.board(lambda plant: plant["outputs"][0].update(lo=lo)))

        self.assertTrue(begins(60))
        self.assertFalse(begins(0))
        self.assertFalse(begins(21))  # 20 degC is below the span, and counts as uncertain

    def test_products_by_mass_are_estimated_by_mass(self) -> None:
        def by_mass(plant: dict) -> None:
            for truth in plant["truths"]:
                truth["unit"] = "%w"

        def one_by_mass(plant: dict) -> None:
            plant["truths"][0]["unit"] = "%w"

        self.assertIn("set block2.basis mass", self.board(by_mass))
        lines = self.board(one_by_mass)
        self.assertNotIn("set block2.basis mass", lines)
        self.assertIn("set meas10.unit -", lines)  # moles, as the other one
        self.assertIn("set meas11.unit %", lines)

    def test_another_operating_point_has_another_table_and_other_settings(self) -> None:
        there, here = self.board(None, "--set", "QC102=1200", "--set", "F=11"), self.board()
        self.assertIn("#   out QC102 1200", there)
        for start in ("set block1.checksum.1 ", "set loop1.gain "):
            self.assertNotEqual(*(next(line for line in lines if line.startswith(start)) for lines in (there, here)))

    def test_what_cannot_be_estimated_is_left_out_with_the_reason(self) -> None:
        def no_thermometer_below(plant: dict) -> None:
            plant["outputs"] = [c for c in plant["outputs"] if c["name"] not in ("TI1", "TI5", "TI8", "TD")]

        lines = self.board(no_thermometer_below)
        self.assertIn("set block2.points xD_est", lines)
        self.assertTrue(any(line.startswith("# not estimated: hexane:1: no thermometer of the stripping section") for line in lines))
        status, out, _ = call("column", "column-a", "--board")
        self.assertEqual(status, 0)
        self.assertIn("# not estimated: no table for a board: the column has 41 stages, a table 40 at most", out)
        self.assertNotIn("block1", out)

    def test_a_pressure_that_is_measured_drives_the_estimator_and_one_that_is_not_is_told(self) -> None:
        def measured(plant: dict) -> None:
            plant["outputs"].append({"name": "PI", "is": "pressure", "unit": "mbar", "lo": 900, "hi": 1300})

        words = "# the pressure changes and nothing measures it: the estimates are off meanwhile. Add an output that is pressure"
        self.assertIn(words, self.board())
        lines = self.board(measured)
        self.assertNotIn(words, lines)
        for line in ("set block2.is.9 pressure", "set block2.si.9 100,0"):
            self.assertIn(line, lines)

    def test_it_takes_no_option_of_the_picture(self) -> None:
        status, _, err = call("column", "pilot", "--board", "--outputs", "T1")
        self.assertEqual(status, 2)
        self.assertIn("--board goes with --set alone", err)


if __name__ == "__main__":
    unittest.main()
