#!/usr/bin/python3
"""A plant in another language, written from docs/inside/plant-link.md alone, is controlled by the firmware."""

import os
import pty
import re
import signal
import subprocess
import sys
import tempfile
import termios
import unittest
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

BRIDGE = """begin
set meas1.name Ttop
set meas1.unit degC
set meas2.name Tbot
set meas2.unit degC
set mv1.name reflux
set mv1.unit %
set mv2.name heater
set mv2.unit W
set mv2.hi 2000
apply"""


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
        page = (board.ROOT / "docs" / "start" / "hardware.md").read_text(encoding="utf-8")
        (program,) = re.findall(r"^```python\n(.*?)^```\n", page, re.M | re.S)
        program = program.replace("link.TICK_MS = 5000", "link.TICK_MS = 2500").replace("return list(kettle)", "return [kettle[0], math.nan]")
        self.assertIn("2500", program)
        self.assertIn("math.nan]", program)
        program = program.replace('"""Sets the real outputs', 'print("set", *values, flush=True)\n    """Sets the real outputs')
        with tempfile.TemporaryDirectory() as folder, board.start("host") as firmware, board.console(firmware) as console:
            script = Path(folder) / "bridge.py"
            script.write_text(program, encoding="utf-8")
            for line in BRIDGE.splitlines():
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


if __name__ == "__main__":
    unittest.main()
