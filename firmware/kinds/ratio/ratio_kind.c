/* MV = zero + (output - zero) F/at, with F through a lag. */
#include "kinds/ratio/ratio.h"

#include <string.h>

#include "base/assertion.h"
#include "base/channel.h"
#include "block/refuse.h"
#include "signal/lag.h"

/* Outputs that go back through the ratio stay within what Q7.24 holds, with some room. */
#define BACK_MOST 120.0f

struct ratio {
    num_t offset, slope; /* ratio of a feed as a fraction of its span */
    num_t zero, lo, hi;
    num_t ratio; /* in force */
    struct lag lag;
    uint32_t hold_steps, missing; /* steps without a feed */
    bool begun;                   /* there has been a feed */
};

#define PLACE(field) offsetof(struct ratio_settings, field)
#define NUMBER(id, field, name, unit, help, lo, hi, initial)                                       \
    {                                                                                              \
        id, BLOCK_FLOAT, PLACE(field), 1, 1, name, unit, help, lo, hi, initial                     \
    }

static const struct block_parameter ratio_parameters[] = {
    NUMBER(1, nominal, "at", "EU", "feed at which the ratio is 1", 0, 1e9f, 0),
    NUMBER(2, zero, "zero", "-", "fraction of the MV's span at which nothing flows", -2, 1, 0),
    NUMBER(3, lag_s, "lag", "s", "of the feed", 0, 1e5f, 0),
    NUMBER(4, lo, "lo", "-", "least ratio", 0.05f, 1, 0.2f),
    NUMBER(5, hi, "hi", "-", "largest ratio", 1, 20, 5),
    NUMBER(6, hold_s, "hold", "s", "time that the last ratio is kept without a feed", 0, 1e6f, 60),
};

/* ---- settings ---- */

static uint32_t ratio_bytes(const struct block_setup *setup)
{
    (void)setup;
    return (uint32_t)((sizeof(struct ratio) + 7u) & ~(size_t)7u);
}

static float ratio_size(float x)
{
    return x < 0 ? -x : x;
}

static enum err ratio_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct ratio_settings *c = setup->settings;
    if (setup->members < 1 || setup->members > RATIO_LOOPS)
        return block_refuse(fault, 0, "loops", "needs one or two");
    if (setup->inputs != 1)
        return block_refuse(fault, 0, "inputs", "needs the feed, and nothing else");
    if (!(c->nominal > 0))
        return block_refuse(fault, 0, "at", "must be above 0");
    const struct block_signal *feed = &setup->input[0];
    if (!(ratio_size(feed->lo) <= NUM_MAX_MAGNITUDE * c->nominal &&
          feed->hi - feed->lo <= NUM_MAX_MAGNITUDE * c->nominal))
        return block_refuse(fault, 0, "at", "must be a hundredth of the feed's span or more");
    for (unsigned k = 0; k < setup->members; k++)
        if ((setup->present & (1u << k)) &&
            !((setup->member[k].out_reach + ratio_size(c->zero)) <= BACK_MOST * c->lo))
            return block_refuse(fault, k, "lo", "is too small for what the loop's MV may be");
    return ERR_OK;
}

static enum err ratio_configure(void *state, const struct block_setup *setup, bool retune)
{
    REFLUX_ASSERT(setup->members <= RATIO_LOOPS && setup->inputs == 1);
    struct ratio *s = state;
    const struct ratio_settings *c = setup->settings;
    float hold = c->hold_s / setup->interval_s;
    if (!retune)
        memset(s, 0, sizeof *s);
    s->offset = num_from_float(setup->input[0].lo / c->nominal);
    s->slope = num_from_float((setup->input[0].hi - setup->input[0].lo) / c->nominal);
    s->zero = num_from_float(c->zero);
    s->lo = num_from_float(c->lo);
    s->hi = num_from_float(c->hi);
    s->hold_steps = hold < 4e9f ? (uint32_t)hold : 4000000000u;
    if (!retune) {
        s->ratio = num_one();
        return lag_init(&s->lag, c->lag_s, setup->interval_s);
    }
    return lag_retune(&s->lag, c->lag_s, setup->interval_s);
}

/* ---- steps ---- */

static num_t ratio_of_feed(const struct ratio *s, num_t feed)
{
    num_wide_t sum = num_wide_add(num_wide_zero(), s->offset, num_one());
    return num_clamp(num_from_wide(num_wide_add(sum, s->slope, feed)), s->lo, s->hi);
}

/* zero + (x - zero) ratio */
static num_t times_ratio(const struct ratio *s, num_t x)
{
    num_wide_t sum = num_wide_add(num_wide_zero(), s->zero, num_one());
    return num_from_wide(num_wide_add(sum, num_sub(x, s->zero), s->ratio));
}

static bool feed_is_usable(const struct block_io *io)
{
    return quality_usable((enum quality)io->inputs.quality[0]);
}

static void ratio_step(void *state, struct block_io *io)
{
    REFLUX_ASSERT(!(io->members.acting >> RATIO_LOOPS));
    struct ratio *s = state;
    if (feed_is_usable(io)) {
        s->ratio = lag_step(&s->lag, ratio_of_feed(s, io->inputs.value[0]));
        s->missing = 0;
        s->begun = true;
    } else if (!s->begun || s->missing >= s->hold_steps) {
        io->requests.gives_up = "no_feed";
        return;
    } else {
        s->missing++;
    }
    for (unsigned k = 0; k < RATIO_LOOPS; k++)
        if (io->members.acting & (1u << k))
            io->members.out[k] = times_ratio(s, io->members.in[k]);
}

/* Turns a difference of MVs into one of the loops' outputs. */
static void ratio_back_calculate(void *state, struct block_io *io)
{
    const struct ratio *s = state;
    for (unsigned k = 0; k < RATIO_LOOPS; k++)
        if (io->members.acting & (1u << k))
            io->members.out[k] = num_div(io->members.in[k], s->ratio);
}

/* The lag goes on where a member did; else it is at rest at the present feed. */
static void ratio_follow(void *state, struct block_io *io)
{
    struct ratio *s = state;
    if (feed_is_usable(io) && !io->members.going_on) {
        s->ratio = ratio_of_feed(s, io->inputs.value[0]);
        lag_reset(&s->lag, s->ratio);
        s->begun = true;
        s->missing = 0;
    } else if (feed_is_usable(io)) { /* the ratio of the next step */
        struct lag next = s->lag;
        s->ratio = lag_step(&next, ratio_of_feed(s, io->inputs.value[0]));
    }
    for (unsigned k = 0; k < RATIO_LOOPS; k++)
        if (io->members.acting & (1u << k))
            io->members.out[k] =
                num_add(s->zero, num_div(num_sub(io->members.in[k], s->zero), s->ratio));
}

static const char *ratio_describe(const void *state, size_t i, float *value)
{
    const struct ratio *s = state;
    if (i > 1)
        return NULL;
    *value = i == 0 ? num_to_float(s->ratio) : (float)s->missing;
    return i == 0 ? "ratio" : "missing";
}

const struct block_kind ratio_kind = {
    .name = "ratio",
    .stage = STAGE_COMPENSATE,
    .parameter = ratio_parameters,
    .parameters = sizeof ratio_parameters / sizeof ratio_parameters[0],
    .settings_bytes = sizeof(struct ratio_settings),
    .members_most = RATIO_LOOPS,
    .inputs_most = 1,
    .bad_input = BAD_INPUT_IS_TOLD,
    .bytes = ratio_bytes,
    .check = ratio_check,
    .configure = ratio_configure,
    .step = ratio_step,
    .back_calculate = ratio_back_calculate,
    .follow = ratio_follow,
    .describe = ratio_describe,
};
