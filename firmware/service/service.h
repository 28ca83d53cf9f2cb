/* Data that the main loop and the tick share, and who may touch it.
 *
 *   requests     main -> tick   queue
 *   telemetry    tick -> main   queue
 *   tick_events  tick -> main   queue; events of the main loop go into the history at once
 *   plans        two: the tick reads the one in force, the main loop writes the other (scratch). A REQUEST_APPLY hands
 *                the scratch plan over, and the tick then exchanges them. An edit while a plan waits first puts that
 *                plan into force, with the requests before it, as the next tick would
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

/* Cost of ticks in counts of hal_cycles(), written by the tick. A tick counts from the first byte of its sample on the line until it
 * hands its command to the line. Receive interrupts, which put bytes into a ring, count where they interrupt that. */
struct tick_cost {
    uint32_t n, last, lowest, highest;
    uint64_t sum;
};

#define PLAN_BUFFERS 2

/* Cost of all pieces of work together, in thousands and what is left of them. */
#if COMMISSION_CHANNELS
struct work_sum {
    uint32_t thousands, rest;
};
#else
struct work_sum {
};
#endif

/* Cost of pieces of work between ticks, written by the main loop. A piece that a tick interrupts does not count. */
struct work_cost {
    uint32_t n, highest;
    struct work_sum sum;
};

#if COMMISSION_CHANNELS
static inline void work_sum_add(struct work_sum *w, uint32_t cost)
{
    uint32_t sum = w->rest + cost;
    w->thousands += sum / 1000u;
    w->rest = sum % 1000u;
}
#else
static inline void work_sum_add(struct work_sum *w, uint32_t cost)
{
    (void)w;
    (void)cost;
}
#endif

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
    uint32_t tick_event_count; /* events that the tick has put since the start */
    struct tick_cost cost;
    struct work_cost work_cost; /* cost of automatic start-up */
    bool watchdog;
    bool tick_known;               /* the newest plan was made with the tick of a plant */
    volatile bool plan_to_fit;     /* set by the tick; service_fit_plan() clears it */
    uint8_t image;                 /* enum hal_image; damaged: nothing acts */
    uint8_t early_resets;          /* resets before this start (service/early_resets.h) */
    struct storage *storage;       /* storage/storage.h; storage_init() sets it */
    struct commission *commission; /* NULL where the board leaves it out */
    struct workspace *workspace;   /* likewise */

    struct plan plan[PLAN_BUFFERS];
    /* Indices into plan[]. The tick writes in_force, the main loop newest. Where they differ, the newest plan waits. */
    uint8_t in_force, newest;
    /* Puts the waiting plan into force, as the tick does first. Called with the tick locked out. app sets it. */
    void (*activate)(void *context);
    void *activate_context;
    uint32_t serial; /* serial number of the newest plan */

    bool staging;         /* between begin and apply: service_staged() is the transaction's */
    bool staged_proposal; /* ... and it has the proposal of automatic start-up in it */
    /* Modes of the loops once the tick has carried out all queued requests. */
    uint8_t expected_mode[CONFIG_LOOPS];

    struct event_log history;
    uint32_t announced;   /* sequence number of the next event to print */
    uint32_t unannounced; /* events that the history lost before anybody printed them */
};

void service_init(struct service *s, struct supervisor *supervisor, struct plant_link *link);

/* Returns the newest plan, which a request of now will meet: the waiting one if there is one. Main loop. */
const struct plan *service_plan(const struct service *s);
/* Returns the plan that the tick works with. */
static inline const struct plan *service_in_force(const struct service *s)
{
    return &s->plan[s->in_force];
}

/* Puts a plan that waits for the tick into force now. Until the main loop makes the next plan, the states of the supervisor
 * and the plan in force keep their places. */
void service_flush(struct service *s);
/* Returns the configuration being edited, in the scratch plan. */
struct config *service_staged(struct service *s);
/* Begins an edit: puts a waiting plan into force and copies service_plan() into service_staged(), which it returns. It drops
 * and counts telemetry rows that wait to be printed under other columns. */
struct config *service_stage(struct service *s);
/* Returns the mode that a loop will have once the tick has carried out the queued requests. */
enum loop_mode service_mode(const struct service *s, uint8_t loop);

/* Returns the error that service_apply() would return now. It builds the scratch plan but queues nothing. */
MUST_CHECK enum err service_check(struct service *s, const struct config *config,
                                  struct config_fault *fault);
/* Checks the whole configuration and queues it for the next tick. Errors as plan_build(). ERR_CONFLICT: the base tick does
 * not fit the plant. ERR_STATE: it would disturb a sequence under way. ERR_BUSY: the request queue is full, or another plan
 * waits that has come since service_stage(); *fault then has no group. */
MUST_CHECK enum err service_apply(struct service *s, const struct config *config,
                                  struct config_fault *fault);
/* Returns the base tick that the plant announces, s; 0 before a plant has come. */
float service_plant_tick_s(const struct service *s);
/* Returns whether the plan's base tick is the interval of the connected plant's samples. With another base tick loops
 * would act with wrong times, so no loop may leave manual. */
bool service_tick_fits(const struct service *s, const struct plan *plan);
/* Writes the name of the refused parameter, "ff1.dead". */
void service_fault_name(const struct config_fault *fault, struct text *t);
/* Returns whether the plan in force takes its base tick from the plant and has another one. Then the main loop must fit the plan
 * (app/app.c), and no tick runs before. Call in the tick context when a plant has come. */
bool service_plan_to_fit(struct service *s);
/* Fits the plan in force, and a waiting one, to the base tick that the plant announces, where the configuration leaves it open. Where
 * a plan cannot have that tick, CONFIG_REFUSED says why and the plan keeps its old base tick. No setting is lost then, and nothing
 * acts, because the tick does not fit. Call in the main loop with the tick locked out. */
void service_fit_plan(struct service *s);
/* Queues a request that the caller has checked with service_plan(), and adds the serial of that plan. ERR_BUSY: the queue is full. */
MUST_CHECK enum err service_request(struct service *s, const struct request *request);

/* Checks that the loop can leave manual: the plant announces its channels, with the right units. *what gets the name of the
 * channel, *wanted the reason in words. ERR_STATE: no plant, plant time stands still, or the firmware is damaged.
 * ERR_UNKNOWN: a channel is not announced. ERR_UNIT.
 * ERR_CONFLICT: cascade without an outer loop, or another base tick. ERR_UNSUPPORTED: the loop is served by a block whose kind
 * this build lacks. */
MUST_CHECK enum err service_may_act(struct service *s, uint8_t loop, enum loop_mode mode,
                                    const char **what, const char **wanted);

/* Checks the same for a manipulated variable that somebody wants to move by hand. */
MUST_CHECK enum err service_output_there(struct service *s, uint8_t output, const char **what,
                                         const char **wanted);

/* Puts the waiting plan into force, if there is one. Tick context. */
void service_take_pending(struct service *s);

/* Moves events from the queue into the history, also while nobody reads the console. */
void service_keep_events(struct service *s);
/* Gets the next event to announce. Returns false where there is none. */
bool service_next_event(struct service *s, struct event *event);
/* Writes an event of the main loop, or an action (EVENT_DO_...), into the history, at the present plant time. */
void service_record(struct service *s, enum event_code code, const char *subject, float value,
                    uint8_t detail);
/* Counts one more event of a code whose value is their number. All of one start share an entry of the history, under the
 * time of the first, so that many of them push nothing out. A new entry begins after an event `until`. */
void service_record_one_more(struct service *s, enum event_code code, enum event_code until);
/* Returns the plant time, ms. Main loop. */
uint64_t service_time_ms(const struct service *s);

/* Returns the index of an announced channel, or PLAN_NONE. The caller is in the tick context or holds hal_tick_lock. */
uint8_t service_find_announced(const struct service *s, bool manipulated, const char *name);

#endif
