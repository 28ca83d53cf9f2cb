"""Events as sentences for people, as the console says them (firmware/console/event_sentence.c), from the lines for scripts that a transcript holds."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Callable, Mapping

from reflux import scenario_settings

# %s: the subject, %v: the value in the unit of the subject, %n: the value alone, %m: a mode, %b: "block 2: settle", %i: what an interlock watches. The part
# behind a bar stands where the value is 0, of RESTART_DONE where it is 1.
PATTERNS = {
    "STARTED": "started in the safe state: %s", "MODE": "%s %m", "SETPOINT": "%s setpoint %v", "OUTPUT": "%s output %v",
    "SAMPLE_TWICE": "sample %n repeated or out of order", "SAMPLE_EARLY": "sample %n s early", "SAMPLE_LATE": "sample %n s late",
    "SAMPLE_MISSING": "%n samples missing", "MEASUREMENT_BAD": "%s not usable at %v, last value held", "MEASUREMENT_GOOD": "%s usable again, %v",
    "INTERLOCK_ON": "interlock holds %s, %i", "INTERLOCK_OFF": "interlock releases %s, %i", "TELEMETRY_LOST": "%n telemetry rows lost",
    "MANUAL_BY_BOARD": "the board has put %s into manual",
    "ALARM_ON": "%s: %v, beyond its limit", "ALARM_OFF": "%s: %v, the alarm is over",
    "ALARM_SHELVED": "alarm %s silent for %n s|alarm %s no longer silent",
    "RESTART_DONE": "as before the reset: outputs, modes, setpoints|as before the reset: outputs", "PLANT_REFUSED": "plant %s refused (%n)",
    "STORAGE_REFUSED": "%s: stored set %n refused, `load` says why", "SAME_READING": "%s sends the same numbers as meas%n",
    "SEQUENCE_CONFIRMED": "%s: step %n confirmed", "SEQUENCE_SKIPPED": "%s: wait of step %n skipped",
    "SEQUENCE_TIMEOUT": "%s: step %n took longer than allowed", "OFFSET": "%v subtracted from %s|%s: no offset any more", "BLOCK_VERB": "%b done",
    "BLOCK_EVENT": "%b %n", "BLOCK_ALARM": "%b %n",
}
WITHOUT_REASON = ("STARTED", "ALARM_SHELVED", "OFFSET")  # a colon in their text begins none
TEXT_HAS_COLON = ("STORAGE_NEWER", "STORAGE_CLIPPED", "BLOCK_UNKNOWN")  # before the semicolon of their text; a reason comes after all of it
LOOPS = ("SETPOINT", "DEVIATION", "DEVIATION_OVER", "WATCH_LOOP")
MEASUREMENTS = ("MEASUREMENT_BAD", "MEASUREMENT_GOOD", "OFFSET", "DOUBTFUL", "DOUBTFUL_OVER", "FIRST_READING")
OUTPUTS = ("OUTPUT", "NOT_FOLLOWING", "FOLLOWING")
ALARMS = ("ALARM_ON", "ALARM_OFF")
MODES = ("MANUAL", "AUTO", "CASCADE")
WITH_CODE = ("warning", "alarm")


@dataclass
class Names:
    """What a configuration calls things: units of measurements and outputs, measurement and output of loops, measurements whose interlocks hold an output."""

    measurements: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, str] = field(default_factory=dict)
    loops: dict[str, tuple[str, str]] = field(default_factory=dict)
    locks: dict[str, list[str]] = field(default_factory=dict)

    def of_loop(self, name: str) -> str:
        return self.measurements.get(self.loops.get(name, ("", ""))[0], "")

    def of_output(self, name: str) -> str:
        """The subject is an output, or a loop that drives one or the setpoint of another loop."""
        out = self.loops.get(name, ("", ""))[1]
        return next((self.outputs[x] for x in (name, out) if x in self.outputs), self.of_loop(out))

    def of_alarm(self, name: str) -> str:
        on, _, side = name.rpartition(".")
        return self.of_loop(on) if side == "dev" else self.measurements.get(on, "")


def names_of(values: Mapping[str, str], unit: Callable[[str], str] = lambda name: "") -> Names:
    """values: parameters. unit: of a channel for which they have none."""
    def units(group: str) -> dict[str, str]:
        found = {name: values.get(f"{k}.unit") or unit(name) for name, k in scenario_settings.in_use(values, group).items()}
        return {name: "" if said == "-" else said for name, said in found.items()}

    out = Names(units("meas"), units("mv"), {name: (values.get(f"{k}.pv", ""), values.get(f"{k}.out", ""))
                                             for name, k in scenario_settings.in_use(values, "loop").items()})
    for k in scenario_settings.numbered(values, "lock"):
        out.locks.setdefault(values.get(f"{k}.mv", "-"), []).append(values.get(f"{k}.meas", "-"))
    return out


def sentence(level: str, code: str, rest: str, names: Names) -> str:
    """rest: subject, value and text. What is no event of this form is given back as it is."""
    subject, value_text, text = [*rest.split(" ", 2), "", "", ""][:3]
    try:
        value = float(value_text) if value_text != "none" else math.nan
    except ValueError:
        return f"{code} {rest}".strip()
    subject = "" if subject == "-" else subject
    pattern = PATTERNS.get(code)
    words = _by_pattern(code, pattern, subject, value, text, names) if pattern else _by_text(code, subject, value, text, names)
    return f"{words} ({code})" if level in WITH_CODE or code == "STARTED" else words


def _by_pattern(code: str, pattern: str, subject: str, value: float, text: str, names: Names) -> str:
    usual, _, special = pattern.partition("|")
    words = special if special and value == (1 if code == "RESTART_DONE" else 0) else usual
    for mark, said in (("%v", lambda: in_unit(code, subject, value, names)), ("%n", lambda: count(value)), ("%m", lambda: mode(value)),
                       ("%b", lambda: block_word(subject)), ("%i", lambda: watched(subject, value, names)), ("%s", lambda: subject)):
        if mark in words:
            words = words.replace(mark, said())
    reason = "" if code in WITHOUT_REASON else text.partition(": ")[2]
    return f"{words}: {reason}" if reason else words


def _by_text(code: str, subject: str, value: float, text: str, names: Names) -> str:
    """The subject, the text, and the value behind the words after its semicolon."""
    head, tail = text, ""
    if ";" in text and (code in TEXT_HAS_COLON or ":" not in text[:text.index(";")]):
        head, _, tail = text.partition("; ")
    meaning, colon, reason = tail.partition(": ")
    if meaning == "block":
        acts = head.startswith("a block ")
        named = f"block {count(value)}" + (f" ({subject})" if subject else "")
        return f"{named}{' ' if acts else ': '}{head.removeprefix('a block ')}{colon}{reason}"
    about = f"{subject}: " if subject else ""
    if tail:
        return f"{about}{head}, {with_value(code, meaning, subject, value, names)}{colon}{reason}"
    said, colon, reason = head.partition(": ")
    if said.endswith((", s", " step")):
        return f"{about}{with_value(code, said, subject, value, names)}{colon}{reason}"
    return about + head


def with_value(code: str, words: str, subject: str, value: float, names: Names) -> str:
    """"base tick, s" as "base tick 1 s" """
    if words.endswith(share := ", fraction of span"):
        return f"{words.removesuffix(share)} {four_digits(100 * value)} % of span"
    if words.endswith(", s"):
        return f"{words.removesuffix(', s')} {count(value)} s"
    has_unit = code in LOOPS + MEASUREMENTS + OUTPUTS + ALARMS
    return f"{words} {in_unit(code, subject, value, names) if has_unit else count(value)}"


def in_unit(code: str, subject: str, value: float, names: Names) -> str:
    if code in LOOPS:
        unit = names.of_loop(subject)
    elif code in MEASUREMENTS:
        unit = names.measurements.get(subject, "")
    elif code in OUTPUTS:
        unit = names.of_output(subject)
    else:
        unit = names.of_alarm(subject) if code in ALARMS else ""
    return f"{four_digits(value)} {unit}".rstrip()


def watched(output: str, value: float, names: Names) -> str:
    """Of several interlocks of an output an event does not say which it was."""
    locks = names.locks.get(output, [])
    if len(locks) != 1 or locks[0] not in names.measurements:
        return f"measurement {four_digits(value)}"
    return f"{locks[0]} {four_digits(value)} {names.measurements[locks[0]]}".rstrip()


def mode(value: float) -> str:
    return MODES[int(value)] if 0 <= value < len(MODES) else "?"


def block_word(subject: str) -> str:
    """"block2.settle" as "block 2: settle" """
    block, dot, word = subject.partition(".")
    spaced = "".join(f" {c}" if c.isdigit() else c for c in block)
    return f"{spaced}: {word}" if dot else spaced


def count(value: float) -> str:
    """Whole numbers, which may count something, keep all digits."""
    return str(int(value)) if 0 <= value < 1e6 and value == int(value) else four_digits(value)


def four_digits(value: float) -> str:
    """A power of ten only where nine digits do not hold the number."""
    if not math.isfinite(value):
        return "none"
    return f"{float(f'{value:.3e}'):.9g}"
