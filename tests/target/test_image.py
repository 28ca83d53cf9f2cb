#!/usr/bin/python3
"""Rules for the linked image: the rules of tools/image, and one file for emulator and flash.

By default on the images that the default tier of tools/test builds, with the argument `all` on every image.
"""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests" / "support")]
sys.dont_write_bytecode = True

import sample  # noqa: E402
from dev import elf_image, image_check  # noqa: E402
from reflux import build  # noqa: E402
from reflux.boards import BUILT_BY_DEFAULT  # noqa: E402
from reflux.paths import build_dir  # noqa: E402

PRESETS = image_check.presets() if sample.EVERY else BUILT_BY_DEFAULT


class ImageTest(unittest.TestCase):
    reports: dict[str, image_check.Report]

    @classmethod
    def setUpClass(cls) -> None:
        cls.reports = {preset: image_check.check(build_dir(preset)) for preset in PRESETS}
        for preset, r in cls.reports.items():
            print(f"image {preset}: flash {r.flash()}, RAM owned for ever {r.ram()} without stack, {r.ram() - r.arena} "
                  f"without arena; workspace {r.workspace()}")
            print(f"stack {preset}: {r.stack_needed} of {r.stack_reserved} bytes in the worst case")
            print(f"calls {preset}: {r.functions} functions, {r.pointer_calls} calls through pointers")

    def expect_none(self, kind: str) -> None:
        found = [f"{preset}: {line}" for preset, report in self.reports.items()
                 for line in report.findings if line.startswith(kind)]
        self.assertEqual(found, [], "\n" + "\n".join(found))

    def test_nothing_forbidden_is_linked(self) -> None:
        for report in self.reports.values():
            self.assertIn("app_tick", report.image.symbols)
        for what in image_check.FORBIDDEN:
            self.expect_none(what)

    def test_nothing_calls_itself_and_every_call_through_a_pointer_is_listed(self) -> None:
        self.expect_none("recursion")
        self.expect_none("pointer")
        if sample.EVERY:  # a line may be there for one image alone
            self.assertEqual(image_check.unused_lines(list(self.reports.values())), [])

    def test_the_stack_is_enough_with_all_interrupts_on_top(self) -> None:
        self.expect_none("stack")
        for report in self.reports.values():
            buses = "interrupt_spi1" in report.image.symbols
            self.assertEqual(len(report.contexts), 6 if buses else 5)
            self.assertGreater(report.frames_agree, 150, "frames confirmed by the compiler's own figures")

    def test_main_loop_and_tick_stay_on_their_sides_of_the_wall(self) -> None:
        self.expect_none("contexts")

    def test_each_layer_keeps_its_budget(self) -> None:
        self.expect_none("budget")

    def test_the_column_model_links_without_double_precision(self) -> None:
        """Nothing of the image needs the model yet: all of it is linked here, with the image's own flags."""
        folder = build_dir("stm32f405")
        layers = {name: folder / "firmware" / name / f"libreflux_{name}.a" for name in ("model", "num", "base")}
        with tempfile.TemporaryDirectory() as place:
            elf = Path(place) / "model.elf"
            subprocess.run(["arm-none-eabi-gcc", "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16",
                            "--specs=picolibc.specs", "-nostartfiles", "-Wl,--entry=column_rates", "-Wl,--no-gc-sections",
                            "-Wl,--whole-archive", str(layers["model"]), "-Wl,--no-whole-archive", str(layers["num"]), str(layers["base"]),
                            "-o", str(elf)], check=True)
            image = elf_image.Image(elf)
        for name in ("column_rates", "column_jacobian", "float_exp", "float_log", "float_pow"):
            self.assertIn(name, image.symbols)
        self.assertEqual(image_check.forbidden(image), [])

    def test_the_flashed_file_is_the_linked_image_byte_for_byte(self) -> None:
        for preset, report in self.reports.items():
            flashed = report.image.path.with_suffix(".bin")
            with tempfile.TemporaryDirectory() as folder:
                again = Path(folder) / "again.bin"
                subprocess.run(["arm-none-eabi-objcopy", "-O", "binary", str(report.image.path), str(again)],
                               check=True)
                self.assertEqual(again.read_bytes(), flashed.read_bytes())
            self.assertEqual(build.find_image(preset), flashed)  # what the emulator is given


if __name__ == "__main__":
    unittest.main()
