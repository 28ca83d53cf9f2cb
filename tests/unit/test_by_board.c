/* Loops that the board has put into manual: their alarm stays until somebody sets their mode. */
#include "supervise/by_board.h"

#include "supervise/restart.h"
#include "supervisor_bench.h"

void setUp(void)
{
    bench_start();
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    tick();
    bench_forget_events();
}
void tearDown(void) {}

static uint8_t cause(uint8_t loop)
{
    return bench.s.by_board.cause[loop];
}

/* The measurement of bottom is bad for longer than its hold of 10 s, then good again. */
static void lose_and_find_t10(void)
{
    bad_reading(T10, QUALITY_BAD, 115);
    ticks(15);
    reading(T10, 115);
    ticks(5);
}

static void it_outlives_the_fault_that_took_the_loop(void)
{
    lose_and_find_t10();
    TEST_ASSERT_EQUAL(1, happened(EVENT_MEASUREMENT_GOOD, "T10"));
    TEST_ASSERT_EQUAL(1, happened(EVENT_MANUAL_BY_BOARD, "bottom"));
    TEST_ASSERT_EQUAL(BY_BOARD_BAD, cause(BOTTOM));
    TEST_ASSERT_EQUAL(BY_BOARD_NOT, cause(TOP)); /* its measurement was good */
    ticks(500);
    TEST_ASSERT_EQUAL(BY_BOARD_BAD, cause(BOTTOM));
    TEST_ASSERT_EQUAL(1, happened(EVENT_MANUAL_BY_BOARD, NULL)); /* once */
}

static void the_event_says_why_and_the_state_since_when(void)
{
    bad_reading(T10, QUALITY_BAD, 115);
    while (bench.s.loop[BOTTOM].mode != LOOP_MANUAL)
        tick();
    TEST_ASSERT_EQUAL(bench.s.time_ms / 1000, bench.s.by_board.since_s[BOTTOM]);
    for (unsigned i = 0; i < bench.n_seen; i++)
        if (bench.seen[i].code == EVENT_MANUAL_BY_BOARD)
            TEST_ASSERT_EQUAL(BY_BOARD_BAD, bench.seen[i].detail);
    uint32_t since_s = bench.s.by_board.since_s[BOTTOM];
    ticks(20);
    TEST_ASSERT_EQUAL(since_s, bench.s.by_board.since_s[BOTTOM]);
}

static void setting_the_mode_ends_it_also_to_manual(void)
{
    lose_and_find_t10();
    mode(BOTTOM, LOOP_MANUAL);
    TEST_ASSERT_EQUAL(BY_BOARD_NOT, cause(BOTTOM));
    TEST_ASSERT_EQUAL(1, happened(EVENT_MANUAL_BY_BOARD_OVER, "bottom"));
    mode(BOTTOM, LOOP_AUTO);
    lose_and_find_t10();
    TEST_ASSERT_EQUAL(BY_BOARD_BAD, cause(BOTTOM));
    mode(BOTTOM, LOOP_AUTO);
    TEST_ASSERT_EQUAL(BY_BOARD_NOT, cause(BOTTOM));
    TEST_ASSERT_EQUAL(2, happened(EVENT_MANUAL_BY_BOARD_OVER, "bottom"));
    mode(BOTTOM, LOOP_MANUAL); /* by a person: no alarm */
    TEST_ASSERT_EQUAL(BY_BOARD_NOT, cause(BOTTOM));
    TEST_ASSERT_EQUAL(2, happened(EVENT_MANUAL_BY_BOARD, NULL));
}

static void a_mode_that_is_refused_and_an_output_do_not_end_it(void)
{
    bad_reading(T10, QUALITY_BAD, 115);
    ticks(15);
    mode(BOTTOM, LOOP_AUTO);
    TEST_ASSERT_EQUAL(1, happened(EVENT_MODE_REFUSED, "bottom"));
    out(BOTTOM, 0.5);
    TEST_ASSERT_EQUAL(BY_BOARD_BAD, cause(BOTTOM));
}

static void the_safe_state_takes_loops_that_act_and_keeps_earlier_causes(void)
{
    lose_and_find_t10();
    supervisor_go_safe(&bench.s, "link");
    TEST_ASSERT_EQUAL(BY_BOARD_SAFE, cause(TOP));
    TEST_ASSERT_EQUAL(BY_BOARD_BAD, cause(BOTTOM));
    supervisor_go_safe(&bench.s, "link");
    TEST_ASSERT_EQUAL(1, happened(EVENT_MANUAL_BY_BOARD, "top"));
    tick();
    mode(TOP, LOOP_AUTO); /* it ends the safe state of all, but not the alarm of bottom */
    TEST_ASSERT_EQUAL(BY_BOARD_NOT, cause(TOP));
    TEST_ASSERT_EQUAL(BY_BOARD_BAD, cause(BOTTOM));
}

static void a_channel_that_the_plant_lacks_takes_the_loop(void)
{
    bench.s.mv[HEAT].bound = false;
    tick();
    TEST_ASSERT_EQUAL(BY_BOARD_UNBOUND, cause(BOTTOM));
}

static void settings_that_make_it_another_loop_take_it(void)
{
    set_and_apply("meas2.hi", "170");
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[BOTTOM].mode);
    TEST_ASSERT_EQUAL(BY_BOARD_PLAN, cause(BOTTOM));
    set_and_apply("meas2.hi", "160"); /* it stays in manual, and says so still */
    TEST_ASSERT_EQUAL(BY_BOARD_PLAN, cause(BOTTOM));
    set_and_apply("loop1.gain", "1");
    TEST_ASSERT_EQUAL(BY_BOARD_PLAN, cause(BOTTOM));
    set_and_apply("loop2.name", "lower");
    TEST_ASSERT_EQUAL(BY_BOARD_NOT, cause(BOTTOM));
    TEST_ASSERT_EQUAL(BY_BOARD_NOT, cause(TOP)); /* no setting of its own has changed */
    put("loop2.name", "-");
    put("loop2.pv", "-");
    set_and_apply("loop2.out", "-");
    TEST_ASSERT_EQUAL(BY_BOARD_NOT, cause(BOTTOM));
}

/* Keeps the record of this moment, and starts anew with it. policy: restart.policy. */
static void restart(const char *policy)
{
    static struct restart_record record;
    struct restart r;
    restart_init(&r, &record, false);
    restart_keep(&r, &bench.s);
    uint64_t time_ms = bench.input.time_ms;
    supervisor_init(&bench.s, &bench.events);
    put("restart.policy", policy);
    apply();
    bench_forget_events();
    bench.input.time_ms = time_ms;
    restart_init(&r, &record, true);
    for (unsigned k = 0; k < 3; k++) {
        validate();
        restart_try(&r, &bench.s);
        supervisor_control(&bench.s);
        restart_keep(&r, &bench.s);
    }
    bench_events();
}

static void it_survives_a_restart_that_brings_modes_back(void)
{
    set_and_apply("restart.policy", "resume");
    lose_and_find_t10();
    restart("resume");
    TEST_ASSERT_EQUAL(1, happened(EVENT_RESTART_DONE, NULL));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL(BY_BOARD_NOT, cause(TOP));
    TEST_ASSERT_EQUAL(BY_BOARD_BAD, cause(BOTTOM));
    TEST_ASSERT_EQUAL(BY_BOARD_EARLIER, bench.s.by_board.since_s[BOTTOM]);
    restart("resume"); /* and the next one */
    TEST_ASSERT_EQUAL(BY_BOARD_BAD, cause(BOTTOM));
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
}

static void a_restart_that_brings_back_outputs_alone_takes_the_loops_that_acted(void)
{
    set_and_apply("restart.policy", "hold");
    mode(BOTTOM, LOOP_MANUAL);
    tick();
    restart("hold");
    TEST_ASSERT_EQUAL(1, happened(EVENT_RESTART_DONE, NULL));
    TEST_ASSERT_EQUAL(BY_BOARD_RESTART, cause(TOP));
    TEST_ASSERT_EQUAL(BY_BOARD_NOT, cause(BOTTOM)); /* a person had it in manual */
}

/* The latch of an interlock is kept as the interlock is. */
static void a_latched_interlock_survives_a_restart_too(void)
{
    put_all((const char *const[]){"lock1.meas", "T10", "lock1.mv", "heat", "lock1.limit", "140",
                                  "lock1.latch", "on", "restart.policy", "resume", NULL});
    apply();
    reading(T10, 150);
    ticks(2);
    reading(T10, 115);
    ticks(2);
    restart("resume");
    ticks(20);
    TEST_ASSERT_TRUE(bench.s.interlock[0].active);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, sent(HEAT));
    request(REQUEST_RELEASE, PLAN_NONE, 0, 0, 0);
    ticks(2);
    TEST_ASSERT_FALSE(bench.s.interlock[0].active);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_outlives_the_fault_that_took_the_loop);
    RUN_TEST(the_event_says_why_and_the_state_since_when);
    RUN_TEST(setting_the_mode_ends_it_also_to_manual);
    RUN_TEST(a_mode_that_is_refused_and_an_output_do_not_end_it);
    RUN_TEST(the_safe_state_takes_loops_that_act_and_keeps_earlier_causes);
    RUN_TEST(a_channel_that_the_plant_lacks_takes_the_loop);
    RUN_TEST(settings_that_make_it_another_loop_take_it);
    RUN_TEST(it_survives_a_restart_that_brings_modes_back);
    RUN_TEST(a_restart_that_brings_back_outputs_alone_takes_the_loops_that_acted);
    RUN_TEST(a_latched_interlock_survives_a_restart_too);
    return UNITY_END();
}
