/* What blocks with a record say: events of their kinds, told once for each occurrence, and held for the alarms. Within supervise
 * only. */
#ifndef REFLUX_SUPERVISE_RAISED_H
#define REFLUX_SUPERVISE_RAISED_H

#include "exchange/state.h"

#if CONFIG_BLOCKS
/* It has made a step. */
void raised_tell(struct supervisor *s, uint8_t slot, const struct block_io *io);
/* It makes none: what it raised holds no longer. */
void raised_forget(struct supervisor *s, uint8_t slot);
#endif

#endif
