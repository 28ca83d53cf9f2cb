/* What the estimator of compositions says, when, and how good its estimates are then. */
#include <math.h>
#include <stdio.h>

#include "composition_bench.h"

void setUp(void)
{
    bench_pilot();
}

void tearDown(void) {}

static void says_nothing(void)
{
    TEST_ASSERT_EQUAL_HEX16(0, io.requests.raised);
}

static void says(unsigned event, float value)
{
    TEST_ASSERT_EQUAL_HEX16(1u << event, io.requests.raised);
    TEST_ASSERT_EQUAL_FLOAT(value, event_value[event]);
}

static void is_called(enum quality wanted)
{
    for (unsigned k = 0; k < setup.points; k++)
        TEST_ASSERT_EQUAL(wanted, point_quality[k]);
}

/* ---- locking on ---- */

static void it_is_uncertain_until_it_has_locked_on(void)
{
    begin();
    is_called(QUALITY_UNCERTAIN);
    for (unsigned n = 1; n <= LOCKED + 2; n++) {
        step();
        is_called(n < LOCKED ? QUALITY_UNCERTAIN : QUALITY_GOOD);
        says_nothing();
    }
}

/* Three times 1/lambda of the slowest that moves anything. */
static void the_slowest_temperature_says_when_it_has_locked_on(void)
{
    all_settings.tune[T_LOW][TUNE_LAMBDA] = 20;
    all_settings.tune[T_HIGH][TUNE_LAMBDA] = 5;
    all_settings.tune[T_COMPARED][TUNE_LAMBDA] = 1;
    begin();
    steps(215);
    is_called(QUALITY_UNCERTAIN);
    steps(2);
    is_called(QUALITY_GOOD);
}

/* ---- lost, alone, no_input ---- */

static void a_temperature_that_is_missing_is_lost(void)
{
    begin();
    steps(LOCKED);
    quality[T_HIGH] = QUALITY_UNCERTAIN;
    step();
    says(EVENT_LOST, T_HIGH + 1);
    is_called(QUALITY_UNCERTAIN);
    quality[T_LOW] = QUALITY_BAD;
    step();
    says(EVENT_LOST, T_LOW + 1);
    quality[T_LOW] = quality[T_HIGH] = QUALITY_GOOD;
    step(); /* two steps without one of the sections cost two */
    says_nothing();
    is_called(QUALITY_UNCERTAIN);
    step();
    is_called(QUALITY_GOOD);
}

static void a_section_that_was_not_seen_for_a_while_is_uncertain_for_as_long_again(void)
{
    begin();
    steps(2 * LOCKED);
    quality[T_LOW] = QUALITY_MISSING;
    steps(20);
    quality[T_LOW] = QUALITY_GOOD;
    for (unsigned n = 1; n <= 20; n++) {
        step();
        is_called(n < 20 ? QUALITY_UNCERTAIN : QUALITY_GOOD);
    }
}

/* One that is only compared, and none at all. */
static void a_point_in_a_section_without_a_thermometer_is_never_good(void)
{
    all_settings.s.place[T_HIGH][OF_COMPONENT] = 0;
    begin();
    steps(10 * LOCKED);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[TOP_FRACTION]);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[INNER_TEMPERATURE]);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[BOTTOM_FRACTION]);
}

static void a_point_of_the_feed_needs_a_thermometer_in_any_section(void)
{
    all_settings.s.place[T_HIGH][OF_COMPONENT] = 0;
    all_settings.s.quantity[TOP_FRACTION] = OF_FEED_FRACTION;
    all_settings.s.point[TOP_FRACTION][AT_STAGE] = 0;
    begin();
    steps(LOCKED + 1);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[TOP_FRACTION]);
}

static void what_was_far_off_and_is_believed_leaves_nothing_good(void)
{
    all_settings.s.nis = 0;
    all_settings.tune[T_HIGH][TUNE_LAMBDA] = 1; /* it finds it slowly */
    begin();
    steps(12 * LOCKED);
    is_called(QUALITY_GOOD);
    put(T_HIGH, truth(10) + 25);
    steps(60);
    TEST_ASSERT_TRUE(block.sensors.sensor[1].present);
    TEST_ASSERT_TRUE(fabsf((float)block.sensors.sensor[1].e) > 10);
    is_called(QUALITY_UNCERTAIN);
}

static void without_heat_nothing_reaches_the_product(void)
{
    begin();
    steps(2 * LOCKED);
    put(HEAT, 0);
    for (unsigned n = 0; n < 60; n++) {
        step();
        TEST_ASSERT_TRUE(raised(EVENT_NO_BOIL));
        is_called(QUALITY_UNCERTAIN);
    }
    step();
    TEST_ASSERT_FALSE(raised(EVENT_ALONE));
    is_called(QUALITY_BAD);
}

static void one_that_is_only_compared_is_not_missed(void)
{
    begin();
    steps(LOCKED);
    quality[T_COMPARED] = QUALITY_MISSING;
    step();
    says_nothing();
    is_called(QUALITY_GOOD);
}

static void without_any_temperature_the_model_counts_for_a_while(void)
{
    begin();
    steps(LOCKED);
    quality[T_LOW] = quality[T_HIGH] = QUALITY_BAD;
    for (unsigned n = 0; n < 60; n++) { /* 600 s */
        step();
        says(EVENT_LOST, T_LOW + 1);
        is_called(QUALITY_UNCERTAIN);
    }
    step();
    TEST_ASSERT_TRUE(raised(EVENT_ALONE));
    TEST_ASSERT_EQUAL_FLOAT(1, event_value[EVENT_ALONE]);
    is_called(QUALITY_BAD);
    quality[T_LOW] = QUALITY_GOOD;
    step();
    says(EVENT_LOST, T_HIGH + 1);
    is_called(QUALITY_UNCERTAIN);
    quality[T_LOW] = QUALITY_BAD;
    steps(60); /* counted anew */
    TEST_ASSERT_FALSE(raised(EVENT_ALONE));
}

static void a_flow_that_is_missing_is_told_with_its_input(void)
{
    begin();
    steps(LOCKED);
    quality[REFLUX] = QUALITY_MISSING;
    step();
    says(EVENT_NO_INPUT, REFLUX + 1);
    is_called(QUALITY_UNCERTAIN);
    quality[FEED] = QUALITY_BAD;
    step();
    says(EVENT_NO_INPUT, FEED + 1);
    quality[FEED] = quality[REFLUX] = QUALITY_UNCERTAIN;
    step();
    says_nothing();
    is_called(QUALITY_GOOD);
}

/* ---- no_state ---- */

/* The model cannot have a fraction that is none. */
static void break_the_model(void)
{
    block.model.x[0] = NAN;
}

static void without_a_solution_it_begins_anew_and_says_so(void)
{
    begin();
    steps(2 * LOCKED);
    break_the_model();
    step();
    says(EVENT_NO_STATE, 1);
    is_called(QUALITY_BAD);
    TEST_ASSERT_EQUAL_FLOAT(1, shown("bounced"));
    TEST_ASSERT_EQUAL_FLOAT(block.model.table.profile[0], block.model.x[0]);
    TEST_ASSERT_EQUAL(0, block.watch.steps);
    for (unsigned n = 1; n <= LOCKED; n++) {
        step();
        says_nothing();
        is_called(n < LOCKED ? QUALITY_UNCERTAIN : QUALITY_GOOD);
    }
}

static void without_a_solution_in_its_first_tick_its_points_are_bad(void)
{
    begin();
    kind->follow(&block, &io);
    break_the_model();
    step();
    is_called(QUALITY_BAD);
}

static void how_often_it_began_anew_stops_counting_at_the_largest_number(void)
{
    begin();
    block.model.restarts = UINT16_MAX - 1;
    for (unsigned n = 0; n < 3; n++) {
        break_the_model();
        step();
    }
    TEST_ASSERT_EQUAL(UINT16_MAX, block.model.restarts);
}

/* ---- pull, nis, apart ---- */

/* A second temperature of the rectifying section. */
static void begin_with_a_third(float pull, float nis, float apart)
{
    all_settings.s.pull = pull;
    all_settings.s.nis = nis;
    all_settings.s.apart = apart;
    temperature_at(FURTHER, 8, 1);
    setup.inputs++;
    begin();
}

/* The first input of which this is more than the limit. */
static float first_above(const char *names, float limit)
{
    static const unsigned inputs[] = {T_LOW, T_HIGH, T_COMPARED, FURTHER};
    for (unsigned k = 0; k < 4; k++) {
        char name[16];
        snprintf(name, sizeof name, "%s_%u", names, inputs[k] + 1);
        if (fabsf(shown(name)) > limit)
            return (float)(inputs[k] + 1);
    }
    TEST_FAIL_MESSAGE(names);
    return 0;
}

static void an_alarm_waits_for_the_mean_it_is_of(unsigned event, const char *names, float limit)
{
    put(FURTHER, truth(8) + 4);
    for (unsigned n = 1; n < WATCHES; n++) {
        step();
        TEST_ASSERT_FALSE(raised(event));
    }
    step();
    says(event, first_above(names, limit));
    is_called(QUALITY_BAD);
}

static void a_temperature_that_draws_too_hard_is_told(void)
{
    begin_with_a_third(20, 0, 0);
    an_alarm_waits_for_the_mean_it_is_of(EVENT_PULL, "pull", 20);
}

static void innovations_that_are_too_large_are_told(void)
{
    begin_with_a_third(0, 4, 0);
    an_alarm_waits_for_the_mean_it_is_of(EVENT_NIS, "nis", 4);
}

static void temperatures_that_contradict_each_other_are_told(void)
{
    begin_with_a_third(0, 0, 1);
    put(FURTHER, truth(8) + 4);
    steps(WATCHES - 1);
    TEST_ASSERT_FALSE(raised(EVENT_APART));
    step();
    TEST_ASSERT_EQUAL_HEX16(1u << EVENT_APART, io.requests.raised);
    unsigned odd = whole_odd(&block, 1);
    TEST_ASSERT_TRUE(odd == T_HIGH + 1 || odd == FURTHER + 1);
    TEST_ASSERT_EQUAL_FLOAT((float)odd, event_value[EVENT_APART]);
    is_called(QUALITY_BAD);
}

static void an_alarm_at_zero_is_none(void)
{
    begin_with_a_third(0, 0, 0);
    put(FURTHER, truth(8) + 5);
    steps(WATCHES + 50);
    says_nothing();
    is_called(QUALITY_GOOD);
}

static void what_agrees_raises_no_alarm(void)
{
    begin_with_a_third(1, 4, 1);
    steps(WATCHES + 50);
    says_nothing();
    is_called(QUALITY_GOOD);
}

static void alarms_may_leave_the_estimates_uncertain(void)
{
    all_settings.s.doubt = DOUBT_UNCERTAIN;
    begin_with_a_third(1, 4, 1);
    put(FURTHER, truth(8) + 4);
    steps(WATCHES);
    TEST_ASSERT_TRUE(raised(EVENT_PULL) && raised(EVENT_NIS) && raised(EVENT_APART));
    is_called(QUALITY_UNCERTAIN);
    put(FURTHER, truth(8));
    steps(8000);
    says_nothing();
    is_called(QUALITY_GOOD);
}

static void the_innovation_of_what_is_only_compared_counts_too(void)
{
    all_settings.s.nis = 4;
    begin();
    put(T_COMPARED, truth(7) + 5);
    steps(WATCHES);
    says(EVENT_NIS, T_COMPARED + 1);
}

static void a_draw_downwards_counts_as_one_upwards(void)
{
    begin();
    steps(WATCHES);
    block.s.pull = 5;
    block.watch.sensor[0].pull = -100;
    step();
    says(EVENT_PULL, T_LOW + 1);
}

/* ---- the monitor ---- */

static struct composition_block monitored(unsigned sensors)
{
    struct composition_block c = {.sensors = {.n = (uint8_t)sensors}, .watch = {.weight = 0.25f}};
    c.model.table.config.feed_stage = 5;
    for (unsigned k = 0; k < sensors; k++) {
        c.sensors.sensor[k].input = (uint8_t)(2 * k);
        c.sensors.sensor[k].moves = c.sensors.sensor[k].present = true;
        c.sensors.sensor[k].noise2 = 0.25f;
    }
    return c;
}

/* The plain mean of the first, then by weight. */
static void means_are_of_what_was_watched(void)
{
    struct composition_block c = monitored(1);
    struct composition_sensor *s = &c.sensors.sensor[0];
    const struct composition_means *w = &c.watch.sensor[0];
    static const float e[] = {1, 2, -3, 1, 5};
    float pull = 0, square = 0, product = 0;
    for (unsigned n = 0; n < 5; n++) {
        float weight = n < 3 ? 1.0f / (float)(n + 1) : 0.25f;
        s->e = e[n];
        s->correction = 0.001f * e[n];
        composition_watch_step(&c.watch, &c.sensors);
        pull += weight * (3.6f * e[n] - pull);
        square += weight * (4 * e[n] * e[n] - square);
        product += weight * (4 * e[n] * (n ? e[n - 1] : 0) - product);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, pull, w->pull);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, square, w->square);
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, product, w->product);
    }
    s->present = false;
    composition_watch_step(&c.watch, &c.sensors);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, square, w->square);
    TEST_ASSERT_EQUAL(6, c.watch.steps);
    c.watch.steps = UINT32_MAX;
    composition_watch_step(&c.watch, &c.sensors);
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, c.watch.steps);
}

static void the_reduced_filter_knows_what_innovation_to_expect(void)
{
    struct composition_block c = monitored(3);
    c.sensors.method = METHOD_REKF;
    for (unsigned k = 0; k < 3; k++) {
        c.sensors.sensor[k].e = 2;
        c.sensors.sensor[k].spread = 2;
    }
    c.sensors.sensor[1].moves = false;
    c.sensors.sensor[2].spread = 0;
    composition_watch_step(&c.watch, &c.sensors);
    TEST_ASSERT_EQUAL_FLOAT(2, c.watch.sensor[0].square);
    TEST_ASSERT_EQUAL_FLOAT(16, c.watch.sensor[1].square); /* noise alone */
    TEST_ASSERT_EQUAL_FLOAT(16, c.watch.sensor[2].square);
    c.sensors.method = METHOD_GEOMETRIC;
    composition_watch_step(&c.watch, &c.sensors);
    TEST_ASSERT_EQUAL_FLOAT(9, c.watch.sensor[0].square);
}

static unsigned odd_of(const float *pull, const unsigned *stage, unsigned n)
{
    struct composition_block c = monitored(n);
    for (unsigned k = 0; k < n; k++) {
        c.watch.sensor[k].pull = pull[k];
        c.sensors.sensor[k].stage = (uint8_t)(stage[k] - 1);
    }
    return whole_odd(&c, 10);
}

static void the_oddest_of_a_section_is_the_farthest_from_the_others(void)
{
    TEST_ASSERT_EQUAL(3, odd_of((float[]){0, 20, 1}, (unsigned[]){6, 7, 8}, 3));
    TEST_ASSERT_EQUAL(5, odd_of((float[]){1, 0, -20}, (unsigned[]){2, 5, 1}, 3));
    TEST_ASSERT_EQUAL(1, odd_of((float[]){30, 20, 19}, (unsigned[]){12, 8, 9}, 3));
    TEST_ASSERT_EQUAL(1, odd_of((float[]){10, 25, 26}, (unsigned[]){12, 8, 9}, 3));
    TEST_ASSERT_EQUAL(0, odd_of((float[]){0, 9.9f, 0}, (unsigned[]){6, 7, 8}, 3));
}

static void both_sections_may_draw_differently(void)
{
    TEST_ASSERT_EQUAL(0, odd_of((float[]){0, 0, 50, 50}, (unsigned[]){2, 5, 6, 8}, 4));
    TEST_ASSERT_EQUAL(0, odd_of((float[]){0, 50}, (unsigned[]){5, 6}, 2));
    TEST_ASSERT_EQUAL(0, odd_of((float[]){-50}, (unsigned[]){7}, 1));
    TEST_ASSERT_EQUAL(3, odd_of((float[]){0, 50, 0}, (unsigned[]){7, 6, 8}, 3));
    TEST_ASSERT_EQUAL(5, odd_of((float[]){0, 0, 50, 1}, (unsigned[]){7, 8, 5, 4}, 4));
}

static void what_moves_nothing_or_is_missing_is_not_odd(void)
{
    struct composition_block c = monitored(3);
    for (unsigned k = 0; k < 3; k++) {
        c.sensors.sensor[k].stage = (uint8_t)(6 + k);
        c.watch.sensor[k].pull = k == 1 ? 50 : 0;
    }
    TEST_ASSERT_EQUAL(3, whole_odd(&c, 10));
    c.sensors.sensor[1].moves = false;
    TEST_ASSERT_EQUAL(0, whole_odd(&c, 10));
    c.sensors.sensor[1].moves = true;
    c.sensors.sensor[1].present = false;
    TEST_ASSERT_EQUAL(0, whole_odd(&c, 10));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_is_uncertain_until_it_has_locked_on);
    RUN_TEST(the_slowest_temperature_says_when_it_has_locked_on);
    RUN_TEST(a_temperature_that_is_missing_is_lost);
    RUN_TEST(a_section_that_was_not_seen_for_a_while_is_uncertain_for_as_long_again);
    RUN_TEST(a_point_in_a_section_without_a_thermometer_is_never_good);
    RUN_TEST(a_point_of_the_feed_needs_a_thermometer_in_any_section);
    RUN_TEST(what_was_far_off_and_is_believed_leaves_nothing_good);
    RUN_TEST(without_heat_nothing_reaches_the_product);
    RUN_TEST(one_that_is_only_compared_is_not_missed);
    RUN_TEST(without_any_temperature_the_model_counts_for_a_while);
    RUN_TEST(a_flow_that_is_missing_is_told_with_its_input);
    RUN_TEST(without_a_solution_it_begins_anew_and_says_so);
    RUN_TEST(without_a_solution_in_its_first_tick_its_points_are_bad);
    RUN_TEST(how_often_it_began_anew_stops_counting_at_the_largest_number);
    RUN_TEST(a_temperature_that_draws_too_hard_is_told);
    RUN_TEST(innovations_that_are_too_large_are_told);
    RUN_TEST(temperatures_that_contradict_each_other_are_told);
    RUN_TEST(an_alarm_at_zero_is_none);
    RUN_TEST(what_agrees_raises_no_alarm);
    RUN_TEST(alarms_may_leave_the_estimates_uncertain);
    RUN_TEST(the_innovation_of_what_is_only_compared_counts_too);
    RUN_TEST(a_draw_downwards_counts_as_one_upwards);
    RUN_TEST(means_are_of_what_was_watched);
    RUN_TEST(the_reduced_filter_knows_what_innovation_to_expect);
    RUN_TEST(the_oddest_of_a_section_is_the_farthest_from_the_others);
    RUN_TEST(both_sections_may_draw_differently);
    RUN_TEST(what_moves_nothing_or_is_missing_is_not_odd);
    return UNITY_END();
}
