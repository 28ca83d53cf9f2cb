"""The board's side of the answers: defaults from its configuration, and the console lines that configure it."""

from __future__ import annotations

import math
from typing import Any

from reflux.commission.answers import AUTO, GIVEN, INPUT, LIMIT_SHARE, MEASUREMENT, PAIRS, TEST, Answers, Room, Values, Wrong, rounded
from reflux.commission.board import Channel, Plant, State
from reflux.errors import UserError


def defaults(plant: Plant, parameters: dict[str, str], state: State, operating: dict[str, float],
             room: Room) -> Answers:
    """From what is announced, what the board has configured already, and (simulated plants) the operating point."""
    answers = Answers(plant.name, plant.tick_s, [], [], known_room=room.known, ranges=room.ranges)
    places = room.channels
    for kind, group, channels in (("measurement", "meas", plant.measurements), ("input", "mv", plant.inputs)):
        where = {parameters[f"{group}{i}.name"]: i for i in range(1, places + 1) if f"{group}{i}.name" in parameters}
        new = [c for c in channels if c.name not in where]
        if len(new) > places - len(where):
            raise UserError(f"the plant has {len(new)} {kind}s that are not configured, the board room for "
                            f"{places - len(where)} more; configure those that matter (docs/use/console.md)")
        for channel in channels:
            place = where.get(channel.name)
            have = {} if place is None else {n.split(".")[1]: v for n, v in parameters.items()
                                             if n.startswith(f"{group}{place}.")}
            if place is not None and have["unit"].replace("-", "") != channel.unit.replace("-", ""):
                raise UserError(f"{group}{place}.unit is {have['unit']}, the plant announces {channel.name} in "
                                f"{channel.unit}; set it right first")
            values = _measurement(channel, place, have) if kind == "measurement" else \
                _input(channel, place, have, state, operating)
            (answers.measurements if kind == "measurement" else answers.inputs).append(values)
    for f in TEST:
        value = parameters[f.parameter]
        answers.test[f.name] = value if f.words else int(value) if f.whole else float(value)
    _known(answers, parameters)
    return answers


def _span(channel: Channel, have: dict[str, str]) -> dict[str, float]:
    return {end: float(have.get(end, getattr(channel, end))) for end in ("lo", "hi")}


def _measurement(channel: Channel, place: int | None, have: dict[str, str]) -> Values:
    span = _span(channel, have)
    limit = float(have.get("test_limit", 0))
    return Values(channel, MEASUREMENT, place, {
        **span, "tested": have.get("test", "on") == "on", "critical": have.get("test_critical", "off") == "on",
        "limit": limit if limit > 0 else rounded(LIMIT_SHARE * (span["hi"] - span["lo"]))})


def _input(channel: Channel, place: int | None, have: dict[str, str], state: State,
           operating: dict[str, float]) -> Values:
    """The operating point: where the output is, when it has been brought somewhere; else what the simulator says."""
    span = _span(channel, have)
    step, time_s = float(have.get("test_step", 0)), float(have.get("test_time", 0))
    values = Values(channel, INPUT, place, {
        **span, "safe": float(have.get("safe", channel.safe)), "min": float(have.get("min", span["lo"])),
        "max": float(have.get("max", span["hi"])), "at": None, "tested": have.get("test", "on") == "on",
        "step": step if step > 0 else AUTO, "time": time_s if time_s > 0 else AUTO,
        "critical": have.get("test_critical", "off") == "on"})
    at = state.values.get(channel.name) if place is not None and not state.safe else operating.get(channel.name)
    if at is not None:
        try:
            values.change({"at": at})
        except Wrong:
            pass  # no default then
    return values


def _known(answers: Answers, parameters: dict[str, str]) -> None:
    for i in range(1, answers.known_room + 1):
        have = {n.split(".")[1]: v for n, v in parameters.items() if n.startswith(f"pair{i}.")}
        try:
            if have:
                answers.add_known(have["meas"], have["mv"], have["time"], have["gain"], parameters.get(PAIRS) == GIVEN)
        except Wrong:
            continue  # of another plant


def set_lines(answers: Answers, parameters: dict[str, str], places: int) -> list[str]:
    """Lines that change the board's configuration into this one."""
    lines = []
    for group, all_values in (("meas", answers.measurements), ("mv", answers.inputs)):
        taken = {v.place for v in all_values} | {i for i in range(1, places + 1) if f"{group}{i}.name" in parameters}
        free = iter(i for i in range(1, places + 1) if i not in taken)
        for v in all_values:
            if v.place is None and not v.values["tested"]:
                continue  # left alone
            place = v.place or next(free)
            wanted = {"name": v.channel.name, "unit": v.channel.unit} if v.place is None else {}
            wanted |= {f.parameter: _word(v.values[f.name]) for f in v.asked() if f.parameter}
            lines += _changes({f"{group}{place}.{n}": value for n, value in wanted.items()}, parameters)
    lines += _changes({f.parameter: _word(answers.test[f.name]) for f in TEST}, parameters)
    lines += _changes({PAIRS: GIVEN if answers.known_pairs() else "found"}, parameters)
    for i in range(1, answers.known_room + 1):
        k = answers.known[i - 1] if i <= len(answers.known) else None
        if k is None and f"pair{i}.meas" not in parameters:
            continue
        lines += _changes({f"pair{i}.meas": k.measurement if k else "-", f"pair{i}.mv": k.input if k else "-",
                           f"pair{i}.time": _word(k.time_s if k else 0.0),
                           f"pair{i}.gain": _word(k.gain if k else 0.0)}, parameters)
    return lines


def _word(value: Any) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    if value == AUTO:
        return "0"
    return value if isinstance(value, str) else f"{value:.9g}"


def _changes(wanted: dict[str, str], parameters: dict[str, str]) -> list[str]:
    return [f"set {name} {value}" for name, value in wanted.items() if not _same(value, parameters.get(name))]


def _same(value: str, have: str | None) -> bool:
    if have is None:
        return False
    try:
        return math.isclose(float(value), float(have), rel_tol=1e-7, abs_tol=1e-30)
    except ValueError:
        return value == have
