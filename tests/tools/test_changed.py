"""tools/test --changed: a file that changed runs every test that reaches it, and what is unknown runs."""

import struct
import sys
import unittest
from unittest import mock

from support import ROOT, FolderTest

from reflux.errors import RunFailed, UserError
from dev.testing import changed, reach, reach_measure
from dev.testing.entries import Test, needs

ROWS = {"pid": frozenset({"firmware/signal/pid.c"}), "svd": frozenset({"firmware/num/svd.c"})}
TESTS = [Test("asan.pid", ["x"], ["unit"], needs("asan", "tests/unit/test_pid")),
         Test("asan-fixed.pid", ["x"], ["unit"], needs("asan-fixed", "tests/unit/test_pid")),
         Test("asan.svd", ["x"], ["unit"], needs("asan", "tests/unit/test_svd")),
         Test("asan.new", ["x"], ["unit"], needs("asan", "tests/unit/test_new")),
         Test("style.clang-format", ["x"], ["style"]),
         Test("tools.documents", [sys.executable, str(ROOT / "tests" / "tools" / "test_documents.py")], ["tools"])]
OWN = {"asan": {"tests/unit/test_pid": {"tests/unit/kinds/pid/test_pid.c"}, "tests/unit/test_svd": {"tests/unit/test_svd.c"}}}


def reaching(path: str) -> set[str]:
    with mock.patch.object(reach, "load", return_value=ROWS), \
            mock.patch.object(changed, "_sources_by_target", side_effect=lambda preset: OWN.get(preset, {})):
        return changed.reaching(TESTS, path)


class Changed(unittest.TestCase):
    def test_a_source_runs_tests_that_reach_it_in_both_number_formats_and_tests_without_a_row(self) -> None:
        self.assertEqual(reaching("firmware/signal/pid.c"), {"asan.pid", "asan-fixed.pid", "asan.new", "style.clang-format"})

    def test_a_header_runs_what_reaches_any_source_that_includes_it(self) -> None:
        found = reaching("firmware/num/svd.h")
        self.assertIn("asan.svd", found)

    def test_a_source_of_a_test_runs_that_test_alone(self) -> None:
        self.assertEqual(reaching("tests/unit/test_svd.c"), {"asan.svd", "style.clang-format"})

    def test_a_module_runs_python_tests_that_import_it(self) -> None:
        self.assertEqual(reaching("tests/tools/support.py"), {"tools.documents"})

    def test_a_command_runs_python_tests_that_call_it_by_its_name_and_the_pages(self) -> None:
        script = str(ROOT / "tests" / "tools" / "test_gradients.py")
        some = [Test("tools.gradients", [sys.executable, script], ["tools"]), Test("tools.commands-README-quick", ["x"], ["tools"]), *TESTS]
        self.assertEqual(changed.reaching(some, "tools/reflux/cmd_gradients.py"),
                         {"tools.gradients", "tools.commands-README-quick"})

    def test_a_note_of_the_reference_runs_the_test_of_its_pages(self) -> None:
        some = [Test("tools.reference", ["x"], ["tools"]), *TESTS]
        self.assertEqual(changed.reaching(some, "docs/reference/notes/events.toml"), {"tools.reference"})
        self.assertIn("tools.reference", changed.reaching(some, "docs/reference/events.md"))

    def test_a_notebook_runs_the_tests_of_notebooks_and_of_links(self) -> None:
        some = [Test(name, ["x"], ["tools"]) for name in ("tools.notebooks", "tools.notebooks-all", "tools.links", "tools.lab")]
        self.assertEqual(changed.reaching([*some, *TESTS], "docs/notebooks/splitter.ipynb"), {"tools.notebooks", "tools.notebooks-all", "tools.links"})

    def test_what_is_not_known_runs_everything(self) -> None:
        for path in ("CMakeLists.txt", "tests/reference/pid_cases.csv", "host_sim/scenarios/pilot.conf", "tools/launcher.sh"):
            self.assertEqual(reaching(path), {t.name for t in TESTS}, path)

    def test_the_shortest_tests_fit_and_one_of_unknown_time_is_among_them(self) -> None:
        seconds = {"asan.pid": 5.0, "asan-fixed.pid": 1.0, "asan.svd": 2.0, "style.clang-format": 1.0, "tools.documents": 9.0}
        self.assertEqual([t.name for t in changed.fitting(TESTS, seconds, 4.0)],
                         ["asan.new", "asan-fixed.pid", "style.clang-format", "asan.svd"])

    def test_a_commit_that_git_does_not_know_is_an_error(self) -> None:
        with self.assertRaisesRegex(UserError, "--changed: git diff"):
            changed.changed_files("no-such-commit")


class Reach(FolderTest):
    def test_what_is_written_reads_back(self) -> None:
        path = self.folder / "reach.txt"
        rows = {"a": {"firmware/a.c", "firmware/b.c"}, "b": {"firmware/b.c"}, "c": set()}
        reach.store(rows, path)
        self.assertEqual(reach.load(path), {name: frozenset(sources) for name, sources in rows.items()})

    def test_a_line_that_is_no_row_is_an_error_with_its_number(self) -> None:
        with self.assertRaisesRegex(UserError, "reach.txt:2"):
            reach.load(self.file("reach.txt", "firmware/a.c\nname no-number\n"))

    def test_both_number_formats_have_one_row(self) -> None:
        self.assertEqual({reach.row_of(n) for n in ("asan.pid", "asan-fixed.pid", "host.pid")}, {"pid"})
        self.assertEqual(reach.row_of("loop.pid"), "loop.pid")

    def test_counters_tell_whether_a_source_ran(self) -> None:
        head = struct.pack("<II", reach_measure.MAGIC, 0x4232322A) + bytes(8) + struct.pack("<Ii3I", 0x01000000, 12, 1, 2, 3)
        path = self.folder / "x.gcda"
        counter = struct.pack("<IiQ", reach_measure.COUNTERS, 8, 1)
        none = struct.pack("<IiQ", reach_measure.COUNTERS, 8, 0)
        omitted = struct.pack("<Ii", reach_measure.COUNTERS, -8)
        self.assertTrue(reach_measure.ran(head + omitted + none + counter, path))
        self.assertFalse(reach_measure.ran(head + omitted + none, path))
        with self.assertRaisesRegex(RunFailed, "another compiler"):
            reach_measure.ran(struct.pack("<II", reach_measure.MAGIC, 0x4131312A) + bytes(8), path)


if __name__ == "__main__":
    unittest.main()
