"""Programs that are the same machine code run once; those that are not run twice."""

import subprocess
import unittest
from pathlib import Path

from support import FolderTest

from reflux import machine_code
from reflux.errors import RunFailed
from reflux.paths import build_dir
from dev.testing.ctest_files import Entry
from dev.testing.entries import SANITIZED
from dev.testing.run_once import same_code

SOURCE = "static const char text[] = \"{text}\";\nint main(int n, char **v) {{ (void)v; return n - {value} + text[0]; }}\n"


class MachineCode(FolderTest):
    def program(self, name: str, *options: str, text: str = "a", value: int = 1) -> Path:
        source, made = self.folder / "main.c", self.folder / name
        source.write_text(SOURCE.format(text=text, value=value))
        subprocess.run(["gcc", *options, str(source), "-o", str(made)], check=True)
        return made

    def test_debugging_information_makes_no_difference(self) -> None:
        self.assertTrue(machine_code.same(self.program("a"), self.program("b", "-g")))

    def test_another_constant_is_another_program(self) -> None:
        self.assertFalse(machine_code.same(self.program("a"), self.program("b", value=2)))

    def test_another_text_is_another_program(self) -> None:
        self.assertFalse(machine_code.same(self.program("a"), self.program("b", text="b")))

    def test_a_script_is_no_program_and_is_not_compared(self) -> None:
        script = self.folder / "script"
        script.write_text("#!/bin/sh\n")
        self.assertFalse(machine_code.is_program(script))
        with self.assertRaises(RunFailed):
            machine_code.loaded(script)

    def test_other_arguments_are_another_test(self) -> None:
        def entry(*command: str) -> Entry:
            return Entry("x", command, self.folder)

        folders = [build_dir(preset) for preset in SANITIZED]
        left = entry(str(folders[0] / "no-such-program"), "1")
        self.assertFalse(same_code(left, entry(str(folders[1] / "no-such-program"), "1")))
        self.assertFalse(same_code(entry("/bin/true", "1"), entry("/bin/true", "2")))
        self.assertTrue(same_code(entry("/bin/true", "1"), entry("/bin/true", "1")))


if __name__ == "__main__":
    unittest.main()
