/* A plan comes into force: which blocks with a number (blockN) go on, which get new settings, and which begin anew. Within
 * supervise only. */
#ifndef REFLUX_SUPERVISE_NUMBERED_PLACE_H
#define REFLUX_SUPERVISE_NUMBERED_PLACE_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* old: the plan before, or NULL. */
void numbered_place(struct supervisor *s, const struct plan *old);
/* The loops whose outputs a block changes, or adds to, by that plan go on from the outputs they find. */
void numbered_moves_loops(struct supervisor *s, const struct plan *plan, uint8_t block);
#else
#define numbered_place(s, old) ((void)(old))
#endif

#endif
