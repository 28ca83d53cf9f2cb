"""What a board has at its own pins, as its settings `chan`, `out`, `meas` and `mv` say."""

from __future__ import annotations

from dataclasses import dataclass

from reflux.errors import UserError
from reflux.session import Session

UNUSED, LINK = "-", "link"
# kinds of output whose pin is on or off, not something between
ON_OFF = ("relay",)
STEP_SHARE = 0.1  # of the span that the board may use: enough to see, little to spoil


@dataclass(frozen=True)
class Channel:
    """A sensor and its measurement."""

    name: str
    unit: str
    where: str  # for people
    meas: str  # meas1
    span: float
    gain: float
    zero: float
    valid_lo: float
    valid_hi: float


@dataclass(frozen=True)
class Output:
    """An output and its manipulated variable."""

    name: str
    unit: str
    where: str
    kind: str
    heater: bool
    least: float
    most: float
    safe: float

    def little(self) -> float:
        """A value that shows that it moves: a little from the safe one; a relay is switched on."""
        if self.kind in ON_OFF:
            return self.most
        step = STEP_SHARE * (self.most - self.least)
        value = min(max(self.safe + step, self.least), self.most)
        return value if value != self.safe else self.safe - step


@dataclass(frozen=True)
class Wiring:
    """Everything at the pins. enables: pins of contactors in series with the heaters, which the board switches by itself."""

    channels: list[Channel]
    outputs: list[Output]
    enables: list[str]


def read(talk: Session) -> Wiring:
    """UserError: the board takes its plant from the link, or nothing is at its pins."""
    rows: dict[str, dict[str, str]] = {}
    for prefix in ("io", "chan", "out", "meas", "mv"):
        for line in talk.ask(f"list {prefix}"):
            name, _, value = line.partition(" = ")
            row, _, what = name.partition(".")
            rows.setdefault(row, {})[what] = value.split()[0]
    if rows.get("io", {}).get("source", LINK) == LINK:
        raise UserError("the board takes its plant from the link: `set io.source board` after the sensors and outputs have their settings "
                        "(docs/use/pins.md)")
    used = {row: own for row, own in rows.items() if own.get("name", UNUSED) != UNUSED}
    channels = [_channel(own, used) for row, own in used.items() if row.startswith("chan")]
    outputs = [_output(own, used) for row, own in used.items() if row.startswith("out")]
    if not channels and not outputs:
        raise UserError("no sensor and no output has settings: set chan1.name, out1.name and the others first (docs/use/pins.md)")
    enables = [own["pin"] for row, own in rows.items() if row.startswith("out") and own["kind"] == "enable"]
    return Wiring(channels, [output for output in outputs if output.kind != "enable"], enables)


def _of(name: str, group: str, rows: dict[str, dict[str, str]]) -> tuple[str, dict[str, str]]:
    for row, own in rows.items():
        if row.rstrip("0123456789") == group and own["name"] == name:
            return row, own
    raise UserError(f"{name} is at the pins and no {group} has this name: set {group}1.name {name}, its unit and its span")


def _channel(own: dict[str, str], rows: dict[str, dict[str, str]]) -> Channel:
    meas, settings = _of(own["name"], "meas", rows)
    at = [own["device"], *(f"on {own['bus']}" for _ in (1,) if own["bus"] != UNUSED), own["select"]]
    number = {key: float(settings[key]) for key in ("lo", "hi", "gain", "zero", "valid_lo", "valid_hi")}
    return Channel(own["name"], "" if own["unit"] == UNUSED else own["unit"], " ".join(at), meas, number["hi"] - number["lo"],
                   number["gain"], number["zero"], number["valid_lo"], number["valid_hi"])


def _output(own: dict[str, str], rows: dict[str, dict[str, str]]) -> Output:
    where = " ".join([own["kind"], "on", own["pin"], *(own[pin] for pin in ("pin2",) if own[pin] != UNUSED)])
    if own["kind"] == "enable":
        return Output(own["name"], "", where, own["kind"], False, 0.0, 1.0, 0.0)
    settings = _of(own["name"], "mv", rows)[1]
    least, most, safe = (float(settings[key]) for key in ("min", "max", "safe"))
    return Output(own["name"], "" if own["unit"] == UNUSED else own["unit"], where, own["kind"], own["heater"] == "on", least, most, safe)
