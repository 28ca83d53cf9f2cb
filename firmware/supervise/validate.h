/* What is to be valid of a reading, and what stands in for it otherwise. Within supervise only. */
#ifndef REFLUX_SUPERVISE_VALIDATE_H
#define REFLUX_SUPERVISE_VALIDATE_H

#include "exchange/state.h"

/* i: a measurement of the plan in force. */
void validate_measurement(struct supervisor *s, uint8_t i, const struct reading *r);
/* j: a manipulated variable. r: what the plant says it does. */
void validate_readback_sent(struct supervisor *s, uint8_t j, const struct reading *r);
static inline void validate_readback(struct supervisor *s, uint8_t j, const struct reading *r)
{
    const struct mv_state *o = &s->mv[j];
    if (quality_usable(r->quality) || o->not_following || o->alarm)
        validate_readback_sent(s, j, r); /* most plants send none */
}

#endif
