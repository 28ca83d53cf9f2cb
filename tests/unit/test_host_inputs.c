/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* Inputs of the host: levels, counted edges and conversions of what the world has at its pins. */
#include "buses.h"
#include "hal/analog.h"
#include "hal/clock.h"
#include "hal/pulse.h"
#include "unity.h"

static uint64_t clock_ms;

uint64_t hal_clock_ms(void)
{
    return clock_ms;
}

void setUp(void)
{
    clock_ms = 1000;
    buses_set_world(NULL);
    buses_reset();
}

void tearDown(void)
{
    buses_reset();
    buses_set_world(NULL);
}

static void an_open_input_has_the_level_of_its_pull_up(void)
{
    hal_pin_use(HAL_PIN('C', 8), HAL_PIN_INPUT_PULLED);
    TEST_ASSERT_TRUE(hal_pin_read(HAL_PIN('C', 8)));
    buses_set_pin(HAL_PIN('C', 8), PIN_LEVEL_LOW);
    TEST_ASSERT_FALSE(hal_pin_read(HAL_PIN('C', 8)));
    buses_set_pin(HAL_PIN('C', 8), PIN_LEVEL_HIGH);
    TEST_ASSERT_TRUE(hal_pin_read(HAL_PIN('C', 8)));
    buses_set_pin(HAL_PIN('C', 8), PIN_LEVEL_OPEN);
    TEST_ASSERT_TRUE(hal_pin_read(HAL_PIN('C', 8)));
}

static enum pin_level low_at_c8(void *context, uint64_t now_ns, unsigned pin)
{
    (void)context;
    (void)now_ns;
    return pin == HAL_PIN('C', 8) ? PIN_LEVEL_LOW : PIN_LEVEL_OPEN;
}

static void an_input_has_the_level_that_the_world_gives_it(void)
{
    const struct world wired = {.pin_input = low_at_c8};
    hal_pin_use(HAL_PIN('C', 8), HAL_PIN_INPUT_PULLED);
    hal_pin_use(HAL_PIN('C', 7), HAL_PIN_INPUT_PULLED);
    buses_set_world(&wired);
    TEST_ASSERT_FALSE(hal_pin_read(HAL_PIN('C', 8)));
    TEST_ASSERT_TRUE(hal_pin_read(HAL_PIN('C', 7)));
    buses_set_pin(HAL_PIN('C', 7), PIN_LEVEL_LOW);
    TEST_ASSERT_FALSE(hal_pin_read(HAL_PIN('C', 7))); /* the world says nothing about it */
    buses_set_pin(HAL_PIN('C', 7), PIN_LEVEL_OPEN);
}

static void falling_edges_are_pulses(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_pulse_open(HAL_PIN('C', 9)));
    for (unsigned i = 0; i < 7; i++) {
        buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_LOW);
        buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_LOW); /* no edge */
        buses_set_pin(HAL_PIN('C', 9), i % 2 ? PIN_LEVEL_OPEN : PIN_LEVEL_HIGH);
    }
    TEST_ASSERT_EQUAL_UINT32(7, hal_pulse_count(HAL_PIN('C', 9)));
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_pulse_open(HAL_PIN('C', 9)));
    TEST_ASSERT_EQUAL_UINT32(0, hal_pulse_count(HAL_PIN('C', 9)));
}

/* A pin that is pulled down and let go after so many ms each. */
static const uint64_t moved_ms[] = {1010, 1011, 1012, 1014, 1020, 1021, 1025, 1026, 1031, 1032};
#define MOVES (sizeof moved_ms / sizeof *moved_ms)

static uint64_t next_move(void *context, uint64_t now_ns)
{
    (void)context;
    for (unsigned i = 0; i < MOVES; i++)
        if (moved_ms[i] * 1000000u > now_ns)
            return moved_ms[i] * 1000000u;
    return UINT64_MAX;
}

static enum pin_level moved(void *context, uint64_t now_ns, unsigned pin)
{
    unsigned i = 0;
    (void)context;
    while (i < MOVES && moved_ms[i] * 1000000u <= now_ns)
        i++;
    return pin == HAL_PIN('C', 9) && i % 2 != 0 ? PIN_LEVEL_LOW : PIN_LEVEL_OPEN;
}

static void edges_that_the_world_makes_are_counted_whenever_somebody_asks(void)
{
    const struct world moving = {.pin_input = moved, .next_edge = next_move};
    buses_set_world(&moving);
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_pulse_open(HAL_PIN('C', 9)));
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_pulse_open(HAL_PIN('C', 8)));
    clock_ms = 1015;
    TEST_ASSERT_EQUAL_UINT32(2, hal_pulse_count(HAL_PIN('C', 9)));
    TEST_ASSERT_EQUAL_UINT32(2, hal_pulse_count(HAL_PIN('C', 9)));
    clock_ms = 2000;
    TEST_ASSERT_EQUAL_UINT32(5, hal_pulse_count(HAL_PIN('C', 9)));
    TEST_ASSERT_EQUAL_UINT32(0, hal_pulse_count(HAL_PIN('C', 8)));
}

static void the_turn_of_the_clock_counts_edges_before_the_world_is_another_one(void)
{
    const struct world moving = {.pin_input = moved, .next_edge = next_move};
    buses_set_world(&moving);
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_pulse_open(HAL_PIN('C', 9)));
    clock_ms = 2000;
    buses_clock();
    buses_set_world(NULL);
    TEST_ASSERT_EQUAL_UINT32(5, hal_pulse_count(HAL_PIN('C', 9)));
}

static void an_edge_within_the_dead_time_of_the_one_before_is_a_bounce(void)
{
    const struct world moving = {.pin_input = moved, .next_edge = next_move};
    buses_set_world(&moving);
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_pulse_open(HAL_PIN('C', 9)));
    hal_pulse_set_dead_time(HAL_PIN('C', 9), 6);
    clock_ms = 2000;
    TEST_ASSERT_EQUAL_UINT32(3, hal_pulse_count(HAL_PIN('C', 9))); /* at 1010, 1020 and 1031 */
}

static double volts_at_pin;
static double pin_volts(void *context, uint64_t now_ns, unsigned pin)
{
    (void)context;
    (void)now_ns;
    return pin == HAL_PIN('C', 0) ? volts_at_pin : 0.0;
}

/* As often as the mean has conversions. */
static void convert(void)
{
    for (unsigned i = 0; i < 16; i++)
        buses_clock();
}

static void an_analogue_input_is_the_mean_of_16_conversions(void)
{
    struct world volts = {.pin_volts = pin_volts};
    uint16_t code;
    buses_set_world(&volts);
    volts_at_pin = 0.0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_analog_open(HAL_PIN('C', 0)));
    for (unsigned i = 0; i < 16; i++) {
        TEST_ASSERT_FALSE(hal_analog_read(HAL_PIN('C', 0), &code));
        buses_clock();
    }
    volts_at_pin = 3.3;
    for (unsigned i = 1; i <= 16; i++) {
        buses_clock();
        TEST_ASSERT_TRUE(hal_analog_read(HAL_PIN('C', 0), &code));
        TEST_ASSERT_DOUBLE_WITHIN(16.0, 4096.0 * i, code);
    }
}

static void an_analogue_input_is_a_part_of_the_reference(void)
{
    struct world volts = {.pin_volts = pin_volts};
    static const double at[] = {0.0, 0.33, 1.65, 3.0, 3.3};
    uint16_t code;
    buses_set_world(&volts);
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_analog_open(HAL_PIN('C', 0)));
    for (unsigned i = 0; i < sizeof at / sizeof *at; i++) {
        volts_at_pin = at[i];
        convert();
        TEST_ASSERT_TRUE(hal_analog_read(HAL_PIN('C', 0), &code));
        TEST_ASSERT_DOUBLE_WITHIN(3.3 / 4096, at[i],
                                  code * (double)hal_analog_reference() / HAL_ANALOG_FULL);
    }
    volts_at_pin = 5.0;
    convert();
    TEST_ASSERT_TRUE(hal_analog_read(HAL_PIN('C', 0), &code));
    TEST_ASSERT_EQUAL_UINT16(HAL_ANALOG_FULL, code);
    volts_at_pin = -1.0;
    convert();
    TEST_ASSERT_TRUE(hal_analog_read(HAL_PIN('C', 0), &code));
    TEST_ASSERT_EQUAL_UINT16(0, code);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, hal_analog_open(HAL_PIN('C', 8)));
}

static void an_analogue_input_without_a_world_is_0(void)
{
    uint16_t code = 1;
    TEST_ASSERT_EQUAL_INT(ERR_OK, hal_analog_open(HAL_PIN('C', 0)));
    convert();
    TEST_ASSERT_TRUE(hal_analog_read(HAL_PIN('C', 0), &code));
    TEST_ASSERT_EQUAL_UINT16(0, code);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_open_input_has_the_level_of_its_pull_up);
    RUN_TEST(an_input_has_the_level_that_the_world_gives_it);
    RUN_TEST(falling_edges_are_pulses);
    RUN_TEST(edges_that_the_world_makes_are_counted_whenever_somebody_asks);
    RUN_TEST(the_turn_of_the_clock_counts_edges_before_the_world_is_another_one);
    RUN_TEST(an_edge_within_the_dead_time_of_the_one_before_is_a_bounce);
    RUN_TEST(an_analogue_input_is_the_mean_of_16_conversions);
    RUN_TEST(an_analogue_input_is_a_part_of_the_reference);
    RUN_TEST(an_analogue_input_without_a_world_is_0);
    return UNITY_END();
}
