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


if __name__ == "__main__":
    unittest.main()
