"""tools/calibrate: what makes the true values of the readings."""

import contextlib
import io
import unittest

import support  # noqa: F401  (finds the tools)

from reflux import cmd_calibrate
from reflux.errors import UserError


def printed(*arguments):
    with contextlib.redirect_stdout(io.StringIO()) as out:
        cmd_calibrate.main(["meas2", *arguments])
    lines = out.getvalue().splitlines()
    assert (lines[0], lines[-1]) == ("begin", "apply")
    return {line.split()[1].removeprefix("meas2."): float(line.split()[2]) for line in lines[1:-1]}


class Calibrate(unittest.TestCase):
    def test_two_points_give_gain_and_zero_and_both_readings_come_true(self):
        c = printed("0.4=0", "98.9=100")
        self.assertAlmostEqual(c["zero"] + c["gain"] * 0.4, 0.0, places=5)
        self.assertAlmostEqual(c["zero"] + c["gain"] * 98.9, 100.0, places=4)

    def test_one_point_moves_the_zero_alone(self):
        self.assertEqual(printed("20.5=20"), {"gain": 1.0, "zero": -0.5})

    def test_what_is_calibrated_already_is_corrected_further(self):
        before = ["--gain", "2", "--zero", "3"]
        c = printed("10=11", "20=22", *before)
        for sent in (3.5, 8.5):  # which the board shows as 10 and 20
            self.assertAlmostEqual(c["zero"] + c["gain"] * sent, 1.1 * (3 + 2 * sent), places=5)

    def test_points_that_make_no_calibration_are_refused_in_words(self):
        for points, because in [
            (["5"], "a point is READING=TRUE"),
            (["1=a"], "a point is READING=TRUE"),
            (["nan=1"], "finite"),
            (["5=1", "5=2"], "the same reading"),
            (["5=1", "6=0"], "swapped point"),
            (["1=1", "2=2", "3=3"], "one or two points"),
            (["1=0", "1.0000001=100"], "gain"),
        ]:
            with self.assertRaisesRegex(UserError, because):
                cmd_calibrate.main(["meas2", *points])

    def test_a_channels_name_is_no_measurement_of_the_board(self):
        with self.assertRaisesRegex(UserError, "meas1"):
            cmd_calibrate.main(["T10", "1=2"])


if __name__ == "__main__":
    unittest.main()
