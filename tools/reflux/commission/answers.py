"""Answers of the operator before a start-up, and their limits."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from reflux.commission.board import Channel

AUTO = "auto"
PAIRS, GIVEN = "test.pairs", "given"
LIMIT_SHARE = 0.2   # of span: the firmware's own default
ROOM_SHARE = 0.005  # of span, to both sides of the operating point: the firmware wants that
BIG = 1e9
TIME_MOST = 1e6


class Wrong(Exception):
    """An answer that cannot be: what is wrong and what would be right, in one line."""


@dataclass(frozen=True)
class Field:
    name: str
    kind: str  # number, auto (number or the word), yes
    help: str
    parameter: str = ""
    new: bool = False  # only asked for channels that the board has not configured
    unit: str = ""     # where it is not the channel's


MEASUREMENT = (
    Field("lo", "number", "lower end of the span", "lo", new=True),
    Field("hi", "number", "upper end of the span", "hi", new=True),
    Field("tested", "yes", "yes: start-up looks for a loop; no: it only watches what is configured", "test"),
    Field("limit", "number", "largest distance from rest: a step turns round before it gets there; the test stops "
          "beyond it", "test_limit"),
    Field("critical", "yes", "yes: only half of the limit", "test_critical"),
)
INPUT = (
    Field("lo", "number", "lower end of the span", "lo", new=True),
    Field("hi", "number", "upper end of the span", "hi", new=True),
    Field("safe", "number", "value at start, on silence, in the safe state", "safe", new=True),
    Field("min", "number", "lowest value ever commanded; the plant does not announce it", "min"),
    Field("max", "number", "highest value ever commanded; the plant does not announce it", "max"),
    Field("at", "number", "operating point: start-up holds the input there and tests around it"),
    Field("tested", "yes", "yes: start-up steps it; no: it stays where it is", "test"),
    Field("step", "auto", "amplitude of its steps; auto: larger and larger, until a response exceeds the noise",
          "test_step"),
    Field("time", "auto", "length of half a double step; auto: until the plant is at rest", "test_time", unit="s"),
    Field("critical", "yes", "yes: start-up tests it first, so that its times help the others", "test_critical"),
)
FOLLOWS = {"lo": ("min", "limit"), "hi": ("max", "limit")}


@dataclass(frozen=True)
class TestField:
    name: str
    parameter: str
    unit: str
    help: str
    words: tuple[str, ...] = ()
    whole: bool = False


TEST = (
    TestField("guard", "test.guard", "", "how a peak is predicted: by a model of the response so far, or by a straight line", ("model", "line")),
    TestField("blank", "test.blank", "s", "time after a step in which the guard does not look; for inverse responses"),
    TestField("noise", "test.noise", "", "smallest response, as a multiple of the noise"),
    TestField("window", "test.window", "samples", "length over which the plant must be at rest", whole=True),
    TestField("longest", "test.longest", "s", "longest half of a double step; 0: as long as the responses ask for, 20,000 samples at most"),
    TestField("confidence", "test.confidence", "", "smallest probability of a pairing that counts as determined"),
    TestField("rounds", "test.rounds", "", "most tests of each input, repeated until the pairing is determined", whole=True),
    TestField("probe", "test.probe", "", "factor on each loop's gain on the way back in the trial, with which it must stay stable; 0: no such probe"),
)


@dataclass
class Values:
    """Answers about one channel, by the names of its fields."""

    channel: Channel
    fields: tuple[Field, ...]
    place: int | None  # of the configured channel on the board, from 1
    values: dict[str, Any]
    given: set[str] = field(default_factory=set)  # otherwise they follow the span

    def asked(self) -> list[Field]:
        return [f for f in self.fields if self.place is None or not f.new]

    def change(self, given: dict[str, Any]) -> None:
        """All of them or none."""
        before = dict(self.values), set(self.given)
        try:
            for name, value in given.items():
                self._set(name, value)
            self.check()
        except Wrong:
            self.values, self.given = before
            raise

    def _set(self, name: str, value: Any) -> None:
        known = {f.name: f for f in self.asked()}
        if name not in known:
            raise Wrong(f"{self.channel.name} has no {name}; there is {', '.join(known)}")
        for follower in FOLLOWS.get(name, ()):
            if follower in self.values and follower not in self.given:
                self.values[follower] = None
        f = known[name]
        self.values[name] = _value(f.kind, value, f"{self.channel.name} {name}", f.unit or self.channel.unit)
        self.given.add(name)

    def check(self) -> None:
        v, name, unit = self.values, self.channel.name, self.channel.unit
        for end in ("lo", "hi"):
            _within(v[end], -BIG, BIG, f"{name} {end}", unit)
        if not v["lo"] < v["hi"]:
            raise Wrong(f"{name} lo is {v['lo']:g} and hi is {v['hi']:g}; lo must be below hi")
        if self.fields is MEASUREMENT:
            self._check_measurement()
        else:
            self._check_input()

    def _check_measurement(self) -> None:
        v, name, span = self.values, self.channel.name, self.values["hi"] - self.values["lo"]
        if v["limit"] is None:
            v["limit"] = rounded(LIMIT_SHARE * span)
        if not 0 < v["limit"] <= span:
            raise Wrong(f"{name} limit is {v['limit']:g}; it must be more than 0 and up to its span, {span:g} {self.channel.unit}")

    def _check_input(self) -> None:
        v, name, unit = self.values, self.channel.name, self.channel.unit
        v["min"] = v["lo"] if v["min"] is None else v["min"]
        v["max"] = v["hi"] if v["max"] is None else v["max"]
        _within(v["safe"], v["lo"], v["hi"], f"{name} safe", unit)
        _within(v["min"], v["lo"], v["hi"], f"{name} min", unit)
        _within(v["max"], v["lo"], v["hi"], f"{name} max", unit)
        if not v["min"] < v["max"]:
            raise Wrong(f"{name} min is {v['min']:g} and max is {v['max']:g}; min must be below max")
        if v["time"] != AUTO:
            _within(v["time"], 0, TIME_MOST, f"{name} time", "s", above=True)
        if v["at"] is None:
            if v["step"] != AUTO:
                _within(v["step"], 0, 0.5 * (v["hi"] - v["lo"]), f"{name} step", unit, above=True)
            return
        _within(v["at"], v["min"], v["max"], f"{name} at", unit)
        room, least = self.room(), ROOM_SHARE * (v["hi"] - v["lo"])
        if v["tested"] and room < least:
            raise Wrong(f"{name} at {v['at']:g} {unit} leaves no room to step both ways; set {name} at to {v['min'] + least:g} .. "
                        f"{v['max'] - least:g}, or change min and max, or set {name} tested no")
        if v["step"] != AUTO:
            _within(v["step"], 0, min(room, 0.5 * (v["hi"] - v["lo"])), f"{name} step", unit, above=True,
                    why=f" (it goes both ways from {v['at']:g}, within {v['min']:g} .. {v['max']:g})")

    def room(self) -> float:
        return min(self.values["at"] - self.values["min"], self.values["max"] - self.values["at"])

    def missing(self) -> str | None:
        """Says which value has no default and was not given yet."""
        if self.fields is INPUT and self.values["tested"] and self.values["at"] is None:
            v = self.values
            return (f"give {self.channel.name} at, the value at the plant's operating point, between {v['min']:g} "
                    f"and {v['max']:g} {self.channel.unit}")
        return None


@dataclass
class Known:
    """Prior knowledge of one element."""

    measurement: str
    input: str
    time_s: float = 0.0
    gain: float = 0.0
    pair: bool = False  # this input is to control that measurement


@dataclass(frozen=True)
class Room:
    """Capacity of the board."""

    channels: int  # of each kind
    known: int     # elements of which something is known beforehand
    ranges: dict[str, tuple[float, float]]  # of the numbers of TEST


@dataclass
class Answers:
    plant: str
    tick_s: float
    measurements: list[Values]
    inputs: list[Values]
    known: list[Known] = field(default_factory=list)
    known_room: int = 4
    test: dict[str, Any] = field(default_factory=dict)
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)
    proposal: str = "accept"
    edits: dict[str, str] = field(default_factory=dict)

    def channel(self, name: str) -> Values:
        for values in (*self.measurements, *self.inputs):
            if values.channel.name == name:
                return values
        names = [v.channel.name for v in (*self.measurements, *self.inputs)]
        raise Wrong(f"there is no {name}; there are {', '.join(names)}")

    def change_test(self, name: str, value: Any) -> None:
        known = {f.name: f for f in TEST}
        if name not in known:
            raise Wrong(f"there is no {name}; there are {', '.join(known)}")
        f = known[name]
        if f.words:
            if value not in f.words:
                raise Wrong(f"{name} is {value}; it must be {' or '.join(f.words)}")
            self.test[name] = value
            return
        number = _value("number", value, name, f.unit)
        low, high = self.ranges[name]
        _within(number, low, high, name, f.unit)
        if f.whole and number != int(number):
            raise Wrong(f"{name} is {number:g}; it must be a whole number")
        self.test[name] = int(number) if f.whole else number

    def add_known(self, measurement: str, input_name: str, time_s: Any = 0.0, gain: Any = 0.0, pair: Any = False) -> None:
        where = f"{measurement} {input_name}"
        if measurement not in [v.channel.name for v in self.measurements]:
            raise Wrong(f"{measurement} is not a measurement; there are "
                        f"{', '.join(v.channel.name for v in self.measurements)}")
        if input_name not in [v.channel.name for v in self.inputs]:
            raise Wrong(f"{input_name} is not an input; there are {', '.join(v.channel.name for v in self.inputs)}")
        known = Known(measurement, input_name, _value("number", time_s, f"{where} time", "s"),
                      _value("number", gain, f"{where} gain", ""), _value("yes", pair, f"{where} pair", ""))
        _within(known.time_s, 0, TIME_MOST, f"{where} time", "s")
        _within(known.gain, -BIG, BIG, f"{where} gain", "")
        rest = [k for k in self.known if (k.measurement, k.input) != (measurement, input_name)]
        if known.time_s == 0 and known.gain == 0 and not known.pair:
            self.known = rest
            return
        for other in rest:
            if known.pair and other.pair and (other.measurement == measurement or other.input == input_name):
                raise Wrong(f"{where} is not a pair: {other.measurement} {other.input} is one already; `{other.measurement} "
                            f"{other.input} pair no` would take it back")
        if len(rest) >= self.known_room:
            raise Wrong(f"the board keeps {self.known_room} of these; `{rest[0].measurement} {rest[0].input} time 0 gain "
                        "0` would take one back")
        self.known = [*rest, known]

    def known_pairs(self) -> list[tuple[str, str]]:
        return [(k.measurement, k.input) for k in self.known if k.pair]

    def missing(self) -> str | None:
        other = next((k for k in self.known if not k.pair), None)
        if other and self.known_pairs():
            return (f"{other.measurement} {other.input} is known, and is not a pair: where pairs are given, the board takes every "
                    "element that is known for one")
        if not any(v.values["tested"] for v in self.measurements):
            return "no measurement is tested: `NAME tested yes` for at least one"
        if not any(v.values["tested"] for v in self.inputs):
            return "no input is tested: `NAME tested yes` for at least one"
        return next((m for m in (v.missing() for v in self.inputs) if m), None)


def _value(kind: str, value: Any, where: str, unit: str) -> Any:
    of = f" in {unit}" if unit and unit != "-" else ""
    if kind == "yes":
        if isinstance(value, bool):
            return value
        if value in ("yes", "no"):
            return value == "yes"
        raise Wrong(f"{where} is {value}; it must be yes or no")
    wanted = f"it must be a number{of} or {AUTO}" if kind == "auto" else f"it must be a number{of}"
    if kind == "auto" and value == AUTO:
        return AUTO
    if isinstance(value, bool):
        raise Wrong(f"{where} is {str(value).lower()}; {wanted}")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise Wrong(f"{where} is {value}; {wanted}") from None
    if not math.isfinite(number):
        raise Wrong(f"{where} is {value}; {wanted}, a finite one")
    return number


def _within(value: float, low: float, high: float, where: str, unit: str, above: bool = False, why: str = "") -> None:
    if low <= value <= high and not (above and value <= low):
        return
    of = f" {unit}" if unit and unit != "-" else ""
    wanted = f"more than {low:g} and up to {high:g}{of}" if above else f"{low:g} .. {high:g}{of}"
    raise Wrong(f"{where} is {value:g}; it must be {wanted}{why}")


def rounded(value: float) -> float:
    return float(f"{value:.6g}")
