#!/usr/bin/python3
"""A plant in another language, written from docs/inside/plant-link.md alone, is controlled by the firmware."""

import math
import os
import pty
import re
import signal
import subprocess
import sys
import tempfile
import termios
import time
import types
import unittest
import unittest.mock
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
import python_plant  # noqa: E402

CONFIGURATION = """begin
set meas1.name T1
set meas1.unit degC
set meas2.name T2
set meas2.unit degC
set mv1.name u1
set mv1.unit %
set mv2.name u2
set mv2.unit %
set loop1.name first
set loop1.pv T1
set loop1.out u1
set loop1.gain 2
set loop1.ti 100
set loop2.name second
set loop2.pv T2
set loop2.out u2
set loop2.gain 2
set loop2.ti 150
apply"""

PAGE = board.ROOT / "docs" / "start" / "hardware.md"


def bridge() -> list[str]:
    """What the page has typed at the console."""
    return [line.removeprefix("    > ") for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("    > ")]


# A file that is opened to be written is empty, which a pin never is, and stays so where the program ends before it writes.
WRITE_AS_A_PIN = """def set_pin(pin, level):
    fresh = pin.with_suffix(".fresh")
    fresh.write_text(level)
    fresh.replace(pin)
"""


def level(pin: Path) -> str:
    return pin.read_text(encoding="ascii")


class PythonPlantTest(unittest.TestCase):
    def test_a_serial_line_has_the_speed_of_the_plant_link(self) -> None:
        ours, theirs = pty.openpty()
        try:
            link = python_plant.Link(os.ttyname(theirs))
            self.assertEqual(termios.tcgetattr(theirs)[4:6], [termios.B115200, termios.B115200])
            os.close(link.fd)
        finally:
            os.close(ours)
            os.close(theirs)

    def test_a_second_program_on_a_line_is_refused_by_the_name_of_the_first(self) -> None:
        ours, theirs = pty.openpty()
        first = python_plant.Link(os.ttyname(theirs))
        try:
            script = board.ROOT / "tests" / "support" / "python_plant.py"
            second = subprocess.run([sys.executable, str(script), os.ttyname(theirs)], capture_output=True, text=True, check=False)
            self.assertEqual((second.returncode, second.stdout), (1, ""))
            self.assertRegex(second.stderr, rf"^{os.ttyname(theirs)} is in use by \S.* \(process {os.getpid()}\); end that first, or name another port\n$")
        finally:
            for descriptor in (first.fd, ours, theirs):
                os.close(descriptor)

    def test_a_plant_in_python_is_brought_to_its_setpoints(self) -> None:
        with board.start("host") as firmware, board.console(firmware) as console:
            for line in CONFIGURATION.splitlines():
                console.do(line)
            script = board.ROOT / "tests" / "support" / "python_plant.py"
            plant = subprocess.Popen([sys.executable, str(script), firmware.link.removeprefix("socket:"), "400"],
                                     stdout=subprocess.PIPE, text=True)
            try:
                console.event("LINK_UP")
                assert plant.stdout
                plant.stdout.readline()  # the first sample has been answered
                console.do("mode first auto")
                console.do("mode second auto")
                console.event("MODE")
                console.event("MODE")
                console.do("sp first 55")
                console.do("sp second 60")
                rows = plant.stdout.read().splitlines()
            finally:
                plant.kill()
                plant.wait()
                plant.stdout.close()
            final = [float(x) for x in rows[-1].split(",")]
            self.assertAlmostEqual(final[1], 55.0, delta=0.1)
            self.assertAlmostEqual(final[2], 60.0, delta=0.1)

    def test_a_loop_whose_channel_the_plant_has_in_another_unit_refuses_auto(self) -> None:
        with board.start("host") as firmware, board.console(firmware) as console:
            for line in CONFIGURATION.replace("set meas2.unit degC", "set meas2.unit K").splitlines():
                console.do(line)
            script = board.ROOT / "tests" / "support" / "python_plant.py"
            plant = subprocess.Popen([sys.executable, str(script), firmware.link.removeprefix("socket:"), "5"],
                                     stdout=subprocess.PIPE, text=True)
            try:
                console.event("CHANNEL_UNIT")
                self.assertRegex(console.ask("mode second auto")[-1], r"^err UNIT T2")
                self.assertEqual(console.ask("mode first auto"), ["ok"])
            finally:
                plant.kill()
                plant.wait()
                assert plant.stdout
                plant.stdout.close()

    def test_the_program_of_the_page_keeps_the_line_alive_and_leaves_the_outputs_safe(self) -> None:
        """Ticks are longer than the silence that the board bears."""
        program, _ = programs_of_the_page()
        program = program.replace("link.TICK_MS = 5000", "link.TICK_MS = 2500").replace("return list(kettle)", "return [kettle[0], math.nan]")
        self.assertIn("2500", program)
        self.assertIn("math.nan]", program)
        # A signal interrupts print between its parts.
        program = program.replace('"""Sets the real outputs', '__import__("os").write(1, f"set {values[0]} {values[1]}\\n".encode())\n    """Sets the real outputs')
        with tempfile.TemporaryDirectory() as folder, board.start("host") as firmware, board.console(firmware) as console:
            script = Path(folder) / "bridge.py"
            script.write_text(program, encoding="utf-8")
            for line in bridge():
                console.do(line)
            plant = subprocess.Popen([sys.executable, str(script), firmware.link.removeprefix("socket:")], cwd=board.ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                     text=True)
            assert plant.stdout and plant.stderr
            try:
                console.event("LINK_UP")
                console.event("MEASUREMENT_BAD")
                console.do("out reflux 20")
                console.event("OUTPUT")
                rows = [plant.stdout.readline().split() for _ in range(8)]
                self.assertNotIn("LINK_DOWN", "\n".join(console.ask("events")))
                plant.send_signal(signal.SIGINT)
                rows += [line.split() for line in plant.stdout.read().splitlines()]
                self.assertEqual(plant.stderr.read(), "ended: the outputs are at their safe values\n")
            finally:
                plant.kill()
                plant.wait()
                plant.stdout.close()
                plant.stderr.close()
            self.assertIn(["set", "20.0", "0.0"], rows)
            self.assertEqual(rows[-1], ["set", "0.0", "0.0"])
            console.event("SAFE_STATE")

    def test_thermometers_and_pins_of_the_page_are_read_and_switched(self) -> None:
        """Files stand in for the kernel's."""
        program, pins = programs_of_the_page()
        before, after = program[:program.index("kettle = ")], program[program.index("class Column"):]
        with tempfile.TemporaryDirectory() as folder, board.start("host") as firmware, board.console(firmware) as console:
            files = stand_ins(Path(folder))
            script = Path(folder) / "bridge.py"
            self.assertEqual(pins.count("pin.write_text("), 1)
            pins = WRITE_AS_A_PIN + pins.replace("pin.write_text(", "set_pin(pin, ")
            script.write_text((before + pins + after).replace("link.TICK_MS = 5000", "link.TICK_MS = 1000").replace("/sys/", f"{folder}/"), encoding="utf-8")
            for line in bridge():
                if line.startswith("set lock"):
                    continue  # with a thermometer dead it would hold the heater
                console.do(line)
            plant = subprocess.Popen([sys.executable, str(script), firmware.link.removeprefix("socket:")], cwd=board.ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                     text=True)
            assert plant.stdout and plant.stderr
            try:
                console.event("LINK_UP")
                console.do("out heater 1000")
                console.event("OUTPUT")
                rows = [plant.stdout.readline().split() for _ in range(4)]
                values = set()
                for _ in range(150):
                    values.add(level(files["heater"]))
                    time.sleep(0.01)
                plant.send_signal(signal.SIGINT)
                rows += [line.split() for line in plant.stdout.read().splitlines()]
                self.assertEqual(plant.stderr.read(), "ended: the outputs are at their safe values\n")
            finally:
                plant.kill()
                plant.wait()
                plant.stdout.close()
                plant.stderr.close()
            self.assertIn(["21.562", "nan", "0.0", "1000.0"], rows)  # exactly 85 is no reading
            self.assertLessEqual({"0", "1"}, values)
            self.assertEqual([level(files[name]) for name in ("heater", "reflux")], ["0", "0"])

    def test_pins_of_the_page_go_off_when_nothing_is_commanded_and_readings_grow_old(self) -> None:
        _, pins = programs_of_the_page()
        with tempfile.TemporaryDirectory() as folder:
            files = stand_ins(Path(folder))
            link = types.SimpleNamespace(TICK_MS=200, DRIVEN=[("reflux", "%", 0.0, 100.0, 0.0), ("heater", "W", 0.0, 2000.0, 0.0)])
            page = {"link": link, "math": math, "time": time}
            exec(pins[:pins.index("for arguments in")].replace("/sys/", f"{folder}/"), page)  # without its threads
            page["ask"](0)
            page["ask"](1)
            self.assertEqual(page["read"]()[0], 21.562)
            page["seen"][0] = (time.monotonic() - 6, 21.562)
            self.assertTrue(math.isnan(page["read"]()[0]))
            files["28-000005e2fdc3"].unlink()
            page["ask"](0)
            self.assertTrue(math.isnan(page["read"]()[0]))
            for part, on in ((1.0, 0.95), (0.25, 0.25)):
                page["drive"]([0.0, 2000.0 * part])
                for moment in (0.0, 0.2, 0.3, 0.94, 0.96):
                    page["until"][0] = 2.0 + moment
                    with unittest.mock.patch("time.monotonic", return_value=1.0 + moment):
                        page["switch"]()
                    self.assertEqual(level(files["heater"]), "1" if moment < on else "0")
                    self.assertEqual(level(files["reflux"]), "0")
            page["drive"]([100.0, 2000.0])
            time.sleep(0.45)
            page["switch"]()
            self.assertEqual([level(files[name]) for name in ("heater", "reflux")], ["0", "0"])


def programs_of_the_page() -> list[str]:
    """The program between board and column, and the part of it for a Raspberry Pi: files that the page links."""
    linked = re.findall(r"\[(bridge\w*\.py)\]\(\1\)", PAGE.read_text(encoding="utf-8"))
    return [(PAGE.parent / name).read_text(encoding="utf-8") for name in dict.fromkeys(linked)]


def stand_ins(folder: Path) -> dict[str, Path]:
    """Files as the kernel has them: two thermometers in thousandths of a degree, two pins."""
    files = {name: folder / "class" / "leds" / name / "brightness" for name in ("reflux", "heater")}
    files |= {name: folder / "bus" / "w1" / "devices" / name / "temperature" for name in ("28-000005e2fdc3", "28-000005e31a8b")}
    for (name, file), text in zip(files.items(), ("1", "1", "21562\n", "85000\n")):
        file.parent.mkdir(parents=True)
        file.write_text(text, encoding="ascii")
    return files


if __name__ == "__main__":
    unittest.main()
