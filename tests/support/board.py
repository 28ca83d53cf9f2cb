"""A firmware for end-to-end tests: started as a host process, in the emulator or on the virtual board, with a console to talk to.

The board kinds are those of tools/run: host, host-fixed, stm32f405, board-stm32f405 and so on. Nothing is built here.
"""

from __future__ import annotations

import contextlib
import re
import select
import signal
import socket
import subprocess
import sys
import time
import unittest
from pathlib import Path
from typing import Iterator

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True

from reflux import build, launch  # noqa: E402
from virtual_board import VirtualBoard  # noqa: E402

PATIENCE_S = 600.0  # stops what hangs, on however busy a machine; nothing here measures time

# A shell starts a background job with SIGINT ignored, and a child inherits that: the tools under test would not hear Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)

ON_BOARD = "board-"
PROMPT = re.compile(r"^(?:> |\r|\x1b\[K)+")


class SocketPort:
    """The console of a process, in the time on the wall. A VirtualBoard has the same functions in a time of its own."""

    def __init__(self, where: str) -> None:
        self.socket = connect(where)
        self.write, self.close = self.socket.sendall, self.socket.close

    @property
    def now_s(self) -> float:
        return time.monotonic()

    def read(self, seconds: float) -> bytes:
        """What there is within that time; nothing: it was silent."""
        if not select.select([self.socket], [], [], seconds)[0]:
            return b""
        data = self.socket.recv(65536)
        if not data:
            raise ConnectionError("the console was closed")
        return data


class Console:
    """The firmware's console in machine mode."""

    def __init__(self, port: SocketPort | VirtualBoard) -> None:
        self.port = port
        self.rest = b""
        self.events: list[str] = []
        self.telemetry: list[str] = []
        self.machine_mode()

    def machine_mode(self) -> None:
        """Asks until answered: what arrives before the receiver is switched on is lost."""
        end = self.port.now_s + PATIENCE_S
        while True:
            self.write("\r\nmode machine\r\n")
            try:
                self.until(lambda line: line == "ok", 1.0)
                return
            except TimeoutError:
                if self.port.now_s > end:
                    raise

    def close(self) -> None:
        self.port.close()

    def write(self, text: str) -> None:
        self.port.write(text.encode("latin-1"))

    def line(self, patience_s: float = PATIENCE_S) -> str:
        end = self.port.now_s + patience_s
        while b"\n" not in self.rest:
            left = end - self.port.now_s
            if left <= 0:
                raise TimeoutError(f"no line from the console within {patience_s:g} s; so far {self.rest!r}")
            self.rest += self.port.read(left)
        line, self.rest = self.rest.split(b"\n", 1)
        # Before machine mode is answered, lines come with a prompt or the erasing of one.
        return PROMPT.sub("", line.decode("latin-1").strip("\r"))

    def stays_silent(self, seconds: float) -> None:
        """Nothing comes in that time: no test of a board that is slow."""
        if said := self.rest or self.port.read(seconds):
            raise AssertionError(f"the console says {said!r}")

    def until(self, wanted, patience_s: float = PATIENCE_S) -> str:
        """The next line that is wanted; asynchronous lines on the way are kept."""
        while True:
            line = self.line(patience_s)
            if line.startswith("!"):
                self.events.append(line)
            elif line.startswith(("T,", "H,")):
                self.telemetry.append(line)
            if wanted(line):
                return line

    def event(self, code: str, patience_s: float = PATIENCE_S) -> str:
        for k, line in enumerate(self.events):
            if f" {code} " in line:
                return self.events.pop(k)
        line = self.until(lambda text: text.startswith("!") and f" {code} " in text, patience_s)
        self.events.remove(line)
        return line

    def ask(self, command: str) -> list[str]:
        """The whole reply: payload lines, then `ok` or `err ...`."""
        self.write(command + "\n")
        reply: list[str] = []

        def ends(line: str) -> bool:
            if line.startswith(("!", "T,", "H,")):
                return False
            reply.append(line)
            return line == "ok" or line.startswith("err ")

        self.until(ends)
        return reply

    def samples(self, more: int = 3) -> None:
        """Waits until the plant has had so many more samples answered."""
        wanted, end = self._answered() + more, self.port.now_s + PATIENCE_S
        while self._answered() < wanted:
            if self.port.now_s > end:
                raise TimeoutError(f"the plant sent no {more} samples within {PATIENCE_S:g} s")

    def _answered(self) -> int:
        return int(" ".join(self.do("stats")).split("samples ")[1].split()[0])

    def do(self, command: str) -> list[str]:
        """Payload of a command that must succeed."""
        reply = self.ask(command)
        if reply[-1] != "ok":
            raise AssertionError(f"{command}: {reply[-1]}")
        return reply[:-1]


def connect(where: str) -> socket.socket:
    path = where.removeprefix("socket:")
    end = time.monotonic() + PATIENCE_S
    while True:
        peer = socket.socket(socket.AF_UNIX)
        try:
            peer.connect(path)
            return peer
        except OSError:
            peer.close()
            if time.monotonic() > end:
                raise
            time.sleep(0.05)


@contextlib.contextmanager
def console(firmware: launch.Firmware | VirtualBoard) -> Iterator[Console]:
    port = firmware if isinstance(firmware, VirtualBoard) else SocketPort(firmware.console)
    with contextlib.closing(Console(port)) as it:
        yield it


@contextlib.contextmanager
def start(kind: str, *options: str, image: Path | None = None) -> Iterator[launch.Firmware | VirtualBoard]:
    """options: more of the emulator or of reflux-board. image: a file in place of the one that was built."""
    if not kind.startswith(ON_BOARD):
        with launch.start(kind, extra=options, image=image) as firmware:
            yield firmware
        return
    with VirtualBoard(image or kind.removeprefix(ON_BOARD), *options) as firmware:
        firmware.erase()
        yield firmware


def simulator(firmware: launch.Firmware | VirtualBoard, *arguments: str) -> list[str]:
    """Command line of a simulator at the plant link, without console."""
    return [str(build.find_program("host", "reflux-sim")), "--port", firmware.link, "--timeout", str(PATIENCE_S), *arguments]


def plant(test: unittest.TestCase, firmware: launch.Firmware | VirtualBoard, name: str = "pilot") -> subprocess.Popen[bytes]:
    """A simulated plant at the plant link, at 300 times its own speed, until the test ends."""
    process = subprocess.Popen(simulator(firmware, "--plant", name, "--speed", "300", "--duration", "1e6"),
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    test.addCleanup(process.wait)
    test.addCleanup(process.kill)
    if isinstance(firmware, VirtualBoard):
        firmware.meet_plant()
    return process


def write_link(firmware: launch.Firmware | VirtualBoard, data: bytes) -> None:
    """Bytes for the plant link, where no plant is."""
    if isinstance(firmware, VirtualBoard):
        firmware.write_link(data)
    else:
        with contextlib.closing(connect(firmware.link)) as link:
            link.sendall(data)


def configure(console: Console, name: str = "pilot.conf") -> None:
    """Sends a file of console lines, as tools/run would."""
    for text in (ROOT / "host_sim" / "scenarios" / name).read_text().splitlines():
        if text.strip() and not text.startswith("#"):
            console.do(text)
