#!/usr/bin/python3
"""The STM32F100 whose plant is at its own pins. The flashed image on the virtual board gives the log of the host in fixed point, bit for bit. What it
lacks it refuses with a reason, and sets that the image with the plant link has stored stay readable, both ways."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from pilot_at_pins import simulate, telemetry, virtual_board  # noqa: E402
from virtual_board import VirtualBoard  # noqa: E402

IMAGE, TWIN = "stm32f100-pins", "host-fixed"
BOARD = board.ROOT / "build" / "host" / "reflux-board"
SETTINGS = board.ROOT / "host_sim" / "scenarios" / "pilot-pins-small.conf"
WIRING = board.ROOT / "host_sim" / "scenarios" / "pilot-pins-small.wiring"
DURATION_S = 60
# Plant time, s, and console line: manual outputs, the heater's loop to automatic, a setpoint, settings that come into force meanwhile, the other loop.
LATER = ((3, "out Lr 4.5"), (3, "out Qrb 0.8"), (8, "status"), (10, "mode bottom auto"), (20, "sp bottom 104"), (30, "begin"),
         (30, "set loop1.gain 4"), (30, "apply"), (40, "mode top auto"), (50, "mode bottom manual"), (51, "out Qrb 1.2"))
# No heater warms so much in 3 s, so one that is on is said to be dead.
PROOF = ("set out1.proof warms", "set out1.proof_at chan1", "set out1.proof_change 20", "set out1.proof_on 3", "set out1.proof_below 200")


@unittest.skipUnless(BOARD.exists(), "no reflux-board: libunicorn-dev is not installed")
class SmallBoardPinsTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))
        settings = [line for line in SETTINGS.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
        self.settings = [*settings[:-1], *PROOF, settings[-1]]

    def simulate(self, name: str, program: str = "reflux-sim-memory", where: str = "memory") -> Path:
        """The folder with log, telemetry and transcript of a run of the plant."""
        out = self.folder / name
        print(f"{name}: {simulate(out, DURATION_S, self.settings, LATER, program=program, where=where, wiring=WIRING, preset=TWIN)}")
        return out

    def test_the_image_gives_the_log_of_the_host(self) -> None:
        host = self.simulate("host")
        with virtual_board(self.folder, IMAGE, WIRING) as (where, said):
            image = self.simulate("board", "reflux-sim", where)
        print(said[0].strip())
        self.assertEqual((host / "simulator.csv").read_bytes(), (image / "simulator.csv").read_bytes())
        self.assertEqual(telemetry(host), telemetry(image))
        for kind in ("software", "watchdog"):
            self.assertIn(f"{kind} 0", said[0])
        status = next(line for line in (image / "transcript.txt").read_text(encoding="utf-8").splitlines() if ", plant at " in line)
        self.assertRegex(status, r"plant at the board's pins, plant time \d+\.000 s")
        for out in (host, image):
            self.assertRegex((out / "transcript.txt").read_text(encoding="utf-8"), r"OUTPUT_CONTRADICTED.*nothing warms")

    def test_the_run_is_a_column_that_is_controlled(self) -> None:
        """Else two logs might be alike because nothing happens."""
        rows = telemetry(self.simulate("host"))
        self.assertGreaterEqual(len(rows), DURATION_S)
        self.assertEqual({row["T10.q"] for row in rows}, {"0"})
        last = rows[-1]
        self.assertEqual((last["top.mode"], last["bottom.mode"], float(last["bottom.sp"])), ("1", "0", float(last["T10"])))
        self.assertAlmostEqual(float(last["Qrb.cmd"]), 1.2, places=6)
        self.assertNotEqual(float(last["Lr.cmd"]), 4.5)
        self.assertAlmostEqual(float(last["T10"]), 105.0, delta=3.0)
        self.assertAlmostEqual(float(last["T1"]), 87.0, delta=3.0)


@unittest.skipUnless(BOARD.exists(), "no reflux-board: libunicorn-dev is not installed")
class SmallBoardPinsConsoleTest(unittest.TestCase):
    LINKED = "stm32f100"  # the image with the plant link

    def setUp(self) -> None:
        self.nvm = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-"))) / "nvm"

    def start(self, image: str) -> VirtualBoard:
        firmware = self.enterContext(VirtualBoard(image, "--nvm", str(self.nvm)))
        firmware.boot()
        firmware.erase()  # a stored set is read by then as well
        return firmware

    def save(self, image: str, *lines: str) -> None:
        """A flash that this image has saved settings in."""
        firmware = self.start(image)
        for line in (*lines, "save"):
            firmware.do(line)
        firmware.close()

    def refused(self, firmware: VirtualBoard, line: str) -> str:
        return firmware.ask(line).splitlines()[-1]

    def test_a_device_that_the_board_lacks_is_refused_with_those_it_has(self) -> None:
        firmware = self.start(IMAGE)
        for device in ("max31856", "ads1115", "bme280", "bme280_temperature", "xgzp6897", "analog", "flow", "pulses"):
            self.assertEqual(self.refused(firmware, f"set chan1.device {device}"),
                             "err UNSUPPORTED chan1.device: this board has max31865, ds18b20 and level only")
        for device in ("max31865", "ds18b20", "level"):
            firmware.do(f"set chan1.device {device}")

    def test_an_output_that_the_board_lacks_is_refused_with_those_it_has(self) -> None:
        firmware = self.start(IMAGE)
        for kind in ("burst", "pwm", "analog", "stepper", "motor_valve", "ad5422"):
            self.assertEqual(self.refused(firmware, f"set out2.kind {kind}"),
                             "err UNSUPPORTED out2.kind: this board has window, relay and enable only")
        for kind in ("window", "relay", "enable"):
            firmware.do(f"set out2.kind {kind}")

    def test_the_plant_link_is_refused_because_the_board_has_none(self) -> None:
        firmware = self.start(IMAGE)
        self.assertIn("no plant: this board has no plant link, `set io.source board`", firmware.do("status"))
        self.assertEqual(self.refused(firmware, "set io.source both"),
                         "err UNSUPPORTED io.source: this board has no plant link: `board`, or `link` for no plant")
        firmware.do("set io.source board")
        self.assertIn("plant at the board's pins", firmware.do("status"))

    def test_more_channels_than_the_board_has_are_refused_with_the_bytes_they_need(self) -> None:
        firmware = self.start(IMAGE)
        for name in ("chan3.lo", "out3.lo", "meas3.lo", "loop3.gain", "lock2.limit"):
            self.assertRegex(self.refused(firmware, f"set {name} 1"), rf"^err UNSUPPORTED {name}: this board has \d, bytes needed for each more: \d+$")

    def test_a_set_that_the_image_with_the_link_has_stored_is_read_and_carried_over(self) -> None:
        self.save(self.LINKED, "set meas1.name T1", "set meas1.lo 70", "set meas4.name T4", "set meas4.lo 40")
        firmware = self.start(IMAGE)
        self.assertIn("storage: ok", firmware.do("version"))
        self.assertIn("meas1.lo = 70", firmware.do("get meas1.lo"))
        firmware.do("set meas1.lo 71")
        firmware.do("save")
        firmware.close()
        again = self.start(self.LINKED)
        self.assertIn("meas1.lo = 71", again.do("get meas1.lo"))
        self.assertIn("meas4.lo = 40", again.do("get meas4.lo"))

    def test_the_image_with_the_link_carries_settings_of_pins_over(self) -> None:
        self.save(IMAGE, "set chan2.hi 90", "set out1.period 7", "set meas1.lo 70")
        firmware = self.start(self.LINKED)
        self.assertIn("meas1.lo = 70", firmware.do("get meas1.lo"))
        firmware.do("set meas1.lo 71")
        firmware.do("save")
        firmware.close()
        again = self.start(IMAGE)
        self.assertIn("meas1.lo = 71", again.do("get meas1.lo"))
        self.assertIn("chan2.hi = 90", again.do("get chan2.hi"))
        self.assertIn("out1.period = 7", again.do("get out1.period"))


if __name__ == "__main__":
    unittest.main()
