/* All that the supervisor remembers from tick to tick, and what is asked of it: data only. What moves it: supervise/supervisor.h.
 *
 * Owners: requests and their queue belong to the main loop until they are taken; struct proposal_slot and struct switch_off_slot to
 * whom their state names; everything else to the tick. The main loop reads single words, or copies under hal_tick_lock. */
#ifndef REFLUX_EXCHANGE_STATE_H
#define REFLUX_EXCHANGE_STATE_H

#include "base/event.h"
#include "base/job.h"
#include "exchange/plan.h"
#include "exchange/sequence_state.h"
#include "signal/lag.h"
#include "signal/ramp.h"

enum loop_mode { LOOP_MANUAL = 0, LOOP_AUTO = 1, LOOP_CASCADE = 2 };

enum supervisor_state {
    SUPERVISOR_SAFE =
        0, /* after a restart or a fault: outputs at safe values until an operator acts */
    SUPERVISOR_RUN = 1
};

enum request_kind {
    REQUEST_MODE,
    REQUEST_SETPOINT,
    REQUEST_OUTPUT, /* up to here: loop_request.h */
    REQUEST_APPLY,
    REQUEST_ACK,      /* output: index of the alarm, PLAN_NONE all */
    REQUEST_SHELVE,   /* the same, for `value` seconds; 0 ends it */
    REQUEST_SEQUENCE, /* mode: enum sequence_command; output: row that was shown */
    REQUEST_BLOCK,    /* output: which block with a record, from 0; mode: 1 on, 0 off */
    REQUEST_VERB /* output: likewise; mode: which verb of its kind; loop: 1 with a number, `value` */
};

/* Loops, outputs and alarms are named by their places in the plan it was checked with. That is in force when its turn
 * comes, since plans and requests wait in one queue; were it another, the request is refused. */
struct request {
    enum request_kind kind;
    uint8_t loop;   /* MODE, SETPOINT, OUTPUT of a loop */
    uint8_t output; /* OUTPUT of a manipulated variable without a loop; else PLAN_NONE */
    uint8_t mode;   /* enum loop_mode */
    uint32_t plan;  /* serial of that plan */
    float value;    /* EU, checked by whoever asks */
};

#ifndef REQUEST_QUEUE_SIZE
#define REQUEST_QUEUE_SIZE 32 /* power of two */
#endif

struct request_queue {
    struct spsc index;
    struct request slot[REQUEST_QUEUE_SIZE];
};

struct reading {
    float value; /* EU */
    enum quality quality;
};

/* What a tick is given, in the order of the configuration's channels. */
struct tick_input {
    uint64_t time_ms;
    struct reading
        measurement[CHANNEL_MAX];         /* QUALITY_MISSING where the plant has no such channel */
    struct reading readback[CHANNEL_MAX]; /* what was applied before this sample */
};

/* Why a reading is not valid. Detail of EVENT_MEASUREMENT_BAD; words in supervise/alarms.c. */
enum measurement_fault {
    MEASUREMENT_FINE,
    MEASUREMENT_MISSING,
    MEASUREMENT_FLAGGED,
    MEASUREMENT_NOT_A_NUMBER,
    MEASUREMENT_OUT_OF_RANGE,
    MEASUREMENT_TOO_FAST,
    MEASUREMENT_FROZEN,
    MEASUREMENT_FAULTS
};

/* A condition that is an alarm once it has lasted. In one word, because every measurement and every loop has one. */
struct lasting {
    uint32_t holds : 1, active : 1;
    uint32_t since_ms : 30; /* plant time, low bits: 12 days, where no delay is longer than 1e6 s */
};
#define LASTING_MS 0x3FFFFFFFu

/* What a board may lack of the states below is a struct that is empty there. */
#if CONFIG_CALIBRATION
struct reading_watch {          /* supervise/watch.h */
    uint8_t young;              /* readings for which the first valid one may still prove wrong */
    uint8_t twin, twin_changes; /* a measurement that sends the same numbers; how many so far */
};
#else
struct reading_watch {
};
#endif
#if CONFIG_STEPS
struct offset_state {
    bool on; /* the configured offset is subtracted from readings */
};
#else
struct offset_state {
};
#endif
#if CONFIG_LOOP_GUARD
struct guard_timer { /* supervise/deviations.h */
    struct lasting lasting;
};
#else
struct guard_timer {
};
#endif
#if CONFIG_ANALYSERS
struct analyser_state { /* of a measurement with `every` above 1 */
    uint64_t sample_ms; /* plant time at which its last sample came */
    uint32_t turn;      /* the base tick of that */
    bool fresh;         /* a reading was looked at in this tick */
};
#else
struct analyser_state {
};
#endif
#if CONFIG_BLOCKS
struct estimate_state { /* of a measurement that a block writes */
    bool stands_in;     /* it was valid at the end of the last tick */
    float value;        /* ... with this value, EU */
};
struct served_loop { /* of a loop that a block serves */
    num_t applied;   /* what took effect of v */
    num_t excite,
        excited; /* the block's test signal on the setpoint: asked for, and in `setpoint` */
};
struct event_alarm {
    float value; /* of the event of a block, when it was last raised */
};
#else
struct estimate_state {
};
struct served_loop {
};
struct event_alarm {
};
#endif

struct measurement_state {
    bool bound;        /* the plant announces it with the configured unit */
    bool seen;         /* there has been a usable value */
    bool valid;        /* ... and a reading that was valid */
    bool lost;         /* no valid reading for longer than sensor_hold_s */
    bool delivered;    /* `last` is a reading */
    bool alarm : 1;    /* reported as bad */
    bool inferred : 1; /* `value` is made from something else, by meas.infer */
    bool doubted : 1;  /* an estimate that no loop may act on: it has long been uncertain */
    uint8_t fault;     /* enum measurement_fault of the last reading */
    struct reading_watch watch;
    struct offset_state offset;
    enum quality quality;     /* of `value` */
    struct guard_timer doubt; /* it is uncertain while a loop acts on it */
    float raw;   /* last reading that was good by the plant, valid or not, less the offset, EU */
    num_t value; /* validated and filtered, fraction of span */
    struct lag filter;
    float last_valid;    /* last valid reading, EU */
    float last;          /* last number delivered, as the plant sends it */
    uint64_t valid_ms;   /* plant time at which `good` came */
    uint64_t changed_ms; /* plant time at which `last` came to its value */
    struct analyser_state analyser;
    struct estimate_state estimate;
};

struct mv_state {
    bool bound;
    bool sent;          /* a command has gone out since the safe state was taken */
    bool interlocked;   /* an interlock holds it */
    bool beyond;        /* an interlock left it outside its limits, and nobody has moved it since */
    bool not_following; /* read-back differs from the command */
    bool alarm;         /* ... and has been reported */
    num_t manual;       /* value while nothing acts on it */
    num_t excitation;   /* test signal in `commanded`; 0 where none is */
    num_t commanded;    /* before constrain */
    num_t constrained;  /* sent to the plant */
    num_t applied;      /* constrained, or the read-back where the plant does something else */
    num_t readback;     /* last good read-back, one sample late */
    struct ramp rate;   /* where the rate limit is */
    uint64_t differs_ms; /* plant time since when it does not follow */
};

struct loop_state {
    enum loop_mode mode;
    bool transfer_pending; /* the block must take over the output it finds before it runs next */
    bool moved;  /* its own output has another meaning now: it goes on from the output it finds */
    bool drives; /* in this tick its output is a block's: blocks.h */
    bool downstream_inactive; /* its output reaches nothing: the loop below does not listen */
    bool
        sp_given; /* the target is the operator's, or was in force: kept in manual unless sp_track */
    struct guard_timer deviation; /* the PV is far from the setpoint */
    num_t target;                 /* setpoint asked for */
    num_t setpoint;               /* in force, after limits, ramp and filter */
    struct ramp ramp;
    struct lag filter;
    num_t v; /* output of the block, before decoupler and feedforward */
    struct served_loop served;
    num_t feedforward;
    uint8_t clamp;   /* enum integral_clamp, from the loop it drives */
    uint8_t limited; /* the same: limits of its block that its output is at */
};

/* A block in force: where its state is, and what the tick remembers of it. */
struct block_state {
    uint16_t grain, grains; /* first one in the arena, and how many */
    uint8_t kind;           /* in block_kinds[]; PLAN_NONE = there is none */
    bool retune : 1;        /* new settings wait for the step that the old ones still make */
    bool stepped : 1;       /* it has not been told yet what became of its last step */
    bool off : 1;         /* it has given up, or was switched off: the loops' own controllers act */
    bool must_follow : 1; /* before its next step */
    bool running : 1;     /* a feedforward element: has begun on a usable value */
    uint8_t acting;       /* of a compensator: members that take part */
    uint8_t going_on;     /* ... and did so in the last tick */
};

#if CONFIG_BLOCKS
/* What clients are told of a block with a record. */
struct served_state {
    const char *gave_up; /* why it is off, in a word; NULL: this input of it was bad */
    uint8_t input;
    uint8_t silenced; /* terms of an element that added nothing in its last step */
    uint16_t raised
        : BLOCK_EVENTS_MAX;  /* bit k: the k-th event of its kind held in its last step */
    uint16_t on_pending : 1; /* it was told to come on in the midst of a piece of its work */
};
_Static_assert(BLOCK_EVENTS_MAX < 16, "a bit for each, and one more");

/* What a block excites: block_excitation.h. */
struct excited {
    uint8_t what, index; /* EXCITE_MV: which; EXCITE_SETPOINT: of which loop */
    num_t amplitude, lo, hi;
};

struct excite_answer {
    uint8_t state, reason;
};

struct excitation_state {
    uint8_t holder; /* number of the block that excites, from 1; 0 = none */
    uint8_t targets;
    struct excite_answer answer[CONFIG_BLOCKS]; /* what became of each block's asking */
    uint32_t modes;                             /* of all loops when it began, two bits each */
    uint32_t asked;                             /* tick of the last asking */
    struct excited target[BLOCK_EXCITES_MAX];
};

/* A proposal on its way from the tick, which writes it while the place is free, to the main loop, which frees it. */
enum proposal_state {
    PROPOSAL_FREE,
    PROPOSAL_GIVEN,  /* in a step, under the plan `plan` */
    PROPOSAL_SEEN,   /* by the main loop, which has not been able to check it yet */
    PROPOSAL_OFFERED /* right so far: somebody has to accept it */
};
struct proposal_slot {
    _Atomic uint8_t state; /* enum proposal_state */
    uint8_t block;
    _Atomic bool withdrawn; /* by its block: the main loop, which may be reading it, frees it */
    uint32_t plan;          /* serial */
    struct block_proposal content;
};

/* A switch-off on its way from the tick, which has silenced the element and writes it while the place is free, to the main loop, which
 * makes it settings. */
enum switch_off_state {
    SWITCH_OFF_FREE,
    SWITCH_OFF_GIVEN,
    SWITCH_OFF_STAGED,  /* its values are in the open transaction */
    SWITCH_OFF_APPLIED, /* ... which has come into force with them */
    SWITCH_OFF_LIFTED   /* ... with others: the tick lets the element act, and frees the place */
};
struct switch_off_slot {
    _Atomic uint8_t state; /* enum switch_off_state */
    uint8_t kind;          /* of the block that gave it: place in block_kinds[] */
    struct block_switch_off content;
};
#define SILENCED_BYTES (1 + CONFIG_BLOCKS) /* a bit for each switch_off_element() and term */
_Static_assert(CONFIG_FEEDFORWARDS <= ELEMENT_TERMS, "their bits fit a byte");

/* Which block a job works for. */
struct supervisor_work {
    struct supervisor *supervisor;
    uint8_t slot;
};
#else
struct served_state {
};
struct excitation_state {
};
struct proposal_slot {
};
struct switch_off_slot {
};
struct supervisor_work {
};
#define SILENCED_BYTES 0
#endif

/* supervise/alarms.h */
struct alarm_state {
    bool condition;    /* holds now, delay over */
    bool listed;       /* on the list: holds, or is latched */
    bool acknowledged; /* ... and somebody has seen it */
    bool first;        /* came before the others of its group; until all of them are off the list */
    bool pending;      /* condition holds, delay running */
    struct event_alarm event;
    uint64_t since_ms;
    uint64_t shelved_until_ms; /* 0 = not shelved */
};

struct interlock_state {
    bool active;
    bool pending;      /* condition holds, or did and nothing was heard since; delay running */
    uint32_t heard_ms; /* low bits of the plant time at which it was last heard to hold */
    uint64_t since_ms;
};

/* What has as many places in the arena as the plan reaches. */
enum placed {
    PLACED_MEASUREMENTS,
    PLACED_MVS,
    PLACED_LOOPS,
    PLACED_INTERLOCKS,
    PLACED_ALARMS,
    PLACED_KINDS
};

struct supervisor {
    const struct plan *plan; /* NULL before the first */
    struct event_queue *events;
    enum supervisor_state state;
    char safe_reason
        [CHANNEL_NAME_SIZE]; /* what the safe state was last taken for; empty since the start */
    uint32_t safe_count;     /* times it was taken, again and again in silence; wraps */
    bool testing;            /* somebody tests the plant (commission): no sequence begins */
    uint64_t time_ms;        /* of the last tick */
    uint32_t ticks;
    float tick_s; /* base tick the states were placed for */
    /* In the arena. Index i, below placed[], is that of the plan; what the plan does not use is zero or not there. */
    uint8_t placed[PLACED_KINDS];
    struct measurement_state *measurement;
    struct mv_state *mv;
    struct loop_state *loop;
    struct interlock_state *interlock;
    struct alarm_state *alarm;
    struct sequence sequence;
    struct block_state block[PLAN_BLOCKS]; /* by slot, as in the plan */
    struct job work[CONFIG_BLOCKS];        /* of blocks with a record */
    struct supervisor_work worker[CONFIG_BLOCKS];
    uint16_t history[PLAN_POINTS]; /* of each MV, as in the plan; they stand behind the blocks */
    struct excitation_state excitation;
    struct served_state served[CONFIG_BLOCKS];
    struct proposal_slot proposal;
    struct switch_off_slot switch_off[CONFIG_BLOCKS]; /* of each block */
    uint8_t silenced[SILENCED_BYTES];
    _Alignas(8) num_t arena[PLAN_ARENA_BYTES / sizeof(num_t)];
};

/* The state of the block in a slot of the plan in force. */
static inline void *supervisor_block(const struct supervisor *s, uint8_t slot)
{
    REFLUX_ASSERT(slot < PLAN_BLOCKS && (uint32_t)s->block[slot].grain + s->block[slot].grains <=
                                            PLAN_ARENA_BYTES / ARENA_GRAIN);
    return (uint8_t *)s->arena + s->block[slot].grain * ARENA_GRAIN;
}

#if CONFIG_BLOCKS
/* element: switch_off_element() or switch_off_term(). */
static inline bool element_is_silenced(const struct supervisor *s, uint8_t element)
{
    return element / ELEMENT_TERMS < SILENCED_BYTES &&
           (s->silenced[element / ELEMENT_TERMS] & 1u << element % ELEMENT_TERMS) != 0;
}
/* The kind of the block that excites the plant now, or NULL. While start-up tests (`testing`) none can. */
static inline const char *supervisor_excited_by(const struct supervisor *s)
{
    uint8_t holder = s->excitation.holder;
    return holder ? plan_kind(s->plan, (uint8_t)(SLOT_RECORDS + holder - 1u))->name : NULL;
}
/* The setpoint in force without a test signal. */
static inline num_t loop_own_setpoint(const struct loop_state *l)
{
    return num_sub(l->setpoint, l->served.excited);
}
/* What took effect of the output of a loop that a block serves. */
static inline void loop_applied(struct loop_state *l, num_t v)
{
    l->served.applied = v;
}
/* Slot of the block in whose hands loop i is, or PLAN_NONE: its own controller's. */
static inline uint8_t loop_server(const struct supervisor *s, uint8_t i)
{
    uint8_t slot = s->plan->loop[i].server;
    return slot == PLAN_NONE || s->block[slot].off ? (uint8_t)PLAN_NONE : slot;
}
#else
#define element_is_silenced(s, element) ((void)(s), (void)(element), false)
#define supervisor_excited_by(s)        ((void)(s), (const char *)NULL)
#define loop_own_setpoint(l)            ((l)->setpoint)
#define loop_applied(l, v)              ((void)(l), (void)(v))
#define loop_server(s, i)               ((void)(s), (void)(i), (uint8_t)PLAN_NONE)
#endif

/* The offset subtracted from readings of a measurement now, EU. */
#if CONFIG_STEPS
static inline float measurement_offset_in_force(const struct measurement_state *m,
                                                const struct measurement_config *c)
{
    return m->offset.on ? c->offset.eu : 0.0f;
}
static inline bool measurement_offset_is_on(const struct measurement_state *m)
{
    return m->offset.on;
}
static inline float measurement_offset_of(const struct measurement_config *c)
{
    return c->offset.eu;
}
#else
#define measurement_offset_of(c)          ((void)(c), 0.0f)
#define measurement_offset_in_force(m, c) ((void)(m), (void)(c), 0.0f)
#define measurement_offset_is_on(m)       ((void)(m), false)
#endif

/* The last reading is good by the plant: it is a number, valid or not. After validation. */
static inline bool measurement_is_good(const struct measurement_state *m)
{
    return m->bound && m->fault != MEASUREMENT_MISSING && m->fault != MEASUREMENT_FLAGGED &&
           m->fault != MEASUREMENT_NOT_A_NUMBER;
}

/* A loop may act on its value. */
static inline bool measurement_may_control(const struct measurement_state *m)
{
    return !m->doubted && quality_usable(m->quality);
}

/* LOOP_MANUAL for a loop beyond those of the plan. */
static inline enum loop_mode supervisor_mode(const struct supervisor *s, uint8_t loop)
{
    return loop < s->placed[PLACED_LOOPS] ? s->loop[loop].mode : LOOP_MANUAL;
}

#endif
