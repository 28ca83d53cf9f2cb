/* Kinds of blocks with a number (blockN) that no product has, which really do something: an estimator with two points and work
 * between ticks, and a controller of two loops with a further input. For tests of what the tick does with such blocks;
 * included in one file of a test, which has the table of kinds. */
#ifndef REFLUX_TESTS_NUMBERED_KINDS_H
#define REFLUX_TESTS_NUMBERED_KINDS_H

#include "block/block.h"

/* ---- an estimator: mean and difference of its inputs; its work counts to ten ---- */

struct mean_settings {
    float weight; /* of the first */
};

struct mean {
    num_t weight;
    float interval_s;
    uint32_t counted, results;
    bool begun;
};

static const struct block_parameter mean_parameters[] = {
    {.id = 1,
     .type = BLOCK_FLOAT,
     .name = "weight",
     .unit = "-",
     .help = "of the first",
     .lo = 0,
     .hi = 1,
     .initial = 0.5f},
};

/* A test may set the first, and look at the others. */
static uint32_t mean_more;            /* bytes it needs besides */
static struct block_setup mean_setup; /* with which it was last configured, */
static bool mean_retuned;             /* and how */
static bool mean_waits;               /* its work is wanted */
static bool mean_again;               /* it wants work again and again */
static float mean_adds;               /* to its first point */
static unsigned mean_follows;

static uint32_t mean_bytes(const struct block_setup *setup)
{
    (void)setup;
    return (uint32_t)sizeof(struct mean) + mean_more;
}

static enum err mean_check(const struct block_setup *setup, struct block_fault *fault)
{
    fault->field = "inputs";
    fault->wanted = "needs two inputs and two points";
    return setup->inputs == 2 && setup->points == 2 ? ERR_OK : ERR_RANGE;
}

static enum err mean_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct mean *m = state;
    const struct mean_settings *c = setup->settings;
    if (!retune)
        *m = (struct mean){0};
    mean_setup = *setup;
    mean_retuned = retune;
    m->weight = num_from_float(c->weight);
    m->interval_s = setup->interval_s;
    return ERR_OK;
}

static bool mean_same(const struct block_setup *before, const struct block_setup *now)
{
    const struct mean_settings *a = before->settings, *b = now->settings;
    return a->weight == b->weight;
}

static void mean_follow(void *state, struct block_io *io)
{
    (void)state;
    (void)io;
    mean_follows++;
}

static void mean_step(void *state, struct block_io *io)
{
    struct mean *m = state;
    num_t rest = num_sub(num_one(), m->weight);
    io->points.value[0] =
        num_add(num_mul(m->weight, io->inputs.value[0]), num_mul(rest, io->inputs.value[1]));
    io->points.value[1] = num_sub(io->inputs.value[1], io->inputs.value[0]);
    io->points.quality[0] = io->points.quality[1] = io->inputs.quality[0] > io->inputs.quality[1]
                                                        ? io->inputs.quality[0]
                                                        : io->inputs.quality[1];
    io->points.value[0] = num_add(io->points.value[0], num_from_float(mean_adds));
    m->results += io->requests.work_done;
    mean_waits = io->requests.work_wanted;
    if (!m->begun || (mean_again && !io->requests.work_wanted)) {
        m->begun = true;
        m->counted = 0;
        io->requests.ask_work = 5;
    }
}

static bool mean_work(void *state)
{
    struct mean *m = state;
    return ++m->counted < 10;
}

static const struct block_kind mean_kind = {
    .name = "mean",
    .stage = STAGE_ESTIMATE,
    .parameter = mean_parameters,
    .parameters = 1,
    .settings_bytes = sizeof(struct mean_settings),
    .inputs_most = 2,
    .points_most = 2,
    .bytes = mean_bytes,
    .check = mean_check,
    .configure = mean_configure,
    .same = mean_same,
    .step = mean_step,
    .follow = mean_follow,
    .work = mean_work,
};

/* ---- a controller of two loops: integrals of both errors on both outputs; gives up when told ---- */

struct both_settings {
    float rate; /* of the integrals, 1/step */
    float cross;
};

struct both {
    num_t rate, cross, u[2];
    unsigned steps, backs, follows;
    num_t applied[2];
};

static bool both_gives_up;
static float both_interval_s; /* with which it was last configured */
static float both_adds;       /* to its first output */
static uint8_t both_limited;  /* what its steps say of its second output: enum integral_clamp */
static struct both *both_state;

static const struct block_parameter both_parameters[] = {
    {.id = 1,
     .type = BLOCK_FLOAT,
     .name = "rate",
     .unit = "-",
     .help = "of the integrals",
     .lo = 0,
     .hi = 1,
     .initial = 0.1f},
    {.id = 2,
     .type = BLOCK_FLOAT,
     .offset = 4,
     .name = "cross",
     .unit = "-",
     .help = "share of the other error",
     .lo = -1,
     .hi = 1,
     .initial = 0.25f},
};

static uint32_t both_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct both);
}

static enum err both_check(const struct block_setup *setup, struct block_fault *fault)
{
    fault->field = "loops";
    fault->wanted = "needs two loops";
    return setup->members == 2 ? ERR_OK : ERR_RANGE;
}

static enum err both_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct both *b = state;
    const struct both_settings *c = setup->settings;
    if (!retune)
        *b = (struct both){0};
    b->rate = num_from_float(c->rate);
    b->cross = num_from_float(c->cross);
    both_state = b;
    both_interval_s = setup->interval_s;
    return ERR_OK;
}

static void both_step(void *state, struct block_io *io)
{
    struct both *b = both_state = state; /* a plan may have moved it */
    num_t e[2] = {num_sub(io->members.setpoint[0], io->members.in[0]),
                  num_sub(io->members.setpoint[1], io->members.in[1])};
    if (both_gives_up) {
        io->requests.gives_up = "test";
        return;
    }
    for (int k = 0; k < 2; k++) {
        num_t mixed = num_add(e[k], num_mul(b->cross, e[1 - k]));
        b->u[k] = num_add(b->u[k], num_mul(b->rate, mixed));
        io->members.out[k] = b->u[k];
    }
    io->members.out[0] = num_add(io->members.out[0], num_from_float(both_adds));
    io->members.limited[1] = both_limited;
    b->steps++;
}

static void both_back_calculate(void *state, struct block_io *io)
{
    struct both *b = state;
    for (int k = 0; k < 2; k++)
        b->applied[k] = b->u[k] = io->members.out[k];
    b->backs++;
}

static void both_follow(void *state, struct block_io *io)
{
    struct both *b = state;
    for (int k = 0; k < 2; k++)
        b->u[k] = io->members.out[k];
    b->follows++;
}

static const struct block_kind both_kind = {
    .name = "both",
    .stage = STAGE_CONTROL,
    .parameter = both_parameters,
    .parameters = 2,
    .settings_bytes = sizeof(struct both_settings),
    .members_most = 2,
    .inputs_most = 1,
    .bad_input = BAD_INPUT_GIVES_UP,
    .bytes = both_bytes,
    .check = both_check,
    .configure = both_configure,
    .step = both_step,
    .back_calculate = both_back_calculate,
    .follow = both_follow,
};

#endif
