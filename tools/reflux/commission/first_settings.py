"""Settings that a simulated board has before the start-up: the user's interlocks, alarms and estimators."""

from __future__ import annotations

from pathlib import Path

from reflux import session, textfile
from reflux.commission.dialogue import say
from reflux.commission.startup import GREETING_S, PATIENCE_TICKS, Startup
from reflux.errors import UserError
from reflux.paths import shown, tool
from reflux.session import Refused

OUTSIDE = ("begin", "apply")
TAKEN = ("set", "defaults")


def read(path: Path) -> list[tuple[int, str]]:
    """Its settings with the numbers of their lines. Whatever moves the plant is refused: the start-up itself brings it to its operating point."""
    lines = session.commands_in(path, textfile.read(path))
    out = []
    for number, line in lines:
        if line.split()[0] in TAKEN:
            out.append((number, line))
        elif line not in OUTSIDE:
            raise UserError(f"{shown(path)}:{number}: `{line}` is no setting; --conf takes `set` and `defaults`, in `begin` and `apply` or alone")
    if not any(line.startswith("set ") for _, line in out):
        raise UserError(f"{shown(path)} holds no `set` line; is it a configuration ({tool('console')} PORT --dump FILE)?")
    return out


def send(run: Startup, lines: list[tuple[int, str]]) -> None:
    """The outputs go to the operating point in the same sample as the channels: the plant must not see their safe values first. Interlocks follow once
    readings are valid, because one that has no valid reading yet would act."""
    board, path = run.board, run.options.conf
    assert path
    plant = board.plant(GREETING_S)
    values = settings(lines)
    names = {value for name, value in values.items() if name.endswith(".name")}
    transaction(run, path, [x for x in lines if not interlock(x)], {name: at for name, at in run.operating.items() if name in names})
    until_s = board.state().plant_s + PATIENCE_TICKS * plant.tick_s
    while (state := board.state()).plant_s < until_s and not all(state.good.get(c.name, True) for c in plant.measurements):
        board.listen(0.05)
        run.alive()
    transaction(run, path, [x for x in lines if interlock(x)], {})
    say(f"{shown(path)}: {len(values)} settings, in force before the start-up")


def settings(lines: list[tuple[int, str]]) -> dict[str, str]:
    return dict(words[1:] for _, line in lines if len(words := line.split(None, 2)) == 3)


def interlock(line: tuple[int, str]) -> bool:
    return line[1].startswith("set lock")


def transaction(run: Startup, path: Path, lines: list[tuple[int, str]], moves: dict[str, float]) -> None:
    if not lines:
        return
    board = run.board
    board.new_events()
    board.ask("begin")
    for number, line in lines:
        try:
            board.ask(line)
        except Refused as error:
            raise UserError(f"{shown(path)}:{number}: `{line}`: {error}") from None
    if refusals := board.ask_together(["apply", *(f"out {name} {at:.9g}" for name, at in moves.items())]):
        raise UserError(f"{shown(path)}: the board refuses {refusals[0]}")
    run.await_event("CONFIG_APPLIED", "CONFIG_REFUSED")
    values = settings(lines)
    drives = {values.get(key.replace(".out", ".name"), ""): value for key, value in values.items() if key.startswith("loop") and key.endswith(".out")}
    for name in moves:  # a move of an output that a loop drives is reported under the name of that loop
        run.await_event("OUTPUT", "REQUEST_REFUSED", subjects=(name, *(loop for loop, out in drives.items() if out == name)))
