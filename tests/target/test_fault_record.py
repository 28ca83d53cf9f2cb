#!/usr/bin/python3
"""Record of a fault: the debugger's port of the emulator, or a fault of the virtual board, sends the processor into nowhere, and after
the restart the console tells where that was.

    test_fault_record.py [IMAGE]      IMAGE: build/stm32f405/reflux-stm32f405.bin by default
"""

import contextlib
import re
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402

IMAGE = board.ROOT / "build" / "stm32f405" / "reflux-stm32f405.bin"
FLASH = 0x08000000
NOWHERE = 0xA0000000  # no memory, and not executable


class Debugger:
    """As much of the remote protocol of gdb as this needs."""

    def __init__(self, path: str) -> None:
        self.socket = board.connect(path)
        self.socket.settimeout(board.PATIENCE_S)
        self.text = b""

    def send(self, packet: str) -> None:
        total = sum(packet.encode()) % 256
        self.socket.sendall(f"${packet}#{total:02x}".encode())

    def reply(self) -> str:
        while not (found := re.search(rb"\$([^#]*)#..", self.text)):
            self.text += self.socket.recv(4096)
        self.text = self.text[found.end():]
        self.socket.sendall(b"+")
        return found[1].decode("latin-1")

    def jump(self, address: int, r0: int | None = None) -> None:
        """Stops the processor, mostly in the main loop, now and then in a tick or an interrupt, and lets it go on at address."""
        for question in ("?", "qXfer:features:read:target.xml:0,ffb"):  # single registers only go with the second
            self.send(question)
            self.reply()
        for register, value in (("0", r0), ("f", address)):
            if value is None:
                continue
            self.send(f"P{register}=" + value.to_bytes(4, "little").hex())
            # The stop itself may have been told once more in between.
            if "OK" not in (self.reply() for _ in range(4)):
                raise AssertionError("the debugger's port did not take a register")
        self.send("c")

    def close(self) -> None:
        self.socket.close()


class FaultRecordTest(unittest.TestCase):
    KIND = "stm32f405"

    def setUp(self) -> None:
        self.firmware = self.enterContext(board.start(self.KIND, *self.options(), image=IMAGE))
        self.console = self.enterContext(board.console(self.firmware))

    def options(self) -> list[str]:
        self.debugger_path = str(Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-"))) / "debugger")
        return ["-chardev", f"socket,id=gdb,path={self.debugger_path},server=on,wait=off", "-gdb", "chardev:gdb"]

    def jump(self, address: int, r0: int | None) -> None:
        with contextlib.closing(Debugger(self.debugger_path)) as debugger:
            debugger.jump(address, r0)

    def version(self) -> str:
        return "\n".join(self.console.do("version"))

    def crash(self, address: int = NOWHERE, r0: int | None = None) -> None:
        self.jump(address, r0)
        self.console.until(lambda line: "STARTED" in line and "fault" in line)
        self.console.machine_mode()

    def test_cause_place_and_context_of_a_fault_are_told_after_the_restart(self) -> None:
        self.assertNotIn("last fault", self.version())
        self.crash()
        version = self.version()
        print(version)
        self.assertIn("started by: fault", version)
        fault = re.search(r"last fault: (\w+) in .*, pc (\w{8}) lr (\w{8}) cfsr (\w{8}) .* boots_ago (\d+)", version)
        self.assertIsNotNone(fault, version)
        self.assertIn(fault[1], ("bus", "memory", "hard"))
        self.assertEqual(int(fault[2], 16) & ~1, NOWHERE)
        self.assertIn(int(fault[3], 16) >> 24, (0x08, 0xFF))  # somebody in the flash had called, or it was an interrupt
        self.assertNotEqual(int(fault[4], 16), 0)
        self.assertEqual(fault[5], "1")
        self.assertTrue(self.console.do("status")[0].startswith("state safe"))
        # The record stays, and says how long ago it was.
        self.console.write("reboot\n")
        self.console.until(lambda line: line == "ok")
        self.console.until(lambda line: "STARTED" in line and "requested" in line)
        self.console.machine_mode()
        version = self.version()
        self.assertIn("started by: requested", version)
        self.assertIn("boots_ago 2", version)

    def test_a_null_pointer_is_a_fault_although_the_flash_lies_there(self) -> None:
        image = IMAGE.read_bytes()
        load, store = (next(k for k in range(0x400, len(image), 2) if image[k:k + 2] == code.to_bytes(2, "little"))
                       for code in (0x6800, 0x6000))  # ldr r0, [r0] and str r0, [r0], wherever there is one
        for what, address, r0, status, reached in (("a read", FLASH + load, 0x10, 0x82, 0x10),
                                                   ("a write", FLASH + store, 0x0, 0x82, 0x0),
                                                   ("a call", 0x100, None, 0x01, None)):
            with self.subTest(what):
                self.crash(address, r0)
                version = self.version()
                fault = re.search(r"last fault: (\w+) in .* cfsr (\w{8}) .* address (\w{8})", version)
                self.assertIsNotNone(fault, version)
                self.assertIn(fault[1], ("memory", "hard"))  # hard where interrupts were held off just then
                self.assertEqual(int(fault[2], 16), status)
                if reached is not None:
                    self.assertEqual(int(fault[3], 16), reached)

    def test_faults_in_a_row_soon_after_the_start_are_counted_until_somebody_reboots(self) -> None:
        for n in (1, 2, 3):
            self.crash()
            self.assertIn(f"early_resets {n}", self.version())
        self.console.write("reboot\n")
        self.console.until(lambda line: "STARTED" in line and "requested" in line)
        self.console.machine_mode()
        self.assertNotIn("early_resets", self.version())


class OnTheVirtualBoard(FaultRecordTest):
    KIND = "board-stm32f405"

    def options(self) -> list[str]:
        return []

    def jump(self, address: int, r0: int | None) -> None:
        if r0 is not None:
            self.firmware.fault("set_r0", r0)
        self.firmware.fault("jump", address)


if __name__ == "__main__":
    if len(sys.argv) > 1 and not sys.argv[1].startswith("-"):
        IMAGE = Path(sys.argv.pop(1)).resolve()
    unittest.main()
