"""Each Python block of docs/ runs as printed, in a process of its own, and prints the text block that stands below it. A port on the page is the
host build here.
With the argument `all` (full tier) also with pandas from PyPI, whose columns count differently from arrays.
"""

import importlib.util
import os
import re
import subprocess
import sys
import unittest

from support import ROOT, FolderTest, from_pypi

from reflux import build, launch
from reflux.environment import clean
from reflux.paths import every

sys.path.append(str(ROOT / "tests" / "support"))
import sample  # noqa: E402

# Those of docs/start need what the commands between them have written: test_tutorial.py runs them.
PAGES = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in every(ROOT / "docs", "*/*.md") if path.parent.name != "start"}
PORT = "/dev/ttyUSB0"
BLOCK = re.compile(r"^```python\n(.*?)^```\n(?:\n```text\n(.*?)^```\n)?", re.M | re.S)


def setUpModule() -> None:
    build.build("host", ("reflux-sim", "reflux-host", "libreflux", "libreflux_lab"), quiet=True)


class Blocks(FolderTest):
    python = sys.executable

    def run_block(self, block: str) -> str:
        environment = {**clean(os.environ), "PYTHONPATH": str(ROOT / "tools")}
        said = subprocess.run([self.python, "-W", "error::SyntaxWarning", "-c", block], cwd=self.folder, env=environment, capture_output=True, text=True,
                              check=False)
        self.assertEqual(said.returncode, 0, f"{block}\n{said.stderr}")
        return said.stdout

    def test_the_pages_have_blocks(self) -> None:
        self.assertGreaterEqual(len(BLOCK.findall(PAGES["docs/use/python.md"])), 6)
        self.assertTrue(any(printed for text in PAGES.values() for _, printed in BLOCK.findall(text)))

    def test_every_block_runs_and_prints_what_the_page_says(self) -> None:
        self.run_blocks(with_gymnasium=bool(importlib.util.find_spec("gymnasium")))

    @unittest.skipUnless(sample.EVERY, "with pandas in the full tier: test_python_page.py all")
    def test_every_block_runs_with_pandas(self) -> None:
        self.python = from_pypi(self.folder, "gymnasium")
        self.run_blocks(with_gymnasium=True)

    def run_blocks(self, with_gymnasium: bool) -> None:
        for page, block, printed in ((page, *found) for page, text in PAGES.items() for found in BLOCK.findall(text)):
            with self.subTest(page, block=block.splitlines()[0]):
                if "ColumnEnv" in block and not with_gymnasium:
                    self.skipTest("gymnasium is not installed; pip install gymnasium")
                if PORT in block:
                    with launch.start("host") as firmware, launch.plant(firmware, "pilot", "--speed", "600", "--tick", "30", "--timeout", "3600"):
                        self.run_block(block.replace(PORT, firmware.console))
                    continue
                said = self.run_block(block)
                if printed:
                    self.assertEqual(said, printed)

    def test_the_first_block_leaves_its_picture(self) -> None:
        self.run_block(BLOCK.findall(PAGES["docs/use/python.md"])[0][0])
        self.assertTrue((self.folder / "first.png").read_bytes().startswith(b"\x89PNG"))


if __name__ == "__main__":
    unittest.main()
