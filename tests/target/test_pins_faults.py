#!/usr/bin/python3
"""Faults of chips, buses and loads at the board's own pins in states of the firmware, with the pilot column and models of the chips.

    test_pins_faults.py [all]                a share of the cells on the host, and faults of each bus on the flashed image; all: every cell on the
                                         host, and a few on the image
    test_pins_faults.py --matrix FILE.md     every cell, printed as a page; --only REGEX: of cells with such names, `device | fault | state`
        --board                              on the flashed image of the virtual board
        --jobs N                             N cells at a time

What must hold in a cell is at the head of tests/support/pins_faults_judge.py.
"""

import argparse
import contextlib
import re
import subprocess
import sys
import tempfile
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Callable

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from pins_faults import (  # noqa: E402
    DEVICES, LOADS, NOT_SHOWN, PULSES, STATES, STATES_OF_LOADS, Cell, Job, Run, find, jobs, run, settings, simulate)
from pins_faults_judge import judge  # noqa: E402
from pins_proofs import BROKEN, PROOFS, PROVED, SHORTED, judge_proof, proof_jobs, simulate_proof, states_of  # noqa: E402
from sample import EVERY  # noqa: E402

from reflux import build  # noqa: E402

IMAGE = "stm32f405"
BOARD = board.ROOT / "build" / "host" / "reflux-board"
SHARE = 23  # of the cells, the default test runs one in so many; the states and the faults of a device have no such factor
ON_BOARD = (Job("max31865", "open", "auto"), Job("max31856", "missing chip", "sequence"), Job("ads1115, 4-20 mA", "bus stuck low", "auto, safe"),
            Job("ad5422, 4-20 mA", "missing chip", "auto"), Job("flow", "no pulses", "auto"), Job("level", "chatters each 5 ms", "auto"))


# A chip of each bus with faults that overlap, plant time in s.
MIXED_WIRING = ["T1 max31865 spi1 PA4 reference=430 wires=3", "T2 ds18b20 wire1 rom=28-000005e2fdc3", "T7 max31856 spi2 PC0 type=K",
                "T9 ads1115 i2c1 0x48 2 lo=0 hi=200 lo_in=0.4 hi_in=2", "T10 max31865 spi1 PB12 reference=430 wires=3", *PULSES]
MIXED_ROWS = (("T2", "device ds18b20", "bus wire1", "select 28000005e2fdc3"), ("T7", "device max31856", "bus spi2", "select PC0", "type K"),
              ("T9", "device ads1115", "bus i2c1", "select 0x48", "input 2", "type 4-20mA", "lo 0", "hi 200"))
MIXED_EVENTS = ["8:T1.open=1", "9:T2.power_loss=1", "10:T7.missing=1", "11:i2c1.stuck=1", "12:T2.power_loss=0", "14:T1.open=0", "14:T7.missing=0",
                "15:i2c1.stuck=0", "16:T10.wrong=1", "18:T9.open=1", "19:T10.wrong=0", "20:wire1.stuck=1", "21:T9.open=0", "22:wire1.stuck=0"]
MIXED_END_S = 28


def mixed(place: Path | None = None, wire: Callable[[Path], str] | None = None) -> Run:
    more = ["set meas1.hold 2"]
    for n, (name, *rows) in enumerate(MIXED_ROWS, 3):
        more += [f"set chan{n}.{row}" for row in (f"name {name}", "unit degC", *rows)]
        more += [f"set meas{n}.{row}" for row in (f"name {name}", "unit degC", "lo 0", "hi 200")]
    lines = [f"0 {line}" for line in settings(DEVICES[0], LOADS[3], STATES["auto"], tuple(more))]
    lines += ["3 out Lr 4.5", "3 out Qrb 0.8", "5 mode top auto", "5 mode bottom auto"]
    return run(MIXED_WIRING, lines, MIXED_EVENTS, MIXED_END_S, place, wire)


def all_jobs() -> list[Job]:
    return jobs() + proof_jobs()


def cell_of(job: Job, *board: object) -> Cell:
    """On the host, or in a folder on a board that a function starts with a wiring file."""
    return judge_proof(job, simulate_proof(job, *board)) if job.device in PROVED else judge(job, simulate(job, *board))


def on_host(job: Job) -> Cell:
    return cell_of(job)


@contextlib.contextmanager
def virtual_board():
    """A folder, a function that starts a board with a wiring file there and gives its port, and what boards said at their end."""
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder, contextlib.ExitStack() as stack:
        control, said = Path(folder) / "control", []

        def wire(wiring: Path) -> str:
            process = subprocess.Popen([str(BOARD), "--image", str(build.find_image(IMAGE)), "--control", str(control), "--wiring", str(wiring)],
                                       stderr=subprocess.PIPE, text=True)
            stack.callback(lambda: said.append(process.communicate(timeout=board.PATIENCE_S)[1].strip()))
            end = time.monotonic() + board.PATIENCE_S
            while not control.exists():
                if process.poll() is not None or time.monotonic() > end:
                    process.kill()
                    raise RuntimeError("reflux-board did not start")
                time.sleep(0.01)
            return f"board:{control}"

        yield Path(folder), wire, said


def on_board(job: Job) -> Cell:
    """On the flashed image: both ends have the same wiring file."""
    with virtual_board() as (folder, wire, said):
        cell = cell_of(job, folder, wire)
    cell.wrong += [f"the board: {words[-200:]}" for words in said if words]
    return cell


def of_device(device: str, states: list[str], cells: dict[Job, Cell]) -> list[str]:
    """The rows of one device or load."""
    out = []
    for fault in dict.fromkeys(job.fault for job in cells if job.device == device):
        row = [cells.get(Job(device, fault, state)) for state in states]
        words = [("" if not cell.wrong else "**no**: " + "; ".join(cell.wrong) + " - ") + cell.words if cell else "-" for cell in row]
        why = "" if device in PROVED else f" | {find(Job(device, fault, states[0]))[2].why or '-'}"
        out.append(f"| {fault} | " + " | ".join(words) + f"{why} |")
    return out


def page(cells: dict[Job, Cell], where: str) -> str:
    """The cells as a page."""
    wrong = sum(bool(cell.wrong) for cell in cells.values())
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False).stdout.strip()
    out = ["# Faults at the board's own pins", "",
           "`tests/target/test_pins_faults.py --matrix FILE` prints this page: the pilot column at the pins, T1 behind each kind of device in turn,",
           "one fault in each state, and the outputs with each kind of load. `tests/support/pins_faults_judge.py` says what must hold. Then outputs",
           "with `out.proof` on the cold pilot column: `tests/support/pins_proofs.py`.", "",
           f"Commit {commit}, {where}: {len(cells)} cells, {wrong} of them against that.", "",
           "A cell says how soon the fault was told and with which words, and what then had the plant. A fault that no chip reports has the reason",
           "in the last column. In all cells the outputs were within their limits or safe, or let fall where their chip had the fault, unless the cell says",
           "otherwise."]
    for name, states in [(device.name, list(STATES)) for device in DEVICES] + [(load.name, list(STATES_OF_LOADS)) for load in LOADS]:
        if any(job.device == name for job in cells):
            out += ["", f"## {name}", "", "| fault | " + " | ".join(states) + " | why |", "|---|" + "---|" * (len(states) + 1)]
            out += of_device(name, states, cells)
    for proof in PROOFS:
        if any(job.device == proof.name for job in cells):
            states = states_of(proof.name)
            out += ["", f"## {proof.name}", "", "| fault | " + " | ".join(states) + " |", "|---|" + "---|" * len(states)]
            out += of_device(proof.name, states, cells)
    return "\n".join([*out, "", "## Not shown", "", *(f"- `{kind}`: {why}." for kind, why in NOT_SHOWN.items()), ""])


def main() -> int:
    p = argparse.ArgumentParser()
    p.add_argument("--matrix", type=Path, required=True)
    p.add_argument("--only", default="")
    p.add_argument("--board", action="store_true")
    p.add_argument("--jobs", type=int, default=1)
    given = p.parse_args()
    wanted = [job for job in all_jobs() if re.search(given.only, str(job))]
    with ThreadPoolExecutor(given.jobs) as pool:
        cells = {}
        for job, cell in zip(wanted, pool.map(on_board if given.board else on_host, wanted)):
            cells[job] = cell
            if cell.wrong:
                print(f"against the oracle: {job}: {'; '.join(cell.wrong)}", flush=True)
    given.matrix.write_text(page(cells, "flashed image on the virtual board" if given.board else "host"), encoding="utf-8")
    print(f"{len(cells)} of {len(all_jobs())} cells")
    return 1 if any(cell.wrong for cell in cells.values()) else 0


class PinsFaultsTest(unittest.TestCase):
    def test_cells_on_the_host(self) -> None:
        wanted = all_jobs() if EVERY else all_jobs()[::SHARE]
        with ThreadPoolExecutor(2) as pool:
            for job, cell in zip(wanted, pool.map(on_host, wanted)):
                with self.subTest(str(job)):
                    self.assertEqual(cell.wrong, [], cell.words)

    def test_a_rule_of_a_data_sheet_that_is_broken_is_said_at_the_end_of_a_run(self) -> None:
        """Else no cell could find one. Nobody can know that a chip converts whose data line is stuck."""
        run_ = simulate(Job("max31865", "bus stuck low", "auto, each other second"))
        self.assertIn("max31865: register 00h: 1-shot while it converts", run_.warned)

    @unittest.skipUnless(BOARD.exists(), "no reflux-board: libunicorn-dev is not installed")
    def test_the_flashed_image_tells_the_faults_of_each_bus_as_the_host_does(self) -> None:
        host = mixed()
        with virtual_board() as (folder, wire, said):
            image = mixed(folder, wire)
        self.assertEqual((host.failed, image.failed, said), ("", "", [""]))
        self.assertEqual(host.said, image.said)
        told = {who for _, code, who, _ in host.said if code == "SENSOR_FAULT"}
        self.assertEqual(told, {"T1", "T2", "T7", "T9", "T10"})
        self.assertIn("MANUAL_BY_BOARD", {code for _, code, _, _ in host.said})

    @unittest.skipUnless(EVERY and BOARD.exists(), "minutes each: in the full tier")
    def test_cells_on_the_flashed_image(self) -> None:
        for job in ON_BOARD:
            with self.subTest(str(job)):
                cell = on_board(job)
                self.assertEqual(cell.wrong, [], cell.words)
                self.assertEqual(cell.words, on_host(job).words)

    def test_the_sample_has_each_device_and_each_state(self) -> None:
        sample = jobs()[::SHARE]
        self.assertEqual({job.state for job in sample}, set(STATES))
        self.assertEqual({job.device for job in sample} & {device.name for device in DEVICES}, {device.name for device in DEVICES})

    def test_each_shorted_and_each_broken_load_that_is_proved_is_told(self) -> None:
        """A kind of heater and a kind of flow; the others are in the full tier."""
        for job in proof_jobs():
            if job.device in ("ad5422, 0-10 V, heater proved", "stepper, flow proved") or (job.device.startswith("pwm, flow") and job.fault == SHORTED):
                with self.subTest(str(job)):
                    cell = on_host(job)
                    self.assertEqual(cell.wrong, [], cell.words)
                    self.assertEqual(cell.words == "not told", job.fault not in (SHORTED, BROKEN))

    def test_every_kind_of_device_and_output_has_cells_or_a_reason(self) -> None:
        """By the page of what there is at the pins."""
        pins = (board.ROOT / "docs" / "reference" / "pins.md").read_text(encoding="utf-8")
        tables = [pins.split(f"## {part}\n")[1].split("\n## ")[0].split("\n|---")[1] for part in ("Devices", "Outputs")]
        known = [name for rows in tables for name in re.findall(r"^\| `(\w+)`", rows, re.MULTILINE)]
        shown = {job.device.split(",")[0] for job in all_jobs()}
        self.assertGreater(len(known), 15)
        self.assertEqual([name for name in known if name not in shown and name not in NOT_SHOWN], [])


if __name__ == "__main__":
    if "--matrix" in sys.argv:
        sys.exit(main())
    unittest.main()
