/* Alarms: when they come and go, who has seen them, and which was first. */
#include "supervise/alarms.h"

#include "exchange/alarm_names.h"
#include "plan/plan_build.h"
#include "supervisor_bench.h"

static void with_alarms(void)
{
    put_all((const char *const[]){"alarm1.on",
                                  "T10",
                                  "alarm1.side",
                                  "hi_hi",
                                  "alarm1.limit",
                                  "130",
                                  "alarm1.hysteresis",
                                  "2",
                                  "alarm1.group",
                                  "a",
                                  "alarm2.on",
                                  "T10",
                                  "alarm2.side",
                                  "hi",
                                  "alarm2.limit",
                                  "120",
                                  "alarm2.hysteresis",
                                  "2",
                                  "alarm2.group",
                                  "a",
                                  "alarm3.on",
                                  "T1",
                                  "alarm3.side",
                                  "lo",
                                  "alarm3.limit",
                                  "80",
                                  "alarm3.hysteresis",
                                  "1",
                                  "alarm3.delay",
                                  "5",
                                  "alarm3.latch",
                                  "on",
                                  "alarm3.group",
                                  "a",
                                  "alarm4.on",
                                  "bottom",
                                  "alarm4.side",
                                  "deviation",
                                  "alarm4.limit",
                                  "3",
                                  NULL});
}

void setUp(void)
{
    bench_start_with(with_alarms);
}
void tearDown(void) {}

static void ask(enum request_kind kind, uint8_t alarm, double seconds)
{
    struct request r = {.kind = kind,
                        .loop = PLAN_NONE,
                        .output = alarm,
                        .plan = bench.s.plan->serial,
                        .value = (float)seconds};
    supervisor_request(&bench.s, &r);
    bench_events();
}

static void an_alarm_comes_at_its_limit_and_goes_inside_its_hysteresis(void)
{
    reading(T10, 120.5);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ON, "T10.hi"));
    reading(T10, 118.5);
    ticks(3);
    TEST_ASSERT_EQUAL(0, happened(EVENT_ALARM_OFF, NULL));
    reading(T10, 117.9);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_OFF, "T10.hi"));
    TEST_ASSERT_FALSE(bench.s.alarm[1].listed);
}

static void inside_its_hysteresis_it_does_not_come(void)
{
    static const double quiet[] = {118.5, 119.5, 120,
                                   118.5}; /* 120 is the limit, and not beyond it */
    for (unsigned k = 0; k < 4; k++) {
        reading(T10, quiet[k]);
        reading(T1, 80.5); /* the other side: 80 is the limit, 81 where it would go */
        ticks(10);
        TEST_ASSERT_EQUAL(0, happened(EVENT_ALARM_ON, NULL));
    }
    reading(T10, 120.01);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ON, "T10.hi"));
}

static void the_hysteresis_does_not_count_while_it_waits_for_its_delay(void)
{
    reading(T1, 79);
    ticks(3);
    reading(T1, 80.5);
    tick();
    reading(T1, 79);
    ticks(5);
    TEST_ASSERT_EQUAL(0, happened(EVENT_ALARM_ON, NULL)); /* it began anew */
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ON, "T1.lo"));
    reading(T1, 80.9);
    ticks(10);
    TEST_ASSERT_EQUAL(0, happened(EVENT_ALARM_OFF, NULL));
    reading(T1, 81.1);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_OFF, "T1.lo"));
}

static void it_waits_for_its_delay_which_begins_anew_after_an_interruption(void)
{
    for (unsigned n = 0; n < 30; n++) {
        reading(T1, n % 5 == 4 ? 85 : 79);
        tick();
    }
    TEST_ASSERT_EQUAL(0, happened(EVENT_ALARM_ON, NULL));
    reading(T1, 79);
    ticks(5);
    TEST_ASSERT_EQUAL(0, happened(EVENT_ALARM_ON, NULL));
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ON, "T1.lo"));
}

static void a_latched_one_stays_on_the_list_until_it_is_acknowledged(void)
{
    reading(T1, 79);
    ticks(7);
    reading(T1, 85);
    ticks(3);
    TEST_ASSERT_TRUE(bench.s.alarm[2].listed);
    TEST_ASSERT_FALSE(bench.s.alarm[2].condition);
    ask(REQUEST_ACK, 2, 0);
    TEST_ASSERT_FALSE(bench.s.alarm[2].listed);
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ACK, "T1.lo"));
    for (unsigned i = 0; i < bench.n_seen; i++)
        if (bench.seen[i].code == EVENT_ALARM_ACK)
            TEST_ASSERT_EQUAL_FLOAT(0.0f, bench.seen[i].value);
}

static void an_acknowledged_one_stays_while_its_condition_holds(void)
{
    reading(T1, 79);
    ticks(7);
    ask(REQUEST_ACK, 2, 0);
    ask(REQUEST_ACK, 2, 0);
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ACK, NULL));
    TEST_ASSERT_TRUE(bench.s.alarm[2].listed);
    reading(T1, 85);
    tick();
    TEST_ASSERT_FALSE(bench.s.alarm[2].listed);
    reading(T1, 79);
    ticks(6);
    TEST_ASSERT_FALSE(bench.s.alarm[2].acknowledged); /* it is news again */
}

static void all_are_acknowledged_at_once(void)
{
    reading(T1, 79);
    reading(T10, 131);
    ticks(7);
    ask(REQUEST_ACK, PLAN_NONE, 0);
    TEST_ASSERT_EQUAL(3, happened(EVENT_ALARM_ACK, NULL));
}

static void the_first_of_a_group_is_marked_until_the_whole_group_is_quiet(void)
{
    reading(T10, 121);
    tick();
    reading(T10, 131);
    reading(T1, 79);
    ticks(8);
    TEST_ASSERT_FALSE(bench.s.alarm[0].first);
    TEST_ASSERT_TRUE(bench.s.alarm[1].first);
    TEST_ASSERT_FALSE(bench.s.alarm[2].first);
    reading(T10, 115); /* it is over, but T1 is still low */
    ticks(3);
    TEST_ASSERT_FALSE(bench.s.alarm[1].listed);
    TEST_ASSERT_TRUE(bench.s.alarm[1].first);
    reading(T1, 85);
    ask(REQUEST_ACK, PLAN_NONE, 0);
    ticks(2);
    TEST_ASSERT_FALSE(bench.s.alarm[1].first);
    reading(T10, 131); /* in one tick: the first of the table */
    tick();
    TEST_ASSERT_TRUE(bench.s.alarm[0].first);
    TEST_ASSERT_FALSE(bench.s.alarm[1].first);
}

static void deviation_counts_only_while_the_loop_acts(void)
{
    mode(BOTTOM, LOOP_AUTO);
    tick();
    setpoint(BOTTOM, 118.5);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ON, "bottom.dev"));
    mode(BOTTOM, LOOP_MANUAL);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_OFF, "bottom.dev"));
}

static void a_shelved_one_is_silent_for_its_time_and_then_comes_anew(void)
{
    reading(T10, 121);
    tick();
    ask(REQUEST_SHELVE, 1, 60);
    TEST_ASSERT_FALSE(bench.s.alarm[1].listed);
    bench_forget_events();
    for (unsigned n = 0; n < 59; n++) {
        reading(T10, n % 2 ? 121 : 115);
        tick();
    }
    TEST_ASSERT_EQUAL(0, bench.n_seen);
    reading(T10, 121);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_SHELVED, "T10.hi"));
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ON, "T10.hi"));
}

static void a_shelf_ends_when_that_is_asked_or_plant_time_is_set_back(void)
{
    ask(REQUEST_SHELVE, 1, 1000);
    ask(REQUEST_SHELVE, 1, 0);
    reading(T10, 121);
    tick();
    TEST_ASSERT_TRUE(bench.s.alarm[1].listed);
    ask(REQUEST_SHELVE, 1, 1000);
    bench.input.time_ms = 0;
    ticks(2);
    TEST_ASSERT_TRUE(bench.s.alarm[1].listed);
}

static void a_measurement_that_is_not_believed_changes_nothing(void)
{
    bad_reading(T10, QUALITY_BAD, 140);
    ticks(30);
    TEST_ASSERT_EQUAL(0, happened(EVENT_ALARM_ON, NULL));
    reading(T10, 121);
    tick();
    bad_reading(T10, QUALITY_BAD, 90);
    ticks(30);
    TEST_ASSERT_TRUE(bench.s.alarm[1].listed);
}

static void its_delay_stands_still_while_the_measurement_is_not_valid(void)
{
    reading(T1, 79);
    ticks(2);
    bad_reading(T1, QUALITY_BAD, 79);
    ticks(100);
    reading(T1, 79);
    ticks(3);
    TEST_ASSERT_EQUAL(0, happened(EVENT_ALARM_ON, "T1.lo"));
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ON, "T1.lo"));
}

static void deviation_ends_with_the_loop_that_has_lost_its_measurement(void)
{
    mode(BOTTOM, LOOP_AUTO);
    tick();
    setpoint(BOTTOM, 118.5);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ON, "bottom.dev"));
    bad_reading(T10, QUALITY_BAD, 115);
    ticks(100);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_OFF, "bottom.dev"));
}

/* 125 degC where the heat is 1 kW, 100 where it is 0. */
static void a_value_made_up_for_a_lost_one_neither_brings_it_nor_ends_it(void)
{
    put("meas2.infer", "heat");
    put("meas2.infer_offset", "100");
    set_and_apply("meas2.infer_gain", "25");
    bad_reading(T10, QUALITY_BAD, 0);
    ticks(3);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 125, span_to_eu(bench.s.measurement[T10].value, 60, 160));
    ticks(10);
    TEST_ASSERT_EQUAL(0, happened(EVENT_ALARM_ON, NULL));
    reading(T10, 121);
    ticks(2);
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_ON, "T10.hi"));
    bad_reading(T10, QUALITY_BAD, 0);
    out(BOTTOM, 0);
    ticks(10);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 100, span_to_eu(bench.s.measurement[T10].value, 60, 160));
    TEST_ASSERT_EQUAL(0, happened(EVENT_ALARM_OFF, NULL));
    reading(T10, 117.9);
    tick();
    TEST_ASSERT_EQUAL(1, happened(EVENT_ALARM_OFF, "T10.hi"));
}

static void what_is_asked_of_an_alarm_that_is_not_there_is_refused(void)
{
    ask(REQUEST_ACK, CONFIG_ALARMS - 1, 0);
    ask(REQUEST_SHELVE, CONFIG_ALARMS, 10);
    TEST_ASSERT_EQUAL(2, happened(EVENT_REQUEST_REFUSED, "alarm"));
}

static void names_are_found_and_long_ones_cut(void)
{
    char name[CHANNEL_NAME_SIZE];
    TEST_ASSERT_EQUAL(0, alarm_find(&bench.config, "T10.hi_hi"));
    TEST_ASSERT_EQUAL(1, alarm_find(&bench.config, "alarm2"));
    TEST_ASSERT_EQUAL(3, alarm_find(&bench.config, "bottom.dev"));
    TEST_ASSERT_EQUAL(PLAN_NONE, alarm_find(&bench.config, "alarm5"));
    TEST_ASSERT_EQUAL(PLAN_NONE, alarm_find(&bench.config, "alarm9"));
    TEST_ASSERT_EQUAL(PLAN_NONE, alarm_find(&bench.config, "T1.hi"));
    memcpy(bench.config.alarm[0].on, "abcdefghijklmno", 16);
    alarm_name(&bench.config, 0, name);
    TEST_ASSERT_EQUAL_STRING("abcdefghi.hi_hi", name);
}

static void a_plan_with_an_alarm_on_nothing_is_refused(void)
{
    struct config_fault fault;
    put("alarm1.on", "nobody");
    TEST_ASSERT_EQUAL(ERR_UNKNOWN,
                      plan_build(&bench.plan[1 - bench.current], &bench.config, 1, &fault));
    TEST_ASSERT_EQUAL_STRING("alarm", fault.group);
    put("alarm1.on", "T10");
    put("alarm4.on", "T10"); /* a measurement has no setpoint */
    TEST_ASSERT_EQUAL(ERR_UNKNOWN,
                      plan_build(&bench.plan[1 - bench.current], &bench.config, 1, &fault));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_alarm_comes_at_its_limit_and_goes_inside_its_hysteresis);
    RUN_TEST(inside_its_hysteresis_it_does_not_come);
    RUN_TEST(the_hysteresis_does_not_count_while_it_waits_for_its_delay);
    RUN_TEST(it_waits_for_its_delay_which_begins_anew_after_an_interruption);
    RUN_TEST(a_latched_one_stays_on_the_list_until_it_is_acknowledged);
    RUN_TEST(an_acknowledged_one_stays_while_its_condition_holds);
    RUN_TEST(all_are_acknowledged_at_once);
    RUN_TEST(the_first_of_a_group_is_marked_until_the_whole_group_is_quiet);
    RUN_TEST(deviation_counts_only_while_the_loop_acts);
    RUN_TEST(a_shelved_one_is_silent_for_its_time_and_then_comes_anew);
    RUN_TEST(a_shelf_ends_when_that_is_asked_or_plant_time_is_set_back);
    RUN_TEST(a_measurement_that_is_not_believed_changes_nothing);
    RUN_TEST(its_delay_stands_still_while_the_measurement_is_not_valid);
    RUN_TEST(deviation_ends_with_the_loop_that_has_lost_its_measurement);
    RUN_TEST(a_value_made_up_for_a_lost_one_neither_brings_it_nor_ends_it);
    RUN_TEST(what_is_asked_of_an_alarm_that_is_not_there_is_refused);
    RUN_TEST(names_are_found_and_long_ones_cut);
    RUN_TEST(a_plan_with_an_alarm_on_nothing_is_refused);
    return UNITY_END();
}
