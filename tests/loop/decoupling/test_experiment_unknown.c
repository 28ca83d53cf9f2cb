/* The kind `experiment` where there is no model to be had: it has to say so, and why. */
#include "experiment_plant.h"

static const struct experiment_case kotyk = KOTYK_COLUMN("band.1 1.9", "band.2 2.9");
/* Its first output integrates. */
static const struct experiment_case integrating = {
    DECOUPLING "/integrating.json",
    120000,
    2,
    {"y1", "y2"},
    {"u1", "u2"},
    {"bits 7", "clock 4", "amplitude.1 0.5", "amplitude.2 0.5", "band.1 1.9", "band.2 2.9"}};
/* Not linear, and slower than the sequence is long. */
static const struct experiment_case pilot = {"pilot",
                                             30000,
                                             2,
                                             {"T1", "T9"},
                                             {"Lr", "Qrb"},
                                             {"bits 6", "clock 2", "periods 4", "amplitude.1 0.3",
                                              "amplitude.2 0.05", "band.1 10", "band.2 20"}};

/* Four by four, of which the model does not fit into settings. */
static const struct experiment_case furnace = {
    "furnace",
    10000,
    4,
    {"y1", "y2", "y3", "y4"},
    {"u1", "u2", "u3", "u4"},
    {"period 60", "cutoff 0.5", "bits 7", "clock 5", "periods 1", "nb 6", "amplitude.1 5",
     "amplitude.2 5", "amplitude.3 5", "amplitude.4 5", "band.1 100", "band.2 100", "band.3 100",
     "band.4 100"}};

static const double furnace_gain[4][4] = {
    {1, 0.7, 0.3, 0.2}, {0.6, 1, 0.4, 0.35}, {0.35, 0.4, 1, 0.6}, {0.2, 0.3, 0.7, 1}};

static void run(const struct experiment_case *c, unsigned most)
{
    ask_ok("block 1 start");
    (void)until_over(1, most);
    TEST_ASSERT_EQUAL_MESSAGE(DONE, stage_of(1), c->plant);
}

static void nothing_is_proposed(int verdict, int at_fault)
{
    TEST_ASSERT_EQUAL(verdict, (int)value_of(1, "verdict"));
    if (at_fault)
        TEST_ASSERT_EQUAL(at_fault, (int)value_of(1, "at_fault"));
    plant_steps(5);
    ask_ok("events");
    TEST_ASSERT_TRUE(said("block1.no_model"));
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("proposes"));
    ask_ok("get block1.known");
    TEST_ASSERT_TRUE(said("= off"));
}

static void a_plant_that_integrates_has_no_gains(void)
{
    for (uint64_t seed = 1; seed < 4; seed++) {
        begin_case(&integrating, seed, 200);
        run(&integrating, 4000);
        TEST_ASSERT_TRUE(value_of(1, "fit_1") > 90); /* though the record is followed */
        nothing_is_proposed(SLOW, 1);
        plant_power_off();
    }
}

static void a_column_slower_than_the_sequence_is_not_known(void)
{
    for (uint64_t seed = 1; seed < 4; seed++) {
        begin_case(&pilot, seed, 200);
        run(&pilot, 4000);
        nothing_is_proposed(POOR, 1);
        plant_power_off();
    }
}

static void amplitudes_below_the_noise_tell_nothing(void)
{
    begin_case(&kotyk, 1, 200);
    ask_ok("set block1.amplitude.1 0.005");
    ask_ok("set block1.amplitude.2 0.005");
    plant_steps(2);
    run(&kotyk, 4000);
    nothing_is_proposed(POOR, 1);
}

static void a_measurement_that_stands_still_unnoticed_has_no_model(void)
{
    begin_case(&kotyk, 1, 200);
    ask_ok("block 1 start");
    plant_steps(100);
    plant_event("y2.frozen=1");
    (void)until_over(1, 4000);
    nothing_is_proposed(POOR, 2);
}

/* Both valves stand still, and the plant says so: nothing was excited. */
static void inputs_that_did_not_move_tell_nothing(void)
{
    begin_case(&kotyk, 1, 200);
    plant_event("u1.stuck=0.5");
    plant_event("u2.stuck=0.5");
    run(&kotyk, 4000);
    TEST_ASSERT_TRUE(value_of(1, "verdict") > 1.5);
    nothing_is_proposed((int)value_of(1, "verdict"), 0);
}

/* ---- loops in automatic ---- */

static void close_loops(const char *gain)
{
    static const char *const lines[] = {"set loop1.action reverse", "set loop1.ti 500",
                                        "set loop2.action direct",  "set loop2.ti 1200",
                                        "set block1.reach.1 4.9",   "set block1.reach.2 4.9"};
    char line[40];
    begin_case(&kotyk, 1, 200);
    for (unsigned k = 0; k < 6; k++)
        ask_ok(lines[k]);
    for (unsigned k = 1; k <= 2; k++) {
        snprintf(line, sizeof line, "set loop%u.gain %s", k, gain);
        ask_ok(line);
    }
    plant_steps(2);
    ask_ok("mode l1 auto");
    ask_ok("mode l2 auto");
    plant_steps(40);
}

static void slow_loops_may_act_meanwhile(void)
{
    close_loops("0.7");
    run(&kotyk, 4000);
    TEST_ASSERT_TRUE(value_of(1, "others_1") > 0.01);
    TEST_ASSERT_EQUAL(USABLE, (int)value_of(1, "verdict"));
    TEST_ASSERT_DOUBLE_WITHIN(0.005, kotyk_gain[0][0], value_of(1, "gain11"));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, kotyk_gain[1][1], value_of(1, "gain22"));
}

static void loops_that_move_the_inputs_themselves_leave_instruments_without_a_model(void)
{
    close_loops("1.7");
    run(&kotyk, 4000);
    TEST_ASSERT_TRUE(value_of(1, "others_1") > 0.25 || value_of(1, "others_2") > 0.25);
    nothing_is_proposed(LOOPS, 0);
}

/* ---- four by four ---- */

static void a_model_of_four_is_shown_and_not_proposed(void)
{
    begin_case(&furnace, 1, 400);
    run(&furnace, 20000);
    TEST_ASSERT_EQUAL(USABLE, (int)value_of(1, "verdict"));
    for (unsigned i = 0; i < 4; i++)
        for (unsigned j = 0; j < 4; j++) {
            char name[16];
            snprintf(name, sizeof name, "gain%u%u", i + 1, j + 1);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.03, furnace_gain[i][j], value_of(1, name), name);
        }
    TEST_ASSERT_TRUE(fabs(value_of(1, "b44_2")) > 0.001);
    plant_steps(5);
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("proposes"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_plant_that_integrates_has_no_gains);
    RUN_TEST(a_column_slower_than_the_sequence_is_not_known);
    RUN_TEST(amplitudes_below_the_noise_tell_nothing);
    RUN_TEST(a_measurement_that_stands_still_unnoticed_has_no_model);
    RUN_TEST(inputs_that_did_not_move_tell_nothing);
    RUN_TEST(slow_loops_may_act_meanwhile);
    RUN_TEST(loops_that_move_the_inputs_themselves_leave_instruments_without_a_model);
    RUN_TEST(a_model_of_four_is_shown_and_not_proposed);
    return UNITY_END();
}
