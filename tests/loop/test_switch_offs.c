/* Blocks that switch a feedforward element off while settings are not free: its effect is off at the next tick, the settings follow. */
#include <math.h>

#include "app/app.h"
#include "board_bench.h"
#include "operate/operate.h"
#include "storage/storage.h"
#define VERBS_BESIDE_ELEMENTS
#include "verb_kinds.h"

/* Block 1 watches T1, block 2 the loops' inputs; ff1 adds half of the feed to the reflux, ff2 to the heat. */
void setUp(void)
{
    static const char *const lines[] = {
        "begin",
        "set meas3.name feed",
        "set meas3.unit l/h",
        "set meas3.hi 10",
        "set meas5.name seen",
        "set meas5.unit degC",
        "set meas5.lo 60",
        "set meas5.hi 160",
        "set block1.kind watch",
        "set block1.inputs T1",
        "set block1.points seen",
        "set block2.kind pair",
        "set block2.loops top,bottom",
        "set block2.inputs feed",
        "set ff1.from feed",
        "set ff1.to reflux",
        "set ff1.gain 0.5",
        "set ff2.from feed",
        "set ff2.to heat",
        "set ff2.gain 0.5",
        "apply",
        "out reflux 5",
        "out heat 1",
    };
    memset(&watch_proposes, 0, sizeof watch_proposes);
    memset(&watch_switches_off, 0, sizeof watch_switches_off);
    memset(&pair_switches_off, 0, sizeof pair_switches_off);
    memory_port_erase_all();
    running();
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
    samples(2);
    ask_ok("mode top auto");
    ask_ok("mode bottom auto");
    samples(3);
    board_forget();
}
void tearDown(void) {}

static double reflux(void)
{
    return (double)board.command.output[0].value;
}

/* Reflux that a step of the feed by a tenth of its span adds. */
static double added(void)
{
    double before = reflux();
    board.values[2] += board.values[2] < 7 ? 1 : -1;
    samples(1);
    return reflux() - before;
}

#define ASSERT_ACTS()   TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.5, fabs(added()))
#define ASSERT_SILENT() TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, added())

static struct block_switch_off off(uint8_t element)
{
    return (struct block_switch_off){
        .n = 2,
        .element = switch_off_of_ff(element),
        .value = {{proposed_own(1), 0}, {proposed_setting(PROPOSED_FF_GAIN, element), 0}}};
}

/* In the step of the next sample. */
static void switches_off(void)
{
    double before = reflux();
    watch_switches_off = off(0);
    board_forget();
    samples(1);
    TEST_ASSERT_TRUE_MESSAGE(said(" warning SWITCHED_OFF ff1 1 "), board.said);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before, reflux());
}

static void is_set(const char *line)
{
    char name[40];
    snprintf(name, sizeof name, "get %.*s", (int)strcspn(line, " "), line);
    ANSWERS(name, line);
}

static void settings_have_followed(void)
{
    samples(2);
    is_set("ff1.gain = 0 fraction/fraction");
    is_set("block1.limit = 0 fraction");
    ASSERT_SILENT();
}

static void with_settings_free_they_follow_at_once(void)
{
    ASSERT_ACTS();
    switches_off();
    TEST_ASSERT_TRUE(said(" info BLOCK_ADOPTED watch 1 "));
    ASSERT_SILENT();
    settings_have_followed();
    ask_ok("proposal back");
    samples(2);
    ASSERT_ACTS();
}

static void while_a_transaction_is_open_it_is_silent_and_apply_says_what_came_in(void)
{
    ask_ok("begin");
    ask_ok("set loop1.b 0.5");
    ASSERT_ACTS();
    switches_off();
    ASSERT_SILENT();
    ASSERT_SILENT();
    TEST_ASSERT_FALSE(said("BLOCK_ADOPTED"));
    ANSWERS("diff", "set loop1.b 0.5", "set ff1.gain 0", "set block1.limit 0");
    ANSWERS("apply", "# switched off meanwhile: block1.limit, ff1.gain");
    settings_have_followed();
    is_set("loop1.b = 0.5 -");
    ANSWERS("proposal", "no block has proposed anything");
}

static void an_apply_with_nothing_switched_off_says_nothing(void)
{
    ask_ok("begin");
    ask_ok("set loop1.b 0.5");
    TEST_ASSERT_EQUAL_STRING("ok", ask("apply"));
    TEST_ASSERT_EQUAL_UINT(1, n_reply);
}

static void two_blocks_switch_off_in_the_same_tick(void)
{
    ask_ok("begin");
    pair_switches_off = off(1);
    switches_off();
    TEST_ASSERT_TRUE(said(" warning SWITCHED_OFF ff2 2 "));
    ANSWERS("proposal", "block1 watch has switched off  block1.limit = 0.5, to be 0",
            "block1 watch has switched off  ff1.gain = 0.5, to be 0",
            "block2 pair has switched off  block2.rate = 0.5, to be 0",
            "block2 pair has switched off  ff2.gain = 0.5, to be 0");
    ANSWERS("apply", "# switched off meanwhile: block1.limit, ff1.gain, block2.rate, ff2.gain");
    settings_have_followed();
    is_set("ff2.gain = 0 fraction/fraction");
}

static void after_an_abandoned_transaction_the_settings_follow(void)
{
    ask_ok("begin");
    switches_off();
    type("abandon\nbegin\n"); /* before the main loop looks */
    ask_ok("apply");
    settings_have_followed();
}

static void whoever_sets_it_again_in_the_transaction_has_it_act(void)
{
    ask_ok("begin");
    switches_off();
    ask_ok("set ff1.gain 0.5"); /* what is in force */
    TEST_ASSERT_EQUAL_STRING("ok", ask("apply"));
    TEST_ASSERT_EQUAL_UINT(1, n_reply);
    samples(3);
    is_set("ff1.gain = 0.5 fraction/fraction");
    ASSERT_ACTS();
}

static void another_proposal_that_waits_is_no_hindrance(void)
{
    watch_proposes.n = 1;
    watch_proposes.value[0] = (struct proposed_value){proposed_setting(PROPOSED_LOOP_GAIN, 0), 1};
    samples(1);
    TEST_ASSERT_TRUE(said("BLOCK_PROPOSES"));
    switches_off();
    ASSERT_SILENT();
    settings_have_followed();
    ask_ok("proposal accept");
}

static void begin_sequence(void)
{
    ask_ok("begin");
    ask_ok("set step1.seq stop");
    ask_ok("set step1.until confirm");
    ask_ok("apply");
    samples(1);
    ask_ok("seq stop");
    samples(1);
}

static void while_a_sequence_is_under_way(void)
{
    begin_sequence();
    switches_off();
    ASSERT_SILENT();
    is_set("ff1.gain = 0.5 fraction/fraction");
    ask_ok("seq confirm");
    settings_have_followed();
}

static void other_settings_of_the_element_have_it_act(void)
{
    begin_sequence();
    switches_off();
    ask_ok("set ff1.gain -0.5");
    samples(1);
    ASSERT_ACTS();
    ask_ok("seq confirm");
    samples(3);
    is_set("ff1.gain = -0.5 fraction/fraction");
    ASSERT_ACTS();
}

static void other_settings_of_anything_else_do_not(void)
{
    begin_sequence();
    switches_off();
    ask_ok("set ff2.gain 0.25");
    ask_ok("set meas3.hi 20"); /* what it looks at */
    samples(3);
    ASSERT_SILENT();
}

static void a_block_that_is_gone_leaves_the_element_off(void)
{
    begin_sequence();
    switches_off();
    ask_ok("set block1.kind -");
    samples(2);
    ask_ok("seq confirm");
    samples(3);
    is_set("ff1.gain = 0 fraction/fraction");
    ask_ok("set block2.kind -");
}

static void while_settings_are_saved(void)
{
    const struct storage *storage = app_door(app_instance())->service->storage;
    struct frame f;
    TEST_ASSERT_EQUAL(5, memory_port_give(HAL_UART_CONSOLE, "save\n", 5));
    for (unsigned n = 0; n < 100 && !storage_saving(storage); n++)
        memory_port_turn();
    TEST_ASSERT_TRUE(storage_saving(storage));
    watch_switches_off = off(0);
    for (unsigned n = 0; n < 2; n++) {
        board.number++;
        board.time_ms += board.tick_ms;
        board.values[2] += n; /* in the tick after it */
        pack_present_sample(&f);
        link_give(&f);
        memory_port_turn();
        TEST_ASSERT_TRUE(storage_saving(storage));
    }
    double before = reflux();
    board_run();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before, reflux());
    TEST_ASSERT_TRUE(said(" warning SWITCHED_OFF ff1 1 "));
    settings_have_followed();
}

/* Two terms of a feedforward element blockN, from the feed to the reflux, in place of ff1. */
static void two_terms(void)
{
    static const char *const lines[] = {"begin",
                                        "set ff1.gain 0",
                                        "set block3.kind leadlag",
                                        "set block3.inputs feed",
                                        "set block3.points reflux",
                                        "set block3.from.1 1,1,0,0,0,0,0,0",
                                        "set block3.to.1 1,1,0,0,0,0,0,0",
                                        "set block3.gain.1 0.25,0.1,0,0,0,0,0,0",
                                        "apply"};
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
    samples(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.35, fabs(added()));
    watch_switches_off = (struct block_switch_off){
        .n = 1, .element = switch_off_term(2, 0), .value = {{proposed_in_row(2, 3, 0, 0), 0}}};
    ask_ok("begin");
    board_forget();
    samples(1);
    TEST_ASSERT_TRUE_MESSAGE(said(" warning SWITCHED_OFF block3.term1 1 "), board.said);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.1, fabs(added()));
}

static void a_term_of_an_element_is_silent_and_the_others_go_on(void)
{
    two_terms();
    ANSWERS("apply", "# switched off meanwhile: block3.gain.1");
    samples(2);
    is_set("block3.gain.1 = 0,0.1,0,0,0,0,0,0 -");
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.1, fabs(added()));
}

static void other_settings_of_the_term_have_it_act(void)
{
    two_terms();
    ask_ok("set block3.gain.1 -0.25,0.1,0,0,0,0,0,0");
    ask_ok("apply");
    samples(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.15, fabs(added()));
}

static void other_settings_of_another_term_do_not(void)
{
    begin_sequence();
    two_terms();
    ask_ok("abandon");
    ask_ok("set block3.gain.1 0.25,0.2,0,0,0,0,0,0");
    samples(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.2, fabs(added()));
    ask_ok("set block3.dead.1 0,5,0,0,0,0,0,0"); /* it needs more memory */
    samples(2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, fabs(added()));
}

static void while_start_up_is_under_way(void)
{
    ask_ok("mode top manual");
    ask_ok("mode bottom manual");
    samples(1);
    ask_ok("commission begin");
    samples(2);
    watch_switches_off = off(0);
    samples(2);
    TEST_ASSERT_TRUE(said(" warning SWITCHED_OFF ff1 1 "));
    is_set("ff1.gain = 0.5 fraction/fraction");
    ask_ok("commission abort");
    samples(2);
    is_set("ff1.gain = 0 fraction/fraction");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(with_settings_free_they_follow_at_once);
    RUN_TEST(while_a_transaction_is_open_it_is_silent_and_apply_says_what_came_in);
    RUN_TEST(an_apply_with_nothing_switched_off_says_nothing);
    RUN_TEST(two_blocks_switch_off_in_the_same_tick);
    RUN_TEST(after_an_abandoned_transaction_the_settings_follow);
    RUN_TEST(whoever_sets_it_again_in_the_transaction_has_it_act);
    RUN_TEST(another_proposal_that_waits_is_no_hindrance);
    RUN_TEST(while_a_sequence_is_under_way);
    RUN_TEST(other_settings_of_the_element_have_it_act);
    RUN_TEST(other_settings_of_anything_else_do_not);
    RUN_TEST(a_block_that_is_gone_leaves_the_element_off);
    RUN_TEST(while_settings_are_saved);
    RUN_TEST(a_term_of_an_element_is_silent_and_the_others_go_on);
    RUN_TEST(other_settings_of_the_term_have_it_act);
    RUN_TEST(other_settings_of_another_term_do_not);
    RUN_TEST(while_start_up_is_under_way);
    return UNITY_END();
}
