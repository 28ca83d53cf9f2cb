#!/usr/bin/python3
"""The image for 8 KiB of RAM in the emulator and on the virtual board: what it lacks it says, and asked for it, refuses with a reason."""

import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402


class SmallBoardTest(unittest.TestCase):
    KIND, SAYS = "stm32f100", "in an emulator"

    def setUp(self) -> None:
        self.firmware = self.enterContext(board.start(self.KIND))
        self.console = self.enterContext(board.console(self.firmware))

    def control_pilot(self) -> None:
        board.plant(self, self.firmware)
        self.console.event("LINK_UP")
        board.configure(self.console)
        end = time.monotonic() + board.PATIENCE_S
        while not self.console.do("loop"):  # until the tick has taken the configuration
            self.assertLess(time.monotonic(), end)

    def test_version_says_what_is_short(self) -> None:
        version = "\n".join(self.console.do("version"))
        self.assertIn("on stm32f100, numbers Q7.24", version)
        self.assertIn(self.SAYS, version)
        for limit in ("channels 4", "loops 2", "feedforwards 1", "interlocks 2", "alarms 1",
                      "arena bytes 1280 steps 0", "left out of this build: sequences automatic-start-up",
                      "recalls no lines"):
            self.assertIn(limit, version)

    def test_what_only_larger_boards_have_is_refused_with_the_bytes_it_needs(self) -> None:
        for name in ("loop3.gain", "meas5.lo", "mv16.hi", "ff2.gain", "lock3.limit", "alarm2.limit"):
            reply = self.console.ask(f"set {name} 1")[-1]
            self.assertRegex(reply, rf"^err UNSUPPORTED {name}: this board has \d, bytes needed for each more: \d+$")
        self.assertRegex(self.console.ask("set step1.hold 1")[-1],
                         r"^err UNSUPPORTED step1.hold: this board has 0, bytes needed for each more: 96$")
        self.assertTrue(self.console.ask("seq start")[-1].startswith("err UNSUPPORTED sequences are left out"))
        self.assertTrue(self.console.ask("set loop17.gain 1")[-1].startswith("err UNKNOWN"))

    def test_a_dead_time_too_long_for_the_arena_is_refused_with_the_bytes_it_needs(self) -> None:
        self.control_pilot()
        for line in ("begin", "set ff1.reference 90", "set ff1.from T1", "set ff1.to Lr", "set ff1.gain 1", "set ff1.dead 3100"):
            self.console.do(line)
        reply = self.console.ask("apply")[-1]
        self.assertTrue(reply.startswith("err MEMORY ff1.dead:"), reply)
        self.assertIn("bytes needed: 1288, there are: 1280", reply)
        self.console.do("set ff1.dead 300")
        self.console.do("apply")

    def test_changes_need_not_wait_for_the_tick(self) -> None:
        """Without a plant the ticks come at the board's own pace: there is time for many."""
        self.console.do("set meas1.name T1")
        for lo in range(70, 80):
            self.console.do(f"set meas1.lo {lo}")
        self.assertEqual(self.console.do("get meas1.name"), ["meas1.name = T1"])
        self.assertEqual(self.console.do("get meas1.lo"), ["meas1.lo = 79 EU"])

    def test_a_plant_with_too_many_channels_is_refused_by_name(self) -> None:
        board.plant(self, self.firmware, "shell-fractionator")
        self.console.event("PLANT_REFUSED")
        self.assertIn("plant link down", self.console.do("status")[0])

    def test_stack_and_rings_have_room_left_after_a_busy_while(self) -> None:
        self.control_pilot()
        self.console.do("log on")
        for line in ("mode top auto", "mode bottom auto", "loop bottom", "list all", "help", "diff defaults",
                     "tune bottom cohen-coon-pid 120 60 600", "events"):
            self.console.do(line)
        self.console.do("log off")
        stats = " ".join(self.console.do("stats"))
        for word in ("dropped 0", "telemetry_lost 0", "bad_crc 0", "congested 0"):
            self.assertIn(word, stats)
        print(stats[stats.index("stack_bytes"):])
        self.assertGreater(int(stats.split("stack_unused ")[1].split()[0]), 64)


class OnTheVirtualBoard(SmallBoardTest):
    KIND, SAYS = "board-stm32f100", "STM32F100, Cortex-M3, chip"


if __name__ == "__main__":
    unittest.main()
