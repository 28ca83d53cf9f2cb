"""Faults in the port of a chip: the image with the fault runs on the virtual board, after the unit tests of the port on the host.

A fault is compiled and linked as the flashed file, in a folder of build trees of its own whose other trees are those that are
there. The tests look into it because REFLUX_BUILD_ROOT names it.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

from reflux import boards, build, table
from reflux.paths import ROOT, build_dir, build_root
from dev.mutation import drawing, registers
from dev.mutation import tree as trees
from dev.mutation.drawing import Fault
from dev.mutation.random_round import CAUGHT, EQUIVALENT, SURVIVED, Result, Round, State, totals
from dev.mutation.reach import Costs
from dev.mutation.tree import Test, Tree
from dev.mutation.trial import Bench, NotCompiled, Verdict

KINDS = (*registers.KINDS, *registers.COMMON)
UNIT_TESTS = {"stm32f405": ("stm32f405_start", "stm32f405_chip", "stm32_flash", "stm32_memory"),
              "stm32f100": ("stm32f100_start", "stm32f100_chip", "stm32_memory")}
SCRIPTS = {"stm32f405": ("test_virtual_board", "test_self_checks", "test_board_faults"),
           "stm32f100": ("test_virtual_board",)}
OTHER_CHIP = {"stm32f405": ("test_a_low_supply_is_seen", "test_memory_at_power_on_is_of_the_seed", "test_a_supply_that_goes_in_a_save_loses_no_set"),
              "stm32f100": ("test_an_image_that_is_too_large_is_refused",)}  # tests of what is not this image
HOST_PROGRAMS = ("reflux-sim", "reflux-board", "reflux-host", "board-self-checks")
FLASHED = 1.0  # s of processor time that a test costs beyond what is measured, as the board of a fault may run on


class ImageTree(Tree):
    """The build tree of the image, which is that of its preset."""

    compared = ("-g0",)
    strip = "arm-none-eabi-strip"

    def __init__(self, board: str):
        super().__init__(board)
        self.folder = build_dir(board)

    def link_command(self, program: str) -> list[str]:
        """Without what follows the link, and without its map."""
        words = super().link_command(program)
        return [w for w in words[:words.index("&&")] if not w.startswith("-Wl,-Map=")] if "&&" in words else words

    @property
    def program(self) -> str:
        return str(self.folder / f"reflux-{self.name}.elf")


def board_tests(board: str) -> list[Test]:
    """Each test of the scripts by itself, and the smoke scenario on the virtual board and in the emulator."""
    out, image = [], str(build_root() / board / f"reflux-{board}.bin")
    for script in SCRIPTS[board]:
        path = ROOT / "tests" / "target" / f"{script}.py"
        given = [image] if script == "test_self_checks" else []
        for group in ast.parse(path.read_text(encoding="utf-8")).body:
            for test in group.body if isinstance(group, ast.ClassDef) else []:
                if isinstance(test, ast.FunctionDef) and test.name.startswith("test_") and test.name not in OTHER_CHIP[board]:
                    name = f"{group.name}.{test.name}"
                    out.append(Test(name, (sys.executable, str(path), *given, name), str(ROOT), (), tuple(given)))
    twin = next(image.twin for image in boards.RUNS if image.preset == board)
    # What only the emulator needs, it alone notices.
    out += [Test(name, (sys.executable, str(ROOT / "tests" / "loop" / "same_log.py"), str(ROOT / "host_sim" / "scenarios" / "smoke.toml"), twin, firmware),
                 str(ROOT), (), ()) for name, firmware in (("smoke", f"board-{board}"), ("emulator", board))]
    return out


class BoardBench:
    """Tries a fault on the host, then in the image."""

    def __init__(self, board: str):
        self.image, self.host = ImageTree(board), Tree("float")
        for preset in SCRIPTS:
            build.build(preset)  # some tests run both images
        build.build("host", HOST_PROGRAMS)
        build.build("host-fixed", ("reflux-host",))
        self.units = [t for t in self.host.tests() if t.name in UNIT_TESTS[board]]
        self.host.build(tuple(sorted({self.host.target_of(p) for t in self.units for p in t.programs})))
        self.unit_bench = Bench(self.host, Costs(self.host).measure(self.units))
        costs = Costs(self.image)
        self.tests = board_tests(board)
        self.costs = costs.measure(self.tests)
        self.tests = sorted((t for t in self.tests if t.name in self.costs), key=lambda t: (self.costs[t.name], t.name))
        self.plain: dict[str, bytes | None] = {}

    def differs(self, path: Path, changed: str, place: Path) -> bool:
        plain = path.read_text(encoding="utf-8")
        for unit in self.image.units_of(path):
            if unit.target not in self.plain:
                self.plain[unit.target] = self.image.code(unit, path, plain, place)
            code = self.image.code(unit, path, changed, place)
            if code is None:
                raise NotCompiled
            if code != self.plain[unit.target]:
                return True
        return False

    def attempt(self, path: Path, text: str, place: Path, longest_s: float | None) -> Verdict:
        verdict = self.unit_bench.attempt(path, text, self.units, place / "host")
        if verdict.test is not None:
            return verdict
        try:
            root, flashed = self._flashed(path, text, place)
            used, tried = verdict.cpu_s, verdict.tried
            for test in self.tests:
                if longest_s is not None and self.costs[test.name] > longest_s:
                    continue
                here = replace(test, environment=(f"REFLUX_BUILD_ROOT={root}",))
                outcome = self.image.run(here, place / "run", {p: flashed for p in test.programs}, 10.0 * self.costs[test.name] + FLASHED)
                tried, used = tried + 1, used + outcome.cpu_s
                if outcome.trouble is not None:
                    return Verdict(test.name, outcome.trouble, tried, used)
            return Verdict(None, "", tried, used)
        finally:
            trees.clear(place)

    def _flashed(self, path: Path, text: str, place: Path) -> tuple[Path, Path]:
        """The folder of build trees, and the file in it that is flashed."""
        objects = {}
        for unit in self.image.units_of(path):
            made = self.image.compile(unit, path, text, place)
            if made is None:
                raise NotCompiled
            objects[unit.target] = made
        root = place / "build"
        own = root / self.image.name
        elf = self.image.link(self.image.program, objects, own)
        if elf is None:
            raise NotCompiled
        for folder in build_root().iterdir():
            if folder.is_dir() and folder.name != own.name:
                (root / folder.name).symlink_to(folder)
        flashed = elf.with_suffix(".bin")
        subprocess.run([sys.executable, str(ROOT / "tools" / "cmake" / "image_crc.py"), "arm-none-eabi-objcopy", str(elf), str(flashed)],
                       check=True, capture_output=True)
        return root, flashed


class BoardRound(Round):
    """A round of one chip. An image that no longer links counts as no fault."""

    def __init__(self, board: str, jobs: int, longest_s: float | None, kinds: tuple[str, ...]):
        super().__init__(jobs, longest_s)
        self.board, self.kinds = board, kinds or KINDS
        self.board_bench: BoardBench | None = None

    def prepare(self) -> None:
        self.board_bench = BoardBench(self.board)

    def faults(self, files: list[str]) -> dict[tuple[str, int], list[Fault]]:
        by_line = drawing.faults_by_line(files, self.board)
        some = {line: [f for f in faults if f.edit.kind in self.kinds] for line, faults in by_line.items()}
        return {line: faults for line, faults in some.items() if faults}

    def state(self, seed: int, files: list[str]) -> State:
        return State(seed, files, self.longest_s, self.board + "".join(f"-{k}" for k in self.kinds if self.kinds != KINDS))

    def format_of(self, fault: Fault, plain: str, changed: str) -> str | None:
        assert self.board_bench is not None
        return self.board if self.board_bench.differs(fault.path, changed, self.work / "compared") else None

    def attempt(self, fault: Fault, first: str, place: Path) -> Result:
        assert self.board_bench is not None
        e = fault.edit
        result = Result(fault.file, e.function, e.line, e.kind, fault.old, fault.new, SURVIVED, first)
        changed = e.apply(fault.path.read_text(encoding="utf-8"))
        verdict = self.board_bench.attempt(fault.path, changed, place, self.longest_s)
        result.cpu_s = verdict.cpu_s
        if verdict.test is not None:
            result.status, result.by, result.trouble = CAUGHT, verdict.test, verdict.trouble
        return result

    def rows(self, results: list[Result]) -> list[list[str]]:
        """By kind."""
        found = [k for k in KINDS if any(r.kind == k for r in results)]
        return [*(totals(k, [r for r in results if r.kind == k]) for k in found), totals(self.board, results)]

    heading = "kind"
    equivalent_max = 1.0  # two writes of which either may come first are many
