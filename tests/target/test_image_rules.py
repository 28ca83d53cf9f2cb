#!/usr/bin/python3
"""Small images, each with one fault, must be found out by the rules that tools/image applies."""

import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
sys.dont_write_bytecode = True

from dev import elf_image, image_check, kind_tables, stack_use  # noqa: E402
from reflux import memory_map  # noqa: E402
from reflux.errors import RunFailed  # noqa: E402

FLAGS = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-Os", "-g", "-fno-inline",
         "-ffunction-sections", "-fdata-sections",
         "-fno-optimize-sibling-calls", "-fstack-usage", "-nostartfiles", "-Wl,--gc-sections",
         "--specs=picolibc.specs"]
HEAD = """
#include <stdint.h>
extern uint32_t stack_bottom[], stack_top[];
void reset_entry(void); void tick(void); void fault_entry(void);
__attribute__((section(".vectors"), used)) const void *const vectors[] = {
    stack_top, (void *)reset_entry, (void *)fault_entry, (void *)tick, (void *)0xFFFFFFFF};
volatile int seen; volatile float number;
void fault_entry(void) { for (;;) seen++; }
"""
SCRIPT = """
MEMORY { flash (rx) : ORIGIN = 0x08000000, LENGTH = 64K  ram (rw) : ORIGIN = 0x20000000, LENGTH = 16K }
ENTRY(reset_entry)
SECTIONS {
  .text : { KEEP(*(.vectors)) *(.text .text.*) *(.rodata .rodata.*) } > flash
  .stack (NOLOAD) : { stack_bottom = .; . += 512; stack_top = .; } > ram
  .data : { *(.data .data.*) } > ram AT > flash
  .bss (NOLOAD) : { *(.bss .bss.*) *(COMMON) } > ram
  __heap_start = 0x20003000; __heap_end = 0x20004000;
  /DISCARD/ : { *(.ARM.exidx* .ARM.extab* .eh_frame* .note*) }
}
"""
BUDGET = """
[trial]
flash = 20000
ram = 4096
levels = [["reset_entry"], ["tick"], ["fault_entry"]]
[trial.layers]
other = [20000, 100, 4096]
libc = [20000, 500, 4096]
libgcc = [20000, 0, 0]
"""
CALM = "void tick(void) { number = number * 2.0f; } void reset_entry(void) { for (;;) seen++; }"
LEASED = "uint8_t workspace_memory[1000]; void keep(void) { workspace_memory[seen] = 1; }" + CALM.replace(
    "number = number", "keep(); number = number")
# Takes anything into the core-coupled memory, which the board's own script does not.
CCM_SCRIPT = SCRIPT.replace("LENGTH = 16K }", "LENGTH = 16K  ccm : ORIGIN = 0x10000000, LENGTH = 4K }").replace(
    "SECTIONS {", "SECTIONS {\n  .ccm (NOLOAD) : { *(.bss.workspace_memory) KEEP(*(.fast)) } > ccm")
HAL = Path(__file__).resolve().parents[2] / "hal"


class Rules(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def report(self, code: str, calls: str = "", budget: str = BUDGET, script: str = SCRIPT) -> image_check.Report:
        for name, text in (("trial.c", HEAD + code), ("trial.ld", script), ("budget.toml", budget),
                           ("calls.txt", calls)):
            (self.folder / name).write_text(text, encoding="utf-8")
        subprocess.run(["arm-none-eabi-gcc", *FLAGS, "trial.c", "-Ttrial.ld", "-Wl,-Map=reflux-trial.map", "-o",
                        "reflux-trial.elf", "-lc", "-lm"], cwd=self.folder, check=True, env={**os.environ, "LANG": "C"})
        return image_check.check(self.folder, self.folder / "budget.toml", self.folder / "calls.txt")

    def finds(self, expected: str, code: str, calls: str = "", budget: str = BUDGET, script: str = SCRIPT) -> None:
        found = self.report(code, calls, budget, script).findings
        self.assertTrue(any(expected in line for line in found), f"no {expected!r} in {found}")

    def test_a_clean_image_passes(self) -> None:
        report = self.report(CALM)
        self.assertEqual(report.findings, [])
        self.assertEqual(report.stack_reserved, 512)
        self.assertEqual([c.frame for c in report.contexts], [0, 108, 108])
        self.assertEqual(report.layers["other"].bss, 8)

    def test_heap(self) -> None:
        self.finds("heap: malloc", "#include <stdlib.h>\nvoid tick(void) { number = *(float *)malloc((unsigned)seen); }"
                   "void reset_entry(void) { for (;;) seen++; }")

    def test_double_precision(self) -> None:
        self.finds("double precision: __aeabi_d", "void tick(void) { number = (float)(number * 1.1); }"
                   "void reset_entry(void) { for (;;) seen++; }")
        self.finds("double precision", "#include <math.h>\nvoid tick(void) { number = powf(number, 1.5f); }"
                   "void reset_entry(void) { for (;;) seen++; }")

    def test_setjmp(self) -> None:
        self.finds("setjmp: ", "#include <setjmp.h>\njmp_buf b; void tick(void) { longjmp(b, 1); }"
                   "void reset_entry(void) { seen = setjmp(b); for (;;) seen++; }")

    def test_recursion_by_name_and_through_a_pointer(self) -> None:
        self.finds("recursion: even -> even", "int even(int n); int even(int n) { return n && even(n - seen) + 1; }"
                   "void tick(void) { seen = even(seen); }"
                   "void reset_entry(void) { for (;;) seen++; }")
        self.finds("recursion: ", "void again(void); void (*volatile hook)(void) = again;"
                   "void again(void) { hook(); seen++; } void tick(void) { again(); }"
                   "void reset_entry(void) { for (;;) seen++; }", "again: again  # the fault\n")

    def test_calls_through_pointers(self) -> None:
        code = ("void one(void) { seen = 1; } void two(void) { seen = 2; } void (*volatile hook)(void) = one;"
                "void (*volatile other)(void) = two; void tick(void) { hook(); } "
                "void reset_entry(void) { other = two; for (;;) seen++; }")
        self.finds("tick (trial.c:9) calls through a pointer and has no line in calls.txt; write there `tick: TARGET ...  # why", code)
        self.finds("the address of two is kept, but it is the target of no line in calls.txt; add two there", code, "tick: one  # hook\n")
        report = self.report(code, "tick: one two  # hook\n")
        self.assertEqual(report.findings, [])
        self.assertEqual(report.pointer_calls, 1)
        self.finds("the address of two is kept", code, "tick: o*  # a pattern, which two is not of\n")
        self.assertEqual(self.report(code, "tick: o* *wo  # hook\n").findings, [])

    def test_stack_too_small(self) -> None:
        code = ("void use(volatile char *); void use(volatile char *p) { p[seen] = 1; }"
                "void tick(void) { volatile char b[200]; use(b); }"
                "void reset_entry(void) { volatile char b[%d]; use(b); for (;;) seen++; }")
        self.finds("bytes can be needed, 512 are there", code % 200)
        report = self.report(code % 16)
        self.assertEqual(report.findings, [])
        # frames with the saved lr and padding, and what the processor pushes twice
        self.assertEqual(report.stack_needed, (16 + 8) + 208 + 2 * 108)

    def test_a_stack_that_cannot_be_followed_is_an_error(self) -> None:
        self.finds("cannot follow the stack pointer", "void use(char *); void use(char *p) { p[0] = (char)seen; }"
                   "void tick(void) { char b[seen]; use(b); } void reset_entry(void) { for (;;) seen++; }")

    def test_a_layer_without_a_row_gets_the_row_to_write(self) -> None:
        report = self.report(CALM, "", BUDGET.replace("other = ", "another = "))
        text = -(-report.layers["other"].text // 64) * 64
        self.assertRegex(report.findings[0], rf"^budget: layer other has no row in \[trial\.layers\] of \S*budget\.toml; it takes \d+ bytes of text, 0 of data, 8 of bss: write  other = \[{text}, 0, 64\]$")

    def test_a_handler_nobody_counted(self) -> None:
        self.finds("the vector table leads to tick, which is in no level", CALM, "",
                   BUDGET.replace('["tick"], ', ""))

    def test_a_layer_in_the_wrong_context(self) -> None:
        code = """
void shared(void) { seen++; }
void door(void) { shared(); seen = 3; }
void tick(void) { shared(); }
void reset_entry(void) { for (;;) door(); }
"""
        rules = """
[contexts]
main_loop = ["reset_entry"]
tick = ["tick"]
doors = ["%s"]
not_in_the_main_loop = [%s]
not_in_the_tick = [%s]
"""
        self.finds("contexts: other/ must not run in the tick: shared <-", code, budget=BUDGET + rules % ("door", "", '"other"'))
        self.finds("contexts: other/ must not run in the main loop: reset_entry", code,
                   budget=BUDGET + rules % ("door", '"other"', ""))
        self.finds("the image has no function gate", code, budget=BUDGET + rules % ("gate", "", ""))
        behind_the_door = self.report(code, budget=BUDGET + rules % ("door", '"other"', "")).findings
        self.assertFalse(any("shared <-" in line for line in behind_the_door), behind_the_door)

    def test_budget(self) -> None:
        self.finds("budget: bss of other is 8, 4 allowed", CALM, "", BUDGET.replace("[20000, 100, 4096]",
                                                                                  "[20000, 0, 4]"))
        self.finds("budget: flash is ", CALM, "", BUDGET.replace("flash = 20000", "flash = 10"))
        self.finds(", and 20000 are kept for families to come; 20000 allowed", CALM, "",
                   BUDGET + '[trial.families]\nnext = 20000\n')
        whole = BUDGET.replace("ram = 4096", "ram = 500\nworkspace = 1000\nsram_free = 14864")
        report = self.report(LEASED, "", whole)
        self.assertEqual(report.findings, [])  # it is nobody's: neither in a layer nor owned for ever
        self.assertEqual((report.workspace(), report.ram(), report.ccm()), (1000, 8, 0))
        self.assertEqual(report.sram_free(), 16384 - 512 - 1008)  # without the stack, and it lies in the SRAM
        self.finds("budget: workspace is 1000, at least 1001 wanted", LEASED, "", whole.replace("= 1000", "= 1001"))
        self.finds("budget: sram free is 14864, at least 14865 wanted", LEASED, "", whole.replace("= 14864", "= 14865"))
        self.finds("budget: ram is 8, 7 allowed", LEASED, "", whole.replace("ram = 500", "ram = 7"))
        self.finds("budget: workspace is 0, at least 1000 wanted", CALM, "", whole)

    def test_a_workspace_in_core_coupled_memory_takes_no_sram(self) -> None:
        whole = BUDGET.replace("ram = 4096", "ram = 500\nworkspace = 1000\nsram_free = 15864\nccm = 1000")
        report = self.report(LEASED, "", whole, CCM_SCRIPT)
        self.assertEqual(report.findings, [])
        self.assertEqual((report.workspace(), report.ram(), report.ccm()), (1000, 8, 1000))
        self.assertEqual(report.sram_free(), 16384 - 512 - 8)
        self.finds("budget: ccm is 1000, 999 allowed", LEASED, "", whole.replace("ccm = 1000", "ccm = 999"), CCM_SCRIPT)

    def test_neither_code_nor_other_data_lies_in_core_coupled_memory(self) -> None:
        there = '__attribute__((section(".fast"), used)) '
        self.finds("ccm: quick lies in the core-coupled memory at 0x10000", f"{there}void quick(void) {{ seen++; }}" + LEASED,
                   script=CCM_SCRIPT)
        self.finds("ccm: received lies in the core-coupled memory at 0x10000", f"{there}uint8_t received[64];" + LEASED, script=CCM_SCRIPT)
        self.finds("ccm: hidden lies in the core-coupled memory at 0x10000", f"{there}static uint8_t hidden[64];" + LEASED,
                   script=CCM_SCRIPT)
        self.finds("ccm: stack_bottom lies in the core-coupled memory at 0x10000", LEASED,
                   script=CCM_SCRIPT.replace("stack_top = .; } > ram", "stack_top = .; } > ccm"))

    def test_code_that_runs_while_the_flash_is_erased_reaches_nothing_in_it(self) -> None:
        script = SCRIPT.replace(".data : {", ".data : { *(.ram_code)")
        there = '__attribute__((section(".ram_code"), noinline)) static void waits(void) '
        for code in (f"{there}{{ while (seen) number = 1; }}",  # what it reaches lies in the SRAM
                     f"{there}{{ while (seen) ; }}"):
            found = self.report(code + CALM.replace("number = number", "waits(); number = number"), script=script).findings
            self.assertEqual([f for f in found if f.startswith("ram code")], [])
        elsewhere = "const int table[] = {1, 2, 5}; __attribute__((noinline)) static void helps(void) { seen = 3; }"
        for name, code in (("waits", f"{there}{{ seen = table[seen]; }}"), ("__helps_veneer", f"{there}{{ helps(); seen = 2; }}")):
            self.finds(f"ram code: {name} runs while the flash is erased and reaches 0x80000",
                       elsewhere + code + CALM.replace("number = number", "waits(); number = number"), script=script)

    def link_as_on_the_board(self, code: str) -> "subprocess.CompletedProcess[str]":
        (self.folder / "trial.c").write_text(HEAD + code, encoding="utf-8")
        return subprocess.run(["arm-none-eabi-gcc", *FLAGS, "trial.c", f"-L{HAL / 'stm32'}", f"-T{HAL / 'stm32f405' / 'stm32f405.ld'}",
                               "-Wl,--no-gc-sections", "-o", "board.elf", "-lc"], cwd=self.folder, check=False, capture_output=True, text=True)

    def test_the_script_of_the_board_puts_the_workspace_alone_at_the_end_of_that_memory(self) -> None:
        done = self.link_as_on_the_board(
            '__attribute__((section(".fast"), used)) void quick(void) { seen++; }'
            '__attribute__((section(".ccm.received"), used)) uint8_t received[64];'
            '__attribute__((section(".bss.ccm"), used)) uint8_t other[64];' + LEASED.replace("[1000]", "[999]"))
        self.assertEqual(done.returncode, 0, done.stderr)
        image = elf_image.Image(self.folder / "board.elf")
        there = {name for name, address in image.symbols.items() if address >> 16 == 0x1000 and name[0] not in "$."}
        self.assertEqual(there, {"workspace_memory"})
        self.assertEqual(image.symbols["workspace_memory"], 0x10010000 - 1000)
        self.assertEqual(image.symbols["workspace_stand_in"], 0x20030000 - 1000)

    def test_a_workspace_that_memory_cannot_hold_does_not_link(self) -> None:
        self.assertEqual(self.link_as_on_the_board(LEASED.replace("[1000]", "[65536]")).returncode, 0)
        self.assertIn("the workspace does not fit into the CCM", self.link_as_on_the_board(LEASED.replace("[1000]", "[65544]")).stderr)


class Reading(unittest.TestCase):
    def test_stack_effects(self) -> None:
        for name, operands, expected in (
                ("push", "{r4, r5, lr}", 12), ("stmdb", "sp!, {r4, r5, r6, sl, lr}", 20), ("vpush", "{d8-d9}", 16),
                ("vpush", "{s16-s18}", 12), ("sub.w", "sp, sp, #580", 580), ("sub", "sp, #12", 12),
                ("str.w", "lr, [sp, #-4]!", 4), ("ldr.w", "pc, [sp], #4", -4), ("pop", "{r4, pc}", -8),
                ("ldmiane.w", "sp!, {r4, pc}", -8), ("add", "sp, #8", -8), ("mov", "sp, r7", None),
                ("sub.w", "sp, sp, r3", None), ("str", "r0, [sp, #4]", 0), ("add", "r0, sp, #4", 0)):
            self.assertEqual(stack_use.stack_effect(name, operands), expected, f"{name} {operands}")

    def test_layers(self) -> None:
        for path, layer in (("firmware/num/libreflux_num.a(accumulator.c.obj)", "num"),
                            ("CMakeFiles/x.dir/hal/stm32f405/uart.c.obj", "hal"),
                            ("/usr/lib/picolibc/lib/libc.a(strlen.o)", "libc"),
                            ("/usr/lib/gcc/libgcc.a(x.o)", "libgcc")):
            self.assertEqual(memory_map.layer_of(path), layer)


KIND_C = """
/* const struct block_kind none_kind = { */
static const struct block_verb far_verbs[] = {
    {"go", NULL, "a } in words, {1}", 0, 0, false, ACCESS_OPERATOR, run_go},
    {"halt", "s", "it", 0, 9, false,
     ACCESS_ENGINEER, run_halt},
};
const struct block_kind far_kind = {
    .name = "far",
    .stage = STAGE_FEED_FORWARD, /* where */
    .parameter = far_rows,
    .verb = far_verbs,
    .check = far_check,
    .step =
        far_step,
};
"""
BLOCK_H = """
enum block_stage { STAGE_CONTROL, STAGE_FEED_FORWARD };
struct block_kind {
    const char *name;
    uint16_t (*history)(const struct block_setup *setup);
    enum err (*check)(const struct block_setup *setup, struct block_fault *fault);
    void (*step)(void *state, struct block_io *io);
};
"""
OWN_C = "const struct block_kind own_kind = {\n    .stage = STAGE_CONTROL,\n    .algorithms = 1u << 1,\n    .step = own_step,\n};\n"


class KindTables(unittest.TestCase):
    """The sets that tools/image reads from the tables of the kinds."""

    def firmware(self, rows: str) -> Path:
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        for name, text in (("block/block.h", BLOCK_H), ("kinds/far/far.c", KIND_C), ("kinds/own/own_kind.c", OWN_C), ("app/kinds.c", rows)):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
        return folder

    def test_functions_are_found_by_entry_stage_and_use(self) -> None:
        sets = kind_tables.sets(self.firmware("&far_kind, &own_kind"))
        self.assertEqual({name: found for name, found in sets.items() if found}, {
            "@kinds_step": ["far_step", "own_step"], "@record_step": ["far_step"], "@own_step": ["own_step"],
            "@control_step": ["own_step"], "@feed_forward_step": ["far_step"], "@kinds_check": ["far_check"],
            "@record_check": ["far_check"], "@feed_forward_check": ["far_check"], "@kinds_verb": ["run_go", "run_halt"]})
        self.assertEqual(sets["@kinds_history"], [])

    def test_a_kind_whose_table_is_not_found_is_named(self) -> None:
        with self.assertRaisesRegex(RunFailed, "near_kind of firmware/app/kinds.c: no `const struct block_kind near_kind"):
            kind_tables.sets(self.firmware("&far_kind, &near_kind"))

    def test_every_kind_of_the_firmware_has_a_step(self) -> None:
        kinds = re.findall(r"^\s*(?:\w+\(\s*)?&(\w+)_kind\b", (kind_tables.FIRMWARE / "app" / "kinds.c").read_text(), re.MULTILINE)
        self.assertEqual(len(kind_tables.sets()["@kinds_step"]), len(kinds))
        self.assertGreater(len(kinds), 16)


if __name__ == "__main__":
    unittest.main()
