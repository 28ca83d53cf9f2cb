#!/usr/bin/python3
"""What must hold for the linked image: no heap, no double, no stdio streams, one file for emulator and flash."""

import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402

FORBIDDEN = {
    "heap": r"_?(malloc|calloc|realloc|free|sbrk)(_r)?$",
    "double precision": r"__aeabi_(d[a-z]|.*2d$|f2d|cd)|__(add|sub|mul|div)df3",
    "streams": r"(fopen|fread|fwrite|printf|puts|stdout|__iob)$",
    "setjmp": r"(setjmp|longjmp)$",
}


class ImageTest(unittest.TestCase):
    def image(self, preset: str, suffix: str) -> Path:
        return board.ROOT / "build" / preset / f"reflux-stm32f405{suffix}"

    def symbols(self, preset: str) -> list[str]:
        text = subprocess.run(["arm-none-eabi-nm", str(self.image(preset, ".elf"))], check=True, text=True,
                              capture_output=True).stdout
        return [line.split()[-1] for line in text.splitlines()]

    def test_nothing_forbidden_is_linked(self) -> None:
        for preset in ("stm32f405", "stm32f405-fixed"):
            symbols = self.symbols(preset)
            self.assertIn("app_tick", symbols)
            for what, pattern in FORBIDDEN.items():
                found = [name for name in symbols if re.match(pattern, name)]
                self.assertEqual(found, [], f"{preset} links {what}")

    def test_the_flashed_file_is_the_linked_image_byte_for_byte(self) -> None:
        for preset in ("stm32f405", "stm32f405-fixed"):
            with tempfile.TemporaryDirectory() as folder:
                again = Path(folder) / "again.bin"
                subprocess.run(["arm-none-eabi-objcopy", "-O", "binary", str(self.image(preset, ".elf")), str(again)],
                               check=True)
                self.assertEqual(again.read_bytes(), self.image(preset, ".bin").read_bytes())
            with board.start(preset) as firmware:  # what the emulator is given
                self.assertEqual(firmware.image, self.image(preset, ".bin"))

    def test_it_leaves_room_on_the_chip(self) -> None:
        for preset in ("stm32f405", "stm32f405-fixed"):
            text = subprocess.run(["arm-none-eabi-size", str(self.image(preset, ".elf"))], check=True, text=True,
                                  capture_output=True).stdout.splitlines()[1].split()
            code, data, zero = (int(word) for word in text[:3])
            self.assertLess(code + data, 128 * 1024, preset)
            self.assertLess(data + zero, 100 * 1024, preset)


if __name__ == "__main__":
    unittest.main()
