"""Pages on commands, parameters, events and refusals, from the tables that the program reference_tables prints."""

from __future__ import annotations

import re
from itertools import groupby
from pathlib import Path

from dev.reference.markdown import cell, code, contents, page, table
from dev.reference.tables import Rows, check_same, notes, said_by
from reflux.errors import RunFailed

WORD = re.compile(r"[A-Za-z0-9_-]+")


# ---- commands ----

def commands(rows: Rows) -> str:
    declared = {name: (arguments, about) for name, arguments, about in rows["command"]}
    noted = notes("commands")
    families = [(family["title"], family["commands"]) for family in noted["family"]]
    check_same("command", "commands", [name for _, names in families for name in names], declared)
    check_same("command", "commands", noted["command"], declared)
    parts = []
    for title, names in families:
        parts.append([f"## {title}"])
        for name in names:
            parts += _command(name, *declared[name], noted["command"][name])
    return page(
        ["# Console commands"],
        ["Look up here how a command is typed, what it does, and who may use it. [console.md](../use/console.md) says how to talk to a board; `help` at the",
         "console prints the same list, `help COMMAND` one line of it. Words in capital letters stand for names and values; `[...]` may be left out; of words",
         "with `|` between them one is typed. EU is the engineering unit of the channel. Only engineers may use what is marked so, once a key is set",
         "([operators and engineers](../use/console.md#operators-and-engineers)). The reply is `ok`, or one of the [refusals](errors.md)."],
        contents(families), *parts)


def _command(name: str, arguments: str, about: str, note: dict) -> list[list[str]]:
    said = " ".join(form for form, _, _ in note["forms"])
    lacking = set(WORD.findall(arguments)) - set(WORD.findall(said))
    if lacking:
        raise RunFailed(f"docs/reference/notes/commands.toml: no form of {name} has {', '.join(sorted(lacking))}")
    unknown = {word for form, _, _ in note["forms"] for word in WORD.findall(form) if word.islower()} - {name, *WORD.findall(arguments)}
    if unknown:
        raise RunFailed(f"docs/reference/notes/commands.toml: the row of {name} in firmware/console/commands.h lacks {', '.join(sorted(unknown))}")
    if any(form.split()[0] != name or who not in ("everybody", "engineers") for form, who, _ in note["forms"]):
        raise RunFailed(f"docs/reference/notes/commands.toml: a form of {name} is of another command, or for somebody else")
    lines = [f"- {code(form)}{' (engineers)' if who == 'engineers' else ''}: {what}." for form, who, what in note["forms"]]
    head = f"In short: {about}." + (f" {note['about']}" if "about" in note else "")
    return [[f"### {name}"], [head], lines]


# ---- parameters ----

def unit_of(unit: str, allowed: str) -> str:
    """The unit, or what stands there in its place."""
    if unit:
        return unit
    if "|" in allowed:
        return "word"
    for begin, what in (("up to 15 letters", "name"), ("up to 11", "text"), ("names with commas", "names")):
        if allowed.startswith(begin):
            return what
    return "-"


def _spread(name: str, rows: int) -> str:
    return code(name) if rows <= 1 else f"`{name}.1` to `{name}.{rows}`"


def with_notes(fields: list[str], noted: dict[str, str]) -> list[str]:
    """The fields with the note on this parameter behind what its table says."""
    note = noted.get(f"{fields[0]}.{fields[1]}")
    return [*fields[:5], f"{fields[5]}; {note}", *fields[6:]] if note else fields


def _row(fields: list[str]) -> tuple[str, ...]:
    _, name, unit, allowed, default, about, identity, rows, _ = fields
    return _spread(name, int(rows)), unit_of(unit, allowed), allowed, default, about, identity


def parameter_rows(parameters: list[list[str]]) -> list[tuple[str, ...]]:
    """One row for those that follow one another and differ in name and id alone."""
    out = []
    for _, same in groupby(parameters, key=lambda fields: (*fields[2:6], fields[7])):
        group = list(same)
        first, last = _row(group[0]), _row(group[-1])
        joined = len(group) > 2
        if joined:
            out.append((f"{first[0]} to {last[0]}", *first[1:5], f"{first[5]} to {last[5]}"))
        else:
            out += [_row(fields) for fields in group]
    return out


HEADER = ("name", "unit", "allowed", "default", "what", "id")


def parameters(rows: Rows) -> str:
    counts = {name: int(count) for name, count in rows["group"]}
    noted = notes("parameters")
    families = [(family["title"], list(family["groups"])) for family in noted["family"]]
    check_same("group", "parameters", [name for _, names in families for name in names], counts)
    check_same("group", "parameters", noted["group"], counts)
    unknown = set(noted["note"]) - {f"{fields[0]}.{fields[1]}" for fields in [*rows["parameter"], *rows["own"]]}
    if unknown:
        raise RunFailed(f"docs/reference/notes/parameters.toml: there is no parameter {', '.join(sorted(unknown))}")
    kinds = [fields[0] for fields in rows["kind"]]
    check_same("kind", "parameters", noted["kind"], kinds)
    parts = []
    for title, names in families:
        parts.append([f"## {title}"])
        for name in names:
            parts.append([f"### {name}"])
            parts.append([f"Names begin with `{name}1.` to `{name}{counts[name]}.`." if counts[name] else f"Names begin with `{name}.`.", noted["group"][name]["about"].strip()])
            parts.append(table(HEADER, parameter_rows([with_notes(fields, noted["note"]) for fields in rows["parameter"] if fields[0] == name])))
    parts += _kinds(rows, noted["kind"], noted["note"])
    return page(
        ["# Parameters"],
        ["Look up here what a setting means, its unit, the values that it takes, and its default. At the console `list` shows those in use, `help PARAMETER` one",
         "of them. A parameter is named by its group, the index of its channel, loop or element, and its field: `loop1.gain`; or by the name of its loop or",
         "channel, `bottom.gain` ([names](../use/console.md#parameters))."],
        ["- `set` outside a transaction puts one parameter into force at the next tick. What only makes sense together (names that refer to each other, spans,",
         "  limits, dead times that fit the memory) goes between `begin` and `apply`, which checks all of it and takes it at the next tick. None needs a restart.",
         "- Some change in manual only, or while no loop acts on the channel; their rows say so. `mode LOOP manual` comes first.",
         "- `save` keeps them over a restart.",
         "- A channel, loop or element exists when its first field, a name, is not empty (`-`).",
         "- EU is the engineering unit of the channel, a fraction is one of its span, ticks are base ticks. Dimensionless numbers, and texts without a unit, have",
         "  `-`; `word`, `name`, `names` and `text` say what stands there instead of a number.",
         "- Ids never change their meaning. The one in the table is that of index 1; each further index is one more."],
        contents([*families, ("Kinds of blocks", [f"kind {name}" for name in kinds])]), *parts)


def _kinds(rows: Rows, noted: dict, of_parameters: dict[str, str]) -> list[list[str]]:
    parts = [["## Kinds of blocks"],
             ["`set block1.kind gmv` gives a block the parameters of the kind, `block 1 VERB` runs one of its verbs, and its events come as BLOCK_EVENT or",
              "BLOCK_ALARM with the block and the code as subject, `block1.frozen`."]]
    for name, stage, loops, inputs, points in rows["kind"]:
        most = [f"{count} {what}{'' if count == '1' else 's'}" for count, what in ((loops, "loop"), (inputs, "input"), (points, "point")) if count != "0"]
        parts.append([f"### kind {name}"])
        stage = f" As a{'n' if stage[0] in 'aeiou' else ''} {stage} it has at most {' and '.join(most)}." if most else ""
        parts.append([noted[name]["about"] + stage])
        parts.append(table(HEADER, parameter_rows([with_notes(fields, of_parameters) for fields in rows["own"] if fields[0] == name])))
        verbs = [fields[1:] for fields in rows["verb"] if fields[0] == name]
        if verbs:
            parts.append(table(("verb", "number", "who", "what"),
                               [(code(verb), _number(number, low, high, optional), f"{who}s" if who == "engineer" else "everybody", about)
                                for verb, number, low, high, optional, who, about in verbs]))
        events = [fields[1:] for fields in rows["kind_event"] if fields[0] == name]
        if events:
            parts.append(table(("event", "level", "what, and what the value is"), [(code(event), level, words) for event, level, words in events]))
        if "values" in noted[name]:
            parts.append([noted[name]["values"].strip()])
    return parts


def _number(number: str, low: str, high: str, optional: str) -> str:
    return f"{number}, {low} .. {high}{', may be left out' if optional else ''}" if number else "none"


# ---- events ----

def events(rows: Rows, program: Path) -> str:
    declared = {name: (number, level, text, boards) for number, name, level, text, boards in rows["event"]}
    noted = notes("events")
    families = [(family["title"], family["events"]) for family in noted["family"]]
    check_same("event", "events", [name for _, names in families for name in names], declared)
    check_same("event", "events", noted["event"], declared)
    asked = "".join(f"{name} {noted['event'][name]['example']}\n" for name in declared)
    said = dict(line.split("\t") for line in said_by(program, "sentences", told=asked).splitlines())
    parts = []
    for title, names in families:
        parts.append([f"## {title}"])
        found = []
        for name in names:
            number, level, text, _ = declared[name]
            note = noted["event"][name]
            sentence = said[name].split(maxsplit=2)[2].replace("`", "'")
            found.append((code(name), level, f"{text}<br>{code(sentence)}", note["subject"], note["value"], note["unit"], number))
        parts.append(table(("CODE", "level", "text, and as people read it", "subject", "value", "unit", "no."), found))
    boards = [f"- On {where} only: {', '.join(code(name) for name in names)}."
              for where, names in _by_boards(declared).items() if where != "every board"]
    return page(
        ["# Events"],
        ["Look up here what a line that begins with `!`, or a line of `events`, means, and what to do with its value. [console.md](../use/console.md#events) says",
         "how events are written, kept and counted. Scripts get CODE, subject, value and text; people a sentence. Below each text stands such a sentence, as the",
         "firmware makes it for a loop `top` that holds the temperature `T1` by the reflux `Lr`. Actions were asked for at the console; `events` shows them.",
         "EU is the unit of the channel, or of the loop's measurement. Where subject or value are empty, the event has none. Numbers are those of this version:",
         "scripts go by the CODE."],
        contents([(title, []) for title, _ in families]), *parts, ["## Boards that lack some"], boards)


def _by_boards(declared: dict[str, tuple[str, str, str, str]]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for name, (_, _, _, boards) in declared.items():
        found.setdefault(boards, []).append(name)
    return found


# ---- refusals ----

def errors(rows: Rows) -> str:
    noted = notes("errors")["error"]
    check_same("code", "errors", noted, [name for name, _ in rows["error"]])
    return page(
        ["# Refusals"],
        ["Look up here what to do after a line that begins with `err`. A refusal is one line, `err CODE text`, and changes nothing. The text names what is wrong,",
         "where, and what would be right; where it names nothing more, it is the one below. Codes are the same on every board, and the tools print them too."],
        table(("CODE", "text", "what to do"), [(code(name), text, noted[name]) for name, text in rows["error"]]))
