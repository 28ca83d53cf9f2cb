#!/usr/bin/python3
"""Faults of the hardware in states of the firmware, on the virtual board with the pilot column.

    test_board_faults.py [all]               a cell for each kind of fault; all: every cell but those of flipped bits (test_board_flips.py)
    test_board_faults.py --matrix FILE.md    every cell and the flipped bits, printed as a page; --only REGEX: of faults with such names
        --cells FILE.jsonl                   keeps each cell as it comes, and takes those that are there already
        --for S, --jobs N                    ends after so many seconds, N cells at a time

A cell passes where the board has started again for the right reason (or not at all where it must not) and has told it, has kept its stored set,
where the plant was never told an output outside its limits other than the safe value, and where its outputs were safe within the stated time
(tests/support/board_faults.py). Of flipped bits (board_flips.py) none may be silent in the image, in the stored set and in retained memory.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from board_faults import STATES, Cell, Fault, Flash, faults, run  # noqa: E402
from board_flips import CLASSES, KINDS, MEANING, SEEDS, Flip, Flips, broken  # noqa: E402
from sample import EVERY  # noqa: E402

Job = tuple[str, str, int]  # name, state, seed; 0: no flip


def jobs(only: str = "") -> list[Job]:
    """Every cell."""
    out = [(fault.name, state, 0) for fault in faults() for state in STATES if re.search(only, fault.name)]
    return out + [(kind.name, state, seed) for kind in KINDS for state in STATES for seed in range(1, SEEDS + 1) if re.search(only, kind.name)]


def sample() -> list[Job]:
    """One of each kind, the states in turn."""
    first: dict[str, Fault] = {}
    for fault in faults():
        first.setdefault(fault.kind, fault)
    states = list(STATES)
    return [(fault.name, states[n % len(states)], 0) for n, fault in enumerate(first.values())]


class Matrix:
    """Runs cells."""

    def __init__(self, folder: Path) -> None:
        flash = Flash(folder)
        self.flash, self.flips = flash, Flips(flash)
        self.faults = {fault.name: fault for fault in faults()}
        self.kinds = {kind.name: kind for kind in KINDS}

    def run(self, job: Job) -> Cell | Flip:
        name, state, seed = job
        return run(self.faults[name], state, self.flash) if seed == 0 else self.flips.run(self.kinds[name], state, seed)

    def wrong(self, cell: Cell | Flip) -> str:
        """What breaks the oracle; empty: nothing."""
        if isinstance(cell, Cell):
            return "" if cell.passed else cell.words
        return broken(cell)


def page(done: dict[Job, Cell | Flip], matrix: Matrix) -> str:
    """The cells as a page."""
    cells = {job: cell for job, cell in done.items() if isinstance(cell, Cell)}
    flips = [cell for cell in done.values() if isinstance(cell, Flip)]
    names = [name for name in matrix.faults if all((name, state, 0) in cells for state in STATES)]
    wrong = sum(matrix.wrong(cell) != "" for cell in done.values())
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False).stdout.strip()
    out = ["# Faults of the hardware on the virtual board", "",
           "`tests/target/test_board_faults.py --matrix FILE` prints this page: the STM32F405 image (float) with the pilot column, one fault in each of",
           "five states. The head of the script says what must hold.", "",
           f"Commit {commit}: {len(names)} faults and {len(matrix.kinds)} kinds of flipped bits, {len(done)} runs, {wrong} of them against that.", "",
           "A cell has the reason of the restart as told, and the time from the moment that the board was gone until the plant's outputs were safe. Last is",
           "the time that the pages promise.", "",
           "| fault | " + " | ".join(STATES) + " | stated |", "|---|" + "---|" * (len(STATES) + 1)]
    for name in names:
        row = [cells[name, state, 0] for state in STATES]
        stated = f"{matrix.faults[name].safe_s:.2f} s" if any(cell.safe_s is not None for cell in row) else "-"
        out.append(f"| {name} | " + " | ".join(("" if cell.passed else "**no**: ") + cell.words for cell in row) + f" | {stated} |")
    out += ["", "Flipped bits, one in each run, places and instants by seed; each run is compared with one without the flip. These runs read little of the",
            "RAM, and nothing of the CCM, which holds the workspace of a start-up.", "",
            "| what is hit | runs | " + " | ".join(CLASSES) + " |", "|---|---:|" + "---:|" * len(CLASSES)]
    for kind in matrix.kinds:
        of_kind = [flip.outcome for flip in flips if flip.kind == kind]
        out.append(f"| {kind} | {len(of_kind)} | " + " | ".join(str(of_kind.count(outcome)) for outcome in CLASSES) + " |")
    return "\n".join([*out, "", *(f"- *{outcome}*: {MEANING[outcome]}." for outcome in CLASSES), ""])


def load(path: Path | None) -> dict[Job, Cell | Flip]:
    out: dict[Job, Cell | Flip] = {}
    for line in path.read_text().splitlines() if path is not None and path.exists() else ():
        row = json.loads(line)
        out[tuple(row["job"])] = (Flip if row["job"][2] else Cell)(**row["cell"])
    return out


def main() -> int:
    p = argparse.ArgumentParser()
    p.add_argument("--matrix", type=Path, required=True)
    p.add_argument("--only", default="")
    p.add_argument("--cells", type=Path)
    p.add_argument("--for", type=float, default=float("inf"), dest="seconds")
    p.add_argument("--jobs", type=int, default=1)
    given = p.parse_args()
    end, done = time.monotonic() + given.seconds, load(given.cells)
    todo = [job for job in jobs(given.only) if job not in done]
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder, ThreadPoolExecutor(given.jobs) as pool:
        matrix = Matrix(Path(folder))

        def one(job: Job) -> tuple[Job, Cell | Flip | None]:
            return job, matrix.run(job) if time.monotonic() < end else None

        for job, cell in pool.map(one, todo):
            if cell is None:
                continue
            done[job] = cell
            print(*job, cell, flush=True)
            if given.cells is not None:
                with given.cells.open("a") as out:
                    out.write(json.dumps({"job": job, "cell": asdict(cell)}) + "\n")
        given.matrix.write_text(page(done, matrix))
        wrong = {job: words for job, cell in done.items() if (words := matrix.wrong(cell))}
    for job, words in wrong.items():
        print("against the oracle:", *job, words)
    print(f"{sum(job in done for job in jobs(given.only))} of {len(jobs(given.only))} cells")
    return 1 if wrong else 0


class BoardFaultsTest(unittest.TestCase):
    def test_cells(self) -> None:
        wanted = [(name, state) for name, state, seed in jobs() if seed == 0] if EVERY else [job[:2] for job in sample()]
        by_name = {fault.name: fault for fault in faults()}
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder, ThreadPoolExecutor(2) as pool:
            flash = Flash(Path(folder))
            for (name, state), cell in zip(wanted, pool.map(lambda job: run(by_name[job[0]], job[1], flash), wanted)):
                with self.subTest(name=name, state=state):
                    self.assertTrue(cell.passed, cell.words)

    def test_the_list_has_forty_faults_and_five_states(self) -> None:
        self.assertGreaterEqual(len({fault.name for fault in faults()}), 40)
        self.assertEqual(len(STATES), 5)


if __name__ == "__main__":
    if "--matrix" in sys.argv:
        sys.exit(main())
    unittest.main()
