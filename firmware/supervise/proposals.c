#include "supervise/proposals.h"

struct block_proposal *proposal_room(struct supervisor *s)
{
    if (atomic_load(&s->proposal.state) != PROPOSAL_FREE)
        return NULL;
    s->proposal.content.n = 0;
    s->proposal.content.manner = PROPOSAL_WHEN_ACCEPTED;
    return &s->proposal.content;
}

void proposal_withdraw(struct supervisor *s, uint8_t block)
{
    if (atomic_load(&s->proposal.state) != PROPOSAL_FREE &&
        s->proposal.block == block - BLOCK_NUMBERED)
        atomic_store(&s->proposal.withdrawn, true);
}

void proposal_hand_over(struct supervisor *s, uint8_t block, const struct block_io *io)
{
    struct block_proposal *p = io->requests.proposal;
    uint8_t n = (uint8_t)(block - BLOCK_NUMBERED);
    if (!p || !p->n)
        return;
    for (uint8_t k = 0; k < p->n && k < PROPOSAL_MAX; k++)
        p->value[k].id = proposed_by(n, p->value[k].id);
    s->proposal.block = n;
    atomic_store(&s->proposal.withdrawn, false);
    s->proposal.plan = s->plan->serial;
    atomic_store(&s->proposal.state, PROPOSAL_GIVEN);
}
