#!/usr/bin/python3
"""Bad thermometers under composition control from tray temperatures (docs/methods/inferential.md): every law in every mode, a bad primary and a bad
secondary, and the state each must end in. `test_inferential_faults.py table` prints the rows of tests/loop/fault-matrix.md, which a test compares.
The configuration is host_sim/scenarios/composition-cascade.conf, whose thermometers have rate_limit and frozen."""

import re
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests" / "support")]

import sample  # noqa: E402

from reflux import runner, scenario  # noqa: E402
from reflux.logs import Log  # noqa: E402
from reflux.scenario import Event, Line  # noqa: E402

HOUR = 3600.0
BEGINS, ENDS, OVER = 2 * HOUR, 2.5 * HOUR, 4 * HOUR
SCENARIO = ROOT / "host_sim" / "scenarios" / "composition-cascade.toml"
LAWS = ("conventional", "cascade", "clf")
MANUAL, AUTO, CASCADE = "0", "1", "2"
LEAST, MOST = 1500.0, 5800.0  # of Q
Q_SPAN = 6000.0


@dataclass(frozen=True)
class Mode:
    name: str
    lines: tuple[str, ...]
    shown: str
    config: tuple[str, ...] = ()


MODES = (
    Mode("manual", (), MANUAL),
    Mode("auto", ("mode tray auto", "sp tray 328.12"), AUTO),
    Mode("cascade", ("mode tray cascade", "mode purity auto", "sp purity 0.02"), CASCADE),
    Mode("at a limit", ("mode tray auto", "sp tray 327"), AUTO, ("set mv2.min 4120",)),
)


@dataclass(frozen=True)
class Fault:
    name: str
    begins: tuple[tuple[str, float], ...]  # options of the thermometer
    ends: tuple[tuple[str, float], ...]
    lost: bool = True  # it is seen to be bad, and for longer than `hold`
    doubted: bool = True  # a secondary is not good for ten steps


FAULTS = (
    Fault("flagged bad", (("quality", 2),), (("quality", 0),)),
    Fault("missing", (("quality", 3),), (("quality", 0),)),
    Fault("not a number", (("nan", 1),), (("nan", 0),)),
    Fault("frozen", (("frozen", 1),), (("free", 1),)),
    Fault("dead: the lower end of its span, called good", (("dead", 1),), (("free", 1),)),
    Fault("stuck 60 K too high", (("stuck", 388),), (("free", 1),)),
    Fault("spikes of 20 K, 20 an hour", (("spike", 20), ("spike_rate", 20)), (("spike_rate", 0),), False, False),
    Fault("uncertain", (("quality", 1),), (("quality", 0),), False),
    Fault("half of its samples missing", (("dropout", 0.5),), (("dropout", 0),), False, False),
)
PLACES = (("primary", "T33"), ("secondary", "T34"))


@dataclass(frozen=True)
class Outcome:
    log: Log
    events: list[tuple[float, str, str, str]]


def play(law: str, mode: Mode, fault: Fault, channel: str) -> Outcome:
    base = scenario.load(SCENARIO)
    config = tuple(
        replace(line, text=f"set block1.law.1 {law}") if line.text.startswith("set block1.law.1") else line
        for line in base.config
    )
    more = tuple(Line(0.0, text) for text in mode.config)
    lines = tuple(line for line in base.lines if line.text.startswith("out ")) + tuple(
        Line(1800.0, text) for text in mode.lines
    )
    events = tuple(e for e in base.events if e.at_s == 0)
    for at, options in ((BEGINS, fault.begins), (ENDS, fault.ends)):
        events += tuple(Event(at, f"{channel}.{option}", value) for option, value in options)
    played = replace(
        base,
        firmware="memory",
        duration_s=OVER,
        limits=(),
        lines=lines,
        events=events,
        config=(*config[:-1], *more, config[-1]),
    )
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        log = runner.run(played, runner.Options(Path(folder) / "out", quiet=True)).log
        return Outcome(log, runner.events_in(Path(folder) / "out" / "transcript.txt"))


def mode_at(outcome: Outcome, at: float) -> str:
    t = outcome.log.numbers("time")
    return outcome.log.text("fw.tray.mode")[min(range(len(t)), key=lambda k: abs(t[k] - at))]


def told(outcome: Outcome, code: str, words: str) -> bool:
    return any(c == code and words in text for t, _, c, text in outcome.events if t >= BEGINS)


def expected(law: str, mode: Mode, fault: Fault, place: str) -> tuple[str, bool]:
    """Mode of the tray's loop in the end, and whether the block says that it goes on without its secondary."""
    if place == "primary":
        return (MANUAL if fault.lost else mode.shown), False
    return mode.shown, fault.doubted and law != "conventional" and mode.shown != MANUAL


def rows() -> list[str]:
    words = {MANUAL: "the loop goes to manual, its output stays", "": ""}
    out = ["| fault | primary | secondary, `cascade` and `clf` | secondary, `conventional` |", "|---|---|---|---|"]
    for fault in FAULTS:
        primary = words[MANUAL] if fault.lost else "the loop goes on"
        secondary = (
            "the loop goes on as `conventional`, no_2nd is told; back by itself"
            if fault.doubted
            else "the loop goes on"
        )
        out.append(f"| {fault.name} | {primary} | {secondary} | nothing |")
    return out


class Faults(unittest.TestCase):
    def judge(self, law: str, mode: Mode, fault: Fault, place: str, outcome: Outcome) -> None:
        shown, alone = expected(law, mode, fault, place)
        log, t = outcome.log, outcome.log.numbers("time")
        self.assertEqual(mode_at(outcome, BEGINS - 60), mode.shown)
        self.assertEqual(mode_at(outcome, OVER), shown)
        self.assertEqual(told(outcome, "BLOCK_ALARM", "no_2nd"), alone)
        self.assertEqual(told(outcome, "BLOCK_GAVE_UP", ""), False)
        self.assertEqual(
            told(outcome, "MEASUREMENT_BAD", "T33" if place == "primary" else "T34"),
            fault.lost or "uncertain" != fault.name,
        )
        least = 4120.0 if mode.config else LEAST
        for k, u in enumerate(log.numbers("Q.applied")):
            if t[k] > BEGINS:
                self.assertTrue(least - 0.1 <= u <= MOST, (t[k], u))
        if shown == MANUAL and mode.shown != MANUAL:  # held: it stands where it was when it was lost
            u = [v for k, v in enumerate(log.numbers("Q.applied")) if t[k] > ENDS]
            self.assertLess(max(u) - min(u), 1e-3)
        elif mode.shown == AUTO and not mode.config and not (place == "primary" and fault.name.startswith("half")):
            # A kelvin: the noise of 0.05 K, and what readings of up to 300 s ago make of it.
            away = [abs(a - b) for x, a, b in zip(t, log.numbers("T33.true"), log.numbers("fw.tray.sp")) if x > BEGINS]
            self.assertLess(max(away), 1.0)
            u = log.numbers("Q.cmd")
            moves = [abs(u[k] - u[k - 1]) for k in range(1, len(u)) if t[k] > BEGINS]
            self.assertLess(max(moves), 0.05 * Q_SPAN)  # the same noise; a spike taken for true would be 300 %

    def test_every_law_in_every_mode_ends_as_it_must_with_a_bad_primary_and_a_bad_secondary(self) -> None:
        cases = sample.combinations(LAWS, MODES, FAULTS, PLACES, stride=3)
        with ThreadPoolExecutor(2) as pool:
            outcomes = list(pool.map(lambda c: play(c[0], c[1], c[2], c[3][1]), cases))
        for (law, mode, fault, (place, _)), outcome in zip(cases, outcomes):
            with self.subTest(law=law, mode=mode.name, fault=fault.name, place=place):
                self.judge(law, mode, fault, place, outcome)
        print(f"{len(cases)} combinations")

    def test_the_page_has_these_rows(self) -> None:
        page = (ROOT / "tests" / "loop" / "fault-matrix.md").read_text(encoding="utf-8")
        section = page.split("## Composition control from tray temperatures")[1]
        self.assertEqual(re.findall(r"^\|.*$", section.split("\n## ")[0], re.MULTILINE), rows())


if __name__ == "__main__":
    if sys.argv[1:] == ["table"]:
        print("\n".join(rows()))
    else:
        unittest.main(argv=[sys.argv[0], "-v"])
