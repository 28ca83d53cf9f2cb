"""Metrics on responses whose values are known exactly."""

import math
import unittest
from pathlib import Path

import support  # noqa: F401  finds the tools

from reflux import limits, metrics
from reflux.logs import Log
from reflux.scenario import Event, Limit, Line, Loop, Scenario

DT, T, STEP = 1.0, 100.0, 2.0
LOOP = Loop("top", "T1", "Lr", 0.1)


def scenario(**more: object) -> Scenario:
    fields: dict[str, object] = dict(
        file=Path("x"), name="x", title="x", plant="x", duration_s=2000.0, loops=(LOOP,),
        lines=(Line(500.0, "sp top 12"),), events=(Event(1500.0, "F", 1.0),))
    return Scenario(**{**fields, **more})  # type: ignore[arg-type]


def log(response, u=lambda t: 0.0) -> Log:
    columns = ["number", "time[s]", "T1.true[degC]", "Lr.applied[l/h]", "fw.top.sp[degC]"]
    rows = []
    for k in range(2001):
        t = k * DT
        rows.append([str(k), str(t), repr(response(t)), repr(u(t)), "12" if t >= 500 else "10"])
    return Log(columns, rows)


def first_order(t: float) -> float:
    return 10.0 if t < 500 else 12 - STEP * math.exp(-(t - 500) / T)


def second_order(t: float, zeta: float = 0.4, w: float = 0.05) -> float:
    if t < 500:
        return 10.0
    s, wd = t - 500, w * math.sqrt(1 - zeta**2)
    return 12 - STEP * math.exp(-zeta * w * s) * (math.cos(wd * s) + zeta * w / wd * math.sin(wd * s))


class Metrics(unittest.TestCase):
    def windows(self, response, **more) -> list[metrics.Window]:
        return metrics.windows(log(response, **more), scenario(), LOOP)

    def test_first_order_step(self) -> None:
        start, step, disturbance, overall = self.windows(first_order)
        self.assertEqual((start.kind, step.kind, disturbance.kind, overall.kind),
                         ("start", "setpoint", "disturbance", "overall"))
        self.assertEqual(start.iae, 0.0)
        self.assertEqual(step.step, STEP)
        exact = STEP * T * (1 - math.exp(-10))  # integral of the error over 10 time constants
        self.assertAlmostEqual(step.iae / exact, 1.0, places=4)
        self.assertEqual(step.overshoot_percent, 0.0)
        self.assertAlmostEqual(step.settling_s, math.ceil(T * math.log(STEP / LOOP.band)), delta=1)
        self.assertAlmostEqual(step.max_error, STEP)
        self.assertEqual(disturbance.settling_s, 0.0)

    def test_a_setpoint_in_degrees_is_judged_in_the_kelvin_of_the_plant(self) -> None:
        degrees = log(first_order)
        kelvin = Log([name.replace("T1.true[degC]", "T1.true[K]") for name in degrees.columns],
                     [[*row[:2], repr(float(row[2]) + 273.15), *row[3:]] for row in degrees.rows])
        here, there = (metrics.windows(one, scenario(), LOOP)[1] for one in (degrees, kelvin))
        self.assertAlmostEqual(here.iae, there.iae, places=6)
        self.assertAlmostEqual(here.max_error, there.max_error, places=9)

    def test_overshoot_of_a_second_order_step(self) -> None:
        step = self.windows(second_order)[1]
        self.assertAlmostEqual(step.overshoot_percent, 100 * math.exp(-math.pi * 0.4 / math.sqrt(1 - 0.16)), delta=0.1)

    def test_step_down_overshoots_below(self) -> None:
        self.assertEqual(metrics.overshoot([10, 7.5, 8.2], 10, 8), 25.0)
        self.assertEqual(metrics.overshoot([8, 10.5, 10], 8, 10), 25.0)

    def test_never_settles(self) -> None:
        step = self.windows(lambda t: 10.0)[1]
        self.assertTrue(math.isnan(step.settling_s))
        self.assertEqual(step.as_dict()["settling_s"], "never")

    def test_travel(self) -> None:
        overall = self.windows(first_order, u=lambda t: (t // 10) % 2)[3]
        self.assertEqual(overall.tv, 200.0)
        self.assertEqual(metrics.travel([]), 0.0)

    def test_windows_share_the_travel_of_the_run(self) -> None:
        *parts, overall = self.windows(first_order, u=lambda t: math.sin(t / 7))
        self.assertAlmostEqual(sum(p.tv for p in parts), overall.tv)
        self.assertAlmostEqual(sum(p.iae for p in parts), overall.iae)

    def test_other_loop_is_interaction(self) -> None:
        one = scenario(lines=(Line(500.0, "sp bottom 5"),))
        self.assertEqual(metrics.windows(log(first_order), one, LOOP)[1].kind, "interaction")


class Limits(unittest.TestCase):
    def check(self, limit: Limit, response=first_order) -> limits.Check:
        one = scenario(limits=(limit,))
        return limits.check(one, metrics.windows(log(response), one, LOOP))[0]

    def test_kept_and_missed(self) -> None:
        self.assertTrue(self.check(Limit("top", 500.0, {"iae": 201.0})).passed)
        missed = self.check(Limit("top", 500.0, {"iae": 190.0}))
        self.assertFalse(missed.passed)
        self.assertIn("loop top: IAE in the window from 500 s is 200, at most 190 allowed", missed.sentence())

    def test_never_settled_is_missed(self) -> None:
        missed = self.check(Limit("top", None, {"settling_s": 1e9}), lambda t: 10.0)
        self.assertFalse(missed.passed)
        self.assertIn("never reached", missed.sentence())


if __name__ == "__main__":
    unittest.main()
