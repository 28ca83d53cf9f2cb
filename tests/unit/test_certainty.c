/* commission/certainty.[ch]: what has to agree with the draws before a pairing is determined, on either side of each bound.
 *
 * Contract
 *   flags          slow, unknown: not determined, whether a pair uses the element or not; other flags never, nor a ramp whose
 *                  slope is known
 *   signs, rank    a gain, a determinant, a direction that does not stand out of its error: not determined
 *   second opinion gains over residence times that pair otherwise: shown, no doubt
 *   what is left   every channel without a loop, with the reason
 */
#include <string.h>

#include "commission/analysis.h"
#include "commission/analysis_structure.h"
#include "commission/certainty.h"
#include "commission/words.h"
#include "unity.h"

static struct analysis a;
static struct analysis_config config;

void setUp(void)
{
    config = (struct analysis_config){.h_s = 1,
                                      .confidence = REAL_C(0.95),
                                      .floor = REAL_C(0.005),
                                      .step = REAL_C(0.05),
                                      .loops_max = 8};
    memset(&a, 0, sizeof a);
}
void tearDown(void) {}

static void element(unsigned j, unsigned i, double gain, double sd, double lag_s)
{
    a.plant.element[j][i] = (struct fopdt){.gain = (real_t)gain,
                                           .time_constant_s = (real_t)lag_s,
                                           .dead_time_s = (real_t)(0.1 * lag_s)};
    a.plant.gain_sd[j][i] = (real_t)sd;
}

/* Diagonal pairs without a doubt. */
static void good(void)
{
    a.plant.outputs = a.plant.inputs = 2;
    element(0, 0, 1.0, 0.01, 100);
    element(0, 1, 0.3, 0.01, 100);
    element(1, 0, -0.2, 0.01, 100);
    element(1, 1, 0.8, 0.01, 100);
    memset(a.flags, 0, sizeof a.flags);
}

static void run(void)
{
    enum err err = analysis_begin(&a, &config);
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    while ((err = analysis_step(&a)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_EQUAL_INT(a.certainty.doubts == 0, a.verdict == PAIRING_DETERMINED);
    TEST_ASSERT_EQUAL_INT(a.certainty.doubts == 0, a.designed);
}

static void a_plant_without_doubts_is_determined(void)
{
    good();
    run();
    TEST_ASSERT_EQUAL_HEX8(0, a.certainty.doubts);
    TEST_ASSERT_EQUAL_INT(SECOND_AGREES, a.layout.second);
    for (uint8_t k = 0; k < 2; k++) {
        TEST_ASSERT_EQUAL_INT(LEFT_NOT, certainty_output_left(&a, k));
        TEST_ASSERT_EQUAL_INT(LEFT_NOT, certainty_input_left(&a, k));
    }
}

/* The gain of a response that was not seen to its end may be anything: fast pairs whose cross couplings are 80 times slower
 * were kept, and ran away. */
static void an_unresolved_flag_counts_whether_paired_or_not(void)
{
    static const struct {
        uint16_t flag;
        uint8_t doubts;
    } cases[] = {{IDENTIFIED_SLOW, DOUBT_SHAPE},
                 {IDENTIFIED_UNKNOWN, DOUBT_SHAPE},
                 {IDENTIFIED_INVERSE, 0},
                 {IDENTIFIED_RAMP, 0}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++)
        for (uint8_t i = 0; i < 2; i++) {
            uint8_t doubts = cases[n].doubts;
            good();
            a.flags[1][i] = cases[n].flag;
            run();
            TEST_ASSERT_EQUAL_HEX8(doubts, a.certainty.doubts);
            TEST_ASSERT_EQUAL_HEX16(doubts ? 2 : 0, a.certainty.ambiguous_outputs);
            TEST_ASSERT_EQUAL_HEX16(doubts ? cases[n].flag : 0, certainty_flags(&a, 1, i));
            TEST_ASSERT_EQUAL_HEX16(doubts == DOUBT_SHAPE ? 1u << i : 0, a.certainty.unsettled);
        }
}

/* A gain that is lost in its error is no proof that there is none: the test was too short to know. */
static void a_flag_counts_where_the_gain_does_not_stand_out(void)
{
    static const uint16_t flags[] = {IDENTIFIED_SLOW, IDENTIFIED_UNKNOWN};
    for (unsigned n = 0; n < sizeof flags / sizeof flags[0]; n++) {
        good();
        element(0, 1, 0.029, 0.01, 100);
        a.flags[0][1] = flags[n];
        run();
        TEST_ASSERT_EQUAL_HEX8(DOUBT_SHAPE, a.certainty.doubts);
    }
}

static void words_name_a_response_not_seen_to_its_end(void)
{
    good();
    a.flags[0][1] = IDENTIFIED_SLOW;
    run();
    TEST_ASSERT_EQUAL_STRING("not determined: a response was not seen to its end",
                             words_of_verdict(&a));
    good();
    a.flags[0][1] = IDENTIFIED_UNKNOWN;
    run();
    TEST_ASSERT_EQUAL_STRING("not determined: a response was not seen to its end",
                             words_of_verdict(&a));
}

static void a_flag_counts_for_the_inner_loop_of_a_cascade_too(void)
{
    a.plant.outputs = 2;
    a.plant.inputs = 1;
    element(0, 0, 1.0, 0.005, 10);
    element(1, 0, 0.8, 0.005, 200);
    run();
    TEST_ASSERT_EQUAL_HEX16(1, a.layout.inner_outputs);
    TEST_ASSERT_EQUAL_HEX8(0, a.certainty.doubts);
    TEST_ASSERT_EQUAL_INT(LEFT_NOT, certainty_output_left(&a, 0));
    element(0, 0, 1.0, 0.005, 10); /* the loop above it is designed on another plant */
    element(1, 0, 0.8, 0.005, 200);
    a.flags[0][0] = IDENTIFIED_SLOW;
    run();
    TEST_ASSERT_EQUAL_HEX8(DOUBT_SHAPE, a.certainty.doubts);
}

/* A gain of 0.3 between an input whose other gain is not known at all and the outputs of what looks like a cascade. */
static void an_unknown_gain_is_not_none(void)
{
    a.plant.outputs = a.plant.inputs = 2;
    element(0, 0, 1.0, 0.005, 10);
    element(1, 0, 0.8, 0.005, 200);
    element(0, 1, 0.001, 0.032,
            100); /* three deviations are less than a tenth of the row's largest: none */
    element(1, 1, 0.001, 0.0025, 100);
    run();
    TEST_ASSERT_EQUAL_HEX16(1, a.layout.inner_outputs);
    TEST_ASSERT_EQUAL_HEX8(0, a.certainty.doubts);
    TEST_ASSERT_EQUAL_INT(LEFT_UNSEEN, certainty_input_left(&a, 1));

    element(0, 0, 1.0, 0.005, 10);
    element(1, 0, 0.8, 0.005, 200);
    element(0, 1, 0.001, 0.035, 100);
    element(1, 1, 0.001, 0.0025, 100);
    run();
    TEST_ASSERT_EQUAL_HEX16(0, a.layout.inner_outputs);
    TEST_ASSERT_NOT_EQUAL_INT(PAIRING_DETERMINED, a.verdict);
    TEST_ASSERT_EQUAL_INT(LEFT_UNSEEN, certainty_input_left(&a, 1));

    element(0, 0, 0.1, 0.0005, 10); /* nor is it where all gains are small */
    element(1, 0, 0.08, 0.0005, 200);
    element(0, 1, 0.0001, 0.0035, 100);
    element(1, 1, 0.0001, 0.00025, 100);
    run();
    TEST_ASSERT_EQUAL_HEX16(0, a.layout.inner_outputs);
}

static void a_sign_is_sure_from_three_standard_deviations_on(void)
{
    for (double sds = 2.9; sds < 3.2; sds += 0.2) {
        good();
        element(0, 1, 0.0, 0.001, 100);
        element(1, 0, 0.0, 0.001, 100);
        element(1, 1, 0.8, 0.8 / sds, 100);
        run();
        TEST_ASSERT_EQUAL_INT(sds < 3.0, (a.certainty.doubts & DOUBT_SIGN) != 0);
        TEST_ASSERT_EQUAL_HEX16(sds < 3.0 ? 2 : 0, a.certainty.ambiguous_outputs);
    }
}

/* 1 - b, b the only gain that is not sure: its sign by the determinant at 2, by the rank at 1.94 of its deviations. */
static void determinant_and_rank_have_to_stand_out_of_the_errors(void)
{
    static const struct {
        double sds;
        unsigned doubts;
    } cases[] = {{1.85, DOUBT_DETERMINANT | DOUBT_RANK}, {2.1, 0}};
    for (unsigned n = 0; n < 2; n++) {
        good();
        config.floor = REAL_C(1e-4);
        element(0, 0, 1.0, 0.0, 100);
        element(0, 1, 0.7, 0.3 / cases[n].sds, 100);
        element(1, 0, 1.0, 0.0, 100);
        element(1, 1, 1.0, 0.0, 100);
        run();
        TEST_ASSERT_EQUAL_HEX8(cases[n].doubts, a.certainty.doubts);
        TEST_ASSERT_EQUAL_INT(cases[n].doubts ? 1 : 2, a.rank);
        TEST_ASSERT_TRUE(a.probability > REAL_C(0.95)); /* the draws alone would have taken it */
    }
}

/* Loads at either input; whichever pairs are taken, the other opinion is shown and decides nothing. */
static void another_second_opinion_is_no_doubt(void)
{
    good();
    element(0, 0, 1.0, 0.01, 100);
    element(0, 1, 0.9, 0.01, 60);
    element(1, 0, -0.9, 0.01, 60);
    element(1, 1, 1.0, 0.01, 100);
    a.given[0] = 1;
    run();
    TEST_ASSERT_EQUAL_INT(SECOND_DIFFERS, a.layout.second);
    TEST_ASSERT_EQUAL_HEX8(0, a.certainty.doubts);
    a.given[0] = 0;
}

static void what_is_left_over_has_a_reason(void)
{
    a.plant.outputs = 2;
    a.plant.inputs = 3;
    element(0, 0, 1.0, 0.01, 100);
    element(0, 1, 0.2, 0.01, 100);
    element(0, 2, 0.3, 0.01, 100);
    element(1, 0, 0.2, 0.01, 100);
    element(1, 1, 1.0, 0.01, 100);
    element(1, 2, 0.3, 0.01, 100);
    run();
    TEST_ASSERT_EQUAL_HEX8(0, a.certainty.doubts);
    TEST_ASSERT_EQUAL_INT(LEFT_NOT, certainty_input_left(&a, 0));
    TEST_ASSERT_EQUAL_INT(LEFT_OVER, certainty_input_left(&a, 2));
    element(0, 2, 0.001, 0.01, 100);
    element(1, 2, 0.029, 0.01, 100);
    run();
    TEST_ASSERT_EQUAL_INT(LEFT_UNSEEN, certainty_input_left(&a, 2));
    element(1, 2, 0.031, 0.01, 100);
    run();
    TEST_ASSERT_EQUAL_INT(LEFT_OVER, certainty_input_left(&a, 2));

    memset(&a, 0, sizeof a);
    a.plant.outputs = 2;
    a.plant.inputs = 1;
    element(0, 0, 1.0, 0.01, 100);
    element(1, 0, 0.001, 0.01, 100);
    run();
    TEST_ASSERT_EQUAL_HEX8(0, a.certainty.doubts);
    TEST_ASSERT_EQUAL_INT(LEFT_UNSEEN, certainty_output_left(&a, 1));
    element(1, 0, 0.5, 0.01, 110);
    run();
    TEST_ASSERT_EQUAL_INT(LEFT_OVER, certainty_output_left(&a, 1));
}

/* By gains alone the other pairs; each of the pairs given has a positive relative gain of 0.4. */
static void pairs_that_are_given_are_taken_and_no_others_are_looked_for(void)
{
    for (unsigned given = 0; given < 3; given++) {
        good();
        element(0, 0, 1.0, 0.01, 100);
        element(0, 1, 1.2, 0.01, 100);
        element(1, 0, -1.2, 0.01, 100);
        element(1, 1, 1.0, 0.01, 100);
        memset(a.given, 0, sizeof a.given);
        if (given == 1)
            a.given[1] = 2; /* and so the other is given, too */
        if (given == 2)
            a.given[0] = 1, a.given[1] = 2;
        run();
        TEST_ASSERT_EQUAL_INT(PAIRING_DETERMINED, a.verdict);
        TEST_ASSERT_EQUAL_UINT8(given ? 0 : 1, a.pairs.input[0]);
        TEST_ASSERT_EQUAL_UINT8(given ? 1 : 0, a.pairs.input[1]);
    }
}

static void pairs_that_are_given_need_all_else(void)
{
    config.confidence = REAL_C(0.9);
    good();
    element(0, 0, 1.0, 0.01, 400);
    element(0, 1, 0.9, 0.01, 20);
    element(1, 0, -0.9, 0.01, 20);
    element(1, 1, 1.0, 0.01, 400);
    a.given[0] = 1;
    a.given[1] = 2;
    run();
    TEST_ASSERT_EQUAL_INT(SECOND_DIFFERS, a.layout.second);
    TEST_ASSERT_EQUAL_HEX8(0, a.certainty.doubts);
    a.flags[0][1] = IDENTIFIED_SLOW;
    run();
    TEST_ASSERT_EQUAL_HEX8(DOUBT_SHAPE, a.certainty.doubts);
    memset(a.flags, 0, sizeof a.flags);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_plant_without_doubts_is_determined);
    RUN_TEST(an_unresolved_flag_counts_whether_paired_or_not);
    RUN_TEST(a_flag_counts_where_the_gain_does_not_stand_out);
    RUN_TEST(words_name_a_response_not_seen_to_its_end);
    RUN_TEST(a_flag_counts_for_the_inner_loop_of_a_cascade_too);
    RUN_TEST(an_unknown_gain_is_not_none);
    RUN_TEST(a_sign_is_sure_from_three_standard_deviations_on);
    RUN_TEST(determinant_and_rank_have_to_stand_out_of_the_errors);
    RUN_TEST(another_second_opinion_is_no_doubt);
    RUN_TEST(what_is_left_over_has_a_reason);
    RUN_TEST(pairs_that_are_given_are_taken_and_no_others_are_looked_for);
    RUN_TEST(pairs_that_are_given_need_all_else);
    return UNITY_END();
}
