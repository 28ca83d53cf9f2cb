"""Asks the simulator about a plant alone, without a firmware."""

from __future__ import annotations

import json
import subprocess
from typing import Any, Iterable

from reflux import build
from reflux.errors import RunFailed, UserError


def ask(*arguments: str) -> str:
    """Returns what reflux-sim prints; its own message says what is wrong."""
    program = build.find_program("host", "reflux-sim")
    done = subprocess.run([str(program), *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        text = (done.stderr.strip().splitlines() or ["it said nothing"])[-1].removeprefix("reflux-sim: ")
        raise (UserError if done.returncode == 2 else RunFailed)(text)
    return done.stdout


def at_rest(plant: str, settings: Iterable[str] = ()) -> dict[str, float]:
    """The value of every channel at the steady state: of an input that the file trims, what the trim found. settings: NAME=VALUE of inputs."""
    rows = [line.split(",") for line in ask("--steady", "--plant", plant, *setting_words(settings)).splitlines()[1:]]
    return {row[1]: float(row[3]) for row in rows}


def numbers(settings: Iterable[str]) -> dict[str, float]:
    """Values of inputs from NAME=VALUE, as a command line has them."""
    out = {}
    for text in settings:
        name, _, value = text.partition("=")
        try:
            out[name] = float(value)
        except ValueError:
            raise UserError(f"--set {text}: must be NAME=NUMBER") from None
    return out


def setting_words(settings: Iterable[str]) -> list[str]:
    return [word for setting in settings for word in ("--set", setting)]


def check_plant(name: str) -> None:
    """Refuses a plant that the simulator does not know or whose file is wrong. Asked before anything is started."""
    try:
        ask("--list", name)
    except UserError as error:
        raise UserError(f"plant {str(error).removeprefix('--plant ')}") from None


def linearised(plant: str, settings: Iterable[str] = ()) -> dict[str, Any]:
    """Matrices A to D of a plant, in rows one after the other, with the names of inputs and outputs. settings: NAME=VALUE of inputs."""
    return json.loads(ask("--linearise", "--plant", plant, "--format", "json", *setting_words(settings)))


def table_lines(plant: str, block: int, *arguments: str) -> tuple[str, ...]:
    """Lines of the column table that a board takes for this block, without comments and without begin and apply."""
    lines = ask("--table", "--plant", plant, "--block", str(block), *arguments).splitlines()
    return tuple(line for line in lines if line and line[0] != "#" and line not in ("begin", "apply"))
