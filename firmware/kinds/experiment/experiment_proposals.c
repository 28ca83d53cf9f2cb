#include "kinds/experiment/experiment_proposals.h"

#include "base/assertion.h"
#include "kinds/experiment/experiment_ids.h"
#include "kinds/experiment/experiment_model.h"
#include "kinds/experiment/experiment_proposals_state.h"

/* The p-th of all values: its id, its value as it should be, and in *actual as it is. False past the end. */
static bool nth_value(const struct experiment_context *c, const float *coefficients, unsigned p,
                      struct proposed_value *wanted, float *actual)
{
    const unsigned of_a = c->n * DIFFERENCE_A_MOST, of_pair = DIFFERENCE_B_MOST;
    if (p < of_a) {
        unsigned i = p / DIFFERENCE_A_MOST, k = p % DIFFERENCE_A_MOST;
        *wanted = (struct proposed_value){
            proposed_own((uint8_t)(EXPERIMENT_ID_A + i * DIFFERENCE_A_MOST + k)), coefficients[p]};
        *actual = c->s.a[i][k];
        return true;
    }
    unsigned pair = (p - of_a) / of_pair, k = (p - of_a) % of_pair, i = pair / c->n,
             j = pair % c->n;
    if (i >= c->n)
        return false;
    *wanted = (struct proposed_value){
        proposed_own((uint8_t)(EXPERIMENT_ID_B + (i * EXPERIMENT_KEPT + j) * of_pair + k)),
        coefficients[p]};
    *actual = c->s.b[i][j][k];
    return true;
}

static uint8_t values_left(const struct experiment_context *c, const float *coefficients)
{
    struct proposed_value wanted;
    float actual;
    unsigned left = 0;
    for (unsigned p = 0; nth_value(c, coefficients, p, &wanted, &actual); p++)
        left += wanted.value != actual ? 1u : 0u;
    return (uint8_t)left;
}

void experiment_propose(struct experiment_proposals *p, unsigned n)
{
    p->proposes = n <= EXPERIMENT_KEPT;
    p->waits = false;
}

void experiment_proposals_stop(struct experiment_proposals *p)
{
    p->proposes = false;
}

bool experiment_proposes(const struct experiment_proposals *p)
{
    return p->proposes;
}

/* Values first, up to the room that `known` leaves. */
static void put_model(const struct experiment_context *c, const float *coefficients,
                      struct block_proposal *room, unsigned left)
{
    REFLUX_ASSERT(room->n == 0);
    struct proposed_value wanted;
    float actual, known = left < PROPOSAL_MAX ? 1.0f : 0.0f;
    if (c->s.known != (uint8_t)known)
        room->value[room->n++] = (struct proposed_value){proposed_own(EXPERIMENT_ID_KNOWN), known};
    for (unsigned p = 0; room->n < PROPOSAL_MAX && nth_value(c, coefficients, p, &wanted, &actual);
         p++)
        if (wanted.value != actual)
            room->value[room->n++] = wanted;
}

void experiment_proposals_step(struct experiment_proposals *p, const struct experiment_context *c,
                               const float *coefficients, struct block_proposal *room)
{
    if (!p->proposes || !room)
        return;
    unsigned left = values_left(c, coefficients);
    uint8_t state = (uint8_t)(2u * left + c->s.known);
    bool refused = p->waits && state == p->proposed; /* or rejected */
    bool whole = left == 0 && c->s.known;
    if (refused || whole) {
        p->proposes = false;
        return;
    }
    put_model(c, coefficients, room, left);
    room->manner = p->waits || c->s.adopt == EXPERIMENT_ADOPT_AT_ONCE ? PROPOSAL_AT_ONCE
                                                                      : PROPOSAL_WHEN_ACCEPTED;
    p->proposed = state;
    p->waits = true;
}
