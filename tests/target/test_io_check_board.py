#!/usr/bin/python3
"""tools/io against the flashed image on the virtual board: chips at its pins, sensors that are warmed, faults, outputs and what the plant gets."""

import re
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from io_dialogue import Dialogue  # noqa: E402

BOARD = board.ROOT / "build" / "host" / "reflux-board"
SCENARIOS = board.ROOT / "host_sim" / "scenarios"


@unittest.skipUnless(BOARD.exists(), "no reflux-board: libunicorn-dev is not installed")
class VirtualBoardTest(unittest.TestCase):
    def setUp(self) -> None:
        self.log = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-"))) / "lines.txt"

    def dialogue(self, *options: str) -> Dialogue:
        return self.enterContext(Dialogue("--board", str(SCENARIOS / "pilot-pins.wiring"), "--settings", str(SCENARIOS / "pilot-pins.conf"),
                                          "--no-build", "--log", str(self.log), *options))

    def test_the_pilot_column_is_checked_from_the_list_to_the_calibration(self) -> None:
        d = self.dialogue()
        d.answer("T1, T10: the reading is outside what the board believes", "y")
        d.answer("T1: warm it", "pins.T1 28")
        d.until("ok: T1 moved by +8")
        d.answer("T10: warm it", "pins.T1 20")  # the hand is at the wrong thermometer
        d.until("NOT OK: T1 moved, T10 did not: exchange their wires")
        d.answer("Lr: window on PB0", "6")
        d.answer("Did Lr move", "y")
        d.until("ok: Lr moved at 6 l/h, and is back at 4.5")
        d.answer("Qrb: window on PB1", "y")
        d.answer("Did Qrb move", "y")
        d.until("ok: Qrb moved at 0.4 kW, and is back at 0")
        d.answer("Calibrate", "T10")
        d.type("pins.T10 0.5")
        d.answer("first true value", "0")
        d.until("it reads 0.")
        d.type("pins.T10 98")
        d.answer("second true value", "100")
        settings = d.until("take these settings?")
        gain = float(re.search(r"meas2.gain ([\d.]+)", settings)[1])
        self.assertAlmostEqual(gain, 100 / 97.5, delta=0.002)
        d.type("y")
        d.until("ok: T10 is calibrated and now reads")
        d.answer("Calibrate", "")
        d.answer("Save the settings", "n")
        status, _ = d.end()
        self.assertEqual(status, 1)  # because of T10
        sent = [line[2:] for line in self.log.read_text(encoding="utf-8").splitlines() if line.startswith("> ")]
        last = {line.split()[1]: line.split()[2] for line in sent if line.startswith("set meas")}
        self.assertEqual({name: float(value) for name, value in last.items() if "valid" in name},
                         {f"meas{k}.valid_{end}": 0.0 for k in (1, 2) for end in ("lo", "hi")})

    def test_a_broken_wire_is_named_with_what_to_look_at(self) -> None:
        d = self.dialogue()
        d.type("pins.T1.open 1")
        d.answer("the reading is outside what the board believes", "y")
        d.until("NOT OK: T1 ")
        self.assertIn("sensor or wire open; look at the sensor's wires and terminals", d.until("terminals"))
        d.interrupt()
        self.assertEqual(d.end()[0], 130)

    def test_a_sensor_that_is_not_wired_ends_the_virtual_board_with_its_reason(self) -> None:
        d = self.dialogue()
        d.answer("the reading is outside what the board believes", "pins.T9 30")
        status, said = d.end()
        self.assertEqual(status, 1)
        self.assertIn("the virtual board has ended", said)
        self.assertIn("T9", said)

    def test_ctrl_c_while_an_output_is_away_brings_it_back(self) -> None:
        d = self.dialogue()
        d.answer("the reading is outside what the board believes", "y")
        for sensor in ("T1", "T10"):
            d.answer(f"{sensor}: warm it", "")
        d.answer("Lr: window on PB0", "")
        d.answer("Qrb: window on PB1", "1")
        d.until("Did Qrb move")
        d.interrupt()
        status, said = d.end()
        self.assertEqual(status, 130)
        self.assertIn("outputs that were moved are at their safe values", said)
        lines = self.log.read_text(encoding="utf-8").splitlines()
        sent = [line[2:] for line in lines if line.startswith("> out ")]
        self.assertEqual(sent, ["out Qrb 1", "out Qrb 0"])
        header = next(line[2:].split(",") for line in lines if line.startswith("< H,"))
        rows = [line[2:].split(",") for line in lines if line.startswith("< T,")]
        applied = [float(row[header.index("Qrb.app[kW]")]) for row in rows]
        self.assertEqual((max(applied), applied[-1]), (1.0, 0.0))


if __name__ == "__main__":
    unittest.main()
