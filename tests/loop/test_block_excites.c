/* A block's test signal through the whole firmware: what goes to the plant, what people are told, and who may have the plant. */
#include "board_bench.h"
#include "exciting_kinds.h"

/* Block 1 serves both loops and has begun to excite the reflux, which stood at 2 of 0 to 10 l/h. */
static void exciting(void)
{
    static const char *const lines[] = {
        "begin",
        "set block1.kind held",
        "set block1.loops top,bottom",
        "apply",
    };
    memset(wish, 0, sizeof wish);
    running();
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
    ask_ok("out top 2");
    samples(2);
    ask_ok("mode top auto");
    samples(2);
    board_forget();
    wish[CONTROLLER].ask[0] = on(EXCITE_MV, 0, 0.05);
    samples(2);
}

void setUp(void)
{
    exciting();
}
void tearDown(void) {}

static double reflux(void)
{
    return (double)board.command.output[0].value;
}

static void the_plant_gets_it_and_people_are_told(void)
{
    TEST_ASSERT_TRUE(said(" info EXCITATION_BEGUN held 1 "));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2.5, reflux());
    ANSWERS("block", "block1 held on  loops top,bottom  excites the plant");
    wish[CONTROLLER].ask[0].value = num_from_float(-0.05f);
    samples(1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.5, reflux());
    wish[CONTROLLER].ask[0].what = EXCITE_NOTHING;
    samples(1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2.0, reflux());
    TEST_ASSERT_TRUE(said(" info EXCITATION_ENDED asked 1 "));
}

static void start_up_does_not_begin_and_says_who_has_the_plant_and_how_to_free_it(void)
{
    ask_refused("commission begin", "STATE");
    TEST_ASSERT_TRUE(said("held: excites the plant: `block BLOCK off`"));
    ask_ok("block 1 off");
    samples(1);
    TEST_ASSERT_TRUE(said(" info EXCITATION_ENDED gave_up 1 "));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2.0, reflux());
    ask_refused("commission begin", "STATE");
    TEST_ASSERT_FALSE(said("excites the plant"));
}

static void a_relay_test_does_not_either(void)
{
    ask_refused("commission relay bottom", "STATE");
    TEST_ASSERT_TRUE(said("held: excites the plant"));
}

static void silence_ends_it_and_it_does_not_come_back_with_the_link(void)
{
    board.mute = true;
    pass(6000);
    TEST_ASSERT_TRUE(said(" info EXCITATION_ENDED safe_state 1 "));
    board.mute = false;
    pass(3000);
    samples(3);
    ask_ok("out top 2");
    samples(2);
    ask_ok("mode top auto");
    samples(3); /* it asks as before, but has not paused */
    TEST_ASSERT_FALSE(said("EXCITATION_BEGUN"));
    TEST_ASSERT_EQUAL(EXCITE_ENDED, wish[CONTROLLER].state);
    TEST_ASSERT_EQUAL(EXCITE_SAFE, wish[CONTROLLER].reason);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 2.0, reflux());
}

static void an_apply_that_has_nothing_to_do_with_it_goes_by_without_a_trace(void)
{
    ask_ok("set alarm1.on T1");
    samples(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2.5, reflux());
    ask_ok("set loop1.gain 3");
    samples(1);
    TEST_ASSERT_TRUE(said(" info EXCITATION_ENDED settings 1 "));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2.0, reflux());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_plant_gets_it_and_people_are_told);
    RUN_TEST(start_up_does_not_begin_and_says_who_has_the_plant_and_how_to_free_it);
    RUN_TEST(a_relay_test_does_not_either);
    RUN_TEST(silence_ends_it_and_it_does_not_come_back_with_the_link);
    RUN_TEST(an_apply_that_has_nothing_to_do_with_it_goes_by_without_a_trace);
    return UNITY_END();
}
