#!/usr/bin/python3
"""The image in the emulator and on the virtual board, talked to over its own serial ports."""

import random
import struct
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402


def float32(text: str) -> float:
    return struct.unpack("f", struct.pack("f", float(text)))[0]


class EmulatorTest(unittest.TestCase):
    KIND, SAYS = "stm32f405", "in an emulator"

    def setUp(self) -> None:
        self.firmware = self.enterContext(board.start(self.KIND))
        self.console = self.enterContext(board.console(self.firmware))

    def test_the_board_knows_what_it_runs_on_and_how_fast(self) -> None:
        board.plant(self, self.firmware)
        version = "\n".join(self.console.do("version"))
        self.assertIn("on stm32f405", version)
        self.assertIn(self.SAYS, version)
        self.assertIn("168000000", version)

    def test_numbers_typed_on_the_console_are_read_as_the_nearest_float(self) -> None:
        board.plant(self, self.firmware)
        seed = random.randrange(1 << 30)
        print(f"seed {seed}")
        generator = random.Random(seed)
        self.console.do("begin")
        for _ in range(1000):
            digits = generator.randint(1, 9)
            text = f"{generator.randint(1, 10 ** digits - 1)}e{generator.randint(-12, 0)}"
            self.console.do(f"set lock8.limit {text}")
            shown = self.console.do("get lock8.limit")[0].split()[2]
            self.assertEqual(float32(shown), float32(text), text)
        self.console.do("abandon")

    def test_two_hundred_pasted_lines_arrive_whole(self) -> None:
        board.plant(self, self.firmware)
        self.console.write("".join(f"get loop{1 + k % 8}.gain\n" for k in range(200)))
        replies = 0
        while replies < 200:
            replies += self.console.line() == "ok"
        counters = " ".join(self.console.do("stats"))
        self.assertIn("console lines 20", counters)
        self.assertIn("errors 0", counters)

    def test_nothing_is_sent_between_xoff_and_xon_and_nothing_is_lost(self) -> None:
        expected = self.console.do("help")
        self.assertGreater(sum(map(len, expected)), 1024)  # more than the transmit ring
        self.console.write("\x13help\n")
        self.console.stays_silent(0.3)
        self.console.write("\x11")
        reply = [self.console.line() for _ in expected]
        self.assertEqual(reply, expected)
        self.assertEqual(self.console.line(), "ok")

    def test_noise_on_the_plant_link_leaves_the_console_alive(self) -> None:
        board.write_link(self.firmware, bytes(range(1, 200)) + b"\0")  # an unfinished frame and a delimiter
        self.console.do("version")
        self.assertIn("plant link down", self.console.do("status")[0])

    def test_a_silent_plant_and_a_reboot_end_in_the_safe_state(self) -> None:
        plant = board.plant(self, self.firmware)
        self.console.event("LINK_UP")
        board.configure(self.console)
        self.console.samples()
        self.console.do("out Qrb 0.8")
        self.console.do("mode bottom auto")
        self.console.event("MODE")
        plant.kill()
        self.console.event("LINK_DOWN")
        self.console.event("SAFE_STATE")
        self.console.write("reboot\n")
        self.console.until(lambda line: line == "ok")
        end = time.monotonic() + board.PATIENCE_S
        said = ""
        while "started by: requested" not in said and time.monotonic() < end:
            self.console.machine_mode()
            said = " ".join(self.console.ask("version"))
        self.assertIn("started by: requested", said)
        self.assertTrue(self.console.do("status")[0].startswith("state safe"))


class OnTheVirtualBoard(EmulatorTest):
    KIND, SAYS = "board-stm32f405", "STM32F405, Cortex-M4F, chip"


if __name__ == "__main__":
    unittest.main()
