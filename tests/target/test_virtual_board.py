#!/usr/bin/python3
"""The flashed files on the virtual board, which has the whole chip: they start as on one, keep what was saved, and repeat byte for byte."""

import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from virtual_board import ROOT, Ended, VirtualBoard  # noqa: E402

from reflux import build, launch, runner, scenario  # noqa: E402

SMALL, LARGE = "stm32f100", "stm32f405"
CRYSTALS_MHZ = {SMALL: (4, 8, 12, 16, 24), LARGE: (8, 12, 16, 25)}
CHIP_MHZ = {SMALL: 24, LARGE: 168}
# The internal oscillator of the STM32F100 is off by -2.4 % to +2.5 % over temperature (DS5944), that of the STM32F405 by -8 % to +4.5 % (DS8626).
OSCILLATOR_PPM = {SMALL: (-20000, 20000), LARGE: (-20000, 20000)}
RESETS = ("software", "watchdog")


def version(image: str, *options: str) -> str:
    with VirtualBoard(image, *options) as board:
        return board.boot()


def count(statistics: str, what: str) -> int:
    found = re.search(rf"{what} (\d+)", statistics)
    assert found is not None, statistics
    return int(found.group(1))


class StartTest(unittest.TestCase):
    def test_the_images_start_as_on_a_chip(self) -> None:
        for image, core in ((SMALL, "Cortex-M3"), (LARGE, "Cortex-M4F")):
            said = version(image)
            self.assertIn(f"{image.upper()}, {core}, chip\n", said)
            self.assertIn(f"clock Hz {CHIP_MHZ[image]}000000, HSE 8 MHz, PLL\n", said)
            self.assertIn("watchdog runs, flash for storage", said)
            self.assertIn("image whole", said)
            self.assertIn("started by: power-on", said)

    def test_every_listed_crystal_is_known_with_the_oscillator_off(self) -> None:
        for image, listed in CRYSTALS_MHZ.items():
            for mhz in listed:
                for ppm in OSCILLATOR_PPM[image]:
                    with self.subTest(image=image, crystal=mhz, ppm=ppm):
                        self.assertIn(f"clock Hz {CHIP_MHZ[image]}000000, HSE {mhz} MHz, PLL\n",
                                      version(image, "--crystal", str(mhz * 1000000), "--oscillator", str(ppm)))

    def test_without_a_crystal_the_internal_oscillator_is_enough(self) -> None:
        for image in CRYSTALS_MHZ:
            for ppm in OSCILLATOR_PPM[image]:
                with self.subTest(image=image, ppm=ppm):
                    said = version(image, "--crystal", "0", "--oscillator", str(ppm))
                    self.assertRegex(said, rf"clock Hz {CHIP_MHZ[image]}000000, HSI \d+ MHz, PLL\n")

    def test_a_low_supply_is_seen(self) -> None:
        self.assertIn("supply enough for the flash", version(SMALL, "--supply", "2400"))
        self.assertIn("TOO LOW for the flash", version(SMALL, "--supply", "2200"))

    def test_the_watchdog_holds_over_the_range_of_its_clock(self) -> None:
        for image, least, most in ((SMALL, 30000, 60000), (LARGE, 17000, 47000)):
            for hz in (least, most):
                with self.subTest(image=image, hz=hz), VirtualBoard(image, "--slow-clock", str(hz), "--statistics") as board:
                    board.boot()
                    for line in ("begin", "set meas1.name T1", "apply", "save"):
                        board.do(line)
                    end = board.now_s + 10.0
                    while board.now_s < end:
                        board.step(1.0)
                    self.assertEqual(count(board.close(), "watchdog"), 0)
        with self.assertRaisesRegex(Ended, "from 30000 to 60000 Hz on the STM32F100"):
            VirtualBoard(SMALL, "--slow-clock", "61000")

    def test_an_image_that_is_too_large_is_refused(self) -> None:
        with self.assertRaisesRegex(Ended, "the STM32F100 has 131072 of flash"):
            VirtualBoard(LARGE, "--chip", "stm32f100")
        with self.assertRaisesRegex(Ended, "no chip of that name: stm32f999"):
            VirtualBoard(SMALL, "--chip", "stm32f999")


class CoreTest(unittest.TestCase):
    def test_start_up_sets_the_core(self) -> None:
        for image in (LARGE, SMALL):
            with self.subTest(image=image):
                subprocess.run([build.find_program("host", "board-self-checks"), build.find_image(image), "core"], check=True)

    def test_barriers_stand_where_the_manuals_want_them(self) -> None:
        """The exact mode checks them (host_sim/virtual_board/barrier_rules.h): in start-up, in sleep, when settings are saved and read, in a reset."""
        for image in (LARGE, SMALL):
            with self.subTest(image=image), VirtualBoard(image, "--exact") as board:
                board.boot()
                board.do("save")
                board.text = ""
                board.step(console=b"reboot\r")
                board.boot()
                board.do("save")


class SameRunTest(unittest.TestCase):
    def run_smoke(self, image: str, folder: Path, *options: str) -> dict[str, bytes | int]:
        """Log, transcript and telemetry of the scenario, what the memory holds at the end, and the instructions that the board has run."""
        wanted = scenario.load(ROOT / "host_sim" / "scenarios" / "smoke.toml")
        folder.mkdir()
        runner.write_script(wanted, folder / "script.txt")
        memory = folder / "memory"  # has the bytes of the last frames, too
        with launch.start(f"board-{image}", extra=("--statistics", "--memory", str(memory), *options)) as firmware:
            subprocess.run(runner.simulator_command(wanted, firmware, folder), check=True, stdout=subprocess.DEVNULL)
            assert firmware.process is not None and firmware.messages is not None
            self.assertEqual(firmware.process.wait(timeout=60), 0)
            statistics = firmware.messages.read_text()
        found = re.search(r"(\d+) instructions", statistics)
        assert found is not None, statistics
        print(f"{image} {' '.join(options)}: {statistics.strip()}")
        for kind in RESETS:
            self.assertEqual(count(statistics, kind), 0, statistics)
        out: dict[str, bytes | int] = {name: (folder / name).read_bytes() for name in ("simulator.csv", "transcript.txt", "telemetry.csv", "memory")}
        self.assertTrue(all(out.values()))
        return {**out, "instructions": int(found.group(1))}

    def test_a_run_repeats_byte_for_byte_and_by_single_instructions(self) -> None:
        for image in (SMALL, LARGE):
            with self.subTest(image=image), tempfile.TemporaryDirectory(prefix="reflux-") as name:
                first, again, exact = (self.run_smoke(image, Path(name) / str(k), *options)
                                       for k, options in enumerate(((), (), ("--exact",))))
                self.assertEqual(first, again)
                self.assertEqual(first, exact)

    def test_memory_at_power_on_is_of_the_seed(self) -> None:
        boots = [re.search(r"boot (\d+)", version(SMALL, "--seed", seed)) for seed in ("1", "1", "2")]
        one, same, other = (found.group(1) for found in boots if found is not None)
        self.assertEqual(one, same)
        self.assertNotEqual(one, other)


class StorageTest(unittest.TestCase):
    def save(self, board: VirtualBoard, low: int) -> None:
        for line in ("begin", "set meas1.name T1", f"set meas1.lo {low}", "apply"):
            board.do(line)
        board.do("save")

    def stored(self, board: VirtualBoard) -> str:
        """After a start: what the stored set has, once it has been taken over."""
        for _ in range(10):
            said = board.do("version")
            if "storage: ok" in said:
                return board.do("get meas1.lo")
            self.assertIn("storage: unread", said)
            board.step(1.0)
        raise AssertionError("the stored set was not read")

    def reboot(self, board: VirtualBoard) -> None:
        board.do("reboot")  # its `ok` leaves whole
        self.assertIn("started by: requested", board.boot())

    def test_a_saved_set_comes_back_after_a_reboot(self) -> None:
        for image in (SMALL, LARGE):
            with self.subTest(image=image), VirtualBoard(image, "--statistics") as board:
                board.boot()
                self.save(board, 70)
                self.reboot(board)
                self.assertIn("meas1.lo = 70 ", self.stored(board))
                self.save(board, 71)
                self.reboot(board)
                self.assertIn("meas1.lo = 71 ", self.stored(board))


if __name__ == "__main__":
    unittest.main()
