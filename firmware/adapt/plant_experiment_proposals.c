/* A usable model becomes settings of the block by proposals, as many values at a time as there is room for: only those that change,
 * `known` off first where that takes more than one, and on with the last. */
#include "adapt/plant_experiment_block.h"

#if CONFIG_EXPERIMENT

/* The p-th of all values: id, what it is, what it should be. False past the end. */
static bool nth_value(struct experiment *e, unsigned p, struct proposed_value *wanted, float *is)
{
    const unsigned of_a = e->n * DIFFERENCE_A_MOST, of_pair = DIFFERENCE_B_MOST;
    if (p < of_a) {
        unsigned i = p / DIFFERENCE_A_MOST, k = p % DIFFERENCE_A_MOST;
        *wanted = (struct proposed_value){
            proposed_own((uint8_t)(EXPERIMENT_ID_A + i * DIFFERENCE_A_MOST + k)),
            experiment_a(e, i)[k]};
        *is = e->s.a[i][k];
        return true;
    }
    p -= of_a;
    unsigned pair = p / of_pair, k = p % of_pair, i = pair / e->n, j = pair % e->n;
    if (i >= e->n)
        return false;
    *wanted = (struct proposed_value){
        proposed_own((uint8_t)(EXPERIMENT_ID_B + (i * EXPERIMENT_KEPT + j) * of_pair + k)),
        experiment_b(e, i, j)[k]};
    *is = e->s.b[i][j][k];
    return true;
}

static uint8_t values_left(struct experiment *e)
{
    struct proposed_value wanted;
    float is;
    unsigned left = 0;
    for (unsigned p = 0; nth_value(e, p, &wanted, &is); p++)
        left += wanted.value != is ? 1u : 0u;
    return (uint8_t)left;
}

void experiment_propose(struct experiment *e)
{
    e->proposes = e->n <= EXPERIMENT_KEPT;
    e->waits = false;
}

/* Values first, up to the room that `known` leaves. */
static void put_proposal(struct experiment *e, struct block_proposal *room, unsigned left)
{
    struct proposed_value wanted;
    float is;
    bool whole = left < PROPOSAL_MAX;
    unsigned n = 0;
    if (whole != (e->s.known != 0))
        room->value[n++] =
            (struct proposed_value){proposed_own(EXPERIMENT_ID_KNOWN), whole ? 1.0f : 0.0f};
    for (unsigned p = 0; n < PROPOSAL_MAX && nth_value(e, p, &wanted, &is); p++)
        if (wanted.value != is)
            room->value[n++] = wanted;
    room->n = (uint8_t)n;
    room->manner =
        e->s.adopt == EXPERIMENT_ADOPT_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
}

void experiment_proposals_step(struct experiment *e, struct block_proposal *room)
{
    if (!e->proposes || !room)
        return;
    unsigned left = values_left(e);
    uint8_t now = (uint8_t)(2u * left + e->s.known);
    if (e->waits && now == e->proposed) { /* refused, or rejected */
        e->proposes = false;
        return;
    }
    if (left == 0 && e->s.known) {
        e->proposes = false;
        return;
    }
    put_proposal(e, room, left);
    e->proposed = now;
    e->waits = true;
}

#endif
