/* commission/direction.c and direction_sum.c: when all inputs are tested together, with what settings, and what becomes of it. The
 * tests of the single inputs are made up: they know lags of 100 s and dead times of 10 s, relative gain 50. */
#include "commission/direction.h"
#include "commission/direction_sum.h"
#include "commission_outcome.h"

static const struct experiment_config *settings;

static void alike(struct analysis *a)
{
    static const double gain[2][2] = {{1, 0.98}, {1, 1}};
    a->plant.outputs = a->plant.inputs = 2;
    for (unsigned j = 0; j < 2; j++)
        for (unsigned k = 0; k < 2; k++) {
            struct shape_found *f = &c.work->element[j][k].found;
            *f = (struct shape_found){.kind = SHAPE_ONE_LAG, .parameters = 3};
            f->shape = (struct shape){.gain = (real_t)gain[j][k], .lag_s = 100, .dead_time_s = 10};
            f->sd[SHAPE_GAIN] = REAL_C(0.002);
            a->plant.element[j][k].gain = (real_t)gain[j][k];
            a->plant.gain_sd[j][k] = REAL_C(0.002);
        }
    a->weakest[0] = REAL_C(-0.7);
    a->weakest[1] = REAL_C(0.35);
}

/* An analysis that knows no sign of the determinant is done. */
static struct analysis *analysed(void)
{
    struct analysis *a = &c.work->analysis;
    fitted();
    commission_lease(&c);
    c.inputs.turn = 2;
    c.inputs.input[0].rounds = c.inputs.input[1].rounds = 1;
    c.analysis_job.column[1] = 1;
    has_done(TASK_ANALYSIS);
    c.status.phase = COMMISSION_ANALYSING;
    a->verdict = PAIRING_UNDETERMINED;
    a->certainty.doubts = DOUBT_DETERMINANT;
    a->config.floor = REAL_C(0.005);
    alike(a);
    c.outputs.noise_sd[0] = c.outputs.noise_sd[1] = REAL_C(1e-4);
    settings = &c.work->experiment.config;
    return a;
}

void setUp(void)
{
    outcome_begin();
}
void tearDown(void) {}

static bool follows(void)
{
    goes_on();
    return inputs_is_direction(&c.inputs) && c.status.phase == COMMISSION_TESTING;
}

static void inputs_that_act_alike_are_tested_together_next(void)
{
    analysed();
    TEST_ASSERT_TRUE(follows());
    NEAR(1.0, c.work->share[0]);
    NEAR(-0.5, c.work->share[1]);
    TEST_ASSERT_EQUAL_UINT8(1, c.inputs.round); /* not another round */
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_TEST_EXTENDED, DIRECTION_NAME));
    TEST_ASSERT_EQUAL_UINT8(2, inputs_count(&c.inputs));
    TEST_ASSERT_EQUAL_UINT8(1, inputs_due_from(&c.inputs, c.inputs.turn));
}

static void a_large_relative_gain_asks_for_it_as_well(void)
{
    struct analysis *a = analysed();
    a->certainty.doubts = DOUBT_DRAWS;
    a->pairs.n = 2;
    a->pair_lambda[0] = a->pair_lambda[1] = 10;
    TEST_ASSERT_FALSE(follows());
    a = analysed();
    a->certainty.doubts = DOUBT_DRAWS;
    a->pairs.n = 2;
    a->pair_lambda[0] = a->pair_lambda[1] = REAL_C(10.1);
    TEST_ASSERT_TRUE(follows());
}

static void what_is_determined_needs_none(void)
{
    struct analysis *a = analysed();
    a->verdict = PAIRING_DETERMINED;
    a->certainty.doubts = 0;
    a->designed = true;
    TEST_ASSERT_FALSE(follows());
    TEST_ASSERT_EQUAL_INT(COMMISSION_READY, c.status.phase);
}

static void a_response_without_its_end_comes_first(void)
{
    analysed()->flags[1][0] = IDENTIFIED_SLOW;
    TEST_ASSERT_FALSE(follows());
}

static void a_plant_whose_inputs_take_all_places_has_none(void)
{
    analysed();
    c.inputs.n = CHANNEL_MAX;
    TEST_ASSERT_FALSE(direction_is_wanted(&c));
    c.inputs.n = CHANNEL_MAX - 1;
    TEST_ASSERT_TRUE(direction_is_wanted(&c));
}

static void there_is_one_direction_and_a_new_round_tests_it_again(void)
{
    (void)analysed();
    direction_line_up(&c);
    c.inputs.turn = 3;
    goes_on(); /* every gain is as sure as it can be */
    TEST_ASSERT_EQUAL_INT(COMMISSION_READY, c.status.phase);
    struct analysis *a = analysed();
    direction_line_up(&c);
    c.inputs.turn = 3;
    a->plant.along_sd[1] = REAL_C(1e-3); /* but what they do together is not */
    a->plant.share[0] = 1;
    a->plant.share[1] = -1;
    TEST_ASSERT_FALSE(follows());
    TEST_ASSERT_EQUAL_UINT8(2, c.inputs.round);
    TEST_ASSERT_EQUAL_UINT8(3, inputs_due_from(&c.inputs, 0));
}

/* ---- its settings ---- */

static void its_step_is_as_large_as_the_room_of_every_input(void)
{
    analysed();
    c.inputs.input[1].test_base = REAL_C(0.05); /* room of 0.05, for a share of a half */
    TEST_ASSERT_TRUE(follows());
    NEAR(0.1, settings->amplitude_max);
    NEAR(0.0, settings->amplitude);
    TEST_ASSERT_FALSE(settings->gains_unknown);
}

static void a_step_that_is_given_for_an_input_bounds_its_own(void)
{
    analysed();
    cf->mv[0].start_up.step = REAL_C(0.02) * (cf->mv[0].hi - cf->mv[0].lo);
    TEST_ASSERT_TRUE(follows());
    NEAR(0.02, settings->amplitude_max);
}

static void the_model_bounds_its_first_step(void)
{
    analysed();
    c.outputs.noise_sd[0] = c.outputs.noise_sd[1] = REAL_C(0.1);
    TEST_ASSERT_TRUE(follows());
    /* Limits of a fifth; 1 - 0.5 at the end, and twice the error. */
    double most = 0.51 + 2 * 0.002 * sqrt(1.25), ends = 1 - exp(-4.0 * 100 / 100);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.5 * 0.2 / (most * ends), (double)settings->amplitude_first);
}

static void a_clear_response_is_enough(void)
{
    analysed();
    TEST_ASSERT_TRUE(follows());
    NEAR(2 * 20 * 1e-4 / 0.51, settings->amplitude_first); /* noise multiple 20 */
}

static void it_lasts_until_what_the_inputs_have_in_common_is_over(void)
{
    analysed();
    TEST_ASSERT_TRUE(follows());
    TEST_ASSERT_EQUAL_UINT32((10 + 7.5 * 100) / 2, settings->half_least); /* ticks of 2 s */
}

/* ---- the test ---- */

static void all_inputs_move_by_their_shares_and_come_back_together(void)
{
    analysed();
    TEST_ASSERT_TRUE(follows());
    direction_excite(&c, &bench.s, REAL_C(0.2));
    NEAR(0.2, num_to_float(bench.s.mv[0].excitation));
    NEAR(-0.1, num_to_float(bench.s.mv[1].excitation));
    commission_end(&c, &bench.s, REASON_ASKED, NULL, 0);
    NEAR(0.0, num_to_float(bench.s.mv[0].excitation));
    NEAR(0.0, num_to_float(bench.s.mv[1].excitation));
}

/* Record of a test of 1000 s a half by 0.2: the lags of the inputs differ by 5 s, so that a pulse hides the end. */
static void recorded(double end, double noise)
{
    struct record *r = &c.work->experiment.record;
    struct random random = random_from(3);
    c.work->experiment.config.outputs = 2;
    c.work->experiment.config.h_s = 10;
    c.work->experiment.half = 100;
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_init(r, 2, 10));
    real_t y[2] = {0};
    TEST_ASSERT_EQUAL_INT(ERR_OK, record_begin(r, y));
    for (unsigned i = 0; i < 400; i++) {
        double sum = 0;
        for (unsigned edge = 0; edge < 3; edge++) {
            double since = 10.0 * ((double)i - 100.0 * edge) - 10;
            double change = edge == 1 ? -0.4 : 0.2;
            if (since > 0)
                sum += change * (1 - exp(-since / 105) - (1 - end) * (1 - exp(-since / 95)));
        }
        y[0] = y[1] = (real_t)(sum + noise * (double)random_normal(&random));
        TEST_ASSERT_EQUAL_INT(ERR_OK, record_step(r, y));
        if (i % 100 == 0 && i < 300)
            TEST_ASSERT_EQUAL_INT(ERR_OK, record_move(r, (real_t)(i == 0     ? 0.2
                                                                  : i == 100 ? -0.2
                                                                             : 0)));
    }
}

static void line_up(void)
{
    struct analysis *a = analysed();
    a->weakest[1] = REAL_C(0.7);
    direction_line_up(&c);
    c.inputs.input[2].rounds = 1;
    for (unsigned j = 0; j < 2; j++) /* what the inputs' own tests know of the times */
        for (unsigned k = 0; k < 2; k++)
            c.work->element[j][k].found.shape.lag_s = k == 0 ? 105 : 95;
}

static void the_end_behind_a_pulse_is_read_from_the_plateaus(void)
{
    real_t gain, sd;
    line_up();
    recorded(0.02, 0);
    TEST_ASSERT_TRUE(direction_plateau(&c, 0, &gain));
    TEST_ASSERT_TRUE(direction_plateau_sd(&c, 0, gain, &sd));
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 0.02, (double)gain);
    recorded(0.02, 0.003);
    TEST_ASSERT_TRUE(direction_plateau(&c, 0, &gain));
    TEST_ASSERT_TRUE(direction_plateau_sd(&c, 0, gain, &sd));
    /* Points of 40 s, two halves of about 450 s each. */
    double wanted = 0.003 / sqrt(4.0 * 22) / 0.2;
    TEST_ASSERT_DOUBLE_WITHIN(0.5 * wanted, wanted, (double)sd);
    TEST_ASSERT_DOUBLE_WITHIN(3 * (double)sd, 0.02, (double)gain);
}

static void halves_that_are_too_short_show_no_plateau(void)
{
    real_t gain;
    line_up();
    recorded(0.02, 0);
    for (unsigned k = 0; k < 2; k++)
        c.work->element[0][k].found.shape.lag_s = 197;
    TEST_ASSERT_FALSE(direction_plateau(&c, 0, &gain));
}

/* ---- its use ---- */

static void use(void)
{
    for (unsigned j = 0; j < 2; j++) {
        struct element *e = &c.work->element[j][2];
        e->found.shape.gain = j == 0 ? REAL_C(0.02) : 0;
        e->found.sd[SHAPE_GAIN] = REAL_C(1e-4);
    }
    direction_condition(&c, 0);
}

static void the_gains_of_the_analysis_agree_with_it(void)
{
    line_up();
    struct interact_plant *plant = &c.work->analysis.plant;
    plant->element[1][1].gain = REAL_C(0.99);
    use();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.02,
                              (double)(plant->element[0][0].gain - plant->element[0][1].gain));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0,
                              (double)(plant->element[1][0].gain - plant->element[1][1].gain));
    TEST_ASSERT_TRUE(plant->along_sd[0] > 0 && plant->along_sd[1] > 0);
}

static void a_row_whose_sum_has_no_end_stays(void)
{
    line_up();
    c.work->element[0][2].flags = IDENTIFIED_SLOW;
    c.work->analysis.flags[1][0] = IDENTIFIED_RAMP;
    use();
    TEST_ASSERT_FALSE(c.work->analysis.plant.along_sd[0] > 0);
    TEST_ASSERT_FALSE(c.work->analysis.plant.along_sd[1] > 0);
}

static void without_one_of_its_inputs_it_says_nothing(void)
{
    line_up();
    c.inputs.input[1].skipped = true;
    use();
    TEST_ASSERT_FALSE(c.work->analysis.plant.along_sd[0] > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(inputs_that_act_alike_are_tested_together_next);
    RUN_TEST(a_large_relative_gain_asks_for_it_as_well);
    RUN_TEST(what_is_determined_needs_none);
    RUN_TEST(a_response_without_its_end_comes_first);
    RUN_TEST(a_plant_whose_inputs_take_all_places_has_none);
    RUN_TEST(there_is_one_direction_and_a_new_round_tests_it_again);
    RUN_TEST(its_step_is_as_large_as_the_room_of_every_input);
    RUN_TEST(a_step_that_is_given_for_an_input_bounds_its_own);
    RUN_TEST(the_model_bounds_its_first_step);
    RUN_TEST(a_clear_response_is_enough);
    RUN_TEST(it_lasts_until_what_the_inputs_have_in_common_is_over);
    RUN_TEST(all_inputs_move_by_their_shares_and_come_back_together);
    RUN_TEST(the_end_behind_a_pulse_is_read_from_the_plateaus);
    RUN_TEST(halves_that_are_too_short_show_no_plateau);
    RUN_TEST(the_gains_of_the_analysis_agree_with_it);
    RUN_TEST(a_row_whose_sum_has_no_end_stays);
    RUN_TEST(without_one_of_its_inputs_it_says_nothing);
    return UNITY_END();
}
