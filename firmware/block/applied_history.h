/* What really took effect of a manipulated variable, tick by tick: after limits, interlocks and read-back, whoever moved it.
 * One ring for each MV that a block asked for (block_kind.history), kept by the tick, read by every block that has to do
 * with the MV; so no regressor or predictor keeps its own.
 *
 * Fractions of the MV's span. A ring begins full, of the value that is there then: what is read is never rubbish, but it
 * says nothing of the time before. */
#ifndef REFLUX_BLOCK_APPLIED_HISTORY_H
#define REFLUX_BLOCK_APPLIED_HISTORY_H

#include <stdint.h>

#include "base/assertion.h"
#include "num/num.h"

struct applied_history {
    uint16_t depth;  /* base ticks, 1 and more */
    uint16_t newest; /* below depth */
    num_t value[];
};

/* Bytes of one that goes back so many ticks. */
static inline uint32_t applied_history_bytes(uint32_t depth)
{
    return (uint32_t)(sizeof(struct applied_history) + depth * sizeof(num_t));
}

/* It has always been `value`. */
static inline void applied_history_begin(struct applied_history *h, uint16_t depth, num_t value)
{
    h->depth = depth;
    h->newest = 0;
    for (uint16_t k = 0; k < depth; k++)
        h->value[k] = value;
}

static inline void applied_history_append(struct applied_history *h, num_t value)
{
    REFLUX_ASSERT(h->newest < h->depth);
    h->newest = (uint16_t)(h->newest + 1u < h->depth ? h->newest + 1u : 0);
    h->value[h->newest] = value;
}

/* What took effect `ticks` base ticks ago. 1: in the tick before the one that runs, the last that is known; 0 counts as 1, and
 * beyond the depth it is the oldest. */
static inline num_t applied_ticks_ago(const struct applied_history *h, uint32_t ticks)
{
    uint32_t back = ticks ? ticks - 1u : 0;
    if (back >= h->depth)
        back = h->depth - 1u;
    return h->value[h->newest >= back ? h->newest - back : h->newest + h->depth - back];
}

/* Base ticks that have to be kept for so many steps of `divisor` base ticks each. */
static inline uint32_t applied_history_ticks(uint32_t steps, uint16_t divisor)
{
    return steps ? 1u + (steps - 1u) * divisor : 0;
}

/* What took effect at the end of the step's interval `steps` steps ago, 1 being the one that ends now. A step has `divisor`
 * base ticks; where a rate or a valve moves the MV within them, this is where it had got to. */
static inline num_t applied_steps_ago(const struct applied_history *h, uint32_t steps,
                                      uint16_t divisor)
{
    return applied_ticks_ago(h, applied_history_ticks(steps ? steps : 1u, divisor));
}

#endif
