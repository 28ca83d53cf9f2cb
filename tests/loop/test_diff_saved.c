/* `diff saved`: the settings beside the stored ones, as lines to paste and remarks. */
#include "board_bench.h"
#include "flash_model.h"
#include "settings/parameters.h"

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

/* The default of mv.max is mv.hi. A paste of the lines onto the stored settings has to give both present values. */
static void a_default_that_follows_another_parameter_is_the_one_of_the_save(void)
{
    ask_ok("save");
    ask_ok("set mv5.hi 60"); /* takes max along */
    samples(1);
    ANSWERS("diff saved", "set mv5.hi 60", "# saved: 100", "set mv5.max 60", "# saved: 100");
    ask_ok("begin");
    ask_ok("set mv5.hi 150");
    ask_ok("set mv5.max 100");
    ANSWERS("diff saved", "set mv5.hi 150", "# saved: 100", "set mv5.max 100", "# saved: 100");
    ask_ok("apply");
    samples(1);
    ask_ok("save");
    ANSWERS("diff saved", NULL);
    ask_ok("set mv5.hi 60");
    samples(1);
    ANSWERS("diff saved", "set mv5.hi 60", "# saved: 150", "set mv5.max 100", "# saved: 100");
}

static uint32_t first_record;
static unsigned looks;

/* Counts reads at the lowest address that is read: the head of the first record, with which each search begins. */
static void count_looks(uint32_t address, uint8_t *data, uint32_t n)
{
    (void)data;
    (void)n;
    if (address < first_record) {
        first_record = address;
        looks = 0;
    }
    looks += address == first_record;
}

static void the_stored_set_is_searched_once_for_each_parameter(void)
{
    const unsigned reads = 2; /* storage_read() reads until two agree */
    ask_ok("save");
    ask_ok("set loop2.gain 2.5");
    samples(1);
    first_record = UINT32_MAX;
    flash_model_glance = count_looks;
    ask_ok("diff saved");
    flash_model_glance = NULL;
    static struct config defaults; /* which has as many, because this board has no blocks */
    parameters_defaults(&defaults);
    unsigned parameters = parameter_count(&defaults);
    TEST_ASSERT_GREATER_THAN_UINT(parameters / 2u, looks / reads);
    /* The default of mv.max follows mv.hi, so mv.hi is searched for as well. */
    TEST_ASSERT_LESS_OR_EQUAL_UINT(parameters + CHANNEL_MAX, looks / reads);
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
    RUN_TEST(a_default_that_follows_another_parameter_is_the_one_of_the_save);
    RUN_TEST(the_stored_set_is_searched_once_for_each_parameter);
    RUN_TEST(an_open_transaction_is_compared);
    RUN_TEST(settings_of_a_block_of_another_kind_are_none_of_the_stored_ones);
    RUN_TEST(a_key_differs_and_is_not_shown);
    RUN_TEST(every_word_but_its_own_is_refused);
    return UNITY_END();
}
