#include "supervise/outputs_safe.h"

#include <string.h>

#include "exchange/span.h"
#include "supervise/block_excitation.h"
#include "supervise/by_board.h"

/* Copies the reason, because it may be a name in a plan that is overwritten later. */
static void keep_reason(struct supervisor *s, const char *reason)
{
    strncpy(s->safe_reason, reason, sizeof s->safe_reason - 1);
}

void outputs_take_safe(struct supervisor *s, const char *reason)
{
    excitation_end(s, EXCITE_SAFE);
    for (unsigned i = 0; i < s->placed[PLACED_LOOPS]; i++) {
        if (CONFIG_LOOP_GUARD && loop_acts(s, (uint8_t)i))
            by_board_begin(s, (uint8_t)i, BY_BOARD_SAFE);
        s->loop[i].mode = LOOP_MANUAL;
    }
    for (unsigned j = 0; j < s->placed[PLACED_MVS]; j++) {
        struct mv_state *o = &s->mv[j];
        const struct mv_config *c = &s->plan->config.mv[j];
        if (!c->name[0])
            continue;
        o->manual = span_to_fraction(c->safe, c->lo, c->hi);
        o->commanded = o->constrained = o->applied = o->manual;
        o->excitation = num_zero();
        o->sent = false;
        o->interlocked = o->beyond = false; /* until the next tick finds it so */
        o->not_following = o->alarm = false;
    }
    if (s->state != SUPERVISOR_SAFE)
        event_put(s->events, s->time_ms, EVENT_SAFE_STATE, reason, 0.0f, 0);
    if (s->state != SUPERVISOR_SAFE)
        keep_reason(s, reason);
    s->state = SUPERVISOR_SAFE;
    s->safe_count++;
}
