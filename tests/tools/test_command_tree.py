"""The command reflux: every tool of tools/ in one tree of help."""

import subprocess
import sys
import unittest

from support import ROOT

from reflux import __main__ as entry


class Command(unittest.TestCase):
    def run_it(self, *arguments: str) -> subprocess.CompletedProcess:
        return subprocess.run([sys.executable, "-m", "reflux", *arguments], env={"PYTHONPATH": str(ROOT / "tools")}, capture_output=True, text=True,
                              check=False)

    def test_help_has_every_command_and_no_other(self) -> None:
        self.assertEqual(list(entry.WORDS), list(entry.COMMANDS))
        said = self.run_it("--help")
        self.assertEqual((said.returncode, said.stderr), (0, ""))
        for name in entry.COMMANDS:
            self.assertRegex(said.stdout, rf"(?m)^  {name} ")

    def test_each_tool_of_the_folder_is_a_command(self) -> None:
        tools = {path.name for path in (ROOT / "tools").iterdir() if path.is_file() and "run_tool" in path.read_text(encoding="utf-8")}
        self.assertEqual(tools - {"launcher.sh"}, set(entry.COMMANDS))

    def test_a_command_does_what_the_tool_does(self) -> None:
        tool = subprocess.run([str(ROOT / "tools" / "run"), "--help"], capture_output=True, text=True, check=True)
        self.assertEqual(self.run_it("run", "--help").stdout, tool.stdout)

    def test_an_unknown_command_is_a_usage_error(self) -> None:
        said = self.run_it("rum")
        self.assertEqual(said.returncode, 2)
        self.assertIn("there is no command rum", said.stderr)


if __name__ == "__main__":
    unittest.main()
