#include "supervise/config.h"
#if COMMISSION_CHANNELS

#include "commission/parts.h"

void commission_back_to_old(struct commission *c, struct supervisor *s, enum commission_why why,
                            const char *subject, real_t value)
{
    commission_end(c, s, why, subject, value);
    adoption_put_back(&c->adoption, s, why == WHY_HAND);
    c->phase = COMMISSION_RETURNED;
    c->wants_old = true;
}

bool commission_trial_is_disturbed(struct commission *c, struct supervisor *s)
{
    const char *subject;
    if (s->plan->serial != c->plan_serial) {
        commission_end(c, s, WHY_CONFIG, NULL, REAL_C(0.0)); /* that one stays */
        return true;
    }
    enum commission_why why = s->safe_count != c->safe_count ? WHY_SAFE : WHY_NOT;
    if (why == WHY_NOT)
        why = commission_hindrance(c, s, &subject);
    int at = commission_at_end(c);
    if (why == WHY_NOT && at >= 0) {
        why = WHY_SPAN;
        subject = s->plan->config.measurement[c->measurement[at]].name;
    }
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
    if (commission_trial_is_disturbed(c, s))
        return;
    commission_age_origin(c, s);
    c->adoption.origin = &c->origin;
    enum err err = adoption_begin(&c->adoption, s, &c->work->analysis.work.after.rest);
    if (err) {
        commission_back_to_old(c, s, WHY_NUMBERS, NULL, (real_t)err);
        return;
    }
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
        [ADOPTION_SWINGS] = WHY_TRIAL_SWINGS,
        [ADOPTION_BLOCKED] = WHY_TRIAL_ROOM,
        [ADOPTION_HAND] = WHY_HAND,
        [ADOPTION_LEFT] = WHY_LEFT,
    };
    enum adoption_result r = adoption_tick(&c->adoption, s);
    if (r == ADOPTION_RUNNING)
        return;
    if (r == ADOPTION_PASSED) {
        c->phase = COMMISSION_KEPT;
        c->ended_ms = s->time_ms;
        event_put(c->events, s->time_ms, EVENT_TRIAL_KEPT, NULL, (float)c->adoption.n, 0);
        return;
    }
    const struct adoption *a = &c->adoption;
    const struct config *config = &s->plan->config;
    bool of_loop = a->culprit < a->n;
    const char *subject = of_loop ? config->loop[a->loop[a->culprit].loop].name
                                  : config->measurement[a->channel[a->culprit].measurement].name;
    commission_back_to_old(c, s, why[r], subject, of_loop ? a->loop[a->culprit].peak : REAL_C(0.0));
}

#endif
