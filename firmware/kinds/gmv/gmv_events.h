/* Events of the kind `gmv`. */
#ifndef REFLUX_GMV_GMV_EVENTS_H
#define REFLUX_GMV_GMV_EVENTS_H

#include "block/block.h"
#include "kinds/gmv/gmv_supervise.h"

#define GMV_EVENTS 9
extern const struct block_event gmv_event_rows[GMV_EVENTS];

/* Raises the events of a step. wish: enum gmv_wish of the step; singular: the loops were solved one by one. */
void gmv_events_raise(const struct gmv_status *status, struct block_io *io, unsigned loops,
                      uint8_t wish, bool singular);

#endif
