/* A usable model becomes settings of the block by proposals: only the values that change, nearly always in one. Where there is no room for all,
 * `known` goes off first and on with the last; who accepts the first has accepted the others. */
#include "kinds/experiment/plant_experiment_block.h"

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
static void put_model(struct experiment *e, struct block_proposal *room, unsigned left)
{
    struct proposed_value wanted;
    float is, known = left < PROPOSAL_MAX ? 1.0f : 0.0f;
    if (e->s.known != (uint8_t)known)
        room->value[room->n++] = (struct proposed_value){proposed_own(EXPERIMENT_ID_KNOWN), known};
    for (unsigned p = 0; room->n < PROPOSAL_MAX && nth_value(e, p, &wanted, &is); p++)
        if (wanted.value != is)
            room->value[room->n++] = wanted;
}

void experiment_proposals_step(struct experiment *e, struct block_proposal *room)
{
    if (!e->proposes || !room)
        return;
    unsigned left = values_left(e);
    uint8_t now = (uint8_t)(2u * left + e->s.known);
    bool refused = e->waits && now == e->proposed; /* or rejected */
    bool whole = left == 0 && e->s.known;
    if (refused || whole) {
        e->proposes = false;
        return;
    }
    put_model(e, room, left);
    room->manner = e->waits || e->s.adopt == EXPERIMENT_ADOPT_AT_ONCE ? PROPOSAL_AT_ONCE
                                                                      : PROPOSAL_WHEN_ACCEPTED;
    e->proposed = now;
    e->waits = true;
}
