"""The boards that the emulator runs: the one table of them. Another board is a row here (docs/inside/architecture.md)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Image:
    """An image that scenarios run on."""

    preset: str
    twin: str  # preset of the host whose log is the same, bit for bit
    test: str  # that shows it: target.smoke-TEST
    too_large: tuple[str, ...] = ()  # scenarios that find no memory in it

    @property
    def emulated(self) -> tuple[str, str]:
        return self.twin, self.preset

    @property
    def kinds(self) -> tuple[str, str, str]:
        """All firmwares with that log."""
        return *self.emulated, f"board-{self.preset}"


@dataclass(frozen=True)
class Board:
    machine: str  # the emulated board that carries its processor
    runs: tuple[Image, ...]
    others: tuple[str, ...] = ()  # further presets, of which the size is checked


BOARDS = {
    "stm32f405": Board("netduinoplus2", (Image("stm32f405", "host", "float"), Image("stm32f405-fixed", "host-fixed", "fixed", ("methanol-ahead",)),
                                         Image("stm32f405-assert", "host", "assert")),
                       ("stm32f405-base",)),
    "stm32f100": Board("stm32vldiscovery", (Image("stm32f100", "host-fixed", "small"),), ("stm32f100-pins",)),
}

RUNS = tuple(image for board in BOARDS.values() for image in board.runs)
# Images that `--firmware` of tools/run and `firmware` of a scenario may name.
FIRMWARES = tuple(image.preset for image in RUNS)
# The same images on the virtual board, which has the whole chip: `board` is the first of them.
VIRTUAL = {"board": "stm32f405", **{f"board-{preset}": preset for preset in FIRMWARES}}
# Everything there is to build.
PRESETS = (*FIRMWARES, *(preset for board in BOARDS.values() for preset in board.others))
# Images that the default tier of tools/test builds: one image in float, and a fixed-point image of the smallest board.
BUILT_BY_DEFAULT = ("stm32f405", "stm32f100")
