#!/usr/bin/python3
"""The STM32F405's own pins and buses: tests/target/io_image on the virtual board, with a small plant at its pins (tests/target/board_io)."""

import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402

IMAGE = board.ROOT / "build" / "stm32f405" / "io-stm32f405.bin"
PROGRAM = board.ROOT / "build" / "host" / "board-io"
COUNT = 20000  # transfers of a campaign


@unittest.skipUnless(PROGRAM.exists(), "no board-io: libunicorn-dev is not installed")
class BoardIoTest(unittest.TestCase):
    def case(self, name: str, *arguments: str) -> str:
        done = subprocess.run([PROGRAM, IMAGE, name, *arguments], capture_output=True, text=True, timeout=900, check=False)
        print(done.stdout, end="")
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def campaign(self, name: str, seed: int) -> None:
        self.assertIn(" 0 hung", self.case(name, str(COUNT), str(seed)))

    def test_barriers_stand_where_the_manuals_want_them(self) -> None:
        """The exact mode checks them (host_sim/virtual_board/barrier_rules.h)."""
        for name in ("pins", "outputs", "pwm", "pulses", "analog", "spi", "wire", "i2c", "together"):
            with self.subTest(name):
                self.case(name, "exact")

    def test_free_pins_do_what_they_are_told_and_the_others_stay_as_they_are(self) -> None:
        self.case("pins")

    def test_outputs_are_on_only_when_they_are_set(self) -> None:
        self.case("outputs")

    def test_pulse_widths_are_as_they_are_set_and_off_at_once(self) -> None:
        self.case("pwm")

    def test_pulses_are_counted_and_bounces_are_not(self) -> None:
        self.case("pulses")

    def test_analogue_inputs_are_means_of_16_conversions(self) -> None:
        self.case("analog")

    def test_spi_exchanges_bytes_with_chips(self) -> None:
        self.case("spi")

    def test_no_spi_transfer_hangs(self) -> None:
        self.campaign("spi-campaign", 1)

    def test_1_wire_finds_chips_and_exchanges_bytes_with_them(self) -> None:
        self.case("wire")

    def test_no_1_wire_transfer_hangs(self) -> None:
        self.campaign("wire-campaign", 1)

    def test_i2c_exchanges_bytes_and_frees_a_bus_that_is_held(self) -> None:
        self.case("i2c")

    def test_all_buses_and_inputs_run_at_the_same_time(self) -> None:
        self.case("together")

    def test_no_i2c_transfer_hangs(self) -> None:
        self.campaign("i2c-campaign", 1)


if __name__ == "__main__":
    unittest.main()
