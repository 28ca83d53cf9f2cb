#!/usr/bin/python3
"""Kotyk and Machacek's column under the polynomial decoupler and pole placement, the whole firmware over the link in float and in fixed
point, as the scenario kotyk-decoupled has it. The bounds are those of the source: 10 % overshoot (to half a per cent), no
interaction (to rounding), inputs within 5 V."""

import subprocess
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import build, runner, scenario  # noqa: E402
from reflux.logs import Log  # noqa: E402

STEP_V, ONE_S, TWO_S, CLIPPED_S, SECOND_S, FREE_S, BACK_S = 0.3, 4800, 12000, 18000, 24000, 31200, 36000
SPAN_V = {"y1": 4, "y2": 6, "u1": 10, "u2": 10}
ROUNDING = 1e-5  # of a span: what 24 bits leave after 60 samples


class Decoupled(unittest.TestCase):
    firmware = "memory"
    log: Log

    @classmethod
    def setUpClass(cls) -> None:
        played = scenario.load(ROOT / "host_sim" / "scenarios" / "kotyk-decoupled.toml")
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            cls.log = runner.run(replace(played, firmware=cls.firmware), runner.Options(Path(folder) / "out", quiet=True)).log

    def between(self, column: str, begin_s: float, end_s: float) -> list[float]:
        return [x for t, x in zip(self.log.numbers("time"), self.log.numbers(column)) if begin_s < t <= end_s]

    def overshoot(self, column: str, begin_s: float, end_s: float, from_v: float, to_v: float) -> float:
        way = to_v - from_v
        return max((x - to_v) / way for x in self.between(column, begin_s, end_s)) * 100

    def test_each_loop_overshoots_by_ten_per_cent(self) -> None:
        self.assertAlmostEqual(self.overshoot("y1.true", ONE_S, TWO_S, 0, STEP_V), 10, delta=0.5)
        self.assertAlmostEqual(self.overshoot("y2.true", TWO_S, CLIPPED_S, 0, STEP_V), 10, delta=0.5)

    def test_a_loop_keeps_its_setpoint_while_the_other_steps(self) -> None:
        for x in self.between("y2.true", ONE_S, TWO_S):
            self.assertAlmostEqual(x, 0, delta=ROUNDING * SPAN_V["y2"])
        for x in self.between("y1.true", TWO_S + 3600, CLIPPED_S):
            self.assertAlmostEqual(x, STEP_V, delta=0.01 * STEP_V)  # the last of its own step dies away

    def test_inputs_stay_within_five_volts(self) -> None:
        for u in ("u1", "u2"):
            self.assertLess(max(abs(x) for x in self.between(f"{u}.applied", ONE_S, CLIPPED_S)), 5)

    def test_with_its_input_held_back_one_loop_gives_way_and_the_other_comes_to_its_setpoint(self) -> None:
        self.assertLess(self.between("y1.true", SECOND_S, FREE_S)[-1], 0.9 * STEP_V)
        self.assertAlmostEqual(self.between("y2.true", CLIPPED_S, SECOND_S)[-1], 0.3, delta=0.01 * STEP_V)
        self.assertAlmostEqual(self.between("y2.true", SECOND_S, FREE_S)[-1], 0.1, delta=0.01 * STEP_V)

    def test_with_its_input_free_again_it_comes_to_its_setpoint_without_what_had_wound_up(self) -> None:
        start = self.between("y1.true", SECOND_S, FREE_S)[-1]
        self.assertAlmostEqual(self.between("y1.true", FREE_S, BACK_S)[-1], STEP_V, delta=0.01 * STEP_V)
        self.assertLess(self.overshoot("y1.true", FREE_S, BACK_S, start, STEP_V), 15)


class DecoupledInFixedPoint(Decoupled):
    firmware = "host-fixed"

    @classmethod
    def setUpClass(cls) -> None:
        build.build("host-fixed", ("reflux-host",), quiet=True)
        super().setUpClass()


class Designed(unittest.TestCase):
    def test_the_blocks_of_the_scenario_are_what_the_tool_prints(self) -> None:
        told = (ROOT / "host_sim" / "scenarios" / "kotyk-decoupled.conf").read_text(encoding="utf-8").splitlines()
        printed = subprocess.run([str(ROOT / "tools" / "decouple"), "kotyk-column", "--loops", "pp", "--settling", "3600", "--loop-names", "one,two",
                                  "--no-build"], capture_output=True, text=True, check=True).stdout.splitlines()
        self.assertEqual([line for line in told if line.startswith("set block")], [line for line in printed if line.startswith("set block")])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
