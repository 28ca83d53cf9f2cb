/* Verbs of blocks through the whole firmware: at the console, and by a client without text. */
#include "app/app.h"
#include "board_bench.h"
#include "operate/operate.h"
#include "verb_kinds.h"

static struct session client;
static struct answer answer;

/* Block 1 watches T1, block 2 serves both loops, block 3 is another watch. */
static void with_blocks(void)
{
    static const char *const lines[] = {
        "begin",
        "set meas5.name seen",
        "set meas5.unit degC",
        "set meas5.lo 60",
        "set meas5.hi 160",
        "set meas6.name again",
        "set meas6.unit degC",
        "set block1.kind watch",
        "set block1.inputs T1",
        "set block1.points seen",
        "set block2.kind pair",
        "set block2.loops top,bottom",
        "apply",
    };
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
    samples(2);
    board_forget();
}

void setUp(void)
{
    running();
    with_blocks();
    session_init(&client, app_door(app_instance()));
}
void tearDown(void) {}

static void blocks_are_listed_with_what_they_do(void)
{
    ANSWERS("block", "block1 watch on  inputs T1  points seen", "block2 pair on  loops top,bottom");
    ANSWERS("block 1", "block1 watch on  inputs T1  points seen", "  held = 0.25", "  limit = 0.5",
            "  verb freeze: keeps its point where it is", "  verb thaw: lets it go on",
            "  verb tune [1..100 s]: to that time, or the one it finds (engineer)",
            "  alarm high: its input is above the limit, fraction of span",
            "  event crossed: its input has passed the limit, fraction of span");
    ANSWERS("block pair", "block2 pair on  loops top,bottom", "  verb tune 1..100 s: to that time",
            "  alarm spent: it has no room, share");
    ANSWERS("block block2", "block2 pair on  loops top,bottom",
            "  verb tune 1..100 s: to that time", "  alarm spent: it has no room, share");
}

static unsigned locks, read_values;

static void hold_tick(void)
{
    locks++;
}

static void let_tick_go(void)
{
    locks--;
}

static void read_while_held(void)
{
    TEST_ASSERT_EQUAL_UINT(1, locks);
    read_values++;
}

/* A value may be computed from several that the tick writes together. */
static void inner_values_are_read_while_the_tick_is_held_off(void)
{
    float value;
    memory_port_set_tick_lock(hold_tick, let_tick_go);
    watch_described = read_while_held;
    ask_ok("block 1");
    TEST_ASSERT_EQUAL_STRING("held", operate_block_value(&client, 0, 0, &value));
    watch_described = NULL;
    memory_port_set_tick_lock(NULL, NULL);
    TEST_ASSERT_TRUE(read_values > 3);
    TEST_ASSERT_EQUAL_UINT(0, locks);
}

static void a_block_is_switched_off_and_on_and_says_why_it_is_off(void)
{
    ask_ok("block 2 off");
    samples(1);
    TEST_ASSERT_TRUE(said(" alarm BLOCK_GAVE_UP asked 2 "));
    ANSWERS("block pair", "block2 pair off: asked  loops top,bottom",
            "  verb tune 1..100 s: to that time", "  alarm spent: it has no room, share");
    ask_refused("block 2 tune 5", "STATE");
    TEST_ASSERT_TRUE(said("pair: is off"));
    ask_ok("block 2 on");
    samples(1);
    TEST_ASSERT_TRUE(said(" info BLOCK_ON pair 2 "));
    ask_ok("events");
    TEST_ASSERT_TRUE(said(" action DO_BLOCK block2.off 0 "));
    TEST_ASSERT_TRUE(said(" action DO_BLOCK block2.on 0 "));
    ask_refused("block 1 off", "STATE");
    TEST_ASSERT_TRUE(said("watch: is an estimator"));
}

static void a_verb_reaches_the_block_with_the_next_sample(void)
{
    ask_ok("block watch tune 12.5");
    TEST_ASSERT_EQUAL_UINT(0, watch_state->tunings);
    samples(1);
    TEST_ASSERT_EQUAL_UINT(1, watch_state->tunings);
    TEST_ASSERT_EQUAL_FLOAT(12.5f, watch_state->tuned);
    TEST_ASSERT_TRUE(said(" info BLOCK_VERB block1.tune 12.5 "));
    ask_ok("events");
    TEST_ASSERT_TRUE(said(" action DO_BLOCK block1.tune 12.5 "));
    ask_ok("block 1 freeze");
    ask_ok("block 1 freeze");
    samples(1);
    TEST_ASSERT_TRUE(said(" info BLOCK_VERB block1.freeze 0 "));
    TEST_ASSERT_TRUE(said(" warning BLOCK_REFUSED frozen 1 "));
    ask_ok("events");
    TEST_ASSERT_TRUE(said(" action DO_BLOCK block1.freeze 0 "));
}

static void a_number_may_be_either_end_of_its_range(void)
{
    ask_ok("block 2 tune 1");
    samples(1);
    TEST_ASSERT_EQUAL_FLOAT(1, pair_state->tuned);
    ask_ok("block 2 tune 100");
    samples(1);
    TEST_ASSERT_EQUAL_FLOAT(100, pair_state->tuned);
    ask_refused("block 2 tune 0.99", "RANGE");
    ask_refused("block 2 tune 100.1", "RANGE");
}

static void refusals_name_what_there_is(void)
{
    ask_refused("block 1 frz", "UNKNOWN");
    TEST_ASSERT_TRUE(said("frz: no such verb; its kind has: freeze thaw tune\n"));
    ask_refused("block 2 frz", "UNKNOWN");
    TEST_ASSERT_TRUE(said("frz: no such verb; its kind has: tune; `block N on|off` switches it\n"));
    ask_refused("block 3", "UNKNOWN");
    TEST_ASSERT_TRUE(said("no such block; `block` lists them"));
    ask_refused("block gmv tune", "UNKNOWN");
    ask_refused("block 2 tune", "PARSE");
    TEST_ASSERT_TRUE(said("tune: needs a number"));
    ask_refused("block 1 freeze 3", "PARSE");
    TEST_ASSERT_TRUE(said("freeze: takes no number"));
    ask_refused("block 2 tune 0", "RANGE");
    TEST_ASSERT_TRUE(said("tune: 0 refused, allowed: 1 .. 100 s"));
    ask_refused("block 2 tune x", "PARSE");
    ask_refused("block 2 on 1", "PARSE");
    samples(1);
    TEST_ASSERT_EQUAL_UINT(0, watch_state->tunings + pair_state->tunings);
    ask_ok("begin");
    ask_ok("set block3.kind watch");
    ask_ok("set block3.inputs T10");
    ask_ok("set block3.points again");
    ask_ok("apply");
    samples(1);
    ask_refused("block watch freeze", "CONFLICT");
    TEST_ASSERT_TRUE(said("watch: several blocks are of this kind"));
    ask_ok("block 3 freeze");
}

static void engineers_verbs_are_for_engineers(void)
{
    ask_ok("key still");
    ask_ok("lock");
    ask_refused("block 1 tune", "LOCKED");
    ask_ok("block 1 freeze");
    ask_ok("block 2 off");
    ask_ok("unlock still");
    ask_ok("block 1 tune");
    samples(1);
    TEST_ASSERT_EQUAL_UINT(1, watch_state->tunings);
}

/* Earlier requests come into force first. */
static void a_verb_meets_the_plan_it_was_asked_in(void)
{
    ask_ok("begin");
    ask_ok("set block1.kind -");
    ask_ok("set block4.kind watch");
    ask_ok("set block4.inputs T1");
    ask_ok("set block4.points seen");
    ask_ok("apply");
    ask_ok("block 4 freeze");
    ask_refused("block 1 freeze", "UNKNOWN");
    samples(1);
    TEST_ASSERT_TRUE(watch_state->frozen);
    TEST_ASSERT_TRUE(said(" info BLOCK_VERB block4.freeze 0 "));
}

static void completes(const char *begun, const char *whole)
{
    board_forget();
    type("\x15");
    type(begun);
    type("\t");
    TEST_ASSERT_TRUE_MESSAGE(said(whole), begun);
}

static void blocks_and_verbs_are_completed(void)
{
    type("mode human\n");
    completes("block 1 fr", "block 1 freeze");
    completes("block 2 of", "block 2 off");
}

static void a_client_without_text_does_the_same(void)
{
    struct block_reading r;
    uint8_t block, verb;
    float number = 7, value;
    TEST_ASSERT_TRUE(operate_block(&client, 1, &r));
    TEST_ASSERT_TRUE(r.kind == &pair_kind && r.gave_up == NULL && r.work == BLOCK_IDLE);
    TEST_ASSERT_FALSE(operate_block(&client, 2, &r));
    TEST_ASSERT_FALSE(operate_block(&client, PLAN_NONE, &r));
    TEST_ASSERT_EQUAL_STRING("held", operate_block_value(&client, 0, 0, &value));
    TEST_ASSERT_EQUAL_FLOAT(0.25f, value);
    TEST_ASSERT_NULL(operate_block_value(&client, 1, 0, &value)); /* it describes nothing */

    TEST_ASSERT_EQUAL(ERR_OK, operate_find_block(&client, "watch", &block, &answer));
    TEST_ASSERT_EQUAL(ERR_OK, operate_find_verb(&client, block, "tune", &verb, &answer));
    TEST_ASSERT_EQUAL(ERR_OK, operate_verb(&client, block, verb, &number, &answer));
    samples(1);
    TEST_ASSERT_EQUAL_FLOAT(7, watch_state->tuned);
    TEST_ASSERT_EQUAL(ERR_OK, operate_block_switch(&client, 1, false, &answer));
    samples(1);
    TEST_ASSERT_TRUE(operate_block(&client, 1, &r));
    TEST_ASSERT_EQUAL_STRING("asked", r.gave_up);

    TEST_ASSERT_EQUAL(ERR_STATE, operate_verb(&client, 1, 0, &number, &answer));
    TEST_ASSERT_EQUAL(ERR_UNKNOWN, operate_verb(&client, 0, 3, NULL, &answer));
    TEST_ASSERT_EQUAL(ANSWER_VERBS, answer.more);
    TEST_ASSERT_TRUE(answer.kind == &watch_kind);
    TEST_ASSERT_EQUAL(ERR_UNKNOWN, operate_verb(&client, 2, 0, NULL, &answer));
    TEST_ASSERT_EQUAL(ERR_UNKNOWN, operate_verb(&client, PLAN_NONE, 0, NULL, &answer));
    TEST_ASSERT_EQUAL(ERR_UNKNOWN, operate_block_switch(&client, 3, true, &answer));
    TEST_ASSERT_EQUAL(ERR_STATE, operate_block_switch(&client, 0, true, &answer));
    number = (float)atof("nan");
    TEST_ASSERT_EQUAL(ERR_RANGE, operate_verb(&client, 0, verb, &number, &answer));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(blocks_are_listed_with_what_they_do);
    RUN_TEST(inner_values_are_read_while_the_tick_is_held_off);
    RUN_TEST(a_block_is_switched_off_and_on_and_says_why_it_is_off);
    RUN_TEST(a_verb_reaches_the_block_with_the_next_sample);
    RUN_TEST(a_number_may_be_either_end_of_its_range);
    RUN_TEST(refusals_name_what_there_is);
    RUN_TEST(engineers_verbs_are_for_engineers);
    RUN_TEST(a_verb_meets_the_plan_it_was_asked_in);
    RUN_TEST(blocks_and_verbs_are_completed);
    RUN_TEST(a_client_without_text_does_the_same);
    return UNITY_END();
}
