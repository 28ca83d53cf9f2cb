#include "kinds/rst/rst.h"

#include <string.h>

#include "base/assertion.h"
#include "block/refuse.h"
#include "num/accumulator.h"

#define MOST RST_COEFFICIENTS

/* The polynomials as coefficients of differences of one sample. */
struct rst_coefficients {
    /* Q(1) */
    struct coefficient error;
    /* Factors of u one step ago and before, negative. */
    struct coefficient p[MOST];
    /* Factors of y and w in this step and before; q negative. */
    struct coefficient q[MOST], r[MOST];
    /* Number of each; those behind them are 0. */
    unsigned used;
};

struct rst {
    struct rst_coefficients c;
    float period_s;
    /* Q(1) is above 0. */
    bool rises;
    /* u of the step before, but for a bumpless beginning. */
    struct accumulator base;
    /* Q(1) (w - y) of the last step, alone. */
    struct accumulator added;
    /* The last step. */
    num_t error, y, w;
    /* u of the last step; what took effect. */
    num_t given, applied;
    /* Differences, the newest first; those of y and w without the present one. */
    num_t du[MOST], dy[MOST], dw[MOST];
};

#define PLACE_OF(field) offsetof(struct rst_settings, field)

static const struct block_parameter rst_parameters[] = {
    {RST_ID_PERIOD, BLOCK_FLOAT, PLACE_OF(period_s), 1, 1, "period", "s",
     "of a step of z; that of the loop", 0.001f, 1e5f, 1},
    {RST_ID_P, BLOCK_FLOAT, PLACE_OF(p), 1, MOST, "p", "-", "P behind its 1, from z^-1 on", -100,
     100, 0},
    {RST_ID_Q, BLOCK_FLOAT, PLACE_OF(q), 1, MOST, "q", "-", "Q, of the measurement, from z^0 on",
     -1000, 1000, 0},
    {RST_ID_R, BLOCK_FLOAT, PLACE_OF(r), 1, MOST, "r", "-", "R, of the setpoint, from z^0 on",
     -1000, 1000, 0},
};

/* ---- settings ---- */

static uint32_t rst_bytes(const struct block_setup *setup)
{
    (void)setup;
    return (uint32_t)((sizeof(struct rst) + 7u) & ~(size_t)7u);
}

/* Returns the sum of a row. *size: sum of the magnitudes. */
static float sum_of(const float *x, float *size)
{
    float sum = 0;
    *size = 0;
    for (unsigned k = 0; k < MOST; k++) {
        sum += x[k];
        *size += x[k] < 0 ? -x[k] : x[k];
    }
    return sum;
}

static enum err rst_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct rst_settings *c = setup->settings;
    float q_size, r_size, q = sum_of(c->q, &q_size), r = sum_of(c->r, &r_size);
    float away = r - q, late = c->period_s - setup->interval_s;
    if (setup->members != 1)
        return block_refuse(fault, 0, "loops", "needs one");
    if (!(late <= 1e-3f * setup->interval_s && late >= -1e-3f * setup->interval_s))
        return block_refuse(fault, 0, "period", "must be that of the loop's steps");
    /* Below that its sign may be rounding. */
    if (!((q < 0 ? -q : q) > 1e-5f * q_size))
        return block_refuse(fault, 0, "q", "needs a sum that is not 0: it is the integral action");
    if (!((away < 0 ? -away : away) <= 1e-3f * (q < 0 ? -q : q) + 1e-6f * (q_size + r_size)))
        return block_refuse(fault, 0, "r", "needs the sum that q has, or there is an offset");
    return ERR_OK;
}

static void set_coefficients(struct rst_coefficients *to, const struct rst_settings *c)
{
    float q = 0, r = 0, size;
    to->error = coefficient_from_float(sum_of(c->q, &size));
    /* X = X(1) + (1 - z^-1) (-(x1 + x2 + ...) - (x2 + ...) z^-1 - ...) */
    for (unsigned k = MOST; k-- > 0;) {
        to->p[k] = coefficient_from_float(-c->p[k]);
        to->q[k] = coefficient_from_float(q);
        to->r[k] = coefficient_from_float(-r);
        q += c->q[k];
        r += c->r[k];
    }
    to->used = MOST;
    while (to->used > 1 && c->p[to->used - 1] == 0.0f && c->q[to->used - 1] == 0.0f &&
           c->r[to->used - 1] == 0.0f)
        to->used--;
}

/* Adds what the past and these moves of w and y add to u, without the error's share. */
static void add_moves(const struct rst *s, num_t dw, num_t dy, struct accumulator *sum)
{
    REFLUX_ASSERT(s->c.used <= MOST);
    const struct rst_coefficients *c = &s->c;
    accumulator_add_product(sum, c->r[0], dw);
    accumulator_add_product(sum, c->q[0], dy);
    for (unsigned k = 0; k < c->used; k++)
        accumulator_add_product(sum, c->p[k], s->du[k]);
    for (unsigned k = 1; k < c->used; k++) {
        accumulator_add_product(sum, c->r[k], s->dw[k - 1]);
        accumulator_add_product(sum, c->q[k], s->dy[k - 1]);
    }
}

/* Returns what the next step adds to base when nothing moves. */
static struct accumulator at_rest(const struct rst *s)
{
    struct accumulator sum;
    accumulator_set(&sum, num_zero());
    accumulator_add_product(&sum, s->c.error, s->error);
    add_moves(s, num_zero(), num_zero(), &sum);
    return sum;
}

static void forget_moves(struct rst *s, unsigned from)
{
    for (unsigned k = from; k < MOST; k++)
        s->du[k] = s->dy[k] = s->dw[k] = num_zero();
}

static enum err rst_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct rst *s = state;
    const struct rst_settings *c = setup->settings;
    float size;
    if (!retune) {
        memset(s, 0, sizeof *s);
        forget_moves(s, 0);
    }
    struct accumulator before = at_rest(s);
    /* Moves of another sampling interval, and those that were not kept. */
    forget_moves(s, s->period_s == setup->interval_s ? s->c.used : 0);
    set_coefficients(&s->c, c);
    s->period_s = setup->interval_s;
    s->rises = sum_of(c->q, &size) > 0;
    struct accumulator after = at_rest(s);
    accumulator_add_sum(&s->base, &before);
    accumulator_take_sum(&s->base, &after);
    return ERR_OK;
}

/* ---- steps ---- */

/* Keeps as many as a step looks at. */
static void keep_newest(const struct rst *s, num_t past[MOST], num_t newest)
{
    REFLUX_ASSERT(s->c.used >= 1 && s->c.used <= MOST);
    memmove(past + 1, past, (s->c.used - 1u) * sizeof *past);
    past[0] = newest;
}

static void rst_step(void *state, struct block_io *io)
{
    struct rst *s = state;
    num_t dw = num_sub(io->members.setpoint[0], s->w), dy = num_sub(io->members.in[0], s->y);
    s->error = num_sub(io->members.setpoint[0], io->members.in[0]);
    accumulator_set(&s->added, num_zero());
    accumulator_add_product(&s->added, s->c.error, s->error);
    accumulator_add_sum(&s->base, &s->added);
    add_moves(s, dw, dy, &s->base);
    keep_newest(s, s->dw, dw);
    keep_newest(s, s->dy, dy);
    s->w = io->members.setpoint[0];
    s->y = io->members.in[0];
    s->given = io->members.out[0] = accumulator_get(&s->base);
}

static void rst_back_calculate(void *state, struct block_io *io)
{
    struct rst *s = state;
    bool up = s->rises == num_lt(num_zero(), s->error);
    keep_newest(s, s->du, num_sub(io->members.out[0], s->applied));
    s->applied = io->members.out[0];
    if (!num_eq(io->members.out[0], s->given))
        accumulator_set(&s->base, io->members.out[0]);
    else if (io->members.clamp[0] & (up ? INTEGRAL_CLAMP_UP : INTEGRAL_CLAMP_DOWN))
        accumulator_take_sum(&s->base, &s->added);
}

/* Begins at rest where the output is: the next step with these inputs adds nothing to it. */
static void rst_follow(void *state, struct block_io *io)
{
    struct rst *s = state;
    forget_moves(s, 0);
    s->w = io->members.setpoint[0];
    s->y = io->members.in[0];
    s->error = num_sub(s->w, s->y);
    s->applied = s->given = io->members.out[0];
    accumulator_set(&s->base, io->members.out[0]);
    struct accumulator next = at_rest(s);
    accumulator_take_sum(&s->base, &next);
}

static const char *rst_describe(const void *state, size_t i, float *value)
{
    const struct rst *s = state;
    const struct {
        const char *name;
        float value;
    } inner[] = {{"error", num_to_float(s->error)},
                 {"given", num_to_float(s->given)},
                 {"applied", num_to_float(s->applied)}};
    if (i >= sizeof inner / sizeof inner[0])
        return NULL;
    *value = inner[i].value;
    return inner[i].name;
}

const struct block_kind rst_kind = {
    .name = "rst",
    .stage = STAGE_CONTROL,
    .parameter = rst_parameters,
    .parameters = sizeof rst_parameters / sizeof rst_parameters[0],
    .settings_bytes = sizeof(struct rst_settings),
    .members_most = 1,
    .bytes = rst_bytes,
    .check = rst_check,
    .configure = rst_configure,
    .step = rst_step,
    .back_calculate = rst_back_calculate,
    .follow = rst_follow,
    .describe = rst_describe,
};
