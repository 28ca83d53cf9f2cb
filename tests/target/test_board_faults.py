#!/usr/bin/python3
"""Faults of the hardware in states of the firmware, on the virtual board with the pilot column.

    test_board_faults.py                     a sample
    test_board_faults.py --matrix FILE.md    all of them, printed as a page; --only REGEX some of them

A cell passes where the board has started again for the right reason (or did not restart where it must not), told so by its event, kept
its stored set, and never commanded an output outside its limits other than its safe value.
"""

import argparse
import csv
import re
import subprocess
import sys
import tempfile
import unittest
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from reflux import build, launch  # noqa: E402

FAULT_S, ASK_S, END_S = 300, 900, 960
LIMITS = {"Lr": (1.0, 9.0, 4.5), "Qrb": (0.4, 1.25, 0.0)}
GAIN, CHANGED = "12", "13"
LATER_NS = {"start": 40_000_000, "save": 1_000_000}  # the line that begins the state comes after the event
STATES = {
    "start": [f"{FAULT_S} ?reboot"],
    "manual": [],
    "auto": ["60 mode top auto", "60 mode bottom auto"],
    "commission": ["60 commission begin"],
    "save": [f"{FAULT_S - 60} set loop1.gain {CHANGED}", f"{FAULT_S} ?save"],
}
ANY = ("power-on", "watchdog", "reset-pin", "fault", "crystal", "requested")


@dataclass(frozen=True)
class Fault:
    """settings: NAME=VALUE in order; causes: of the restart, "" for none."""

    name: str
    settings: tuple[str, ...]
    causes: tuple[str, ...]
    flips: bool = False


def faults() -> list[Fault]:
    """The list of faults."""
    out = [Fault(f"power cut {s:g} s", (f"power_cut={s:g}",), ("power-on",)) for s in (0.001, 0.1, 2, 8)]
    out += [Fault(f"power cut, {n} instructions on", (f"after_instructions={n}", "power_cut=0.5"), ("power-on",))
            for n in (1, 777, 54321, 1234567)]
    out += [Fault(f"supply to {v:g} V and back", (f"supply={v:g}", "after_ns=500000000", "supply=3.3"), ("power-on",))
            for v in (2.6, 1.8, 0.5)]
    out += [Fault("supply to 2.85 V and back", ("supply=2.85", "after_ns=500000000", "supply=3.3"), ("",))]
    out += [Fault(f"supply ramp to {v:g} V in {t:g} s and back",
                  (f"ramp_time={t:g}", f"supply_ramp={v:g}", "after_ns=3000000000", "supply=3.3"),
                  ("power-on",)) for v, t in ((2.5, 0.05), (2.0, 0.25), (0.0, 2))]
    out += [Fault("crystal stops", ("crystal=0",), ("crystal",)),
            Fault("crystal stops and comes back", ("crystal=0", "after_ns=100000000", "crystal=8000000"), ("crystal",)),
            Fault("crystal 1 % low", ("crystal=7920000",), ("",)),
            Fault("crystal 2 % high", ("crystal=8160000",), ("",))]
    out += [Fault(f"watchdog's clock {hz} Hz", (f"slow_clock={hz}",), ("",)) for hz in (17000, 47000)]
    out += [Fault(f"button {s:g} s", (f"button={s:g}",), ("reset-pin",)) for s in (0.00001, 0.3, 4)]
    out += [Fault(f"button, {n} instructions on", (f"after_instructions={n}", "button=0.01"), ("reset-pin",))
            for n in (99, 98765)]
    out += [Fault("main loop hangs", ("hang_main=1",), ("watchdog",)), Fault("tick hangs", ("hang_tick=1",), ("watchdog",)),
            Fault("main loop hangs 0.2 s", ("hang_main=1", "after_ns=200000000", "hang_main=0"), ("",)),
            Fault("tick hangs 0.1 s", ("hang_tick=1", "after_ns=100000000", "hang_tick=0"), ("",))]
    out += [Fault(f"noise on the plant link, {n} bytes in a million", (f"noise_link={n}", "after_ns=5000000000", "noise_link=0"), ("",))
            for n in (100, 2000, 20000)]
    out += [Fault("plant link unplugged 3 s", ("unplug_link=3",), ("",)),
            Fault("console unplugged 1 s", ("unplug_console=1",), ("",))]
    for what in ("ram", "ccm", "flash", "stored", "register"):
        out += [Fault(f"{bits} bits of {what}, place {place}", (f"place={place}", f"flip_{what}={bits}"), ANY + ("",), True)
                for place, bits in ((1, 1), (2, 1), (3, 8))]
    out += [Fault(f"supply goes in word {n} of the next save", (f"flash_cut_word={n}", "off_time=0.5"), ("power-on", ""))
            for n in (1, 17, 40)]
    out += [Fault(f"supply goes at {p} per mille of the next erase", ("off_time=0.5", f"flash_cut_erase={p}"), ("power-on", ""))
            for p in (10, 500, 990)]
    return out


@dataclass
class Cell:
    """What came of one fault in one state."""

    passed: bool
    kind: str
    words: str


def run(fault: Fault, state: str, board_seed: int = 1) -> Cell:
    """One cell: the set is saved first, then the state is entered, then the fault comes."""
    conf = board.ROOT / "host_sim" / "scenarios" / "pilot.conf"
    lines = [f"0 {line}" for line in conf.read_text().splitlines() if line and not line.startswith("#")]
    lines += ["10 mode top manual", "10 mode bottom manual", "20 save", "30 out Lr 4.5", "30 out Qrb 0.8", *STATES[state],
              f"{ASK_S} ?version", f"{ASK_S} ?get loop1.gain", f"{ASK_S} ?events"]
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        place = Path(folder)
        (place / "script").write_text("\n".join(lines) + "\n")
        settings = fault.settings
        if state in LATER_NS and not settings[0].startswith("after"):
            settings = (f"after_ns={LATER_NS[state]}", *settings)
        events = [word for setting in settings for word in ("--event", f"{FAULT_S}:board.{setting}")]
        with launch.start("board", extra=("--seed", str(board_seed), "--nvm", str(place / "nvm"))) as firmware:
            sim = subprocess.run(
                [str(build.find_program("host", "reflux-sim")), "--plant", "pilot", "--port", firmware.link, "--console",
                 firmware.console, "--script", str(place / "script"), "--transcript", str(place / "transcript"), "--log",
                 str(place / "log"), "--duration", str(END_S), *events],
                capture_output=True, text=True, timeout=120, check=False)
            if firmware.process:
                try:
                    firmware.process.wait(timeout=2)
                except subprocess.TimeoutExpired:
                    pass
            verdict = firmware.died() or ""
        transcript = (place / "transcript").read_text(errors="replace")
        if sim.returncode and not verdict.count("status 3"):
            transcript += stored_set(place)
        log = (place / "log").read_text(errors="replace").splitlines()
    return judge(fault, state, transcript, log, sim.stderr.strip().splitlines()[-1:] if sim.returncode else [], verdict)


def stored_set(place: Path) -> str:
    """What a second start says of the set, where the run ended with the reply that did not come."""
    (place / "script").write_text("0 get loop1.gain\n")
    with launch.start("board", extra=("--nvm", str(place / "nvm"))) as firmware:
        subprocess.run([str(build.find_program("host", "reflux-sim")), "--plant", "pilot", "--port", firmware.link, "--console",
                        firmware.console, "--script", str(place / "script"), "--transcript", str(place / "after"), "--duration", "0"],
                       capture_output=True, timeout=60, check=False)
    return (place / "after").read_text(errors="replace")


def judge(fault: Fault, state: str, transcript: str, log: list[str], failed: list[str], verdict: str) -> Cell:
    """Compares what was said and done with the oracle."""
    causes = [cause for cause in re.findall(r"started in the safe state: ([\w-]+) \(STARTED\)", transcript)][1:]
    if failed and causes:
        causes.pop()  # the second start, which only looks at the set
    if state == "start" and "requested" in causes:
        causes.remove("requested")
    gains = re.findall(r"loop1\.gain ([0-9.]+)", transcript)
    answered = f"{ASK_S}.000 < started by" in transcript
    wrong = []
    rows = list(csv.DictReader(line for line in log if not line.startswith("#")))
    for row in rows:
        for name, (lo, hi, safe) in LIMITS.items():
            value = next(float(cell) for key, cell in row.items() if key.startswith(f"{name}.cmd"))
            if row[f"{name}.drive"] == "1" and not lo <= value <= hi and abs(value - safe) > 1e-6:
                wrong.append(f"{name} at {value:g}")
    told = next((cause for cause in causes), "")
    if state == "save" and any("restarted before" in words for words in failed):
        told = told or fault.causes[0]  # the run ends with the reply that did not come, before the console tells why
    if told not in fault.causes:
        wrong.append(f"started by {told or 'nothing'}")
    if "status 3" in verdict:
        wrong.append(f"verdict: {verdict.split(': ', 2)[-1]}")
    if gains and float(gains[-1]) not in (float(GAIN), float(CHANGED) if state == "save" else float(GAIN)):
        wrong.append(f"gain {gains[-1]}")
    if not gains and "status 3" not in verdict:
        wrong.append("the set is lost")
    if not answered and state != "save":
        wrong.append("no answer: " + " ".join(failed)[-100:])
    kind = "told" if causes or failed or verdict.count("status 3") else "masked or silent"
    return Cell(not wrong, kind, "; ".join(dict.fromkeys(wrong)) or (f"started by {told}" if told else "ran on"))


def matrix(path: Path, only: str) -> int:
    """Runs the cells and prints them as a page."""
    rows, failed, n = [], [], 0
    flips: dict[str, int] = {}
    for fault in faults():
        if not re.search(only, fault.name):
            continue
        cells = [run(fault, state) for state in STATES]
        n += len(cells)
        rows.append(f"| {fault.name} | " + " | ".join(("" if c.passed else "**no**: ") + c.words for c in cells) + " |")
        failed += [f"{fault.name}, {state}: {c.words}" for state, c in zip(STATES, cells) if not c.passed]
        if fault.flips:
            for cell in cells:
                flips[cell.kind] = flips.get(cell.kind, 0) + 1
        print(rows[-1], flush=True)
        path.write_text("\n".join([
            "# Faults of the hardware on the virtual board", "",
            "`tests/target/test_board_faults.py --matrix FILE` writes this page: the STM32F405 image (float) with the pilot column, one fault at",
            "300 s of plant time in each of five states. A cell says what the board did; **no** marks one that breaks the oracle at the head of the",
            "script.", "", f"{n} cells, {len(failed)} of them against the oracle. Flipped bits: "
            + (", ".join(f"{kind} {count}" for kind, count in sorted(flips.items())) or "none run") + ".", "",
            "| fault | " + " | ".join(STATES) + " |", "|---|" + "---|" * len(STATES), *rows, ""]))
    return 1 if failed else 0


class BoardFaultsTest(unittest.TestCase):
    def test_sample(self) -> None:
        by_name = {fault.name: fault for fault in faults()}
        for name, state in (("power cut 0.1 s", "manual"), ("supply to 2.6 V and back", "auto"), ("crystal stops", "auto"),
                            ("main loop hangs", "manual"), ("tick hangs", "auto"), ("button 0.3 s", "manual"),
                            ("plant link unplugged 3 s", "auto")):
            with self.subTest(fault=name, state=state):
                cell = run(by_name[name], state)
                self.assertTrue(cell.passed, cell.words)


if __name__ == "__main__":
    if "--matrix" in sys.argv:
        parser = argparse.ArgumentParser()
        parser.add_argument("--matrix", type=Path)
        parser.add_argument("--only", default="")
        given = parser.parse_args()
        sys.exit(matrix(given.matrix, given.only))
    unittest.main()
