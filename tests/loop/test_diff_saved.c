/* `diff saved`: the settings beside the stored ones, as lines to paste and remarks. */
#include "board_bench.h"

void setUp(void)
{
    memory_port_erase_all();
    running();
}
void tearDown(void) {}

static void without_a_stored_set_there_is_nothing_to_compare_with(void)
{
    TEST_ASSERT_EQUAL_STRING("err EMPTY no whole set is stored", ask("diff saved"));
}

static void after_a_save_nothing_differs(void)
{
    ask_ok("save");
    ANSWERS("diff saved", NULL);
}

static void what_was_set_since_stands_beside_what_is_stored(void)
{
    ask_ok("save");
    ask_ok("set loop2.gain 2.5");
    ask_ok("set loop1.action reverse");
    ask_ok("set loop1.divisor 2");
    ask_ok("set meas4.name extra");
    samples(1);
    ANSWERS("diff saved", "set meas4.name extra", "# saved: -", "set loop1.action reverse",
            "# saved: direct", "set loop1.divisor 2", "# saved: 1", "set loop2.gain 2.5",
            "# saved: 1.5");
    ask_ok("save");
    ANSWERS("diff saved", NULL);
}

static void what_goes_back_to_its_default_differs_too(void)
{
    ask_ok("set loop2.td 10");
    samples(1);
    ask_ok("save");
    ask_ok("set loop2.td 0");
    samples(1);
    ANSWERS("diff saved", "set loop2.td 0", "# saved: 10");
}

static void an_open_transaction_is_compared(void)
{
    ask_ok("save");
    ask_ok("begin");
    ask_ok("set loop2.gain 3");
    ANSWERS("diff saved", "set loop2.gain 3", "# saved: 1.5");
    ask_ok("abandon");
    ANSWERS("diff saved", NULL);
}

static void settings_of_a_block_of_another_kind_are_none_of_the_stored_ones(void)
{
    ask_ok("begin");
    ask_ok("set block1.kind gmv");
    ask_ok("set block1.loops bottom");
    ask_ok("set block1.inputs T10");
    ask_ok("set block1.tune_gain.1 1.5");
    ask_ok("set block1.memory 500");
    ask_ok("apply");
    samples(1);
    ask_ok("save");
    ANSWERS("diff saved", NULL);
    ask_ok("set block1.memory 250");
    samples(1);
    ask_ok("diff saved");
    TEST_ASSERT_TRUE_MESSAGE(said("set block1.memory 250\n# saved: 500\n"), board.said);
    ask_ok("set block1.kind -");
    samples(1);
    ask_ok("diff saved");
    TEST_ASSERT_TRUE_MESSAGE(said("set block1.kind -\n# saved: gmv\n"), board.said);
    TEST_ASSERT_FALSE_MESSAGE(said("memory"), board.said);
}

static void a_key_differs_and_is_not_shown(void)
{
    ask_ok("key pot_still");
    samples(1);
    ask_ok("save");
    ask_ok("key another");
    samples(1);
    ANSWERS("diff saved", "set console.key ***", "# saved: ***");
    ask_ok("key -");
}

static void every_word_but_its_own_is_refused(void)
{
    ask_refused("diff stored", "PARSE");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_a_stored_set_there_is_nothing_to_compare_with);
    RUN_TEST(after_a_save_nothing_differs);
    RUN_TEST(what_was_set_since_stands_beside_what_is_stored);
    RUN_TEST(what_goes_back_to_its_default_differs_too);
    RUN_TEST(an_open_transaction_is_compared);
    RUN_TEST(settings_of_a_block_of_another_kind_are_none_of_the_stored_ones);
    RUN_TEST(a_key_differs_and_is_not_shown);
    RUN_TEST(every_word_but_its_own_is_refused);
    return UNITY_END();
}
