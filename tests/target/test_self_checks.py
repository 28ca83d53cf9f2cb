#!/usr/bin/python3
"""What the image finds out about its board, on the virtual board: option bytes, memory, image, supply and plant link in an erase.

    test_self_checks.py [IMAGE]      IMAGE: build/stm32f405/reflux-stm32f405.bin by default
"""

import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402

IMAGE = board.ROOT / "build" / "stm32f405" / "reflux-stm32f405.bin"
PROGRAM = board.ROOT / "build" / "host" / "board-self-checks"


@unittest.skipUnless(PROGRAM.exists(), "no board-self-checks: libunicorn-dev is not installed")
class SelfChecksTest(unittest.TestCase):
    def case(self, name: str) -> str:
        done = subprocess.run([PROGRAM, IMAGE, name], capture_output=True, text=True, timeout=600, check=False)
        print(done.stdout, end="")
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_version_says_which_option_bytes_protect_the_board(self) -> None:
        self.case("options")

    def test_start_up_feeds_a_watchdog_that_runs_from_the_reset_on(self) -> None:
        self.assertEqual(self.case("watchdog").count(" 0 resets"), 12)

    def test_a_stuck_bit_of_the_ram_is_told_and_nothing_acts(self) -> None:
        self.case("stuck")

    def test_good_ram_passes_and_other_resets_keep_what_it_holds(self) -> None:
        self.case("memory")

    def test_a_bit_of_the_image_that_changes_in_the_run_is_told(self) -> None:
        self.case("image")

    def test_a_supply_that_dips_in_an_erase_spoils_it(self) -> None:
        self.case("dip")

    def test_a_save_without_brown_out_reset_wants_a_word_more(self) -> None:
        self.case("save")

    def test_the_plant_link_lives_through_an_erase(self) -> None:
        self.case("link")


if __name__ == "__main__":
    if len(sys.argv) > 1 and not sys.argv[1].startswith("-"):
        IMAGE = Path(sys.argv.pop(1)).resolve()
    unittest.main()
