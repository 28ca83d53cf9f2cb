/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* Outputs of every kind drive loads as they are commanded, and inputs that are pins of the board read what is wired to them. */
#include "pins_bench.h"

static const char wiring[] = "T1   max31865 spi1 PA4\n"
                             "Q    ssr      PB0\n"
                             "E    relay    PB1\n"
                             "W    pwm      PB6\n"
                             "X    pwm      PB7  active=low\n"
                             "R    relay    PC1  active=low\n";

static void set(const char *group, unsigned i, const char *field, const char *value)
{
    char line[80];
    snprintf(line, sizeof line, "set %s%u.%s %s", group, i, field, value);
    ask_ok(line);
}

/* An output and its manipulated variable, 0 to 1. */
static void output(unsigned i, const char *name, const char *kind, const char *pin)
{
    set("out", i, "name", name);
    set("out", i, "kind", kind);
    set("out", i, "pin", pin);
    set("out", i, "hi", "1");
    set("mv", i, "name", name);
    set("mv", i, "hi", "1");
    set("mv", i, "max", "1");
}

static void input(unsigned i, const char *name, const char *device, const char *pin)
{
    set("chan", i, "name", name);
    set("chan", i, "device", device);
    set("chan", i, "select", pin);
    set("meas", i, "name", name);
}

void setUp(void)
{
    pins_power_on(wiring);
    PINS_ASK("begin", "set io.source board", "set tick.base 1");
    PINS_ASK("set chan1.bus spi1", "set chan1.unit degC", "set meas1.unit degC");
    input(1, "T1", "max31865", "PA4");
}

void tearDown(void)
{
    pins_close();
    buses_set_pin(HAL_PIN('C', 8), PIN_LEVEL_OPEN);
    buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_OPEN);
}

static void in_force(void)
{
    PINS_ASK("apply", "log on");
    pins_samples(5);
}

/* ---- outputs ---- */

static void is_on_for(const char *load, double command, double within)
{
    char line[40];
    snprintf(line, sizeof line, "out %s %g", load, command);
    ask_ok(line);
    pass(10000);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(within, command, pins_mean(load, 20000), line);
}

static void a_burst_is_on_for_the_part_that_is_commanded(void)
{
    output(1, "Q", "burst", "PB0");
    in_force();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_mean("Q", 5000));
    is_on_for("Q", 0.25, 0.01);
    is_on_for("Q", 0.8, 0.01);
    is_on_for("Q", 1.0, 0.01);
    is_on_for("Q", 0.0, 0.0);
}

static void a_pulse_width_is_the_part_that_is_commanded(void)
{
    output(1, "W", "pwm", "PB6");
    output(2, "X", "pwm", "PB7");
    set("out", 2, "active", "low");
    in_force();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_mean("W", 5000));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_mean("X", 5000));
    is_on_for("W", 0.25, 1e-4);
    is_on_for("X", 0.75, 1e-4);
    is_on_for("W", 1.0, 1e-4);
    is_on_for("X", 0.0, 0.0);
}

static void a_relay_is_on_above_one_half(void)
{
    output(1, "R", "relay", "PC1");
    set("out", 1, "active", "low");
    in_force();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_mean("R", 5000));
    PINS_ASK("out R 0.8");
    pass(3000);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, pins_mean("R", 10000));
    PINS_ASK("out R 0.2");
    pass(3000);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_mean("R", 10000));
}

static void outputs_of_every_kind_go_off_when_ticks_stop(void)
{
    static const char *const loads[] = {"Q", "W", "X", "R"};
    double before[4];
    output(1, "Q", "window", "PB0");
    output(2, "W", "pwm", "PB6");
    output(3, "X", "pwm", "PB7");
    output(4, "R", "relay", "PC1");
    set("out", 3, "active", "low");
    set("out", 4, "active", "low");
    in_force();
    PINS_ASK("out Q 1", "out W 1", "out X 1", "out R 1");
    pass(10000);
    for (unsigned i = 0; i < 4; i++)
        TEST_ASSERT_TRUE_MESSAGE(pins_mean(loads[i], 2000) > 0.9, loads[i]);
    pins_stall(2100);
    for (unsigned i = 0; i < 4; i++)
        before[i] = pins_on_s(loads[i]);
    pins_stall(5000);
    for (unsigned i = 0; i < 4; i++)
        TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(before[i], pins_on_s(loads[i]), loads[i]);
}

static void the_contactor_of_the_heaters_opens_when_ticks_stop(void)
{
    output(1, "Q", "window", "PB0");
    set("out", 1, "heater", "on");
    set("out", 2, "name", "E");
    set("out", 2, "kind", "enable");
    set("out", 2, "pin", "PB1");
    set("out", 2, "least_off", "1");
    in_force();
    PINS_ASK("out Q 1");
    pass(10000);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, pins_mean("E", 5000));
    TEST_ASSERT_TRUE(pins_mean("Q", 4000) > 0.9);
    pins_stall(2500);
    double contactor = pins_on_s("E"), heater = pins_on_s("Q");
    pins_stall(5000);
    TEST_ASSERT_EQUAL_DOUBLE(contactor, pins_on_s("E"));
    TEST_ASSERT_EQUAL_DOUBLE(heater, pins_on_s("Q"));
}

/* Nothing is wired to these pins. */
static void a_chip_that_does_not_answer_is_told_and_its_output_does_not_follow(void)
{
    output(1, "V", "ad5422", "PB0");
    set("out", 1, "pin2", "PB1");
    set("out", 1, "bus", "spi1");
    set("mv", 1, "follow", "3");
    in_force();
    PINS_ASK("out V 0.5");
    pass(10000);
    ask_ok("events");
    TEST_ASSERT_EQUAL_UINT_MESSAGE(
        1, times_said("OUTPUT_FAULT V 8 output at the board's pins has a fault: no chip"),
        board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("NOT_FOLLOWING V "), board.said);
}

static void mains_that_do_not_come_are_told_once(void)
{
    output(1, "Q", "burst", "PB0");
    set("out", 1, "zero_cross", "PC0");
    in_force();
    is_on_for("Q", 0.25, 0.01); /* it goes on without them */
    ask_ok("events");
    TEST_ASSERT_EQUAL_UINT_MESSAGE(1, times_said("OUTPUT_FAULT Q 64"), board.said);
}

static void the_contactor_is_no_manipulated_variable(void)
{
    set("out", 1, "name", "E");
    set("out", 1, "kind", "enable");
    set("out", 1, "pin", "PB1");
    set("out", 1, "least_off", "1");
    output(2, "Q", "window", "PB0");
    set("mv", 1, "name", "-");
    in_force();
    is_on_for("Q", 0.5, 0.01); /* its command is not taken for the contactor's */
}

/* ---- inputs ---- */

static void a_contact_is_a_level(void)
{
    input(2, "S", "level", "PC8");
    in_force();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, pins_field("S"));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_field("S.q"));
    buses_set_pin(HAL_PIN('C', 8), PIN_LEVEL_LOW);
    pins_samples(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.0, pins_field("S")); /* fixed point rounds it */
    buses_set_pin(HAL_PIN('C', 8), PIN_LEVEL_OPEN);
    pins_samples(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, pins_field("S"));
}

static void pulses_are_a_flow(void)
{
    input(2, "F", "flow", "PC9");
    in_force();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_field("F"));
    board_forget();
    for (unsigned i = 0; i < 100; i++) { /* 10 pulses each 0.5 s */
        buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_LOW);
        buses_set_pin(HAL_PIN('C', 9), PIN_LEVEL_HIGH);
        pass(50);
    }
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 20.0, pins_field("F")); /* a pulse more or less each 0.5 s */
    pins_samples(3);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_field("F"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_burst_is_on_for_the_part_that_is_commanded);
    RUN_TEST(a_pulse_width_is_the_part_that_is_commanded);
    RUN_TEST(a_relay_is_on_above_one_half);
    RUN_TEST(outputs_of_every_kind_go_off_when_ticks_stop);
    RUN_TEST(the_contactor_of_the_heaters_opens_when_ticks_stop);
    RUN_TEST(a_chip_that_does_not_answer_is_told_and_its_output_does_not_follow);
    RUN_TEST(mains_that_do_not_come_are_told_once);
    RUN_TEST(the_contactor_is_no_manipulated_variable);
    RUN_TEST(a_contact_is_a_level);
    RUN_TEST(pulses_are_a_flow);
    return UNITY_END();
}
