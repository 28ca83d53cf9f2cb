/* Composes the firmware: one context, the tick, the main loop. */
#include "app/app.h"

#include <stddef.h>
#include <string.h>

#include "base/elapsed.h"
#include "base/job.h"
#include "base/workspace.h"
#include "commission/commission.h"
#include "console/console.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/image.h"
#include "hal/retained.h"
#include "hal/tick.h"
#include "hal/uart.h"
#include "hal/watchdog.h"
#include "io/sample_gate.h"
#include "service/early_resets.h"
#include "service/heartbeat.h"
#include "storage/storage.h"
#include "supervise/restart.h"

#define WATCHDOG_MS 2000

_Static_assert(sizeof(struct restart_record) <= HAL_RETAINED_RESTART_BYTES,
               "what a restart returns to fits the memory kept for it");

struct app {
    struct supervisor supervisor;
    struct plant_link link;
    struct service service;
    struct operate operate;
    struct console console;
    uint32_t bound_generation; /* channel table the supervisor is bound to */
    enum io_state io_state;
    uint8_t measurement_at[CHANNEL_MAX], output_at[CHANNEL_MAX]; /* index in the plant's table */
    bool untold;               /* the plan in force has not been told of, nor its channels bound */
    uint64_t safe_tick_ms;     /* board time of the last tick in silence */
    struct io_command command; /* last one sent */
    bool driven[IO_CHANNELS_MAX]; /* outputs of this plant that have been commanded */
    struct restart restart;
    struct heartbeat heartbeat;
    struct early_resets early_resets;
    struct storage storage;
#if JOBS_MAX
    struct jobs jobs;
    struct sample_gate gate;
#endif
#if WORKSPACE_BYTES
    struct workspace workspace;
#endif
#if COMMISSION_CHANNELS
    struct commission commission;
#endif
    volatile uint32_t main_turns;
};

static struct app instance;

#if WORKSPACE_BYTES
/* By itself, for tools/image: what all of the firmware owns for ever is apart from it. */
static _Alignas(max_align_t) uint8_t workspace_memory[WORKSPACE_BYTES];
#endif

struct app *app_instance(void)
{
    return &instance;
}

struct workspace *app_workspace(struct app *app)
{
    return app->service.workspace;
}

static void activate_plan(void *context);

struct operate *app_door(struct app *app)
{
    return &app->operate;
}

void app_init(struct app *app)
{
    memset(app, 0, sizeof *app);
    service_init(&app->service, &app->supervisor, &app->link);
    supervisor_init(&app->supervisor, &app->service.tick_events);
    plant_link_init(&app->link, &app->service.tick_events, &app->supervisor.time_ms);
    app->service.io = plant_link_port(&app->link);
    supervisor_take_plan(&app->supervisor, &app->service.plan[app->service.in_force]);
    supervisor_tell_plan(&app->supervisor);
    app->service.activate = activate_plan;
    app->service.activate_context = app;
    operate_init(&app->operate, &app->service);
    console_init(&app->console, &app->operate);
#if WORKSPACE_BYTES
    workspace_init(&app->workspace, workspace_memory, sizeof workspace_memory);
    workspace_share(&app->workspace);
    app->service.workspace = &app->workspace;
#endif
#if COMMISSION_CHANNELS
    commission_init(&app->commission, &app->service.tick_events, &app->workspace);
    app->service.commission = &app->commission;
    (void)!jobs_add(&app->jobs, &app->commission.job); /* the first, and there is room for more */
#endif
#if CONFIG_BLOCKS
    for (unsigned n = 0; n < CONFIG_BLOCKS; n++)
        (void)!jobs_add(&app->jobs, &app->supervisor.work[n]);
#endif
    storage_init(&app->storage, &app->service);
    app->service.watchdog = hal_watchdog_start(WATCHDOG_MS);
    heartbeat_init(&app->heartbeat, WATCHDOG_MS);
    enum hal_reset cause = hal_reset_cause();
    app->service.early_resets = early_resets_init(
        &app->early_resets, hal_retained(HAL_RETAINED_STARTS, sizeof(struct early_resets_record)),
        cause, (uint32_t)hal_clock_ms());
    restart_init(&app->restart, hal_retained(HAL_RETAINED_RESTART, sizeof(struct restart_record)),
                 cause != HAL_RESET_POWER_ON);
    service_record(&app->service, EVENT_STARTED, hal_reset_name(cause), 0.0f, 0);
    app->service.image = (uint8_t)hal_image_check();
    if (app->service.image == HAL_IMAGE_DAMAGED)
        service_record(&app->service, EVENT_IMAGE_DAMAGED, NULL, 0.0f, 0);
#if COMMISSION_CHANNELS
    if (app->restart.was_testing)
        commission_was_reset(&app->commission);
#endif
}

static void tick_event(struct app *app, enum event_code code, const char *subject, float value)
{
    event_put(&app->service.tick_events, app->supervisor.time_ms, code, subject, value, 0);
}

/* ---- the tick context ---- */

/* A point is there with what it is made from. One by the name of a measurement that the plant has stands in its place. */
static void bind_point(struct app *app, uint8_t i)
{
#if CONFIG_BLOCKS
    struct service *s = &app->service;
    const struct plan *plan = &s->plan[s->in_force];
    const char *name = plan->config.measurement[i].name;
    if (service_find_announced(s, false, name) != PLAN_NONE)
        tick_event(app, EVENT_CHANNEL_WRITTEN, name, (float)(plan->writer[i] + 1u));
#else
    (void)app;
    (void)i;
#endif
}

static void bind_channels(struct app *app)
{
    struct service *s = &app->service;
    const struct config *c = &s->plan[s->in_force].config;
    supervisor_unbind(&app->supervisor);
    if (app->io_state != IO_READY)
        return;
    if (!service_tick_fits(s, &s->plan[s->in_force])) {
        if (c->tick_s != 0.0f) /* else service_follow_tick() has said why */
            tick_event(app, EVENT_CONFIG_REFUSED, "tick.base", service_plant_tick_s(s));
        return; /* nothing bound: no loop leaves manual */
    }
    for (uint8_t k = 0; k < 2u * CHANNEL_MAX; k++) {
        bool manipulated = k >= CHANNEL_MAX;
        uint8_t i = manipulated ? (uint8_t)(k - CHANNEL_MAX) : k;
        const char *name = manipulated ? c->mv[i].name : c->measurement[i].name;
        const char *unit = manipulated ? c->mv[i].unit : c->measurement[i].unit;
        if (!name[0])
            continue;
        if (!manipulated && plan_is_estimate(&s->plan[s->in_force], i)) {
            bind_point(app, i);
            continue;
        }
        uint8_t at = service_find_announced(s, manipulated, name);
        if (at == PLAN_NONE) {
            tick_event(app, EVENT_CHANNEL_MISSING, name, 0.0f);
        } else if (strcmp(s->io.channel(s->io.context, manipulated, at).unit, unit) != 0) {
            tick_event(app, EVENT_CHANNEL_UNIT, name, 0.0f);
        } else if (manipulated) {
            app->output_at[i] = at;
            supervisor_bind_mv(&app->supervisor, i);
        } else {
            app->measurement_at[i] = at;
            supervisor_bind_measurement(&app->supervisor, i);
        }
    }
}

/* A plan has come into force: whoever is next to act meets it with its channels bound. Several that came between two
 * ticks are told once. */
static void meet_plan(struct app *app)
{
    if (!app->untold)
        return;
    app->untold = false;
    supervisor_tell_plan(&app->supervisor);
    bind_channels(app);
}

/* The plant has come, gone or changed: everything bound to the old one is void. False: a piece of a block's work is under way,
 * whose memory a plan for another tick could move; a turn later it is over. */
static bool follow_plant(struct app *app)
{
    struct service *s = &app->service;
    enum io_state state = s->io.state(s->io.context);
    uint32_t generation = s->io.generation(s->io.context);
    if (state == app->io_state && generation == app->bound_generation)
        return true;
    if (supervisor_working(&app->supervisor))
        return false;
    app->io_state = state;
    app->bound_generation = generation;
#if JOBS_MAX
    sample_gate_forget(&app->gate);
#endif
    samples_forget(&s->samples, hal_clock_ms());
    app->command.n_outputs = 0;
    memset(app->driven, 0, sizeof app->driven);
    supervisor_go_safe(&app->supervisor, state == IO_READY ? "plant" : "link");
    struct plan *plan = &s->plan[s->in_force];
    if (state == IO_READY && service_follow_tick(s, plan)) {
        supervisor_take_plan(&app->supervisor, plan);
        app->untold = true;
    }
    if (app->untold)
        meet_plan(app);
    else
        bind_channels(app);
    return true;
}

/* Requests wait for the tick. A new plan is put into force before the sample is looked at, with all that was
 * asked before it, so that what is asked after it meets this sample in the new plan. */
static void take_requests(struct app *app, bool up_to_last_plan)
{
    struct request_queue *q = &app->service.requests;
    /* Bounded by what was there at the start: the main loop does not run meanwhile. */
    uint32_t n = spsc_count(&q->index), read = spsc_read_index(&q->index);
    while (up_to_last_plan && n &&
           q->slot[(read + n - 1u) & (REQUEST_QUEUE_SIZE - 1u)].kind != REQUEST_APPLY)
        n--;
    for (; n; n--) {
        struct request r = q->slot[spsc_read_index(&q->index)];
        spsc_read_done(&q->index);
        if (r.kind == REQUEST_APPLY) {
            service_take_pending(&app->service);
            app->untold = true;
        } else {
            meet_plan(app);
            supervisor_request(&app->supervisor, &r);
        }
    }
}

/* The main loop needs the buffer of the plan that waits: what the next tick would begin with is done now. */
static void activate_plan(void *context)
{
    take_requests(context, true);
}

static void take_requests_in_tick(struct app *app, bool up_to_last_plan)
{
    take_requests(app, up_to_last_plan);
    meet_plan(app);
}

/* The readings are needed no longer than that, and the stack is small: not part of a larger frame. */
NOT_INLINE static void validate(struct app *app, const struct io_sample *sample)
{
    const struct supervisor *s = &app->supervisor;
    struct tick_input input;
    memset(&input, 0, sizeof input);
    input.time_ms = sample->time;
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        input.measurement[i].quality = QUALITY_MISSING;
        input.readback[i].quality = QUALITY_MISSING;
        if (i < s->placed[PLACED_MEASUREMENTS] && s->measurement[i].bound) {
            const struct io_reading *r = &sample->measurement[app->measurement_at[i]];
            input.measurement[i] = (struct reading){r->value, r->quality};
        }
        if (i < s->placed[PLACED_MVS] && s->mv[i].bound && sample->n_readback) {
            const struct io_reading *r = &sample->readback[app->output_at[i]];
            input.readback[i] = (struct reading){r->value, r->quality};
        }
    }
    supervisor_validate(&app->supervisor, &input);
}

static void send_command(struct app *app, const struct io_sample *sample, uint64_t now_ms)
{
    struct service *s = &app->service;
    app->command.number = sample->number;
    app->command.time = sample->time;
    (void)!s->io.command(s->io.context, &app->command,
                         now_ms); /* congestion is counted by the link */
}

static void fill_command(struct app *app)
{
    struct service *s = &app->service;
    const struct config *c = &s->plan[s->in_force].config;
    memset(&app->command, 0, sizeof app->command);
    app->command.safe = app->supervisor.state == SUPERVISOR_SAFE;
    app->command.n_outputs = s->io.count(s->io.context, true);
    for (unsigned j = 0; j < app->supervisor.placed[PLACED_MVS]; j++) {
        if (!app->supervisor.mv[j].bound)
            continue;
        const struct mv_config *o = &c->mv[j];
        app->command.output[app->output_at[j]].value =
            mv_to_eu(app->supervisor.mv[j].constrained, o);
        app->command.output[app->output_at[j]].drive = true;
        app->driven[app->output_at[j]] = true;
    }
    /* An output given up by a new configuration would stay where it was, with nobody watching it. */
    for (uint8_t j = 0; j < app->command.n_outputs; j++) {
        if (!app->driven[j] || app->command.output[j].drive)
            continue;
        app->command.output[j].value = s->io.channel(s->io.context, true, j).safe;
        app->command.output[j].drive = true;
    }
    /* The first command after a start is safe whatever the configuration: that may still lie in storage. */
    for (uint8_t j = 0; app->supervisor.ticks == 1 && j < app->command.n_outputs; j++) {
        if (app->command.output[j].drive)
            continue;
        app->command.output[j].value = s->io.channel(s->io.context, true, j).safe;
        app->command.output[j].drive = true;
    }
}

static enum sample_verdict judge_sample(struct app *app, const struct io_sample *sample,
                                        uint64_t now_ms)
{
    struct service *s = &app->service;
    const struct plan *plan = &s->plan[s->in_force];
    /* With a plan for another tick nothing acts, and the plant's samples are as they should be. */
    float tick_s = service_tick_fits(s, plan) ? plan->tick_s : service_plant_tick_s(s);
    return samples_judge(&s->samples, sample, now_ms, tick_s, plan->config.miss_limit,
                         &s->tick_events);
}

static void tick(struct app *app, const struct io_sample *sample, uint64_t now_ms)
{
    struct service *s = &app->service;
    uint32_t start = hal_cycles();
    enum sample_verdict verdict = judge_sample(app, sample, now_ms);
    if (verdict == SAMPLE_NO_TICK) {
        send_command(app, sample, now_ms); /* the plant gets an answer, but no new one */
        return;
    }
    /* What was asked before a safe state was asked by somebody who did not know of it: it meets it, and does not end it. */
    take_requests_in_tick(app, verdict == SAMPLE_TICK);
    if (verdict == SAMPLE_TICK_LOST)
        supervisor_go_safe(&app->supervisor, "samples");
    if (verdict == SAMPLE_TICK_STALLED)
        supervisor_go_safe(&app->supervisor, "plant_time");
    bool acted = app->supervisor.state != SUPERVISOR_SAFE;
    validate(app, sample);
    bool fell_back = acted && app->supervisor.state == SUPERVISOR_SAFE;
    take_requests_in_tick(app, false);
    if (fell_back)
        supervisor_stay_safe(&app->supervisor);
    if (app->service.image == HAL_IMAGE_DAMAGED) /* whatever has been asked for */
        supervisor_outputs_safe(&app->supervisor, "image");
    else
        restart_try(&app->restart, &app->supervisor);
#if COMMISSION_CHANNELS
    commission_tick(&app->commission, &app->supervisor);
#endif
    supervisor_control(&app->supervisor);
#if WORKSPACE_BYTES
    workspace_tick(&app->workspace);
#endif
    fill_command(app);
    send_command(app, sample, now_ms);
    restart_keep(&app->restart, &app->supervisor);

    struct tick_cost *cost = &s->cost;
    cost->last = hal_cycles() - start + sample->reception;
    cost->lowest = cost->n == 0 || cost->last < cost->lowest ? cost->last : cost->lowest;
    cost->highest = cost->last > cost->highest ? cost->last : cost->highest;
    cost->sum += cost->last;
    cost->n++;
    telemetry_capture(&s->telemetry, &app->supervisor, sample->number,
                      atomic_load(&s->tick_events.index.written), cost->last);
}

/* No plant: requests are still taken and the outputs stay safe, at the pace of the board's clock. */
static void silent_tick(struct app *app, uint64_t now_ms)
{
    float period_ms = app->service.plan[app->service.in_force].tick_s * 1000.0f;
    if (period_ms > 1000.0f)
        period_ms = 1000.0f;
    if (elapsed_ms(now_ms, app->safe_tick_ms) < period_ms)
        return;
    app->safe_tick_ms = now_ms;
    take_requests_in_tick(app, false);
    supervisor_go_safe(&app->supervisor, "link");
    restart_keep(&app->restart, &app->supervisor);
}

/* The plant is there, says so, and sends no samples. */
static void watch_samples(struct app *app, uint64_t now_ms)
{
    struct service *s = &app->service;
    if (!samples_overdue(&s->samples, now_ms, s->plan[s->in_force].config.sample_timeout_s,
                         &s->tick_events))
        return;
    supervisor_go_safe(&app->supervisor, "samples");
    restart_keep(&app->restart, &app->supervisor);
}

/* A tick may take a base tick of the plant, and a second at most. */
static uint32_t tick_deadline_ms(const struct app *app)
{
    float tick_ms = app->service.plan[app->service.in_force].tick_s * 1000.0f;
    uint32_t longest_ms = WATCHDOG_MS / 2;
    return tick_ms < (float)longest_ms ? (uint32_t)tick_ms : longest_ms;
}

/* The next sample that is to be looked at now, where there is one. */
static bool next_sample(struct app *app, uint64_t now_ms, struct io_sample *sample)
{
    const struct io_port *io = &app->service.io;
#if JOBS_MAX
    bool wait = jobs_wait(&app->jobs);
    if (wait)
        app->service.samples.seen_ms = now_ms; /* nobody has looked */
    return sample_gate_poll(&app->gate, io, wait, now_ms, sample);
#else
    return io->poll(io->context, now_ms, sample);
#endif
}

void app_tick(struct app *app)
{
    struct io_sample sample;
    uint64_t now_ms = hal_clock_ms();
    /* Bounded: a sample costs the line milliseconds, a turn here microseconds. */
    for (unsigned n = 0; n < 64; n++) {
        bool there = next_sample(app, now_ms, &sample);
        if (!follow_plant(app) || !there)
            break;
        heartbeat_tick_begins(&app->heartbeat, hal_clock_ms());
        tick(app, &sample, now_ms);
        heartbeat_tick_ends(&app->heartbeat, hal_clock_ms(), tick_deadline_ms(app));
    }
    if (app->io_state != IO_READY)
        silent_tick(app, now_ms);
    else
        watch_samples(app, now_ms);
    if (heartbeat_due(&app->heartbeat, hal_clock_ms(), app->main_turns))
        hal_watchdog_feed();
}

/* ---- the main loop ---- */

#if JOBS_MAX
static bool do_work(struct app *app)
{
    struct service *s = &app->service;
    uint32_t ticks = s->cost.n, start = hal_cycles();
    /* A piece of a block's work and a plan that comes into force must not meet. */
    if (s->newest != s->in_force && supervisor_work_wanted(&app->supervisor))
        service_flush(s);
    bool worked = jobs_work(&app->jobs);
    uint32_t cost = hal_cycles() - start;
    if (worked && ticks == s->cost.n) {
        s->work_cost.n++;
        if (cost > s->work_cost.highest)
            s->work_cost.highest = cost;
    }
    if (app->gate.holds && !jobs_wait(&app->jobs))
        hal_tick_request();
    return worked;
}
#endif

void app_background(struct app *app)
{
    app->main_turns++;
    early_resets_poll(&app->early_resets, (uint32_t)hal_clock_ms());
    bool busy = console_poll(&app->console);
#if JOBS_MAX
    busy = do_work(app) || busy;
#endif
#if COMMISSION_CHANNELS
    busy = operate_poll(&app->operate) || busy;
#endif
#if CONFIG_BLOCKS
    busy = operate_poll_proposals(&app->operate) || busy;
#endif
    busy = storage_poll(&app->storage) || busy;
    busy = hal_uart_pump(HAL_UART_CONSOLE) != 0 || busy;
    hal_idle(!busy);
}
