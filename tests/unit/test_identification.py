"""Identification by the library for the host tools, and tools/identify on a log, on the column of Kotyk and Machacek (1995).

    python3 test_identification.py build/host/libreflux.so
"""

import contextlib
import io
import json
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tools" / "figures"), str(ROOT / "tests" / "tools")]

import arx_bias  # noqa: E402
from reflux import cmd_identify, identification, libreflux  # noqa: E402
from reflux.errors import UserError  # noqa: E402
from support import FolderTest, call  # noqa: E402

A = [[-0.80338, 0.02616], [-1.06726, 0.14709]]
B = [[[0.03851, -0.00386], [-0.01062, -0.00192]], [[0.01262, 0.00316], [-0.01990, 0.00157]]]
TWO = identification.Orders(2, ((1, 2), (1, 2)))


def record(samples=1000, noise=0.0, level=0.0):
    u = identification.prbs(2, samples, 1.0, bits=9)[0]
    y = np.zeros((samples, 2))
    for k in range(samples):
        for i in range(2):
            y[k, i] = sum(-A[i][m] * y[k - 1 - m, i] + sum(B[i][j][m] * u[k - 1 - m, j] for j in range(2)) for m in range(2) if k > m)
    return identification.Record(u, y + level + noise * np.random.default_rng(2).standard_normal(y.shape))


class Identification(unittest.TestCase):
    def test_the_model_of_the_paper_comes_back_from_both_inputs_at_once(self):
        for method in identification.METHODS[:2]:
            for i in range(2):
                found = identification.fit(record(), i, TWO, method)
                np.testing.assert_allclose(found.a(), A[i], atol=1e-11)
                np.testing.assert_allclose(found.b(), B[i], atol=1e-11)

    def test_its_orders_are_found(self):
        for criterion in identification.CRITERIA:
            for i in range(2):
                self.assertEqual(identification.select(record(), i, 4, 4, criterion=criterion).best.orders, TWO)

    def test_a_simulation_is_the_output(self):
        of = record(300)
        np.testing.assert_allclose(identification.simulate(of, 1, identification.fit(of, 1, TWO)), of.y[:, 1], atol=1e-9)

    def test_a_simulation_begins_at_the_level_of_a_constant(self):
        of = record(300, level=0.5)
        orders = identification.Orders(2, TWO.lags, 0, True)
        np.testing.assert_allclose(identification.simulate(of, 0, identification.fit(of, 0, orders)), of.y[:, 0], atol=1e-9)

    def test_a_refusal_has_the_words_of_the_firmware(self):
        with self.assertRaisesRegex(libreflux.Refused, "na: 0 to 4"):
            identification.fit(record(100), 0, identification.Orders(5, TWO.lags))
        with self.assertRaisesRegex(libreflux.Refused, "bits: 3 to 15"):
            identification.prbs(2, 10, 1.0, bits=20)

    def test_of_decimated_samples_one_in_so_many_is_kept(self):
        kept = identification.decimate(np.full(21, 3.0), 5, 0.5)
        np.testing.assert_allclose(kept, [3.0] * 5)


class Bias(unittest.TestCase):
    """The numbers of tools/figures/arx_bias.py, the first twenty of its seeds."""

    @classmethod
    def setUpClass(cls):
        cls.found = {}
        u = identification.prbs(2, 4088, 1.0, bits=9)[0]
        y = arx_bias.outputs(u)
        for method in ("ls", "iv"):
            cls.found[method] = arx_bias.errors(method, u, y, 0.01, 20)

    def test_least_squares_are_off_by_many_of_their_standard_deviations_and_instruments_are_not(self):
        for method, least, most in (("ls", 10.0, np.inf), ("iv", 0.0, 4.0)):
            of_a = self.found[method].of_a
            self.assertEqual(len(of_a), 20)
            off = abs(of_a.mean()) / (of_a.std(ddof=1) / np.sqrt(len(of_a)))
            self.assertTrue(least <= off <= most, f"{method}: {off:.1f} standard errors")

    def test_the_bias_is_that_of_the_normal_equations(self):
        """Limit of least squares: the moments of the record without noise, noise added to the diagonal of A."""
        u = identification.prbs(2, 4088, 1.0, bits=9)[0]
        y = arx_bias.outputs(u)[:, 1]
        k = np.arange(2, len(y))
        rows = np.column_stack([-y[k - 1], -y[k - 2], u[k - 1, 0], u[k - 2, 0], u[k - 1, 1], u[k - 2, 1]])
        moments = rows.T @ rows / len(k) + np.diag([0.01**2, 0.01**2, 0, 0, 0, 0])
        tends_to = np.linalg.solve(moments, rows.T @ y[k] / len(k))[0] - arx_bias.A[1, 0]
        of_a = self.found["ls"].of_a
        self.assertAlmostEqual(of_a.mean(), tends_to, delta=4 * of_a.std(ddof=1) / np.sqrt(len(of_a)))

    def test_a_row_of_refusals_alone_has_no_numbers(self):
        self.assertEqual(arx_bias.Errors(np.array([]), np.array([]), 5).cells(), ["all refused", "-"])


class Tool(unittest.TestCase):
    def run_on(self, of, *more, header="time[s],u1[V],u2[V],y1[V],y2.meas[V]"):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "table.csv"
            rows = [",".join(map(repr, map(float, (120 * k, *of.u[k], *of.y[k])))) for k in range(of.samples)]
            path.write_text("\n".join([header, *rows]) + "\n")
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                cmd_identify.main([str(path), "--inputs", "u1,u2", "--outputs", "y1,y2", *more])
            return out.getvalue()

    def test_the_model_of_a_log_is_the_plants(self):
        found = json.loads(self.run_on(record(level=2.0), "--format", "json", "--method", "ls"))
        self.assertEqual(found["period_s"], 120.0)
        for i, output in enumerate(found["outputs"]):
            np.testing.assert_allclose(output["A"], [1.0, *A[i]], atol=1e-8)
            np.testing.assert_allclose(output["B"], [[0.0, *row] for row in B[i]], atol=1e-8)
            self.assertGreater(output["validation"]["fit"], 0.999)

    def test_under_noise_the_gains_are_within_a_tenth(self):
        found = json.loads(self.run_on(record(1500, 0.01), "--format", "json"))
        exact = np.array(B).sum(axis=2) / (1 + np.array(A).sum(axis=1))[:, None]
        np.testing.assert_allclose([output["gains"] for output in found["outputs"]], exact, atol=0.1 * np.abs(exact).max())

    def test_what_is_printed_names_orders_and_coefficients(self):
        text = self.run_on(record(600, 0.01))
        for word in ("y1: na", "BIC validation", "A1 = 1 -", "B22 = -", "gains at rest", "identify.png"):
            self.assertIn(word, text)

    def test_an_input_as_applied_is_one_row_late(self):
        of = record(600)
        late = identification.Record(np.vstack([of.u[:1], of.u[:-1]]), of.y)
        found = json.loads(self.run_on(late, "--format", "json", "--orders", "2,2", "--method", "ls", "--no-constant",
                                       header="time[s],u1.applied[V],u2.applied[V],y1[V],y2[V]"))
        np.testing.assert_allclose(found["outputs"][0]["B"], [[0.0, *row] for row in B[0]], atol=1e-3)

    def test_a_row_without_a_number_is_named(self):
        of = record(100)
        of.y[41, 1] = np.nan
        with self.assertRaisesRegex(UserError, "row 42"):
            self.run_on(of)

    def test_rows_that_are_not_evenly_spaced_are_refused_unless_a_period_is_told(self):
        with self.assertRaisesRegex(UserError, "no column time"):
            self.run_on(record(200), header="clock,u1,u2,y1,y2")
        self.run_on(record(200), "--period", "120", header="clock,u1,u2,y1,y2")


HEADER = "time[s],u1[V],u2[V],y1[V],y2[V]"


class OddLogs(FolderTest):
    """A plain error, or the right model."""

    @classmethod
    def setUpClass(cls):
        cls.recorded = record(300, 0.01)

    def rows(self, change=None):
        rows = [[120.0 * k, *map(float, self.recorded.u[k]), *map(float, self.recorded.y[k])] for k in range(self.recorded.samples)]
        return (change(rows) or rows) if change else rows

    def cell(self, row, column, value):
        return self.rows(lambda rows: rows[row].__setitem__(column, value))

    def column(self, place, value):
        return [[*row[:place], value(k, row), *row[place + 1 :]] for k, row in enumerate(self.rows())]

    def text(self, rows, header=HEADER):
        return "\n".join([header, *(",".join(map(str, row)) for row in rows)]) + "\n"

    def identify(self, content, *more):
        path = self.folder / "log.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        more = more if "--outputs" in more else (*more, "--outputs", "y1,y2")
        return call("identify", str(path), "--inputs", "u1,u2", *more)

    def refused(self, content, words, *more):
        status, out, err = self.identify(content, *more)
        self.assertIn(status, (1, 2), out)
        self.assertIn(words, err)
        self.assertEqual(err.count("\n"), 1, err)

    def model(self, content, *more):
        status, out, err = self.identify(content, "--format", "json", *more)
        self.assertEqual(status, 0, err)
        found = json.loads(out)
        return found["period_s"], [y["A"] + y["B"] for y in found["outputs"]]

    def test_the_same_table_written_otherwise_is_the_same_model(self):
        plain = self.text(self.rows())
        want = self.model(plain)
        numbered = self.text([[k, *row] for k, row in enumerate(self.rows())], "number," + HEADER)
        for other in (plain.replace("\n", "\r\n"), "\ufeff" + plain, plain.rstrip("\n"), "# a remark\n" + plain, plain.replace(",", " , "), numbered,
                      "\ufeff" + numbered, ",".join(f'"{c}"' for c in HEADER.split(",")) + plain[len(HEADER) :],
                      self.text(self.column(0, lambda k, row: 2.0 * k), HEADER.replace("[s]", "[min]"))):
            with self.subTest(other[:60]):
                self.assertEqual(self.model(other), want)

    def test_times_that_are_rounded_are_even(self):
        for at, want in ((lambda k, row: np.float32(0.1 * k), 0.1), (lambda k, row: 1.7e9 + 0.1 * k, 0.1)):
            self.assertAlmostEqual(self.model(self.text(self.column(0, at)))[0], want, places=6)

    def test_rows_at_wrong_times_are_refused_with_their_number(self):
        rows = self.rows()
        for odd, words in ((self.cell(100, 0, 0.0), "row 101"), (self.cell(100, 0, rows[99][0]), "row 101 is 0 s"), (rows[:100] + rows[110:], "row 101 is 1320 s"),
                           (rows[:100] + rows[99:], "row 101 is 0 s"), (rows[::-1], "goes back"), (self.column(0, lambda k, row: 7.0), "stands still"),
                           (self.cell(100, 0, "noon"), "row 101 has no time"), (self.cell(100, 0, "nan"), "row 101 has no time")):
            with self.subTest(words):
                self.refused(self.text(odd), words)
        self.refused(self.text(rows[:100] + rows[110:]), "row 101", "--period", "120")  # a lost row is lost whatever is told

    def test_a_period_that_the_times_contradict_is_refused(self):
        self.refused(self.text(self.rows()), "the period is 60 s", "--period", "60")
        self.refused(self.text(self.rows(), HEADER.replace("[s]", "[ticks]")), "column time in ticks")
        self.assertEqual(self.model(self.text(self.rows(), HEADER.replace("[s]", "[ticks]")), "--period", "60")[0], 60)
        for wrong in ("0", "-1", "nan", "inf"):
            self.refused(self.text(self.rows()), "--period", "--period", wrong)

    def test_cells_without_a_number_are_refused_with_row_and_column(self):
        for value in ("nan", "", "hot", "inf", "-"):
            self.refused(self.text(self.cell(41, 3, value)), "row 42 has no number for y1")
        self.refused(self.text(self.cell(41, 1, 1e300)), "outside its allowed range")

    def test_tables_of_another_form_are_refused(self):
        plain = self.text(self.rows())
        for content, words in (("", "empty"), ("\n\n", "empty"), ("# only a remark\n", "empty"), (HEADER, "0 samples"), (self.text(self.rows()[:1]), "samples"),
                               (self.text(self.rows()[:12]), "12 samples"), (plain + "1,2\n", "row 301 has 2 cells"), (plain.replace(".", ","), "cells"),
                               (plain.replace(",", ";"), "commas"), (plain.replace(",", "\t"), "commas"), (self.text(self.rows(), HEADER.replace("u2", "u3")), "no column u2"),
                               (self.text(self.rows(), HEADER.replace("y2", "y1")), "two columns y1"), (b"\xff\xfet\x00", "is UTF-16 text")):
            with self.subTest(words):
                self.refused(content, words)
        status, _, err = call("identify", str(self.folder / "none"), "--inputs", "u1,u2", "--outputs", "y1,y2")
        self.assertEqual((status, err.count("\n")), (2, 1))

    def test_columns_that_say_nothing_are_refused(self):
        for place, name in ((1, "u1"), (2, "u2"), (3, "y1"), (4, "y2")):
            self.refused(self.text(self.column(place, lambda k, row: 1.5)), f"{name} never moves")
        same = self.text(self.column(2, lambda k, row: row[1]))
        for more in ((), ("--orders", "2,2")):
            self.refused(same, "inputs that do not move on their own", *more)

    def test_options_that_are_wrong_are_refused(self):
        plain = self.text(self.rows())
        for more, words in ((("--outputs", "y1,y1"), "twice"), (("--outputs", "u1"), "twice"), (("--na", "5"), "--na"), (("--na", "-1"), "--na"), (("--nb", "0"), "--nb"),
                            (("--nb", "9"), "--nb"), (("--orders", "0,0"), "--orders"), (("--orders", "5,1"), "--orders"), (("--every", "0"), "--every"),
                            (("--every", "1000"), "samples"), (("--every", "2", "--cutoff", "nan"), "--cutoff"), (("--cutoff", "1"), "--cutoff"),
                            (("--validation", "nan"), "--validation"), (("--nc", "1"), "--nc"), (("--nc", "9", "--method", "els"), "--nc"), (("-o", "/none/x.png"), "cannot be written")):
            with self.subTest(more):
                self.refused(plain, words, *more)
        self.assertEqual(self.identify(plain, "--orders", "²,1")[0], 2)

    def test_an_input_that_moves_within_a_control_interval_is_told(self):
        self.assertIn("note: u1, u2 move within control intervals of 2 rows", self.identify(self.text(self.rows()), "--every", "2")[1])
        held = [[row[0], *self.recorded.u[k // 2 * 2], *row[3:]] for k, row in enumerate(self.rows())]
        self.assertNotIn("note: u1", self.identify(self.text(held), "--every", "2", "--orders", "1,2")[1])


if __name__ == "__main__":
    libreflux.load(sys.argv.pop(1))
    unittest.main(verbosity=2)
