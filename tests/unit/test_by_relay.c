/* commission/by_relay.[ch]: a relay test on the supervisor, tick by tick, on either side of each bound. The measurements are what
 * is written here; where the relay cycles, an integrator with dead time. */
#include <math.h>
#include <string.h>

#include "commission_space.h"
#include "supervisor_bench.h"

#define WINDOW 32

static struct commission c;
static struct config *cf;
static const struct relay_test *t;
static const struct relay_config *r;
static double y[2]; /* of T1 and T10, fraction of span */

#define NEAR(wanted, value)                                                                        \
    TEST_ASSERT_DOUBLE_WITHIN(2e-6 + 2e-6 * fabs(wanted), wanted, (double)(value))

/* Ticks of 2 s; top (T1 by reflux at half, direct) is to be tested, T10 watched. */
void setUp(void)
{
    bench_start();
    bench.plan[bench.current].tick_s = 2;
    cf = &bench.plan[bench.current].config;
    cf->test = (struct test_config){.noise_multiple = 20, .rounds = 1, .window = WINDOW};
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        cf->measurement[i].start_up.test = i == T10;
        cf->measurement[i].start_up.critical = 0;
        cf->measurement[i].start_up.limit = cf->mv[i].start_up.step = 0;
    }
    y[0] = y[1] = 0.25;
    commission_init(&c, &bench.events, commission_fresh_region());
    commission_lease(&c);
    t = &c.work->relay;
    r = &c.work->relay.relay.config;
    c.requests.relay_serial = bench.s.plan->serial;
    c.requests.relay_loop = TOP;
    bench_forget_events();
}
void tearDown(void) {}

static void begin(void)
{
    setUp();
    commission_begin_relay(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_RELAY, c.status.phase);
}

/* The next sample, so many ticks after the one before. */
static void sample(unsigned ticks)
{
    bench.s.time_ms += 2000u * ticks;
    bench.s.measurement[T1].value = N(y[0]);
    bench.s.measurement[T10].value = N(y[1]);
    commission_relay(&c, &bench.s);
}

/* Ticks until the relay is at work, the measurements climbing by so much each and swinging by so much with every sample. */
static unsigned rests(double climb0, double climb1, double swing, unsigned most)
{
    double from[2] = {y[0], y[1]};
    for (unsigned n = 1; n <= most && c.status.phase == COMMISSION_RELAY; n++) {
        y[0] = from[0] + climb0 * n + (n % 2 ? swing : -swing);
        y[1] = from[1] + climb1 * n;
        sample(1);
        if (!t->resting)
            return n;
    }
    return 0;
}

static void ended(enum commission_reason reason, const char *subject, double value)
{
    TEST_ASSERT_EQUAL_INT(COMMISSION_ENDED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(reason, c.status.reason);
    TEST_ASSERT_EQUAL_STRING(subject, c.status.subject);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, value, (double)c.status.value);
}

/* ---- the beginning ---- */

static void it_begins_with_its_own_measurement_and_the_tested_ones(void)
{
    memset(c.work, 0xA5, sizeof *c.work); /* whatever was there before */
    c.outputs.n = c.inputs.n = 3;
    c.status.analysed = true;
    bench.s.loop[BOTTOM].mode = LOOP_AUTO; /* it is no hand that this one acts already */
    cf->measurement[T1].start_up.test = 1;
    cf->measurement[FEED].start_up.test = 1;
    commission_begin_relay(&c, &bench.s);
    TEST_ASSERT_TRUE(c.by_relay.latest);
    TEST_ASSERT_EQUAL_UINT8(TOP, c.by_relay.loop);
    TEST_ASSERT_EQUAL_UINT8(1, c.inputs.round);
    TEST_ASSERT_EQUAL_UINT8(3, c.outputs.n);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(((uint8_t[]){T1, T10, FEED}), c.outputs.measurement, 3);
    TEST_ASSERT_EQUAL_UINT8(1, c.inputs.n);
    TEST_ASSERT_EQUAL_UINT8(REFLUX, c.inputs.input[0].output);
    NEAR(0.5, c.inputs.input[0].test_base);
    TEST_ASSERT_FALSE(c.status.analysed);
    TEST_ASSERT_EQUAL_UINT8(LOOP_MANUAL, c.by_relay.mode[TOP]);
    TEST_ASSERT_EQUAL_UINT8(LOOP_AUTO, c.by_relay.mode[BOTTOM]);
    TEST_ASSERT_TRUE(t->resting);
    TEST_ASSERT_EQUAL_UINT32(0, t->waited);
    TEST_ASSERT_EQUAL_UINT32(0, t->cycling);
    NEAR(0.0, t->slope_per_s[0]);
    NEAR(0.0, t->limit[3]);
    NEAR(0.2, t->limit[2]);
    TEST_ASSERT_EQUAL_UINT64(bench.s.time_ms, c.status.phase_ms);
    TEST_ASSERT_EQUAL_UINT64(bench.s.time_ms, c.outputs.sample_ms);
    TEST_ASSERT_EQUAL_UINT32(2, t->steady.config.block);
    NEAR(3.0, t->steady.config.motion_limit);
    NEAR(4.0, t->steady.config.variance_limit);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 7e-5, (double)t->steady.config.noise_floor);
    bench_events();
    TEST_ASSERT_EQUAL_UINT(1, bench.n_seen);
    TEST_ASSERT_EQUAL_INT(EVENT_COMMISSION_BEGUN, bench.seen[0].code);
    TEST_ASSERT_EQUAL_STRING("top", bench.seen[0].subject);
    NEAR(1.0, bench.seen[0].value);
    setUp();
    cf->test.window = STEADY_BLOCKS - 1;
    commission_begin_relay(&c, &bench.s);
    TEST_ASSERT_EQUAL_UINT32(1, t->steady.config.block);
    setUp();
    bench.plan[bench.current].tick_s = 0; /* no time at all */
    commission_begin_relay(&c, &bench.s);
    ended(REASON_NUMBERS, "reflux", (double)ERR_RANGE);
    setUp();
    bench.s.loop[BOTTOM].mode = LOOP_AUTO;
    commission_begin_relay(&c, &bench.s);
    sample(1);
    TEST_ASSERT_EQUAL_INT(COMMISSION_RELAY, c.status.phase);
}

static void what_has_changed_since_it_was_asked_for_is_refused(void)
{
    for (unsigned n = 0; n < 4; n++) {
        setUp();
        if (n == 0)
            c.requests.relay_serial++;
        else if (n == 1)
            c.requests.relay_loop = CONFIG_LOOPS;
        else if (n == 2)
            c.requests.relay_loop = 5; /* there is none */
        else
            bench.s.loop[TOP].mode = LOOP_AUTO;
        commission_begin_relay(&c, &bench.s);
        TEST_ASSERT_EQUAL_INT(COMMISSION_IDLE, c.status.phase);
        TEST_ASSERT_FALSE(c.by_relay.latest);
        TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_REQUEST_REFUSED, ""));
    }
}

/* ---- rest ---- */

static void a_window_at_rest_is_enough(void)
{
    begin();
    TEST_ASSERT_EQUAL_UINT(WINDOW, rests(0, 0, 0, 100));
    NEAR(0.25, t->rest[0]);
    NEAR(0.25, t->rest[1]);
    NEAR(0.0, t->slope_per_s[0]);
    TEST_ASSERT_EQUAL_UINT32(1, t->cycling);
}

/* The hysteresis is a thousandth of span here, a limit a fifth. */
static void a_drift_no_faster_than_the_hysteresis_is_taken_at_once_and_others_in_time(void)
{
    for (unsigned j = 0; j < 2; j++) {
        static const struct {
            double carried; /* in a window */
            unsigned rests; /* ticks; 0: for ever */
        } cases[] = {{0.00095, 48}, {0.00105, 97}, {0.059, 97}, {0.061, 0}};
        for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
            begin();
            double climb = cases[n].carried / WINDOW;
            TEST_ASSERT_EQUAL_UINT(cases[n].rests, rests(j ? 0 : climb, j ? climb : 0, 0, 300));
            if (cases[n].rests > 0) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-5, y[j], (double)t->rest[j]);
                TEST_ASSERT_DOUBLE_WITHIN(1e-3 * climb, climb / 2.0, (double)t->slope_per_s[j]);
                NEAR(0.0, t->slope_per_s[1 - j]);
            }
        }
    }
}

static void what_does_not_come_to_rest_ends_it(void)
{
    for (unsigned j = 0; j < 2; j++) {
        begin();
        cf->test.longest_s = 5; /* no matter how long a half may be */
        double climb = 0.065 / WINDOW;
        unsigned n = 0;
        double from = y[j] = -1.5;
        for (; c.status.phase == COMMISSION_RELAY && n < 2000; n++) {
            y[j] = from + climb * (n + 1);
            sample(1);
        }
        TEST_ASSERT_EQUAL_UINT(20 * WINDOW + 1000 + 1, n);
        ended(REASON_RESTLESS, j ? "T10" : "T1", 0.0);
    }
}

/* ---- the relay ---- */

static void the_relay_is_made_for_the_noise_the_limit_and_the_room(void)
{
    begin();
    rests(0, 0, 0, 100);
    NEAR(2.0, r->h_s);
    TEST_ASSERT_EQUAL_INT(-1, r->sign);
    NEAR(0.25, r->reference);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 7e-5, (double)r->noise_sd);
    NEAR(0.001, r->hysteresis);
    NEAR(0.0, r->amplitude);
    NEAR(0.5, r->most);
    NEAR(0.003, r->wanted);
    NEAR(0.02, r->first);
    TEST_ASSERT_EQUAL_UINT32(2 * WINDOW, r->patience);
    TEST_ASSERT_EQUAL_UINT32(1000, r->half_most);
    /* Every second sample up and down by s: neighbours are 2 s apart, and the first has none before it. */
    for (unsigned n = 0; n < 3; n++) {
        static const double swing[] = {0.0005, 0.002, 0.004};
        double sd = swing[n] * sqrt(2.0 * (WINDOW - 1) / WINDOW);
        begin();
        rests(0, 0, swing[n], 100);
        NEAR(sd, r->noise_sd);
        NEAR(3.0 * sd, r->hysteresis);
        NEAR(10.0 * sd, r->wanted); /* half of 20 deviations; that is more than three hystereses */
        NEAR(n == 0 ? 0.02 : n == 1 ? 10.0 * sd : 0.05, r->first);
    }
}

static void the_relay_is_made_for_what_is_set(void)
{
    begin();
    cf->measurement[T1].start_up.limit = 0.5f; /* half of it is less than three hystereses */
    commission_start_relay(&c, &bench.s);
    cf->test.noise_multiple = 2;
    cf->test.longest_s = 129; /* to the nearest tick: 65 */
    rests(0, 0, 0.0005, 100);
    NEAR(0.0025, r->wanted);
    TEST_ASSERT_EQUAL_UINT32(65, r->half_most);
    begin();
    cf->test.noise_multiple = 2;
    cf->test.longest_s = 128;
    rests(0, 0, 0.0005, 100);
    NEAR(9.0 * 0.0005 * sqrt(2.0 * (WINDOW - 1) / WINDOW), r->wanted);
    TEST_ASSERT_EQUAL_UINT32(65, r->half_most); /* above the patience */
    begin();
    cf->test.longest_s = 132;
    rests(0, 0, 0, 100);
    TEST_ASSERT_EQUAL_UINT32(66, r->half_most);
    begin();
    cf->mv[REFLUX].start_up.step = 2; /* of 10 */
    cf->loop[TOP].own.action = LOOP_REVERSE;
    rests(0, 0, 0, 100);
    NEAR(0.2, r->amplitude);
    TEST_ASSERT_EQUAL_INT(1, r->sign);
    begin();
    cf->mv[REFLUX].lo = 2;
    cf->mv[REFLUX].start_up.step = 2; /* of 8 */
    rests(0, 0, 0, 100);
    NEAR(0.25, r->amplitude);
    begin();
    c.inputs.input[0].test_base = REAL_C(0.03);
    cf->mv[REFLUX].start_up.step = 2;
    rests(0, 0, 0, 100);
    NEAR(0.03, r->most);
    NEAR(0.03, r->amplitude);
    NEAR(0.015, r->first); /* half of it is for the bias */
}

/* ---- while it cycles ---- */

/* At rest, the relay waiting for an answer. T1 may be 0.2 from 0.25, and three deviations of noise beyond. */
static void at_work(void)
{
    begin();
    rests(0, 0, 0, 100);
    TEST_ASSERT_FALSE(t->resting);
    bench_forget_events();
}

static void a_measurement_past_its_limit_for_two_samples_ends_it(void)
{
    for (unsigned j = 0; j < 2; j++)
        for (int sign = -1; sign <= 1; sign += 2) {
            at_work();
            double most = 0.2 + 3.0 * 7e-5;
            y[j] = 0.25 + sign * (most - 2e-5);
            sample(1);
            sample(1);
            y[j] = 0.25 + sign * (most + 2e-5);
            sample(1);
            y[j] = 0.25; /* a spike */
            sample(1);
            TEST_ASSERT_EQUAL_INT(COMMISSION_RELAY, c.status.phase);
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.00115, (double)c.inputs.input[0].worst);
            y[j] = 0.25 + sign * (most + 2e-5);
            sample(1);
            TEST_ASSERT_EQUAL_INT(COMMISSION_RELAY, c.status.phase);
            y[j] = 0.25 + sign * 0.3;
            sample(1);
            ended(REASON_LIMIT, j ? "T10" : "T1", 1.5);
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.5, (double)c.inputs.input[0].worst);
        }
}

static void the_largest_share_of_all_is_remembered(void)
{
    at_work();
    y[0] = 0.27;
    y[1] = 0.21;
    sample(1);
    NEAR(0.2, c.inputs.input[0].worst);
    y[1] = 0.27;
    sample(1);
    NEAR(0.2, c.inputs.input[0].worst);
    y[0] = 0.31;
    sample(1);
    NEAR(0.3, c.inputs.input[0].worst);
}

static void a_drift_is_taken_off_for_the_time_that_has_gone(void)
{
    double climb = 0.03 / WINDOW;
    begin();
    TEST_ASSERT_EQUAL_UINT(97, rests(0, climb, 0, 300));
    double from = y[1];
    for (unsigned n = 1; n <= 100; n++) {
        y[1] = from + climb * n;
        sample(1);
    }
    TEST_ASSERT_EQUAL_INT(COMMISSION_RELAY, c.status.phase);
    TEST_ASSERT_EQUAL_UINT32(101, t->cycling);
    TEST_ASSERT_TRUE(c.inputs.input[0].worst < REAL_C(0.02));
    y[1] += climb * 3;
    sample(3);
    TEST_ASSERT_EQUAL_UINT32(104, t->cycling);
    TEST_ASSERT_TRUE(c.inputs.input[0].worst < REAL_C(0.02));
}

static void eight_samples_may_be_missing(void)
{
    at_work();
    uint32_t before = t->relay.half;
    sample(9);
    TEST_ASSERT_EQUAL_INT(COMMISSION_RELAY, c.status.phase);
    TEST_ASSERT_EQUAL_UINT32(before + 9, t->relay.half);
    sample(10);
    ended(REASON_SAMPLES, "", 9.0);
}

static void a_hand_on_any_loop_ends_it(void)
{
    for (uint8_t i = 0; i < 2; i++)
        for (unsigned resting = 0; resting < 2; resting++) {
            if (resting)
                begin();
            else
                at_work();
            bench.s.loop[i].mode = LOOP_AUTO;
            sample(1);
            ended(REASON_HAND, i ? "bottom" : "top", 0.0);
        }
}

static void no_answer_within_its_patience_makes_the_relay_larger(void)
{
    at_work();
    unsigned n = 0;
    while (happened(EVENT_TEST_STEP, "reflux") < 1 && n < 500) {
        sample(1);
        n++;
    }
    double first = (double)t->relay.amplitude;
    TEST_ASSERT_TRUE(n < 2 * WINDOW + 3);
    NEAR(first, bench.seen[bench.n_seen - 1].value);
    TEST_ASSERT_EQUAL_UINT8(1, bench.seen[bench.n_seen - 1].detail);
    NEAR((double)t->relay.level, D(bench.s.mv[REFLUX].excitation));
    for (n = 0; c.status.phase == COMMISSION_RELAY && n < 5000; n++)
        sample(1);
    ended(REASON_NO_ANSWER, "top", 0.0);
    TEST_ASSERT_TRUE(happened(EVENT_TEST_STEP, "reflux") >= 4);
}

static void numbers_that_are_none_end_it(void)
{
    at_work();
    c.work->relay.relay.phase = RELAY_DONE; /* takes no sample any more */
    sample(1);
    ended(REASON_NUMBERS, "top", (double)ERR_STATE);
    begin();
    cf->test.noise_multiple = -1e9f;
    cf->measurement[T1].start_up.limit = 0;
    c.inputs.input[0].test_base = 0; /* no room */
    rests(0, 0, 0, 100);
    TEST_ASSERT_EQUAL_INT(COMMISSION_ENDED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_NUMBERS, c.status.reason);
    TEST_ASSERT_EQUAL_STRING("reflux", c.status.subject);
}

/* ---- the proposal ---- */

/* An integrator behind two samples of dead time: by so much each sample for a whole span of the input. */
static void cycles(double slope)
{
    double before[3] = {0};
    begin();
    for (unsigned n = 0; c.status.phase == COMMISSION_RELAY && n < 5000; n++) {
        before[2] = before[1];
        before[1] = before[0];
        before[0] = D(bench.s.mv[REFLUX].excitation);
        y[0] -= slope * before[2]; /* the loop is direct */
        sample(1);
    }
    TEST_ASSERT_EQUAL_INT(COMMISSION_READY, c.status.phase);
}

static void a_cycle_becomes_a_proposal_for_one_pair(void)
{
    cycles(0.02);
    const struct analysis *a = &c.work->analysis;
    const struct relay_result *found = &c.by_relay.finding.result;
    double ku = fabs((double)found->gain), pu = (double)found->period_s;
    TEST_ASSERT_TRUE(c.by_relay.finding.found && c.status.analysed && a->designed);
    TEST_ASSERT_TRUE(found->gain < 0 && ku > 5.0 && ku < 60.0);
    TEST_ASSERT_TRUE(pu > 10.0 && pu < 60.0);
    NEAR(-ku / 3.2, c.by_relay.finding.gain);
    NEAR(2.2 * pu, c.by_relay.finding.ti_s);
    NEAR((double)found->amplitude, c.inputs.input[0].amplitude);
    TEST_ASSERT_EQUAL_INT(ANALYSIS_DONE, a->stage);
    TEST_ASSERT_EQUAL_INT(PAIRING_DETERMINED, a->verdict);
    TEST_ASSERT_EQUAL_INT(DECOUPLER_NOT_NEEDED, a->decoupler);
    TEST_ASSERT_EQUAL_UINT8(1, a->plant.outputs);
    TEST_ASSERT_EQUAL_UINT8(1, a->plant.inputs);
    TEST_ASSERT_EQUAL_UINT8(1, a->pairs.n);
    TEST_ASSERT_EQUAL_UINT8(1, a->loops.pairs.n);
    NEAR(1.0, a->probability);
    TEST_ASSERT_EQUAL_UINT8(0, a->pairs.output[0]);
    TEST_ASSERT_EQUAL_UINT8(0, a->pairs.input[0]);
    TEST_ASSERT_EQUAL_UINT8(0, a->layout.n_cascades);
    TEST_ASSERT_EQUAL_HEX16(0, a->layout.inner_outputs);
    NEAR(ku / 3.2, a->loops.tuning[0].gain);
    NEAR(2.2 * pu, a->loops.tuning[0].ti_s);
    TEST_ASSERT_EQUAL_INT(TUNING_DIRECT, a->loops.tuning[0].action);
    NEAR(8.0, a->loops.derivative_filter);
    NEAR(0.05, a->config.step);
    NEAR(2.0 * pu * 0.05, a->predicted[0].iae);
    NEAR(2.0 * pu * 0.05, a->tried[0].iae);
    NEAR(0.22, a->predicted[0].peak);
    NEAR(8.0 * pu, a->predicted[0].settled_s);
    NEAR(0.66 * ku * 0.05, a->predicted[0].moved);
    NEAR(0.66 * ku * 0.05, a->tried[0].moved[0]);
    NEAR(12.0 * pu, a->horizon_s);
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(8.0 * pu / 2.0 + 0.5), c.inputs.half_least);
    TEST_ASSERT_EQUAL_UINT64(bench.s.time_ms, c.status.phase_ms);
    TEST_ASSERT_EQUAL_UINT64(bench.s.time_ms, c.status.ended_ms);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_RELAY_DONE, "top"));
    NEAR(pu, bench.seen[bench.n_seen - 1].value);
    NEAR(0.0, D(bench.s.mv[REFLUX].excitation));
    struct config written = *cf;
    written.loop[TOP].own.td_s = 9;
    written.loop[TOP].own.action = LOOP_REVERSE;
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_write(&c, &written));
    NEAR(ku / 3.2, written.loop[TOP].own.gain);
    NEAR(2.2 * pu, written.loop[TOP].own.ti_s);
    NEAR(0.0, written.loop[TOP].own.td_s);
    TEST_ASSERT_EQUAL_UINT8(LOOP_DIRECT, written.loop[TOP].own.action);
    c.by_relay.finding.gain = -c.by_relay.finding.gain;
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_write(&c, &written));
    TEST_ASSERT_EQUAL_UINT8(LOOP_REVERSE, written.loop[TOP].own.action);
    strcpy(written.loop[TOP].pv, "T10");
    TEST_ASSERT_EQUAL_INT(ERR_UNKNOWN, proposal_write(&c, &written));
}

static void no_gain_is_more_than_a_loop_takes(void)
{
    cycles(0.0006);
    double ku = fabs((double)c.by_relay.finding.result.gain),
           pu = (double)c.by_relay.finding.result.period_s;
    TEST_ASSERT_TRUE(ku > 330.0);
    NEAR(-100.0, c.by_relay.finding.gain);
    NEAR(2.2 * pu * ku / 320.0, c.by_relay.finding.ti_s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_begins_with_its_own_measurement_and_the_tested_ones);
    RUN_TEST(what_has_changed_since_it_was_asked_for_is_refused);
    RUN_TEST(a_window_at_rest_is_enough);
    RUN_TEST(a_drift_no_faster_than_the_hysteresis_is_taken_at_once_and_others_in_time);
    RUN_TEST(what_does_not_come_to_rest_ends_it);
    RUN_TEST(the_relay_is_made_for_the_noise_the_limit_and_the_room);
    RUN_TEST(the_relay_is_made_for_what_is_set);
    RUN_TEST(a_measurement_past_its_limit_for_two_samples_ends_it);
    RUN_TEST(the_largest_share_of_all_is_remembered);
    RUN_TEST(a_drift_is_taken_off_for_the_time_that_has_gone);
    RUN_TEST(eight_samples_may_be_missing);
    RUN_TEST(a_hand_on_any_loop_ends_it);
    RUN_TEST(no_answer_within_its_patience_makes_the_relay_larger);
    RUN_TEST(numbers_that_are_none_end_it);
    RUN_TEST(a_cycle_becomes_a_proposal_for_one_pair);
    RUN_TEST(no_gain_is_more_than_a_loop_takes);
    return UNITY_END();
}
