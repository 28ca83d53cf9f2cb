/* Proposals of an experiment: a usable model becomes settings of the block, only the values that change, nearly always in one. Where there is no
 * room for all, `known` goes off first and on with the last; who accepts the first has accepted the others. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_PROPOSALS_H
#define REFLUX_EXPERIMENT_EXPERIMENT_PROPOSALS_H

#include "kinds/experiment/experiment_context.h"

struct experiment_proposals;

/* Proposes a model of n outputs from now on, if parameters are kept for so many. */
void experiment_propose(struct experiment_proposals *p, unsigned n);
void experiment_proposals_stop(struct experiment_proposals *p);
/* There is more to propose. */
bool experiment_proposes(const struct experiment_proposals *p);
void experiment_proposals_step(struct experiment_proposals *p, const struct experiment_context *c,
                               const float *coefficients, struct block_proposal *room);

#endif
