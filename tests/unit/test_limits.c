/* commission/limits.[ch]: every bound on a step under way, just inside of it and just outside, on experiments that are made
 * up number by number. */
#include <math.h>
#include <string.h>

#include "commission/experiment_state.h"
#include "commission/limits.h"
#include "commission/origin_state.h"
#include "unity.h"

#define LIMIT 0.25

static struct experiment e;
static struct origin origin;
static real_t y[3];

void setUp(void)
{
    memset(&e, 0, sizeof e);
    memset(&origin, 0, sizeof origin);
    e.config.outputs = 2;
    e.config.h_s = 2;
    e.phase = EXPERIMENT_UP;
    e.amplitude = REAL_C(0.125);
    e.samples = 16;
    e.record.block = 2;
    for (unsigned j = 0; j < 2; j++) {
        e.config.limit[j] = (real_t)LIMIT;
        e.before[j].noise_sd = REAL_C(1.0) / 256;
        e.rest[j] = y[j] = REAL_C(0.5);
    }
    e.config.limit[2] = REAL_C(0.01); /* of no output: it is past everything */
    e.last[2] = y[2] = 9;
    e.at_turn[2] = -1;
    origin.channel[2].left = 1;
}
void tearDown(void) {}

/* So far from its rest. */
static void is(unsigned j, double away)
{
    y[j] = (real_t)(0.5 + away);
}

static void with_origin(void)
{
    origin.channel[2].left = 1;
    e.config.origin = &origin;
    origin.fixed = true;
    for (unsigned j = 0; j < 2; j++) {
        origin.channel[j].level = REAL_C(0.5);
        origin.channel[j].slope_most = 1;
    }
}

#define NEAR(wanted, value) TEST_ASSERT_DOUBLE_WITHIN(1e-6, wanted, (double)(value))

static void what_is_left_comes_off_the_room_on_either_side(void)
{
    NEAR(0.25, limits_room(&e, 1));
    with_origin();
    for (int sign = -1; sign <= 1; sign += 2) {
        origin.channel[1].left = (real_t)(sign * 0.0625);
        NEAR(0.1875, limits_room(&e, 1));
        origin.channel[1].left = (real_t)(sign * 0.3);
        NEAR(0.0, limits_room(&e, 1));
    }
    NEAR(0.25, limits_room(&e, 0));
}

static void a_drift_counts_where_it_explains_what_is_seen_and_no_farther_than_the_limit(void)
{
    is(1, 0.0625);
    NEAR(0.0625, limits_away(&e, 1, y));
    e.drift_per_s[1] = REAL_C(1.0) / 1024; /* 1/32 in 16 samples of 2 s */
    NEAR(0.03125, limits_away(&e, 1, y));
    is(1, -0.0625);
    NEAR(-0.0625, limits_away(&e, 1, y));
    e.samples = 100000;
    is(1, 0.5);
    NEAR(0.25, limits_away(&e, 1, y));
    e.samples = 16;
    is(1, 0.0625);
    with_origin();
    origin.channel[1].slope_most = REAL_C(1.0) / 4096;
    NEAR(0.0625 - 0.0078125, limits_away(&e, 1, y));
}

static void half_of_a_limit_may_be_left_before_another_test(void)
{
    TEST_ASSERT_EQUAL_INT(-1, limits_spent(&e));
    with_origin();
    origin.channel[1].left = REAL_C(0.125);
    TEST_ASSERT_EQUAL_INT(-1, limits_spent(&e));
    origin.channel[1].left = REAL_C(0.126);
    TEST_ASSERT_EQUAL_INT(1, limits_spent(&e));
    origin.channel[0].left = REAL_C(-0.127);
    TEST_ASSERT_EQUAL_INT(0, limits_spent(&e)); /* the one that is farther */
    origin.channel[1].left = REAL_C(-0.13);
    TEST_ASSERT_EQUAL_INT(1, limits_spent(&e));
    e.config.limit[1] = REAL_C(0.5);
    TEST_ASSERT_EQUAL_INT(0, limits_spent(&e));
}

static void the_line_guard_begins_at_rest_and_goes_on_from_where_the_output_is(void)
{
    e.config.blank_s = 7;
    e.config.dead_time_s[1] = 9;
    is(1, 0.0625);
    e.samples = 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, limits_arm(&e, y));
    const struct guard_config *g = &e.limits.guard.config;
    TEST_ASSERT_EQUAL_UINT32(2, g->outputs);
    NEAR(2.0, g->h_s);
    NEAR(7.0, g->blanking_s);
    NEAR(0.05, g->noise_share);
    NEAR(0.5, g->output[1].initial);
    NEAR(0.25, g->output[1].limit);
    NEAR(1.0 / 256, g->output[1].noise_sd);
    NEAR(9.0, g->output[1].dead_time_s);
    NEAR(0.0, g->output[2].limit);
    e.samples = 1;
    TEST_ASSERT_EQUAL_INT(ERR_OK, limits_arm(&e, y));
    NEAR(0.5625, g->output[1].initial);
    NEAR(0.1875, g->output[1].limit);
    is(1, -0.2245); /* a tenth of the limit is left at least */
    TEST_ASSERT_EQUAL_INT(ERR_OK, limits_arm(&e, y));
    NEAR(0.2755, g->output[1].initial);
    NEAR(0.0255, g->output[1].limit);
    is(1, -0.2255);
    TEST_ASSERT_EQUAL_INT(ERR_OK, limits_arm(&e, y));
    NEAR(0.025, g->output[1].limit);
    with_origin();
    origin.channel[1].left = REAL_C(0.0625);
    is(1, 0.0625);
    TEST_ASSERT_EQUAL_INT(ERR_OK, limits_arm(&e, y));
    NEAR(0.125, g->output[1].limit);
}

static void watch(double before, double now)
{
    e.last[0] = e.rest[0];
    e.last[1] = (real_t)(0.5 + before);
    is(1, now);
    limits_watch(&e, y);
}

static void two_samples_agree_on_how_far_a_response_has_been_less_three_deviations_of_noise(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        const real_t *is_kept = sign < 0 ? &e.limits.low[1] : &e.limits.high[1];
        const real_t *other = sign < 0 ? &e.limits.high[1] : &e.limits.low[1];
        watch(sign / 16.0, sign / 32.0);
        NEAR(sign * 0.15625, *is_kept); /* (1/32 - 3/256) / 0.125 */
        NEAR(0.0, *other);
        watch(sign / 32.0, sign / 16.0);
        NEAR(sign * 0.15625, *is_kept);
        watch(sign / 64.0, sign / 16.0); /* it has been farther */
        NEAR(sign * 0.15625, *is_kept);
        watch(sign * 0.0625, sign * 0.0625);
        NEAR(sign * 0.40625, *is_kept);
        NEAR(0.0, *other);
    }
    NEAR(0.0, e.limits.high[0]);
    NEAR(0.0, e.limits.low[0]);
    NEAR(0.0, e.limits.high[2]);
    NEAR(0.0, e.limits.low[2]);
    e.last[0] = y[0] = REAL_C(0.625); /* of every output */
    limits_watch(&e, y);
    NEAR(0.90625, e.limits.high[0]);
}

static void the_reversal_takes_what_goes_the_wrong_way_twice_as_far(void)
{
    static const double cases[][4] = {/* low, high, gain, reach */
                                      {-0.5, 2, 1, 3}, {-0.5, 2, 3, 4},  {-0.5, 2, -1, 5},
                                      {0, 0, -1, 1},   {0, 0, 1.5, 1.5}, {-2, 0, 0.5, 4.5},
                                      {-2, 1, 0, 4},   {0, 3, 0, 6}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        e.limits.low[1] = (real_t)cases[n][0];
        e.limits.high[1] = (real_t)cases[n][1];
        NEAR(cases[n][3], limits_reach(&e, 1, (real_t)cases[n][2]));
    }
}

static struct limits_peak peak;

static enum limits_verdict judged(void)
{
    enum limits_verdict v;
    uint32_t samples = e.samples;
    real_t rest[2] = {e.rest[0], e.rest[1]};
    e.samples = 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, limits_arm(&e, rest)); /* the line has seen nothing yet */
    e.samples = samples;
    peak = (struct limits_peak){.output = 9};
    TEST_ASSERT_EQUAL_INT(ERR_OK, limits_judge(&e, y, &v, &peak));
    if (v == LIMITS_FINE)
        TEST_ASSERT_EQUAL_UINT8(9, peak.output);
    return v;
}

static void says(enum limits_verdict wanted, unsigned culprit, double predicted)
{
    TEST_ASSERT_EQUAL_INT(wanted, judged());
    TEST_ASSERT_EQUAL_UINT8(culprit, peak.output);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, predicted, (double)peak.predicted);
}

static void four_fifths_of_the_room_and_the_noise_end_a_half(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        is(1, sign * 0.2035);
        TEST_ASSERT_EQUAL_INT(LIMITS_FINE, judged());
        is(1, sign * 0.2043); /* 0.2 + 1/256 */
        says(LIMITS_TURN, 1, sign * 0.2043);
        is(0, sign * 0.21);
        says(LIMITS_TURN, 0, sign * 0.21);
        is(0, 0.0);
        is(1, sign * 0.2538);
        says(LIMITS_TURN, 1, sign * 0.2538);
        is(1, sign * 0.2541); /* nothing below takes it back */
        says(LIMITS_BACK, 1, sign * 0.2541);
        is(1, 0.0);
    }
    with_origin();
    origin.channel[1].left = REAL_C(0.0625);
    is(1, 0.1535);
    TEST_ASSERT_EQUAL_INT(LIMITS_FINE, judged());
    is(1, 0.1875 + 1.0 / 256); /* all of it: not past it */
    says(LIMITS_TURN, 1, 0.1875 + 1.0 / 256);
    is(1, 0.1545); /* 0.8 times 0.1875 + 1/256 */
    says(LIMITS_TURN, 1, 0.1545);
}

static void what_the_reversal_would_do_counts_as_well(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        *(sign < 0 ? &e.limits.high[1] : &e.limits.low[1]) =
            (real_t)(-sign * 0.25); /* 1/16 on top */
        is(1, sign * 0.14);
        TEST_ASSERT_EQUAL_INT(LIMITS_FINE, judged());
        is(1, sign * 0.1425);
        says(LIMITS_TURN, 1, sign * 0.205);
        is(1, sign * 0.1905);
        says(LIMITS_TURN, 1, sign * 0.253);
        is(1, sign * 0.1925);
        says(LIMITS_BACK, 1, sign * 0.255);
        is(0, sign * 0.22); /* that one would only turn */
        says(LIMITS_BACK, 1, sign * 0.255);
    }
}

static void the_model_says_where_it_goes_while_what_is_under_way_arrives(void)
{
    double share =
        1.0 - exp(-1.0); /* in a dead time of 6 s and two samples of 2 s, of a lag of 10 s */
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        e.interim_fitted = true;
        e.interim_fit.found[1] = (struct identified){
            .gain = (real_t)(sign * 4.0), .gain_sd = 1, .time_constant_s = 10, .dead_time_s = 6};
        /* It ends at (4 - 1)/8 at least. */
        is(1, sign * 0.05);
        says(LIMITS_TURN, 1, sign * (0.05 + 0.325 * share));
        is(1, sign * -0.092);
        TEST_ASSERT_EQUAL_INT(LIMITS_FINE, judged()); /* 0.2032 */
        is(1, sign * -0.089);
        TEST_ASSERT_EQUAL_INT(LIMITS_TURN, judged()); /* 0.2043 */
        /* Where the line is valid the model has all of the room. */
        e.config.line_guard = true;
        is(1, sign * 0.045);
        TEST_ASSERT_EQUAL_INT(LIMITS_FINE, judged()); /* 0.2536 */
        is(1, sign * 0.048);
        TEST_ASSERT_EQUAL_INT(LIMITS_TURN, judged()); /* 0.2547 */
        e.config.line_guard = false;
        e.interim_fitted = false;
        TEST_ASSERT_EQUAL_INT(LIMITS_FINE, judged());
        e.interim_fitted = true;
        e.interim_fit.found[1].gain_sd = REAL_C(1.34); /* not known within a third */
        TEST_ASSERT_EQUAL_INT(LIMITS_FINE, judged());
        e.interim_fit.found[1].gain_sd = 1;
        e.interim_fit.found[1].time_constant_s = 0;
        TEST_ASSERT_EQUAL_INT(LIMITS_FINE, judged());
        e.interim_fit.found[1].time_constant_s = REAL_C(0.5); /* all of it arrives */
        is(1, 0.0);
        TEST_ASSERT_EQUAL_INT(LIMITS_TURN, judged());
    }
}

static void the_extremes_of_a_step_that_grows_count_for_the_difference(void)
{
    e.limits.low[1] = REAL_C(-0.5);
    watch(0.0625, 0.0625);
    limits_step_grows(&e, y, REAL_C(0.25));
    e.amplitude = REAL_C(0.25);
    NEAR(-0.5, e.limits.low[1]); /* of an amplitude of 1, however large the step is */
    watch(-0.0625, -0.0625);     /* 1/8 down, by a step of 1/8 more */
    NEAR(-0.90625, e.limits.low[1]);
    e.drift_per_s[0] = REAL_C(1e-6); /* then it may be the drift */
    limits_step_grows(&e, y, REAL_C(0.5));
    NEAR(-0.453125, e.limits.low[1]);
    NEAR(0.125, e.limits.step_from);
}

static void a_response_is_seen_after_dead_time_and_23_time_constants(void)
{
    struct identified *f = &e.interim_fit.found[1];
    *f = (struct identified){
        .gain = 1, .gain_sd = REAL_C(0.1), .time_constant_s = 10, .dead_time_s = 5};
    e.interim_fit.found[0].flags = IDENTIFIED_NO_GAIN;
    e.half = 14; /* 28 s */
    TEST_ASSERT_FALSE(limits_response_is_seen(&e));
    e.interim_fitted = true;
    TEST_ASSERT_TRUE(limits_response_is_seen(&e));
    f->time_constant_s = REAL_C(10.1);
    TEST_ASSERT_FALSE(limits_response_is_seen(&e));
    f->time_constant_s = 10;
    f->gain_sd = REAL_C(0.4);
    TEST_ASSERT_FALSE(limits_response_is_seen(&e));
    f->flags = IDENTIFIED_NO_GAIN;
    TEST_ASSERT_TRUE(limits_response_is_seen(&e));
}

static void a_line_that_trips_is_counted_from_rest(void)
{
    for (unsigned believed = 0; believed < 2; believed++) {
        enum limits_verdict v = LIMITS_FINE;
        unsigned n = 0;
        setUp();
        e.config.line_guard = believed != 0;
        is(1, 0.03125);
        TEST_ASSERT_EQUAL_INT(ERR_OK, limits_arm(&e, y));
        for (; v == LIMITS_FINE && n < 40; n++) {
            is(1, 0.03125 + 0.000244140625 * n * n);
            TEST_ASSERT_EQUAL_INT(ERR_OK, limits_judge(&e, y, &v, &peak));
        }
        TEST_ASSERT_EQUAL_INT(LIMITS_TURN, v);
        TEST_ASSERT_EQUAL_UINT8(1, peak.output);
        if (believed) {
            struct guard_prediction p;
            TEST_ASSERT_EQUAL_INT(ERR_OK, guard_predict(&e.limits.guard, 1, &p));
            TEST_ASSERT_TRUE(real_abs(peak.predicted) > real_abs(y[1] - e.rest[1]) + REAL_C(0.01));
            NEAR(fmax((double)p.predicted + 0.03125,
                      (double)(y[1] - e.rest[1] + p.source - 3 * p.sd)),
                 peak.predicted);
        } else {
            /* It goes on as fast as now for as long as it has. */
            struct guard_prediction p;
            TEST_ASSERT_EQUAL_INT(ERR_OK, guard_predict(&e.limits.guard, 1, &p));
            NEAR((double)(y[1] - e.rest[1] + p.source - 3 * p.sd), peak.predicted);
        }
    }
    y[1] = (real_t)NAN;
    enum limits_verdict v;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, limits_judge(&e, y, &v, &peak));
}

/* Points of the record of output 1, from the first. */
static void recorded(const double *points, unsigned n)
{
    e.record.points = n;
    for (unsigned i = 0; i < n; i++)
        e.record.y[1][i] = (real_t)points[i];
}

static void on_the_way_down_what_comes_in_a_dead_time_counts(void)
{
    /* Over half of 20 s, in points of 4 s: three of them. */
    static const double points[] = {0.3, -0.3, 0.2, 0, 0, 0.1, -0.04, -0.10, -0.10, -0.10};
    e.phase = EXPERIMENT_DOWN;
    e.config.dead_time_s[1] = 20;
    e.half = 21;
    e.waited = 11;
    recorded(points, 10);
    is(1, -0.0995); /* and 0.005 each second for 20 s, of 0.8 times 0.25 */
    TEST_ASSERT_FALSE(limits_far_enough(&e, y));
    is(1, -0.1005);
    TEST_ASSERT_TRUE(limits_far_enough(&e, y));
    recorded(points + 6, 3); /* too few to tell */
    TEST_ASSERT_FALSE(limits_far_enough(&e, y));
    recorded(points + 6, 4);
    TEST_ASSERT_TRUE(limits_far_enough(&e, y));
    is(1, 0.0995 + 0.2);
    TEST_ASSERT_FALSE(limits_far_enough(&e, y)); /* it comes nearer: 0.1995 */
    e.config.dead_time_s[1] = 0;
    is(1, 0.1995);
    TEST_ASSERT_FALSE(limits_far_enough(&e, y));
    is(1, 0.2005);
    TEST_ASSERT_TRUE(limits_far_enough(&e, y));
    is(1, -0.2005);
    TEST_ASSERT_TRUE(limits_far_enough(&e, y));
    is(1, 0.0);
    is(0, -0.2005);
    TEST_ASSERT_TRUE(limits_far_enough(&e, y));
}

static void on_the_way_down_two_samples_at_the_present_speed_count_less_noise(void)
{
    /* Away by 0.0178125 in two samples, of which two deviations are noise. */
    for (int sign = -1; sign <= 1; sign += 2) {
        const double points[] = {0.1, 0.1 + sign * (0.01 + 2.0 / 256)};
        setUp();
        e.phase = EXPERIMENT_DOWN;
        recorded(points, 2);
        is(1, sign * 0.1895); /* and 0.01, of 0.8 times 0.25 */
        TEST_ASSERT_FALSE(limits_far_enough(&e, y));
        is(1, sign * 0.1905);
        TEST_ASSERT_TRUE(limits_far_enough(&e, y));
        is(1, sign * -0.1995); /* it comes nearer */
        TEST_ASSERT_FALSE(limits_far_enough(&e, y));
    }
}

static void for_half_a_level_it_may_still_be_on_its_way_from_the_other_side(void)
{
    e.phase = EXPERIMENT_DOWN;
    e.half = 21;
    e.waited = 10;
    for (int sign = -1; sign <= 1; sign += 2) {
        e.at_turn[1] = (real_t)(sign * 0.1);
        is(1, sign * 0.2573); /* 0.25 + 2/256 */
        TEST_ASSERT_FALSE(limits_far_enough(&e, y));
        is(1, sign * 0.2578125);
        TEST_ASSERT_FALSE(limits_far_enough(&e, y));
        is(1, sign * 0.2583);
        TEST_ASSERT_TRUE(limits_far_enough(&e, y));
        is(1, sign * 0.2005);
        TEST_ASSERT_FALSE(limits_far_enough(&e, y));
        is(1, sign * -0.2005);
        TEST_ASSERT_TRUE(limits_far_enough(&e, y));
        e.waited = 11;
        is(1, sign * 0.2005);
        TEST_ASSERT_TRUE(limits_far_enough(&e, y));
        e.waited = 10;
    }
}

static void before_the_step_it_may_stray_for_nine_tenths_of_the_room(void)
{
    e.phase = EXPERIMENT_REST;
    is(1, 0.2);
    TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
    with_origin();
    origin.channel[1].left = REAL_C(-0.0625); /* 0.16875 are left */
    for (int sign = -1; sign <= 1; sign += 2) {
        is(1, sign * 0.168);
        for (unsigned n = 0; n < 3; n++)
            TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
        is(1, sign * 0.1695);
        TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
        is(1, 0.0); /* a spike */
        TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
        is(1, sign * 0.1695);
        TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
        TEST_ASSERT_EQUAL_INT(1, limits_strayed(&e, y));
        is(1, 0.0);
        TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
        is(0, sign * 0.23);
        TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
        TEST_ASSERT_EQUAL_INT(0, limits_strayed(&e, y));
        is(0, 0.0);
    }
    /* The fastest drift seen may have carried it either way. */
    origin.channel[1].drift_per_s = REAL_C(0.001);
    origin.since_s = 100;
    for (int sign = -1; sign <= 1; sign += 2) {
        is(1, sign * (0.1 + 0.168));
        for (unsigned n = 0; n < 2; n++)
            TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
        is(1, sign * (0.1 + 0.1695));
        TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
        TEST_ASSERT_EQUAL_INT(1, limits_strayed(&e, y));
        is(1, 0.0);
        TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
    }
    origin.fixed = false;
    is(1, 0.3);
    for (unsigned n = 0; n < 2; n++)
        TEST_ASSERT_EQUAL_INT(-1, limits_strayed(&e, y));
}

/* The second sample in a row decides. */
static bool past(double away)
{
    is(1, 0.0);
    (void)limits_past(&e, y);
    is(1, away);
    TEST_ASSERT_EQUAL_INT(-1, limits_past(&e, y));
    int who = limits_past(&e, y);
    TEST_ASSERT_TRUE(who == -1 || who == 1);
    return who == 1;
}

static void a_limit_is_passed_where_two_samples_are_beyond_it(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        e.before[1].noise_sd =
            REAL_C(1.0) / 256; /* four of those are less than a tenth of the room */
        TEST_ASSERT_FALSE(past(sign * 0.2495));
        TEST_ASSERT_TRUE(past(sign * 0.2505));
        e.before[1].noise_sd = REAL_C(1.0) / 64; /* by 0.0375 more */
        TEST_ASSERT_FALSE(past(sign * 0.287));
        TEST_ASSERT_TRUE(past(sign * 0.288));
    }
    e.before[1].noise_sd = 0;
    TEST_ASSERT_FALSE(past(0.25)); /* at it, not beyond */
    e.limits.worst = 0;
    with_origin();
    origin.channel[1].left = REAL_C(0.0625);
    (void)past(0.125); /* and what is left: 0.1875 of 0.25 */
    NEAR(0.75, e.limits.worst);
    TEST_ASSERT_EQUAL_UINT8(1, e.limits.worst_output);
    (void)past(0.1);
    NEAR(0.75, e.limits.worst);
    origin.channel[0].left = REAL_C(0.2);
    (void)past(0.0);
    NEAR(0.8, e.limits.worst);
    TEST_ASSERT_EQUAL_UINT8(0, e.limits.worst_output);
}

static void after_the_first_half_a_drift_may_have_turned(void)
{
    e.drift_per_s[1] = REAL_C(1.0) / 1024; /* 1/32 so far */
    TEST_ASSERT_TRUE(past(-0.27));
    for (int phase = EXPERIMENT_DOWN; phase <= EXPERIMENT_BACK; phase++) {
        e.phase = (enum experiment_phase)phase;
        e.half = 1000;
        TEST_ASSERT_FALSE(past(-0.27));
        TEST_ASSERT_FALSE(past(-0.281));
        TEST_ASSERT_TRUE(past(-0.2815));
        TEST_ASSERT_FALSE(past(0.281));
        TEST_ASSERT_TRUE(past(0.2815));
    }
}

static void the_fastest_drift_of_any_rest_may_have_come_back(void)
{
    with_origin();
    origin.channel[1].drift_per_s = REAL_C(1.0) / 1024; /* the latest rest shows none */
    e.half = 1000;
    TEST_ASSERT_TRUE(past(0.2501));
    e.phase = EXPERIMENT_DOWN;
    TEST_ASSERT_FALSE(past(0.281));
    TEST_ASSERT_FALSE(past(-0.281));
    TEST_ASSERT_TRUE(past(0.2815));
    TEST_ASSERT_TRUE(past(-0.2815));
}

static void what_runs_away_is_stopped_before_its_limit(void)
{
    static const double slow[] = {0.5, 0.20, 0.21}, fast[] = {0.5, 0, 0.12};
    double noise = 1.0 / 1024,
           leaving = 0.005 - noise; /* in a sample; two deviations over a block of 2 */
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        e.before[1].noise_sd = (real_t)noise;
        e.phase = EXPERIMENT_DOWN;
        e.half = 21;
        e.waited = 10;
        e.at_turn[1] = (real_t)(sign * 0.1);
        double most = 0.9 * 0.25 - 2.0 * leaving;
        double points[3];
        for (unsigned i = 0; i < 3; i++)
            points[i] = sign * slow[i];
        recorded(points, 3);
        TEST_ASSERT_FALSE(past(sign * (most - 0.0005)));
        TEST_ASSERT_TRUE(past(sign * (most + 0.0005)));
        e.waited = 9; /* not yet */
        TEST_ASSERT_FALSE(past(sign * 0.2495));
        e.waited = 10;
        TEST_ASSERT_FALSE(past(-sign * 0.2495)); /* where it should be by now */
        e.phase = EXPERIMENT_BACK;
        TEST_ASSERT_TRUE(past(sign * (most + 0.0005)));
        TEST_ASSERT_TRUE(past(-sign * 0.2255)); /* on its way back */
        TEST_ASSERT_FALSE(past(-sign * 0.2245));
        double faster = 0.9 * 0.25 - 2.0 * (0.01 - noise); /* two points are enough */
        recorded((double[]){0, sign * 0.02}, 2);
        TEST_ASSERT_FALSE(past(sign * (faster - 0.0005)));
        TEST_ASSERT_TRUE(past(sign * (faster + 0.0005)));
        recorded(points, 1); /* one is not */
        TEST_ASSERT_FALSE(past(sign * 0.2245));
        TEST_ASSERT_TRUE(past(sign * 0.2255));
        /* Half of the room it may be from rest, however fast it goes. */
        for (unsigned i = 0; i < 3; i++)
            points[i] = sign * fast[i];
        recorded(points, 3);
        TEST_ASSERT_FALSE(past(sign * 0.1245));
        TEST_ASSERT_FALSE(past(sign * 0.125));
        TEST_ASSERT_TRUE(past(sign * 0.1255));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_is_left_comes_off_the_room_on_either_side);
    RUN_TEST(a_drift_counts_where_it_explains_what_is_seen_and_no_farther_than_the_limit);
    RUN_TEST(half_of_a_limit_may_be_left_before_another_test);
    RUN_TEST(the_line_guard_begins_at_rest_and_goes_on_from_where_the_output_is);
    RUN_TEST(two_samples_agree_on_how_far_a_response_has_been_less_three_deviations_of_noise);
    RUN_TEST(the_reversal_takes_what_goes_the_wrong_way_twice_as_far);
    RUN_TEST(four_fifths_of_the_room_and_the_noise_end_a_half);
    RUN_TEST(what_the_reversal_would_do_counts_as_well);
    RUN_TEST(the_model_says_where_it_goes_while_what_is_under_way_arrives);
    RUN_TEST(the_extremes_of_a_step_that_grows_count_for_the_difference);
    RUN_TEST(a_response_is_seen_after_dead_time_and_23_time_constants);
    RUN_TEST(a_line_that_trips_is_counted_from_rest);
    RUN_TEST(on_the_way_down_what_comes_in_a_dead_time_counts);
    RUN_TEST(on_the_way_down_two_samples_at_the_present_speed_count_less_noise);
    RUN_TEST(for_half_a_level_it_may_still_be_on_its_way_from_the_other_side);
    RUN_TEST(before_the_step_it_may_stray_for_nine_tenths_of_the_room);
    RUN_TEST(a_limit_is_passed_where_two_samples_are_beyond_it);
    RUN_TEST(after_the_first_half_a_drift_may_have_turned);
    RUN_TEST(the_fastest_drift_of_any_rest_may_have_come_back);
    RUN_TEST(what_runs_away_is_stopped_before_its_limit);
    return UNITY_END();
}
