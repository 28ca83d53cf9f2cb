"""The console of a virtual board (host_sim/virtual_board/control.h) behind the calls of ports.Port: its time goes on only as somebody waits for it.

What is at its pins is told in lines such as "pins.T1 35": the quantity of a sensor, or with a third name a fault of its chip.
"""

from __future__ import annotations

import concurrent.futures
import math
import re
import socket
import struct
import time

from reflux.errors import RunFailed, UserError

SCHEME = "board:"
OPENING_S = 10.0
STEP_S = 0.02
FRAME_MOST = 16384
REPLY = "<QHHBQB"
FLOW = b"\x11\x13"  # the virtual line obeys them itself
PINS = re.compile(r"pins\.\w+(\.\w+)? [-+]?\d+(\.\d*)?([eE][-+]?\d+)?")


class BoardPort:
    """where: board:PATH, the socket of reflux-board --control. in_step: the board waits for the clock on the wall, because a person looks on."""

    def __init__(self, where: str, in_step: bool) -> None:
        self.name, self.in_step = where, in_step
        self._typed, self._pins, self._came = b"", b"", b""
        self._ns = 0
        self._peer = _connect(where.removeprefix(SCHEME))
        self._ahead = time.monotonic()
        self._worker = concurrent.futures.ThreadPoolExecutor(1)
        self._running: concurrent.futures.Future[bool] | None = None

    def now(self) -> float:
        """Time of the board, s."""
        return self._ns / 1e9

    def read(self, patience_s: float = 0.0) -> bytes:
        """Bytes that have come, at once or within this time of the board; b"" for none."""
        self._finish()
        end = self._ns + math.ceil(max(0.0, patience_s) * 1e6) * 1000  # more than rounding errors of who waits
        while not self._came and self._ns < end:
            self._step(min(STEP_S, (end - self._ns) / 1e9))
        came, self._came = self._came, b""
        return came

    def write(self, data: bytes) -> bytes:
        """The bytes leave with the next step of the board."""
        self._finish()
        self._typed += data
        return b""

    def set_pins(self, line: str) -> None:
        """Gives a sensor its quantity or a chip its fault with the next step. UserError: the line has not that form."""
        if not PINS.fullmatch(line):
            raise UserError(f'"{line}": a sensor is set like this: pins.T1 35')
        self._finish()
        self._pins += line.encode("ascii") + b"\n"

    def close(self) -> None:
        self._worker.shutdown()
        self._peer.close()

    def _step(self, seconds: float) -> None:
        """Ctrl-C may come at any time. A step is a thread's, so that no exchange is cut in its middle: the next step waits for it."""
        before = self._ns
        self._running = self._worker.submit(self._exchange, seconds)
        self._finish()
        if self.in_step:
            self._ahead = max(self._ahead + (self._ns - before) / 1e9, time.monotonic() - 1.0)
            time.sleep(max(0.0, self._ahead - time.monotonic()))

    def _finish(self) -> None:
        if self._running is None:
            return
        try:
            ended = self._running.result()
        except OSError:
            ended = True
        self._running = None
        if ended:
            raise RunFailed(f"{self.name}: the virtual board has ended; it says why on its standard error")

    def _exchange(self, seconds: float) -> bool:
        """True when the board has ended."""
        typed, self._typed = self._typed[:FRAME_MOST], self._typed[FRAME_MOST:]
        pins, self._pins = self._pins, b""
        self._peer.sendall(struct.pack("<QHHH", round(seconds * 1e9), len(typed), 0, len(pins)) + typed + pins)
        self._ns, n_console, n_link, ended, _, n_loads = struct.unpack(REPLY, self._whole(struct.calcsize(REPLY)))
        self._came += self._whole(n_console).translate(None, FLOW)
        self._whole(n_link + 8 * n_loads)
        return bool(ended)

    def _whole(self, n: int) -> bytes:
        block = b""
        while len(block) < n:
            more = self._peer.recv(n - len(block))
            if not more:
                raise ConnectionError
            block += more
        return block


def _connect(path: str) -> socket.socket:
    end = time.monotonic() + OPENING_S
    while True:
        peer = socket.socket(socket.AF_UNIX)
        try:
            peer.connect(path)
            return peer
        except OSError as error:
            peer.close()
            if time.monotonic() > end:
                raise UserError(f"{path}: {error.strerror or error}; is `reflux-board --control {path}` running?") from None
            time.sleep(0.05)
