/* A run in lockstep. At plant time T, in this order:
 *
 *   1. events with time <= T
 *   2. console lines with time <= T, each waiting for its reply (the link is kept alive meanwhile)
 *   3. sample T is taken and sent; it waits for its command and, while telemetry is on, for its row
 *   4. one row of the log
 *   5. actuators move under the command, the plant goes on by one tick
 *
 * With a plant at the board's own pins (pins_side.h) sensors have sample T over the tick from T on, and the command is what the loads were in it.
 * The board's clock goes on by a tick between one sample and the next. What is at the link beside them (rest_side.h) is one tick behind.
 *
 * Nothing but the order of these steps decides the result, so the same run gives the same log however fast the
 * controller is. A controller that restarts is greeted again, its console put back into machine mode, telemetry
 * switched on again if it was on, and the sample under way repeated: plant time stands still meanwhile.
 */
#ifndef REFLUX_HOST_SIM_LOCKSTEP_H
#define REFLUX_HOST_SIM_LOCKSTEP_H

#include <signal.h>

#include "bench/console_driver.h"
#include "bench/events.h"
#include "bench/progress.h"
#include "bench/script.h"
#include "bench/sim_log.h"
#include "link_server.h"
#include "pins_side.h"
#include "rest_side.h"

enum lockstep_result { RUN_DONE, RUN_FAILED, RUN_INTERRUPTED };

struct lockstep {
    /* set up by the owner */
    const struct plant_class *class;
    struct plant *plant;
    struct instruments *instruments;
    struct events *events;
    struct link_server *link;
    struct pins_side *pins;  /* NULL: the plant is at the link */
    struct rest_side *rest;  /* NULL: what is at no pin is nowhere */
    struct console *console; /* NULL: none */
    struct script *script;
    struct sim_log *log;
    struct progress *progress;
    uint32_t tick_ms;
    double duration_s; /* negative: without end */
    double speed; /* plant seconds per second of the wall or a virtual board; 0 = without limit */
    uint64_t timeout_ms;
    const volatile sig_atomic_t *interrupted;

    /* the run */
    uint32_t number; /* sample under way */
    uint64_t time_ms;
    uint64_t samples; /* answered */
    uint32_t greetings_seen;
    uint32_t session_seen, introductions_seen;
    bool met; /* a controller was greeted */
    uint32_t restarts;
    bool ended; /* by the script */
    double wall_began;
    double pace_began; /* by the clock of the pace, at plant time 0 */
    double wall_s;
    char error[400]; /* of RUN_FAILED */
};

enum lockstep_result lockstep_run(struct lockstep *k);

/* The same run in pieces, for an owner who decides between two samples what comes next. Greets the controller; then lines
 * and samples in any order. Each returns RUN_DONE, or RUN_FAILED with k->error; nothing may follow a failure. */
enum lockstep_result lockstep_begin(struct lockstep *k);
/* Sends one console line before the sample to come and waits for its reply, which is in k->console: REPLY_ERR is no failure. */
enum lockstep_result lockstep_line(struct lockstep *k, const char *text);
/* Steps 1 to 5 at the present plant time. */
enum lockstep_result lockstep_step(struct lockstep *k);

#endif
