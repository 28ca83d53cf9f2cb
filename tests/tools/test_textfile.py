"""Text files that people give to the tools: byte order marks and encodings."""

import unittest
from pathlib import Path

from support import FolderTest

from reflux_tools import textfile
from reflux_tools.errors import UserError


class TextFile(FolderTest):
    def bytes(self, data: bytes) -> Path:
        path = self.folder / "file"
        path.write_bytes(data)
        return path

    def test_a_byte_order_mark_is_skipped(self) -> None:
        self.assertEqual(textfile.read(self.bytes(b"\xef\xbb\xbfa = 1\r\nb = 2\r\n")), "a = 1\nb = 2\n")

    def test_utf16_is_refused_with_the_way_to_convert_it(self) -> None:
        for encoding in ("utf-16-le", "utf-16-be"):
            for mark in ("\ufeff", ""):
                with self.subTest(encoding=encoding, mark=bool(mark)), self.assertRaisesRegex(UserError, "UTF-16.*iconv"):
                    textfile.read(self.bytes((mark + "a = 1\n").encode(encoding)))

    def test_a_byte_that_is_not_utf8_is_named_with_its_line(self) -> None:
        with self.assertRaisesRegex(UserError, r"file:2: byte 0xB0 is not UTF-8"):
            textfile.read(self.bytes("a\n50 °C\n".encode("latin-1")))

    def test_a_damaged_transcript_is_read_all_the_same(self) -> None:
        self.assertEqual(textfile.read(self.bytes(b"ok\n\xb0\0\n"), damaged=True), "ok\n\ufffd\0\n")

    def test_a_file_that_is_not_there_is_named(self) -> None:
        with self.assertRaisesRegex(UserError, "none: cannot be read: No such file"):
            textfile.read(self.folder / "none")

    def test_json_that_does_not_parse_is_refused_with_its_place(self) -> None:
        with self.assertRaisesRegex(UserError, "not JSON.*line 2"):
            textfile.read_json(self.bytes(b"{\n1}"))


if __name__ == "__main__":
    unittest.main()
