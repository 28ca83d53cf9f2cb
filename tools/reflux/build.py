"""Configuring and building the presets of CMakePresets.json.

Each build tree has a lock, because two processes that build in one tree at once disturb one another.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path
from typing import Iterator

from reflux.errors import RunFailed, UserError
from reflux.paths import INSTALLED, ROOT, build_dir, shown

STEP = re.compile(rb"^\[(\d+)/(\d+)\]")
LINES_SHOWN = 40
SILENT_WAIT_S = 2.0
LOOK_AGAIN_S = 0.1


@contextlib.contextmanager
def locked(folder: Path, quiet: bool = False) -> Iterator[None]:
    """Holds the lock of one build tree. Waits while another process holds it, and says so after SILENT_WAIT_S.

    The lock is on a file beside the tree. The kernel frees it when its holder ends, however that holder ends. A process
    must not take the same lock twice.
    """
    path = folder.with_name(f"{folder.name}.lock")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        file = path.open("a")
    except OSError as error:
        raise RunFailed(f"{shown(path)}: cannot be opened: {error.strerror}") from None
    with file:
        _wait_for_lock(file.fileno(), folder, quiet)
        yield


def _wait_for_lock(descriptor: int, folder: Path, quiet: bool) -> None:
    started, announced = time.monotonic(), quiet
    while True:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return
        except BlockingIOError:
            if not announced and time.monotonic() - started > SILENT_WAIT_S:
                print(f"waiting for the build tree {shown(folder)}, in which another process builds", flush=True)
                announced = True
            time.sleep(LOOK_AGAIN_S)


def configure(preset: str, quiet: bool = False) -> Path:
    """Makes the build tree where there is none, and makes it anew where a file of CMake's has changed since."""
    folder = build_dir(preset)
    with locked(folder, quiet):
        if (folder / "build.ninja").is_file():
            _run(f"configuring {preset}", ["cmake", "--build", str(folder), "--target", "build.ninja"], quiet=True)
        else:
            _configure(preset, folder, quiet)
    return folder


def _configure(preset: str, folder: Path, quiet: bool) -> None:
    if not (folder / "build.ninja").is_file():
        _run(f"configuring {preset}", ["cmake", "--preset", preset, "-B", str(folder)], quiet)


def knows(preset: str, target: str, quiet: bool = False) -> bool:
    """Whether the build tree has this target. A tree that was made before its library was installed is made anew."""
    folder = build_dir(preset)
    with locked(folder, quiet):
        for again in (False, True):
            if again:
                _run(f"configuring {preset}", ["cmake", "--preset", preset, "-B", str(folder)], quiet)
            else:
                _configure(preset, folder, quiet)
            if f"\nbuild {target}: " in (folder / "build.ninja").read_text(encoding="utf-8"):
                return True
    return False


def build(preset: str, targets: tuple[str, ...] = (), quiet: bool = False) -> Path:
    """Brings one build tree up to date and returns it. Output is shown only where something fails. An installed package has nothing to
    build."""
    folder = build_dir(preset)
    if INSTALLED:
        if preset != "host":
            raise UserError(f"the installed package has no firmware {preset}; it has host and memory, and a clone of the repository builds {preset}")
        return folder
    command = ["cmake", "--build", str(folder)]
    if targets:
        command += ["--target", *targets]
    with locked(folder, quiet):
        _configure(preset, folder, quiet)
        _run(f"building {preset}", command, quiet)
    return folder


def variant(preset: str, name: str, definitions: tuple[str, ...] = (), targets: tuple[str, ...] = (), quiet: bool = False) -> Path:
    """A preset with other definitions (-DNAME=VALUE), in the build tree `name`: what they do not touch is built once."""
    folder = build_dir(name)
    command = ["cmake", "--build", str(folder)] + (["--target", *targets] if targets else [])
    with locked(folder, quiet):
        _run(f"configuring {name}", ["cmake", "--preset", preset, "-B", str(folder), *definitions], quiet=True)
        _run(f"building {name} {' '.join(definitions)}".rstrip(), command, quiet)
    return folder


def _run(what: str, command: list[str], quiet: bool) -> None:
    started = time.monotonic()
    lines: list[bytes] = []
    environment = {name: value for name, value in os.environ.items() if name != "NINJA_STATUS"}  # STEP is ninja's own form
    try:
        process = subprocess.Popen(command, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    except FileNotFoundError:
        raise RunFailed(f"{what}: there is no program {command[0]}; tools/bootstrap installs it") from None
    assert process.stdout is not None
    progress = Progress(what, quiet)
    steps = 0
    for line in process.stdout:
        lines.append(line)
        match = STEP.match(line)
        if match:
            steps = int(match.group(2))
            progress.show(f"{match.group(1).decode()}/{match.group(2).decode()}")
    process.stdout.close()
    if process.wait() != 0:
        progress.end("failed")
        sys.stderr.write(b"".join(lines[-LINES_SHOWN:]).decode(errors="replace"))
        raise RunFailed(f"{what} failed (its last lines are above); to repeat: {' '.join(command)}")
    if steps > 1 or "configuring" in what:
        progress.end(f"{time.monotonic() - started:.0f} s")
    else:
        progress.end("up to date")


DONE = re.compile(r"\b(\d+(?:\.\d+)?)(?: \w+)?(?: of |/)(\d+(?:\.\d+)?)\b")
TOLD_AFTER_S = 2.0  # what is over sooner needs no forecast


def forecast(text: str, elapsed_s: float) -> str:
    """The text with the time that is left, from "3 of 12", "3/12" or "30 s of 120 s" in it."""
    found = DONE.search(text)
    if not found or elapsed_s < TOLD_AFTER_S or " left" in text:
        return text
    done, whole = float(found[1]), float(found[2])
    if not 0 < done < whole:
        return text
    left = elapsed_s * (whole - done) / done
    return f"{text}, about {left:.0f} s left" if left < 120 else f"{text}, about {left / 60:.0f} min left"


class Progress:
    """One line that is written over on a terminal, and one line at the end elsewhere."""

    def __init__(self, what: str, quiet: bool = False):
        self.what, self.quiet = what, quiet
        self.terminal = sys.stdout.isatty()
        self.last = 0.0
        self.started = time.monotonic()

    def show(self, text: str) -> None:
        now = time.monotonic()
        if self.terminal and not self.quiet and now - self.last > 0.1:
            self.last = now
            print(f"\r\033[K{self.what}: {forecast(text, now - self.started)}", end="", flush=True)

    def end(self, text: str) -> None:
        if not self.quiet:
            start = "\r\033[K" if self.terminal else ""
            print(f"{start}{self.what}: {text}", flush=True)


def compiler_words(command: str) -> list[str]:
    """The words of a compile command, from the compiler on: a compiler cache may stand before it."""
    words = shlex.split(command)
    return words[next(k for k, word in enumerate(words) if word.startswith("-")) - 1:]


def find_image(preset: str) -> Path:
    """The file that is flashed, and that the emulator runs."""
    folder = build_dir(preset)
    for pattern in ("reflux-*.bin", "*/reflux-*.bin", "*/*/reflux-*.bin"):
        found = sorted(folder.glob(pattern))
        if found:
            return found[0]
    raise RunFailed(f"{shown(folder)}: the build left no image reflux-*.bin there")


def find_program(preset: str, name: str) -> Path:
    folder = build_dir(preset)
    if (folder / name).is_file():
        return folder / name
    raise RunFailed(f"{shown(folder)}: the build left no program {name} there")
