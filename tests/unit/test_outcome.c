/* commission/results.c: what becomes of a test and of an analysis, on either side of each bound. What the tests have found is
 * made up. */
#include "commission_outcome.h"

void setUp(void)
{
    outcome_begin();
}
void tearDown(void) {}

static void is_kept(void)
{
    goes_on();
    TEST_ASSERT_EQUAL_INT(COMMISSION_TESTING, c.status.phase);
    TEST_ASSERT_EQUAL_UINT8(1, c.inputs.turn); /* the next input's turn */
    TEST_ASSERT_EQUAL_UINT8(1, c.inputs.input[0].rounds);
    NEAR(0.5, c.work->element[0][0].found.shape.gain);
}

static void is_again(void)
{
    goes_on();
    TEST_ASSERT_EQUAL_INT(COMMISSION_TESTING, c.status.phase);
    TEST_ASSERT_EQUAL_UINT8(0, c.inputs.turn);
    TEST_ASSERT_EQUAL_UINT8(0, c.inputs.input[0].rounds);
}

static void ends(enum commission_reason reason, const char *subject, double value)
{
    goes_on();
    TEST_ASSERT_EQUAL_INT(COMMISSION_ENDED, c.status.phase);
    TEST_ASSERT_EQUAL_INT(reason, c.status.reason);
    TEST_ASSERT_EQUAL_STRING(subject, c.status.subject);
    NEAR(value, c.status.value);
    TEST_ASSERT_EQUAL_UINT8((uint8_t)reason, said(EVENT_COMMISSION_ENDED)->detail);
}

/* ---- a job ---- */

static void a_result_is_taken_when_it_is_due_and_done(void)
{
    c.background.job.due = 3;
    goes_on();
    goes_on();
    TEST_ASSERT_EQUAL_INT(COMMISSION_FITTING, c.status.phase);
    c.background.job.done = false;
    goes_on();
    goes_on();
    TEST_ASSERT_EQUAL_INT(COMMISSION_FITTING, c.status.phase);
    c.background.job.done = true;
    is_kept();
    TEST_ASSERT_FALSE(job_is_asked(&c.background.job));
}

static void the_next_sample_waits_for_what_is_due_then(void)
{
    struct jobs jobs = jobs_of_it();
    c.background.job.due = 3;
    c.background.job.done = false;
    c.background.job.ticks = 1;
    TEST_ASSERT_FALSE(jobs_wait(&jobs));
    c.background.job.ticks = 2;
    TEST_ASSERT_TRUE(jobs_wait(&jobs));
    c.background.job.done = true;
    TEST_ASSERT_FALSE(jobs_wait(&jobs));
    c.background.job.done = false;
    job_give_up(&c.background.job);
    TEST_ASSERT_FALSE(jobs_wait(&jobs));
}

static void a_fit_that_fails_ends_it(void)
{
    c.model.error = ERR_RANGE;
    ends(REASON_NUMBERS, "reflux", (double)ERR_RANGE);
    TEST_ASSERT_EQUAL_UINT(0, c.inputs.input[0].rounds);
}

static void samples_are_the_nearest_number_of_ticks(void)
{
    TEST_ASSERT_EQUAL_UINT32(4, commission_samples(&bench.s, REAL_C(8.9)));
    TEST_ASSERT_EQUAL_UINT32(5, commission_samples(&bench.s, REAL_C(9.1)));
    TEST_ASSERT_EQUAL_UINT32(0, commission_samples(&bench.s, REAL_C(0.9)));
}

/* ---- after a test ---- */

static void how_long_the_slowest_response_takes_is_a_measure_for_the_next(void)
{
    is_kept();
    TEST_ASSERT_EQUAL_UINT32(35, c.inputs.half_least); /* 10 and three times 20 s */
    fitted();
    c.inputs.half_least = 36;
    is_kept();
    TEST_ASSERT_EQUAL_UINT32(36, c.inputs.half_least);
    fitted();
    c.inputs.round = 2; /* of the first round only */
    is_kept();
    TEST_ASSERT_EQUAL_UINT32(0, c.inputs.half_least);
}

static void what_goes_on_climbing_gets_three_times_as_long(void)
{
    for (unsigned flagged = 0; flagged < 3; flagged++)
        for (unsigned j = 0; j < 2; j++) {
            fitted();
            if (flagged)
                c.model.fitted[j].flags = flagged == 1 ? IDENTIFIED_SLOW : IDENTIFIED_UNKNOWN;
            c.model.climbs[j] = flagged ? REAL_C(0.49) : REAL_C(0.69);
            is_kept();
            fitted();
            if (flagged)
                c.model.fitted[j].flags = flagged == 1 ? IDENTIFIED_SLOW : IDENTIFIED_UNKNOWN;
            c.model.climbs[j] = flagged ? REAL_C(0.51) : REAL_C(0.71);
            is_again();
            TEST_ASSERT_EQUAL_UINT32(300, c.inputs.input[0].half_wanted);
            TEST_ASSERT_EQUAL_UINT8(1, c.inputs.input[0].longer_retries);
            NEAR(600.0, said(EVENT_TEST_LONGER)->value);
            TEST_ASSERT_EQUAL_UINT8(1, said(EVENT_TEST_LONGER)->detail);
            TEST_ASSERT_EQUAL_STRING("reflux", said(EVENT_TEST_LONGER)->subject);
        }
    fitted();
    c.model.climbs[0] = REAL_C(0.9);
    c.inputs.input[0].rounds = 1; /* it came to rest in an earlier round */
    goes_on();
    TEST_ASSERT_EQUAL_UINT8(2, c.inputs.input[0].rounds);
}

/* A longer level would show the same slope. */
static void a_ramp_whose_slope_is_known_may_climb(void)
{
    c.model.climbs[0] = REAL_C(1.0);
    c.model.fitted[0].flags = IDENTIFIED_RAMP;
    interim_fit_shape(&x->interim_fit, 0)->kind = SHAPE_INTEGRATING;
    is_kept();
    TEST_ASSERT_EQUAL_HEX16(IDENTIFIED_RAMP, c.work->element[0][0].flags);
}

static void three_times_a_half_is_made_longer(void)
{
    cf->test.longest_s = 2000; /* 1000 samples */
    c.model.climbs[1] = REAL_C(0.9);
    c.inputs.input[0].longer_retries = 2;
    is_again();
    fitted();
    c.model.climbs[1] = REAL_C(0.9);
    c.inputs.input[0].longer_retries = 3;
    c.inputs.input[0].worst = REAL_C(0.4);
    ends(REASON_TOO_SLOW, "T10", 0.4);
    fitted();
    c.model.climbs[1] = REAL_C(0.9);
    x->half = 999;
    is_again();
    fitted();
    c.model.climbs[1] = REAL_C(0.9);
    x->half = 1000;
    ends(REASON_TOO_SLOW, "T10", 0.0);
    fitted();
    c.model.climbs[1] = REAL_C(0.9);
    x->config.half = 1; /* given */
    ends(REASON_TOO_SLOW, "T10", 0.0);
}

static void slow_is_what_has_a_time_constant_that_is_known_within_half(void)
{
    static const struct {
        double sd;
        unsigned flags;
        enum commission_reason reason;
    } cases[] = {{9.9, 0, REASON_TOO_SLOW},
                 {10.1, 0, REASON_INTEGRATES},
                 {0, 0, REASON_INTEGRATES},
                 {1, IDENTIFIED_UNKNOWN, REASON_INTEGRATES},
                 {1, IDENTIFIED_SLOW, REASON_TOO_SLOW}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        fitted();
        c.model.climbs[0] = REAL_C(0.9);
        c.inputs.input[0].longer_retries = 3;
        c.model.fitted[0].time_constant_sd_s = (real_t)cases[n].sd;
        c.model.fitted[0].flags = (uint16_t)cases[n].flags;
        ends(cases[n].reason, "T1", 0.0);
    }
}

static void of_a_step_that_was_cut_the_fit_must_say_so_too(void)
{
    c.model.climbs[0] = REAL_C(0.9);
    x->cut = true;
    is_kept();
    fitted();
    c.model.climbs[0] = REAL_C(0.9);
    c.model.fitted[0].flags = IDENTIFIED_UNKNOWN;
    x->cut = true;
    ends(REASON_INTEGRATES, "T1", 0.0);
}

/* A response of which so much was still to come; 190 s after its dead time. */
static void cut(double unseen)
{
    fitted();
    x->cut = true;
    c.model.fitted[0].time_constant_s = (real_t)(190.0 / -log(unseen));
}

static void what_the_guard_has_cut_is_tried_with_less(void)
{
    cut(0.099);
    is_kept();
    cut(0.101);
    is_again();
    NEAR(0.06, c.inputs.input[0].amplitude_most);
    TEST_ASSERT_EQUAL_UINT8(1, c.inputs.input[0].cut_retries);
    NEAR(0.06, said(EVENT_TEST_SMALLER)->value);
    TEST_ASSERT_EQUAL_UINT8(1, said(EVENT_TEST_SMALLER)->detail);
    cut(0.5);
    x->cut = false;
    is_kept();
    cut(0.5);
    c.model.fitted[0].flags = IDENTIFIED_NO_GAIN;
    is_kept();
    cut(0.5);
    x->config.repeats = false; /* the amplitude is given, or it was made smaller three times */
    is_kept();
}

static void the_smaller_step_leaves_half_of_the_room(void)
{
    static const struct {
        double gain, sd, left, most;
    } cases[] = {{1.6, 0.01, 0, 0.06},      {1.7, 0.01, 0, 0.1 / 1.72},
                 {-1.6, 0.1, 0, 0.1 / 1.8}, {1.6, 0.01, 0.05, 0.075 / 1.62},
                 {4.9, 0, 0, 0.1 / 4.9},    {5.1, 0, 0, 0.02},
                 {50, 0, 0, 0.02}};
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        cut(0.5);
        struct origin origin = {.fixed = true};
        origin.channel[1].left = (real_t)cases[n].left;
        x->config.origin = &origin;
        c.model.fitted[1].gain = (real_t)cases[n].gain;
        c.model.fitted[1].gain_sd = (real_t)cases[n].sd;
        is_again();
        NEAR(cases[n].most, c.inputs.input[0].amplitude_most);
    }
}

static void where_the_reversal_has_no_room_it_says_so_in_the_end(void)
{
    x->cut = x->one_sided = true;
    is_again();
    fitted();
    x->cut = x->one_sided = true;
    x->culprit = 1;
    x->predicted = REAL_C(-0.3);
    x->config.repeats = false;
    ends(REASON_REVERSAL, "T10", -0.3);
}

static void asymmetric(unsigned j, int asymmetry)
{
    fitted();
    c.work->element[j][0].asymmetry = (int16_t)asymmetry;
}

static void what_is_not_linear_is_tried_with_less(void)
{
    for (unsigned j = 0; j < 2; j++)
        for (int sign = -1; sign <= 1; sign += 2) {
            asymmetric(j, sign * 499);
            is_kept();
            asymmetric(j, sign * 500);
            is_again();
            NEAR(0.04, c.inputs.input[0].amplitude_wanted); /* to 0.2 */
            TEST_ASSERT_EQUAL_UINT8(1, c.inputs.input[0].linear_retries);
            NEAR(0.04, said(EVENT_TEST_SMALLER)->value);
        }
    asymmetric(0, 800);
    c.work->element[1][0].asymmetry = 700;
    is_again();
    NEAR(0.025, c.inputs.input[0].amplitude_wanted);
    asymmetric(0, 800);
    x->record.input.edges = 4; /* it has grown: a smaller one does not stand out */
    is_kept();
    asymmetric(0, 800);
    c.inputs.input[0].rounds = 1;
    goes_on();
    TEST_ASSERT_EQUAL_UINT8(2, c.inputs.input[0].rounds);
    asymmetric(0, 800);
    x->cut = true;
    is_kept();
    asymmetric(0, 800);
    x->config.amplitude = REAL_C(0.1);
    is_kept();
    asymmetric(0, 800);
    c.inputs.input[0].linear_retries = 1;
    is_kept();
}

/* ---- the analysis ---- */

static void after_the_last_input_all_is_analysed(void)
{
    c.inputs.input[1].skipped = true;
    bench.s.time_ms = 77000;
    goes_on();
    TEST_ASSERT_EQUAL_INT(COMMISSION_ANALYSING, c.status.phase);
    TEST_ASSERT_TRUE(job_is_asked(&c.background.job));
    TEST_ASSERT_EQUAL_UINT8(TASK_ANALYSIS, c.background.task);
    TEST_ASSERT_EQUAL_UINT32(11, c.background.job.due); /* 20 s, and one */
    TEST_ASSERT_EQUAL_UINT32(0, c.background.job.ticks);
    TEST_ASSERT_FALSE(c.background.job.done);
    TEST_ASSERT_EQUAL_UINT32(2, c.background.job.number);
    TEST_ASSERT_EQUAL_UINT64(77000, c.status.phase_ms);
    TEST_ASSERT_EQUAL_UINT8(1, c.work->analysis.plant.inputs);
}

/* An analysis that leaves the pairing open, of gains known to a hundredth, where a two hundredth would be valid. */
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
    a->certainty.doubts = DOUBT_DRAWS;
    a->probability = REAL_C(0.75);
    a->config.floor = REAL_C(0.005);
    a->plant.outputs = a->plant.inputs = 2;
    for (unsigned j = 0; j < 2; j++)
        for (unsigned i = 0; i < 2; i++) {
            a->plant.element[j][i].gain = -2;
            a->plant.gain_sd[j][i] = REAL_C(0.0099);
        }
    a->plant.gain_sd[2][0] = a->plant.gain_sd[0][2] = 1; /* of no element */
    return a;
}

static void goes_round(bool again)
{
    goes_on();
    TEST_ASSERT_EQUAL_INT(again ? COMMISSION_TESTING : COMMISSION_READY, c.status.phase);
    TEST_ASSERT_EQUAL_UINT8(again ? 2 : 1, c.inputs.round);
    TEST_ASSERT_EQUAL(!again, c.status.analysed);
    TEST_ASSERT_EQUAL_UINT(again, happened(EVENT_TEST_EXTENDED, NULL));
    TEST_ASSERT_EQUAL_UINT(!again, happened(EVENT_NOT_DETERMINED, NULL));
    const struct event *e = said(again ? EVENT_TEST_EXTENDED : EVENT_NOT_DETERMINED);
    NEAR(0.75, e->value);
    TEST_ASSERT_EQUAL_UINT8(again ? 2 : 0, e->detail);
}

static void another_round_is_made_where_it_would_help(void)
{
    analysed();
    goes_round(false); /* every gain is as sure as a model can be */
    for (unsigned j = 0; j < 2; j++)
        for (unsigned i = 0; i < 2; i++) {
            analysed()->plant.gain_sd[j][i] = REAL_C(0.0101);
            goes_round(true);
        }
    analysed()->certainty.doubts = DOUBT_DRAWS | DOUBT_SHAPE;
    goes_round(true);
}

static void there_are_as_many_rounds_as_set(void)
{
    analysed()->plant.gain_sd[0][0] = 1;
    cf->test.rounds = 2;
    goes_round(true);
    analysed()->plant.gain_sd[0][0] = 1;
    cf->test.rounds = 1;
    goes_round(false);
}

static void inputs_that_a_longer_test_may_resolve_are_remembered(void)
{
    struct analysis *a = analysed();
    a->certainty.doubts = DOUBT_SHAPE;
    a->certainty.unsettled = 1 << 1;
    c.analysis_job.column[0] = 1; /* the other way round */
    c.analysis_job.column[1] = 0;
    c.inputs.input[1].unsettled = true;
    goes_on();
    TEST_ASSERT_TRUE(c.inputs.input[0].unsettled);
    TEST_ASSERT_FALSE(c.inputs.input[1].unsettled);
    TEST_ASSERT_EQUAL_UINT8(0, c.inputs.turn);
    a = analysed();
    a->certainty.doubts = DOUBT_SHAPE | DOUBT_DRAWS;
    c.inputs.input[0].skipped = true;
    goes_on();
    TEST_ASSERT_EQUAL_UINT8(1, c.inputs.turn);
}

static void where_nothing_else_is_open_only_inputs_that_want_longer_tests_are_tested_again(void)
{
    for (unsigned open = 0; open < 2; open++) {
        struct analysis *a = analysed();
        a->certainty.doubts = (uint8_t)(DOUBT_SHAPE | (open ? DOUBT_DRAWS : 0));
        a->certainty.unsettled = 1 << 1;
        c.inputs.input[0].skipped = false;
        goes_on();
        TEST_ASSERT_EQUAL_UINT8(open ? 0 : 1, c.inputs.turn);
    }
}

static void a_pairing_that_is_determined_is_proposed(void)
{
    struct analysis *a = analysed();
    a->verdict = PAIRING_DETERMINED;
    a->certainty.doubts = 0;
    a->designed = true;
    a->plant.gain_sd[0][0] = 1;
    bench.s.time_ms = 99000;
    goes_on();
    TEST_ASSERT_EQUAL_INT(COMMISSION_READY, c.status.phase);
    TEST_ASSERT_TRUE(c.status.analysed);
    TEST_ASSERT_EQUAL_UINT64(99000, c.status.phase_ms);
    TEST_ASSERT_EQUAL_UINT64(99000, c.status.ended_ms);
    NEAR(0.75, said(EVENT_PROPOSAL)->value);
    TEST_ASSERT_EQUAL_UINT8(1, said(EVENT_PROPOSAL)->detail);
    TEST_ASSERT_TRUE(commission_has_proposal(&c));
    c.status.phase = COMMISSION_ENDED;
    TEST_ASSERT_FALSE(commission_has_proposal(&c));
}

static void an_analysis_that_fails_ends_it(void)
{
    analysed();
    c.analysis_job.error = ERR_EMPTY;
    ends(REASON_NO_INPUT, "", 0.0);
    analysed();
    c.analysis_job.error = ERR_RANGE;
    ends(REASON_NUMBERS, "", (double)ERR_RANGE);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_result_is_taken_when_it_is_due_and_done);
    RUN_TEST(the_next_sample_waits_for_what_is_due_then);
    RUN_TEST(a_fit_that_fails_ends_it);
    RUN_TEST(samples_are_the_nearest_number_of_ticks);
    RUN_TEST(how_long_the_slowest_response_takes_is_a_measure_for_the_next);
    RUN_TEST(what_goes_on_climbing_gets_three_times_as_long);
    RUN_TEST(a_ramp_whose_slope_is_known_may_climb);
    RUN_TEST(three_times_a_half_is_made_longer);
    RUN_TEST(slow_is_what_has_a_time_constant_that_is_known_within_half);
    RUN_TEST(of_a_step_that_was_cut_the_fit_must_say_so_too);
    RUN_TEST(what_the_guard_has_cut_is_tried_with_less);
    RUN_TEST(the_smaller_step_leaves_half_of_the_room);
    RUN_TEST(where_the_reversal_has_no_room_it_says_so_in_the_end);
    RUN_TEST(what_is_not_linear_is_tried_with_less);
    RUN_TEST(after_the_last_input_all_is_analysed);
    RUN_TEST(another_round_is_made_where_it_would_help);
    RUN_TEST(there_are_as_many_rounds_as_set);
    RUN_TEST(inputs_that_a_longer_test_may_resolve_are_remembered);
    RUN_TEST(where_nothing_else_is_open_only_inputs_that_want_longer_tests_are_tested_again);
    RUN_TEST(a_pairing_that_is_determined_is_proposed);
    RUN_TEST(an_analysis_that_fails_ends_it);
    return UNITY_END();
}
