/* What the main loop and the tick share, and who may touch what.
 *
 *   requests     main -> tick   queue
 *   telemetry    tick -> main   queue
 *   tick_events  tick -> main   queue; events of the main loop go into the history at once
 *   plans        two: one is in force (tick reads), the other is scratch (main writes) until it is handed over by a
 *                REQUEST_APPLY, at which the tick exchanges them. Who wants to edit while one waits has it put into
 *                force first, with what was asked before it: that is what the next tick would begin with
 *
 * Everything else here belongs to the main loop. Supervisor, plant link and samples belong to the tick; the main loop
 * reads single words of them, or copies under hal_tick_lock.
 */
#ifndef REFLUX_SERVICE_SERVICE_H
#define REFLUX_SERVICE_SERVICE_H

#include "base/event.h"
#include "hal/io.h"
#include "io/plant_link.h"
#include "io/samples.h"
#include "service/event_log.h"
#include "service/telemetry.h"
#include "supervise/supervisor.h"

/* Cost of ticks in counts of hal_cycles(), written by the tick: from the first byte of what came on the line for it to its
 * command handed to the line. The receive interrupts, which put bytes into a ring, count where they interrupt that. */
struct tick_cost {
    uint32_t n, last, lowest, highest;
    uint64_t sum;
};

#define PLAN_BUFFERS 2

/* Pieces of work between ticks; one in which a tick came is not measured. Written by the main loop. */
struct work_cost {
    uint32_t n, highest;
};

struct storage;
struct commission;
struct workspace;

struct service {
    struct supervisor *supervisor;
    struct plant_link *link;
    struct io_port io;
    struct samples samples;
    struct request_queue requests;
    struct telemetry telemetry;
    struct event_queue tick_events;
    uint32_t tick_event_count; /* events the tick has put since start */
    struct tick_cost cost;
    struct work_cost work_cost; /* of automatic start-up */
    bool watchdog;
    bool tick_known;               /* the newest plan was made with the tick of a plant */
    volatile bool plan_to_fit;     /* the tick's; the main loop ends it: service_fit_plan() */
    uint8_t image;                 /* enum hal_image; damaged: nothing acts */
    uint8_t early_resets;          /* that led to this start: service/early_resets.h */
    struct storage *storage;       /* storage/storage.h; set by storage_init() */
    struct commission *commission; /* NULL where the board leaves it out */
    struct workspace *workspace;   /* likewise */

    struct plan plan[PLAN_BUFFERS];
    /* Indices into plan[]. The tick writes the one, the main loop the other; where they differ the newest waits. */
    uint8_t in_force, newest;
    /* What the tick does first when a plan waits for it; called with the tick locked out. Set by app. */
    void (*activate)(void *context);
    void *activate_context;
    uint32_t serial; /* of the newest plan */

    bool staging;         /* between begin and apply: service_staged() is the transaction's */
    bool staged_proposal; /* ... and automatic start-up's proposal was put into it */
    uint8_t expected_mode[CONFIG_LOOPS]; /* once all queued requests are carried out */

    struct event_log history;
    uint32_t announced;   /* events before this one have been printed */
    uint32_t unannounced; /* events the history lost before they could be printed */
};

void service_init(struct service *s, struct supervisor *supervisor, struct plant_link *link);

/* The plan everything asked now will meet: the pending one if there is one. Main loop. */
const struct plan *service_plan(const struct service *s);
/* The plan the tick works with. */
static inline const struct plan *service_in_force(const struct service *s)
{
    return &s->plan[s->in_force];
}

/* A plan that waits for the tick comes into force now. Until the main loop makes the next one, the states of supervisor
 * and plan in force stay where they are. */
void service_flush(struct service *s);
/* The configuration being edited, in the scratch plan. */
struct config *service_staged(struct service *s);
/* Begins with a copy of service_plan(). A plan that waits for the tick comes into force now; telemetry rows that
 * wait to be printed under other columns are given up, and counted. */
struct config *service_stage(struct service *s);
/* Mode a loop will have once the queued requests are carried out. */
enum loop_mode service_mode(const struct service *s, uint8_t loop);

/* What service_apply() would say of the configuration now; the scratch plan is built from it, nothing is queued. */
MUST_CHECK enum err service_check(struct service *s, const struct config *config,
                                  struct config_fault *fault);
/* Checks the configuration whole and queues it for the next tick. Errors as plan_build, ERR_STATE when it would
 * disturb a sequence under way, and ERR_BUSY when the request queue is full or
 * another plan waits that has come since service_stage() (*fault then has no group). */
MUST_CHECK enum err service_apply(struct service *s, const struct config *config,
                                  struct config_fault *fault);
/* Base tick the plant announces, s; 0 before one has come. */
float service_plant_tick_s(const struct service *s);
/* Is the plan's base tick the interval of the connected plant's samples? Loops computed with another one
 * would act with wrong times: with such a plant none leaves manual. */
bool service_tick_fits(const struct service *s, const struct plan *plan);
/* "ff1.dead": the parameter a refusal is about. */
void service_fault_name(const struct config_fault *fault, struct text *t);
/* Tick context, when a plant has come: does the plan in force wait for the base tick of the plant, and have another one? Then the main
 * loop has to fit it (app.c), and no tick runs before. */
bool service_plan_to_fit(struct service *s);
/* Main loop, with the tick locked out: the plan in force, and one that waits, for the base tick that the plant announces, where the
 * configuration leaves it open. Where that cannot be, CONFIG_REFUSED says why and the plan stays whole for the tick it was made
 * for, which does not fit: no setting is lost, and nothing acts. */
void service_fit_plan(struct service *s);
/* Queues a request that has been checked with service_plan(), and puts that plan's serial on it. ERR_BUSY when the queue is full. */
MUST_CHECK enum err service_request(struct service *s, const struct request *request);

/* Can the loop leave manual: are its channels announced, with the right unit? *what gets the channel's
 * name, *wanted the reason in words. ERR_STATE no plant, ERR_UNKNOWN not announced, ERR_UNIT, ERR_CONFLICT
 * cascade without an outer loop, ERR_UNSUPPORTED served by a block of a kind that this build lacks. */
MUST_CHECK enum err service_may_act(struct service *s, uint8_t loop, enum loop_mode mode,
                                    const char **what, const char **wanted);

/* The same for a manipulated variable, to be moved by hand. */
MUST_CHECK enum err service_output_there(struct service *s, uint8_t output, const char **what,
                                         const char **wanted);

/* Tick context: swaps in the pending plan if there is one. */
void service_take_pending(struct service *s);

/* Moves events from the queue into the history, whether or not anybody listens. */
void service_keep_events(struct service *s);
/* The next event to announce; false when there is none. */
bool service_next_event(struct service *s, struct event *event);
/* Writes an event of the main loop, or an action (EVENT_DO_...), into the history, at the present plant time. */
void service_record(struct service *s, enum event_code code, const char *subject, float value,
                    uint8_t detail);
/* One more of an event whose value is how many there were: those of one start share an entry of the history, under the
 * time of the first, so that many of them push nothing out. A new entry begins after an event `until`. */
void service_record_one_more(struct service *s, enum event_code code, enum event_code until);
/* Plant time, from the main loop. */
uint64_t service_time_ms(const struct service *s);

/* Index of an announced channel, or PLAN_NONE. Caller is in the tick context or holds hal_tick_lock. */
uint8_t service_find_announced(const struct service *s, bool manipulated, const char *name);

#endif
