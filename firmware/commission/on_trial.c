#include "supervise/config.h"
#if COMMISSION_CHANNELS

#include "commission/parts.h"

#include <string.h>

void commission_back_to_old(struct commission *c, struct supervisor *s, enum commission_why why,
                            const char *subject, real_t value)
{
    const struct adoption *a = &c->adoption;
    commission_end(c, s, why, subject, value);
    for (uint8_t k = 0; k < a->n + a->n_inner; k++) {
        uint8_t i = a->loop[k].loop, j = s->plan->loop[i].output;
        if (why == WHY_HAND && s->loop[i].mode == LOOP_MANUAL)
            continue;
        struct request r = {
            .kind = REQUEST_MODE, .loop = i, .output = PLAN_NONE, .mode = LOOP_MANUAL};
        supervisor_request(s, &r);
        if (j != PLAN_NONE)
            s->output[j].manual = num_from_float(a->loop[k].held);
    }
    c->phase = COMMISSION_RETURNED;
    c->wants_old = true;
}

/* What is not for the adoption to judge. True: the trial is over. */
static bool trial_is_disturbed(struct commission *c, struct supervisor *s)
{
    const char *subject;
    if (s->plan->serial != c->plan_serial) {
        commission_end(c, s, WHY_CONFIG, NULL, REAL_C(0.0)); /* that one stays */
        return true;
    }
    enum commission_why why = s->safe_count != c->safe_count ? WHY_SAFE : WHY_NOT;
    if (why == WHY_NOT)
        why = commission_hindrance(c, s, &subject);
    if (why == WHY_SAFE) {
        commission_end(c, s, WHY_SAFE, NULL, REAL_C(0.0));
        c->phase = COMMISSION_RETURNED;
        c->wants_old = true; /* what was not tried to the end is not kept */
        return true;
    }
    if (why != WHY_NOT)
        commission_back_to_old(c, s, why, subject, REAL_C(0.0));
    return why != WHY_NOT;
}

void commission_begin_trial(struct commission *c, struct supervisor *s)
{
    c->plan_serial = c->trial_serial;
    c->safe_count = s->safe_count;
    c->phase = COMMISSION_TRIAL;
    c->why = WHY_NOT;
    c->phase_ms = s->time_ms;
    if (s->plan->serial == c->plan_serial)
        adoption_hold(&c->adoption, s);
    if (trial_is_disturbed(c, s))
        return;
    adoption_begin(&c->adoption, s);
    event_put(c->events, s->time_ms, EVENT_TRIAL_BEGUN, NULL, (float)c->adoption.n, 0);
}

void commission_trial(struct commission *c, struct supervisor *s)
{
    static const enum commission_why why[] = {
        [ADOPTION_RUNNING] = WHY_NOT,
        [ADOPTION_PASSED] = WHY_NOT,
        [ADOPTION_PAST_LIMIT] = WHY_TRIAL_LIMIT,
        [ADOPTION_SLOW] = WHY_TRIAL_SLOW,
        [ADOPTION_OVERSHOOT] = WHY_TRIAL_PEAK,
        [ADOPTION_RESTLESS] = WHY_TRIAL_REST,
        [ADOPTION_NOT_AUTO] = WHY_HAND,
    };
    if (trial_is_disturbed(c, s))
        return;
    enum adoption_result r = adoption_tick(&c->adoption, s);
    if (r == ADOPTION_RUNNING)
        return;
    if (r == ADOPTION_PASSED) {
        c->phase = COMMISSION_KEPT;
        c->ended_ms = s->time_ms;
        event_put(c->events, s->time_ms, EVENT_TRIAL_KEPT, NULL, (float)c->adoption.n, 0);
        return;
    }
    const struct adoption_loop *l = &c->adoption.loop[c->adoption.culprit];
    commission_back_to_old(c, s, why[r], s->plan->config.loop[l->loop].name, l->peak);
}

#endif
