"""Integrals of the error of sampled loops, and the search for the best settings of equal sensitivity."""

import unittest

import support  # noqa: F401 - finds the tools

import numpy as np

from research import startup_iae, startup_plants
from research.startup_judge import PI, Judge
from research.startup_linear import Linear


class Integrals(unittest.TestCase):
    def test_without_a_change_of_sign_they_are_ti_over_kc(self) -> None:
        """The integral's state has to move by the load, or by the setpoint over the gain: a sum of errors that is known."""
        plant = Linear(startup_plants.transfer("case", 5.0, [[startup_plants.lag(2.0, 100, dead=12)]]))
        loops = [PI(0, 0, 0.6, 100.0)]
        setpoint, load = startup_iae.integrals(plant, loops, np.array([[0.6], [0.3]]), np.array([[100.0], [100.0]]), 2000)
        for k, kc in enumerate((0.6, 0.3)):
            self.assertAlmostEqual(load[k], 100.0 / kc, delta=0.01 * load[k])
            self.assertAlmostEqual(setpoint[k], 100.0 / kc / 2.0, delta=0.01 * setpoint[k])

    def test_unstable_settings_have_large_ones(self) -> None:
        plant = startup_plants.case("plain").linear()
        loops = [PI(0, 0, 30.0, 50.0), PI(1, 1, 30.0, 50.0)]
        found = startup_iae.integrals(plant, loops, np.array([[30.0, 30.0]]), np.array([[50.0, 50.0]]), 400)
        self.assertGreater(found[0][0], 1e6)


class Search(unittest.TestCase):
    def test_slow_settings_leave_room_and_the_best_keep_the_bound(self) -> None:
        judge = Judge(startup_plants.case("one-way").linear())
        loops = [PI(0, 0, 1.0, 300.0), PI(1, 1, 1.0, 300.0)]
        least, best = startup_iae.best(judge, loops, 1.6, 1)
        self.assertLessEqual(judge.judge(best).ms, 1.61)
        before = startup_iae.integrals(judge.plant, loops, np.array([[1.0, 1.0]]), np.array([[300.0, 300.0]]), startup_iae.samples_of(judge.plant))[1][0]
        self.assertLess(least, 0.6 * before)


if __name__ == "__main__":
    unittest.main()
