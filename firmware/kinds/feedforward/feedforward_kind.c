/* The feedforward element as a kind of block. The ring of its dead time stands behind its state. */
#include "kinds/feedforward/feedforward.h"

#include "block/feedforward.h"

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

static enum err feedforward_check(const struct block_setup *setup, struct block_fault *fault)
{
    fault->member = 0;
    return feedforward_validate(setup->settings, setup->interval_s, &fault->field, &fault->wanted);
}

static enum err feedforward_configure(void *state, const struct block_setup *setup, bool retune)
{
    (void)retune; /* other settings begin at rest */
    return feedforward_init(state, setup->settings, setup->interval_s, feedforward_ring(state),
                            feedforward_bytes(setup->settings, setup->interval_s));
}

/* The state may have been moved, and the ring with it. */
static struct feedforward *element_of_state(void *state)
{
    (void)feedforward_place_ring(state, feedforward_ring(state));
    return state;
}

static void feedforward_kind_step(void *state, struct block_io *io)
{
    io->members.out[0] = feedforward_step(element_of_state(state), io->members.in[0]);
}

static void feedforward_kind_follow(void *state, struct block_io *io)
{
    feedforward_reset(element_of_state(state), io->members.in[0]);
}

const struct block_kind feedforward_kind = {
    .name = "feedforward",
    .stage = STAGE_FEED_FORWARD,
    .bad_input = BAD_INPUT_IS_TOLD, /* it goes on with the value that stands in for the reading */
    .bytes = feedforward_kind_bytes,
    .check = feedforward_check,
    .configure = feedforward_configure,
    .step = feedforward_kind_step,
    .follow = feedforward_kind_follow,
};
