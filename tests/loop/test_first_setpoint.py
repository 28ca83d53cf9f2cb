#!/usr/bin/python3
"""The first steps of docs/start/hardware.md, `pilot.conf`, `mode bottom auto` and `sp bottom 112.5`, raise neither alarm nor warning."""

import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import runner, scenario  # noqa: E402

PILOT = ROOT / "host_sim" / "scenarios" / "smoke.toml"  # the pilot column with pilot.conf
STEPS = ("mode bottom auto", "sp bottom 112.5")


class FirstSetpointTest(unittest.TestCase):
    def test_it_is_reached_without_an_alarm(self) -> None:
        page = (ROOT / "docs" / "start" / "hardware.md").read_text(encoding="utf-8")
        for step in STEPS:
            self.assertIn(f"`{step}`", page)
        loaded = scenario.load(PILOT)
        lines = tuple(scenario.Line(120.0 + 60.0 * k, step) for k, step in enumerate(STEPS))
        wanted = replace(loaded, firmware="memory", duration_s=7200.0, lines=lines, events=(), limits=())
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            result = runner.run(wanted, runner.Options(Path(folder), quiet=True))
            events = runner.events_in(result.out / "transcript.txt")
        self.assertIn("SETPOINT", [code for _, _, code, _ in events])
        self.assertEqual([event for event in events if event[1] in ("warning", "alarm")], [])
        for value in result.log.numbers("T10.true")[-20:]:
            self.assertAlmostEqual(value, 112.5, delta=0.3)


if __name__ == "__main__":
    unittest.main()
