"""tests/run_once.txt claims that the number format cannot matter to some tests. Needs both sanitizer trees, whole."""

import unittest

import support  # noqa: F401

from dev.testing import reach, run_once
from dev.testing.entries import SANITIZED


class RunOnce(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.sections = run_once.sections()
        cls.float, cls.fixed = (run_once.entries(preset) for preset in SANITIZED)

    def test_every_name_is_a_test_of_both_number_formats(self) -> None:
        names = [name for section in self.sections.values() for name in section]
        self.assertEqual(sorted(set(names)), sorted(names))
        self.assertEqual([name for name in names if name not in self.float or name not in self.fixed], [])

    def test_tests_of_same_code_are_the_same_machine_code_and_no_other_test_is(self) -> None:
        same = [name for name in self.fixed if name in self.float and run_once.same_code(self.float[name], self.fixed[name])]
        self.assertEqual(sorted(same), sorted(self.sections["same-code"]))

    def test_tests_of_not_reached_run_no_source_that_differs(self) -> None:
        differing = run_once.differing_sources()
        rows = reach.load()
        for name in self.sections["not-reached"]:
            with self.subTest(name):
                self.assertIn(name, rows, "tools/coverage --reach has measured it")
                self.assertEqual(sorted(rows[name] & differing), [])


if __name__ == "__main__":
    unittest.main()
