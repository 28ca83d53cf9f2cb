"""The commands that README, CONTRIBUTING and docs/ print, and the rows of commands.toml about them.

A command stands in an indented block: a shell command, or behind `> ` a line of the board's console. What stands below
`$ command`, or below a console line, is what it must print.
"""

import re
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from support import ROOT

from reflux.paths import every

PROGRAM = re.compile(r"(\$ )?((tools|build|tests)/|cd tests |cmake |ctest |python3 |qemu-|st-flash|openocd|dfu-util|picocom|"
                     r"reflux-|git |grep |sudo |apt|PYTHONPATH=)")
CONSOLE = "> "
GENERATED = ("evidence.md",)  # tools/evidence runs what stands there and writes what it printed
IN_ORDER = ("docs/start/tutorial.md",)  # test_tutorial.py runs it, because each block needs those above it
ROWS = Path(__file__).parent / "commands.toml"


@dataclass
class Command:
    """One command of a page."""

    page: str
    number: int
    line: str  # without prompt and comment
    printed: list[str] | None = None  # what the page says it prints
    console: bool = False

    def place(self) -> str:
        """Page, line and text of the command, for a person."""
        return f"{self.page}:{self.number}: {self.line}"

    @property
    def background(self) -> bool:
        """True if it runs beside the commands after it."""
        return self.line.endswith("&")


@dataclass
class Exempt:
    """A command that the test does not run as printed, and the line that it runs instead."""

    page: str
    line: str
    why: str
    instead: str


@dataclass
class Slow:
    """A command that takes 10 s of processor time or more, or one that reads the results of such a command (after)."""

    page: str
    line: str
    seconds: float
    after: str = ""


@dataclass
class Page:
    """A page and its commands, from top to bottom."""

    name: str
    commands: list[Command] = field(default_factory=list)


def pages() -> list[Page]:
    """Every page that has a command and whose commands need none of another block."""
    files = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *every(ROOT / "docs", "**/*.md")]
    return [page for page in (read(f) for f in files if f.name not in GENERATED) if page.commands and page.name not in IN_ORDER]


def read(path: Path) -> Page:
    """The commands of one file."""
    page = Page(path.relative_to(ROOT).as_posix())
    for first, block in blocks(path.read_text(encoding="utf-8").splitlines()):
        expected: list[str] | None = None
        whole, begun = "", first
        for offset, text in enumerate(block):
            number = first + offset
            if whole or PROGRAM.match(text):
                begun = begun if whole else number
                whole += text.removesuffix("\\") if text.endswith("\\") else text
                if text.endswith("\\"):
                    continue
                expected = [] if whole.startswith("$ ") else None
                line = re.split(r"\s+#\s|\s{4,}\(", whole.removeprefix("$ "))[0].strip()
                page.commands.append(Command(page.name, begun, " ".join(line.split()), expected))
                whole = ""
            elif text.startswith(CONSOLE):
                expected = []
                line = re.split(r"\s{4,}", text.removeprefix(CONSOLE))[0].strip()
                page.commands.append(Command(page.name, number, CONSOLE + line, expected, True))
            elif expected is not None:
                expected.append(text)
    return page


def blocks(lines: list[str]) -> list[tuple[int, list[str]]]:
    """First line number and lines of each indented block, the indent taken off."""
    out: list[tuple[int, list[str]]] = []
    current: list[str] | None = None
    before = ""
    for number, text in enumerate(lines, 1):
        if text.startswith("    ") and (current is not None or not before.strip()):
            if current is None:
                current = []
                out.append((number, current))
            current.append(text[4:])
        elif text.strip() or current is None:
            current = None
        else:
            current.append("")
        before = text
    return out


def rows() -> tuple[list[Exempt], list[Slow]]:
    """Rows of commands.toml about single commands."""
    with ROWS.open("rb") as f:
        document = tomllib.load(f)
    return [Exempt(**row) for row in document["command"]], [Slow(**row) for row in document.get("slow", [])]
