#!/usr/bin/python3
"""Plants at the board's own pins: the flashed image on the virtual board gives the log of the host, bit for bit.

usage: test_board_pins.py [all]      (all: ten minutes of each scenario in place of one)
"""

import sys
import tempfile
import unittest
from dataclasses import dataclass, replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from sample import EVERY  # noqa: E402

from reflux import build, compare, logs, runner, scenario  # noqa: E402

IMAGE = "stm32f405"
DURATION_S = 600 if EVERY else 60


@dataclass(frozen=True)
class Case:
    """later: plant time, s, and console line, beside those of the scenario. near: measurements and what the plant has of them about then, in the
    unit of the board, with the largest difference. last: columns at the end, and their values. outputs: lines of the wiring in place of those with
    their names."""

    name: str
    later: tuple[tuple[float, str], ...]
    near: dict[str, tuple[float, float]]
    last: dict[str, float]
    scenario: str = ""
    outputs: tuple[str, ...] = ()


# Outputs by hand, loops to automatic, setpoints, and settings that come into force meanwhile.
STEPS = tuple((20.0 + k, f"out u{3 + k % 2} {37 * k % 90 + 5}") for k in range(30))  # a tick has some milliseconds of the voltage before each
CASES = (
    Case("pilot-pins",
         ((8, "status"), (10, "mode top auto"), (10, "mode bottom auto"), (25, "sp top 87.5"), (35, "begin"), (35, "set loop1.gain 10"),
          (35, "apply"), (45, "mode bottom manual"), (46, "out Qrb 0.7")),
         {"T1": (87.0, 5.0), "T10": (107.0, 5.0)}, {"top.mode": 1, "bottom.mode": 0, "top.sp": 87.5, "Qrb.cmd": 0.7}),
    # The reflux valve to its contact, and back.
    Case("methanol-pins",
         ((4, "out R 0"), (10, "mode bottom auto"), (20, "sp bottom 98"), (30, "status"), (40, "out R 8")),
         {"T4": (99.0, 2.0), "T12": (80.0, 5.0)}, {"bottom.mode": 1, "bottom.sp": 98, "R.cmd": 8}),
    Case("furnace-pins",
         ((5, "mode burner1 auto"), (5, "mode burner2 auto"), (15, "sp burner1 60"), *STEPS, (50, "mode burner2 manual"), (55, "out u4 60")),
         {"y1": (52.0, 10.0), "y2": (50.0, 10.0), "y3": (50.0, 10.0), "y4": (50.0, 10.0)},
         {"burner1.mode": 1, "burner1.sp": 60, "burner2.mode": 0, "u4.cmd": 60}),
    # The reflux by a pump, the heater by a chip on the bus of the first thermometer.
    Case("chip and stepper",
         (*((0, line) for line in ("begin", *(f"set out1.{row}" for row in ("kind stepper", "pin2 PC2", "flow 12", "steps 120", "ramp 2000")),
                                   *(f"set out2.{row}" for row in ("kind ad5422", "pin PC5", "pin2 PC4", "bus spi1", "range 4-20mA")), "apply")),
          (10, "mode top auto"), (10, "mode bottom auto"), (25, "sp top 87.5"), (45, "mode bottom manual"), (46, "out Qrb 0.7")),
         {"T1": (87.0, 5.0), "T10": (107.0, 5.0)}, {"top.mode": 1, "bottom.mode": 0, "top.sp": 87.5, "Qrb.cmd": 0.7},
         "pilot-pins", ("Lr stepper PB0 PC2 steps=120 hi=12", "Qrb ad5422 spi1 PC4 clear=PC5 lo=0 hi=1.5")),
    # Its own events: the mains are lost for a while, a leak to the level switch, noise and faults of a voltage, a flow meter and the switch.
    Case("inputs-pins", ((5, "out vF 100"), (30, "status"), (35, "out vCW 80")), {"T1": (20.0, 1.0)}, {"vF.cmd": 100, "vCW.cmd": 80, "wet": 0}),
)


class SameLogTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))

    def run_on(self, firmware: str, case: Case, name: str) -> runner.Result:
        """A minute with the lines of the case; in a longer run those of the scenario come after it."""
        whole = scenario.load(scenario.SCENARIOS / f"{case.scenario or case.name}.toml")
        scripted = [scenario.Line(float(at), text) for at, text in case.later]
        own = [line for line in whole.lines if line.at_s < DURATION_S and (line.at_s == 0 or line.at_s >= 60)]
        wanted = replace(whole, firmware=firmware, duration_s=float(DURATION_S), lines=tuple(sorted([*own, *scripted], key=lambda line: line.at_s)),
                         events=tuple(event for event in whole.events if event.at_s < DURATION_S), limits=(), loops=())
        self.assertIsNotNone(wanted.wiring)
        if case.outputs:
            mine = {line.split()[0] for line in case.outputs}
            lines = [line for line in wanted.wiring.read_text(encoding="utf-8").splitlines() if not mine.intersection(line.split()[:1])]
            wired = self.folder / "wiring"
            wired.write_text("\n".join([*lines, *case.outputs]) + "\n", encoding="utf-8")
            wanted = replace(wanted, wiring=wired)
        result = runner.run(wanted, runner.Options(self.folder / name, quiet=True))
        print(f"{case.name} on {firmware}: {result.facts['samples']} samples in {result.facts['wall_s']} s", flush=True)
        return result

    @unittest.skipUnless((build.build_dir("host") / "reflux-board").exists(), "no reflux-board: libunicorn-dev is not installed")
    def test_the_image_gives_the_log_of_the_host(self) -> None:
        for case in CASES:
            with self.subTest(case.name):
                host, image = self.run_on("memory", case, f"{case.name}-host"), self.run_on(f"board-{IMAGE}", case, f"{case.name}-board")
                self.assertEqual(compare.compare(host.log, image.log), [])

    def test_each_run_is_a_plant_that_is_controlled(self) -> None:
        """Else two logs might be alike because nothing happens."""
        for case in CASES:
            with self.subTest(case.name):
                log = self.run_on("memory", case, case.name).log
                minute = [k for k, time in enumerate(log.numbers("time")) if time <= 60]
                for name, (value, most) in case.near.items():
                    self.assertEqual({log.text(f"fw.{name}.q")[k] for k in minute}, {"0"})
                    kelvin = 273.15 if log.unit(f"{name}.meas") == "K" else 0.0
                    given = [x - kelvin for x in log.numbers(f"{name}.meas")]  # what the sensors are given
                    for k in minute:
                        self.assertAlmostEqual(given[k], value, delta=most)
                    # What the board reads before the plant has moved, but for noise.
                    self.assertAlmostEqual(log.numbers(f"fw.{name}")[0], given[0], delta=0.2)
                for name, value in case.last.items():
                    self.assertAlmostEqual(log.numbers(f"fw.{name}")[minute[-1]], value, places=4, msg=name)

    def test_a_motor_valve_gets_to_its_contact_and_back(self) -> None:
        case = next(case for case in CASES if case.name == "methanol-pins")
        result = self.run_on("memory", case, "valve")
        log = result.log
        actual, time = log.numbers("fw.R.app"), log.numbers("time")
        self.assertAlmostEqual(actual[0], 10.9, delta=0.4)  # the valve stays where it is within its dead band of 1 %
        self.assertEqual({actual[k] for k in range(len(time)) if 34 <= time[k] <= 40}, {0.0})
        self.assertAlmostEqual(actual[next(k for k in range(len(time)) if time[k] == 60)], 8.0, delta=0.4)
        codes = {code for _, _, code, _ in runner.events_in(result.out / "transcript.txt")}
        self.assertNotIn("VALVE_FAULT", codes)

    FAULTS = ("OUTPUT_FAULT", "OUTPUT_FINE", "SENSOR_FAULT", "SENSOR_FINE", "INTERLOCK_ON")

    def test_currents_pulses_and_a_contact_are_read_and_their_faults_told(self) -> None:
        case = next(case for case in CASES if case.name == "inputs-pins")
        result = self.run_on("memory", case, "inputs")
        log = result.log
        time = [int(t) for t in log.numbers("time")]
        read = {name: dict(zip(time, log.numbers(f"fw.{name}"))) for name in ("LB", "TB", "Fcw", "Vcw", "wet", "Qrb.app")}
        given = {name: dict(zip(time, log.numbers(f"{name}.meas"))) for name in ("LB", "TB", "Fcw")}
        for t in range(1, 39):  # a sample has what was measured in the one before
            self.assertAlmostEqual(read["LB"][t], given["LB"][t - 1], delta=0.05)  # 4,095 codes of 3.3 V
            self.assertAlmostEqual(read["TB"][t], given["TB"][t - 1], delta=0.1 if t < 20 else 4.0)  # noise of 12.5 mV in the mean
            self.assertAlmostEqual(read["Fcw"][t], max(given["Fcw"][t - 1], 0) / 4, delta=2.0)  # a pulse in half a second
        drawn = sum(max(given["Fcw"][t], 0) / 4 for t in range(39))
        self.assertAlmostEqual(read["Vcw"][39], drawn, delta=1.5)
        self.assertGreater(drawn, 50)
        dry = next(t for t in time if read["wet"][t] == 0)
        self.assertTrue(all(given["LB"][t] >= 17.0 - 0.3 for t in range(dry - 1)))
        self.assertLessEqual(given["LB"][dry - 1], 17.0 - 0.3)
        self.assertAlmostEqual(read["Qrb.app"][dry - 1], 0.9, places=4)
        self.assertEqual(read["Qrb.app"][dry + 2], 0.0)
        self.assertEqual({read["Fcw"][t] for t in (50, 51)}, {0.0})
        told = [(code, at) for at, _, code, _ in runner.events_in(result.out / "transcript.txt") if code in self.FAULTS]
        begin = told[0][1] - 12  # of plant time, by the board's clock; the mains are found again when a second of crossings was right
        self.assertEqual([(code, at - begin) for code, at in told[:5]],
                         [("OUTPUT_FAULT", 12), ("OUTPUT_FINE", 16), ("INTERLOCK_ON", dry), ("SENSOR_FAULT", 40), ("SENSOR_FINE", 44)])

    def test_a_run_on_the_host_repeats_to_the_bit(self) -> None:
        first, second = (self.run_on("memory", CASES[0], name) for name in ("first", "second"))
        for kept in ("log.csv", "telemetry.csv", "transcript.txt"):
            with self.subTest(kept):
                self.assertEqual((first.out / kept).read_bytes(), (second.out / kept).read_bytes())


class DemonstrationTest(unittest.TestCase):
    """tools/demo --board."""

    def demonstrate(self, firmware: str) -> runner.Result:
        folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))
        wanted = scenario.load(scenario.SCENARIOS / "demo-board.toml").with_options(firmware=firmware)
        return runner.run(wanted, runner.Options(folder / firmware, quiet=True))

    def test_the_cold_column_comes_under_control_by_its_own_sequence(self) -> None:
        result = self.demonstrate("memory")
        self.assertEqual(result.failures(), [])
        log, events = result.log, runner.events_in(result.out / "transcript.txt")
        self.assertIn("SEQUENCE_DONE", [code for _, _, code, _ in events])
        self.assertFalse([text for _, _, code, text in events if code in ("SEQUENCE_HELD", "SEQUENCE_TIMEOUT", "SEQUENCE_ABORTED", "SENSOR_FAULT", "VALVE_FAULT")])
        self.assertLess(log.numbers("T1.true")[0], 25.0)
        self.assertEqual([log.numbers(f"fw.{loop}.mode")[-1] for loop in ("top", "bottom")], [1.0, 1.0])
        for name, setpoint in (("T1", 87.15), ("T10", 107.5)):
            self.assertAlmostEqual(log.numbers(f"{name}.true")[-1], setpoint, delta=1.0)

    @unittest.skipUnless(EVERY, "the image takes minutes")
    def test_the_image_does_it_as_the_host_does(self) -> None:
        self.assertEqual(compare.compare(self.demonstrate("memory").log, self.demonstrate(f"board-{IMAGE}").log), [])


if __name__ == "__main__":
    unittest.main()
