"""The layers of docs/architecture.md are those of CMake; no file includes what its place does not allow, no modules include
each other in a circle, and a static function has its name for itself."""

import re
import unittest
from collections import defaultdict
from pathlib import Path

from support import ROOT, FolderTest

from reflux.paths import every

PAGE = ROOT / "docs" / "architecture.md"
FIRMWARE = ROOT / "firmware"

COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
STATIC = re.compile(r"^(?:[A-Z_]+ )*static (?:[^=;(){}]*[\s*])?(\w+)\(", re.MULTILINE)


def sources(folder: Path) -> dict[str, str]:
    """Text of every source and header, without comments, by its path."""
    return {str(path.relative_to(folder)): COMMENT.sub("", path.read_text(encoding="utf-8"))
            for path in sorted(folder.rglob("*.[ch]"))}


def layers_of_cmake(folder: Path) -> dict[str, list[str]]:
    found = {}
    for path in every(folder, "*/CMakeLists.txt", "kinds/*/CMakeLists.txt"):
        text = re.sub(r"#.*", "", path.read_text(encoding="utf-8"))
        for what, name, body in re.findall(r"reflux_(layer|kind)\((\w+)([^)]*)\)", text):
            place = f"kinds/{name}" if what == "kind" else name
            found[place] = sorted(body.split("DEPENDS")[1].split()) if "DEPENDS" in body else []
    return found


def layers_of_page(text: str) -> dict[str, list[str]]:
    """Rows `| folder | uses | what is in it |`; `-` for none."""
    section = text.split("\n## Layers\n")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `((?:kinds/)?\w+)/` \| ([^|]*) \|", section, re.MULTILINE)
    return {name: sorted(re.findall(r"`(\w+)`", uses)) for name, uses in rows}


def odd_includes(texts: dict[str, str]) -> list[str]:
    """Includes that are not a folder and a file of it."""
    return [f"{path}: {name}" for path, text in texts.items() for name in INCLUDE.findall(text)
            if "/" not in name or ".." in name.split("/") or "." in name.split("/")]


def module(path: str) -> str:
    return path.rsplit(".", 1)[0]


def circles(texts: dict[str, str]) -> list[list[str]]:
    """Modules (x.c with x.h) of which each reaches every other by includes. Tarjan, SIAM J. Comput. 1 (1972) 146."""
    uses = defaultdict(set)
    for path, text in texts.items():
        uses[module(path)] |= {module(n) for n in INCLUDE.findall(text) if n in texts and module(n) != module(path)}
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    open_ones: list[str] = []
    found = []

    def visit(one: str) -> None:
        index[one] = low[one] = len(index)
        open_ones.append(one)
        for other in sorted(uses[one]):
            if other not in index:
                visit(other)
            if other in open_ones:
                low[one] = min(low[one], low[other])
        if low[one] == index[one]:
            at = open_ones.index(one)
            circle = open_ones[at:]
            del open_ones[at:]
            if len(circle) > 1:
                found.append(sorted(circle))

    for one in sorted(uses):
        if one not in index:
            visit(one)
    return found


def equal_names(texts: dict[str, str]) -> dict[str, list[str]]:
    where = defaultdict(set)
    for path, text in texts.items():
        for name in STATIC.findall(text):
            where[name].add(path)
    return {name: sorted(paths) for name, paths in sorted(where.items()) if len(paths) > 1}


class Lint(unittest.TestCase):
    def setUp(self) -> None:
        self.texts = sources(FIRMWARE)

    def test_every_include_names_a_folder_and_a_file(self) -> None:
        self.assertEqual(odd_includes(self.texts), [])

    def test_the_page_has_the_layers_that_cmake_has(self) -> None:
        self.assertEqual(layers_of_page(PAGE.read_text(encoding="utf-8")), layers_of_cmake(FIRMWARE))

    def test_no_modules_include_each_other_in_a_circle(self) -> None:
        self.assertEqual(circles(self.texts), [])

    def test_a_static_function_has_its_name_for_itself(self) -> None:
        self.assertEqual(equal_names(self.texts), {})

    def test_every_file_that_the_page_names_is_there(self) -> None:
        named = set(re.findall(r"`((?:\w+/)+[\w.*<>]*)`", PAGE.read_text(encoding="utf-8")))
        self.assertTrue(named)
        for name in sorted(named):
            if "NAME" not in name and "<" not in name:
                self.assertTrue(any(list(top.glob(name.rstrip("/"))) for top in (ROOT, FIRMWARE)), name)


class Tools(unittest.TestCase):
    def test_what_users_run_imports_nothing_of_campaigns_and_of_development(self) -> None:
        for path in every(ROOT / "tools" / "reflux", "**/*.py"):
            with self.subTest(path.name):
                self.assertNotRegex(path.read_text(encoding="utf-8"), r"(?m)^\s*(from|import) (dev|research)\b")


class Found(FolderTest):
    """What the lint looks for, in small trees."""

    def texts(self, **files: str) -> dict[str, str]:
        for name, text in files.items():
            path = self.folder / name.replace("__", "/").replace("_h", ".h").replace("_c", ".c")
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return sources(self.folder)

    def test_includes_without_a_folder_or_upwards(self) -> None:
        texts = self.texts(a__x_c='#include "a/y.h"\n#include "y.h"\n#  include "../b/z.h"\n// \n/* #include "w.h" */\n')
        self.assertEqual(odd_includes(texts), ["a/x.c: y.h", "a/x.c: ../b/z.h"])

    def test_a_circle_through_a_source(self) -> None:
        texts = self.texts(a__x_h='#include "a/y.h"\n', a__x_c='#include "a/x.h"\n', a__y_h="", a__z_h="",
                           a__y_c='#include "a/y.h"\n#include "a/z.h"\n', a__z_c='#include "a/x.h"\n')
        self.assertEqual(circles(texts), [["a/x", "a/y", "a/z"]])

    def test_no_circle_where_two_meet_below(self) -> None:
        texts = self.texts(a__x_h='#include "a/y.h"\n#include "a/z.h"\n', a__y_h='#include "a/z.h"\n', a__z_h="")
        self.assertEqual(circles(texts), [])

    def test_static_functions_however_they_are_declared(self) -> None:
        texts = self.texts(
            a__x_c="static int f(void);\nNOT_INLINE static const struct s *g(int a)\n{\n    static int h(void);\n}\n"
                   "static bool (*const k[])(void) = {f};\nstatic void m(int a,\n              int b)\n{\n}\n",
            b__y_c="static bool f(int a)\n{\n}\nstatic struct s *g(void)\n{\n}\nstatic int h(void)\n{\n}\n"
                   "static int k(void)\n{\n}\nMUST_CHECK static inline enum err\nm(void)\n{\n}\n")
        self.assertEqual(equal_names(texts), {n: ["a/x.c", "b/y.c"] for n in "fgm"})

    def test_layers_of_a_build_file(self) -> None:
        self.texts(a__x_c="")
        (self.folder / "a" / "CMakeLists.txt").write_text(
            "# reflux_layer(no)\nreflux_layer(a SOURCES x.c # this\n  DEPENDS c b)\nreflux_double_layer(a SOURCES x.c)\n",
            encoding="utf-8")
        self.assertEqual(layers_of_cmake(self.folder), {"a": ["b", "c"]})


if __name__ == "__main__":
    unittest.main()
