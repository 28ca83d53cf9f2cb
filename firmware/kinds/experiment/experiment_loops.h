/* From a model to what blocks of the kinds `polynomial` and `rst` compute with: the decoupler, and a controller by pole placement for each
 * loop, by the code behind tools/decouple. Loop k is measurement k by MV k. In the workspace, one design in each piece of work. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_LOOPS_H
#define REFLUX_EXPERIMENT_EXPERIMENT_LOOPS_H

#include "kinds/experiment/experiment_context.h"

/* In the block: what was found, and how far it is proposed. */
struct experiment_loops;
/* In the workspace: the design. */
struct experiment_loops_job;

struct state_law_found;

extern const uint32_t experiment_loops_bytes;
void experiment_loops_begin(struct experiment_loops_job *job, const struct experiment_context *c);
/* The next design. */
void experiment_loops_piece(struct experiment_loops_job *job, const struct experiment_context *c);
/* All of it is done, or it is refused. */
bool experiment_loops_are_found(const struct experiment_loops_job *job,
                                const struct experiment_context *c);
/* Takes what was found. found: radius of the loops, or what is refused. */
void experiment_loops_take(struct experiment_loops *l, const struct experiment_loops_job *job,
                           struct state_law_found *found);

/* In every step with something to propose. Returns false when there is no more. */
bool experiment_loops_propose(struct experiment_loops *l, const struct experiment_context *c,
                              struct block_proposal *room);

#endif
