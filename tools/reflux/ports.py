"""A line to a board's console: serial device, pseudo-terminal or unix socket, behind one set of calls.

XOFF and XON from the board are obeyed here and never reach the caller. A device that another tool has open is refused (port_lock.py).
"""

from __future__ import annotations

import errno
import os
import select
import socket
import stat
import termios
import time
import tty
from typing import Any

from reflux import port_lock
from reflux.errors import RunFailed, UserError

XON, XOFF = 0x11, 0x13
HELD_S = 10.0  # a board that holds us off longer than this is gone
OPENING_S = 10.0
BAUD = 115200


class Port:
    def __init__(self, where: str):
        self.name = where
        self.held = False
        self._socket: socket.socket | None = None
        self._serial: Any = None
        self._rest = b""
        path = where.removeprefix("socket:").removeprefix("pty:").removeprefix("serial:").split("@")[0]
        if where.startswith("socket:") or _is_socket(path):
            self._socket = _connect(path)
            self._fd = self._socket.fileno()
        elif not os.path.exists(path):
            raise UserError(f"there is no {path}; a serial device such as /dev/ttyUSB0, a pseudo-terminal, or "
                            "socket:PATH")
        elif os.path.realpath(path).startswith("/dev/pts/"):
            self._fd = _open(path)
            try:
                port_lock.claim(self._fd, path)
            except UserError:
                os.close(self._fd)
                raise
            tty.setraw(self._fd, termios.TCSANOW)
        elif stat.S_ISCHR(os.stat(path).st_mode):
            self._serial = _open_serial(path, where)
            self._fd = self._serial.fileno()
        else:
            raise UserError(f"{path} is not a serial device, pseudo-terminal or socket")

    def fileno(self) -> int:
        return self._fd

    def read(self, patience_s: float = 0.0) -> bytes:
        """Returns the bytes that have come, at once or within this time; b"" for none."""
        if not select.select([self._fd], [], [], max(0.0, patience_s))[0]:
            return b""
        try:
            data = os.read(self._fd, 65536)
        except OSError:
            data = b""
        if not data:
            raise RunFailed(f"{self.name}: the other side is gone")
        if XON in data or XOFF in data:
            self.held = data.rfind(XOFF) > data.rfind(XON)
            data = bytes(byte for byte in data if byte not in (XON, XOFF))
        return data

    def write(self, data: bytes) -> bytes:
        """Sends everything; returns what came in meanwhile while the board held us off."""
        came = b""
        end = time.monotonic() + HELD_S
        while data:
            if self.held:
                came += self.read(0.1)
            elif select.select([], [self._fd], [], 0.1)[1]:
                try:
                    data = data[os.write(self._fd, data[:64]):]
                except BlockingIOError:
                    continue
                except OSError:
                    raise RunFailed(f"{self.name}: the other side is gone") from None
                end = time.monotonic() + HELD_S
                if select.select([self._fd], [], [], 0)[0]:
                    came += self.read()
            if time.monotonic() > end:
                raise RunFailed(f"{self.name}: takes no more bytes for {HELD_S:g} s")
        return came

    def close(self) -> None:
        if self._socket:
            self._socket.close()
        elif self._serial:
            self._serial.close()
        else:
            os.close(self._fd)


def _is_socket(path: str) -> bool:
    try:
        return stat.S_ISSOCK(os.stat(path).st_mode)
    except OSError:
        return False


def _connect(path: str) -> socket.socket:
    end = time.monotonic() + OPENING_S
    while True:
        peer = socket.socket(socket.AF_UNIX)
        try:
            peer.connect(path)
            peer.setblocking(False)
            return peer
        except OSError as error:
            peer.close()
            if not os.path.exists(path) or time.monotonic() > end:
                raise UserError(f"socket {path}: {error.strerror or error}") from None
            time.sleep(0.05)


def _open(path: str) -> int:
    try:
        return os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError as error:
        raise UserError(port_lock.in_use(path) if error.errno == errno.EBUSY else f"{path}: {error.strerror}") from None


def _open_serial(path: str, where: str) -> Any:
    import serial  # only for real ports
    baud = where.split("@")[1] if "@" in where else str(BAUD)
    if not baud.isdigit():
        raise UserError(f'{where}: "{baud}" is not a baud rate')
    try:
        return serial.Serial(path, int(baud), timeout=0, exclusive=True)  # takes the lock of port_lock.py before it sets anything
    except (serial.SerialException, ValueError) as error:
        if getattr(error, "errno", None) in (errno.EBUSY, errno.EAGAIN):
            raise UserError(port_lock.in_use(path)) from None
        raise UserError(f"{path}: {getattr(error, 'strerror', None) or error}") from None
