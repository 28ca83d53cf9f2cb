"""tools/flash with programs that only pretend to have a board: their flash is a file."""

import os
import struct
import sys
import unittest
import zlib
from pathlib import Path
from unittest import mock

from support import FolderTest, call

from reflux import option_bytes

FAKE = """#!{python}
import os, re, sys
here = {folder!r}
flash = os.path.join(here, "flash.bin")
with open(os.path.join(here, "calls.txt"), "a") as log:
    log.write({name!r} + " " + " ".join(sys.argv[1:]) + "\\n")
a = sys.argv[1:]
def store(path):
    data = open(path, "rb").read()
    if os.environ.get("FAKE_DAMAGE"):
        data = data[:600] + bytes([data[600] ^ 1]) + data[601:]
    open(flash, "wb").write(data)
options = os.path.join(here, "options.txt")
def have_options():
    return int(open(options).read(), 0) if os.path.exists(options) else 0x0FFFAAED
def closed():
    return ~have_options() >> 16 & 0xFFF & 1 and a[-3:-2] == ["write"]
def fetch(path, size):
    assert not os.path.exists(path)
    open(path, "wb").write(open(flash, "rb").read()[:size])
{body}
"""
BODIES = {
    "st-info": 'print(os.environ.get("FAKE_STLINK", "Found 0 stlink programmers"))',
    "st-flash": """
if os.environ.get("FAKE_STLINK_FAILS"):
    print("2026 ERROR common.c: Failed to connect to target"); sys.exit(1)
k = next((k for k, x in enumerate(a) if x in ("write", "read", "reset")))
if "--area=option" in a:
    if a[k] == "write": open(options, "w").write(a[k + 1])
    else: print("st-flash 1.7.0", "%08x" % have_options(), sep=chr(10))
    sys.exit(0)
if closed(): print("ERROR: write protected"); sys.exit(1 if a[k] == "write" else 0)
if a[k] == "write": store(a[k + 1])
if a[k] == "read": fetch(a[k + 1], int(a[k + 3]))
""",
    "dfu-util": """
if a == ["-l"]:
    print("dfu-util 0.11\\n" + os.environ.get("FAKE_DFU", "")); sys.exit(0)
if "-D" in a: store(a[a.index("-D") + 1])
if "-U" in a: fetch(a[a.index("-U") + 1], int(a[a.index("-s") + 1].split(":")[1]))
""",
    "openocd": """
if not os.environ.get("FAKE_OPENOCD"):
    print("Error: open failed"); sys.exit(1)
print("Info : Target voltage: 3.24")
for c in a:
    w = re.findall(r"{{[^}}]*}}|\\S+", c)  # Tcl's words
    if w[:1] == ["flash"]: store(w[3].strip("{{}}"))
    if w[:1] == ["mdw"]: print("0x40023c14: %08x" % have_options())
    if w[:2] == ["mww", "0x40023c14"] and int(w[2], 0) & 2: open(options, "w").write(hex(int(w[2], 0) & ~2 | 1))
    if w[:1] == ["dump_image"]: fetch(w[1].strip("{{}}"), int(w[3]))
""".replace("{{", "{").replace("}}", "}"),
}
STLINK = "Found 1 stlink programmers\n  version:    V2J37S7\n  serial:     066DFF48\n  chipid:     0x0413\n"
DFU = ('Found DFU: [0483:df11] ver=2200, devnum=9, cfg=1, intf=0, path="1-1", alt=0, '
       'name="@Internal Flash  /0x08000000/04*016Kg", serial="3573"')


class FlashTest(FolderTest):
    def setUp(self) -> None:
        super().setUp()
        self.programs = self.folder / "bin"
        self.programs.mkdir()
        for name in BODIES:
            self.install(name)
        self.image = self.folder / "image.bin"
        body = struct.pack("<II", 0x20002000, 0x08000201) + os.urandom(4996)
        self.image.write_bytes(body + zlib.crc32(body).to_bytes(4, "little"))
        clean = {k: v for k, v in os.environ.items() if not k.startswith("FAKE_")}
        self.enterContext(mock.patch.dict(os.environ, {**clean, "PATH": str(self.programs)}, clear=True))

    def install(self, name: str) -> None:
        path = self.programs / name
        path.write_text(FAKE.format(python=sys.executable, folder=str(self.folder), name=name, body=BODIES[name]))
        path.chmod(0o755)

    def flash(self, *arguments: str, **environment: str) -> tuple[int, str, str]:
        with mock.patch.dict(os.environ, environment):
            return call("flash", "--image", str(self.image), *arguments)

    def calls(self) -> str:
        path = self.folder / "calls.txt"
        return path.read_text() if path.exists() else ""

    def flashed(self) -> bytes | None:
        path = self.folder / "flash.bin"
        return path.read_bytes() if path.exists() else None

    def test_each_way_writes_reads_back_and_starts(self) -> None:
        for name, environment, last in (("st-flash", {"FAKE_STLINK": STLINK}, "reset"),
                                        ("dfu", {"FAKE_DFU": DFU}, ":leave -U"),
                                        ("openocd", {"FAKE_OPENOCD": "1"}, "reset run")):
            with self.subTest(name):
                (self.folder / "flash.bin").unlink(missing_ok=True)
                status, out, err = self.flash("--yes", **environment)  # found by itself
                self.assertEqual((status, err), (0, ""), out)
                self.assertEqual(self.flashed(), self.image.read_bytes())
                self.assertIn("5008 bytes written", out)
                self.assertIn(last, self.calls().splitlines()[-1])

    def test_dry_run_without_a_board_says_what_is_missing_and_what_it_would_do(self) -> None:
        status, out, _ = self.flash("--dry-run")
        self.assertEqual(status, 0)
        self.assertIn("no board: ", out)
        self.assertIn("write: st-flash", out)
        self.assertIn("nothing written", out)

    def test_dry_run_only_says_what_it_would_do(self) -> None:
        status, out, _ = self.flash("--dry-run", FAKE_STLINK=STLINK)
        self.assertEqual(status, 0)
        self.assertIn("st-flash --connect-under-reset --serial 066DFF48 write", out)
        self.assertIn("nothing written", out)
        self.assertEqual(self.calls().splitlines(), ["st-info --probe"])

    def test_it_asks_and_does_not_write_without_an_answer(self) -> None:
        with mock.patch("sys.stdin") as stdin:
            stdin.isatty.return_value = False
            status, _, err = self.flash(FAKE_STLINK=STLINK)
            self.assertEqual(status, 2)
            self.assertIn("--yes", err)
            stdin.isatty.return_value = True
            with mock.patch("builtins.input", return_value="n"):
                status, out, _ = self.flash(FAKE_STLINK=STLINK)
            self.assertEqual((status, out.splitlines()[-1]), (1, "nothing written"))
            self.assertIsNone(self.flashed())
            with mock.patch("builtins.input", return_value="y"):
                self.assertEqual(self.flash(FAKE_STLINK=STLINK)[0], 0)
        self.assertEqual(self.flashed(), self.image.read_bytes())

    def test_damage_is_seen_and_the_board_not_started(self) -> None:
        status, _, err = self.flash("--yes", FAKE_STLINK=STLINK, FAKE_DAMAGE="1")
        self.assertEqual(status, 1)
        self.assertIn("differs from the image at 0x08000258", err)
        self.assertNotIn("reset\n", self.calls())

    def test_nothing_connected_and_programs_missing(self) -> None:
        status, _, err = self.flash("--yes")
        self.assertEqual((status, err.count("\n")), (1, 1))
        self.assertIn("nothing connected: st-flash, dfu, openocd found no board", err)
        (self.programs / "st-info").unlink()
        self.assertIn("because missing: st-info (package stlink-tools)", self.flash("--yes")[2])
        self.assertIn("st-info (package stlink-tools) missing", self.flash("--probe", "st-flash")[2])
        for name in ("dfu-util", "openocd"):
            (self.programs / name).unlink()
        self.assertIn("no program to write with", self.flash("--yes")[2])

    def test_wrong_chip_two_boards_and_a_failing_program(self) -> None:
        self.assertIn("its chip is unknown (0x414)", self.flash(FAKE_STLINK=STLINK.replace("0413", "0414"))[2])
        two = STLINK + STLINK.replace("066DFF48", "0777")
        status, _, err = self.flash(FAKE_STLINK=two)
        self.assertEqual(status, 2)
        self.assertIn("066DFF48, 0777; choose one with --serial", err)
        self.assertEqual(self.flash("--yes", "--serial", "0777", FAKE_STLINK=two)[0], 0)
        status, _, err = self.flash("--yes", FAKE_STLINK=STLINK, FAKE_STLINK_FAILS="1")
        self.assertEqual(status, 1)
        self.assertIn("Failed to connect to target", err)

    def options(self) -> int:
        return int((self.folder / "options.txt").read_text(), 0)

    def test_protect_says_what_it_changes_asks_and_reads_back(self) -> None:
        for environment in ({"FAKE_STLINK": STLINK}, {"FAKE_OPENOCD": "1"}):
            with self.subTest(str(environment)):
                (self.folder / "options.txt").write_text("0x0fffaaed")
                with mock.patch("sys.stdin") as stdin, mock.patch("builtins.input", return_value="n"):
                    stdin.isatty.return_value = True
                    status, out, _ = self.flash("--protect", **environment)
                self.assertEqual((status, self.options()), (1, 0x0FFFAAED))
                self.assertIn("now: brown-out reset OFF, watchdog only from start-up on, write-protected sectors: none", out)
                self.assertIn("it will set: brown-out reset level 3, watchdog from reset on, write-protected sectors: 0\n", out)
                status, out, err = self.flash("--protect", "--yes", **environment)
                self.assertEqual((status, err), (0, ""))
                self.assertEqual(self.options() & 0x0FFFFFEC, 0x0FFEAAC0)
                self.assertIn("read back equal", out)
                self.assertIn("nothing to change", self.flash("--protect", "--yes", **environment)[1])
                self.assertEqual(self.flash("--unprotect", "--yes", **environment)[0], 0)
                self.assertEqual(self.options() & 0x0FFFFFEC, 0x0FFFAAC0)
        self.assertIsNone(self.flashed())

    def test_a_protected_board_is_opened_written_and_closed_again(self) -> None:
        (self.folder / "options.txt").write_text("0x0ffeaac1")
        status, out, err = self.flash("--yes", FAKE_STLINK=STLINK)
        self.assertEqual((status, err), (0, ""), out)
        self.assertIn("write protection lifted for now: sectors 0\n", out)
        self.assertIn("write protection set again: sectors 0\n", out)
        self.assertEqual((self.options(), self.flashed()), (0x0FFEAAC1, self.image.read_bytes()))
        status, _, err = self.flash("--yes", FAKE_STLINK=STLINK, FAKE_DAMAGE="1")  # closed again after a failure, too
        self.assertEqual((status, self.options()), (1, 0x0FFEAAC1), err)

    def test_a_board_that_is_read_protected_or_on_a_boot_loader_is_refused(self) -> None:
        (self.folder / "options.txt").write_text("0x0fff55ed")
        status, _, err = self.flash("--protect", "--yes", FAKE_STLINK=STLINK)
        self.assertEqual((status, self.options()), (2, 0x0FFF55ED))
        self.assertIn("read-protected", err)
        status, _, err = self.flash("--protect", "--yes", FAKE_DFU=DFU)
        self.assertEqual(status, 2)
        self.assertIn("dfu cannot set option bytes: connect an ST-Link", err)
        status, out, _ = self.flash("--protect", "--dry-run", FAKE_STLINK=STLINK)
        self.assertEqual(status, 0)
        self.assertIn("write protection of sectors 0\nnothing written", out)

    def test_sectors_of_an_image(self) -> None:
        for size, sectors in ((1, 0x1), (16384, 0x1), (16385, 0x3), (131072, 0x1F), (131073, 0x3F), (536576, 0x1FF), (786432, 0x3FF)):
            self.assertEqual(option_bytes.sectors_of(size), sectors)

    def test_files_that_are_no_images(self) -> None:
        for data, expected in ((b"\x7fELF" + bytes(2000), "use the .bin file"), (b"", "0 bytes"),
                               (bytes(800 * 1024), "an image has 512 to 786432")):
            self.image.write_bytes(data)
            status, _, err = self.flash("--yes", FAKE_STLINK=STLINK)
            self.assertEqual(status, 2)
            self.assertIn(expected, err)
        self.assertEqual(self.calls(), "")  # not even a look for a board

    def test_an_image_whose_file_is_damaged_is_not_written(self) -> None:
        data = bytearray(self.image.read_bytes())
        data[1234] ^= 0x10
        self.image.write_bytes(data)
        status, _, err = self.flash("--yes", FAKE_STLINK=STLINK)
        self.assertEqual((status, self.calls()), (2, ""))
        self.assertIn("does not end with the checksum", err)

    def test_a_file_that_is_not_there(self) -> None:
        self.image = Path("/nowhere/image.bin")
        self.assertIn("No such file", self.flash()[2])


if __name__ == "__main__":
    unittest.main()
