"""One tool at a time on a serial device or pseudo-terminal.

The lock is the kernel's on the open device (flock), so it ends with the process that holds it, however that ends. picocom takes the same one.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
from pathlib import Path
from typing import Iterator

from reflux.errors import UserError

PROC = Path("/proc")


def claim(descriptor: int, path: str) -> None:
    """Locks an open device, or refuses by the name of the process that holds it. Nothing has been sent or set by then."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise UserError(in_use(path)) from None


@contextlib.contextmanager
def held(path: str) -> Iterator[None]:
    """For the time in which reflux-sim uses the device: it takes this lock on a pseudo-terminal itself, and none on a serial device."""
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError as error:
        raise UserError(in_use(path) if error.errno == errno.EBUSY else f"{path}: {error.strerror}") from None
    with contextlib.ExitStack() as stack:
        stack.callback(os.close, descriptor)
        claim(descriptor, path)
        if os.path.realpath(path).startswith("/dev/pts/"):
            stack.close()
        yield


def in_use(path: str) -> str:
    return f"{path} is in use by {holder(path)}; end that first, or name another port"


def holder(path: str) -> str:
    """Name and number of the process that has the lock, or else of one that has the device open; of another user's process the kernel may
    tell neither."""
    device = os.path.realpath(path)
    pids = lockers(device) or openers(device)
    return " and ".join(f"{name_of(pid)} (process {pid})" for pid in pids) or "another process"


def lockers(device: str) -> list[int]:
    """From /proc/locks, whose lines are NUMBER: FLOCK ADVISORY WRITE PID MAJOR:MINOR:INODE START END."""
    try:
        place = os.stat(device)
        lines = (PROC / "locks").read_text().splitlines()
    except OSError:
        return []
    wanted = f"{os.major(place.st_dev):02x}:{os.minor(place.st_dev):02x}:{place.st_ino}"
    found = [line.split() for line in lines]
    return sorted({int(words[4]) for words in found if len(words) > 5 and words[1] == "FLOCK" and words[5] == wanted and int(words[4]) > 0})


def openers(device: str) -> list[int]:
    """Other processes that have the device open, as far as we may look."""
    out = []
    for folder in PROC.glob("[0-9]*"):
        try:
            if any(os.readlink(file) == device for file in (folder / "fd").iterdir()) and int(folder.name) != os.getpid():
                out.append(int(folder.name))
        except OSError:
            continue
    return sorted(out)


def name_of(pid: int) -> str:
    """tools/NAME or reflux NAME for one of these tools, a script's name, else the program's."""
    try:
        words = (PROC / str(pid) / "cmdline").read_bytes().decode(errors="replace").split("\0")
    except OSError:
        return "a process"
    if words[1:3] == ["-m", "reflux"] and len(words) > 3:
        return f"tools/{words[3]}"
    if [os.path.basename(word)[:6] for word in words[:2]] == ["python", "reflux"] and len(words) > 2:
        return f"reflux {words[2]}".rstrip()
    if os.path.basename(words[0]).startswith("python") and len(words) > 1 and words[1].endswith(".py"):
        return os.path.basename(words[1])
    return os.path.basename(words[0]) or "a process"
