#include "supervise/sequence.h"
#include "supervise/sequence_act.h"

#include <string.h>

#include "exchange/sequence_rows.h"
#include "exchange/span.h"
#include "supervise/outputs_safe.h"

/* An output this near to the value of a row counts as having reached it, fraction of span. */
#define THERE 0.001f

static const struct step_config *row_of(const struct supervisor *s, uint8_t k)
{
    return &s->plan->config.step[k];
}

static void tell_sequence(struct supervisor *s, enum event_code code, const char *subject)
{
    const struct sequence *q = &s->sequence;
    event_put(s->events, s->time_ms, code, subject, (float)(q->step + 1u),
              sequence_detail(q->kind, q->reason));
}

static void stop_at(struct supervisor *s, enum sequence_state state, enum sequence_reason reason,
                    const char *about)
{
    struct sequence *q = &s->sequence;
    q->state = (uint8_t)state;
    q->reason = (uint8_t)reason;
    strncpy(q->about, about, sizeof q->about - 1);
    tell_sequence(s, state == SEQUENCE_HELD ? EVENT_SEQUENCE_HELD : EVENT_SEQUENCE_ABORTED, about);
}

static void hold(struct supervisor *s, enum sequence_reason reason, const char *about)
{
    stop_at(s, SEQUENCE_HELD, reason, about);
}

static void abort_now(struct supervisor *s, enum sequence_reason reason, const char *about)
{
    stop_at(s, SEQUENCE_ABORTED, reason, about); /* first, so that the safe state finds it ended */
    outputs_take_safe(s, "sequence");
}

void sequence_safe(struct supervisor *s, const char *reason)
{
    if (sequence_active(&s->sequence))
        stop_at(s, SEQUENCE_ABORTED, SEQUENCE_SAFE, reason);
}

void sequence_interrupted(struct supervisor *s, uint8_t kind, uint8_t step)
{
    /* Somebody has started another one already. */
    if (sequence_active(&s->sequence) || step >= CONFIG_STEPS)
        return;
    s->sequence.kind = kind;
    s->sequence.step = step;
    stop_at(s, SEQUENCE_ABORTED, SEQUENCE_RESTART, "");
}

void sequence_place(struct supervisor *s, const struct plan *old)
{
    if (sequence_active(&s->sequence) && sequence_differs(s->plan, old))
        abort_now(s, SEQUENCE_CONFIGURATION, "");
}

/* ---- guards and outputs ---- */

static bool condition_is_met(const struct step_config *c, float value)
{
    return c->until == STEP_ABOVE ? value > c->limit : value < c->limit;
}

/* Only a valid reading on the right side keeps a guard. */
static void run_guards(struct supervisor *s, uint32_t passed_ms)
{
    struct sequence *q = &s->sequence;
    for (uint8_t k = 0; k < CONFIG_STEPS && sequence_active(q); k++) {
        const struct step_config *c = row_of(s, k);
        float value;
        if (!(q->guards & UINT32_C(1) << k))
            continue;
        if (sequence_reading(s, s->plan->step[k].measurement, &value) &&
            condition_is_met(c, value)) {
            q->violated_ms[k] = 0;
            continue;
        }
        uint32_t limit_ms = c->wait_s * UINT32_C(1000);
        q->violated_ms[k] += q->violated_ms[k] < limit_ms ? passed_ms : 0;
        if (q->violated_ms[k] < limit_ms)
            continue;
        if (c->otherwise == STEP_ABORT)
            abort_now(s, SEQUENCE_BY_GUARD, c->measurement);
        else if (q->state != SEQUENCE_HELD || q->reason != SEQUENCE_BY_GUARD)
            hold(s, SEQUENCE_BY_GUARD, c->measurement);
    }
}

/* Returns true if an interlock keeps output j away from the value of the last row that moved it. */
static bool kept_away(const struct supervisor *s, uint8_t j)
{
    const struct sequence *q = &s->sequence;
    const struct mv_state *o = &s->mv[j];
    const struct mv_config *c = &s->plan->config.mv[j];
    num_t wanted = o->constrained;
    for (uint8_t k = 0; k <= q->step; k++)
        if (row_of(s, k)->sequence == q->kind && row_of(s, k)->action == STEP_OUT &&
            s->plan->step[k].what == j && (k < q->step || q->acted))
            wanted = span_to_fraction(row_of(s, k)->value, c->lo, c->hi);
    return o->interlocked &&
           num_lt(num_from_float(THERE), num_abs(num_sub(wanted, o->constrained)));
}

/* Holds the sequence if the loops and outputs that its rows have set do not stay so. */
static void watch(struct supervisor *s)
{
    const struct sequence *q = &s->sequence;
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++) {
        if (!(q->working & 1u << i))
            continue;
        uint8_t j = s->plan->loop[i].mv;
        const char *name = s->plan->config.loop[i].name;
        if (s->loop[i].mode == LOOP_MANUAL)
            hold(s, SEQUENCE_LOOP, name);
        else if (j != PLAN_NONE && s->mv[j].interlocked)
            hold(s, SEQUENCE_INTERLOCK, s->plan->config.mv[j].name);
        else if (j != PLAN_NONE && s->mv[j].alarm)
            hold(s, SEQUENCE_NOT_FOLLOWING, s->plan->config.mv[j].name);
        if (q->state == SEQUENCE_HELD)
            return;
    }
    for (uint8_t j = 0; j < CHANNEL_MAX; j++) {
        if (!(q->driven & 1u << j))
            continue;
        const char *name = s->plan->config.mv[j].name;
        if (kept_away(s, j))
            hold(s, SEQUENCE_INTERLOCK, name);
        else if (s->mv[j].alarm)
            hold(s, SEQUENCE_NOT_FOLLOWING, name);
        if (q->state == SEQUENCE_HELD)
            return;
    }
    uint8_t i = s->plan->step[q->step].measurement;
    if (i == PLAN_NONE || row_of(s, q->step)->action == STEP_GUARD)
        return;
    if (!s->measurement[i].bound || s->measurement[i].lost)
        hold(s, SEQUENCE_NO_READING, row_of(s, q->step)->measurement);
}

/* ---- the condition of a step ---- */

static void forget_condition(struct sequence *q)
{
    q->met_ms = 0;
    q->window = false;
}

/* Returns true if the reading meets the condition so far. */
static bool meets(struct sequence *q, const struct step_config *c, float value)
{
    if (c->until != STEP_STEADY)
        return condition_is_met(c, value);
    if (!q->window)
        q->lo = q->hi = value;
    q->lo = value < q->lo ? value : q->lo;
    q->hi = value > q->hi ? value : q->hi;
    if (q->hi - q->lo > c->limit) { /* the count begins anew */
        q->lo = q->hi = value;
        forget_condition(q);
    }
    return true;
}

/* Counts only the time between valid readings, a base tick at most for each. */
static bool reading_meets(struct supervisor *s, const struct step_config *c, uint32_t passed_ms)
{
    struct sequence *q = &s->sequence;
    uint8_t i = s->plan->step[q->step].measurement;
    uint32_t most_ms = (uint32_t)(s->plan->tick_s * 1000.0f);
    float value;
    if (!sequence_reading(s, i, &value)) {
        if (s->measurement[i].lost)
            forget_condition(q);
        return false;
    }
    if (!meets(q, c, value)) {
        forget_condition(q);
        return false;
    }
    if (q->window)
        q->met_ms += passed_ms < most_ms ? passed_ms : most_ms;
    q->window = true;
    return q->met_ms >= c->wait_s * UINT32_C(1000);
}

static bool condition(struct supervisor *s, uint32_t passed_ms)
{
    struct sequence *q = &s->sequence;
    const struct step_config *c = row_of(s, q->step);
    if (c->action == STEP_GUARD || c->until == STEP_AT_ONCE)
        return true;
    if (c->until == STEP_CONFIRM)
        return q->confirmed;
    if (c->until != STEP_TIME)
        return reading_meets(s, c, passed_ms);
    q->met_ms += passed_ms;
    return q->met_ms >= c->wait_s * UINT32_C(1000);
}

/* ---- from row to row ---- */

/* Begins the row, or begins it again. */
static void enter(struct sequence *q, uint8_t step)
{
    q->state = SEQUENCE_RUNNING;
    q->step = step;
    q->acted = q->confirmed = false;
    q->elapsed_ms = 0;
    forget_condition(q);
}

static void next(struct supervisor *s)
{
    struct sequence *q = &s->sequence;
    uint8_t step = sequence_next(&s->plan->config, (enum sequence_kind)q->kind, q->step);
    if (step != PLAN_NONE) {
        enter(q, step);
        return;
    }
    q->state = SEQUENCE_DONE;
    q->reason = SEQUENCE_OPERATOR;
    tell_sequence(s, EVENT_SEQUENCE_DONE, sequence_kind_text(q->kind));
}

static void begin_row(struct supervisor *s)
{
    struct sequence *q = &s->sequence;
    const struct step_config *c = row_of(s, q->step);
    bool waits = c->action != STEP_GUARD && c->until != STEP_AT_ONCE;
    if (!sequence_act(s, q->step)) {
        hold(s, SEQUENCE_REFUSED, c->what);
        return;
    }
    q->acted = true;
    if (waits)
        tell_sequence(s, EVENT_SEQUENCE_STEP, sequence_kind_text(q->kind));
    if (c->until == STEP_CONFIRM)
        q->state = SEQUENCE_CONFIRM;
    /* The guard counts from the first tick on, without grace. */
    if (c->action == STEP_GUARD && c->wait_s == 0)
        run_guards(s, 0);
}

static bool goes(const struct sequence *q)
{
    return q->state == SEQUENCE_RUNNING || q->state == SEQUENCE_CONFIRM;
}

static void run_rows(struct supervisor *s, uint32_t passed_ms)
{
    struct sequence *q = &s->sequence;
    for (unsigned n = 0; n <= CONFIG_STEPS && goes(q); n++) {
        if (!q->acted) {
            begin_row(s);
            passed_ms = 0; /* its clocks begin now */
        }
        if (!goes(q) || !condition(s, passed_ms))
            return;
        next(s);
    }
}

static void run_timeout(struct supervisor *s)
{
    struct sequence *q = &s->sequence;
    const struct step_config *c = row_of(s, q->step);
    const char *about = c->until == STEP_CONFIRM || c->until == STEP_TIME ? "" : c->measurement;
    if (!c->timeout_s || q->elapsed_ms < c->timeout_s * UINT32_C(1000))
        return;
    bool held = q->state == SEQUENCE_HELD;
    if (held && (c->otherwise != STEP_ABORT))
        return; /* the reason that holds it is stronger */
    q->reason = SEQUENCE_TIMEOUT;
    tell_sequence(s, EVENT_SEQUENCE_TIMEOUT, about);
    if (c->otherwise == STEP_ABORT)
        abort_now(s, SEQUENCE_TIMEOUT, about);
    else if (c->otherwise == STEP_HOLD)
        hold(s, SEQUENCE_TIMEOUT, about);
    else
        next(s);
}

void sequence_run(struct supervisor *s)
{
    struct sequence *q = &s->sequence;
    uint64_t passed = s->time_ms > q->last_ms ? s->time_ms - q->last_ms : 0;
    uint32_t passed_ms = passed < 1000000000u ? (uint32_t)passed : 1000000000u;
    q->last_ms = s->time_ms;
    if (!sequence_active(q))
        return;
    run_guards(s, passed_ms);
    if (goes(q))
        watch(s);
    bool by_person = q->state == SEQUENCE_HELD &&
                     (q->reason == SEQUENCE_OPERATOR || q->reason == SEQUENCE_TIMEOUT);
    if (!by_person && (q->acted || q->state == SEQUENCE_HELD))
        q->elapsed_ms += q->elapsed_ms < 1000000000u ? passed_ms : 0;
    run_rows(s, passed_ms);
    if (sequence_active(q) && !by_person)
        run_timeout(s);
}

/* ---- commands of operators ---- */

static bool anything_acts(const struct supervisor *s)
{
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        if (s->plan->loop[i].used && s->loop[i].mode != LOOP_MANUAL)
            return true;
    return false;
}

static bool begin(struct supervisor *s, enum sequence_kind kind)
{
    struct sequence *q = &s->sequence;
    uint8_t first = sequence_next(&s->plan->config, kind, -1);
    bool starts = kind == SEQUENCE_START;
    if (first == PLAN_NONE || s->testing ||
        (sequence_active(q) && (starts || q->kind == SEQUENCE_STOP)) ||
        (starts && anything_acts(s)))
        return false;
    memset(q, 0, sizeof *q);
    q->kind = (uint8_t)kind;
    q->last_ms = s->time_ms;
    enter(q, first);
    return true;
}

/* Continues a sequence that an operator has looked at and allowed again. A row that was only interrupted continues
 * where it was. */
static void go_on(struct supervisor *s)
{
    struct sequence *q = &s->sequence;
    bool again = q->reason != SEQUENCE_OPERATOR;
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        if (supervisor_mode(s, i) == LOOP_MANUAL)
            q->working = (uint16_t)(q->working & ~(1u << i));
    memset(q->violated_ms, 0, sizeof q->violated_ms);
    q->last_ms = s->time_ms;
    if (again)
        enter(q, q->step);
    else
        q->state = row_of(s, q->step)->until == STEP_CONFIRM ? SEQUENCE_CONFIRM : SEQUENCE_RUNNING;
    tell_sequence(s, EVENT_SEQUENCE_GOES_ON, sequence_kind_text(q->kind));
}

static bool command(struct supervisor *s, const struct request *r)
{
    struct sequence *q = &s->sequence;
    bool active = sequence_active(q), held = q->state == SEQUENCE_HELD;
    switch (r->mode) {
    case SEQUENCE_DO_START:
        return begin(s, SEQUENCE_START);
    case SEQUENCE_DO_STOP:
        return begin(s, SEQUENCE_STOP);
    case SEQUENCE_DO_HOLD:
        if (active && !held)
            hold(s, SEQUENCE_OPERATOR, "");
        return active && !held;
    case SEQUENCE_DO_GO:
        if (held)
            go_on(s);
        return held;
    case SEQUENCE_DO_CONFIRM: /* of the row that was shown, not of a later one */
        if (q->state != SEQUENCE_CONFIRM || r->output != q->step)
            return false;
        q->confirmed = true;
        tell_sequence(s, EVENT_SEQUENCE_CONFIRMED, sequence_kind_text(q->kind));
        return true;
    case SEQUENCE_DO_SKIP:
        if (!active || r->output != q->step)
            return false;
        tell_sequence(s, EVENT_SEQUENCE_SKIPPED, sequence_kind_text(q->kind));
        next(s);
        return true;
    case SEQUENCE_DO_ABORT:
        if (active)
            abort_now(s, SEQUENCE_OPERATOR, "");
        return active;
    default:
        return false;
    }
}

void sequence_request(struct supervisor *s, const struct request *r)
{
    if (!command(s, r))
        event_put(s->events, s->time_ms, EVENT_REQUEST_REFUSED, "seq", (float)r->mode, 0);
}
