"""A line that a person types on a terminal in raw mode, with history and completion."""

from __future__ import annotations

from typing import Callable

LEAVING = (0x1D, 0x03, 0x04)  # ^] ^C ^D
UP, DOWN = b"\x1b[A", b"\x1b[B"


class LineEditor:
    def __init__(self, complete: Callable[[str], str] = str) -> None:
        """complete: the line that a tab makes of one."""
        self.complete = complete
        self.text = ""
        self.left = False
        self.history: list[str] = []
        self.place = 0  # in the history; its length: the line that is being typed
        self.rest = b""

    def feed(self, data: bytes) -> list[str]:
        """Takes keys; returns the lines that were finished."""
        data, self.rest = self.rest + data, b""
        done = []
        while data and not self.left:
            if data[0] == 0x1B:
                if len(data) < 3 and data == UP[:len(data)]:
                    self.rest = data  # the end of a key's code is still to come
                    break
                if data[:3] in (UP, DOWN):
                    self.recall(-1 if data[:3] == UP else 1)
                data = data[3:]
                continue
            key, data = data[0], data[1:]
            if key in (0x0A, 0x0D):
                done += self.finish()
            else:
                self.press(key)
        return done

    def press(self, key: int) -> None:
        if key in LEAVING:
            self.left = True
        elif key in (0x08, 0x7F):
            self.text = self.text[:-1]
        elif key == 0x15:  # ^U
            self.text = ""
        elif key == 0x17:  # ^W
            self.text = self.text.rstrip().rpartition(" ")[0]
            self.text += " " if self.text else ""
        elif key == 0x09:
            self.text = self.complete(self.text)
        elif 0x20 <= key < 0x7F:
            self.text += chr(key)

    def finish(self) -> list[str]:
        line, self.text = self.text.strip(), ""
        if line and (not self.history or self.history[-1] != line):
            self.history.append(line)
        self.place = len(self.history)
        return [line] if line else []

    def recall(self, by: int) -> None:
        self.place = min(max(self.place + by, 0), len(self.history))
        self.text = self.history[self.place] if self.place < len(self.history) else ""
