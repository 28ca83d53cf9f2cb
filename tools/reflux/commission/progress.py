"""Watching a start-up: events in words as they come, and on a terminal one line that is written over."""

from __future__ import annotations

import contextlib
import re
import sys
from typing import Callable

from reflux.commission.answers import Answers, Wrong
from reflux.commission.board import UNDER_WAY, Board, Event, Progress
from reflux.commission.keyboard import Keyboard
from reflux.session import Refused

LOOK_S = 0.2
DIRECTION = "direction"  # where an input has its name: all of them are moved together
QUIET = ("OUTPUT", "MODE", "SETPOINT", "FOLLOWING", "NOT_FOLLOWING")  # of our own doing


def span_of_time(seconds: float) -> str:
    if seconds < 120:
        return f"{seconds:.3g} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 120 else f"{minutes // 60} h {minutes % 60:02d} min"


def held(event: Event) -> str:
    """An output that was in an interlock's hand does not go back by itself."""
    return ", but what the interlock held stays at its value until somebody moves it" if "interlock" in reason(event) else ""


def in_words(event: Event, answers: Answers) -> str | None:
    """Words for an event; None for one that nobody needs to see."""
    def amount(share: float) -> str:
        try:
            v = answers.channel(event.subject)
        except Wrong:
            return f"{100 * share:.3g} % of span"
        return f"{share * (v.values['hi'] - v.values['lo']):.3g} {v.channel.unit}"

    name, x = event.subject, event.value
    words: dict[str, Callable[[], str]] = {
        "COMMISSION_BEGUN": lambda: f"begun: {x:g} input{'s' if x != 1 else ''} to test, once the plant is at rest",
        "TEST_STEP": lambda: f"{name}: at rest; step of {amount(x)} to begin with",
        "TEST_CUT": lambda: f"{name} would go {amount(x)} from rest: the step turns round",
        "TEST_DONE": lambda: f"{name}: tested, half a double step took {span_of_time(x)}",
        "TEST_LONGER": lambda: f"{name}: an output was not at rest; testing again, {span_of_time(x)} for each half",
        "TEST_SMALLER": lambda: f"{name}: the steps grew too large; testing again with steps up to about {amount(x)}",
        "TEST_EXTENDED": lambda: f"not sure enough yet (probability of the pairing {x:.2g}): testing {what_next(name)}",
        "PROPOSAL": lambda: f"the pairing is determined, probability {x:.3g}",
        "NOT_DETERMINED": lambda: f"no proposal: {reason(event)}; probability of the pairing {x:.3g}",
        "COMMISSION_ENDED": lambda: f"ended: {reason(event)}; the inputs are back where they were held{held(event)}",
        "TRIAL_BEGUN": lambda: f"{x:g} proposed loop{'s' if x != 1 else ''} on trial: at rest first, then each setpoint is stepped",
        "TRIAL_KEPT": lambda: "1 loop matched the prediction and stays" if x == 1 else f"{x:g} loops matched the prediction and stay",
        "TRIAL_FAILED": lambda: f"rolled back: {reason(event)}; the old settings return",
    }
    if event.code in words:
        return words[event.code]()
    if event.code == "SETPOINT":
        return f"{name}: setpoint {x:.4g}"
    if event.code in QUIET or event.level == "action" or event.code == "CONFIG_APPLIED":
        return None
    return f"{event.level}: {'' if name == '-' else name + ' '}{event.text} {x:.4g}"


def what_next(name: str) -> str:
    return "all inputs together, because they act nearly alike" if name == DIRECTION else "the inputs again with which it may become surer"


def reason(event: Event) -> str:
    """Why it ended: what follows the colon of the event's text."""
    why = event.text.partition(": ")[2] or event.text
    return why if event.subject == "-" else f"{event.subject} {why}"


def status_words(p: Progress) -> str:
    out = p.phase
    if p.input:
        out = f"input {p.input} ({p.number} of {p.total}), round {p.round}: {p.stage}, amplitude {p.amplitude}"
        if p.worst:
            out += f"; nearest its limit: {p.worst[0]} at {100 * p.worst[1]:.0f} %"
    elif p.text and p.phase in UNDER_WAY:
        out = p.text
    return "; ".join(filter(None, [f"{span_of_time(p.plant_s)}  {out}", left_words(p)]))


def left_words(p: Progress) -> str:
    """`left about 3600 s of this round, ...`, its seconds as a person would say them."""
    return re.sub(r"(\d+) s\b", lambda seconds: span_of_time(float(seconds[1])), p.left)


class View:
    """Lines that stay, and one that does not."""

    def __init__(self) -> None:
        self.terminal = sys.stdout.isatty()
        self.last = ""

    def line(self, text: str) -> None:
        print(f"\r\033[K{text}" if self.terminal and self.last else text, flush=True)
        self.last = ""

    def status(self, text: str) -> None:
        if self.terminal and text != self.last:
            print(f"\r\033[K{text[:160]}", end="", flush=True)
            self.last = text

    def end(self) -> None:
        if self.terminal and self.last:
            print("\r\033[K", end="", flush=True)
        self.last = ""


def follow(board: Board, answers: Answers, keyboard: Keyboard | None, alive: Callable[[], None],
           until: tuple[str, ...], words: tuple[str, ...]) -> Progress:
    """Watches until the phase is one of these; passes the words typed on. alive raises where the plant's process has
    ended."""
    view = View()
    stage = ""
    if keyboard:
        view.line(keyboard.legend(words))
    try:
        with keyboard.keys() if keyboard else contextlib.nullcontext():
            while True:
                board.listen(LOOK_S)
                alive()
                p = board.progress()
                for event in board.new_events():
                    told = in_words(event, answers)
                    if told:
                        view.line(f"{event.at_s:12.0f} s  {told}")
                    if event.code == "TEST_DONE" and p.left:
                        view.line(f"{'':14s}  {left_words(p)}")
                now = "paused" if p.phase == "paused" else ""
                if now and not stage:
                    view.line(f"{'':14s}  paused: the inputs are where they were held; resume begins this test anew")
                stage = now
                view.status(status_words(p))
                if p.phase in until:
                    return p
                word = keyboard.command() if keyboard else None
                if word in words:
                    _tell(board, view, word)
    finally:
        view.end()


def _tell(board: Board, view: View, word: str) -> None:
    try:
        board.ask(f"commission {word}")
        view.line(f"{'':14s}  {word}")
    except Refused as error:
        view.line(f"{'':14s}  {word} is refused: {error}")

