#!/usr/bin/python3
"""Nothing is written above the chip's memory, where the emulated board has more: support/sram_guard.py. Start-ups are
looked at in test_commission.py.

    test_sram_guard.py [all]      all: every scenario, not only the longest in plant time
"""

import subprocess
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from sram_guard import CHIP_END, GUARD_BYTES, Guard  # noqa: E402

from reflux import launch, runner, scenario  # noqa: E402
from dev.elf_image import Image  # noqa: E402
from reflux.paths import every  # noqa: E402

SCENARIOS = board.ROOT / "host_sim" / "scenarios"
LONGEST = ["splitter"]


class SramGuard(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))
        self.guard = Guard(self.folder)

    def test_a_word_written_there_is_noticed(self) -> None:
        with launch.start("stm32f405", extra=self.guard.options()) as firmware, board.console(firmware) as console:
            console.do("status")
            self.assertEqual(self.guard.touched(), [])
            for address in (CHIP_END, CHIP_END + 0x1234, CHIP_END + GUARD_BYTES - 4):
                self.guard.poke(address, b"\0\0\0\0")
            self.assertEqual(self.guard.touched(), [CHIP_END, CHIP_END + 0x1234, CHIP_END + GUARD_BYTES - 4])
            console.do("status")

    def test_the_image_ends_below_it(self) -> None:
        image = Image(board.ROOT / "build" / "stm32f405" / "reflux-stm32f405.elf")
        self.assertLessEqual(image.symbols["bss_end"], CHIP_END)

    def test_no_scenario_writes_there(self) -> None:
        for name in LONGEST:
            wanted = replace(scenario.load(SCENARIOS / f"{name}.toml"), firmware="stm32f405")
            place = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))
            guard = Guard(place)
            with launch.start("stm32f405", extra=guard.options()) as firmware:
                runner.write_script(wanted, place / "script.txt")
                subprocess.run(runner.simulator_command(wanted, firmware, place), check=True, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL, timeout=900)
                self.assertEqual(guard.touched(), [], name)
            print(f"guard above the SRAM: untouched after {name}, {wanted.duration_s:g} s of plant time")


if __name__ == "__main__":
    if sys.argv[1:] == ["all"]:
        LONGEST = [path.stem for path in every(SCENARIOS, "*.toml")]
        del sys.argv[1:]
    unittest.main()
