#!/usr/bin/python3
"""docs/methods/inferential.md, Set it up: its console lines, typed at a board that knows nothing, end in CLF control of both ends of the
splitter, and nothing jumps on the way."""

import re
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import runner, scenario  # noqa: E402
from research import trays  # noqa: E402
from reflux.scenario import Line  # noqa: E402

PAGE = ROOT / "docs" / "methods" / "inferential.md"
SCENARIO = ROOT / "host_sim" / "scenarios" / "splitter-two-ends.toml"
BEGIN_S, BETWEEN_S = 300.0, 600.0


def blocks() -> list[list[str]]:
    """Console lines of the section, a list for each fenced part."""
    section = PAGE.read_text(encoding="utf-8").split("## Set it up")[1].split("\n## ")[0]
    return [part.strip().splitlines() for part in re.findall(r"^```\n(.*?)^```$", section, re.MULTILINE | re.DOTALL)]


def settings(lines: list[str]) -> list[str]:
    return [line for line in lines if line.startswith("set block")]


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        base = scenario.load(SCENARIO)
        configuration, run = blocks()
        rest = [line for line in base.config if not line.text.startswith("set block") and line.text != "apply"]
        # Without noise a thermometer at rest repeats itself.
        rest = [line for line in rest if ".frozen " not in line.text]
        # Modes and setpoints together at first, then one law after the other.
        times = [BEGIN_S if line.split()[0] in ("mode", "sp") else 0.0 for line in run]
        for k in range(len(times)):
            times[k] = times[k] or max(times[:k]) + BETWEEN_S
        lines = [line for line in base.lines if line.text.startswith("out ")] + [
            Line(t, text) for t, text in zip(times, run)
        ]
        cls.shown = max(times)
        cls.changes = [t for t, text in zip(times, run) if text.startswith("set ")]
        played = replace(
            base,
            firmware="memory",
            noise=0.0,
            lines=tuple(lines),
            limits=(),
            events=tuple(replace(e, at_s=cls.shown + BETWEEN_S) for e in base.events),
            duration_s=cls.shown + BETWEEN_S + 6 * trays.HOUR,
            config=tuple([*rest, *(Line(0.0, text) for text in configuration)]),
        )
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            cls.result = runner.run(played, runner.Options(Path(folder) / "out", quiet=True))
            cls.transcript = (Path(folder) / "out" / "transcript.txt").read_text(encoding="utf-8")

    def test_the_page_and_the_file_have_the_same_lines(self) -> None:
        base = scenario.load(SCENARIO)
        self.assertEqual(settings([line.text for line in base.config]), settings(blocks()[0]))
        self.assertEqual({line.text for line in base.lines if not line.text.startswith("out ")}, set(blocks()[1]))

    def test_both_loops_are_clf_in_the_end_and_no_alarm_came(self) -> None:
        for law in ("law_1 = 3", "law_2 = 3"):
            self.assertTrue(law in self.transcript, law)
        self.assertEqual(re.findall(r"BLOCK_GAVE_UP|BLOCK_ALARM", self.transcript), [])

    def test_no_output_jumps_when_a_law_changes_or_a_loop_closes(self) -> None:
        """At rest and without noise: a thousandth of the span, four times what the resolution of the thermometers (0.01 K) can do."""
        log = self.result.log
        t = log.numbers("time")
        for mv, (_, lo, hi, _, _) in trays.MVS.items():
            u = log.numbers(f"{mv}.cmd")
            moves = [abs(u[k] - u[k - 1]) for k in range(1, len(t)) if 60 < t[k] < self.shown]
            self.assertLess(max(moves), 1e-3 * (hi - lo), mv)

    def test_both_impurities_are_held_in_the_mean(self) -> None:
        log = self.result.log
        t = log.numbers("time")
        for name in ("iC4_D", "C3_B"):
            y = log.numbers(name)
            last = [y[k] for k in range(len(t)) if t[k] > t[-1] - trays.HOUR]
            self.assertLess(abs(sum(last) / len(last) - trays.GOAL), trays.BAND, name)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
