#include "kinds/gmv/gmv_proposals.h"

#include "base/assertion.h"
#include "kinds/gmv/gmv_proposals_state.h"
#include "kinds/gmv/gmv_settings.h"

/* Finds the n-th of all parameters of all loops, in one row. False past the end. */
static bool nth_parameter(const struct gmv_shape *shape, unsigned n, unsigned *i, unsigned *p)
{
    for (*i = 0; *i < shape->loops; (*i)++) {
        if (n < gmv_parameters(shape, *i)) {
            *p = n;
            return true;
        }
        n -= gmv_parameters(shape, *i);
    }
    return false;
}

void gmv_proposals_begin(struct gmv_proposals *s, const struct gmv *g)
{
    const struct gmv_shape *shape = gmv_shape(g);
    for (unsigned i = 0; i < shape->loops; i++)
        for (unsigned p = 0; p < gmv_parameters(shape, i); p++)
            s->adopted[i][p] = num_to_float(gmv_used(g, i, p));
    s->open = true;
    s->stored = 0;
    s->handed_over = false;
}

/* Proposes the adopted parameters that differ from the settings. */
static void put_parameters(const struct gmv_proposals *s, const struct gmv_shape *shape,
                           struct block_proposal *room)
{
    REFLUX_ASSERT(room->n == 0);
    unsigned i, p;
    for (unsigned n = 0; nth_parameter(shape, n, &i, &p); n++)
        if (s->theta[i][p] != s->adopted[i][p])
            room->value[room->n++] = (struct proposed_value){
                proposed_own((uint8_t)(GMV_ID_THETA + i * GMV_PARAMETERS + p)), s->adopted[i][p]};
}
_Static_assert(GMV_LOOPS *GMV_PARAMETERS <= PROPOSAL_MAX, "all parameters are one proposal");

static uint8_t parameters_of_all(const struct gmv_shape *shape)
{
    uint8_t n = 0;
    for (unsigned i = 0; i < shape->loops; i++)
        n = (uint8_t)(n + gmv_parameters(shape, i));
    return n;
}

enum gmv_answer gmv_proposals_step(struct gmv_proposals *s, const struct gmv *g,
                                   struct block_proposal *room, bool ask)
{
    const struct gmv_shape *shape = gmv_shape(g);
    if (!s->open || !room)
        return GMV_NO_ANSWER;
    put_parameters(s, shape, room);
    room->manner = ask ? PROPOSAL_WHEN_ACCEPTED : PROPOSAL_AT_ONCE;
    if (room->n && !s->handed_over) {
        s->handed_over = true;
        return GMV_NO_ANSWER;
    }
    bool accepted = room->n == 0; /* else refused, or rejected */
    room->n = 0;
    s->open = false;
    s->stored = accepted ? parameters_of_all(shape) : 0;
    return accepted ? GMV_ACCEPTED : GMV_REJECTED;
}
