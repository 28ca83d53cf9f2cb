/* Kinds for blockN that no product has: a dynamic compensator of one or two loops, a feedforward element with two inputs, a
 * controller of two loops. Included in one file of a test it stands in for app/kinds.c. */
#ifndef REFLUX_TESTS_STAGE_KINDS_H
#define REFLUX_TESTS_STAGE_KINDS_H

#include <stddef.h>

#include "kinds/decoupler/decoupler.h"
#include "kinds/feedforward/feedforward.h"
#include "kinds/pid/pid.h"
#include "kinds/two_position/two_position.h"
#include "signal/lead_lag.h"

#define STAGE_ROW(row_id, of, member, row_lo, row_hi, row_initial)                                 \
    {                                                                                              \
        .id = (row_id), .type = BLOCK_FLOAT, .offset = offsetof(struct of, member),                \
        .name = #member, .unit = "-", .help = "of the test", .lo = (row_lo), .hi = (row_hi),       \
        .initial = (row_initial)                                                                   \
    }

/* Faults of a block of a test: in the calls from the next one on. */
enum stage_fault { STAGE_WELL, STAGE_GIVES_UP, STAGE_NO_NUMBER };
enum stage_call { CALL_STEP, CALL_BACK, CALL_FOLLOW };
static struct {
    enum stage_fault fault;
    enum stage_call call;
} stage_fails;

/* Requests of cross and ahead in their steps, while there are any. */
static struct block_excitation stage_excites;

/* Only float has what is no number; there is no such test in fixed point. */
static inline num_t no_number(void)
{
    return num_from_float(NAN);
}

static inline bool stage_failed(enum stage_call call, struct block_io *io)
{
    if (stage_fails.fault == STAGE_WELL || stage_fails.call != call)
        return false;
    if (stage_fails.fault == STAGE_GIVES_UP)
        io->requests.gives_up = "test";
    else
        io->members.out[0] = no_number();
    return true;
}

/* ---- cross: each output also gets a share of the other input, through a lag ---- */

struct cross_settings {
    float k12, k21; /* shares of the second in the first output, of the first in the second */
    float lag;      /* s */
    float ratio;    /* of its further input, in the first output */
};

struct cross {
    num_t k[2], a, ratio;
    num_t x[2];   /* lagged inputs */
    uint8_t mask; /* that acted when it last followed */
    unsigned steps, backs, follows;
    uint8_t ask_work, results;
    num_t in[2], back_in[2]; /* of the last step, and of what was told of it */
};

static const struct block_parameter cross_parameters[] = {
    STAGE_ROW(1, cross_settings, k12, -100, 100, 0.8f),
    STAGE_ROW(2, cross_settings, k21, -100, 100, 0.6f),
    STAGE_ROW(3, cross_settings, lag, 0, 1000, 9.0f),
    STAGE_ROW(4, cross_settings, ratio, -10, 10, 0.0f),
};

static uint32_t cross_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct cross);
}

static enum err cross_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct cross_settings *c = setup->settings;
    fault->field = "k12";
    fault->wanted = "needs shares whose product is not 1";
    for (uint8_t k = 0; k < setup->members; k++)
        if (!(setup->member[k].out_reach >= 1.0f))
            return ERR_RANGE;
    return c->k12 * c->k21 == 1.0f ? ERR_SINGULAR : ERR_OK;
}

static enum err cross_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct cross *x = state;
    const struct cross_settings *c = setup->settings;
    if (!retune)
        *x = (struct cross){0};
    x->k[0] = num_from_float(c->k12);
    x->k[1] = num_from_float(c->k21);
    x->a = num_from_float(setup->interval_s / (setup->interval_s + c->lag));
    x->ratio = num_from_float(c->ratio);
    return ERR_OK;
}

static num_t cross_ratio(const struct cross *x, const struct block_io *io, unsigned k)
{
    return k == 0 && !num_eq(x->ratio, num_zero()) ? num_mul(x->ratio, io->inputs.value[0])
                                                   : num_zero();
}

static bool cross_other(const struct block_io *io, unsigned k)
{
    return (io->members.acting & (1u << (1 - k))) != 0;
}

/* a + k b, of which only the sum has to be a number of the format. */
static num_t cross_sum(num_t a, num_t k, num_t b)
{
    num_wide_t sum = num_wide_add(num_wide_zero(), a, num_one());
    return num_from_wide(num_wide_add(sum, k, b));
}

static void cross_step(void *state, struct block_io *io)
{
    struct cross *x = state;
    if (stage_failed(CALL_STEP, io))
        return;
    for (unsigned k = 0; k < 2; k++) {
        x->in[k] = io->members.in[k];
        if (!(io->members.acting & (1u << k)))
            continue;
        x->x[k] = num_add(x->x[k], num_mul(x->a, num_sub(io->members.in[k], x->x[k])));
    }
    for (unsigned k = 0; k < 2; k++)
        if (io->members.acting & (1u << k)) {
            num_t own = num_add(io->members.in[k], cross_ratio(x, io, k));
            io->members.out[k] = cross_other(io, k) ? cross_sum(own, x->k[k], x->x[1 - k]) : own;
        }
    io->requests.excite[0] = stage_excites;
    x->steps++;
    x->results = (uint8_t)(x->results + io->requests.work_done);
    io->requests.ask_work = x->ask_work;
    x->ask_work = 0;
}

/* y[k] = w[k] + K[k] g[other] w[other] solved for w. */
static void cross_solve(const struct cross *x, const struct block_io *io, const num_t g[2],
                        const num_t y[2], num_t w[2])
{
    if (io->members.acting != 3) {
        w[0] = y[0];
        w[1] = y[1];
        return;
    }
    num_t k1 = num_mul(x->k[0], g[1]), k2 = num_mul(x->k[1], g[0]);
    num_t det = num_sub(num_one(), num_mul(k1, k2));
    w[0] = num_div(cross_sum(y[0], num_neg(k1), y[1]), det);
    w[1] = num_div(cross_sum(y[1], num_neg(k2), y[0]), det);
}

static void cross_back_calculate(void *state, struct block_io *io)
{
    struct cross *x = state;
    if (stage_failed(CALL_BACK, io))
        return;
    const num_t g[2] = {x->a, x->a};
    num_t w[2];
    memcpy(x->back_in, io->members.in, sizeof x->back_in);
    cross_solve(x, io, g, io->members.in, w);
    for (unsigned k = 0; k < 2; k++)
        if (io->members.acting & (1u << k)) {
            io->members.out[k] = w[k];
            x->x[k] = num_add(x->x[k], num_mul(x->a, w[k]));
        }
    x->backs++;
}

/* The lags of those that took part go on; others are at rest at what is found. */
static void cross_follow(void *state, struct block_io *io)
{
    struct cross *x = state;
    if (stage_failed(CALL_FOLLOW, io))
        return;
    num_t g[2], offset[2], y[2] = {io->members.in[0], io->members.in[1]}, w[2];
    for (unsigned k = 0; k < 2; k++) {
        bool goes_on = (io->members.going_on & (1u << k)) != 0;
        g[k] = goes_on ? x->a : num_one();
        offset[k] = goes_on ? num_mul(num_sub(num_one(), x->a), x->x[k]) : num_zero();
    }
    for (unsigned k = 0; k < 2; k++) {
        if (!(io->members.acting & (1u << k)))
            continue;
        y[k] = num_sub(y[k], cross_ratio(x, io, k));
        if (cross_other(io, k))
            y[k] = num_sub(y[k], num_mul(x->k[k], offset[1 - k]));
    }
    cross_solve(x, io, g, y, w);
    for (unsigned k = 0; k < 2; k++)
        if (io->members.acting & (1u << k)) {
            io->members.out[k] = w[k];
            if (!(io->members.going_on & (1u << k)))
                x->x[k] = w[k];
        }
    x->mask = io->members.acting;
    x->follows++;
}

static bool cross_work(void *state)
{
    (void)state;
    return false;
}

static const struct block_kind cross_kind = {
    .name = "cross",
    .stage = STAGE_COMPENSATE,
    .parameter = cross_parameters,
    .parameters = 4,
    .settings_bytes = sizeof(struct cross_settings),
    .members_most = 2,
    .inputs_most = 1,
    .bytes = cross_bytes,
    .check = cross_check,
    .configure = cross_configure,
    .step = cross_step,
    .back_calculate = cross_back_calculate,
    .follow = cross_follow,
    .work = cross_work,
};

/* ---- twice: a compensator without state of one loop, whose MV is at twice its output; its loop goes to manual without its
 * input ---- */

struct twice_settings {
    float factor;
};

static const struct block_parameter twice_parameters[] = {
    STAGE_ROW(1, twice_settings, factor, 0.1f, 100, 2.0f)};

static uint32_t twice_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(num_t);
}

static enum err twice_check(const struct block_setup *setup, struct block_fault *fault)
{
    (void)setup;
    (void)fault;
    return ERR_OK;
}

static enum err twice_configure(void *state, const struct block_setup *setup, bool retune)
{
    (void)retune;
    *(num_t *)state = num_from_float(((const struct twice_settings *)setup->settings)->factor);
    return ERR_OK;
}

static void twice_step(void *state, struct block_io *io)
{
    if (io->members.acting)
        io->members.out[0] = num_mul(*(num_t *)state, io->members.in[0]);
}

/* Works back values and differences in the same way. */
static void twice_back_calculate(void *state, struct block_io *io)
{
    if (io->members.acting)
        io->members.out[0] = num_div(io->members.in[0], *(num_t *)state);
}

static const struct block_kind twice_kind = {
    .name = "twice",
    .stage = STAGE_COMPENSATE,
    .parameter = twice_parameters,
    .parameters = 1,
    .settings_bytes = sizeof(struct twice_settings),
    .members_most = 1,
    .inputs_most = 1,
    .bad_input = BAD_INPUT_MANUAL,
    .bytes = twice_bytes,
    .check = twice_check,
    .configure = twice_configure,
    .step = twice_step,
    .back_calculate = twice_back_calculate,
};

/* ---- ahead: a lead-lag of its first input and a share of its second, to one MV or, by a share, to two ---- */

struct ahead_settings {
    float gain, lead, lag;
    float second; /* share of the second input */
    float other;  /* share of that in the second MV */
};

struct ahead {
    struct lead_lag shape;
    num_t gain, second, other;
    uint8_t quality; /* of its first input */
    unsigned steps, follows;
};

static const struct block_parameter ahead_parameters[] = {
    STAGE_ROW(1, ahead_settings, gain, -100, 100, 1.0f),
    STAGE_ROW(2, ahead_settings, lead, 0, 1000, 0.0f),
    STAGE_ROW(3, ahead_settings, lag, 0, 1000, 9.0f),
    STAGE_ROW(4, ahead_settings, second, -100, 100, 0.0f),
    STAGE_ROW(5, ahead_settings, other, -100, 100, -0.5f),
};

static uint32_t ahead_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct ahead);
}

static enum err ahead_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct ahead_settings *c = setup->settings;
    fault->field = "lead";
    fault->wanted = "at most the lag";
    return c->lead <= c->lag ? ERR_OK : ERR_RANGE;
}

static enum err ahead_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct ahead *a = state;
    const struct ahead_settings *c = setup->settings;
    if (!retune)
        *a = (struct ahead){0};
    num_t y = accumulator_get(&a->shape.y);
    a->gain = num_from_float(c->gain);
    a->second = num_from_float(c->second);
    a->other = num_from_float(c->other);
    enum err err = lead_lag_init(&a->shape, c->lead, c->lag, setup->interval_s);
    lead_lag_reset(&a->shape, y);
    return err;
}

static void ahead_step(void *state, struct block_io *io)
{
    struct ahead *a = state;
    if (stage_failed(CALL_STEP, io))
        return;
    num_t y = num_mul(a->gain, lead_lag_step(&a->shape, io->members.in[0]));
    if (!num_eq(a->second, num_zero()))
        y = num_add(y, num_mul(a->second, io->inputs.value[1]));
    a->quality = io->inputs.quality[0];
    io->members.out[0] = y;
    io->members.out[1] = num_mul(a->other, y);
    io->requests.excite[0] = stage_excites;
    a->steps++;
}

static void ahead_follow(void *state, struct block_io *io)
{
    struct ahead *a = state;
    lead_lag_reset(&a->shape, io->members.in[0]);
    a->follows++;
}

/* Three that differ in what happens without an input: they give up, their loops go to manual, they are told. */
#define AHEAD_KIND(kind_name, without_input)                                                       \
    {                                                                                              \
        .name = kind_name, .stage = STAGE_FEED_FORWARD, .parameter = ahead_parameters,             \
        .parameters = 5, .settings_bytes = sizeof(struct ahead_settings), .inputs_most = 2,        \
        .points_most = 2, .bad_input = without_input, .bytes = ahead_bytes, .check = ahead_check,  \
        .configure = ahead_configure, .step = ahead_step, .follow = ahead_follow,                  \
    }

static const struct block_kind ahead_kind = AHEAD_KIND("ahead", BAD_INPUT_GIVES_UP);
static const struct block_kind wary_kind = AHEAD_KIND("wary", BAD_INPUT_MANUAL);
static const struct block_kind keen_kind = AHEAD_KIND("keen", BAD_INPUT_IS_TOLD);
#undef AHEAD_KIND

/* ---- duet: a controller of two loops, integrals of their errors ---- */

struct duet_settings {
    float rate; /* 1/step */
};

struct duet {
    num_t rate, u[2], applied[2];
};

static const struct block_parameter duet_parameters[] = {
    STAGE_ROW(1, duet_settings, rate, 0, 1, 0.1f)};

static uint32_t duet_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct duet);
}

static enum err duet_check(const struct block_setup *setup, struct block_fault *fault)
{
    fault->field = "loops";
    fault->wanted = "needs two loops";
    return setup->members == 2 ? ERR_OK : ERR_RANGE;
}

static enum err duet_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct duet *d = state;
    if (!retune)
        *d = (struct duet){0};
    d->rate = num_from_float(((const struct duet_settings *)setup->settings)->rate);
    return ERR_OK;
}

static void duet_step(void *state, struct block_io *io)
{
    struct duet *d = state;
    for (int k = 0; k < 2; k++) {
        d->u[k] =
            num_add(d->u[k], num_mul(d->rate, num_sub(io->members.setpoint[k], io->members.in[k])));
        io->members.out[k] = d->u[k];
    }
}

static void duet_back_calculate(void *state, struct block_io *io)
{
    struct duet *d = state;
    for (int k = 0; k < 2; k++)
        d->applied[k] = d->u[k] = io->members.out[k];
}

static const struct block_kind duet_kind = {
    .name = "duet",
    .stage = STAGE_CONTROL,
    .parameter = duet_parameters,
    .parameters = 1,
    .settings_bytes = sizeof(struct duet_settings),
    .members_most = 2,
    .bytes = duet_bytes,
    .check = duet_check,
    .configure = duet_configure,
    .step = duet_step,
    .back_calculate = duet_back_calculate,
    .follow = duet_back_calculate,
};

/* Those for blockN before the others: groups like ffN find theirs all the same. */
const struct block_kind *const block_kinds[] = {
    &pid_kind,  &cross_kind, &twice_kind,     &ahead_kind,       &wary_kind,
    &keen_kind, &duet_kind,  &decoupler_kind, &feedforward_kind, &two_position_kind,
};
const uint8_t block_kind_count = sizeof block_kinds / sizeof block_kinds[0];

#endif
