#!/usr/bin/python3
"""reflux-sim --wiring: what it cannot do it says, with the file; nothing is commanded until somebody does."""

import csv
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402

from reflux import build  # noqa: E402

SETTINGS = ("begin", "set io.source board", "set tick.base 1", "set chan1.name T1", "set chan1.unit degC", "set chan1.device max31865", "set chan1.bus spi1",
            "set chan1.select PA4", "set out1.name Qrb", "set out1.unit kW", "set out1.kind window", "set out1.pin PB1", "set out1.hi 1.5",
            "set meas1.name T1", "set meas1.unit degC", "set meas1.hi 200", "set mv1.name Qrb", "set mv1.unit kW", "set mv1.hi 1.5")
SENSOR, LOAD = "T1 max31865 spi1 PA4\n", "Qrb ssr PB1 hi=1.5\n"


class WiringOptionTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))
        self.wiring = self.folder / "pins.wiring"

    def run_with(self, wiring: str, *options: str) -> subprocess.CompletedProcess[str]:
        self.wiring.write_text(wiring, encoding="utf-8")
        return subprocess.run([str(build.find_program("host", "reflux-sim-memory")), "--plant", "pilot", "--port", "memory", "--duration", "5",
                               "--wiring", str(self.wiring), *options], capture_output=True, text=True, timeout=board.PATIENCE_S, check=False)

    def refused(self, wiring: str, words: str) -> None:
        done = self.run_with(wiring)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(str(self.wiring), done.stderr)
        self.assertIn(words, done.stderr)

    def test_a_wiring_without_a_measurement_of_the_plant_is_refused(self) -> None:
        self.refused("A max31865 spi1 PA4\n" + LOAD, "no line has the name of a measurement of the plant")

    def test_a_wiring_without_an_input_of_the_plant_is_refused(self) -> None:
        self.refused(SENSOR + "Q ssr PB1\n", "no line has the name of a manipulated variable of the plant")

    def test_a_line_that_is_wrong_is_told_with_its_number(self) -> None:
        self.refused(SENSOR + "Qrb toaster PB1\n", "line 2: ")

    def test_a_rest_on_the_link_needs_a_wiring_that_leaves_some(self) -> None:
        others = (("T2", "PC0"), ("T7", "PC1"), ("T9", "PC2"), ("T10", "PB12"))
        everything = SENSOR + LOAD + "Lr ssr PB0 hi=12\n" + "".join(f"{name} max31865 spi1 {pin}\n" for name, pin in others)
        self.assertIn("every channel of the plant is wired", self.run_with(everything, "--rest-on-link").stderr)
        self.assertEqual(self.run_with(SENSOR + LOAD, "--rest-on-link").returncode, 0)
        alone = subprocess.run([str(build.find_program("host", "reflux-sim-memory")), "--plant", "pilot", "--port", "memory", "--rest-on-link"],
                               capture_output=True, text=True, timeout=board.PATIENCE_S, check=False)
        self.assertNotEqual(alone.returncode, 0)
        self.assertIn("--rest-on-link needs --wiring FILE", alone.stderr)

    def test_a_board_without_settings_leaves_the_loads_off(self) -> None:
        log = self.folder / "log.csv"
        done = self.run_with(SENSOR + LOAD, "--log", str(log))
        self.assertEqual(done.returncode, 0, done.stderr)
        with log.open(encoding="utf-8") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        self.assertGreater(len(rows), 0)
        self.assertEqual({float(row["Qrb.cmd[kW]"]) for row in rows}, {0.0})

    def run_by(self, script: list[str], *options: str) -> list[str]:
        """Telemetry of a board that has these lines at time 0."""
        lines, rows = self.folder / "script.txt", self.folder / "telemetry.csv"
        lines.write_text("".join(f"0 {line}\n" for line in script), encoding="utf-8")
        done = self.run_with(SENSOR + LOAD, "--console", "memory", "--script", str(lines), "--telemetry", str(rows), *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return rows.read_text(encoding="utf-8").splitlines()

    def test_lines_behind_apply_find_the_plant_before_its_time_begins(self) -> None:
        header, *rows = self.run_by([*SETTINGS, "apply", "log on", "out Qrb 0.9"], "--tick", "1")
        self.assertEqual(len(rows), 6)  # none from before plant time
        place = header.replace("[kW]", "").split(",").index("Qrb.cmd")
        self.assertEqual({row.split(",")[place] for row in rows}, {"0.899999976"})

    def test_plant_time_begins_with_a_sample_whatever_the_tick(self) -> None:
        for tick_s, begins_s in ((1, 60), (7, 70), (20, 80), (60, 180)):
            with self.subTest(tick_s):
                settings = [line.replace("tick.base 1", f"tick.base {tick_s}") for line in SETTINGS]
                header, *rows = self.run_by([*settings, "apply", "log on"], "--tick", str(tick_s), "--duration", str(3 * tick_s))
                place = header.replace("[s]", "").split(",").index("time")
                self.assertEqual([float(row.split(",")[place]) for row in rows], [begins_s + k * tick_s for k in range(4)])


if __name__ == "__main__":
    unittest.main()
