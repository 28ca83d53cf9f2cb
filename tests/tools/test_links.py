"""Links and citations: every link of a page leads to a file and a heading that are there; every page that a source, a message, a scenario or a
test names is there; docs/moved.md tells of every page that has moved."""

import re
import unittest
from functools import cache
from pathlib import Path

from support import ROOT

from reflux.paths import every

MOVED = ROOT / "docs" / "moved.md"
CHANGES = ROOT / "CHANGELOG.md"
FOLDERS = ("docs", "firmware", "hal", "host_sim", "tests", "tools")
LINK = re.compile(r"\]\(([^()\s]+)\)")
# A page by its path from the root, or from docs/ where the flash of a board is too small for more.
CITED = re.compile(r"(?<![\w./-])(?:docs/[a-z0-9/-]+\.md|(?:start|use|methods|inside|decisions)/[a-z0-9-]+\.md)")
ROW = re.compile(r"^\| `(docs/[^`]+)` \| \[(docs/[^\]]+)\]\(([^)]+)\) \|$", re.MULTILINE)


@cache
def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def pages() -> list[Path]:
    """Every page of the repository, notebooks too."""
    return [*every(ROOT, "*.md"), *every(ROOT / "docs", "**/*.md"), *every(ROOT / "docs", "**/*.ipynb"), *every(ROOT / "tests", "**/*.md")]


def texts() -> list[Path]:
    """Every file of the repository that may name a page."""
    below = [path for folder in FOLDERS for path in every(ROOT / folder, "**/*")]
    return [path for path in [*every(ROOT, "*.md", "*.txt", "*.json", "*.yml"), *below]
            if path.is_file() and "__pycache__" not in path.parts and path.suffix not in (".png", ".bin", ".csv", ".pyc")]


def headings(path: Path) -> set[str]:
    """The anchors that GitHub gives to the headings of a page."""
    found: dict[str, int] = {}
    out = set()
    for title in re.findall(r"^#+ +(.*?) *$", text_of(path), re.MULTILINE):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).lower()
        anchor = re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")
        before = found.get(anchor, 0)
        found[anchor] = before + 1
        out.add(f"{anchor}-{before}" if before else anchor)
    return out


def moved() -> dict[str, str]:
    """The new path of each page that has moved, by its old path."""
    return {old: new for old, new, _ in ROW.findall(text_of(MOVED))}


class Links(unittest.TestCase):
    def test_every_link_leads_to_a_file_and_a_heading_that_are_there(self) -> None:
        links = 0
        for page in pages():
            for target in LINK.findall(text_of(page)):
                if re.match(r"https?:", target):
                    continue
                links += 1
                path, _, anchor = target.partition("#")
                to = (page.parent / path).resolve() if path else page
                place = f"{page.relative_to(ROOT)}: {target}"
                self.assertTrue(to.exists(), f"{place}: no such file")
                if anchor:
                    self.assertIn(anchor, headings(to), f"{place}: no such heading")
        self.assertGreater(links, 300)

    def test_an_anchor_is_made_of_its_heading_as_on_github(self) -> None:
        page = ROOT / "docs" / "methods" / "self-tuning.md"
        self.assertIn("choice-of-λ", headings(page))
        self.assertNotIn("no-choice-of-λ", headings(page))


class Citations(unittest.TestCase):
    def test_every_page_that_a_file_names_is_there(self) -> None:
        wrong, right, old = [], 0, moved()
        for path in texts():
            if path == MOVED:
                continue
            try:
                text = text_of(path)
            except UnicodeDecodeError:  # an image of a flash
                continue
            if path == CHANGES:  # released sections name pages as they were then
                text = re.split(r"^## \d", text, maxsplit=1, flags=re.MULTILINE)[0]
            for name in CITED.findall(text):
                page = name if name.startswith("docs/") else f"docs/{name}"
                if (ROOT / page).is_file():
                    right += 1
                else:
                    wrong.append(f"{path.relative_to(ROOT)} names {name}" + (f", now {old[page]}" if page in old else ", which is not there"))
        self.assertEqual(wrong, [])
        self.assertGreater(right, 300)


class Moved(unittest.TestCase):
    def test_every_row_names_a_page_that_is_gone_and_one_that_is_there(self) -> None:
        rows = ROW.findall(text_of(MOVED))
        self.assertEqual(len(rows), sum(line.startswith("| `") for line in text_of(MOVED).splitlines()))
        self.assertGreater(len(rows), 40)
        for old, new, link in rows:
            with self.subTest(old):
                self.assertFalse((ROOT / old).exists())
                self.assertTrue((ROOT / new).is_file())
                self.assertEqual(f"docs/{link}", new)

    def test_rows_are_in_the_order_of_old_paths_and_each_of_these_has_one(self) -> None:
        rows = ROW.findall(text_of(MOVED))
        self.assertEqual(rows, sorted(rows))
        self.assertEqual(len({old for old, _, _ in rows}), len(rows))

    def test_the_top_folder_keeps_no_page_but_the_list_and_this_one(self) -> None:
        self.assertEqual([path.name for path in every(ROOT / "docs", "*.md")], ["README.md", "moved.md"])

    def test_the_list_of_pages_has_every_page(self) -> None:
        listed = {(ROOT / "docs" / target.partition("#")[0]).resolve() for target in LINK.findall(text_of(ROOT / "docs" / "README.md"))}
        folders = [path for path in every(ROOT / "docs", "*/*.md") if path.parent.name != "decisions"]
        self.assertEqual([path.relative_to(ROOT).as_posix() for path in folders if path not in listed], [])


if __name__ == "__main__":
    unittest.main()
