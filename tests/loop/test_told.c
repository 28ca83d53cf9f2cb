/* What an operator is told, and kept from, when plant and configuration do not go together. */
#include "board_bench.h"

void setUp(void)
{
    running();
}
void tearDown(void) {}

static void a_base_tick_that_is_not_the_plants_is_refused(void)
{
    ask_refused("set tick.base 20", "CONFLICT");
    ask_ok("set tick.base 1");
    ask_ok("mode bottom auto");
}

static void a_plant_of_another_tick_than_configured_lets_no_loop_act(void)
{
    power_on();
    configure();
    ask_ok("set tick.base 20");
    connect_plant();
    samples(2);
    TEST_ASSERT_TRUE(said("CONFIG_REFUSED tick.base"));
    ask_refused("mode bottom auto", "CONFLICT");
}

static void a_loop_that_a_plan_removes_says_so(void)
{
    ask_ok("mode bottom auto");
    samples(2);
    board_forget();
    ask_ok("set loop2.name -");
    board_forget();
    samples(1);
    TEST_ASSERT_TRUE_MESSAGE(said("MODE bottom 0"), board.said);
}

static void the_safe_state_stays_in_the_list_of_alarms_until_somebody_acts(void)
{
    ask_ok("mode bottom auto");
    samples(2);
    board.mute = true;
    pass(3000);
    connect_plant();
    samples(2);
    ask_ok("alarm");
    TEST_ASSERT_TRUE_MESSAGE(said("SAFE_STATE"), board.said);
    ask_ok("mode bottom auto");
    samples(2);
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("SAFE_STATE"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_base_tick_that_is_not_the_plants_is_refused);
    RUN_TEST(a_plant_of_another_tick_than_configured_lets_no_loop_act);
    RUN_TEST(a_loop_that_a_plan_removes_says_so);
    RUN_TEST(the_safe_state_stays_in_the_list_of_alarms_until_somebody_acts);
    return UNITY_END();
}
