#include "service/service.h"

#include <string.h>

#include "exchange/sampling.h"
#include "exchange/sequence_rows.h"
#include "exchange/tables.h"
#include "hal/identity.h"
#include "hal/image.h"
#include "hal/retained.h"
#include "hal/self_check.h"
#include "hal/tick.h"
#include "plan/plan_build.h"
#include "service/pins_check.h"
#include "settings/parameters.h"

_Static_assert(EVENT_HISTORY * sizeof(struct event_record) <= HAL_RETAINED_EVENTS_BYTES,
               "the history fits the memory set aside for it");

void service_init(struct service *s, struct supervisor *supervisor, struct plant_link *link)
{
    memset(s, 0, sizeof *s);
    s->supervisor = supervisor;
    s->link = link;
    spsc_init(&s->requests.index, REQUEST_QUEUE_SIZE);
    event_queue_init(&s->tick_events);
    telemetry_init(&s->telemetry);
    event_log_init(&s->history,
                   hal_retained(HAL_RETAINED_EVENTS, EVENT_HISTORY * sizeof(struct event_record)),
                   hal_boot_id());
    s->announced = s->history.count; /* earlier starts have announced their events */
    struct config_fault fault;
    tables_begin();
    tables_watch(TABLES_OF_PLAN, &s->plan[0].config);
    tables_watch(TABLES_OF_OTHER_PLAN, &s->plan[1].config);
    struct config *defaults = service_staged(s);
    parameters_defaults(defaults);
    /* The defaults name no channel and no loop: nothing in them can be refused. */
    (void)!plan_build(&s->plan[s->in_force], defaults, 0.0f, &fault);
}

const struct plan *service_plan(const struct service *s)
{
    return &s->plan[s->newest];
}

/* Returns the index of the plan that is not the newest: the scratch plan, when no plan waits. */
static uint8_t other(const struct service *s)
{
    return s->newest ^ 1u;
}

enum loop_mode service_mode(const struct service *s, uint8_t loop)
{
    if (spsc_can_read(&s->requests.index))
        return (enum loop_mode)s->expected_mode[loop];
    return supervisor_mode(s->supervisor, loop);
}

/* Frees the scratch plan of telemetry rows that wait to be printed. Rows with the same columns move to the plan in force; the
 * function drops and counts the others. */
static void release_rows(struct service *s)
{
    struct spsc *q = &s->telemetry.index;
    const struct plan *plan = service_plan(s), *old = &s->plan[other(s)];
    uint32_t n = spsc_count(q), read = spsc_read_index(q), stale = 0;
    for (uint32_t k = 0; k < n; k++)
        stale += s->telemetry.slot[(read + k) & (TELEMETRY_QUEUE_SIZE - 1u)].plan == old;
    bool same = stale && telemetry_same_columns(old, plan);
    /* Rows of the old plan always come before rows of the new one. */
    for (; stale; stale--) {
        if (same) {
            s->telemetry.slot[read++ & (TELEMETRY_QUEUE_SIZE - 1u)].plan = plan;
        } else {
            s->telemetry.lost++;
            spsc_read_done(q);
        }
    }
}

struct config *service_staged(struct service *s)
{
    return &s->plan[other(s)].config;
}

void service_flush(struct service *s)
{
    hal_tick_lock();
    if (s->newest != s->in_force)
        s->activate(s->activate_context);
    hal_tick_unlock();
}

struct config *service_stage(struct service *s)
{
    service_flush(s);
    release_rows(s);
    *service_staged(s) = service_plan(s)->config;
    s->staged_proposal = false;
    return service_staged(s);
}

static void expect(struct service *s, const struct request *r)
{
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        s->expected_mode[i] = (uint8_t)service_mode(s, i);
    if (r->kind == REQUEST_MODE)
        s->expected_mode[r->loop] = r->mode;
}

enum err service_request(struct service *s, const struct request *request)
{
    if (!spsc_can_write(&s->requests.index))
        return ERR_BUSY;
    expect(s, request);
    struct request *slot = &s->requests.slot[spsc_write_index(&s->requests.index)];
    *slot = *request;
    slot->plan = service_plan(s)->serial;
    spsc_write_done(&s->requests.index);
    return ERR_OK;
}

float service_plant_tick_s(const struct service *s)
{
    return (float)s->io.tick_ms(s->io.context) / 1000.0f;
}

bool service_tick_fits(const struct service *s, const struct plan *plan)
{
    float ratio = plan->tick_s / service_plant_tick_s(s);
    return ratio > 0.99f && ratio < 1.01f;
}

void service_fault_name(const struct config_fault *fault, struct text *t)
{
    text_str(t, fault->group);
    if (fault->index)
        text_u32(t, fault->index);
    text_char(t, '.');
    text_str(t, fault->field);
}

/* Builds the scratch plan from the configuration and checks that it may come into force. */
static enum err build_next(struct service *s, const struct config *config,
                           struct config_fault *fault)
{
    memset(fault, 0, sizeof *fault);
    fault->code = ERR_BUSY;
    /* The request that puts the plan into force needs room in the queue. */
    if (!spsc_can_write(&s->requests.index) || s->newest != s->in_force)
        return ERR_BUSY;
    release_rows(s);
    struct plan *plan = &s->plan[other(s)];
    enum err err = plan_build(plan, config, service_plant_tick_s(s), fault);
    if (!err)
        err = pins_check(&plan->config, fault);
    if (err)
        return err;
    /* A table that is in force already keeps its place, so that pointers to it stay valid. */
    tables_share(&plan->config, &service_plan(s)->config);
    /* At its own pins the board samples at whatever base tick it gets. */
    if (s->io.state(s->io.context) == IO_READY && !pins_are_source(&plan->config.pins) &&
        !service_tick_fits(s, plan)) {
        *fault =
            (struct config_fault){.code = ERR_CONFLICT,
                                  .group = "tick",
                                  .field = "base",
                                  .wanted = "must be 0, or the interval of the plant's samples"};
        return ERR_CONFLICT;
    }
    if (sequence_active(&s->supervisor->sequence) && sequence_differs(plan, service_plan(s))) {
        *fault = (struct config_fault){
            .code = ERR_STATE,
            .group = "step",
            .field = "seq",
            .wanted = "rows, loops and channels in them do not change while a sequence is under "
                      "way; `seq abort` ends it"};
        return ERR_STATE;
    }
    return ERR_OK;
}

enum err service_check(struct service *s, const struct config *config, struct config_fault *fault)
{
    return build_next(s, config, fault);
}

enum err service_apply(struct service *s, const struct config *config, struct config_fault *fault)
{
    enum err err = build_next(s, config, fault);
    if (err)
        return err;
    const struct plan *before = service_plan(s);
    s->plan[other(s)].serial = ++s->serial;
    /* The plan first, then the request: the tick that meets the request must find the plan. */
    s->newest = other(s);
    s->tick_known = service_plant_tick_s(s) > 0.0f;
    struct request apply = {.kind = REQUEST_APPLY, .loop = PLAN_NONE, .output = PLAN_NONE};
    err =
        service_request(s, &apply); /* there is room, because only this context writes the queue */
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        if (strcmp(before->config.loop[i].name, config->loop[i].name) != 0)
            s->expected_mode[i] = LOOP_MANUAL;
    return err;
}

/* Reports CONFIG_REFUSED. The function has a frame of its own, because the stack below plan_set_tick() is deep. */
NOT_INLINE static void tell_refusal(struct service *s, const struct config_fault *fault,
                                    float value)
{
    char name[CHANNEL_NAME_SIZE];
    struct text t = text_on(name, sizeof name);
    service_fault_name(fault, &t);
    event_put(&s->tick_events, s->supervisor->time_ms, EVENT_CONFIG_REFUSED, name, value, 0);
}

/* Returns whether a setting counts ticks, and which one. With tick.base 0 such a setting is an interval of the plant at which somebody
 * set it. Another plant would silently make another interval of it. */
static bool counts_ticks(const struct config *c, struct config_fault *fault)
{
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        if (c->loop[i].name[0] && c->loop[i].divisor > 1) {
            *fault = (struct config_fault){
                .group = "loop", .index = (uint8_t)(i + 1u), .field = "divisor"};
            return true;
        }
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        if (c->measurement[i].name[0] && sampling_every(&c->measurement[i]) > 1) {
            *fault = (struct config_fault){
                .group = "meas", .index = (uint8_t)(i + 1u), .field = "every"};
            return true;
        }
    return false;
}

/* Returns whether the configuration leaves the base tick open and the plan has another one than the plant announces. */
static bool plan_is_unfit(const struct service *s, const struct plan *plan)
{
    float tick_s = service_plant_tick_s(s);
    return plan->config.tick_s == 0.0f && tick_s != 0.0f && tick_s != plan->tick_s;
}

bool service_plan_to_fit(struct service *s)
{
    s->plan_to_fit = plan_is_unfit(s, service_in_force(s));
    return s->plan_to_fit;
}

static void fit_plan(struct service *s, struct plan *plan)
{
    struct config_fault fault = {.group = NULL};
    float tick_s = service_plant_tick_s(s), before_s = plan->tick_s;
    if (!plan_is_unfit(s, plan))
        return;
    if (s->tick_known && counts_ticks(&plan->config, &fault)) {
        tell_refusal(s, &fault, tick_s);
        return;
    }
    s->tick_known = true;
    if (plan_set_tick(plan, tick_s, &fault) == ERR_OK)
        return;
    tell_refusal(s, &fault, tick_s);
    (void)!plan_set_tick(plan, before_s, &fault); /* the old base tick, which fitted */
}

void service_fit_plan(struct service *s)
{
    fit_plan(s, &s->plan[s->in_force]);
    if (s->newest != s->in_force)
        fit_plan(s, &s->plan[s->newest]);
    s->plan_to_fit = false;
}

void service_take_pending(struct service *s)
{
    s->in_force = s->newest;
    supervisor_take_plan(s->supervisor, service_in_force(s));
}

uint8_t service_find_announced(const struct service *s, bool manipulated, const char *name)
{
    uint8_t n = s->io.count(s->io.context, manipulated);
    for (uint8_t i = 0; i < n; i++)
        if (strcmp(s->io.channel(s->io.context, manipulated, i).name, name) == 0)
            return i;
    return PLAN_NONE;
}

static enum err channel_fault(const struct service *s, bool manipulated, const char *name,
                              const char *unit, const char **what, const char **wanted)
{
    uint8_t i = service_find_announced(s, manipulated, name);
    *what = name;
    if (i == PLAN_NONE) {
        *wanted = pins_leave_link(&service_in_force(s)->config.pins)
                      ? "is not announced by the plant"
                      : "is in no row of chan or out";
        return ERR_UNKNOWN;
    }
    if (strcmp(s->io.channel(s->io.context, manipulated, i).unit, unit) != 0) {
        *wanted = "is announced with another unit than configured";
        return ERR_UNIT;
    }
    return ERR_OK;
}

/* Returns whether nothing can act: the firmware is damaged, no plant is connected, or plant time stands still. */
static bool nobody_there(const struct service *s, const char **wanted)
{
    if (BOARD_CHECKS && s->image == HAL_IMAGE_RAM_FAILED) {
        *wanted = "cannot act: the RAM failed its test at power-on";
        return true;
    }
    if (s->image == HAL_IMAGE_DAMAGED) {
        *wanted = "cannot act: the firmware is damaged; write it anew";
        return true;
    }
    bool ready = s->io.state(s->io.context) == IO_READY;
    *wanted = ready ? "cannot act while plant time stands still"
                    : "cannot act while no plant is connected";
    return !ready || s->samples.stalled;
}

static bool other_tick(const struct service *s, const char **what, const char **wanted)
{
    if (service_tick_fits(s, service_plan(s)))
        return false;
    *what = "tick.base";
    *wanted = "differs from the interval of the plant's samples";
    return true;
}

enum err service_may_act(struct service *s, uint8_t loop, enum loop_mode mode, const char **what,
                         const char **wanted)
{
    const struct plan *plan = service_plan(s);
    const struct config *c = &plan->config;
    *what = c->loop[loop].name;
    if (mode == LOOP_CASCADE && plan->loop[loop].outer == PLAN_NONE) {
        *wanted = "has no outer loop that drives its setpoint";
        return ERR_CONFLICT;
    }
    uint8_t server = plan_server(plan, loop);
    if (mode != LOOP_MANUAL && server != PLAN_NONE && plan->block[server].kind == PLAN_NONE) {
        *wanted = "is served by a block whose kind this build lacks";
        return ERR_UNSUPPORTED;
    }
    if (nobody_there(s, wanted))
        return ERR_STATE;
    enum err err = ERR_OK;
    if (other_tick(s, what, wanted))
        return ERR_CONFLICT;
    hal_tick_lock();
    /* Goes down the chain of cascades, which has no rings, so it meets every loop once at most. */
    for (unsigned depth = 0; !err && depth < CONFIG_LOOPS && loop != PLAN_NONE; depth++) {
        const struct loop_plan *p = &plan->loop[loop];
        const struct measurement_config *m = &c->measurement[p->pv];
        if (!plan_is_estimate(plan, p->pv))
            err = channel_fault(s, false, m->name, m->unit, what, wanted);
        if (!err && p->mv != PLAN_NONE)
            err = channel_fault(s, true, c->mv[p->mv].name, c->mv[p->mv].unit, what, wanted);
        loop = p->inner;
    }
    hal_tick_unlock();
    return err;
}

enum err service_output_there(struct service *s, uint8_t output, const char **what,
                              const char **wanted)
{
    const struct mv_config *o = &service_plan(s)->config.mv[output];
    *what = o->name;
    if (nobody_there(s, wanted))
        return ERR_STATE;
    if (other_tick(s, what, wanted))
        return ERR_CONFLICT;
    hal_tick_lock();
    enum err err = channel_fault(s, true, o->name, o->unit, what, wanted);
    hal_tick_unlock();
    return err;
}

/* Moves events into the history. While half a history of events waits to be printed, it moves only what exceeds half of the queue. */
void service_keep_events(struct service *s)
{
    struct event_queue *queue = &s->tick_events;
    while (spsc_can_read(&queue->index) && (s->history.count - s->announced < EVENT_HISTORY / 2 ||
                                            spsc_count(&queue->index) > EVENT_QUEUE_SIZE / 2)) {
        event_log_put(&s->history, &queue->slot[spsc_read_index(&queue->index)]);
        spsc_read_done(&queue->index);
    }
}

bool service_next_event(struct service *s, struct event *event)
{
    service_keep_events(s);
    uint32_t oldest = event_log_oldest(&s->history);
    if (s->announced < oldest) {
        s->unannounced += oldest - s->announced;
        s->announced = oldest;
    }
    while (s->announced < s->history.count) {
        bool there = event_log_get(&s->history, s->announced, event);
        if (!event_log_join(&s->history, s->announced))
            s->announced++;
        if (there && event_level(event->code) != EVENT_ACTION)
            return true;
    }
    return false;
}

uint64_t service_time_ms(const struct service *s)
{
    hal_tick_lock();
    uint64_t now = s->supervisor->time_ms;
    hal_tick_unlock();
    return now;
}

void service_record(struct service *s, enum event_code code, const char *subject, float value,
                    uint8_t detail)
{
    struct event e = event_make(service_time_ms(s), code, subject, value, detail);
    service_keep_events(s); /* earlier events of the tick come first */
    event_log_put(&s->history, &e);
}

void service_record_one_more(struct service *s, enum event_code code, enum event_code until)
{
    struct event_log *log = &s->history;
    struct event e;
    service_keep_events(s);
    for (uint32_t k = log->count; k-- > event_log_oldest(log);) {
        if (!event_log_get(log, k, &e))
            continue;
        if (e.code == until || e.boot != log->boot)
            break;
        if (e.code == code) {
            e.value += 1.0f;
            event_log_replace(log, k, &e);
            return;
        }
    }
    service_record(s, code, NULL, 1.0f, 0);
}
