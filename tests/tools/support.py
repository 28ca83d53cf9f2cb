"""Shared by the tests of the tools: where the tools are, and small files to feed them."""

import contextlib
import io
import os
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True

from reflux.environment import clean  # noqa: E402

for name in os.environ.keys() - clean(os.environ).keys():
    del os.environ[name]
os.environ.update(clean(os.environ))

GOOD = """
name = "trial"
plant = "pilot"
duration_s = 600
"""


class FolderTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def file(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path


def from_pypi(folder: Path, *packages: str) -> str:
    """The Python of a virtual environment with what reflux depends on, pandas, and these packages. Skips the test where there can be none."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    place = folder / "environment"
    made = subprocess.run([sys.executable, "-m", "venv", str(place)], capture_output=True, text=True, check=False)
    if made.returncode != 0:
        raise unittest.SkipTest(f"{sys.executable} makes no virtual environment; Debian's package is python3-venv")
    install = [str(place / "bin" / "python"), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    first = subprocess.run([*install, "numpy"], capture_output=True, text=True, check=False)
    if first.returncode != 0:
        raise unittest.SkipTest(f"PyPI cannot be reached: {first.stderr.strip()}")
    rest = subprocess.run([*install, *project["dependencies"], *project["optional-dependencies"]["pandas"], *packages], capture_output=True, text=True, check=False)
    if rest.returncode != 0:
        raise AssertionError(rest.stderr)
    return str(place / "bin" / "python")


def call(name: str, *arguments: str) -> tuple[int, str, str]:
    """A command as a person would start it: exit status, stdout, stderr."""
    from reflux.__main__ import call as command
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            status = command(name, list(arguments))
        except SystemExit as stop:
            status = int(stop.code or 0)
    return status, out.getvalue(), err.getvalue()


# Channels and two loops of Kotyk and Machacek's column, as a decoupler finds them on a board.
KOTYK_BOARD = ["set tick.base 60", "set meas1.name y1", "set meas1.lo -2", "set meas1.hi 2", "set meas2.name y2", "set meas2.lo -3", "set meas2.hi 3",
               "set mv1.name u1", "set mv1.lo -5", "set mv1.hi 5", "set mv1.min -5", "set mv1.max 5", "set mv2.name u2", "set mv2.lo -5", "set mv2.hi 5",
               "set mv2.min -5", "set mv2.max 5", "set loop1.name y1", "set loop1.pv y1", "set loop1.out u1", "set loop2.name y2", "set loop2.pv y2",
               "set loop2.out u2", "set loop2.action direct"]


@contextlib.contextmanager
def board(program: str, lines: list[str] | None = None, key: str | None = None):
    """A firmware on a pseudo-terminal, configured by `lines` (default: KOTYK_BOARD), with a key where one is given: the name of its console."""
    from reflux import board_settings, launch
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        place = Path(folder)
        console = place / "console"
        command = [program, "--console", f"pty:{console}", "--link", f"socket:{place / 'link'}", "--nvm", str(place / "nvm")]
        firmware = launch.spawn("host", command, place, Path(program))
        try:
            launch.await_paths(firmware, [console, place / "link"])
            wanted = KOTYK_BOARD if lines is None else lines
            if wanted:
                board_settings.write_settings(str(console), wanted)
            if key:
                board_settings.write_settings(str(console), [f"set console.key {key}"])
                told(str(console), "lock")
            yield str(console)
        finally:
            launch.end(firmware.process)


def told(console: str, command: str) -> list[str]:
    """The reply of a board to one command."""
    from reflux.ports import Port
    from reflux.session import Session
    with contextlib.closing(Port(console)) as port:
        return Session(port).ask(command)
