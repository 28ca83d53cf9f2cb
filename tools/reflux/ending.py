"""How a tool ends when somebody else ends it: promptly, and without leaving processes or temporary files."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import tempfile
import threading
import time
from pathlib import Path
from typing import Iterator

from reflux.errors import Ended

SIGNALS = (signal.SIGTERM, signal.SIGHUP)  # a closed terminal ends what it started, too
# These tell a board or a plant to stop before they end themselves; what the others have started is ended at once.
GENTLE = ("run", "demo", "console", "play", "commission", "flash", "io")
GENTLE_S, AT_ONCE_S = 15.0, 3.0  # after that the process ends whatever it was doing
LOOK_AGAIN_S = 0.2
KILL_S = 1.0


@contextlib.contextmanager
def cleanly(command: str) -> Iterator[None]:
    """Ends of this process by a signal are raised as Ended. Temporary files are in one folder, which goes with the process; so do processes
    that are still there."""
    folder = tempfile.mkdtemp(prefix="reflux-")
    tempfile.tempdir, os.environ["TMPDIR"] = folder, folder

    def handler(number: int, _frame: object) -> None:
        for ending in SIGNALS:
            signal.signal(ending, signal.SIG_IGN)
        threading.Thread(target=insist, args=(command not in GENTLE, number, folder), daemon=True).start()
        raise Ended(number)

    for ending in SIGNALS:
        signal.signal(ending, handler)
    ring_until_heard()
    try:
        yield
    finally:
        end_all(descendants(os.getpid()))
        shutil.rmtree(folder, ignore_errors=True)


def ring_until_heard() -> None:
    """Python runs a handler between two steps of the main thread. A signal that comes just before that thread begins to wait, for a process
    say, would be heard only when the wait ends; so another thread sends it again until the handler has run."""
    ear, bell = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
    os.set_blocking(ear, True)
    main = threading.main_thread().ident

    def listen() -> None:
        while numbers := os.read(ear, 1):
            while numbers[0] in SIGNALS and callable(signal.getsignal(numbers[0])) and main is not None:
                time.sleep(LOOK_AGAIN_S)
                signal.pthread_kill(main, numbers[0])

    signal.set_wakeup_fd(bell, warn_on_full_buffer=False)
    os.register_at_fork(after_in_child=lambda: signal.set_wakeup_fd(-1))  # a child's signals are not this process's
    threading.Thread(target=listen, daemon=True).start()


def insist(at_once: bool, number: int, folder: str) -> None:
    """Beside the thread that is winding up: it may be waiting for a process, or for others that begin new ones."""
    end = time.monotonic() + (AT_ONCE_S if at_once else GENTLE_S)
    while time.monotonic() < end:
        if at_once:
            send(descendants(os.getpid()), signal.SIGTERM)
        time.sleep(LOOK_AGAIN_S)
    end_all(descendants(os.getpid()))
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(128 + number)


def descendants(pid: int) -> list[tuple[int, str]]:
    """Processes below this one with the time at which each began, which tells a number that is used again."""
    children: dict[int, list[tuple[int, str]]] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        if words := stat_of(int(folder.name)):
            children.setdefault(int(words[1]), []).append((int(folder.name), words[19]))
    found, next_ones = [], [pid]
    while next_ones:
        below = children.get(next_ones.pop(), [])
        found += below
        next_ones += [child for child, _ in below]
    return found


def stat_of(pid: int) -> list[str]:
    """Fields of /proc/PID/stat from the state on; none for a process that has ended. Its name before them may hold anything."""
    try:
        words = (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()
    except OSError:
        return []
    return words if words[:1] not in (["Z"], ["X"]) else []


def send(processes: list[tuple[int, str]], number: int) -> bool:
    """To those that are still there; True when there was one."""
    there = [pid for pid, began in processes if (words := stat_of(pid)) and words[19] == began]
    for pid in there:
        with contextlib.suppress(OSError):
            os.kill(pid, number)
    return bool(there)


def end_all(processes: list[tuple[int, str]]) -> None:
    end = time.monotonic() + KILL_S
    while send(processes, signal.SIGTERM) and time.monotonic() < end:
        time.sleep(0.05)
    send(processes, signal.SIGKILL)
