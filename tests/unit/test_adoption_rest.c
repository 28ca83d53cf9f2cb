/* commission/adoption.c: what a trial makes of the plant at rest, on either side of each bound: the line of a drift, whether it has
 * bent since, how far it carries the setpoints, and what of it is no fault of a loop. Ticks of 2 s; the measurements are what is
 * written here. */
#include <math.h>
#include <string.h>

#include "commission/adoption.h"
#include "commission/adoption_state.h"
#include "commission/origin_state.h"
#include "supervisor_bench.h"

#define WINDOW 48
#define AGE_S  (WINDOW - 1) /* from the middle of the window to its end: 23.5 ticks */

static struct adoption a;
static struct steady rest;
static struct origin operating;

#define NEAR(wanted, value) TEST_ASSERT_DOUBLE_WITHIN(2e-6, wanted, (double)(value))
#define RATE(wanted, value) TEST_ASSERT_DOUBLE_WITHIN(2e-8, wanted, (double)(value))

static void reads(unsigned k, double y)
{
    bench.s.measurement[k].value = N(y);
}

/* Two loops with steps of 0.05 in 200 s and -0.03 in 120 s, at the beginning of the first rest. */
void setUp(void)
{
    bench_start();
    bench.plan[bench.current].tick_s = 2;
    memset(&a, 0, sizeof a);
    operating = (struct origin){0};
    a.n = a.channels = 2;
    a.window = WINDOW;
    a.back = 50;
    for (uint8_t k = 0; k < 2; k++) {
        a.channel[k] = (struct adoption_channel){
            .measurement = k, .output = (uint8_t)(1 - k), .limit = REAL_C(0.2)};
        a.loop[k] = (struct adoption_loop){.loop = k,
                                           .step = k ? REAL_C(-0.03) : REAL_C(0.05),
                                           .duration_s = k ? 120 : 200,
                                           .size = REAL_C(0.05)};
        reads(k, 0.4);
    }
    adoption_hold(&a, &bench.s);
    TEST_ASSERT_EQUAL_INT(ERR_OK, adoption_begin(&a, &bench.s, &operating, &rest));
}
void tearDown(void) {}

/* So many ticks of a line from 0.4, by so much a second; output 1 stays. */
static enum adoption_result line(unsigned ticks, double slope)
{
    enum adoption_result r = ADOPTION_RUNNING;
    for (unsigned n = 1; r == ADOPTION_RUNNING && n <= ticks; n++) {
        reads(0, 0.4 + slope * 2.0 * n);
        r = adoption_tick(&a, &bench.s);
    }
    return r;
}

static void the_line_at_rest_counts_from_its_end_where_it_matters(void)
{
    /* In 200 s a twentieth of the smaller step: 0.0015. */
    for (int sign = -1; sign <= 1; sign += 2)
        for (unsigned drifts = 0; drifts < 2; drifts++) {
            double slope = sign * (drifts ? 7.6e-6 : 7.4e-6), end = 0.4 + slope * 2.0 * WINDOW;
            struct steady_result now;
            setUp();
            TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, line(WINDOW, slope));
            TEST_ASSERT_EQUAL_INT(ERR_OK, steady_look(&rest, 0, &now));
            const struct trial_line *c = &a.channel[0].line;
            TEST_ASSERT_EQUAL(drifts, c->drifts);
            TEST_ASSERT_EQUAL(drifts, a.drifting);
            RATE(slope, c->slope_per_s);
            NEAR(drifts ? end : end - slope * AGE_S, c->rest);
            TEST_ASSERT_EQUAL_FLOAT((float)now.mean_sd, (float)c->rest_sd);
            TEST_ASSERT_EQUAL_FLOAT((float)now.slope_sd_per_s, (float)c->slope_sd_per_s);
            TEST_ASSERT_TRUE(c->rest_sd > 0 && c->slope_sd_per_s > 0);
            TEST_ASSERT_FALSE(a.channel[1].line.drifts);
            /* It is the operating point, by its place in the tests. */
            TEST_ASSERT_TRUE(operating.fixed);
            TEST_ASSERT_EQUAL_FLOAT((float)c->rest, (float)operating.channel[1].level);
            TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)operating.since_s);
            TEST_ASSERT_EQUAL_UINT32(0, a.since);
            TEST_ASSERT_EQUAL_UINT8(1, a.stage);
            /* A quarter of the longest step to settle, or nothing where time matters; and three ticks. */
            TEST_ASSERT_EQUAL_UINT32(drifts ? 3 : 28, a.stage_ticks);
            TEST_ASSERT_FALSE(a.placed);
            for (unsigned k = 0; k < 2; k++)
                TEST_ASSERT_EQUAL_INT(LOOP_AUTO, bench.s.loop[k].mode);
        }
    setUp(); /* the end of it all, where the others are looked at, has its time */
    a.turn = 2;
    line(WINDOW, 1e-5);
    TEST_ASSERT_EQUAL_UINT32(28, a.stage_ticks);
}

static void a_bent_line_is_looked_at_three_times_more(void)
{
    unsigned n = 0;
    for (; a.stage == 0 && n < 1000; n++) {
        unsigned at = n % WINDOW;
        reads(0, 0.4 + 1e-5 * at * (WINDOW - at));
        TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, adoption_tick(&a, &bench.s));
        if (n + 1 == 2 * WINDOW - 1)
            TEST_ASSERT_EQUAL_UINT8(2, a.patience);
    }
    TEST_ASSERT_EQUAL_UINT(4 * WINDOW, n);
    TEST_ASSERT_EQUAL_UINT8(0, a.patience);
}

/* A step has come to something else than predicted; since then the plant was so long on its way from where it was. */
static void doubted(double was, double slope, uint32_t since)
{
    setUp();
    a.doubt = ADOPTION_SLOW;
    a.since = since;
    a.channel[0].line.rest = (real_t)was;
    a.channel[0].line.slope_per_s = (real_t)slope;
    a.channel[1].line.rest = REAL_C(0.4);
}

static void is_bent(bool bent)
{
    enum adoption_result r = line(WINDOW, 0);
    TEST_ASSERT_EQUAL_INT(bent ? ADOPTION_RUNNING : ADOPTION_SLOW, r);
    if (bent) {
        TEST_ASSERT_EQUAL_UINT8(1, a.repeats);
        TEST_ASSERT_TRUE(a.drifting);
        TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, a.doubt);
        TEST_ASSERT_EQUAL_UINT32(3, a.stage_ticks);
    } else {
        TEST_ASSERT_EQUAL_INT(ADOPTION_SLOW, a.result);
        TEST_ASSERT_EQUAL_UINT8(a.turn, a.culprit);
    }
}

/* A tenth of the step is 0.005. */
static void a_plant_that_is_not_where_its_line_led_is_to_blame(void)
{
    for (int sign = -1; sign <= 1; sign += 2)
        for (unsigned bent = 0; bent < 2; bent++) {
            doubted(0.4 + sign * (bent ? 0.0052 : 0.0048), 0, 0);
            is_bent(bent != 0);
            doubted(0.4 + sign * (bent ? 0.0092 : 0.0088), 0, 0);
            a.channel[0].line.rest_sd = REAL_C(0.001); /* four of those more */
            is_bent(bent != 0);
            /* 1000 s on, less the 47 to the middle of the window, by 2e-5 a second */
            doubted(0.4 - 953 * 2e-5 + sign * (bent ? 0.0053 : 0.0047), 2e-5, 452);
            is_bent(bent != 0);
            doubted(0.4 + sign * (bent ? 0.0091 : 0.0086), 0, 452);
            a.channel[0].line.slope_sd_per_s = REAL_C(1e-6); /* 0.000953, four times */
            is_bent(bent != 0);
            /* Steeper by so much in the 200 s of the step; it has gone for 49 s. */
            doubted(0.4 - sign * 49 * 2.5e-5, sign * (bent ? 2.6e-5 : 2.4e-5), 0);
            is_bent(bent != 0);
            doubted(0.4 - sign * 49 * 6.5e-5, sign * (bent ? 6.6e-5 : 6.4e-5), 0);
            a.channel[0].line.slope_sd_per_s = REAL_C(1e-5); /* 0.002, four times */
            is_bent(bent != 0);
        }
}

static void so_often_it_is_believed(void)
{
    for (uint8_t repeats = 1; repeats <= 2; repeats++) {
        doubted(0.5, 0, 0);
        a.repeats = repeats;
        TEST_ASSERT_EQUAL_INT(repeats < 2 ? ADOPTION_RUNNING : ADOPTION_SLOW, line(WINDOW, 0));
        TEST_ASSERT_EQUAL_UINT8(2, a.repeats);
    }
}

static void half_of_the_limit_may_be_left(void)
{
    for (unsigned k = 0; k < 2; k++)
        for (unsigned more = 0; more < 2; more++) {
            setUp();
            operating.fixed = true;
            operating.channel[0].level = operating.channel[1].level = REAL_C(0.4);
            operating.channel[1 - k].left = more ? REAL_C(0.101) : REAL_C(0.099);
            TEST_ASSERT_EQUAL_INT(more ? ADOPTION_LEFT : ADOPTION_RUNNING, line(WINDOW, 0));
            TEST_ASSERT_EQUAL_UINT8(more ? k : 0, a.culprit);
        }
}

static void setpoints_go_with_a_drift_as_far_as_half_of_the_limit(void)
{
    static const struct {
        double slope;
        uint32_t since; /* ticks before this one */
        bool drifts;
        double carried;
    } cases[] = {{1e-4, 99, true, 0.02},    {-1e-4, 99, true, -0.02}, {1e-4, 99, false, 0.0},
                 {1e-4, 489, true, 0.098},  {1e-4, 599, true, 0.1},   {-1e-4, 599, true, -0.1},
                 {-1e-4, 489, true, -0.098}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        setUp();
        line(WINDOW, 0);
        a.since = cases[n].since;
        a.stage_ticks = 100;
        a.channel[0].line.slope_per_s = (real_t)cases[n].slope;
        a.channel[0].line.drifts = cases[n].drifts;
        TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, adoption_tick(&a, &bench.s));
        TEST_ASSERT_TRUE(a.placed);
        NEAR(0.4 + cases[n].carried, a.asked[0]);
        NEAR(0.4, a.asked[1]);
    }
}

/* At the end of a step that went past its setpoint by so much of it. */
static void overshoots(bool too_far, double peak, bool drifts)
{
    setUp();
    line(WINDOW, 0);
    a.stage = 2;
    a.stage_ticks = 100;
    a.ticks = 99;
    a.placed = false;
    a.asked[0] = REAL_C(0.4);
    a.loop[0].peak = (real_t)peak;
    a.loop[0].predicted.peak = REAL_C(0.1);
    a.loop[0].predicted.iae = 2;
    a.channel[0].line.drifts = drifts;
    a.channel[0].line.slope_per_s = REAL_C(-3e-5);
    a.channel[0].line.slope_sd_per_s = REAL_C(1e-5);
    TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, adoption_tick(&a, &bench.s));
    TEST_ASSERT_EQUAL_INT(too_far ? ADOPTION_OVERSHOOT : ADOPTION_RUNNING, a.doubt);
}

/* 0.35 and what was predicted; and twice the integral that was predicted for a step of one, 40 s, times what the line may not
 * have foreseen: twice its deviation, and all of it where it is no drift. */
static void what_a_loop_lags_behind_a_drift_is_no_fault_of_it(void)
{
    double drift = 2.0 * 40.0 * 2e-5 / 0.05, none = 2.0 * 40.0 * 5e-5 / 0.05;
    overshoots(false, 0.45 + drift - 0.001, true);
    overshoots(true, 0.45 + drift + 0.001, true);
    overshoots(false, 0.45 + none - 0.001, false);
    overshoots(true, 0.45 + none + 0.001, false);
}

static void steps_are_counted_in_ticks(void)
{
    setUp();
    line(WINDOW, 0);
    a.ticks = a.stage_ticks - 1;
    TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, adoption_tick(&a, &bench.s));
    TEST_ASSERT_EQUAL_UINT8(2, a.stage);
    TEST_ASSERT_EQUAL_UINT32(100, a.stage_ticks); /* 200 s */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_line_at_rest_counts_from_its_end_where_it_matters);
    RUN_TEST(a_bent_line_is_looked_at_three_times_more);
    RUN_TEST(a_plant_that_is_not_where_its_line_led_is_to_blame);
    RUN_TEST(so_often_it_is_believed);
    RUN_TEST(half_of_the_limit_may_be_left);
    RUN_TEST(setpoints_go_with_a_drift_as_far_as_half_of_the_limit);
    RUN_TEST(what_a_loop_lags_behind_a_drift_is_no_fault_of_it);
    RUN_TEST(steps_are_counted_in_ticks);
    return UNITY_END();
}
