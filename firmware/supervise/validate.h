/* Validates readings, and finds the value that stands in for a bad one. Within supervise only. */
#ifndef REFLUX_SUPERVISE_VALIDATE_H
#define REFLUX_SUPERVISE_VALIDATE_H

#include "exchange/state.h"

/* Validates a reading. i: a measurement of the plan in force. */
void validate_measurement(struct supervisor *s, uint8_t i, const struct reading *r);
/* Validates a read-back. j: a manipulated variable. r: the value that the plant reports. */
void validate_readback_sent(struct supervisor *s, uint8_t j, const struct reading *r);
static inline void validate_readback(struct supervisor *s, uint8_t j, const struct reading *r)
{
    const struct mv_state *o = &s->mv[j];
    /* Most plants send no read-back. */
    if (quality_usable(r->quality) || o->not_following || o->alarm)
        validate_readback_sent(s, j, r);
}

#endif
