/* Events of blocks with a number (blockN), reported once for each occurrence, and held for the alarms. Within
 * supervise only. */
#ifndef REFLUX_SUPERVISE_RAISED_H
#define REFLUX_SUPERVISE_RAISED_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* Reports the events of a block that has made a step. */
void raised_tell(struct supervisor *s, uint8_t block, const struct block_io *io);
/* Clears the events of a block that runs no step. */
static inline void raised_forget(struct supervisor *s, uint8_t block)
{
    if (block >= BLOCK_NUMBERED)
        s->numbered[block - BLOCK_NUMBERED].raised = 0;
}
#else
#define raised_forget(s, block) ((void)(s))
#endif

#endif
