"""Each Python block of docs/use/python.md and of the methods runs as printed, in a folder and a process of its own. A port on the page is the
host build here."""

import importlib.util
import os
import re
import subprocess
import sys
import unittest

from support import ROOT, FolderTest

from reflux import build, launch
from reflux.environment import clean
from reflux.paths import every

PAGE = every(ROOT / "docs", "**/python.md")[0]
PORT = "/dev/ttyUSB0"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.M | re.S)


def setUpModule() -> None:
    build.build("host", ("reflux-sim", "reflux-host", "libreflux", "libreflux_lab"), quiet=True)


class Blocks(FolderTest):
    def run_block(self, block: str) -> None:
        environment = {**clean(os.environ), "PYTHONPATH": str(ROOT / "tools")}
        said = subprocess.run([sys.executable, "-W", "error::SyntaxWarning", "-c", block], cwd=self.folder, env=environment, capture_output=True, text=True,
                              check=False)
        self.assertEqual(said.returncode, 0, f"{block}\n{said.stderr}")

    def test_every_block_runs_as_printed(self) -> None:
        blocks = BLOCK.findall(PAGE.read_text(encoding="utf-8"))
        self.assertGreaterEqual(len(blocks), 6)
        for block in blocks:
            with self.subTest(block.splitlines()[0]):
                if "ColumnEnv" in block and not importlib.util.find_spec("gymnasium"):
                    self.skipTest("gymnasium is not installed; pip install gymnasium")
                if PORT in block:
                    with launch.start("host") as firmware, launch.plant(firmware, "pilot", "--speed", "600", "--tick", "30", "--timeout", "3600"):
                        self.run_block(block.replace(PORT, firmware.console))
                else:
                    self.run_block(block)

    def test_every_block_of_the_methods_runs_as_printed(self) -> None:
        blocks = [block for page in every(ROOT / "docs" / "methods", "*.md") for block in BLOCK.findall(page.read_text(encoding="utf-8"))]
        self.assertTrue(blocks)
        for block in blocks:
            with self.subTest(block.splitlines()[1]):
                self.run_block(block)

    def test_the_first_block_leaves_its_picture(self) -> None:
        self.run_block(BLOCK.findall(PAGE.read_text(encoding="utf-8"))[0])
        self.assertTrue((self.folder / "first.png").read_bytes().startswith(b"\x89PNG"))


if __name__ == "__main__":
    unittest.main()
