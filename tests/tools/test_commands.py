"""Every command of README and docs/ runs as printed, but those of commands.toml, each with its reason.

usage: test_commands.py [--quick] [--list] [--times] [PAGE ...]     (default: every page)

Commands of a page run one after the other in the root of the repository. Figures, results (out/) and what the page puts
into /tmp go to a folder of the test, so pages can run at the same time. Each page with console lines has a board of its own.
--quick leaves out the commands that commands.toml calls slow. --list prints the pages. --times prints the processor
seconds of each command, for the slow rows of commands.toml.
"""

import argparse
import contextlib
import os
import re
import resource
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

from pages import CONSOLE, IN_ORDER, Command, Page, pages, rows
from support import ROOT, FolderTest

from reflux import build
from reflux.ports import Port
from reflux.session import Session

HANGS_S = 1200.0
SLOW_S = 10.0
MOVED = {"/tmp/": "", "out/": "out/", "docs/figures/": "figures/"}  # folders of a page, and where they are in the test's
FOLDER = re.compile(rf"(?<![\w./-])({'|'.join(map(re.escape, MOVED))})")
TREES = re.compile(r"--preset[ =]([\w-]+)|--build build/([\w-]+)")
PAGES = {page.name: page for page in pages()}
EXEMPT, SLOW = rows()
HOST_BOARD = "docs/start/hardware.md"  # the page that starts the host build as a board
FIRST_STEPS = (ROOT / HOST_BOARD).read_text(encoding="utf-8")


class Rows(unittest.TestCase):
    """The rows of commands.toml that no page would miss."""

    def test_each_row_is_about_a_page_that_has_commands(self) -> None:
        for row in [*EXEMPT, *SLOW]:
            with self.subTest(row.page, line=row.line):
                self.assertIn(row.page, [*PAGES, *IN_ORDER])

    def test_no_two_pages_with_commands_have_one_name(self) -> None:
        """tools/test calls the test of a page by the name of its file, without the folder."""
        names = [Path(page).stem for page in PAGES]
        self.assertEqual(sorted(names), sorted(set(names)))


class Commands(FolderTest):
    """The commands of one page."""

    quick = False
    times = False

    def __init__(self, method: str, page: Page):
        super().__init__(method)
        self.page = page
        self.exempt = {e.line: e for e in EXEMPT if e.page == page.name}
        self.slow = {s.line: s for s in SLOW if s.page == page.name}

    def __str__(self) -> str:
        return f"{self._testMethodName} ({self.page.name})"

    def setUp(self) -> None:
        super().setUp()
        build.build("host", ("reflux-sim", "reflux-host", "reflux-sim-memory", "reflux-plant", "libreflux", "libreflux_board", "libreflux_lab"), quiet=True)
        (self.folder / "figures").mkdir()
        self.environment = {**os.environ, "REFLUX_FIGURES": str(self.folder / "figures"), "REFLUX_OUT": str(self.folder / "out")}

    def needed(self, line: str) -> None:
        """Builds the images and test programs that a line names."""
        for preset, name in re.findall(r"build/([\w-]+)/tests/\w+/(\w+)", line):
            build.build(preset, (name,), quiet=True)
        for preset in re.findall(r"build/(stm32[\w-]+)/", line):
            build.build(preset, quiet=True)

    def moved(self, line: str) -> str:
        """The line with the folders of this test in place of the reader's."""
        return FOLDER.sub(lambda match: f"{self.folder}/{MOVED[match[1]]}", line)

    def as_printed(self, text: str) -> list[str]:
        """Output of a command, with the reader's folder of results in place of the test's."""
        out = self.folder.resolve() / "out"
        return text.replace(f"{out}/", "out/").replace(f"{os.path.relpath(out, ROOT)}/", "out/").strip().splitlines()

    def shell(self, line: str) -> subprocess.CompletedProcess:
        """Runs a line. Where it starts cmake itself, this process holds the locks of the build trees."""
        self.needed(line)
        with contextlib.ExitStack() as stack:
            if line.startswith("cmake "):
                for tree in sorted({first or second for first, second in TREES.findall(line)}):
                    stack.enter_context(build.locked(ROOT / "build" / tree, quiet=True))
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            answer = subprocess.run(["bash", "-c", self.moved(line)], cwd=ROOT, env=self.environment, stdin=subprocess.DEVNULL,
                                    capture_output=True, text=True, errors="replace", timeout=HANGS_S, check=False)
        if self.times:
            now = resource.getrusage(resource.RUSAGE_CHILDREN)
            print(f"{now.ru_utime - before.ru_utime + now.ru_stime - before.ru_stime:8.1f} s  {self.page.name}: {line}", flush=True)
        return answer

    def test_the_page_has_the_commands_of_its_rows_and_each_row_says_why(self) -> None:
        lines = {command.line for command in self.page.commands}
        for line, row in self.exempt.items():
            with self.subTest(line):
                self.assertIn(line, lines)
                self.assertTrue(row.why and row.instead)
        for line, slow in self.slow.items():
            with self.subTest(line):
                self.assertIn(line, lines - self.exempt.keys())
                self.assertTrue(slow.seconds >= SLOW_S or slow.after in self.slow)

    def test_what_stands_in_for_an_exempt_command_runs(self) -> None:
        for line in dict.fromkeys(e.instead for e in self.exempt.values()):
            with self.subTest(line):
                answer = self.shell(line)
                self.assertEqual(answer.returncode, 0, answer.stdout[-2000:] + answer.stderr[-2000:])

    def test_every_other_shell_command_runs_and_prints_what_the_page_says(self) -> None:
        for command in self.page.commands:
            if command.console or command.background or command.line in self.exempt:
                continue
            if self.quick and command.line in self.slow:
                continue
            with self.subTest(command.place()):
                answer = self.shell(command.line)
                self.assertEqual(answer.returncode, 0, answer.stdout[-2000:] + answer.stderr[-2000:])
                if command.printed is not None:
                    self.assertEqual(self.as_printed(answer.stdout), [x for x in command.printed if x])

    def test_the_console_answers_what_the_page_says(self) -> None:
        """The host build and the pilot column as hardware.md starts them, with the configuration it pastes."""
        lines = [c for c in self.page.commands if c.console and c.line not in self.exempt]
        if not lines and self.page.name != HOST_BOARD:
            return
        with self.board() as session:
            for command in lines:
                with self.subTest(command.place()):
                    said = self.ask(session, command.line.removeprefix(CONSOLE))
                    expected = [x for x in command.printed or [] if x and not x.startswith("! ")]
                    if expected:
                        self.assertEqual(said, expected)
                    else:
                        self.assertEqual(said[-1], "ok")
        self.assertGreater(len((self.folder / "reflux-flash.bin").read_bytes()), 0)  # what `save` was kept in

    @contextlib.contextmanager
    def board(self):
        """A board that does what hardware.md says, until its state is `run`."""
        processes: list[subprocess.Popen] = []
        try:
            for command in (c for c in PAGES[HOST_BOARD].commands if c.background):
                processes.append(self.background(command))
                self.wait_for(self.folder / "reflux-link", processes[0])
            with contextlib.closing(Port(str(self.folder / "reflux-console"))) as port:
                session = Session(port)
                text = (ROOT / "host_sim" / "scenarios" / "pilot.conf").read_text(encoding="utf-8")
                for line in [x for x in text.splitlines() if x and not x.startswith("#")]:
                    self.assertEqual(self.ask(session, line)[-1], "ok", line)
                for line in ("mode bottom auto", "sp bottom 112.5", "log on", "log off", "save"):
                    self.assertIn(line.replace("off", "on"), FIRST_STEPS)
                    self.until_ok(session, line)
                while "state run" not in self.ask(session, "status")[0]:  # what was asked for meets the next sample
                    time.sleep(0.1)
                yield session
            for process in processes:
                self.assertIsNone(process.poll(), "the page's processes go on")
        finally:
            for process in processes:
                process.send_signal(signal.SIGTERM)
                process.communicate()

    def background(self, command: Command) -> subprocess.Popen:
        """Starts a command that the page starts with `&`."""
        return subprocess.Popen(["bash", "-c", "exec " + self.moved(command.line[:-1])], cwd=ROOT, env=self.environment,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def wait_for(self, path: Path, process: subprocess.Popen) -> None:
        """Until the process has made the path."""
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


def suite(names: list[str]) -> unittest.TestSuite:
    """The tests of these pages."""
    loader = unittest.defaultTestLoader
    out = unittest.TestSuite([loader.loadTestsFromTestCase(Rows)])
    out.addTests(Commands(method, PAGES[name]) for name in names for method in loader.getTestCaseNames(Commands))
    return out


def load_tests(loader: unittest.TestLoader, tests: unittest.TestSuite, pattern: str | None) -> unittest.TestSuite:
    """Tests that `python3 -m unittest` runs."""
    return suite(list(PAGES))


def main() -> int:
    p = argparse.ArgumentParser(description="Runs the commands of README and docs/ as they are printed.")
    p.add_argument("pages", nargs="*", metavar="PAGE", help="such as README.md or docs/methods/kalman.md (default: every page)")
    p.add_argument("--quick", action="store_true", help="without the commands that commands.toml calls slow")
    p.add_argument("--list", action="store_true", help="print the pages, one per line, and run nothing")
    p.add_argument("--times", action="store_true", help="print the processor seconds of each command")
    p.add_argument("-v", "--verbose", action="store_true", help="print the name of each test")
    options = p.parse_args()
    unknown = [name for name in options.pages if name not in PAGES]
    if unknown:
        p.error(f"{unknown[0]} is not a page with commands; --list prints them")
    if options.list:
        print("\n".join(PAGES))
        return 0
    Commands.quick, Commands.times = options.quick, options.times
    result = unittest.TextTestRunner(verbosity=2 if options.verbose else 1).run(suite(options.pages or list(PAGES)))
    return 0 if result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
