#!/usr/bin/python3
"""The flashed files on the virtual board, whose supply is cut in a save and after it, and at random instants: no set is lost.

    test_board_campaign.py [all]
"""

import os
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from sample import EVERY  # noqa: E402

LARGE, SMALL = "stm32f405", "stm32f100"
PROGRAM = board.ROOT / "build" / "host" / "board-campaign"
ALL_RUNS = 20000
JOBS = os.cpu_count() or 1


@unittest.skipUnless(PROGRAM.exists(), "no board-campaign: libunicorn-dev is not installed")
class BoardCampaignTest(unittest.TestCase):
    def campaign(self, name: str, image: str, *options: str) -> str:
        """What the campaign prints, once it has found nothing."""
        done = subprocess.run([PROGRAM, name, board.ROOT / "build" / image / f"reflux-{image}.bin", "--root", board.ROOT, "--jobs",
                               str(JOBS), *options], capture_output=True, text=True, check=False)
        print(done.stdout, end="", flush=True)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        return done.stdout

    def test_a_cut_in_a_save_leaves_the_old_set_or_the_new_one(self) -> None:
        said = self.campaign("first", SMALL, *(() if EVERY else ("--stride", "50")))
        self.assertIn("old ", said)
        if EVERY:
            self.assertIn("new ", said)
            self.assertIn("new ", self.campaign("first", LARGE))

    def test_two_more_cuts_lose_no_set(self) -> None:
        for image in (SMALL, LARGE) if EVERY else (SMALL,):
            self.assertIn("kept ", self.campaign("further", image, "--count", str(ALL_RUNS if EVERY else 6)))

    def test_a_reset_or_a_cut_at_a_random_instant_loses_no_set(self) -> None:
        self.assertIn("kept ", self.campaign("instants", LARGE, "--count", str(ALL_RUNS if EVERY else 5)))


class OptionsTest(unittest.TestCase):
    @unittest.skipUnless(PROGRAM.exists(), "no board-campaign: libunicorn-dev is not installed")
    def test_results_of_another_campaign_are_not_gone_on_with(self) -> None:
        import tempfile
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
            file.write("# first, another image\n")
            file.flush()
            image = board.ROOT / "build" / SMALL / f"reflux-{SMALL}.bin"
            done = subprocess.run([PROGRAM, "first", image, "--root", board.ROOT, "--results", file.name], capture_output=True, text=True,
                                  check=False)
            self.assertEqual(done.returncode, 2)
            self.assertIn("has no results of: first, STM32F100", done.stderr)


if __name__ == "__main__":
    unittest.main()
