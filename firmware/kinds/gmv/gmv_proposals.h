/* Adopted parameters become settings of the block by a proposal, so that `save` keeps them: theta1_1 ... in their order. */
#ifndef REFLUX_GMV_GMV_PROPOSALS_H
#define REFLUX_GMV_GMV_PROPOSALS_H

#include "block/proposal.h"
#include "kinds/gmv/gmv.h"

struct gmv_proposals;

/* Proposes the parameters in use. */
void gmv_proposals_begin(struct gmv_proposals *s, const struct gmv *g);

enum gmv_answer {
    GMV_NO_ANSWER,
    GMV_ACCEPTED,
    /* Refused, or rejected. */
    GMV_REJECTED
};
/* Fills in the proposal while there is one. ask: the operator must accept. room: NULL where the block may not propose. */
enum gmv_answer gmv_proposals_step(struct gmv_proposals *s, const struct gmv *g,
                                   struct block_proposal *room, bool ask);

#endif
