"""A virtual board that a test drives: the flashed file, its console, and time that goes on only as the test says (virtual_board/control.h)."""

from __future__ import annotations

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
PATIENCE_S = 60.0  # on this machine, until the program listens


class Ended(Exception):
    """The board has ended: by a verdict, or because it was misused."""


class VirtualBoard:
    """image: preset of a build tree. options: further ones of reflux-board."""

    def __init__(self, image: str, *options: str) -> None:
        self.folder = tempfile.TemporaryDirectory(prefix="reflux-")
        path = Path(self.folder.name) / "control"
        self.process = subprocess.Popen([str(build.find_program("host", "reflux-board")), "--image", str(build.find_image(image)),
                                         "--control", str(path), *options], stderr=subprocess.PIPE, text=True)
        self.now_s = 0.0
        self.text = ""
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
        self.control.close()
        if self.process.stderr is None or self.process.stderr.closed:
            return ""
        said = self.process.communicate(timeout=PATIENCE_S)[1].strip()
        self.folder.cleanup()
        return said

    def step(self, seconds: float = STEP_S, console: bytes = b"") -> None:
        """Runs the board, until the time at most, or until what left has left."""
        self.control.sendall(struct.pack("<QHHH", round(seconds * 1e9), len(console), 0, 0) + console)
        ns, n_console, n_link, state = struct.unpack("<QHHB", self._whole(13))
        self.now_s = ns / 1e9
        self.text += self._whole(n_console).decode("latin-1").replace("\r", "")
        self._whole(n_link)
        if state != 0:
            raise Ended(self.close())

    def _whole(self, n: int) -> bytes:
        block = b""
        while len(block) < n:
            more = self.control.recv(n - len(block))
            if not more:
                raise Ended(self.close())
            block += more
        return block

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
