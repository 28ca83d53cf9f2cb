/* The firmware as it is sold, started on a set that was stored with the worked family: it cannot run the blocks, and loses
 * nothing of them. */
#include "worked_family_bench.h"

void setUp(void)
{
    flash_from(WORKED_FAMILY_FLASH); /* test_worked_family_without leaves it */
    plant_power_on("wood-berry", TICK_MS, 1, 0);
    pass(3000); /* without a plant it is read after 2 s */
}
void tearDown(void)
{
    if (plant)
        plant_power_off();
}

static void its_loops_stay_in_manual_and_it_says_why(void)
{
    TEST_ASSERT_TRUE(said("alarm BLOCK_UNKNOWN observer 1"));
    TEST_ASSERT_TRUE(said("alarm BLOCK_UNKNOWN state_feedback 2"));
    plant_connect();
    plant_steps(5);
    ask_refused("mode top auto", "UNSUPPORTED");
    ask_refused("mode bottom auto", "UNSUPPORTED");
    plant_steps(5);
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("top manual ") && said("bottom manual "));
    ask_ok("block");
    TEST_ASSERT_TRUE(said("block2 state_feedback unknown"));
    ask_ok("out bottom 1.71"); /* by hand everything goes */
    plant_steps(5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.71, commanded("S"));
}

static void its_saves_keep_what_the_other_build_needs(void)
{
    ask_ok("set loop1.gain 2");
    ask_ok("save");
    flash_to(WORKED_FAMILY_FLASH ".back"); /* test_worked_family_back reads it */
}

static void without_the_blocks_the_pids_act(void)
{
    plant_connect();
    plant_steps(2);
    ask_ok("begin");
    ask_ok("set block1.kind -");
    ask_ok("set block2.kind -");
    ask_ok("apply");
    plant_steps(2);
    ask_ok("mode top auto");
    ask_ok("mode bottom auto");
    plant_steps(2);
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("top auto ") && said("bottom auto "));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(its_loops_stay_in_manual_and_it_says_why);
    RUN_TEST(its_saves_keep_what_the_other_build_needs);
    RUN_TEST(without_the_blocks_the_pids_act);
    return UNITY_END();
}
