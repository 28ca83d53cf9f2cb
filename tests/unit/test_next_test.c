/* commission/next_test.c, tests.c and expected.c: with what the next test of an input is made, on either side of each bound, from what
 * is configured and what the tests before have found. All of that is made up. */
#include <string.h>

#include "commission/expected.h"
#include "commission_space.h"
#include "supervisor_bench.h"

static struct commission c;
static struct config *cf;
static const struct experiment_config *x;

#define NEAR(wanted, value) TEST_ASSERT_DOUBLE_WITHIN(2e-6, wanted, (double)(value))

/* Two measurements and two inputs that are tested, ticks of 2 s, windows of 40; reflux at half, heat at a tenth. */
void setUp(void)
{
    bench_start();
    bench.plan[bench.current].tick_s = 2;
    cf = &bench.plan[bench.current].config;
    memset(cf->pair, 0, sizeof cf->pair);
    cf->test = (struct test_config){.noise_multiple = 20,
                                    .blank_s = 3,
                                    .confidence = 0.95f,
                                    .rounds = 3,
                                    .window = 40,
                                    .guard = TEST_GUARD_MODEL};
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        cf->measurement[i].start_up.test = cf->mv[i].start_up.test = i < 2;
        cf->measurement[i].start_up.critical = cf->mv[i].start_up.critical = 0;
        cf->measurement[i].start_up.limit = cf->mv[i].start_up.step = cf->mv[i].start_up.time_s = 0;
    }
    commission_init(&c, &bench.events, commission_fresh_region());
    commission_lease(&c);
    c.outputs.n = c.inputs.n = 2;
    c.outputs.measurement[1] = c.inputs.input[1].output = c.inputs.order[1] = 1;
    c.inputs.input[0].test_base = REAL_C(0.5);
    c.inputs.input[1].test_base = REAL_C(0.1);
    x = &c.work->experiment.config;
}
void tearDown(void) {}

static void start(uint8_t k)
{
    c.inputs.turn = k;
    commission_start_input(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_TESTING, c.status.phase);
}

/* Input 0 has had a test, of so much for 200 s. Its responses are over after 310 s. */
static void tested(double amplitude, double gain, double sd)
{
    c.inputs.input[0].rounds = 1;
    c.inputs.input[0].amplitude = (real_t)amplitude;
    c.inputs.input[0].half_s = 200;
    c.work->element[2][0].found.shape =
        (struct shape){.gain = 9, .dead_time_s = 999}; /* of no output */
    c.outputs.noise_sd[2] = REAL_C(1e-6);
    struct shape_found *f = &c.work->element[0][0].found;
    *f = (struct shape_found){.kind = SHAPE_ONE_LAG, .parameters = 3};
    f->shape = (struct shape){.gain = (real_t)gain, .lag_s = 100, .dead_time_s = 10};
    f->sd[SHAPE_GAIN] = (real_t)sd;
    f->sd[SHAPE_LAG] = 1;
    f->residence_sd_s = 1000; /* so that the lag's deviation counts */
    c.work->element[0][0].flags = 0;
    c.work->element[1][0] = (struct element){.flags = IDENTIFIED_NO_GAIN};
    c.work->element[1][0].found.kind = SHAPE_NO_RESPONSE;
    c.work->element[1][0].found.sd[SHAPE_GAIN] = REAL_C(1e-6);
    c.outputs.noise_sd[0] = REAL_C(0.002);
    c.outputs.noise_sd[1] = REAL_C(0.001);
}

/* ---- nothing known ---- */

static void a_first_test_has_the_settings_and_finds_its_amplitude(void)
{
    start(0);
    TEST_ASSERT_EQUAL_UINT8(2, x->outputs);
    NEAR(2.0, x->h_s);
    TEST_ASSERT_EQUAL_UINT32(40, x->window);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 7e-5, (double)x->noise_floor);
    NEAR(0.0, x->amplitude);
    NEAR(0.005, x->amplitude_first);
    TEST_ASSERT_TRUE(x->gains_unknown && x->repeats);
    NEAR(0.25, x->amplitude_max);
    NEAR(20.0, x->noise_multiple);
    NEAR(3.0, x->blank_s);
    TEST_ASSERT_EQUAL_UINT32(0, x->half);
    TEST_ASSERT_EQUAL_UINT32(40, x->half_least);
    TEST_ASSERT_EQUAL_UINT32(20000, x->half_most);
    TEST_ASSERT_EQUAL_UINT32(1000, x->half_plenty);
    TEST_ASSERT_FALSE(x->line_guard);
    TEST_ASSERT_EQUAL_PTR(&c.origin, x->origin);
    for (unsigned j = 0; j < 2; j++) {
        NEAR(0.2, x->limit[j]);
        NEAR(0.0, x->dead_time_s[j]);
    }
    start(1);
    NEAR(0.1, x->amplitude_max); /* as far as to its nearer limit */
}

static void what_is_configured_is_taken(void)
{
    cf->measurement[0].start_up.limit = 10;   /* of 100 */
    cf->measurement[1].start_up.critical = 1; /* half of it */
    cf->test.guard = TEST_GUARD_LINE;
    cf->test.window = 15; /* of rest, 16 blocks at least */
    start(0);
    NEAR(0.1, x->limit[0]);
    NEAR(0.1, x->limit[1]);
    TEST_ASSERT_TRUE(x->line_guard);
    TEST_ASSERT_EQUAL_UINT32(16, x->window);
    TEST_ASSERT_EQUAL_UINT32(16, x->half_least);
    cf->test.window = 17;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(17, x->window);
}

static void an_amplitude_and_a_half_that_are_given_hold(void)
{
    cf->mv[0].start_up.step = 1; /* of 10 */
    cf->mv[0].start_up.time_s = 101;
    start(0);
    NEAR(0.1, x->amplitude);
    NEAR(0.5, x->amplitude_max);
    TEST_ASSERT_EQUAL_UINT32(51, x->half); /* to the nearest tick */
    TEST_ASSERT_EQUAL_UINT32(20000, x->half_most);
    c.inputs.input[0].test_base = REAL_C(0.06);
    start(0);
    NEAR(0.06, x->amplitude);
    c.inputs.input[0].amplitude_most = REAL_C(0.05);
    start(0);
    NEAR(0.05, x->amplitude);
    NEAR(0.05, x->amplitude_max);
    c.inputs.input[0].amplitude_most = 0;
    cf->mv[0].start_up.step = 0.6f;
    start(0);
    NEAR(0.06, x->amplitude);
    c.inputs.input[0].amplitude_most = REAL_C(0.07); /* no room for it */
    start(0);
    NEAR(0.06, x->amplitude_max);
    cf->test.longest_s = 90; /* what is given for the input counts more */
    start(0);
    TEST_ASSERT_EQUAL_UINT32(51, x->half_most);
}

static void no_half_is_longer_than_set(void)
{
    cf->test.longest_s = 300;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(150, x->half_most);
    TEST_ASSERT_EQUAL_UINT32(0, x->half_plenty); /* the operator's word holds */
    cf->test.longest_s = 300.8f;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(150, x->half_most);
    cf->test.longest_s = 301.2f;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(151, x->half_most);
    cf->test.longest_s = 0.5f; /* a window and one at least */
    start(0);
    TEST_ASSERT_EQUAL_UINT32(41, x->half_most);
    TEST_ASSERT_EQUAL_UINT32(40, x->half_least);
    TEST_ASSERT_EQUAL_UINT32(0, commission_longest(&bench.s));
    cf->test.longest_s = 0;
    TEST_ASSERT_EQUAL_UINT32(20000, commission_longest(&bench.s));
}

static void what_the_inputs_before_have_taken_is_a_measure(void)
{
    static const struct {
        uint32_t before, window, least, most;
    } cases[] = {{100, 40, 50, 300},   {13, 40, 40, 20000},    {14, 40, 40, 42},
                 {163, 40, 81, 489},   {164, 41, 82, 492},     {333, 83, 166, 999},
                 {334, 83, 167, 1002}, {1900, 475, 950, 5700}, {40000, 10000, 20000, 20000}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        c.inputs.half_least = cases[n].before;
        start(0);
        TEST_ASSERT_EQUAL_UINT32(cases[n].window, x->window);
        TEST_ASSERT_EQUAL_UINT32(cases[n].least, x->half_least);
        TEST_ASSERT_EQUAL_UINT32(cases[n].most, x->half_most);
    }
    c.inputs.half_least = 100;
    c.inputs.input[1].amplitude_wanted = REAL_C(0.01); /* not linear: all of it */
    start(0);
    TEST_ASSERT_EQUAL_UINT32(100, x->half_least);
}

static void a_longer_half_that_is_wished_for_comes_true(void)
{
    c.inputs.half_least = 100;
    c.inputs.input[0].half_wanted = 301;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(301, x->half_least);
    TEST_ASSERT_EQUAL_UINT32(301, x->half_most);
    c.inputs.input[0].half_wanted = 20001;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(20000, x->half_least);
    TEST_ASSERT_EQUAL_UINT32(20000, x->half_most);
    c.inputs.input[0].half_wanted = 299;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(299, x->half_least);
    TEST_ASSERT_EQUAL_UINT32(300, x->half_most);
    c.inputs.input[0].half_wanted = 49;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(50, x->half_least);
}

static void the_smallest_step_that_was_wanted_is_the_first_of_all_inputs(void)
{
    NEAR(0.0, inputs_small_step(&c.inputs));
    c.inputs.input[1].amplitude_wanted = REAL_C(0.01);
    NEAR(0.01, inputs_small_step(&c.inputs));
    start(0);
    NEAR(0.005, x->amplitude_first); /* no larger than the first of any input */
    c.inputs.input[1].amplitude_wanted = REAL_C(0.004);
    start(0);
    NEAR(0.004, x->amplitude_first);
    TEST_ASSERT_TRUE(x->gains_unknown);
    c.inputs.input[1].amplitude_wanted = REAL_C(0.01);
    c.inputs.input[0].amplitude_wanted = REAL_C(0.015);
    start(0);
    NEAR(0.015, x->amplitude_first); /* its own */
    TEST_ASSERT_FALSE(x->gains_unknown);
    NEAR(0.01, inputs_small_step(&c.inputs));
    c.inputs.input[1].amplitude_wanted = 0; /* none is wanted */
    NEAR(0.015, inputs_small_step(&c.inputs));
    c.inputs.input[0].amplitude_wanted = REAL_C(0.005);
    start(0);
    NEAR(0.005, x->amplitude_first);
    c.inputs.input[0].amplitude_wanted = REAL_C(0.00006); /* the floor of the noise is the least */
    start(0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 7e-5, (double)x->amplitude_first);
    c.inputs.n = 0;
    NEAR(0.0, inputs_small_step(&c.inputs));
}

static void pair(unsigned n, const char *measurement, const char *output, double time_s,
                 double gain)
{
    struct pair_config *p = &cf->pair[n];
    memset(p, 0, sizeof *p);
    strcpy(p->measurement, measurement);
    strcpy(p->mv, output);
    p->time_s = (float)time_s;
    p->gain = (float)gain;
}

static void what_is_known_of_a_pair_beforehand_is_taken(void)
{
    pair(0, "T10", "reflux", 100, -5); /* 10 l/h by 100 degC: -0.5 in spans */
    pair(CONFIG_PAIRS - 1, "T1", "heat", 120, 0);
    start(0);
    TEST_ASSERT_EQUAL_UINT32(200, x->half_least); /* four times that */
    NEAR(0.1, x->amplitude_first);                /* a quarter of 0.2 */
    TEST_ASSERT_FALSE(x->gains_unknown);
    cf->measurement[1].start_up.limit = 10;
    start(0);
    NEAR(0.05, x->amplitude_first);
    start(1);
    TEST_ASSERT_EQUAL_UINT32(240, x->half_least);
    NEAR(0.005, x->amplitude_first);
    pair(1, "T1", "reflux", 99, 0); /* the slowest of an input */
    start(0);
    TEST_ASSERT_EQUAL_UINT32(200, x->half_least);
    pair(1, "T1", "reflux", 101, 0);
    start(0);
    TEST_ASSERT_EQUAL_UINT32(202, x->half_least);
    pair(0, "feed", "reflux", 100, 5); /* of no measurement that is tested */
    start(0);
    NEAR(0.005, x->amplitude_first);
    strcpy(cf->measurement[0].name, "T"); /* a short name is one, too */
    memset(cf->pair, 0, sizeof cf->pair);
    pair(0, "T", "reflux", 101, 5);
    start(0);
    TEST_ASSERT_EQUAL_UINT32(202, x->half_least);
    NEAR(0.1, x->amplitude_first);
    cf->mv[0].lo = cf->mv[0].min = -10; /* of a span of 20 */
    start(0);
    NEAR(0.05, x->amplitude_first);
    cf->mv[0].start_up.step = 2;
    start(0);
    NEAR(0.1, x->amplitude);
}

static void what_is_not_known_takes_no_time(void)
{
    bench.plan[bench.current].tick_s = 0.001f; /* a window is 0.04 s */
    tested(0.02, 0.5, 0.01);
    c.inputs.input[0].rounds = 0; /* the test was thrown away: nothing of it counts */
    c.inputs.input[0].unsettled = true;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(40, x->half_least);
    TEST_ASSERT_EQUAL_UINT32(20000, x->half_most);
    NEAR(0.0, x->dead_time_s[0]);
    bench.plan[bench.current].tick_s = 2;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(40, x->half_least);
    TEST_ASSERT_EQUAL_UINT32(20000, x->half_most);
}

/* ---- from the second round on ---- */

static void a_half_that_was_too_short_is_to_be_twice_as_long_or_as_long_as_the_response(void)
{
    tested(0.02, 0.5, 0.01);
    struct element *e = &c.work->element[0][0];
    NEAR(400.0,
         commission_half_needed(&c, 0, 0)); /* over after 310 s, and yet not seen to its end */
    e->found.shape.lag_s = 500;
    e->found.sd[SHAPE_LAG] = 249;
    NEAR(1510.0, commission_half_needed(&c, 0, 0));
    e->found.sd[SHAPE_LAG] = 251;
    NEAR(400.0, commission_half_needed(&c, 0, 0));
    e->found.sd[SHAPE_LAG] = 249;
    e->flags = IDENTIFIED_SLOW;
    NEAR(1510.0, commission_half_needed(&c, 0, 0));
    e->flags = IDENTIFIED_UNKNOWN;
    NEAR(400.0, commission_half_needed(&c, 0, 0));
}

static void the_times_that_are_known_are_the_length(void)
{
    tested(0.02, 0.5, 0.01);
    start(0);
    TEST_ASSERT_EQUAL_UINT32(155, x->half_least); /* 10 and three times 100 s */
    TEST_ASSERT_EQUAL_UINT32(193, x->half_most);  /* and a quarter */
    NEAR(10.0, x->dead_time_s[0]);
    NEAR(0.0, x->dead_time_s[2]);
    struct element *e = &c.work->element[0][0];
    struct shape_found *f = &e->found;
    NEAR(310.0, commission_lasts(&c, 0));
    f->sd[SHAPE_GAIN] = REAL_C(0.099); /* a fifth of the gain */
    NEAR(310.0, commission_lasts(&c, 0));
    f->shape.gain = -f->shape.gain;
    NEAR(310.0, commission_lasts(&c, 0));
    f->sd[SHAPE_GAIN] = REAL_C(0.101);
    NEAR(0.0, commission_lasts(&c, 0));
    f->sd[SHAPE_GAIN] = REAL_C(0.01);
    f->sd[SHAPE_LAG] = REAL_C(29.9);
    NEAR(310.0, commission_lasts(&c, 0));
    f->sd[SHAPE_LAG] = REAL_C(30.1);
    NEAR(0.0, commission_lasts(&c, 0));
    f->sd[SHAPE_LAG] = 1;
    c.work->element[1][0] = *e;
    c.work->element[1][0].found.shape.dead_time_s = 20;
    NEAR(320.0, commission_lasts(&c, 0));
    c.work->element[1][0].found.shape.dead_time_s = 5;
    NEAR(310.0, commission_lasts(&c, 0));
    e->flags = IDENTIFIED_NO_GAIN;
    NEAR(305.0, commission_lasts(&c, 0));
    c.outputs.n = 1;
    NEAR(0.0, commission_lasts(&c, 0));
}

/* What stands for an integrator is a hundred records long, and what has not been seen to its end is no time. */
static void a_ramp_and_what_is_open_have_no_time_to_go_by(void)
{
    static const unsigned flags[] = {IDENTIFIED_RAMP, IDENTIFIED_SLOW, IDENTIFIED_UNKNOWN,
                                     IDENTIFIED_NO_GAIN};
    for (unsigned n = 0; n < sizeof flags / sizeof flags[0]; n++) {
        tested(0.02, 0.5, 0.01);
        c.work->element[0][0].flags = (uint16_t)flags[n];
        NEAR(0.0, commission_lasts(&c, 0));
    }
    c.work->element[0][0].flags = IDENTIFIED_INVERSE;
    NEAR(310.0, commission_lasts(&c, 0));
}

static void what_was_not_known_takes_no_longer_than_it_did(void)
{
    tested(0.02, 0.5, 0.2);
    c.inputs.half_least = 60;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(100, x->half_most); /* 200 s */
    TEST_ASSERT_EQUAL_UINT32(40, x->half_least); /* half of 60, or a window */
    c.inputs.half_least = 90;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(45, x->half_least);
    c.inputs.half_least = 32;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(96, x->half_most); /* three times what the others take */
    c.inputs.half_least = 0;
    c.inputs.input[0].half_s = 80; /* a window */
    start(0);
    TEST_ASSERT_EQUAL_UINT32(20000, x->half_most);
    c.inputs.input[0].half_s = 82;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(41, x->half_most);
    tested(0.02, 0.5, 0.01); /* known, but faster than a window */
    c.work->element[0][0].found.shape.lag_s = 23;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(100, x->half_most);
    c.work->element[0][0].found.shape.lag_s = 24; /* 82 s */
    start(0);
    TEST_ASSERT_EQUAL_UINT32(51, x->half_most);
    TEST_ASSERT_EQUAL_UINT32(41, x->half_least);
}

static void what_an_analysis_left_open_gets_twice_as_long_or_four_times_where_it_may(void)
{
    tested(0.02, 0.5, 0.01);
    c.inputs.half_least = 50;
    c.inputs.input[0].half_s = 300;
    c.inputs.input[0].unsettled = true;
    c.work->element[0][0].flags = IDENTIFIED_SLOW;
    c.work->element[0][0].found.kind = SHAPE_PERHAPS_SLOW; /* another test as long tells as well */
    start(0);
    TEST_ASSERT_EQUAL_UINT32(150, x->half_least);
    c.work->element[0][0].found.kind = SHAPE_SLOW;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(300, x->half_least);
    c.inputs.input[0].rounds = 2;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(600, x->half_least);
    TEST_ASSERT_EQUAL_UINT32(750, x->half_most); /* whatever the others take */
    c.inputs.half_least = 0;
    cf->test.longest_s = 2000;
    start(0);
    TEST_ASSERT_EQUAL_UINT32(300, x->half_least);
    TEST_ASSERT_EQUAL_UINT32(375, x->half_most);
    c.inputs.input[0].half_s = 150; /* it is longer by itself */
    start(0);
    TEST_ASSERT_EQUAL_UINT32(155, x->half_least);
}

static double first(void)
{
    start(0);
    return (double)x->amplitude_first;
}

static void a_later_step_takes_06_of_the_room_and_stands_out_forty_times(void)
{
    tested(0.05, 2, 0.1);
    NEAR(0.05, first()); /* 0.04 would do, and 0.0545 would fit; a smaller one is not asked for */
    tested(0.03, 2, 0.1);
    NEAR(0.04, first());
    tested(0.06, -2, 0.1);
    NEAR(0.12 / 2.2, first());
    c.outputs.noise_sd[0] = REAL_C(0.004);
    tested(0.05, 2, 0.1);
    c.outputs.noise_sd[0] = REAL_C(0.004); /* it does not stand out so far */
    NEAR(0.12 / 2.2, first());
    tested(0.01, 2, 0.1);
    NEAR(0.03, first()); /* three times the one before */
    tested(0.05, 2, 0.1);
    c.outputs.noise_sd[0] = REAL_C(0.004);
    c.origin.channel[0].left = REAL_C(-0.1);
    NEAR(0.06 / 2.2, first());
    c.origin.channel[0].left = REAL_C(0.25); /* nothing is left */
    NEAR(7e-5, first());
    c.origin.channel[0].left = 0;
    c.work->element[1][0].found.sd[SHAPE_GAIN] =
        REAL_C(1.2); /* nor by what is not known of the others */
    NEAR(0.05, first());
    tested(0.2, 0.01, 0.001);
    NEAR(0.25, first());
    c.inputs.input[0].test_base = REAL_C(0.22);
    NEAR(0.22, first());
    tested(0.2, 0.01, 0.001);
    c.work->element[1][0] = c.work->element[0][0]; /* by the one that stands out most */
    c.work->element[1][0].found.shape.gain = REAL_C(-0.41);
    c.outputs.noise_sd[1] = REAL_C(0.001);
    c.inputs.input[0].test_base = REAL_C(0.5);
    NEAR(0.2, first());
    c.inputs.input[0].amplitude = REAL_C(0.05);
    NEAR(40.0 * 0.001 / 0.41, first());
}

static void what_a_round_has_reached_a_later_one_does_not_exceed(void)
{
    tested(0.05, 2, 0.1);
    c.outputs.noise_sd[0] = REAL_C(0.004);
    c.inputs.input[0].worst = REAL_C(0.73); /* of 0.8 at 0.05 */
    NEAR(0.12 / 2.2, first());
    c.inputs.input[0].worst = REAL_C(0.74);
    NEAR(0.04 / 0.74, first());
    c.inputs.input[0].worst = REAL_C(0.9);
    NEAR(0.04 / 0.9, first());
}

static void a_given_amplitude_stays_in_later_rounds(void)
{
    tested(0.05, 2, 0.1);
    cf->mv[0].start_up.step = 1;
    start(0);
    NEAR(0.1, x->amplitude);
}

/* ---- time ---- */

static void time_without_a_sample_ages_the_operating_point(void)
{
    c.origin.fixed = true;
    c.outputs.sample_ms = bench.s.time_ms;
    bench.s.time_ms += 5000;
    start(0);
    NEAR(5.0, c.origin.since_s);
    TEST_ASSERT_EQUAL_UINT64(bench.s.time_ms, c.status.phase_ms);
    start(0);
    NEAR(5.0, c.origin.since_s);
    bench.s.time_ms += 250;
    outputs_age_origin(&c.outputs, &c.origin, &bench.s);
    NEAR(5.25, c.origin.since_s);
    c.origin.fixed = false;
    bench.s.time_ms += 1000;
    outputs_age_origin(&c.outputs, &c.origin, &bench.s);
    NEAR(5.25, c.origin.since_s);
    TEST_ASSERT_EQUAL_UINT64(bench.s.time_ms, c.outputs.sample_ms);
}

/* So many ticks later. */
static void sample_after(unsigned n)
{
    bench.s.time_ms += 2000u * n;
    commission_test(&c, &bench.s);
}

static void eight_samples_may_be_missing_in_a_row(void)
{
    c.outputs.sample_ms = bench.s.time_ms;
    start(0);
    sample_after(30); /* nothing has begun before the first */
    TEST_ASSERT_EQUAL_INT(COMMISSION_TESTING, c.status.phase);
    TEST_ASSERT_EQUAL_UINT32(1, c.work->experiment.waited);
    sample_after(1);
    TEST_ASSERT_EQUAL_UINT32(2, c.work->experiment.waited);
    sample_after(9);
    TEST_ASSERT_EQUAL_INT(COMMISSION_TESTING, c.status.phase);
    TEST_ASSERT_EQUAL_UINT32(11, c.work->experiment.waited);
    NEAR(11 * 2.0, c.origin.since_s);
    sample_after(10);
    TEST_ASSERT_EQUAL_INT(COMMISSION_ENDED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_SAMPLES, c.status.reason);
    NEAR(9.0, c.status.value);
    TEST_ASSERT_EQUAL_STRING("", c.status.subject);
}

static void a_number_that_is_none_ends_it(void)
{
    cf->test.noise_multiple = 0;
    c.inputs.turn = 1;
    commission_start_input(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_ENDED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(REASON_NUMBERS, c.status.reason);
    TEST_ASSERT_EQUAL_STRING("heat", c.status.subject);
    NEAR((double)ERR_RANGE, c.status.value);
}

/* ---- the beginning ---- */

static void critical_inputs_come_first(void)
{
    bench.config = *cf;
    strcpy(bench.config.mv[2].name, "spare");
    bench.config.mv[2].start_up.test = bench.config.mv[2].start_up.critical = 1;
    apply();
    cf = &bench.plan[bench.current].config;
    bench.s.mv[2].manual = N(0.3);
    bench.s.time_ms = 123000;
    c.inputs.round = 7;
    job_ask(&c.background.job, 1);
    bench.s.safe_count = 5;
    c.adoption.n = 3;
    commission_begin(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_TESTING, c.status.phase);
    TEST_ASSERT_EQUAL_UINT8(2, c.outputs.n);
    TEST_ASSERT_EQUAL_UINT8(3, c.inputs.n);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(((uint8_t[]){2, 0, 1}), c.inputs.order, 3);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(((uint8_t[]){0, 1}), c.outputs.measurement, 2);
    TEST_ASSERT_EQUAL_UINT8(2, c.inputs.input[2].output);
    NEAR(0.5, c.inputs.input[0].test_base);
    NEAR(0.3, c.inputs.input[2].test_base);
    TEST_ASSERT_EQUAL_UINT8(1, c.inputs.round);
    TEST_ASSERT_FALSE(job_is_asked(&c.background.job));
    TEST_ASSERT_EQUAL_UINT8(0, c.adoption.n);
    TEST_ASSERT_EQUAL_UINT64(123000, c.status.began_ms);
    TEST_ASSERT_EQUAL_UINT32(bench.s.plan->serial, c.outputs.plan_serial);
    TEST_ASSERT_EQUAL_UINT32(bench.s.safe_count, c.outputs.safe_count);
    TEST_ASSERT_EQUAL_UINT32(commission_channels(cf), c.outputs.channels);
    TEST_ASSERT_EQUAL_PTR(&bench.events, c.status.events);
    TEST_ASSERT_EQUAL_UINT8(inputs_get(&c.inputs, inputs_current(&c.inputs))->output,
                            inputs_under_test(&c.inputs)->output);
    TEST_ASSERT_EQUAL_STRING("spare", cf->mv[inputs_under_test(&c.inputs)->output].name);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_COMMISSION_BEGUN, NULL));
}

static void what_cannot_begin_is_refused_and_leaves_what_was_found(void)
{
    c.inputs.round = 7;
    mode(TOP, LOOP_AUTO);
    bench_forget_events();
    commission_begin(&c, &bench.s);
    TEST_ASSERT_EQUAL_INT(COMMISSION_IDLE, c.status.phase);
    TEST_ASSERT_EQUAL_UINT8(7, c.inputs.round);
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_REQUEST_REFUSED, "top"));
}

/* ---- what is said beforehand ---- */

static void what_a_test_would_do_is_told_beforehand(void)
{
    struct expected_input e = expected_of_input(&bench.s, 0);
    TEST_ASSERT_TRUE(e.tested);
    NEAR(0.5, e.test_base);
    NEAR(0.002, e.first); /* a hundredth of the smallest limit */
    cf->measurement[0].start_up.limit = 10;
    NEAR(0.001, expected_of_input(&bench.s, 0).first);
    cf->measurement[0].start_up.limit = 0;
    NEAR(0.25, e.most);
    NEAR(3 * 80.0 + 2 * 80.0, e.least_s);     /* three halves of a window, and two of rest */
    NEAR(3.5 * 2000.0 + 3 * 500.0, e.most_s); /* a drift is seen over a quarter of a half */
    TEST_ASSERT_EQUAL_UINT16(3 + 3 + 1 + 3, e.tests_most); /* rounds; longer, smaller, gentler */
    bench.s.mv[0].manual = N(0.015625);
    e = expected_of_input(&bench.s, 0);
    NEAR(0.002, e.first);
    NEAR(0.015625, e.most);
    bench.s.mv[0].manual = N(0.5);
    cf->mv[0].start_up.step = 3;
    e = expected_of_input(&bench.s, 0);
    NEAR(0.3, e.first);
    NEAR(0.3, e.most);
    cf->mv[0].start_up.time_s = 0.5f;
    e = expected_of_input(&bench.s, 0);
    NEAR(1.75 + 240.0, e.most_s);
    TEST_ASSERT_EQUAL_UINT16(3, e.tests_most); /* what is given is not changed */
    cf->mv[0].lo = cf->mv[0].min = -10;        /* of a span of 20 */
    bench.s.mv[0].manual = N(0.5);
    NEAR(0.15, expected_of_input(&bench.s, 0).first);
    cf->mv[0].start_up.time_s = 100;
    e = expected_of_input(&bench.s, 0);
    NEAR(460.0, e.least_s);
    NEAR(350.0 + 240.0, e.most_s);
    TEST_ASSERT_FALSE(expected_of_input(&bench.s, 2).tested);
    NEAR(0.0, expected_of_input(&bench.s, 2).least_s);
}

static void times_that_are_given_are_told_four_times_three_halves(void)
{
    pair(1, "T1", "reflux", 50, 0);
    NEAR(3 * 200.0 + 160.0, expected_of_input(&bench.s, 0).least_s);
    pair(1, "T1", "heat", 0, 0);
    pair(0, "T1", "reflux", 22, 0);
    NEAR(3 * 88.0 + 160.0, expected_of_input(&bench.s, 0).least_s);
    pair(0, "T1", "reflux", 19, 0); /* four of them are less than a window of 80 s */
    NEAR(400.0, expected_of_input(&bench.s, 0).least_s);
    pair(1, "T10", "reflux", 21, 0);
    NEAR(3 * 84.0 + 160.0, expected_of_input(&bench.s, 0).least_s);
    pair(2, "T10", "heat", 50, 0);
    NEAR(3 * 84.0 + 160.0, expected_of_input(&bench.s, 0).least_s);
    cf->test.longest_s = 82; /* no longer than that */
    NEAR(3 * 82.0 + 160.0, expected_of_input(&bench.s, 0).least_s);
    NEAR(3.5 * 82.0 + 240.0, expected_of_input(&bench.s, 0).most_s);
    cf->test.longest_s = 0;
    struct expected all = expected_of(&bench.s);
    TEST_ASSERT_EQUAL_UINT8(2, all.outputs);
    TEST_ASSERT_EQUAL_UINT8(2, all.inputs);
    NEAR(3 * 84.0 + 160.0 + 3 * 200.0 + 160.0, all.least_s);
    NEAR(2 * 10 * 8500.0, all.most_s); /* of both inputs, three rounds and seven tests again */
    cf->pair[0].measurement[0] = cf->pair[1].measurement[0] = '\0'; /* not used */
    NEAR(400.0, expected_of_input(&bench.s, 0).least_s);
}

static void left_is(double round_s, double most_s)
{
    struct expected_left left = expected_left(&c, &bench.s);
    NEAR(round_s, left.round_s);
    NEAR(most_s, left.most_s);
}

static void how_long_it_may_still_take_is_told_by_the_plan_and_then_by_the_tests_so_far(void)
{
    bench.s.time_ms = 100000;
    commission_begin(&c, &bench.s);
    left_is(2 * 400.0, 2 * 10 * 8500.0);
    bench.s.time_ms += 300000;
    left_is(500.0, 2 * 10 * 8500.0 - 300.0);
    bench.s.time_ms += 600000;
    left_is(0.0, 2 * 10 * 8500.0 - 900.0);
    c.inputs.tests = 1; /* of 900 s; two inputs, three rounds */
    c.inputs.tested_s = 900;
    c.status.phase = COMMISSION_FITTING;
    left_is(900.0, 900.0 + 2 * 2 * 900.0);
    c.inputs.turn = 1;
    c.status.phase = COMMISSION_TESTING;
    c.status.phase_ms = bench.s.time_ms;
    bench.s.time_ms += 300000;
    left_is(600.0, 600.0 + 2 * 2 * 900.0);
    c.inputs.input[0].skipped = true;
    left_is(600.0, 600.0 + 2 * 900.0);
    c.inputs.round = 3;
    left_is(600.0, 600.0);
    bench.s.time_ms += 900000; /* longer than the others */
    left_is(0.0, 0.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(how_long_it_may_still_take_is_told_by_the_plan_and_then_by_the_tests_so_far);
    RUN_TEST(a_first_test_has_the_settings_and_finds_its_amplitude);
    RUN_TEST(what_is_configured_is_taken);
    RUN_TEST(an_amplitude_and_a_half_that_are_given_hold);
    RUN_TEST(no_half_is_longer_than_set);
    RUN_TEST(what_the_inputs_before_have_taken_is_a_measure);
    RUN_TEST(a_longer_half_that_is_wished_for_comes_true);
    RUN_TEST(the_smallest_step_that_was_wanted_is_the_first_of_all_inputs);
    RUN_TEST(what_is_known_of_a_pair_beforehand_is_taken);
    RUN_TEST(what_is_not_known_takes_no_time);
    RUN_TEST(a_half_that_was_too_short_is_to_be_twice_as_long_or_as_long_as_the_response);
    RUN_TEST(the_times_that_are_known_are_the_length);
    RUN_TEST(what_was_not_known_takes_no_longer_than_it_did);
    RUN_TEST(what_an_analysis_left_open_gets_twice_as_long_or_four_times_where_it_may);
    RUN_TEST(a_ramp_and_what_is_open_have_no_time_to_go_by);
    RUN_TEST(a_later_step_takes_06_of_the_room_and_stands_out_forty_times);
    RUN_TEST(what_a_round_has_reached_a_later_one_does_not_exceed);
    RUN_TEST(a_given_amplitude_stays_in_later_rounds);
    RUN_TEST(time_without_a_sample_ages_the_operating_point);
    RUN_TEST(eight_samples_may_be_missing_in_a_row);
    RUN_TEST(a_number_that_is_none_ends_it);
    RUN_TEST(critical_inputs_come_first);
    RUN_TEST(what_cannot_begin_is_refused_and_leaves_what_was_found);
    RUN_TEST(what_a_test_would_do_is_told_beforehand);
    RUN_TEST(times_that_are_given_are_told_four_times_three_halves);
    return UNITY_END();
}
