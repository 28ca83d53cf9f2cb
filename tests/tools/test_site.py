"""tools/site: the nav of mkdocs.yml has every page, pages in GitHub's Markdown become pages of the site, and what is wrong with a site is found."""

import importlib.util
import os
import re
import unittest
from pathlib import Path
from unittest import mock

from support import ROOT, FolderTest, call

from dev import cmd_site, site_hooks
from dev.cmd_site import faults
from reflux.errors import UserError
from reflux.paths import every

METHODS = ROOT / "docs" / "methods"


def on_site(path: Path) -> str:
    """The name that a page of docs/ has on the site."""
    name = path.relative_to(ROOT / "docs").as_posix()
    return site_hooks.LIST_ON_SITE if name == site_hooks.LIST else name


class Nav(unittest.TestCase):
    def test_the_nav_has_every_page_once_and_the_folders_in_their_order(self) -> None:
        text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").split("\nnav:\n")[1]
        listed = re.findall(r"^ *- (?:\w+: )?(\S+\.md)$", text, re.MULTILINE)
        docs = [on_site(path) for path in every(ROOT / "docs", "**/*.md")]
        self.assertEqual(sorted(listed), sorted([*docs, *site_hooks.OF_THE_ROOT]))
        self.assertEqual(re.findall(r"^  - (\w+):", text, re.MULTILINE), ["Reflux", "Start", "Use", "Methods", "Reference", "Inside", "Decisions"])

    def test_the_theme_fetches_no_fonts(self) -> None:
        self.assertIn("\n  font: false\n", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"))


class Hooks(unittest.TestCase):
    def becomes(self, line: str, wanted: str, folder: os.PathLike = METHODS) -> None:
        self.assertEqual(site_hooks.for_site(line, folder), wanted)

    def test_a_link_within_the_pages_stays(self) -> None:
        for line in ("see [tuning.md](tuning.md#simc)", "![Windup](../figures/pid-windup.png)", "[below](#results)", "[a](https://example.org/x)"):
            self.becomes(line, line)

    def test_a_link_to_another_file_becomes_its_path(self) -> None:
        self.becomes("in [results.md](../../tests/bench/results.md).", "in `tests/bench/results.md`.")
        self.becomes("[the campaign](../../tests/campaign/results/relay.md#x)", "the campaign (`tests/campaign/results/relay.md`)")

    def test_pages_of_the_root_stand_beside_the_folders(self) -> None:
        self.becomes("[x](docs/use/loops.md#a)", "[x](use/loops.md#a)", ROOT)
        self.becomes("[x](CHANGELOG.md)", "[x](CHANGELOG.md)", ROOT)
        self.becomes("[x](../../README.md)", "[x](../README.md)")
        self.becomes("[x](docs/README.md#use)", "[x](pages.md#use)", ROOT)
        self.becomes("[x](../README.md)", "[x](../pages.md)")
        self.becomes("[LICENSE](LICENSE)", "`LICENSE`", ROOT)

    def test_bars_in_the_code_of_a_table_lose_their_backslash(self) -> None:
        self.becomes(r"| `log on\|off` | a \| b |", r"| `log on|off` | a \| b |")
        self.becomes(r"no table: `a\|b`", r"no table: `a\|b`")

    def test_code_stays_as_it_is(self) -> None:
        page = mock.Mock()
        page.file.src_uri = "methods/pid.md"
        link, code = "[x](../../LICENSE)", "loops[i](../../LICENSE)"
        text = f"{link}\n\n    {code}\n\n```python\n{code}\n```\n{link}"
        self.assertEqual(site_hooks.on_page_markdown(text, page), text.replace(link, "x (`LICENSE`)"))

    def test_a_link_may_go_over_two_lines(self) -> None:
        page = mock.Mock()
        page.file.src_uri = "methods/pid.md"
        self.assertEqual(site_hooks.on_page_markdown("see [the\nlicence](../../LICENSE).", page), "see the\nlicence (`LICENSE`).")

    def test_a_list_within_a_list_is_indented_by_four(self) -> None:
        self.becomes("   - `create` returns", "    - `create` returns")
        self.becomes("  goes on", "  goes on")


class Faults(FolderTest):
    def page(self, name: str, body: str) -> None:
        (self.folder / name).write_text(f"<html><body>{body}</body></html>", encoding="utf-8")

    def test_a_site_that_is_whole_has_none(self) -> None:
        self.page("index.html", '<link rel="canonical" href="https://example.org/"><script src="a.js"></script><a href="b.html#%CE%BB">b</a>'
                  '<a href="https://example.org/">elsewhere</a>')
        self.page("b.html", '<h2 id="λ">λ</h2><a href="#λ">here</a>')
        self.assertEqual(faults(self.folder), [])

    def test_requests_to_other_hosts_are_named(self) -> None:
        self.page("index.html", '<script src="https://cdn.example/x.js"></script><link rel="stylesheet" href="//fonts.example/css">')
        self.assertEqual(faults(self.folder), ["index.html requests https://cdn.example/x.js", "index.html requests //fonts.example/css"])

    def test_links_that_lead_nowhere_are_named(self) -> None:
        self.page("index.html", '<a href="gone.html">x</a><a href="b.html#gone">y</a>')
        self.page("b.html", '<h2 id="there">z</h2>')
        self.assertEqual(faults(self.folder), ["index.html links to gone.html, which is not there",
                                               "index.html links to b.html#gone, which is no heading there"])

    def test_a_site_without_a_page_is_one(self) -> None:
        self.assertEqual(len(faults(self.folder)), 1)


class Tool(FolderTest):
    def test_a_folder_that_holds_something_else_is_refused_and_left_alone(self) -> None:
        (self.folder / "letter.txt").write_text("dear", encoding="utf-8")
        status, _, err = call("site", "--out", str(self.folder))
        self.assertEqual(status, 2)
        self.assertIn("is not empty and no site: name another folder", err)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["letter.txt"])

    def test_the_packages_of_debian_are_asked_for_where_a_module_is_missing(self) -> None:
        for missing in cmd_site.MODULES:
            with self.subTest(missing), mock.patch.object(cmd_site.importlib.util, "find_spec", lambda name, gone=missing: name != gone), \
                 mock.patch.object(cmd_site.packages, "need", side_effect=UserError("asked")) as need:
                self.assertIn("asked", call("site", "--out", str(self.folder))[2])
                need.assert_called_once_with("site")

    def test_those_of_pypi_do_as_well(self) -> None:
        with mock.patch.object(cmd_site.importlib.util, "find_spec", lambda name: True), mock.patch.object(cmd_site.packages, "need") as need, \
             mock.patch.object(cmd_site.subprocess, "run", return_value=mock.Mock(returncode=1)) as run:
            self.assertIn("mkdocs built no site", call("site", "--out", str(self.folder))[2])
            need.assert_not_called()
            run.assert_called_once()

    @unittest.skipUnless(importlib.util.find_spec("mkdocs") and importlib.util.find_spec("pymdownx"), "MkDocs is not installed; tools/bootstrap site does")
    def test_it_builds_every_page_without_a_fault(self) -> None:
        status, out, err = call("site", "--out", str(self.folder))
        self.assertEqual((status, err), (0, ""), out)
        self.assertIn(" pages, 0 faults: ", out)
        self.assertTrue((self.folder / "search" / "search_index.json").is_file())
        for page in every(ROOT / "docs", "**/*.md"):
            name = on_site(page).replace(".md", ".html").replace("README", "index")
            self.assertTrue((self.folder / name).is_file(), name)


if __name__ == "__main__":
    unittest.main()
