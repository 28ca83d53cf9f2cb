/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* A pot with a heater behind a contactor, and a pump with a flow meter, at the board's own pins: faults that show in time are told in words
 * within their bounds (io/output_proof.h), and a heater that heats untold loses its power. */
#include "pins_bench.h"
#include "random_source.h"

#define CHANGE 5.0
#define ON_S   150u
#define OFF_S  900u
#define BELOW  75.0
#define FLOW_S 30u

static const char wiring[] = "TB max31865 spi1 PA4 reference=430 wires=3 noise=0.01\n"
                             "F  ads1115  i2c1 0x48 0 noise=200\n"
                             "P  bme280   i2c2 0x76 pressure noise=2\n"
                             "Q  ssr      PB0  hi=1.5\n"
                             "K  relay    PB9\n"
                             "Pu ssr      PC8  hi=10\n";

/* The pot: 0.1 K/s of its heater, whose metal has a lag of 20 s; losses; it boils at 87 degC. */
static struct {
    double t, heat, ambient;
    double last_q_s, last_k_s, last_pump_s, leak;
    bool welded; /* the contactor */
} pot;

static void begin_pot(double t)
{
    memset(&pot, 0, sizeof pot);
    pot.t = t;
    pot.ambient = 20.0;
    pins_measure("TB", t);
    pins_measure("F", 0.0);
    pins_measure("P", 98000);
}

static double more(const char *load, double *last_s)
{
    double now_s = pins_on_s(load), by_s = now_s - *last_s;
    *last_s = now_s;
    return by_s;
}

/* A second passes. */
static void pot_second(void)
{
    pass(1000);
    double q = more("Q", &pot.last_q_s), k = more("K", &pot.last_k_s);
    double pump = more("Pu", &pot.last_pump_s);
    double power = pot.welded ? q : fmin(q, k);
    pot.heat += (power - pot.heat) / 20.0;
    pot.t += 0.1 * pot.heat - (pot.t - pot.ambient) / 6000.0;
    if (pot.t > 87.0)
        pot.t = 87.0;
    pins_measure("TB", pot.t);
    pins_measure("F", 1.5 * pump + pot.leak);
}

/* Lets the pot be until this is said; returns how many seconds that took. most: the test fails if it takes longer. */
static unsigned seconds_to(const char *words, unsigned most)
{
    for (unsigned n = 1; n <= most; n++) {
        pot_second();
        if (said(words))
            return n;
    }
    TEST_FAIL_MESSAGE(words);
    return 0;
}

/* Lets the pot be; nothing is told. */
static void quiet(unsigned seconds)
{
    for (unsigned n = 0; n < seconds; n++) {
        pot_second();
        TEST_ASSERT_FALSE_MESSAGE(said("OUTPUT_CONTRADICTED"), board.said);
        TEST_ASSERT_FALSE_MESSAGE(said("MEASUREMENT_BAD"), board.said);
        board_forget();
    }
}

static double k_is_on(void)
{
    double before = pins_on_s("K");
    pass(5000);
    return (pins_on_s("K") - before) / 5.0;
}

static void set_up(void)
{
    ask_ok("begin");
    PINS_ASK("set io.source board", "set tick.base 1");
    PINS_ASK("set chan1.name TB", "set chan1.unit degC", "set chan1.device max31865",
             "set chan1.bus spi1", "set chan1.select PA4", "set meas1.name TB",
             "set meas1.unit degC", "set meas1.hi 150");
    PINS_ASK("set chan2.name F", "set chan2.unit V", "set chan2.device ads1115",
             "set chan2.bus i2c1", "set chan2.select 0x48", "set meas2.name F", "set meas2.unit V",
             "set meas2.hi 3", "set meas2.valid_lo -1", "set meas2.valid_hi 4");
    PINS_ASK("set chan3.name P", "set chan3.unit Pa", "set chan3.device bme280",
             "set chan3.bus i2c2", "set chan3.select 0x76", "set meas3.name P", "set meas3.unit Pa",
             "set meas3.hi 200000");
    PINS_ASK("set out1.name Q", "set out1.unit kW", "set out1.kind window", "set out1.pin PB0",
             "set out1.hi 1.5", "set out1.heater on", "set mv1.name Q", "set mv1.unit kW",
             "set mv1.hi 1.5", "set mv1.max 1.5");
    PINS_ASK("set out2.name Pu", "set out2.unit l/h", "set out2.kind window", "set out2.pin PC8",
             "set out2.hi 10", "set mv2.name Pu", "set mv2.unit l/h", "set mv2.hi 10",
             "set mv2.max 10");
    PINS_ASK("set out3.name K", "set out3.kind enable", "set out3.pin PB9", "set out3.least_off 1");
    PINS_ASK("set out1.proof warms", "set out1.proof_at chan1", "set out1.proof_change 5",
             "set out1.proof_on 150", "set out1.proof_off 900", "set out1.proof_below 75");
    PINS_ASK("set out2.proof flows", "set out2.proof_at chan2", "set out2.proof_change 0.1",
             "set out2.proof_on 30", "set out2.proof_off 30");
    PINS_ASK("set meas1.frozen 60", "set meas2.frozen 60", "set meas3.frozen 60");
    PINS_ASK("set loop1.name boil", "set loop1.pv TB", "set loop1.out Q",
             "set loop1.action reverse", "set loop1.gain 5", "set loop1.ti 300");
    PINS_ASK("apply");
}

void setUp(void)
{
    pins_power_on(wiring);
    begin_pot(20.0);
    set_up();
    quiet(30);
}

void tearDown(void)
{
    pins_close();
}

/* ---- heater ---- */

static void a_broken_heater_is_told_within_its_time_and_keeps_the_contactor(void)
{
    ask_ok("out Q 1.5");
    quiet(120);
    pins_fault("Q", "broken", 1);
    board_forget();
    (void)seconds_to("OUTPUT_CONTRADICTED Q ", 2u * ON_S + 2u);
    TEST_ASSERT_TRUE_MESSAGE(said("on, and nothing warms"), board.said);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, k_is_on());
    pins_fault("Q", "broken", 0);
    board_forget();
    (void)seconds_to("OUTPUT_ACTS Q ", 2u * ON_S);
}

static void a_heater_that_holds_a_boil_is_not_called_broken(void)
{
    ask_ok("out Q 1.5");
    quiet(6u * 3600u);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 87.0, pot.t);
}

static void a_heater_that_breaks_at_the_boil_is_told_below_it(void)
{
    begin_pot(87.0);
    PINS_ASK("out Q 1.5");
    quiet(300);
    pins_fault("Q", "broken", 1);
    while (pot.t >= BELOW)
        quiet(1);
    (void)seconds_to("OUTPUT_CONTRADICTED Q ", 2u * ON_S + 2u);
    TEST_ASSERT_TRUE_MESSAGE(said("on, and nothing warms"), board.said);
}

static void a_loop_that_holds_a_temperature_below_the_boil_is_quiet(void)
{
    PINS_ASK("mode boil auto", "sp boil 60");
    quiet(3u * 3600u);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 60.0, pot.t);
    ask_ok("sp boil 40");
    quiet(3u * 3600u);
}

static void a_shorted_relay_of_a_cold_heater_opens_the_contactor(void)
{
    quiet(2u * ON_S);
    pins_fault("Q", "shorted", 1);
    board_forget();
    (void)seconds_to("OUTPUT_CONTRADICTED Q ", 3u * ON_S + 2u);
    TEST_ASSERT_TRUE_MESSAGE(said("off, and it warms"), board.said);
    pot_second();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, k_is_on());
    double told_at = pot.t;
    for (unsigned n = 0; n < 3600; n++)
        pot_second();
    TEST_ASSERT_TRUE(pot.t < told_at + 3.0); /* what its metal still had */
    TEST_ASSERT_EQUAL_UINT(1, times_said("OUTPUT_CONTRADICTED"));
}

static void a_relay_that_shorts_while_heating_is_told_once_the_heater_is_off(void)
{
    ask_ok("out Q 1.5");
    quiet(1200);
    pins_fault("Q", "shorted", 1);
    ask_ok("out Q 0");
    board_forget();
    unsigned s = seconds_to("OUTPUT_CONTRADICTED Q ", OFF_S + 2u);
    TEST_ASSERT_GREATER_THAN_UINT(OFF_S - 100u, s);
    TEST_ASSERT_TRUE_MESSAGE(said("off, and it does not cool"), board.said);
    pot_second();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, k_is_on());
}

static void a_heater_without_power_stays_so_until_its_pins_are_set_anew(void)
{
    pins_fault("Q", "shorted", 1);
    (void)seconds_to("OUTPUT_CONTRADICTED Q ", 3u * ON_S + 2u);
    pins_fault("Q", "shorted", 0);
    PINS_ASK("set loop1.gain 2", "out Q 1");
    for (unsigned n = 0; n < 1800; n++)
        pot_second();
    TEST_ASSERT_EQUAL_DOUBLE(0.0, k_is_on());
    ask_ok("set out1.proof_off 901");
    quiet(10);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, k_is_on());
}

static void a_relay_that_is_still_shorted_is_told_anew_after_new_settings(void)
{
    pins_fault("Q", "shorted", 1);
    (void)seconds_to("OUTPUT_CONTRADICTED Q ", 3u * ON_S + 2u);
    pot.t = 20.0; /* else it comes to the limit before it is told */
    ask_ok("set out1.proof_off 901");
    board_forget();
    (void)seconds_to("OUTPUT_CONTRADICTED Q ", 3u * ON_S + 10u);
    TEST_ASSERT_TRUE_MESSAGE(said("off, and it warms"), board.said);
}

/* What the pump brings may be hot. */
static void a_heater_is_not_judged_while_another_output_is_on(void)
{
    ask_ok("out Pu 10");
    for (unsigned n = 0; n < 5u * ON_S; n++) {
        pot.t += 0.05;
        quiet(1);
    }
}

static void heat_through_a_welded_contactor_is_told_as_well(void)
{
    pot.welded = true;
    pins_fault("Q", "shorted", 1);
    (void)seconds_to("off, and it warms", 3u * ON_S + 2u);
    board_forget();
    (void)seconds_to("still not cooler", 3u * ON_S + 2u);
}

static void a_heater_that_is_switched_often_is_quiet(void)
{
    struct random_source random = {38};
    for (unsigned n = 0; n < 60; n++) {
        char line[24];
        unsigned tenths = random_below(&random, 16);
        snprintf(line, sizeof line, "out Q %u.%u", tenths / 10u, tenths % 10u);
        ask_ok(line);
        quiet(10u + random_below(&random, 600));
    }
}

/* ---- pump ---- */

static void a_flow_without_its_pump_is_told_in_words(void)
{
    ask_ok("out Pu 10");
    quiet(100);
    ask_ok("out Pu 0");
    quiet(2u * FLOW_S + 5u);
    pins_fault("Pu", "shorted", 1);
    board_forget();
    (void)seconds_to("OUTPUT_CONTRADICTED Pu ", 2u * FLOW_S + 2u);
    TEST_ASSERT_TRUE_MESSAGE(said("off, and it flows"), board.said);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, k_is_on());
    pins_fault("Pu", "shorted", 0);
    (void)seconds_to("OUTPUT_ACTS Pu ", 2u * FLOW_S + 6u);
}

static void a_pump_that_moves_nothing_is_told_in_words(void)
{
    pins_fault("Pu", "broken", 1);
    ask_ok("out Pu 10");
    board_forget();
    (void)seconds_to("OUTPUT_CONTRADICTED Pu ", FLOW_S + 3u);
    TEST_ASSERT_TRUE_MESSAGE(said("on, and nothing flows"), board.said);
}

/* ---- frozen ---- */

static void a_chip_that_gives_the_same_number_again_and_again_is_told_as_frozen(void)
{
    static const char *const chips[] = {"F", "P"};
    for (unsigned i = 0; i < 2; i++) {
        char words[40];
        pins_fault(chips[i], "stuck", 1);
        board_forget();
        snprintf(words, sizeof words, "MEASUREMENT_BAD %s ", chips[i]);
        (void)seconds_to(words, 60 + 2);
        TEST_ASSERT_TRUE_MESSAGE(said("frozen"), board.said);
        pins_fault(chips[i], "stuck", 0);
        snprintf(words, sizeof words, "MEASUREMENT_GOOD %s ", chips[i]);
        (void)seconds_to(words, 4);
    }
}

/* ---- settings ---- */

static void refuses(const char *line, const char *words)
{
    const char *end = ask(line);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE("err ", end, 4, line);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(end, words), end);
}

static void a_proof_that_could_tell_nothing_is_refused_in_words(void)
{
    refuses("set out1.proof_at -", "must say which channel shows that it acts");
    refuses("set out1.proof_at chan9", "must say which channel shows that it acts");
    refuses("set out1.proof_change 0", "must be above 0");
    refuses("set out1.proof_below 0", "must say below which temperature nothing boils");
    refuses("set out3.proof warms", "must be - of an output of kind enable");
    ask_ok("set out1.proof_on 0");
    refuses("set out1.proof_off 0", "one must say how long");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_broken_heater_is_told_within_its_time_and_keeps_the_contactor);
    RUN_TEST(a_heater_that_holds_a_boil_is_not_called_broken);
    RUN_TEST(a_heater_that_breaks_at_the_boil_is_told_below_it);
    RUN_TEST(a_loop_that_holds_a_temperature_below_the_boil_is_quiet);
    RUN_TEST(a_shorted_relay_of_a_cold_heater_opens_the_contactor);
    RUN_TEST(a_relay_that_shorts_while_heating_is_told_once_the_heater_is_off);
    RUN_TEST(a_heater_without_power_stays_so_until_its_pins_are_set_anew);
    RUN_TEST(a_relay_that_is_still_shorted_is_told_anew_after_new_settings);
    RUN_TEST(a_heater_is_not_judged_while_another_output_is_on);
    RUN_TEST(heat_through_a_welded_contactor_is_told_as_well);
    RUN_TEST(a_heater_that_is_switched_often_is_quiet);
    RUN_TEST(a_flow_without_its_pump_is_told_in_words);
    RUN_TEST(a_pump_that_moves_nothing_is_told_in_words);
    RUN_TEST(a_chip_that_gives_the_same_number_again_and_again_is_told_as_frozen);
    RUN_TEST(a_proof_that_could_tell_nothing_is_refused_in_words);
    return UNITY_END();
}
