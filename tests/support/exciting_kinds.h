/* Kinds of blocks that excite: a controller of two loops that holds its outputs, and an estimator. What they ask for is what the
 * test says, so that each way in which a signal ends can be told from the others. Included in one file of a test. */
#ifndef REFLUX_TESTS_EXCITING_KINDS_H
#define REFLUX_TESTS_EXCITING_KINDS_H

#include "block/block.h"
#include "control/pid.h"
#include "supervise/records.h"
#include "supervisor_bench.h"

/* ---- a kind that excites: it holds its outputs, and asks for what stands in `wish` ---- */

static struct wish {
    struct block_excitation ask[BLOCK_EXCITES_MAX];
    bool gives_up;
    /* What it was told in its last step. */
    uint8_t state, reason;
    const char *holder;
    unsigned steps;
    double setpoint[2];
} wish[2]; /* of the controller, of the estimator */

enum { CONTROLLER, ESTIMATOR };

struct held {
    num_t u[2];
};

static uint32_t held_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct held);
}

static enum err held_check(const struct block_setup *setup, struct block_fault *fault)
{
    (void)setup;
    (void)fault;
    return ERR_OK;
}

static enum err held_configure(void *state, const struct block_setup *setup, bool retune)
{
    (void)setup;
    if (!retune)
        *(struct held *)state = (struct held){0};
    return ERR_OK;
}

static void ask(struct wish *w, struct block_io *io)
{
    w->steps++;
    w->state = io->excite_state;
    w->reason = io->excite_reason;
    w->holder = io->excite_holder;
    for (unsigned k = 0; k < BLOCK_EXCITES_MAX; k++) {
        TEST_ASSERT_EQUAL(EXCITE_NOTHING, io->excite[k].what);
        io->excite[k] = w->ask[k];
    }
}

static void held_step(void *state, struct block_io *io)
{
    struct held *h = state;
    struct wish *w = &wish[CONTROLLER];
    for (int k = 0; k < 2; k++) {
        io->out[k] = h->u[k];
        w->setpoint[k] = D(io->setpoint[k]);
    }
    if (w->gives_up)
        io->gives_up = "test";
    ask(w, io);
}

static void held_follow(void *state, struct block_io *io)
{
    struct held *h = state;
    for (int k = 0; k < 2; k++)
        h->u[k] = io->out[k];
}

static void held_back_calculate(void *state, struct block_io *io)
{
    (void)state;
    (void)io;
}

static void shake_step(void *state, struct block_io *io)
{
    (void)state;
    ask(&wish[ESTIMATOR], io);
}

static const struct block_parameter spare_parameter[] = {
    {.id = 1, .type = BLOCK_FLOAT, .name = "size", .unit = "-", .help = "unused", .hi = 1},
};

static const struct block_kind held_kind = {
    .name = "held",
    .stage = STAGE_CONTROL,
    .parameter = spare_parameter,
    .parameters = 1,
    .settings_bytes = 4,
    .members_most = 2,
    .inputs_most = 2,
    .bad_input = BAD_INPUT_GIVES_UP,
    .bytes = held_bytes,
    .check = held_check,
    .configure = held_configure,
    .step = held_step,
    .back_calculate = held_back_calculate,
    .follow = held_follow,
};

static const struct block_kind shake_kind = {
    .name = "shake",
    .stage = STAGE_ESTIMATE,
    .parameter = spare_parameter,
    .parameters = 1,
    .settings_bytes = 4,
    .inputs_most = 2,
    .bytes = held_bytes,
    .check = held_check,
    .configure = held_configure,
    .step = shake_step,
};

const struct block_kind *const block_kinds[] = {&pid_kind, &held_kind, &shake_kind};
const uint8_t block_kind_count = 3;

static inline void put_block(unsigned n, const char *kind, const char *loops, const char *inputs)
{
    struct block_config *b = &bench.config.block[n];
    uint32_t needed, room;
    TEST_ASSERT_EQUAL(ERR_OK, record_make(&bench.config, (uint8_t)n, kind, &needed, &room));
    strcpy(b->loops, loops);
    strcpy(b->inputs, inputs);
}

static inline void put_size(unsigned n, float size)
{
    memcpy(bench.config.pool + bench.config.block[n].at, &size, sizeof size);
}

static inline void blocks(void)
{
    put_block(CONTROLLER, "held", "top bottom", "spare feed");
    put_block(ESTIMATOR, "shake", "", "spare feed");
    put("meas3.hold", "2");
}

/* Both loops in auto; reflux and heat at half their spans. */
static inline void begin_with(void (*more)(void))
{
    memset(wish, 0, sizeof wish);
    bench_start_with(more);
    mode(TOP, LOOP_AUTO);
    mode(BOTTOM, LOOP_AUTO);
    ticks(2);
}

static inline void begin(void)
{
    begin_with(blocks);
}

static inline struct block_excitation on(enum excite_what what, uint8_t which, double value)
{
    return (struct block_excitation){(uint8_t)what,        which,      num_from_float((float)value),
                                     num_from_float(0.1f), num_zero(), num_one()};
}

/* It excites both MVs and the setpoint of top. */
static inline void excite_all(void)
{
    wish[CONTROLLER].ask[0] = on(EXCITE_MV, 0, 0.05);
    wish[CONTROLLER].ask[1] = on(EXCITE_MV, 1, -0.1);
    wish[CONTROLLER].ask[2] = on(EXCITE_SETPOINT, 0, 0.02);
    ticks(2);
    TEST_ASSERT_EQUAL(EXCITE_RUNS, wish[CONTROLLER].state);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.55, sent(REFLUX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, sent(HEAT));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.27, setpoint_of(TOP));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_EXCITATION_BEGUN, "held"));
}

static inline void nothing_is_excited(void)
{
    for (unsigned j = 0; j < 3; j++)
        TEST_ASSERT_TRUE(num_eq(bench.s.output[j].excitation, num_zero()));
    for (unsigned i = 0; i < 2; i++) {
        TEST_ASSERT_TRUE(num_eq(bench.s.loop[i].excite, num_zero()));
        TEST_ASSERT_TRUE(num_eq(bench.s.loop[i].excited, num_zero()));
    }
    TEST_ASSERT_NULL(supervisor_excited_by(&bench.s));
}

static inline void ended(const char *why)
{
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_EXCITATION_ENDED, why));
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_EXCITATION_ENDED, NULL));
    nothing_is_excited();
}

/* ... and in the same tick nothing of it is left in what is sent. */
static inline void gone(const char *why)
{
    ended(why);
    ASSERT_NO_BUMP(0.5, sent(REFLUX));
    ASSERT_NO_BUMP(0.5, sent(HEAT));
}

#endif
