#include "commission/experiment_check.h"

#include "identify/steady.h"
#include "lti/fopdt.h" /* real_is_finite */

#define WINDOW_MOST (1u << 20) /* samples; no sum of counts gets near the end of 32 bits */
#define HALF_MOST   (1u << 28)
#define BLANK_MOST  REAL_C(1e6) /* s, as the guard takes it */

static bool positive(real_t x)
{
    return x > REAL_C(0.0) && real_is_finite(x);
}

static bool not_negative(real_t x, real_t most)
{
    return x >= REAL_C(0.0) && x <= most;
}

enum err double_step_check(const struct experiment_config *c)
{
    if (c->outputs == 0 || c->outputs > CHANNEL_MAX || c->window < STEADY_BLOCKS ||
        c->window > WINDOW_MOST || c->half_most > HALF_MOST || c->half_most <= c->window ||
        c->half > c->half_most || c->half_least > c->half_most)
        return ERR_RANGE;
    if (!positive(c->amplitude_max) || !(c->amplitude >= REAL_C(0.0)) ||
        c->amplitude > c->amplitude_max || !positive(c->noise_multiple) ||
        (c->amplitude <= REAL_C(0.0) && !positive(c->amplitude_first)))
        return ERR_RANGE;
    if (!not_negative(c->blank_s, BLANK_MOST))
        return ERR_RANGE;
    for (unsigned j = 0; j < c->outputs; j++)
        if (!positive(c->limit[j]) || !not_negative(c->dead_time_s[j], BLANK_MOST))
            return ERR_RANGE;
    return ERR_OK;
}
