#!/usr/bin/python3
"""Automatic start-up of a plant whose inputs act nearly alike: relative gain 60, which no test of single inputs can tell from minus 60.
It is found by moving both inputs together; or, where that was left out, by following the board's advice to start up one loop first and
the other while that one is closed. The loops are judged on the plant itself (tools/research/startup_judge.py).

usage: test_commission_alike.py      (needs reflux-sim-memory of the host build; nothing is built here)
"""

import json
import re
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from commissioning import OUTCOMES, Plant, Run, configuration, whole  # noqa: E402

from research.startup_judge import PI, Judge  # noqa: E402
from research.startup_linear import Linear  # noqa: E402

MS_MOST, MARGIN_LEAST = 2.5, 1.5


def channel(name: str, **more: float) -> dict:
    return {"name": name, "unit": "%", "lo": 0, "hi": 100, "nominal": 50, **more}


def element(gain: float, lag: float) -> dict:
    return {"gain": gain, "lags": lag, "dead_time": 15}


DATA = {"name": "alike", "title": "alike", "source": "made up for tests/loop/test_commission_alike.py", "ours": "everything",
        "time_unit": "s", "tick_s": 10, "inputs": [channel("u1"), channel("u2")],
        "outputs": [channel(y, noise=0.1, resolution=0.01) for y in ("y1", "y2")], "model": "transfer",
        "elements": [[element(1.0, 150), element(0.9833, 155)], [element(1.0, 155), element(1.0, 150)]]}


class Alike(unittest.TestCase):
    def setUp(self) -> None:
        path = Path(self.enterContext(tempfile.TemporaryDirectory())) / "alike.json"
        path.write_text(json.dumps(DATA))
        self.plant = Plant(path)

    def judged(self, lines: list[str]) -> None:
        """The loops of the proposals, on the plant."""
        loops = []
        for line in lines:
            if m := re.match(r"loop (y\d) (u\d) gain (\S+) ti (\S+) td (\S+) (reverse|direct) ", line):
                gain = float(m[3]) * (1.0 if m[6] == "reverse" else -1.0)
                loops.append(PI(int(m[1][1]) - 1, int(m[2][1]) - 1, gain, float(m[4]), float(m[5])))
        self.assertEqual(len(loops), 2, lines)
        verdict = Judge(Linear(DATA)).judge(loops)
        print(f"alike: {loops}, {verdict}")
        self.assertTrue(verdict.stable and verdict.ms < MS_MOST and verdict.gain_margin > MARGIN_LEAST, verdict)

    def test_both_inputs_are_moved_together_and_the_loops_are_sound(self):
        run = Run(self.plant, whole(self.plant), noise=1.0, log=True)
        self.assertIsNotNone(run.first("TRIAL_KEPT"))
        stepped = run.all("TEST_STEP")[2].time_s
        moved = next((row["u1.cmd"] - 50, row["u2.cmd"] - 50) for row in run.rows if row["time"] > stepped + 10)
        self.assertGreater(min(map(abs, moved)), 1)
        self.assertLess(moved[0] * moved[1], 0)
        self.assertEqual([e.subject for e in run.all("TEST_STEP")], ["u1", "u2", "direction"])
        self.judged(run.reply("commission proposal"))
        shares = next(line for line in run.reply("commission model") if line.startswith("direction "))
        u1, u2 = map(float, re.match(r"direction u1 (\S+) u2 (\S+) ", shares).groups())
        self.assertEqual(max(abs(u1), abs(u2)), 1.0)
        self.assertLess(abs(u1 + u2), 0.1)
        for y, row in zip(("y1", "y2"), DATA["elements"]):
            along = next(line for line in run.reply("commission model") if line.startswith(f"along {y} "))
            gain, sd = map(float, re.match(r"along \S+ gain (\S+) sd (\S+) ", along).groups())
            self.assertLess(abs(gain - u1 * row[0]["gain"] - u2 * row[1]["gain"]), 3 * sd)

    def test_both_inputs_go_back_where_the_test_of_both_is_aborted(self):
        script = whole(self.plant, accept=False)
        at, until = script[-1][0], next(k for k, (_, line) in enumerate(script) if line.startswith("~until"))
        script = [*script[:until], (at, "~until TEST_EXTENDED"), (at, "commission"), (at, "~until TEST_STEP 100000"),
                  (at, "commission"), (at, "commission abort"), (at, "~until COMMISSION_ENDED 100"), (at, "commission begin"),
                  (at, "~until TEST_STEP 100000"), (at, "~end")]
        run = Run(self.plant, script, noise=1.0, log=True)
        self.assertEqual([e.subject for e in run.all("TEST_STEP")], ["u1", "u2", "direction", "u1"])
        self.assertTrue(any(line.startswith("input direction (3 of 3), round 1") for line in run.reply("commission")))
        ended, again = run.first("COMMISSION_ENDED").time_s, run.all("TEST_STEP")[3].time_s
        for row in run.rows:
            if ended + 10 < row["time"] < again:
                self.assertEqual((row["u1.cmd"], row["u2.cmd"]), (50, 50), row)

    def test_one_loop_after_the_other_as_advised_where_they_are_not_moved_together(self):
        script = whole(self.plant, accept=False)
        at, until = script[-1][0], next(k for k, (_, line) in enumerate(script) if line.startswith("~until"))
        script = [*script[:until], (at, "~until TEST_EXTENDED"), (at, "commission skip"), (at, f"~until {OUTCOMES}"),
                  (at, "commission advice"), (at, "~end")]
        run = Run(self.plant, script, noise=1.0)
        self.assertIsNotNone(run.first("NOT_DETERMINED"))
        advice = run.reply("commission advice")
        print(f"alike: {advice}")
        script, lines = [(0.0, line) for line in [*configuration(self.plant), "apply"]], []
        script += [(10.0, f"out {u['name']} {u['nominal']}") for u in self.plant.inputs]
        for line in advice:
            changes = re.findall(r"`(set [^`]+)`", line)
            self.assertTrue(changes, line)
            script += [(at, text) for text in ["begin", *changes, "apply", "commission begin", f"~until {OUTCOMES} 1000000",
                                               "commission proposal", "commission accept", "~until TRIAL_KEPT|TRIAL_FAILED 1000000"]]
        run = Run(self.plant, [*script, (at, "~end")], noise=1.0)
        self.assertEqual(len(run.all("TRIAL_KEPT")), 2)
        for line in run.said:
            if m := re.search(r" < (loop y\d u\d .*)", line):
                lines.append(m[1])
        self.judged(lines)


if __name__ == "__main__":
    unittest.main()
