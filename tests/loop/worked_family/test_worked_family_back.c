/* The worked family on a set that firmware without it has loaded, changed and stored: nothing of the blocks is lost. */
#include "worked_family_bench.h"

void setUp(void)
{
    flash_from(WORKED_FAMILY_FLASH ".back"); /* test_worked_family_product leaves it */
    plant_power_on("wood-berry", TICK_MS, 1, 0);
    pass(3000);
}
void tearDown(void)
{
    plant_power_off();
}

static void what_another_build_has_carried_over_is_all_there(void)
{
    static char carried[SAID_MAX];
    ask_ok("get loop1.gain");
    TEST_ASSERT_TRUE(said("loop1.gain = 2 "));
    ask_ok("set loop1.gain 3");
    ask_ok("dump");
    snprintf(carried, sizeof carried, "%s", board.said);
    ask_file(WORKED_FAMILY_CONF);
    ask_ok("dump");
    TEST_ASSERT_EQUAL_STRING(board.said, carried);
}

static void the_blocks_act(void)
{
    plant_connect();
    plant_steps(2);
    ask_ok("out bottom 1.71");
    plant_steps(300);
    in_auto();
    ask_ok("block");
    TEST_ASSERT_TRUE(said("block1 observer on") && said("block2 state_feedback on"));
    TEST_ASSERT_EQUAL_DOUBLE(1, inside("state_feedback", "together"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_another_build_has_carried_over_is_all_there);
    RUN_TEST(the_blocks_act);
    return UNITY_END();
}
