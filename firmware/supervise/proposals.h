/* Proposals of blocks on their way from the tick to the main loop, one at a time. Within supervise only. */
#ifndef REFLUX_SUPERVISE_PROPOSALS_H
#define REFLUX_SUPERVISE_PROPOSALS_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Returns the place where a block may put a proposal in its step; NULL while another one waits. */
struct block_proposal *proposal_room(struct supervisor *s);
/* Withdraws a waiting proposal of that block. */
void proposal_withdraw(struct supervisor *s, uint8_t block);
/* Hands over the proposal of a block that has made its step, and has not given up. */
void proposal_hand_over(struct supervisor *s, uint8_t block, const struct block_io *io);
#endif

#endif
