/* The kind `ff_tune` in orders of events it was not made for: an element that is not the one it takes it for, others who have the settings
 * open, a proposal that waits, gaps, an MV at its limit, two blocks on one loop. */
#include "unlike_bench.h"

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

/* ---- its element ---- */

static void an_element_that_is_not_there_is_refused_when_it_is_proposed(void)
{
    static const char *const other[] = {"set block1.element 5", NULL};
    begin_unlike(&usual, 0);
    settle(other);
    tune_whole(0);
    TEST_ASSERT_EQUAL(IDLE, tune_value("stage"));
    TEST_ASSERT_EQUAL(REJECTED, tune_value("verdict"));
    TEST_ASSERT_TRUE(gain_is_off("ff1"));
}

static void an_element_that_does_nothing_is_identified_anew_three_times_and_then_goes_off(void)
{
    static const char *const other[] = {"set ff1.from em", NULL};
    begin_unlike(&usual, 0);
    settle(other);
    tune_whole(0);
    TEST_ASSERT_EQUAL(RUNS, tune_value("stage"));
    tune_seconds(30000);
    for (unsigned k = 0; k < 2; k++) {
        TEST_ASSERT_EQUAL(IDLE, tune_value("stage"));
        TEST_ASSERT_EQUAL(NO_BETTER, tune_value("verdict"));
        TEST_ASSERT_TRUE(gain_is_off("ff1"));
        tune_seconds(3000);
    }
}

/* ---- others who have the settings ---- */

static const char *const wrong_sign[] = {"set ff1.gain 0.47", "set block1.k 0.47", NULL};

static void one_that_waits_to_be_switched_off_counts_once(void)
{
    begin_unlike(&usual, 0);
    tune_whole(0);
    settle(wrong_sign);
    ask_ok("begin");
    tune_seconds(3000);
    TEST_ASSERT_EQUAL(1, tune_value("tried"));
    ask_ok("set block1.check 1200");
    ask_ok("apply");
    tune_seconds(100);
    TEST_ASSERT_EQUAL(1, tune_value("tried"));
    TEST_ASSERT_EQUAL(DISTURBANCE, tune_value("stage"));
}

/* Its lag is longer than the disturbance rests: calm is not waited for as long as that takes. */
static void a_slow_element_that_is_worse_is_off_within_half_of_check(void)
{
    static const char *const slow[] = {"set ff1.gain 0.6", "set block1.k 0.6", "set ff1.lag 300",
                                       "set block1.lag 300", NULL};
    begin_unlike(&usual, 0);
    course.period = 1000;
    tune_whole(0);
    TEST_ASSERT_EQUAL(RUNS, tune_value("stage"));
    tune_seconds(1200);
    settle(slow);
    tune_seconds(600);
    TEST_ASSERT_EQUAL(1, tune_value("tried"));
    TEST_ASSERT_TRUE(gain_is_off("ff1"));
}

static void other_settings_forget_that_it_was_to_be_identified_anew(void)
{
    static const char *const off[] = {"set ff1.gain 0", "set block1.k 0", NULL};
    begin_unlike(&usual, 0);
    tune_whole(0);
    settle(wrong_sign);
    ask_ok("begin");
    tune_seconds(3000);
    TEST_ASSERT_EQUAL(WORSE, tune_value("verdict"));
    ask_ok("set block1.settled 12");
    ask_ok("apply");
    tune_seconds(100);
    TEST_ASSERT_EQUAL(NONE, tune_value("verdict"));
    settle(off);
    tune_seconds(100);
    TEST_ASSERT_TRUE(gain_is_off("ff1"));
    TEST_ASSERT_EQUAL(IDLE, tune_value("stage"));
}

/* ---- a proposal that waits ---- */

static void to_proposal(void)
{
    static const char *const ask_first[] = {"set block1.adopt ask", NULL};
    begin_unlike(&usual, 0);
    settle(ask_first);
    ask_ok("save");
    tune_whole(0);
    TEST_ASSERT_EQUAL(PROPOSES, tune_value("stage"));
}

static void a_power_cut_forgets_a_proposal_that_waits(void)
{
    to_proposal();
    plant_power_off();
    plant_power_on(FEEDFORWARD "/unlike.json", 1000, 7, 1);
    pass(3000);
    plant_connect();
    plant_steps(50);
    ask_ok("proposal");
    TEST_ASSERT_TRUE(said("no block has proposed anything"));
    TEST_ASSERT_EQUAL(IDLE, tune_value("stage"));
    TEST_ASSERT_TRUE(gain_is_off("ff1"));
}

static void is_withdrawn(void)
{
    TEST_ASSERT_TRUE(said(" info PROPOSAL_WITHDRAWN ff_tune 1 "));
    ask_refused("proposal accept", "STATE");
    TEST_ASSERT_TRUE(gain_is_off("ff1"));
}

static void stop_withdraws_a_proposal(void)
{
    to_proposal();
    ask_ok("block 1 stop");
    plant_steps(2);
    is_withdrawn();
    TEST_ASSERT_EQUAL(STOPPED, tune_value("verdict"));
}

/* The model, which would watch it, is gone with them. */
static void other_settings_withdraw_a_proposal(void)
{
    to_proposal();
    ask_ok("set block1.settled 12");
    plant_steps(2);
    is_withdrawn();
    TEST_ASSERT_EQUAL(IDLE, tune_value("stage"));
}

static void what_makes_the_loop_worse_withdraws_what_was_to_come_in_its_place(void)
{
    to_proposal();
    settle(wrong_sign);
    board_forget();
    for (unsigned k = 0; k < 200 && !said("SWITCHED_OFF"); k++)
        tune_seconds(20);
    plant_steps(2);
    TEST_ASSERT_TRUE(said(" info PROPOSAL_WITHDRAWN ff_tune 1 "));
    TEST_ASSERT_TRUE(gain_is_off("ff1"));
}

/* ---- what is not watched ---- */

static double does_to_the_bit(double before)
{
    double now = value_of(1, "does");
    TEST_ASSERT_TRUE(before > 85);
    TEST_ASSERT_TRUE(now >= before && now <= before);
    return now;
}

static void nothing_is_watched_while_setpoints_move(void)
{
    begin_unlike(&usual, 0);
    tune_whole(0);
    tune_seconds(1500);
    ask_ok("sp one 1");
    tune_seconds(2); /* what was measured before it */
    double before = value_of(1, "does");
    for (unsigned k = 0; k < 20; k++) {
        tune_seconds(90);
        ask_ok(k & 1 ? "sp one 1" : "sp one 0");
        before = does_to_the_bit(before);
    }
    tune_seconds(300);
    TEST_ASSERT_TRUE(value_of(1, "does") < before || value_of(1, "does") > before);
}

static void nothing_is_watched_while_a_reading_is_missing(void)
{
    begin_unlike(&usual, 0);
    tune_whole(0);
    tune_seconds(1500);
    plant_event("dm.quality=2");
    tune_second(); /* what was measured before it */
    double before = value_of(1, "does");
    tune_seconds(300);
    (void)does_to_the_bit(before);
}

/* ---- gaps ---- */

/* In hand the block has no turn; what the models look back at has a gap then. */
static void after_a_while_in_hand_nothing_is_learnt_for_as_long_as_the_model_looks_back(void)
{
    static const char *const no_signal[] = {"set block1.step 0", NULL};
    begin_unlike(&usual, 0);
    settle(no_signal);
    ask_ok("block 1 tune");
    tune_seconds(600);
    TEST_ASSERT_EQUAL(1, tune_value("learns"));
    ask_ok("mode one manual");
    tune_seconds(100);
    ask_ok("mode one auto");
    tune_seconds(30);
    TEST_ASSERT_EQUAL(DISTURBANCE, tune_value("stage"));
    TEST_ASSERT_EQUAL(0, tune_value("learns"));
    tune_seconds(100);
    TEST_ASSERT_EQUAL(1, tune_value("learns"));
}

/* One tick of five, wherever in the sample. */
static void a_reading_that_is_missing_for_a_tick_spoils_its_sample(void)
{
    static const char *const slower[] = {"set block1.step 0", "set block1.period 5", NULL};
    begin_unlike(&usual, 0);
    settle(slower);
    ask_ok("block 1 tune");
    for (unsigned phase = 0; phase < 5; phase++) {
        tune_seconds(601);
        TEST_ASSERT_EQUAL(1, tune_value("learns"));
        plant_event("dm.quality=2");
        tune_second();
        plant_event("dm.quality=0");
        tune_seconds(10);
        TEST_ASSERT_EQUAL(0, tune_value("learns"));
    }
}

static void a_setpoint_under_way_is_not_learnt_as_the_disturbance(void)
{
    begin_unlike(&usual, 1);
    course.quiet = true;
    ask_ok("block 1 tune");
    for (unsigned k = 0; k < 1000 && tune_value("stage") != DISTURBANCE; k++)
        tune_seconds(20);
    course.quiet = false;
    tune_seconds(600);
    TEST_ASSERT_EQUAL(1, tune_value("learns"));
    ask_ok("sp one 0.5");
    tune_seconds(60);
    TEST_ASSERT_EQUAL(0, tune_value("learns"));
    tune_seconds(200);
    TEST_ASSERT_EQUAL(1, tune_value("learns"));
}

/* The plant's clock stands while its samples go on: the board takes the loop off it, and with that the stage is over. */
static void a_clock_that_stands_still_ends_the_stage_as_a_lost_plant_does(void)
{
    begin_unlike(&usual, 0);
    ask_ok("block 1 tune");
    tune_seconds(600);
    uint32_t tick = board.tick_ms;
    board.tick_ms = 0;
    plant_steps(100);
    board.tick_ms = tick;
    TEST_ASSERT_TRUE(loop_is("one", "manual"));
    plant_steps(2);
    ask_ok("mode one auto");
    plant_step();
    ask_ok("sp one 0");
    tune_seconds(60);
    TEST_ASSERT_EQUAL(IDLE, tune_value("stage"));
    TEST_ASSERT_TRUE(tune_value("verdict") > SIGNAL);
    tune_whole(0);
    TEST_ASSERT_EQUAL(ADOPTED, tune_value("verdict"));
}

/* ---- what the models do not allow for ---- */

/* It is off again, and the loop is what it was. */
static void what_was_found_at_a_limit_of_the_mv_does_not_stay(unsigned method)
{
    static const char *const narrow[] = {"set loop1.out_hi 0.51", "set loop1.out_lo 0.49", NULL};
    begin_unlike(&usual, method);
    settle(narrow);
    tune_seconds(1200);
    double before = mean_square(1200);
    tune_whole(method);
    tune_seconds(2400);
    TEST_ASSERT_TRUE_MESSAGE(gain_is_off("ff1"), methods[method]);
    tune_seconds(9000);
    course.quiet = true;
    ask(tune_value("stage") == IDLE ? "get ff1.gain" : "block 1 stop");
    course.quiet = false;
    tune_seconds(600);
    TEST_ASSERT_TRUE_MESSAGE(mean_square(1200) < 1.1 * before, methods[method]);
    plant_power_off();
}

static void no_method_leaves_an_element_on_where_the_mv_is_always_at_a_limit(void)
{
    for (unsigned m = 0; m < METHODS; m++)
        what_was_found_at_a_limit_of_the_mv_does_not_stay(m);
}

static void a_disturbance_that_moves_with_the_setpoint_does_no_harm(void)
{
    static const char *const no_signal[] = {"set block1.step 0", NULL};
    for (unsigned m = 0; m < METHODS; m++) {
        begin_unlike(&usual, m);
        double before = mean_square(1200);
        settle(no_signal);
        ask_ok("block 1 tune");
        for (unsigned k = 0; k < 60; k++) {
            ask_ok(k & 1 ? "sp one 1" : "sp one -1");
            set_disturbance(k & 1 ? 1 : -1);
            plant_steps(200);
        }
        ask_ok("sp one 0");
        tune_seconds(1200);
        TEST_ASSERT_TRUE_MESSAGE(mean_square(1200) < 1.02 * before, methods[m]);
        plant_power_off();
    }
}

/* ---- two blocks on one loop ---- */

static const char *const second[] = {"set ff2.from em",
                                     "set ff2.to u",
                                     "set block2.kind ff_tune",
                                     "set block2.loops one",
                                     "set block2.inputs y,em",
                                     "set block2.gain 0.65",
                                     "set block2.ti 13.2",
                                     "set block2.learn 3000",
                                     "set block2.check 1200",
                                     "set block2.step 1",
                                     "set block2.adopt at_once",
                                     "set block2.step_period 400",
                                     "set block2.dead_most 20",
                                     "set block2.lag_most 60",
                                     "set block2.element 2",
                                     "set block2.method input",
                                     NULL};

static void both_seconds(unsigned n, bool second_moves)
{
    while (n--) {
        bool up = fmod((double)board.time_ms / 1000.0, 370) < 185;
        TEST_ASSERT_TRUE(kind->set_input(plant, plant_channel_of("e"),
                                         !second_moves ? 0
                                         : up          ? 1
                                                       : -1,
                                         plant_err, sizeof plant_err));
        tune_second();
    }
}

/* Runs the method `input`; the other disturbance rests. */
static void tune_one_after_the_other(void)
{
    begin_unlike(&usual, 3);
    settle(second);
    tune_whole(3);
    TEST_ASSERT_EQUAL(RUNS, tune_value("stage"));
    course.quiet = true;
    tune_seconds(600);
    ask_ok("block 2 tune");
    tune_seconds(20);
    for (unsigned k = 0; k < 1000 && value_of(2, "stage") != RUNS; k++)
        both_seconds(20, value_of(2, "stage") > LOOP);
    course.quiet = false;
}

static void two_blocks_that_are_tuned_one_after_the_other_both_act(void)
{
    tune_one_after_the_other();
    both_seconds(4500, true);
    TEST_ASSERT_FALSE(gain_is_off("ff1"));
    TEST_ASSERT_FALSE(gain_is_off("ff2"));
    course.error = course.count = 0;
    both_seconds(1500, true);
    TEST_ASSERT_TRUE(course.error / course.count < 0.2); /* 2.1 without */
}

static void of_two_elements_the_one_that_is_worse_is_switched_off(void)
{
    static const char *const wrong[] = {"set ff2.gain 0.5", "set block2.k 0.5", NULL};
    tune_one_after_the_other();
    both_seconds(3000, true);
    settle(wrong);
    both_seconds(1200, true);
    TEST_ASSERT_TRUE(gain_is_off("ff2"));
}

static void of_two_blocks_at_a_time_one_has_the_test_signal(void)
{
    begin_unlike(&usual, 0);
    settle(second);
    ask_ok("block 1 tune");
    ask_ok("block 2 tune");
    both_seconds(100, true);
    TEST_ASSERT_EQUAL(DISTURBANCE, tune_value("stage"));
    TEST_ASSERT_EQUAL(IDLE, (int)value_of(2, "stage"));
    TEST_ASSERT_EQUAL(SIGNAL + 1, (int)value_of(2, "verdict"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_element_that_is_not_there_is_refused_when_it_is_proposed);
    RUN_TEST(an_element_that_does_nothing_is_identified_anew_three_times_and_then_goes_off);
    RUN_TEST(one_that_waits_to_be_switched_off_counts_once);
    RUN_TEST(a_slow_element_that_is_worse_is_off_within_half_of_check);
    RUN_TEST(other_settings_forget_that_it_was_to_be_identified_anew);
    RUN_TEST(a_power_cut_forgets_a_proposal_that_waits);
    RUN_TEST(stop_withdraws_a_proposal);
    RUN_TEST(other_settings_withdraw_a_proposal);
    RUN_TEST(what_makes_the_loop_worse_withdraws_what_was_to_come_in_its_place);
    RUN_TEST(nothing_is_watched_while_setpoints_move);
    RUN_TEST(nothing_is_watched_while_a_reading_is_missing);
    RUN_TEST(after_a_while_in_hand_nothing_is_learnt_for_as_long_as_the_model_looks_back);
    RUN_TEST(a_reading_that_is_missing_for_a_tick_spoils_its_sample);
    RUN_TEST(a_setpoint_under_way_is_not_learnt_as_the_disturbance);
    RUN_TEST(a_clock_that_stands_still_ends_the_stage_as_a_lost_plant_does);
    RUN_TEST(no_method_leaves_an_element_on_where_the_mv_is_always_at_a_limit);
    RUN_TEST(a_disturbance_that_moves_with_the_setpoint_does_no_harm);
    RUN_TEST(two_blocks_that_are_tuned_one_after_the_other_both_act);
    RUN_TEST(of_two_elements_the_one_that_is_worse_is_switched_off);
    RUN_TEST(of_two_blocks_at_a_time_one_has_the_test_signal);
    return UNITY_END();
}
