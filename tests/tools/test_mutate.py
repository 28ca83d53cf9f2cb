#!/usr/bin/python3
"""tools/mutate --random: where a fault can be put in the firmware and in a port, and that a seed gives the same ones again."""

from __future__ import annotations

import unittest
from collections import Counter
from pathlib import Path

from support import call

from dev import cmd_mutate
from dev.mutation import board, drawing, registers
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


HEADER = """\
#define PORT_CR      REG32(0x40000000u)
#define PORT_SR(n)   REG32(0x40000004u + (n))
#define PORT_CR_ON   BIT(0)
#define PORT_CR_N(n) ((n) << 4)
#define PORT_CR_ADDRESS 0x40000000u
"""
PORT = """\
static bool wait_ready(volatile uint32_t *reg)
{
    for (unsigned i = 0; i < 9; i++) {
        if (*reg != 0) {
            return true;
        }
    }
    return false;
}

void port_start(void)
{
    PORT_CR = PORT_CR_N(3);
    /* then */
    PORT_SR(1) = 0;
    if (PORT_SR(2) != 0)
        PORT_CR |= PORT_CR_ON;
    PORT_CR &= ~PORT_CR_ON;
    (void)PORT_CR;
    use(PORT_CR_ADDRESS);
    if (!wait_ready(&PORT_CR))
        return;
    wait_ready(&PORT_SR(0));
    __asm volatile("msr basepri, %0\\n\\tdsb\\n\\tisb" : : "r"(1) : "memory");
}
"""


class RegistersTest(unittest.TestCase):
    def of_kind(self, kind: str) -> set[tuple[str, str]]:
        found = [e for e in registers.edits_in(PORT, HEADER) if e.kind == kind]
        for edit in found:
            self.assertEqual(edit.apply(PORT).count("\n"), PORT.count("\n"))
        return {(" ".join(PORT[e.start:e.end].split()), " ".join(e.new.split())) for e in found}

    def test_each_write_of_a_register_is_left_out(self) -> None:
        self.assertEqual(self.of_kind("write"), {(write, ";") for write in ("PORT_CR = PORT_CR_N(3);", "PORT_SR(1) = 0;", "PORT_CR |= PORT_CR_ON;",
                                                                            "PORT_CR &= ~PORT_CR_ON;")})

    def test_writes_are_swapped_where_nothing_stands_between_them(self) -> None:
        self.assertEqual(self.of_kind("swap"), {("PORT_CR = PORT_CR_N(3); /* then */ PORT_SR(1) = 0;", "PORT_SR(1) = 0; /* then */ PORT_CR = PORT_CR_N(3);")})

    def test_bits_move_up_and_set_turns_into_clear(self) -> None:
        self.assertEqual(self.of_kind("bit"), {
            ("PORT_CR_N(3)", "(PORT_CR_N(3) << 1)"), ("PORT_CR_ON", "(PORT_CR_ON << 1)"),
            ("PORT_CR |= PORT_CR_ON;", "PORT_CR &= ~(PORT_CR_ON);"), ("PORT_CR &= ~PORT_CR_ON;", "PORT_CR |= PORT_CR_ON;")})

    def test_waits_are_left_out(self) -> None:
        loop = "for (unsigned i = 0; i < 9; i++) { if (*reg != 0) { return true; } }"
        self.assertEqual(self.of_kind("wait"), {(loop, ";"), ("(void)PORT_CR;", ";"), ("wait_ready(&PORT_CR)", "true"), ("wait_ready(&PORT_SR(0))", "")})

    def test_each_barrier_is_left_out(self) -> None:
        self.assertEqual(self.of_kind("barrier"), {("dsb\\n\\t", ""), ("isb", "")})

    def test_every_port_has_faults_of_each_kind(self) -> None:
        for name in board.SCRIPTS:
            kinds = {f.edit.kind for faults in drawing.faults_by_line([], name).values() for f in faults}
            self.assertEqual(kinds, set(board.KINDS))

    def test_the_tests_of_a_board_stand_in_its_scripts(self) -> None:
        for name in board.SCRIPTS:
            names = [t.name for t in board.board_tests(name)]
            self.assertEqual(len(names), len(set(names)))
            self.assertIn("StartTest.test_the_images_start_as_on_a_chip", names)
            self.assertFalse({n.split(".")[-1] for n in names} & set(board.OTHER_CHIP[name]))


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
                                   (["no_such.c"], "no fault in no_such.c"), (["--kind", "bit"], "--kind goes with --board"),
                                   (["--board", "stm32f405"], "--board with --random or --again")):
            status, _, err = call("mutate", *arguments)
            self.assertEqual(status, 2)
            self.assertIn(because, err)


if __name__ == "__main__":
    unittest.main()
