"""tools/evidence: which lines count, and what the page says where there are none."""

import os
import unittest
from unittest import mock

from support import FolderTest, call

from dev import cmd_evidence as evidence
from dev.cmd_evidence import Line, Result


class Evidence(FolderTest):
    def setUp(self) -> None:
        super().setUp()
        self.enterContext(mock.patch.dict(os.environ, {"REFLUX_BUILD_ROOT": str(self.folder)}))

    def test_only_lines_of_a_section_are_kept_and_each_once(self) -> None:
        lines = [Line(text, "ctest") for text in
                 ("storage power-cut states: 8123", "storage power-cut states: 8123", "Test command: storage 3",
                  "attack bit flips: frames 900, damaged 12, detected 12, undetected 0",
                  "fault matrix: 480 combinations (30 faults, 5 modes)", "anything else 12",
                  "float_pow near 1: 975737 arguments, largest error 0.50966 ulp at 1 2")]
        kept = evidence.filtered(Result(lines), "tests").lines
        self.assertEqual([line.text[:9] for line in kept], ["storage p", "attack bi", "fault mat", "float_pow"])

    def test_page_with_figures_without_and_with_a_failure(self) -> None:
        results = {name: Result() for name in evidence.SOURCES}
        results["mutate"] = Result([Line("mutants: 60, caught: 59", "tools/mutate")], "one was not noticed",
                                   "2026-01-02", "abc123")
        results["fuzz"] = Result(problem="there is no tools/fuzz yet", when="2026-01-02")
        text, lacking = evidence.page(results, {})
        self.assertIn("    $ tools/mutate\n    mutants: 60, caught: 59\n", text)
        self.assertIn("2026-01-02, commit abc123. **Not all was good: one was not noticed**", text)
        self.assertIn("*Not available: there is no tools/fuzz yet.*", text)
        self.assertIn("*Not available: `tools/evidence coverage` has not been run.*", text)
        self.assertEqual(len(lacking), len(evidence.SECTIONS) - 1)

    def test_a_source_that_was_not_run_here_keeps_the_figures_of_the_page(self) -> None:
        page = self.folder / "page.md"
        results = {name: Result() for name in evidence.SOURCES}
        results["mutate"] = Result([Line("mutants: 5, caught: 5", "tools/mutate")], when="2026-01-02", commit="abc123")
        text, lacking = evidence.page(results, {})
        page.write_text(text)
        again, still_lacking = evidence.page({name: Result() for name in evidence.SOURCES}, evidence.kept_sections(page))
        self.assertEqual(again, text)
        self.assertEqual(still_lacking, lacking)

    def test_figures_are_kept_between_runs(self) -> None:
        found = Result([Line("mutants: 5, caught: 5", "tools/mutate")])
        self.enterContext(mock.patch.object(evidence, "PAGE", self.folder / "none.md"))
        self.enterContext(mock.patch.object(evidence.packages, "need"))  # what measures runs nothing here
        with mock.patch.dict(evidence.SOURCES, {"mutate": lambda: found}):
            status, _, _ = call("evidence", "mutate", "--out", str(self.folder / "page.md"))
        self.assertEqual(status, 1)  # the other sections have no figures
        page = self.folder / "again.md"
        call("evidence", "--page-only", "--out", str(page))
        self.assertIn("mutants: 5, caught: 5", page.read_text())

    def test_a_tool_that_is_not_there(self) -> None:
        self.assertEqual(evidence.of_tool("nowhere").problem, "there is no tools/nowhere yet")
        self.assertEqual(call("evidence", "nothing")[0], 2)


if __name__ == "__main__":
    unittest.main()
