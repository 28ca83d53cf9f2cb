/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* The world of a wiring file: what its loads were over time, as their pins had it, and what lines of text do to its chips. */
#include <string.h>

#include "chips/chip.h"
#include "wired_bench.h"

static const char column[] = "T1  max31865 spi1 PA4  reference=430\n"
                             "T2  max31865 spi2 PC0\n"
                             "U   ads1115  i2c1 0x48 1\n"
                             "T3  ds18b20  wire1 rom=28-000005e2fdc3\n"
                             "Q   ssr      PB0       hi=3\n"
                             "E   relay    PB1       active=low\n"
                             "W   pwm      PB6\n"
                             "X   pwm      PB7       active=low\n"
                             "Lr  valve    PB8 PB9   travel=60\n";
enum { Q, E, W, X, LR, LOADS };

void setUp(void)
{
    begin_wired();
    open_text(column);
    TEST_ASSERT_NOT_NULL_MESSAGE(w, err);
}

void tearDown(void)
{
    end_wired();
}

/* Integral of one load up to now, ns. */
static double load(unsigned i, uint64_t now_ns)
{
    double ns[WIRED_OUTPUTS_MAX];
    TEST_ASSERT_EQUAL_size_t(LOADS, wired_loads(w, now_ns, ns));
    return ns[i];
}

/* ---- loads ---- */

static void a_load_counts_the_time_that_its_pin_was_on(void)
{
    drive(1 * S, 'B', 0, PIN_HIGH);
    drive(3 * S, 'B', 0, PIN_LOW);
    drive(4 * S, 'B', 0, PIN_HIGH);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 2e9, load(Q, 4 * S));
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 2.5e9, load(Q, 4 * S + 500 * MS));
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 2.5e9, load(Q, 4 * S + 500 * MS)); /* asked twice */
}

static void a_pin_that_nobody_drives_leaves_its_load_off(void)
{
    static const enum pin_drive none[] = {PIN_FLOATS, PIN_PULLED_UP, PIN_PULLED_DOWN, PIN_OF_BUS};
    TEST_ASSERT_EQUAL_DOUBLE(0.0, load(Q, 10 * S));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, load(E, 10 * S)); /* that is on when low */
    for (unsigned i = 0; i < sizeof(none) / sizeof(none[0]); i++) {
        drive(10 * S, 'B', 0, none[i]);
        drive(10 * S, 'B', 1, none[i]);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, load(Q, (20 + i) * S));
        TEST_ASSERT_EQUAL_DOUBLE(0.0, load(E, (20 + i) * S));
    }
}

static void a_load_that_is_on_when_low_counts_the_low_time(void)
{
    drive(0, 'B', 1, PIN_HIGH);
    drive(2 * S, 'B', 1, PIN_LOW);
    drive(5 * S, 'B', 1, PIN_HIGH);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 3e9, load(E, 9 * S));
}

static void each_load_follows_its_own_pin(void)
{
    drive(0, 'B', 0, PIN_HIGH);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 1e9, load(Q, 1 * S));
    for (unsigned i = Q + 1; i < LOADS; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(0.0, load(i, 1 * S));
    }
}

static void a_pulse_width_is_a_part_of_the_time(void)
{
    world->pin_pulses(world->context, 0, HAL_PIN('B', 6), 1000.0, 0.25);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 1e9, load(W, 4 * S));
    world->pin_pulses(world->context, 4 * S, HAL_PIN('B', 6), 1000.0, 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 2e9, load(W, 5 * S));
    world->pin_pulses(world->context, 5 * S, HAL_PIN('B', 6), 1000.0, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 2e9, load(W, 9 * S));
}

static void the_part_that_is_low_counts_where_low_is_on(void)
{
    world->pin_pulses(world->context, 0, HAL_PIN('B', 7), 1000.0, 0.25);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 3e9, load(X, 4 * S));
}

static void a_level_ends_the_pulses(void)
{
    world->pin_pulses(world->context, 0, HAL_PIN('B', 6), 1000.0, 0.5);
    drive(2 * S, 'B', 6, PIN_LOW);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 1e9, load(W, 9 * S));
    world->pin_pulses(world->context, 9 * S, HAL_PIN('B', 6), 1000.0, 0.5);
    drive(11 * S, 'B', 6, PIN_FLOATS);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 2e9, load(W, 20 * S));
}

/* ---- a valve with two pins ---- */

/* Mean position over a second in which nothing drives it. */
static double position(uint64_t now_ns)
{
    double before = load(LR, now_ns);
    return (load(LR, now_ns + 1 * S) - before) / 1e9;
}

static void a_valve_goes_as_long_as_it_is_driven(void)
{
    drive(0, 'B', 8, PIN_LOW);
    drive(0, 'B', 9, PIN_LOW);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, position(0));
    drive(10 * S, 'B', 8, PIN_HIGH);
    drive(25 * S, 'B', 8, PIN_LOW); /* 15 of 60 s */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.25, position(25 * S));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.25, position(100 * S));
    drive(200 * S, 'B', 9, PIN_HIGH);
    drive(206 * S, 'B', 9, PIN_LOW);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.15, position(206 * S));
}

static void a_valve_on_its_way_counts_its_mean_position(void)
{
    drive(0, 'B', 8, PIN_HIGH);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.5 * 30e9 * 0.5, load(LR, 30 * S)); /* 0 to 0.5 in 30 s */
}

static void a_valve_stops_at_its_ends(void)
{
    drive(0, 'B', 8, PIN_HIGH);
    /* A ramp of 60 s, then 40 s open, looked at once only. */
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 30e9 + 40e9, load(LR, 100 * S));
    drive(100 * S, 'B', 8, PIN_LOW);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, position(100 * S));
    double before = load(LR, 110 * S);
    drive(110 * S, 'B', 9, PIN_HIGH);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, before + 30e9, load(LR, 300 * S));
    drive(300 * S, 'B', 9, PIN_LOW);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, position(300 * S));
}

static void a_valve_driven_both_ways_stays(void)
{
    drive(0, 'B', 8, PIN_HIGH);
    drive(30 * S, 'B', 9, PIN_HIGH);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5, position(60 * S));
}

static void a_valve_is_what_it_is_however_often_one_looks(void)
{
    drive(0, 'B', 8, PIN_HIGH);
    for (uint64_t s = 1; s < 100; s++) {
        (void)load(LR, s * S);
    }
    TEST_ASSERT_DOUBLE_WITHIN(100.0, 70e9, load(LR, 100 * S));
}

static enum pin_level input(uint64_t now_ns, char port, unsigned pin)
{
    return world->pin_input(world->context, now_ns, HAL_PIN(port, (int)pin));
}

static void contacts_of_a_valve_close_at_its_ends_and_nowhere_else(void)
{
    open_text("Lr valve PB8 PB9 PC0 PC1 travel=60\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(w, err);
    TEST_ASSERT_EQUAL_INT(PIN_LEVEL_LOW, input(0, 'C', 1)); /* closed at first */
    TEST_ASSERT_EQUAL_INT(PIN_LEVEL_OPEN, input(0, 'C', 0));
    drive(10 * S, 'B', 8, PIN_HIGH);
    TEST_ASSERT_EQUAL_INT(PIN_LEVEL_OPEN, input(10 * S + 2 * MS, 'C', 1));
    TEST_ASSERT_EQUAL_INT(PIN_LEVEL_OPEN, input(40 * S, 'C', 1));
    TEST_ASSERT_EQUAL_INT(PIN_LEVEL_OPEN, input(70 * S - 2 * MS, 'C', 0));
    TEST_ASSERT_EQUAL_INT(PIN_LEVEL_LOW, input(70 * S, 'C', 0));
    TEST_ASSERT_EQUAL_INT(PIN_LEVEL_LOW, input(90 * S, 'C', 0)); /* driven against its end */
    TEST_ASSERT_EQUAL_INT(PIN_LEVEL_OPEN, input(90 * S, 'C', 2));
}

/* ---- faults and lines ---- */

static void a_shorted_load_is_on_and_a_broken_one_off_from_their_moment_on(void)
{
    TEST_ASSERT_TRUE_MESSAGE(fault(2 * S, "Q", "shorted", 1), err);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 3e9, load(Q, 5 * S));
    TEST_ASSERT_TRUE_MESSAGE(fault(5 * S, "Q", "shorted", 0), err);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 3e9, load(Q, 9 * S));
    drive(9 * S, 'B', 0, PIN_HIGH);
    TEST_ASSERT_TRUE_MESSAGE(fault(10 * S, "Q", "broken", 1), err);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 4e9, load(Q, 20 * S));
}

static void a_broken_valve_stays_where_it_is(void)
{
    drive(0, 'B', 8, PIN_HIGH);
    TEST_ASSERT_TRUE_MESSAGE(fault(15 * S, "Lr", "broken", 1), err);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.25, position(100 * S));
}

static void a_sensor_measures_what_it_is_given(void)
{
    wired_measure(w, 5 * S, "T2", 78.3);
    TEST_ASSERT_EQUAL_DOUBLE(78.3, wiring_sensor(wired_wiring(w), 1)->chip->input[0]);
    TEST_ASSERT_TRUE(wiring_sensor(wired_wiring(w), 0)->chip->input[0] != 78.3);
}

static size_t lines(char *text)
{
    return wired_lines(w, 1 * S, text, strlen(text), err, sizeof(err));
}

static void lines_of_pins_are_carried_out_and_the_others_left(void)
{
    char text[] = "supply 3.3\npins.T1 91.5\npins.T1.open 1\nbutton 1\npins.Q.shorted 1";
    size_t left = lines(text);
    TEST_ASSERT_EQUAL_STRING_LEN("supply 3.3\nbutton 1\n", text, left);
    TEST_ASSERT_EQUAL_size_t(strlen("supply 3.3\nbutton 1\n"), left);
    const struct chip *chip = wiring_sensor(wired_wiring(w), 0)->chip;
    TEST_ASSERT_EQUAL_DOUBLE(91.5, chip->input[0]);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, chip->input[chip_input_index(chip->kind, "open")]);
    TEST_ASSERT_DOUBLE_WITHIN(EXACT, 2e9, load(Q, 3 * S));
}

static void a_line_that_is_none_is_told(void)
{
    static const struct {
        const char *line, *words;
    } wrong[] = {{"pins.T1\n", "pins.T1: must be a name, a blank and a number"},
                 {"pins.T1 hot\n", "pins.T1 hot: must be a name, a blank and a number"},
                 {"pins.T9 5\n", "T9"},
                 {"pins.T9.open 1\n", "T9"},
                 {"pins.T1.nonsense 1\n", "nonsense"}};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        char text[64];
        (void)snprintf(text, sizeof(text), "%s", wrong[i].line);
        err[0] = '\0';
        TEST_ASSERT_TRUE_MESSAGE(lines(text) == SIZE_MAX, wrong[i].line);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err, wrong[i].words), err);
    }
}

/* ---- buses ---- */

static void chips_answer_on_their_buses_and_nobody_on_the_others(void)
{
    void *c = world->context;
    TEST_ASSERT_TRUE(world->i2c_address(c, 10 * MS, 1, 0x48, false));
    world->i2c_stop(c, 10 * MS, 1);
    TEST_ASSERT_FALSE(world->i2c_address(c, 10 * MS, 1, 0x49, false));
    TEST_ASSERT_FALSE(world->i2c_address(c, 10 * MS, 2, 0x48, false));
    TEST_ASSERT_EQUAL_INT(WIRE_PULLED, world->wire_reset(c, 10 * MS, 1));
    TEST_ASSERT_EQUAL_INT(WIRE_SILENT, world->wire_reset(c, 10 * MS, 2));
    TEST_ASSERT_EQUAL_INT(WIRE_SILENT, world->wire_bit(c, 11 * MS, 2, true));
    TEST_ASSERT_EQUAL_HEX8(0xFF, world->spi_exchange(c, 10 * MS, 3, 1, 0));
}

/* Register 3 of a MAX31865 holds the upper fault threshold, FFh at power-on (data sheet of the MAX31865, table 1). */
static uint8_t high_threshold(unsigned bus, char port, int number)
{
    void *c = world->context;
    drive(20 * MS, port, number, PIN_LOW);
    (void)world->spi_exchange(c, 20 * MS, bus, 1, 0x03);
    uint8_t answer = world->spi_exchange(c, 20 * MS, bus, 1, 0);
    drive(21 * MS, port, number, PIN_HIGH);
    return answer;
}

static void a_chip_listens_while_its_select_is_low(void)
{
    void *c = world->context;
    drive(1 * MS, 'A', 4, PIN_HIGH);
    drive(1 * MS, 'C', 0, PIN_HIGH);
    drive(2 * MS, 'A', 4, PIN_LOW); /* writes 12h to the threshold of the first */
    (void)world->spi_exchange(c, 3 * MS, 1, 1, 0x83);
    (void)world->spi_exchange(c, 3 * MS, 1, 1, 0x12);
    drive(4 * MS, 'A', 4, PIN_HIGH);
    (void)world->spi_exchange(c, 5 * MS, 1, 1, 0x83);
    (void)world->spi_exchange(c, 5 * MS, 1, 1, 0x34); /* heard by nobody */
    TEST_ASSERT_EQUAL_HEX8(0x12, high_threshold(1, 'A', 4));
    TEST_ASSERT_EQUAL_HEX8(0xFF, high_threshold(2, 'C', 0));
}

/* ---- faults of chips ---- */

static void write_threshold(uint64_t now_ns, uint8_t value)
{
    void *c = world->context;
    drive(now_ns, 'A', 4, PIN_LOW);
    (void)world->spi_exchange(c, now_ns, 1, 1, 0x83);
    (void)world->spi_exchange(c, now_ns, 1, 1, value);
    drive(now_ns, 'A', 4, PIN_HIGH);
}

static void a_chip_that_is_missing_is_silent_and_comes_back_as_at_power_on(void)
{
    drive(1 * MS, 'A', 4, PIN_HIGH);
    write_threshold(2 * MS, 0x12);
    TEST_ASSERT_TRUE(fault(3 * MS, "T1", "missing", 1));
    TEST_ASSERT_TRUE(fault(4 * MS, "T1", "missing", 1)); /* it is already */
    TEST_ASSERT_TRUE(fault(5 * MS, "spi1", "floats_low", 1));
    TEST_ASSERT_EQUAL_HEX8(0x00, high_threshold(1, 'A', 4));
    TEST_ASSERT_TRUE(fault(30 * MS, "T1", "missing", 0));
    TEST_ASSERT_EQUAL_HEX8(0xFF, high_threshold(1, 'A', 4));
}

static void a_chip_that_is_dead_keeps_its_registers(void)
{
    drive(1 * MS, 'A', 4, PIN_HIGH);
    write_threshold(2 * MS, 0x12);
    TEST_ASSERT_TRUE(fault(3 * MS, "T1", "dead", 1));
    TEST_ASSERT_EQUAL_HEX8(0xFF, high_threshold(1, 'A', 4));
    TEST_ASSERT_TRUE(fault(30 * MS, "T1", "dead", 0));
    TEST_ASSERT_EQUAL_HEX8(0x12, high_threshold(1, 'A', 4));
}

/* Register 3 of a MAX31856 holds the cold junction's high threshold, 7Fh at power-on (data sheet of the MAX31856, table 6). */
static void another_chip_answers_in_the_place_of_a_wrong_one_until_it_is_taken_back(void)
{
    drive(1 * MS, 'A', 4, PIN_HIGH);
    write_threshold(2 * MS, 0x12);
    TEST_ASSERT_TRUE_MESSAGE(fault(3 * MS, "T1", "wrong", 1), err);
    TEST_ASSERT_TRUE(fault(4 * MS, "T1", "wrong", 1));
    TEST_ASSERT_EQUAL_HEX8(0x7F, high_threshold(1, 'A', 4));
    TEST_ASSERT_TRUE(fault(30 * MS, "T1", "wrong", 0));
    TEST_ASSERT_EQUAL_HEX8(0xFF, high_threshold(1, 'A', 4)); /* it has just got power */
    TEST_ASSERT_EQUAL_HEX8(0xFF, high_threshold(2, 'C', 0)); /* the other bus is as it was */
}

static void a_wrong_chip_on_i2c_has_the_address_of_the_right_one(void)
{
    void *c = world->context;
    TEST_ASSERT_TRUE_MESSAGE(fault(3 * MS, "U", "wrong", 1), err);
    TEST_ASSERT_TRUE(world->i2c_address(c, 10 * MS, 1, 0x48, false));
    world->i2c_stop(c, 10 * MS, 1);
    TEST_ASSERT_FALSE(world->i2c_address(c, 11 * MS, 1, 0x6D, false));
}

static void a_broken_wire_leaves_a_voltage_input_at_0_V_until_it_is_taken_back(void)
{
    const struct chip *chip = wiring_sensor(wired_wiring(w), 2)->chip;
    int in1 = chip_input_index(chip->kind, "in1");
    wired_measure(w, 1 * MS, "U", 1.5);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, chip->input[in1]);
    TEST_ASSERT_TRUE(fault(2 * MS, "U", "open", 1));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, chip->input[in1]);
    wired_measure(w, 3 * MS, "U", 1.75);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, chip->input[in1]);
    TEST_ASSERT_TRUE(fault(4 * MS, "U", "open", 0));
    wired_measure(w, 5 * MS, "U", 1.75);
    TEST_ASSERT_EQUAL_DOUBLE(1.75, chip->input[in1]);
}

static void a_stuck_i2c_bus_is_held_low(void)
{
    void *c = world->context;
    TEST_ASSERT_EQUAL_UINT(0, world->i2c_held(c, 1 * MS, 1));
    TEST_ASSERT_TRUE(fault(2 * MS, "i2c1", "stuck", 1));
    TEST_ASSERT_EQUAL_UINT(I2C_DATA_HELD, world->i2c_held(c, 3 * MS, 1));
    TEST_ASSERT_EQUAL_UINT(0, world->i2c_held(c, 3 * MS, 2));
    TEST_ASSERT_TRUE(fault(4 * MS, "i2c1", "stuck", 0));
    TEST_ASSERT_EQUAL_UINT(0, world->i2c_held(c, 5 * MS, 1));
}

static void every_fault_of_every_line_can_be_set_and_taken_back(void)
{
    static const char *const names[] = {"T1", "T2", "U", "T3", "Q", "Lr", "spi1", "i2c1", "wire1"};
    const struct wiring *wiring = wired_wiring(w);
    struct wiring_fault f;
    unsigned faults = 0;
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        for (size_t n = 0; wiring_fault_at(wiring, names[i], n, &f); n++, faults++) {
            TEST_ASSERT_TRUE_MESSAGE(fault((100 + faults) * MS, names[i], f.name, f.hi), err);
            TEST_ASSERT_TRUE_MESSAGE(fault((101 + faults) * MS, names[i], f.name, f.lo), err);
            TEST_ASSERT_TRUE(wiring_fault_check(wiring, names[i], f.name, f.hi, err, sizeof(err)));
            TEST_ASSERT_FALSE(
                wiring_fault_check(wiring, names[i], f.name, f.hi + 1.0, err, sizeof(err)));
        }
    }
    TEST_ASSERT_EQUAL_UINT(10 + 10 + 6 + 5 + 2 + 1 + 3 + 2 + 2, faults);
}

static void a_file_with_too_many_outputs_is_refused(void)
{
    char text[1024] = "";
    for (unsigned i = 0; i <= WIRED_OUTPUTS_MAX; i++) {
        (void)snprintf(text + strlen(text), sizeof(text) - strlen(text), "Q%u ssr P%c%u\n", i,
                       i < 8 ? 'B' : 'C', i % 8);
        if (i == WIRED_OUTPUTS_MAX) {
            (void)strcpy(strrchr(text, 'P'), "PA0\n");
        }
    }
    open_text(text);
    TEST_ASSERT_NULL(w);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err, "more than 16 outputs"), err);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_load_counts_the_time_that_its_pin_was_on);
    RUN_TEST(a_pin_that_nobody_drives_leaves_its_load_off);
    RUN_TEST(a_load_that_is_on_when_low_counts_the_low_time);
    RUN_TEST(each_load_follows_its_own_pin);
    RUN_TEST(a_pulse_width_is_a_part_of_the_time);
    RUN_TEST(the_part_that_is_low_counts_where_low_is_on);
    RUN_TEST(a_level_ends_the_pulses);
    RUN_TEST(a_valve_goes_as_long_as_it_is_driven);
    RUN_TEST(a_valve_on_its_way_counts_its_mean_position);
    RUN_TEST(a_valve_stops_at_its_ends);
    RUN_TEST(a_valve_driven_both_ways_stays);
    RUN_TEST(a_valve_is_what_it_is_however_often_one_looks);
    RUN_TEST(contacts_of_a_valve_close_at_its_ends_and_nowhere_else);
    RUN_TEST(a_shorted_load_is_on_and_a_broken_one_off_from_their_moment_on);
    RUN_TEST(a_broken_valve_stays_where_it_is);
    RUN_TEST(a_sensor_measures_what_it_is_given);
    RUN_TEST(lines_of_pins_are_carried_out_and_the_others_left);
    RUN_TEST(a_line_that_is_none_is_told);
    RUN_TEST(chips_answer_on_their_buses_and_nobody_on_the_others);
    RUN_TEST(a_chip_listens_while_its_select_is_low);
    RUN_TEST(a_file_with_too_many_outputs_is_refused);
    RUN_TEST(a_chip_that_is_missing_is_silent_and_comes_back_as_at_power_on);
    RUN_TEST(a_chip_that_is_dead_keeps_its_registers);
    RUN_TEST(another_chip_answers_in_the_place_of_a_wrong_one_until_it_is_taken_back);
    RUN_TEST(a_wrong_chip_on_i2c_has_the_address_of_the_right_one);
    RUN_TEST(a_broken_wire_leaves_a_voltage_input_at_0_V_until_it_is_taken_back);
    RUN_TEST(a_stuck_i2c_bus_is_held_low);
    RUN_TEST(every_fault_of_every_line_can_be_set_and_taken_back);
    return UNITY_END();
}
