"""tools/research/feedforward_other_plants.py: the four ways to Gd/Gp on the rig of chapter 4 of Siddha (2003), whose models are known."""

import unittest

import numpy as np
import support  # noqa: F401

from research import feedforward_other_plants as other_plants
from reflux.errors import UserError
from research.feedforward_other_plants import Rig


class OnTheRig(unittest.TestCase):
    def test_each_method_finds_the_ratio_where_there_is_no_noise(self) -> None:
        """But for readings in 0.01 K; up to 0.01 rad/s."""
        for method in other_plants.METHODS:
            db, degrees = other_plants.error_of(other_plants.play_rig(Rig(method=method, noise=0.0), 1)["tuning"])
            self.assertLess(abs(db[:3]).max(), 0.5, method)
            self.assertLess(abs(degrees[:3]).max(), 4.0, method)

    def test_a_cycle_from_rest(self) -> None:
        """The exact element leaves next to nothing, and the PI alone much more than any element that fits."""
        alone, exact = (other_plants.rig_iae(1, t) for t in (None, other_plants.RIG_SHINSKEY))
        self.assertGreater(alone, 60.0)
        self.assertLess(exact, 0.5)
        self.assertLess(exact, other_plants.rig_iae(1, other_plants.RIG_PUBLISHED[1]))

    def test_signals_come_in_turn_unless_both_paths_are_learnt_together(self) -> None:
        both = np.array([other_plants._rig_signals(Rig(), k) for k in range(244)])
        self.assertTrue((both[164:].max(axis=0) > 0).all())
        turns = np.array([other_plants._rig_signals(Rig(method="B"), k) for k in range(244)])
        self.assertEqual(abs(turns[:164, 1]).max(), 0.0)
        self.assertEqual(abs(turns[164:, 0]).max(), 0.0)

    def test_a_method_that_is_none_is_refused(self) -> None:
        with self.assertRaises(UserError):
            other_plants.play_rig(Rig(method="E"), 1)


if __name__ == "__main__":
    unittest.main()
