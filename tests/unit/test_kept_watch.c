/* commission/kept_watch.c and watching.c: the loops that a trial has kept, watched. The measurement does what is written here. */
#include "commission_outcome.h"

#include <math.h>

#include "commission/kept_watch.h"
#include "commission/kept_watch_state.h"
#include "commission/watching.h"

#define AT     85.0 /* degC, of a span of 100 */
#define LENGTH 4000u
#define LASTS  50u /* samples of a setpoint step */

static struct kept_watch *w;

static void loops(void)
{
    static const char *const pairs[] = {"loop1.action", "reverse", "loop1.gain", "0.0001",
                                        "loop1.ti",     "10000",   NULL};
    put_all(pairs);
}

static void sample(double value)
{
    reading(T1, value);
    validate();
    commission_tick(&c, &bench.s);
    supervisor_control(&bench.s);
    bench_events();
}

/* One kept loop, T1 by its output, in automatic at AT; the old settings are those in force. */
static void kept(void)
{
    struct adoption *a = &c.adoption;
    fitted();
    commission_lease(&c);
    w = &c.work->analysis.work.after.watch;
    c.status.phase = COMMISSION_KEPT;
    c.outputs.plan_serial = c.requests.trial_serial = bench.s.plan->serial;
    a->n = a->channels = 1;
    a->loop[0] = (struct adoption_loop){.loop = TOP, .duration_s = 100, .test_base = REAL_C(0.5)};
    a->channel[0] = (struct adoption_channel){
        .limit = REAL_C(0.1), .noise_sd = REAL_C(0.001), .line.rest = REAL_C(0.25)};
    out(TOP, 5);
    sample(AT);
    mode(TOP, LOOP_AUTO);
    setpoint(TOP, AT);
    sample(AT);
    commission_set_watch(&c, LENGTH);
    c.requests.ask = COMMISSION_ASK_WATCH;
    sample(AT);
    TEST_ASSERT_EQUAL_INT(COMMISSION_WATCHING, c.status.phase);
}

void setUp(void)
{
    bench_start_with(loops);
    bench.plan[bench.current].tick_s = 2;
    bench.tick_ms = 2000;
    cf = &bench.plan[bench.current].config;
    kept();
}
void tearDown(void) {}

static void samples(unsigned n, double value)
{
    for (unsigned k = 0; k < n && c.status.phase == COMMISSION_WATCHING; k++)
        sample(value);
}

/* height: of a sine about AT, degC; decay: ratio of each half cycle to the one before. */
static void swings(unsigned n, double height, double decay)
{
    for (unsigned k = 0; k < n && c.status.phase == COMMISSION_WATCHING; k++)
        sample(AT + height * pow(decay, k / 20.0) * sin(k * 3.14159265 / 20.0));
}

static void a_quiet_loop_is_watched_to_the_end_and_its_figures_are_said(void)
{
    samples(LASTS + 10, AT);
    for (unsigned k = 0; k < LENGTH; k++) {
        if (c.status.phase != COMMISSION_WATCHING)
            break;
        sample(AT + (k % 2 ? 0.2 : -0.2));
    }
    TEST_ASSERT_EQUAL_INT(COMMISSION_KEPT, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_NOT, c.status.reason);
    TEST_ASSERT_FALSE(c.requests.old_wanted);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.2, (double)said(EVENT_WATCH_LOOP)->value);
    TEST_ASSERT_EQUAL_STRING("top", said(EVENT_WATCH_LOOP)->subject);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, LENGTH * 2.0 / 3600.0, (double)said(EVENT_WATCH_ENDED)->value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.002, (double)kept_watch_sd(w, 0));
    TEST_ASSERT_TRUE(lease_holds(&c.lease));
}

static void an_error_past_the_limit_brings_the_old_settings_back(void)
{
    samples(LASTS + 10, AT);
    samples(5, AT + 9.9);
    TEST_ASSERT_EQUAL_INT(COMMISSION_WATCHING, c.status.phase);
    samples(5, AT + 10.6);
    TEST_ASSERT_EQUAL_INT(COMMISSION_RETURNED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_WATCH_LIMIT, c.status.reason);
    TEST_ASSERT_EQUAL_STRING("top", c.status.subject);
    TEST_ASSERT_TRUE(c.requests.old_wanted);
    TEST_ASSERT_EQUAL_INT(LOOP_MANUAL, bench.s.loop[TOP].mode);
    NEAR(0.5, D(bench.s.mv[0].manual));
    TEST_ASSERT_EQUAL_UINT8(REASON_WATCH_LIMIT, said(EVENT_WATCH_FAILED)->detail);
}

static void an_oscillation_that_lasts_is_a_sign_and_one_that_decays_or_is_small_is_not(void)
{
    samples(LASTS + 10, AT);
    swings(1000, 5.0, 0.6);
    TEST_ASSERT_EQUAL_INT(COMMISSION_WATCHING, c.status.phase);
    swings(1000, 0.4, 1.0); /* less than a twentieth of the limit */
    TEST_ASSERT_EQUAL_INT(COMMISSION_WATCHING, c.status.phase);
    swings(400, 3.0, 1.0);
    TEST_ASSERT_EQUAL_INT(COMMISSION_RETURNED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_WATCH_SWINGS, c.status.reason);
}

static void where_the_setpoint_has_gone_far_the_settings_stay(void)
{
    setpoint(TOP, AT + 15.0);
    samples(LASTS + 10, AT + 15.0);
    samples(5, AT + 26.0);
    TEST_ASSERT_EQUAL_INT(COMMISSION_KEPT, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_WATCH_LIMIT, c.status.reason);
    TEST_ASSERT_FALSE(c.requests.old_wanted);
    TEST_ASSERT_EQUAL_INT(LOOP_AUTO, bench.s.loop[TOP].mode);
    TEST_ASSERT_EQUAL_STRING("top", said(EVENT_WATCH_SIGN)->subject);
}

static void a_new_setpoint_is_no_sign_while_its_step_lasts(void)
{
    samples(LASTS + 10, AT);
    setpoint(TOP, AT + 15.0);
    samples(LASTS - 5, AT);
    TEST_ASSERT_EQUAL_INT(COMMISSION_WATCHING, c.status.phase);
    samples(10, AT);
    TEST_ASSERT_TRUE(c.status.phase != COMMISSION_WATCHING);
}

static void a_hand_ends_it_and_the_settings_stay(void)
{
    samples(LASTS + 10, AT);
    mode(TOP, LOOP_MANUAL);
    samples(2, AT);
    TEST_ASSERT_EQUAL_INT(COMMISSION_KEPT, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_HAND, c.status.reason);
    TEST_ASSERT_FALSE(c.requests.old_wanted);
    TEST_ASSERT_EQUAL_UINT8(REASON_HAND, said(EVENT_WATCH_ENDED)->detail);
}

static void other_settings_and_the_safe_state_and_an_abort_end_it(void)
{
    for (unsigned n = 0; n < 3; n++) {
        setUp();
        if (n == 0)
            c.outputs.plan_serial++;
        else if (n == 1)
            bench.s.safe_count++;
        else
            c.requests.ask = COMMISSION_ASK_ABORT;
        sample(AT);
        TEST_ASSERT_EQUAL_INT(COMMISSION_KEPT, c.status.phase);
        TEST_ASSERT_EQUAL_INT(n == 0   ? REASON_CONFIG
                              : n == 1 ? REASON_SAFE
                                       : REASON_ASKED,
                              c.status.reason);
        TEST_ASSERT_FALSE(c.requests.old_wanted);
    }
}

static void an_output_at_its_limit_for_twice_a_step_is_a_sign(void)
{
    samples(LASTS + 10, AT);
    cf->mv[0].max = 1.0f; /* below where it is */
    samples(2 * LASTS - 2, AT);
    TEST_ASSERT_EQUAL_INT(COMMISSION_WATCHING, c.status.phase);
    samples(8, AT);
    TEST_ASSERT_EQUAL_INT(REASON_WATCH_STUCK, c.status.reason);
}

static void a_lost_measurement_may_have_the_loop_in_manual_for_a_tenth_of_the_time(void)
{
    samples(LASTS + 10, AT);
    for (unsigned n = 0; n < LENGTH / 8 && c.status.phase == COMMISSION_WATCHING; n++) {
        bad_reading(T1, QUALITY_BAD, AT);
        validate();
        commission_tick(&c, &bench.s);
        supervisor_control(&bench.s);
        bench_events();
    }
    TEST_ASSERT_EQUAL_INT(REASON_WATCH_MANUAL, c.status.reason);
    TEST_ASSERT_TRUE(w->loop[0].manual > LENGTH / 10);
}

static void only_kept_loops_are_watched(void)
{
    const char *wanted = "";
    for (unsigned phase = 0; phase <= COMMISSION_WATCHING; phase++) {
        c.status.phase = (enum commission_phase)phase;
        TEST_ASSERT_EQUAL_INT(phase == COMMISSION_KEPT ? ERR_OK : ERR_STATE,
                              commission_may(&c, COMMISSION_ASK_WATCH, &wanted));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_quiet_loop_is_watched_to_the_end_and_its_figures_are_said);
    RUN_TEST(an_error_past_the_limit_brings_the_old_settings_back);
    RUN_TEST(an_oscillation_that_lasts_is_a_sign_and_one_that_decays_or_is_small_is_not);
    RUN_TEST(where_the_setpoint_has_gone_far_the_settings_stay);
    RUN_TEST(a_new_setpoint_is_no_sign_while_its_step_lasts);
    RUN_TEST(a_hand_ends_it_and_the_settings_stay);
    RUN_TEST(other_settings_and_the_safe_state_and_an_abort_end_it);
    RUN_TEST(an_output_at_its_limit_for_twice_a_step_is_a_sign);
    RUN_TEST(a_lost_measurement_may_have_the_loop_in_manual_for_a_tenth_of_the_time);
    RUN_TEST(only_kept_loops_are_watched);
    return UNITY_END();
}
