/* Feedforward elements that blocks have switched off (block/proposal.h): silent from the next tick on, until a plan brings other
 * settings for them. */
#ifndef REFLUX_SUPERVISE_SWITCH_OFFS_H
#define REFLUX_SUPERVISE_SWITCH_OFFS_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Where a block may put one in its step; NULL while its last one waits. */
struct block_switch_off *switch_off_room(struct supervisor *s, uint8_t slot);
/* It has made the step, and goes on. */
void switch_off_hand_over(struct supervisor *s, uint8_t slot, const struct block_io *io);
/* Before elements are computed: those act again whose switch-off was overruled. */
void switch_offs_lift(struct supervisor *s);
/* A plan brings other settings for ffK, from 0: it acts. */
void switch_off_forget_element(struct supervisor *s, uint8_t k);
/* The same for a block with a record and those of its terms that have other settings; all of them where it is another block. */
void switch_off_forget_terms(struct supervisor *s, const struct plan *old, uint8_t slot, bool same);
#else
#define switch_offs_lift(s)             ((void)(s))
#define switch_off_forget_element(s, k) ((void)(s), (void)(k))
#endif

#endif
