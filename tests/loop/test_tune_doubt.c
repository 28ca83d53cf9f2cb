/* `tune` proposes settings, and says where `set` would refuse them. */
#include "board_bench.h"

void setUp(void)
{
    running();
}
void tearDown(void) {}

#define DOUBT "# `set` would refuse this: "

static void settings_that_can_be_set_have_no_remark(void)
{
    ask_ok("tune bottom simc 100 20 600");
    TEST_ASSERT_FALSE_MESSAGE(said("#"), board.said);
    TEST_ASSERT_EQUAL(5, n_reply);
}

static void a_gain_beyond_its_range_is_told_with_the_range(void)
{
    ask_ok("tune bottom simc 0.01 1 6000");
    TEST_ASSERT_TRUE_MESSAGE(
        said(DOUBT "gain: 1.5e+07 refused, allowed: 1e-06 .. 100 fraction/fraction\nok\n"),
        board.said);
    ask_refused("set loop2.gain 1.5e7", "RANGE");
}

static void a_sense_that_an_acting_loop_keeps_is_told(void)
{
    ask_ok("mode bottom auto");
    samples(1);
    ask_ok("tune bottom simc 100 20 600");
    TEST_ASSERT_FALSE_MESSAGE(said("#"), board.said);
    ask_ok("tune bottom simc -100 20 600");
    TEST_ASSERT_TRUE_MESSAGE(said(DOUBT "loop2.action: 'bottom' acts: its action"), board.said);
    ask_refused("set loop2.action direct", "STATE");
    ask_ok("mode bottom manual");
    samples(1);
    ask_ok("tune bottom simc -100 20 600");
    TEST_ASSERT_FALSE_MESSAGE(said("#"), board.said);
}

static void it_changes_nothing_and_an_open_transaction_stays(void)
{
    ask_ok("begin");
    ask_ok("set loop2.gain 3");
    ask_ok("tune bottom simc 0.01 1 6000");
    TEST_ASSERT_TRUE_MESSAGE(said(DOUBT "gain"), board.said);
    ANSWERS("diff", "set loop2.gain 3");
    ask_ok("abandon");
    ask_ok("tune bottom simc 100 20 600");
    ANSWERS("get loop2.gain", "loop2.gain = 1.5 fraction/fraction");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(settings_that_can_be_set_have_no_remark);
    RUN_TEST(a_gain_beyond_its_range_is_told_with_the_range);
    RUN_TEST(a_sense_that_an_acting_loop_keeps_is_told);
    RUN_TEST(it_changes_nothing_and_an_open_transaction_stays);
    return UNITY_END();
}
