"""Text files that people give to the tools: byte order marks and encodings. Rebuilt from public reports of spreadsheets and editors of
other systems."""

import codecs
import subprocess
import unittest
from pathlib import Path
from typing import Any, Callable

from support import GOOD, ROOT, FolderTest

from reflux import board_model, build, cmd_console, cmd_identify, column_file, gradients, logs, plant_file, scenario, textfile
from reflux.commission import record
from reflux.errors import UserError

PLANTS = ROOT / "host_sim" / "plants"
LOG = "number,time[s],T1.true[degC],T1.meas[degC],Lr.applied[l/h]\n" + "".join(f"{k},{30 * k},{87 + k % 3},87,4.5\n" for k in range(40))
TELEMETRY = "H,1,number,time[s],T1[degC],stat.tick\nT,1,0,0.000,87.1,10\n"
PROFILE = "stage,T[K],x.a,x.b\n" + "".join(f"{k},{400 - 5 * k},{k / 10},{1 - k / 10}\n" for k in range(1, 10))
LISTING = """block1.kind = experiment
block1.loops = y1
block1.inputs = y1,u1
block1.known = on
block1.a1_1 = -0.75 -
block1.b11_1 = 0.1 -
"""


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


def simulator(*arguments: object) -> str:
    """stdout, or the last line of stderr as the tools show it."""
    done = subprocess.run([str(build.find_program("host", "reflux-sim")), *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise UserError(done.stderr.strip())
    return done.stdout


# Name and text of a file, and what reads it.
READERS: list[tuple[str, str, Callable[[Path], Any]]] = [
    ("trial.toml", GOOD, lambda path: scenario.load(path).title),
    ("lines.conf", "set meas1.name T1  # top\n", lambda path: [line.text for line in scenario.read_console_files((path,))]),
    ("commands.txt", "begin\napply\n", cmd_console.read_commands),
    ("log.csv", LOG, lambda path: logs.read_csv(path).rows),
    ("table.csv", "t,u,y\n" + "0,1,2\n" * 30, lambda path: cmd_identify.read_table(path).columns),
    ("telemetry.csv", TELEMETRY, lambda path: logs.read_telemetry(path).rows),
    ("transcript.txt", "0.000 > version\n0.000 < reflux\n0.000 < ok\n", record.replies),
    ("profile.csv", PROFILE, lambda path: gradients.read_csv(path).names),
    ("listing.txt", LISTING, lambda path: board_model.read(path, 60)[0]),
    ("pilot.json", (PLANTS / "pilot.json").read_text(encoding="utf-8"), lambda path: column_file.read(str(path)).name),
    ("wood-berry.json", (PLANTS / "wood-berry.json").read_text(encoding="utf-8"), lambda path: plant_file.load(str(path))[0]["name"]),
    ("plant.json", (PLANTS / "pilot.json").read_text(encoding="utf-8"), lambda path: simulator("--list", path)),
    ("run.script", "0 log on\nx\n", lambda path: simulator("--plant", "pilot", "--port", "x", "--console", "y", "--script", path)),
    ("table.txt", "set block1.kind nonsense\n", lambda path: simulator("--table-check", path)),
]


def outcome(read: Callable[[Path], Any], path: Path) -> Any:
    """The text that was read, or the words of the refusal."""
    try:
        return read(path)
    except UserError as error:
        return str(error)


class EveryReader(FolderTest):
    def put(self, name: str, data: bytes) -> Path:
        path = self.folder / name
        path.write_bytes(data)
        return path

    def test_each_kind_of_file_may_begin_with_a_byte_order_mark(self) -> None:
        for name, text, read in READERS:
            with self.subTest(name):
                plain = outcome(read, self.put(name, text.encode()))
                self.assertEqual(outcome(read, self.put(name, codecs.BOM_UTF8 + text.encode())), plain)

    def test_each_kind_of_file_is_refused_in_utf16_by_that_word(self) -> None:
        for name, text, read in READERS:
            with self.subTest(name), self.assertRaisesRegex(UserError, f"{name}: is UTF-16 text"):
                read(self.put(name, text.encode("utf-16")))


if __name__ == "__main__":
    unittest.main()
