/* The parts of the firmware: one struct app, composed in app.c. Each part says which context writes it. The tick is
 * in tick_context.c, the binding of channels in binding.c, the main loop in app.c. */
#ifndef REFLUX_APP_PARTS_H
#define REFLUX_APP_PARTS_H

#include "app/start_up.h"
#include "base/job.h"
#include "base/workspace.h"
#include "console/console.h"
#include "io/board_io.h"
#include "io/both_io.h"
#include "io/sample_gate.h"
#include "service/early_resets.h"
#include "service/heartbeat.h"
#include "storage/storage.h"
#include "supervise/restart.h"

/* Time-outs of the watchdog. A board whose own outputs are in use has the short one, because they must be off 2 s after the last command even
 * where its clock hangs: the reset is what switches them off then, and the watchdog's own clock, 32 kHz, may be as slow as 17. So a board that
 * can have outputs begins with it, and has the long one once it is known that its plant is at the link. */
#define WATCHDOG_MS       2000
#define WATCHDOG_PINS_MS  1000
#define WATCHDOG_FIRST_MS (CONFIG_DEVICES != 0 ? WATCHDOG_PINS_MS : WATCHDOG_MS)

/* The plan's channels in the plant's tables. The tick writes it (binding.c). */
struct binding {
    uint32_t generation; /* generation of the channel table to which the plan is bound */
    enum io_state io_state;
    uint8_t measurement_index[CHANNEL_MAX], output_index[CHANNEL_MAX];
    bool announce_pending; /* a plan has come into force that is neither announced nor bound yet */
};

/* State of the tick. The tick writes it (tick_context.c). */
struct tick_context {
    uint64_t silent_tick_ms;      /* board time of the last tick in silence */
    struct io_command command;    /* last one sent */
    bool driven[IO_CHANNELS_MAX]; /* outputs of this plant that have been commanded */
    struct restart restart;
    struct heartbeat heartbeat;
    struct sample_gate gate;
};

struct app {
    struct supervisor supervisor;
    struct plant_link link[CONFIG_LINK];
    struct board_io board_io; /* its devices and outputs: the board clock steps them */
    struct both_io both_io;   /* the tick, while io.source is `both` */
    struct service service;
    struct operate operate;
    struct console console;
    struct binding binding;
    struct tick_context tick;
    struct early_resets early_resets;
    struct storage storage;
    struct jobs jobs;
    struct workspace workspace;
    struct start_up start_up;
    volatile uint32_t main_turns; /* turns of the main loop, for the tick's heartbeat */
};

/* ---- tick context ---- */

/* Handles link input, the tick when a sample is due, and silence of the link: app_tick(). */
void tick_context_run(struct app *app);
/* Binds the channels of the plan in force to those of the plant, as far as it has them. */
void binding_bind(struct app *app);
/* Announces a plan that has come into force, and binds its channels before anything else acts. It announces several
 * plans that came between two ticks once. */
void binding_announce(struct app *app);
/* Unbinds the outputs that are bound to this one of the plant and to those after it. */
void binding_lose_outputs(struct app *app, uint8_t first);
#if CONFIG_DEVICES
/* Has the plant where the plan in force says it is: at the link, at the board's pins, or at both. */
void binding_take_source(struct app *app);
/* Whether a plan has changed the plant's tables since binding_follow_plant() looked. */
bool source_changed(const struct app *app);
/* Binds anew what is at the link where its plant has come, gone or changed beside the board's own pins, which go on. Readings of a plant that
 * has gone are missing, as those of a sensor that fails. Nobody knows what its outputs do, so their loops go to manual. */
void source_follow_link(struct app *app);
/* Board clock. */
void source_clock(struct app *app, uint32_t now_ms);
/* Main loop: has turned, which outputs of kind `enable` want to know. */
void source_main_loop_turns(void);
#else
static inline void binding_take_source(struct app *app)
{
    (void)app;
}
static inline bool source_changed(const struct app *app)
{
    (void)app;
    return false;
}
static inline void source_follow_link(struct app *app)
{
    (void)app;
}
static inline void source_clock(struct app *app, uint32_t now_ms)
{
    (void)app;
    (void)now_ms;
}
static inline void source_main_loop_turns(void) {}
#endif
/* Follows the plant: if it has come, gone or changed, all bindings to the old one are void. Returns false if the
 * plan cannot change yet, because a piece of a block's work is under way, or because the main loop must fit the
 * plan to the plant's tick first. */
bool binding_follow_plant(struct app *app);

/* ---- main loop: the doors into the tick context; the state behind them belongs to the tick ---- */

/* Before the tick runs: initialises the tick's parts, and takes the first plan. */
void tick_context_init(struct app *app);
/* Before the tick runs, when the cause of the start is known: initialises the restart and the watchdog's heartbeat. */
void tick_context_start(struct app *app, enum hal_reset cause);
/* With the tick locked out: takes the requests that the next tick would begin with, up to the last plan that waits. */
void tick_context_activate(void *app);
/* With the tick locked out: takes the plan in force again, whose base tick has changed, and announces it. */
void tick_context_take_plan(struct app *app);

#endif
