/* commission/analysis_structure.[ch]: cascades, feedforwards and the second opinion in the analysis.
 *
 * Contract
 *   inner and outer loop       SIMC and the half rule worked out by hand, 1e-4 relative
 *   feedforward                quotient of the two elements, a tick less; share left as the formula has it, 1e-4 relative
 */
#include <math.h>
#include <string.h>

#include "commission/analysis.h"
#include "commission/analysis_structure.h"
#include "interact_plants.h"
#include "unity.h"

static struct known_plant known;
static struct analysis a;
static struct analysis_config config;

void setUp(void)
{
    config = (struct analysis_config){.h_s = 2,
                                      .confidence = REAL_C(0.95),
                                      .floor = REAL_C(0.01),
                                      .step = REAL_C(0.05),
                                      .loops_max = 8};
    memset(&a, 0, sizeof a);
}
void tearDown(void) {}

static void plant_of(unsigned outputs, unsigned inputs)
{
    a.plant.outputs = (uint8_t)outputs;
    a.plant.inputs = (uint8_t)inputs;
    for (unsigned i = 0; i < outputs; i++)
        for (unsigned j = 0; j < inputs; j++)
            a.plant.gain_sd[i][j] = REAL_C(0.002);
}

static void element(unsigned i, unsigned j, double gain, double lag_s, double dead_s)
{
    a.plant.element[i][j] = (struct fopdt){
        .gain = (real_t)gain, .time_constant_s = (real_t)lag_s, .dead_time_s = (real_t)dead_s};
}

static void run(void)
{
    enum err err = analysis_begin(&a, &config);
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    for (unsigned n = 0; n < 1000000; n++) {
        err = analysis_step(&a);
        if (err != ERR_BUSY)
            break;
    }
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
}

#define CLOSE(expected, found)                                                                     \
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * fabs(expected) + 1e-6, expected, (double)(found))

/* ---- cascades ---- */

/* y1 fast, y2 behind it, both by u1; y3 by u2. */
static void flow_and_temperature(void)
{
    plant_of(3, 2);
    element(0, 0, 1.5, 12, 3);
    element(1, 0, -0.9, 150, 20);
    element(2, 1, 1.0, 60, 10);
}

static void one_input_for_a_fast_output_and_one_behind_it_is_a_cascade(void)
{
    flow_and_temperature();
    run();
    TEST_ASSERT_TRUE(a.designed);
    TEST_ASSERT_EQUAL_UINT8(1, a.layout.n_cascades);
    TEST_ASSERT_EQUAL_UINT8(2, a.pairs.n);
    TEST_ASSERT_EQUAL_UINT8(1, a.pairs.output[0]);
    TEST_ASSERT_EQUAL_UINT8(0, analysis_inner_of(&a, 0));
    TEST_ASSERT_EQUAL_UINT8(INTERACT_NONE, analysis_inner_of(&a, 1));
    TEST_ASSERT_EQUAL_UINT8(3, analysis_loops(&a));
    /* inner: theta = 3 + h/2 = 4 = tau_c; K = 12/(1.5 (4 + 4)), Ti = 12 */
    CLOSE(1.0, a.layout.inner_tuning[0].gain);
    CLOSE(12.0, a.layout.inner_tuning[0].ti_s);
    TEST_ASSERT_EQUAL_INT(TUNING_REVERSE, a.layout.inner_tuning[0].action);
    /* G2: -0.6, dead 17 s, lag 170 - 15 - 17 = 138 s; behind exp(-3 s)/(4 s + 1): lag 140 s, dead 22 s */
    const struct fopdt *outer = &a.plant.element[1][0];
    CLOSE(-0.6, outer->gain);
    CLOSE(140.0, outer->time_constant_s);
    CLOSE(22.0, outer->dead_time_s);
    TEST_ASSERT_EQUAL_INT(TUNING_DIRECT, a.loops.tuning[0].action);
    /* errors of both gains, relative, together */
    double sd = 0.6 * hypot(0.002 / 0.9, 0.002 / 1.5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, sd, (double)a.plant.gain_sd[1][0]);
}

static void not_where_the_second_output_is_hardly_slower(void)
{
    flow_and_temperature();
    element(1, 0, -0.9, 12, 5);
    run();
    TEST_ASSERT_EQUAL_UINT8(0, a.layout.n_cascades);
    TEST_ASSERT_EQUAL_UINT8(2, analysis_loops(&a));
}

static void not_where_another_input_moves_one_of_the_two(void)
{
    flow_and_temperature();
    element(0, 1, 0.75, 12, 3);
    element(1, 1, -0.45, 150, 20);
    run();
    TEST_ASSERT_EQUAL_UINT8(1, a.layout.n_cascades); /* shown */
    TEST_ASSERT_EQUAL_UINT16(0, a.layout.inner_outputs);
    TEST_ASSERT_EQUAL_UINT8(a.pairs.n, analysis_loops(&a));
}

/* Three deviations of a gain are nothing beside the largest of its row as long as they are a tenth of it at most. What
 * the input of the two does to others, and the others among themselves, is another matter. */
static void not_where_the_error_of_a_gain_could_hide_that_it_moves_one_of_the_two(void)
{
    static const double largest_of_row[] = {1.5, 0.9, 1.0};
    for (unsigned i = 0; i < 3; i++)
        for (unsigned j = 0; j < 2; j++)
            for (unsigned more = 0; more < 2; more++) {
                bool way_in_or_out = (i < 2) != (j < 1);
                flow_and_temperature();
                a.layout.inner_outputs = 0;
                a.plant.gain_sd[i][j] =
                    (real_t)((more ? 1.02 : 0.98) * 0.1 / 3.0 * largest_of_row[i]);
                run();
                TEST_ASSERT_EQUAL_UINT8(1, a.layout.n_cascades);
                TEST_ASSERT_EQUAL_UINT16(more && way_in_or_out ? 0 : 1, a.layout.inner_outputs);
            }
}

static void not_where_no_settings_are_for_the_inner_loop(void)
{
    flow_and_temperature();
    element(0, 0, 1.5, 0, 3); /* no lag: SIMC has no PI for it */
    run();
    TEST_ASSERT_EQUAL_UINT16(0, a.layout.inner_outputs);
    flow_and_temperature();
    element(0, 0, 1.5, 0.005, 0); /* too short a lag for an integral time */
    run();
    TEST_ASSERT_EQUAL_UINT16(0, a.layout.inner_outputs);
    flow_and_temperature();
    element(0, 0, 0.01, 12, 0); /* gain of more than 100 */
    run();
    TEST_ASSERT_EQUAL_UINT16(0, a.layout.inner_outputs);
}

static void an_inner_loop_counts_among_those_the_board_runs(void)
{
    flow_and_temperature();
    config.loops_max = 2;
    run();
    TEST_ASSERT_FALSE(a.designed);
    TEST_ASSERT_EQUAL_INT(ERR_FULL, a.design_error);
}

/* ---- feedforward ---- */

static void triangle(double dead_cross_s, double dead_own_s)
{
    plant_of(2, 2);
    element(0, 0, 1.2, 80, 8);
    element(1, 0, 0.8, 100, dead_cross_s);
    element(1, 1, -1.0, 70, dead_own_s);
}

static void what_disturbs_only_one_way_is_fed_forward(void)
{
    triangle(24, 14);
    run();
    struct feed f = analysis_feed(&a, 0, 1);
    TEST_ASSERT_EQUAL_INT(FEED_USED, f.verdict);
    CLOSE(0.8, f.way.gain);
    CLOSE(70.0, f.way.lead_s);
    CLOSE(100.0, f.way.lag_s);
    CLOSE(8.0, f.way.dead_s); /* 24 - 14 less a tick */
    CLOSE(0.0, f.left);
    TEST_ASSERT_EQUAL_INT(FEED_NONE, analysis_feed(&a, 1, 0).verdict);
    TEST_ASSERT_EQUAL_INT(FEED_NONE, analysis_feed(&a, 0, 0).verdict);
}

static void a_little_late_is_told_and_too_late_is_not_used(void)
{
    triangle(14, 14); /* late by the tick */
    run();
    struct feed f = analysis_feed(&a, 0, 1);
    TEST_ASSERT_EQUAL_INT(FEED_USED, f.verdict);
    CLOSE(2.0, f.way.late_s);
    CLOSE(0.0, f.way.dead_s);
    CLOSE(2.0 * (double)a.loops.tuning[1].gain / (double)a.loops.tuning[1].ti_s, f.left);
    memset(&a, 0, sizeof a);
    triangle(2, 40);
    run();
    f = analysis_feed(&a, 0, 1);
    CLOSE(40.0, f.way.late_s);
    memset(&a, 0, sizeof a);
    triangle(0, 300);
    run();
    TEST_ASSERT_EQUAL_INT(FEED_LATE, analysis_feed(&a, 0, 1).verdict);
}

static void a_lead_without_a_lag_gets_one_and_is_late_by_it(void)
{
    triangle(24, 14);
    element(1, 0, 0.8, 1, 24);
    run();
    struct feed f = analysis_feed(&a, 0, 1);
    CLOSE(12.0, f.way.lag_s); /* 70/5 - 2 */
    CLOSE(11.0, f.way.late_s);
    TEST_ASSERT_TRUE(f.left > REAL_C(0.0));
}

static void a_loop_in_a_block_of_several_is_not_fed(void)
{
    plant_of(3, 3);
    element(0, 0, 1, 60, 6);
    element(1, 0, 0.5, 60, 12);
    element(1, 1, 1, 60, 6);
    element(1, 2, 0.4, 60, 6);
    element(2, 1, 0.4, 60, 6);
    element(2, 2, 1, 60, 6);
    run();
    TEST_ASSERT_TRUE(a.designed);
    TEST_ASSERT_EQUAL_INT(FEED_COMPANY, analysis_feed(&a, 0, 1).verdict);
}

static void what_is_beyond_an_element_is_not_used(void)
{
    triangle(14 + 2100, 14); /* more samples of dead time than its share of the memory */
    run();
    TEST_ASSERT_TRUE(a.designed);
    TEST_ASSERT_EQUAL_INT(FEED_LARGE, analysis_feed(&a, 0, 1).verdict);
    memset(&a, 0, sizeof a);
    triangle(24, 14);
    element(1, 0, 15, 100, 24); /* a gain of 150 for the feedforward */
    element(1, 1, -0.1, 70, 14);
    run();
    TEST_ASSERT_TRUE(a.designed);
    TEST_ASSERT_EQUAL_INT(FEED_LARGE, analysis_feed(&a, 0, 1).verdict);
}

/* Four loops, each disturbed by all before it: six ways, four places. */
static void of_more_ways_than_places_the_strongest_are_used(void)
{
    unsigned used = 0, full = 0;
    plant_of(4, 4);
    for (unsigned i = 0; i < 4; i++)
        for (unsigned j = 0; j <= i; j++)
            element(i, j, i == j ? 1.0 : 0.3 + 0.05 * i + 0.01 * j, 60, i == j ? 4 : 12);
    run();
    TEST_ASSERT_TRUE(a.designed);
    double weakest = 1e9, strongest_left = 0.0;
    for (uint8_t k = 0; k < 4; k++)
        for (uint8_t l = 0; l < 4; l++) {
            struct feed f = analysis_feed(&a, k, l);
            used += f.verdict == FEED_USED;
            full += f.verdict == FEED_FULL;
            if (f.verdict == FEED_USED)
                weakest = fmin(weakest, fabs((double)f.way.gain));
            if (f.verdict == FEED_FULL)
                strongest_left = fmax(strongest_left, fabs((double)f.way.gain));
        }
    TEST_ASSERT_EQUAL_UINT(4, used);
    TEST_ASSERT_EQUAL_UINT(2, full);
    TEST_ASSERT_TRUE(weakest > strongest_left);
}

static void without_a_design_there_is_no_feedforward(void)
{
    triangle(24, 14);
    config.loops_max = 1;
    run();
    TEST_ASSERT_FALSE(a.designed);
    TEST_ASSERT_EQUAL_INT(FEED_NONE, analysis_feed(&a, 0, 1).verdict);
}

/* ---- second opinion ---- */

static void take(unsigned number, double unit_s)
{
    known_plant(number, &known);
    memset(&a, 0, sizeof a);
    a.plant = known.plant;
    for (unsigned i = 0; i < a.plant.outputs; i++)
        for (unsigned j = 0; j < a.plant.inputs; j++) {
            a.plant.element[i][j].time_constant_s *= (real_t)unit_s;
            a.plant.element[i][j].dead_time_s *= (real_t)unit_s;
            a.plant.gain_sd[i][j] = REAL_C(0.001) * real_abs(a.plant.element[i][j].gain);
        }
    run();
}

static void gains_over_residence_times_agree_on_the_books_plants(void)
{
    take(PLANT_WOOD_BERRY, 60);
    TEST_ASSERT_EQUAL_INT(SECOND_AGREES, a.layout.second);
    /* docs/methods/interaction.md */
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.56, (double)a.layout.pair_phi[0]);
    take(PLANT_LUYBEN_4X4, 60);
    TEST_ASSERT_EQUAL_INT(SECOND_AGREES, a.layout.second);
}

/* Gains alone favour the diagonal a little, speeds the other pairs by far: both pairings get settings, and the faster is taken. */
static void of_two_pairings_that_would_do_the_faster_is_taken(void)
{
    for (unsigned fast = 0; fast < 2; fast++) {
        plant_of(2, 2);
        element(0, 0, 1.0, 400, 40);
        element(0, 1, 0.9, fast ? 20 : 400, fast ? 2 : 40);
        element(1, 0, -0.9, fast ? 20 : 400, fast ? 2 : 40);
        element(1, 1, 1.0, 400, 40);
        run();
        TEST_ASSERT_EQUAL_INT(PAIRING_DETERMINED, a.verdict);
        TEST_ASSERT_EQUAL_UINT8(2, a.choice.n);
        TEST_ASSERT_EQUAL_UINT8(fast ? 1 : 0, a.choice.chosen);
        TEST_ASSERT_EQUAL_UINT8(fast ? 1 : 0, a.pairs.input[0]);
        TEST_ASSERT_EQUAL_UINT8(fast ? 0 : 1, a.pairs.input[1]);
        TEST_ASSERT_EQUAL_INT(SECOND_AGREES, a.layout.second);
        CLOSE(fast ? 0.81 / 1.81 : 1 / 1.81, a.pair_lambda[0]);
        TEST_ASSERT_EQUAL_INT(fast, a.choice.list[1].speed > a.choice.list[0].speed);
    }
}

/* Only with all four loops does the diagonal hold; of its loops 1 and 2 alone the index is -0.2. No other pairing has positive
 * relative gains and index. */
static void loops_that_run_away_without_the_others_are_a_warning(void)
{
    static const double k[4][4] = {
        {1, 1.5, -0.4, 0.6}, {0.8, 1, 1.2, -1.3}, {1, -1.1, 1, -1.5}, {-1.4, 0.8, -0.1, 1}};
    plant_of(4, 4);
    for (unsigned i = 0; i < 4; i++)
        for (unsigned j = 0; j < 4; j++)
            element(i, j, k[i][j], 100, 10);
    run();
    TEST_ASSERT_EQUAL_HEX8(0, a.certainty.doubts);
    TEST_ASSERT_EQUAL_INT(PAIRING_DETERMINED, a.verdict);
    TEST_ASSERT_EQUAL_HEX16(3, a.negative);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -0.2, (double)a.negative_index);
}

static void a_gain_within_its_error_counts_for_none_whatever_its_times(void)
{
    plant_of(2, 2);
    element(0, 0, 1.0, 4000, 40);
    element(1, 1, 1.0, 4000, 40);
    element(0, 1, 0.005, 0, 0);
    element(1, 0, 0.005, 0, 0);
    run();
    TEST_ASSERT_EQUAL_INT(SECOND_AGREES, a.layout.second);
    CLOSE(1.0, a.layout.pair_phi[0]);
}

static void without_a_pairing_there_is_none(void)
{
    take(PLANT_PAPER_MACHINE, 1);
    TEST_ASSERT_EQUAL_INT(SECOND_NONE, a.layout.second);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(one_input_for_a_fast_output_and_one_behind_it_is_a_cascade);
    RUN_TEST(not_where_the_second_output_is_hardly_slower);
    RUN_TEST(not_where_another_input_moves_one_of_the_two);
    RUN_TEST(not_where_the_error_of_a_gain_could_hide_that_it_moves_one_of_the_two);
    RUN_TEST(not_where_no_settings_are_for_the_inner_loop);
    RUN_TEST(an_inner_loop_counts_among_those_the_board_runs);
    RUN_TEST(what_disturbs_only_one_way_is_fed_forward);
    RUN_TEST(a_little_late_is_told_and_too_late_is_not_used);
    RUN_TEST(a_lead_without_a_lag_gets_one_and_is_late_by_it);
    RUN_TEST(a_loop_in_a_block_of_several_is_not_fed);
    RUN_TEST(what_is_beyond_an_element_is_not_used);
    RUN_TEST(of_more_ways_than_places_the_strongest_are_used);
    RUN_TEST(without_a_design_there_is_no_feedforward);
    RUN_TEST(gains_over_residence_times_agree_on_the_books_plants);
    RUN_TEST(of_two_pairings_that_would_do_the_faster_is_taken);
    RUN_TEST(loops_that_run_away_without_the_others_are_a_warning);
    RUN_TEST(a_gain_within_its_error_counts_for_none_whatever_its_times);
    RUN_TEST(without_a_pairing_there_is_none);
    return UNITY_END();
}
