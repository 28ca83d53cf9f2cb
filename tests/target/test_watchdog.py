#!/usr/bin/python3
"""A watchdog that really bites: tests/target/watchdog_image on an emulated MPS2 board, because the emulated STM32F405 has none, and on the
virtual STM32F405 with the port's own driver."""

import re
import subprocess
import sys
import threading
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from virtual_board import ROOT, VirtualBoard  # noqa: E402

IMAGES = ROOT / "build" / "stm32f405"
TIMEOUT_MS = 400  # of the image's watchdog


def on_emulator(image: Path) -> str:
    """Output of the image until it is done; its clock counts instructions, whatever else the machine does."""
    emulator = subprocess.Popen(
        ["qemu-system-arm", "-M", "mps2-an386", "-kernel", str(image), "-display", "none", "-monitor", "none",
         "-serial", "stdio", "-icount", "shift=6,sleep=off"],
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
    watch = threading.Timer(900, emulator.kill)
    watch.start()
    said = ""
    try:
        for line in emulator.stdout:
            said += line
            if line.strip() == "done":
                break
    finally:
        watch.cancel()
        emulator.kill()
        emulator.wait()
        emulator.stdout.close()
    return said


class WatchdogTest(unittest.TestCase):
    def test_on_an_emulated_board(self) -> None:
        self.each_way_to_hang_ends_in_a_reset_and_health_does_not(on_emulator(IMAGES / "watchdog-image.elf"))

    def test_on_the_virtual_board(self) -> None:
        with VirtualBoard(IMAGES / "watchdog-stm32f405.bin") as board:
            self.each_way_to_hang_ends_in_a_reset_and_health_does_not(board.until(r"^done\n", 60.0))

    def each_way_to_hang_ends_in_a_reset_and_health_does_not(self, said: str) -> None:
        print(said, end="")
        lives = re.findall(r"life (\d) begins, watchdog runs", said)
        ends = dict(re.findall(r"life (\d) ended after ms (\d+)", said))
        self.assertEqual(lives, ["1", "2", "3", "4"])
        self.assertEqual(sorted(ends), ["1", "2", "3"])
        self.assertTrue(said.endswith("done\n"))
        # Fed as long as all was well, and no longer than a time-out and a half after that.
        for life, healthy_ms in (("1", 3 * TIMEOUT_MS), ("2", 300), ("3", 300)):
            self.assertGreater(int(ends[life]), healthy_ms)
            self.assertLess(int(ends[life]), healthy_ms + 3 * TIMEOUT_MS)


if __name__ == "__main__":
    unittest.main()
