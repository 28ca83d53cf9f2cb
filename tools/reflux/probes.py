"""Ways to reach the flash of a real board: what is connected, and the commands that write and read it."""

from __future__ import annotations

import re
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

from reflux import option_bytes
from reflux.build import Progress
from reflux.errors import RunFailed, UserError

FLASH = 0x08000000
CHIPS = {0x413: "STM32F405/F407", 0x419: "STM32F42x"}
WANTED_CHIP = 0x413
PATIENCE_S = 120.0
LOOK_S = 15.0


@dataclass(frozen=True)
class Steps:
    """write and read are run; finish starts the program. read leaves the flash's content in the file given."""

    write: list[list[str]]
    read: list[list[str]]
    finish: list[list[str]]


@dataclass(frozen=True)
class Found:
    name: str
    serial: str
    text: str


@dataclass(frozen=True)
class Options:
    """How a program reads and writes the option bytes: a command that prints them, where in what it prints, and one that writes them."""

    read: Callable[[str], list[str]]
    pattern: str
    write: Callable[[str, int], list[str]]

    def value(self, serial: str) -> int:
        said = must_run(self.read(serial), "reading option bytes")
        found = re.search(self.pattern, said, re.M | re.I)
        if found is None:
            raise RunFailed(f"{self.read(serial)[0]} did not say the option bytes")
        return int(found[1], 16)


@dataclass(frozen=True)
class Probe:
    name: str
    programs: tuple[str, ...]
    package: str
    look: Callable[[], list[Found]]
    steps: Callable[[Path, Path, str], Steps]
    options: Options | None = None  # None: this program cannot

    def missing(self) -> str | None:
        return next((p for p in self.programs if shutil.which(p) is None), None)


def run(command: list[str], seconds: float = PATIENCE_S, what: str = "") -> tuple[int, str]:
    """Exit status and everything it said. Shows the time that passes when there is a name for it."""
    started = time.monotonic()
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               text=True, errors="replace")
    progress = Progress(what, quiet=not what)
    while True:
        try:
            text, _ = process.communicate(timeout=1.0)
            break
        except subprocess.TimeoutExpired:
            passed = time.monotonic() - started
            progress.show(f"{passed:.0f} s")
            if passed > seconds:
                process.kill()
                process.communicate()
                raise RunFailed(f"{command[0]} did not end within {seconds:g} s") from None
    if what:
        progress.end(f"{time.monotonic() - started:.0f} s" if process.returncode == 0 else "failed")
    return process.returncode, text


def must_run(command: list[str], what: str) -> str:
    status, text = run(command, what=what)
    if status != 0:
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        wrong = [line for line in lines if re.search(r"error|fail|can't|cannot|unable", line, re.I)]
        raise RunFailed(f"{what}: {command[0]} ended with {status}: {(wrong or lines or ['it said nothing'])[-1]}")
    return text


def look_stlink() -> list[Found]:
    _, text = run(["st-info", "--probe"], LOOK_S)
    serials = re.findall(r"^\s*serial:\s*(\S+)", text, re.M)
    chips = re.findall(r"^\s*chip-?id:\s*0x([0-9a-fA-F]+)", text, re.M)
    out = []
    for k, serial in enumerate(serials):
        chip = int(chips[k], 16) if k < len(chips) else 0
        if chip == 0:
            raise RunFailed(f"ST-Link {serial} is there, but the chip behind it does not answer: power, wiring, NRST?")
        if chip != WANTED_CHIP:
            raise RunFailed(f"ST-Link {serial}: its chip is {CHIPS.get(chip, 'unknown')} ({chip:#x}), not "
                            f"{CHIPS[WANTED_CHIP]}")
        out.append(Found("st-flash", serial, f"ST-Link {serial}, {CHIPS[chip]}"))
    return out


def stlink_steps(image: Path, back: Path, serial: str) -> Steps:
    to = ["st-flash", "--connect-under-reset", "--serial", serial]
    size = str(image.stat().st_size)
    return Steps([[*to, "write", str(image), f"{FLASH:#010x}"]],
                 [[*to, "read", str(back), f"{FLASH:#010x}", size]], [[*to, "reset"]])


def look_dfu() -> list[Found]:
    _, text = run(["dfu-util", "-l"], LOOK_S)
    out = []
    for line in text.splitlines():
        if line.startswith("Found DFU: [0483:df11]") and "alt=0" in line and "@Internal Flash" in line:
            serial = re.search(r'serial="([^"]*)"', line)
            out.append(Found("dfu", serial[1] if serial else "", f"boot loader {serial[1] if serial else ''}"))
        elif "LIBUSB_ERROR_ACCESS" in line or "Cannot open DFU device 0483:df11" in line:
            raise RunFailed("a boot loader is there, but this user may not open it: run as root, or add a udev rule")
    return out


def dfu_steps(image: Path, back: Path, serial: str) -> Steps:
    to = ["dfu-util", "-d", "0483:df11", "-a", "0", *(["-S", serial] if serial else [])]
    size = image.stat().st_size
    return Steps([[*to, "-s", f"{FLASH:#010x}", "-D", str(image)]],
                 [[*to, "-s", f"{FLASH:#010x}:{size}", "-U", str(back)]],
                 # Leaving comes with an upload; four bytes do.
                 [[*to, "-s", f"{FLASH:#010x}:4:leave", "-U", str(back.with_suffix(".leave"))]])


OPENOCD = ["openocd", "-f", "interface/stlink.cfg", "-f", "target/stm32f4x.cfg"]


def openocd(*commands: str) -> list[str]:
    return [*OPENOCD, *(part for command in commands for part in ("-c", command))]


def look_openocd() -> list[Found]:
    status, text = run(openocd("init", "targets", "shutdown"), LOOK_S)
    if status != 0:
        return []
    said = re.search(r"Target voltage: (\S+)", text)
    return [Found("openocd", "", "OpenOCD with an ST-Link" + (f", target at {said[1]} V" if said else ""))]


def openocd_steps(image: Path, back: Path, serial: str) -> Steps:
    to = f"{{{image}}}"
    return Steps([openocd("init", "reset halt", f"flash write_image erase {to} {FLASH:#010x} bin", "shutdown")],
                 [openocd("init", "halt", f"dump_image {{{back}}} {FLASH:#010x} {image.stat().st_size}", "shutdown")],
                 [openocd("init", "reset run", "shutdown")])


# Both not tried on a board yet. st-flash knows the bytes of this chip as its register OPTCR; OpenOCD follows RM0090 3.7.2.
STLINK_OPTIONS = Options(lambda serial: ["st-flash", "--connect-under-reset", "--serial", serial, "--area=option", "read"],
                         r"^\s*(?:0x)?([0-9a-f]{8})\s*$",
                         lambda serial, value: ["st-flash", "--connect-under-reset", "--serial", serial, "--area=option", "write",
                                                f"{value:#010x}"])
OPENOCD_OPTIONS = Options(lambda serial: openocd("init", "reset halt", f"mdw {option_bytes.OPTCR:#x}", "shutdown"),
                          rf"{option_bytes.OPTCR:#x}:\s*([0-9a-f]{{8}})",
                          lambda serial, value: openocd(
                              "init", "reset halt", *(f"mww {option_bytes.OPTKEYR:#x} {key:#x}" for key in option_bytes.KEYS),
                              *(f"mww {option_bytes.OPTCR:#x} {value & option_bytes.CHANGEABLE | start:#x}"
                                for start in (0, option_bytes.START)), "sleep 2000", "shutdown"))

PROBES = {
    "st-flash": Probe("st-flash", ("st-info", "st-flash"), "stlink-tools", look_stlink, stlink_steps, STLINK_OPTIONS),
    "dfu": Probe("dfu", ("dfu-util",), "dfu-util", look_dfu, dfu_steps),
    "openocd": Probe("openocd", ("openocd",), "openocd", look_openocd, openocd_steps, OPENOCD_OPTIONS),
}


def find(name: str | None, serial: str | None) -> tuple[Probe, Found]:
    """The one probe that is connected, or the one asked for."""
    missing, seen = [], []
    for probe in PROBES.values() if name is None else [PROBES[name]]:
        program = probe.missing()
        if program:
            missing.append(f"{program} (package {probe.package})")
            continue
        seen = [f for f in probe.look() if serial is None or f.serial == serial]
        if len(seen) == 1:
            return probe, seen[0]
        if seen:
            raise UserError(f"{len(seen)} boards are connected: {', '.join(f.serial for f in seen)}; choose one with "
                            "--serial")
    tried = [n for n in (PROBES if name is None else [name]) if not PROBES[n].missing()]
    if not tried:
        raise RunFailed(f"no program to write with: {', '.join(missing)} missing")
    which = f" with serial number {serial}" if serial else ""
    note = f"; not looked for, because missing: {', '.join(missing)}" if missing else ""
    raise RunFailed(f"nothing connected{which}: {', '.join(tried)} found no board (ST-Link on USB, or the board on USB "
                    f"and started with BOOT0 high for dfu){note}")
