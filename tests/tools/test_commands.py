"""Every command of README and docs/ runs as printed, but those of commands.toml, each with its reason.

A command stands in an indented block: a shell command, or behind `> ` a line of the board's console. What stands below
`$ command`, or below a console line, is what it must print. Commands of a page run one after the other in the root of
the repository; figures go to a folder of the test, and so does what the page puts into /tmp.
"""

import os
import re
import signal
import subprocess
import time
import tomllib
import unittest
from dataclasses import dataclass, field
from pathlib import Path

from support import ROOT, FolderTest

from reflux_tools import build
from reflux_tools.ports import Port
from reflux_tools.session import Session

PROGRAM = re.compile(r"(\$ )?((tools|build|tests)/|cd tests |cmake |ctest |python3 |qemu-|st-flash|openocd|dfu-util|picocom|"
                     r"reflux-|git |sudo |apt)")
CONSOLE = "> "
GENERATED = ("evidence.md",)  # tools/evidence runs what stands there and writes what it printed
HANGS_S = 1200.0


@dataclass
class Command:
    page: str
    number: int
    line: str  # without prompt and comment
    printed: list[str] | None = None  # what the page says it prints
    console: bool = False

    def place(self) -> str:
        return f"{self.page}:{self.number}: {self.line}"


@dataclass
class Exempt:
    page: str
    line: str
    why: str
    instead: str


@dataclass
class Page:
    name: str
    commands: list[Command] = field(default_factory=list)


def pages() -> list[Page]:
    files = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    return [read(f) for f in files if f.name not in GENERATED]


def read(path: Path) -> Page:
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


def exempt() -> list[Exempt]:
    with (Path(__file__).parent / "commands.toml").open("rb") as f:
        return [Exempt(**row) for row in tomllib.load(f)["command"]]


class Commands(FolderTest):
    @classmethod
    def setUpClass(cls) -> None:
        build.build("host", ("reflux-sim", "reflux-host", "reflux-sim-memory", "reflux-plant", "libreflux"), quiet=True)
        cls.pages = pages()
        cls.exempt = exempt()

    def is_exempt(self, command: Command) -> bool:
        return any((e.page, e.line) == (command.page, command.line) for e in self.exempt)

    def environment(self) -> dict[str, str]:
        figures = self.folder / "figures"
        figures.mkdir(exist_ok=True)
        return {**os.environ, "REFLUX_FIGURES": str(figures), "MPLBACKEND": "Agg"}

    def needed(self, line: str) -> None:
        """Builds the test programs that a line names."""
        for preset, name in re.findall(r"build/([\w-]+)/tests/\w+/(\w+)", line):
            build.build(preset, (name,), quiet=True)

    def moved(self, line: str) -> str:
        """The page's /tmp is the folder of this test: two of them may run on one machine."""
        return line.replace("/tmp/", f"{self.folder}/")

    def shell(self, line: str) -> subprocess.CompletedProcess:
        return subprocess.run(["bash", "-c", self.moved(line)], cwd=ROOT, env=self.environment(), stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, errors="replace", timeout=HANGS_S, check=False)

    def test_what_is_exempt_stands_on_its_page_and_says_why(self) -> None:
        for e in self.exempt:
            with self.subTest(e.page, line=e.line):
                page = next(p for p in self.pages if p.name == e.page)
                self.assertTrue(any(c.line == e.line for c in page.commands), f"{e.page} has no {e.line!r}")
                self.assertTrue(e.why and e.instead)

    def test_what_stands_in_for_it_runs(self) -> None:
        build.build("stm32f405", quiet=True)
        build.build("stm32f100", quiet=True)
        if not (ROOT / "out" / "demo").is_dir():
            self.assertEqual(self.shell("tools/run demo --firmware host --out out/demo").returncode, 0)
        for line in sorted({e.instead for e in self.exempt}):
            with self.subTest(line):
                self.needed(line)
                answer = self.shell(line)
                self.assertEqual(answer.returncode, 0, answer.stdout[-2000:] + answer.stderr[-2000:])

    def test_every_other_shell_command_runs_and_prints_what_the_page_says(self) -> None:
        for page in self.pages:
            for command in page.commands:
                if command.console or self.is_exempt(command) or command.line.endswith("&"):
                    continue
                with self.subTest(command.place()):
                    self.needed(command.line)
                    answer = self.shell(command.line)
                    self.assertEqual(answer.returncode, 0, answer.stdout[-2000:] + answer.stderr[-2000:])
                    if command.printed is not None:
                        self.assertEqual(answer.stdout.strip().splitlines(), [x for x in command.printed if x])

    def test_the_console_of_the_readme_answers_what_pages_say(self) -> None:
        """The host build and the pilot column as the README starts them, with the configuration it pastes."""
        processes = []
        try:
            for command in self.page("README.md").commands:
                if command.line.endswith("&"):
                    processes.append(subprocess.Popen(["bash", "-c", "exec " + self.moved(command.line[:-1])], cwd=ROOT,
                                                      stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                                      stderr=subprocess.STDOUT))
                    self.wait_for(self.folder / "reflux-link", processes[0])
            session = Session(Port(str(self.folder / "reflux-console")))
            text = (ROOT / "host_sim" / "scenarios" / "pilot.conf").read_text(encoding="utf-8")
            for line in [x for x in text.splitlines() if x and not x.startswith("#")]:
                self.assertEqual(self.ask(session, line)[-1], "ok", line)
            for line in ("mode bottom auto", "sp bottom 112.5", "log on", "log off", "save"):
                self.assertIn(line.replace("off", "on"), README)
                self.until_ok(session, line)
            while "state run" not in self.ask(session, "status")[0]:  # what was asked for meets the next sample
                time.sleep(0.1)
            for page in self.pages:
                for command in page.commands:
                    if command.console and not self.is_exempt(command):
                        with self.subTest(command.place()):
                            said = self.ask(session, command.line.removeprefix(CONSOLE))
                            expected = [x for x in command.printed or [] if x and not x.startswith("! ")]
                            if expected:
                                self.assertEqual(said, expected)
                            else:
                                self.assertEqual(said[-1], "ok")
            for process in processes:
                self.assertIsNone(process.poll(), "the README's processes go on")
            self.assertGreater(len((self.folder / "reflux-flash.bin").read_bytes()), 0)  # what `save` was kept in
        finally:
            for process in processes:
                process.send_signal(signal.SIGTERM)
                process.communicate()

    def page(self, name: str) -> Page:
        return next(p for p in self.pages if p.name == name)

    def wait_for(self, path: Path, process: subprocess.Popen) -> None:
        while not path.exists():
            if process.poll() is not None:
                self.fail(f"it ended: {process.communicate()[0].decode(errors='replace')}")
            time.sleep(0.05)

    @staticmethod
    def ask(session: Session, line: str) -> list[str]:
        """All lines of the reply; what the board says by itself is left out."""
        session.write(line)
        said = []
        while True:
            text = session.line(HANGS_S)
            if text.startswith(("T,", "H,", "! ")):
                continue
            said.append(text)
            if text == "ok" or text.startswith("err "):
                return said

    def until_ok(self, session: Session, line: str) -> None:
        """The first samples may still be under way."""
        for _ in range(600):
            if (said := self.ask(session, line))[-1] == "ok":
                return
            time.sleep(0.1)
        self.fail(f"{line}: {said[-1]}")


README = (ROOT / "README.md").read_text(encoding="utf-8")

if __name__ == "__main__":
    unittest.main()
