"""The layers of docs/inside/architecture.md are those of CMake; no file includes what its place does not allow, no modules include
each other in a circle, and a static function has its name for itself. A struct of state has one owner, and no files include or
call each other in a circle. Conditionals on the configuration are few, and stand outside of functions and structs."""

import re
import tomllib
import unittest
from collections import defaultdict
from pathlib import Path

from support import ROOT, FolderTest

from reflux.paths import every

PAGE = ROOT / "docs" / "inside" / "architecture.md"
FIRMWARE = ROOT / "firmware"
DATA = Path(__file__).parent / "data"
OWNERS = DATA / "owners.toml"

COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
STRUCT = re.compile(r"^struct (\w+) \{\n(.*?)^\};", re.MULTILINE | re.DOTALL)
FUNCTION = re.compile(r"^([A-Za-z_][^;{}#=]*)\n\{\n(.*?)^\}", re.MULTILINE | re.DOTALL)
NAME = re.compile(r"\b(\w+)\(")
CONDITIONAL = re.compile(r"\s*#\s*(if|ifdef|ifndef)\b\s*(\w*)")
LITERAL = re.compile(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'')
CONDITIONALS_MAX = 60
ANY_STRUCT = re.compile(r"struct (\w*)\s*\{\n(.*?)\n\s*\}", re.DOTALL)
# Names that say nothing of a value.
POOR_FIELD = re.compile(r"[\s*,](of|is|at|there|far|now|then|told)(?:\[[^\]]*\])*(?:\s*:\s*\d+)?\s*[,;]")
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


def modules(texts: dict[str, str], of: dict[str, str]) -> dict[str, str]:
    """x.c and x.h are one module, x, and so is the header that defines a struct of x.c."""
    found = {path: path.rsplit(".", 1)[0] for path in texts}
    for name, (path, _) in definitions(texts, of).items():
        found[path] = of[name].rsplit(".", 1)[0]
    return found


def includes(texts: dict[str, str], of: dict[str, str]) -> dict[str, set[str]]:
    """Modules that each module includes."""
    module = modules(texts, of)
    uses = defaultdict(set)
    for path, text in texts.items():
        # A state header includes the header of its owner: that is no way back.
        uses[module[path]] |= {module[n] for n in INCLUDE.findall(text) if n in texts} - {module[path], module[path].removesuffix("_state")}
    return uses


def functions(text: str) -> list[tuple[str, str]]:
    """Head and body of each function, by braces that stand alone in the first column."""
    return [(head, body) for head, body in FUNCTION.findall(text) if "(" in head]


def calls(texts: dict[str, str], of: dict[str, str]) -> dict[str, set[str]]:
    """Modules whose functions each module calls by name. Calls through a table are none of these."""
    module = modules(texts, of)
    defined = defaultdict(set)
    for path, text in texts.items():
        for head, _ in functions(text):
            if path.endswith(".h") or not re.search(r"\bstatic\b", head):
                defined[NAME.search(head).group(1)].add(module[path])
    uses = defaultdict(set)
    for path, text in texts.items():
        for _, body in functions(text):
            for name in set(NAME.findall(body)):
                uses[module[path]] |= defined.get(name, set()) - {module[path]}
    return uses


def circles(uses: dict[str, set[str]]) -> list[list[str]]:
    """Modules of which each reaches every other. Tarjan, SIAM J. Comput. 1 (1972) 146."""
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
    return sorted(found)


def circles_of_files(texts: dict[str, str], of: dict[str, str]) -> list[list[str]]:
    uses = includes(texts, of)
    for one, others in calls(texts, of).items():
        uses[one] |= others
    return circles(uses)


def conditionals(path: str, text: str) -> list[str]:
    """Where each conditional begins; without include guards and without defaults (#ifndef X, #define X). `inside`: between braces."""
    found, depth, lines = [], 0, text.split("\n")
    for k, line in enumerate(lines):
        if match := CONDITIONAL.match(line):
            default = match[1] == "ifndef" and k + 1 < len(lines) and re.match(rf"\s*#\s*define\s+{match[2]}\b", lines[k + 1])
            if not default:
                found.append(f"{path}: {line.strip()}" + (": inside" if depth else ""))
        elif not line.lstrip().startswith("#"):
            code = LITERAL.sub("", line)
            depth += code.count("{") - code.count("}")
    return found


def owners(text: str) -> dict[str, str]:
    """The owner of each struct: `name = "file.c"` in the table of its folder."""
    return {struct: f"{folder}/{owner}" for folder, rows in tomllib.loads(text).items() if folder != "readers"
            for struct, owner in rows.items()}


def readers(text: str) -> dict[str, list[str]]:
    """Files that may include a state header of another for its inline functions, by that header."""
    return tomllib.loads(text).get("readers", {})


def definitions(texts: dict[str, str], of: dict[str, str]) -> dict[str, tuple[str, str]]:
    """File and body of the definition of each of these structs."""
    return {name: (path, body) for path, text in texts.items() for name, body in STRUCT.findall(text) if name in of}


def seen_from(texts: dict[str, str], path: str) -> set[str]:
    """A file and all that it includes, directly or not."""
    seen, open_ones = set(), [path]
    while open_ones:
        one = open_ones.pop()
        if one not in seen and one in texts:
            seen.add(one)
            open_ones += INCLUDE.findall(texts[one])
    return seen


def touched_fields(text: str, names: set[str], before: str) -> list[str]:
    """Uses of a field of a variable or member of one of these names: name->field, name[i].field."""
    if not names:
        return []
    return [m.group(0) for m in re.finditer(rf"{before}(?:{'|'.join(sorted(names))})(?:\[[^\]]*\])*(?:->|\.)\w+", text)]


def broken_ownership(texts: dict[str, str], of: dict[str, str], read_by: dict[str, list[str]] | None = None) -> list[str]:
    """A struct is defined by its owner, or by a header that only owners of its structs, and who makes room for them, include.
    Others that see it because a struct of theirs holds it touch no field."""
    where = definitions(texts, of)
    found = [f"{name}: nobody defines it" for name in of if name not in where]
    headers = {path for path, _ in where.values()}
    for header in sorted(headers):
        allowed = {of[name] for name, (path, _) in where.items() if path == header} | set((read_by or {}).get(header, []))
        if header.endswith(".c"):
            found += [f"{header}: has a struct of {owner}" for owner in sorted(allowed - {header})]
            continue
        here = "|".join(name for name, (path, _) in where.items() if path == header)
        makes_room = re.compile(rf"^ +struct (?:{here}) \w+(?:\[\w+\])?;|sizeof\(struct (?:{here})\)", re.M)
        found += [f"{path}: includes {header}" for path, text in texts.items()
                  if header in INCLUDE.findall(text) and path not in allowed | headers and not makes_room.search(text)]
    for path, text in texts.items():
        visible = seen_from(texts, path)
        for name, (home, _) in where.items():
            if home not in visible or path in (home, of[name]):
                continue
            typed = re.compile(rf"\bstruct {name}\b[\s*]*(?:const\s+)?(\w+)")
            members = {m for _, body in where.values() for m in typed.findall(body)}
            for head, body in functions(text):
                found += [f"{path}: {use}" for use in touched_fields(body, set(typed.findall(head + body)), r"(?<![\w.>])")]
                found += [f"{path}: {use}" for use in touched_fields(body, members, r"(?:->|\.)")]
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
        self.owners = owners(OWNERS.read_text(encoding="utf-8"))

    def test_every_include_names_a_folder_and_a_file(self) -> None:
        self.assertEqual(odd_includes(self.texts), [])

    def test_the_page_has_the_layers_that_cmake_has(self) -> None:
        self.assertEqual(layers_of_page(PAGE.read_text(encoding="utf-8")), layers_of_cmake(FIRMWARE))

    def test_no_modules_include_each_other_in_a_circle(self) -> None:
        self.assertEqual(circles(includes(self.texts, {})), [])

    def test_no_files_include_or_call_each_other_in_a_circle(self) -> None:
        self.assertEqual(circles_of_files(self.texts, {}), [])

    def test_no_conditional_stands_within_a_function_or_a_struct(self) -> None:
        self.assertEqual([line for path, text in self.texts.items() for line in conditionals(path, text) if line.endswith("inside")], [])

    def test_few_conditionals_stand_in_sources(self) -> None:
        found = [line for path, text in self.texts.items() if path.endswith(".c") for line in conditionals(path, text)]
        self.assertLessEqual(len(found), CONDITIONALS_MAX, "\n".join(
            ["leave the source out by CMake (tools/cmake/layers.cmake), or put the conditional into a header:", *found]))

    def test_fields_have_nouns_for_names(self) -> None:
        self.assertEqual([f"{path}: struct {name}: {field}" for path, text in self.texts.items()
                          for name, body in ANY_STRUCT.findall(text) for field in POOR_FIELD.findall(body)], [])

    def test_only_its_owner_touches_the_fields_of_a_struct(self) -> None:
        self.assertEqual(broken_ownership(self.texts, self.owners, readers(OWNERS.read_text(encoding="utf-8"))), [])

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

    def test_conditionals_in_their_places(self) -> None:
        text = ("#ifndef X\n#define X 1\n#endif\n#if X\nint f(void)\n{\n#ifdef Y\n    return 1;\n#endif\n    return '{';\n}\n#endif\n"
                "#if X\n#endif\n")
        self.assertEqual(conditionals("a/x.c", text), ["a/x.c: #if X", "a/x.c: #ifdef Y: inside", "a/x.c: #if X"])

    def test_fields_that_say_nothing(self) -> None:
        found = [field for _, body in ANY_STRUCT.findall("struct x {\n    int at, n;\n    int shift : 3, is : 1;\n    char *of[4];\n    int data;\n};\n")
                 for field in POOR_FIELD.findall(body)]
        self.assertEqual(found, ["at", "is", "of"])

    def test_a_circle_through_a_source(self) -> None:
        texts = self.texts(a__x_h='#include "a/y.h"\n', a__x_c='#include "a/x.h"\n', a__y_h="", a__z_h="",
                           a__y_c='#include "a/y.h"\n#include "a/z.h"\n', a__z_c='#include "a/x.h"\n')
        self.assertEqual(circles(includes(texts, {})), [["a/x", "a/y", "a/z"]])

    def test_no_circle_where_two_meet_below(self) -> None:
        texts = self.texts(a__x_h='#include "a/y.h"\n#include "a/z.h"\n', a__y_h='#include "a/z.h"\n', a__z_h="")
        self.assertEqual(circles(includes(texts, {})), [])

    def test_a_header_of_state_is_part_of_its_owner(self) -> None:
        texts = self.texts(a__x_h='#include "a/z.h"\n', a__z_h='#include "a/x_state.h"\n',
                           a__x_state_h="struct x {\n    int n;\n};\n")
        self.assertEqual(circles(includes(texts, {})), [])
        self.assertEqual(circles(includes(texts, {"x": "a/x.c"})), [["a/x", "a/z"]])

    def test_a_circle_through_a_call(self) -> None:
        texts = self.texts(a__x_h='void x(void);\n#include "a/y.h"\n', a__x_c='#include "a/x.h"\nvoid x(void)\n{\n    y();\n}\n',
                           a__y_h="void y(void);\n", a__y_c="void x(void);\nvoid y(void)\n{\n    x();\n}\n")
        self.assertEqual(circles(includes(texts, {})), [])
        self.assertEqual(circles_of_files(texts, {}), [["a/x", "a/y"]])

    def test_no_circle_through_a_table_or_a_function_of_the_file_itself(self) -> None:
        texts = self.texts(a__x_c="static void f(void)\n{\n}\nvoid x(void)\n{\n    f();\n    y();\n}\n",
                           a__y_c="static void f(void)\n{\n}\nvoid (*const table[])(void) = {x};\n"
                                "void y(void)\n{\n    f();\n    table[0]();\n}\n")
        self.assertEqual(circles_of_files(texts, {}), [])

    def owned(self, **files: str) -> list[str]:
        """Two structs, of which one holds the other."""
        texts = {"a__x_state_h": "struct x {\n    int n;\n};\n",
                 "a__x_c": '#include "a/x_state.h"\nint f(struct x *x)\n{\n    return x->n;\n}\n',
                 "a__y_state_h": '#include "a/x_state.h"\nstruct y {\n    struct x part[2];\n    int m;\n};\n',
                 "a__y_c": '#include "a/y_state.h"\nint g(struct y *y)\n{\n    return f(&y->part[0]) + y->m;\n}\n'}
        return broken_ownership(self.texts(**texts | files), owners('["a"]\nx = "x.c"\ny = "y.c"\n'))

    def test_owners_that_keep_to_themselves(self) -> None:
        self.assertEqual(self.owned(), [])

    def test_a_stranger_that_includes_the_header_of_a_state(self) -> None:
        self.assertEqual(self.owned(a__z_c='#include "a/x_state.h"\n', a__w_h='#include "a/y_state.h"\n'),
                         ["a/z.c: includes a/x_state.h", "a/w.h: includes a/y_state.h"])

    def test_an_owner_that_touches_fields_of_what_its_struct_holds(self) -> None:
        self.assertEqual(self.owned(a__y_c='#include "a/y_state.h"\nint g(struct y *y)\n{\n    return y->part[1].n;\n}\n'
                                           "int h(const struct x *some)\n{\n    return some->n;\n}\n"),
                         ["a/y.c: ->part[1].n", "a/y.c: some->n"])

    def test_a_struct_that_nobody_or_somebody_else_defines(self) -> None:
        self.assertEqual(self.owned(a__x_state_h="", a__y_c="struct x {\n    int n;\n};\n"), ["a/y.c: has a struct of a/x.c"])
        self.assertEqual(self.owned(a__x_state_h="", a__y_c=""), ["x: nobody defines it"])

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
