/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* What is at pins of the board itself: a voltage, pulses and a contact follow the quantity of their line, and have the faults of theirs. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "chips/wired.h"
#include "unity.h"

#define MS   UINT64_C(1000000)
#define S    UINT64_C(1000000000)
#define NEAR 1e-9

static char path[64];
static char err[512];
static struct wired *w;
static const struct world *world;

enum { AT_U = 32, AT_F = 41, AT_G = 50, AT_M = 39, AT_ONE = 38, AT_L = 40, AT_N = 37 };
static const char lines[] = "U  analog PC0 lo=0 hi=50 lo_in=0.4 hi_in=2\n"
                            "F  flow   PC9 hi=8 hi_in=1\n"
                            "G  flow   PD2 quantity=F hi=8 hi_in=1\n"
                            "M  mains  PC7\n"
                            "O  mains  PC6 frequency=60 per_cycle=1\n"
                            "L  level  PC8 limit=10 hysteresis=2 bounce=8\n"
                            "N  level  PC5 limit=10 normally=closed bounce=0\n";

void setUp(void)
{
    (void)snprintf(path, sizeof(path), "/tmp/at_pin_test_XXXXXX");
    int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0);
    TEST_ASSERT_EQUAL_INT((int)strlen(lines), (int)write(file, lines, strlen(lines)));
    (void)close(file);
    w = wired_open(path, 1, err, sizeof(err));
    TEST_ASSERT_NOT_NULL_MESSAGE(w, err);
    world = wired_world(w);
}

void tearDown(void)
{
    wired_close(w);
    (void)remove(path);
}

static void measure(uint64_t now_ns, const char *name, double value)
{
    wired_measure(w, now_ns, name, value);
}

static void fault(uint64_t now_ns, const char *name, const char *what, double value)
{
    TEST_ASSERT_TRUE_MESSAGE(wired_fault(w, now_ns, name, what, value, err, sizeof(err)), err);
}

static double volts(uint64_t now_ns)
{
    return world->pin_volts(world->context, now_ns, AT_U);
}

static bool low(uint64_t now_ns, unsigned pin)
{
    return world->pin_input(world->context, now_ns, pin) == PIN_LEVEL_LOW;
}

/* Falling edges of a pin from one moment to another, by the edges that the world announces. */
static unsigned falling(uint64_t from_ns, uint64_t to_ns, unsigned pin)
{
    unsigned n = 0;
    bool before = low(from_ns, pin);
    for (uint64_t at = world->next_edge(world->context, from_ns); at <= to_ns;
         at = world->next_edge(world->context, at)) {
        n += low(at, pin) && !before;
        before = low(at, pin);
    }
    return n;
}

/* ---- a voltage ---- */

static void a_voltage_follows_its_quantity_and_stays_within_what_a_pin_bears(void)
{
    measure(0, "U", 25);
    TEST_ASSERT_DOUBLE_WITHIN(NEAR, 1.2, volts(1 * MS));
    measure(1 * S, "U", 1000);
    TEST_ASSERT_DOUBLE_WITHIN(NEAR, 3.6, volts(1 * S));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, world->pin_volts(world->context, 1 * S, AT_F));
}

static void a_broken_or_shorted_wire_has_the_voltage_of_a_rail_until_it_is_mended(void)
{
    static const struct {
        const char *what;
        double volts;
    } cases[] = {{"open", 0.0}, {"short_low", 0.0}, {"short_high", 3.3}};
    for (unsigned i = 0; i < 3; i++) {
        measure(i * S, "U", 25);
        fault(i * S + MS, "U", cases[i].what, 1);
        measure(i * S + 2 * MS, "U", 50);
        TEST_ASSERT_DOUBLE_WITHIN(NEAR, cases[i].volts, volts(i * S + 3 * MS));
        fault(i * S + 4 * MS, "U", cases[i].what, 0);
        TEST_ASSERT_DOUBLE_WITHIN(NEAR, 2.0, volts(i * S + 5 * MS));
    }
}

static void a_frozen_voltage_stays_whatever_is_measured(void)
{
    measure(0, "U", 25);
    fault(1 * S, "U", "frozen", 1);
    measure(2 * S, "U", 50);
    measure(3 * S, "U", 0);
    TEST_ASSERT_DOUBLE_WITHIN(NEAR, 1.2, volts(4 * S));
    fault(5 * S, "U", "frozen", 0);
    TEST_ASSERT_DOUBLE_WITHIN(NEAR, 0.4, volts(5 * S));
}

static void noise_has_its_deviation_and_is_the_same_for_all_who_look_in_a_millisecond(void)
{
    double sum = 0.0, squares = 0.0;
    measure(0, "U", 25);
    fault(0, "U", "pickup", 0.1);
    for (unsigned ms = 1; ms <= 4000; ms++) {
        double off = volts(ms * MS) - 1.2;
        TEST_ASSERT_EQUAL_DOUBLE(volts(ms * MS), volts(ms * MS - MS / 5));
        sum += off;
        squares += off * off;
    }
    TEST_ASSERT_DOUBLE_WITHIN(4 * 0.1 / 63, 0.0, sum / 4000);              /* 4 sd of the mean */
    TEST_ASSERT_DOUBLE_WITHIN(4 * 0.01 * 1.42 / 63, 0.01, squares / 4000); /* and of the variance */
}

/* ---- pulses ---- */

static void a_meter_gives_as_many_pulses_as_have_flown_however_the_flow_changes(void)
{
    unsigned n = 0;
    double expected = 0.0;
    for (unsigned s = 0; s < 200; s++) {
        double flow = s % 7 * 33.3;
        measure(s * S, "F", flow);
        n += falling(s * S, (s + 1) * S, AT_F);
        expected += flow / 8.0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1.0, expected, n);
}

static void meters_whose_pulses_come_in_the_same_moment_are_both_seen(void)
{
    measure(0, "F", 200);
    measure(0, "G", 200);
    TEST_ASSERT_EQUAL_UINT(25, falling(0, 1 * S, AT_F));
    TEST_ASSERT_EQUAL_UINT(25, falling(0, 1 * S, AT_G));
}

static void no_pulse_comes_near_the_moment_in_which_a_board_looks(void)
{
    measure(0, "F", 8 * 1900.0);
    fault(0, "F", "pickup", 500);
    for (uint64_t at = world->next_edge(world->context, 0); at < 1 * S;
         at = world->next_edge(world->context, at)) {
        if (low(at, AT_F))
            TEST_ASSERT_TRUE(at % MS >= MS / 5 && at % MS <= MS / 10 * 7);
    }
}

static void a_meter_that_has_stopped_gives_no_pulses_and_none_that_were_missed(void)
{
    measure(0, "F", 80);
    fault(1 * S, "F", "stopped", 1);
    TEST_ASSERT_EQUAL_UINT(0, falling(1 * S, 5 * S, AT_F));
    fault(5 * S, "F", "stopped", 0);
    TEST_ASSERT_EQUAL_UINT(10, falling(5 * S, 6 * S, AT_F));
}

static void a_bouncing_meter_gives_three_pulses_for_one(void)
{
    measure(0, "F", 80);
    fault(0, "F", "bounce", 1);
    TEST_ASSERT_EQUAL_UINT(30, falling(0, 1 * S, AT_F));
}

static void a_wire_picks_up_pulses_without_flow(void)
{
    fault(0, "F", "pickup", 250);
    unsigned n = falling(0, 40 * S, AT_F);
    TEST_ASSERT_TRUE(n > 9600 && n < 10400); /* 10,000 and 4 sd of 87 */
}

static void nothing_flows_before_plant_time_begins(void)
{
    measure(0, WIRED_TIME, 0);
    measure(0, "F", 80);
    TEST_ASSERT_EQUAL_UINT(0, falling(0, 3 * S, AT_F));
    measure(3 * S, WIRED_TIME, 1);
    TEST_ASSERT_EQUAL_UINT(10, falling(3 * S, 4 * S, AT_F));
}

static void the_mains_cross_zero_once_or_twice_a_cycle(void)
{
    TEST_ASSERT_EQUAL_UINT(1000, falling(0, 10 * S, AT_M));
    TEST_ASSERT_EQUAL_UINT(600, falling(0, 10 * S, AT_ONE));
}

static void the_mains_may_be_lost_and_have_another_frequency(void)
{
    fault(1 * S, "M", "lost", 1);
    TEST_ASSERT_EQUAL_UINT(0, falling(1 * S, 2 * S, AT_M));
    fault(2 * S, "M", "lost", 0);
    fault(2 * S, "M", "shift", -10);
    TEST_ASSERT_EQUAL_UINT(80, falling(2 * S, 3 * S, AT_M));
}

/* ---- a contact ---- */

static void a_contact_closes_at_its_limit_and_opens_below_its_hysteresis(void)
{
    static const double value[] = {9.9, 10.0, 8.1, 8.0, 9.9};
    static const bool closed[] = {false, true, true, false, false};
    for (unsigned i = 0; i < 5; i++) {
        measure((i + 1) * S, "L", value[i]);
        TEST_ASSERT_EQUAL_INT(closed[i], low((i + 1) * S + 500 * MS, AT_L));
    }
}

static void one_that_is_normally_closed_opens_at_its_limit_at_once(void)
{
    measure(1 * S, "N", 9);
    TEST_ASSERT_TRUE(low(1 * S + 100 * MS, AT_N));
    measure(2 * S, "N", 11);
    TEST_ASSERT_TRUE(low(2 * S, AT_N));
    TEST_ASSERT_FALSE(low(2 * S + 1 * MS, AT_N));
}

static void a_contact_bounces_for_its_time_and_no_longer(void)
{
    unsigned edges = 0;
    for (unsigned s = 1; s <= 40; s++) {
        measure(s * S, "L", s % 2 ? 20 : 0);
        edges += falling(s * S, s * S + 9 * MS, AT_L);
        TEST_ASSERT_EQUAL_UINT(0, falling(s * S + 9 * MS, s * S + 900 * MS, AT_L));
        TEST_ASSERT_EQUAL_INT(s % 2, low(s * S + 9 * MS, AT_L));
    }
    TEST_ASSERT_TRUE(edges > 40); /* 20 without bounces */
}

static void a_contact_that_jams_in_the_moment_of_a_change_stays_as_it_was(void)
{
    measure(1 * S, "L", 20);
    fault(1 * S, "L", "jammed", 1);
    TEST_ASSERT_FALSE(low(1 * S + 100 * MS, AT_L));
}

static void a_contact_moves_in_the_middle_of_a_millisecond(void)
{
    fault(0, "M", "lost", 1);
    fault(0, "O", "lost", 1);
    measure(1 * S, "L", 20);
    uint64_t at = world->next_edge(world->context, 1 * S);
    for (; at != UINT64_MAX; at = world->next_edge(world->context, at)) {
        TEST_ASSERT_EQUAL_UINT64(MS / 2, at % MS);
        TEST_ASSERT_TRUE(low(at, AT_L) != low(at - 1, AT_L));
    }
}

static void a_contact_may_jam_chatter_and_have_broken_or_shorted_wires(void)
{
    measure(1 * S, "L", 20);
    fault(2 * S, "L", "open", 1);
    TEST_ASSERT_FALSE(low(2 * S + 100 * MS, AT_L));
    fault(3 * S, "L", "open", 0);
    fault(3 * S, "L", "jammed", 1);
    measure(4 * S, "L", 0);
    TEST_ASSERT_TRUE(low(4 * S + 100 * MS, AT_L));
    fault(5 * S, "L", "jammed", 0);
    TEST_ASSERT_FALSE(low(5 * S + 100 * MS, AT_L));
    fault(6 * S, "L", "short", 1);
    TEST_ASSERT_TRUE(low(6 * S + 100 * MS, AT_L));
    fault(7 * S, "L", "short", 0);
    fault(7 * S, "L", "chatter", 10);
    unsigned n = falling(7 * S, 17 * S, AT_L);
    TEST_ASSERT_TRUE(n > 187 && n < 313); /* 250 in 1,000 steps, 4 sd of 16 */
}

/* ---- boards that look a little earlier and later ---- */

/* Counts and levels that a board finds which looks so long before each whole millisecond of its world. */
static void look(uint64_t early_ns, unsigned counts[3000], bool closed[3000])
{
    uint64_t base = 5 * S;
    measure(base, WIRED_TIME, 0);
    measure(base, WIRED_TIME, 1);
    unsigned n = 0;
    uint64_t seen = base;
    for (unsigned ms = 0; ms < 3000; ms++) {
        uint64_t now = base + (ms + 1) * MS - early_ns;
        n += falling(seen, now, AT_F);
        seen = now;
        counts[ms] = n;
        closed[ms] = low(now, AT_L);
        if (ms % 1000 == 999) {
            n += falling(seen, base + (ms + 1) * MS, AT_F);
            seen = base + (ms + 1) * MS;
            measure(seen, "F", ms / 1000 * 160 + 80);
            measure(seen, "L", ms / 1000 % 2 ? 0 : 20);
        }
    }
}

static void boards_that_look_a_part_of_a_millisecond_apart_see_the_same(void)
{
    static unsigned first[3000], other[3000];
    static bool closed[3000], likewise[3000];
    look(0, first, closed);
    tearDown();
    setUp();
    look(MS / 5, other, likewise);
    TEST_ASSERT_EQUAL_UINT_ARRAY(first, other, 3000);
    TEST_ASSERT_EQUAL_MEMORY(closed, likewise, sizeof(closed));
    TEST_ASSERT_TRUE(first[2999] >= 39);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_voltage_follows_its_quantity_and_stays_within_what_a_pin_bears);
    RUN_TEST(a_broken_or_shorted_wire_has_the_voltage_of_a_rail_until_it_is_mended);
    RUN_TEST(a_frozen_voltage_stays_whatever_is_measured);
    RUN_TEST(noise_has_its_deviation_and_is_the_same_for_all_who_look_in_a_millisecond);
    RUN_TEST(a_meter_gives_as_many_pulses_as_have_flown_however_the_flow_changes);
    RUN_TEST(meters_whose_pulses_come_in_the_same_moment_are_both_seen);
    RUN_TEST(no_pulse_comes_near_the_moment_in_which_a_board_looks);
    RUN_TEST(a_meter_that_has_stopped_gives_no_pulses_and_none_that_were_missed);
    RUN_TEST(a_bouncing_meter_gives_three_pulses_for_one);
    RUN_TEST(a_wire_picks_up_pulses_without_flow);
    RUN_TEST(nothing_flows_before_plant_time_begins);
    RUN_TEST(the_mains_cross_zero_once_or_twice_a_cycle);
    RUN_TEST(the_mains_may_be_lost_and_have_another_frequency);
    RUN_TEST(a_contact_closes_at_its_limit_and_opens_below_its_hysteresis);
    RUN_TEST(one_that_is_normally_closed_opens_at_its_limit_at_once);
    RUN_TEST(a_contact_bounces_for_its_time_and_no_longer);
    RUN_TEST(a_contact_that_jams_in_the_moment_of_a_change_stays_as_it_was);
    RUN_TEST(a_contact_moves_in_the_middle_of_a_millisecond);
    RUN_TEST(a_contact_may_jam_chatter_and_have_broken_or_shorted_wires);
    RUN_TEST(boards_that_look_a_part_of_a_millisecond_apart_see_the_same);
    return UNITY_END();
}
