#include "kinds/composition/composition_analysis.h"

#include <string.h>

uint16_t composition_analysis_every(real_t h, real_t reach)
{
    real_t every = reach / (h * (real_t)(ANALYSIS_PAST - 1u));
    return every < REAL_C(60000.0) ? (uint16_t)(every + REAL_C(1.0)) : 60000u;
}

void composition_analysis_begin(struct composition_analysis *a, real_t h, real_t reach)
{
    memset(a->past, 0, sizeof a->past);
    a->at = a->filled = a->counted = 0;
    a->every = composition_analysis_every(h, reach);
    a->correction = a->surprise = a->age_s = REAL_C(0.0);
    a->seen = a->far = a->fresh = false;
}

static void remember(struct composition_analysis *a, real_t x)
{
    if (a->filled > 0 && ++a->counted < a->every)
        return;
    a->counted = 0;
    a->at = (uint16_t)((a->at + 1u) % ANALYSIS_PAST);
    a->past[a->at] = (float)x;
    if (a->filled < ANALYSIS_PAST)
        a->filled++;
}

/* The estimate so many seconds ago, by the nearest that is kept; false: none is. */
static bool recall(const struct composition_analysis *a, real_t h, real_t age_s, real_t *x)
{
    real_t steps = age_s / h - (real_t)a->counted, slots = steps / (real_t)a->every;
    if (slots < REAL_C(0.0))
        slots = REAL_C(0.0);
    if (!(slots + REAL_C(0.5) < (real_t)a->filled))
        return false;
    uint32_t back = (uint32_t)(slots + REAL_C(0.5));
    *x = a->past[(a->at + ANALYSIS_PAST - back) % ANALYSIS_PAST];
    return true;
}

bool composition_analysis_step(struct composition_analysis *a, real_t h, real_t x, bool usable,
                               real_t y, real_t age_s, real_t most)
{
    real_t then, left;
    remember(a, x);
    bool is_new = usable && (!a->seen || age_s < a->age_s + h / REAL_C(2.0));
    if (usable)
        a->age_s = age_s;
    a->seen = a->seen || usable;
    if (!is_new)
        return false;
    if (!recall(a, h, age_s, &then))
        return true;
    left = y - (then + a->correction);
    a->surprise = left;
    a->far = most > REAL_C(0.0) && real_abs(left) > most;
    a->fresh = !a->far && a->told;
    a->moved = x - then;
    if (!a->far && !a->told)
        a->correction += a->share * left;
    return false;
}
