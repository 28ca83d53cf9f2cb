/* Selects the readings of an analyser (exchange/sampling.h) that the tick looks at. */
#ifndef REFLUX_SUPERVISE_SAMPLING_H
#define REFLUX_SUPERVISE_SAMPLING_H

#include "exchange/sampling.h"

#if CONFIG_ANALYSERS
bool sampling_is_due(struct supervisor *s, uint8_t i);
/* Returns true if the tick, whose time is already set, looks at a reading: the first of its turn, and each one as
 * long as none of the turn is valid. */
static inline bool sampling_due(struct supervisor *s, uint8_t i, const struct measurement_config *c)
{
    return sampling_every(c) <= 1 || sampling_is_due(s, i);
}
/* Reports loops whose divisor is no multiple of their measurement's `every`, if that was not so in the plan before. */
void sampling_tell(struct supervisor *s, const struct plan *old);
#else
#define sampling_due(s, i, c) true
#define sampling_tell(s, old) ((void)(old))
#endif

#endif
