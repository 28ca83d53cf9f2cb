#!/usr/bin/python3
"""tools/io on the real firmware as a process of this computer: what it lists, moves, writes, and brings back however it ends."""

import contextlib
import io
import signal
import sys
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
from io_dialogue import Dialogue  # noqa: E402

from reflux import io_check, io_wiring  # noqa: E402

# A level switch, which the host reads as an open contact, an amplifier without a chip, a relay, a heater, and the contactor of heaters.
SETTINGS = ["begin", "set io.source board", "set tick.base 0.1",
            "set chan1.name low", "set chan1.device level", "set chan1.select PC1", "set meas1.name low", "set meas1.hi 1", "set meas1.lo -1",
            "set chan2.name T1", "set chan2.unit degC", "set chan2.device max31865", "set chan2.bus spi1", "set chan2.select PA4",
            "set meas2.name T1", "set meas2.unit degC",
            "set out1.name pump", "set out1.unit %", "set out1.kind relay", "set out1.pin PB0", "set mv1.name pump", "set mv1.unit %", "set mv1.safe 0",
            "set out2.name heat", "set out2.unit W", "set out2.kind window", "set out2.pin PB1", "set out2.heater on", "set out2.hi 1000",
            "set mv2.name heat", "set mv2.unit W", "set mv2.hi 1000", "set mv2.max 900", "set mv2.min 100", "set mv2.safe 0",
            "set out3.name permit", "set out3.kind enable", "set out3.pin PC0", "set out3.least_off 1", "apply"]


class IoTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))
        self.firmware = self.enterContext(board.launch.start("host"))
        self.log = folder / "lines.txt"
        self.command([*SETTINGS])

    def command(self, lines: list[str]) -> list[str]:
        """Payload of the last line."""
        with board.console(self.firmware) as console:
            return [console.do(line) for line in lines][-1]

    @staticmethod
    def ticks(console: board.Console) -> None:
        """Waits for some ticks, in which what was asked for comes into force."""
        console.do("log on")
        for _ in range(5):
            console.until(lambda line: line.startswith("T,"))
        console.do("log off")

    def status(self) -> str:
        return "\n".join(self.command(["status"]))

    def dialogue(self, *options: str) -> Dialogue:
        return self.enterContext(Dialogue(self.firmware.console, "--log", str(self.log), *options))

    def test_list_has_every_sensor_and_output_with_reading_and_reason(self) -> None:
        status, said = self.dialogue("--list").end()
        self.assertEqual(status, 0)
        lines = [" ".join(line.split()) for line in said.splitlines()]
        self.assertEqual(lines, ["low level PC1 0", "T1 max31865 on spi1 PA4 bad: no chip answers", "pump relay on PB0 0 .. 100 %, safe 0",
                                 "heat window on PB1 100 .. 900 W, safe 0, heater",
                                 "enable on PC0: on while clock, tick and main loop turn; heaters are off without it"])
        sent = [line[2:] for line in self.log.read_text(encoding="utf-8").splitlines() if line.startswith("> ")]
        self.assertFalse([line for line in sent if line.startswith(("set ", "out ", "begin", "mode low", "apply"))])

    def test_a_sensor_with_a_fault_is_told_with_what_to_look_at_and_fails_the_check(self) -> None:
        d = self.dialogue()
        d.answer("warm it", "")
        d.until("NOT OK: T1 bad: no chip answers; look at supply and ground of the chip, the select pin")
        for question in ("pump: relay", "heat: window", "Calibrate"):
            d.answer(question, "")
        status, said = d.end()
        self.assertEqual(status, 1)
        self.assertIn("NOT OK T1 bad: no chip answers", said)

    def at_outputs(self) -> Dialogue:
        d = self.dialogue()
        d.answer("warm it", "")
        return d

    def test_an_output_moves_after_a_yes_and_is_back_after_the_answer(self) -> None:
        d = self.at_outputs()
        d.answer("pump: relay", "y")
        d.until("Did pump move")
        d.type("y")
        d.until("ok: pump moved at 100 %, and is back at 0")
        d.until("heat is a heater: unplug it and put a lamp in its place")
        d.answer("heat: window", "250")
        d.answer("Did heat move", "n")
        d.until("NOT OK: heat did not move, or something else did: look at its pin PB1, and is back at 0")
        d.answer("Calibrate", "")
        self.assertEqual(d.end()[0], 1)
        sent = [line for line in self.log.read_text(encoding="utf-8").splitlines() if line.startswith("> out ")]
        self.assertEqual(sent, ["> out pump 100", "> out pump 0", "> out heat 250", "> out heat 0"])
        self.assertIn("heat = 0 W", self.status())

    def test_without_an_answer_an_output_goes_back_after_the_time_limit(self) -> None:
        d = self.dialogue("--hold", "2")
        d.answer("warm it", "")
        d.answer("pump: relay", "y")
        d.until("NOT OK: no answer about pump in 2 s, and is back at 0")
        d.until("heat: window")
        d.interrupt()
        self.assertEqual(d.end()[0], 130)

    def test_however_it_ends_an_output_that_was_moved_is_at_its_safe_value(self) -> None:
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129), (None, 1)):
            with self.subTest(number):
                d = self.at_outputs()
                d.answer("pump: relay", "")
                d.answer("heat: window", "y")
                d.until("Did heat move")
                if number is None:
                    d.process.stdin.close()  # no more answers
                else:
                    d.interrupt(number)
                d.process.wait(timeout=board.PATIENCE_S)
                self.assertEqual(d.process.returncode, status)
                self.assertIn("heat = 0 W", self.status())

    def test_an_output_that_an_interlock_holds_is_told(self) -> None:
        self.command(["begin", "set lock1.meas T1", "set lock1.mv heat", "set lock1.side above", "set lock1.limit 90", "set lock1.value 0", "apply"])
        with board.console(self.firmware) as console:
            self.ticks(console)
        d = self.at_outputs()
        d.answer("pump: relay", "")
        d.answer("heat: window", "y")
        d.until("NOT OK: heat is held by an interlock")
        d.interrupt()
        self.assertEqual(d.end()[0], 130)

    def test_a_value_that_the_board_refuses_moves_nothing(self) -> None:
        d = self.at_outputs()
        d.answer("pump: relay", "")
        d.answer("heat: window", "950")
        d.until("NOT OK: heat: the board refuses 950: err RANGE heat")
        d.answer("Calibrate", "")
        self.assertEqual(d.end()[0], 1)

    def test_a_loop_in_automatic_is_put_into_manual_first_or_nothing_is_done(self) -> None:
        self.command(["begin", "set loop1.name level", "set loop1.pv low", "set loop1.out pump", "apply"])
        for answer, mode in (("n", "auto"), ("y", "manual")):
            with self.subTest(answer), board.console(self.firmware) as console:
                console.do("mode level auto")
                self.ticks(console)
            d = self.dialogue()
            d.answer("level would move outputs meanwhile. Put into manual?", answer)
            if answer == "y":
                d.until("warm it")
                d.interrupt()
            d.end()
            self.assertIn(f"level {mode}", self.command(["loop"])[0])

    def test_a_calibration_is_written_to_the_measurement_and_saved_when_asked(self) -> None:
        d = self.at_outputs()
        d.answer("pump: relay", "")
        d.answer("heat: window", "")
        d.answer("Calibrate", "low")
        d.answer("first true value", "0.25")
        d.answer("second true value", "")
        d.answer("set meas1.gain 1; set meas1.zero 0.25: take these settings?", "y")
        d.until("ok: low is calibrated and now reads 0.25")
        d.answer("Calibrate", "")
        d.answer("Save the settings in the board's flash?", "y")
        d.until("ok: saved")
        d.end()
        self.assertEqual(self.command(["get meas1.zero"]), ["meas1.zero = 0.25 EU"])
        self.assertNotIn("meas1.zero", "\n".join(self.command(["diff saved"])))

    def test_readings_outside_the_limits_of_belief_are_believed_during_the_check_alone(self) -> None:
        self.command(["begin", "set meas1.valid_lo 0.5", "set meas1.valid_hi 0.9", "apply"])
        with board.console(self.firmware) as console:
            self.ticks(console)
        d = self.dialogue()
        d.answer("low: the reading is outside what the board believes", "y")
        d.until("It reads 0")
        d.until("warm it")
        d.interrupt()
        self.assertEqual(d.end()[0], 130)
        self.assertEqual(self.command(["get meas1.valid_lo"]) + self.command(["get meas1.valid_hi"]), ["meas1.valid_lo = 0.5 EU", "meas1.valid_hi = 0.9 EU"])

    def test_a_board_with_its_plant_at_the_link_is_told_what_to_set(self) -> None:
        self.command(["set io.source link"])
        status, said = self.dialogue().end()
        self.assertEqual(status, 2)
        self.assertIn("`set io.source board`", said)


def channel(name: str) -> io_wiring.Channel:
    return io_wiring.Channel(name, "degC", "max31865 on spi1 PA4", "meas1", 100.0, 1.0, 0.0, 0.0, 0.0)


def judged(wanted: str, moved: dict[str, float]) -> tuple[bool, str]:
    check = io_check.Check(SimpleNamespace(), SimpleNamespace(), io_wiring.Wiring([], [], []), 10.0)
    with contextlib.redirect_stdout(io.StringIO()):
        check.judge(channel(wanted), moved)
    return check.findings[0]


class Verdicts(unittest.TestCase):
    """What is said of the readings that moved, and of an output's small move."""

    def test_the_sensor_that_was_touched_moved_alone(self) -> None:
        self.assertEqual(judged("T1", {"T1": 4.2}), (True, "T1 moved by +4.2 degC, and nothing else did"))

    def test_another_sensor_moved_in_its_place(self) -> None:
        fine, said = judged("T1", {"T10": 4.2})
        self.assertFalse(fine)
        self.assertIn("T10 moved, T1 did not: exchange", said)

    def test_two_sensors_moved_together(self) -> None:
        fine, said = judged("T1", {"T1": 4.2, "T10": 4.1})
        self.assertFalse(fine)
        self.assertIn("T10 moved together with T1", said)

    def test_a_thermometer_that_falls_may_have_its_wires_exchanged(self) -> None:
        fine, said = judged("T1", {"T1": -4.2})
        self.assertFalse(fine)
        self.assertIn("its two wires are exchanged", said)

    def test_a_little_is_within_the_limits_and_away_from_the_safe_value(self) -> None:
        for least, most, safe, wanted in ((0.0, 100.0, 0.0, 10.0), (0.4, 1.25, 0.0, 0.4), (1.0, 9.0, 4.5, 5.3), (0.0, 100.0, 100.0, 90.0)):
            with self.subTest(safe=safe, least=least):
                o = io_wiring.Output("u", "%", "window on PB0", "window", False, least, most, safe)
                self.assertAlmostEqual(o.little(), wanted)

    def test_each_fault_of_a_sensor_has_advice(self) -> None:
        source = (board.ROOT / "firmware" / "devices" / "devices.c").read_text(encoding="utf-8")
        texts = source.split("fault_texts[] = {")[1].split("};")[0]
        self.assertEqual(sorted(io_check.ADVICE), sorted(text.strip().strip('"') for text in texts.split('",')))

    def test_only_a_virtual_board_takes_lines_for_its_pins(self) -> None:
        from reflux.board_port import PINS
        self.assertTrue(all(PINS.fullmatch(line) for line in ("pins.T1 35", "pins.T1.open 1", "pins.x -2.5e3")))
        self.assertFalse(any(PINS.fullmatch(line) for line in ("pins.T1", "pins.T1 hot", "supply 0", "pins.T1 35\nsupply 0")))


if __name__ == "__main__":
    unittest.main()
