"""A virtual board that a test drives: the flashed file, its console, and time that goes on only as the test says (virtual_board/control.h).

A reflux-sim at `link` has the plant's end. It asks for a step at a time, which it gets when the test waits for the board, and sends a frame
every FRAMES_APART_S of the board's time at most. So no test depends on how fast the machine is, and each run is the same.
"""

from __future__ import annotations

import contextlib
import re
import socket
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True

from reflux import build  # noqa: E402

STEP_S = 0.05
ERASED_S = 4.0  # a start on an empty flash has erased it by then
FRAMES_APART_S = 0.1
FRAME_MOST = 16384
FLOW = b"\x11\x13"  # XON and XOFF, which the virtual line obeys
PATIENCE_S = 600.0  # stops what hangs, on however busy a machine


class Ended(Exception):
    """The board has ended: by a verdict, or because it was misused."""


def whole(line: socket.socket, n: int) -> bytes:
    """So many bytes from the line."""
    block = b""
    while len(block) < n:
        more = line.recv(n - len(block))
        if not more:
            raise ConnectionError("the other end has gone")
        block += more
    return block


class VirtualBoard:
    """image: a file, or preset of a build tree. options: further ones of reflux-board."""

    def __init__(self, image: str | Path, *options: str) -> None:
        self.folder = tempfile.TemporaryDirectory(prefix="reflux-")
        path = Path(self.folder.name) / "control"
        self.process = subprocess.Popen([str(build.find_program("host", "reflux-board")), "--image",
                                         str(build.find_image(image) if isinstance(image, str) else image), "--control", str(path), *options],
                                        stderr=subprocess.PIPE, text=True)
        self.now_s = 0.0
        self.text = ""
        self.typed, self.linked, self.faults = b"", b"", b""
        self.plant: socket.socket | None = None
        self.asked: tuple[int, bytes, bytes] | None = None  # a step that the plant waits for: time, bytes, faults
        self.heard, self.due_s = b"", 0.0  # what the plant has not been given yet, and when its next frame may come
        self.link = f"board:{self.folder.name}/plant"
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(f"{self.folder.name}/plant")
        self.listener.listen()
        self.listener.settimeout(PATIENCE_S)
        self.control = socket.socket(socket.AF_UNIX)
        end = time.monotonic() + PATIENCE_S
        while self.control.connect_ex(str(path)) != 0:
            if self.process.poll() is not None or time.monotonic() > end:
                raise Ended(self.close())
            time.sleep(0.01)

    def __enter__(self) -> "VirtualBoard":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> str:
        """Ends the board; returns what it said on stderr."""
        for line in (self.control, self.listener, self.plant):
            if line is not None:
                line.close()
        if self.process.stderr is None or self.process.stderr.closed:
            return ""
        said = self.process.communicate(timeout=PATIENCE_S)[1].strip()
        self.folder.cleanup()
        return said

    def meet_plant(self) -> None:
        """The plant that has been started at `link` is there from now on."""
        self.plant = self.listener.accept()[0]

    def step(self, seconds: float = STEP_S, console: bytes = b"") -> None:
        """Runs the board, until the time at most, or until what left has left. A plant says for how long."""
        wanted = self._plant_wants()
        ns, link, faults = wanted or (round(seconds * 1e9), b"", b"")
        self.typed += console
        console, self.typed = self.typed[:FRAME_MOST], self.typed[FRAME_MOST:]
        link, self.linked = self.linked + link, b""
        faults, self.faults = self.faults + faults, b""
        self.control.sendall(struct.pack("<QHHH", ns, len(console), len(link), len(faults)) + console + link + faults)
        ns, n_console, n_link, state, clock_ns, n_loads = struct.unpack("<QHHBQB", self._whole(22))
        self.now_s = ns / 1e9
        self.text += self._whole(n_console).translate(None, FLOW).decode("latin-1").replace("\r", "")
        self.heard = (self.heard if self.plant else b"") + self._whole(n_link)
        self._whole(8 * n_loads)  # nothing is wired to this board's pins
        if wanted is not None:
            self.due_s = self.now_s + FRAMES_APART_S if wanted[1] else self.due_s
            with contextlib.suppress(ConnectionError):  # it has gone meanwhile
                self.plant.sendall(struct.pack("<QHHBQB", ns, 0, len(self.heard), state, clock_ns, 0) + self.heard)
            self.asked, self.heard = None, b""
        if state != 0:
            raise Ended(self.close())

    def _plant_wants(self) -> tuple[int, bytes, bytes] | None:
        """The plant's step. None: it is too early for its frame, no plant is there, or it has gone."""
        if self.plant is not None and self.asked is None:
            try:
                ns, _, n_link, n_faults = struct.unpack("<QHHH", whole(self.plant, 14))
                self.asked = ns, whole(self.plant, n_link), whole(self.plant, n_faults)
            except ConnectionError:
                self.plant.close()
                self.plant = None
        return None if self.asked is not None and self.asked[1] and self.now_s < self.due_s else self.asked

    def _whole(self, n: int) -> bytes:
        try:
            return whole(self.control, n)
        except ConnectionError:
            raise Ended(self.close()) from None

    def erase(self) -> None:
        """Runs a new board until its flash has been erased: meanwhile bytes from the console are lost, and samples wait."""
        while self.now_s < ERASED_S:
            self.step()

    def write(self, data: bytes) -> None:
        """Bytes for the console: they leave with the next step."""
        self.typed += data

    def write_link(self, data: bytes) -> None:
        """Bytes for the plant link, likewise."""
        self.linked += data

    def read(self, seconds: float) -> bytes:
        """What the console says next, within that time of the board; nothing: it was silent."""
        end = self.now_s + seconds
        while not self.text and self.now_s < end:
            self.step()
        said, self.text = self.text, ""
        return said.encode("latin-1")

    def fault(self, name: str, value: float) -> None:
        """A fault of the hardware (virtual_board/fault_table.h) that comes with the next step."""
        self.faults += f"{name} {value:.17g}\n".encode()

    def until(self, pattern: str, seconds: float = 20.0) -> str:
        """Runs until the console has said something that matches; returns what was said up to there, and forgets it."""
        end = self.now_s + seconds
        while (found := re.search(pattern, self.text, re.MULTILINE)) is None:
            if self.now_s > end:
                raise AssertionError(f"no {pattern!r} within {seconds:g} s of the board; it said {self.text!r}")
            self.step()
        said, self.text = self.text[:found.end()], self.text[found.end():]
        return said

    def ask(self, command: str, seconds: float = 60.0) -> str:
        """The reply to a command: its text, then `ok` or `err ...`."""
        self.text = ""
        self.step(console=command.encode() + b"\r")
        return self.until(r"^(ok|err .*)\n", seconds)

    def do(self, command: str, seconds: float = 60.0) -> str:
        """The reply to a command that must succeed."""
        reply = self.ask(command, seconds)
        if not reply.endswith("ok\n"):
            raise AssertionError(f"{command}: {reply}")
        return reply

    def boot(self) -> str:
        """Runs until the firmware listens in machine mode; returns what `version` says."""
        self.until(r"STARTED.*\n")
        self.do("mode machine")
        return self.do("version")
