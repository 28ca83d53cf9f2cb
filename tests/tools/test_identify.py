"""tools/identify on the logs that people have: when it must say that its model should not be used, and with which option another one can be
had; columns of times as loggers and spreadsheets call them. Rebuilt from public reports, with plants and numbers of our own."""

import datetime
import json
import unittest
from collections.abc import Callable

import numpy as np
from support import FolderTest, call

ROWS, PERIOD = 1200, 5.0


def steps(rows: int = ROWS, hold: int = 80) -> np.ndarray:
    """Between two levels, at random every so many rows."""
    return np.random.default_rng(3).integers(0, 2, -(-rows // hold)).repeat(hold)[:rows] * 20.0 + 20.0


def first_order(u: np.ndarray, gain: float = 0.8, rows: float = 20.0, dead: int = 1, noise: float = 0.1) -> np.ndarray:
    y, a = np.zeros(len(u)), np.exp(-1 / rows)
    y[0] = gain * u[0]
    for k in range(1, len(u)):
        y[k] = a * y[k - 1] + gain * (1 - a) * u[max(k - dead, 0)]
    return y + noise * np.random.default_rng(4).standard_normal(len(u))


class Logs(FolderTest):
    def log(self, columns: dict[str, np.ndarray | list], header: bool = True) -> str:
        lines = [",".join(columns)] * header + [",".join(map(str, row)) for row in zip(*columns.values())]
        return str(self.file("log.csv", "\n".join(lines) + "\n"))

    def identify(self, path: str, *more: str) -> tuple[int, dict, str]:
        inputs = () if "--inputs" in more else ("--inputs", "u", "--outputs", "y")
        status, out, err = call("identify", path, *inputs, *more, "--format", "json")
        return status, json.loads(out) if out else {}, err

    def timed(self, u: np.ndarray, y: np.ndarray) -> str:
        return self.log({"time": PERIOD * np.arange(len(u)), "u": u, "y": y})


class Verdicts(Logs):
    def helped(self, path: str, words: str, option: str, gain: float, *more: str) -> None:
        """Refused without the option that the words name, and right with it."""
        status, found, err = self.identify(path, *more)
        self.assertEqual((status, err.count("\n")), (1, 1), err)
        self.assertRegex(err, words)
        self.assertIn(option, err)
        self.assertIn(found["outputs"][0]["doubt"], err)
        status, found, err = self.identify(path, *option.split(), *more)
        self.assertEqual((status, err), (0, ""))
        self.assertAlmostEqual(found["outputs"][0]["gains"][0], gain, delta=0.1 * gain)

    def test_a_drift_is_named_with_its_option(self) -> None:
        u = steps()
        self.helped(self.timed(u, first_order(u) + 0.02 * np.arange(ROWS)), "y: probably a drift", "--drift", 0.8)

    def test_readings_that_stand_apart_are_named_with_their_option(self) -> None:
        u = steps()
        y = first_order(u)
        y[[86, 117, 492, 513, 629, 720, 841, 914]] = 85.0
        self.helped(self.timed(u, y), "y: probably 8 readings that stand apart", "--despike", 0.8)

    def test_a_dead_time_beyond_the_powers_tried_is_named_with_its_option(self) -> None:
        u = steps(hold=60)
        status, _, err = self.identify(self.timed(u, first_order(u, rows=60.0, dead=30)))
        self.assertEqual(status, 1)
        self.assertRegex(err, r"y: probably a dead time of some (20|25|30) rows .*: use --every (20|25|30)")
        status, found, err = self.identify(self.timed(u, first_order(u, rows=60.0, dead=30)), "--every", "30")
        self.assertEqual((status, err), (0, ""))
        self.assertAlmostEqual(found["outputs"][0]["gains"][0], 0.8, delta=0.08)

    def test_an_integrator_is_named_and_its_rate_found_with_the_option(self) -> None:
        u = steps() - 30.0
        y = 50.0 + np.concatenate([[0.0], np.cumsum(0.001 * PERIOD * u[:-1])]) + 0.02 * np.random.default_rng(5).standard_normal(ROWS)
        status, _, err = self.identify(self.timed(u, y))
        self.assertEqual(status, 1)
        self.assertRegex(err, "y: (an|probably an) integrator.*--integrates y")
        status, out, err = call("identify", self.timed(u, y), "--inputs", "u", "--outputs", "y", "--integrates", "y", "-o", str(self.folder / "x.png"))
        self.assertEqual((status, err), (0, ""))
        rate = float(out.split("y, per s")[1].split()[0])
        self.assertAlmostEqual(rate, 0.001, delta=0.0001)
        self.assertIsNone(self.identify(self.timed(u, y), "--integrates", "y")[1]["outputs"][0]["gains"][0])

    def test_a_model_no_better_than_the_mean_fails(self) -> None:
        noise = np.random.default_rng(6).standard_normal(ROWS).cumsum()
        status, found, err = self.identify(self.timed(steps(), 50.0 + noise))
        self.assertEqual(status, 1)
        self.assertIn("no better than the mean", err)
        self.assertLess(found["outputs"][0]["validation"]["fit"], 0)

    def test_a_good_model_has_no_doubt(self) -> None:
        u = steps()
        status, found, err = self.identify(self.timed(u, first_order(u)))
        self.assertEqual((status, err, found["outputs"][0]["doubt"]), (0, "", ""))

    def test_options_for_what_is_not_there_are_refused(self) -> None:
        path = self.timed(steps(), steps())
        for more, words in ((("--integrates", "T"), "none of --outputs"), (("--integrates", "y", "--na", "0"), "a coefficient of A"),
                            (("--drift", "--inputs", "a,b,c,d", "--outputs", "y"), "3 at most")):
            status, _, err = self.identify(path, *more)
            self.assertEqual(status, 2)
            self.assertIn(words, err)


class Times(Logs):
    def period(self, name: str, of: Callable[[int], object], *more: str) -> tuple[float, str]:
        u = steps(300, 20)
        status, found, err = self.identify(self.log({name: [of(k) for k in range(300)], "u": u, "y": first_order(u)}), *more)
        self.assertEqual(status, 0, err)
        return found["period_s"], err

    def test_columns_of_times_are_recognised_by_their_names_and_units(self) -> None:
        for name, unit_s in (("Time", 1), ("time_s", 1), ("t", 1), ("TIME [min]", 60), ("time (min)", 60), ("Time(h)", 3600), ("time_ms", 0.001), ("timestamp", 1)):
            with self.subTest(name):
                self.assertAlmostEqual(self.period(name, lambda k: f"{5 * k / unit_s:.6f}")[0], 5.0, places=3)

    def test_dates_are_times(self) -> None:
        begin = datetime.datetime(2024, 2, 28, 23, 59, 0, tzinfo=datetime.timezone.utc)
        for name, text in (("date", lambda t: t.isoformat()), ("Date Time", lambda t: t.strftime("%Y-%m-%d %H:%M:%S")),
                           ("timestamp", lambda t: t.strftime("%Y-%m-%dT%H:%M:%SZ"))):
            with self.subTest(name):
                self.assertAlmostEqual(self.period(name, lambda k: text(begin + datetime.timedelta(seconds=5 * k)))[0], 5.0)

    def test_a_temperature_is_no_time(self) -> None:
        for name in ("T", "T_s", "T (min)", "tmin"):
            with self.subTest(name):
                status, _, err = self.identify(self.log({name: np.arange(300), "u": steps(300, 20), "y": first_order(steps(300, 20))}))
                self.assertEqual(status, 2)
                self.assertIn("no column time", err)

    def test_rows_that_are_early_or_late_are_told_with_a_period_too(self) -> None:
        period, err = self.period("Time", lambda k: 5 * k + k % 2, "--period", "5")
        self.assertEqual(period, 5.0)
        self.assertIn("up to 20 % of a period early or late", err)

    def test_a_lost_row_is_refused_with_a_period_too(self) -> None:
        u = steps(300, 20)
        path = self.log({"Time": [5 * k + 10 * (k > 100) for k in range(300)], "u": u, "y": first_order(u)})
        status, _, err = self.identify(path, "--period", "5")
        self.assertEqual(status, 2)
        self.assertIn("row 102 is 15 s after the one before", err)

    def test_a_file_without_a_header_is_refused_in_words(self) -> None:
        status, _, err = self.identify(self.log({"0": np.arange(50), "u": steps(50, 5), "y": steps(50, 5)}, header=False))
        self.assertEqual(status, 2)
        self.assertIn("has no header", err)


if __name__ == "__main__":
    unittest.main()
