/* Motor valves, on a model of the drive: a valve that really is somewhere, with or without contacts at its ends.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs_bench.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>

static struct random_source random_source;
static struct output_settings settings;
static double place;              /* of the real valve, 0 closed to 1 open */
static double rate;               /* of the real valve, 1/ms */
static bool has_contacts, broken; /* broken: the contacts never close */
static int last_way;              /* of the real motor: 1 opens, -1 closes */
static unsigned still_ms;         /* since the motor ran */
static unsigned starts;

void setUp(void) {}
void tearDown(void)
{
    bench_tell_seed();
}

static uint32_t below(uint32_t n)
{
    return random_below(&random_source, n);
}

static void move_contacts(void)
{
    bench_pins[settings.pin[OUTPUT_OPEN_END]].contact = !broken && place >= 1.0;
    bench_pins[settings.pin[OUTPUT_CLOSED_END]].contact = !broken && place <= 0.0;
}

static void begin(bool contacts, double at_first, double off_rate)
{
    bench_begin();
    settings = bench_settings(OUTPUT_MOTOR_VALVE, 2);
    settings.travel = 10.0f;
    settings.dead_band = 0.02f;
    settings.pause = 0.5f;
    place = at_first;
    rate = 1.0 / 10000.0 * off_rate;
    has_contacts = contacts;
    broken = false;
    if (!contacts)
        settings.pin[OUTPUT_OPEN_END] = settings.pin[OUTPUT_CLOSED_END] = HAL_PIN_NONE;
    else
        move_contacts();
    last_way = 0;
    still_ms = 0;
    starts = 0;
    bench_open(&settings, 1);
}

/* A millisecond of the drive: it is never told to go both ways, and rests before it turns back. */
static void turn(void)
{
    bench_turn();
    bool opens = bench_on(settings.pin[OUTPUT_PIN]);
    bool closes = bench_on(settings.pin[OUTPUT_SECOND_PIN]);
    TEST_ASSERT_FALSE(opens && closes);
    int way = opens - closes;
    if (way && still_ms)
        starts++;
    if (way && last_way && way != last_way)
        TEST_ASSERT_GREATER_OR_EQUAL(500, still_ms);
    still_ms = way ? 0 : still_ms + 1;
    last_way = way ? way : last_way;
    place += way * rate;
    place = place < 0.0 ? 0.0 : place > 1.0 ? 1.0 : place;
    if (has_contacts)
        move_contacts();
}

static void run(double command, unsigned ms)
{
    for (unsigned k = 0; k < ms; k++) {
        outputs_command(0, true, (float)command);
        turn();
    }
}

static void it_finds_its_end_first_and_then_goes_where_it_is_told(void)
{
    for (unsigned contacts = 0; contacts < 2; contacts++)
        for (unsigned where = 0; where <= 10; where++) {
            begin(contacts, where / 10.0, 1.0);
            run(0.4, 1);
            TEST_ASSERT_TRUE(outputs_faults(0) & OUTPUT_NO_POSITION || (contacts && where == 0));
            run(0.4, 12000 + 5000);
            TEST_ASSERT_EQUAL(0, outputs_faults(0));
            TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.4, place);
        }
}

static void with_a_safe_place_that_is_open_it_finds_the_open_end(void)
{
    begin(true, 0.5, 1.0);
    settings.safe = 1.0f;
    bench_open(&settings, 1);
    run(0.4, 4900);
    TEST_ASSERT_TRUE(place > 0.9);
    run(0.4, 10000);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.4, place);
}

static void random_commands_never_close_both_and_stay_within_the_dead_band(void)
{
    for (uint32_t seed = 1; seed <= 30; seed++) {
        random_source = bench_random(seed);
        begin(seed % 2, below(101) / 100.0, 1.0);
        run(0.0, 12000);
        for (unsigned piece = 0; piece < 60; piece++) {
            uint32_t how = below(6);
            double command = how == 0 ? 0.0 : how == 1 ? 1.0 : below(1001) / 1000.0;
            run(command, below(3000)); /* it may be on its way */
            if (below(3))
                continue;
            run(command, 13000);
            TEST_ASSERT_DOUBLE_WITHIN(0.0221, command, place);
            (void)outputs_readback(0);
            run(command, 100);
            TEST_ASSERT_DOUBLE_WITHIN(0.002, place, (double)outputs_readback(0));
        }
    }
}

static void changes_within_the_dead_band_do_not_start_the_motor(void)
{
    begin(false, 0.0, 1.0);
    run(0.5, 25000);
    unsigned before = starts;
    for (unsigned k = 0; k < 50; k++) {
        run(0.519, 200);
        run(0.481, 200);
    }
    TEST_ASSERT_EQUAL(before, starts);
    run(0.53, 1000);
    TEST_ASSERT_EQUAL(before + 1, starts);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.53, place);
}

/* The drive is 5 % slower than it should be, so that reckoning alone drifts. */
static void each_way_to_an_end_sets_the_position_anew(void)
{
    for (unsigned contacts = 0; contacts < 2; contacts++) {
        begin(contacts, 0.7, 0.95);
        run(0.0, 16000);
        for (unsigned k = 0; k < 40; k++) {
            run(0.3, 8000);
            run(0.8, 8000);
            TEST_ASSERT_DOUBLE_WITHIN(0.15, 0.8, place);
            run(k % 2 ? 1.0 : 0.0, 16000);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, k % 2 ? 1.0 : 0.0, place);
            run(0.5, 10000);
            TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.5, place);
        }
    }
}

static void a_contact_that_closes_on_the_way_sets_the_position(void)
{
    begin(true, 0.0, 1.3); /* faster than reckoned */
    run(0.9, 16000);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.9, place);
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
}

static void a_contact_that_bounces_is_not_believed(void)
{
    begin(true, 0.0, 1.0);
    run(0.5, 10000);
    outputs_command(0, true, 1.0f);
    for (unsigned k = 0; k < 2000; k++) {
        bench_pins[settings.pin[OUTPUT_OPEN_END]].contact = k % 5 != 0; /* at most 4 ms in a row */
        outputs_command(0, true, 1.0f);
        bench_turn();
        place += rate * bench_on(settings.pin[OUTPUT_PIN]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.7, place);
}

static void a_contact_that_never_closes_is_told_and_the_motor_stops(void)
{
    begin(true, 0.2, 1.0);
    broken = true;
    run(0.0, 500 + 10000 + 4900);
    TEST_ASSERT_TRUE(bench_on(settings.pin[OUTPUT_SECOND_PIN]));
    run(0.0, 200);
    TEST_ASSERT_FALSE(bench_on(settings.pin[OUTPUT_SECOND_PIN]));
    TEST_ASSERT_EQUAL(OUTPUT_END_MISSED, outputs_faults(0));
    broken = false;
    run(1.0, 20000);
    TEST_ASSERT_EQUAL(0, outputs_faults(0));
}

static void both_contacts_closed_stop_the_motor_and_are_told(void)
{
    begin(true, 0.0, 1.0);
    run(1.0, 4000);
    has_contacts = false;
    bench_pins[settings.pin[OUTPUT_OPEN_END]].contact = true;
    bench_pins[settings.pin[OUTPUT_CLOSED_END]].contact = true;
    run(1.0, 10);
    TEST_ASSERT_FALSE(bench_on(settings.pin[OUTPUT_PIN]));
    TEST_ASSERT_EQUAL(OUTPUT_BOTH_ENDS, outputs_faults(0) & OUTPUT_BOTH_ENDS);
    double before = place;
    run(0.0, 2000);
    TEST_ASSERT_TRUE(place == before);
    has_contacts = true;
    run(0.0, 8000);
    TEST_ASSERT_EQUAL(0, outputs_faults(0) & OUTPUT_BOTH_ENDS);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, place);
}

static void a_command_that_turns_back_at_any_moment_waits_for_the_pause(void)
{
    for (unsigned when = 1; when < 700; when += 3) {
        begin(false, 0.0, 1.0);
        run(0.5, 18000);
        run(0.9, when);
        run(0.1, 1200); /* turn() checks the pause */
        TEST_ASSERT_TRUE(bench_on(settings.pin[OUTPUT_SECOND_PIN]));
    }
}

static void nobody_drives_it_to_its_safe_place(void)
{
    begin(false, 0.0, 1.0);
    settings.safe = 0.25f;
    bench_open(&settings, 1);
    run(0.9, 25000);
    for (unsigned k = 0; k < 10000; k++) {
        outputs_command(0, false, 0.9f);
        turn();
    }
    TEST_ASSERT_EQUAL(OUTPUT_NO_DRIVER, outputs_rule(0));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.25, place);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_finds_its_end_first_and_then_goes_where_it_is_told);
    RUN_TEST(with_a_safe_place_that_is_open_it_finds_the_open_end);
    RUN_TEST(random_commands_never_close_both_and_stay_within_the_dead_band);
    RUN_TEST(changes_within_the_dead_band_do_not_start_the_motor);
    RUN_TEST(each_way_to_an_end_sets_the_position_anew);
    RUN_TEST(a_contact_that_closes_on_the_way_sets_the_position);
    RUN_TEST(a_contact_that_bounces_is_not_believed);
    RUN_TEST(a_contact_that_never_closes_is_told_and_the_motor_stops);
    RUN_TEST(both_contacts_closed_stop_the_motor_and_are_told);
    RUN_TEST(a_command_that_turns_back_at_any_moment_waits_for_the_pause);
    RUN_TEST(nobody_drives_it_to_its_safe_place);
    return UNITY_END();
}
