#!/usr/bin/python3
"""Nothing is written where no variable lies, neither in the chip's SRAM nor above it, where the emulated board has more:
support/sram_guard.py. The workspace lies where the emulated board has it. Start-ups are looked at in test_commission.py. In the emulator
alone, because only its memory goes on behind the chip's: on the virtual board a write there is a fault, as on the chip.

    test_sram_guard.py [all]      all: every scenario, not only the longest in plant time
"""

import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from sram_guard import CHIP_END, EMULATED_END, Guard, symbols  # noqa: E402

from reflux import launch, runner, scenario  # noqa: E402
from reflux.paths import every  # noqa: E402

IMAGE = board.ROOT / "build" / "stm32f405" / "reflux-stm32f405.bin"
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
            places = [self.guard.begin, CHIP_END - 4, CHIP_END, CHIP_END + 0x1234, self.guard.end - 4]
            for address in places:
                self.guard.poke(address, b"\0\0\0\0")
            self.assertEqual(self.guard.touched(), places)
            console.do("status")

    def test_the_image_ends_below_the_chip_and_the_workspace_begins_above(self) -> None:
        self.assertLessEqual(self.guard.begin, CHIP_END)
        self.assertGreaterEqual(self.guard.end, CHIP_END)

    def check_workspace(self, image: Path, at: int) -> None:
        """It lies there, and has been cleared although the memory held something."""
        size = EMULATED_END - self.guard.end
        (self.folder / "junk").write_bytes(bytes([0xA5]) * size)
        junk = ("-device", f"loader,file={self.folder / 'junk'},addr={self.guard.end:#x},force-raw=on")
        with board.start("stm32f405", *self.guard.options(), *junk, image=image) as firmware, board.console(firmware) as console:
            version = "\n".join(console.do("version"))
            self.assertIn("image whole", version)
            self.assertNotIn("last fault", version)
            self.assertEqual(self.guard.memory(self.guard.end, size), bytes(size))
            word = symbols("stm32f405")["shared"]  # firmware/base/workspace.c: a pointer to a struct that begins with the pointer
            for _ in range(2):
                word = int.from_bytes(self.guard.memory(word, 4), "little")
            self.assertEqual(word, at)

    def test_a_board_without_core_coupled_memory_takes_the_end_of_its_sram(self) -> None:
        self.check_workspace(IMAGE, self.guard.end)

    def test_a_board_that_has_it_takes_it(self) -> None:
        """The emulated board has none: in this copy of the image the end of its SRAM passes for it, and where the workspace would stand
        in there is nothing."""
        table, data = symbols("stm32f405"), bytearray(IMAGE.read_bytes()[:-4])
        words = [word for (word,) in struct.iter_unpack("<I", data)]
        for address, other in ((table["workspace_memory"], table["workspace_stand_in"]), (table["workspace_stand_in"], EMULATED_END)):
            self.assertEqual(words.count(address), 1)
            struct.pack_into("<I", data, 4 * words.index(address), other)
        image = self.folder / IMAGE.name
        image.write_bytes(data + zlib.crc32(data).to_bytes(4, "little"))
        self.check_workspace(image, self.guard.end)

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
            print(f"guard over free SRAM and above: untouched after {name}, {wanted.duration_s:g} s of plant time")


if __name__ == "__main__":
    if sys.argv[1:] == ["all"]:
        LONGEST = [path.stem for path in every(SCENARIOS, "*.toml") if scenario.load(path).wiring is None]
        del sys.argv[1:]
    unittest.main()
