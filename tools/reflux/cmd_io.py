"""tools/io: a guided check of what is wired to a board's own pins."""

from __future__ import annotations

import argparse
import contextlib
import signal
import subprocess
import sys
from pathlib import Path
from typing import Iterator

from reflux import build, io_wiring, keys, launch, session, textfile
from reflux.board_port import SCHEME, BoardPort
from reflux.cmd_console import open_log
from reflux.errors import RunFailed, UserError
from reflux.io_board import CheckedBoard
from reflux.io_check import Check
from reflux.io_person import Person
from reflux.paths import named, shown, tool
from reflux.ports import Port

HOLD_LEAST_S, HOLD_MOST_S = 2.0, 60.0
LAST_WORDS_S = 3.0


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog=tool("io"),
        description="Goes with you through the sensors and outputs at a board's own pins. It lists them with their readings, asks you to warm one "
        "sensor after the other and says which reading moves, moves each output a little after a question, and calibrates sensors. Outputs go back "
        "to their safe values after each question, at the end and with Ctrl-C. It cannot do so when this computer or the line to the board dies: "
        "put a lamp in place of each heater. The exit status is 1 where something is not as it should be.",
        epilog="At a virtual board type `pins.T1 35` at any question to give the sensor T1 another temperature, `pins.T1.open 1` for a fault of its "
        "chip. It is in step with the clock where answers come from a terminal, else as fast as it can.")
    p.add_argument("port", nargs="?", metavar="PORT", help="serial device of the board's console (/dev/ttyUSB0), a pseudo-terminal, socket:PATH, or "
                   "board:PATH for a `reflux-board --control PATH`")
    p.add_argument("--board", type=named, metavar="WIRING", help="start a virtual board instead, with the chips of this wiring file at its pins")
    p.add_argument("--settings", type=named, metavar="FILE", help="with --board: console lines to send first")
    p.add_argument("--no-build", action="store_true", help="with --board: do not build; use what is there")
    p.add_argument("--list", action="store_true", help="print sensors and outputs with their readings; change nothing")
    p.add_argument("--hold", type=float, default=10.0, metavar="S", help=f"most seconds that an output is away from its safe value, {HOLD_LEAST_S:g} to "
                   f"{HOLD_MOST_S:g} (default 10)")
    p.add_argument("--log", type=named, metavar="FILE", help="append all lines from and to the board to FILE")
    keys.add_option(p)
    return p


def main(arguments: list[str]) -> int:
    options = parser().parse_args(arguments)
    if bool(options.board) == bool(options.port):
        raise UserError("which board? PORT, or --board WIRING for a virtual one")
    if options.settings and not options.board:
        raise UserError("--settings goes with --board; `tools/console PORT --run FILE` sends settings to a board")
    if not HOLD_LEAST_S <= options.hold <= HOLD_MOST_S:
        raise UserError(f"--hold must be {HOLD_LEAST_S:g} to {HOLD_MOST_S:g} s")
    options.key = keys.key_of(options.key)
    text = textfile.read(options.settings) if options.settings else ""
    with contextlib.ExitStack() as stack:
        where = stack.enter_context(virtual_board(options.board, options.no_build)) if options.board else options.port
        log = stack.enter_context(open_log(options.log)) if options.log else None
        port = BoardPort(where, sys.stdin.isatty()) if where.startswith(SCHEME) else Port(where)
        stack.enter_context(contextlib.closing(port))
        board = CheckedBoard(port, log)
        if options.key:
            board.talk.ask(f"unlock {options.key}")
        if options.settings:
            session.run_file(board.talk, options.settings, text, lambda line: None)
        return checked(board, Person(board.turn, board.now, port.set_pins if isinstance(port, BoardPort) else None), options)


@contextlib.contextmanager
def virtual_board(wiring: Path, no_build: bool) -> Iterator[str]:
    if not wiring.is_file():
        raise UserError(f"there is no {shown(wiring)}; docs/reference/pins.md says what is in a wiring file")
    if not no_build:
        with contextlib.redirect_stdout(sys.stderr):  # the first time takes minutes, and --list is for other programs, too
            launch.build_for("board")
    build.find_program("host", "reflux-board")
    with launch.start("board", extra=("--wiring", str(wiring))) as firmware:
        try:
            yield firmware.console
        except RunFailed as error:  # such as a line for a sensor that the wiring does not have
            with contextlib.suppress(subprocess.TimeoutExpired):
                if firmware.process is not None and "has ended" in str(error):
                    firmware.process.wait(LAST_WORDS_S)
            said = firmware.died()
            raise RunFailed(f"{error}: {said}" if said else str(error)) from None


def checked(board: CheckedBoard, person: Person, options: argparse.Namespace) -> int:
    check = Check(board, person, io_wiring.read(board.talk), options.hold)
    try:
        board.begin()
        check.list()
        if options.list:
            return 0
        check.prepare()
        check.sensors()
        check.outputs()
        calibrated = check.calibrate()
        board.narrow()
        if calibrated:
            check.offer_save()
    finally:
        with undisturbed():
            board.restore()
            if not options.list:
                print("\noutputs that were moved are at their safe values", flush=True)
    print("findings:")
    for fine, finding in check.findings:
        print(f"  {'ok    ' if fine else 'NOT OK'} {finding}")
    if not all(fine for fine, _ in check.findings):
        raise RunFailed("something is not as it should be")
    return 0


@contextlib.contextmanager
def undisturbed() -> Iterator[None]:
    """A second Ctrl-C does not keep outputs from their safe values."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
