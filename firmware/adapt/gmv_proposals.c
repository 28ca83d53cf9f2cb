/* Adopted parameters become settings of the block by proposals, so that `save` keeps them: theta1_1 ... in their order, as many
 * at a time as a proposal has room for. */
#include "adapt/gmv_block.h"

#if CONFIG_BLOCKS

/* The n-th of all parameters of all loops, in one row. False past the end. */
static bool nth_parameter(const struct gmv_block *s, unsigned n, unsigned *i, unsigned *p)
{
    const struct gmv_shape *shape = &gmv_of_const(s)->shape;
    for (*i = 0; *i < s->loops; (*i)++) {
        if (n < gmv_parameters(shape, *i)) {
            *p = n;
            return true;
        }
        n -= gmv_parameters(shape, *i);
    }
    return false;
}

void gmv_propose(struct gmv_block *s)
{
    const struct gmv *g = gmv_of_const(s);
    for (unsigned i = 0; i < s->loops; i++)
        for (unsigned p = 0; p < gmv_parameters(&g->shape, i); p++)
            s->adopted[i][p] = num_to_float(gmv_used(g, i, p));
    s->proposes = true;
    s->proposed = s->waits_for = 0;
}

/* Whether the n values from the first that is not are settings now. */
static bool are_settings(const struct gmv_block *s, unsigned n)
{
    unsigned i, p;
    for (unsigned k = 0; k < n; k++)
        if (nth_parameter(s, s->proposed + k, &i, &p) && s->start[i][p] != s->adopted[i][p])
            return false;
    return true;
}

/* Up to eight of those that are left. */
static uint8_t put_values(const struct gmv_block *s, struct block_proposal *room)
{
    unsigned i, p;
    uint8_t n = 0;
    while (n < PROPOSAL_MAX && nth_parameter(s, s->proposed + n, &i, &p)) {
        room->value[n] = (struct proposed_value){
            proposed_own((uint8_t)(GMV_ID_THETA + i * GMV_PARAMETERS + p)), s->adopted[i][p]};
        n++;
    }
    return n;
}

uint8_t gmv_proposals_step(struct gmv_block *s, struct block_proposal *room)
{
    if (!s->proposes || !room)
        return 0;
    if (s->waits_for) { /* there is room again: it is in force, or refused, or rejected */
        if (!are_settings(s, s->waits_for)) {
            s->proposes = false;
            return gmv_supervise_accepted(&s->watch, false);
        }
        s->proposed = (uint8_t)(s->proposed + s->waits_for);
        s->waits_for = 0;
    }
    uint8_t n = put_values(s, room);
    if (n == 0) {
        s->proposes = false;
        return gmv_supervise_accepted(&s->watch, true);
    }
    s->waits_for = n;
    if (are_settings(s, n)) /* already: the next ones in the next step */
        return 0;
    room->n = n;
    room->manner = s->watch.config.ask ? PROPOSAL_WHEN_ACCEPTED : PROPOSAL_AT_ONCE;
    return 0;
}

#endif
