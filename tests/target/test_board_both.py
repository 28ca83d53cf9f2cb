#!/usr/bin/python3
"""The pilot column with a part of it at the board's own pins and a part at the link: the flashed image gives the log of the host, bit for bit."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from pilot_at_pins import BY_LINK, REST_ON_LINK, settings, simulate, telemetry, virtual_board  # noqa: E402

IMAGE = "stm32f405"
BOARD = board.ROOT / "build" / "host" / "reflux-board"
DURATION_S = 60
# Plant time, s, and console line: manual outputs, both loops to automatic, a setpoint, and settings that come into force meanwhile.
LATER = ((3, "out Lr 4.5"), (3, "out Qrb 0.8"), (8, "status"), (10, "mode top auto"), (10, "mode bottom auto"), (25, "sp top 87.5"),
         (35, "begin"), (35, "set loop1.gain 10"), (35, "apply"), (45, "mode bottom manual"), (46, "out Qrb 0.7"))
UNPLUGGED = (*REST_ON_LINK, "--event", "20:board.unplug_link=15")


@unittest.skipUnless(BOARD.exists(), "no reflux-board: libunicorn-dev is not installed")
class SameLogTest(unittest.TestCase):
    def test_the_image_gives_the_log_of_the_host_with_a_part_of_the_plant_at_the_link(self) -> None:
        folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))
        host, image = folder / "host", folder / "board"
        print(simulate(host, DURATION_S, settings(), LATER, *UNPLUGGED))
        with virtual_board(folder, IMAGE) as (where, said):
            print(simulate(image, DURATION_S, settings(), LATER, *UNPLUGGED, program="reflux-sim", where=where))
        self.assertEqual((host / "simulator.csv").read_bytes(), (image / "simulator.csv").read_bytes())
        self.assertEqual(telemetry(host), telemetry(image))
        for kind in ("software", "watchdog"):
            self.assertIn(f"{kind} 0", said[0])
        rows = telemetry(image)[-DURATION_S - 1:]
        for name in BY_LINK:
            good = [row[f"{name}.q"] == "0" for row in rows]
            self.assertEqual((good[15], good[30], good[45]), (True, False, True))
        self.assertEqual({row["T1.q"] for row in rows}, {"0"})


if __name__ == "__main__":
    unittest.main()
