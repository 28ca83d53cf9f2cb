/* commission/analysis.c: what is made of settings and predictions that are there, on either side of each bound: how long a step is
 * predicted for, which of two designs is taken, which settings a loop takes. The predictions are made up. */
#include <math.h>
#include <string.h>

#include "commission/analysis.h"
#include "commission/analysis_structure.h"
#include "unity.h"

static struct analysis a;

#define NEAR(wanted, value)                                                                        \
    TEST_ASSERT_DOUBLE_WITHIN(2e-6 * (1.0 + fabs((double)(wanted))), wanted, (double)(value))

/* Two loops beside each other, designed; that of pair 0 is under prediction, of 100 s. */
void setUp(void)
{
    memset(&a, 0, sizeof a);
    a.plant.outputs = a.plant.inputs = 2;
    a.pairs.n = 2;
    a.pairs.output[1] = a.pairs.input[1] = 1;
    for (unsigned k = 0; k < 2; k++) {
        a.plant.element[k][k] =
            (struct fopdt){.gain = 1, .time_constant_s = 100, .dead_time_s = (real_t)(10 + k)};
        a.loops.tuning[k] = (struct tuning){.gain = 1, .ti_s = 100, .action = TUNING_REVERSE};
    }
    a.loops.pairs = a.pairs;
    a.loops.interval_s = 1;
    a.loops.derivative_filter = 8;
    a.config = (struct analysis_config){.h_s = 1, .step = REAL_C(0.05), .loops_max = 8};
    a.decoupler = DECOUPLER_NOT_NEEDED;
    a.stage = ANALYSIS_PREDICTION;
    a.bounded = true;
    a.horizon_s = 50;
}
void tearDown(void) {}

/* The prediction under way has come to its end like this. */
static void predicted(double settled_s, double duration_s, bool bounded)
{
    struct trial *t = &a.work.trial;
    memset(t, 0, sizeof *t);
    t->plant = &a.plant;
    t->loops = &a.loops;
    t->bounded = bounded;
    t->duration_s = (real_t)duration_s;
    for (unsigned k = 0; k < 2; k++)
        t->loop[k] =
            (struct trial_loop){.iae = (real_t)(0.05 * (k + 1)), .settled_s = (real_t)settled_s};
    t->mark.left = REAL_C(0.125);
}

static void a_step_that_has_not_settled_is_predicted_four_times_as_long_twice(void)
{
    predicted(94, 100, true); /* of 95 */
    TEST_ASSERT_EQUAL_INT(ERR_BUSY, analysis_step(&a));
    TEST_ASSERT_EQUAL_UINT8(1, a.turn);
    TEST_ASSERT_EQUAL_UINT8(0, a.extended);
    NEAR(94.0, a.predicted[0].settled_s);
    NEAR(0.125, a.tried[0].left);
    NEAR(50.0, a.work.trial.config.mark_s);
    NEAR(15.0 * 111.0, a.work.trial.duration_s); /* its own time again */
    TEST_ASSERT_EQUAL_UINT8(1, a.work.trial.config.loop);
    NEAR(0.05, a.work.trial.config.size);
    NEAR(1.0, a.work.trial.config.setpoint_weight);
    for (uint8_t extended = 0; extended < 3; extended++) {
        setUp();
        a.extended = extended;
        predicted(96, 100, true);
        TEST_ASSERT_EQUAL_INT(ERR_BUSY, analysis_step(&a));
        TEST_ASSERT_EQUAL_UINT8(extended == 2, a.turn);
        NEAR(extended == 0 ? 0.125 : 0.0, a.tried[0].left); /* of the first, which is the finest */
        if (extended < 2) {
            TEST_ASSERT_EQUAL_UINT8(extended + 1, a.extended);
            NEAR(400.0, a.work.trial.duration_s);
        }
    }
    setUp();
    predicted(9.9e6, 1e7, true); /* no longer than that */
    TEST_ASSERT_EQUAL_INT(ERR_BUSY, analysis_step(&a));
    TEST_ASSERT_EQUAL_UINT8(1, a.turn);
    setUp();
    predicted(4e6, 4e6, true);
    TEST_ASSERT_EQUAL_INT(ERR_BUSY, analysis_step(&a));
    NEAR(1e7, a.work.trial.duration_s);
    setUp();
    predicted(100, 100, false); /* nor what runs away */
    TEST_ASSERT_EQUAL_INT(ERR_BUSY, analysis_step(&a));
    TEST_ASSERT_EQUAL_UINT8(1, a.turn);
    TEST_ASSERT_FALSE(a.bounded);
}

/* The last step, and the relative gains of the two pairs after it, in some pieces each. */
static void ends(void)
{
    enum err err = analysis_step(&a);
    for (unsigned k = 0; k < 40 && err == ERR_BUSY; k++)
        err = analysis_step(&a);
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_EQUAL_INT(ANALYSIS_DONE, a.stage);
}

static void every_loop_is_predicted_and_all_must_be_bounded(void)
{
    for (unsigned bounded = 0; bounded < 2; bounded++) {
        setUp();
        a.turn = 1;
        predicted(50, 100, bounded != 0);
        TEST_ASSERT_EQUAL_INT(ERR_BUSY, analysis_step(&a));
        TEST_ASSERT_EQUAL_INT(ANALYSIS_ALTERNATIVE, a.stage);
        TEST_ASSERT_EQUAL(bounded, a.designed);
        TEST_ASSERT_EQUAL_INT(bounded ? ERR_OK : ERR_RANGE, a.design_error);
        ends();
    }
}

static void with_a_decoupler_in_view_loads_are_predicted_too_and_all_is_counted(void)
{
    for (unsigned without = 0; without < 2; without++) {
        setUp();
        a.compares = true;
        a.decoupler = without ? DECOUPLER_NO_BETTER : DECOUPLER_USED;
        predicted(50, 100, true);
        TEST_ASSERT_EQUAL_INT(ERR_BUSY, analysis_step(&a));
        TEST_ASSERT_TRUE(a.load);
        TEST_ASSERT_TRUE(a.work.trial.config.load);
        TEST_ASSERT_EQUAL_UINT8(0, a.turn);
        NEAR(100.0, a.work.trial.duration_s);    /* for as long */
        NEAR(1.5, a.figures[without].setpoints); /* 0.05 and 0.1 over the step, and the mean */
        NEAR(0.0, a.figures[without].loads);
        predicted(50, 100, true);
        TEST_ASSERT_EQUAL_INT(ERR_BUSY, analysis_step(&a));
        TEST_ASSERT_FALSE(a.load);
        TEST_ASSERT_EQUAL_UINT8(1, a.turn);
        NEAR(1.5, a.figures[without].loads);
        NEAR(1.5, a.figures[without].setpoints);
        NEAR(0.0, a.figures[!without].loads);
        NEAR(1665.0, a.work.trial.duration_s);
        a.turn = 1;
        a.load = true;
        predicted(50, 100, false);
        TEST_ASSERT_EQUAL_INT(ERR_BUSY, analysis_step(&a));
        TEST_ASSERT_EQUAL_INT(ANALYSIS_ALTERNATIVE, a.stage);
        TEST_ASSERT_FALSE(a.designed);
        TEST_ASSERT_EQUAL_INT(ERR_RANGE, a.design_error);
    }
}

/* The design without a decoupler is there; the one with it has such figures. */
static void chosen(bool designed, double with)
{
    struct analysis_design *d = &a.decoupled;
    setUp();
    a.stage = ANALYSIS_ALTERNATIVE;
    a.decoupler = DECOUPLER_NO_BETTER;
    a.has_decoupled = true;
    a.designed = designed;
    a.design_error = designed ? ERR_OK : ERR_TIMEOUT;
    a.figures[0] = (struct analysis_figures){.setpoints = 2, .loads = (real_t)with};
    a.figures[1] = (struct analysis_figures){.setpoints = 4, .loads = 5};
    a.d.value[0][0] = 1;
    a.sensitivity.s_nominal = a.sensitivity.factor = a.horizon_s = 1;
    a.predicted[1].iae = a.tried[1].iae = 1;
    d->loops = a.loops;
    d->loops.tuning[1].gain = 7;
    d->d.value[0][1] = REAL_C(-0.5);
    d->sensitivity.s_nominal = 2;
    d->sensitivity.factor = 3;
    d->horizon_s = 5;
    d->predicted[1].iae = 6;
    d->tried[1].iae = 8;
    ends();
}

static void is_decoupled(bool is)
{
    TEST_ASSERT_TRUE(a.designed);
    TEST_ASSERT_EQUAL_INT(ERR_OK, a.design_error);
    TEST_ASSERT_EQUAL_INT(is ? DECOUPLER_USED : DECOUPLER_NO_BETTER, a.decoupler);
    NEAR(is ? 7 : 1, a.loops.tuning[1].gain);
    NEAR(is ? -0.5 : 0.0, a.d.value[0][1]);
    NEAR(is ? 2 : 1, a.sensitivity.s_nominal);
    NEAR(is ? 3 : 1, a.sensitivity.factor);
    NEAR(is ? 5 : 1, a.horizon_s);
    NEAR(is ? 6 : 1, a.predicted[1].iae);
    NEAR(is ? 8 : 1, a.tried[1].iae);
}

static void a_decoupler_pays_from_a_tenth_in_setpoints_and_in_loads_on(void)
{
    chosen(true, 8.05); /* 16.1 of 0.81 times 20 */
    is_decoupled(true);
    chosen(true, 8.15);
    is_decoupled(false);
    chosen(false, 1000); /* the only one there is */
    is_decoupled(true);
    setUp();
    a.stage = ANALYSIS_ALTERNATIVE;
    a.decoupler = DECOUPLER_ILL;
    a.design_error = ERR_TIMEOUT;
    TEST_ASSERT_EQUAL_INT(ERR_OK, analysis_step(&a));
    TEST_ASSERT_FALSE(a.designed);
    TEST_ASSERT_EQUAL_INT(ERR_TIMEOUT, a.design_error);
}

static void the_one_with_a_decoupler_is_remembered_while_the_other_is_made(void)
{
    for (unsigned designed = 0; designed < 2; designed++) {
        setUp();
        a.stage = ANALYSIS_ALTERNATIVE;
        a.decoupler = DECOUPLER_USED;
        a.designed = designed != 0;
        a.design_error = ERR_TIMEOUT;
        a.compares = true;
        a.sensitivity.s_nominal = 2;
        a.sensitivity.factor = 3;
        a.horizon_s = 5;
        a.predicted[1].iae = 6;
        a.tried[1].iae = 8;
        a.d.value[0][1] = REAL_C(-0.5);
        a.loops.tuning[1].gain = 7;
        TEST_ASSERT_EQUAL_INT(ERR_BUSY, analysis_step(&a));
        TEST_ASSERT_EQUAL_INT(ANALYSIS_SETTINGS, a.stage);
        TEST_ASSERT_EQUAL_INT(designed ? DECOUPLER_NO_BETTER : DECOUPLER_ILL, a.decoupler);
        TEST_ASSERT_EQUAL(designed, a.has_decoupled);
        TEST_ASSERT_EQUAL(designed, a.compares);
        TEST_ASSERT_FALSE(a.designed);
        TEST_ASSERT_EQUAL_INT(ERR_OK, a.design_error);
        NEAR(0.0, a.d.value[0][1]); /* none */
        NEAR(1.0, a.d.value[1][1]);
        TEST_ASSERT_EQUAL_UINT8(2, a.d.cols);
        const struct analysis_design *d = &a.decoupled;
        NEAR(designed ? 2 : 0, d->sensitivity.s_nominal);
        NEAR(designed ? 3 : 0, d->sensitivity.factor);
        NEAR(designed ? 5 : 0, d->horizon_s);
        NEAR(designed ? 6 : 0, d->predicted[1].iae);
        NEAR(designed ? 8 : 0, d->tried[1].iae);
        NEAR(designed ? 7 : 0, d->loops.tuning[1].gain);
        NEAR(designed ? -0.5 : 0, d->d.value[0][1]);
    }
}

static void a_loop_takes_settings_within_its_ranges(void)
{
    static const struct {
        double gain, ti_s;
        bool takes;
    } cases[] = {{1.01e-6, 1, true}, {0.99e-6, 1, false}, {99.9, 1, true},   {100.1, 1, false},
                 {1, 0.0101, true},  {1, 0.0099, false},  {1, 0.99e6, true}, {1, 1.01e6, false},
                 {100, 1, true},     {1, 1e6, true},      {NAN, 1, false},   {1, NAN, false}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        struct tuning t = {.gain = (real_t)cases[n].gain, .ti_s = (real_t)cases[n].ti_s};
        TEST_ASSERT_EQUAL(cases[n].takes, analysis_loop_takes(&t));
    }
    struct tuning least = {.gain = REAL_C(1e-6), .ti_s = REAL_C(0.01)};
    TEST_ASSERT_TRUE(analysis_loop_takes(&least));
}

/* From settings to the first prediction, by a whole analysis. */
static void the_horizon_is_five_times_integral_and_dead_time_of_the_slowest_loop(void)
{
    struct analysis_config config = {.h_s = 10,
                                     .confidence = REAL_C(0.95),
                                     .floor = REAL_C(0.005),
                                     .step = REAL_C(0.05),
                                     .loops_max = 8};
    for (unsigned slow = 0; slow < 2; slow++) {
        setUp();
        for (unsigned j = 0; j < 2; j++)
            for (unsigned i = 0; i < 2; i++) {
                a.plant.element[j][i] = (struct fopdt){.gain = i == j ? 1 : REAL_C(0.1),
                                                       .time_constant_s = j == slow ? 900 : 300,
                                                       .dead_time_s = 200};
                a.plant.gain_sd[j][i] = REAL_C(0.001);
            }
        TEST_ASSERT_EQUAL_INT(ERR_OK, analysis_begin(&a, &config));
        while (a.stage != ANALYSIS_DONE)
            TEST_ASSERT_TRUE(analysis_step(&a) == ERR_BUSY || a.stage == ANALYSIS_DONE);
        TEST_ASSERT_TRUE(a.designed);
        double longest = 0.0;
        for (unsigned k = 0; k < 2; k++)
            longest = fmax(longest, 5.0 * ((double)a.loops.tuning[k].ti_s + 200.0));
        NEAR(longest, a.horizon_s);
        TEST_ASSERT_NULL(a.loops.decoupler);
    }
}

/* Two pairings would do. With its own input one loop, the first or the second, has a tenth of the dead time, and the other loop
 * two thirds more. */
static void every_loop_counts_for_the_fastest_pairing(void)
{
    static const double dead_s[2][2] = {{10, 100}, {100, 60}}; /* own input, other one */
    struct analysis_config config = {.h_s = 1,
                                     .confidence = REAL_C(0.95),
                                     .floor = REAL_C(0.005),
                                     .step = REAL_C(0.05),
                                     .loops_max = 8};
    for (unsigned fast = 0; fast < 2; fast++) {
        setUp();
        for (unsigned j = 0; j < 2; j++)
            for (unsigned i = 0; i < 2; i++) {
                a.plant.element[j][i] =
                    (struct fopdt){.gain = i == j ? 1 : (real_t)(j ? -0.8 : 0.8),
                                   .time_constant_s = 100,
                                   .dead_time_s = (real_t)dead_s[j != fast][i != j]};
                a.plant.gain_sd[j][i] = REAL_C(0.001);
            }
        TEST_ASSERT_EQUAL_INT(ERR_OK, analysis_begin(&a, &config));
        while (a.stage != ANALYSIS_DONE)
            TEST_ASSERT_TRUE(analysis_step(&a) == ERR_BUSY || a.stage == ANALYSIS_DONE);
        TEST_ASSERT_EQUAL_UINT8(2, a.choice.n);
        TEST_ASSERT_TRUE(a.choice.list[0].has_settings && a.choice.list[1].has_settings);
        TEST_ASSERT_EQUAL_UINT8(0, a.pairs.input[0]);
        TEST_ASSERT_EQUAL_UINT8(1, a.pairs.input[1]);
    }
}

/* The second output answers to the first input, the first output to the second one, and the gains are too poor for any pairing. */
static void where_no_pairing_is_sure_the_pairs_of_the_estimates_stay(void)
{
    struct analysis_config config = {.h_s = 10,
                                     .confidence = REAL_C(0.95),
                                     .floor = REAL_C(0.005),
                                     .step = REAL_C(0.05),
                                     .loops_max = 8};
    for (unsigned j = 0; j < 2; j++)
        for (unsigned i = 0; i < 2; i++) {
            a.plant.element[j][i] = (struct fopdt){
                .gain = i == j ? REAL_C(0.9) : 1, .time_constant_s = 300, .dead_time_s = 30};
            a.plant.gain_sd[j][i] = REAL_C(0.1);
        }
    TEST_ASSERT_EQUAL_INT(ERR_OK, analysis_begin(&a, &config));
    while (a.stage != ANALYSIS_DONE)
        TEST_ASSERT_TRUE(analysis_step(&a) == ERR_BUSY || a.stage == ANALYSIS_DONE);
    TEST_ASSERT_EQUAL_INT(PAIRING_UNDETERMINED, a.verdict);
    TEST_ASSERT_EQUAL_UINT8(0, a.choice.n);
    TEST_ASSERT_EQUAL_UINT8(2, a.pairs.n);
    for (unsigned k = 0; k < 2; k++) {
        TEST_ASSERT_EQUAL_UINT8(1u - a.pairs.output[k], a.pairs.input[k]);
        NEAR(1.0 / (1.0 - 0.81), a.pair_lambda[k]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_step_that_has_not_settled_is_predicted_four_times_as_long_twice);
    RUN_TEST(every_loop_is_predicted_and_all_must_be_bounded);
    RUN_TEST(with_a_decoupler_in_view_loads_are_predicted_too_and_all_is_counted);
    RUN_TEST(a_decoupler_pays_from_a_tenth_in_setpoints_and_in_loads_on);
    RUN_TEST(the_one_with_a_decoupler_is_remembered_while_the_other_is_made);
    RUN_TEST(a_loop_takes_settings_within_its_ranges);
    RUN_TEST(the_horizon_is_five_times_integral_and_dead_time_of_the_slowest_loop);
    RUN_TEST(every_loop_counts_for_the_fastest_pairing);
    RUN_TEST(where_no_pairing_is_sure_the_pairs_of_the_estimates_stay);
    return UNITY_END();
}
