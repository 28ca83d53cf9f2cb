#!/usr/bin/python3
"""tools/decouple: what it designs against numpy, what the board takes, and what it says of models and options that are wrong.

usage: test_decouple_tool.py LIBRARY REFLUX_HOST
"""
import json
import sys
import unittest
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "tools"), str(HERE.parents[1] / "tools")]

from reflux import decoupled_loops, decoupling, libreflux, sampled_plant, session  # noqa: E402
from support import FolderTest, board, call, told  # noqa: E402

PLANTS = HERE.parents[1] / "host_sim" / "plants"
LOOPS = ("--loops", "pp", "--settling", "3600", "--tick", "60")
METHODS = (("polynomial",), ("static",), ("partial", "--factor", "0.5"), ("one-way", "--rank", "y2,y1"), ("directions", "--condition", "2"))
HOST = ""
TWO_LAGS = {
    "name": "two", "title": "two loops, each element with a lag of its own", "source": "ours", "model": "transfer", "time_unit": "s", "tick_s": 10,
    "outputs": [{"name": name, "unit": "degC", "lo": 0, "hi": 100, "nominal": 50} for name in ("y1", "y2")],
    "inputs": [{"name": name, "unit": "%", "lo": 0, "hi": 100, "nominal": 50} for name in ("u1", "u2")],
    "elements": [[{"gain": -0.8, "lags": 200, "dead_time": 20}, {"gain": 0.5, "lags": 260, "dead_time": 40}],
                 [{"gain": 0.6, "lags": 180, "dead_time": 30}, {"gain": 0.9, "lags": 120, "dead_time": 15}]],
}


def decouple(*arguments):
    return call("decouple", *arguments, "--no-build")


def as_json(*arguments):
    status, out, err = decouple(*arguments, "--format", "json")
    assert status == 0, err
    return json.loads(out)


def model(b, a=((-0.8,), (-0.7,)), period=60.0):
    """As tools/identify prints it: b outputs x inputs x coefficients of z^-1 on."""
    return {"period_s": period, "inputs": ["u1", "u2"], "outputs": [{"name": f"y{i + 1}", "A": [1.0, *a[i]], "B": [[0.0, *x] for x in row]} for i, row in enumerate(b)]}


def product(b, g):
    """B G, coefficients from z^-1 on."""
    n = len(b)
    return [[sum(np.convolve(b[i][k], g[k][j]) for k in range(n)) for j in range(n)] for i in range(n)]


class Design(FolderTest):
    def test_nothing_of_the_interaction_is_left_by_the_polynomial_one(self):
        plant = sampled_plant.read("kotyk-column", None, None).in_spans()
        found = as_json("kotyk-column")
        seen = product(plant.b, np.array(found["g"]))
        for i in range(2):
            self.assertGreater(np.abs(seen[i][i]).max(), 1e-3)
            self.assertLess(np.abs(seen[i][1 - i]).max(), 1e-15)

    def test_zeros_are_those_of_the_determinant_by_numpy(self):
        b = sampled_plant.read("kotyk-column", None, None).in_spans().b
        det = np.convolve(b[0][0], b[1][1]) - np.convolve(b[0][1], b[1][0])
        want = np.sort(np.roots(det).real)
        np.testing.assert_allclose(np.sort([z[0] for z in as_json("kotyk-column")["zeros"]]), want, rtol=1e-9)

    def test_a_static_one_is_the_inverse_of_the_gains_with_a_diagonal_of_1(self):
        k = sampled_plant.read("kotyk-column", None, None).in_spans().gains()
        inverse = np.linalg.inv(k)
        np.testing.assert_allclose(np.array(as_json("kotyk-column", "--method", "static")["g"])[:, :, 0], inverse / np.diag(inverse), atol=1e-12)

    def test_a_part_of_it_lies_between_none_and_all(self):
        def g(factor):
            return np.array(as_json("kotyk-column", "--method", "partial", "--factor", factor)["g"])[:, :, 0]
        np.testing.assert_allclose(g("0"), np.eye(2), atol=1e-15)
        np.testing.assert_allclose(g("0.5"), (g("0") + g("1")) / 2, atol=1e-12)
        np.testing.assert_allclose(g("1,0.25,0,1"), [[1, 0.25 * g("1")[0, 1]], [0, 1]], atol=1e-12)

    def test_one_way_leaves_the_first_of_the_ranks_alone(self):
        k = sampled_plant.read("kotyk-column", None, None).in_spans().gains()
        for first, rank in ((0, "y1,y2"), (1, "y2,y1")):
            seen = k @ np.array(as_json("kotyk-column", "--method", "one-way", "--rank", rank)["g"])[:, :, 0]
            self.assertLess(abs(seen[first, 1 - first]), 1e-12)
            self.assertGreater(abs(seen[1 - first, first]), 1e-2)

    def test_directions_under_no_bound_are_the_inverse_and_limit_the_weak_one_under_a_close_one(self):
        static = as_json("kotyk-column", "--method", "static")["g"]
        wide, close = (as_json("kotyk-column", "--method", "directions", "--condition", c) for c in ("10000", "1"))
        np.testing.assert_allclose(wide["g"], static, atol=1e-9)
        self.assertEqual((wide["limited"], close["limited"]), (0, 1))

    def test_controllers_close_the_loops_with_the_overshoot_asked_for(self):
        for method in METHODS:
            with self.subTest(method):
                found = as_json("kotyk-column", "--method", *method, *LOOPS)
                self.assertLess(found["largest_pole"], 1)
                for loop in found["loops"]:
                    self.assertAlmostEqual(loop["overshoot"], 0.1, places=4)
                    self.assertAlmostEqual(sum(loop["q"]), sum(loop["r"]), places=9)  # no offset

    def test_poles_of_other_elements_that_a_loop_does_not_move_are_left_out_and_told(self):
        arguments = ("wood-berry", "--period", "300", "--method", "partial", "--factor", "0", "--loops", "pp", "--settling", "6000")
        status, out, err = decouple(*arguments)
        self.assertEqual(status, 0, err)
        for name, lag in (("xD", 21.0), ("xB", 10.9)):
            self.assertIn(f"{name}: poles that the loop does not move: {np.exp(-5 / lag):.5g}", out)
        for loop in as_json(*arguments)["loops"]:
            self.assertAlmostEqual(loop["overshoot"], 0.1, places=4)

    def test_a_loop_without_zeros_of_its_own_has_a_controller(self):
        """All zeros of y1's loop are poles of the other element."""
        path = str(self.file("two.json", json.dumps(TWO_LAGS)))
        found = as_json(path, "--period", "20", "--method", "one-way", "--rank", "y1,y2", "--loops", "pp", "--settling", "1200", "--observer", "0.5", "--condition-hi", "1e6")
        self.assertAlmostEqual(found["loops"][0]["overshoot"], 0.1, places=4)
        self.assertLess(found["largest_pole"], 1)

    def test_engineering_units_change_what_is_printed_and_not_what_the_board_gets(self):
        spans, eu = as_json("kotyk-column"), as_json("kotyk-column", "--units", "eu")
        self.assertEqual(spans["lines"], eu["lines"])
        np.testing.assert_allclose(eu["gains"], np.array(spans["gains"]) * [[4 / 10, 4 / 10], [6 / 10, 6 / 10]], rtol=1e-12)

    def test_a_continuous_plant_is_sampled_with_its_dead_times(self):
        plant = sampled_plant.read("wood-berry", None, 900.0)
        np.testing.assert_allclose(plant.gains(), [[12.8, -18.9], [6.6, -19.4]], rtol=1e-9)
        # First coefficient of xB by S: 12 of 15 min after a dead time of 3, numerator over the poles of both elements.
        np.testing.assert_allclose(plant.b[1, 1, 0], -19.4 * (1 - np.exp(-12 / 14.4)), rtol=1e-9)


class Lines(FolderTest):
    def test_a_polynomial_row_has_as_many_coefficients_as_the_kind_takes_and_its_design(self):
        found = as_json("kotyk-column")
        rows = [line.split()[2] for line in found["lines"] if ".g." in line]
        self.assertEqual(len(rows), 4)
        for row, g in zip(rows, np.array(found["g"]).reshape(4, -1)):
            numbers = [float(x) for x in row.split(",")]
            self.assertEqual(len(numbers), 8)
            np.testing.assert_allclose(numbers[: len(g)], g, rtol=1e-6)

    def test_rows_of_a_controller_are_those_of_its_design_without_the_1_of_p(self):
        found = as_json("kotyk-column", *LOOPS)
        for k, loop in enumerate(found["loops"]):
            for what, want in (("p", loop["p"][1:]), ("q", loop["q"]), ("r", loop["r"])):
                row = next(line.split()[2] for line in found["lines"] if line.startswith(f"set block{k + 2}.{what}.1 "))
                numbers = [float(x) for x in row.split(",")]
                self.assertEqual(len(numbers), 8)
                np.testing.assert_allclose(numbers, [*want, *[0.0] * (8 - len(want))], rtol=1e-6, atol=1e-12)

    def test_names_numbers_and_blocks_are_those_asked_for(self):
        lines = as_json("kotyk-column", "--first-block", "2", "--loop-names", "top,bottom", "--loop-numbers", "4,2", *LOOPS)["lines"]
        for line in ("set block2.loops top,bottom", "set block3.loops top", "set block4.loops bottom", "set loop4.divisor 2", "set loop2.divisor 2"):
            self.assertIn(line, lines)

    def test_without_a_base_tick_a_remark_says_what_loops_need(self):
        _, out, _ = decouple("kotyk-column", *LOOPS[:-2])
        self.assertIn("# the loops have to run every 120 s", out)
        self.assertNotIn("divisor ", out)

    def test_a_file_is_one_transaction(self):
        place = self.folder / "decoupler.conf"
        self.assertEqual(decouple("kotyk-column", *LOOPS, "--out", str(place))[0], 0)
        text = place.read_text().splitlines()
        self.assertEqual((text[0], text[-1]), ("begin", "apply"))
        self.assertTrue(all(line.startswith("set ") for line in text[1:-1]))


class Board(FolderTest):
    def test_every_design_is_taken_and_reads_back_as_printed(self):
        for method, loops in [(m, x) for m in METHODS for x in ((), LOOPS)]:
            with self.subTest(method=method, loops=loops), board(HOST) as console:
                status, out, err = decouple("kotyk-column", "--method", *method, *loops, "--to", console)
                self.assertEqual(status, 0, err)
                self.assertIn("in force from the next tick, not saved", out)
                kept = dict(line.split(None, 2)[1:] for line in told(console, "diff defaults"))
                for line in out.splitlines():
                    if line.startswith("set ") and line.split()[2] != "recurse":  # the default
                        _, name, value = line.split(None, 2)
                        if name in kept:
                            self.assert_same(kept[name], value, name)
                        else:
                            self.assertIn(value, ("0", "1", "0,0,0,0,0,0,0,0"), name)  # its default

    def assert_same(self, there, sent, name):
        try:
            np.testing.assert_allclose([float(x) for x in there.split(",")], [float(x) for x in sent.split(",")], rtol=1e-6, err_msg=name)
        except ValueError:
            self.assertEqual(there, sent, name)

    def test_the_bounds_of_the_tool_are_those_of_the_board(self):
        most = {"block1.g.1": decoupled_loops.ELEMENT_MOST, "block2.p.1": decoupled_loops.P_MOST, "block2.q.1": decoupled_loops.QR_MOST,
                "block2.r.1": decoupled_loops.QR_MOST, "decouple1.d2": decoupled_loops.ELEMENT_MOST}
        with board(HOST) as console:
            told(console, "begin")
            told(console, "set block1.kind polynomial")
            told(console, "set block2.kind rst")
            for name, bound in most.items():
                row = "" if name.startswith("decouple") else ",0" * (decoupled_loops.TAPS - 1)
                for sign in (1, -1):
                    told(console, f"set {name} {sign * bound:g}{row}")
                    for beyond in (f"{sign * bound * 1.0001:.9g}{row}", f"{sign * bound:g}{row},0"):
                        with self.subTest(name=name, value=beyond), self.assertRaises(session.Refused):
                            told(console, f"set {name} {beyond}")
            told(console, "abandon")

    def test_a_file_of_it_is_taken_by_the_console_tool(self):
        place = self.folder / "decoupler.conf"
        decouple("kotyk-column", *LOOPS, "--out", str(place))
        with board(HOST) as console:
            self.assertEqual(call("console", console, "--run", str(place))[0], 0)
            self.assertIn("block3 rst on  loops y2", "\n".join(told(console, "block 3")))

    def test_a_refusal_is_told_and_leaves_the_board_as_it_was(self):
        with board(HOST) as console:
            before = told(console, "diff defaults")
            for options, words in ((("--loop-names", "top,bottom"), "block1.loops: 'top' must be the name of a configured loop"),
                                   ((*LOOPS[:-1], "120"), "block2.period"), (("--first-block", "99"), "block99.kind")):
                status, _, err = decouple("kotyk-column", *options, "--to", console)
                self.assertEqual(status, 1)
                self.assertIn("nothing of it is in force", err)
                self.assertIn(words, err)
                self.assertEqual(err.count("\n"), 1, err)
                self.assertEqual(told(console, "diff defaults"), before)

    def test_the_engineer_level_needs_its_key(self):
        with board(HOST, key="pot_still") as console:
            status, _, err = decouple("kotyk-column", "--to", console)
            self.assertEqual(status, 1)
            self.assertIn("--key opens the engineer level", err)
            self.assertEqual(decouple("kotyk-column", "--to", console, "--key", "pot_still")[0], 0)

    def test_a_port_that_is_not_there_is_said(self):
        status, _, err = decouple("kotyk-column", "--to", str(self.folder / "none"))
        self.assertEqual(status, 2)
        self.assertIn("there is no", err)


class Refusals(FolderTest):
    def refused(self, of, words, *more):
        path = self.file("model.json", of if isinstance(of, str) else json.dumps(of))
        status, out, err = decouple(str(path), "--units", "eu", *more)
        self.assertIn(status, (1, 2), out)
        self.assertEqual(err.count("\n"), 1, err)
        self.assertTrue(err.startswith("tools/decouple: "), err)
        self.assertIn(words, err)

    def test_a_determinant_that_is_0_is_refused(self):
        same = model([[[0.2], [0.1]], [[0.4], [0.2]]])
        self.refused(same, "determinant")
        for method in METHODS[1:4]:
            if method[0] != "one-way":
                self.refused(same, "inverse", "--method", *method)

    def test_a_zero_outside_the_unit_circle_is_refused_and_told_unless_it_is_allowed(self):
        outside = model([[[0.1, 0.2], [0.02, 0.0]], [[0.02, 0.0], [0.2, 0.0]]])
        self.refused(outside, "zeros of det B -2.0")
        path = self.file("outside.json", json.dumps(outside))
        self.assertEqual(decouple(str(path), "--units", "eu", "--zero-hi", "3")[0], 0)

    def test_a_refusal_names_designs_that_there_are(self):
        """Each of them is then accepted."""
        for name, period, ways in (("lime-kiln", "60", ("--period 120", "--method static")), ("packed-bed", "60", ("--period 120", "--method partial --factor 0.5")),
                                   ("packed-bed", "180", ("--period 120", "--zero-hi 2.39", "--method partial --factor 0.5"))):
            status, _, err = decouple(name, "--period", period)
            self.assertEqual(status, 1)
            self.assertIn("; there is one with " + " or ".join(ways).replace("--zero-hi 2.39", "--zero-hi 2.39 (the zero stays in every loop)"), err)
            for way in ways:
                with self.subTest(name=name, period=period, way=way):
                    self.assertEqual(decouple(name, *([] if "--period" in way else ["--period", period]), *way.split())[0], 0)
        loops = ("--period", "60", "--loops", "pp", "--settling", "2400")
        self.assertIn("with --period 600 or", decouple("lime-kiln", *loops)[2])
        self.assertNotIn("--period 600", decouple("lime-kiln", *loops, "--tick", "90")[2])  # whole ticks alone
        self.assertIn("with --period 180 or", decouple("lime-kiln", *loops, "--observer", "0.5", "--tick", "90")[2])
        same = model([[[0.2], [0.1]], [[0.4], [0.2]]])
        self.refused(same, "; --method static and partial have none either, and identify again with another period; decouple fewer pairs (--pairs)\n")

    def test_a_refusal_of_controllers_names_a_method_that_has_some(self):
        path = str(self.file("two.json", json.dumps(TWO_LAGS)))
        loops = ("--loops", "pp", "--settling", "600")
        way = "--method partial --factor 0"
        for period, method in (("20", ()), ("40", ()), ("40", ("--method", "static")), ("60", ("--method", "one-way", "--rank", "y1,y2"))):
            with self.subTest(period=period, method=method):
                status, _, err = decouple(path, "--period", period, *method, *loops)
                self.assertEqual(status, 1)
                self.assertIn(f"; there are controllers with {way} (no decoupler)\n", err)
                done = as_json(path, "--period", period, *way.split(), *loops)
                self.assertLess(done["largest_pole"], 1)
        short = ("--period", "40", "--method", "static", "--loops", "pp", "--settling", "80")
        self.assertIn("another --settling or --period, or PIDs on the loops: --method static without --loops pp", decouple(path, *short)[2])
        self.assertEqual(decouple(path, *short[:4])[0], 0)

    def test_a_continuous_plant_without_a_period_is_refused_with_one_that_works(self):
        path = str(self.file("two.json", json.dumps(TWO_LAGS)))
        for name, period in ((path, "24"), ("wood-berry", "130")):
            self.assertIn(f"--period says how often it is sampled, s; try --period {period}\n", decouple(name, "--method", "static")[2])
            self.assertEqual(decouple(name, "--method", "static", "--period", period)[0], 0)

    def test_a_plant_that_is_not_square_is_refused(self):
        status, _, err = decouple("shell-fractionator")
        self.assertEqual(status, 2)
        self.assertIn("7 outputs and 3 inputs", err)
        wide = model([[[0.2], [0.1]]])
        self.refused(wide, "1 outputs and 2 inputs")

    def test_more_loops_or_coefficients_than_the_model_of_the_board_has_are_refused(self):
        self.refused(model([[[0.2], [0.1]], [[0.1], [0.2]]], a=((-0.5, 0.1, 0.1, 0.1, 0.1), (-0.7, 0, 0, 0, 0))), "order 5")
        self.refused(model([[[0] * 8 + [0.2], [0.1]], [[0.1], [0.2]]]), "B reaches to z^-9")
        five = {"period_s": 60, "inputs": [f"u{k}" for k in range(5)],
                "outputs": [{"name": f"y{i}", "A": [1, -0.5], "B": [[0, float(i == k)] for k in range(5)]} for i in range(5)]}
        self.refused(five, "5 loops, more than 4")

    def test_numbers_that_are_none_are_refused(self):
        good = json.dumps(model([[[0.2], [0.1]], [[0.1], [0.2]]]))
        for text, words in ((good.replace("-0.8", "NaN"), "finite number"), (good.replace("[0.0, 0.1]", "[0.0, Infinity]", 1), "finite number"),
                            (good.replace("60.0", "NaN"), "period"), (good.replace("60.0", "0"), "period"), (good.replace("60.0", "-60"), "period"),
                            (good.replace("60.0", '"often"'), "tools/identify"), (good.replace("-0.8", '"x"'), "tools/identify"),
                            (good.replace("[1.0, -0.8]", "[2.0, -0.8]"), "A has to begin with 1"), (good.replace("[0.0, 0.1]", "[0.3, 0.1]", 1), "B with 0")):
            with self.subTest(text):
                self.refused(text, words)

    def test_files_that_are_no_model_are_refused(self):
        for text, words in (("", "not JSON"), ("{", "not JSON"), ("[]", "is not a plant"), ("{}", "not linear"), ("null", "is not a plant"), ('{"period_s": 60}', "tools/identify"),
                            ('{"period_s": 60, "inputs": [], "outputs": []}', "needs one of each"), ('{"period_s": 60, "inputs": 3, "outputs": 4}', "tools/identify"),
                            ('{"period_s": 60, "inputs": ["u"], "outputs": [{"name": "y", "A": [], "B": []}]}', "tools/identify"),
                            ('{"model": "transfer"}', "linear-plants.md"), ('{"model": "polynomial", "name": "x", "outputs": [], "inputs": []}', "needs one of each")):
            with self.subTest(text):
                self.refused(text, words)
        for name, words in ((str(self.folder / "none.json"), "cannot be read"), (str(self.folder), "cannot be read"), ("nothing", "no plant of that name")):
            status, _, err = decouple(name)
            self.assertEqual(status, 2)
            self.assertIn(words, err)
        binary = self.folder / "binary.json"
        binary.write_bytes(b"\xff\xfe\x00")
        self.assertEqual(decouple(str(binary))[0], 2)

    def test_options_that_are_wrong_are_refused(self):
        for arguments, words in ((("--method", "partial"), "needs --factor"), (("--factor", "1"), "goes with"), (("--method", "partial", "--factor", "2"), "0 to 1"),
                                 (("--method", "partial", "--factor", "nan"), "number"), (("--method", "partial", "--factor", "1,1"), "one number or 4"),
                                 (("--method", "one-way", "--rank", "y1"), "once"), (("--method", "directions", "--condition", "0.5"), "1 to 1e4"),
                                 (("--method", "directions", "--condition", "nan"), "1 to 1e4"), (("--loops", "pp"), "--settling"),
                                 (("--settling", "60"), "goes with"), (("--loops", "pp", "--settling", "1,2,3"), "one for all"),
                                 (("--loops", "pp", "--settling", "x"), "number"), (("--loops", "pp", "--settling", "1e-3"), "settling"),
                                 (("--loops", "pp", "--settling", "-5"), "settling"), ((*LOOPS, "--overshoot", "0.9"), "overshoot"),
                                 ((*LOOPS, "--overshoot", "nan"), "overshoot"), ((*LOOPS, "--observer", "1"), "observer"), ((*LOOPS, "--condition-hi", "nan"), "condition"),
                                 (("--tick", "60"), "--tick"), ((*LOOPS[:-1], "nan"), "--tick"), ((*LOOPS[:-1], "7"), "whole ticks"), ((*LOOPS[:-1], "3600"), "whole ticks"),
                                 (("--zero-hi", "nan"), "zero_hi"), (("--determinant-lo", "-1"), "determinant_lo"), (("--element-hi", "inf"), "element_hi"),
                                 (("--period", "60"), "sampled already"), (("--period", "nan"), "period"), (("--pairs", "y1=u1,y1=u2"), ""), (("--pairs", "y1"), "OUTPUT=INPUT"),
                                 (("--first-block", "0"), "--first-block"), (("--loop-names", "a,a"), "2 different"), (("--loop-names", "a b,c"), "--loop-names"),
                                 (("--loop-numbers", "1,9"), "1 to 8"), (("--loop-numbers", "²,1"), "1 to 8"), (("--key", "x"), "--to"), (("--spans", "y1=1"), "no span"),
                                 (("--spans", "y1=x"), "NAME=SPAN"), (("--spans", "y1=nan,y2=1,u1=1,u2=1"), "no span"), (("--out", "/none/there"), "cannot be written")):
            with self.subTest(arguments):
                status, out, err = decouple("kotyk-column", *arguments)
                self.assertIn(status, (1, 2), out)
                self.assertIn(words, err)
                self.assertEqual(err.count("\n"), 1, err)

    def test_a_model_without_spans_has_no_lines_and_says_so(self):
        path = str(self.file("model.json", json.dumps(model([[[0.2], [0.1]], [[0.1], [0.2]]]))))
        self.assertIn("--spans", decouple(path)[2])
        self.assertIn("no lines for the board", decouple(path, "--units", "eu")[1])
        self.assertIn("set block1.g.1", decouple(path, "--spans", "kotyk-column")[1])

    def test_a_library_call_with_wrong_sizes_is_refused_before_it(self):
        for b in (np.zeros((2, 2)), np.zeros((3, 2, 1))):
            with self.assertRaises(ValueError):
                decoupling.polynomial(np.zeros((2, 1)), b, 60.0)
        for b in (np.ones((2, 3, 1)), np.ones((2, 1, 1))):
            with self.assertRaises(decoupling.Refused):
                decoupling.polynomial(np.zeros((2, 1)), b, 60.0)
        for wrong in (np.ones((2, 3)), np.ones(4)):
            with self.assertRaises(ValueError):
                decoupling.partial(wrong, 1.0)
        with self.assertRaises(decoupling.Refused):
            decoupling.one_way(np.eye(9), list(range(9)))
        for ranks in ([0, 0], [0, 2], [-1, 0]):
            with self.assertRaises(decoupling.Refused):
                decoupling.one_way(np.eye(2), ranks)


if __name__ == "__main__":
    libreflux.load(sys.argv.pop(1))
    HOST = sys.argv.pop(1)
    unittest.main()
