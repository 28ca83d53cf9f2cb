/* Events and alarms of blocks through the whole firmware: announced, listed, kept, set and stored. */
#include "board_bench.h"
#include "verb_kinds.h"

void setUp(void)
{
    static const char *const lines[] = {
        "begin",
        "set meas5.name seen",
        "set meas5.unit degC",
        "set meas5.lo 60",
        "set meas5.hi 160",
        "set block2.kind watch",
        "set block2.inputs T1",
        "set block2.points seen",
        "apply",
    };
    running();
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
    samples(2);
    board_forget();
}
void tearDown(void) {}

#define WORDS "its input is above the limit, fraction of span"

static void what_a_block_says_is_announced_and_kept_with_its_words(void)
{
    board.values[0] = 120;
    samples(2);
    TEST_ASSERT_EQUAL_UINT(1, times_said(" alarm BLOCK_ALARM block2.high 0.6"));
    TEST_ASSERT_TRUE(said(" a block says: " WORDS "\n"));
    TEST_ASSERT_EQUAL_UINT(1, times_said(" info BLOCK_EVENT block2.crossed 0.6"));
    ask_ok("events");
    TEST_ASSERT_TRUE(said(" alarm BLOCK_ALARM block2.high 0.6"));
    TEST_ASSERT_TRUE(said(" a block says: " WORDS "\n"));
    ask_ok("block 2");
    TEST_ASSERT_TRUE(said("  alarm high: " WORDS ", now\n"));
    TEST_ASSERT_TRUE(said("  event crossed: its input has passed the limit, fraction of span\n"));
}

static void alarms_say_it_while_it_holds(void)
{
    board.values[0] = 120;
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("BLOCK_ALARM block2.high " WORDS "\n"));
    board.values[0] = 100;
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("BLOCK_ALARM"));
}

static void an_entry_on_it_is_listed_acknowledged_and_shelved(void)
{
    ask_ok("set alarm3.on block2.high");
    board.values[0] = 120;
    samples(2);
    TEST_ASSERT_TRUE(said(" alarm ALARM_ON block2.high 0.6"));
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("ALARM_ON block2.high alarm3 medium unacknowledged\n"));
    TEST_ASSERT_FALSE(said("BLOCK_ALARM"));
    ask_ok("alarm ack block2.high");
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("ALARM_ON block2.high alarm3 medium acknowledged\n"));
    ask_ok("alarm shelve alarm3 100");
    samples(1);
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("SHELVED block2.high alarm3 medium"));
    TEST_ASSERT_FALSE(said("BLOCK_ALARM"));
}

static void an_entry_on_it_is_set_refused_dumped_and_comes_back_from_storage(void)
{
    ask_refused("set alarm3.on block2.low", "UNKNOWN");
    TEST_ASSERT_TRUE(said(
        "alarm3.on: 'block2.low' is nothing that block says; `block N` lists what it may say"));
    ask_refused("set alarm3.on T9", "UNKNOWN");
    TEST_ASSERT_TRUE(said("'T9' must be the name of a configured measurement"));
    ask_refused("set alarm3.on block2,high", "PARSE");
    TEST_ASSERT_TRUE(said("allowed: up to 15 letters, digits or _, blockN.CODE, - for none"));
    ask_refused("set meas4.name a.b", "PARSE"); /* others are names as before */
    ask_ok("set alarm3.on block2.high");
    samples(1);
    ANSWERS("get alarm3.on", "alarm3.on = block2.high");
    ask_ok("dump");
    TEST_ASSERT_TRUE(said("set alarm3.on block2.high\n"));
    ask_ok("save");
    ask_ok("defaults");
    samples(1);
    ANSWERS("get alarm3.on", "alarm3.on = -");
    ask_ok("load");
    samples(1);
    ANSWERS("get alarm3.on", "alarm3.on = block2.high");
    /* Without the block it says nothing. */
    ask_refused("set block2.kind -", "UNKNOWN");
    TEST_ASSERT_TRUE(said("alarm3.on: 'block2.high' must begin with a block that is there"));
}

/* Nobody sees the plant's readings then, and an interlock on that name looks at the block's. */
static void a_point_by_a_name_that_the_plant_announces_is_told(void)
{
    static const char *const lines[] = {
        "begin",           "set meas6.name feed", "set meas6.unit l/h",
        "set meas6.lo 60", "set meas6.hi 160",    "set block2.points feed",
    };
    samples(1);
    TEST_ASSERT_FALSE(said("CHANNEL_WRITTEN"));
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
    ask_ok("apply");
    board_forget();
    samples(1);
    TEST_ASSERT_EQUAL_UINT(1, times_said(" warning CHANNEL_WRITTEN feed 2 "));
    ask_ok("set block2.points seen");
    samples(1);
    TEST_ASSERT_FALSE(said("CHANNEL_WRITTEN"));
}

static void a_point_that_is_named_twice_is_refused_as_that(void)
{
    ask_refused("set block2.points seen,seen", "CONFLICT");
    TEST_ASSERT_TRUE_MESSAGE(said("block2.points: 'seen,seen' refused, a name stands in it twice"),
                             board.said);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_a_block_says_is_announced_and_kept_with_its_words);
    RUN_TEST(alarms_say_it_while_it_holds);
    RUN_TEST(an_entry_on_it_is_listed_acknowledged_and_shelved);
    RUN_TEST(an_entry_on_it_is_set_refused_dumped_and_comes_back_from_storage);
    RUN_TEST(a_point_by_a_name_that_the_plant_announces_is_told);
    RUN_TEST(a_point_that_is_named_twice_is_refused_as_that);
    return UNITY_END();
}
