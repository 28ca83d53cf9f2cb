"""Pages of the methods: their tables have every field of the C struct, beside the parameter it is at the console."""

import contextlib
import io
import os
import re
import runpy
import sys
import unittest
from pathlib import Path
from unittest import mock

from support import ROOT

from reflux.paths import every

PAGES = (  # page, header, struct, group of docs/reference/parameters.md
    ("methods/pid.md", "signal/pid.h", "pid_config", "loop"),
    ("methods/feedforward.md", "block/settings.h", "feedforward_settings", "ff"),
    ("methods/tuning.md", "design/tuning.h", "tuning", "loop"),
)


def page(name: str) -> str:
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


def words() -> dict[str, int]:
    """Words of README and of each folder of docs/, without the pages that tools/reference writes."""
    counts = {"README.md": len((ROOT / "README.md").read_text(encoding="utf-8").split())}
    for path in every(ROOT / "docs", "**/*.md"):
        folder = path.parent.relative_to(ROOT).as_posix()
        if folder != "docs/reference":
            counts[folder] = counts.get(folder, 0) + len(path.read_text(encoding="utf-8").split())
    return counts


def fields(header: str, struct: str) -> list[str]:
    text = (ROOT / "firmware" / header).read_text(encoding="utf-8")
    body = re.search(rf"^struct {struct} {{\n(.*?)^}};", text, re.MULTILINE | re.DOTALL)
    assert body is not None
    plain = re.sub(r"/\*.*?\*/", "", body[1], flags=re.DOTALL)
    return [name for line in plain.split(";") for name in re.findall(r"\w+(?=\s*(?:,|$))", line.strip())]


def parameters(group: str) -> list[str]:
    section = page("reference/parameters.md").split(f"\n### {group}\n")[1].split("\n##")[0]
    return re.findall(r"^\| `(\w+)` \|.*0x[0-9a-f]+ \|$", section, re.MULTILINE)


def table(name: str) -> list[tuple[list[str], list[str]]]:
    """First and second cell of each row below the header `field ... | parameter`."""
    lines = page(name).splitlines()
    begin = next(i for i, line in enumerate(lines) if re.match(r"\| field[^|]*\| parameter \|", line))
    rows = []
    for line in lines[begin + 2:]:
        if not line.startswith("|"):
            break
        cells = [cell.strip() for cell in line.split("|")[1:3]]
        rows.append((cells[0].split(", "), cells[1].split(", ")))
    return rows


class Names(unittest.TestCase):
    def test_every_field_stands_beside_a_parameter_that_exists(self) -> None:
        for name, header, struct, group in PAGES:
            with self.subTest(name):
                rows = table(name)
                self.assertEqual([f for row in rows for f in row[0]], fields(header, struct))
                for c_names, console_names in rows:
                    self.assertEqual(len(c_names), len(console_names))
                    for known in console_names:
                        self.assertIn(known, parameters(group))

    def test_the_names_are_those_of_the_refusals(self) -> None:
        """Kinds of blocks turn a field into the parameter it names in a refusal."""
        text = "".join(path.read_text(encoding="utf-8") for path in every(ROOT / "firmware", "kinds/*/*_kind.c"))
        pairs = dict(re.findall(r'\{"(\w+)", "(\w+)"\}', text))
        self.assertIn("ti_s", pairs)
        named = {c: p for name, *_ in PAGES for row in table(name) for c, p in zip(*row)}
        for field, parameter in pairs.items():
            self.assertEqual(named[field], parameter)


class Alarms(unittest.TestCase):
    """docs/use/alarms.md: each alarm and each warning stands in one row."""

    def test_each_alarm_and_each_warning_has_one_row(self) -> None:
        text = re.sub(r"\\\n", "", (ROOT / "firmware" / "base" / "event_list.h").read_text(encoding="utf-8"))
        events = re.findall(r'[A-Z_]+\(\s*([A-Z_]+),(?:\s*"[^"]*")+,\s*(ALARM|WARNING)\b', text)
        rows = [cell for line in page("use/alarms.md").splitlines() if line.startswith("| ") for cell in line.split("|")[1].strip().split(", ")]
        self.assertEqual(sorted(row for row in rows if row != "CODE"), sorted(code for code, _ in events))


class Kinds(unittest.TestCase):
    def test_the_page_of_parameters_names_every_kind_that_a_block_can_be(self) -> None:
        tables = [body for path in (ROOT / "firmware" / "kinds").glob("*/*.c")
                  for body in re.findall(r"^const struct block_kind \w+ = {\n(.*?)^};", path.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)]
        names = {re.findall(r'\.name = "(\w+)"', body)[0] for body in tables if ".parameter =" in body}
        blocks = page("reference/parameters.md").split("\n### block\n")[1].split("\n### ")[0]
        row = re.findall(r"^\| `kind` \| word \| (\S+) \|.*0x[0-9a-f]+ \|$", blocks, re.MULTILINE)
        self.assertEqual(len(row), 1)
        self.assertEqual(set(row[0].split("\\|")), names | {"-"})


class WorkedFamily(unittest.TestCase):
    """The page on adding a controller prints what its example touches, as git diff --stat has it."""

    def test_the_diffstat_on_the_page_has_all_its_files_and_no_other(self) -> None:
        section = page("inside/adding-a-controller.md").split("\n## What it touches\n")[1].split("\n## ")[0]
        rows = re.findall(r"^ +(\S+) +\| +(\d+) \++$", section, re.MULTILINE)
        loop = ROOT / "tests" / "loop"
        files = [loop / "worked_family.cmake", *(loop / "worked_family").iterdir()]
        self.assertEqual(sorted(path for path, _ in rows), sorted(path.relative_to(ROOT).as_posix() for path in files))
        self.assertIn(f"{len(rows)} files changed, {sum(int(lines) for _, lines in rows)} insertions(+)", section)

    def test_the_tests_that_the_page_names_are_there(self) -> None:
        section = page("inside/adding-a-controller.md").split("\n### 10. Tests\n")[1].split("\n## ")[0]
        texts = "".join(path.read_text(encoding="utf-8") for path in every(ROOT / "tests/loop/worked_family", "test_*.c"))
        named = re.findall(r"`(\w+)`", section)
        self.assertTrue(named)
        for name in named:
            self.assertIn(f"RUN_TEST({name});", texts)


class MethodPages(unittest.TestCase):
    """docs/methods: one form for all pages, and the equations behind what a user needs."""

    HEADINGS = ("When not to use it", "Set it up", "Parameters", "Results", "Robustness", "Equations", "Source")
    WORDS_MOST = 1500  # above the equations

    def test_each_page_has_the_form_and_few_words_above_its_equations(self) -> None:
        pages = every(ROOT / "docs" / "methods", "*.md")
        self.assertGreaterEqual(len(list(pages)), 23)
        for path in pages:
            with self.subTest(path.name):
                text = path.read_text(encoding="utf-8")
                self.assertEqual(tuple(re.findall(r"^## (.+)$", text, re.MULTILINE)), self.HEADINGS)
                words = [word for word in text.split("\n## Equations\n")[0].split() if re.search(r"\w", word)]
                self.assertLessEqual(len(words), self.WORDS_MOST)


class Decisions(unittest.TestCase):
    """The pages of docs/decisions: an idea, the decision with its date, the measurement, and what would change it."""

    def test_each_page_has_its_parts_and_stands_in_the_index(self) -> None:
        index = (ROOT / "docs" / "decisions" / "README.md").read_text(encoding="utf-8")
        pages = [path for path in every(ROOT / "docs" / "decisions", "*.md") if path.name != "README.md"]
        self.assertGreaterEqual(len(pages), 6)
        for path in pages:
            with self.subTest(path.name):
                text = path.read_text(encoding="utf-8")
                for part in ("Idea.", "Decision.", "Measurement.", "We would reconsider"):
                    self.assertIn(f"**{part}**", text)
                self.assertIn(f"]({path.name})", index)
                dates = re.findall(r"\b20\d\d-\d\d-\d\d\b", text)
                self.assertTrue(dates)
                self.assertIn(f"{dates[0]} |", next(line for line in index.splitlines() if path.name in line))


class Readme(unittest.TestCase):
    """README.md: short, and honest before the first picture."""

    def test_it_has_at_most_900_words(self) -> None:
        self.assertLessEqual(len((ROOT / "README.md").read_text(encoding="utf-8").split()), 900)

    def test_it_says_what_there_is_and_what_not_before_the_picture(self) -> None:
        first = (ROOT / "README.md").read_text(encoding="utf-8").split("![")[0]
        for said in ("simulate", "my plant", "my hardware", "serial link", "STM32F405", "STM32F100", "Not Blue Pill, ESP32 or Arduino", "emulator", "No batch stills"):
            self.assertIn(said, first)
        table = page("inside/boards.md").split("## What has run where\n")[1].split("\n## ")[0]
        silicon = re.findall(r"^\| [^|]+ \| ([^|]+) \| [^|]+ \| [^|]+ \|$", table, re.MULTILINE)[1:]
        self.assertGreater(len(silicon), 10)
        self.assertEqual("Nothing has run on silicon yet" in first, set(silicon) == {"no"})


class Glossary(unittest.TestCase):
    """docs/start/glossary.md: a line for each term, in the order of the alphabet."""

    def test_each_term_has_one_line_in_the_order_of_the_alphabet(self) -> None:
        lines = page("start/glossary.md").splitlines()[4:]
        terms = [match[1].casefold() for match in (re.fullmatch(r"- \*\*([^*]+)\*\*: .{20,}\.", line) for line in lines) if match]
        self.assertEqual(len(terms), len(lines))
        self.assertGreaterEqual(len(terms), 50)
        self.assertEqual(terms, sorted(set(terms)))


class Figures(unittest.TestCase):
    def test_each_script_says_how_it_is_used_and_draws_nothing(self) -> None:
        """All in this process: the libraries that draw take most of a second to load."""
        scripts = every(ROOT / "tools" / "figures", "*.py")
        for script in scripts:
            with self.subTest(script.name):
                self.assertTrue(os.access(script, os.X_OK))
                self.assertTrue(script.read_text(encoding="utf-8").startswith("#!/usr/bin/python3\n"))
                said, status = self.asked_for_help(script)
                self.assertEqual(status, 0)
                self.assertIn(script.name, said)

    @staticmethod
    def asked_for_help(script: Path) -> tuple[str, int]:
        said, path = io.StringIO(), list(sys.path)
        sys.path.insert(0, str(script.parent))
        try:
            with mock.patch.object(sys, "argv", [str(script), "--help"]), contextlib.redirect_stdout(said):
                runpy.run_path(str(script), run_name="__main__")
        except SystemExit as stop:
            return said.getvalue(), int(stop.code or 0)
        finally:
            sys.path[:] = path
        return said.getvalue(), 0


if __name__ == "__main__":
    print(f"words: {', '.join(f'{folder} {count}' for folder, count in words().items())}; {sum(words().values())} in all")
    unittest.main()
