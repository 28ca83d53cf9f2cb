"""Settings that a tool has found, written to a board or a file as one transaction: all of them are in force from one tick on, or none is."""

from __future__ import annotations

import argparse
import contextlib
from typing import Callable, Iterable

from reflux import keys, session
from reflux.errors import RunFailed, UserError
from reflux.paths import named, shown
from reflux.ports import Port
from reflux.session import Refused, Session


def add_options(p: argparse.ArgumentParser) -> None:
    """Adds the options that hand_over() uses."""
    p.add_argument("--out", type=named, metavar="FILE", help="write the lines as a transaction for tools/console --run")
    p.add_argument("--to", metavar="PORT", help="write them to a board, all or none; the board does not save them")
    keys.add_option(p, "with --to: ")


def check_options(options: argparse.Namespace) -> None:
    """Reads the key, too."""
    if options.key and not options.to:
        raise UserError("--key goes with --to")
    options.key = keys.key_of(options.key)


def hand_over(options: argparse.Namespace, lines: list[str], said: Callable[[str], None] = print) -> None:
    if options.out:
        try:
            options.out.write_text("\n".join(["begin", *lines, "apply"]) + "\n", encoding="utf-8")
        except OSError as error:
            raise UserError(f"{shown(options.out)} cannot be written: {error.strerror}") from None
        said(shown(options.out))
    if options.to:
        to_board(options, lines, said)


def to_board(options: argparse.Namespace, lines: list[str], said: Callable[[str], None] = print) -> None:
    count = write_settings(options.to, lines, options.key)
    said(f"{options.to}: {count} settings taken and read back, in force from the next tick, not saved")


def write_settings(port: str, lines: Iterable[str], key: str | None = None) -> int:
    """Sends the `set` lines between `begin` and `apply` and reads them back; returns how many there were. Remarks and empty lines are left out.
    Nothing is saved: that is for who has seen the loops run. port: as tools/console takes it; key opens the engineer level first.

    Refused: the board did not take a line, or the whole of it. It says the line and the board's own words, and the board is as it was.
    A transaction that somebody has open is not touched."""
    wanted = settings_of(lines)
    with contextlib.closing(Port(port)) as opened:
        talk = Session(opened)
        try:
            if key:
                unlock(talk, key)
            send(talk, wanted)
            compare(talk, wanted)
        finally:
            with contextlib.suppress(RunFailed):
                talk.write("mode human")
    return len(wanted)


def settings_of(lines: Iterable[str]) -> list[str]:
    """The `set` lines; anything else but remarks is a mistake of the caller."""
    wanted = [line.strip() for line in lines if line.strip() and not line.strip().startswith("#")]
    for line in wanted:
        if not line.startswith("set ") or len(line.split(None, 2)) != 3:
            raise ValueError(f"'{line}' is not of the form `set NAME VALUE`")
    if not wanted:
        raise ValueError("there is nothing to set")
    return wanted


def send(talk: Session, wanted: list[str]) -> None:
    step = "begin"
    ask(talk, step)
    try:
        for step in [*wanted, "apply"]:
            ask(talk, step)
    except BaseException:
        session.abandon(talk)  # `begin` was taken, so the transaction is not somebody else's
        raise


def unlock(talk: Session, key: str) -> None:
    try:
        talk.ask(f"unlock {key}")
    except Refused as error:
        raise Refused(f"the board does not take the key, and nothing is sent: {error}") from None


def compare(talk: Session, wanted: list[str]) -> None:
    """RunFailed where the board, which has taken them, has something else now."""
    values = dict(line.split(None, 2)[1:] for line in wanted)  # the last of each name
    for name, value in values.items():
        if name == "console.key":  # never shown
            continue
        there = " ".join(talk.ask(f"get {name}")).partition(" = ")[2]
        if not same(value.strip(), there):
            raise RunFailed(f"the board took everything, but {name} is {there}, and {value.strip()} was sent")


def same(sent: str, there: str) -> bool:
    """Numbers but for the rounding of float and of what is printed; there may be a unit behind."""
    words = there.split()
    if not words:
        return False
    try:
        a, b = [float(x) for x in sent.split(",")], [float(x) for x in words[0].split(",")]
    except ValueError:
        return sent in (words[0], there)
    return len(a) == len(b) and all(abs(x - y) <= 2e-6 * max(abs(x), abs(y)) + 1e-30 for x, y in zip(a, b))


def ask(talk: Session, command: str) -> None:
    try:
        talk.ask(command)
    except Refused as error:
        text = f"the board refuses `{keys.masked(command)}`, and nothing of it is in force: {error}"
        raise Refused(text if "LOCKED" not in str(error) else f"{text}; --key opens the engineer level") from None
