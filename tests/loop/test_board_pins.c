/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* A plant at the board's own pins: readings, faults of sensors, fall-back, outputs that go off, settings that come and go. */
#include "pins_bench.h"

static const char wiring[] = "T1   max31865 spi1 PA4  reference=430 wires=3\n"
                             "T10  max31865 spi1 PB12 reference=430 wires=3\n"
                             "Ta   ds18b20  wire1     rom=28-000005e2fdc3\n"
                             "Tb   ds18b20  wire1     rom=28-000005e2fdc4\n"
                             "L    ads1115  i2c1 0x48 1\n"
                             "L2   ads1115  i2c1 0x48 3\n"
                             "P    bme280   i2c2 0x76 pressure\n"
                             "Tair bme280   i2c2 0x76 temperature\n"
                             "Tc   max31856 spi2 PC0  type=K\n"
                             "Q    ssr      PB0       hi=3\n"
                             "Lr   valve    PB1 PC2   hi=20 travel=60\n";

static void channel(unsigned i, const char *name, const char *unit, const char *device,
                    const char *bus, const char *select)
{
    static const char *const fields[] = {"name", "unit", "device", "bus", "select"};
    const char *values[] = {name, unit, device, bus, select};
    char line[80];
    for (unsigned k = 0; k < 5; k++) {
        snprintf(line, sizeof line, "set chan%u.%s %s", i, fields[k], values[k]);
        ask_ok(line);
    }
    for (unsigned k = 0; k < 2; k++) {
        snprintf(line, sizeof line, "set meas%u.%s %s", i, fields[k], values[k]);
        ask_ok(line);
    }
    snprintf(line, sizeof line, "set meas%u.hi %s", i, strcmp(unit, "Pa") == 0 ? "200000" : "200");
    ask_ok(line);
}

/* Sensors and outputs as wired, and a loop from T1 to the heater. */
static void set_up(void)
{
    ask_ok("begin");
    PINS_ASK("set io.source board", "set tick.base 1");
    channel(1, "T1", "degC", "max31865", "spi1", "PA4");
    channel(2, "T10", "degC", "max31865", "spi1", "PB12");
    channel(3, "Ta", "degC", "ds18b20", "wire1", "28000005e2fdc3");
    channel(4, "Tb", "degC", "ds18b20", "wire1", "28000005e2fdc4");
    channel(5, "L", "V", "ads1115", "i2c1", "0x48");
    channel(6, "L2", "V", "ads1115", "i2c1", "0x48");
    channel(7, "P", "Pa", "bme280", "i2c2", "0x76");
    channel(8, "Tair", "degC", "bme280_temperature", "i2c2", "0x76");
    channel(9, "Tc", "degC", "max31856", "spi2", "PC0");
    PINS_ASK("set chan5.input 1", "set chan6.input 3", "set chan9.type K");
    PINS_ASK("set out1.name Q", "set out1.unit kW", "set out1.kind window", "set out1.pin PB0",
             "set out1.hi 3", "set out1.period 2");
    PINS_ASK("set out2.name Lr", "set out2.unit l/h", "set out2.kind motor_valve",
             "set out2.pin PB1", "set out2.pin2 PC2", "set out2.hi 20", "set out2.travel 60");
    PINS_ASK("set mv1.name Q", "set mv1.unit kW", "set mv1.hi 3", "set mv1.max 3",
             "set mv2.name Lr", "set mv2.unit l/h", "set mv2.hi 20", "set mv2.max 20");
    PINS_ASK("set loop1.name boil", "set loop1.pv T1", "set loop1.out Q", "set loop1.gain 2",
             "set loop1.ti 100", "set meas1.hold 3");
    PINS_ASK("apply", "log on");
}

static void measure_all(double k)
{
    pins_measure("T1", 78.3 + k);
    pins_measure("T10", 99.6 - k);
    pins_measure("Ta", 20.5 + k);
    pins_measure("Tb", 31.25 + k);
    pins_measure("L", 1.25 + k / 100);
    pins_measure("L2", 2.5);
    pins_measure("P", 98000 + k);
    pins_measure("Tair", 23.0);
    pins_measure("Tc", 150.0 + k);
}

void setUp(void)
{
    pins_power_on(wiring);
    measure_all(0);
    set_up();
    pins_samples(8);
}

void tearDown(void)
{
    pins_close();
}

static void reads(const char *name, double value, double within)
{
    TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(0.0, pins_field(name) * 0.0, name);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(within, value, pins_field(name), name);
    char quality[24];
    snprintf(quality, sizeof quality, "%s.q", name);
    TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(0.0, pins_field(quality), name);
}

static bool is_good(const char *name)
{
    char quality[24];
    snprintf(quality, sizeof quality, "%s.q", name);
    return pins_field(quality) == 0.0;
}

/* ---- readings ---- */

static void all_readings_are(double k)
{
    reads("T1", 78.3 + k, 0.1);
    reads("T10", 99.6 - k, 0.1);
    reads("Ta", 20.5 + k, 0.1);
    reads("Tb", 31.25 + k, 0.1);
    reads("L", 1.25 + k / 100, 0.001);
    reads("L2", 2.5, 0.001);
    reads("P", 98000 + k, 20.0);
    reads("Tair", 23.0, 0.1);
    reads("Tc", 150.0 + k, 0.1);
}

static void every_reading_is_what_its_sensor_has(void)
{
    all_readings_are(0);
    measure_all(30);
    pins_samples(4);
    all_readings_are(30);
}

static void no_rule_of_a_data_sheet_is_broken(void)
{
    unsigned count;
    pins_samples(60);
    TEST_ASSERT_EQUAL_STRING("", wiring_wrong(wired_wiring(pins_world), &count));
    TEST_ASSERT_EQUAL_UINT(0, count);
}

static void a_sample_comes_each_base_tick(void)
{
    static const struct {
        const char *line;
        unsigned rows;
    } ticks[] = {{"set tick.base 1", 10},
                 {"set tick.base 2", 5},
                 {"set tick.base 0.5", 20},
                 {"set tick.base 5", 2}};
    for (unsigned i = 0; i < sizeof ticks / sizeof *ticks; i++) {
        PINS_ASK("begin", ticks[i].line, "apply");
        pass(20000);
        board_forget();
        pass(10000);
        TEST_ASSERT_EQUAL_UINT_MESSAGE(ticks[i].rows, pins_take_rows(), ticks[i].line);
        reads("T1", 78.3, 0.1);
        reads("Ta", 20.5, 0.1);
    }
}

/* ---- faults of sensors ---- */

static void is_told(const char *sensor, const char *fault, const char *words)
{
    char text[64];
    pins_fault(sensor, fault, 1);
    pins_samples(2);
    snprintf(text, sizeof text, "SENSOR_FAULT %s ", sensor);
    TEST_ASSERT_TRUE_MESSAGE(said(text), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said(words), board.said);
    TEST_ASSERT_FALSE_MESSAGE(is_good(sensor), fault);
    pins_fault(sensor, fault, 0);
    pins_samples(6);
    snprintf(text, sizeof text, "SENSOR_FINE %s ", sensor);
    TEST_ASSERT_TRUE_MESSAGE(said(text), board.said);
    TEST_ASSERT_TRUE_MESSAGE(is_good(sensor), fault);
}

static void a_thermometer_that_is_broken_is_told_within_two_samples(void)
{
    is_told("T1", "open", "sensor or wire open");
    is_told("T1", "short", "sensor shorted");
    is_told("T1", "dead", "no chip answers");
    reads("T1", 78.3, 0.1);
    reads("T10", 99.6, 0.1);
}

static void a_thermocouple_that_is_broken_is_told_within_two_samples(void)
{
    is_told("Tc", "open", "sensor or wire open");
    is_told("Tc", "dead", "no chip answers");
    reads("Tc", 150.0, 0.1);
}

static void a_chip_that_is_dead_is_told_within_two_samples(void)
{
    is_told("L", "dead", "no chip answers");
    is_told("P", "dead", "no chip answers");
    reads("L", 1.25, 0.001);
    reads("P", 98000, 20.0);
}

static void one_of_two_thermometers_on_a_wire_may_fail(void)
{
    pins_fault("Ta", "dead", 1);
    pins_measure("Tb", 55.0);
    pins_samples(4);
    TEST_ASSERT_TRUE_MESSAGE(said("SENSOR_FAULT Ta "), board.said);
    TEST_ASSERT_FALSE(said("SENSOR_FAULT Tb "));
    TEST_ASSERT_FALSE(is_good("Ta"));
    reads("Tb", 55.0, 0.1);
    pins_fault("Ta", "dead", 0);
    pins_samples(6);
    reads("Ta", 20.5, 0.1);
}

static void a_fault_is_told_once(void)
{
    pins_fault("T1", "open", 1);
    pins_samples(20);
    TEST_ASSERT_EQUAL_UINT(1, times_said("SENSOR_FAULT T1 "));
}

static void the_loop_of_a_lost_thermometer_holds_and_then_goes_to_manual(void)
{
    PINS_ASK("out Q 1.5", "mode boil auto");
    pins_samples(3);
    ask_ok("loop boil");
    TEST_ASSERT_TRUE_MESSAGE(said("boil auto"), board.said);
    pins_fault("T1", "open", 1);
    pins_samples(2);
    TEST_ASSERT_TRUE_MESSAGE(said("MEASUREMENT_BAD T1"), board.said);
    ask_ok("loop boil");
    TEST_ASSERT_TRUE_MESSAGE(said("boil auto"), board.said); /* it holds the value for 3 s */
    pins_samples(4);
    TEST_ASSERT_TRUE_MESSAGE(said("MANUAL_BY_BOARD boil"), board.said);
    ask_ok("loop boil");
    TEST_ASSERT_TRUE_MESSAGE(said("boil manual"), board.said);
    pins_fault("T1", "open", 0);
    pins_samples(6);
    TEST_ASSERT_TRUE_MESSAGE(said("MEASUREMENT_GOOD T1"), board.said);
    PINS_ASK("mode boil auto");
}

static void the_board_goes_to_its_safe_state_where_that_is_declared(void)
{
    PINS_ASK("begin", "set meas1.fallback safe", "apply", "out Q 1.5", "mode boil auto");
    pins_samples(3);
    pins_fault("T1", "dead", 1);
    pins_samples(8);
    ask_ok("status");
    TEST_ASSERT_TRUE_MESSAGE(said("state safe"), board.said);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_mean("Q", 10000));
}

static void a_bus_that_is_stuck_is_told_for_its_devices_alone(void)
{
    pins_fault("i2c1", "stuck", 1);
    pins_samples(4);
    TEST_ASSERT_TRUE_MESSAGE(said("SENSOR_FAULT L "), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said("SENSOR_FAULT L2 "), board.said);
    TEST_ASSERT_FALSE(is_good("L"));
    TEST_ASSERT_FALSE(is_good("L2"));
    reads("T1", 78.3, 0.1);
    reads("P", 98000, 20.0);
    reads("Ta", 20.5, 0.1);
    pins_fault("i2c1", "stuck", 0);
    pins_samples(8);
    all_readings_are(0);
}

static void a_noisy_bus_gives_no_wrong_number_for_a_good_one(void)
{
    static const char *const buses[] = {"spi1", "spi2", "wire1", "i2c1", "i2c2"};
    static const struct {
        const char *name;
        double value, within;
    } truth[] = {{"T1", 78.3, 0.1},  {"T10", 99.6, 0.1}, {"Ta", 20.5, 0.1},
                 {"Tb", 31.25, 0.1}, {"L", 1.25, 0.001}, {"L2", 2.5, 0.001},
                 {"P", 98000, 20.0}, {"Tair", 23, 0.1},  {"Tc", 150, 0.1}};
    unsigned good = 0, bad = 0;
    for (unsigned i = 0; i < 5; i++)
        pins_fault(buses[i], "noise",
                   1e-4); /* each bit, each way; more may disturb two reads alike */
    for (unsigned n = 0; n < 900; n++) {
        pins_samples(1);
        for (unsigned k = 0; k < sizeof truth / sizeof *truth; k++) {
            good += is_good(truth[k].name);
            bad += !is_good(truth[k].name);
            if (is_good(truth[k].name))
                TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(truth[k].within, truth[k].value,
                                                  pins_field(truth[k].name), truth[k].name);
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT(0, bad); /* else there was no noise */
    TEST_ASSERT_GREATER_THAN_UINT(bad, good);
    for (unsigned i = 0; i < 5; i++)
        pins_fault(buses[i], "noise", 0);
    pins_samples(8);
    all_readings_are(0);
}

static void settings_that_come_within_a_conversion_mix_no_inputs(void)
{
    for (unsigned n = 0; n < 20; n++) {
        pass(1000 - board.clock_ms % 1000 +
             50 * n); /* one of the two inputs is converted now, or none */
        PINS_ASK("begin", n % 2 ? "set chan1.hi 300" : "set chan1.hi 200", "apply");
        pins_samples(1); /* the tick that takes the plan has no row */
        for (unsigned k = 0; k < 3; k++) {
            pins_samples(1);
            if (is_good("L"))
                reads("L", 1.25, 0.001);
            if (is_good("L2"))
                reads("L2", 2.5, 0.001);
        }
        reads("L", 1.25, 0.001);
        reads("L2", 2.5, 0.001);
    }
}

static void a_plan_that_swaps_two_sensors_gives_neither_the_reading_of_the_other(void)
{
    for (unsigned n = 0; n < 4; n++) {
        ask_ok("begin");
        channel(1, n % 2 ? "T1" : "T10", "degC", "max31865", "spi1", n % 2 ? "PA4" : "PB12");
        channel(2, n % 2 ? "T10" : "T1", "degC", "max31865", "spi1", n % 2 ? "PB12" : "PA4");
        PINS_ASK("set loop1.pv T1", "apply");
        for (unsigned k = 0; k < 5; k++) {
            pins_samples(1);
            if (pins_take_rows() == 0)
                continue;
            if (is_good("T1"))
                reads("T1", 78.3, 0.1);
            if (is_good("T10"))
                reads("T10", 99.6, 0.1);
        }
        reads("T1", 78.3, 0.1);
        reads("T10", 99.6, 0.1);
    }
}

/* ---- outputs ---- */

static void the_loads_are_what_is_commanded(void)
{
    PINS_ASK("out Q 0.9", "out Lr 5");
    pass(70000);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.3, pins_mean("Q", 20000));   /* of 3 kW */
    TEST_ASSERT_DOUBLE_WITHIN(0.011, 0.25, pins_mean("Lr", 5000)); /* within its dead band */
    PINS_ASK("out Q 3", "out Lr 12");
    pass(70000);
    TEST_ASSERT_DOUBLE_WITHIN(0.021, 1.0,
                              pins_mean("Q", 20000)); /* without its shortest time off */
    TEST_ASSERT_DOUBLE_WITHIN(0.011, 0.6, pins_mean("Lr", 5000));
}

static void outputs_are_off_until_they_are_commanded(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_on_s("Q"));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_mean("Q", 10000));
}

static void outputs_go_off_when_ticks_stop(void)
{
    PINS_ASK("out Q 3", "out Lr 12");
    pass(70000);
    pins_stall(2100); /* its dead man is 2 s */
    double on = pins_on_s("Q");
    pins_stall(5000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, on, pins_on_s("Q"));
    pins_samples(3); /* ticks come again */
    ask_ok("status");
    TEST_ASSERT_TRUE_MESSAGE(said("state safe"), board.said);
    PINS_ASK("out Q 1.5");
    pins_samples(4);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.5, pins_mean("Q", 20000));
}

static void outputs_go_off_when_the_plant_is_at_the_link(void)
{
    PINS_ASK("out Q 3");
    pins_samples(10);
    PINS_ASK("begin", "set io.source link", "apply");
    pins_samples(3);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_mean("Q", 10000));
    board_forget();
    pass(5000);
    TEST_ASSERT_EQUAL_UINT(0, pins_take_rows()); /* nobody is there */
    PINS_ASK("begin", "set io.source board", "apply");
    pins_samples(8);
    reads("T1", 78.3, 0.1);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pins_mean("Q", 10000)); /* nobody has commanded it since */
    PINS_ASK("out Q 1.5");
    pins_samples(4);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.5, pins_mean("Q", 20000));
}

static void other_settings_leave_the_outputs_alone(void)
{
    PINS_ASK("out Q 1.5", "out Lr 12");
    pass(120000); /* the valve closes first, so that it knows where it is */
    double on = pins_on_s("Q"), lr = pins_on_s("Lr");
    for (unsigned i = 0; i < 5; i++) {
        PINS_ASK("begin", i % 2 ? "set loop1.gain 2" : "set loop1.gain 3", "apply");
        pass(4000);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 10.0, pins_on_s("Q") - on);
    TEST_ASSERT_DOUBLE_WITHIN(0.25, 12.0, pins_on_s("Lr") - lr);
}

static void outputs_are_off_after_a_reset_until_they_are_commanded(void)
{
    PINS_ASK("save", "out Q 3");
    pins_samples(10);
    memory_port_reset(HAL_RESET_WATCHDOG);
    board_run();
    double on = pins_on_s("Q");
    pass(20000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, on, pins_on_s("Q"));
    type("mode machine\n");
    PINS_ASK("out Q 1.5");
    pins_samples(4);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.5, pins_mean("Q", 20000));
}

/* Feedings come eight times in a time-out: 1 s of a board with outputs, 2 s of one whose plant is at the link. The tick looks every 50 ms. */
static void the_watchdog_is_fed_as_a_board_with_outputs_needs_it(void)
{
    (void)memory_port_unfed_ms();
    pass(20000);
    uint64_t pins = memory_port_unfed_ms();
    TEST_ASSERT_TRUE(pins >= 125 && pins < 125 + 50);
    PINS_ASK("begin", "set io.source link", "apply");
    pass(20000);
    uint64_t link = memory_port_unfed_ms();
    TEST_ASSERT_TRUE(link >= 250 && link < 250 + 50);
    PINS_ASK("begin", "set io.source board", "apply");
    pass(1000);
    (void)memory_port_unfed_ms();
    pass(20000);
    TEST_ASSERT_TRUE(memory_port_unfed_ms() < 125 + 50);
}

/* ---- settings ---- */

static void saved_settings_are_there_after_a_restart(void)
{
    PINS_ASK("save");
    memory_port_reset(HAL_RESET_POWER_ON);
    board_run();
    type("mode machine\n");
    pass(2000);
    PINS_ASK("log on");
    pins_header[0] = pins_row[0] = '\0';
    pins_samples(8);
    all_readings_are(0);
    ANSWERS("get chan4.select", "chan4.select = 28000005e2fdc4");
    ANSWERS("get out2.kind", "out2.kind = motor_valve");
}

static void settings_that_conflict_are_refused_and_the_old_ones_stay(void)
{
    static const char *const wrong[][2] = {
        {"set chan2.select PA4", "err CONFLICT chan2.select: 'PA4' is taken by another devi"},
        {"set chan3.bus spi3", "err CONFLICT chan3.bus: 'Ta' must be a bus"},
        {"set chan6.input 1", "err CONFLICT chan6.input: 'L2' is read by another ch"},
        {"set chan5.select 0x99", "err RANGE chan5.select: '0x99' must be its address on"},
        {"set chan9.type -", "err RANGE chan9.type: 'Tc' must be one that"},
        {"set out1.pin PA5", "err CONFLICT out1.pin: 'Q' is taken by another devi"},
        {"set out2.pin2 -", "err CONFLICT out2.pin2: 'Lr' a pin is missing"},
        {"set out2.pin2 PB0", "err CONFLICT out2.pin2: 'Lr' another output has"}};
    for (unsigned i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        PINS_ASK("begin", wrong[i][0]);
        TEST_ASSERT_EQUAL_STRING_LEN(wrong[i][1], ask("apply"), strlen(wrong[i][1]));
        ask_ok("abandon");
    }
    pins_samples(3);
    all_readings_are(0);
}

static void settings_that_a_chip_cannot_have_are_told(void)
{
    PINS_ASK("begin", "set chan5.select 0x20", "set chan6.select 0x20", "apply");
    pins_samples(3);
    TEST_ASSERT_TRUE_MESSAGE(said("SENSOR_FAULT L "), board.said);
    TEST_ASSERT_FALSE(is_good("L"));
    reads("T1", 78.3, 0.1);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_reading_is_what_its_sensor_has);
    RUN_TEST(no_rule_of_a_data_sheet_is_broken);
    RUN_TEST(a_sample_comes_each_base_tick);
    RUN_TEST(a_thermometer_that_is_broken_is_told_within_two_samples);
    RUN_TEST(a_thermocouple_that_is_broken_is_told_within_two_samples);
    RUN_TEST(a_chip_that_is_dead_is_told_within_two_samples);
    RUN_TEST(one_of_two_thermometers_on_a_wire_may_fail);
    RUN_TEST(a_fault_is_told_once);
    RUN_TEST(a_bus_that_is_stuck_is_told_for_its_devices_alone);
    RUN_TEST(settings_that_come_within_a_conversion_mix_no_inputs);
    RUN_TEST(a_plan_that_swaps_two_sensors_gives_neither_the_reading_of_the_other);
    RUN_TEST(a_noisy_bus_gives_no_wrong_number_for_a_good_one);
    RUN_TEST(the_loop_of_a_lost_thermometer_holds_and_then_goes_to_manual);
    RUN_TEST(the_board_goes_to_its_safe_state_where_that_is_declared);
    RUN_TEST(the_loads_are_what_is_commanded);
    RUN_TEST(outputs_are_off_until_they_are_commanded);
    RUN_TEST(outputs_go_off_when_ticks_stop);
    RUN_TEST(outputs_go_off_when_the_plant_is_at_the_link);
    RUN_TEST(other_settings_leave_the_outputs_alone);
    RUN_TEST(outputs_are_off_after_a_reset_until_they_are_commanded);
    RUN_TEST(the_watchdog_is_fed_as_a_board_with_outputs_needs_it);
    RUN_TEST(saved_settings_are_there_after_a_restart);
    RUN_TEST(settings_that_conflict_are_refused_and_the_old_ones_stay);
    RUN_TEST(settings_that_a_chip_cannot_have_are_told);
    return UNITY_END();
}
