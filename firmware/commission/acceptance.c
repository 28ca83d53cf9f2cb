#include "commission/acceptance.h"

#include "commission/adoption.h"
#include "commission/blocking.h"
#include "commission/commission_state.h"
#include "commission/requests.h"
#include "commission/start_stop.h"
#include "commission/status.h"
#include "commission/test_outputs.h"

#include <string.h>

void commission_back_to_old(struct commission *c, struct supervisor *s,
                            enum commission_reason reason, const char *subject, real_t value)
{
    commission_end(c, s, reason, subject, value);
    adoption_put_back(&c->adoption, s, reason == REASON_HAND);
    status_returned(&c->status);
    requests_set_want_old(&c->requests, true);
}

bool commission_acceptance_is_disturbed(struct commission *c, struct supervisor *s)
{
    const char *subject = NULL;
    enum commission_reason reason = commission_interruption(c, s);
    if (reason == REASON_CONFIG) {
        commission_end(c, s, REASON_CONFIG, NULL, REAL_C(0.0)); /* that one stays */
        return true;
    }
    if (reason == REASON_NOT)
        reason = blocking_reason(c, s, &subject);
    int end = outputs_at_end(&c->outputs);
    if (reason == REASON_NOT && end >= 0) {
        reason = REASON_SPAN;
        subject = outputs_name(&c->outputs, s, (uint8_t)end);
    }
    if (reason == REASON_SAFE) {
        commission_end(c, s, REASON_SAFE, NULL, REAL_C(0.0));
        status_returned(&c->status);
        requests_set_want_old(&c->requests, true); /* an unfinished trial keeps nothing */
        return true;
    }
    if (reason != REASON_NOT)
        commission_back_to_old(c, s, reason, subject, REAL_C(0.0));
    return reason != REASON_NOT;
}

void commission_begin_trial(struct commission *c, struct supervisor *s)
{
    outputs_begin_trial(&c->outputs, s, requests_trial_serial(&c->requests));
    status_enter_trial(&c->status, s->time_ms);
    if (outputs_plan_in_force(&c->outputs, s))
        adoption_hold(&c->adoption, s);
    if (commission_acceptance_is_disturbed(c, s))
        return;
    outputs_age_origin(&c->outputs, &c->origin, s);
    enum err err = adoption_begin(&c->adoption, s, &c->origin, &c->work->analysis.work.after.rest);
    if (err) {
        commission_back_to_old(c, s, REASON_NUMBERS, NULL, (real_t)err);
        return;
    }
    commission_say(c, s, EVENT_TRIAL_BEGUN, NULL, (float)adoption_loops(&c->adoption));
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
        [ADOPTION_MARGIN] = REASON_TRIAL_MARGIN,
        [ADOPTION_HAND] = REASON_HAND,
        [ADOPTION_LEFT] = REASON_LEFT,
    };
    enum adoption_result r = adoption_tick(&c->adoption, s);
    if (r == ADOPTION_RUNNING)
        return;
    if (r == ADOPTION_PASSED) {
        memset(&c->work->analysis.work.after.watch, 0, sizeof c->work->analysis.work.after.watch);
        status_kept(&c->status, s->time_ms);
        commission_say(c, s, EVENT_TRIAL_KEPT, NULL, (float)adoption_loops(&c->adoption));
        return;
    }
    real_t peak;
    const char *subject = adoption_culprit(&c->adoption, &s->plan->config, &peak);
    commission_back_to_old(c, s, reason[r], subject, peak);
}
