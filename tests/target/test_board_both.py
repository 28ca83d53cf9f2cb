#!/usr/bin/python3
"""The pilot column with a part of it at the board's own pins and a part at the link: the flashed image gives the log of the host, bit for bit."""

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

IMAGE = "stm32f405"
BOARD = board.ROOT / "build" / "host" / "reflux-board"
SETTINGS = board.ROOT / "host_sim" / "scenarios" / "pilot-pins.conf"
WIRING = board.ROOT / "host_sim" / "scenarios" / "pilot-pins.wiring"
DURATION_S = 60
# Plant time, s, and console line: manual outputs, both loops to automatic, a setpoint, and settings that come into force meanwhile.
LATER = ((3, "out Lr 4.5"), (3, "out Qrb 0.8"), (8, "status"), (10, "mode top auto"), (10, "mode bottom auto"), (25, "sp top 87.5"),
         (35, "begin"), (35, "set loop1.gain 10"), (35, "apply"), (45, "mode bottom manual"), (46, "out Qrb 0.7"))
SPENT = ("stat.tick",)  # processor time
# Three thermometers at the link beside the pins, which is unplugged for a while.
BY_LINK = ("T3", "T5", "T8")
UNPLUGGED = ("--rest-on-link", *(word for name in BY_LINK for word in ("--measure", name)), "--event", "20:board.unplug_link=15")


def settings() -> list[str]:
    return [line for line in SETTINGS.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]


def telemetry(out: Path) -> list[dict[str, str]]:
    """The rows by the names of their header, without units and without what no two boards have in common."""
    names: list[str] = []
    rows = []
    for line in (out / "telemetry.csv").read_text(encoding="utf-8").splitlines():
        fields = line.split(",")
        if fields[0] == "H":
            names = [re.sub(r"\[.*", "", name) for name in fields]
        else:
            rows.append({name: field for name, field in zip(names, fields) if name not in SPENT})
    return rows


@unittest.skipUnless(BOARD.exists(), "no reflux-board: libunicorn-dev is not installed")
class SameLogTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))
        self.script = self.folder / "script.txt"
        self.write_script(settings())

    def write_script(self, first: list[str]) -> None:
        lines = [*((0, line) for line in (*first, "log on")), *LATER]
        self.script.write_text("".join(f"{at} {line}\n" for at, line in lines), encoding="utf-8")

    def simulate(self, program: str, where: str, name: str, *options: str) -> Path:
        """The folder with log, telemetry and transcript of a run of the plant."""
        out = self.folder / name
        out.mkdir()
        done = subprocess.run([str(build.find_program("host", program)), "--plant", "pilot", "--port", where, "--console", where,
                               "--wiring", str(WIRING), "--tick", "1", "--duration", str(DURATION_S), "--script", str(self.script),
                               "--log", str(out / "simulator.csv"), "--telemetry", str(out / "telemetry.csv"),
                               "--transcript", str(out / "transcript.txt"), "--timeout", str(board.PATIENCE_S), *options],
                              capture_output=True, text=True, timeout=board.PATIENCE_S, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        print(f"{name}: {done.stdout.strip()}{done.stderr.strip()}")
        return out

    def host(self, name: str = "host", *options: str) -> Path:
        return self.simulate("reflux-sim-memory", "memory", name, *options)

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

    def test_the_image_gives_the_log_of_the_host_with_a_part_of_the_plant_at_the_link(self) -> None:
        lines = [line.replace("io.source board", "io.source both") for line in settings()]
        for number, name in enumerate(BY_LINK, 3):
            lines[-1:-1] = [f"set meas{number}.{field}" for field in (f"name {name}", "unit degC", "lo 70", "hi 130")]
        self.write_script(lines)
        rows = telemetry(self.compare(*UNPLUGGED))[-DURATION_S - 1:]
        for name in BY_LINK:
            good = [row[f"{name}.q"] == "0" for row in rows]
            self.assertEqual((good[15], good[30], good[45]), (True, False, True))
        self.assertEqual({row["T1.q"] for row in rows}, {"0"})

    def compare(self, *options: str) -> Path:
        host = self.host("host", *options)
        with self.virtual_board() as where:
            image = self.simulate("reflux-sim", where, "board", *options)
        print(self.said.strip())
        self.assertEqual((host / "simulator.csv").read_bytes(), (image / "simulator.csv").read_bytes())
        self.assertEqual(telemetry(host), telemetry(image))
        for kind in ("software", "watchdog"):
            self.assertIn(f"{kind} 0", self.said)
        return image


if __name__ == "__main__":
    unittest.main()
