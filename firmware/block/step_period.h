/* The step period of a kind that does not run in every base tick. */
#ifndef REFLUX_BLOCK_STEP_PERIOD_H
#define REFLUX_BLOCK_STEP_PERIOD_H

#include "block/refuse.h"

/* Returns the period in base ticks, as it is set; period_s = 0 gives one. */
static inline float step_period_ticks(float period_s, float interval_s)
{
    return period_s > 0 ? period_s / interval_s : 1;
}

/* Returns the nearest whole number of base ticks; ticks: 0 to 4e9. */
static inline uint32_t step_period_rounded(float ticks)
{
    return (uint32_t)(ticks + 0.5f);
}

/* Returns true within a thousandth of a whole number, because decimal seconds are not exact. ticks: as for
 * step_period_rounded. */
static inline bool step_period_is_whole(float ticks)
{
    float away = ticks - (float)step_period_rounded(ticks);
    return away <= 1e-3f * ticks && away >= -1e-3f * ticks;
}

/* Checks the parameter `period` of a kind that takes a step at least every 10000 base ticks. On ERR_RANGE *fault
 * says what it must be. */
MUST_CHECK enum err step_period_check(float ticks, struct block_fault *fault);

#endif
