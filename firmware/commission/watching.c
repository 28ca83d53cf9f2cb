#include "commission/watching.h"

#include "commission/acceptance.h"
#include "commission/adoption.h"
#include "commission/blocking.h"
#include "commission/commission_state.h"
#include "commission/kept_watch_state.h"
#include "commission/lease.h"
#include "commission/start_stop.h"
#include "commission/status.h"
#include "commission/test_outputs.h"

#define HOUR_S REAL_C(3600.0)

static struct kept_watch *watch_of(const struct commission *c)
{
    return &c->work->analysis.work.after.watch;
}

void commission_set_watch(struct commission *c, uint32_t samples)
{
    watch_of(c)->length = samples;
}

bool commission_may_watch(const struct commission *c)
{
    return status_phase(&c->status) == COMMISSION_KEPT && lease_holds(&c->lease);
}

static float hours_so_far(const struct commission *c, const struct supervisor *s)
{
    return (float)(status_phase_s(&c->status, s->time_ms) / HOUR_S);
}

static const char *loop_name(const struct commission *c, const struct supervisor *s, uint8_t k)
{
    return s->plan->config.loop[adoption_loop(&c->adoption, k)->loop].name;
}

void commission_begin_watch(struct commission *c, struct supervisor *s)
{
    if (!outputs_plan_in_force(&c->outputs, s))
        return; /* the kept settings are no longer there */
    outputs_begin_trial(&c->outputs, s, s->plan->serial); /* safe states count from here */
    struct kept_watch *w = watch_of(c);
    kept_watch_begin(w, &c->adoption, s, w->length);
    status_watch(&c->status, s->time_ms);
    real_t hours = (real_t)w->length * s->plan->tick_s / HOUR_S;
    commission_say(c, s, EVENT_WATCH_BEGUN, NULL, (float)hours);
}

static void say_loops(const struct commission *c, const struct supervisor *s)
{
    for (uint8_t k = 0; k < adoption_loops(&c->adoption); k++) {
        const struct measurement_config *m =
            &s->plan->config.measurement[adoption_channel(&c->adoption, k)->measurement];
        float largest = (float)kept_watch_loop(watch_of(c), k)->largest;
        commission_say(c, s, EVENT_WATCH_LOOP, loop_name(c, s, k), largest * (m->hi - m->lo));
    }
}

static void leave_watch(struct commission *c, const struct supervisor *s, enum event_code code,
                        enum commission_reason reason, const char *subject)
{
    event_put(status_events(&c->status), s->time_ms, code, subject, hours_so_far(c, s),
              (uint8_t)reason);
    status_watched(&c->status, reason, subject);
}

void commission_end_watch(struct commission *c, struct supervisor *s, enum commission_reason reason,
                          const char *subject)
{
    leave_watch(c, s, EVENT_WATCH_ENDED, reason, subject);
}

/* A loop has gone wrong: the old settings return where the outputs of that time would hold the plant, else they stay. */
static void act_on_sign(struct commission *c, struct supervisor *s, enum commission_reason reason,
                        const char *subject)
{
    if (kept_watch_is_near(watch_of(c), &c->adoption, s))
        commission_back_to_old(c, s, reason, subject, REAL_C(0.0));
    else
        leave_watch(c, s, EVENT_WATCH_SIGN, reason, subject);
}

void commission_watch(struct commission *c, struct supervisor *s)
{
    static const enum commission_reason reason[] = {
        [KEPT_FINE] = REASON_NOT,
        [KEPT_OVER] = REASON_NOT,
        [KEPT_PAST_LIMIT] = REASON_WATCH_LIMIT,
        [KEPT_SWINGS] = REASON_WATCH_SWINGS,
        [KEPT_STUCK] = REASON_WATCH_STUCK,
        [KEPT_IN_MANUAL] = REASON_WATCH_MANUAL,
        [KEPT_HAND] = REASON_HAND,
    };
    enum commission_reason interruption = commission_interruption(c, s);
    if (interruption != REASON_NOT) {
        commission_end_watch(c, s, interruption, NULL);
        return;
    }
    enum kept_sign sign = kept_watch_tick(watch_of(c), &c->adoption, s);
    if (sign == KEPT_FINE)
        return;
    const char *subject = sign == KEPT_OVER ? NULL : loop_name(c, s, watch_of(c)->culprit);
    say_loops(c, s);
    if (sign == KEPT_OVER || sign == KEPT_HAND)
        commission_end_watch(c, s, reason[sign], subject);
    else
        act_on_sign(c, s, reason[sign], subject);
}
