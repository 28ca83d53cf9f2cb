"""Boards to buy: a board that is said to suit does, and the picture is drawn from the settings."""

import importlib.util
import unittest

from support import ROOT

from dev.reference import named_boards_page
from reflux.errors import RunFailed

WIRED = [("PA5", "clock of spi1"), ("PB12", "select pin of T10")]
BUSES = {"spi1": ["PA5", "PA6", "PA7"], "wire1": ["PC6"]}


def board(**taken: str) -> dict:
    return {"name": "a board", "chip": "STM32F405RG", "crystal": 8, "suits": "yes", "taken": taken, "source": "-"}


class NamedBoards(unittest.TestCase):
    def test_a_board_suits_only_if_nothing_has_the_pins_of_console_and_pilot_column(self) -> None:
        named_boards_page.check(board(PC12="LED"), WIRED)
        for taken in ({"PA9": "USB supply"}, {"PA10": "USB"}, {"PA5": "LED"}, {"PB12": "SD card"}):
            with self.subTest(taken), self.assertRaisesRegex(RunFailed, next(iter(taken))):
                named_boards_page.check(board(**taken), WIRED)

    def test_what_is_from_memory_stands_so_on_the_page_and_refuses_nothing(self) -> None:
        guessed = board(PB12="SD card?")
        named_boards_page.check(guessed, WIRED)
        self.assertIn("`PB12`: SD card (unverified)", named_boards_page.row(guessed, ["PB12", "PB0"], BUSES)[4])

    def test_a_crystal_that_the_clock_does_not_know_does_not_suit(self) -> None:
        with self.assertRaisesRegex(RunFailed, "24"):
            named_boards_page.check({**board(), "crystal": 24}, WIRED)
        clock = (ROOT / "hal" / "stm32f405" / "clock.c").read_text(encoding="utf-8")
        for mhz in named_boards_page.CRYSTALS_MHZ:
            self.assertRegex(clock, rf"\b{mhz}(000000)?u?\b")

    def test_buses_and_pins_that_are_left_have_no_taken_pin(self) -> None:
        row = named_boards_page.row(board(PA6="LED"), ["PA6", "PB0"], BUSES)
        self.assertEqual(row[5:7], ("`wire1`", "`PB0`"))

    def test_the_picture_is_what_its_script_draws_from_the_settings(self) -> None:
        path = ROOT / "tools" / "figures" / "wiring_figure.py"
        spec = importlib.util.spec_from_file_location("wiring_figure", path)
        assert spec is not None and spec.loader is not None
        script = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(script)
        drawn = script.draw()
        self.assertEqual((ROOT / "docs" / "figures" / "pilot-wiring.svg").read_text(encoding="utf-8"), drawn)
        for pin in ("PA4", "PB12", "PB0", "PB1"):
            self.assertIn(f">{pin}</text>", drawn)


if __name__ == "__main__":
    unittest.main()
