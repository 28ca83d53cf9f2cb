/* The values of an MV that really took effect, tick by tick: after limits, interlocks and read-back, whoever moved
 * the MV. The tick keeps one ring for each MV that a block asked for (block_kind.history), and every block that
 * uses the MV reads this ring. So no regressor or predictor keeps a ring of its own.
 *
 * Values are fractions of the MV's span. A new ring is filled with the value that the MV has then. So a reader
 * never gets rubbish, but these values say nothing about the time before. */
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

/* Returns the bytes of a ring of `depth` base ticks. */
static inline uint32_t applied_history_bytes(uint32_t depth)
{
    return (uint32_t)(sizeof(struct applied_history) + depth * sizeof(num_t));
}

/* Fills the ring with `value`, as if the MV had always had it. */
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

/* Returns what took effect `ticks` base ticks ago. The value for 1 is the one of the tick before the tick that
 * runs, which is the newest known; 0 counts as 1. Beyond the depth the function returns the oldest value. */
static inline num_t applied_ticks_ago(const struct applied_history *h, uint32_t ticks)
{
    uint32_t back = ticks ? ticks - 1u : 0;
    if (back >= h->depth)
        back = h->depth - 1u;
    return h->value[h->newest >= back ? h->newest - back : h->newest + h->depth - back];
}

/* Returns the base ticks to keep for `steps` steps of `divisor` base ticks each. */
static inline uint32_t applied_history_ticks(uint32_t steps, uint16_t divisor)
{
    return steps ? 1u + (steps - 1u) * divisor : 0;
}

/* Returns what took effect at the end of a step's interval, `steps` steps ago; 1 is the interval that ends now. A
 * step has `divisor` base ticks. Where a rate limit or a valve moves the MV within a step, this is the value the MV
 * had reached by its end. */
static inline num_t applied_steps_ago(const struct applied_history *h, uint32_t steps,
                                      uint16_t divisor)
{
    return applied_ticks_ago(h, applied_history_ticks(steps ? steps : 1u, divisor));
}

#endif
