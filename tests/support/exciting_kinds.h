/* Kinds of blocks that excite: a controller of two loops that holds its outputs, and an estimator. What they ask for is what the
 * test says, so that each way in which a signal ends can be told from the others. Included in one file of a test. */
#ifndef REFLUX_TESTS_EXCITING_KINDS_H
#define REFLUX_TESTS_EXCITING_KINDS_H

#include "block/block.h"
#include "formats.h"
#include "kinds/pid/pid.h"
#include "unity.h"

/* ---- a kind that excites: it holds its outputs, and asks for what stands in `wish` ---- */

static struct wish {
    struct block_excitation ask[BLOCK_EXCITES_MAX];
    bool gives_up;
    /* State of its last step. */
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

static void ask_for(struct wish *w, struct block_io *io)
{
    w->steps++;
    w->state = io->requests.excite_state;
    w->reason = io->requests.excite_reason;
    w->holder = io->requests.excite_holder;
    for (unsigned k = 0; k < BLOCK_EXCITES_MAX; k++) {
        TEST_ASSERT_EQUAL(EXCITE_NOTHING, io->requests.excite[k].what);
        io->requests.excite[k] = w->ask[k];
    }
}

static void held_step(void *state, struct block_io *io)
{
    struct held *h = state;
    struct wish *w = &wish[CONTROLLER];
    for (int k = 0; k < 2; k++) {
        io->members.out[k] = h->u[k];
        w->setpoint[k] = D(io->members.setpoint[k]);
    }
    if (w->gives_up)
        io->requests.gives_up = "test";
    ask_for(w, io);
}

static void held_follow(void *state, struct block_io *io)
{
    struct held *h = state;
    for (int k = 0; k < 2; k++)
        h->u[k] = io->members.out[k];
}

static void held_back_calculate(void *state, struct block_io *io)
{
    (void)state;
    (void)io;
}

static void shake_step(void *state, struct block_io *io)
{
    (void)state;
    ask_for(&wish[ESTIMATOR], io);
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

/* Feedforward that adds nothing, and a compensator that changes nothing. */
static void pass_on(void *state, struct block_io *io)
{
    (void)state;
    if (io->members.acting)
        io->members.out[0] = io->members.in[0];
}

static void pass_step(void *state, struct block_io *io)
{
    pass_on(state, io);
    ask_for(&wish[ESTIMATOR], io);
}

static void add_nothing(void *state, struct block_io *io)
{
    (void)state;
    io->members.out[0] = num_zero();
    ask_for(&wish[ESTIMATOR], io);
}

static const struct block_kind ahead_kind = {
    .name = "ahead",
    .stage = STAGE_FEED_FORWARD,
    .parameter = spare_parameter,
    .parameters = 1,
    .settings_bytes = 4,
    .inputs_most = 2,
    .points_most = 1,
    .bytes = held_bytes,
    .check = held_check,
    .configure = held_configure,
    .step = add_nothing,
    .follow = held_back_calculate,
};

static const struct block_kind pass_kind = {
    .name = "pass",
    .stage = STAGE_COMPENSATE,
    .parameter = spare_parameter,
    .parameters = 1,
    .settings_bytes = 4,
    .members_most = 1,
    .bytes = held_bytes,
    .check = held_check,
    .configure = held_configure,
    .step = pass_step,
    .back_calculate = pass_on,
};

const struct block_kind *const block_kinds[] = {&pid_kind, &held_kind, &shake_kind, &ahead_kind,
                                                &pass_kind};
const uint8_t block_kind_count = 5;

static inline struct block_excitation on(enum excite_what what, uint8_t which, double value)
{
    return (struct block_excitation){(uint8_t)what,        which,      num_from_float((float)value),
                                     num_from_float(0.1f), num_zero(), num_one()};
}

#endif
