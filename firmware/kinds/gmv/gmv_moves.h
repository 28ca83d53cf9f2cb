/* Moves of a self-tuner's MVs: the law's solution as changes of the output, within the limits that have shown. The first moves fade in. */
#ifndef REFLUX_GMV_GMV_MOVES_H
#define REFLUX_GMV_GMV_MOVES_H

#include "block/block.h"
#include "kinds/gmv/gmv.h"

struct gmv_moves;

/* Forgets the limits. */
void gmv_moves_init(struct gmv_moves *m);

/* The output is where loop i was left, or where it would be without the limit that cut it short. */
bool gmv_moves_continue(const struct gmv_moves *m, unsigned i, num_t out);

/* Learns the limits from the last outputs: an MV that the law asked to move and that did not is at one. */
void gmv_moves_learn_limits(struct gmv_moves *m, const struct gmv_sample *sample, unsigned loops);
/* Move that the law asked of MV i last and that it did not make; 0: nothing was asked. */
float gmv_moves_lacked(const struct gmv_moves *m, const struct gmv_sample *sample, unsigned i);
/* Outputs of the members that act. False: the law has no number. */
bool gmv_moves_step_law(struct gmv_moves *m, struct gmv *g, const struct gmv_sample *sample,
                        struct block_io *io);

#endif
