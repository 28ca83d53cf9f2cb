/* `block N design` of the kind `experiment` when readings or the link fail while it computes, and when a save, a power cut or `proposal back`
 * comes between the two parts of a long decoupler. */
#include "decoupler_design_bench.h"

/* ---- readings and link ---- */

static double first_of_designed[4];

static void keep_designed(double to[4])
{
    char row[20];
    for (unsigned k = 0; k < 4; k++) {
        snprintf(row, sizeof row, "block2.g.%u", k + 1);
        to[k] = nth_of_row(row, 0);
    }
}

static void is_designed(const char *what)
{
    double g[4];
    keep_designed(g);
    for (unsigned k = 0; k < 4; k++)
        TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(first_of_designed[k], g[k], what);
    for (unsigned k = 0; k < 2; k++)
        TEST_ASSERT_TRUE_MESSAGE(nth_of_row(k ? "block4.q.1" : "block3.q.1", 0) != 1, what);
}

static void begin_design(void)
{
    memory_port_erase_all();
    begin_with_model("set block1.adopt at_once", no_blocks);
}

static void both(const char *option)
{
    char line[40];
    for (unsigned k = 1; k <= 2; k++) {
        snprintf(line, sizeof line, "y%u.%s", k, option);
        plant_event(line);
    }
}

/* The design is of the kept model alone. */
static void bad_readings_while_it_computes_change_nothing(void)
{
    static const char *const faults[] = {"nan=1", "quality=2", "quality=3", "dropout=1"};
    begin_design();
    design();
    keep_designed(first_of_designed);
    TEST_ASSERT_TRUE(first_of_designed[1] != 0);
    plant_power_off();
    for (unsigned k = 0; k < sizeof faults / sizeof faults[0]; k++)
        for (unsigned after = 0; after < 5; after++) {
            begin_design();
            ask_ok("block 1 design");
            plant_steps(after);
            both(faults[k]);
            plant_steps(20);
            is_designed(faults[k]);
            plant_power_off();
        }
}

static void a_sensor_that_has_never_been_there_does_not_keep_it_waiting(void)
{
    begin_design();
    ask_ok("save");
    plant_steps(2);
    plant_power_off();
    plant_power_on(unlike_lags.plant, unlike_lags.tick_ms, 1, 1);
    pass(3000);
    both("nan=1");
    plant_connect();
    plant_steps(3);
    design();
    is_designed("never there");
}

static void a_plant_that_was_away_meanwhile_changes_nothing(void)
{
    for (unsigned after = 0; after < 5; after++) {
        begin_design();
        ask_ok("block 1 design");
        plant_steps(after);
        board.mute = true;
        pass(60000);
        plant_connect();
        plant_steps(20);
        is_designed("away");
        plant_power_off();
    }
}

/* ---- between the two parts ---- */

/* 31 values of the decoupler differ, more than one proposal has room for. */
static void long_decoupler(void)
{
    memory_port_erase_all();
    begin_with_model("set block1.adopt ask", no_blocks);
    ask_ok("begin");
    for (unsigned k = 2; k <= 8; k++) {
        set_line("set block1.b11_%u 0.00%u", k, 9 - k);
        set_line("set block1.b12_%u -0.000%u", k, 9 - k);
        set_line("set block1.b21_%u 0.000%u", k, 9 - k);
        set_line("set block1.b22_%u -0.00%u", k, 9 - k);
    }
    ask_ok("set block1.place.1 0");
    ask_ok("set block1.place.2 0");
    ask_ok("apply");
    plant_steps(2);
    ask_ok("save");
    plant_steps(3);
    design();
}

static void is_whole(void)
{
    for (unsigned k = 0; k < 8; k++) {
        TEST_ASSERT_TRUE(nth_of_row("block2.g.1", k) > 0);
        TEST_ASSERT_TRUE(nth_of_row("block2.g.4", k) > 0 && nth_of_row("block2.g.4", k) != 1);
    }
    ask_ok("get block2.limits");
    TEST_ASSERT_FALSE(said("incomplete"));
}

static void is_incomplete(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(1, nth_of_row("block2.g.4", 0)); /* as it was */
    TEST_ASSERT_TRUE(nth_of_row("block2.g.1", 0) != 1);
    ask_ok("get block2.limits");
    TEST_ASSERT_TRUE_MESSAGE(said("incomplete"), board.said);
}

/* The power goes and comes. */
static void restart(void)
{
    plant_power_off();
    plant_power_on(unlike_lags.plant, unlike_lags.tick_ms, 1, 0);
    pass(3000);
    rest_case(&unlike_lags, 20);
}

/* A move of MV 1 does not reach MV 2, and the block says why. */
static void the_loops_act_without_it(void)
{
    ask_ok("mode l1 auto");
    ask_ok("mode l2 auto");
    plant_steps(4);
    double u1 = commanded("u1"), u2 = commanded("u2");
    ask_ok("sp l1 0.3");
    plant_steps(3);
    TEST_ASSERT_TRUE(fabs(commanded("u1") - u1) > 0.05);
    TEST_ASSERT_TRUE(fabs(commanded("u2") - u2) < 0.1 * fabs(commanded("u1") - u1));
    TEST_ASSERT_TRUE(events_say(" info BLOCK_EVENT block2.partial "));
    ask_ok("mode l1 manual");
    ask_ok("mode l2 manual");
    plant_steps(2);
}

static void a_design_completes_it(void)
{
    design();
    ask_ok("proposal accept");
    plant_steps(5);
    is_whole();
}

static void a_long_decoupler_comes_in_two_parts_and_is_accepted_once(void)
{
    long_decoupler();
    ask_ok("proposal accept");
    plant_steps(5);
    is_whole();
    TEST_ASSERT_FALSE(events_say("PROPOSAL_REFUSED")); /* no controller without a block for it */
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("proposes"));
    ask_ok("save");
    plant_steps(3);
    restart();
    is_whole();
}

static void a_power_cut_between_the_parts_leaves_what_was_saved(void)
{
    for (unsigned after = 0; after < 4; after++) {
        long_decoupler();
        ask_ok("proposal accept");
        plant_steps(after);
        restart();
        TEST_ASSERT_EQUAL_DOUBLE(1, nth_of_row("block2.g.1", 0));
        TEST_ASSERT_EQUAL_DOUBLE(0, nth_of_row("block2.g.2", 0));
        ask_ok("get block2.limits");
        TEST_ASSERT_TRUE(said("recurse"));
        plant_power_off();
    }
}

static void saved_between_the_parts_and_restarted_the_loops_act_without_a_decoupler(void)
{
    long_decoupler();
    ask_ok("proposal accept");
    ask_ok("save");
    plant_steps(5);
    is_whole();
    restart();
    is_incomplete();
    the_loops_act_without_it();
    a_design_completes_it();
}

static void the_second_part_taken_back_the_loops_act_without_a_decoupler(void)
{
    long_decoupler();
    ask_ok("proposal accept");
    plant_steps(5);
    ask_ok("proposal back");
    plant_steps(3);
    is_incomplete();
    the_loops_act_without_it();
    a_design_completes_it();
}

static void accepted_while_the_loops_act_no_mv_jumps(void)
{
    long_decoupler();
    ask_ok("mode l1 auto");
    ask_ok("mode l2 auto");
    ask_ok("sp l1 0.03");
    plant_steps(12);
    double before[2] = {commanded("u1"), commanded("u2")};
    ask_ok("proposal accept");
    for (unsigned k = 0; k < 6; k++) {
        plant_step();
        TEST_ASSERT_DOUBLE_WITHIN(0.15, before[0], commanded("u1"));
        TEST_ASSERT_DOUBLE_WITHIN(0.15, before[1], commanded("u2"));
        before[0] = commanded("u1");
        before[1] = commanded("u2");
    }
    is_whole();
}

/* None of the 40 values of a kept model is the same in the one that is found. */
static void a_model_that_was_saved_between_its_parts_does_not_count(void)
{
    memory_port_erase_all();
    unlike_lags.tick_ms = 120000;
    begin_case(&unlike_lags, 1, 20);
    ask_ok("begin");
    for (unsigned i = 1; i <= 2; i++)
        for (unsigned k = 1; k <= 8; k++) {
            if (k <= 4)
                set_line("set block1.a%u_%u 0.01", i, k);
            set_line("set block1.b%u1_%u 0.01", i, k);
            set_line("set block1.b%u2_%u 0.01", i, k);
        }
    ask_ok("set block1.known on");
    ask_ok("set block1.adopt ask");
    ask_ok("apply");
    plant_steps(2);
    add_blocks(1, no_blocks);
    ask_ok("block 1 start");
    plant_steps(1000);
    (void)until_over(1, 100);
    TEST_ASSERT_EQUAL(DONE, stage_of(1));
    plant_steps(2);
    ask_ok("proposal accept");
    ask_ok("save");
    plant_steps(5);
    ask_ok("get block1.known");
    TEST_ASSERT_TRUE(said("= on"));
    restart();
    ask_ok("get block1.known");
    TEST_ASSERT_TRUE(said("= off"));
    board_forget();
    type("block 1 design\n");
    plant_steps(3);
    TEST_ASSERT_TRUE_MESSAGE(events_say("no_model"), board.said);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bad_readings_while_it_computes_change_nothing);
    RUN_TEST(a_sensor_that_has_never_been_there_does_not_keep_it_waiting);
    RUN_TEST(a_plant_that_was_away_meanwhile_changes_nothing);
    RUN_TEST(a_long_decoupler_comes_in_two_parts_and_is_accepted_once);
    RUN_TEST(a_power_cut_between_the_parts_leaves_what_was_saved);
    RUN_TEST(saved_between_the_parts_and_restarted_the_loops_act_without_a_decoupler);
    RUN_TEST(the_second_part_taken_back_the_loops_act_without_a_decoupler);
    RUN_TEST(accepted_while_the_loops_act_no_mv_jumps);
    RUN_TEST(a_model_that_was_saved_between_its_parts_does_not_count);
    return UNITY_END();
}
