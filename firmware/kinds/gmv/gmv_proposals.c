/* Adopted parameters become settings of the block by a proposal, so that `save` keeps them: theta1_1 ... in their order. */
#include "kinds/gmv/gmv_block.h"

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
    s->proposed = 0;
    s->waits = false;
}

/* Those that are settings with other values. */
static void put_parameters(const struct gmv_block *s, struct block_proposal *room)
{
    unsigned i, p;
    for (unsigned n = 0; nth_parameter(s, n, &i, &p); n++)
        if (s->start[i][p] != s->adopted[i][p])
            room->value[room->n++] = (struct proposed_value){
                proposed_own((uint8_t)(GMV_ID_THETA + i * GMV_PARAMETERS + p)), s->adopted[i][p]};
}
_Static_assert(GMV_LOOPS *GMV_PARAMETERS <= PROPOSAL_MAX, "all parameters are one proposal");

static uint8_t parameters_of_all(const struct gmv_block *s)
{
    uint8_t n = 0;
    for (unsigned i = 0; i < s->loops; i++)
        n = (uint8_t)(n + gmv_parameters(&gmv_of_const(s)->shape, i));
    return n;
}

uint8_t gmv_proposals_step(struct gmv_block *s, struct block_proposal *room)
{
    if (!s->proposes || !room)
        return 0;
    put_parameters(s, room);
    room->manner = s->watch.config.ask ? PROPOSAL_WHEN_ACCEPTED : PROPOSAL_AT_ONCE;
    if (room->n && !s->waits) {
        s->waits = true;
        return 0;
    }
    bool accepted = room->n == 0; /* else refused, or rejected */
    room->n = 0;
    s->proposes = false;
    s->proposed = accepted ? parameters_of_all(s) : 0;
    return gmv_supervise_accepted(&s->watch, accepted);
}
