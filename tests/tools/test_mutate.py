#!/usr/bin/python3
"""tools/mutate --random: where a fault can be put, and that a seed gives the same ones again."""

from __future__ import annotations

import unittest
from collections import Counter
from pathlib import Path

from support import call

from dev import cmd_mutate
from dev.mutation import drawing
from dev.mutation.edits import KINDS, edits_of

SOURCE = """\
#include <stdint.h>
#define LIMIT (3 + 1) /* 99 */
static const float steps[] = {0.5f, 2};
struct pair { int a[4]; };
enum { FIRST = 7 };

/* a + b: 5 */
static int work(const struct pair *p, int n)
{
    int room[8];
    const char *said = "1 + 1 < 3";
    if (n < LIMIT && !p->a[0])
        return -1;
    for (int i = 0; i < n; i++)
        room[i] = p->a[i] * (int)-2;
    use(said,
        room);
    n += *p->a;
    return n == 3 ? room[0] : (n & 1);
}
"""


def found(source: str = SOURCE, name: str = "work.c") -> list[tuple[str, int, str, str]]:
    return [(e.kind, e.line, source[e.start:e.end], e.new) for e in edits_of(Path(name), source)]


class EditsTest(unittest.TestCase):
    def test_all_kinds_are_found_where_there_is_code(self) -> None:
        edits = found()
        self.assertEqual({kind for kind, *_ in edits}, set(KINDS))
        for expected in (("constant", 2, "3", "4"), ("arithmetic", 2, "+", "-"), ("constant", 3, "0.5f", "0.25f"),
                         ("comparison", 12, "<", "<="), ("comparison", 12, "&&", "||"), ("comparison", 12, "!", ""),
                         ("arithmetic", 13, "-", ""), ("arithmetic", 14, "++", "--"), ("arithmetic", 15, "*", "/"),
                         ("dropped", 15, "room[i] = p->a[i] * (int)-2;", ";"), ("arithmetic", 18, "+=", "-="),
                         ("dropped", 18, "n += *p->a;", ";"), ("comparison", 19, "==", "!="), ("arithmetic", 19, "&", "|")):
            self.assertIn(expected, edits)

    def test_texts_comments_declarations_and_what_a_pointer_points_to_are_left_alone(self) -> None:
        edits = found()
        self.assertFalse([e for e in edits if e[1] in (1, 4, 5, 7, 8, 9, 11)])
        self.assertFalse([e for e in edits if e[1] == 18 and e[2] == "*"])
        self.assertNotIn(("constant", 10, "8", "9"), edits)  # nothing could notice one more
        self.assertIn(("constant", 10, "8", "7"), edits)

    def test_lines_keep_their_numbers(self) -> None:
        for edit in edits_of(Path("work.c"), SOURCE):
            self.assertEqual(edit.apply(SOURCE).count("\n"), SOURCE.count("\n"))
            self.assertNotEqual(edit.apply(SOURCE), SOURCE)
            self.assertTrue(edit.first <= edit.line <= edit.last)
        dropped = next(e for e in edits_of(Path("work.c"), SOURCE) if e.kind == "dropped" and e.first == 16)
        self.assertEqual(dropped.shown(SOURCE), ("use(said, room);", ";"))
        self.assertEqual(dropped.function, "work")

    def test_of_a_header_only_its_functions(self) -> None:
        self.assertEqual({e[1] for e in found(name="work.h")}, {e[1] for e in found() if e[1] > 9})


class DrawingTest(unittest.TestCase):
    def test_a_seed_gives_the_same_faults_again_and_none_twice(self) -> None:
        by_line = drawing.faults_by_line(["firmware/base"])
        first, again = (list(drawing.draws(5, by_line)) for _ in range(2))
        self.assertEqual(first, again)
        self.assertEqual(len(set(first)), sum(len(faults) for faults in by_line.values()))
        self.assertNotEqual(first[:20], list(drawing.draws(6, by_line))[:20])

    def test_each_line_is_as_likely(self) -> None:
        by_line = drawing.faults_by_line(["firmware/base/error.c", "firmware/base/crc32.c"])
        counts = Counter((f.file, f.edit.line) for f in (next(drawing.draws(s, by_line)) for s in range(2000)))
        self.assertEqual(set(counts), set(by_line))
        mean = 2000 / len(by_line)
        self.assertTrue(all(abs(n - mean) < 5 * mean**0.5 for n in counts.values()), counts)

    def test_the_kept_equivalents_can_be_read(self) -> None:
        for (file, _, old, new), reason in drawing.equivalents().items():
            self.assertTrue((drawing.ROOT / file).is_file(), file)
            self.assertNotEqual(old, new)
            self.assertGreater(len(reason), 20)


class ListTest(unittest.TestCase):
    def test_each_fault_of_the_list_stands_in_its_file_once(self) -> None:
        cmd_mutate.check(cmd_mutate.load())  # raises, and names the fault


class OptionsTest(unittest.TestCase):
    def test_what_is_wrong_is_said(self) -> None:
        for arguments, because in ((["--random", "0"], "--random must be 1 or more"), (["--jobs", "0"], "--jobs must be 1"),
                                   (["no_such.c"], "no fault in no_such.c")):
            status, _, err = call("mutate", *arguments)
            self.assertEqual(status, 2)
            self.assertIn(because, err)


if __name__ == "__main__":
    unittest.main()
