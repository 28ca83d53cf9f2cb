/* The kind `experiment` from its verb to a proposal, over the real link, on plants whose gains are known. */
#include "experiment_plant.h"
#include "sample.h"

static const struct experiment_case kotyk = KOTYK_COLUMN("band.1 0.8", "band.2 1.2");
/* Two base ticks to a sample, with a filter before one of them is kept. */
static const struct experiment_case wood_berry = {"wood-berry",
                                                  60000,
                                                  2,
                                                  {"xD", "xB"},
                                                  {"R", "S"},
                                                  {"period 120", "cutoff 0.5", "bits 7", "clock 4",
                                                   "amplitude.1 0.05", "amplitude.2 0.05",
                                                   "band.1 4", "band.2 6"}};
/* The slowest lag is ten times the others. */
static const struct experiment_case kiln = {"lime-kiln",
                                            30000,
                                            2,
                                            {"y1", "y2"},
                                            {"u1", "u2"},
                                            {"period 60", "cutoff 0.5", "bits 7", "clock 4",
                                             "amplitude.1 5", "amplitude.2 5", "band.1 40",
                                             "band.2 40"}};

/* The largest error of the model's gains in a row, as a part of the largest of the row. */
static double worst_gain(const double gain[2][2], unsigned i)
{
    char name[16];
    double worst = 0, largest = fmax(fabs(gain[i][0]), fabs(gain[i][1]));
    for (unsigned j = 0; j < 2; j++) {
        snprintf(name, sizeof name, "gain%u%u", i + 1, j + 1);
        worst = fmax(worst, fabs(value_of(1, name) - gain[i][j]));
    }
    return worst / largest;
}

static const double wood_berry_gain[2][2] = {{12.8, -18.9}, {6.6, -19.4}};
static const double kiln_gain[2][2] = {{1.66, -1.74}, {0.34, 1.4}};

static void run_case(const struct experiment_case *c, uint64_t seed)
{
    begin_case(c, seed, 400);
    ask_ok("block 1 start");
    (void)until_over(1, 8000);
    TEST_ASSERT_EQUAL(DONE, stage_of(1));
}

/* ---- figures ---- */

static void the_papers_column_is_found_within_three_percent(void)
{
    for (uint64_t seed = 1; seed <= (sample_every_case ? 5 : 2); seed++) {
        run_case(&kotyk, seed);
        TEST_ASSERT_EQUAL(USABLE, (int)value_of(1, "verdict"));
        for (unsigned i = 0; i < 2; i++)
            TEST_ASSERT_TRUE(worst_gain(kotyk_gain, i) < 0.03);
        plant_power_off();
    }
}

/* Dead times of 1 to 7 min, lags that differ from input to input though A is one of the row, and the filter as part of it. */
static void wood_and_berrys_is_found_within_the_tenth_that_is_promised(void)
{
    for (uint64_t seed = 1; seed <= (sample_every_case ? 5 : 2); seed++) {
        run_case(&wood_berry, seed);
        TEST_ASSERT_EQUAL(USABLE, (int)value_of(1, "verdict"));
        for (unsigned i = 0; i < 2; i++)
            TEST_ASSERT_TRUE(worst_gain(wood_berry_gain, i) < 0.1);
        plant_power_off();
    }
}

/* Lags of 39 and 4 min in one row are hard: what is said to be usable is right within what is promised, the rest is refused. */
static void no_model_of_the_lime_kiln_is_wrong_and_said_to_be_usable(void)
{
    unsigned usable = 0;
    for (uint64_t seed = 1; seed <= (sample_every_case ? 10 : 4); seed++) {
        run_case(&kiln, seed);
        for (unsigned i = 0; i < 2 && value_of(1, "verdict") < 1.5; i++, usable++)
            TEST_ASSERT_TRUE(worst_gain(kiln_gain, i) < 0.15);
        plant_power_off();
    }
    printf("lime kiln: %u rows of models said to be usable\n", usable);
}

static void with_too_few_powers_in_b_the_lime_kilns_gains_are_not_proposed(void)
{
    begin_case(&kiln, 3, 400);
    ask_ok("set block1.nb 6");
    plant_steps(2);
    ask_ok("block 1 start");
    (void)until_over(1, 8000);
    TEST_ASSERT_EQUAL(DONE, stage_of(1));
    TEST_ASSERT_EQUAL(UNSURE, (int)value_of(1, "verdict"));
    TEST_ASSERT_TRUE(value_of(1, "fit_1") > 85); /* though it follows the record */
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("proposes"));
}

/* ---- the record ---- */

static void the_inputs_move_both_ways_by_their_amplitude_and_return(void)
{
    double least = 9, most = -9;
    begin_case(&kotyk, 2, 60);
    ask_ok("block 1 start");
    plant_steps(22);
    TEST_ASSERT_EQUAL(SETTLES, stage_of(1));
    TEST_ASSERT_EQUAL_DOUBLE(0, commanded("u1"));
    for (unsigned k = 0; k < 1000; k++) {
        plant_step();
        least = fmin(least, commanded("u2"));
        most = fmax(most, commanded("u2"));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -1, least);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1, most);
    (void)until_over(1, 400);
    TEST_ASSERT_EQUAL_DOUBLE(0, commanded("u1"));
    TEST_ASSERT_EQUAL_DOUBLE(0, commanded("u2"));
}

static void while_it_runs_the_recursive_estimate_comes_near(void)
{
    begin_case(&kotyk, 4, 60);
    ask_ok("block 1 start");
    plant_steps(600);
    TEST_ASSERT_EQUAL(EXCITES, stage_of(1));
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * kotyk_gain[0][0], kotyk_gain[0][0], value_of(1, "gain11"));
    TEST_ASSERT_TRUE(value_of(1, "live_1") > 0 && value_of(1, "live_1") < 1);
    TEST_ASSERT_DOUBLE_WITHIN(1, 100.0 * value_of(1, "samples") / 1016, value_of(1, "percent"));
}

static void the_same_log_gives_the_same_model(void)
{
    double first[2];
    for (unsigned k = 0; k < 2; k++) {
        memory_port_erase_all();
        run_case(&kotyk, 7);
        first[k] = value_of(1, "gain22");
        plant_power_off();
    }
    TEST_ASSERT_EQUAL_DOUBLE(first[0], first[1]);
}

/* ---- proposals ---- */

static void accept_it(void)
{
    ask_ok("proposal accept");
    plant_steps(4);
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("proposes"));
}

static void a_usable_model_of_two_by_two_is_accepted_at_once(void)
{
    run_case(&kotyk, 3);
    plant_step();
    ask_ok("get block1.known");
    TEST_ASSERT_TRUE(said("= off"));
    accept_it();
    ask_ok("get block1.known");
    TEST_ASSERT_TRUE(said("= on"));
    double at_rest = 1, sum = 0;
    char name[20];
    for (unsigned k = 1; k <= 4; k++) {
        snprintf(name, sizeof name, "block1.a1_%u", k);
        at_rest += setting_of(name);
    }
    for (unsigned k = 1; k <= 8; k++) {
        snprintf(name, sizeof name, "block1.b11_%u", k);
        sum += setting_of(name);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * kotyk_gain[0][0], kotyk_gain[0][0], sum / at_rest);
}

static void stop_withdraws_a_model_that_nobody_has_accepted(void)
{
    run_case(&kotyk, 3);
    plant_step();
    ask_ok("block 1 stop");
    plant_steps(2);
    TEST_ASSERT_TRUE(said("PROPOSAL_WITHDRAWN experiment 1"));
    ask_refused("proposal accept", "STATE");
}

static void a_second_model_takes_the_place_of_the_first(void)
{
    run_case(&kotyk, 3);
    plant_step();
    accept_it();
    ask_ok("block 1 start");
    plant_steps(3);
    (void)until_over(1, 3000);
    TEST_ASSERT_EQUAL(DONE, stage_of(1));
    plant_step();
    accept_it();
    ask_ok("get block1.known");
    TEST_ASSERT_TRUE(said("= on"));
}

static void what_is_rejected_is_not_proposed_again(void)
{
    run_case(&kotyk, 3);
    plant_step();
    ask_ok("proposal reject");
    plant_steps(5);
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("proposes"));
    ask_ok("get block1.known");
    TEST_ASSERT_TRUE(said("= off"));
}

static void at_once_it_is_in_force_without_anybody(void)
{
    begin_case(&kotyk, 3, 100);
    ask_ok("set block1.adopt at_once");
    plant_steps(2);
    ask_ok("block 1 start");
    (void)until_over(1, 3000);
    plant_steps(20);
    ask_ok("get block1.known");
    TEST_ASSERT_TRUE(said("= on"));
    ask_ok("save");
}

static void an_accepted_model_is_there_after_a_restart(void)
{
    at_once_it_is_in_force_without_anybody();
    plant_steps(30);
    double a = setting_of("block1.a1_1");
    plant_power_off();
    plant_power_on("kotyk-column", 120000, 3, 1);
    pass(3000);
    TEST_ASSERT_EQUAL_DOUBLE(a, setting_of("block1.a1_1"));
    ask_ok("get block1.known");
    TEST_ASSERT_TRUE(said("= on"));
}

int main(int argc, char **argv)
{
    sample_arguments(argc, argv);
    UNITY_BEGIN();
    RUN_TEST(the_papers_column_is_found_within_three_percent);
    RUN_TEST(wood_and_berrys_is_found_within_the_tenth_that_is_promised);
    RUN_TEST(no_model_of_the_lime_kiln_is_wrong_and_said_to_be_usable);
    RUN_TEST(with_too_few_powers_in_b_the_lime_kilns_gains_are_not_proposed);
    RUN_TEST(the_inputs_move_both_ways_by_their_amplitude_and_return);
    RUN_TEST(while_it_runs_the_recursive_estimate_comes_near);
    RUN_TEST(the_same_log_gives_the_same_model);
    RUN_TEST(a_usable_model_of_two_by_two_is_accepted_at_once);
    RUN_TEST(stop_withdraws_a_model_that_nobody_has_accepted);
    RUN_TEST(a_second_model_takes_the_place_of_the_first);
    RUN_TEST(what_is_rejected_is_not_proposed_again);
    RUN_TEST(at_once_it_is_in_force_without_anybody);
    RUN_TEST(an_accepted_model_is_there_after_a_restart);
    return UNITY_END();
}
