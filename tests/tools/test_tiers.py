"""tools/test: the two tiers, the forecast, and the sample of cases that long tests try."""

import sys
import unittest

from support import ROOT, FolderTest, call

from reflux.errors import UserError
from dev.testing import cases, running, tiers
from dev.testing.entries import AGAIN, LABELS, Test

sys.path.insert(0, str(ROOT / "tests" / "support"))
import sample  # noqa: E402


def tests(*names: str) -> list[Test]:
    return [Test(name, ["true"], ["unit"]) for name in names]


class Tiers(FolderTest):
    def table(self, text: str) -> list[tiers.Row]:
        return tiers.rows(self.file("full_tier.toml", text))

    def test_a_pattern_moves_tests_to_the_full_tier_with_its_reason(self) -> None:
        rows = self.table('[[full]]\ntests = ["long.*"]\nreason = "takes an hour"\n')
        default, reasons, full = tiers.split(tests("long.a", "long.b", "short"), set(LABELS), rows)
        self.assertEqual([t.name for t in default], ["short"])
        self.assertEqual([t.name for t in full], ["long.a", "long.b"])
        self.assertEqual(reasons, {"long.a": "takes an hour", "long.b": "takes an hour"})

    def test_a_row_with_arguments_adds_a_test_and_leaves_the_first_where_it_is(self) -> None:
        rows = self.table('[[full]]\ntests = ["power"]\narguments = ["all"]\nreason = "every case"\n')
        default, _, full = tiers.split(tests("power"), set(LABELS), rows)
        self.assertEqual([t.command for t in default], [["true"]])
        self.assertEqual([(t.name, t.command) for t in full], [("power-all", ["true", "all"])])

    def test_a_row_that_names_no_test_is_an_error_that_says_which(self) -> None:
        rows = self.table('[[full]]\ntests = ["renamed"]\nreason = "long"\n')
        with self.assertRaisesRegex(UserError, "no test is called renamed"):
            tiers.split(tests("a"), set(LABELS), rows)
        self.assertEqual(len(tiers.split(tests("a"), {"loop"}, rows)[0]), 1)  # tests of other labels are not there

    def test_a_row_without_a_reason_is_an_error_that_says_which(self) -> None:
        for text in ('[[full]]\ntests = ["a"]\n', '[[full]]\nreason = "b"\n', '[[full]]\ntests = ["a"]\nreason = "b"\nspeed = 1\n'):
            with self.assertRaisesRegex(UserError, "row 1"):
                self.table(text)

    def test_the_second_number_format_of_a_test_that_runs_once_is_in_the_full_tier(self) -> None:
        twin = Test("asan-fixed.crc32", ["true"], ["unit", AGAIN])
        default, reasons, full = tiers.split([*tests("asan.crc32"), twin], {"unit"}, [])
        self.assertEqual([t.name for t in default], ["asan.crc32"])
        self.assertEqual(full, [twin])
        self.assertIn("run_once.txt", reasons["asan-fixed.crc32"])

    def test_every_row_of_the_repository_has_a_reason(self) -> None:
        self.assertTrue(all(row.reason for row in tiers.rows()))


class Regex(unittest.TestCase):
    def test_a_name_that_matches_nothing_is_refused_and_one_of_the_full_tier_with_the_option(self) -> None:
        for regex, words in (("nothing_is_called_so", "tools/test --list"), ("target.smoke-fixed$", "--all runs them")):
            status, _, said = call("test", "target", "-R", regex)
            self.assertEqual(status, 2)
            self.assertIn(words, said)


class Forecast(unittest.TestCase):
    def test_what_is_left_shrinks_as_tests_end(self) -> None:
        watch = running.Watch(tests("a", "b", "c"), {"a": 10.0, "b": 20.0, "c": 30.0}, 2)
        self.assertAlmostEqual(watch.left_s(), 30.0, delta=0.1)
        watch.started("c")
        watch.ended("c", "Passed", 31.0)
        self.assertAlmostEqual(watch.left_s(), 15.0, delta=0.1)
        watch.ended("a", "***Failed", 1.0)
        self.assertIn("2 of 3 tests, 1 failed", watch.line())
        self.assertEqual((watch.failed, watch.seconds), (["a"], {"c": 31.0, "a": 1.0}))

    def test_a_test_that_overruns_its_forecast_is_said_to(self) -> None:
        watch = running.Watch(tests("a"), {"a": 0.0}, 1)
        watch.started("a")
        self.assertEqual(watch.line(), "0 of 1 tests, the rest takes longer than expected; running: a")

    def test_lines_of_ctest_are_understood(self) -> None:
        self.assertEqual(running.STARTED.match("      Start  12: asan.pid_loop")[1], "asan.pid_loop")
        line = "  3/630 Test  #12: asan.pid_loop ..........................   Passed    0.31 sec"
        self.assertEqual(running.ENDED.match(line).groups(), ("asan.pid_loop", "Passed", "0.31"))
        line = "563/630 Test #565: loop.inferential_faults ..................***Failed    0.08 sec"
        self.assertEqual(running.ENDED.match(line).groups(), ("loop.inferential_faults", "***Failed", "0.08"))


class Sample(unittest.TestCase):
    def test_every_item_of_every_list_is_in_the_sample(self) -> None:
        chosen = sample.combinations("abcd", "xyz", (1, 2, 3), stride=3)
        self.assertEqual(len(chosen), 4 * 3 * 3 // 3)
        for place, items in enumerate(("abcd", "xyz", (1, 2, 3))):
            self.assertEqual({c[place] for c in chosen}, set(items))

    def test_stride_one_is_every_combination(self) -> None:
        self.assertEqual(len(sample.combinations("ab", "xyz", stride=1)), 6)


class Cases(FolderTest):
    def test_functions_of_c_and_python_tests_are_found(self) -> None:
        c = self.file("test_a.c", "int main(void)\n{\n    RUN_TEST(one);\n    RUN_TEST( two );\n}\n")
        python = self.file("test_b.py", "class A(unittest.TestCase):\n    def test_x(self): pass\n    def other(self): pass\n")
        self.assertEqual(cases._c_cases(c), ("one", "two"))
        self.assertEqual(cases.cases_of(Test("b", ["python3", str(python)], ["tools"])), [("Python", str(python), "A.test_x")])


if __name__ == "__main__":
    unittest.main()
