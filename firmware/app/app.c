/* Composes the firmware, and runs the main loop. */
#include "app/app.h"

#include <stddef.h>
#include <string.h>

#include "app/parts.h"
#include "exchange/block_work.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/image.h"
#include "hal/retained.h"
#include "hal/self_check.h"
#include "hal/tick.h"
#include "hal/uart.h"
#include "hal/watchdog.h"
#include "hal/workspace.h"

static struct app instance;

struct app *app_instance(void)
{
    return &instance;
}

struct workspace *app_workspace(struct app *app)
{
    return app->service.workspace;
}

struct operate *app_door(struct app *app)
{
    return &app->operate;
}

static void start_watching(struct app *app)
{
    app->service.watchdog = hal_watchdog_start(WATCHDOG_FIRST_MS);
    enum hal_reset cause = hal_reset_cause();
    app->service.early_resets = early_resets_init(
        &app->early_resets, hal_retained(HAL_RETAINED_STARTS, sizeof(struct early_resets_record)),
        cause, (uint32_t)hal_clock_ms());
    tick_context_start(app, cause);
    service_record(&app->service, EVENT_STARTED, hal_reset_name(cause), 0.0f, 0);
    app->service.image = (uint8_t)hal_image_check();
    if (BOARD_CHECKS && app->service.image == HAL_IMAGE_RAM_FAILED)
        service_record(&app->service, EVENT_RAM_FAILED, NULL, 0.0f, 0);
    if (app->service.image == HAL_IMAGE_DAMAGED)
        service_record(&app->service, EVENT_IMAGE_DAMAGED, NULL, 0.0f, 0);
}

/* Goes on with the check of the image while it runs. From the next tick on nothing acts if it is damaged. */
static void watch_image(struct app *app)
{
    if (app->service.image != HAL_IMAGE_WHOLE || hal_image_watch() != HAL_IMAGE_DAMAGED)
        return;
    app->service.image = HAL_IMAGE_DAMAGED;
    service_record(&app->service, EVENT_IMAGE_DAMAGED, NULL, 0.0f, 0);
}

void app_init(struct app *app)
{
    memset(app, 0, sizeof *app);
    service_init(&app->service, &app->supervisor, app->link);
    tick_context_init(app);
    app->service.activate = tick_context_activate;
    app->service.activate_context = app;
    operate_init(&app->operate, &app->service);
    console_init(&app->console, &app->operate);
    app->service.workspace = workspace_start(&app->workspace, hal_workspace(), WORKSPACE_BYTES);
    start_up_init(&app->start_up, &app->service, &app->jobs);
    block_work_add_jobs(&app->supervisor, &app->jobs);
    storage_init(&app->storage, &app->service);
    start_watching(app);
    start_up_resume(&app->start_up, app->tick.restart.was_testing);
}

/* Fits the plan in force to the base tick of a plant that has come; the tick waits for it. */
static void fit_plan_to_plant(struct app *app)
{
    if (!app->service.plan_to_fit)
        return;
    hal_tick_lock();
    service_fit_plan(&app->service);
    tick_context_take_plan(app);
    hal_tick_unlock();
}

/* Does a piece of work that the tick has asked for. Returns true if there was one. */
static bool do_work(struct app *app)
{
    struct service *s = &app->service;
    uint32_t ticks = s->cost.n, start = hal_cycles();
    /* A piece of a block's work must not overlap with a plan that comes into force. */
    if (s->newest != s->in_force && block_work_is_asked(&app->supervisor))
        service_flush(s);
    bool worked = jobs_work(&app->jobs);
    uint32_t cost = hal_cycles() - start;
    if (worked && ticks == s->cost.n) {
        s->work_cost.n++;
        work_sum_add(&s->work_cost.sum, cost);
        if (cost > s->work_cost.highest)
            s->work_cost.highest = cost;
    }
    if (sample_gate_holds(&app->tick.gate) && !jobs_wait(&app->jobs))
        hal_tick_request();
    return worked;
}

void app_background(struct app *app)
{
    app->main_turns++;
    source_main_loop_turns();
    fit_plan_to_plant(app);
    early_resets_poll(&app->early_resets, (uint32_t)hal_clock_ms());
    bool busy = console_poll(&app->console);
    busy = do_work(app) || busy;
    busy = operate_poll(&app->operate) || busy;
    busy = operate_poll_proposals(&app->operate) || busy;
    busy = storage_poll(&app->storage) || busy;
    if (hal_uart_pump(HAL_UART_CONSOLE) != 0 && !hal_uart_sends_alone())
        busy = true;
    if (BOARD_CHECKS && !busy)
        watch_image(app);
    hal_idle(!busy);
}

_Static_assert(APP_KEEP_ALIVE_BYTES == LINK_KEEP_ALIVE_BYTES, "one frame of the link");

size_t app_keep_alive(struct app *app, uint8_t *wire)
{
    return CONFIG_LINK ? plant_link_keep_alive(app->link, wire) : 0;
}

void app_clock(struct app *app, uint32_t now_ms)
{
    source_clock(app, now_ms);
}

void app_tick(struct app *app)
{
    tick_context_run(app);
}
