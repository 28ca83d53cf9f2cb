#!/usr/bin/python3
"""tools/ina and what libreflux.so gives it, against numpy; the numbers of Kotyk and Machacek's column.

usage: test_ina_tool.py LIBRARY REFLUX_HOST
"""
import io
import os
import sys
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "tools"), str(HERE.parent / "reference"), str(HERE.parents[1] / "tools")]

from linear_reference import Plant  # noqa: E402
from reflux import arrays, board_settings, cmd_ina, ina_plant, ina_window, libreflux  # noqa: E402
from reflux.errors import RunFailed, UserError  # noqa: E402
from reflux.paths import every  # noqa: E402
from support import FolderTest, board, call, told  # noqa: E402

THEIRS = np.array([[1.0, 0.33], [0.64, 1.2112]])
THEIR_OPERATIONS = ("--do", "add 2 1 -0.64", "--do", "add 1 2 -0.33")
HOST = ""
BLOCKS = HERE.parents[1] / "host_sim" / "plants"


def ina(*arguments):
    return call("ina", *arguments, "--no-build")


def kotyk():
    plant = ina_plant.read("kotyk-column", None)
    return plant, plant.response(plant.omega(400, None, None))


class Numbers(unittest.TestCase):
    def test_ratios_are_those_worked_out_from_the_source(self):
        _, f = kotyk()
        for g, rows, columns in ((np.eye(2), (0.609, 1.271), (0.861, 0.362)), (THEIRS, (0.197, 0.424), (0.238, 0.141))):
            found = arrays.array(f, g)
            np.testing.assert_allclose(found.worst("rows"), rows, atol=5e-4)
            np.testing.assert_allclose(found.worst("columns"), columns, atol=5e-4)

    def test_gains_at_rest_and_relative_gain_are_those_of_the_source(self):
        plant, _ = kotyk()
        gain = plant.response(np.array([0.0]))[0]
        np.testing.assert_allclose(gain, [[0.15553, -0.05629], [0.19767, -0.22961]], atol=5e-6)
        self.assertAlmostEqual(libreflux.rga(libreflux.Plant(gain.real))[0, 0], 1.4526, places=4)

    def test_the_search_is_more_dominant_than_the_source(self):
        _, f = kotyk()
        for by in arrays.BY:
            g, numbers = arrays.search(f, np.eye(2), by)
            self.assertAlmostEqual(numbers["after"], arrays.array(f, g).worst(by).max(), places=9)
            self.assertLess(numbers["after"], 0.7 * arrays.array(f, THEIRS).worst(by).max())

    def test_arrays_of_every_plant_are_those_of_numpy(self):
        seen = 0
        for path in every(BLOCKS, "*.json"):
            try:
                plant = ina_plant.read(path.stem, None)
                omega = plant.omega(20, None, None)
            except UserError:
                continue
            f, g = plant.response(omega), np.eye(plant.n) + 0.1
            np.testing.assert_allclose(arrays.array(f, g, inverse=False).values, f @ g, rtol=0, atol=1e-13 * np.abs(f).max())
            want = np.sort_complex(np.linalg.eigvals(f @ g))
            np.testing.assert_allclose(np.sort_complex(arrays.loci(f, g)), want, rtol=0, atol=1e-9 * np.abs(want).max())
            if np.linalg.cond(f @ g).max() < 1e9:
                inverse = np.linalg.inv(f @ g)
                size = np.abs(inverse).max(axis=(1, 2)) * np.linalg.cond(f @ g)
                self.assertLess((np.abs(arrays.array(f, g).values - inverse).max(axis=(1, 2)) / size).max(), 1e-13)
                seen += 1
        self.assertGreaterEqual(seen, 8)

    def test_responses_at_rest_are_the_gains_of_the_plants(self):
        for name in ("wood-berry", "luyben-4x4", "kotyk-column", "furnace", "paper-machine", "air-compressor", "folami-linear"):
            gains = Plant(BLOCKS / f"{name}.json").gains()
            f = ina_plant.read(name, None).response(np.array([0.0]))[0]
            np.testing.assert_allclose(f, gains[:, :len(f)], rtol=1e-9, atol=1e-12, err_msg=name)

    def test_aligned_columns_are_the_least_squares_ones(self):
        _, f = kotyk()
        for v in f[::40]:  # the phases that real least squares leave, found by trying them
            g = arrays.align(v)
            for j in range(2):
                angle = np.linspace(0, np.pi, 20001)
                stacked = np.vstack([v.real, v.imag])
                wanted = np.zeros((4, len(angle)))
                wanted[j], wanted[2 + j] = np.cos(angle), np.sin(angle)
                left = ((stacked @ np.linalg.pinv(stacked) @ wanted - wanted) ** 2).sum(axis=0).min()
                h = v @ g[:, j]
                unit = np.eye(2)[j] * np.exp(1j * np.angle(h[j]))
                self.assertLess((np.abs(h - unit) ** 2).sum(), left + 1e-9)


class Tool(FolderTest):
    def test_two_operations_give_the_compensator_of_the_source_to_the_board(self):
        status, out, _ = ina("kotyk-column", "--units", "eu", *THEIR_OPERATIONS)
        self.assertEqual(status, 0)
        self.assertIn("set loop1.decouple on\nset decouple1.d1 1\nset decouple1.d2 0.33\nset loop2.decouple on\nset decouple2.d1 0.64\n"
                      "set decouple2.d2 1.2112\n", out)
        self.assertIn("by rows dominant at every frequency: largest ratio 0.424", out)

    def test_undo_gives_the_last_bit_back(self):
        _, once, _ = ina("wood-berry", "--do", "add 1 2 0.1")
        _, again, _ = ina("wood-berry", "--do", "add 1 2 0.1", "--do", "swap 1 2", "--do", "scale 1 3", "--do", "undo", "--do", "undo")
        self.assertEqual(once.split("\n\n")[-2:], again.split("\n\n")[-2:])
        self.assertEqual(ina("wood-berry", "--do", "undo")[0], 2)

    def test_engineering_units_become_spans_on_the_board(self):
        j = (BLOCKS / "kotyk-column.json").read_text().replace('"name": "u2", "unit": "V", "lo": -5, "hi": 5', '"name": "u2", "unit": "V", "lo": -5, "hi": 15')
        path = self.file("other.json", j)
        _, out, _ = ina(str(path), "--units", "eu", *THEIR_OPERATIONS)  # 10 V and 20 V
        self.assertIn("set decouple1.d2 0.66\n", out)
        self.assertIn("set decouple2.d1 0.32\n", out)

    def test_the_best_rows_of_two_loops_do_not_depend_on_units(self):
        for units in ("spans", "eu"):  # one element off the diagonal: units change both rows' ratios alike
            self.assertIn("set decouple2.d1 0.7788", ina("kotyk-column", "--auto", "--units", units)[1])

    def test_pictures_are_drawn_for_each_operation_and_view(self):
        ina("kotyk-column", *THEIR_OPERATIONS, "--every", "--out", str(self.folder / "a.png"))
        for view in ("inverse", "direct", "loci"):
            self.assertEqual(ina("wood-berry", "--points", "50", "--view", view, "--out", str(self.folder / f"{view}.png"))[0], 0)
        for name in ("a-1", "a-2", "inverse", "direct", "loci"):
            self.assertEqual((self.folder / f"{name}.png").read_bytes()[:4], b"\x89PNG")

    def test_loops_may_have_other_numbers_and_pairs_another_order(self):
        status, out, _ = ina("shell-fractionator", "--pairs", "y7=u3,y4=u1", "--loops", "5,2", "--do", "set 1 2 3 4")
        self.assertEqual(status, 0)
        self.assertIn("y7 by u3, y4 by u1", out)
        self.assertIn("set loop5.decouple on\nset decouple5.d5 1\nset decouple5.d2 2\nset loop2.decouple on\nset decouple2.d5 3\n", out)

    def test_what_is_wrong_is_said(self):
        plain = '{"gain": 12.8, "lags": 16.7, "dead_time": 1}'
        cases = self.file("cases.json", (BLOCKS / "wood-berry.json").read_text().replace(plain, '{"cases": [' + plain + "]}"))
        for arguments, words in ((("shell-fractionator",), "7 outputs and 3 inputs"), (("pilot",), "not linear"), (("nothing",), "no plant of that name"),
                                 (("wood-berry", "--do", "add 1 1 2"), ""), (("wood-berry", "--do", "add 1 3 2"), "must be a row, 1 to 2"),
                                 (("wood-berry", "--do", "add 1 2 x"), "not a number"), (("wood-berry", "--do", "turn"), "is not an operation"),
                                 (("wood-berry", "--pairs", "xD=xB"), "OUTPUT=INPUT"), (("wood-berry", "--loops", "1,1"), "different numbers"),
                                 (("wood-berry", "--points", "1"), "--points"), (("wood-berry", "--low", "2", "--high", "1"), "frequencies"),
                                 (("wood-berry", "--low", "nan"), "frequencies"), (("wood-berry", "--high", "inf"), "frequencies"), (("wood-berry", "--loops", "²,1"), "different numbers"),
                                 (("wood-berry", "--do", "write"), "--to PORT"), (("wood-berry", "--key", "x"), "--to"),
                                 (("kotyk-column", "--do", "align 1"), "half its rate"), ((str(cases),), "cases"),
                                 (("paper-machine",), "frequency 1 of 400")):
            with self.subTest(arguments):
                status, _, err = ina(*arguments)
                self.assertIn(status, (1, 2))
                self.assertIn(words, err)


class Board(FolderTest):
    def decoupler(self, console):
        return [line for line in told(console, "diff defaults") if "decouple" in line]

    def test_the_last_g_is_written_and_read_back(self):
        with board(HOST) as console:
            status, out, err = ina("kotyk-column", "--units", "eu", *THEIR_OPERATIONS, "--to", console)
            self.assertEqual(status, 0, err)
            self.assertIn("6 settings taken and read back", out)
            self.assertEqual(self.decoupler(console), ["set loop1.decouple on", "set loop2.decouple on", "set decouple1.d2 0.33", "set decouple2.d1 0.64", "set decouple2.d2 1.2112"])

    def test_at_the_prompt_only_what_is_asked_for_is_written(self):
        for typed, want in (("set 1 0.5 0.25 1\n", []), ("set 1 0.5 0.25 1\nwrite\nscale 1 2\n", ["0.5", "0.25"])):
            with board(HOST) as console, mock.patch("sys.stdin", io.StringIO(typed)):
                self.assertEqual(ina("kotyk-column", "--prompt", "--to", console)[0], 0)
                self.assertEqual([line.split()[2] for line in self.decoupler(console) if ".d" in line and "loop" not in line], want)

    def test_an_operation_writes_too_and_then_nothing_more_is_written_at_the_end(self):
        with board(HOST) as console:
            _, out, _ = ina("kotyk-column", "--do", "set 1 0.5 0.25 1", "--do", "write", "--to", console)
            self.assertEqual(out.count("settings taken"), 1)

    def test_a_refusal_is_told_and_leaves_the_board_as_it_was(self):
        with board(HOST) as console:  # a loop alone would have a gain of a thousandth
            before = told(console, "diff defaults")
            status, _, err = ina("kotyk-column", "--do", "set 0.001 1 1 0.001", "--to", console)
            self.assertEqual(status, 1)
            self.assertIn("the board refuses `apply`, and nothing of it is in force: err SINGULAR", err)
            self.assertEqual(err.count("\n"), 1)
            self.assertEqual(told(console, "diff defaults"), before)

    def test_somebody_elses_transaction_is_left_alone(self):
        with board(HOST) as console:
            told(console, "begin")
            told(console, "set loop1.gain 7")
            status, _, err = ina("kotyk-column", "--auto", "--to", console)
            self.assertEqual(status, 1)
            self.assertIn("the board refuses `begin`", err)
            told(console, "apply")
            self.assertIn("set loop1.gain 7", told(console, "diff defaults"))
            self.assertEqual(self.decoupler(console), [])

    def test_the_engineer_level_needs_its_key(self):
        with board(HOST, key="pot_still") as console:
            self.assertIn("--key opens the engineer level", ina("kotyk-column", "--to", console)[2])
            self.assertEqual(ina("kotyk-column", "--to", console, "--key", "pot_still")[0], 0)
        with board(HOST, key="pot_still") as console:
            status, _, err = ina("kotyk-column", "--to", console, "--key", "pan")
            self.assertEqual(status, 1)
            self.assertIn("does not take the key, and nothing is sent", err)

    def test_a_port_that_is_not_there_is_said(self):
        status, _, err = ina("kotyk-column", "--to", str(self.folder / "none"))
        self.assertEqual(status, 2)
        self.assertIn("there is no", err)

    def test_what_is_read_back_counts_but_for_rounding(self):
        for sent, there, want in (("0.33", "0.33 -", True), ("0.33", "0.3300001 -", True), ("0.33", "0.34 -", False), ("on", "on", True), ("on", "off", False),
                                  ("1,0,0", "1,0,0 -", True), ("1,0,0", "1,0 -", False), ("1", "", False), ("0", "0 s", True)):
            self.assertEqual(board_settings.same(sent, there), want, (sent, there))

        class Other:
            def ask(self, _):
                return ["decouple1.d2 = 0.5"]
        with self.assertRaisesRegex(RunFailed, "decouple1.d2 is 0.5, and 0.33 was sent"):
            board_settings.compare(Other(), ["set decouple1.d2 0.33"])


class Live(FolderTest):
    def test_without_a_display_it_is_an_error_of_one_line(self):
        with mock.patch.dict(os.environ):
            for name in ("DISPLAY", "WAYLAND_DISPLAY"):
                os.environ.pop(name, None)
            status, _, err = ina("kotyk-column", "--window")
        self.assertEqual(status, 2)
        self.assertIn("--window: there is no display", err)
        self.assertEqual(err.count("\n"), 1)

    def test_a_display_that_does_not_answer_or_a_drawing_without_windows_is_one_too(self):
        for changes in ({"DISPLAY": ":4711"}, {"DISPLAY": ":4711", "MPLBACKEND": "agg"}, {"DISPLAY": ":4711", "MPLBACKEND": "nonsense"}):
            with mock.patch.dict(os.environ, changes):
                os.environ.pop("WAYLAND_DISPLAY", None)
                status, _, err = ina("kotyk-column", "--window")
            self.assertEqual(status, 2)
            self.assertIn("matplotlib has no window here", err)
            self.assertEqual(err.count("\n"), 1)

    def test_it_is_drawn_anew_after_each_operation_and_is_the_picture(self):
        seen = []

        class Noted(ina_window.Window):
            def draw(self, fill):
                super().draw(fill)
                seen.append((self.figure._suptitle.get_text(), bytes(self.figure.canvas.buffer_rgba())))

        with mock.patch.object(cmd_ina.ina_window, "window", lambda size: Noted(size, "agg", windows=False)):
            status, _, err = ina("kotyk-column", "--window", *THEIR_OPERATIONS, "--do", "undo")
        self.assertEqual(status, 0, err)
        self.assertEqual([title.partition("plane; ")[2] for title, _ in seen], ["G = 1", "add 2 1 -0.64", "add 2 1 -0.64, add 1 2 -0.33", "add 2 1 -0.64"])
        self.assertEqual(seen[1], seen[3])
        self.assertEqual(len({picture for _, picture in seen}), 3)

    def test_closed_by_its_frame_it_is_left_closed_and_work_goes_on(self):
        window = ina_window.Window((4, 4), "agg", windows=False)
        window.plt.close(window.figure)
        window.draw(lambda figure: self.fail("drawn"))
        window.wait()
        window.close()

    def test_lines_are_taken_while_the_window_is_alive_pasted_ones_too(self):
        reader, writer = os.pipe()
        pumped = []

        class Pumped:
            def pump(self):
                pumped.append(1)
                if len(pumped) == 2:
                    os.write(writer, b"add 1 2 3\nun")
                if len(pumped) == 4:
                    os.write(writer, b"do\nend")
                    os.close(writer)
        with os.fdopen(reader) as stdin, mock.patch("sys.stdin", stdin):
            lines = ina_window.Lines(Pumped())
            self.assertEqual([lines.read() for _ in range(4)], ["add 1 2 3\n", "undo\n", "end", ""])


if __name__ == "__main__":
    libreflux.load(sys.argv.pop(1))
    HOST = sys.argv.pop(1)
    unittest.main()
