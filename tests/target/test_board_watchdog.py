#!/usr/bin/python3
"""Outputs at the board's own pins where its clock hangs, and while its flash is erased: the flashed image on the virtual board, over the range of
the watchdog's own clock."""

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
SLOW_CLOCKS_HZ = (17000, 32000, 47000)  # DS8626: range, and nominal
TIMEOUT_S = 1.0        # WATCHDOG_PINS_MS at the nominal clock
FED_EVERY_S = 0.175    # an eighth of that, and a turn of the tick
TURN_S = 0.05          # of the tick: the last command may be so much older than the hang
DEAD_MAN_S = 2.0
STARTED = ("3 out Lr 4.5", "3 out Qrb 0.8")
HANG_S, LOOK_S = 8, 0.05
FILLING = 125          # saves: more than a half of the flash for settings holds


def rows_of(log: Path) -> list[dict[str, str]]:
    lines = [line for line in log.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    names = [re.sub(r"\[.*", "", name) for name in lines[0].split(",")]
    return [dict(zip(names, line.split(","))) for line in lines[1:]]


@unittest.skipUnless(BOARD.exists(), "no reflux-board: libunicorn-dev is not installed")
class BoardWatchdogTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))

    wiring = WIRING

    @contextlib.contextmanager
    def virtual_board(self, slow_clock_hz: int):
        control = self.folder / "control"
        process = subprocess.Popen([str(BOARD), "--image", str(build.find_image(IMAGE)), "--control", str(control), "--wiring", str(self.wiring),
                                    "--slow-clock", str(slow_clock_hz), "--diary", str(self.folder / "diary"), "--statistics"],
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        end = time.monotonic() + board.PATIENCE_S
        while not control.exists():
            self.assertTrue(process.poll() is None and time.monotonic() < end, "reflux-board did not start")
            time.sleep(0.01)
        yield f"board:{control}"
        self.said = process.communicate(timeout=board.PATIENCE_S)[1].strip()

    def run_column(self, slow_clock_hz: int, duration_s: int, lines: list[str], *options: str, tick_s: float = 1) -> str:
        """The column at the pins under these console lines. Returns the transcript; self.diary has (time of the board, words)."""
        settings = [f"0 {line}" for line in SETTINGS.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
        script, transcript = self.folder / "script", self.folder / "transcript"
        timed = sorted([*settings, *STARTED, *lines], key=lambda line: float(line.split(" ", 1)[0]))
        script.write_text("\n".join(timed) + "\n", encoding="utf-8")
        with self.virtual_board(slow_clock_hz) as where:
            done = subprocess.run([str(build.find_program("host", "reflux-sim")), "--plant", "pilot", "--port", where, "--console", where,
                                   "--wiring", str(self.wiring), "--tick", str(tick_s), "--duration", str(duration_s), "--script", str(script),
                                   "--transcript", str(transcript), "--timeout", str(board.PATIENCE_S), *options],
                                  capture_output=True, text=True, timeout=board.PATIENCE_S, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
        diary = (self.folder / "diary").read_text(encoding="utf-8").splitlines()
        self.diary = [(float(line.split(" ", 1)[0]), line.split(" ", 1)[1]) for line in diary]
        return transcript.read_text(encoding="utf-8", errors="replace")

    def test_a_clock_that_hangs_is_reset_within_the_dead_mans_time(self) -> None:
        for hz in SLOW_CLOCKS_HZ:
            with self.subTest(hz):
                self.run_column(hz, 12, [], "--event", "8:board.hang_clock=1")
                hung = next(at for at, words in self.diary if words == "fault hang_clock 1")
                resets = [at - hung for at, words in self.diary if words == "reset watchdog"]
                print(f"watchdog's clock {hz} Hz: reset {resets[0] if resets else -1:.3f} s after the clock hangs")
                self.assertEqual(len(resets), 1)
                whole_s = TIMEOUT_S * 32000 / hz
                self.assertLess(resets[0] + TURN_S, DEAD_MAN_S)
                self.assertGreater(resets[0], 0.99 * whole_s - FED_EVERY_S)
                self.assertLess(resets[0], 1.01 * whole_s)

    def test_a_chip_that_keeps_its_current_falls_by_its_clear_pin_whatever_hangs(self) -> None:
        """The heater behind an AD5422, which has no watchdog, where that of the board is slowest."""
        self.wiring = self.folder / "wiring"
        lines = [line for line in WIRING.read_text(encoding="utf-8").splitlines() if not line.startswith("Qrb")]
        self.wiring.write_text("\n".join([*lines, "Qrb ad5422 spi1 PC4 clear=PC5 lo=0 hi=1.5"]) + "\n", encoding="utf-8")
        rows = [f"0 set out2.{row}" for row in ("kind ad5422", "pin PC5", "pin2 PC4", "bus spi1", "range 4-20mA", "dead_man 2")]
        for hang in ("hang_clock", "hang_tick", "hang_main"):
            hz = SLOW_CLOCKS_HZ[0]
            with self.subTest(hang):
                log = self.folder / "log"
                self.run_column(hz, 12, ["0 begin", *rows, "0 apply"], "--event", f"{HANG_S}:board.{hang}=1", "--log", str(log), tick_s=LOOK_S)
                hung = next(at for at, words in self.diary if words == f"fault {hang} 1")
                reset = next(at for at, words in self.diary if words.startswith("reset") and at > hung)
                heat = [(float(row["time"]), float(row["Qrb.cmd"])) for row in rows_of(log)]
                self.assertAlmostEqual(dict(heat)[HANG_S - 1.0], 0.8, delta=0.01)
                gone = max(at for at, kw in heat if kw > 0.0) - HANG_S
                print(f"{hang}, watchdog's clock {hz} Hz: reset after {reset - hung:.3f} s, the heater off after {gone:.2f} s")
                self.assertLess(gone, DEAD_MAN_S)
                self.assertLess(max(kw for at, kw in heat if at >= HANG_S), 0.81)

    def test_an_erase_while_outputs_are_in_use_resets_nobody_where_the_watchdogs_clock_is_fastest(self) -> None:
        lines = [f"5 {line}" for n in range(FILLING) for line in (f"set loop1.ti {201 + n}", "save")]
        said = self.run_column(SLOW_CLOCKS_HZ[-1], 14, [*lines, "12 ?get loop1.ti", "12 ?version"])
        print(self.said)
        erases = re.search(r"storage: ok, .*erases (\d+)", said)
        self.assertIsNotNone(erases, said[-2000:])
        self.assertGreaterEqual(int(erases.group(1)), 2)  # the first one was at the start
        self.assertIn(f"loop1.ti = {200 + FILLING}", said)
        self.assertIn("watchdog 0", self.said)
        self.assertIn("software 0", self.said)
        self.assertEqual([words for _, words in self.diary if words != "reset power"], [])


if __name__ == "__main__":
    unittest.main()
