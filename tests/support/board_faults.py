"""Faults of the hardware in states of the firmware, on the virtual board with the pilot column: the list, a run, and what must hold in each.

Times are those of the board. Plant time goes on 60 times as fast, 30 s in each 0.5 s, so that the board's own clocks, watchdog and checks of
its background have the time that they need.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path

from board import PATIENCE_S, ROOT
from reflux import build, launch

TICK_S, SPEED = 30, 60
ENTER_S, FAULT_S = 60, 120  # plant time
LIMITS = {"Lr": (1.0, 9.0, 4.5), "Qrb": (0.4, 1.25, 0.0)}
GAIN, CHANGED = "12", "13"
NEARLY_FULL = 102  # saves that leave the slot in use 20,640 bytes; a start that finds less than 19,568 erases the other slot for the next save
MORE_SAVES = [f"{TICK_S} {line}" for ti in (201, 202, 200) for line in (f"set loop1.ti {ti}", "save")]
LATER_NS = {"start": 40_000_000, "save": 1_000_000}  # the line that begins the state comes after the event
STATES = {
    "start": [f"{FAULT_S} ?reboot"],
    "manual": [],
    "auto": [f"{ENTER_S} mode top auto", f"{ENTER_S} mode bottom auto"],
    "commission": [f"{ENTER_S} commission begin"],
    "save": [f"{ENTER_S} set loop1.gain {CHANGED}", f"{FAULT_S} ?save"],
}
# How soon the plant's outputs must be safe, s.
SILENCE_S = 2.0   # docs/inside/plant-link.md 4.3: no valid frame for so long
TURN_S = 1.0      # docs/inside/faults.md: the watchdog is fed for so long after the last turn of the main loop
WATCHDOG_S = 2.0  # likewise, with its clock at
SLOW_CLOCK_HZ = 32000
LOOK_S = 0.005    # a frame on its way takes 2 ms, the plant looks every millisecond
ROOM_FOR_START_S = 3.0  # of the board, after a fault is over


@dataclass(frozen=True)
class Fault:
    """settings: NAME=VALUE in order. causes: of the restarts, in order; several lists where there is a choice. lasts_s: until it is over."""

    kind: str
    name: str
    settings: tuple[str, ...]
    causes: tuple[tuple[str, ...], ...]
    lasts_s: float = 0.0
    safe_s: float = SILENCE_S  # from the moment that the board is gone
    saves: bool = False        # a save is under way in every state
    full: bool = False         # the flash for settings has so little room that the start after the fault erases the other half


POWER, PIN, WATCHDOG, CRYSTAL, NOTHING = (("power-on",),), (("reset-pin",),), (("watchdog",),), (("crystal",),), ((),)


def faults() -> list[Fault]:
    """All but flipped bits (board_flips.py)."""
    out = [Fault("power cut", f"power cut {s:g} s", (f"power_cut={s:g}",), POWER, s) for s in (0.001, 0.1, 2, 8)]
    out += [Fault("power cut", f"power cut {n} instructions on", (f"after_instructions={n}", "power_cut=0.5"), POWER, 0.5)
            for n in (1, 777, 54321, 1234567)]
    out += [Fault("supply", f"supply {v:g} V for 0.5 s", (f"supply={v:g}", "after_ns=500000000", "supply=3.3"), POWER if v < 2.7 else NOTHING, 0.5)
            for v in (2.85, 2.6, 1.8, 0.5)]
    out += [Fault("ramp", f"supply ramp to {v:g} V in {down:g} s, back in {up:g} s",
                  (f"ramp_time={down:g}", f"supply_ramp={v:g}", f"ramp_time={up:g}", f"after_ns={round((down + 0.5) * 1e9)}", "supply_ramp=3.3"),
                  POWER, down + up + 0.5)
            for v, down, up in ((2.5, 0.05, 0.05), (2, 0.5, 0.01), (1.2, 0.01, 1), (0, 0.1, 2), (0, 2, 0.1), (2.65, 4, 1))]
    out += [Fault("crystal", "crystal stops", ("crystal=0",), CRYSTAL),
            Fault("crystal", "crystal stops, back after 0.1 s", ("crystal=0", "after_ns=100000000", "crystal=8000000"), CRYSTAL),
            Fault("crystal", "crystal 1 % low", ("crystal=7920000",), NOTHING),
            Fault("crystal", "crystal 2 % high", ("crystal=8160000",), NOTHING)]
    out += [Fault("crystal", f"power cut, then {what}", ("power_cut=0.5", "after_ns=200000000", f"crystal={hz}"), POWER, 0.5)
            for what, hz in (("no crystal", 0), ("a crystal of 12 MHz", 12000000), ("a crystal of 10 MHz", 10000000))]
    for hz in (17000, 47000):
        slow = SLOW_CLOCK_HZ / hz
        out += [Fault("watchdog's clock", f"watchdog's clock {hz} Hz", (f"slow_clock={hz}",), NOTHING),
                Fault("watchdog's clock", f"watchdog's clock {hz} Hz, main loop hangs",
                      (f"slow_clock={hz}", "after_ns=500000000", "hang_main=1"), WATCHDOG, 5.3, TURN_S + WATCHDOG_S * slow + SILENCE_S),
                Fault("watchdog's clock", f"watchdog's clock {hz} Hz, tick hangs",
                      (f"slow_clock={hz}", "after_ns=500000000", "hang_tick=1"), WATCHDOG, 4.3)]
    out += [Fault("button", f"button {s:g} s", (f"button={s:g}",), PIN, s) for s in (0.00001, 0.3, 4)]
    out += [Fault("button", f"button {n} instructions on", (f"after_instructions={n}", "button=0.01"), PIN) for n in (99, 98765, 1234567)]
    out += [Fault("hang", "main loop hangs", ("hang_main=1",), WATCHDOG, 3, TURN_S + WATCHDOG_S + SILENCE_S),
            Fault("hang", "tick hangs", ("hang_tick=1",), WATCHDOG, 2),
            Fault("hang", "main loop hangs 0.2 s", ("hang_main=1", "after_ns=200000000", "hang_main=0"), NOTHING),
            Fault("hang", "tick hangs 0.1 s", ("hang_tick=1", "after_ns=100000000", "hang_tick=0"), NOTHING)]
    out += [Fault("noise", f"noise on the {line}, {n} ppm of bytes, 5 s", (f"noise_{line}={n}", "after_ns=5000000000", f"noise_{line}=0"), NOTHING, 5)
            for line, n in (("link", 100), ("link", 2000), ("link", 20000), ("console", 2000), ("console", 20000))]
    out += [Fault("unplugged", f"link unplugged {s:g} s", (f"unplug_link={s:g}",), NOTHING, s) for s in (0.3, 3)]
    out += [Fault("unplugged", "console unplugged 1 s", ("unplug_console=1",), NOTHING, 1),
            Fault("unplugged", "both lines unplugged 3 s", ("unplug_link=3", "unplug_console=3"), NOTHING, 3)]
    out += [Fault("cut save", f"supply goes in word {n} of a save", (f"flash_cut_word={n}", "off_time=0.5"), POWER, 1, saves=True) for n in (1, 17, 130, 258)]
    out += [Fault("cut erase", f"supply goes at {p} per mille of an erase", ("off_time=0.5", f"flash_cut_erase={p}", "button=0.01"),
                  (("reset-pin", "power-on"),), 2, full=True) for p in (10, 500, 990)]
    return out


@dataclass
class Run:
    """What was said and done."""

    transcript: str
    log: str
    outputs: list[list[str]]   # board's ms, why, values
    diary: list[tuple[float, str]]
    memory: bytes
    failed: str                # of the simulator
    verdict: str               # of the board: what no chip takes
    after: str = ""            # said by a second start, where a reply did not come in the first


def simulate(state: str, settings: tuple[str, ...], after_s: float, nvm: Path, more: list[str] | None = None) -> Run:
    """The board starts with what is stored, the state is entered, the fault comes, and the board goes on for after_s. more: console lines."""
    end_s = FAULT_S + TICK_S * round(after_s * SPEED / TICK_S)
    lines = [f"{TICK_S} out Lr 4.5", f"{TICK_S} out Qrb 0.8", *STATES[state], *(more or [])]
    lines.sort(key=lambda line: float(line.split(" ", 1)[0]))
    lines += [f"{end_s} ?{line}" for line in ("version", "status", "get loop1.gain", "events")]
    if state in LATER_NS and settings and not settings[0].startswith("after_"):
        settings = (f"after_ns={LATER_NS[state]}", *settings)
    events = [word for setting in settings for word in ("--event", f"{FAULT_S}:board.{setting}")]
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        place = Path(folder)
        shutil.copy(nvm, place / "nvm")
        failed, verdict = start(place, lines, end_s, "--outputs", str(place / "outputs"), *events,
                                board=("--diary", str(place / "diary"), "--memory", str(place / "memory")))
        transcript = (place / "transcript").read_text(errors="replace")
        log, memory = (place / "log").read_text(errors="replace"), (place / "memory").read_bytes()
        after = ""
        if failed and not verdict:
            start(place, [f"{2 * TICK_S} get loop1.gain"], 2 * TICK_S)
            after = (place / "transcript").read_text(errors="replace")
        return Run(transcript, log, [row.split(",") for row in (place / "outputs").read_text().splitlines()[1:]],
                   [(float(line.split(" ", 1)[0]), line.split(" ", 1)[1]) for line in (place / "diary").read_text().splitlines()],
                   memory, failed, verdict, after)


def start(place: Path, lines: list[str], end_s: float, *options: str, board: tuple[str, ...] = ()) -> tuple[str, str]:
    """A run with the flash in the folder. Returns why it failed, and the board's verdict: what no chip takes."""
    (place / "script").write_text("\n".join(lines) + "\n")
    with launch.start("board", extra=("--nvm", str(place / "nvm"), *board)) as firmware:
        sim = subprocess.run(
            [str(build.find_program("host", "reflux-sim")), "--plant", "pilot", "--port", firmware.link, "--console", firmware.console,
             "--script", str(place / "script"), "--transcript", str(place / "transcript"), "--log", str(place / "log"),
             "--speed", str(SPEED), "--timeout", "40", "--duration", str(end_s), *options],
            capture_output=True, text=True, timeout=PATIENCE_S, check=False)
        if firmware.process:
            firmware.process.wait(timeout=PATIENCE_S)
        verdict = firmware.died() or ""
    return (sim.stderr.strip().splitlines() or [""])[-1] if sim.returncode else "", verdict if "status 3" in verdict else ""


def store(nvm: Path, saves: int, *more: str) -> None:
    """Makes a flash that holds the set, with these console lines in it, and so many saves before it."""
    conf = ROOT / "host_sim" / "scenarios" / "pilot.conf"
    lines = [f"0 {line}" for line in conf.read_text().splitlines() if line and not line.startswith("#")]
    late = 4 * TICK_S  # the first slot is erased meanwhile, and the console is not heard
    lines += [f"{late} {line}" for n in range(saves) for line in (f"set loop1.ti {201 + n}", "save")]
    lines += [f"{late} {line}" for line in ("set loop1.ti 200", *more, "save", "version")]
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        place = Path(folder)
        failed, verdict = start(place, lines, late)
        said = (place / "transcript").read_text(errors="replace")
        found = re.search(r"storage: ok, .*room (\d+)", said)
        assert found is not None and (saves == 0 or 19600 < int(found.group(1)) < 21700), f"{failed} {verdict} {said[-400:]}"
        shutil.copy(place / "nvm", nvm)


@dataclass
class Cell:
    """What came of one fault in one state."""

    passed: bool
    words: str
    safe_s: float | None = None  # from the moment that the board is gone until the outputs are safe; None: it was not gone


class Flash:
    """The flashes that runs begin with, each made when it is first wanted."""

    MADE_BY = {"stored": (0,), "full": (NEARLY_FULL,), "resume": (0, "set restart.policy resume")}

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.lock = threading.Lock()

    def file(self, name: str) -> Path:
        path = self.folder / name
        with self.lock:
            if not path.exists():
                store(path, *self.MADE_BY[name])
        return path


def run(fault: Fault, state: str, flash: Flash) -> Cell:
    more = list(MORE_SAVES) if fault.full else []
    if fault.saves and state != "save":
        at_s = FAULT_S + TICK_S if state == "start" else FAULT_S  # a start has to take the stored set first
        more += [f"{at_s} ?set loop1.gain {CHANGED}", f"{at_s} ?save"]
    return judge(fault, state, simulate(state, fault.settings, fault.lasts_s + ROOM_FOR_START_S, flash.file("full" if fault.full else "stored"), more))


def is_safe(row: list[str]) -> bool:
    return all(cell != "" and abs(float(cell) - safe) < 1e-6 for cell, (_, _, safe) in zip(row[2:], LIMITS.values()))


def beyond_limits(rows: list[list[str]]) -> list[str]:
    """Outputs outside their limits that are not the safe value, as the plant sees them."""
    return [f"{name} at {cell}" for row in rows for cell, (name, (lo, hi, safe)) in zip(row[2:], LIMITS.items())
            if cell != "" and not lo <= float(cell) <= hi and abs(float(cell) - safe) > 1e-6]


def gone_since(fault: Fault, diary: list[tuple[float, str]]) -> float | None:
    """When the board no longer controlled because of the fault."""
    began = next((at for at, what in diary if what.startswith("fault ")), None)
    hung = next((at for at, what in diary if what in ("fault hang_main 1", "fault hang_tick 1")), None)
    if began is None:
        return None
    if hung is not None and fault.causes == WATCHDOG:
        return hung
    if "unplug_link=3" in fault.settings:
        return began
    return next((at for at, what in diary if at >= began and what.split(" ")[0] in ("held", "reset")), None)


def restarts(state: str, transcript: str) -> tuple[str, ...]:
    """Reasons that were told since the first start, less the requested one of that state. A press of the button before that start has looked
    at its reason leaves the reason as it is."""
    causes = re.findall(r"started in the safe state: ([\w-]+) \(STARTED\)", transcript)[1:]
    if state == "start" and causes[:1] == ["requested"]:
        causes.pop(0)
    return tuple(causes)


def judge(fault: Fault, state: str, r: Run) -> Cell:
    """Compares what was said and done with what must hold."""
    wrong, causes = beyond_limits(r.outputs), restarts(state, r.transcript)
    if r.verdict:
        wrong.append(f"verdict: {r.verdict.split(': ', 2)[-1]}")
    if causes not in fault.causes + (((),) if state == "start" and fault.kind == "button" else ()):
        wrong.append("started by " + (", ".join(causes) or "nothing"))
    last = re.findall(r"started by: ([\w-]+)", r.transcript)
    if last and causes and last[-1] != causes[-1]:
        wrong.append(f"version says {last[-1]}")
    gains = re.findall(r"loop1\.gain = ([0-9.]+)", r.transcript + r.after)
    if not gains or gains[-1] not in ((GAIN, CHANGED) if state == "save" or fault.saves else (GAIN,)):
        wrong.append(f"gain {gains[-1]}" if gains else "the set is lost")
    if r.failed and not (state == "save" and any("console" in setting for setting in fault.settings)):
        wrong.append(f"the run ended: {r.failed[-120:]}")
    gone, safe_s = gone_since(fault, r.diary), None
    if gone is not None:
        safe_s = seconds_to_safe(gone, r.outputs)
        bound = fault.safe_s + LOOK_S
        if safe_s is None or safe_s > bound:
            wrong.append(f"safe after {safe_s} s, stated {fault.safe_s:g} s")
        elif any(not is_safe(row) for row in r.outputs if causes and int(row[0]) / 1000 > gone + bound and "" not in row):
            wrong.append("outputs moved after the restart")
    said = ", ".join(causes) or "ran on"
    return Cell(not wrong, "; ".join(dict.fromkeys(wrong)) or said + (f", {safe_s:.2f} s" if safe_s is not None else ""), safe_s)


def seconds_to_safe(gone_s: float, rows: list[list[str]]) -> float | None:
    """0: they were safe when the board went."""
    before = [row for row in rows if int(row[0]) / 1000 <= gone_s]
    if before and is_safe(before[-1]):
        return 0.0
    return next((int(row[0]) / 1000 - gone_s for row in rows if int(row[0]) / 1000 > gone_s and is_safe(row)), None)
