/* Feedforward elements that blocks have switched off (block/proposal.h): they are silent from the next tick on,
 * until a plan brings other settings for them. */
#ifndef REFLUX_SUPERVISE_SWITCH_OFFS_H
#define REFLUX_SUPERVISE_SWITCH_OFFS_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Returns the place where a block may put a switch-off in its step; NULL while its last one waits. */
struct block_switch_off *switch_off_room(struct supervisor *s, uint8_t block);
/* Hands over the switch-off of a block that has made its step, and has not given up. */
void switch_off_hand_over(struct supervisor *s, uint8_t block, const struct block_io *io);
/* Before feedforward runs: lets those act again whose switch-off was overruled. */
void switch_offs_lift(struct supervisor *s);
/* Lets ffK, from 0, act again, because a plan brings other settings for it. */
void switch_off_forget_ff(struct supervisor *s, uint8_t k);
/* Lets those terms of blockN act again that have other settings; all of them if it is another block. */
void switch_off_forget_terms(struct supervisor *s, const struct plan *old, uint8_t block,
                             bool same);
/* Returns true if that ffN is switched off. */
bool switched_off(const struct supervisor *s, uint8_t block);
/* Tells a blockN which of its terms are switched off. Returns whether these are others than in its last step. */
bool switched_off_changes(struct supervisor *s, uint8_t block, struct block_io *io);
#else
#define switched_off(s, block)             ((void)(s), false)
#define switched_off_changes(s, block, io) ((void)(s), false)
#define switch_offs_lift(s)                ((void)(s))
#define switch_off_forget_ff(s, k)         ((void)(s), (void)(k))
#endif

#endif
