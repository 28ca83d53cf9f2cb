#!/usr/bin/python3
"""Flipped bits on the virtual board, each in a run that is compared with one without: those of the image, of the stored set and of retained
memory are never silent (tests/support/board_flips.py). test_board_faults.py --matrix counts them.

    test_board_flips.py [all]      one of each kind; all: 20 of each kind in each of five states
"""

import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from board_faults import STATES, Flash  # noqa: E402
from board_flips import KINDS, SEEDS, THERE, TOLD, Flips, broken  # noqa: E402
from sample import EVERY  # noqa: E402


class BoardFlipsTest(unittest.TestCase):
    def test_flips(self) -> None:
        states = list(STATES)
        wanted = [(kind, states[(n + 1) % len(states)], n + 1) for n, kind in enumerate(KINDS)]
        if EVERY:
            wanted = [(kind, state, seed) for kind in KINDS for state in states for seed in range(1, SEEDS + 1)]
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder, ThreadPoolExecutor(2) as pool:
            flips = Flips(Flash(Path(folder)))
            for flip in pool.map(lambda job: flips.run(*job), wanted):
                with self.subTest(kind=flip.kind, state=flip.state, seed=flip.seed):
                    self.assertTrue(flip.place.startswith("flip "), flip.place)
                    self.assertEqual(broken(flip), "")
                    if flip.kind == "image":  # the check comes round while the run lasts
                        self.assertNotEqual(flip.outcome, THERE)

    def test_a_flip_of_the_stored_set_is_told_at_the_next_start(self) -> None:
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            flip = Flips(Flash(Path(folder))).run(next(kind for kind in KINDS if kind.name == "stored set"), "manual", 1)
        self.assertEqual(flip.outcome, TOLD, flip.words)


if __name__ == "__main__":
    unittest.main()
