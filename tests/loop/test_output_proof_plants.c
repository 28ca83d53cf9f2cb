/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* The cold pilot column, filled, started, controlled, disturbed, shut down and left alone again and again: its heater, feed, reflux and cooling
 * water are proved (io/output_proof.h) by what their sensors read, two thermometers for the heater. Nothing is told but what is broken.
 *
 *     test_output_proof_plants HOURS      runs longer than the test does */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "instruments.h"
#include "io/output_proof.h"
#include "plant_bench.h"
#include "random_source.h"

#define SEED   38u
#define TICK_S 10.0

enum { VALVE_REFLUX, HEATER, VALVE_FEED, VALVE_WATER, VALVE_TOP, VALVE_BOTTOM, INPUTS };

static const struct {
    const char *name;
    double hi;
} inputs[INPUTS] = {{"vLr", 100}, {"Qrb", 1.5}, {"vF", 100},
                    {"vCW", 100}, {"vD", 100},  {"vB", 100}};

#define WARMS PROOF_KIND_WARMS
#define FLOWS PROOF_KIND_FLOWS
static const struct watched {
    unsigned input;
    const char *channel;
    struct proof_config c;
} watched[] = {
    /* 1.1 kW warm a full reboiler, 14 kJ/K, by 5 K in 64 s; 0.7 x 1.6 W/K to 35 degC cool it from 82 degC by 5 K in 1300 s. The mixture boils
     * at 85 degC or above, and feed comes in at 80 degC at most. */
    {HEATER, "TB", {.change = 5, .on_s = 180, .off_s = 1800, .limit = 82, .kind = WARMS}},
    /* The lowest tray is cold until vapour comes. */
    {HEATER, "T10", {.change = 5, .on_s = 1800, .off_s = 1800, .limit = 82, .kind = WARMS}},
    {VALVE_REFLUX, "Lr", {.change = 0.5f, .off_s = 60, .kind = FLOWS}}, /* its drum may be empty */
    {VALVE_FEED, "F", {.change = 0.5f, .on_s = 60, .off_s = 60, .kind = FLOWS}},
    {VALVE_WATER, "Fcw", {.change = 3, .on_s = 60, .off_s = 60, .kind = FLOWS}},
};
#define WATCHED (sizeof watched / sizeof *watched)

static struct random_source random_of_runs;
static double most_hours = 100.0;
static struct instruments in;
static struct link_sample sample;
static struct output_proof proof[WATCHED];
static enum output_proof_fault told[WATCHED];
static double now_s, command[INPUTS];

static double reading_of(const char *name)
{
    for (size_t i = 0; i < in.n_sensors; i++)
        if (in.sensor[i].channel == channel(name))
            return (double)sample.measurement[i].value;
    TEST_FAIL_MESSAGE(name);
    return 0.0;
}

static void give_commands(void)
{
    struct link_command c = {.n_outputs = (uint8_t)in.n_actuators};
    for (size_t i = 0; i < in.n_actuators; i++)
        for (unsigned k = 0; k < INPUTS; k++)
            if (in.actuator[i].channel == channel(inputs[k].name)) {
                c.output[i].drive = true;
                c.output[i].value = (float)command[k];
            }
    instruments_command(&in, &c);
}

/* A sample later. */
static void tick(void)
{
    give_commands();
    TEST_ASSERT_TRUE_MESSAGE(instruments_drive(&in, plant, TICK_S, err, sizeof err), err);
    now_s += TICK_S;
    run_to(now_s);
    instruments_measure(&in, plant, TICK_S, &sample);
    for (size_t i = 0; i < WATCHED; i++) {
        const struct watched *w = &watched[i];
        struct output_proof_look look = {.part = (float)(command[w->input] / inputs[w->input].hi),
                                         .reading = (float)reading_of(w->channel),
                                         .usable = true,
                                         .since_ms = (uint32_t)(TICK_S * 1000.0)};
        for (unsigned k = 0; k < INPUTS; k++)
            if (k != w->input)
                look.elsewhere = fmaxf(look.elsewhere, (float)(command[k] / inputs[k].hi));
        told[i] = output_proof_step(&proof[i], &w->c, &look);
    }
}

static void quiet_until(double until_s)
{
    while (now_s < until_s) {
        tick();
        for (size_t i = 0; i < WATCHED; i++) {
            char text[160];
            snprintf(text, sizeof text, "seed %u, %.0f s, %s of %s: %s", SEED, now_s,
                     inputs[watched[i].input].name, watched[i].channel,
                     output_proof_text((uint8_t)told[i]));
            TEST_ASSERT_EQUAL_INT_MESSAGE(PROOF_FINE, told[i], text);
        }
    }
}

static double pick(double lo, double hi)
{
    return lo + (hi - lo) * random_below(&random_of_runs, 10001) / 10000.0;
}

void setUp(void)
{
    random_of_runs = (struct random_source){SEED};
    bench_open("pilot-cold");
    TEST_ASSERT_TRUE_MESSAGE(instruments_init(&in, kind, SEED, 1.0, err, sizeof err), err);
    instruments_begin(&in, plant);
    instruments_measure(&in, plant, 0.0, &sample);
    memset(proof, 0, sizeof proof);
    memset(command, 0, sizeof command);
    now_s = 0.0;
    command[VALVE_REFLUX] = command[VALVE_WATER] = 100.0; /* as the plant begins */
}

void tearDown(void)
{
    bench_close();
}

/* Cooling water, a charge of feed, heat, total reflux, and then the column runs. */
static void start(double heat)
{
    command[VALVE_WATER] = 100.0;
    command[VALVE_REFLUX] = 0.0;
    command[VALVE_FEED] = reading_of("LB") < 18.0 ? 100.0 : 0.0;
    for (unsigned n = 0; n < 180 && reading_of("LB") < 18.0; n++)
        quiet_until(now_s + TICK_S);
    command[VALVE_FEED] = 0.0;
    command[HEATER] = heat;
    quiet_until(now_s + 2400.0);
    command[VALVE_REFLUX] = 100.0;
    quiet_until(now_s + 1200.0);
    command[VALVE_FEED] = 50.0;
    command[VALVE_TOP] = 40.0;
    command[VALVE_BOTTOM] = 39.6;
    command[VALVE_REFLUX] = 37.5;
    command[HEATER] = 0.823;
    quiet_until(now_s + 600.0);
}

/* The temperature of the lowest tray is controlled with the heater. */
static void control(double set, double until_s)
{
    double before = reading_of("T10");
    while (now_s < until_s) {
        double t = reading_of("T10");
        command[HEATER] += 0.05 * (before - t + (set - t) * TICK_S / 600.0);
        command[HEATER] = fmin(fmax(command[HEATER], 0.4), 1.25);
        before = t;
        quiet_until(now_s + TICK_S);
    }
}

static void shut_down(void)
{
    command[HEATER] = command[VALVE_FEED] = command[VALVE_TOP] = command[VALVE_BOTTOM] = 0.0;
    command[VALVE_REFLUX] = 100.0;
    quiet_until(now_s + pick(600.0, 1800.0));
    command[VALVE_REFLUX] = 0.0;
    quiet_until(now_s + 1200.0);
    command[VALVE_WATER] = 0.0;
}

static void a_column_that_is_well_is_never_accused(void)
{
    unsigned runs = 0;
    for (; now_s < most_hours * 3600.0; runs++) {
        start(pick(0.8, 1.25));
        for (unsigned n = 3 + random_below(&random_of_runs, 6); n > 0; n--) {
            switch (random_below(&random_of_runs, 5)) {
            case 0:
                set("xF", pick(20.0, 60.0));
                break;
            case 1:
                set("TF", pick(15.0, 80.0));
                break;
            case 2:
                command[VALVE_FEED] = pick(30.0, 70.0);
                break;
            default:
                break;
            }
            control(pick(100.0, 112.0), now_s + pick(900.0, 3600.0));
        }
        shut_down();
        set("Tamb", pick(10.0, 35.0));
        set("P", pick(720.0, 790.0));
        set("loss", pick(0.7, 1.5));
        quiet_until(now_s + (runs % 8 == 7 ? 72.0 * 3600.0 : pick(600.0, 12.0 * 3600.0)));
    }
    printf("no false alarm in %.0f h of the cold pilot column: %u starts\n", now_s / 3600.0, runs);
}

/* ---- faults ---- */

static void heater_is(double power)
{
    instruments_set(&in, channel("Qrb"), OPTION_STUCK, power);
}

/* Waits until the fault is told of what is watched, within so many seconds and two samples. */
static void told_after(size_t what, enum output_proof_fault fault, double most_s)
{
    double from = now_s;
    while (told[what] == PROOF_FINE) {
        tick();
        TEST_ASSERT_TRUE_MESSAGE(now_s - from <= most_s + 2.0 * TICK_S,
                                 output_proof_text((uint8_t)fault));
    }
    TEST_ASSERT_EQUAL_INT(fault, told[what]);
    printf("%-3s %.45s...: %4.0f s, bound %.0f s\n", watched[what].channel,
           output_proof_text((uint8_t)fault), now_s - from, most_s);
}

static void a_relay_that_shorts_in_the_cold_is_told(void)
{
    command[VALVE_REFLUX] = command[VALVE_WATER] = 0.0;
    quiet_until(3600.0);
    heater_is(1.5);
    told_after(0, PROOF_WARMS, 3.0 * watched[0].c.on_s);
}

static void a_relay_that_shorts_at_the_boil_is_told(void)
{
    start(1.0);
    control(106.0, now_s + 3600.0);
    heater_is(1.5);
    command[HEATER] = 0.0;
    told_after(0, PROOF_NOT_COOLING, watched[0].c.off_s);
}

static void a_heater_that_fails_on_the_way_to_the_boil_is_told(void)
{
    command[HEATER] = 1.2;
    quiet_until(300.0);
    heater_is(0.0);
    told_after(0, PROOF_NO_HEAT, 2.0 * watched[0].c.on_s);
}

static void a_heater_that_fails_at_the_boil_is_told_below_it(void)
{
    start(1.0);
    control(106.0, now_s + 3600.0);
    heater_is(0.0);
    command[HEATER] = 1.25;
    while (reading_of("TB") >= (double)watched[0].c.limit) {
        tick();
        TEST_ASSERT_EQUAL_INT(PROOF_FINE, told[0]);
    }
    told_after(0, PROOF_NO_HEAT, 2.0 * watched[0].c.on_s);
}

static void feed_that_flows_through_a_closed_valve_is_told(void)
{
    quiet_until(600.0);
    instruments_set(&in, channel("vF"), OPTION_STUCK, 30.0);
    told_after(3, PROOF_FLOWS, 2.0 * watched[3].c.off_s);
}

static void cooling_water_that_fails_is_told(void)
{
    quiet_until(600.0);
    set("supply", 0.0);
    told_after(4, PROOF_NO_FLOW, 2.0 * watched[4].c.on_s);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        most_hours = atof(argv[1]);
    UNITY_BEGIN();
    RUN_TEST(a_column_that_is_well_is_never_accused);
    RUN_TEST(a_relay_that_shorts_in_the_cold_is_told);
    RUN_TEST(a_relay_that_shorts_at_the_boil_is_told);
    RUN_TEST(a_heater_that_fails_on_the_way_to_the_boil_is_told);
    RUN_TEST(a_heater_that_fails_at_the_boil_is_told_below_it);
    RUN_TEST(feed_that_flows_through_a_closed_valve_is_told);
    RUN_TEST(cooling_water_that_fails_is_told);
    return UNITY_END();
}
