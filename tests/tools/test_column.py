"""tools/column: numbers on matrices whose answers are known exactly, what it reads of a file, its refusals, a whole run."""

import json
import math
import os
import unittest
from unittest import mock

import numpy as np
from support import FolderTest, call

from reflux_tools import column_file, linear_analysis as linear
from reflux_tools.errors import UserError

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

    def test_what_is_no_column_is_said_in_one_line(self) -> None:
        for text, words in (("{", "not JSON"), ("[]", "is no plant"), ('{"plant": 1}', "is no column"),
                            ('{"column": 1, "name": "x", "stages": {}}', "is no sound column")):
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
        self.assertIn("condition number", out)

    def test_what_cannot_be_is_said_in_one_line(self) -> None:
        picture = str(self.folder / "x.png")
        for arguments, words in ((("pilot", "--outputs", "T99"), "--outputs T99: pilot has no such output; there is T1 "),
                                 (("pilot", "--inputs", "T1"), "--inputs T1: pilot has no such input; there is Lr "),
                                 (("pilot", "--set", "Lr=99"), "Lr = 99 l/h is outside 0 to 12"),
                                 (("wood-berry",), "is no column")):
            status, _, err = call("column", *arguments, "--out", picture)
            self.assertEqual((status, err.count("\n")), (2, 1), err)
            self.assertIn(words, err)


if __name__ == "__main__":
    unittest.main()
