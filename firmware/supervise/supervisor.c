/* Requests, channels, and calls to the tick from outside. The tick itself is in tick.c, plans are in activate.c. */
#include "supervise/supervisor.h"

#include <string.h>

#include "exchange/block_work.h"

#include "supervise/alarms.h"
#include "supervise/histories.h"
#include "supervise/latch.h"
#include "supervise/loop_request.h"
#include "supervise/numbered_control.h"
#include "supervise/numbered_switch.h"
#include "supervise/sequence.h"
#include "supervise/verbs.h"

void supervisor_init(struct supervisor *s, struct event_queue *events)
{
    memset(s, 0, sizeof *s);
    s->events = events;
    s->state = SUPERVISOR_SAFE;
    for (unsigned b = 0; b < PLAN_BLOCKS; b++)
        s->block[b].kind = PLAN_NONE;
    block_work_init(s);
}

void supervisor_tell_plan(struct supervisor *s)
{
    event_put(s->events, s->time_ms, EVENT_CONFIG_APPLIED, NULL, s->plan->tick_s, 0);
}

void supervisor_unbind(struct supervisor *s)
{
    for (unsigned i = 0; i < s->placed[PLACED_MEASUREMENTS]; i++)
        s->measurement[i].bound = false;
    for (unsigned j = 0; j < s->placed[PLACED_MVS]; j++)
        s->mv[j].bound = false;
}

void supervisor_bind_measurement(struct supervisor *s, uint8_t index)
{
    s->measurement[index].bound = true;
}

void supervisor_bind_mv(struct supervisor *s, uint8_t index)
{
    s->mv[index].bound = true;
}

void supervisor_unbind_mv(struct supervisor *s, uint8_t index)
{
    s->mv[index].bound = false;
}

void supervisor_go_safe(struct supervisor *s, const char *reason)
{
    for (unsigned i = 0; i < s->placed[PLACED_MEASUREMENTS]; i++) {
        /* The next readings may come from another plant, or hours later: filters begin anew. */
        s->measurement[i].seen = s->measurement[i].valid = s->measurement[i].delivered = false;
        s->measurement[i].quality = QUALITY_MISSING;
    }
    for (unsigned i = 0; i < CONFIG_FEEDFORWARDS; i++)
        s->block[BLOCK_FEEDFORWARDS + i].running = false;
    numbered_forget(s);
    supervisor_outputs_safe(s, reason);
    histories_begin(s);
}

void supervisor_excite(struct supervisor *s, uint8_t j, num_t fraction)
{
    if (j < s->placed[PLACED_MVS]) /* another plan may have removed the output */
        s->mv[j].excitation = fraction;
}

bool supervisor_request(struct supervisor *s, const struct request *r)
{
    if (r->plan != s->plan->serial) { /* another loop or output may be in that place */
        event_put(s->events, s->time_ms, EVENT_REQUEST_REFUSED, "plan", r->value, 0);
        return false;
    }
    if (r->kind <= REQUEST_OUTPUT)
        return loop_request(s, r);
    if (r->kind == REQUEST_ACK || r->kind == REQUEST_SHELVE)
        alarms_request(s, r);
    else if (CONFIG_LOOP_GUARD && r->kind == REQUEST_RELEASE)
        latch_release(s, r);
    else if (CONFIG_STEPS && r->kind == REQUEST_SEQUENCE)
        sequence_request(s, r);
    else if (CONFIG_BLOCKS && r->kind == REQUEST_BLOCK &&
             numbered_switch(s, r->output, r->mode != 0))
        return true;
    else if (CONFIG_BLOCKS && r->kind == REQUEST_VERB && verb_exists(s, r))
        return verb_run(s, r);
    else
        event_put(s->events, s->time_ms, EVENT_REQUEST_REFUSED, NULL, r->value, 0);
    return false;
}
