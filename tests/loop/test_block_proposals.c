/* Proposals of blocks through the whole firmware: checked, in force at once or when accepted, refused, taken back. */
#include "app/app.h"
#include "board_bench.h"
#include "operate/operate.h"
#define VERBS_BESIDE_ELEMENTS
#include "verb_kinds.h"

static struct session client;
static struct answer answer;

/* Block 1 watches T1; loop 1 is in automatic, at its setpoint. */
void setUp(void)
{
    static const char *const lines[] = {
        "begin",
        "set meas5.name seen",
        "set meas5.unit degC",
        "set meas5.lo 60",
        "set meas5.hi 160",
        "set block1.kind watch",
        "set block1.inputs T1",
        "set block1.points seen",
        "apply",
        "out reflux 5",
    };
    memset(&watch_proposes, 0, sizeof watch_proposes);
    no_room = 0;
    running();
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
    samples(2);
    ask_ok("mode top auto");
    samples(3);
    board_forget();
    session_init(&client, app_door(app_instance()));
}
void tearDown(void) {}

static void proposes(uint32_t id, double value)
{
    watch_proposes.value[watch_proposes.n++] = (struct proposed_value){id, (float)value};
}

#define GAIN proposed_setting(PROPOSED_LOOP_GAIN, 0)
#define TI   proposed_setting(PROPOSED_LOOP_TI, 0)

/* In the next sample; the main loop has its turns after it. */
static void gives(enum proposal_manner manner)
{
    watch_proposes.manner = (uint8_t)manner;
    samples(1);
    TEST_ASSERT_EQUAL_UINT8(0, watch_proposes.n);
}

static void is_set(const char *line)
{
    char name[40];
    snprintf(name, sizeof name, "get %.*s", (int)strcspn(line, " "), line);
    ANSWERS(name, line);
}

static void without_a_proposal_it_says_so(void)
{
    ANSWERS("proposal", "no block has proposed anything");
    ask_refused("proposal accept", "STATE");
    TEST_ASSERT_TRUE(said("no proposal waits to be accepted"));
    ask_refused("proposal reject", "STATE");
    ask_refused("proposal back", "STATE");
    TEST_ASSERT_TRUE(said("no proposal is in force that could be taken back"));
    ask_refused("proposal please", "PARSE");
}

static void one_that_needs_nobody_is_in_force_at_the_next_tick_without_a_bump(void)
{
    double before = (double)board.command.output[0].value;
    proposes(GAIN, 3);
    proposes(TI, 150);
    gives(PROPOSAL_AT_ONCE);
    TEST_ASSERT_TRUE(said(" info BLOCK_ADOPTED watch 1 "));
    board_forget();
    samples(1);
    TEST_ASSERT_EQUAL_UINT(1, times_said(" info CONFIG_APPLIED "));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, before, (double)board.command.output[0].value);
    is_set("loop1.gain = 3 fraction/fraction");
    is_set("loop1.ti = 150 s");
    ANSWERS("proposal", "block1 watch proposed what is in force, `proposal back` undoes it",
            "  loop1.gain = 3, before 1", "  loop1.ti = 150, before 200");
    samples(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, before, (double)board.command.output[0].value);
}

static void another_waits_until_it_is_accepted(void)
{
    proposes(GAIN, 3);
    gives(PROPOSAL_WHEN_ACCEPTED);
    TEST_ASSERT_TRUE(
        said(" info BLOCK_PROPOSES watch 1 a block proposes settings, see `proposal`"));
    samples(3);
    is_set("loop1.gain = 1 fraction/fraction");
    ANSWERS("proposal", "block1 watch proposes, to be accepted or rejected",
            "  loop1.gain = 1, proposed 3");
    ask_ok("proposal accept");
    samples(1);
    is_set("loop1.gain = 3 fraction/fraction");
    ask_ok("events");
    TEST_ASSERT_TRUE(said(" action DO_PROPOSAL accept 1 "));
    ask_refused("proposal accept", "STATE");
}

static void the_way_back_is_one_apply_and_leaves_the_rest_alone(void)
{
    proposes(GAIN, 3);
    proposes(TI, 150);
    proposes(GAIN, 4); /* the last counts */
    gives(PROPOSAL_AT_ONCE);
    samples(1);
    is_set("loop1.gain = 4 fraction/fraction");
    ask_ok("set loop1.b 0.5");
    samples(1);
    ask_ok("proposal back");
    board_forget();
    samples(1);
    TEST_ASSERT_EQUAL_UINT(1, times_said(" info CONFIG_APPLIED "));
    is_set("loop1.gain = 1 fraction/fraction");
    is_set("loop1.ti = 200 s");
    is_set("loop1.b = 0.5 -");
    ask_ok("events");
    TEST_ASSERT_TRUE(said(" action DO_PROPOSAL back 3 "));
    ANSWERS("proposal", "no block has proposed anything");
    ask_refused("proposal back", "STATE");
}

static void one_that_is_rejected_makes_room(void)
{
    proposes(GAIN, 3);
    gives(PROPOSAL_WHEN_ACCEPTED);
    proposes(GAIN, 4);
    samples(2);
    TEST_ASSERT_EQUAL_UINT(2, no_room);
    ask_ok("proposal reject");
    samples(1);
    ANSWERS("proposal", "block1 watch proposes, to be accepted or rejected",
            "  loop1.gain = 1, proposed 4");
    ask_ok("events");
    TEST_ASSERT_TRUE(said(" action DO_PROPOSAL reject 0 "));
}

static void is_refused(const char *event, const char *line)
{
    watch_proposes.manner = PROPOSAL_AT_ONCE;
    board_forget();
    samples(1);
    TEST_ASSERT_TRUE_MESSAGE(said(event), board.said);
    TEST_ASSERT_FALSE(said("BLOCK_ADOPTED"));
    samples(1);
    ANSWERS("proposal", line);
    is_set("loop1.gain = 1 fraction/fraction");
}

static void one_that_does_not_fit_is_refused_whole_with_field_and_reason(void)
{
    proposes(GAIN, 3);
    proposes(TI, 1e7);
    is_refused(" warning PROPOSAL_REFUSED loop1.ti 1e+07 ",
               "block1 watch refused: loop1.ti is proposed with a value that is not allowed, "
               "1e+07");
    proposes(GAIN, 3);
    proposes(TI, (double)strtof("nan", NULL));
    is_refused(" warning PROPOSAL_REFUSED loop1.ti none ",
               "block1 watch refused: loop1.ti is proposed with a value that is not allowed, none");
    proposes(GAIN, 3);
    proposes(0x4600, 2); /* phase: only the plan knows that the divisor is 1 */
    is_refused(" warning PROPOSAL_REFUSED loop1.phase 2 ",
               "block1 watch refused: loop1.phase 'top' must be below the divisor");
    proposes(GAIN, 3);
    proposes(0x4040, 2);
    is_refused(" warning PROPOSAL_REFUSED loop1.name 2 ",
               "block1 watch refused: loop1.name is not a number: it cannot be proposed");
    proposes(GAIN, 3);
    proposes(0x7100, 2); /* no block has a say in interlocks */
    is_refused(" warning PROPOSAL_REFUSED lock1.limit 2 ",
               "block1 watch refused: lock1.limit is not a setting of a block");
    proposes(GAIN, 3);
    proposes(0x4FC0, 2);
    is_refused(" warning PROPOSAL_REFUSED block1.proposal 2 ",
               "block1 watch refused: block1.proposal names an unknown parameter");
    proposes(GAIN, 3);
    watch_proposes.n = PROPOSAL_MAX + 1;
    is_refused(" warning PROPOSAL_REFUSED block1.proposal 0 ",
               "block1 watch refused: block1.proposal has more values than there is room for");
}

static void one_to_be_accepted_is_checked_when_it_comes(void)
{
    proposes(0x4600, 2);
    gives(PROPOSAL_WHEN_ACCEPTED);
    TEST_ASSERT_TRUE(said(" warning PROPOSAL_REFUSED loop1.phase 2 "));
    TEST_ASSERT_FALSE(said("BLOCK_PROPOSES"));
    ask_refused("proposal accept", "STATE");
}

static void a_refusal_does_not_cost_the_way_back(void)
{
    proposes(GAIN, 3);
    gives(PROPOSAL_AT_ONCE);
    samples(1);
    proposes(TI, -1);
    gives(PROPOSAL_AT_ONCE);
    samples(1);
    ANSWERS("proposal",
            "block1 watch refused: loop1.ti is proposed with a value that is not allowed, -1",
            "block1 watch proposed what is in force, `proposal back` undoes it",
            "  loop1.gain = 3, before 1");
    ask_ok("proposal back");
    samples(1);
    is_set("loop1.gain = 1 fraction/fraction");
}

static void what_is_in_force_already_does_not_cost_the_way_back(void)
{
    proposes(GAIN, 3);
    gives(PROPOSAL_AT_ONCE);
    samples(1);
    board_forget();
    proposes(GAIN, 3);
    gives(PROPOSAL_AT_ONCE);
    samples(1);
    TEST_ASSERT_FALSE(said("BLOCK_ADOPTED") || said("CONFIG_APPLIED"));
    ANSWERS("proposal", "block1 watch proposed what is in force, `proposal back` undoes it",
            "  loop1.gain = 3, before 1");
    proposes(TI, 50); /* there is room for the next */
    gives(PROPOSAL_AT_ONCE);
    TEST_ASSERT_TRUE(said("BLOCK_ADOPTED"));
}

static void one_made_for_other_loops_is_given_up(void)
{
    proposes(GAIN, 3);
    gives(PROPOSAL_WHEN_ACCEPTED);
    ask_ok("set alarm1.limit 5"); /* that changes nothing it is about */
    samples(1);
    ask_ok("set loop2.name foot");
    samples(1);
    TEST_ASSERT_TRUE(said(" warning PROPOSAL_REFUSED block1.proposal 0 "));
    board_forget();
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("to be accepted"));
}

/* Each of what ids and values go by: channels and spans, loops, blocks, feedforwards. */
static void one_made_for_other_channels_spans_or_blocks_is_given_up(void)
{
    static const char *const changes[][2] = {
        {"set meas4.name extra", NULL},
        {"set meas1.hi 170", NULL},
        {"set meas1.lo 50", NULL},
        {"set mv4.name other", NULL},
        {"set mv2.hi 4", NULL},
        {"set loop2.pv feed", NULL},
        {"set loop2.out spare", NULL},
        {"set block1.inputs T10", NULL},
        {"set block1.points again", NULL},
        {"set block2.loops bottom,top", NULL},
        {"set block2.kind watch", "set block2.loops -"},
        {"set block3.kind watch", NULL},
        {"set ff1.from T10", NULL},
        {"set ff1.to heat", NULL},
    };
    for (unsigned k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        setUp();
        ask_ok("mode top manual"); /* spans of a loop that acts do not change */
        samples(1);
        ask_ok("begin");
        ask_ok("set meas3.name feed");
        ask_ok("set mv3.name spare");
        ask_ok("set meas6.name again");
        ask_ok("set block2.kind pair");
        ask_ok("set block2.loops top,bottom");
        ask_ok("set ff1.from feed");
        ask_ok("set ff1.to reflux");
        ask_ok("apply");
        samples(1);
        proposes(GAIN, 3);
        gives(PROPOSAL_WHEN_ACCEPTED);
        TEST_ASSERT_TRUE(said("BLOCK_PROPOSES"));
        ask_ok("mode top manual"); /* a loop that acts keeps its channels and spans */
        samples(1);
        ask_ok("begin");
        for (unsigned n = 0; n < 2 && changes[k][n]; n++)
            ask_ok(changes[k][n]);
        ask_ok("apply");
        samples(1);
        TEST_ASSERT_TRUE_MESSAGE(said(" warning PROPOSAL_REFUSED block1.proposal 0 "),
                                 changes[k][0]);
    }
}

static void one_whose_block_is_gone_is_given_up_under_its_number_alone(void)
{
    proposes(GAIN, 3);
    gives(PROPOSAL_WHEN_ACCEPTED);
    ask_ok("set block1.kind -");
    samples(1);
    ANSWERS("proposal",
            "block1 refused: block1.proposal is out of date: loops, blocks or spans have changed");
}

static void nor_does_the_way_back_lead_into_other_loops(void)
{
    proposes(GAIN, 3);
    gives(PROPOSAL_AT_ONCE);
    samples(1);
    ask_ok("set loop1.name head");
    samples(1);
    ask_refused("proposal back", "CONFLICT");
    TEST_ASSERT_TRUE(said("loops, blocks or spans have changed since"));
    is_set("loop1.gain = 3 fraction/fraction");
}

static void it_waits_behind_an_open_transaction_and_a_sequence(void)
{
    ask_ok("begin");
    ask_ok("set loop1.b 0.5");
    proposes(GAIN, 3);
    gives(PROPOSAL_AT_ONCE);
    samples(2);
    ANSWERS("proposal", "block1 watch proposes, in force as soon as settings may be changed",
            "  loop1.gain = 1, proposed 3");
    TEST_ASSERT_FALSE(said("BLOCK_ADOPTED"));
    ask_ok("apply");
    samples(2);
    is_set("loop1.gain = 3 fraction/fraction");
    is_set("loop1.b = 0.5 -");
    ask_ok("begin");
    ask_refused("proposal back", "STATE");
    TEST_ASSERT_TRUE(said("a transaction is open already"));
    ask_ok("abandon");

    ask_ok("begin");
    ask_ok("set step1.seq stop");
    ask_ok("set step1.until confirm");
    ask_ok("apply");
    samples(1);
    ask_ok("seq stop");
    samples(1);
    proposes(GAIN, 5);
    gives(PROPOSAL_AT_ONCE);
    ask_refused("proposal back", "BUSY");
    samples(2);
    is_set("loop1.gain = 3 fraction/fraction");
    ask_ok("seq confirm");
    samples(3);
    is_set("loop1.gain = 5 fraction/fraction");
}

static void it_waits_behind_automatic_start_up(void)
{
    ask_ok("mode top manual");
    samples(1);
    ask_ok("commission begin");
    samples(3);
    proposes(GAIN, 3);
    gives(PROPOSAL_AT_ONCE);
    samples(5);
    TEST_ASSERT_FALSE(said("BLOCK_ADOPTED"));
    is_set("loop1.gain = 1 fraction/fraction");
    ask_refused("proposal back", "STATE");
    ask_ok("commission abort");
    samples(3);
    is_set("loop1.gain = 3 fraction/fraction");
}

/* Between the `adopt` of a start-up and the tick in which the trial begins. */
static void it_waits_while_start_up_puts_its_settings_on_trial(void)
{
    struct commission *start_up = client.door->service->commission;
    ask_ok("begin");
    proposes(GAIN, 3);
    gives(PROPOSAL_AT_ONCE);
    start_up->requests.ask = COMMISSION_ASK_TRIAL;
    ask_ok("abandon");
    is_set("loop1.gain = 1 fraction/fraction");
    start_up->requests.ask = COMMISSION_ASK_NONE;
    board_run();
    samples(1);
    is_set("loop1.gain = 3 fraction/fraction");
}

static void is_withdrawn(const char *event)
{
    samples(1);
    TEST_ASSERT_TRUE_MESSAGE(said(event), board.said);
    ask_refused("proposal accept", "STATE");
    is_set("loop1.gain = 1 fraction/fraction");
}

static void its_block_takes_it_back(void)
{
    proposes(GAIN, 3);
    gives(PROPOSAL_WHEN_ACCEPTED);
    watch_withdraws = true;
    is_withdrawn(" info PROPOSAL_WITHDRAWN watch 1 ");
    proposes(GAIN, 4); /* there is room for the next */
    gives(PROPOSAL_WHEN_ACCEPTED);
    ask_ok("proposal accept");
}

static void its_block_takes_it_back_behind_an_open_transaction(void)
{
    ask_ok("begin");
    proposes(GAIN, 3);
    gives(PROPOSAL_AT_ONCE);
    watch_withdraws = true;
    samples(1);
    ask_ok("abandon");
    is_withdrawn("");
}

static void serves_a_pair(void)
{
    static const char *const lines[] = {"begin",
                                        "set block2.kind pair",
                                        "set block2.loops top,bottom",
                                        "set block2.inputs feed",
                                        "set meas3.name feed",
                                        "set meas3.unit l/h",
                                        "set meas3.hi 10",
                                        "apply",
                                        "mode bottom auto"};
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
    samples(3);
}

static void another_block_cannot_take_it_back(void)
{
    serves_a_pair();
    proposes(GAIN, 3);
    gives(PROPOSAL_WHEN_ACCEPTED);
    pair_withdraws = true;
    samples(2);
    TEST_ASSERT_FALSE(pair_withdraws);
    ask_ok("proposal accept");
}

static void a_block_that_is_switched_off_has_nothing_waiting(void)
{
    serves_a_pair();
    pair_proposes = (struct block_proposal){.n = 1, .value = {{GAIN, 3}}};
    samples(1);
    TEST_ASSERT_TRUE(said(" info BLOCK_PROPOSES pair 2 "));
    ask_ok("block 2 off");
    is_withdrawn(" info PROPOSAL_WITHDRAWN pair 2 ");
}

static void settings_of_blocks_are_proposed_too(void)
{
    proposes(proposed_own(1), 0.75);
    gives(PROPOSAL_AT_ONCE);
    samples(1);
    is_set("block1.limit = 0.75 fraction");
    ask_ok("proposal back");
    samples(1);
    is_set("block1.limit = 0.5 fraction");
}

/* Settings of an element for block 2. */
static const char *const element[] = {"begin",
                                      "set meas3.name feed",
                                      "set meas3.unit l/h",
                                      "set meas3.hi 10",
                                      "set block2.kind leadlag",
                                      "set block2.inputs feed",
                                      "set block2.points reflux",
                                      "set block2.from.1 1,1,0,0,0,0,0,0",
                                      "set block2.to.1 1,1,0,0,0,0,0,0",
                                      "apply"};

#define ELEMENT_GAIN(row, col) proposed_in_row(1, 3, row, col)

static void a_value_in_a_row_is_proposed_too(void)
{
    for (unsigned i = 0; i < sizeof element / sizeof element[0]; i++)
        ask_ok(element[i]);
    samples(2);
    proposes(ELEMENT_GAIN(0, 1), 0.25);
    gives(PROPOSAL_WHEN_ACCEPTED);
    ANSWERS("proposal", "block1 watch proposes, to be accepted or rejected",
            "  block2.gain.1 value 2 = 0, proposed 0.25");
    ask_ok("proposal accept");
    samples(1);
    is_set("block2.gain.1 = 0,0.25,0,0,0,0,0,0 -");
    ANSWERS("proposal", "block1 watch proposed what is in force, `proposal back` undoes it",
            "  block2.gain.1 value 2 = 0.25, before 0");
    ask_ok("proposal back");
    samples(1);
    is_set("block2.gain.1 = 0,0,0,0,0,0,0,0 -");
}

static void a_value_in_a_row_must_fit_as_any_other(void)
{
    for (unsigned i = 0; i < sizeof element / sizeof element[0]; i++)
        ask_ok(element[i]);
    samples(2);
    proposes(ELEMENT_GAIN(0, 1), 101);
    is_refused(" warning PROPOSAL_REFUSED block2.gain 101 ",
               "block1 watch refused: block2.gain is proposed with a value that is not allowed, "
               "101");
    proposes(ELEMENT_GAIN(1, 1), 1); /* there is one row */
    is_refused(" warning PROPOSAL_REFUSED block1.proposal 1 ",
               "block1 watch refused: block1.proposal names an unknown parameter");
    proposes(proposed_in_row(1, 8, 0, 4), 1); /* lo: four values */
    is_refused(" warning PROPOSAL_REFUSED block1.proposal 1 ",
               "block1 watch refused: block1.proposal names an unknown parameter");
    proposes(proposed_in_row(1, 12, 0, 1), 1); /* washout: no row */
    is_refused(" warning PROPOSAL_REFUSED block1.proposal 1 ",
               "block1 watch refused: block1.proposal names an unknown parameter");
}

static void changing_settings_is_for_engineers(void)
{
    proposes(GAIN, 3);
    gives(PROPOSAL_WHEN_ACCEPTED);
    ask_ok("key still");
    ask_ok("lock");
    ask_ok("proposal");
    ask_refused("proposal accept", "LOCKED");
    ask_refused("proposal reject", "LOCKED");
    ask_refused("proposal back", "LOCKED");
    ask_ok("unlock still");
    ask_ok("proposal accept");
}

static void a_client_without_text_does_the_same(void)
{
    struct proposal_reading r;
    struct parameter p;
    float value;
    TEST_ASSERT_FALSE(operate_proposal(&client, &r));
    proposes(GAIN, 3);
    gives(PROPOSAL_WHEN_ACCEPTED);
    TEST_ASSERT_TRUE(operate_proposal(&client, &r));
    TEST_ASSERT_EQUAL(PROPOSAL_OFFERED, r.state);
    TEST_ASSERT_EQUAL_UINT8(1, r.values);
    TEST_ASSERT_TRUE(operate_proposed(&client, 0, &p, &value));
    TEST_ASSERT_EQUAL_HEX32(GAIN, parameter_id(&p));
    TEST_ASSERT_EQUAL_FLOAT(3, value);
    TEST_ASSERT_FALSE(operate_proposed(&client, 1, &p, &value));
    TEST_ASSERT_EQUAL(ERR_OK, operate_proposal_accept(&client, &answer));
    samples(1);
    TEST_ASSERT_TRUE(operate_proposal(&client, &r));
    TEST_ASSERT_EQUAL(PROPOSAL_FREE, r.state);
    TEST_ASSERT_NOT_NULL(r.back);
    TEST_ASSERT_NULL(r.refused);
    TEST_ASSERT_EQUAL_FLOAT(1, r.back->value[0].value);
    TEST_ASSERT_EQUAL(ERR_OK, operate_proposal_back(&client, &answer));
    samples(1);
    is_set("loop1.gain = 1 fraction/fraction");
    TEST_ASSERT_EQUAL(ERR_STATE, operate_proposal_reject(&client, &answer));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_a_proposal_it_says_so);
    RUN_TEST(one_that_needs_nobody_is_in_force_at_the_next_tick_without_a_bump);
    RUN_TEST(another_waits_until_it_is_accepted);
    RUN_TEST(the_way_back_is_one_apply_and_leaves_the_rest_alone);
    RUN_TEST(one_that_is_rejected_makes_room);
    RUN_TEST(one_that_does_not_fit_is_refused_whole_with_field_and_reason);
    RUN_TEST(one_to_be_accepted_is_checked_when_it_comes);
    RUN_TEST(a_refusal_does_not_cost_the_way_back);
    RUN_TEST(what_is_in_force_already_does_not_cost_the_way_back);
    RUN_TEST(one_made_for_other_loops_is_given_up);
    RUN_TEST(one_made_for_other_channels_spans_or_blocks_is_given_up);
    RUN_TEST(one_whose_block_is_gone_is_given_up_under_its_number_alone);
    RUN_TEST(nor_does_the_way_back_lead_into_other_loops);
    RUN_TEST(it_waits_behind_an_open_transaction_and_a_sequence);
    RUN_TEST(it_waits_behind_automatic_start_up);
    RUN_TEST(it_waits_while_start_up_puts_its_settings_on_trial);
    RUN_TEST(its_block_takes_it_back);
    RUN_TEST(its_block_takes_it_back_behind_an_open_transaction);
    RUN_TEST(another_block_cannot_take_it_back);
    RUN_TEST(a_block_that_is_switched_off_has_nothing_waiting);
    RUN_TEST(settings_of_blocks_are_proposed_too);
    RUN_TEST(a_value_in_a_row_is_proposed_too);
    RUN_TEST(a_value_in_a_row_must_fit_as_any_other);
    RUN_TEST(changing_settings_is_for_engineers);
    RUN_TEST(a_client_without_text_does_the_same);
    return UNITY_END();
}
