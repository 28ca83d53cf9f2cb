/* Warnings and refusals when plant and configuration do not go together. */
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

/* ---- a plant whose tick the configuration cannot have ---- */

static void another_plant(uint32_t tick_ms)
{
    board.session++;
    board.tick_ms = tick_ms;
    board.ready = false;
    board_forget();
    plant_hello();
    board_run();
    TEST_ASSERT_TRUE(board.ready);
}

/* Fits 1 s ticks, and not 0.1 s: ten times the values would have to be remembered. */
static void remember_long(void)
{
    ask_ok("begin");
    ask_ok("set meas3.name feed");
    ask_ok("set meas3.unit l/h");
    ask_ok("set ff1.from feed");
    ask_ok("set ff1.to heat");
    ask_ok("set ff1.gain 0.1");
    ask_ok("set ff1.dead 3000");
    ask_ok("apply");
}

static char *settings(void)
{
    static char kept[2][20000];
    static unsigned n;
    char *to = kept[n++ % 2];
    board_forget();
    ask_ok("diff defaults");
    const char *from = strstr(board.said, "set ");
    (void)snprintf(to, sizeof kept[0], "%s", from ? from : "");
    return to;
}

/* Nothing acts, nothing is lost, each sample is answered; with the plant of before everything is as before. */
static void no_setting_is_lost(uint32_t tick_ms, const char *event)
{
    const char *before = settings();
    TEST_ASSERT_NOT_NULL(strstr(before, "set loop2.name bottom"));
    ask_ok("mode bottom auto");
    samples(2);
    another_plant(tick_ms);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("CONFIG_REFUSED"), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said(event), board.said);
    unsigned commands = board.commands;
    samples(20);
    TEST_ASSERT_EQUAL(commands + 20, board.commands);
    TEST_ASSERT_FALSE(board.command.output[0].drive || board.command.output[1].drive);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_FALSE_MESSAGE(said("SAMPLE_"), board.said);
    ask_refused("mode bottom auto", "CONFLICT");
    ask_refused("out heat 1", "CONFLICT");
    TEST_ASSERT_EQUAL_STRING(before, settings());
    ask_ok("save");
    another_plant(1000);
    samples(2);
    TEST_ASSERT_FALSE_MESSAGE(said("CONFIG_REFUSED"), board.said);
    TEST_ASSERT_TRUE(board.command.output[0].drive && board.command.output[1].drive);
    TEST_ASSERT_EQUAL_STRING(before, settings());
    ask_ok("mode bottom auto");
    samples(2);
    power_on(); /* and what was saved is the same */
    connect_plant();
    samples(2);
    ask_ok("mode machine");
    TEST_ASSERT_EQUAL_STRING(before, settings());
}

static void a_tick_that_needs_too_much_memory_loses_no_setting(void)
{
    remember_long();
    samples(2);
    no_setting_is_lost(100, "CONFIG_REFUSED ff1.dead 0.1");
}

static void a_tick_too_short_for_any_block_loses_no_setting(void)
{
    no_setting_is_lost(10, "CONFIG_REFUSED tick.base 0.01");
}

static void a_tick_too_long_for_a_divisor_loses_no_setting(void)
{
    ask_ok("set loop1.divisor 10000");
    samples(2);
    no_setting_is_lost(60000, "CONFIG_REFUSED loop1.divisor 60");
}

/* With tick.base 0 ten ticks of this plant would be another interval than ten of the last one. */
static void a_divisor_is_not_taken_over_to_a_plant_of_another_tick(void)
{
    ask_ok("set loop1.divisor 10");
    samples(2);
    no_setting_is_lost(2000, "CONFIG_REFUSED loop1.divisor 2");
    another_plant(2000);
    ask_ok("set loop1.divisor 5");
    samples(2);
    ask_ok("mode bottom auto");
}

static void a_stored_set_that_did_not_fit_the_plant_is_tried_again_with_the_next(void)
{
    ask_ok("set tick.base 1");
    samples(1);
    ask_ok("save");
    pass(2000);
    memory_port_reset(HAL_RESET_POWER_ON);
    board_run();
    type("mode machine\n");
    another_plant(20000);
    samples(2);
    pass(3000);
    TEST_ASSERT_TRUE_MESSAGE(said("STORAGE_REFUSED tick.base"), board.said);
    ask_refused("mode bottom auto", "UNKNOWN");
    another_plant(1000);
    samples(3);
    pass(3000);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("STORAGE_LOADED"), board.said);
    samples(2);
    ask_ok("mode bottom auto");
}

static void a_configuration_that_waited_while_the_plant_changed_is_kept(void)
{
    remember_long(); /* no sample since */
    const char *wanted = settings();
    TEST_ASSERT_NOT_NULL(strstr(wanted, "set ff1.dead 3000"));
    another_plant(100);
    samples(2);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said("CONFIG_REFUSED ff1.dead 0.1"), board.said);
    TEST_ASSERT_EQUAL_STRING(wanted, settings());
    ask_refused("mode bottom auto", "CONFLICT");
    another_plant(1000);
    samples(2);
    ask_ok("mode bottom auto");
}

static void what_does_not_fit_can_be_mended_while_that_plant_is_there(void)
{
    remember_long();
    samples(2);
    another_plant(100);
    samples(2);
    ask_refused("set loop1.gain 2", "MEMORY");
    ask_ok("set ff1.dead 100");
    samples(2);
    TEST_ASSERT_TRUE(board.command.output[1].drive);
    ask_ok("mode bottom auto");
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
    RUN_TEST(a_tick_that_needs_too_much_memory_loses_no_setting);
    RUN_TEST(a_tick_too_short_for_any_block_loses_no_setting);
    RUN_TEST(a_tick_too_long_for_a_divisor_loses_no_setting);
    RUN_TEST(a_divisor_is_not_taken_over_to_a_plant_of_another_tick);
    RUN_TEST(a_stored_set_that_did_not_fit_the_plant_is_tried_again_with_the_next);
    RUN_TEST(a_configuration_that_waited_while_the_plant_changed_is_kept);
    RUN_TEST(what_does_not_fit_can_be_mended_while_that_plant_is_there);
    RUN_TEST(a_loop_that_a_plan_removes_says_so);
    RUN_TEST(the_safe_state_stays_in_the_list_of_alarms_until_somebody_acts);
    return UNITY_END();
}
