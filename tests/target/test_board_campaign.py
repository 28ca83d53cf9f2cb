#!/usr/bin/python3
"""The flashed files on the virtual board, whose supply is cut in a save and after it, and at random instants: no set is lost.

    test_board_campaign.py [all]
"""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from sample import EVERY  # noqa: E402

LARGE, SMALL = "stm32f405", "stm32f100"
PROGRAM = board.ROOT / "build" / "host" / "board-campaign"
ALL_RUNS = 20000
JOBS = os.cpu_count() or 1


RESULTS = board.ROOT / "build" / "board-campaign"


def flashed(image: str) -> Path:
    return board.ROOT / "build" / image / f"reflux-{image}.bin"


def kept(name: str, image: str) -> Path:
    """Where results of this image are kept, so that a campaign of hours goes on after it was stopped."""
    RESULTS.mkdir(parents=True, exist_ok=True)
    return RESULTS / f"{name}-{image}-{flashed(image).read_bytes()[-4:][::-1].hex()}.txt"


@unittest.skipUnless(PROGRAM.exists(), "no board-campaign: libunicorn-dev is not installed")
class BoardCampaignTest(unittest.TestCase):
    def run_program(self, name: str, image: str, *options: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([PROGRAM, name, flashed(image), "--root", board.ROOT, "--jobs", str(JOBS), *options],
                              capture_output=True, text=True, check=False)

    def campaign(self, name: str, image: str, *options: str) -> str:
        """What the campaign prints, once it has found nothing."""
        if EVERY:
            options = ("--results", str(kept(name, image)), *options)
        done = self.run_program(name, image, *options)
        print(done.stdout, end="", flush=True)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        self.assertIn(", 0 finds", done.stdout)
        return done.stdout

    def test_a_cut_in_a_save_leaves_the_old_set_or_the_new_one(self) -> None:
        said = self.campaign("first", SMALL, *(() if EVERY else ("--stride", "60")))
        self.assertIn("old ", said)
        if EVERY:
            self.assertIn("new ", said)
            self.assertIn("new ", self.campaign("first", LARGE))

    def test_two_more_cuts_lose_no_set(self) -> None:
        if EVERY:
            for image in (SMALL, LARGE):
                self.assertIn(f"kept {ALL_RUNS}", self.campaign("further", image, "--count", str(ALL_RUNS)))
            return
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            options = ("--count", "4", "--append", "--results", str(Path(folder) / "results"))
            self.assertIn("4 runs, 4 of them now", self.campaign("further", SMALL, *options))
            self.assertIn("4 runs, 0 of them now", self.campaign("further", SMALL, *options))

    def test_a_reset_or_a_cut_at_a_random_instant_loses_no_set(self) -> None:
        # By default one in a save and one in a start.
        self.campaign("instants", LARGE, *(("--count", str(ALL_RUNS)) if EVERY else ("--from", "4", "--count", "2")))

    def test_results_of_another_campaign_are_not_gone_on_with(self) -> None:
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
            file.write("# first, another image\n")
            file.flush()
            done = self.run_program("first", SMALL, "--results", file.name)
            self.assertEqual(done.returncode, 2)
            self.assertIn("has no results of: first, STM32F100", done.stderr)


if __name__ == "__main__":
    unittest.main()
