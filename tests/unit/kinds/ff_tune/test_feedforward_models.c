/* What the kind `ff_tune` makes of responses between ticks: models of both paths, Shinskey's rule, what stands in for the search. Responses are
 * given; samples of 1 s. */
#include <complex.h>
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "kinds/ff_tune/feedforward_tune.h"
#include "kinds/ff_tune/tune_search.h"
#include "kinds/ff_tune/tune_state.h"
#include "kinds/ff_tune/tune_test.h"
#include "unity.h"

static alignas(8) char memory[sizeof(struct tune)];
static struct tune *const t = (struct tune *)(void *)memory;

void setUp(void)
{
    memset(memory, 0, sizeof memory);
    t->context.s = (struct tune_settings){.gain = 0.65f,
                                          .ti_s = 13.2f,
                                          .b = 1,
                                          .band_lo = 0.02f,
                                          .band_hi = 0.4f,
                                          .doubt = 3,
                                          .confident = 50,
                                          .kick = 10,
                                          .lag_most_s = 100,
                                          .dead_most_s = 100,
                                          .learn_s = 1000,
                                          .check_s = 80,
                                          .better = 10,
                                          .method = TUNE_JOINT,
                                          .rules = 1};
    t->context.h_s = t->context.tick_s = REAL_C(1.0);
    tune_responses_grid(&t->responses, &t->context);
}
void tearDown(void) {}

static struct high_order_point point(double complex z, double sd)
{
    return (struct high_order_point){cplx((real_t)creal(z), (real_t)cimag(z)), (real_t)sd};
}

static double complex first_order(double gain, double lag, double dead, double w)
{
    return gain * cexp(-I * w * dead) / (1 + I * w * lag);
}

/* Process and path as they are identified; sd of the ratio, part of it. */
static void see(double gain, double lag, double dead, double gain_d, double lag_d, double dead_d,
                double sd)
{
    for (unsigned i = 0; i < t->responses.band.points; i++) {
        double w = (double)t->responses.band.omega[i];
        double complex gp = first_order(gain, lag, dead, w),
                       ratio = first_order(gain_d, lag_d, dead_d, w) / gp;
        t->responses.loop[i] = point(gp, 0);
        t->responses.band.ratio[i] = point(ratio, sd * cabs(ratio));
    }
}

static bool work(void)
{
    return tune_search_piece(&t->search, &t->context, &t->responses, &t->paths, NULL, false);
}

static void sample(void)
{
    const struct tune_parts parts = tune_parts_of(t);
    tune_stages_sample(&parts);
}

static enum tune_verdict worked(void)
{
    t->search.work = WORK_RATIO;
    t->search.point = 0;
    for (unsigned k = 0; k < 2000 && t->search.work != WORK_NONE; k++) {
        t->search.pieces = 1;
        (void)work();
    }
    TEST_ASSERT_EQUAL(WORK_NONE, t->search.work);
    return (enum tune_verdict)t->search.outcome;
}

/* ---- models ---- */

static void both_paths_are_found_again(void)
{
    see(1, 8, 12.5, 0.5, 5, 8, 0);
    TEST_ASSERT_EQUAL(TUNE_NONE, worked());
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1, (double)t->paths.process.element.gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 8, (double)t->paths.process.element.time_constant_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 12.5, (double)t->paths.process.element.dead_time_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.5, (double)t->paths.rule.path.element.gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 5, (double)t->paths.rule.path.element.time_constant_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 8, (double)t->paths.rule.path.element.dead_time_s);
    TEST_ASSERT_EQUAL(33, t->paths.rule.number);
    TEST_ASSERT_FALSE(t->search.by_rule);
    TEST_ASSERT_TRUE(t->search.search.j <= t->paths.rule.j);
}

static void a_process_is_late_by_half_a_sample_whatever_its_response_says(void)
{
    see(1, 8, 0, 0.5, 5, 8, 0);
    TEST_ASSERT_EQUAL(TUNE_NONE, worked());
    TEST_ASSERT_TRUE(t->paths.process.element.dead_time_s >= REAL_C(0.5));
}

static void a_gain_of_the_other_sign_is_no_model(void)
{
    see(-1, 8, 12.5, 0.5, 5, 8, 0);
    TEST_ASSERT_EQUAL(TUNE_NO_MODEL, worked());
    TEST_ASSERT_FALSE(t->paths.rule.valid);
}

/* Every other frequency the other way round. */
static void see_no_first_order_process(void)
{
    see(1, 8, 12.5, 0.5, 5, 8, 0);
    for (unsigned i = 0; i < t->responses.band.points; i += 2)
        t->responses.loop[i].value = cplx_scale(t->responses.loop[i].value, -1);
}

static void what_is_not_of_first_order_is_no_model(void)
{
    see_no_first_order_process();
    TEST_ASSERT_EQUAL(TUNE_NO_MODEL, worked());
}

static void a_path_that_is_not_of_first_order_has_no_rule_and_not_that_of_before(void)
{
    see(1, 8, 12.5, 0.5, 5, 8, 0);
    (void)worked();
    TEST_ASSERT_TRUE(t->paths.rule.valid);
    for (unsigned i = 0; i < t->responses.band.points; i += 2)
        t->responses.band.ratio[i].value = cplx_scale(t->responses.band.ratio[i].value, -1);
    TEST_ASSERT_EQUAL(TUNE_NONE, worked());
    TEST_ASSERT_FALSE(t->paths.rule.valid);
}

/* ---- the rule ---- */

/* III b: lead and lag 10 to 1, whatever the element may. */
static void a_rule_is_what_the_element_may_be(void)
{
    static const float kicks[] = {1, 1.5f, 3, 10};
    for (unsigned k = 0; k < sizeof kicks / sizeof kicks[0]; k++)
        for (unsigned most = 0; most < 3; most++) {
            t->context.s.kick = kicks[k];
            t->context.s.lag_most_s = most == 0 ? 0 : most == 1 ? 2 : 100;
            see(1, 8, 20, 0.5, 8, 4, 0);
            TEST_ASSERT_EQUAL(TUNE_NONE, worked());
            const struct feedforward_shape *f = &t->paths.rule.shape;
            TEST_ASSERT_EQUAL(32, t->paths.rule.number);
            TEST_ASSERT_TRUE(f->lag >= 0 && f->lag <= t->context.s.lag_most_s);
            TEST_ASSERT_TRUE(f->lead >= 0);
            TEST_ASSERT_TRUE((f->lead + 1) <= REAL_C(1.0001) * t->context.s.kick * (f->lag + 1));
        }
}

static void a_lag_is_made_longer_before_a_lead_is_cut(void)
{
    t->context.s.kick = 3;
    see(1, 8, 20, 0.5, 8, 4, 0);
    (void)worked();
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 1.1 * 16, (double)t->paths.rule.shape.lead);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, (1.1 * 16 + 1) / 3 - 1, (double)t->paths.rule.shape.lag);
}

/* II b. */
static void a_disturbance_that_comes_late_is_waited_for_where_that_is_allowed(void)
{
    see(1, 8, 12, 0.5, 8, 20, 0);
    (void)worked();
    TEST_ASSERT_EQUAL(22, t->paths.rule.number);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 8, (double)t->paths.rule.shape.dead);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 8, (double)t->paths.rule.shape.lead);
    t->context.s.dead_most_s = 0;
    (void)worked();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, (double)t->paths.rule.shape.dead);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0,
                              (double)t->paths.rule.shape.lead); /* Shinskey's is below 0 */
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 4, (double)t->paths.rule.shape.lag);
}

/* ---- in place of the search ---- */

static void where_the_ratio_is_in_doubt_the_rule_is_the_candidate(void)
{
    see(1, 8, 12.5, 0.5, 5, 8, 0.25); /* 3 times that is more than confident, less than all of it */
    TEST_ASSERT_EQUAL(TUNE_NONE, worked());
    TEST_ASSERT_TRUE(t->search.by_rule);
    TEST_ASSERT_EQUAL_MEMORY(&t->paths.rule.shape, &t->search.candidate,
                             sizeof t->search.candidate);
}

static void where_rules_only_compare_it_is_unsure_and_tells_both(void)
{
    t->context.s.rules = 0;
    see(1, 8, 12.5, 0.5, 5, 8, 0.25);
    TEST_ASSERT_EQUAL(TUNE_UNSURE, worked());
    TEST_ASSERT_FALSE(t->search.by_rule);
    TEST_ASSERT_TRUE(t->search.search.j0 > 0 && t->search.search.j < t->search.search.j0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)t->paths.rule.j, (double)t->search.search.j);
}

static void a_rule_that_is_worse_than_nothing_is_not_taken(void)
{
    t->paths.rule.valid = true;
    t->paths.rule.j = 2;
    t->search.search.j0 = 3;
    TEST_ASSERT_TRUE(tune_search_falls_back(&t->search, &t->context, &t->paths.rule));
    t->search.search.j0 = 2;
    TEST_ASSERT_FALSE(tune_search_falls_back(&t->search, &t->context, &t->paths.rule));
}

/* A test that is over, and lost, with a rule at hand. */
static void lost_test(void)
{
    t->stages.stage = TUNE_TESTS;
    t->paths.rule.valid = true;
    t->paths.rule.shape = (struct feedforward_shape){.k = REAL_C(-0.5), .lead = 3, .lag = 2};
    t->search.search.j0 = 1;
    tune_candidate_begin(&t->shadows, &t->context, 0);
    tune_test_begin(&t->test, &t->context);
    t->test.parts = TUNE_PARTS;
    t->test.all.actual = t->test.all.with_candidate = t->test.all.no_feedforward = 1;
}

static void where_the_candidate_is_no_better_the_rule_is_tested_from_the_beginning(void)
{
    lost_test();
    sample();
    TEST_ASSERT_EQUAL(TUNE_TESTS, t->stages.stage);
    TEST_ASSERT_TRUE(t->search.by_rule);
    TEST_ASSERT_EQUAL(0, t->test.parts);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, (double)t->test.all.actual);
    t->test.parts = TUNE_PARTS; /* no better either */
    t->test.all.actual = t->test.all.with_candidate = t->test.all.no_feedforward = 1;
    sample();
    TEST_ASSERT_EQUAL(TUNE_IDLE, t->stages.stage);
    TEST_ASSERT_EQUAL(TUNE_NO_BETTER, t->stages.verdict);
}

/* ---- pieces ---- */

static void between_two_steps_it_works_as_many_pieces_as_the_step_has_given(void)
{
    see(1, 8, 12.5, 0.5, 5, 8, 0);
    for (unsigned given = 1; given <= 5; given++) {
        unsigned pieces = 1;
        t->search.work = WORK_RATIO;
        t->search.pieces = (uint16_t)given;
        while (work())
            TEST_ASSERT_TRUE(++pieces <= given);
        TEST_ASSERT_EQUAL_UINT(given, pieces);
        TEST_ASSERT_NOT_EQUAL(WORK_NONE, t->search.work);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(both_paths_are_found_again);
    RUN_TEST(a_process_is_late_by_half_a_sample_whatever_its_response_says);
    RUN_TEST(a_gain_of_the_other_sign_is_no_model);
    RUN_TEST(what_is_not_of_first_order_is_no_model);
    RUN_TEST(a_path_that_is_not_of_first_order_has_no_rule_and_not_that_of_before);
    RUN_TEST(a_rule_is_what_the_element_may_be);
    RUN_TEST(a_lag_is_made_longer_before_a_lead_is_cut);
    RUN_TEST(a_disturbance_that_comes_late_is_waited_for_where_that_is_allowed);
    RUN_TEST(where_the_ratio_is_in_doubt_the_rule_is_the_candidate);
    RUN_TEST(where_rules_only_compare_it_is_unsure_and_tells_both);
    RUN_TEST(a_rule_that_is_worse_than_nothing_is_not_taken);
    RUN_TEST(where_the_candidate_is_no_better_the_rule_is_tested_from_the_beginning);
    RUN_TEST(between_two_steps_it_works_as_many_pieces_as_the_step_has_given);
    return UNITY_END();
}
