"""The file of a start-up's answers: read over the defaults, and written so that it gives the same answers again."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from reflux.commission.answers import TEST, Answers, Values, Wrong
from reflux.errors import UserError
from reflux.paths import shown, tool
from reflux.schema import Table, load_toml


def read(path: Path, answers: Answers) -> None:
    """Takes a file's answers over the defaults. What is wrong is told with the key."""
    top = Table(load_toml(path), path)
    if top.has("plant"):
        table = top.table("plant")
        name = table.text("name", answers.plant)
        if name != answers.plant:
            raise UserError(f'{table.path("name")} is "{name}"; the plant that is connected is {answers.plant}')
        tick = table.number("tick_s", answers.tick_s, above=0)
        if not math.isclose(tick, answers.tick_s, rel_tol=1e-6):
            raise UserError(f'{table.path("tick_s")} is {tick:g}; the plant samples every {answers.tick_s:g} s, which is '
                            "set there")
        table.done()
    for key, kind in (("measurement", answers.measurements), ("input", answers.inputs)):
        if not top.has(key):
            continue
        tables = top.table(key)
        for name in list(tables.data):
            _channel(tables, name, kind)
    _read_known(top, answers)
    if top.has("test"):
        table = top.table("test")
        for name in list(table.data):
            value = table.data.pop(name)
            _guarded(table, name, lambda n=name, v=value: answers.change_test(n, v))
    if top.has("proposal"):
        table = top.table("proposal")
        answers.proposal = table.text("answer", "accept", choices=("accept", "reject"))
        if table.has("set"):
            sets = table.table("set")
            answers.edits = {n: str(v).lower() if isinstance(v, bool) else str(v) for n, v in sets.data.items()}
        table.done()
    top.done()
    if missing := answers.missing():
        raise UserError(f"{shown(path)}: {missing}")


def _read_known(top: Table, answers: Answers) -> None:
    """[[known]] elements, or [known] with nothing but pairs."""
    if isinstance(top.data.get("known"), dict):
        table = top.table("known")
        pairs = table.data.pop("pairs", None)
        for pair in pairs if isinstance(pairs, list) else [None]:
            if not (isinstance(pair, list) and len(pair) == 2 and all(isinstance(name, str) for name in pair)):
                raise UserError(f'{table.path("pairs")}: give pairs, such as [["{answers.measurements[0].channel.name}", '
                                f'"{answers.inputs[0].channel.name}"]]')
            _guarded(table, "pairs", lambda p=pair: answers.add_known(*p, pair=True))
        table.done()
        return
    for table in top.tables("known"):
        time_s, gain, pair = table.number("time_s", 0.0), table.number("gain", 0.0), table.data.pop("pair", False)
        _guarded(table, "", lambda t=table, a=time_s, b=gain, c=pair: answers.add_known(t.text("measurement"), t.text("input"),
                                                                                        a, b, c))
        table.done()


def _channel(tables: Table, name: str, kind: list[Values]) -> None:
    found = next((v for v in kind if v.channel.name == name), None)
    if found is None:
        raise UserError(f"{tables.path(name)}: there is no such {tables.where}; there are "
                        f"{', '.join(v.channel.name for v in kind)}")
    table = tables.table(name)
    _guarded(table, "", lambda: found.change(table.data))


def _guarded(table: Table, key: str, what: Any) -> None:
    try:
        what()
    except Wrong as error:
        where = table.path(key) if key else f"{shown(table.file)}: {table.where}"
        raise UserError(f"{where}: {error}") from None


def text(answers: Answers) -> str:
    """As a file that gives the same answers."""
    out = [f"# Answers of a start-up; {tool('commission')} ... --file runs it again. docs/use/commission.md", "",
           "[plant]", f'name = "{answers.plant}"', f"tick_s = {answers.tick_s:.9g}"]
    for key, all_values in (("measurement", answers.measurements), ("input", answers.inputs)):
        for v in all_values:
            out += ["", f"[{key}.{v.channel.name}]"]
            out += [f"{f.name} = {_toml(v.values[f.name])}" for f in v.asked() if v.values[f.name] is not None]
    for k in answers.known:
        out += ["", "[[known]]", f'measurement = "{k.measurement}"', f'input = "{k.input}"',
                f"time_s = {k.time_s:.9g}", f"gain = {k.gain:.9g}", f"pair = {_toml(k.pair)}"]
    out += ["", "[test]", *(f"{f.name} = {_toml(answers.test[f.name])}" for f in TEST)]
    out += ["", "[proposal]", f'answer = "{answers.proposal}"']
    if answers.edits:
        out += ["", "[proposal.set]", *(f'"{n}" = "{v}"' for n, v in answers.edits.items())]
    return "\n".join(out) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return f'"{value}"' if isinstance(value, str) else f"{value:.9g}"
