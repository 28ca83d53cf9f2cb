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

static struct identified element(double gain, double sd, double lag, double dead)
{
    return (struct identified){.gain = (real_t)gain,
                               .gain_sd = (real_t)sd,
                               .time_constant_s = (real_t)lag,
                               .time_constant_sd_s = (real_t)(0.1 * lag),
                               .dead_time_s = (real_t)dead,
                               .dead_time_sd_s = (real_t)(0.1 * dead)};
}

/* ---- several tests of one element ---- */

static void two_tests_count_by_how_well_they_know(void)
{
    struct identified sum = element(1.0, 0.1, 100, 20), next = element(1.2, 0.2, 130, 26);
    next.time_constant_sd_s = 20;
    next.dead_time_sd_s = 4;
    model_combine(&sum, &next);
    /* weights 100 and 25 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, (100 * 1.0 + 25 * 1.2) / 125, (double)sum.gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, sqrt(1.0 / 125), (double)sum.gain_sd);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (100 * 4 + 130) / 5.0, (double)sum.time_constant_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (20 * 4 + 26) / 5.0, (double)sum.dead_time_s);
}

static void tests_that_disagree_are_less_sure_than_they_say(void)
{
    struct identified sum = element(1.0, 0.1, 100, 20), next = element(1.6, 0.1, 100, 20);
    model_combine(&sum, &next);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.3, (double)sum.gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.3, (double)sum.gain_sd); /* Birge: by what they differ */
}

static void more_tests_make_an_element_surer_and_their_order_does_not_matter(void)
{
    struct identified tests[4], sum[2];
    struct random_source r = {SEED};
    for (int i = 0; i < 4; i++)
        tests[i] = element(1.0 + 0.02 * normal(&r), 0.05 + 0.02 * i, 100 + 5 * normal(&r), 20);
    for (int order = 0; order < 2; order++) {
        sum[order] = tests[order ? 3 : 0];
        for (int i = 1; i < 4; i++) {
            double before = (double)sum[order].gain_sd;
            model_combine(&sum[order], &tests[order ? 3 - i : i]);
            TEST_ASSERT_TRUE((double)sum[order].gain_sd < before);
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)sum[0].gain, (double)sum[1].gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)sum[0].time_constant_s, (double)sum[1].time_constant_s);
}

static void a_test_that_saw_no_gain_brings_no_times(void)
{
    struct identified sum = element(1.0, 0.1, 100, 20), none = element(0.05, 0.3, 0, 0);
    none.flags = IDENTIFIED_NO_GAIN;
    model_combine(&sum, &none);
    TEST_ASSERT_EQUAL_FLOAT(100.0f, (float)sum.time_constant_s);
    TEST_ASSERT_EQUAL_FLOAT(20.0f, (float)sum.dead_time_s);
    TEST_ASSERT_TRUE(sum.gain < 1 && sum.gain > REAL_C(0.85));
    TEST_ASSERT_FALSE(sum.flags & IDENTIFIED_NO_GAIN);
}

static void times_come_from_the_test_that_first_saw_a_gain(void)
{
    struct identified sum = element(0.05, 0.3, 0, 0), next = element(1.0, 0.05, 100, 20);
    sum.flags = IDENTIFIED_NO_GAIN;
    model_combine(&sum, &next);
    TEST_ASSERT_EQUAL_FLOAT(100.0f, (float)sum.time_constant_s);
    TEST_ASSERT_EQUAL_FLOAT(20.0f, (float)sum.dead_time_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.975, (double)sum.gain);
    TEST_ASSERT_FALSE(sum.flags & IDENTIFIED_NO_GAIN);
}

static void two_tests_that_saw_nothing_still_see_nothing(void)
{
    struct identified sum = element(0.01, 0.3, 0, 0), next = element(-0.02, 0.2, 0, 0);
    sum.flags = next.flags = IDENTIFIED_NO_GAIN;
    model_combine(&sum, &next);
    TEST_ASSERT_TRUE(sum.flags & IDENTIFIED_NO_GAIN);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)sum.time_constant_s);
}

static void a_deviation_of_nothing_does_not_divide_by_it(void)
{
    struct identified sum = element(1.0, 0.0, 100, 0), next = element(1.0, 0.0, 100, 0);
    sum.time_constant_sd_s = next.time_constant_sd_s = 0;
    model_combine(&sum, &next);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, (float)sum.gain);
    TEST_ASSERT_EQUAL_FLOAT(100.0f, (float)sum.time_constant_s);
    TEST_ASSERT_TRUE(real_is_finite(sum.gain_sd) && real_is_finite(sum.dead_time_s));
    memset(&sum, 0, sizeof sum);
    memset(&next, 0, sizeof next);
    model_combine(&sum, &next);
    TEST_ASSERT_TRUE(real_is_finite(sum.gain) && real_is_finite(sum.gain_sd));
}

/* ---- from a test ---- */

/* Input k of a plant of two inputs has just been tested on the bench. */
static void tested(uint8_t k)
{
    bench_run();
    TEST_ASSERT_EQUAL_INT(EXPERIMENT_DONE, experiment.phase);
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
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(is->gain), is->gain, (double)e->fit.gain);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * (is->lag + is->dead), is->lag,
                                  (double)e->fit.time_constant_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * (is->lag + is->dead), is->dead,
                                  (double)e->fit.dead_time_s);
        /* second opinions on the same test */
        TEST_ASSERT_DOUBLE_WITHIN(0.03 * fabs(is->gain), is->gain, (double)e->moments.gain);
        if (real_abs(e->plateau_gain) > 0) /* where the levels were long enough */
            TEST_ASSERT_DOUBLE_WITHIN(0.03 * fabs(is->gain), is->gain, (double)e->plateau_gain);
    }
    TEST_ASSERT_TRUE(c.work->element[2][1].fit.flags & IDENTIFIED_NO_GAIN);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)c.work->element[0][0].fit.gain); /* the other input's */
}

static void a_second_round_joins_the_first(void)
{
    bench.noise = 0.002;
    bench.element[0] = (struct test_element){0.8, 40, 10};
    config.amplitude = REAL_C(0.03);
    tested(0);
    model_keep(&c);
    c.inputs.input[0].rounds = 1;
    double sd = (double)c.work->element[0][0].fit.gain_sd;
    real_t first = c.work->element[0][0].fit.gain;
    bench.k = bench.edges = 0;
    tested(0);
    model_keep(&c);
    TEST_ASSERT_TRUE((double)c.work->element[0][0].fit.gain_sd < sd);
    TEST_ASSERT_TRUE(c.work->element[0][0].fit.gain >
                     first); /* towards the second, which is higher */
    TEST_ASSERT_DOUBLE_WITHIN(0.08, 0.8, (double)c.work->element[0][0].fit.gain);
}

/* Goes up at once and dies away again: no lag fits that. */
static double washed_out(unsigned j, uint32_t k)
{
    double y = 0.0;
    for (unsigned i = 0; i < bench.edges; i++)
        if (k > bench.edge[i])
            y += 2.0 * bench.change[i] * exp(-(k - bench.edge[i] - 1.0) / 12.0);
    (void)j;
    return y;
}

static void what_is_no_lag_is_not_believed_to_be_one(void)
{
    bench.other = washed_out;
    config.amplitude = REAL_C(0.02);
    config.half = 80;
    tested(0);
    const struct identified *e = &c.model.fitted[0];
    /* nothing there, or a gain that is no surer than its own size */
    TEST_ASSERT_TRUE((e->flags & IDENTIFIED_NO_GAIN) ||
                     e->gain_sd > REAL_C(0.3) * real_abs(e->gain));
    TEST_ASSERT_TRUE(real_is_finite(e->gain) && real_is_finite(e->gain_sd));
}

/* A lag of 40, dead time 10, under a drift that turns once. */
static uint32_t turns_at;
static double under_a_drift_that_turns(unsigned j, uint32_t k)
{
    const struct test_element e = {0.8, 40, 10};
    double y = 2e-4 * k - (k > turns_at ? 4e-4 * (k - turns_at) : 0.0);
    for (unsigned i = 0; i < bench.edges; i++)
        y += bench.change[i] * step_response(&e, k - bench.edge[i]);
    (void)j;
    return y;
}

static void a_drift_that_turns_within_the_test_spoils_no_gain(void)
{
    for (turns_at = 150; turns_at < 800; turns_at += 50) {
        bench_begin(SEED + turns_at);
        memset(&c, 0, sizeof c);
        commission_lease(&c);
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

/* Two lags, one of them slow: no first-order model is that. */
static double fast_and_slow(unsigned j, uint32_t k)
{
    const struct test_element fast = {0.5, 8, 0}, slow = {0.5, 120, 0};
    double y = 0.0;
    for (unsigned i = 0; i < bench.edges; i++)
        y += bench.change[i] *
             (step_response(&fast, k - bench.edge[i]) + step_response(&slow, k - bench.edge[i]));
    (void)j;
    return y;
}

static void a_response_of_another_shape_is_doubted_in_every_round(void)
{
    bench.other = fast_and_slow;
    config.amplitude = REAL_C(0.05);
    config.half = 400;
    tested(0);
    double misfit = (double)c.model.misfit[0];
    TEST_ASSERT_TRUE(misfit > 0.005);
    for (uint8_t round = 0; round < 8; round++) {
        model_keep(&c);
        c.inputs.input[0].rounds = (uint8_t)(round + 1u);
        TEST_ASSERT_TRUE((double)c.work->element[0][0].fit.gain_sd >= misfit);
    }
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * misfit, 1.0, (double)c.work->element[0][0].fit.gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.06, 1.0,
                              (double)c.work->element[0][0].fit.gain); /* of the levels */
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
}

static void an_output_of_noise_has_no_gain(void)
{
    unsigned seen = 0;
    for (unsigned seed = 0; seed < 30; seed++) {
        bench_begin(SEED + seed);
        memset(&c, 0, sizeof c);
        commission_lease(&c);
        bench.noise = 0.005;
        config.amplitude = REAL_C(0.05);
        config.half = 150;
        bench.element[0] = (struct test_element){0.0, 1, 0};
        tested(0);
        seen += !(c.model.fitted[0].flags & IDENTIFIED_NO_GAIN) &&
                real_abs(c.model.fitted[0].gain) > 4 * c.model.fitted[0].gain_sd;
    }
    TEST_ASSERT_TRUE(seen <= 1);
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
            c.work->element[j][k].fit = element(1.0 + j + 10.0 * k, 0.01, 100 + k, 5);
            c.inputs.input[k].rounds = 1;
            c.work->element[2][k].fit = element(9.0, 0.01, 9, 9); /* of no output */
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
    TEST_ASSERT_EQUAL_FLOAT(0.005f, (float)c.analysis_job.config.floor);
    TEST_ASSERT_EQUAL_FLOAT(0.05f, (float)c.analysis_job.config.step);
    TEST_ASSERT_EQUAL_FLOAT(0.95f, (float)c.analysis_job.config.confidence);
    TEST_ASSERT_EQUAL_UINT8(CONFIG_LOOPS, c.analysis_job.config.loops_max);
    TEST_ASSERT_EQUAL_PTR(c.outputs.noise_sd, c.analysis_job.config.noise_sd);
}

/* ---- the beginning of a response ---- */

static void begins(double slope, double dead, double gain)
{
    static struct config settings;
    memset(&c, 0, sizeof c);
    commission_lease(&c);
    c.outputs.n = c.inputs.n = 1;
    c.work->element[0][0].fit = element(gain, 0.01, 100, 10);
    c.work->element[0][0].early_slope = (real_t)slope;
    c.work->element[0][0].early_dead_s = (real_t)dead;
    analysis_job_begin(&c, &settings, 1);
}

static void what_is_known_of_the_beginning_goes_into_the_analysis(void)
{
    const struct analysis *a = &c.work->analysis;
    const struct fopdt *whole = &a->plant.element[0][0];
    for (int sign = -1; sign <= 1; sign += 2) {
        begins(0.02, 6, sign * 0.8);
        TEST_ASSERT_EQUAL_FLOAT(40.0f, (float)a->beginning[0][0].time_constant_s);
        TEST_ASSERT_EQUAL_FLOAT(6.0f, (float)a->beginning[0][0].dead_time_s);
        TEST_ASSERT_EQUAL_FLOAT(6.0f, (float)whole->dead_time_s); /* and takes as long */
        TEST_ASSERT_EQUAL_FLOAT(104.0f, (float)whole->time_constant_s);
    }
    begins(0.02, 12, 0.8);
    TEST_ASSERT_EQUAL_FLOAT(12.0f, (float)a->beginning[0][0].dead_time_s);
    TEST_ASSERT_EQUAL_FLOAT(10.0f, (float)whole->dead_time_s);
    TEST_ASSERT_EQUAL_FLOAT(100.0f, (float)whole->time_constant_s);
    begins(0, 6, 0.8);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)a->beginning[0][0].time_constant_s);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)a->beginning[0][0].dead_time_s);
    TEST_ASSERT_EQUAL_FLOAT(10.0f, (float)whole->dead_time_s);
    begins(0.02, 6, 0);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)a->beginning[0][0].dead_time_s);
}

/* The fit of what the bench has just done, with another word of the look that came in time. */
static void with_a_look(double slope, double dead, double dead_sd)
{
    memset(&c, 0, sizeof c);
    commission_lease(&c);
    c.outputs.n = c.inputs.n = 1;
    c.work->experiment = experiment;
    c.work->experiment.early[0].slope = (real_t)slope;
    c.work->experiment.early[0].dead_s = (real_t)dead;
    c.work->experiment.early[0].dead_sd_s = (real_t)dead_sd;
    model_begin_fit(&c);
    while (model_piece(&c))
        ;
}

static void a_beginning_is_taken_where_it_is_steeper_and_its_dead_time_twice_as_sure(void)
{
    bench.other = fast_and_slow;
    config.amplitude = REAL_C(0.05);
    config.half = 400;
    tested(0);
    double sd = (double)c.model.fitted[0].dead_time_sd_s;
    double slope = fabs((double)c.model.fitted[0].gain / (double)c.model.fitted[0].time_constant_s);
    const struct element *e = &c.work->element[0][0];
    with_a_look(1.01 * slope, 3, 0.49 * sd);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.01 * slope, (double)e->early_slope);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 3 + 0.49 * sd, (double)e->early_dead_s);
    with_a_look(0.99 * slope, 3, 0.49 * sd);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)e->early_slope);
    with_a_look(1.01 * slope, 3, 0.51 * sd);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)e->early_slope);
}

/* Gain 1 at rest; for a step of 0.05 so much more of it up than down. */
static double more_up;
static double curved(unsigned j, uint32_t k)
{
    const struct test_element e = {1.0, 30, 5};
    double y = 0.0;
    for (unsigned i = 0; i < bench.edges; i++)
        y += bench.change[i] * step_response(&e, k - bench.edge[i]);
    (void)j;
    return y + more_up / 0.1 * y * y;
}

static void an_asymmetry_of_twice_the_mean_gain_is_none(void)
{
    static const double shares[] = {0.3, 1.9, 2.1, -1.9, -2.1};
    for (unsigned n = 0; n < 5; n++) {
        bench_begin(SEED);
        memset(&c, 0, sizeof c);
        commission_lease(&c);
        bench.other = curved;
        more_up = shares[n];
        config.amplitude = REAL_C(0.05);
        config.half = 300;
        tested(0);
        double wanted = fabs(more_up) < 2.0 ? 1000.0 * more_up : 0.0;
        TEST_ASSERT_DOUBLE_WITHIN(15.0, wanted, c.work->element[0][0].asymmetry);
    }
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

static void misfits_of_several_rounds_count_by_how_well_each_knows_the_gain(void)
{
    c.outputs.n = c.inputs.n = 2;
    c.model.fitted[1] = element(1.0, 0.1, 100, 20);
    c.model.misfit[1] = REAL_C(0.04);
    c.model.misfit[2] = 9;
    model_keep(&c);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.04, (double)c.work->element[1][0].misfit);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, (double)c.work->element[1][0].fit.gain_sd);
    c.inputs.input[0].rounds = 1;
    c.model.fitted[1].gain_sd = REAL_C(0.2); /* weights 100 and 25 */
    c.model.misfit[1] = REAL_C(0.09);
    model_keep(&c);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.05, (double)c.work->element[1][0].misfit);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, sqrt(1.0 / 125.0), (double)c.work->element[1][0].fit.gain_sd);
    c.model.misfit[1] = REAL_C(0.9);
    model_keep(&c); /* of 0.05 by 125 and 0.9 by 25 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 115.0 / 600.0, (double)c.work->element[1][0].misfit);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 115.0 / 600.0, (double)c.work->element[1][0].fit.gain_sd);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)c.work->element[2][0].misfit);
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

static void a_later_test_resolves_what_an_earlier_one_left_open_but_no_oscillation(void)
{
    const unsigned open = IDENTIFIED_SHORT | IDENTIFIED_NOT_SETTLED | IDENTIFIED_INTEGRATING;
    const unsigned stays = IDENTIFIED_OSCILLATORY | IDENTIFIED_INVERSE;
    const unsigned later[] = {0, IDENTIFIED_NOT_SETTLED, IDENTIFIED_NO_GAIN};
    const unsigned wanted[] = {stays, stays | IDENTIFIED_NOT_SETTLED, stays | open};
    for (unsigned n = 0; n < 3; n++) {
        struct identified sum = {.gain = 1, .gain_sd = REAL_C(0.1)}, next = sum;
        sum.flags = (uint16_t)(open | stays);
        next.flags = (uint16_t)later[n];
        model_combine(&sum, &next);
        TEST_ASSERT_EQUAL_HEX16(wanted[n], sum.flags);
    }
}

static void a_longer_test_that_sees_no_response_resolves_it_and_one_as_long_does_not(void)
{
    static const struct {
        bool unsettled;
        uint32_t half, least, most;
        bool resolves;
    } cases[] = {{true, 200, 200, 250, true},
                 {false, 200, 200, 250, false}, /* of another reason than to see the end */
                 {true, 199, 200, 250, false},  /* cut by the guard */
                 {true, 200, 200, 200, false}}; /* the longest there is */
    struct experiment *x = &c.work->experiment;
    c.outputs.n = c.inputs.n = 1;
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        c.work->element[0][0].fit = element(0.1, 0.1, 100, 20);
        c.work->element[0][0].fit.flags = IDENTIFIED_SHORT | IDENTIFIED_OSCILLATORY;
        c.model.fitted[0] = element(0.01, 0.02, 0, 0);
        c.model.fitted[0].flags = IDENTIFIED_NO_GAIN;
        c.inputs.input[0].rounds = 1;
        c.inputs.input[0].unsettled = cases[n].unsettled;
        x->half = cases[n].half;
        x->config.half_least = cases[n].least;
        x->config.half_most = cases[n].most;
        model_keep(&c);
        TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_OSCILLATORY |
                                    (cases[n].resolves ? 0u : (unsigned)IDENTIFIED_SHORT),
                                c.work->element[0][0].fit.flags);
    }
}

int main(void)
{
    printf("seed %u\n", SEED);
    UNITY_BEGIN();
    RUN_TEST(a_later_test_resolves_what_an_earlier_one_left_open_but_no_oscillation);
    RUN_TEST(a_longer_test_that_sees_no_response_resolves_it_and_one_as_long_does_not);
    RUN_TEST(two_tests_count_by_how_well_they_know);
    RUN_TEST(tests_that_disagree_are_less_sure_than_they_say);
    RUN_TEST(more_tests_make_an_element_surer_and_their_order_does_not_matter);
    RUN_TEST(a_test_that_saw_no_gain_brings_no_times);
    RUN_TEST(times_come_from_the_test_that_first_saw_a_gain);
    RUN_TEST(two_tests_that_saw_nothing_still_see_nothing);
    RUN_TEST(a_deviation_of_nothing_does_not_divide_by_it);
    RUN_TEST(a_test_gives_every_output_its_element);
    RUN_TEST(a_second_round_joins_the_first);
    RUN_TEST(what_is_no_lag_is_not_believed_to_be_one);
    RUN_TEST(a_drift_that_turns_within_the_test_spoils_no_gain);
    RUN_TEST(a_response_of_another_shape_is_doubted_in_every_round);
    RUN_TEST(a_dead_time_of_most_of_a_level_is_no_integrator);
    RUN_TEST(an_output_of_noise_has_no_gain);
    RUN_TEST(inputs_that_were_skipped_are_no_columns);
    RUN_TEST(what_is_known_of_the_beginning_goes_into_the_analysis);
    RUN_TEST(a_beginning_is_taken_where_it_is_steeper_and_its_dead_time_twice_as_sure);
    RUN_TEST(an_asymmetry_of_twice_the_mean_gain_is_none);
    RUN_TEST(what_a_half_has_not_seen_of_a_response);
    RUN_TEST(misfits_of_several_rounds_count_by_how_well_each_knows_the_gain);
    RUN_TEST(nothing_is_analysed_where_every_input_was_skipped);
    return UNITY_END();
}
