/* A law that was found becomes settings by proposals, as many values at a time as there is room for: only those that change. `made` goes to 0
 * first where that takes more than one, and on with the last; who accepts the first has accepted the others. */
#include "control/state_law_block.h"

#if CONFIG_BLOCKS

/* The p-th of all values: id of its parameter, what it is and what it should be. False past the end. */
static bool nth_of_law(const struct state_law_settings *s, const struct state_law_found *f,
                       unsigned loops, unsigned p, struct proposed_value *wanted, float *is)
{
    unsigned of_g = loops * loops, i, k;
    if (p < of_g) {
        i = p / loops;
        k = p % loops;
        wanted->id = STATE_LAW_ID_G + i * STATE_LAW_LOOPS + k;
        wanted->value = f->g[i][k];
        *is = s->g[i][k];
        return true;
    }
    p -= of_g;
    i = p / STATE_FEEDBACK_INPUTS;
    k = p % STATE_FEEDBACK_INPUTS;
    if (i >= STATE_LAW_LOOPS)
        return false;
    wanted->id = STATE_LAW_ID_F + i * STATE_FEEDBACK_INPUTS + k;
    wanted->value = f->f[i][k];
    *is = s->f[i][k];
    return true;
}

unsigned state_law_values_left(const struct state_law_settings *is,
                               const struct state_law_found *wanted, float made_s, unsigned loops)
{
    struct proposed_value value;
    float now;
    unsigned left = 0;
    for (unsigned p = 0; nth_of_law(is, wanted, loops, p, &value, &now); p++)
        left += value.value != now ? 1u : 0u;
    return 2u * left + (is->made_s != made_s ? 1u : 0u);
}

static uint32_t id_in(uint8_t block, uint32_t id)
{
    return (proposed_own((uint8_t)id) & ~PROPOSED_SELF) | block;
}

void state_law_put_values(const struct state_law_settings *is, const struct state_law_found *wanted,
                          float made_s, unsigned loops, uint8_t block, struct block_proposal *room)
{
    struct proposed_value value;
    float now;
    unsigned n = 0;
    bool whole = state_law_values_left(is, wanted, made_s, loops) / 2u < PROPOSAL_MAX;
    float made = whole ? made_s : 0.0f;
    if (is->made_s != made)
        room->value[n++] = (struct proposed_value){id_in(block, STATE_LAW_ID_MADE), made};
    for (unsigned p = 0; n < PROPOSAL_MAX && nth_of_law(is, wanted, loops, p, &value, &now); p++)
        if (value.value != now)
            room->value[n++] = (struct proposed_value){id_in(block, value.id), value.value};
    room->n = (uint8_t)n;
}

void state_law_propose(struct state_law_block *b, struct block_proposal *room)
{
    if (!b->proposes || !room)
        return;
    uint8_t left = (uint8_t)state_law_values_left(&b->s, &b->found, b->s.period_s, b->loops);
    bool refused = b->waits && left == b->proposed; /* or rejected */
    if (refused || left == 0) {
        b->proposes = false;
        return;
    }
    b->accepted = b->accepted || b->waits;
    state_law_put_values(&b->s, &b->found, b->s.period_s, b->loops, PROPOSED_SELF, room);
    room->manner =
        b->accepted || b->s.adopt == STATE_LAW_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
    b->proposed = left;
    b->waits = true;
}

#endif
