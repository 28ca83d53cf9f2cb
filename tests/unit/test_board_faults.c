/* Faults of a virtual board's hardware fall on the instruction they were meant for, and what the processor stacks at a fault of its own is
 * the same in fast mode and in exact mode. The images are some halfwords of code. */
#include <stdlib.h>
#include <string.h>

#include "faults.h"
#include "models/models.h"
#include "replay.h"
#include "unity.h"

#define CODE    0x100u
#define HANDLER 0x180u
#define BASE    0x08000000u
#define STACK   0x20001000u
#define FRAME   (STACK - 32u)
#define CFSR    0xE000ED28u
#define RCC     0x40023800u

/* The handler reads what was stacked and stays. */
static const uint16_t handler[] = {0xE7FE};

static struct board *make(const uint16_t *code, size_t n, bool exact)
{
    static uint8_t image[0x400];
    static const struct surroundings around = {.crystal_hz = 8000000,
                                               .slow_clock_hz = 32000,
                                               .supply_mv = 3300,
                                               .brown_out_mv = 2700,
                                               .baud = 115200,
                                               .seed = 1};
    char err[200] = "";
    uint32_t vectors[16];
    for (unsigned i = 1; i < 16; i++)
        vectors[i] = BASE + HANDLER + 1u;
    vectors[0] = STACK;
    vectors[1] = BASE + CODE + 1u;
    (void)memset(image, 0, sizeof(image));
    (void)memcpy(image, vectors, sizeof(vectors));
    (void)memcpy(image + CODE, code, 2u * n);
    (void)memcpy(image + HANDLER, handler, sizeof(handler));
    struct board *b =
        board_new(&chip_stm32f405, &around, image, sizeof(image), exact, err, sizeof(err));
    TEST_ASSERT_NOT_NULL_MESSAGE(b, err);
    replay_begin(b);
    board_power_on(b);
    return b;
}

static void check_fault(const uint16_t *code, size_t n, uint32_t at, uint32_t status)
{
    uint8_t frames[2][32];
    for (unsigned exact = 0; exact < 2; exact++) {
        struct board *b = make(code, n, exact != 0);
        uint32_t pc = 0;
        board_run(b, 100000);
        TEST_ASSERT_EQUAL_STRING("", b->verdict);
        (void)memcpy(frames[exact], processor_memory(b, FRAME, 32), 32);
        (void)memcpy(&pc, frames[exact] + 24, 4);
        TEST_ASSERT_EQUAL_HEX32(BASE + CODE + at, pc);
        TEST_ASSERT_EQUAL_HEX32(status, bus_read(b, CFSR, 4) & status);
        board_free(b);
    }
    TEST_ASSERT_EQUAL_MEMORY(frames[0], frames[1], 32);
}

/* ldr r4,[pc,#..] of an address that is nothing, three harmless ones, the load, one more */
static void test_pc_of_a_bad_load(void)
{
    static const uint16_t code[] = {0x4C03, 0x2001, 0x3001, 0x3001, 0x6823,
                                    0x3001, 0xE7FE, 0xBF00, 0x0000, 0xA000};
    check_fault(code, 10, 8, 1u << 9);
}

static void test_pc_of_an_undefined_instruction(void)
{
    static const uint16_t code[] = {0x2001, 0x3001, 0xDE00, 0x3001, 0xE7FE};
    check_fault(code, 5, 4, 1u << 16);
}

/* CCR |= DIV_0_TRP, then two divisions, the second by nothing */
static void test_division_by_nothing_traps(void)
{
    static const uint16_t code[] = {0x4C07, 0x6820, 0xF040, 0x0010, 0x6020, 0x2064,
                                    0x2105, 0xFBB0, 0xF0F1, 0x2100, 0xFB90, 0xF0F1,
                                    0x3001, 0xE7FE, 0xBF00, 0xBF00, 0xED14, 0xE000};
    check_fault(code, 18, 20, UINT32_C(1) << 25);
}

static void test_division_by_nothing_gives_nothing_where_it_does_not_trap(void)
{
    static const uint16_t code[] = {0x2064, 0x2100, 0xFBB0, 0xF2F1, 0xE7FE};
    struct board *b = make(code, 5, false);
    board_run(b, 100000);
    TEST_ASSERT_EQUAL_HEX32(BASE + CODE + 8u, processor_pc(b));
    TEST_ASSERT_EQUAL_HEX32(0, bus_read(b, CFSR, 4));
    board_free(b);
}

/* vadd.f32 s0,s0,s0 before CPACR has been written */
static void test_numbers_without_their_unit(void)
{
    static const uint16_t code[] = {0x2001, 0x3001, 0xEE30, 0x0A00, 0x3001, 0xE7FE};
    check_fault(code, 6, 4, 1u << 19);
}

/* RCC of the STM32F405: crystal with clock security, core from the crystal, which then fails: 25 MHz, and 16 MHz from there on. */
static void test_a_run_ends_at_its_time_although_the_clock_changes_on_the_way(void)
{
    static const uint16_t code[] = {0xE7FE};
    static const char fails[] = "after_ns 1000000\ncrystal 0\n";
    struct board *b = make(code, 1, false);
    char err[BOARD_VERDICT];
    b->around.crystal_hz = 25000000;
    bus_write(b, RCC, 4, bus_read(b, RCC, 4) | 1u << 16 | 1u << 19);
    board_run(b, board_ns(b) + 5000000);
    bus_write(b, RCC + 8u, 4, 1);
    TEST_ASSERT_EQUAL(25000000, b->core_hz);
    uint64_t end = board_ns(b) + 10000000;
    TEST_ASSERT_TRUE(faults_add_text(b, fails, sizeof(fails) - 1u, err, sizeof(err)));
    board_run(b, end);
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
    TEST_ASSERT_EQUAL(16000000, b->core_hz);
    TEST_ASSERT_UINT64_WITHIN(1000, end, board_ns(b));
    board_free(b);
}

/* A loop of one block: r0 counts its turns. The core is held after each of 40 instructions in turn; where, is the place in the loop. */
static void test_a_fault_falls_on_any_instruction(void)
{
    static const uint16_t code[] = {0x2000, 0x3001, 0x2102, 0xF04F, 0x0203, 0x2304, 0xE7F9};
    static const uint32_t places[] = {2, 4, 6, 10, 12};
    for (uint32_t k = 1; k <= 40; k++) {
        struct board *b = make(code, 7, false);
        char err[200];
        TEST_ASSERT_TRUE(faults_add(b, FAULT_AFTER_INSTRUCTIONS, k, err, sizeof(err)));
        TEST_ASSERT_TRUE(faults_add(b, FAULT_HANG_MAIN, 1, err, sizeof(err)));
        board_run(b, 100000);
        TEST_ASSERT_EQUAL_HEX32(BASE + CODE + places[(k - 1u) % 5u], processor_pc(b));
        TEST_ASSERT_EQUAL_UINT64(k, b->instructions);
        board_free(b);
    }
}

/* The second of two conditional instructions is no place: the fault comes before the IT. */
static void test_a_fault_does_not_split_conditional_instructions(void)
{
    static const uint16_t code[] = {0x2000, 0x2800, 0xBF0C, 0x2107, 0x2109, 0x3001, 0xE7F9};
    static const uint32_t places[] = {2, 4, 4, 4, 10, 12};
    for (uint32_t k = 1; k <= 6; k++) {
        struct board *b = make(code, 7, false);
        char err[200];
        TEST_ASSERT_TRUE(faults_add(b, FAULT_AFTER_INSTRUCTIONS, k, err, sizeof(err)));
        TEST_ASSERT_TRUE(faults_add(b, FAULT_HANG_MAIN, 1, err, sizeof(err)));
        board_run(b, 100000);
        TEST_ASSERT_EQUAL_HEX32(BASE + CODE + places[k - 1u], processor_pc(b));
        board_free(b);
    }
}

static void test_power_cut_forgets_memory_and_keeps_flash(void)
{
    static const uint16_t code[] = {0xE7FE};
    char err[200];
    struct board *b = make(code, 1, false);
    static const uint8_t known[4] = {1, 2, 3, 4};
    (void)memcpy(processor_memory(b, 0x20000400u, 4), known, 4);
    stored_flash(b)->bytes[0] = 0x55;
    TEST_ASSERT_TRUE(
        faults_add_text(b, "after_ns 5000000\npower_cut 0.25\n", 32, err, sizeof(err)));
    board_run(b, 250000000);
    TEST_ASSERT_TRUE(b->held);
    board_run(b, 300000000);
    TEST_ASSERT_FALSE(b->held);
    TEST_ASSERT_EQUAL_UINT(2, b->resets[RESET_POWER]);
    TEST_ASSERT_TRUE(memcmp(processor_memory(b, 0x20000400u, 4), known, 4) != 0);
    TEST_ASSERT_EQUAL_HEX8(0x55, stored_flash(b)->bytes[0]);
    board_free(b);
}

static void test_brown_out_keeps_memory(void)
{
    static const uint16_t code[] = {0xE7FE};
    char err[200];
    struct board *b = make(code, 1, false);
    static const uint8_t known[4] = {1, 2, 3, 4};
    (void)memcpy(processor_memory(b, 0x20000400u, 4), known, 4);
    TEST_ASSERT_TRUE(faults_add(b, FAULT_RAMP_TIME, 0.1, err, sizeof(err)));
    TEST_ASSERT_TRUE(faults_add(b, FAULT_SUPPLY_RAMP, 2.3, err, sizeof(err)));
    board_run(b, 50000000);
    TEST_ASSERT_FALSE(b->held); /* 2.8 V */
    board_run(b, 65000000);
    TEST_ASSERT_TRUE(b->held); /* 2.65 V */
    board_run(b, 150000000);
    TEST_ASSERT_TRUE(faults_add(b, FAULT_SUPPLY, 3.3, err, sizeof(err)));
    board_run(b, 160000000);
    TEST_ASSERT_FALSE(b->held);
    TEST_ASSERT_EQUAL_UINT(1, b->resets[RESET_BROWN_OUT]);
    TEST_ASSERT_EQUAL_MEMORY(known, processor_memory(b, 0x20000400u, 4), 4);
    board_free(b);
}

static void test_flips_turn_as_many_bits(void)
{
    static const uint16_t code[] = {0xE7FE};
    char err[200];
    struct board *b = make(code, 1, false);
    uint8_t *before = malloc(0x20000);
    (void)memcpy(before, processor_memory(b, 0x20000000u, 0x20000), 0x20000);
    TEST_ASSERT_TRUE(faults_add(b, FAULT_PLACE, 7, err, sizeof(err)));
    TEST_ASSERT_TRUE(faults_add(b, FAULT_FLIP_RAM, 3, err, sizeof(err)));
    board_run(b, 1000000);
    const uint8_t *after = processor_memory(b, 0x20000000u, 0x20000);
    int turned = 0;
    for (size_t i = 0; i < 0x20000; i++)
        turned += __builtin_popcount((unsigned)before[i] ^ after[i]);
    TEST_ASSERT_EQUAL_INT(3, turned);
    free(before);
    board_free(b);
}

static void test_flips_stay_in_the_part_that_is_named(void)
{
    static const uint16_t code[] = {0xE7FE};
    static const char within[] = "flip_from 536871168\nflip_bytes 16\nflip_ram 5\n";
    static const char outside[] = "flip_from 134217728\nflip_ram 1\n";
    char err[200];
    struct board *b = make(code, 1, false);
    uint8_t *before = malloc(0x20000);
    (void)memcpy(before, processor_memory(b, 0x20000000u, 0x20000), 0x20000);
    TEST_ASSERT_TRUE(faults_add_text(b, within, sizeof(within) - 1u, err, sizeof(err)));
    board_run(b, 1000000);
    const uint8_t *after = processor_memory(b, 0x20000000u, 0x20000);
    TEST_ASSERT_TRUE(memcmp(before + 0x100, after + 0x100, 16) != 0);
    TEST_ASSERT_EQUAL_MEMORY(before, after, 0x100);
    TEST_ASSERT_EQUAL_MEMORY(before + 0x110, after + 0x110, 0x20000 - 0x110);
    TEST_ASSERT_TRUE(faults_add_text(b, outside, sizeof(outside) - 1u, err, sizeof(err)));
    board_run(b, 2000000);
    TEST_ASSERT_TRUE(strstr(b->verdict, "nothing of that memory") != NULL);
    free(before);
    board_free(b);
}

static void test_each_ramp_has_the_time_that_was_set_for_it(void)
{
    static const uint16_t code[] = {0xE7FE};
    static const char down_and_up[] = "ramp_time 0.01\nsupply_ramp 2\nramp_time 1\n"
                                      "after_ns 100000000\nsupply_ramp 3.3\n";
    char err[200];
    struct board *b = make(code, 1, false);
    TEST_ASSERT_TRUE(faults_add_text(b, down_and_up, sizeof(down_and_up) - 1u, err, sizeof(err)));
    board_run(b, 20000000);
    TEST_ASSERT_EQUAL_UINT32(2000, b->around.supply_mv);
    board_run(b, 600000000);
    TEST_ASSERT_UINT32_WITHIN(5, 2650, b->around.supply_mv);
    TEST_ASSERT_TRUE(b->held);
    board_run(b, 1200000000);
    TEST_ASSERT_EQUAL_UINT32(3300, b->around.supply_mv);
    TEST_ASSERT_FALSE(b->held);
    board_free(b);
}

static void test_the_diary_has_faults_and_resets_with_their_times(void)
{
    static const uint16_t code[] = {0xE7FE};
    static const char press[] = "after_ns 5000000\nbutton 0.25\n";
    char err[200], said[400] = "";
    struct board *b = make(code, 1, false);
    b->diary = tmpfile();
    TEST_ASSERT_NOT_NULL(b->diary);
    TEST_ASSERT_TRUE(faults_add_text(b, press, sizeof(press) - 1u, err, sizeof(err)));
    board_run(b, 300000000);
    rewind(b->diary);
    TEST_ASSERT_GREATER_THAN_size_t(0, fread(said, 1, sizeof(said) - 1u, b->diary));
    TEST_ASSERT_TRUE(strncmp(said, "0.005000000 fault button 0.25\n", 30) == 0);
    TEST_ASSERT_TRUE(strstr(said, "0.005000000 held pin\n") != NULL);
    TEST_ASSERT_TRUE(strstr(said, "0.255000000 reset pin\n") != NULL);
    (void)fclose(b->diary);
    board_free(b);
}

static void test_what_cannot_be_is_refused(void)
{
    static const uint16_t code[] = {0xE7FE};
    static const char *const wrong[] = {"power_cut 0\n", "crystal 1.5\n", "flip_ram 0.5\n",
                                        "meteor 1\n", "button\n"};
    struct board *b = make(code, 1, false);
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        char err[200] = "";
        TEST_ASSERT_FALSE_MESSAGE(faults_add_text(b, wrong[i], strlen(wrong[i]), err, sizeof(err)),
                                  wrong[i]);
        TEST_ASSERT_TRUE(err[0] != '\0');
    }
    board_free(b);
}

void setUp(void) {}

void tearDown(void) {}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_pc_of_a_bad_load);
    RUN_TEST(test_pc_of_an_undefined_instruction);
    RUN_TEST(test_division_by_nothing_traps);
    RUN_TEST(test_division_by_nothing_gives_nothing_where_it_does_not_trap);
    RUN_TEST(test_numbers_without_their_unit);
    RUN_TEST(test_a_run_ends_at_its_time_although_the_clock_changes_on_the_way);
    RUN_TEST(test_a_fault_falls_on_any_instruction);
    RUN_TEST(test_a_fault_does_not_split_conditional_instructions);
    RUN_TEST(test_power_cut_forgets_memory_and_keeps_flash);
    RUN_TEST(test_brown_out_keeps_memory);
    RUN_TEST(test_flips_turn_as_many_bits);
    RUN_TEST(test_flips_stay_in_the_part_that_is_named);
    RUN_TEST(test_each_ramp_has_the_time_that_was_set_for_it);
    RUN_TEST(test_the_diary_has_faults_and_resets_with_their_times);
    RUN_TEST(test_what_cannot_be_is_refused);
    return UNITY_END();
}
