"""tools/flash: writes the image to a real board and reads it back."""

from __future__ import annotations

import argparse
import hashlib
import shlex
import struct
import sys
import tempfile
import zlib
from pathlib import Path

from reflux import build, option_bytes, probes
from reflux.errors import RunFailed, UserError
from reflux.paths import INSTALLED, build_dir, named, shown, tool

LARGEST = 768 * 1024  # sectors 0 to 9; 10 and 11 keep the parameters
RAM = range(0x20000000, 0x20020001)
PRESET = "stm32f405"


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog=tool("flash"),
        description="Finds the board (ST-Link by st-flash, USB boot loader by dfu-util, ST-Link by OpenOCD), says what "
        "it will do, asks, writes the image, reads it back, compares, and starts it. Stored parameters are kept: "
        "their sectors are not touched.")
    p.add_argument("--image", type=named, metavar="FILE", help=f"file to write (default: the image of preset {PRESET})")
    p.add_argument("--probe", choices=sorted(probes.PROBES), help="use only this program (default: the first that works)")
    p.add_argument("--serial", metavar="NUMBER", help="serial number of the ST-Link or boot loader, when there are several")
    p.add_argument("--protect", action="store_true",
                   help="write no image: set the brown-out reset to level 3, let the watchdog run from a reset on, and write-protect the sectors "
                   "that hold the image; by ST-Link only")
    p.add_argument("--unprotect", action="store_true", help="write no image: lift the write protection; by ST-Link only")
    p.add_argument("--yes", action="store_true", help="do not ask")
    p.add_argument("--dry-run", action="store_true", help="print what the tool would do, and stop")
    options = p.parse_args(arguments)
    image = options.image or default_image()
    about = inspect(image)
    try:
        probe, found = probes.find(options.probe, options.serial)
    except (RunFailed, UserError) as error:
        if not options.dry_run:
            raise
        print(f"no board: {error}")
        probe, found = likely(options.probe, options.serial)
    if options.protect or options.unprotect:
        return set_options(probe, found, image.stat().st_size, options)
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        back = Path(folder) / "back.bin"
        steps = probe.steps(image, back, found.serial)
        print(f"board: {found.text}\nimage: {shown(image)}, {about}\nit will:")
        for what, commands in (("write", steps.write), ("read back and compare", steps.read), ("start", steps.finish)):
            for command in commands:
                print(f"  {what}: {shlex.join(command)}")
        if options.dry_run:
            print("nothing written (--dry-run)")
            return 0
        if not options.yes and not agreed():
            print("nothing written")
            return 1
        closed = lift(probe, found, image.stat().st_size)
        try:
            write(image, back, steps)
        finally:
            if closed is not None:
                write_options(probe, found, closed)
                print(f"write protection set again: sectors {option_bytes.names(option_bytes.closed(closed))}")
        for command in steps.finish:
            probes.must_run(command, "starting")
    print(f"flash: {image.stat().st_size} bytes written to {found.text}, read back equal, started")
    return 0


def set_options(probe: probes.Probe, found: probes.Found, size: int, asked: argparse.Namespace) -> int:
    """Protects the board, or lifts the write protection: says what changes, asks, writes, reads back."""
    if asked.protect and asked.unprotect:
        raise UserError("--protect and --unprotect: which of the two?")
    if probe.options is None:
        raise UserError(f"{probe.name} cannot set option bytes: connect an ST-Link (st-flash or OpenOCD), or set them in ST's programmer: "
                        "BOR_LEV 0, WDG_SW 0, nWRP 0 for the sectors of the program")
    if asked.dry_run:
        print(f"board: {found.text}\nit will read the option bytes: {shlex.join(probe.options.read(found.serial))}")
        print("and then, without a change of anything else: " +
              ("lift the write protection of all sectors" if asked.unprotect else "set brown-out reset level 3, watchdog from reset on, "
               f"write protection of sectors {option_bytes.names(option_bytes.sectors_of(size))}") + "\nnothing written (--dry-run)")
        return 0
    before = probe.options.value(found.serial)
    option_bytes.check(before)
    after = option_bytes.with_open(before, 0xFFF) if asked.unprotect else option_bytes.protected(before, size)
    print(f"board: {found.text}\nnow: {option_bytes.text(before)}")
    if after == before:
        print("nothing to change")
        return 0
    print(f"it will set: {option_bytes.text(after)}\n  {shlex.join(probe.options.write(found.serial, after))}")
    if not asked.yes and not agreed():
        print("nothing written")
        return 1
    write_options(probe, found, after)
    print("option bytes written, read back equal; switch the supply off and on")
    return 0


def write_options(probe: probes.Probe, found: probes.Found, value: int) -> None:
    assert probe.options is not None
    probes.must_run(probe.options.write(found.serial, value), "writing option bytes")
    have = probe.options.value(found.serial)
    if (have ^ value) & option_bytes.CHANGEABLE:
        raise RunFailed(f"the option bytes are {have:#010x} and not {value:#010x}: look at `version` of the board, and try again")


def lift(probe: probes.Probe, found: probes.Found, size: int) -> int | None:
    """Lifts a write protection of sectors that the image needs. Returns the option bytes before; None if nothing stood in the way."""
    if probe.options is None:
        return None  # the program itself says that it cannot write
    before = probe.options.value(found.serial)
    needed = option_bytes.closed(before) & option_bytes.sectors_of(size)
    if not needed:
        return None
    option_bytes.check(before)
    print(f"write protection lifted for now: sectors {option_bytes.names(needed)}")
    write_options(probe, found, option_bytes.with_open(before, needed))
    return before


def likely(name: str | None, serial: str | None) -> tuple[probes.Probe, probes.Found]:
    """Without a board: what the program asked for, or the first one, would do."""
    probe = probes.PROBES[name or next(iter(probes.PROBES))]
    return probe, probes.Found(probe.name, serial or "SERIAL", f"whichever {probe.name} finds")


def default_image() -> Path:
    try:
        return build.find_image(PRESET)
    except RunFailed:
        if INSTALLED:
            raise UserError("an installed package has no image: name one with --image") from None
        raise UserError(f"{shown(build_dir(PRESET))} has no image; build one (cmake --workflow --preset {PRESET}) or "
                        "name one with --image") from None


def inspect(image: Path) -> str:
    """Refuses what cannot be an image for this chip: its first words are stack and start, its last is its checksum."""
    try:
        data = image.read_bytes()
    except OSError as error:
        raise UserError(f"{shown(image)}: {error.strerror}") from None
    if len(data) < 512 or len(data) > LARGEST:
        raise UserError(f"{shown(image)}: {len(data)} bytes; an image has 512 to {LARGEST}")
    stack, start = struct.unpack_from("<II", data)
    if stack not in RAM or not start & 1 or not probes.FLASH < start < probes.FLASH + len(data):
        raise UserError(f"{shown(image)} does not begin with the vectors of an image linked for {probes.FLASH:#010x} "
                        "(use the .bin file, not the .elf)")
    if zlib.crc32(data[:-4]).to_bytes(4, "little") != data[-4:]:
        raise UserError(f"{shown(image)} does not end with the checksum of what is before it: it is damaged, or not from "
                        "a build of this firmware; the board would let nothing act")
    return f"{len(data)} bytes, sha256 {hashlib.sha256(data).hexdigest()[:16]}"


def agreed() -> bool:
    if not sys.stdin.isatty():
        raise UserError("nobody is there to be asked; --yes writes without asking")
    try:
        return input("Heaters off? Write? [y/N] ").strip().lower() in ("y", "yes")
    except EOFError:
        return False


def write(image: Path, back: Path, steps: probes.Steps) -> None:
    for command in steps.write:
        probes.must_run(command, "writing")
    for command in steps.read:
        probes.must_run(command, "reading back")
    wanted = image.read_bytes()
    try:
        have = back.read_bytes()
    except OSError:
        raise RunFailed("reading back gave no file; the board's content is not known") from None
    if have != wanted:
        k = next((i for i, (a, b) in enumerate(zip(wanted, have)) if a != b), min(len(wanted), len(have)))
        raise RunFailed(f"what was read back differs from the image at {probes.FLASH + k:#010x}; the board was not "
                        "started: write again")
