/* The feedforward element as a kind of block. Its state is followed by the ring of its dead time. */
#include "kinds/feedforward/feedforward.h"

#include <string.h>

static uint32_t feedforward_kind_bytes(const struct block_setup *setup)
{
    return (uint32_t)(sizeof(struct feedforward) +
                      feedforward_bytes(setup->settings, setup->interval_s));
}

static num_t *feedforward_ring(void *state)
{
    struct feedforward *ff = state;
    return (num_t *)(ff + 1);
}

static const char *feedforward_parameter(const char *field)
{
    static const struct {
        const char *field, *parameter;
    } names[] = {
        {"lead_s", "lead"}, {"lag_s", "lag"}, {"dead_time_s", "dead"},
        {"out_lo", "lo"},   {"out_hi", "hi"}, {"h_s", ""},
    };
    for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strcmp(field, names[i].field) == 0)
            return names[i].parameter;
    return field;
}

static enum err feedforward_check(const struct block_setup *setup, struct block_fault *fault)
{
    enum err err =
        feedforward_validate(setup->settings, setup->interval_s, &fault->field, &fault->wanted);
    fault->member = 0;
    fault->field = feedforward_parameter(fault->field);
    return err;
}

static enum err feedforward_configure(void *state, const struct block_setup *setup, bool retune)
{
    (void)retune; /* other settings begin at rest */
    return feedforward_init(state, setup->settings, setup->interval_s, feedforward_ring(state),
                            feedforward_bytes(setup->settings, setup->interval_s));
}

static void feedforward_kind_step(void *state, struct block_io *io)
{
    struct feedforward *ff = state;
    ff->delay.ring = feedforward_ring(ff); /* the state may have been moved */
    io->out[0] = feedforward_step(ff, io->in[0]);
}

static void feedforward_kind_follow(void *state, struct block_io *io)
{
    struct feedforward *ff = state;
    ff->delay.ring = feedforward_ring(ff);
    feedforward_reset(ff, io->in[0]);
}

const struct block_kind feedforward_kind = {
    .name = "feedforward",
    .stage = STAGE_FEED_FORWARD,
    .bytes = feedforward_kind_bytes,
    .check = feedforward_check,
    .configure = feedforward_configure,
    .step = feedforward_kind_step,
    .follow = feedforward_kind_follow,
};
