#!/usr/bin/python3
"""The checksum of the image: right in what was built, and one bit of the flash that has changed since is noticed.

    test_damaged_image.py [IMAGE]      IMAGE: build/stm32f405/reflux-stm32f405.bin by default
"""

import re
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402

IMAGE = board.ROOT / "build" / "stm32f405" / "reflux-stm32f405.bin"
TEXT = b"firmware, board, limits"  # of the help: a bit of it does nobody any harm


class DamagedImageTest(unittest.TestCase):
    KIND = "stm32f405"

    def answers(self, image: Path, *commands: str) -> list[str]:
        """Answers of the console of a board with that image."""
        with board.start(self.KIND, image=image) as firmware, board.console(firmware) as console:
            return ["\n".join(console.do(command)) for command in commands]

    def test_the_image_as_built_is_whole_and_says_its_checksum(self) -> None:
        data = IMAGE.read_bytes()
        self.assertEqual(zlib.crc32(data[:-4]).to_bytes(4, "little"), data[-4:])
        version, status = self.answers(IMAGE, "version", "status")
        print(re.search("image .*", version)[0])
        self.assertIn(f"image whole crc {zlib.crc32(data[:-4]):08x} bytes {len(data)}", version.lower())
        self.assertNotIn("not the one that was built", status)

    def test_one_bit_that_has_changed_is_noticed(self) -> None:
        data = bytearray(IMAGE.read_bytes())
        self.assertEqual(data.count(TEXT), 1)
        data[data.index(TEXT)] ^= 0x01
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            damaged = Path(folder) / IMAGE.name
            damaged.write_bytes(data)
            version, status, events = self.answers(damaged, "version", "status", "events")
        self.assertIn("image DAMAGED", version)
        self.assertIn("firmware is not the one that was built", status)
        self.assertIn("alarm IMAGE_DAMAGED", events)


class OnTheVirtualBoard(DamagedImageTest):
    KIND = "board-stm32f405"


if __name__ == "__main__":
    if len(sys.argv) > 1 and not sys.argv[1].startswith("-"):
        IMAGE = Path(sys.argv.pop(1)).resolve()
    unittest.main()
