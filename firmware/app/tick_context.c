/* The tick context: requests, samples, the tick, silence. Runs above the main loop (hal/tick.h); parts.h has its doors. */
#include "app/parts.h"

#include <string.h>

#include "base/elapsed.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/image.h"
#include "hal/retained.h"
#include "hal/tick.h"
#include "hal/watchdog.h"

_Static_assert(sizeof(struct restart_record) <= HAL_RETAINED_RESTART_BYTES,
               "what a restart returns to fits the memory kept for it");

void tick_context_init(struct app *app)
{
    supervisor_init(&app->supervisor, &app->service.tick_events);
    if (CONFIG_LINK)
        plant_link_init(app->link, &app->service.tick_events, &app->supervisor.time_ms);
    board_io_init(&app->board_io, &app->service.tick_events, &app->supervisor.time_ms);
    app->service.io = CONFIG_LINK ? plant_link_port(app->link) : board_io_port(&app->board_io);
    supervisor_take_plan(&app->supervisor, service_in_force(&app->service));
    supervisor_tell_plan(&app->supervisor);
}

void tick_context_start(struct app *app, enum hal_reset cause)
{
    heartbeat_init(&app->tick.heartbeat, WATCHDOG_FIRST_MS);
    restart_init(&app->tick.restart,
                 hal_retained(HAL_RETAINED_RESTART, sizeof(struct restart_record)),
                 cause != HAL_RESET_POWER_ON);
}

/* Requests wait for the tick. A new plan comes into force before the sample is looked at, with all requests that
 * came before it. So a request that comes after the plan meets this sample under the new plan. */
static void take_requests(struct app *app, bool up_to_last_plan)
{
    struct request_queue *q = &app->service.requests;
    /* The number at the start bounds the loop, because the main loop does not run meanwhile. */
    uint32_t n = spsc_count(&q->index), read = spsc_read_index(&q->index);
    while (up_to_last_plan && n &&
           q->slot[(read + n - 1u) & (REQUEST_QUEUE_SIZE - 1u)].kind != REQUEST_APPLY)
        n--;
    for (; n; n--) {
        struct request r = q->slot[spsc_read_index(&q->index)];
        spsc_read_done(&q->index);
        if (r.kind == REQUEST_APPLY) {
            service_take_pending(&app->service);
            binding_take_source(app);
            app->binding.announce_pending = true;
        } else {
            binding_announce(app);
            supervisor_request(&app->supervisor, &r);
        }
    }
}

void tick_context_activate(void *app)
{
    take_requests(app, true);
}

void tick_context_take_plan(struct app *app)
{
    supervisor_take_plan(&app->supervisor, service_in_force(&app->service));
    binding_take_source(app);
    app->binding.announce_pending = true;
    binding_announce(app);
}

static void take_requests_in_tick(struct app *app, bool up_to_last_plan)
{
    take_requests(app, up_to_last_plan);
    binding_announce(app);
}

/* This function is not part of a larger frame, because the readings are needed only here and the stack is small. */
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
            const struct io_reading *r = &sample->measurement[app->binding.measurement_index[i]];
            input.measurement[i] = (struct reading){r->value, r->quality};
        }
        if (i < s->placed[PLACED_MVS] && s->mv[i].bound && sample->n_readback) {
            const struct io_reading *r = &sample->readback[app->binding.output_index[i]];
            input.readback[i] = (struct reading){r->value, r->quality};
        }
    }
    supervisor_validate(&app->supervisor, &input);
}

static void send_command(struct app *app, const struct io_sample *sample, uint64_t now_ms)
{
    struct service *s = &app->service;
    app->tick.command.number = sample->number;
    app->tick.command.time = sample->time;
    /* The link counts congestion. */
    (void)!s->io.command(s->io.context, &app->tick.command, now_ms);
}

static void fill_command(struct app *app)
{
    struct service *s = &app->service;
    const struct config *c = &service_in_force(s)->config;
    memset(&app->tick.command, 0, sizeof app->tick.command);
    app->tick.command.safe = app->supervisor.state == SUPERVISOR_SAFE;
    app->tick.command.n_outputs = s->io.count(s->io.context, true);
    for (unsigned j = 0; j < app->supervisor.placed[PLACED_MVS]; j++) {
        if (!app->supervisor.mv[j].bound)
            continue;
        const struct mv_config *o = &c->mv[j];
        app->tick.command.output[app->binding.output_index[j]].value =
            mv_to_eu(app->supervisor.mv[j].constrained, o);
        app->tick.command.output[app->binding.output_index[j]].drive = true;
        app->tick.driven[app->binding.output_index[j]] = true;
    }
    /* An output that a new configuration has given up would stay where it was, with nobody watching it. */
    for (uint8_t j = 0; j < app->tick.command.n_outputs; j++) {
        if (!app->tick.driven[j] || app->tick.command.output[j].drive)
            continue;
        app->tick.command.output[j].value = s->io.channel(s->io.context, true, j).safe;
        app->tick.command.output[j].drive = true;
    }
    /* The first command after a start is safe whatever the configuration says, because that may still lie in
     * storage. */
    for (uint8_t j = 0; app->supervisor.ticks == 1 && j < app->tick.command.n_outputs; j++) {
        if (app->tick.command.output[j].drive)
            continue;
        app->tick.command.output[j].value = s->io.channel(s->io.context, true, j).safe;
        app->tick.command.output[j].drive = true;
    }
}

static enum sample_verdict judge_sample(struct app *app, const struct io_sample *sample,
                                        uint64_t now_ms)
{
    struct service *s = &app->service;
    const struct plan *plan = service_in_force(s);
    /* With a plan for another tick nothing acts, and the samples come at the plant's own tick. */
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
    /* Whoever asked before a safe state did not know of it. So the tick takes these requests first, and they do not
     * end the safe state. */
    take_requests_in_tick(app, verdict == SAMPLE_TICK);
    if (source_changed(app))
        return; /* the sample is of channels that a plan has just replaced */
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
    if (app->service.image >= HAL_IMAGE_DAMAGED) /* whatever has been asked for */
        supervisor_outputs_safe(&app->supervisor, "image");
    else
        restart_try(&app->tick.restart, &app->supervisor);
    start_up_tick(&app->start_up, &app->supervisor);
    supervisor_control(&app->supervisor);
    workspace_tick(&app->workspace);
    fill_command(app);
    send_command(app, sample, now_ms);
    restart_keep(&app->tick.restart, &app->supervisor);

    struct tick_cost *cost = &s->cost;
    cost->last = hal_cycles() - start + sample->reception;
    cost->lowest = cost->n == 0 || cost->last < cost->lowest ? cost->last : cost->lowest;
    cost->highest = cost->last > cost->highest ? cost->last : cost->highest;
    cost->sum += cost->last;
    cost->n++;
    telemetry_capture(&s->telemetry, &app->supervisor, sample->number,
                      atomic_load(&s->tick_events.index.written), cost->last);
}

/* Without a plant, the tick still takes requests at the pace of the board's clock, and the outputs stay safe. */
static void silent_tick(struct app *app, uint64_t now_ms)
{
    float period_ms = service_in_force(&app->service)->tick_s * 1000.0f;
    if (period_ms > 1000.0f)
        period_ms = 1000.0f;
    if (elapsed_ms(now_ms, app->tick.silent_tick_ms) < period_ms)
        return;
    app->tick.silent_tick_ms = now_ms;
    take_requests_in_tick(app, false);
    supervisor_go_safe(&app->supervisor, "link");
    restart_keep(&app->tick.restart, &app->supervisor);
}

/* Takes the safe state if the plant is there and says so, but sends no samples. */
static void watch_samples(struct app *app, uint64_t now_ms)
{
    struct service *s = &app->service;
    if (!samples_overdue(&s->samples, now_ms, service_in_force(s)->config.sample_timeout_s,
                         &s->tick_events))
        return;
    supervisor_go_safe(&app->supervisor, "samples");
    restart_keep(&app->tick.restart, &app->supervisor);
}

/* Returns the longest time a tick may take: a base tick of the plant, and half the watchdog's time-out at most. */
static uint32_t tick_deadline_ms(const struct app *app)
{
    float tick_ms = service_in_force(&app->service)->tick_s * 1000.0f;
    uint32_t longest_ms = (CONFIG_DEVICES != 0 ? app->tick.heartbeat.timeout_ms : WATCHDOG_MS) / 2u;
    return tick_ms < (float)longest_ms ? (uint32_t)tick_ms : longest_ms;
}

/* Returns true with the next sample, if there is one to be looked at now. */
static bool next_sample(struct app *app, uint64_t now_ms, struct io_sample *sample)
{
    const struct io_port *io = &app->service.io;
    bool wait = jobs_wait(&app->jobs);
    if (wait)
        app->service.samples.seen_ms = now_ms; /* nobody has looked */
    return sample_gate_poll(&app->tick.gate, io, wait, now_ms, sample);
}

/* Has the watchdog's time-out follow the plan in force. Both directions hold the tick and the main loop to the longer of two only after the
 * watchdog has it. */
static void fit_watchdog(struct app *app)
{
    struct heartbeat *h = &app->tick.heartbeat;
    uint32_t wanted_ms = pins_are_source(&service_in_force(&app->service)->config.pins)
                             ? WATCHDOG_PINS_MS
                             : WATCHDOG_MS;
    if (CONFIG_DEVICES != 0 && h->timeout_ms != wanted_ms && hal_watchdog_change(wanted_ms))
        heartbeat_change(h, wanted_ms);
}

void tick_context_run(struct app *app)
{
    struct io_sample sample;
    uint64_t now_ms = hal_clock_ms();
    /* The loop is bounded, because a sample costs the line milliseconds, and a turn here microseconds. */
    for (unsigned n = 0; n < 64 && !app->service.plan_to_fit; n++) {
        bool there = next_sample(app, now_ms, &sample);
        if (!binding_follow_plant(app))
            break;
        source_follow_link(app);
        if (!there)
            break;
        heartbeat_tick_begins(&app->tick.heartbeat, hal_clock_ms());
        tick(app, &sample, now_ms);
        heartbeat_tick_ends(&app->tick.heartbeat, hal_clock_ms(), tick_deadline_ms(app));
    }
    if (app->binding.io_state != IO_READY)
        silent_tick(app, now_ms);
    else
        watch_samples(app, now_ms);
    fit_watchdog(app);
    if (heartbeat_due(&app->tick.heartbeat, hal_clock_ms(), app->main_turns))
        hal_watchdog_feed();
}
