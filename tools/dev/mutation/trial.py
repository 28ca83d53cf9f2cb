"""One fault: the tests that could notice it, the cheapest first, until one does."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from pathlib import Path

from dev.mutation import tree as trees
from dev.mutation.tree import Test, Tree, Unit


class NotCompiled(Exception):
    """The changed text is not C, or no longer fits the rest."""


@dataclass(frozen=True)
class Verdict:
    """test and trouble: which test noticed, and what it saw; None where none did. tried: how many were run."""

    test: str | None
    trouble: str
    tried: int
    cpu_s: float


class Bench:
    """A build tree with what its tests cost; tries faults in it."""

    def __init__(self, tree: Tree, costs: dict[str, float]):
        self.tree, self.costs = tree, costs
        self.plain: dict[str, bytes | None] = {}
        self.lock = threading.Lock()

    def attempt(self, path: Path, text: str, tests: list[Test], place: Path) -> Verdict:
        """The tests whose programs contain the file, in order of their cost."""
        with self.lock:
            units = self.tree.units_of(path)
        objects: dict[str, Path] = {}
        programs: dict[str, Path | None] = {}
        tried, used = 0, 0.0
        try:
            for test in sorted(tests, key=lambda t: (self.costs.get(t.name, 0.0), t.name)):
                instead = {}
                for program in test.programs:
                    if program not in programs:
                        programs[program] = self._changed(program, units, path, text, objects, place)
                    changed = programs[program]
                    if changed is not None:
                        instead[program] = changed
                if not instead:
                    continue
                outcome = self.tree.run(test, place, instead, 10.0 * self.costs.get(test.name, 0.0) + 2.0)
                tried, used = tried + 1, used + outcome.cpu_s
                if outcome.trouble is not None:
                    return Verdict(test.name, outcome.trouble, tried, used)
            return Verdict(None, "", tried, used)
        finally:
            trees.clear(place)

    def _changed(self, program: str, units: list[Unit], path: Path, text: str, objects: dict[str, Path],
                 place: Path) -> Path | None:
        with self.lock:
            within = self.tree.linked(program, units)
        if not within:
            return None
        for unit in within:
            if unit.target not in objects:
                made = self.tree.compile(unit, path, text, place)
                if made is None:
                    raise NotCompiled
                objects[unit.target] = made
        target = self.tree.link(program, {u.target: objects[u.target] for u in within}, place / "linked")
        if target is None:
            raise NotCompiled
        return target

    def differs(self, path: Path, plain: str, changed: str, place: Path) -> bool:
        """True if the machine code or data of anything in the firmware's libraries is another."""
        for unit in self.tree.units_of(path):
            if not unit.target.startswith("firmware/"):
                continue
            key = f"{unit.target}\0{path}"
            if key not in self.plain:
                self.plain[key] = self.tree.code(unit, path, plain, place)
            code = self.tree.code(unit, path, changed, place)
            if code is None:
                raise NotCompiled
            if code != self.plain[key]:
                return True
        return False
