/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* The world of a wiring file: loads behind a chip, which follow its current, and pumps with a stepper. */
#include "wired_bench.h"

void setUp(void)
{
    begin_wired();
}

void tearDown(void)
{
    end_wired();
}

static void frame(uint64_t now_ns, uint8_t command, uint16_t value)
{
    void *c = world->context;
    drive(now_ns, 'C', 4, PIN_LOW);
    (void)world->spi_exchange(c, now_ns, 1, 0, command);
    (void)world->spi_exchange(c, now_ns, 1, 0, (uint8_t)(value >> 8));
    (void)world->spi_exchange(c, now_ns, 1, 0, (uint8_t)value);
    drive(now_ns, 'C', 4, PIN_HIGH);
}

/* 4 to 20 mA, enabled, half way, CLEAR driven low. */
static void half_way(uint64_t now_ns)
{
    drive(now_ns, 'C', 4, PIN_HIGH);
    drive(now_ns, 'C', 5, PIN_LOW);
    frame(now_ns, 0x55, 0x1005);
    frame(now_ns, 0x01, 0x8000);
}

static double only(uint64_t now_ns)
{
    double ns[WIRED_OUTPUTS_MAX];
    TEST_ASSERT_EQUAL_size_t(1, wired_loads(w, now_ns, ns));
    return ns[0];
}

static void open_loop(const char *properties)
{
    char text[128];
    (void)snprintf(text, sizeof(text), "Lr ad5422 spi1 PC4 clear=PC5 hi=12 %s\n", properties);
    open_text(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(w, err);
}

static void a_load_behind_a_chip_follows_its_current(void)
{
    open_loop("");
    TEST_ASSERT_EQUAL_DOUBLE(0.0, only(1 * S));
    half_way(1 * S);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 1e9, only(3 * S));
    frame(3 * S, 0x01, 0x4000);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 2e9, only(7 * S));
    TEST_ASSERT_EQUAL_STRING("", wiring_wrong(wired_wiring(w), NULL));
}

static void current_beyond_the_input_of_the_load_is_its_end(void)
{
    open_loop("lo_in=4 hi_in=10");
    half_way(1 * S);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 1e9, only(2 * S));
    frame(2 * S, 0x55, 0x0005); /* disabled: 0 mA */
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 1e9, only(3 * S));
}

static void a_transfer_counts_from_the_next_millisecond_on(void)
{
    open_loop("");
    (void)only(1 * S);
    half_way(1 * S + 5 * MS);
    double early = only(2 * S);
    open_loop("");
    (void)only(1 * S + 200000);
    half_way(1 * S + 5 * MS + 130000);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, early, only(2 * S + 200000));
}

static void a_clear_pin_that_nobody_drives_low_clears_the_load(void)
{
    static const enum pin_drive high[] = {PIN_FLOATS, PIN_PULLED_UP, PIN_PULLED_DOWN, PIN_HIGH};
    for (unsigned i = 0; i < sizeof(high) / sizeof(high[0]); i++) {
        open_loop("");
        half_way(1 * S);
        drive(2 * S, 'C', 5, high[i]);
        TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0.5e9, only(9 * S));
    }
}

static void a_chip_is_cleared_until_the_board_takes_its_clear_pin(void)
{
    open_loop("");
    drive(0, 'C', 4, PIN_HIGH);
    frame(1 * S, 0x55, 0x1005);
    frame(1 * S, 0x01, 0x8000);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, only(5 * S));
}

static void faults_of_a_chip_with_a_load_take_its_current(void)
{
    static const char *const faults[] = {"open", "missing", "broken", "brownout"};
    for (unsigned i = 0; i < sizeof(faults) / sizeof(faults[0]); i++) {
        open_loop("");
        half_way(1 * S);
        TEST_ASSERT_TRUE_MESSAGE(fault(2 * S, "Lr", faults[i], 1), err);
        drive(2 * S, 'C', 4, PIN_LOW); /* a chip looks at what befell it then */
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(2e6, 0.5e9, only(9 * S), faults[i]);
    }
    open_loop("");
    TEST_ASSERT_TRUE_MESSAGE(fault(2 * S, "Lr", "shorted", 1), err);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 1e9, only(3 * S));
    TEST_ASSERT_FALSE(fault(3 * S, "Lr", "nonsense", 1));
}

static void a_stepper_brings_its_volume_step_by_step(void)
{
    open_text("D stepper PB3 PB4 steps=1000 hi=3.6\n"); /* 1 ml/s: 1000 steps are 1 s */
    drive(0, 'B', 4, PIN_LOW);
    for (uint64_t k = 0; k < 250; k++) {
        drive(k * 2 * MS, 'B', 3, PIN_HIGH);
        drive(k * 2 * MS + 1 * MS, 'B', 3, PIN_LOW);
    }
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0.25e9, only(1 * S));
    drive(2 * S, 'B', 3, PIN_FLOATS);
    drive(3 * S, 'B', 4, PIN_HIGH); /* backwards */
    drive(3 * S, 'B', 3, PIN_HIGH);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0.25e9, only(4 * S));
    drive(5 * S, 'B', 4, PIN_LOW);
    drive(5 * S, 'B', 3, PIN_LOW);
    TEST_ASSERT_TRUE_MESSAGE(fault(6 * S, "D", "broken", 1), err);
    drive(7 * S, 'B', 3, PIN_HIGH);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 0.25e9, only(8 * S));
    TEST_ASSERT_FALSE(wiring_has(wired_wiring(w), "D", "shorted"));
}

static void a_step_of_a_stepper_that_is_on_when_low_is_its_falling_edge(void)
{
    open_text("D stepper PB3 steps=1000 hi=3.6 active=low\n");
    drive(1 * S, 'B', 3, PIN_HIGH);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, only(1 * S));
    drive(2 * S, 'B', 3, PIN_LOW);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 1e6, only(2 * S));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_load_behind_a_chip_follows_its_current);
    RUN_TEST(current_beyond_the_input_of_the_load_is_its_end);
    RUN_TEST(a_transfer_counts_from_the_next_millisecond_on);
    RUN_TEST(a_clear_pin_that_nobody_drives_low_clears_the_load);
    RUN_TEST(a_chip_is_cleared_until_the_board_takes_its_clear_pin);
    RUN_TEST(faults_of_a_chip_with_a_load_take_its_current);
    RUN_TEST(a_stepper_brings_its_volume_step_by_step);
    RUN_TEST(a_step_of_a_stepper_that_is_on_when_low_is_its_falling_edge);
    return UNITY_END();
}
