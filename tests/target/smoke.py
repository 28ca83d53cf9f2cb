#!/usr/bin/python3
"""Starts the firmware image in the emulator, waits for it to greet, and asks for its version.

    smoke.py --image build/stm32f405/reflux-stm32f405.bin

Noise on the plant link in between must leave the console alive. Ends with 0 when the console answered both
times, 1 when not, 2 when it could not be tried.
"""
import argparse
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
sys.dont_write_bytecode = True

from reflux.boards import BOARDS  # noqa: E402

GREETING = "STARTED"  # the firmware's own event: console and link are listening


class Failed(Exception):
    pass


def join(path, process, deadline):
    """A unix socket the emulator listens on; it appears a little after the process."""
    while time.monotonic() < deadline:
        if process.poll() is not None:
            raise Failed(f"the emulator ended with {process.returncode}: {process.stderr.read().strip()}")
        line = socket.socket(socket.AF_UNIX)
        try:
            line.connect(path)
            return line
        except OSError:
            line.close()
            time.sleep(0.02)
    raise Failed("the emulator did not offer its serial lines in time")


def read_until(line, pattern, deadline):
    text = ""
    while not re.search(pattern, text, re.MULTILINE):
        left = deadline - time.monotonic()
        if left <= 0:
            raise Failed(f"no {pattern!r} on the console in time; it said {text!r}")
        line.settimeout(left)
        try:
            block = line.recv(4096)
        except TimeoutError:
            continue
        if not block:
            raise Failed(f"the console closed; it said {text!r}")
        text += block.decode("ascii", "replace").replace("\r", "")
    return text


def check(folder, process, board, deadline):
    console = join(os.path.join(folder, "console"), process, deadline)
    link = join(os.path.join(folder, "link"), process, deadline)
    read_until(console, GREETING, deadline)
    console.sendall(b"version\r")
    reply = read_until(console, r"^ok$", deadline)
    if board not in reply:
        raise Failed(f"'version' does not name the board {board}: {reply!r}")
    # An unfinished frame and a delimiter: garbage for the link, which must leave the console alive.
    link.sendall(bytes(range(1, 200)) + b"\0")
    console.sendall(b"version\r")
    read_until(console, r"^ok$", deadline)
    return reply


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--image", required=True, help="the .bin that is also written to the chip")
    parser.add_argument("--board", default="stm32f405", choices=BOARDS,
                        help="name that 'version' must say")
    parser.add_argument("--qemu", default="qemu-system-arm")
    parser.add_argument("--timeout", type=float, default=20.0, help="seconds for everything (default 20)")
    options = parser.parse_args()
    if not shutil.which(options.qemu):
        print(f"smoke: no {options.qemu} here", file=sys.stderr)
        return 2
    if not os.path.isfile(options.image):
        print(f"smoke: no image {options.image}", file=sys.stderr)
        return 2
    deadline = time.monotonic() + options.timeout
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        command = [options.qemu, "-M", BOARDS[options.board].machine, "-kernel", options.image, "-nographic", "-monitor", "none"]
        for name in ("console", "link"):  # in this order: USART1, USART2
            path = os.path.join(folder, name)
            command += ["-chardev", f"socket,id={name},path={path},server=on,wait=on"]
            command += ["-serial", f"chardev:{name}"]
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True)
        try:
            reply = check(folder, process, options.board, deadline)
        except (Failed, OSError) as reason:
            print(f"smoke: {reason}", file=sys.stderr)
            return 1
        finally:
            process.kill()
            process.wait()
    print(reply.strip())
    return 0


if __name__ == "__main__":
    sys.exit(main())
