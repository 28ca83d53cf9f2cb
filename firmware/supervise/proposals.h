/* Proposals of blocks on their way from the tick to the main loop, one at a time. Within supervise only. */
#ifndef REFLUX_SUPERVISE_PROPOSALS_H
#define REFLUX_SUPERVISE_PROPOSALS_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Where a block may put one in its step; NULL while another waits. */
struct block_proposal *proposal_room(struct supervisor *s);
/* What the block in that slot has waiting holds no longer. */
void proposal_withdraw(struct supervisor *s, uint8_t slot);
/* It has made the step, and goes on. */
void proposal_hand_over(struct supervisor *s, uint8_t slot, const struct block_io *io);
#endif

#endif
