#!/usr/bin/python3
"""The model of an experiment as a board lists it (tools/reflux/board_model.py)."""

import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import board_model  # noqa: E402
from reflux.errors import UserError  # noqa: E402

LISTED = """\
block1.kind = polynomial
block2.kind = experiment
block2.inputs = y1,y2,u1,u2
block2.period = 120 s
block2.known = on
block2.a1_1 = -0.75 -
block2.a2_1 = -0.5 -
block2.b11_1 = 0.1 -
block2.b12_2 = -0.025 -
block2.b21_5 = 0.25 -
block2.b22_1 = 1e-1 -
"""


class BoardModel(unittest.TestCase):
    def read(self, text: str, period: float | None = None):
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            path = Path(folder) / "list.txt"
            path.write_text(text, encoding="utf-8")
            return board_model.read(path, period)

    def test_a_listing_is_read(self) -> None:
        outputs, inputs, a, b, period, filtered = self.read(LISTED)
        self.assertEqual((outputs, inputs, period, filtered), (["y1", "y2"], ["u1", "u2"], 120, ""))
        self.assertEqual((a[0, 0], a[1, 0], b[0, 0, 0], b[0, 1, 1], b[1, 0, 4], b[1, 1, 0]), (-0.75, -0.5, 0.1, -0.025, 0.25, 0.1))

    def test_lines_that_set_it_are_read_and_the_last_one_holds(self) -> None:
        text = LISTED.replace(" = ", " ").replace("block", "set block") + "69000.000 < block2.a1_1 = -0.8 -\n"
        self.assertEqual(self.read(text)[2][0, 0], -0.8)

    def test_without_a_period_of_its_own_it_is_the_base_tick_or_told(self) -> None:
        text = LISTED.replace("period = 120", "period = 0")
        self.assertEqual(self.read("tick.base = 30 s\n" + text)[4], 30)
        self.assertEqual(self.read(text, 15)[4], 15)
        with self.assertRaisesRegex(UserError, "--period"):
            self.read(text)

    def test_a_filter_of_faster_samples_is_told(self) -> None:
        text = LISTED + "block2.cutoff = 0.5 -\n"
        self.assertEqual(self.read("tick.base = 60 s\n" + text)[5], "block2.cutoff 0.5")
        self.assertEqual(self.read("tick.base = 120 s\n" + text)[5], "")

    def test_what_has_no_model_is_refused_with_what_would_have_one(self) -> None:
        for text in ("", "block1.kind = pid\n", "\n".join(LISTED.splitlines()[:4]).replace("known = on", ""), LISTED.replace("experiment", "gmv"), LISTED.replace("known = on", "known = off")):
            with self.subTest(text), self.assertRaisesRegex(UserError, "list block1"):
                self.read(text)

    def test_what_is_no_number_is_refused_by_its_name(self) -> None:
        for word in ("nan", "inf", "x"):
            with self.subTest(word), self.assertRaisesRegex(UserError, "a1_1"):
                self.read(LISTED.replace("-0.75", word))

    def test_a_file_that_is_not_there_is_told(self) -> None:
        with self.assertRaisesRegex(UserError, "cannot be read"):
            board_model.read(Path("nowhere.txt"), None)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
