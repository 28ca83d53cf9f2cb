"""The access key of a board (docs/use/console.md): where a tool takes it from, and lines shown without it."""

from __future__ import annotations

import argparse
import getpass
import re
import sys
from pathlib import Path

from reflux.errors import UserError
from reflux.paths import shown
from reflux.textfile import read

HELP = "open the engineer level first. KEY is - (asks for it), @FILE (its first line), or the key itself, which others can then see"
WARNING = ("warning: other users can see a key on the command line, and the shell's history keeps it; --key - asks for the key, "
           "--key @FILE reads it")
SECRET = re.compile(r"(^\s*(?:unlock|key)|\bconsole\.key)\s+\S.*")


def add_option(p: argparse.ArgumentParser, condition: str = "") -> None:
    p.add_argument("--key", metavar="KEY", help=condition + HELP)


def key_of(option: str | None) -> str:
    """The key that --key stands for; empty without one."""
    if option is None or option == "":
        return ""
    if option == "-":
        return asked()
    if option.startswith("@"):
        path = Path(option[1:])
        lines = read(path).splitlines()
        if not lines or not lines[0].strip():
            raise UserError(f"{shown(path)} holds no key in its first line")
        return lines[0].strip()
    print(WARNING, file=sys.stderr)
    return option


def asked() -> str:
    try:
        key = getpass.getpass("key: ") if sys.stdin.isatty() else sys.stdin.readline()
    except EOFError:
        key = ""
    if not key.strip():
        raise UserError("--key -: no key was given")
    return key.strip()


def masked(line: str) -> str:
    """A console line for people's eyes, a transcript or a message: with *** in place of a key."""
    return SECRET.sub(r"\1 ***", line)
