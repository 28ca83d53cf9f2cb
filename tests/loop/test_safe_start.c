/* After every restart: manual, safe values first, nothing remembered of what was running. */
#include "board_bench.h"

void setUp(void)
{
    running();
}
void tearDown(void) {}

static void the_first_command_after_power_on_is_the_safe_state(void)
{
    power_on();
    configure();
    connect_plant();
    board.commands = 0;
    samples(1);
    TEST_ASSERT_EQUAL(1, board.commands);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, board.command.output[0].value);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
}

static void a_reboot_while_controlling_ends_in_the_safe_state(void)
{
    ask_ok("mode bottom auto");
    samples(3);
    TEST_ASSERT_FALSE(board.command.safe);
    board_forget();
    type("reboot\n");
    TEST_ASSERT_EQUAL(1, memory_port_reboots());
    type("mode machine\n");
    pass(1000);
    TEST_ASSERT_TRUE(board.ready); /* the plant was met again */
    configure();
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
    ask_ok("loop bottom");
    TEST_ASSERT_TRUE(said("bottom manual"));
}

static void the_reply_to_reboot_comes_before_the_board_goes(void)
{
    board_forget();
    type("reboot\n");
    TEST_ASSERT_TRUE(memory_port_reboots() == 1);
}

static void the_safe_state_lasts_until_somebody_acts(void)
{
    power_on();
    configure();
    connect_plant();
    samples(50);
    TEST_ASSERT_TRUE(board.command.safe);
    ask_ok("out top 5");
    samples(1);
    TEST_ASSERT_FALSE(board.command.safe);
    TEST_ASSERT_EQUAL_FLOAT(5.0f, board.command.output[0].value);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
}

static void nothing_can_act_before_there_is_a_plant(void)
{
    power_on();
    configure();
    ask_refused("mode bottom auto", "STATE");
    ask_refused("out bottom 1", "STATE");
    ask_ok("status");
    TEST_ASSERT_TRUE(said("state safe"));
}

static void an_interlock_holds_from_the_first_command_on(void)
{
    power_on();
    configure();
    ask_ok("begin");
    ask_ok("set lock1.meas T10");
    ask_ok("set lock1.mv heat");
    ask_ok("set lock1.limit 110"); /* the column is hot already */
    ask_ok("set lock1.value 0");
    ask_ok("apply");
    connect_plant();
    samples(1);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, board.command.output[1].value);
}

static void a_restart_is_told_first(void)
{
    power_on();
    board_forget();
    ask_ok("events");
    TEST_ASSERT_TRUE(said("STARTED"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_first_command_after_power_on_is_the_safe_state);
    RUN_TEST(a_reboot_while_controlling_ends_in_the_safe_state);
    RUN_TEST(the_reply_to_reboot_comes_before_the_board_goes);
    RUN_TEST(the_safe_state_lasts_until_somebody_acts);
    RUN_TEST(nothing_can_act_before_there_is_a_plant);
    RUN_TEST(an_interlock_holds_from_the_first_command_on);
    RUN_TEST(a_restart_is_told_first);
    return UNITY_END();
}
