"""A person's terminal on a board's console: bytes through, both ways."""

from __future__ import annotations

import contextlib
import os
import select
import sys
import termios
import time
import tty
from typing import Iterator, TextIO

from reflux.ports import Port

LEAVE = 0x1D  # ^]
CONTROL_C = 0x03
AFTER_INPUT_S = 1.0


@contextlib.contextmanager
def raw() -> Iterator[bool]:
    """Keys as they are pressed, and the terminal as it was afterwards, however it ends. False: the input is no terminal."""
    if not sys.stdin.isatty():
        yield False
        return
    before = termios.tcgetattr(0)
    try:
        tty.setraw(0)
        yield True
    finally:
        termios.tcsetattr(0, termios.TCSADRAIN, before)
        print(flush=True)


def interactive(port: Port, log: TextIO | None, leave: tuple[int, ...] = (LEAVE,), told: str = "^] leaves") -> int:
    """Input that is no terminal is sent line by line, and then the replies awaited."""
    with raw() as terminal:
        if terminal:
            print(f"{port.name}: {told}", end="\r\n", flush=True)  # after raw(): what is typed before is thrown away
        return pass_through(port, log, terminal, leave)


def pass_through(port: Port, log: TextIO | None, terminal: bool, leave: tuple[int, ...]) -> int:
    open_input, quiet_since = True, time.monotonic()
    while open_input or time.monotonic() - quiet_since < AFTER_INPUT_S:
        ready = select.select([port.fileno(), *([0] if open_input else [])], [], [], 0.1)[0]
        came = b""
        if 0 in ready:
            typed = os.read(0, 1024)
            if not typed or (terminal and any(key in typed for key in leave)):
                open_input = False
                if typed:
                    return 0
            came = port.write(typed.replace(b"\n", b"\r") if not terminal else typed)
            quiet_since = time.monotonic()
        if port.fileno() in ready:
            came += port.read()
        if came:
            quiet_since = time.monotonic()
            os.write(1, came)
            if log:
                log.write(came.decode("latin-1").replace("\r\n", "\n"))
                log.flush()
    return 0
