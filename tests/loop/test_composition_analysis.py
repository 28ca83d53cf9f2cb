#!/usr/bin/python3
"""An analyser beside the estimate of a composition (docs/methods/composition-estimation.md): a sample every 30 min, shown 20 min later; one that
lies, one that falls silent, one that is noisy."""

import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import runner  # noqa: E402
from research import estimates, trays  # noqa: E402
from research.estimates import Case  # noqa: E402
from reflux.logs import Log  # noqa: E402
from reflux.scenario import Event  # noqa: E402

HOUR, TICK_S, EVERY, DELAY = 3600.0, 20.0, 90, 60
GOOD, UNCERTAIN = "0", "1"


def play(*events: Event, analysed: bool = True, method: str = "geometric", noise: float = 0.0) -> tuple[Log, list]:
    case = Case("sE[C3,30]", method, hours=10.0, tick_s=TICK_S)
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        base = estimates.scenario(case, Path(folder))
        rows = [line.text for line in base.config][:-1]
        channel = 1 + max(int(r.split()[1].split(".")[0][4:]) for r in rows if r.startswith("set meas"))
        if analysed:
            rows = [r + ",iC4_D" if r.startswith("set block3.inputs") else r for r in rows]
            rows += ["set block3.is.6 analysis", "set block3.place.6 37,2"]
        spans = (("name", "iC4_D"), ("unit", "-"), ("lo", 0), ("hi", 1), ("every", EVERY), ("delay", DELAY))
        rows += [f"set meas{channel}.{key} {value}" for key, value in spans]
        instrument = (("every", EVERY), ("delay", DELAY), ("noise", noise))
        played = replace(
            base,
            measure=(*base.measure, "iC4_D"),
            config=trays.config_lines([*rows, "apply"]),
            events=(*base.events, *(Event(0.0, f"iC4_D.{name}", value) for name, value in instrument), *events),
        )
        log = runner.run(played, runner.Options(Path(folder) / "out", quiet=True)).log
        return log, runner.events_in(Path(folder) / "out" / "transcript.txt")


def errors(log: Log, first_h: float, last_h: float) -> list[float]:
    e = [a - b for a, b in zip(log.numbers("fw.est_iC4"), log.numbers("iC4_D.true"))]
    return [e[k] for k, t in enumerate(log.numbers("time")) if first_h * HOUR <= t <= last_h * HOUR]


def mean(values: list[float]) -> float:
    return sum(values) / len(values)


def said(told: list, code: str, first_h: float, last_h: float) -> bool:
    return any(first_h * HOUR <= t <= last_h * HOUR and text.startswith(f"block3.{code} ") for t, _, _, text in told)


class Analyses(unittest.TestCase):
    def test_three_samples_take_the_error_off_the_estimate(self) -> None:
        """Without them 0.0034 of 0.02 stay; the feed changes at 1 h, and three samples have come within 1 h 50 min."""
        without, _ = play(analysed=False)
        left = mean(errors(without, 9, 10))
        self.assertGreater(left, 0.003)
        for method in ("geometric", "rekf"):
            log, _ = play(method=method)
            self.assertLess(abs(mean(errors(log, 3, 4))), 0.2 * left)
            self.assertLess(abs(mean(errors(log, 9, 10))), 0.1 * left)
            self.assertEqual(log.text("fw.est_iC4.q")[-1], GOOD)

    def test_an_analyser_that_reads_a_tenth_too_much_is_not_believed_and_told(self) -> None:
        log, told = play(Event(5 * HOUR, "iC4_D.bias", 0.1))
        self.assertLess(max(abs(e) for e in errors(log, 5, 10)), 0.003)
        self.assertTrue(said(told, "no_input", 5, 7))
        self.assertEqual(log.text("fw.est_iC4.q")[-1], UNCERTAIN)

    def test_one_that_falls_silent_leaves_what_it_said_and_is_told(self) -> None:
        log, told = play(Event(5 * HOUR, "iC4_D.quality", 3))
        self.assertLess(max(abs(e) for e in errors(log, 5, 10)), 0.003)
        self.assertTrue(said(told, "no_input", 5, 7))
        self.assertEqual(log.text("fw.est_iC4.q")[-1], UNCERTAIN)

    def test_its_noise_comes_through_by_its_share_alone(self) -> None:
        """0.001; the variance of the corrections is g/(2 - g) of its, 0.54 at a share of 0.7."""
        log, _ = play(noise=0.001)
        e = errors(log, 4, 10)
        self.assertLess((mean([x * x for x in e])) ** 0.5, 0.002)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
