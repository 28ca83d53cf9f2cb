/* A raised gain of one loop's own controller, for a while: the margin probe of start-up. */
#ifndef REFLUX_SUPERVISE_RAISE_GAIN_H
#define REFLUX_SUPERVISE_RAISE_GAIN_H

#include "exchange/block_setup.h"
#include "exchange/state.h"

#if COMMISSION_CHANNELS

/* Multiplies the gain of loop i's own controller by factor, without a bump, from the step after the next one on; the integral time
 * stays. The plan's gain returns in the same way with PLAN_NONE, and at once with the next plan. One loop at a time has a raised gain.
 * The product must be a valid gain of the controller. Tick. */
void supervisor_raise_gain(struct supervisor *s, uint8_t i, float factor);
/* Raises the gain in the setup of that loop's own controller. */
void raised_gain_take(const struct supervisor *s, uint8_t block, struct block_instance *b);

#else
static inline void supervisor_raise_gain(struct supervisor *s, uint8_t i, float factor)
{
    (void)s;
    (void)i;
    (void)factor;
}
static inline void raised_gain_take(const struct supervisor *s, uint8_t block,
                                    struct block_instance *b)
{
    (void)s;
    (void)block;
    (void)b;
}
#endif

#endif
