/* All that the supervisor remembers from tick to tick, and the requests to it. This file is data only;
 * supervise/supervisor.h has the functions.
 *
 * Owners: requests and their queue belong to the main loop until the tick takes them. struct proposal_slot and
 * struct switch_off_slot belong to the context that their state names. Everything else belongs to the tick. The
 * main loop reads single words, or copies under hal_tick_lock. */
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
    /* After a restart or a fault: outputs stay at safe values until an operator acts. */
    SUPERVISOR_SAFE = 0,
    SUPERVISOR_RUN = 1
};

enum request_kind {
    REQUEST_MODE,
    REQUEST_SETPOINT,
    REQUEST_OUTPUT, /* kinds up to this one: loop_request.h */
    REQUEST_APPLY,
    REQUEST_ACK,      /* output: index of the alarm, PLAN_NONE = all */
    REQUEST_SHELVE,   /* output: likewise; `value`: seconds, 0 ends it */
    REQUEST_SEQUENCE, /* mode: enum sequence_command; output: row that was shown */
    REQUEST_BLOCK,    /* output: number of the block (blockN), from 0; mode: 1 on, 0 off */
    /* Output: number of the block, from 0. Mode: which verb of its kind. Loop: 1 with a number, `value`. */
    REQUEST_VERB,
    REQUEST_RELEASE /* output: index of an interlock that its latch alone holds */
};

/* A request to the tick. It names loops, outputs and alarms by their places in the plan with which it was checked.
 * This plan is in force when the request's turn comes, because plans and requests wait in one queue. If another
 * plan is in force, the tick refuses the request. */
struct request {
    enum request_kind kind;
    uint8_t loop;   /* MODE, SETPOINT, OUTPUT of a loop */
    uint8_t output; /* OUTPUT of a manipulated variable without a loop; else PLAN_NONE */
    uint8_t mode;   /* enum loop_mode */
    uint32_t plan;  /* serial of the plan with which it was checked */
    float value;    /* EU; the sender has checked it */
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

/* Inputs of a tick, in the order of the configuration's channels. */
struct tick_input {
    uint64_t time_ms;
    /* QUALITY_MISSING where the plant has no such channel. */
    struct reading measurement[CHANNEL_MAX];
    struct reading readback[CHANNEL_MAX]; /* values applied before this sample */
};

/* Why a reading is not valid. This is the detail of EVENT_MEASUREMENT_BAD; measurement_fault_text() has the words. */
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

/* A condition that becomes an alarm once it has lasted. It takes one word, because every measurement and every loop
 * has one. */
struct lasting {
    uint32_t holds : 1, active : 1;
    uint32_t since_ms : 30; /* plant time, low bits: 12 days, and no delay is longer than 1e6 s */
};
#define LASTING_MS 0x3FFFFFFFu

/* Why the board has put a loop into manual. This is the detail of EVENT_MANUAL_BY_BOARD; loop_guard_words.c has the words. */
enum by_board_cause {
    BY_BOARD_NOT,     /* the loop acts, or somebody has set its mode */
    BY_BOARD_BAD,     /* its measurement was bad */
    BY_BOARD_DOUBTED, /* its measurement was an estimate that was uncertain for long */
    BY_BOARD_UNBOUND, /* the plant lacked its measurement or its output */
    BY_BOARD_BLOCK,   /* a block on it had a bad input, or cannot run */
    BY_BOARD_SAFE,    /* the safe state */
    BY_BOARD_PLAN,    /* new settings made it another loop of the same name */
    BY_BOARD_RESTART, /* a restart brought back outputs, but not its mode */
    BY_BOARD_CAUSES
};

/* States of features that a board may lack. Where the feature is left out, the struct is empty. */
#if CONFIG_CALIBRATION
struct reading_watch { /* supervise/watch.h */
    uint8_t young;     /* readings during which the first valid one may still prove wrong */
    /* Another measurement with the same numbers, and the number of changes it has shared so far. */
    uint8_t twin, twin_changes;
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
struct by_board {                   /* supervise/by_board.h */
    uint8_t cause[CONFIG_LOOPS];    /* enum by_board_cause */
    uint32_t since_s[CONFIG_LOOPS]; /* plant time, s */
};
struct latch_state { /* supervise/latch.h */
    bool alone;      /* the condition is over, and the latch alone holds */
};
#define BY_BOARD_EARLIER UINT32_MAX /* since_s: before the last restart */
#else
struct guard_timer {
};
struct by_board {
};
struct latch_state {
};
#endif
#if CONFIG_ANALYSERS
struct analyser_state { /* for a measurement with `every` above 1 */
    uint64_t sample_ms; /* plant time at which its last sample came */
    uint32_t turn;      /* base tick of that sample */
    bool fresh;         /* the tick has looked at a reading */
};
#else
struct analyser_state {
};
#endif
#if CONFIG_BLOCKS
struct estimate_state { /* for a measurement that a block writes */
    bool stands_in;     /* the estimate was valid at the end of the last tick */
    float value;        /* its value then, EU */
};
struct loop_of_block { /* for a loop that a block serves */
    num_t applied;     /* the part of v that took effect */
    /* The block's test signal on the setpoint: the one it asked for, and the one in `setpoint`. */
    num_t excite, excited;
};
struct event_alarm {
    float value; /* value of a block's event when it was last raised */
};
#else
struct estimate_state {
};
struct loop_of_block {
};
struct event_alarm {
};
#endif

struct measurement_state {
    bool bound;        /* the plant announces it, with the configured unit */
    bool seen;         /* there has been a usable value */
    bool valid;        /* there has been a valid reading since it was bound */
    bool lost;         /* no valid reading for longer than sensor_hold_s */
    bool delivered;    /* `last` is a reading */
    bool alarm : 1;    /* reported as bad */
    bool inferred : 1; /* `value` comes from another source, by meas.infer */
    bool doubted : 1;  /* no loop may act on this estimate, which has long been uncertain */
    uint8_t fault;     /* enum measurement_fault of the last reading */
    struct reading_watch watch;
    struct offset_state offset;
    enum quality quality;     /* quality of `value` */
    struct guard_timer doubt; /* measures how long it has been uncertain while a loop acts on it */
    float raw;   /* last reading that the plant calls good, valid or not, less the offset, EU */
    num_t value; /* validated and filtered, fraction of span */
    struct lag filter;
    float last_valid;    /* last valid reading, EU */
    float last;          /* last number delivered, as the plant sends it */
    uint64_t valid_ms;   /* plant time of the last valid reading, not of an uncertain estimate */
    uint64_t changed_ms; /* plant time at which `last` came to its value */
    struct analyser_state analyser;
    struct estimate_state estimate;
};

struct mv_state {
    bool bound;
    bool sent;        /* a command has gone out since the safe state was taken */
    bool interlocked; /* an interlock holds it */
    bool beyond; /* an interlock has left it outside its limits, and nobody has moved it since */
    bool not_following;  /* read-back differs from the command */
    bool alarm;          /* the difference has been reported */
    num_t manual;        /* value while nothing acts on it */
    num_t excitation;    /* test signal in `commanded`; 0 = none */
    num_t commanded;     /* before constrain */
    num_t constrained;   /* sent to the plant */
    num_t applied;       /* constrained, or the read-back if that differs from the command */
    num_t readback;      /* last good read-back, one sample late */
    struct ramp rate;    /* state of the rate limit */
    uint64_t differs_ms; /* plant time since which it does not follow */
};

struct loop_state {
    enum loop_mode mode;
    bool transfer_pending; /* the block must take over the output it finds before its next step */
    bool moved;  /* its output has another meaning now: it continues from the output it finds */
    bool drives; /* in this tick the loop's output comes from a block: blocks.h */
    /* Its output reaches nothing, because the loop below does not take it. */
    bool downstream_inactive;
    /* The target comes from the operator, or was in force; the loop keeps it in manual unless sp_track is set. */
    bool sp_given;
    struct guard_timer deviation; /* the PV is far from the setpoint */
    num_t target;                 /* setpoint asked for */
    num_t setpoint;               /* in force, after limits, ramp and filter */
    struct ramp ramp;
    struct lag filter;
    num_t v; /* output of the block, before decoupler and feedforward */
    struct loop_of_block of_block;
    num_t feedforward;
    uint8_t clamp;   /* enum integral_clamp, from the loop it drives */
    uint8_t limited; /* enum integral_clamp: limits of its block that the output has reached */
};

/* A block in force: the place of its state, and what the tick remembers of it. */
struct block_state {
    uint16_t grain, grains; /* first grain in the arena, and number of grains */
    uint8_t kind;           /* place in block_kinds[]; PLAN_NONE = no block */
    bool retune : 1;        /* new settings wait until the old ones have made the next step */
    bool stepped : 1;       /* its last step has had no back-calculation yet */
    /* It has given up, or was switched off: the loops' own controllers act. */
    bool off : 1;
    bool must_follow : 1; /* it gets follow before its next step */
    bool running : 1;     /* a feedforward element: it has begun on a usable value */
    uint8_t acting;       /* for a compensator: members that take part */
    uint8_t going_on;     /* those that also took part in the last tick */
};

#if CONFIG_BLOCKS
/* State of a block with a number (blockN) that clients see. */
struct numbered_state {
    const char *gave_up; /* why it is off, in a word; NULL: its input `input` was bad */
    uint8_t input;
    uint8_t silenced; /* terms of a feedforward element that added nothing in its last step */
    /* Bit k: the k-th event of its kind held in its last step. */
    uint16_t raised : BLOCK_EVENTS_MAX;
    uint16_t on_pending : 1; /* it waits for the end of a piece of its work, and then comes on */
};
_Static_assert(BLOCK_EVENTS_MAX < 16, "a bit for each, and one more");

/* An MV or setpoint that a block excites: block_excitation.h. */
struct excited {
    uint8_t what, index; /* index: the MV for EXCITE_MV, the loop for EXCITE_SETPOINT */
    num_t amplitude, lo, hi;
};

struct excite_answer {
    uint8_t state, reason;
};

struct excitation_state {
    uint8_t holder; /* number of the block that excites, from 1; 0 = none */
    uint8_t targets;
    struct excite_answer answer[CONFIG_BLOCKS]; /* answer to each block's last request */
    uint32_t modes; /* modes of all loops when it began, two bits each */
    uint32_t asked; /* tick of the last request */
    struct excited target[BLOCK_EXCITES_MAX];
};

/* A proposal on its way from the tick to the main loop. The tick writes it while the place is free, and the main
 * loop frees the place. */
enum proposal_state {
    PROPOSAL_FREE,
    PROPOSAL_GIVEN,  /* a block gave it in a step, under the plan `plan` */
    PROPOSAL_SEEN,   /* the main loop has seen it, but could not check it yet */
    PROPOSAL_OFFERED /* it passed the check so far, and waits until somebody accepts it */
};
struct proposal_slot {
    _Atomic uint8_t state; /* enum proposal_state */
    uint8_t block;
    /* Its block has withdrawn it. The main loop, which may be reading it, frees it. */
    _Atomic bool withdrawn;
    uint32_t plan; /* serial of the plan under which it was given */
    struct block_proposal content;
};

/* A switch-off on its way from the tick to the main loop. The tick has silenced the feedforward element, and writes the
 * switch-off while the place is free; the main loop turns it into settings. */
enum switch_off_state {
    SWITCH_OFF_FREE,
    SWITCH_OFF_GIVEN,
    SWITCH_OFF_STAGED,  /* its values are in the open transaction */
    SWITCH_OFF_APPLIED, /* the transaction has come into force with these values */
    /* The transaction has come into force with other values. The tick lets the element act, and frees the place. */
    SWITCH_OFF_LIFTED
};
struct switch_off_slot {
    _Atomic uint8_t state; /* enum switch_off_state */
    uint8_t kind;          /* kind of the block that gave it: place in block_kinds[] */
    struct block_switch_off content;
};
#define SWITCH_OFF_BYTES (1 + CONFIG_BLOCKS) /* a bit for each switch_off_of_ff() and term */
_Static_assert(CONFIG_FEEDFORWARDS <= SWITCH_OFF_TERMS, "their bits fit a byte");

/* The block for which a job works. */
struct supervisor_work {
    struct supervisor *supervisor;
    uint8_t block;
};
#else
struct numbered_state {
};
struct excitation_state {
};
struct proposal_slot {
};
struct switch_off_slot {
};
struct supervisor_work {
};
#define SWITCH_OFF_BYTES 0
#endif

/* supervise/alarms.h */
struct alarm_state {
    bool condition;    /* it holds now, and the delay is over */
    bool listed;       /* it is on the list: it holds, or is latched */
    bool acknowledged; /* somebody has acknowledged it */
    /* It came before the others of its group. The mark stays until the whole group is off the list. */
    bool first;
    bool pending; /* it holds, and the delay is running */
    struct event_alarm event;
    uint64_t since_ms;
    uint64_t shelved_until_ms; /* 0 = not shelved */
};

struct interlock_state {
    bool active;
    bool pending; /* the condition holds, or held in the last good reading; the delay is running */
    struct latch_state latch;
    uint32_t heard_ms; /* plant time at which a good reading last met the condition, low bits */
    uint64_t since_ms;
};

/* Kinds of states that have as many places in the arena as the plan needs. */
enum placed {
    PLACED_MEASUREMENTS,
    PLACED_MVS,
    PLACED_LOOPS,
    PLACED_INTERLOCKS,
    PLACED_ALARMS,
    PLACED_KINDS
};

#if COMMISSION_CHANNELS
/* A loop whose own controller has its gain raised for a while: supervise/raise_gain.h. */
struct raised_gain {
    float factor; /* on the gain that the plan gives it; 0 = no loop has one */
    uint8_t loop;
};
#else
struct raised_gain {
};
#endif

struct supervisor {
    const struct plan *plan; /* NULL before the first */
    struct event_queue *events;
    enum supervisor_state state;
    /* Reason for the last safe state; empty since the start. */
    char safe_reason[CHANNEL_NAME_SIZE];
    uint32_t safe_count; /* times the safe state was taken, also repeatedly during silence; wraps */
    bool testing;        /* automatic start-up tests the plant: no sequence begins */
    bool proposal_waits; /* a reset loses the proposal of automatic start-up */
    struct raised_gain raised;
    uint64_t time_ms; /* plant time of the last tick */
    uint32_t ticks;
    float tick_s; /* base tick for which the states were placed */
    /* States in the arena. Index i, below placed[], is the index of the plan; a place that the plan does not use is
     * zero or absent. */
    uint8_t placed[PLACED_KINDS];
    struct measurement_state *measurement;
    struct mv_state *mv;
    struct loop_state *loop;
    struct interlock_state *interlock;
    struct alarm_state *alarm;
    struct by_board by_board;
    struct sequence sequence;
    struct block_state block[PLAN_BLOCKS]; /* as in the plan */
    struct job work[CONFIG_BLOCKS];        /* jobs of the blocks with a number (blockN) */
    struct supervisor_work worker[CONFIG_BLOCKS];
    /* Depth of the history of each MV, base ticks, as in the plan. The histories stand behind the blocks. */
    uint16_t history[PLAN_POINTS];
    struct excitation_state excitation;
    struct numbered_state numbered[CONFIG_BLOCKS];
    struct proposal_slot proposal;
    struct switch_off_slot switch_off[CONFIG_BLOCKS]; /* one for each block */
    uint8_t silenced[SWITCH_OFF_BYTES];
    _Alignas(8) num_t arena[PLAN_ARENA_BYTES / sizeof(num_t)];
};

/* Returns the state of a block of the plan in force. */
static inline void *supervisor_block(const struct supervisor *s, uint8_t block)
{
    REFLUX_ASSERT(block < PLAN_BLOCKS && (uint32_t)s->block[block].grain + s->block[block].grains <=
                                             PLAN_ARENA_BYTES / ARENA_GRAIN);
    return (uint8_t *)s->arena + s->block[block].grain * ARENA_GRAIN;
}

#if CONFIG_BLOCKS
/* Returns true if the feedforward element or term is switched off. element: switch_off_of_ff() or switch_off_term(). */
static inline bool is_switched_off(const struct supervisor *s, uint8_t element)
{
    return element / SWITCH_OFF_TERMS < SWITCH_OFF_BYTES &&
           (s->silenced[element / SWITCH_OFF_TERMS] & 1u << element % SWITCH_OFF_TERMS) != 0;
}
/* Returns the name of the kind of the block that excites the plant now, or NULL. While start-up tests (`testing`)
 * no block can. */
static inline const char *supervisor_excited_by(const struct supervisor *s)
{
    uint8_t holder = s->excitation.holder;
    return holder ? plan_kind(s->plan, (uint8_t)(BLOCK_NUMBERED + holder - 1u))->name : NULL;
}
/* Returns the setpoint in force without a test signal. */
static inline num_t loop_own_setpoint(const struct loop_state *l)
{
    return num_sub(l->setpoint, l->of_block.excited);
}
/* Keeps the part of the output that took effect, for a loop that a block serves. */
static inline void loop_applied(struct loop_state *l, num_t v)
{
    l->of_block.applied = v;
}
/* Returns the blockN that acts for loop i, or PLAN_NONE if its own controller does. */
static inline uint8_t loop_server(const struct supervisor *s, uint8_t i)
{
    uint8_t block = s->plan->server[i];
    return block == PLAN_NONE || s->block[block].off ? (uint8_t)PLAN_NONE : block;
}
#else
#define is_switched_off(s, element) ((void)(s), (void)(element), false)
#define supervisor_excited_by(s)    ((void)(s), (const char *)NULL)
#define loop_own_setpoint(l)        ((l)->setpoint)
#define loop_applied(l, v)          ((void)(l), (void)(v))
#define loop_server(s, i)           ((void)(s), (void)(i), (uint8_t)PLAN_NONE)
#endif

/* Return the offset that is subtracted from readings of a measurement now, EU; whether it is on; and its configured
 * value, EU. */
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

/* Returns true if the last reading is a number that the plant calls good, valid or not. Call it after validation. */
static inline bool measurement_is_good(const struct measurement_state *m)
{
    return m->bound && m->fault != MEASUREMENT_MISSING && m->fault != MEASUREMENT_FLAGGED &&
           m->fault != MEASUREMENT_NOT_A_NUMBER;
}

/* Returns true if a loop may act on the measurement's value. */
static inline bool measurement_may_control(const struct measurement_state *m)
{
    return !m->doubted && quality_usable(m->quality);
}

/* Returns the mode of a loop; LOOP_MANUAL for a loop beyond those of the plan. */
static inline enum loop_mode supervisor_mode(const struct supervisor *s, uint8_t loop)
{
    return loop < s->placed[PLACED_LOOPS] ? s->loop[loop].mode : LOOP_MANUAL;
}

#endif
