"""A painted guard over the memory of the emulated board that nothing owns.

The STM32F405 has 128 KiB of SRAM at 0x20000000 and nothing behind: there an overrun is a fault. The emulated board goes
on for 64 KiB, where it would pass unseen. At their end the workspace stands in for the chip's core-coupled memory
(hal/stm32f405/workspace.c). So all from the image's last variable to that workspace is painted before the start and looked at
in the end, from outside, while the processor goes on. Behind the workspace the emulated board has no memory either.
"""

from __future__ import annotations

import json
import socket
import struct
from pathlib import Path

from dev.elf_image import tool
from reflux.paths import build_dir

CHIP_END = 0x20000000 + 128 * 1024
EMULATED_END = 0x20000000 + 192 * 1024


def symbols(preset: str) -> dict[str, int]:
    """Addresses of the image of that preset."""
    rows = (line.split() for line in tool("nm", str(build_dir(preset) / "reflux-stm32f405.elf")).splitlines())
    return {name: int(address, 16) for address, _, name in rows}


def paint(size: int) -> bytes:
    """No two words alike, and none that a program is likely to write."""
    return b"".join(struct.pack("<I", 0xA5000000 ^ (at * 2654435761 & 0xFFFFFF)) for at in range(size // 4))


class Guard:
    def __init__(self, folder: Path, preset: str = "stm32f405") -> None:
        self.folder = folder
        image = symbols(preset)
        self.begin, self.end = image["bss_end"], image["workspace_stand_in"]
        (folder / "paint").write_bytes(paint(self.end - self.begin))

    def options(self) -> tuple[str, ...]:
        """For the emulator."""
        return ("-device", f"loader,file={self.folder / 'paint'},addr={self.begin:#x},force-raw=on",
                "-qmp", f"unix:{self.folder / 'qmp'},server=on,wait=off",
                "-chardev", f"socket,id=poke,path={self.folder / 'poke'},server=on,wait=off", "-gdb", "chardev:poke")

    def touched(self) -> list[int]:
        """Addresses of words that are not as they were painted; the emulator is still there."""
        found = self.memory(self.begin, self.end - self.begin)
        words = zip(struct.iter_unpack("<I", found), struct.iter_unpack("<I", paint(self.end - self.begin)), strict=True)
        return [self.begin + 4 * n for n, (now, before) in enumerate(words) if now != before]

    def memory(self, address: int, size: int) -> bytes:
        """What lies there now."""
        found = self.folder / "found"
        with socket.socket(socket.AF_UNIX) as line:
            line.connect(str(self.folder / "qmp"))
            with line.makefile("rw", encoding="utf-8") as qmp:
                answer(qmp, "QMP", None)
                answer(qmp, "return", {"execute": "qmp_capabilities"})
                answer(qmp, "return", {"execute": "pmemsave", "arguments": {
                    "val": address, "size": size, "filename": str(found)}})
        return found.read_bytes()

    def poke(self, address: int, data: bytes) -> None:
        """Writes as a program would, through the debugger's port, and lets the processor go on."""
        with socket.socket(socket.AF_UNIX) as line:
            line.settimeout(60)
            line.connect(str(self.folder / "poke"))
            for packet in (f"M{address:x},{len(data):x}:{data.hex()}", "D"):
                line.sendall(f"${packet}#{sum(packet.encode()) % 256:02x}".encode())
                heard = b""
                while b"$OK#9a" not in heard:
                    more = line.recv(4096)
                    if not more:
                        raise ConnectionError("the debugger's port was closed")
                    heard += more
                line.sendall(b"+")


def answer(qmp, kind: str, command: object) -> object:
    """Answer of the emulator, events left out."""
    if command is not None:
        qmp.write(json.dumps(command) + "\n")
        qmp.flush()
    for line in qmp:
        said = json.loads(line)
        if "error" in said:
            raise AssertionError(f"{command}: {said['error']['desc']}")
        if kind in said:
            return said[kind]
    raise ConnectionError("the emulator closed its monitor")
