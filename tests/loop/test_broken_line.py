#!/usr/bin/python3
"""The plant goes away, comes back, and speaks rubbish; the firmware is safe meanwhile and says so."""

import random
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402


class BrokenLineTest(unittest.TestCase):
    def setUp(self) -> None:
        self.firmware = self.enterContext(board.start("host"))
        self.console = self.enterContext(board.console(self.firmware))
        board.configure(self.console)

    def plant(self) -> subprocess.Popen[bytes]:
        plant = subprocess.Popen(board.simulator(self.firmware, "--plant", "pilot", "--speed", "300", "--duration",
                                                 "1e6"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(plant.wait)
        self.addCleanup(plant.kill)
        return plant

    def run_loops(self) -> None:
        self.console.event("LINK_UP")
        self.console.samples()  # so that there is something to control
        self.console.do("out Qrb 0.8")
        self.console.do("mode bottom auto")
        self.console.event("MODE")

    def test_a_plant_that_falls_silent_puts_the_firmware_into_its_safe_state(self) -> None:
        plant = self.plant()
        self.run_loops()
        self.assertTrue(self.console.do("status")[0].startswith("state run"))
        plant.kill()
        self.console.event("LINK_DOWN")
        self.console.event("SAFE_STATE")
        self.assertTrue(self.console.do("status")[0].startswith("state safe, plant link down"))
        self.assertTrue(any("bottom manual" in line for line in self.console.do("loop")))
        self.assertRegex(self.console.ask("mode bottom auto")[-1], "^err STATE bottom: cannot act while no plant")

    def test_a_plant_that_comes_back_is_taken_up_again_with_safe_outputs(self) -> None:
        plant = self.plant()
        self.run_loops()
        plant.kill()
        self.console.event("LINK_DOWN")
        self.plant()
        self.console.event("LINK_UP")
        self.console.samples()
        status = "\n".join(self.console.do("status"))
        self.assertIn("state safe, plant link ready", status)
        self.assertIn("Qrb = 0 kW", status)
        self.console.do("mode bottom auto")
        self.console.event("MODE")

    def test_rubbish_on_the_link_is_counted_and_does_no_harm(self) -> None:
        seed = random.randrange(1 << 30)
        print(f"seed {seed}")
        wire = board.connect(self.firmware.link)
        generator = random.Random(seed)
        for _ in range(200):
            wire.sendall(generator.randbytes(1000))
        wire.close()
        self.plant()
        self.run_loops()
        counters = " ".join(self.console.do("stats"))
        malformed = int(counters.split("malformed ")[1].split()[0]) + int(counters.split("overlong ")[1].split()[0])
        self.assertGreater(malformed, 100)
        self.assertIn("refused 0", counters)

    def test_a_rebooted_board_starts_in_its_safe_state_with_its_plant(self) -> None:
        self.plant()
        self.run_loops()
        self.console.do("reboot")
        self.console.machine_mode()
        self.console.samples()  # LINK_UP may have come before, as a sentence
        self.assertTrue(self.console.do("status")[0].startswith("state safe"))
        self.assertIn("started by: requested", " ".join(self.console.do("version")))


if __name__ == "__main__":
    unittest.main()
