#!/usr/bin/python3
"""The ratio to the feed (docs/methods/ratio.md) over the link: feed steps, a feed that is not measured for a while, manual and back, another loop
taking over the reflux, in both builds. Every 30 s; F steps at 1 h from 88.2 to 97.02 m3/h, a tenth."""

import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import runner  # noqa: E402
from research import trays  # noqa: E402
from reflux.logs import Log  # noqa: E402
from reflux.scenario import Event, Line  # noqa: E402
from research.trays import Case  # noqa: E402

HOUR, R, TICK = 3600.0, 32.2787, 30.0
CASE = Case("sC[Q,33]_{R/F}", "conventional", state="SS2", scenario="SC1")
SPAN = 120.0  # of R, m3/h


def play(
    *events: Event, lines: tuple[Line, ...] = (), config: tuple[str, ...] = (), firmware: str = "memory"
) -> tuple[Log, list]:
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        base = trays.scenario(CASE, Path(folder))
        more = tuple(Line(0.0, text) for text in config)
        played = replace(
            base,
            duration_s=3 * HOUR,
            firmware=firmware,
            events=(Event(HOUR, "F", 97.02), *events),
            lines=(*base.lines, *lines),
            config=(*base.config[:-1], *more, base.config[-1]),
        )
        log = runner.run(played, runner.Options(Path(folder) / "out", quiet=True)).log
        return log, runner.events_in(Path(folder) / "out" / "transcript.txt")


def reflux(log: Log, first_s: float, last_s: float) -> list[float]:
    return [u for t, u in zip(log.numbers("time"), log.numbers("R.cmd")) if first_s <= t <= last_s]


def largest_move(log: Log, first_s: float, last_s: float) -> float:
    u = reflux(log, first_s, last_s)
    return max(abs(b - a) for a, b in zip(u, u[1:]))


class Ratio(unittest.TestCase):
    def test_the_reflux_follows_the_feed_in_the_next_tick_in_both_builds(self) -> None:
        for firmware in ("memory", "host-fixed"):
            with self.subTest(firmware):
                log, _ = play(firmware=firmware)
                self.assertLess(largest_move(log, 600, HOUR - TICK), 1e-4 * SPAN)
                for u in reflux(log, HOUR + 2 * TICK, 3 * HOUR):
                    self.assertAlmostEqual(u, 1.1 * R, delta=1e-4 * SPAN)

    def test_a_lag_is_a_lag(self) -> None:
        log, _ = play(config=("set block2.lag 600",))
        after = reflux(log, HOUR + 600 - TICK, HOUR + 600 + TICK)
        self.assertTrue(any(abs(u - (1 + 0.1 * (1 - 0.3679)) * R) < 0.02 * R for u in after), after)
        self.assertLess(max(reflux(log, HOUR, 3 * HOUR)), 1.1 * R + 1e-3)

    def test_without_a_feed_the_ratio_stays_and_then_the_loops_go_on_alone_without_a_bump(self) -> None:
        """Missing for half an hour, in which the feed falls again to what it was; then it is taken up where the reflux stands."""
        log, told = play(
            Event(1.5 * HOUR, "Fm.quality", 3.0), Event(1.6 * HOUR, "F", 88.2), Event(2 * HOUR, "Fm.quality", 0.0)
        )
        self.assertLess(largest_move(log, HOUR + 2 * TICK, 2.9 * HOUR), 1e-4 * SPAN)
        self.assertTrue(any(c == "BLOCK_GAVE_UP" and "no_feed" in w for _, _, c, w in told))

    def test_a_feed_that_is_missing_for_a_minute_changes_nothing(self) -> None:
        log, told = play(Event(1.5 * HOUR, "Fm.quality", 3.0), Event(1.5 * HOUR + 60, "Fm.quality", 0.0))
        self.assertLess(largest_move(log, HOUR + 2 * TICK, 2.9 * HOUR), 1e-4 * SPAN)
        self.assertEqual([w for _, _, c, w in told if c == "BLOCK_GAVE_UP"], [])

    def test_a_feed_that_reads_nonsense_moves_the_reflux_to_its_limits_only(self) -> None:
        for value, ratio in ((0.0, 0.2), (150.0, 150 / 88.2)):
            with self.subTest(value):
                log, _ = play(Event(1.5 * HOUR, "Fm.stuck", value))
                self.assertAlmostEqual(reflux(log, 2 * HOUR, 3 * HOUR)[-1], max(10.0, ratio * R), delta=0.02)

    def test_manual_and_back_is_without_a_bump_and_manual_keeps_the_reflux(self) -> None:
        log, _ = play(
            Event(1.5 * HOUR, "F", 80.0),
            lines=(Line(1.2 * HOUR, "mode top manual"), Line(2 * HOUR, "mode top auto")),
        )
        self.assertLess(largest_move(log, HOUR + 2 * TICK, 3 * HOUR), 1e-4 * SPAN)
        self.assertAlmostEqual(reflux(log, 2.5 * HOUR, 3 * HOUR)[0], 1.1 * R, delta=0.02)

    def test_the_block_switched_off_and_on_again_is_without_a_bump(self) -> None:
        log, _ = play(
            Event(1.5 * HOUR, "F", 80.0),
            lines=(Line(1.2 * HOUR, "block 2 off"), Line(2 * HOUR, "block 2 on")),
        )
        self.assertLess(largest_move(log, HOUR + 2 * TICK, 3 * HOUR), 1e-4 * SPAN)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
