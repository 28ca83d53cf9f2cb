#!/usr/bin/python3
"""Mistakes of a user with the estimator of docs/methods/composition-estimation.md, and what it must say: units forgotten, a thermometer broken from the
start, all thermometers gone for an hour. An estimate that nobody can rely on is not called good."""

import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import runner, scenario  # noqa: E402
from reflux.logs import Log  # noqa: E402
from reflux.scenario import Event, Line  # noqa: E402

HOUR = 3600.0
GOOD, UNCERTAIN, BAD, MISSING = "0", "1", "2", "3"
THERMOMETERS = ("T30", "T31", "T33")


def play(hours: float, events: tuple[Event, ...] = (), set_: tuple[str, ...] = (), without: str = "", *lines: Line):
    """splitter-estimate, the column at rest but for the events: its log and what the block said."""
    base = scenario.load(scenario.find("splitter-estimate"))
    config = [line for line in base.config if not without or without not in line.text]
    config[-1:-1] = [Line(0.0, text) for text in set_]
    outputs = [line for line in base.lines if line.text.startswith("out ")]
    played = replace(
        base,
        duration_s=hours * HOUR,
        firmware="memory",
        config=tuple(config),
        events=events,
        loops=(),
        limits=(),
        lines=(*outputs, *lines),
    )
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        log = runner.run(played, runner.Options(Path(folder) / "out", quiet=True)).log
        told = runner.events_in(Path(folder) / "out" / "transcript.txt")
    return log, {
        text.split()[0].removeprefix("block3.") for _, _, code, text in told if code in ("BLOCK_EVENT", "BLOCK_ALARM")
    }


def rows(log: Log, first: float, last: float):
    """Time, quality and error of the estimate."""
    for t, q, x, true in zip(
        log.numbers("time"), log.text("fw.est_iC4.q"), log.numbers("fw.est_iC4"), log.numbers("iC4_D")
    ):
        if first <= t <= last:
            yield t, q, abs(x - true)


class Attack(unittest.TestCase):
    def good_and_off(self, log: Log, first: float, by: float) -> list:
        return [(t, error) for t, q, error in rows(log, first, 1e9) if q == GOOD and error > by]

    def test_after_an_hour_without_thermometers_the_estimate_is_found_again_before_it_is_good(self) -> None:
        """Without them the model goes to its own steady state, 0.03 off."""
        lost = tuple(Event(3 * HOUR, f"{t}.quality", 3) for t in THERMOMETERS)
        back = tuple(Event(4 * HOUR, f"{t}.quality", 0) for t in THERMOMETERS)
        log, said = play(6, (*lost, *back))
        self.assertEqual(said, {"lost", "alone"})
        self.assertEqual(self.good_and_off(log, HOUR, 0.006), [])
        self.assertEqual({q for t, q, _ in rows(log, 4 * HOUR, 4 * HOUR + 1000)}, {UNCERTAIN})
        self.assertEqual({q for t, q, _ in rows(log, 4 * HOUR + 1200, 6 * HOUR)}, {GOOD})

    def test_a_minute_without_them_costs_a_minute(self) -> None:
        lost = tuple(Event(3 * HOUR, f"{t}.quality", 3) for t in THERMOMETERS)
        back = tuple(Event(3 * HOUR + 60, f"{t}.quality", 0) for t in THERMOMETERS)
        log, _ = play(4, (*lost, *back))
        self.assertEqual({q for t, q, _ in rows(log, 3 * HOUR + 60, 3 * HOUR + 100)}, {UNCERTAIN})
        self.assertEqual({q for t, q, _ in rows(log, 3 * HOUR + 140, 4 * HOUR)}, {GOOD})

    def test_one_of_three_that_comes_back_costs_nothing(self) -> None:
        log, _ = play(4, (Event(3 * HOUR, "T30.quality", 3), Event(3.5 * HOUR, "T30.quality", 0)))
        self.assertEqual({q for t, q, _ in rows(log, 3.5 * HOUR + 20, 4 * HOUR)}, {GOOD})

    def test_a_thermometer_broken_from_the_start_leaves_nothing_good(self) -> None:
        log, said = play(3, (Event(0, "T30.stuck", 395),))
        self.assertIn("nis", said)
        self.assertEqual(self.good_and_off(log, 0, 0.02), [])

    def test_after_a_start_an_input_that_is_missing_is_not_waited_for(self) -> None:
        for channels in (("T30",), ("Fm",), THERMOMETERS):
            events = [Event(0, f"{c}.quality", 3) for c in channels] + [
                Event(1800, f"{c}.quality", 0) for c in channels
            ]
            log, _ = play(1, tuple(events))
            self.assertEqual({q for _, q, _ in rows(log, 30, 1790)} & {MISSING, GOOD}, set(), channels)
            self.assertEqual({q for _, q, _ in rows(log, 3000, HOUR)}, {GOOD}, channels)
            self.assertEqual(self.good_and_off(log, 0, 0.006), [])

    def test_a_feed_meter_that_hums_about_nothing_does_not_fill_the_history(self) -> None:
        """A cold column: heat off, the feed's noise is all that flows."""
        log, _ = play(1, (Event(0, "F", 0.0), Event(0, "Fm.noise", 0.5)), ("set mv2.min 0",), "", Line(60, "out Q 0"))
        qualities = [q for _, q, _ in rows(log, 300, HOUR)]
        self.assertLess(sum(a != b for a, b in zip(qualities, qualities[1:])), 3)

    def test_a_column_that_is_heated_again_is_good_after_a_while(self) -> None:
        log, said = play(4, (), ("set mv2.min 0",), "", Line(HOUR, "out Q 0"), Line(1.5 * HOUR, "out Q 4143.046"))
        self.assertEqual(said, {"no_boil"})
        self.assertEqual({q for _, q, _ in rows(log, 1.4 * HOUR, 1.5 * HOUR - 10)}, {BAD})
        self.assertEqual({q for _, q, _ in rows(log, 1.5 * HOUR + 400, 1.5 * HOUR + 900)}, {UNCERTAIN})
        self.assertEqual({q for _, q, _ in rows(log, 2.5 * HOUR, 4 * HOUR)}, {GOOD})


if __name__ == "__main__":
    unittest.main(verbosity=2)
