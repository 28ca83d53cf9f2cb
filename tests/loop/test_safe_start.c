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

/* Asked for while all was well; the very sample that meets it takes the safe state. */
static void what_was_asked_before_the_safe_state_does_not_end_it(void)
{
    static const char *const asked[] = {"mode bottom auto", "out bottom 1.5"};
    for (unsigned n = 0; n < 4; n++) {
        running();
        ask_ok("set meas1.fallback safe");
        ask_ok("set meas1.hold 0");
        ask_ok("out bottom 1");
        samples(3);
        TEST_ASSERT_FALSE(board.command.safe);
        ask_ok(asked[n % 2]);
        board.quality[0] = n < 2 ? 2 : 0; /* T1 is lost; or too many samples are */
        sample_after(n < 2 ? board.tick_ms : 20 * board.tick_ms);
        TEST_ASSERT_TRUE_MESSAGE(board.command.safe, asked[n % 2]);
        TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
        samples(2);
        TEST_ASSERT_TRUE(board.command.safe);
        ask_ok(asked[n % 2]);
        samples(1);
        TEST_ASSERT_FALSE(board.command.safe); /* by somebody who knows */
    }
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

/* The plant meets a board that has been reset, and whose flash may have lost a bit meanwhile. */
static void reset_with_image(enum hal_image image)
{
    memory_port_set_image(image);
    memory_port_reset(HAL_RESET_PIN);
    memory_port_set_image(HAL_IMAGE_NO_CHECKSUM);
    board.ready = false;
    board_forget();
    type("mode machine\n");
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
}

static void with_a_damaged_image_nothing_acts_and_the_console_says_why(void)
{
    static const char *const requests[] = {"mode bottom auto", "mode bottom manual",
                                           "out top 5",        "out heat 1.5",
                                           "seq start",        "commission begin"};
    ask_ok("version"); /* a process has none, and says so */
    TEST_ASSERT_TRUE(said("image without a checksum"));
    ask_ok("set restart.policy resume");
    ask_ok("save");
    ask_ok("mode bottom auto");
    samples(30);
    reset_with_image(HAL_IMAGE_WHOLE);
    samples(4); /* storage is read after the first */
    TEST_ASSERT_FALSE(board.command.safe);
    reset_with_image(HAL_IMAGE_DAMAGED);
    TEST_ASSERT_TRUE(said("alarm IMAGE_DAMAGED"));
    samples(10);
    ask_ok("loop"); /* the settings are those that were stored: their safe values hold */
    TEST_ASSERT_TRUE(said("bottom manual"));
    for (unsigned i = 0; i < sizeof requests / sizeof requests[0]; i++) {
        (void)ask(requests[i]);
        TEST_ASSERT_TRUE_MESSAGE(said("ok\n") || said("err "), requests[i]);
        samples(3);
        TEST_ASSERT_TRUE_MESSAGE(board.command.safe, requests[i]);
        TEST_ASSERT_EQUAL_FLOAT(0.0f, board.command.output[0].value);
        TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
    }
    ask_refused("mode bottom auto", "STATE");
    TEST_ASSERT_TRUE(said("firmware is damaged"));
    ask_refused("out top 5", "STATE");
    TEST_ASSERT_TRUE(said("firmware is damaged"));
    ask_ok("status");
    TEST_ASSERT_TRUE(said("state safe"));
    TEST_ASSERT_TRUE(said("firmware is not the one that was built"));
    ask_ok("version");
    TEST_ASSERT_TRUE(said("image DAMAGED"));
    reset_with_image(HAL_IMAGE_WHOLE);
    samples(4);
    ask_ok("mode bottom auto");
    samples(1);
    TEST_ASSERT_FALSE(board.command.safe);
    ask_ok("version");
    TEST_ASSERT_TRUE(said("image whole"));
}

/* Two passes over the flash are behind the word of the port. */
static void an_image_that_is_damaged_in_the_run_lets_nothing_act(void)
{
    reset_with_image(HAL_IMAGE_WHOLE);
    samples(4);
    ask_ok("mode bottom auto");
    samples(3);
    TEST_ASSERT_FALSE(board.command.safe);
    memory_port_set_image(HAL_IMAGE_DAMAGED);
    pass(10);
    memory_port_set_image(HAL_IMAGE_NO_CHECKSUM);
    TEST_ASSERT_TRUE(said("alarm IMAGE_DAMAGED"));
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    ask_refused("mode bottom auto", "STATE");
    TEST_ASSERT_TRUE(said("firmware is damaged"));
}

static void with_a_ram_that_failed_its_test_nothing_acts(void)
{
    reset_with_image(HAL_IMAGE_RAM_FAILED);
    TEST_ASSERT_TRUE(said("alarm RAM_FAILED"));
    samples(4);
    ask_refused("mode bottom auto", "STATE");
    TEST_ASSERT_TRUE(said("the RAM failed its test"));
    ask_ok("status");
    TEST_ASSERT_TRUE(said("state safe"));
    TEST_ASSERT_TRUE(said("the RAM failed its test at power-on"));
    ask_ok("version");
    TEST_ASSERT_TRUE(said("image not checked: the RAM FAILED its test"));
    samples(2);
    TEST_ASSERT_TRUE(board.command.safe);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(with_a_damaged_image_nothing_acts_and_the_console_says_why);
    RUN_TEST(an_image_that_is_damaged_in_the_run_lets_nothing_act);
    RUN_TEST(with_a_ram_that_failed_its_test_nothing_acts);
    RUN_TEST(the_first_command_after_power_on_is_the_safe_state);
    RUN_TEST(a_reboot_while_controlling_ends_in_the_safe_state);
    RUN_TEST(the_reply_to_reboot_comes_before_the_board_goes);
    RUN_TEST(the_safe_state_lasts_until_somebody_acts);
    RUN_TEST(what_was_asked_before_the_safe_state_does_not_end_it);
    RUN_TEST(nothing_can_act_before_there_is_a_plant);
    RUN_TEST(an_interlock_holds_from_the_first_command_on);
    RUN_TEST(a_restart_is_told_first);
    return UNITY_END();
}
