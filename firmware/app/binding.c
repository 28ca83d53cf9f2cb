/* Binds each channel of the plan to a channel of the plant. */
#include <string.h>

#include "app/parts.h"
#include "exchange/block_work.h"
#include "hal/clock.h"

static void tick_event(struct app *app, enum event_code code, const char *subject, float value)
{
    event_put(&app->service.tick_events, app->supervisor.time_ms, code, subject, value, 0);
}

/* Reports a measurement of the plant that has the name of a point that a block writes, and so stays unused. */
static void bind_point(struct app *app, const struct plan *plan, uint8_t i)
{
    const char *name = plan->config.measurement[i].name;
    if (service_find_announced(&app->service, false, name) != PLAN_NONE)
        tick_event(app, EVENT_CHANNEL_WRITTEN, name, (float)(plan_writer(plan, i) + 1u));
}

/* Binds a channel that the plant has by this name and with this unit. */
static void bind_channel(struct app *app, bool manipulated, uint8_t i, const char *name,
                         const char *unit)
{
    struct service *s = &app->service;
    uint8_t index = service_find_announced(s, manipulated, name);
    if (index == PLAN_NONE) {
        tick_event(app, EVENT_CHANNEL_MISSING, name, 0.0f);
    } else if (strcmp(s->io.channel(s->io.context, manipulated, index).unit, unit) != 0) {
        tick_event(app, EVENT_CHANNEL_UNIT, name, 0.0f);
    } else if (manipulated) {
        app->binding.output_index[i] = index;
        supervisor_bind_mv(&app->supervisor, i);
    } else {
        app->binding.measurement_index[i] = index;
        supervisor_bind_measurement(&app->supervisor, i);
    }
}

void binding_bind(struct app *app)
{
    struct service *s = &app->service;
    const struct plan *plan = service_in_force(s);
    const struct config *c = &plan->config;
    supervisor_unbind(&app->supervisor);
    if (app->binding.io_state != IO_READY)
        return;
    if (!service_tick_fits(s, plan)) {
        if (c->tick_s != 0.0f) /* else service_fit_plan() has said why */
            tick_event(app, EVENT_CONFIG_REFUSED, "tick.base", service_plant_tick_s(s));
        return; /* nothing bound: no loop leaves manual */
    }
    for (uint8_t i = 0; i < CHANNEL_MAX; i++) {
        const struct measurement_config *m = &c->measurement[i];
        if (m->name[0] && plan_is_estimate(plan, i))
            bind_point(app, plan, i);
        else if (m->name[0])
            bind_channel(app, false, i, m->name, m->unit);
    }
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        if (c->mv[i].name[0])
            bind_channel(app, true, i, c->mv[i].name, c->mv[i].unit);
}

void binding_announce(struct app *app)
{
    if (!app->binding.announce_pending)
        return;
    app->binding.announce_pending = false;
    supervisor_tell_plan(&app->supervisor);
    binding_bind(app);
}

void binding_lose_outputs(struct app *app, uint8_t first)
{
    const struct config *c = &service_in_force(&app->service)->config;
    for (uint8_t j = 0; j < app->supervisor.placed[PLACED_MVS]; j++) {
        if (!app->supervisor.mv[j].bound || app->binding.output_index[j] < first)
            continue;
        supervisor_unbind_mv(&app->supervisor, j);
        tick_event(app, EVENT_CHANNEL_MISSING, c->mv[j].name, 0.0f);
    }
}

bool binding_follow_plant(struct app *app)
{
    struct service *s = &app->service;
    struct binding *b = &app->binding;
    enum io_state state = s->io.state(s->io.context);
    uint32_t generation = s->io.generation(s->io.context);
    if (state == b->io_state && generation == b->generation)
        return true;
    /* A piece of a block's work is under way, and a plan for another tick could move its memory. One turn later it
     * is over. */
    if (block_work_is_under_way(&app->supervisor))
        return false;
    b->io_state = state;
    b->generation = generation;
    sample_gate_forget(&app->tick.gate);
    samples_forget(&s->samples, hal_clock_ms());
    app->tick.command.n_outputs = 0;
    memset(app->tick.driven, 0, sizeof app->tick.driven);
    supervisor_go_safe(&app->supervisor, state == IO_READY ? "plant" : "link");
    if (state == IO_READY && service_plan_to_fit(s))
        return false; /* the main loop makes the plan: service_fit_plan() */
    if (b->announce_pending)
        binding_announce(app);
    else
        binding_bind(app);
    return true;
}
