/* commission/model.[ch]: from finished tests to the elements of the plant. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "commission/model.h"
#include "commission_space.h"
#include "experiment_bench.h"

#define SEED 20240713u

static struct commission c;

void setUp(void)
{
    memset(&c, 0, sizeof c);
    commission_lease(&c);
    bench_begin(SEED);
}
void tearDown(void) {}

/* A shape of one lag, with deviations of a tenth of its times. */
static struct shape_found lag(double gain, double sd, double lag_s, double dead_s)
{
    struct shape_found f = {
        .kind = SHAPE_ONE_LAG,
        .parameters = 3,
        .other_parameters = 3,
        .shape = {.gain = (real_t)gain, .dead_time_s = (real_t)dead_s, .lag_s = (real_t)lag_s}};
    f.sd[SHAPE_GAIN] = (real_t)sd;
    f.sd[SHAPE_LAG] = f.residence_sd_s = (real_t)(0.1 * lag_s);
    f.sd[SHAPE_DEAD] = (real_t)(0.1 * dead_s);
    return f;
}

/* ---- from a test ---- */

/* A fresh start-up and bench. */
static void fresh(unsigned seed)
{
    memset(&c, 0, sizeof c);
    commission_lease(&c);
    bench_begin(SEED + seed);
}

/* The fits of the test that the bench has just made of input k of two. */
static void fitted(uint8_t k)
{
    c.outputs.n = config.outputs;
    c.inputs.n = 2;
    c.inputs.order[0] = 0;
    c.inputs.order[1] = 1;
    c.inputs.turn = k;
    c.work->experiment = experiment;
    model_begin_fit(&c);
    for (unsigned n = 0; model_piece(&c); n++)
        TEST_ASSERT_TRUE(n < 10000);
    TEST_ASSERT_EQUAL_INT(ERR_OK, c.model.error);
}

static void tested(uint8_t k)
{
    bench_run();
    TEST_ASSERT_EQUAL_INT(EXPERIMENT_DONE, experiment.phase);
    fitted(k);
}

/* What the latest test has found of output j. */
static const struct shape_found *found(uint8_t j)
{
    return interim_fit_shape(experiment_interim_fit(&c.work->experiment), j);
}

/* Within so many deviations, and the deviation within a share of the value. */
static void is_known(double wanted, real_t value, real_t sd, double sds, double share)
{
    TEST_ASSERT_DOUBLE_WITHIN(sds * (double)sd, wanted, (double)value);
    TEST_ASSERT_TRUE((double)sd < share * fabs(wanted));
}

static void a_test_gives_every_output_its_element(void)
{
    config.outputs = 3;
    bench.element[0] = (struct test_element){0.8, 40, 10};
    bench.element[1] = (struct test_element){-2.0, 15, 3};
    bench.element[2] = (struct test_element){0.0, 1, 0};
    tested(1);
    model_keep(&c);
    for (uint8_t j = 0; j < 2; j++) {
        const struct element *e = &c.work->element[j][1];
        const struct test_element *is = &bench.element[j];
        TEST_ASSERT_EQUAL_UINT8(SHAPE_ONE_LAG, e->found.kind);
        TEST_ASSERT_EQUAL_HEX16(0, e->flags);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(is->gain), is->gain, (double)e->found.shape.gain);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * (is->lag + is->dead), is->lag,
                                  (double)e->found.shape.lag_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * (is->lag + is->dead), is->dead,
                                  (double)e->found.shape.dead_time_s);
        /* second opinions on the same test */
        TEST_ASSERT_DOUBLE_WITHIN(0.03 * fabs(is->gain), is->gain, (double)e->moments.gain);
        if (real_abs(e->plateau_gain) > 0) /* where the levels were long enough */
            TEST_ASSERT_DOUBLE_WITHIN(0.03 * fabs(is->gain), is->gain, (double)e->plateau_gain);
    }
    TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_NO_GAIN, c.work->element[2][1].flags);
    TEST_ASSERT_EQUAL_FLOAT(0.0f,
                            (float)c.work->element[0][0].found.shape.gain); /* the other input's */
}

static void a_second_round_joins_the_first(void)
{
    bench.noise = 0.002;
    bench.element[0] = (struct test_element){0.8, 40, 10};
    config.amplitude = REAL_C(0.03);
    tested(0);
    model_keep(&c);
    c.inputs.input[0].rounds = 1;
    struct shape_found first = c.work->element[0][0].found;
    bench.k = bench.edges = 0;
    tested(0);
    struct shape_found second = *found(0), both = first;
    model_keep(&c);
    combine_shapes(&both, &second, false);
    TEST_ASSERT_EQUAL_MEMORY(&both, &c.work->element[0][0].found, sizeof both);
    TEST_ASSERT_TRUE(both.sd[SHAPE_GAIN] < first.sd[SHAPE_GAIN]);
    TEST_ASSERT_DOUBLE_WITHIN(0.08, 0.8, (double)both.shape.gain);
}

static void what_a_fit_says_as_one_lag_is_the_sum_of_its_lags_with_its_flags(void)
{
    struct element e = {.found = lag(0.8, 0.1, 60, 20), .flags = IDENTIFIED_SLOW};
    struct identified f = element_fit(&e);
    TEST_ASSERT_EQUAL_FLOAT(0.8f, (float)f.gain);
    TEST_ASSERT_EQUAL_FLOAT(0.1f, (float)f.gain_sd);
    TEST_ASSERT_EQUAL_FLOAT(60.0f, (float)f.time_constant_s);
    TEST_ASSERT_EQUAL_FLOAT(6.0f, (float)f.time_constant_sd_s);
    TEST_ASSERT_EQUAL_FLOAT(20.0f, (float)f.dead_time_s);
    TEST_ASSERT_EQUAL_FLOAT(2.0f, (float)f.dead_time_sd_s);
    TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_SLOW, f.flags);
}

/* Wood and Berry's xB over R: a lag of 109 s, or lags of 150 and 73 s with a zero of 113 s that says nearly the same. */
static void a_lag_that_a_zero_nearly_cancels_does_not_make_the_time_unsure(void)
{
    struct element e = {.found = lag(0.66, 0.002, 109, 70)};
    e.found.sd[SHAPE_LAG] = 100;
    e.found.sd[SHAPE_DEAD] = 3;
    e.found.residence_sd_s = 4;
    TEST_ASSERT_EQUAL_FLOAT(5.0f, (float)element_fit(&e).time_constant_sd_s);
    e.found.sd[SHAPE_LAG] = REAL_C(4.9);
    TEST_ASSERT_EQUAL_FLOAT(4.9f, (float)element_fit(&e).time_constant_sd_s);
    e.found.sd[SHAPE_LAG] = 100;
    e.found.parameters = 5; /* the chosen shape has such a zero: its end is as unsure as its lag */
    TEST_ASSERT_EQUAL_FLOAT(100.0f, (float)element_fit(&e).time_constant_sd_s);
}

/* ---- shapes ---- */

/* Sum of the bench's steps, each answered by a unit step response. */
static double answered(double (*response)(double t), uint32_t k)
{
    double y = 0.0;
    for (unsigned i = 0; i < bench.edges; i++)
        if (k > bench.edge[i])
            y += bench.change[i] * response(k - bench.edge[i]);
    return y;
}

/* (zero s + 1)/((60 s + 1)(25 s + 1)), gain 0.8, dead time 8 s. */
static double zero_s;
static double two_lags_response(double t)
{
    t -= 8.0;
    double slow = (60.0 - zero_s) * exp(-t / 60.0), fast = (25.0 - zero_s) * exp(-t / 25.0);
    return t > 0.0 ? 0.8 * (1.0 - (slow - fast) / 35.0) : 0.0;
}

static double two_lags(unsigned j, uint32_t k)
{
    (void)j;
    return answered(two_lags_response, k);
}

/* Period of 132 s, damping 0.3, gain 1, dead time 5 s. */
static double damped_response(double t)
{
    double w = 1.0 / 20.0, d = 0.3, wd = w * sqrt(1.0 - d * d);
    t -= 5.0;
    return t > 0.0 ? 1.0 - exp(-d * w * t) * (cos(wd * t) + d * w / wd * sin(wd * t)) : 0.0;
}

static double damped(unsigned j, uint32_t k)
{
    (void)j;
    return answered(damped_response, k);
}

/* Slope 0.01 per second behind a lag of 10 s, dead time 5 s. */
static double ramp_response(double t)
{
    t -= 5.0;
    return t > 0.0 ? 0.01 * (t - 10.0 * (1.0 - exp(-t / 10.0))) : 0.0;
}

static double ramp(unsigned j, uint32_t k)
{
    (void)j;
    return answered(ramp_response, k);
}

static void step_of(double (*other)(unsigned j, uint32_t k), uint32_t half, double noise)
{
    bench.other = other;
    bench.noise = noise;
    config.amplitude = REAL_C(0.05);
    config.half = half;
    config.limit[0] = REAL_C(0.5);
}

/* A fast part of 0.5 and a slow one of 0.5. */
static double fast_and_slow_response(double t)
{
    return t > 2.0 ? 0.5 * (2.0 - exp((2.0 - t) / 8.0) - exp((2.0 - t) / 120.0)) : 0.0;
}

static double fast_and_slow(unsigned j, uint32_t k)
{
    (void)j;
    return answered(fast_and_slow_response, k);
}

static void two_lags_are_found_as_two(void)
{
    zero_s = 0.0;
    step_of(two_lags, 400, 1e-3);
    tested(0);
    const struct shape_found *f = found(0);
    TEST_ASSERT_EQUAL_UINT8(SHAPE_TWO_LAGS, f->kind);
    TEST_ASSERT_EQUAL_HEX16(0, c.model.fitted[0].flags);
    is_known(0.8, f->shape.gain, f->sd[SHAPE_GAIN], 3.0, 0.01);
    is_known(85.0, f->shape.lag_s, f->sd[SHAPE_LAG], 3.0, 0.05);
    is_known(1500.0, f->shape.square_s2, f->sd[SHAPE_SQUARE], 3.0, 0.1);
    is_known(8.0, f->shape.dead_time_s, f->sd[SHAPE_DEAD], 3.0, 0.2);
}

static void a_zero_is_found_with_its_sign_and_only_the_wrong_way_is_inverse(void)
{
    static const double zeros[] = {-30.0, 120.0};
    for (unsigned n = 0; n < 2; n++) {
        fresh(n);
        zero_s = zeros[n];
        step_of(two_lags, 400, 1e-3);
        tested(0);
        const struct shape_found *f = found(0);
        TEST_ASSERT_EQUAL_UINT8(SHAPE_TWO_WITH_ZERO, f->kind);
        TEST_ASSERT_EQUAL_HEX16(n == 0 ? IDENTIFIED_INVERSE : 0, c.model.fitted[0].flags);
        is_known(0.8, f->shape.gain, f->sd[SHAPE_GAIN], 3.0, 0.01);
        is_known(zero_s, f->shape.zero_s, f->sd[SHAPE_ZERO], 3.0, 0.1);
        is_known(1500.0, f->shape.square_s2, f->sd[SHAPE_SQUARE], 3.0, 0.1);
    }
}

static void a_damped_element_is_found_with_its_damping(void)
{
    step_of(damped, 400, 1e-3);
    tested(0);
    const struct shape_found *f = found(0);
    TEST_ASSERT_EQUAL_UINT8(SHAPE_TWO_LAGS, f->kind);
    TEST_ASSERT_EQUAL_HEX16(0, c.model.fitted[0].flags);
    is_known(1.0, f->shape.gain, f->sd[SHAPE_GAIN], 3.0, 0.01);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.3,
                              (double)(f->shape.lag_s / real_sqrt(f->shape.square_s2)) / 2.0);
}

static void a_ramp_is_found_by_its_slope_and_told_from_what_is_open(void)
{
    step_of(ramp, 200, 1e-3);
    tested(0);
    model_keep(&c);
    const struct element *e = &c.work->element[0][0];
    TEST_ASSERT_EQUAL_UINT8(SHAPE_INTEGRATING, e->found.kind);
    TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_RAMP, e->flags);
    TEST_ASSERT_FALSE(e->flags & CERTAINTY_OPEN_FLAGS);
    is_known(0.01, e->found.shape.gain / e->found.shape.lag_s,
             e->found.sd[SHAPE_GAIN] / e->found.shape.lag_s, 3.0, 0.01);
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 10.0, (double)(e->found.shape.square_s2 / e->found.shape.lag_s));
}

/* A lag of 400 s, of which 200 s have seen two fifths: at least the gain that was seen, and its beginning as it is. */
static void what_was_not_seen_to_its_end_is_slow_and_no_more_than_was_seen(void)
{
    bench.element[0] = (struct test_element){2.0, 400, 5};
    step_of(NULL, 200, 5e-4);
    tested(0);
    const struct shape_found *f = found(0);
    TEST_ASSERT_EQUAL_UINT8(SHAPE_SLOW, f->kind);
    TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_SLOW, c.model.fitted[0].flags);
    double seen = 2.0 * (1.0 - exp(-195.0 / 400.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * seen, seen, (double)f->shape.gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * 2.0 / 400.0, 2.0 / 400.0,
                              (double)(f->shape.gain / f->shape.lag_s));
}

static void a_step_that_was_cut_before_the_response_ends_leaves_it_open(void)
{
    bench.element[0] = (struct test_element){20.0, 80, 25};
    config.limit[0] = REAL_C(0.15);
    tested(0);
    TEST_ASSERT_TRUE(experiment.cut);
    TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_SLOW, c.model.fitted[0].flags);
}

/* Goes up at once and dies away again: no shape here has a gain for that. */
static double washed_out_response(double t)
{
    return 2.0 * exp(-(t - 1.0) / 12.0);
}

static double washed_out(unsigned j, uint32_t k)
{
    (void)j;
    return answered(washed_out_response, k);
}

static void what_comes_back_to_where_it_was_has_no_gain_to_build_on(void)
{
    for (unsigned seed = 0; seed < 10; seed++) {
        fresh(seed);
        bench.other = washed_out;
        bench.noise = 2e-4 * seed;
        config.amplitude = REAL_C(0.02);
        config.half = 80;
        tested(0);
        const struct identified *e = &c.model.fitted[0];
        TEST_ASSERT_TRUE((e->flags & CERTAINTY_OPEN_FLAGS) || e->gain_sd > real_abs(e->gain));
        TEST_ASSERT_TRUE(real_is_finite(e->gain) && real_is_finite(e->gain_sd));
    }
}

static void a_fast_part_and_a_slow_tail_are_one_shape(void)
{
    for (unsigned seed = 0; seed < 5; seed++) {
        fresh(seed);
        step_of(fast_and_slow, 400, 5e-4);
        tested(0);
        const struct shape_found *f = found(0);
        TEST_ASSERT_EQUAL_UINT8(SHAPE_TWO_WITH_ZERO, f->kind);
        is_known(1.0, f->shape.gain, f->sd[SHAPE_GAIN], 3.0, 0.1);
        is_known(128.0, f->shape.lag_s, f->sd[SHAPE_LAG], 3.0, 0.1);
    }
}

static void an_output_of_noise_has_no_gain(void)
{
    unsigned seen = 0;
    for (unsigned seed = 0; seed < 30; seed++) {
        fresh(seed);
        bench.noise = 0.005;
        config.amplitude = REAL_C(0.05);
        config.half = 150;
        bench.element[0] = (struct test_element){0.0, 1, 0};
        tested(0);
        seen += c.model.fitted[0].flags != IDENTIFIED_NO_GAIN ||
                real_abs(c.model.fitted[0].gain) > 3 * c.model.fitted[0].gain_sd;
    }
    TEST_ASSERT_TRUE(seen <= 1);
}

static void a_dead_time_of_most_of_a_level_is_no_integrator(void)
{
    bench.noise = 0.005;
    bench.element[0] = (struct test_element){0.25, 2, 50};
    config.amplitude = REAL_C(0.2);
    config.half = 67;
    config.half_least = 60;
    tested(0);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)c.model.climbs[0]);
    TEST_ASSERT_EQUAL_HEX16(0, c.model.fitted[0].flags);
}

static void what_goes_on_climbing_is_measured(void)
{
    step_of(ramp, 200, 1e-3);
    tested(0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 1.0, (double)c.model.climbs[0]);
}

/* ---- flags ---- */

static void flags_say_of_what_kind_the_shape_is(void)
{
    static const uint16_t flags[] = {[SHAPE_UNKNOWN] = IDENTIFIED_UNKNOWN,
                                     [SHAPE_NO_RESPONSE] = IDENTIFIED_NO_GAIN,
                                     [SHAPE_ONE_LAG] = 0,
                                     [SHAPE_TWO_LAGS] = 0,
                                     [SHAPE_TWO_WITH_ZERO] = 0,
                                     [SHAPE_INTEGRATING] = IDENTIFIED_RAMP,
                                     [SHAPE_SLOW] = IDENTIFIED_SLOW};
    struct interim_fit *fits = experiment_interim_fit(&c.work->experiment);
    c.outputs.n = c.inputs.n = 1;
    for (unsigned kind = 0; kind < sizeof flags / sizeof flags[0]; kind++) {
        *interim_fit_shape(fits, 0) = lag(1.0, 0.1, 100, 20);
        interim_fit_shape(fits, 0)->kind = (uint8_t)kind;
        model_keep(&c);
        TEST_ASSERT_EQUAL_HEX16(flags[kind], c.work->element[0][0].flags);
    }
}

static void a_zero_below_0_is_inverse_in_a_shape_that_has_one(void)
{
    struct interim_fit *fits = experiment_interim_fit(&c.work->experiment);
    c.outputs.n = c.inputs.n = 1;
    for (unsigned parameters = 4; parameters < 6; parameters++)
        for (int sign = -1; sign <= 1; sign += 2) {
            struct shape_found *f = interim_fit_shape(fits, 0);
            *f = lag(1.0, 0.1, 100, 20);
            f->kind = SHAPE_SLOW;
            f->parameters = (uint8_t)parameters;
            f->shape.zero_s = (real_t)sign;
            model_keep(&c);
            unsigned inverse = parameters == 5 && sign < 0 ? IDENTIFIED_INVERSE : 0u;
            TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_SLOW | inverse, c.work->element[0][0].flags);
        }
}

static void a_longer_test_that_sees_no_response_resolves_it_and_one_as_long_does_not(void)
{
    static const struct {
        bool unsettled;
        uint32_t half, least, most;
        bool resolves;
    } tests[] = {{true, 200, 200, 250, true},
                 {false, 200, 200, 250, false}, /* of another reason than to see the end */
                 {true, 199, 200, 250, false},  /* cut by the guard */
                 {true, 200, 200, 200, false}}; /* the longest there is */
    struct experiment *x = &c.work->experiment;
    c.outputs.n = c.inputs.n = 1;
    for (unsigned n = 0; n < sizeof tests / sizeof tests[0]; n++) {
        c.work->element[0][0].found = lag(0.1, 0.1, 100, 20);
        c.work->element[0][0].found.kind = SHAPE_SLOW;
        struct shape_found *f = interim_fit_shape(experiment_interim_fit(x), 0);
        *f = lag(0.01, 0.02, 25, 0);
        f->kind = SHAPE_NO_RESPONSE;
        c.inputs.input[0].rounds = 1;
        c.inputs.input[0].unsettled = tests[n].unsettled;
        x->half = tests[n].half;
        x->config.half_least = tests[n].least;
        x->config.half_most = tests[n].most;
        model_keep(&c);
        TEST_ASSERT_EQUAL_HEX16(tests[n].resolves ? IDENTIFIED_NO_GAIN : IDENTIFIED_SLOW,
                                c.work->element[0][0].flags);
    }
}

/* ---- drift ---- */

/* A lag of 40 s, dead time 10 s, under a drift that turns once. */
static uint32_t turns_at;
static double lag_response(double t)
{
    return t > 10.0 ? 0.8 * (1.0 - exp((10.0 - t) / 40.0)) : 0.0;
}

static double under_a_drift_that_turns(unsigned j, uint32_t k)
{
    (void)j;
    return 2e-4 * k - (k > turns_at ? 4e-4 * (k - turns_at) : 0.0) + answered(lag_response, k);
}

static void a_drift_that_turns_within_the_test_spoils_no_gain(void)
{
    for (turns_at = 150; turns_at < 800; turns_at += 50) {
        fresh(turns_at);
        bench.other = under_a_drift_that_turns;
        bench.noise = 0.002;
        config.amplitude = REAL_C(0.05);
        config.half = 200;
        tested(0);
        const struct identified *e = &c.model.fitted[0];
        TEST_ASSERT_DOUBLE_WITHIN(3.5 * (double)e->gain_sd, 0.8, (double)e->gain);
        TEST_ASSERT_TRUE((double)e->gain_sd <
                         0.08); /* it would be 0.4 without a model of the turn */
        TEST_ASSERT_TRUE((double)c.model.climbs[0] < 0.5);
        /* levels on either side of a turn say nothing of the gain */
        TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)c.work->element[0][0].plateau_gain);
    }
}

static void a_turn_that_was_taken_off_makes_the_gain_no_surer_than_its_own_fit(void)
{
    turns_at = 350;
    fresh(turns_at);
    bench.other = under_a_drift_that_turns;
    bench.noise = 0.002;
    config.amplitude = REAL_C(0.05);
    config.half = 200;
    tested(0);
    const struct fopdt_fit_result *bent = &experiment_interim_fit(&c.work->experiment)->shape.bent;
    TEST_ASSERT_TRUE(bent->element.gain_sd > REAL_C(0.005));
    TEST_ASSERT_TRUE(c.model.fitted[0].gain_sd >= bent->element.gain_sd);
}

/* The response alone, without a drift. A tail that has not come to rest when the level ends looks like a turn of the drift. */
static void a_slow_tail_is_no_turn_of_the_drift(void)
{
    for (unsigned seed = 0; seed < 12; seed++) {
        fresh(seed);
        step_of(fast_and_slow, 150, seed % 3 ? 1e-3 : 1e-5);
        tested(0);
        const struct shape_found *f = found(0);
        TEST_ASSERT_EQUAL_UINT8(SHAPE_TWO_WITH_ZERO, f->kind);
        is_known(1.0, f->shape.gain, f->sd[SHAPE_GAIN], 3.5, 0.06);
    }
}

static void a_turn_that_the_shape_explains_better_is_no_doubt(void)
{
    zero_s = 120.0;
    step_of(two_lags, 300, 1e-5);
    tested(0);
    TEST_ASSERT_EQUAL_UINT8(SHAPE_TWO_WITH_ZERO, found(0)->kind);
    is_known(0.8, found(0)->shape.gain, found(0)->sd[SHAPE_GAIN], 3.0, 0.01);
}

/* ---- outputs that are not linear ---- */

/* Gain 1 at rest; for a step of 0.05 so much more of it up than down. */
static double more_up;
static double curved_lag_response(double t)
{
    return t > 5.0 ? 1.0 - exp((5.0 - t) / 30.0) : 0.0;
}

static double curved(unsigned j, uint32_t k)
{
    (void)j;
    double y = answered(curved_lag_response, k);
    return y + more_up / 0.1 * y * y;
}

static void curved_by(double share)
{
    fresh(0);
    more_up = share;
    bench.other = curved;
    config.amplitude = REAL_C(0.05);
    config.half = 300;
}

static void an_asymmetry_of_twice_the_mean_gain_is_none(void)
{
    static const double shares[] = {0.3, 1.9, 2.1, -1.9, -2.1};
    for (unsigned n = 0; n < 5; n++) {
        curved_by(shares[n]);
        tested(0);
        double wanted = fabs(more_up) < 2.0 ? 1000.0 * more_up : 0.0;
        TEST_ASSERT_DOUBLE_WITHIN(15.0, wanted, c.work->element[0][0].asymmetry);
    }
}

static void an_output_that_is_not_linear_is_doubted_by_its_third_order(void)
{
    curved_by(0.3);
    tested(0);
    TEST_ASSERT_DOUBLE_WITHIN(0.15 * 0.0225, 0.3 * 0.3 / 4.0, sqrt((double)c.model.doubt));
    TEST_ASSERT_TRUE(c.model.fitted[0].gain_sd > real_sqrt(c.model.doubt));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0, (double)found(0)->shape.gain);
}

/* Up and down differ while it dies away, but it is linear. */
static void a_slow_tail_is_no_asymmetry(void)
{
    zero_s = 300.0;
    step_of(two_lags, 200, 1e-4);
    tested(0);
    TEST_ASSERT_EQUAL_INT(0, c.work->element[0][0].asymmetry);
}

static void what_a_half_has_not_seen_of_a_response(void)
{
    static struct experiment x;
    struct identified f = {.time_constant_s = 100, .dead_time_s = 20};
    x.config.h_s = 2;
    x.half = 60;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, exp(-1.0), (double)model_unseen(&x, &f));
    f.time_constant_s = 0;
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)model_unseen(&x, &f));
    f.dead_time_s = 120;
    TEST_ASSERT_EQUAL_FLOAT(1.0f, (float)model_unseen(&x, &f));
    f.dead_time_s = 119;
    f.time_constant_s = REAL_C(0.5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, exp(-2.0), (double)model_unseen(&x, &f));
}

/* ---- into the analysis ---- */

static void inputs_that_were_skipped_are_no_columns(void)
{
    static struct config settings;
    settings.test.confidence = 0.95f;
    c.outputs.n = 2;
    c.inputs.n = 3;
    for (uint8_t j = 0; j < 2; j++)
        for (uint8_t k = 0; k < 3; k++) {
            c.work->element[j][k].found = lag(1.0 + j + 10.0 * k, 0.01, 100 + k, 5);
            c.inputs.input[k].rounds = 1;
            c.work->element[2][k].found = lag(9.0, 0.01, 9, 9); /* of no output */
        }
    c.inputs.input[1].skipped = true;
    memset(&c.work->analysis.plant, 0x55, sizeof c.work->analysis.plant); /* of a job before */
    analysis_job_begin(&c, &settings, 1);
    TEST_ASSERT_EQUAL_INT(ERR_OK, c.model.error);
    const struct interact_plant *p = &c.work->analysis.plant;
    TEST_ASSERT_EQUAL_UINT8(2, p->outputs);
    TEST_ASSERT_EQUAL_UINT8(2, p->inputs);
    TEST_ASSERT_EQUAL_UINT8(0, c.analysis_job.column[0]);
    TEST_ASSERT_EQUAL_UINT8(2, c.analysis_job.column[1]);
    TEST_ASSERT_EQUAL_FLOAT(22.0f, (float)p->element[1][1].gain);
    TEST_ASSERT_EQUAL_FLOAT(102.0f, (float)p->element[1][1].time_constant_s);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)p->element[2][0].gain);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)p->element[2][0].gain);
    TEST_ASSERT_EQUAL_FLOAT(0.005f, (float)c.analysis_job.config.floor);
    TEST_ASSERT_EQUAL_FLOAT(0.05f, (float)c.analysis_job.config.step);
    TEST_ASSERT_EQUAL_FLOAT(0.95f, (float)c.analysis_job.config.confidence);
    TEST_ASSERT_EQUAL_UINT8(CONFIG_LOOPS, c.analysis_job.config.loops_max);
    TEST_ASSERT_EQUAL_UINT16(24, c.analysis_job.config.members);
    TEST_ASSERT_EQUAL_PTR(c.outputs.noise_sd, c.analysis_job.config.noise_sd);
}

static void nothing_is_analysed_where_every_input_was_skipped(void)
{
    static struct config settings;
    settings.test.confidence = 0.95f;
    c.outputs.n = c.inputs.n = 1;
    c.inputs.input[0].skipped = true;
    analysis_job_begin(&c, &settings, 1);
    TEST_ASSERT_EQUAL_INT(ERR_EMPTY, c.analysis_job.error);
    TEST_ASSERT_FALSE(analysis_job_piece(&c));
}

/* One element, flagged, and the plant that the analysis gets. */
static const struct interact_plant *plant_of(struct shape_found f, uint16_t flags)
{
    static struct config settings;
    memset(&c, 0, sizeof c);
    commission_lease(&c);
    c.outputs.n = c.inputs.n = 1;
    c.work->element[0][0].found = f;
    c.work->element[0][0].flags = flags;
    analysis_job_begin(&c, &settings, 1);
    TEST_ASSERT_EQUAL_INT(ERR_OK, interact_check(&c.work->analysis.plant, NULL));
    return &c.work->analysis.plant;
}

static struct shape_found two_with_zero(void)
{
    struct shape_found f = lag(0.8, 0.01, 100, 10);
    f.kind = SHAPE_TWO_WITH_ZERO;
    f.parameters = 5;
    f.shape.square_s2 = 2000;
    f.shape.zero_s = -30;
    return f;
}

static void the_analysis_gets_the_whole_shape_with_its_flags(void)
{
    const struct interact_plant *p = plant_of(two_with_zero(), IDENTIFIED_INVERSE);
    TEST_ASSERT_EQUAL_FLOAT(0.8f, (float)p->element[0][0].gain);
    TEST_ASSERT_EQUAL_FLOAT(0.01f, (float)p->gain_sd[0][0]);
    TEST_ASSERT_EQUAL_FLOAT(100.0f, (float)p->element[0][0].time_constant_s);
    TEST_ASSERT_EQUAL_FLOAT(10.0f, (float)p->element[0][0].dead_time_s);
    TEST_ASSERT_EQUAL_FLOAT(2000.0f, (float)p->shape[0][0].square_s2);
    TEST_ASSERT_EQUAL_FLOAT(-30.0f, (float)p->shape[0][0].zero_s);
    TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_INVERSE, c.work->analysis.flags[0][0]);
}

/* Slope 0.01 per second behind a lag of 20 s, by a record of 30,000 s: an element of the analysis has times below 1e6 s. */
static void a_ramp_longer_than_the_analysis_takes_keeps_its_slope(void)
{
    struct shape_found f = lag(3e4, 300, 3e6, 10);
    f.kind = SHAPE_INTEGRATING;
    f.shape.square_s2 = REAL_C(3e6) * 20;
    const struct interact_plant *p = plant_of(f, IDENTIFIED_RAMP);
    TEST_ASSERT_EQUAL_FLOAT(9e5f, (float)p->element[0][0].time_constant_s);
    TEST_ASSERT_EQUAL_FLOAT(9e3f, (float)p->element[0][0].gain);
    TEST_ASSERT_EQUAL_FLOAT(90.0f, (float)p->gain_sd[0][0]);
    TEST_ASSERT_EQUAL_FLOAT(1.8e7f, (float)p->shape[0][0].square_s2);
    TEST_ASSERT_EQUAL_FLOAT(10.0f, (float)p->element[0][0].dead_time_s);
    f = lag(9e3, 90, 9e5, 10); /* no longer than that */
    p = plant_of(f, IDENTIFIED_RAMP);
    TEST_ASSERT_EQUAL_FLOAT(9e5f, (float)p->element[0][0].time_constant_s);
    TEST_ASSERT_EQUAL_FLOAT(9e3f, (float)p->element[0][0].gain);
}

/* Its gain is that of a lag of this length, and its deviation says how much may be there. */
static void an_element_without_a_response_has_its_bound_and_no_dead_time(void)
{
    struct shape_found f = {.kind = SHAPE_NO_RESPONSE, .parameters = 1, .other_parameters = 1};
    f.shape.gain = REAL_C(0.001);
    f.shape.lag_s = REAL_C(37.5);
    f.sd[SHAPE_GAIN] = REAL_C(0.01);
    const struct interact_plant *p = plant_of(f, IDENTIFIED_NO_GAIN);
    TEST_ASSERT_EQUAL_FLOAT(0.001f, (float)p->element[0][0].gain);
    TEST_ASSERT_EQUAL_FLOAT(0.01f, (float)p->gain_sd[0][0]);
    TEST_ASSERT_EQUAL_FLOAT(37.5f, (float)p->element[0][0].time_constant_s);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)p->element[0][0].dead_time_s);
}

static void draw_whole(uint16_t member, struct interact_plant *drawn)
{
    const struct analysis_config *ours = &c.analysis_job.config;
    for (uint8_t j = 0; j < c.work->analysis.plant.outputs; j++)
        ours->draw(ours->context, member, j, drawn);
}

static void the_plants_drawn_differ_as_much_as_the_element_is_unsure(void)
{
    struct shape_found f = two_with_zero();
    (void)plant_of(f, 0);
    static struct interact_plant drawn, again;
    double sum = 0, squares = 0;
    for (uint16_t member = 0; member < 400; member++) {
        draw_whole(member, &drawn);
        draw_whole(member, &again);
        TEST_ASSERT_EQUAL_MEMORY(&drawn, &again, sizeof drawn);
        TEST_ASSERT_EQUAL_INT(ERR_OK, interact_check(&drawn, NULL));
        double apart = (double)drawn.element[0][0].gain - 0.8;
        sum += apart;
        squares += apart * apart;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.0015, 0.0, sum / 400);
    TEST_ASSERT_DOUBLE_WITHIN(0.0012, 0.01, sqrt(squares / 400));
}

/* Behind a closed inner loop the plant is no longer that of the tests; the other input acts as it did. */
static void what_an_inner_loop_drives_is_not_drawn(void)
{
    static struct config settings;
    static struct interact_plant drawn;
    struct analysis *a = &c.work->analysis;
    c.outputs.n = c.inputs.n = 2;
    for (unsigned j = 0; j < 2; j++)
        for (unsigned k = 0; k < 2; k++)
            c.work->element[j][k].found = two_with_zero();
    analysis_job_begin(&c, &settings, 1);
    a->pairs.n = 1;
    a->pairs.output[0] = 0;
    a->pairs.input[0] = 1;
    a->layout.n_cascades = 1;
    a->layout.cascade[0].outer = 0;
    a->layout.cascade[0].inner = 1;
    a->layout.inner_outputs = 1u << 1;
    a->plant.element[0][1].gain = REAL_C(0.5);
    draw_whole(3, &drawn);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, (float)drawn.element[0][1].gain);
    TEST_ASSERT_EQUAL_FLOAT(0.8f, (float)drawn.element[1][1].gain);
    TEST_ASSERT_TRUE(real_abs(drawn.element[0][0].gain - REAL_C(0.8)) > REAL_C(1e-5));
    TEST_ASSERT_TRUE(real_abs(drawn.element[1][0].gain - REAL_C(0.8)) > REAL_C(1e-5));
}

int main(void)
{
    printf("seed %u\n", SEED);
    UNITY_BEGIN();
    RUN_TEST(a_test_gives_every_output_its_element);
    RUN_TEST(a_second_round_joins_the_first);
    RUN_TEST(what_a_fit_says_as_one_lag_is_the_sum_of_its_lags_with_its_flags);
    RUN_TEST(a_lag_that_a_zero_nearly_cancels_does_not_make_the_time_unsure);
    RUN_TEST(two_lags_are_found_as_two);
    RUN_TEST(a_zero_is_found_with_its_sign_and_only_the_wrong_way_is_inverse);
    RUN_TEST(a_damped_element_is_found_with_its_damping);
    RUN_TEST(a_ramp_is_found_by_its_slope_and_told_from_what_is_open);
    RUN_TEST(what_was_not_seen_to_its_end_is_slow_and_no_more_than_was_seen);
    RUN_TEST(a_step_that_was_cut_before_the_response_ends_leaves_it_open);
    RUN_TEST(what_comes_back_to_where_it_was_has_no_gain_to_build_on);
    RUN_TEST(a_fast_part_and_a_slow_tail_are_one_shape);
    RUN_TEST(an_output_of_noise_has_no_gain);
    RUN_TEST(a_dead_time_of_most_of_a_level_is_no_integrator);
    RUN_TEST(what_goes_on_climbing_is_measured);
    RUN_TEST(flags_say_of_what_kind_the_shape_is);
    RUN_TEST(a_zero_below_0_is_inverse_in_a_shape_that_has_one);
    RUN_TEST(a_longer_test_that_sees_no_response_resolves_it_and_one_as_long_does_not);
    RUN_TEST(a_drift_that_turns_within_the_test_spoils_no_gain);
    RUN_TEST(a_turn_that_was_taken_off_makes_the_gain_no_surer_than_its_own_fit);
    RUN_TEST(a_slow_tail_is_no_turn_of_the_drift);
    RUN_TEST(a_turn_that_the_shape_explains_better_is_no_doubt);
    RUN_TEST(an_asymmetry_of_twice_the_mean_gain_is_none);
    RUN_TEST(an_output_that_is_not_linear_is_doubted_by_its_third_order);
    RUN_TEST(a_slow_tail_is_no_asymmetry);
    RUN_TEST(what_a_half_has_not_seen_of_a_response);
    RUN_TEST(inputs_that_were_skipped_are_no_columns);
    RUN_TEST(nothing_is_analysed_where_every_input_was_skipped);
    RUN_TEST(the_analysis_gets_the_whole_shape_with_its_flags);
    RUN_TEST(a_ramp_longer_than_the_analysis_takes_keeps_its_slope);
    RUN_TEST(an_element_without_a_response_has_its_bound_and_no_dead_time);
    RUN_TEST(the_plants_drawn_differ_as_much_as_the_element_is_unsure);
    RUN_TEST(what_an_inner_loop_drives_is_not_drawn);
    return UNITY_END();
}
