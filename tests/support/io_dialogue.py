"""A person at tools/io: answers each question when it is asked."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import sys
import time

from board import PATIENCE_S, ROOT

SILENT_S = 120.0  # it waits for an answer that nobody gives


class Dialogue:
    """tools/io with these arguments. said: everything that it has printed."""

    def __init__(self, *arguments: str) -> None:
        environment = {**os.environ, "PYTHONPATH": str(ROOT / "tools"), "PYTHONDONTWRITEBYTECODE": "1", "PYTHONUNBUFFERED": "1"}
        self.process = subprocess.Popen([sys.executable, "-m", "reflux", "io", *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, cwd=ROOT, env=environment)
        self.said = ""
        self._read_to = 0

    def __enter__(self) -> "Dialogue":
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                with contextlib.suppress(BrokenPipeError):
                    pipe.close()

    def until(self, words: str) -> str:
        """What it prints up to these words, from where the last call has ended."""
        end = time.monotonic() + PATIENCE_S
        assert self.process.stdout is not None
        while (found := self.said.find(words, self._read_to)) < 0:
            if time.monotonic() > end or not select.select([self.process.stdout], [], [], SILENT_S)[0]:
                raise AssertionError(f"no {words!r} in {self.said[self._read_to:]!r}")
            more = os.read(self.process.stdout.fileno(), 4096)
            if not more:
                raise AssertionError(f"it has ended without {words!r}: {self.said[self._read_to:]!r}")
            self.said += more.decode()
        before, self._read_to = self.said[self._read_to:found + len(words)], found + len(words)
        return before

    def answer(self, question: str, answer: str) -> None:
        """Waits for the question, then types a line."""
        self.until(question)
        self.type(answer)

    def type(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n".encode())
        self.process.stdin.flush()

    def interrupt(self, number: int = signal.SIGINT) -> None:
        self.process.send_signal(number)

    def end(self) -> tuple[int, str]:
        """Exit status and the rest of what it prints, after the last answer."""
        rest = self.process.communicate(timeout=PATIENCE_S)[0].decode()
        self.said += rest
        return self.process.returncode, self.said[self._read_to:]
