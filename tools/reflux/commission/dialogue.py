"""The guided part: the plant and every answer with its default and what it means, section by section; an empty line
keeps a section as it stands."""

from __future__ import annotations

import textwrap
from typing import Any, Callable

from reflux import table
from reflux.commission.answers import AUTO, INPUT, MEASUREMENT, TEST, Answers, Field, Values, Wrong
from reflux.commission.board import Plant, State
from reflux.commission.keyboard import Keyboard
from reflux.errors import UserError

WIDTH = 110


def say(text: str = "") -> None:
    print(text, flush=True)


def heading(text: str) -> None:
    say(f"\n{text}\n{'-' * len(text)}")


def plant_lines(plant: Plant, state: State) -> str:
    rows, header = [], ["kind", "name", "unit", "span", "now", "safe"]
    for kind, channels in (("measurement", plant.measurements), ("input", plant.inputs)):
        for c in channels:
            now = f"{state.values[c.name]:.4g}" if c.name in state.values else "-"
            rows.append([kind, c.name, c.unit, f"{c.lo:g} .. {c.hi:g}", now,
                         f"{c.safe:g}" if kind == "input" else ""])
    if all(row[4] == "-" for row in rows):  # the board has no channels yet, so it has read nothing
        header, rows = [*header[:4], header[5]], [[*row[:4], row[5]] for row in rows]
    return table.columns(header, rows)


def shown(field: Field, values: Values) -> str:
    value = values.values[field.name]
    if value is None:
        return "?"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return value if isinstance(value, str) else f"{value:.6g}"


def channel_table(all_values: list[Values], fields: tuple[Field, ...]) -> str:
    """A column for each field that is asked of any of them."""
    used = [f for f in fields if any(f in v.asked() for v in all_values)]
    rows = [[v.channel.name, v.channel.unit, *(shown(f, v) for f in used)] for v in all_values]
    return table.columns(["", "unit", *(f.name for f in used)], rows)


def explain(fields: Any) -> None:
    width = max(len(f.name) for f in fields)
    for f in fields:
        unit = getattr(f, "unit", "")
        text = f"{f.help}{f' [{unit}]' if unit else ''}"
        say(textwrap.fill(text, WIDTH, initial_indent=f"  {f.name:{width}s}  ", subsequent_indent=" " * (width + 4)))


def section(keyboard: Keyboard, show: Callable[[], None], change: Callable[[list[str]], None],
            example: str, done: Callable[[], str | None] = lambda: None) -> None:
    """Shows, asks, changes, until an empty line keeps it."""
    show()
    while True:
        line = keyboard.ask(f"Enter keeps it; or change, such as `{example}` > ")
        words = line.split()
        if not words:
            missing = done()
            if missing is None:
                return
            say(f"  {missing}")
        elif words == ["?"]:
            show()
        else:
            try:
                change(words)
            except Wrong as error:
                say(f"  {error}")
            else:
                show()


def named(words: list[str], start: int) -> dict[str, str]:
    """name value name value ..."""
    rest = words[start:]
    if not rest or len(rest) % 2:
        raise Wrong("give names and values in turn, such as `limit 3`")
    return dict(zip(rest[::2], rest[1::2]))


def channels(keyboard: Keyboard, all_values: list[Values], fields: tuple[Field, ...], example: str,
             done: Callable[[], str | None] = lambda: None) -> None:
    by_name = {v.channel.name: v for v in all_values}

    def change(words: list[str]) -> None:
        if words[0] not in by_name:
            raise Wrong(f"there is no {words[0]} here; there are {', '.join(by_name)}")
        by_name[words[0]].change(named(words, 1))

    def show() -> None:
        say(channel_table(all_values, fields))

    explain([f for f in fields if any(f in v.asked() for v in all_values)])
    say()
    section(keyboard, show, change, example, done)


def ask_all(keyboard: Keyboard, answers: Answers) -> None:
    first, source = answers.measurements[0].channel.name, answers.inputs[0].channel.name
    heading("Measurements")
    limit = float(f"{answers.measurements[0].values['limit'] / 2:.3g}")
    channels(keyboard, answers.measurements, MEASUREMENT, f"{first} limit {limit:g}")
    heading("Inputs")
    say("The plant must be at rest at its operating point before the tests; `at` is that point.\n")
    channels(keyboard, answers.inputs, INPUT, f"{source} max {answers.inputs[0].values['max']:g}", answers.missing)
    heading("What is known")
    say(f"You may state up to {answers.known_room} elements, or none. `time` is dead time and time constant together (s); "
        "it makes the steps\nlong enough at once. `gain` (output unit per input unit) sets the first amplitude. `pair yes` means "
        "that this input\ncontrols that measurement; start-up then looks for no other pairs.\n")
    section(keyboard, lambda: say(known_table(answers)), lambda words: _know(answers, words),
            f"{first} {source} time 900 gain 2", answers.missing)
    heading("Tests")
    say(f"Sample interval: {answers.tick_s:g} s, as the plant announces it{interval_advice(answers)} It is set at the "
        "plant (--tick, with --plant).")
    explain(TEST)
    say()
    section(keyboard, lambda: say(test_table(answers)), lambda words: _test(answers, words), "rounds 2")


def _know(answers: Answers, words: list[str]) -> None:
    if len(words) < 2:
        raise Wrong("give a measurement, an input, and what you know")
    given = named(words, 2)
    if strange := set(given) - {"time", "gain", "pair"}:
        raise Wrong(f"there is no {min(strange)}; there are time, gain and pair")
    have = next((k for k in answers.known if (k.measurement, k.input) == (words[0], words[1])), None)
    answers.add_known(words[0], words[1], given.get("time", have.time_s if have else 0.0),
                      given.get("gain", have.gain if have else 0.0), given.get("pair", have.pair if have else False))


def _test(answers: Answers, words: list[str]) -> None:
    before = dict(answers.test)
    try:
        for name, value in named(words, 0).items():
            answers.change_test(name, value)
    except Wrong:
        answers.test = before
        raise


def known_table(answers: Answers) -> str:
    if not answers.known:
        return "nothing is known beforehand"
    return table.columns(["measurement", "input", "time", "gain", "pair"],
                         [[k.measurement, k.input, f"{k.time_s:g}" if k.time_s else "-", f"{k.gain:g}" if k.gain else "-",
                           "yes" if k.pair else "no"] for k in answers.known])


def test_table(answers: Answers) -> str:
    return table.columns([f.name for f in TEST], [[f"{answers.test[f.name]:g}" if not f.words else answers.test[f.name]
                                                   for f in TEST]])


def interval_advice(answers: Answers) -> str:
    """Ten to fifty samples of a residence time: less shows no shape, more only noise. A critical input counts first."""
    critical = [v.channel.name for v in answers.inputs if v.values["critical"]]
    times = [k.time_s for k in answers.known if k.time_s > 0 and (not critical or k.input in critical)]
    if not times:
        return "."
    low, high = min(times) / 50, min(times) / 10
    verdict = "fits" if low <= answers.tick_s <= high else "is short for" if answers.tick_s < low else "is long for"
    return f"; that {verdict} the {min(times):g} s known of an element ({low:.3g} .. {high:.3g} s)."


def summary(answers: Answers) -> str:
    out = ["Measurements", channel_table(answers.measurements, MEASUREMENT), "", "Inputs",
           channel_table(answers.inputs, INPUT), "", "Known", known_table(answers), "", "Test", test_table(answers)]
    return "\n".join(out)


# As firmware/commission/expected.c has it: up, down and back, and rest before and after; at most until what still climbs counts as
# a drift. In all rounds a test may be made again with longer halves, and with smaller steps.
HALVES, WINDOWS, KNOWN_TIMES, LONGEST_SAMPLES = 3, 2, 4, 1000  # where no longest half is set: a slower response asks for more
HALVES_MOST, WINDOWS_MOST, WINDOW_WIDEST = 3.5, 3, 0.25
LONGER_MOST, SMALLER_MOST = 3, 1 + 3
FIRST_SHARE, MOST_SHARE = 0.005, 0.25  # of an input's span: the first step, and the largest, where it is to be found
FIRST_OF_LIMIT = 0.01  # the first step is no larger than this share of any limit, both in spans


def test_hours(answers: Answers) -> tuple[float, float]:
    """Hours of plant time for all tests: at the least times known, once; and with the longest steps in all rounds, each made again as
    often as it may be."""
    window = answers.test["window"] * answers.tick_s
    longest = answers.test["longest"] or LONGEST_SAMPLES * answers.tick_s
    least = most = 0.0
    for v in tested(answers.inputs):
        known = [KNOWN_TIMES * k.time_s for k in answers.known if k.input == v.channel.name]
        half = (v.values["time"],) * 2 if v.values["time"] != AUTO else (min(max([window, *known]), longest), longest)
        tests = answers.test["rounds"]
        tests += (LONGER_MOST if v.values["time"] == AUTO else 0) + (SMALLER_MOST if v.values["step"] == AUTO else 0)
        least += HALVES * half[0] + WINDOWS * window
        most += tests * (HALVES_MOST * half[1] + WINDOWS_MOST * max(window, WINDOW_WIDEST * half[1]))
    return least / 3600, most / 3600


def tested(all_values: list[Values]) -> list[Values]:
    return [v for v in all_values if v.values["tested"]]


def limit(v: Values) -> float:
    """Distance from rest at which a test stops, in the measurement's unit."""
    return v.values["limit"] * (0.5 if v.values["critical"] else 1)


def first_share(answers: Answers) -> float:
    """First step where the test finds it, as a share of the input's span."""
    limits = [limit(v) / (v.values["hi"] - v.values["lo"]) for v in tested(answers.measurements)]
    return min([FIRST_SHARE, *(FIRST_OF_LIMIT * share for share in limits)])


def expectations(answers: Answers) -> list[str]:
    """By how much the plant will be moved, and for about how long."""
    lines, smallest = [], first_share(answers)
    for v in tested(answers.inputs):
        span, step = v.values["hi"] - v.values["lo"], v.values["step"]
        first, most = (step, step) if step != AUTO else (min(share * span, v.room()) for share in (smallest, MOST_SHARE))
        grows = f", growing to +/-{most:.3g} at most" if most > first else ""
        lines.append(f"{v.channel.name}: +/-{first:.3g} {v.channel.unit} around {v.values['at']:.4g}{grows}")
    lines += [f"{v.channel.name}: the test stops beyond +/-{limit(v):.3g} {v.channel.unit}" for v in tested(answers.measurements)]
    least, most = test_hours(answers)
    longest = answers.test["longest"] or LONGEST_SAMPLES * answers.tick_s
    lines.append(f"The tests take {least:.3g} h at least. Expect about 20 times the slowest dead time and time constant together for each "
                 f"input. If each response takes {longest:g} s and every test is repeated, they take {most:.4g} h. The trial is extra.")
    return lines


def may_begin(keyboard: Keyboard) -> bool:
    while True:
        word = keyboard.ask("begin? yes or no > ").lower()
        if word in ("yes", "no"):
            return word == "yes"
        say("  This moves the plant. Type yes or no.")


def decide(keyboard: Keyboard) -> str:
    """On a proposal."""
    while True:
        word = keyboard.ask("accept (it is tried on the plant), edit, or reject? > ").lower()
        if word in ("accept", "edit", "reject"):
            return word
        say(f"  {word} is not an answer; type accept, edit or reject" if word else
            "  This puts loops into automatic. Type the whole word: accept, edit or reject.")


def check_edit(line: str) -> str:
    """A line of an edit as the board takes it."""
    words = line.split()
    if words[:1] == ["set"]:
        words = words[1:]
    if len(words) != 2 or "." not in words[0]:
        raise UserError(f"{line}: give a parameter and its value, such as `loop1.gain 1.2`")
    return f"set {words[0]} {words[1]}"
