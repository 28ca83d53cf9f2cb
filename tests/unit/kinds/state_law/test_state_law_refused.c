/* What the kind `state_law` refuses, in a configuration and as the end of a design, and in which words; and what ends a design on its way. */
#include "state_law_bench.h"

void setUp(void)
{
    bench_pilot();
}

void tearDown(void)
{
    workspace_share(NULL);
}

/* ---- settings ---- */

static void refused(const char *field, const char *wanted)
{
    enum err err = check();
    TEST_ASSERT_EQUAL_MESSAGE(ERR_RANGE, err, wanted);
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(fault.wanted, wanted), fault.wanted);
}

#define REFUSED(change, field, wanted)                                                             \
    do {                                                                                           \
        bench_pilot();                                                                             \
        change;                                                                                    \
        refused(field, wanted);                                                                    \
    } while (0)

static void inputs_in_another_order_are_refused(void)
{
    REFUSED(setup.inputs = 8, "inputs", "as many MVs as loops");
    REFUSED(setup.input[0].is_mv = true, "inputs", "as many MVs as loops");
    REFUSED(setup.input[8].is_mv = setup.input[9].is_mv = false, "inputs", "as many MVs");
    REFUSED((no_inputs(), temperature_is(11), mvs_are()), "inputs", "one or two loops");
    REFUSED((no_inputs(), mvs_are()), "inputs", "one or two loops");
}

static void numbers_that_cannot_be_are_refused(void)
{
    REFUSED(settings.period_s = 0, "period", "interval of the loops");
    REFUSED(settings.tau_s[1] = 0, "tau", "above 0");
    TEST_ASSERT_EQUAL(1, fault.member);
}

static void what_an_input_cannot_be_of_the_column_is_refused(void)
{
    REFUSED(settings.role[9] = STATE_LAW_TEMPERATURE, "is", "where the input is an MV");
    REFUSED(settings.role[9] = STATE_LAW_FEED_FRACTION, "is", "where the input is an MV");
    REFUSED(settings.role[1] = STATE_LAW_FEED, "is", "what a loop controls");
    REFUSED(settings.role[9] = STATE_LAW_REFLUX, "is", "once");
    REFUSED(settings.role[9] = STATE_LAW_BOILUP, "is", "heat or boilup");
    REFUSED(settings.role[7] = STATE_LAW_FEED_QUALITY, "is", "temperature or quality");
    REFUSED(settings.place[3][STATE_LAW_STAGE] = 13, "place", "condenser");
    REFUSED(settings.place[3][STATE_LAW_STAGE] = 0, "place", "condenser");
    REFUSED(settings.place[2][STATE_LAW_COMPONENT] = 3, "place", "component of the table");
    REFUSED((by_feed(), settings.place[7][STATE_LAW_COMPONENT] = 2), "place", "not the closing");
}

static void a_table_that_is_none_or_too_large_is_refused(void)
{
    REFUSED(setup.named = NULL, "column", "in order");
    REFUSED(record.value[9] += 1, "column", "in order");
    REFUSED(PUT_RECORD(&record, splitter_values), "column", "16 mole fractions");
}

static void one_loop_and_one_without_a_table_are_accepted(void)
{
    no_inputs();
    temperature_is(11);
    temperature_is(9);
    input_is(STATE_LAW_REFLUX, 0, LITRE_AN_HOUR, (struct block_signal){0, 12, true});
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, check(), fault.wanted);
    settings.column = 0;
    setup.named = NULL;
    settings.role[0] = STATE_LAW_FEED; /* nobody looks at it */
    configure(false);
    TEST_ASSERT_EQUAL_STRING("column", tell("design"));
}

/* ---- designs ---- */

static void no_law(const char *words)
{
    configure(false);
    design();
    TEST_ASSERT_EQUAL(STATE_LAW_REFUSED, block()->stage);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told(), words), told());
    step(true);
    TEST_ASSERT_EQUAL(0, proposal.n);
}

static void inputs_that_leave_out_too_much_are_refused(void)
{
    settings.left = 1;
    no_law("inputs must be those that F needs: they leave out more of it than left allows");
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 1.125f, shown("left_of_F"));
}

static void inputs_that_tell_the_same_are_refused(void)
{
    settings.place[7][STATE_LAW_STAGE] = 11;
    no_law("inputs must be of stages of their own");
}

/* Both loops control the same tray. */
static void outputs_that_are_one_are_refused(void)
{
    settings.place[1][STATE_LAW_STAGE] = 11;
    no_law("no law: ");
    TEST_ASSERT_TRUE(strstr(told(), "b_star") || strstr(told(), "output"));
}

static void an_integral_that_makes_the_loop_unstable_is_refused(void)
{
    settings.ti_s[0] = settings.ti_s[1] = 5;
    no_law("ti must be longer: with it the loop is not stable");
}

/* exp(-30/1e12) is 1. */
static void a_law_that_is_refused_for_a_loop_tells_which(void)
{
    settings.tau_s[1] = 1e12f;
    configure(false);
    design();
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told(), "tau must be stable"), told());
    TEST_ASSERT_EQUAL(2, block()->found.loop);
}

/* The end trays alone stand for most of a fast law, but not for enough of it. */
static void a_loop_that_inputs_alone_make_unstable_is_refused(void)
{
    no_inputs();
    temperature_is(11);
    temperature_is(2);
    mvs_are();
    settings.left = 100;
    settings.ti_s[0] = settings.ti_s[1] = 0;
    no_law("with what they tell alone the loop is not stable");
    TEST_ASSERT_TRUE(shown("radius") < 1 && shown("radius_by_inputs") >= 1);
}

/* ---- on the way ---- */

static void somebody_has_the_workspace(void)
{
    void *at;
    TEST_ASSERT_EQUAL(ERR_OK,
                      workspace_lease(&workspace, "start-up", "commission abort", 1000, &at));
    no_law("no workspace; start-up has it; `commission abort` frees it");
    workspace_frees(&workspace, "start-up", NULL);
    design();
    TEST_ASSERT_EQUAL(STATE_LAW_DONE, block()->stage);
}

static void there_is_no_workspace(void)
{
    workspace_share(NULL);
    no_law("no workspace");
}

/* The job has its memory, and so many pieces are done. */
static void half_way(unsigned n)
{
    configure(false);
    TEST_ASSERT_NULL(tell("design"));
    step(false);
    io.requests.work_done = true;
    kind->step(state, &io);
    job_asked = false;
    TEST_ASSERT_EQUAL(STATE_LAW_DESIGNS, block()->stage);
    for (unsigned k = 0; k < n; k++)
        TEST_ASSERT_TRUE(kind->work(state));
}

static void is_over(const char *words)
{
    TEST_ASSERT_EQUAL(STATE_LAW_REFUSED, block()->stage);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told(), words), told());
    TEST_ASSERT_NULL(block()->job);
    TEST_ASSERT_FALSE(kind->work(state));
    TEST_ASSERT_NULL(workspace.frees);
    step(false);
    TEST_ASSERT_EQUAL(1u << STATE_LAW_EVENT_REFUSED, io.requests.raised);
}

static void another_table_ends_a_design(void)
{
    static struct column_record other;
    for (unsigned n = 0; n < 19; n += 3) {
        bench_pilot();
        half_way(n);
        PUT_RECORD(&other, pilot_values);
        setup.named = &other;
        configure(true);
        is_over("have changed while it was being found");
        design();
        TEST_ASSERT_EQUAL(STATE_LAW_DONE, block()->stage);
    }
}

/* A table that is written again stands where it stood. */
static void the_same_table_with_other_numbers_ends_a_design(void)
{
    half_way(5);
    PUT_RECORD(&record, splitter_values);
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(state, &setup, true));
    is_over("have changed while it was being found");
}

static void a_law_for_other_settings_is_not_proposed(void)
{
    configure(false);
    design();
    TEST_ASSERT_EQUAL(STATE_LAW_DONE, block()->stage);
    settings.tau_s[0] = 50;
    configure(true);
    for (unsigned k = 0; k < 3; k++) {
        step(true);
        TEST_ASSERT_EQUAL(0, proposal.n);
    }
}

static void other_settings_end_a_design_and_a_law_by_hand_does_not(void)
{
    half_way(5);
    settings.g[0][0] = 1;
    configure(true);
    TEST_ASSERT_EQUAL(STATE_LAW_DESIGNS, block()->stage);
    settings.tau_s[0] = 50;
    configure(true);
    is_over("have changed while it was being found");
}

static void a_workspace_that_is_taken_away_ends_it(void)
{
    half_way(5);
    for (unsigned k = 0; k < WORKSPACE_TICKS + 2u; k++)
        workspace_tick(&workspace); /* a block that makes no steps */
    void *at;
    TEST_ASSERT_EQUAL(ERR_OK,
                      workspace_lease(&workspace, "start-up", "commission abort", 1000, &at));
    step(false);
    TEST_ASSERT_EQUAL(STATE_LAW_REFUSED, block()->stage);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told(), "start-up has it"), told());
}

static void it_is_stopped(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, check());
    configure(false);
    TEST_ASSERT_EQUAL_STRING("runs not", tell("stop"));
    half_way(5);
    TEST_ASSERT_EQUAL_STRING("runs", tell("design"));
    TEST_ASSERT_NULL(tell("stop"));
    is_over("stopped");
}

/* The plan gives work up where something else of the block changes. */
static void work_that_was_given_up_is_asked_for_again(void)
{
    half_way(5);
    io.requests.work_done = false;
    step(false);
    step(false);
    TEST_ASSERT_EQUAL_MESSAGE(STATE_LAW_DONE, block()->stage, told());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(inputs_in_another_order_are_refused);
    RUN_TEST(numbers_that_cannot_be_are_refused);
    RUN_TEST(what_an_input_cannot_be_of_the_column_is_refused);
    RUN_TEST(a_table_that_is_none_or_too_large_is_refused);
    RUN_TEST(one_loop_and_one_without_a_table_are_accepted);
    RUN_TEST(inputs_that_leave_out_too_much_are_refused);
    RUN_TEST(inputs_that_tell_the_same_are_refused);
    RUN_TEST(outputs_that_are_one_are_refused);
    RUN_TEST(an_integral_that_makes_the_loop_unstable_is_refused);
    RUN_TEST(a_law_that_is_refused_for_a_loop_tells_which);
    RUN_TEST(a_loop_that_inputs_alone_make_unstable_is_refused);
    RUN_TEST(somebody_has_the_workspace);
    RUN_TEST(there_is_no_workspace);
    RUN_TEST(another_table_ends_a_design);
    RUN_TEST(the_same_table_with_other_numbers_ends_a_design);
    RUN_TEST(a_law_for_other_settings_is_not_proposed);
    RUN_TEST(other_settings_end_a_design_and_a_law_by_hand_does_not);
    RUN_TEST(a_workspace_that_is_taken_away_ends_it);
    RUN_TEST(it_is_stopped);
    RUN_TEST(work_that_was_given_up_is_asked_for_again);
    return UNITY_END();
}
