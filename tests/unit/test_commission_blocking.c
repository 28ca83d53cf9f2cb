/* commission/blocking.c, channels.c and test_outputs.c: what stands in the way of a test and of a trial, one thing after the other, on either side of each
 * bound. */
#include <string.h>

#include "commission_space.h"
#include "plan/plan_build.h"
#include "supervisor_bench.h"

static struct commission c;
static struct config *cf;
static const char *what, *wanted;

#define NEAR(wanted, value) TEST_ASSERT_DOUBLE_WITHIN(2e-6, wanted, (double)(value))

/* T1 and T10 tested, by reflux at half and heat at half; ticks of 2 s. */
void setUp(void)
{
    bench_start();
    bench.plan[bench.current].tick_s = 2;
    cf = &bench.plan[bench.current].config;
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        cf->measurement[i].start_up.test = cf->mv[i].start_up.test = i < 2;
        cf->measurement[i].start_up.critical = 0;
        cf->measurement[i].start_up.limit = 0;
    }
    bench.s.time_ms = 1000000;
    commission_init(&c, &bench.events, commission_fresh_region());
    commission_lease(&c);
    c.outputs.plan_serial = bench.s.plan->serial;
    c.outputs.safe_count = bench.s.safe_count;
    c.outputs.n = c.inputs.n = 2;
    c.outputs.measurement[1] = c.inputs.input[1].output = 1;
    c.inputs.input[0].test_base = c.inputs.input[1].test_base = REAL_C(0.5);
    what = wanted = NULL;
}
void tearDown(void) {}

/* ---- how far ---- */

static void the_room_is_the_way_to_the_nearer_operating_limit(void)
{
    struct mv_config *o = &cf->mv[0];
    o->lo = -10;
    o->hi = 30;
    o->min = -2; /* 0.2 */
    o->max = 26; /* 0.9 */
    NEAR(0.1, commission_room(&bench.s, 0, REAL_C(0.3)));
    NEAR(0.3, commission_room(&bench.s, 0, REAL_C(0.5)));
    NEAR(0.15, commission_room(&bench.s, 0, REAL_C(0.75)));
    NEAR(-0.05, commission_room(&bench.s, 0, REAL_C(0.95)));
    bench.s.mv[0].manual = N(0.375);
    NEAR(0.375, commission_test_base(&bench.s, 0));
}

static void a_limit_is_a_fifth_of_the_span_or_what_is_set_and_half_where_it_is_critical(void)
{
    struct measurement_config m = {.lo = 60, .hi = 160};
    NEAR(0.2, commission_limit(&m));
    m.start_up.limit = 0.5f;
    NEAR(0.005, commission_limit(&m));
    m.start_up.critical = 1;
    NEAR(0.0025, commission_limit(&m));
    m.start_up.limit = 0;
    NEAR(0.1, commission_limit(&m));
}

static void names_and_spans_of_all_channels_are_what_results_belong_to(void)
{
    struct config other = *cf;
    uint32_t sum = commission_channels(cf);
    TEST_ASSERT_EQUAL_UINT32(sum, commission_channels(&other));
    other.mv[CHANNEL_MAX - 1].hi += 1;
    TEST_ASSERT_NOT_EQUAL(sum, commission_channels(&other));
    other = *cf;
    other.measurement[0].lo += 1;
    TEST_ASSERT_NOT_EQUAL(sum, commission_channels(&other));
    other = *cf;
    other.measurement[1].name[0] = 'X';
    TEST_ASSERT_NOT_EQUAL(sum, commission_channels(&other));
    other = *cf;
    other.mv[0].name[0] = 'X';
    TEST_ASSERT_NOT_EQUAL(sum, commission_channels(&other));
}

/* ---- at the end of a span ---- */

static void a_measurement_at_the_end_of_its_span_for_two_samples_is_told(void)
{
    static const struct {
        double raw;
        bool end;
    } cases[] = {{60.0, true},     {60.024, true},  {60.026, false}, {50.0, true},
                 {159.974, false}, {159.976, true}, {170.0, true}};
    for (unsigned j = 0; j < 2; j++)
        for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
            setUp();
            bench.s.measurement[j].raw = (float)cases[n].raw;
            outputs_watch_spans(&c.outputs, &bench.s);
            TEST_ASSERT_EQUAL_INT(-1, outputs_at_end(&c.outputs));
            outputs_watch_spans(&c.outputs, &bench.s);
            TEST_ASSERT_EQUAL_INT(cases[n].end ? (int)j : -1, outputs_at_end(&c.outputs));
            bench.s.measurement[j].raw = 100;
            outputs_watch_spans(&c.outputs, &bench.s);
            TEST_ASSERT_EQUAL_INT(-1, outputs_at_end(&c.outputs));
            bench.s.measurement[j].raw = (float)cases[n].raw;
            outputs_watch_spans(&c.outputs, &bench.s);
            TEST_ASSERT_EQUAL_INT(-1, outputs_at_end(&c.outputs));
            bench.s.measurement[j].seen = false;
            outputs_watch_spans(&c.outputs, &bench.s);
            TEST_ASSERT_EQUAL_INT(-1, outputs_at_end(&c.outputs));
        }
    for (int side = -1; side <= 1;
         side += 2) { /* there, or beyond: a 4000th of the span, on both at once */
        setUp();
        float margin = 2.5e-4f * 100.0f;
        bench.s.measurement[0].raw = bench.s.measurement[1].raw =
            side < 0 ? 60.0f + margin : 160.0f - margin;
        outputs_watch_spans(&c.outputs, &bench.s);
        outputs_watch_spans(&c.outputs, &bench.s);
        TEST_ASSERT_EQUAL_HEX32(3, c.outputs.ends_again);
    }
    setUp();
    c.outputs.measurement[2] = T5; /* of no test */
    bench.s.measurement[T5].raw = 60;
    outputs_watch_spans(&c.outputs, &bench.s);
    outputs_watch_spans(&c.outputs, &bench.s);
    TEST_ASSERT_EQUAL_HEX32(0, c.outputs.ends);
    TEST_ASSERT_EQUAL_INT(-1, outputs_at_end(&c.outputs));
    c.outputs.ends_again = 4;
    TEST_ASSERT_EQUAL_INT(-1, outputs_at_end(&c.outputs));
}

/* ---- before the tests ---- */

static void begins(bool may, const char *name, const char *text)
{
    what = "of before";
    TEST_ASSERT_EQUAL_INT(may ? ERR_OK : ERR_STATE, commission_may_begin(&bench.s, &what, &wanted));
    if (may)
        return;
    if (name)
        TEST_ASSERT_EQUAL_STRING(name, what);
    else
        TEST_ASSERT_NULL(what);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(wanted, text), wanted);
}

static void tests_begin_where_all_is_in_hand(void)
{
    begins(true, NULL, NULL);
    bench.s.measurement[T10].quality = QUALITY_UNCERTAIN;
    begins(false, "T10", "not valid");
    bench.s.measurement[T10].quality = QUALITY_GOOD;
    bench.s.measurement[T10].seen = false;
    begins(false, "T10", "not valid");
    bench.s.measurement[T10].seen = true;
    bench.s.measurement[T10].raw = 160;
    begins(false, "T10", "end of its span");
    bench.s.measurement[T10].raw = 100;
    bench.s.loop[BOTTOM].mode = LOOP_AUTO;
    begins(false, "bottom", "not in manual");
    bench.s.loop[BOTTOM].mode = LOOP_MANUAL;
    bench.s.mv[HEAT].interlocked = true;
    begins(false, "heat", "interlock");
    bench.s.mv[HEAT].interlocked = false;
    bench.s.mv[HEAT].manual = N(0.0049);
    begins(false, "heat", "no room");
    bench.s.mv[HEAT].manual = N(0.005); /* at least so much; not every format has the number */
    bool exact = num_to_float(N(0.005)) == 0.005f;
    begins(exact, "heat", "no room");
    bench.s.mv[HEAT].manual = N(0.0051);
    begins(true, NULL, NULL);
    bench.s.mv[HEAT].manual = N(0.9951);
    begins(false, "heat", "no room");
    cf->mv[HEAT].start_up.test = 0; /* what is not tested does not matter */
    begins(true, NULL, NULL);
    cf->measurement[T10].start_up.test = 0;
    bench.s.measurement[T10].quality = QUALITY_BAD;
    begins(true, NULL, NULL);
    bench.s.mv[REFLUX].bound = false;
    begins(false, NULL, "no manipulated variable");
    bench.s.measurement[T1].bound = false;
    begins(false, NULL, "no measurement");
    bench.s.state = SUPERVISOR_SAFE;
    begins(false, NULL, "safe state");
}

static void channels_that_are_there_and_named_are_tested(void)
{
    for (unsigned n = 0; n < 4; n++) {
        setUp();
        if (n == 1)
            cf->mv[1].name[0] = cf->measurement[1].name[0] = '\0';
        else if (n == 2)
            cf->mv[1].start_up.test = cf->measurement[1].start_up.test = 0;
        else if (n == 3)
            bench.s.mv[1].bound = bench.s.measurement[1].bound = false;
        TEST_ASSERT_EQUAL(n == 0, commission_input_is_tested(&bench.s, 1));
        TEST_ASSERT_EQUAL(n == 0, commission_measurement_is_tested(&bench.s, 1));
    }
}

static void relays(uint8_t loop, const char *name, const char *text)
{
    TEST_ASSERT_EQUAL_INT(ERR_STATE, commission_may_relay(&bench.s, loop, &what, &wanted));
    if (name)
        TEST_ASSERT_EQUAL_STRING(name, what);
    else
        TEST_ASSERT_NULL(what);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(wanted, text), wanted);
}

static void a_relay_test_begins_where_its_loop_is_in_hand(void)
{
    bench.s.loop[BOTTOM].mode = LOOP_AUTO; /* of the other loop no matter */
    TEST_ASSERT_EQUAL_INT(ERR_OK, commission_may_relay(&bench.s, TOP, &what, &wanted));
    relays(BOTTOM, "bottom", "not in manual");
    bench.s.mv[REFLUX].manual = N(0.0049);
    relays(TOP, "reflux", "no room");
    bench.s.mv[REFLUX].manual = N(0.0051);
    TEST_ASSERT_EQUAL_INT(ERR_OK, commission_may_relay(&bench.s, TOP, &what, &wanted));
    bench.s.measurement[T1].quality = QUALITY_UNCERTAIN;
    relays(TOP, "T1", "not valid");
    bench.s.mv[REFLUX].interlocked = true;
    relays(TOP, "reflux", "interlock");
    bench.s.mv[REFLUX].bound = false;
    relays(TOP, "reflux", "missing");
    bench.s.loop[TOP].mode = LOOP_CASCADE;
    relays(TOP, "top", "not in manual");
    cf->loop[TOP].own.algorithm = LOOP_TWO_POSITION;
    cf->loop[TOP].own.band = 1;
    struct config_fault fault;
    TEST_ASSERT_EQUAL_INT(ERR_OK, plan_set_tick(&bench.plan[bench.current], 2, &fault));
    relays(TOP, "top", "two positions");
    bench.plan[bench.current].loop[TOP].mv = PLAN_NONE;
    relays(TOP, "top", "drives a loop");
    bench.s.state = SUPERVISOR_SAFE;
    relays(TOP, NULL, "safe state");
}

/* ---- while they go on ---- */

static void disturbs(enum commission_reason reason, const char *name)
{
    TEST_ASSERT_EQUAL_INT(reason, commission_disturbance(&c, &bench.s, &what));
    if (name)
        TEST_ASSERT_EQUAL_STRING(name, what);
    else
        TEST_ASSERT_NULL(what);
}

static void a_measurement_that_is_held_for_longer_than_three_samples_and_a_half_is_lost(void)
{
    struct measurement_state *m = &bench.s.measurement[T10];
    disturbs(REASON_NOT, NULL);
    m->quality = QUALITY_UNCERTAIN;
    m->alarm = true;
    m->valid_ms = bench.s.time_ms - 7000;
    disturbs(REASON_NOT, NULL);
    m->valid_ms--;
    disturbs(REASON_LOST, "T10");
    m->alarm = false;
    disturbs(REASON_NOT, NULL);
    m->alarm = true;
    m->quality = QUALITY_GOOD; /* it is valid again */
    disturbs(REASON_NOT, NULL);
    m->valid_ms = bench.s.time_ms;
    m->quality = QUALITY_BAD;
    disturbs(REASON_LOST, "T10");
    m->quality = QUALITY_UNCERTAIN;
    disturbs(REASON_NOT, NULL);
    m->lost = true;
    disturbs(REASON_LOST, "T10");
    bench.s.measurement[T1] = *m;
    disturbs(REASON_LOST, "T1");
    c.outputs.n = 0; /* of no test */
    disturbs(REASON_NOT, NULL);
}

static void an_output_may_take_five_ticks_to_follow(void)
{
    struct mv_state *o = &bench.s.mv[HEAT];
    o->alarm = true;
    o->differs_ms = bench.s.time_ms - 10000;
    disturbs(REASON_NOT, NULL);
    o->differs_ms--;
    disturbs(REASON_ACTUATOR, "heat");
    o->alarm = false;
    disturbs(REASON_NOT, NULL);
}

static void whatever_else_happens_ends_a_test(void)
{
    bench.s.mv[HEAT].manual = N(0.50390625);
    disturbs(REASON_HAND, "heat");
    bench.s.mv[HEAT].manual = N(0.5);
    bench.s.loop[BOTTOM].mode = LOOP_AUTO;
    disturbs(REASON_HAND, "heat");
    bench.s.mv[HEAT].interlocked = true;
    disturbs(REASON_INTERLOCK, "heat");
    bench.s.mv[REFLUX].interlocked = true;
    disturbs(REASON_INTERLOCK, "reflux");
    c.outputs.ends_again = 1;
    disturbs(REASON_SPAN, "T1");
    bench.s.safe_count++;
    disturbs(REASON_SAFE, NULL);
    bench.s.safe_count--;
    bench.s.state = SUPERVISOR_SAFE;
    disturbs(REASON_SAFE, NULL);
    c.outputs.plan_serial++;
    disturbs(REASON_CONFIG, NULL);
}

/* ---- a trial ---- */

static void hinders(enum commission_reason reason, const char *name)
{
    TEST_ASSERT_EQUAL_INT(reason, blocking_reason(&c, &bench.s, &what));
    if (name)
        TEST_ASSERT_EQUAL_STRING(name, what);
    else
        TEST_ASSERT_NULL(what);
    TEST_ASSERT_EQUAL_INT(reason ? ERR_STATE : ERR_OK,
                          commission_may_try(&c, &bench.s, &what, &wanted));
    TEST_ASSERT_EQUAL_STRING(commission_reason_text(reason), wanted);
}

/* Two pairs, crosswise: T1 by heat, T10 by reflux; behind T10 an inner loop on T5. */
static void pairs(void)
{
    struct analysis *a = &c.work->analysis;
    c.outputs.n = 3;
    c.outputs.measurement[2] = T5;
    c.analysis_job.column[0] = 1;
    c.analysis_job.column[1] = 0;
    a->pairs.n = 2;
    a->pairs.output[1] = 1;
    a->pairs.input[1] = 1;
    a->layout.n_cascades = 1;
    a->layout.cascade[0].inner = 2;
    a->layout.cascade[0].outer = 1;
    a->layout.inner_outputs = 4;
}

static void what_stands_in_the_way_of_a_trial(void)
{
    pairs();
    hinders(REASON_NOT, NULL);
    struct mv_state *o = &bench.s.mv[HEAT];
    o->alarm = true;
    o->differs_ms = bench.s.time_ms - 10001;
    hinders(REASON_ACTUATOR, "heat");
    c.status.phase =
        COMMISSION_TRIAL; /* its loops move it all the time: it must be far off as well */
    o->constrained = N(0.5);
    o->readback = N(0.599);
    hinders(REASON_NOT, NULL);
    o->constrained = N(0.1); /* by more than that; not every format has the number */
    o->readback = N(0.0);
    hinders(num_to_float(N(0.1)) > 0.1f ? REASON_ACTUATOR : REASON_NOT,
            num_to_float(N(0.1)) > 0.1f ? "heat" : NULL);
    o->constrained = N(0.5);
    o->readback = N(0.601);
    hinders(REASON_ACTUATOR, "heat");
    o->readback = N(0.399);
    hinders(REASON_ACTUATOR, "heat");
    o->interlocked = true;
    hinders(REASON_INTERLOCK, "heat");
    *o = bench.s.mv[REFLUX];
    o = &bench.s.mv[REFLUX];
    o->interlocked = true;
    hinders(REASON_INTERLOCK, "reflux");
    bench.s.measurement[T5].lost = true;
    hinders(REASON_LOST, "T5");
    bench.s.measurement[T10].quality = QUALITY_UNCERTAIN; /* usable */
    hinders(REASON_LOST, "T5");
    bench.s.measurement[T10].quality = QUALITY_BAD;
    hinders(REASON_LOST, "T10");
    bench.s.measurement[T1].seen = false;
    hinders(REASON_LOST, "T1");
    bench.s.state = SUPERVISOR_SAFE;
    hinders(REASON_SAFE, NULL);
}

#if CONFIG_STEPS
static void no_test_and_no_trial_begins_while_a_sequence_runs(void)
{
    bench.s.sequence.state = SEQUENCE_RUNNING;
    TEST_ASSERT_TRUE(sequence_active(&bench.s.sequence));
    begins(false, NULL, "sequence");
    relays(TOP, NULL, "sequence");
    hinders(REASON_SEQUENCE, NULL);
}
#endif

#if CONFIG_BLOCKS
static void no_test_and_no_trial_begins_while_a_block_excites_the_plant(void)
{
    bench.plan[bench.current].block[BLOCK_NUMBERED + 1].kind = 0;
    bench.s.excitation.holder = 2;
    begins(false, block_kinds[0]->name, "excites the plant");
    relays(TOP, block_kinds[0]->name, "excites the plant");
    hinders(REASON_EXCITED, block_kinds[0]->name);
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_room_is_the_way_to_the_nearer_operating_limit);
    RUN_TEST(a_limit_is_a_fifth_of_the_span_or_what_is_set_and_half_where_it_is_critical);
    RUN_TEST(names_and_spans_of_all_channels_are_what_results_belong_to);
    RUN_TEST(a_measurement_at_the_end_of_its_span_for_two_samples_is_told);
    RUN_TEST(tests_begin_where_all_is_in_hand);
    RUN_TEST(channels_that_are_there_and_named_are_tested);
    RUN_TEST(a_relay_test_begins_where_its_loop_is_in_hand);
    RUN_TEST(a_measurement_that_is_held_for_longer_than_three_samples_and_a_half_is_lost);
    RUN_TEST(an_output_may_take_five_ticks_to_follow);
    RUN_TEST(whatever_else_happens_ends_a_test);
    RUN_TEST(what_stands_in_the_way_of_a_trial);
#if CONFIG_STEPS
    RUN_TEST(no_test_and_no_trial_begins_while_a_sequence_runs);
#endif
#if CONFIG_BLOCKS
    RUN_TEST(no_test_and_no_trial_begins_while_a_block_excites_the_plant);
#endif
    return UNITY_END();
}
