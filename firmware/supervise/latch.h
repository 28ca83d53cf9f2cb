/* The latch of an interlock (lockN.latch): the interlock holds until an operator releases it, which is possible when its condition is over. Within
 * supervise only. */
#ifndef REFLUX_SUPERVISE_LATCH_H
#define REFLUX_SUPERVISE_LATCH_H

#include "exchange/state.h"

#if CONFIG_LOOP_GUARD
/* Returns whether interlock k holds from this tick on. active: it does without a latch. */
static inline bool latch_holds(struct supervisor *s, uint8_t k, bool active)
{
    struct interlock_state *state = &s->interlock[k];
    state->latch.alone = !active && state->active && s->plan->config.interlock[k].latch.on;
    return active || state->latch.alone;
}
/* Carries out a REQUEST_RELEASE. */
static inline void latch_release(struct supervisor *s, const struct request *r)
{
    uint8_t k = r->output;
    if (k >= s->placed[PLACED_INTERLOCKS] || !s->interlock[k].latch.alone) {
        event_put(s->events, s->time_ms, EVENT_REQUEST_REFUSED, "release", 0.0f, 0);
        return;
    }
    s->interlock[k].active = s->interlock[k].latch.alone = false;
    event_put(s->events, s->time_ms, EVENT_INTERLOCK_OFF, s->plan->config.interlock[k].mv,
              s->measurement[s->plan->interlock[k].measurement].raw, k);
}
#else
#define latch_holds(s, k, active) (active)
#define latch_release(s, r)       ((void)0)
#endif

#endif
