#!/usr/bin/python3
"""The pilot column at the pins of an STM32F100: the flashed image on the virtual board gives the log of the host in fixed point, bit for bit."""

import contextlib
import re
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402

from reflux import build  # noqa: E402

IMAGE, TWIN = "stm32f100-pins", "host-fixed"
BOARD = board.ROOT / "build" / "host" / "reflux-board"
SETTINGS = board.ROOT / "host_sim" / "scenarios" / "pilot-pins-small.conf"
WIRING = board.ROOT / "host_sim" / "scenarios" / "pilot-pins-small.wiring"
DURATION_S = 60
# Plant time, s, and console line: manual outputs, the heater's loop to automatic, a setpoint, settings that come into force meanwhile, the other loop.
LATER = ((3, "out Lr 4.5"), (3, "out Qrb 0.8"), (8, "status"), (10, "mode bottom auto"), (20, "sp bottom 104"), (30, "begin"),
         (30, "set loop1.gain 4"), (30, "apply"), (40, "mode top auto"), (50, "mode bottom manual"), (51, "out Qrb 0.7"))
SPENT = "stat.tick"  # processor time


def telemetry(out: Path) -> list[dict[str, str]]:
    """The rows by the names of their header, without units and processor time."""
    names: list[str] = []
    rows = []
    for line in (out / "telemetry.csv").read_text(encoding="utf-8").splitlines():
        fields = line.split(",")
        if fields[0] == "H":
            names = [re.sub(r"\[.*", "", name) for name in fields]
        else:
            rows.append({name: field for name, field in zip(names, fields) if name != SPENT})
    return rows


@unittest.skipUnless(BOARD.exists(), "no reflux-board: libunicorn-dev is not installed")
class SmallBoardPinsTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))
        self.script = self.folder / "script.txt"
        settings = [line for line in SETTINGS.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
        lines = [*((0, line) for line in (*settings, "log on")), *LATER]
        self.script.write_text("".join(f"{at} {line}\n" for at, line in lines), encoding="utf-8")

    def simulate(self, program: str, where: str, name: str) -> Path:
        """The folder with log, telemetry and transcript of a run of the plant."""
        out = self.folder / name
        out.mkdir()
        done = subprocess.run([str(build.find_program(TWIN, program)), "--plant", "pilot", "--port", where, "--console", where,
                               "--wiring", str(WIRING), "--tick", "1", "--duration", str(DURATION_S), "--script", str(self.script),
                               "--log", str(out / "simulator.csv"), "--telemetry", str(out / "telemetry.csv"),
                               "--transcript", str(out / "transcript.txt"), "--timeout", str(board.PATIENCE_S)],
                              capture_output=True, text=True, timeout=board.PATIENCE_S, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        print(f"{name}: {done.stdout.strip()}{done.stderr.strip()}")
        return out

    @contextlib.contextmanager
    def virtual_board(self):
        control = self.folder / "control"
        process = subprocess.Popen([str(BOARD), "--image", str(build.find_image(IMAGE)), "--control", str(control), "--wiring", str(WIRING),
                                    "--statistics"], stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        end = time.monotonic() + board.PATIENCE_S
        while not control.exists():
            self.assertTrue(process.poll() is None and time.monotonic() < end, "reflux-board did not start")
            time.sleep(0.01)
        self.said = ""
        yield f"board:{control}"
        self.said = process.communicate(timeout=board.PATIENCE_S)[1]

    def test_the_image_gives_the_log_of_the_host(self) -> None:
        host = self.simulate("reflux-sim-memory", "memory", "host")
        with self.virtual_board() as where:
            image = self.simulate("reflux-sim", where, "board")
        print(self.said.strip())
        self.assertEqual((host / "simulator.csv").read_bytes(), (image / "simulator.csv").read_bytes())
        self.assertEqual(telemetry(host), telemetry(image))
        for kind in ("software", "watchdog"):
            self.assertIn(f"{kind} 0", self.said)
        status = next(line for line in (image / "transcript.txt").read_text(encoding="utf-8").splitlines() if ", plant at " in line)
        self.assertRegex(status, r"plant at the board's pins, plant time \d+\.000 s")

    def test_the_run_is_a_column_that_is_controlled(self) -> None:
        """Else two logs might be alike because nothing happens."""
        rows = telemetry(self.simulate("reflux-sim-memory", "memory", "host"))
        self.assertGreaterEqual(len(rows), DURATION_S)
        self.assertEqual({row["T10.q"] for row in rows}, {"0"})
        last = rows[-1]
        self.assertEqual((last["top.mode"], last["bottom.mode"], float(last["bottom.sp"])), ("1", "0", float(last["T10"])))
        self.assertAlmostEqual(float(last["Qrb.cmd"]), 0.7, places=6)
        self.assertNotEqual(float(last["Lr.cmd"]), 4.5)
        self.assertAlmostEqual(float(last["T10"]), 105.0, delta=3.0)
        self.assertAlmostEqual(float(last["T1"]), 87.0, delta=3.0)


if __name__ == "__main__":
    unittest.main()
