#include "exchange/config.h"

#include "commission/commission_internal.h"

void commission_back_to_old(struct commission *c, struct supervisor *s,
                            enum commission_reason reason, const char *subject, real_t value)
{
    commission_end(c, s, reason, subject, value);
    adoption_put_back(&c->adoption, s, reason == REASON_HAND);
    c->phase = COMMISSION_RETURNED;
    c->wants_old = true;
}

bool commission_acceptance_is_disturbed(struct commission *c, struct supervisor *s)
{
    const char *subject;
    if (s->plan->serial != c->plan_serial) {
        commission_end(c, s, REASON_CONFIG, NULL, REAL_C(0.0)); /* that one stays */
        return true;
    }
    enum commission_reason reason = s->safe_count != c->safe_count ? REASON_SAFE : REASON_NOT;
    if (reason == REASON_NOT)
        reason = commission_hindrance(c, s, &subject);
    int at = commission_at_end(c);
    if (reason == REASON_NOT && at >= 0) {
        reason = REASON_SPAN;
        subject = s->plan->config.measurement[c->measurement[at]].name;
    }
    if (reason == REASON_SAFE) {
        commission_end(c, s, REASON_SAFE, NULL, REAL_C(0.0));
        c->phase = COMMISSION_RETURNED;
        c->wants_old = true; /* what was not tried to the end is not kept */
        return true;
    }
    if (reason != REASON_NOT)
        commission_back_to_old(c, s, reason, subject, REAL_C(0.0));
    return reason != REASON_NOT;
}

void commission_begin_trial(struct commission *c, struct supervisor *s)
{
    c->plan_serial = c->trial_serial;
    c->safe_count = s->safe_count;
    c->phase = COMMISSION_TRIAL;
    c->reason = REASON_NOT;
    c->phase_ms = s->time_ms;
    if (s->plan->serial == c->plan_serial)
        adoption_hold(&c->adoption, s);
    if (commission_acceptance_is_disturbed(c, s))
        return;
    commission_age_origin(c, s);
    c->adoption.origin = &c->origin;
    enum err err = adoption_begin(&c->adoption, s, &c->work->analysis.work.after.rest);
    if (err) {
        commission_back_to_old(c, s, REASON_NUMBERS, NULL, (real_t)err);
        return;
    }
    event_put(c->events, s->time_ms, EVENT_TRIAL_BEGUN, NULL, (float)c->adoption.n, 0);
}

void commission_acceptance(struct commission *c, struct supervisor *s)
{
    static const enum commission_reason reason[] = {
        [ADOPTION_RUNNING] = REASON_NOT,
        [ADOPTION_PASSED] = REASON_NOT,
        [ADOPTION_PAST_LIMIT] = REASON_TRIAL_LIMIT,
        [ADOPTION_SLOW] = REASON_TRIAL_SLOW,
        [ADOPTION_OVERSHOOT] = REASON_TRIAL_PEAK,
        [ADOPTION_RESTLESS] = REASON_TRIAL_REST,
        [ADOPTION_SWINGS] = REASON_TRIAL_SWINGS,
        [ADOPTION_BLOCKED] = REASON_TRIAL_ROOM,
        [ADOPTION_HAND] = REASON_HAND,
        [ADOPTION_LEFT] = REASON_LEFT,
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
    commission_back_to_old(c, s, reason[r], subject,
                           of_loop ? a->loop[a->culprit].peak : REAL_C(0.0));
}
