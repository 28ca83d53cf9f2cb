"""A window of tools/ina: the picture, drawn anew after each operation, and alive while a person thinks about the next one."""

from __future__ import annotations

import os
import select
import sys
from typing import Any, Callable

from reflux.errors import UserError

TOOLKITS = ("QtAgg", "GTK3Agg", "TkAgg")  # what matplotlib draws windows with, where MPLBACKEND names none
PUMPED_S = 0.05
NO_WINDOW = "--out PNG draws into a file, and a viewer that loads a changed file again shows it"


class Window:
    """fill draws into an empty figure. toolkit: of matplotlib; one without windows only draws."""

    def __init__(self, size: tuple[float, float], toolkit: str, windows: bool = True):
        from reflux import ina_picture  # first: it asks for pictures without windows

        self.style, self.plt = ina_picture.STYLE, ina_picture.plt
        self.plt.switch_backend(toolkit)
        with self.plt.rc_context(self.style):  # its layout is fixed here
            self.figure: Any = self.plt.figure(figsize=size)
        self.windows = windows
        if windows:
            self.plt.show(block=False)

    def open(self) -> bool:
        """Not closed by its frame."""
        return bool(self.plt.fignum_exists(self.figure.number))

    def draw(self, fill: Callable[[Any], None]) -> None:
        if not self.open():
            return
        self.figure.clear()
        with self.plt.rc_context(self.style):
            fill(self.figure)
            self.figure.canvas.draw()
        self.pump()

    def pump(self) -> None:
        """Serves the window's requests: moved, uncovered, closed."""
        if self.open():
            self.figure.canvas.flush_events()

    def wait(self) -> None:
        """Until it is closed."""
        if self.windows and self.open():
            self.plt.show(block=True)

    def close(self) -> None:
        self.plt.close(self.figure)


def window(size: tuple[float, float]) -> Window:
    """UserError where there is no display, or nothing that can draw on it."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise UserError(f"--window: there is no display; {NO_WINDOW}")
    from matplotlib import rcsetup

    asked = os.environ.get("MPLBACKEND")
    why = ""
    for toolkit in [asked] if asked else TOOLKITS:
        if toolkit.lower() not in (name.lower() for name in rcsetup.interactive_bk):
            why = f"{toolkit} has no windows"
            continue
        try:
            return Window(size, toolkit)
        except Exception as error:  # each toolkit has its own when it is not installed or the display is gone
            why = " ".join(str(error).split()) or type(error).__name__
    raise UserError(f"--window: matplotlib has no window here ({why}); {NO_WINDOW}")


class Lines:
    """Lines of a terminal, with a window alive meanwhile. Its own buffer: what is pasted comes in one piece."""

    def __init__(self, shown: Window):
        self.shown, self.rest, self.ended = shown, b"", False

    def read(self) -> str:
        """With its end of line; "" when there are no more."""
        place = sys.stdin.fileno()
        while b"\n" not in self.rest and not self.ended:
            if select.select([place], [], [], PUMPED_S)[0]:
                came = os.read(place, 4096)
                self.rest, self.ended = self.rest + came, not came
            else:
                self.shown.pump()
        line, end, self.rest = self.rest.partition(b"\n")
        return (line + end).decode("utf-8", "replace")
