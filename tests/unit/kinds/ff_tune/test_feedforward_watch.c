/* Test and watch of the kind `ff_tune`, on errors that are given: what is enough to adopt a candidate, and to switch an element off. */
#include <stdalign.h>
#include <string.h>

#include "kinds/ff_tune/feedforward_tune.h"
#include "kinds/ff_tune/tune_disturbance.h"
#include "kinds/ff_tune/tune_events.h"
#include "kinds/ff_tune/tune_learner.h"
#include "kinds/ff_tune/tune_proposals.h"
#include "kinds/ff_tune/tune_search.h"
#include "kinds/ff_tune/tune_state.h"
#include "kinds/ff_tune/tune_watch.h"
#include "unity.h"

static alignas(8) char memory[sizeof(struct tune)];
static struct tune *const t = (struct tune *)(void *)memory;

/* Samples. */
#define PART 10u

static void begin_test(void)
{
    tune_candidate_begin(&t->shadows, &t->context, tune_sample(&t->samples, SIGNAL_D));
    tune_test_begin(&t->test, &t->context);
}

static enum tune_verdict test_step(void)
{
    return tune_test_step(&t->test, &t->context, &t->shadows, tune_sample(&t->samples, SIGNAL_D),
                          t->learner.move_square, t->stages.samples);
}

static enum tune_verdict watch_step(struct tune *block)
{
    return tune_watch_step(&block->watch, &block->context, &block->shadows, &block->test,
                           tune_sample(&block->samples, SIGNAL_D), block->disturbance.still > 0);
}

static float does(struct tune *block)
{
    const struct tune_parts parts = tune_parts_of(block);
    return tune_does(&parts);
}

static bool waits(struct tune *block)
{
    const struct tune_parts parts = tune_parts_of(block);
    return tune_waits_for_disturbance(&parts);
}

static float step_wanted(struct tune *block)
{
    const struct tune_parts parts = tune_parts_of(block);
    return tune_step_wanted(&parts);
}

static void look_at_disturbance(struct tune *block)
{
    tune_disturbance_look(&block->disturbance, &block->context,
                          tune_sample(&block->samples, SIGNAL_D));
}

static void learn_anew(struct tune *block)
{
    const struct tune_parts p = tune_parts_of(block);
    tune_learner_begin(p.learner, p.context, p.estimator, block->stages.stage == TUNE_LOOP);
}

static void learn(struct tune *block)
{
    const struct tune_parts p = tune_parts_of(block);
    tune_learner_step(p.learner, p.context, p.samples, p.estimator,
                      block->stages.stage == TUNE_LOOP, block->search.reading);
}

static void sample(struct tune *block)
{
    const struct tune_parts parts = tune_parts_of(block);
    tune_stages_sample(&parts);
}

/* A loop that forgets at once, samples of 1 s. */
void setUp(void)
{
    memset(memory, 0, sizeof memory);
    t->context.h_s = REAL_C(1.0);
    t->context.s.check_s = PART * TUNE_PARTS;
    t->context.s.better = 10;
    t->context.s.gain = 1;
    t->stages.acts = true;
    t->shadows.errors.count = true;
    t->shadows.candidate_warm = 1000;
    t->samples.passed[SIGNAL_D] = num_from_float(1);
    begin_test();
    t->shadows.candidate_warm = 1000;
}
void tearDown(void) {}

static enum tune_verdict part_of(double now, double without, double then)
{
    enum tune_verdict verdict = TUNE_NONE;
    t->shadows.errors.actual = (real_t)now;
    t->shadows.errors.no_feedforward = (real_t)without;
    t->shadows.errors.with_candidate = (real_t)then;
    for (unsigned k = 0; k < PART; k++) {
        t->stages.samples++;
        verdict = test_step();
    }
    return verdict;
}

/* In the others it is a little worse. */
static enum tune_verdict better_in(unsigned parts)
{
    enum tune_verdict verdict = TUNE_NONE;
    for (unsigned k = 0; k < TUNE_PARTS; k++) {
        TEST_ASSERT_EQUAL(TUNE_NONE, verdict);
        verdict = part_of(1, 1, k < parts ? 0.1 : 1.01);
    }
    return verdict;
}

/* ---- the test ---- */

static void better_in_six_parts_of_eight_is_enough(void)
{
    TEST_ASSERT_EQUAL(TUNE_ADOPTED, better_in(6));
}

static void better_in_five_parts_is_not_however_much_better(void)
{
    TEST_ASSERT_EQUAL(TUNE_NO_BETTER, better_in(5));
}

static void it_must_be_better_than_what_is_and_than_no_feedforward(void)
{
    for (unsigned k = 0; k < TUNE_PARTS; k++)
        (void)part_of(0.9, 2, 0.88);
    TEST_ASSERT_EQUAL(TUNE_PARTS, t->test.better_parts);
    TEST_ASSERT_EQUAL(TUNE_NO_BETTER, test_step()); /* than what is: by 4 % */
    setUp();
    for (unsigned k = 0; k < TUNE_PARTS; k++)
        (void)part_of(2, 0.9, 0.88);
    TEST_ASSERT_EQUAL(TUNE_NO_BETTER, test_step()); /* than without */
}

static void what_the_model_is_off_by_is_left_over(void)
{
    t->shadows.model.misfit = REAL_C(0.3);
    TEST_ASSERT_EQUAL(TUNE_ADOPTED, better_in(8));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1 - 0.01 - 0.09, (double)t->test.promised);
}

static void parts_in_which_the_disturbance_rests_do_not_count(void)
{
    t->learner.move_square = REAL_C(1.0);
    t->samples.passed[SIGNAL_D] = num_from_float(0.1f);
    TEST_ASSERT_EQUAL(TUNE_NONE, better_in(8));
    TEST_ASSERT_EQUAL(0, t->test.parts);
}

static void samples_that_do_not_count_make_it_untested_in_the_end(void)
{
    t->shadows.errors.count = false;
    for (unsigned k = 0; k < 4u * TUNE_PARTS; k++)
        TEST_ASSERT_EQUAL(TUNE_NONE, part_of(1, 1, 0));
    TEST_ASSERT_EQUAL(TUNE_UNTESTED, part_of(1, 1, 0));
}

static void a_shadow_that_is_lost_has_no_model(void)
{
    t->shadows.with_candidate.lost = true;
    TEST_ASSERT_EQUAL(TUNE_NO_MODEL, part_of(1, 1, 0));
    t->shadows.with_candidate.lost = false;
    t->shadows.no_feedforward.lost = true;
    TEST_ASSERT_EQUAL(TUNE_NO_MODEL, part_of(1, 1, 0));
}

/* ---- the watch ---- */

static unsigned samples_until_worse(double now, double without, unsigned most)
{
    t->shadows.errors.actual = (real_t)now;
    t->shadows.errors.no_feedforward = (real_t)without;
    for (unsigned k = 1; k <= most; k++)
        if (watch_step(t) == TUNE_WORSE)
            return k;
    return 0;
}

/* The memory is a quarter of check, 20 samples; half of it has to be full: 0.95^n below a half after 14. */
static void worse_by_a_tenth_of_the_squares_is_worse(void)
{
    TEST_ASSERT_EQUAL(0, samples_until_worse(1.04, 1, 1000)); /* squares: 8 % */
    tune_watch_begin(&t->watch);
    TEST_ASSERT_EQUAL(14, samples_until_worse(1.06, 1, 1000)); /* 12 % */
}

static void it_has_to_be_worse_for_as_long_as_the_loop_takes_to_forget(void)
{
    t->shadows.model.element.time_constant_s = REAL_C(6.0); /* 30 samples */
    TEST_ASSERT_EQUAL(14 + 30, samples_until_worse(2, 1, 1000));
}

/* An element acts that has made the loop worse for long enough; the next sample finds it. */
static void made_it_worse(void)
{
    setUp();
    t->context.s.protect = 1;
    t->context.s.learn_s = 1000;
    t->stages.stage = TUNE_RUNS;
    t->stages.has_model = true;
    t->shadows.warm = t->samples.setpoint_rests = 1000;
    t->samples.good = true;
    t->watch.actual = 2;
    t->watch.no_feedforward = 1;
    t->watch.weight = 1000;
    t->watch.worse_for = 1000;
}

static void what_waits_to_be_switched_off_is_not_found_worse_again(void)
{
    made_it_worse();
    t->proposals.off_waits = true;
    sample(t);
    TEST_ASSERT_EQUAL(TUNE_RUNS, t->stages.stage);
    TEST_ASSERT_FALSE(t->proposals.silencing);
    made_it_worse();
    sample(t);
    TEST_ASSERT_EQUAL(TUNE_IDLE, t->stages.stage);
    TEST_ASSERT_TRUE(t->proposals.silencing);
    TEST_ASSERT_EQUAL(TUNE_WORSE, t->stages.verdict);
}

static void less_than_half_of_what_was_promised_is_counted_until_it_is_more(void)
{
    t->test.promised = REAL_C(0.8);
    (void)samples_until_worse(0.8, 1, 100); /* 36 % */
    TEST_ASSERT_EQUAL(100 - 13, t->watch.since_change);
    t->watch.changes = 2;
    (void)samples_until_worse(0.7, 1, 100); /* 51 % */
    TEST_ASSERT_EQUAL(0, t->watch.since_change);
    TEST_ASSERT_EQUAL(0, t->watch.changes);
}

static void while_the_disturbance_rests_or_does_little_nothing_is_missed(void)
{
    t->test.promised = REAL_C(0.8);
    t->disturbance.still = 1;
    (void)samples_until_worse(0.8, 1, 100);
    TEST_ASSERT_EQUAL(0, t->watch.since_change);
    t->disturbance.still = 0;
    t->test.square = REAL_C(4.1); /* a quarter of which there is not */
    (void)samples_until_worse(0.8, 1, 100);
    TEST_ASSERT_EQUAL(0, t->watch.since_change);
    t->test.square = REAL_C(3.9);
    (void)samples_until_worse(0.8, 1, 100);
    TEST_ASSERT_EQUAL(100, t->watch.since_change);
}

/* The shadow finds 75 % taken off, but with a disturbance of 1 the loop was no worse under feedback alone. */
static void what_is_no_better_than_feedback_alone_was_does_too_little_whatever_the_shadow_says(void)
{
    t->test.promised = REAL_C(0.8);
    t->test.alone = REAL_C(0.26);
    (void)samples_until_worse(0.5, 1, 100);
    TEST_ASSERT_FALSE(t->watch.as_alone);
    TEST_ASSERT_EQUAL(0, t->watch.since_change);
    t->test.alone = REAL_C(0.24);
    (void)samples_until_worse(0.5, 1, 100);
    TEST_ASSERT_TRUE(t->watch.as_alone);
    TEST_ASSERT_EQUAL(100, t->watch.since_change);
}

static void what_it_does_is_told_from_a_tenth_of_the_memory_on_and_only_while_it_runs(void)
{
    TEST_ASSERT_FLOAT_WITHIN(0, 0, does(t));
    (void)samples_until_worse(0.5, 1, 50);
    TEST_ASSERT_FLOAT_WITHIN(0.01, 75, does(t));
    t->stages.acts = false;
    TEST_ASSERT_FLOAT_WITHIN(0, 0, does(t));
}

static void a_watch_that_is_lost_begins_again(void)
{
    (void)samples_until_worse(0.5, 1, 50);
    TEST_ASSERT_TRUE(does(t) > 0);
    t->context.s.learn_s = 1000;
    t->stages.has_model = true;
    t->shadows.no_feedforward.lost = true;
    sample(t);
    TEST_ASSERT_FALSE(t->shadows.no_feedforward.lost);
    TEST_ASSERT_FLOAT_WITHIN(0, 0, does(t));
}

/* This loop forgets at once: of the first sample nothing is left in the second. */
static void nothing_is_counted_until_the_loop_has_forgotten(void)
{
    t->shadows.candidate_warm = 0;
    (void)part_of(1, 1, 0.1);
    TEST_ASSERT_EQUAL(0, t->test.parts);
    t->shadows.candidate_warm = 1;
    (void)part_of(1, 1, 0.1);
    TEST_ASSERT_EQUAL(1, t->test.parts);
}

/* ---- proposals ---- */

static struct block_proposal room;
static bool rejected;

/* A step of the disturbance takes the element 6 s: twice that and four samples it has to rest. */
static void proposes(void)
{
    memset(&room, 0, sizeof room);
    rejected = false;
    t->context.ticks = 1;
    t->stages.stage = TUNE_PROPOSES;
    t->context.s.element = 2;
    t->context.s.lead_s = 3;
    t->context.s.lag_s = 2;
    t->context.s.dead_s = 1;
    t->context.s.adopt = TUNE_ADOPT_AT_ONCE;
    t->search.candidate.k = REAL_C(0.5);
}

static struct block_switch_off off;
/* proposal: NULL where somebody else's waits. */
static void propose_on(struct block_proposal *proposal)
{
    struct block_io io = {.requests.proposal = proposal, .requests.switch_off = &off};
    if (!tune_propose(&t->proposals, &t->context, &io, tune_stages_stage(&t->stages),
                      tune_candidate(&t->search), tune_since_disturbance(&t->samples)))
        rejected = true;
}

/* Calls until there is a proposal; most: there is none. */
static unsigned calls_until_proposed(unsigned most)
{
    unsigned calls = 0;
    while (calls < most && !room.n) {
        propose_on(&room);
        calls++;
    }
    return calls;
}

static void a_proposal_waits_until_the_disturbance_has_rested(void)
{
    proposes();
    t->samples.disturbance_rests = 16;
    propose_on(&room);
    TEST_ASSERT_EQUAL_UINT8(0, room.n);
    t->samples.disturbance_rests = 17;
    propose_on(NULL); /* somebody else's is there */
    propose_on(&room);
    TEST_ASSERT_EQUAL_UINT8(8, room.n);
    TEST_ASSERT_EQUAL_UINT8(PROPOSAL_AT_ONCE, room.manner);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, room.value[0].value);
    TEST_ASSERT_EQUAL_HEX32(proposed_setting(PROPOSED_FF_GAIN, 1), room.value[1].id);
}

static void a_disturbance_that_never_rests_is_waited_for_as_long_as_four_steps_of_it(void)
{
    proposes();
    unsigned calls = calls_until_proposed(1000);
    TEST_ASSERT_TRUE(calls > 4 * 20 && calls <= 4 * 20 + 2);
    TEST_ASSERT_EQUAL_UINT8(8, room.n);
}

static void one_that_makes_it_worse_is_switched_off_within_a_sixteenth_of_check(void)
{
    proposes();
    t->stages.stage = TUNE_RUNS;
    t->context.s.check_s = 320;
    t->context.s.adopt = TUNE_ADOPT_ASKED;
    t->proposals.silencing = true;
    unsigned calls = calls_until_proposed(1000);
    TEST_ASSERT_TRUE(calls > 20 && calls <= 22);
    TEST_ASSERT_EQUAL_UINT8(2, room.n);
    TEST_ASSERT_EQUAL_FLOAT(0, room.value[0].value);
    TEST_ASSERT_EQUAL_HEX32(proposed_setting(PROPOSED_FF_GAIN, 1), room.value[1].id);
    TEST_ASSERT_FALSE(t->proposals.silencing);
}

static void a_proposal_that_has_not_come_into_force_was_rejected(void)
{
    proposes();
    t->samples.disturbance_rests = 17;
    propose_on(&room);
    TEST_ASSERT_FALSE(rejected);
    propose_on(NULL);
    TEST_ASSERT_FALSE(rejected);
    propose_on(&room);
    TEST_ASSERT_TRUE(rejected);
}

/* ---- a block with its settings ---- */

static alignas(8) char whole_block[32768];

static struct tune *begin_block(struct block_setup *setup, struct tune_settings *s)
{
    struct tune *block = (struct tune *)(void *)whole_block;
    *s = (struct tune_settings){.learn_s = 1000,
                                .check_s = PART * TUNE_PARTS,
                                .gain = 1,
                                .forgetting = RLS_CONSTANT,
                                .forget = 1,
                                .forget_least = 0.5f,
                                .memory = 1,
                                .trace = 1e6f,
                                .p0 = 1000,
                                .order = {{1, 1, 0}, {1, 1, 0}},
                                .k = 0.5f,
                                .lead_s = 2,
                                .lag_s = 3,
                                .dead_s = 1};
    *setup = (struct block_setup){.settings = s, .interval_s = 1, .members = 1, .inputs = 2};
    for (unsigned k = 0; k < 2; k++)
        setup->input[k] = (struct block_signal){0, 1, false};
    TEST_ASSERT_TRUE(feedforward_tune_kind.bytes(setup) <= sizeof whole_block);
    TEST_ASSERT_EQUAL(ERR_OK, feedforward_tune_kind.configure(block, setup, false));
    return block;
}

static void with_any_other_number_of_the_element_what_it_does_is_counted_anew(void)
{
    static struct tune_settings s;
    struct block_setup setup;
    struct tune *block = begin_block(&setup, &s);
    float *const number[] = {&s.k, &s.lead_s, &s.lag_s, &s.dead_s};
    for (unsigned k = 0; k <= sizeof number / sizeof number[0]; k++) {
        for (unsigned n = 0; n < 50; n++) {
            block->shadows.errors.count = true;
            block->shadows.errors.actual = REAL_C(0.5);
            block->shadows.errors.no_feedforward = REAL_C(1.0);
            block->shadows.candidate_warm = 1000;
            (void)watch_step(block);
        }
        TEST_ASSERT_TRUE(does(block) > 70);
        if (k > 0)
            *number[k - 1] += 0.25f;
        TEST_ASSERT_EQUAL(ERR_OK, feedforward_tune_kind.configure(block, &setup, true));
        if (k > 0)
            TEST_ASSERT_EQUAL_FLOAT(0, does(block));
        else
            TEST_ASSERT_TRUE(does(block) > 70);
    }
}

/* An element acts that has done too little for half of `check`. */
static struct tune *one_that_does_too_little(struct tune_settings *s, float step)
{
    struct block_setup setup;
    struct tune *block = begin_block(&setup, s);
    block->context.s.step = step;
    block->context.s.protect = 1;
    block->stages.stage = TUNE_RUNS;
    block->stages.anew = false;
    block->stages.verdict = TUNE_ADOPTED;
    block->test.promised = REAL_C(0.8);
    block->watch.since_change = PART * TUNE_PARTS / 2 + 1;
    return block;
}

static void too_little_it_goes_off_before_a_test_signal_moves_the_setpoint(void)
{
    static struct tune_settings s;
    struct tune *block = one_that_does_too_little(&s, 0.1f);
    block->watch.since_change--;
    sample(block);
    TEST_ASSERT_EQUAL(TUNE_RUNS, block->stages.stage);
    block = one_that_does_too_little(&s, 0.1f);
    sample(block);
    TEST_ASSERT_TRUE(block->proposals.silencing && block->stages.again);
    TEST_ASSERT_EQUAL(TUNE_IDLE, block->stages.stage);
    TEST_ASSERT_EQUAL_HEX(1u << TUNE_EVENT_CHANGED, block->events.pending);
}

static void without_a_test_signal_or_leave_it_goes_on_while_it_is_identified_anew(void)
{
    static struct tune_settings s;
    for (unsigned leave = 0; leave < 2; leave++) {
        struct tune *block = one_that_does_too_little(&s, leave ? 0 : 0.1f);
        block->context.s.protect = (uint8_t)leave;
        sample(block);
        TEST_ASSERT_FALSE(block->proposals.silencing);
        TEST_ASSERT_EQUAL(TUNE_DISTURBANCE, block->stages.stage);
    }
}

static void after_three_times_in_a_row_it_is_off_or_left_at_what_it_does(void)
{
    static struct tune_settings s;
    for (unsigned use = 0; use < 3;
         use++) { /* nothing, a tenth, a tenth but no better than alone */
        struct tune *block = one_that_does_too_little(&s, 0.1f);
        block->watch.changes = 3;
        block->watch.as_alone = use == 2;
        block->watch.actual = REAL_C(0.88);
        block->watch.no_feedforward = use ? REAL_C(1.0) : REAL_C(0.9);
        block->watch.weight = REAL_C(100.0);
        sample(block);
        TEST_ASSERT_EQUAL(use != 1, block->proposals.silencing);
        TEST_ASSERT_FALSE(block->stages.again);
        TEST_ASSERT_EQUAL(use == 1 ? TUNE_ADOPTED : TUNE_NO_BETTER, block->stages.verdict);
        TEST_ASSERT_EQUAL(use == 1 ? TUNE_RUNS : TUNE_IDLE, block->stages.stage);
    }
}

static void a_step_that_was_too_small_is_told_with_one_that_is_not(void)
{
    static struct tune_settings s;
    struct block_setup setup;
    struct tune *block = begin_block(&setup, &s);
    static const struct {
        uint8_t verdict;
        float change, spread, wanted;
    } rows[] = {
        {TUNE_SLOW, 0.3f, 0, 1.5f},   {TUNE_SLOW, 0.11f, 0, 1}, {TUNE_SLOW, 9, 0, 5},
        {TUNE_UNSURE, 0, 1.5f, 1.5f}, {TUNE_UNSURE, 0, 0, 1},   {TUNE_NO_MODEL, 9, 9, 1},
        {TUNE_NO_BAND, 9, 9, 1},      {TUNE_STILL, 9, 9, 0},    {TUNE_ADOPTED, 9, 9, 0},
    };
    block->context.s.step = 0.5f;
    block->context.s.settled = 10;
    block->context.s.confident = 50;
    for (unsigned k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        block->stages.verdict = rows[k].verdict;
        block->responses.change = (real_t)rows[k].change;
        block->search.spread = (real_t)rows[k].spread;
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, rows[k].wanted, step_wanted(block));
    }
}

/* A square wave, and then nothing. */
static void a_disturbance_rests_when_a_tenth_of_its_squares_is_left(void)
{
    static struct tune_settings s;
    struct block_setup setup;
    struct tune *block = begin_block(&setup, &s);
    TEST_ASSERT_TRUE(waits(block));
    for (unsigned k = 0; k < 1000; k++) {
        block->samples.passed[SIGNAL_D] = num_from_float(k % 100 < 50 ? 0.1f : -0.1f);
        look_at_disturbance(block);
    }
    TEST_ASSERT_FALSE(waits(block));
    block->samples.passed[SIGNAL_D] = num_from_float(0);
    unsigned samples = 0;
    for (; samples < 1000 && !waits(block); samples++)
        look_at_disturbance(block);
    TEST_ASSERT_INT_WITHIN(15, 288, (int)samples); /* 125 ln 10, an eighth of learn being 125 */
    block->samples.passed[SIGNAL_D] = num_from_float(0.02f); /* a fifth: 4 % of the squares */
    for (unsigned k = 0; k < 1000; k++)
        look_at_disturbance(block);
    TEST_ASSERT_TRUE(waits(block));
}

static void only_a_loop_that_somebody_has_asked_for_is_moved_while_the_disturbance_rests(void)
{
    static struct tune_settings s;
    struct block_setup setup;
    struct tune *block = begin_block(&setup, &s);
    block->context.s.step = 0.1f;
    for (unsigned stage = TUNE_LOOP; stage <= TUNE_DISTURBANCE; stage++)
        for (unsigned asked = 0; asked < 2; asked++) {
            block->stages.stage = (uint8_t)stage;
            block->stages.unasked = !asked;
            TEST_ASSERT_EQUAL(!(stage == TUNE_LOOP && asked), waits(block));
        }
}

/* Rows: of MV or setpoint, of the disturbance. */
static void orders_are_those_of_their_rows(void)
{
    struct high_order_shape shape[2];
    struct tune_settings s = {.method = TUNE_SENSITIVITY, .order = {{2, 3, 1}, {4, 5, 6}}};
    tune_shapes(&s, shape);
    for (unsigned k = 0; k < 2; k++) {
        TEST_ASSERT_EQUAL(1, shape[k].inputs);
        TEST_ASSERT_EQUAL(s.order[k][0], shape[k].na);
        TEST_ASSERT_EQUAL(s.order[k][1], shape[k].nb[0]);
        TEST_ASSERT_EQUAL(s.order[k][2], shape[k].delay[0]);
    }
    s.method = TUNE_JOINT;
    tune_shapes(&s, shape);
    TEST_ASSERT_EQUAL(2, shape[1].inputs);
    TEST_ASSERT_EQUAL(2, shape[1].na); /* one for both: the first row's */
    for (unsigned j = 0; j < 2; j++) {
        TEST_ASSERT_EQUAL(s.order[j][1], shape[1].nb[j]);
        TEST_ASSERT_EQUAL(s.order[j][2], shape[1].delay[j]);
    }
}

static void the_model_is_not_reset_while_it_is_computed_with(void)
{
    static struct tune_settings s;
    struct block_setup setup;
    for (unsigned k = 0; k < 3; k++) {
        struct tune *block = begin_block(&setup, &s);
        const char *says = NULL;
        block->search.computing = k == 1;
        block->search.idle = k != 2;
        for (unsigned v = 0; v < feedforward_tune_kind.verbs; v++)
            if (strcmp(feedforward_tune_kind.verb[v].name, "reset") == 0)
                says = feedforward_tune_kind.verb[v].run(block, NULL);
        TEST_ASSERT_EQUAL_STRING(k ? "computes" : NULL, says);
    }
}

static void a_disturbance_that_moves_in_this_stage_does_not_stand_still(void)
{
    static struct tune_settings s;
    struct block_setup setup;
    struct tune *block = begin_block(&setup, &s);
    block->stages.stage = TUNE_DISTURBANCE;
    learn_anew(block);
    for (unsigned k = 0; k < 500; k++)
        learn(block);
    TEST_ASSERT_TRUE(tune_stands_still(block->learner.move_square));
    learn_anew(block);
    block->samples.passed[SIGNAL_D] = num_from_float(0.002f);
    for (unsigned k = 0; k < 10; k++)
        learn(block);
    TEST_ASSERT_FALSE(tune_stands_still(block->learner.move_square));
}

static void behind_the_stages_that_learn_it_learns_on_with_every_alone(void)
{
    static struct tune_settings s;
    struct block_setup setup;
    for (unsigned every = 0; every < 2; every++)
        for (unsigned stage = TUNE_DISTURBANCE; stage <= TUNE_RUNS; stage++) {
            struct tune *block = begin_block(&setup, &s);
            bool behind = stage >= TUNE_COMPUTES;
            block->context.s.every_s = every ? 1e6f : 0;
            block->stages.stage = (uint8_t)stage;
            block->samples.bad_rests = block->samples.setpoint_rests = 1000;
            block->stages.anew = block->search.idle = false;
            block->samples.passed[SIGNAL_D] = num_from_float(0.05f);
            learn_anew(block);
            tune_shadows_begin(&block->shadows, &block->context);
            tune_candidate_begin(&block->shadows, &block->context, 0);
            tune_test_begin(&block->test, &block->context);
            for (unsigned k = 0; k < 10; k++)
                sample(block);
            TEST_ASSERT_EQUAL(stage, block->stages.stage);
            TEST_ASSERT_EQUAL(!behind || every > 0,
                              high_order_samples(tune_parts_of(block).estimator) > 0);
        }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(better_in_six_parts_of_eight_is_enough);
    RUN_TEST(better_in_five_parts_is_not_however_much_better);
    RUN_TEST(it_must_be_better_than_what_is_and_than_no_feedforward);
    RUN_TEST(what_the_model_is_off_by_is_left_over);
    RUN_TEST(parts_in_which_the_disturbance_rests_do_not_count);
    RUN_TEST(samples_that_do_not_count_make_it_untested_in_the_end);
    RUN_TEST(a_shadow_that_is_lost_has_no_model);
    RUN_TEST(worse_by_a_tenth_of_the_squares_is_worse);
    RUN_TEST(it_has_to_be_worse_for_as_long_as_the_loop_takes_to_forget);
    RUN_TEST(what_waits_to_be_switched_off_is_not_found_worse_again);
    RUN_TEST(less_than_half_of_what_was_promised_is_counted_until_it_is_more);
    RUN_TEST(what_it_does_is_told_from_a_tenth_of_the_memory_on_and_only_while_it_runs);
    RUN_TEST(a_watch_that_is_lost_begins_again);
    RUN_TEST(nothing_is_counted_until_the_loop_has_forgotten);
    RUN_TEST(a_proposal_waits_until_the_disturbance_has_rested);
    RUN_TEST(a_disturbance_that_never_rests_is_waited_for_as_long_as_four_steps_of_it);
    RUN_TEST(one_that_makes_it_worse_is_switched_off_within_a_sixteenth_of_check);
    RUN_TEST(a_proposal_that_has_not_come_into_force_was_rejected);
    RUN_TEST(with_any_other_number_of_the_element_what_it_does_is_counted_anew);
    RUN_TEST(a_disturbance_that_moves_in_this_stage_does_not_stand_still);
    RUN_TEST(behind_the_stages_that_learn_it_learns_on_with_every_alone);
    RUN_TEST(while_the_disturbance_rests_or_does_little_nothing_is_missed);
    RUN_TEST(what_is_no_better_than_feedback_alone_was_does_too_little_whatever_the_shadow_says);
    RUN_TEST(too_little_it_goes_off_before_a_test_signal_moves_the_setpoint);
    RUN_TEST(without_a_test_signal_or_leave_it_goes_on_while_it_is_identified_anew);
    RUN_TEST(after_three_times_in_a_row_it_is_off_or_left_at_what_it_does);
    RUN_TEST(a_step_that_was_too_small_is_told_with_one_that_is_not);
    RUN_TEST(a_disturbance_rests_when_a_tenth_of_its_squares_is_left);
    RUN_TEST(only_a_loop_that_somebody_has_asked_for_is_moved_while_the_disturbance_rests);
    RUN_TEST(the_model_is_not_reset_while_it_is_computed_with);
    RUN_TEST(orders_are_those_of_their_rows);
    return UNITY_END();
}
