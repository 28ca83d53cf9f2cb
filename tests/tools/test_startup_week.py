"""tools/research/startup_week.py: which runs are taken, what happens in a week, and the figures of one."""

import unittest

import support  # noqa: F401  it finds the packages
import numpy as np

from research import startup_plants, startup_week as weeks


def run(kind: str, n: int, outcome: str = "kept", extras: str = "") -> weeks.Row:
    return {"plant": "plain", "kind": kind, "seed": str(n), "noise": "0.003", "outcome": outcome, "extras": extras, "ms": "1.8",
            "settings": "y1/u1:2.5:80:0 y2/u2:-2:70:0"}


def week(kept: float, pi: float, kind: str = "plain") -> weeks.Row:
    row = {key: "" for key in weeks.FIELDS}
    row.update(plant="plain", kind=kind, seed="1", noise="0.003", week="rest", kept_ms="1.8", iae_kept=str(kept), iae_pi=str(pi), moves_kept="1",
               moves_pi="1", beyond_kept="0", beyond_pi="0", late_kept="1", late_pi="1", manual_kept="0", manual_pi="0", swings_kept="0",
               swings_pi="0")
    return row


class Weeks(unittest.TestCase):
    def test_every_twelfth_kept_run_of_each_class_is_taken(self) -> None:
        rows = [run("first-order", n) for n in range(14)] + [run("damped", 1)] + [run("damped", 2, "taken back"), run("damped", 3, extras="cascade x")]
        found = [(r["kind"], r["seed"]) for r in weeks.sample(rows)]
        self.assertEqual(found, [("damped", "1"), ("first-order", "0"), ("first-order", "12")])

    def test_a_run_counts_once_both_of_its_weeks_are_there(self) -> None:
        rest, busy = week(1.0, 1.0), {**week(1.0, 1.0), "week": "busy"}
        self.assertEqual(weeks.whole([rest]), {})
        self.assertEqual(weeks.whole([rest, busy]), {("plain", "1", "0.003"): [rest, busy]})

    def test_settings_of_a_row_are_loops_and_a_decoupler(self) -> None:
        row = run("first-order", 1)
        row["settings"] += " decoupler:1:0.2:0.3:1"
        loops, decoupler = weeks.loops_of(row, startup_plants.case("plain"))
        self.assertEqual([(c.output, c.input, c.kc, c.ti_s) for c in loops], [(0, 0, 2.5, 80.0), (1, 1, -2.0, 70.0)])
        self.assertEqual(decoupler.tolist(), [[1.0, 0.2], [0.3, 1.0]])

    def test_a_busy_week_is_the_same_each_time_and_stays_within_its_sizes(self) -> None:
        case = startup_plants.case("plain")
        data, loads = weeks.with_loads(case)
        self.assertEqual(len(data["elements"][0]), 4)
        setpoints, events = weeks.busy(case, loads, 3)
        self.assertEqual((setpoints, events), weeks.busy(case, loads, 3))
        self.assertTrue(setpoints and events)
        for at, _, value in setpoints:
            self.assertTrue(weeks.BEGIN_S < at < weeks.WEEK_S and abs(value - 50.0) <= 5.0)
        for event in events:
            self.assertLessEqual(abs(float(event.split("=")[1])), 5.0)

    def test_a_setpoint_holds_from_its_time_on(self) -> None:
        asked = weeks.asked(np.arange(5.0), {"name": "y1", "nominal": 50}, [(2.0, "y1", 53.0), (3.0, "y2", 10.0)])
        self.assertEqual(asked.tolist(), [50.0, 50.0, 53.0, 53.0, 53.0])

    def test_a_cycle_that_lasts_has_its_period_and_noise_has_none(self) -> None:
        time = 10.0 * np.arange(20000)
        noise = np.random.default_rng(1).normal(0.0, 1.0, (len(time), 1))
        self.assertEqual(weeks.lasting(noise, 10.0), 0.0)
        self.assertAlmostEqual(weeks.lasting(noise + 3.0 * np.sin(2 * np.pi * time / 500.0)[:, None], 10.0), 500.0, delta=5.0)

    def test_the_page_has_medians_worst_and_the_share_above_the_bound(self) -> None:
        page = weeks.text([week(1.0, 1.0), week(1.2, 1.0), week(2.0, 1.0)])
        self.assertIn("| all | 3 | rest | 1.20 | 2.00 | 1 of 3 |", page)
        self.assertIn("error 2.00", page)
        self.assertIn("no runs yet", weeks.text([]))


if __name__ == "__main__":
    unittest.main()
