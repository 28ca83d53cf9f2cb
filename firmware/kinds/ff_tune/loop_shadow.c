#include "kinds/ff_tune/loop_shadow.h"

#include <string.h>

#include "base/assertion.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* A shadow beyond so many spans is lost. */
#define LOST REAL_C(8.0)

void shadow_begin(struct loop_shadow *s, const struct fopdt *m, real_t gain, real_t ti_s,
                  real_t h_s)
{
    memset(s, 0, sizeof *s);
    s->decay = m->time_constant_s > ZERO ? real_exp(-h_s / m->time_constant_s) : ZERO;
    s->share = m->gain * (ONE - s->decay);
    s->gain = gain;
    s->integral_share = ti_s > ZERO ? gain * h_s / ti_s : ZERO;
    /* A held input is late by half a sample, which the fit has counted as dead time. */
    real_t samples = m->dead_time_s / h_s - REAL_C(0.5);
    samples = samples < ZERO ? ZERO : samples;
    samples = samples > (real_t)(SHADOW_REACH - 2u) ? (real_t)(SHADOW_REACH - 2u) : samples;
    s->dead = (uint8_t)samples;
    s->fraction = samples - (real_t)s->dead;
}

real_t shadow_step(struct loop_shadow *s, real_t v)
{
    REFLUX_ASSERT(s->dead + 1u < SHADOW_REACH);
    real_t y = s->x;
    if (s->lost)
        return ZERO;
    memmove(s->u + 1, s->u, (SHADOW_REACH - 1u) * sizeof s->u[0]);
    s->u[0] = v - s->gain * y + s->integral;
    s->integral -= s->integral_share * y;
    s->x = s->decay * s->x +
           s->share * (s->u[s->dead] + s->fraction * (s->u[s->dead + 1u] - s->u[s->dead]));
    s->lost = !real_within(s->x, -LOST, LOST);
    return y;
}

bool shadow_is_lost(const struct loop_shadow *s)
{
    return s->lost;
}
