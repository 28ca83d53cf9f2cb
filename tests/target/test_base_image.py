#!/usr/bin/python3
"""The base image of the STM32F405 in the emulator and on the virtual board: what it controls with its own limits, and what it leaves out."""

import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402


class BaseImageTest(unittest.TestCase):
    KIND = "stm32f405-base"

    def setUp(self) -> None:
        self.firmware = self.enterContext(board.start(self.KIND))
        self.console = self.enterContext(board.console(self.firmware))

    def test_version_says_what_is_short_and_left_out(self) -> None:
        board.plant(self, self.firmware)
        version = "\n".join(self.console.do("version"))
        for limit in ("channels 8 loops 8", "events 100", "arena bytes 16448 steps 0", "plant channels 16",
                      "left out of this build: sequences automatic-start-up"):
            self.assertIn(limit, version)

    def test_what_is_left_out_is_refused(self) -> None:
        board.plant(self, self.firmware)
        for line in ("set meas9.lo 1", "set step1.hold 1", "seq start", "commission begin"):
            self.assertTrue(self.console.ask(line)[-1].startswith("err UNSUPPORTED"), line)
        self.assertNotIn("SEQUENCE", "\n".join(self.console.do("events")))

    def test_it_controls_logs_and_takes_changes_while_it_does(self) -> None:
        board.plant(self, self.firmware)
        self.console.event("LINK_UP")
        board.configure(self.console)
        self.console.do("mode bottom auto")
        self.console.event("MODE")
        self.console.do("log on")
        for n in range(60):
            self.console.do(f"set loop2.ti {300 + n}")
        end = time.monotonic() + board.PATIENCE_S
        while len(self.console.telemetry) < 20 and time.monotonic() < end:
            self.console.do("status")
        header, row = (next(t for t in self.console.telemetry if t.startswith(kind)) for kind in ("H,", "T,"))
        self.assertEqual(header.count(","), row.count(","))
        self.assertEqual(self.console.do("get loop2.ti"), ["loop2.ti = 359 s"])
        self.assertIn("bottom auto", "\n".join(self.console.do("loop bottom")))
        stats = " ".join(self.console.do("stats"))
        self.assertIn("events_lost 0", stats)

    def test_a_paste_of_two_hundred_lines_arrives_whole(self) -> None:
        board.plant(self, self.firmware)
        self.console.write("".join(f"get loop{1 + k % 8}.gain\n" for k in range(200)))
        replies = 0
        while replies < 200:
            replies += self.console.line() == "ok"
        self.assertIn("errors 0", " ".join(self.console.do("stats")))

    def test_a_plant_with_more_channels_than_it_can_be_configured_for_connects(self) -> None:
        board.plant(self, self.firmware, str(board.ROOT / "tests/loop/data/sixteen.json"))
        self.console.event("LINK_UP")
        self.assertIn("plant link ready", self.console.do("status")[0])


class OnTheVirtualBoard(BaseImageTest):
    KIND = "board-stm32f405-base"


if __name__ == "__main__":
    unittest.main()
