/* Histories of applied inputs: what a block reads of what really took effect of an MV. The kinds are of this test alone; they
 * look, and move nothing by themselves. */
#include "block/block.h"
#include "exchange/block_settings.h"
#include "kinds/pid/pid.h"
#include "plan/plan_build.h"
#include "settings/block_pool.h"
#include "supervise/arena.h"
#include "supervise/histories.h"
#include "supervisor_bench.h"

/* ---- a kind that looks: a controller whose outputs are its settings, or an estimator that writes nothing ---- */

struct look_settings {
    float out;      /* of all its members */
    uint16_t steps; /* that it looks back */
    uint16_t spare;
};

struct look {
    num_t out;
    unsigned steps;
    uint16_t divisor;
    const struct applied_history *member[2], *input[2];
};

static const struct block_parameter look_parameters[] = {
    {.id = 1, .type = BLOCK_FLOAT, .name = "out", .unit = "-", .help = "output", .lo = 0, .hi = 2},
    {.id = 2,
     .type = BLOCK_U16,
     .offset = 4,
     .name = "steps",
     .unit = "-",
     .help = "looked back",
     .lo = 0,
     .hi = 65535,
     .initial = 5},
};

static uint32_t look_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct look);
}

static uint16_t look_history(const struct block_setup *setup)
{
    const struct look_settings *c = setup->settings;
    return c->steps;
}

static enum err look_check(const struct block_setup *setup, struct block_fault *fault)
{
    (void)setup;
    (void)fault;
    return ERR_OK;
}

static enum err look_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct look *m = state;
    const struct look_settings *c = setup->settings;
    if (!retune)
        *m = (struct look){0};
    m->out = num_from_float(c->out);
    return ERR_OK;
}

static void look_around(struct look *m, const struct block_io *io, uint8_t members, uint8_t inputs)
{
    m->steps++;
    m->divisor = io->members.divisor;
    for (uint8_t k = 0; k < members; k++)
        m->member[k] = io->members.applied[k];
    for (uint8_t k = 0; k < inputs; k++)
        m->input[k] = io->inputs.applied[k];
}

static void look_step(void *state, struct block_io *io)
{
    struct look *m = state;
    look_around(m, io, 2, 1);
    io->members.out[0] = io->members.out[1] = m->out;
}

static void watch_step(void *state, struct block_io *io)
{
    look_around(state, io, 0, 2);
}

static void look_nothing(void *state, struct block_io *io)
{
    (void)state;
    (void)io;
}

#define LOOKS(name_, stage_, members, step_)                                                       \
    {                                                                                              \
        .name = name_, .stage = stage_, .parameter = look_parameters, .parameters = 2,             \
        .settings_bytes = sizeof(struct look_settings), .members_most = members, .inputs_most = 2, \
        .bad_input = BAD_INPUT_IS_TOLD, .bytes = look_bytes, .history = look_history,              \
        .check = look_check, .configure = look_configure, .step = step_,                           \
        .back_calculate = look_nothing, .follow = look_nothing                                     \
    }

static const struct block_kind look_kind = LOOKS("look", STAGE_CONTROL, 2, look_step);
static const struct block_kind watch_kind = LOOKS("watch", STAGE_ESTIMATE, 0, watch_step);

const struct block_kind *const block_kinds[] = {&pid_kind, &look_kind, &watch_kind};
const uint8_t block_kind_count = 3;

enum { LOOK, WATCH };

static void put_block(unsigned n, const char *kind, const char *loops, const char *inputs,
                      uint16_t steps)
{
    struct block_config *b = &bench.config.block[n];
    uint32_t needed, room;
    TEST_ASSERT_EQUAL(ERR_OK, record_make(&bench.config, (uint8_t)n, kind, &needed, &room));
    strcpy(b->loops, loops);
    strcpy(b->inputs, inputs);
    const struct look_settings settings = {0.6f, steps, 0};
    memcpy(bench.config.pool + b->offset, &settings, sizeof settings);
}

static struct look *state_of(unsigned n)
{
    return supervisor_block(&bench.s, (uint8_t)(BLOCK_NUMBERED + n));
}

static double ago(const struct applied_history *h, uint32_t ticks_before)
{
    TEST_ASSERT_NOT_NULL(h);
    return D(applied_ticks_ago(h, ticks_before));
}

static void watched(void)
{
    put_block(WATCH, "watch", "", "reflux feed", 5);
}

void setUp(void) {}
void tearDown(void) {}

/* ---- what is in it ---- */

static void it_holds_what_was_sent_tick_by_tick_from_the_last_one_back(void)
{
    bench_start_with(watched);
    for (int k = 1; k <= 6; k++) {
        out(TOP, k);
        tick();
    }
    const struct applied_history *h = state_of(WATCH)->input[0];
    validate(); /* the estimator steps before this tick's outputs are known */
    for (uint32_t k = 1; k <= 5; k++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1 * (7 - k), ago(h, k));
}

static void beyond_its_depth_it_is_the_oldest_and_no_tick_ago_is_the_last_one(void)
{
    bench_start_with(watched);
    for (int k = 1; k <= 6; k++) {
        out(TOP, k);
        tick();
    }
    const struct applied_history *h = history_of(&bench.s, REFLUX);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, ago(h, 6));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, ago(h, UINT32_MAX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, ago(h, 0));
}

static void a_measurement_has_none_and_neither_has_an_mv_that_nobody_asked_for(void)
{
    bench_start_with(watched);
    TEST_ASSERT_NULL(state_of(WATCH)->input[1]);
    TEST_ASSERT_NOT_NULL(history_of(&bench.s, REFLUX));
    TEST_ASSERT_NULL(history_of(&bench.s, HEAT));
    TEST_ASSERT_NULL(history_of(&bench.s, SPARE));
}

static void it_begins_full_of_what_is_applied_then(void)
{
    bench_start();
    watched();
    apply();
    for (uint32_t k = 1; k <= 5; k++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, ago(history_of(&bench.s, REFLUX), k));
    validate();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, ago(state_of(WATCH)->input[0], 5));
}

static void limits_and_interlocks_are_in_it_and_not_what_was_wanted(void)
{
    bench_start_with(watched);
    put("lock1.meas", "feed");
    put("lock1.mv", "reflux");
    put("lock1.limit", "8");
    put("lock1.value", "9");
    set_and_apply("mv1.max", "7");
    out(TOP, 8);
    tick();
    reading(FEED, 9);
    tick();
    const struct applied_history *h = history_of(&bench.s, REFLUX);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.9, ago(h, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, ago(h, 2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, ago(h, 3));
}

static void a_valve_that_does_not_follow_is_in_it_with_its_read_back(void)
{
    bench_start_with(watched);
    bench.input.readback[REFLUX] = (struct reading){3.0f, QUALITY_GOOD};
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.3, ago(history_of(&bench.s, REFLUX), 1));
}

static void a_test_signal_is_in_it(void)
{
    bench_start_with(watched);
    supervisor_excite(&bench.s, REFLUX, num_from_float(0.1f));
    tick();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, ago(history_of(&bench.s, REFLUX), 1));
}

/* ---- who reads it ---- */

static void members(void)
{
    put_block(LOOK, "look", "top bottom", "spare", 4);
    put_block(WATCH, "watch", "", "reflux feed", 9);
}

static void a_controller_reads_those_of_its_members_whoever_moves_them(void)
{
    bench_start_with(members);
    mode(TOP, LOOP_AUTO);
    out(BOTTOM, 0.8);
    ticks(3);
    const struct look *m = state_of(LOOK);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, ago(m->member[0], 1)); /* its own output */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, ago(m->member[0], 4));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, ago(m->member[1], 1)); /* a hand's: 0.8 of 2 */
    TEST_ASSERT_NOT_NULL(m->input[0]);
}

static void the_deepest_asked_for_serves_all_of_them(void)
{
    bench_start_with(members);
    mode(TOP, LOOP_AUTO);
    tick();
    TEST_ASSERT_EQUAL_PTR(state_of(WATCH)->input[0], state_of(LOOK)->member[0]);
    TEST_ASSERT_EQUAL_UINT16(9, history_of(&bench.s, REFLUX)->depth);
    TEST_ASSERT_EQUAL_UINT16(4, history_of(&bench.s, HEAT)->depth);
}

static void cascaded(void)
{
    bench_cascade();
    put_block(LOOK, "look", "outer", "", 4);
}

static void a_member_that_drives_a_loop_has_none(void)
{
    bench_start_with(cascaded);
    mode(BOTTOM, LOOP_CASCADE);
    mode(OUTER, LOOP_AUTO);
    ticks(2);
    TEST_ASSERT_TRUE(state_of(LOOK)->steps > 0);
    TEST_ASSERT_NULL(state_of(LOOK)->member[0]);
    for (uint8_t j = 0; j < CHANNEL_MAX; j++)
        TEST_ASSERT_NULL(history_of(&bench.s, j));
}

static void slow(void)
{
    put_all((const char *const[]){"loop1.divisor", "4", "loop2.divisor", "4", "mv2.rate", "0.02",
                                  NULL}); /* 0.01 of span in a tick */
    put_block(LOOK, "look", "top bottom", "", 3);
}

static void a_block_with_a_divisor_looks_back_in_its_own_steps(void)
{
    bench_start_with(slow);
    mode(TOP, LOOP_AUTO);
    out(BOTTOM, 1.8);
    ticks(20);
    const struct look *m = state_of(LOOK);
    const struct applied_history *h = m->member[1];
    TEST_ASSERT_EQUAL_UINT16(4, m->divisor);
    TEST_ASSERT_EQUAL_UINT16(9, h->depth);
    /* A ramp: four ticks lie between what two steps saw last. */
    double last = ago(h, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, last, D(applied_steps_ago(h, 1, m->divisor)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, last - 0.04, D(applied_steps_ago(h, 2, m->divisor)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, last - 0.08, D(applied_steps_ago(h, 3, m->divisor)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, last, D(applied_steps_ago(h, 0, m->divisor)));
}

/* ---- plans and gaps ---- */

static void ramp_up(void)
{
    for (int k = 1; k <= 9; k++) {
        out(TOP, k);
        tick();
    }
}

static void a_plan_that_has_nothing_to_do_with_it_keeps_it_wherever_it_stands_then(void)
{
    bench_start_with(members);
    ramp_up();
    const struct applied_history *before = history_of(&bench.s, REFLUX);
    put("meas9.name", "more");
    put("mv1.max", "9.5");
    put("loop1.gain", "3");
    set_and_apply("alarm2.on", "T1");
    const struct applied_history *h = history_of(&bench.s, REFLUX);
    TEST_ASSERT_TRUE(h != before); /* or this test shows nothing */
    for (uint32_t k = 1; k <= 9; k++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1 * (10 - k), ago(h, k));
    TEST_ASSERT_EQUAL_UINT16(4, history_of(&bench.s, HEAT)->depth);
    put("meas9.name", "-");
    set_and_apply("alarm2.on", "-"); /* and back down */
    for (uint32_t k = 1; k <= 9; k++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1 * (10 - k), ago(history_of(&bench.s, REFLUX), k));
}

static void begun_anew(uint16_t depth)
{
    const struct applied_history *h = history_of(&bench.s, REFLUX);
    TEST_ASSERT_EQUAL_UINT16(depth, h->depth);
    for (uint32_t k = 1; k <= depth; k++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, D(bench.s.mv[REFLUX].applied), ago(h, k));
}

static void looks_back(uint16_t depth)
{
    put_block(WATCH, "watch", "", "reflux feed", depth);
    apply();
    TEST_ASSERT_EQUAL_UINT16(depth, history_of(&bench.s, REFLUX)->depth);
}

/* It was 0.9, 0.8 and so on, and before that as the last of them. */
static void goes_on(uint32_t known, uint32_t depth)
{
    for (uint32_t k = 1; k <= depth; k++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1 * (10 - (k < known ? k : known)),
                                  ago(history_of(&bench.s, REFLUX), k));
}

static void another_depth_goes_on_with_what_there_is(void)
{
    for (unsigned turned = 0; turned < 9; turned++) { /* wherever the newest stands in the ring */
        bench_start_with(members);
        ticks(turned);
        ramp_up();
        looks_back(12);
        goes_on(9, 12);
        looks_back(5);
        goes_on(5, 5);
        looks_back(7);
        goes_on(5, 7);
        out(TOP, 2);
        tick();
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, ago(history_of(&bench.s, REFLUX), 1));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.9, ago(history_of(&bench.s, REFLUX), 2));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5, ago(history_of(&bench.s, REFLUX), 7));
    }
}

static void asked_for_later_it_begins_full_too(void)
{
    bench_start_with(NULL);
    ramp_up();
    looks_back(9);
    begun_anew(9);
}

static void another_span_of_the_mv_begins_anew(void)
{
    bench_start_with(members);
    ramp_up();
    set_and_apply("mv1.hi", "20");
    begun_anew(9);
}

static void another_mv_in_its_place_begins_anew(void)
{
    bench_start_with(members);
    ramp_up();
    put("mv1.name", "other");
    put("loop1.out", "other");
    strcpy(bench.config.block[WATCH].inputs, "other feed");
    apply();
    begun_anew(9);
}

static void another_base_tick_begins_anew(void)
{
    bench_start_with(members);
    ramp_up();
    bench.tick_ms = 2000;
    apply();
    begun_anew(9);
}

static void silence_of_the_link_begins_anew_at_the_safe_value(void)
{
    bench_start_with(members);
    ramp_up();
    supervisor_go_safe(&bench.s, "link");
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, D(bench.s.mv[REFLUX].applied));
    for (uint32_t k = 1; k <= 5; k++) /* that of every MV */
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, ago(history_of(&bench.s, HEAT), k));
    begun_anew(9);
}

static void one_that_nobody_asks_for_any_more_is_gone(void)
{
    bench_start_with(members);
    ramp_up();
    put_block(WATCH, "watch", "", "reflux feed", 0);
    put_block(LOOK, "look", "top bottom", "spare", 0);
    apply();
    TEST_ASSERT_NULL(history_of(&bench.s, REFLUX));
    ticks(3);
    TEST_ASSERT_NULL(state_of(WATCH)->input[0]);
}

static uint32_t refused(void)
{
    struct config_fault fault;
    struct plan *next = &bench.plan[1 - bench.current];
    TEST_ASSERT_EQUAL(ERR_MEMORY, plan_build(next, &bench.config, 1.0f, &fault));
    TEST_ASSERT_EQUAL_STRING("block", fault.group);
    TEST_ASSERT_EQUAL_STRING("kind", fault.field);
    TEST_ASSERT_EQUAL_STRING("finds no memory for its history of applied inputs", fault.wanted);
    return fault.bytes;
}

static void more_than_there_is_memory_for_is_refused_with_the_bytes_it_needs(void)
{
    bench_start_with(members);
    uint16_t most = 0;
    struct config_fault fault;
    for (uint16_t steps = 4096; steps; steps /= 2) {
        put_block(WATCH, "watch", "", "reflux feed", (uint16_t)(most + steps));
        if (plan_build(&bench.plan[1 - bench.current], &bench.config, 1.0f, &fault) == ERR_OK)
            most = (uint16_t)(most + steps);
    }
    put_block(WATCH, "watch", "", "reflux feed", most);
    apply();
    TEST_ASSERT_EQUAL_UINT16(most, history_of(&bench.s, REFLUX)->depth);
    ticks(most + 2u);
    put_block(WATCH, "watch", "", "reflux feed", (uint16_t)(most + 2u));
    uint32_t bytes = refused();
    TEST_ASSERT_TRUE(bytes > PLAN_ARENA_BYTES && bytes <= PLAN_ARENA_BYTES + 2 * ARENA_GRAIN);
}

static void the_longest_divisor_and_the_most_steps_are_refused_too(void)
{
    bench_start_with(members);
    put_all((const char *const[]){"loop1.divisor", "10000", "loop2.divisor", "10000", NULL});
    put_block(LOOK, "look", "top bottom", "", 65535);
    TEST_ASSERT_TRUE(refused() > 65534u * 10000u * sizeof(num_t));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_holds_what_was_sent_tick_by_tick_from_the_last_one_back);
    RUN_TEST(beyond_its_depth_it_is_the_oldest_and_no_tick_ago_is_the_last_one);
    RUN_TEST(a_measurement_has_none_and_neither_has_an_mv_that_nobody_asked_for);
    RUN_TEST(it_begins_full_of_what_is_applied_then);
    RUN_TEST(limits_and_interlocks_are_in_it_and_not_what_was_wanted);
    RUN_TEST(a_valve_that_does_not_follow_is_in_it_with_its_read_back);
    RUN_TEST(a_test_signal_is_in_it);
    RUN_TEST(a_controller_reads_those_of_its_members_whoever_moves_them);
    RUN_TEST(the_deepest_asked_for_serves_all_of_them);
    RUN_TEST(a_member_that_drives_a_loop_has_none);
    RUN_TEST(a_block_with_a_divisor_looks_back_in_its_own_steps);
    RUN_TEST(a_plan_that_has_nothing_to_do_with_it_keeps_it_wherever_it_stands_then);
    RUN_TEST(another_depth_goes_on_with_what_there_is);
    RUN_TEST(asked_for_later_it_begins_full_too);
    RUN_TEST(another_span_of_the_mv_begins_anew);
    RUN_TEST(another_mv_in_its_place_begins_anew);
    RUN_TEST(another_base_tick_begins_anew);
    RUN_TEST(silence_of_the_link_begins_anew_at_the_safe_value);
    RUN_TEST(one_that_nobody_asks_for_any_more_is_gone);
    RUN_TEST(more_than_there_is_memory_for_is_refused_with_the_bytes_it_needs);
    RUN_TEST(the_longest_divisor_and_the_most_steps_are_refused_too);
    return UNITY_END();
}
