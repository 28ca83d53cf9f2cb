"""tools/mutate: faults put into the firmware on purpose, one at a time; the tests must notice each."""

from __future__ import annotations

import argparse
import tomllib
from dataclasses import dataclass
from pathlib import Path

from reflux import build, packages
from reflux.errors import RunFailed, UserError
from dev.mutation.board import KINDS, SCRIPTS, BoardRound
from dev.mutation.random_round import Round
from dev.mutation.reach import Costs, mutants_folder
from dev.mutation.tree import Tree
from dev.mutation.trial import Bench, NotCompiled
from reflux.paths import ROOT, shown

LIST = ROOT / "tests" / "mutants.toml"


@dataclass(frozen=True)
class Mutant:
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    format: str

    def title(self) -> str:
        return f"{self.file}: {' '.join(self.old.split())}  ->  {' '.join(self.new.split()) or '(nothing)'}"


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/mutate",
        description="Without --random: each fault of tests/mutants.toml in turn, and the tests named there. With it: N "
        "faults drawn from all code lines of firmware/ (a constant, a comparison, an arithmetic operator, a dropped "
        "statement), each with the unit, loop and replay tests that reach its line, the cheapest first, until one "
        "notices. Only faults count that change the object code; what is known to change nothing that could be observed "
        "is in tests/mutants_equivalent.toml, with the reason. A fault no test notices is printed. Exit status 1: a "
        "listed fault was not noticed, or less than 90 % of the drawn ones, or more than a tenth were equivalent. "
        "Everything is built and kept in build/mutants; a round that was interrupted goes on where it was. With --board: faults "
        "in the port of that chip, tried with the unit tests of its drivers and then as the flashed file on the virtual board.")
    p.add_argument("files", nargs="*", metavar="FILE",
                   help="only faults in source files whose path ends so; with --random also a folder, like firmware/num")
    p.add_argument("--list", action="store_true", help="print the faults of tests/mutants.toml and try none")
    p.add_argument("--random", type=int, metavar="N", help="draw N faults by chance")
    p.add_argument("--seed", type=int, default=1, metavar="S", help="seed of the draw (default 1)")
    p.add_argument("--again", action="store_true",
                   help="only those of the round with this seed that were not noticed, with the present sources and tests")
    p.add_argument("-j", "--jobs", type=int, default=1, metavar="J", help="drawn faults tried at a time (default 1)")
    p.add_argument("--longest", type=float, metavar="SECONDS",
                   help="with --random or --again: leave out tests that take more processor time, for a first look")
    p.add_argument("--board", choices=sorted(SCRIPTS), help="with --random or --again: faults in hal/stm32/ and in the folder of this port")
    p.add_argument("--kind", action="append", choices=KINDS, default=[], help="with --board: only faults of this kind; may be repeated")
    options = p.parse_args(arguments)
    if options.jobs < 1:
        raise UserError("--jobs must be 1 or more")
    if options.random is not None and options.random < 1:
        raise UserError("--random must be 1 or more")
    if (options.board or options.kind) and not (options.board and (options.again or options.random)):
        raise UserError("--kind goes with --board, and --board with --random or --again")
    if options.again or options.random is not None:
        packages.need("host", *(["target"] if options.board else []))
        drawn = (BoardRound(options.board, options.jobs, options.longest, tuple(options.kind)) if options.board
                 else Round(options.jobs, options.longest))
        return drawn.again(options.seed, options.files) if options.again else drawn.run(options.random, options.seed, options.files)
    mutants = [m for m in load() if not options.files or any(m.file.endswith(f) for f in options.files)]
    if not mutants:
        raise UserError(f"{shown(LIST)} has no fault in {' or '.join(options.files)}")
    check(mutants)
    if options.list:
        print("\n".join(m.title() for m in mutants))
        return 0
    packages.need("host")
    return try_listed(mutants)


def load() -> list[Mutant]:
    with LIST.open("rb") as f:
        data = tomllib.load(f)
    out = []
    for group in data["group"]:
        for fault in group["faults"]:
            out.append(Mutant(group["file"], fault[0], fault[1], tuple(group["tests"]), group.get("format", "float")))
    return out


def check(mutants: list[Mutant]) -> None:
    for m in mutants:
        n = (ROOT / m.file).read_text(encoding="utf-8").count(m.old)
        if n != 1:
            raise UserError(f"{shown(LIST)}: in {m.file} the text {m.old!r} stands {n} times, it must stand once")


def try_listed(mutants: list[Mutant]) -> int:
    survivors, not_c = [], []
    done = 0
    progress = build.Progress("mutants")
    for number_format in sorted({m.format for m in mutants}):
        mine = [m for m in mutants if m.format == number_format]
        bench, tests = prepared(number_format, mine)
        for mutant in mine:
            done += 1
            progress.show(f"{done} of {len(mutants)}, {mutant.file}")
            try:
                if not noticed(bench, mutant, tests):
                    survivors.append(mutant)
            except NotCompiled:
                not_c.append(mutant)
    progress.end(f"{len(mutants)} tried")
    for mutant in survivors:
        print(f"not noticed: {mutant.title()}")
    for mutant in not_c:
        print(f"no fault that a test could notice, it does not compile: {mutant.title()}")
    print(f"mutants: {len(mutants)}, caught: {len(mutants) - len(survivors) - len(not_c)}")
    return 1 if survivors or not_c else 0


def prepared(number_format: str, mutants: list[Mutant]) -> tuple[Bench, dict]:
    """The tree with the programs of these faults' tests, which pass where nothing is wrong."""
    tree = Tree(number_format)
    known = {t.name: t for t in tree.tests()}
    wanted = sorted({name for m in mutants for name in m.tests})
    unknown = [name for name in wanted if name not in known]
    if unknown:
        raise UserError(f'{shown(LIST)}: there is no test "{unknown[0]}" ({number_format})')
    tests = {name: known[name] for name in wanted}
    tree.build(tuple(sorted({tree.target_of(p) for t in tests.values() for p in t.programs})))
    costs = Costs(tree)
    bench = Bench(tree, costs.measure(list(tests.values())))
    if costs.failing:
        raise RunFailed("without any fault already: " + ", ".join(costs.failing))
    return bench, tests


def noticed(bench: Bench, mutant: Mutant, tests: dict) -> bool:
    path = ROOT / mutant.file
    text = path.read_text(encoding="utf-8").replace(mutant.old, mutant.new)
    place: Path = mutants_folder() / "work" / "listed"
    return bench.attempt(path, text, [tests[name] for name in mutant.tests], place).test is not None
