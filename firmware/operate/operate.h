/* The one door: everything a client may ask of the controller is judged here, and what was done is written into the
 * history as an action. The console is a client; so would be a field bus or a web page. Sequences run in the tick and do not
 * pass it.
 *
 * Rules
 *  1. Main loop only. Each client has a session; nothing here knows what kind of client it is.
 *  2. A function answers with a code. ERR_OK: done, or queued for the next tick, and an event then reports the result. Else
 *     nothing has changed, and *answer says what it is about and why.
 *  3. Loops and manipulated variables are given by their places in operate_settings(); PLAN_NONE and what is not
 *     configured are ERR_UNKNOWN.
 *  4. save and load take longer than a turn of the main loop: operate_result(). How far a start-up or a sequence is can be
 *     looked at any time.
 *  5. Who opened a transaction has it: to others it is ERR_BUSY, but every engineer may abandon it.
 */
#ifndef REFLUX_OPERATE_OPERATE_H
#define REFLUX_OPERATE_OPERATE_H

#include "commission/commission.h"
#include "design/tuning.h"
#include "service/service.h"
#include "settings/parameters.h"

struct session;

#define NO_PLANT "no plant is connected"

/* Settings as they were before a proposal of a block came into force. */
struct way_back {
    uint8_t n, block; /* values; 0: there is none */
    uint32_t shape;   /* of the settings they belong to */
    struct proposed_value value[PROPOSAL_MAX];
};

/* The last proposal that was refused: the parameter, or the block, and what would be right. */
struct refused_proposal {
    bool known;
    uint8_t block;
    float value; /* that was proposed */
    struct config_fault fault;
};

/* The door's memory of proposals of blocks. On a board without blocks it is empty. */
#if CONFIG_BLOCKS
struct operate_proposals {
    /* Checksum of the loops, blocks and spans that a waiting proposal was made for, and the plan that was last found to have it. */
    uint32_t shape, shape_serial;
    struct way_back back;
    struct refused_proposal refused;
};
#else
struct operate_proposals {
};
#endif

struct operate {
    struct service *service;
    const struct session *editor; /* who opened the transaction; meaningless while none is open */
    /* Last wrong key, board time, low bits, and for how long no other key is tried; 0: none. Whoever tries. */
    uint32_t wrong_ms, wrong_wait_ms;
    struct operate_proposals proposals;
};

/* A client. */
struct session {
    struct operate *door;
    bool engineer;        /* has opened the engineer level, or used it while there was no key */
    uint8_t waits_for;    /* enum operate_wait */
    uint32_t engineer_ms; /* last act on the engineer level, board time, low bits */
};

enum operate_wait {
    WAITS_FOR_NOTHING,
    WAITS_TO_SAVE,
    WAITS_TO_REPLACE,
    WAITS_SAVING,
    WAITS_TO_LOAD
};

/* The part of an answer beside subject and words. */
enum answer_more {
    ANSWER_PLAIN,
    ANSWER_RANGE,  /* range: the value was refused, the allowed ones lie from lo to hi; no words */
    ANSWER_CONFIG, /* config: the settings do not fit together; no words, no subject */
    ANSWER_VALUE,  /* value: no value for that parameter; no words, no subject */
    ANSWER_PLACES, /* value: larger boards have that parameter's place; no words */
    ANSWER_WAIT,   /* wait_ms: until the next key may be tried; no words */
    ANSWER_TAKEN,  /* workspace: somebody else has it, and says what frees it; no words */
    ANSWER_VERBS   /* kind: no such verb, its own are those; no words */
};

/* The texts it points to stay until the next call. */
struct answer {
    const char *subject; /* NULL: none */
    const char *words;   /* NULL: err_text() of the code says all there is to say */
    enum answer_more more;
    union {
        struct {
            float value, lo, hi;
            const char *unit;
        } range;
        struct config_fault config;
        struct {
            struct parameter parameter;
            const char *text;      /* NULL: it was given as a number */
            uint32_t needed, free; /* bytes for the settings of a kind, ERR_FULL */
        } value;
        uint32_t wait_ms;
        const struct workspace *workspace;
        const struct block_kind *kind;
    };
};

void operate_init(struct operate *door, struct service *service);
void session_init(struct session *session, struct operate *door);

/* Once a turn, by each client: closes the engineer level when nobody has used it for long enough. */
void session_poll(struct session *session);

/* Settings in force: names by index are of these. */
static inline const struct config *operate_in_force(const struct session *session)
{
    return &service_in_force(session->door->service)->config;
}
/* Settings that apply to a request made now. */
static inline const struct config *operate_settings(const struct session *session)
{
    return &service_plan(session->door->service)->config;
}

/* ---- access: access.c ---- */

bool operate_is_engineer(const struct session *session);
/* Begins every act of the engineer level; the answer is about `act`. ERR_LOCKED. */
MUST_CHECK enum err operate_admit(struct session *session, const char *act, struct answer *answer);
/* *left_s: full seconds until the engineer level closes by itself, where there is a key. False: it does not. */
bool operate_closes_in_s(const struct session *session, uint32_t *left_s);
static inline bool operate_has_key(const struct session *session)
{
    return operate_settings(session)->console_key[0] != '\0';
}
/* ERR_LOCKED: not the key. ERR_BUSY: too soon after a wrong key, whichever client tried it. */
MUST_CHECK enum err operate_unlock(struct session *session, const char *key, struct answer *answer);
/* ERR_STATE: there is no key. */
MUST_CHECK enum err operate_lock(struct session *session, struct answer *answer);
/* "-": none. Engineer. Errors as operate_set(). */
MUST_CHECK enum err operate_key(struct session *session, const char *key, struct answer *answer);
/* Engineer. The client restarts the board when its answer is out. */
MUST_CHECK enum err operate_reboot(struct session *session, struct answer *answer);

/* ---- loops: loops.c ---- */

/* A loop as an operator sees it, EU. */
struct loop_reading {
    enum loop_mode mode;
    const struct measurement_config *pv;
    const struct mv_config *mv; /* NULL: it drives the setpoint of a loop */
    uint8_t inner;              /* ... this one */
    float value, setpoint, output;
    enum quality quality; /* of `value` */
};

/* In force. False: there is no such loop. */
bool operate_loop(const struct session *session, uint8_t loop, struct loop_reading *reading);
MUST_CHECK enum err operate_find_loop(const struct session *session, const char *name,
                                      uint8_t *loop, struct answer *answer);
/* ERR_STATE, ERR_UNKNOWN, ERR_UNIT, ERR_CONFLICT as service_may_act(); ERR_BUSY: the queue is full. */
MUST_CHECK enum err operate_mode(struct session *session, uint8_t loop, enum loop_mode mode,
                                 struct answer *answer);
/* EU. ERR_RANGE; ERR_STATE: not the operator's in this mode; ERR_BUSY. */
MUST_CHECK enum err operate_setpoint(struct session *session, uint8_t loop, float value,
                                     struct answer *answer);
/* EU, of a manipulated variable or, where that is PLAN_NONE, of a loop; the loop in manual. Errors as both above. */
MUST_CHECK enum err operate_output(struct session *session, uint8_t loop, uint8_t output,
                                   float value, struct answer *answer);

enum tuning_rule { TUNE_SIMC, TUNE_COHEN_COON, TUNE_COHEN_COON_PID, TUNING_RULES };
/* Settings of a loop from a model of its process: gain in EU/EU, times in s. lambda_s: of TUNE_SIMC. Nothing is set.
 * Errors as the rules (design/tuning.h). */
MUST_CHECK enum err operate_tune(const struct session *session, uint8_t loop, enum tuning_rule rule,
                                 const struct fopdt *process, float lambda_s, struct tuning *tuning,
                                 struct answer *answer);

#if CONFIG_PEOPLE
/* Would these settings come into force? Within a transaction only their ranges are looked at. ERR_RANGE; errors as operate_set(). */
MUST_CHECK enum err operate_check_tuning(struct session *session, uint8_t loop,
                                         const struct tuning *tuning, struct answer *answer);
#endif

/* ---- blocks with a number (blockN): blocks.c ---- */

enum block_work { BLOCK_IDLE, BLOCK_WORKS, BLOCK_WORK_LATE };

struct block_reading {
    const struct block_kind *kind; /* NULL: this build lacks it, or had no room for it */
    const char *name;              /* of the kind */
    /* Why it is off: "asked", an input, or a word of the kind; NULL: it is on. */
    const char *gave_up;
    enum block_work work; /* done between ticks for it */
    uint16_t raised;      /* bit k: the k-th event of its kind holds */
    bool excites;         /* the plant, with a test signal */
};

/* In force; blocks count from 0. False: there is no such block. */
bool operate_block(const struct session *session, uint8_t block, struct block_reading *reading);
/* "2", "block2", or a kind that one block alone is of. ERR_UNKNOWN, ERR_CONFLICT: several are. */
MUST_CHECK enum err operate_find_block(const struct session *session, const char *name,
                                       uint8_t *block, struct answer *answer);
/* ERR_UNKNOWN, ERR_UNSUPPORTED: this build lacks the kind; ERR_STATE: it is an estimator; ERR_BUSY. */
MUST_CHECK enum err operate_block_switch(struct session *session, uint8_t block, bool on,
                                         struct answer *answer);
/* ERR_UNKNOWN: *answer has the kind, whose verbs are those there are; ERR_UNSUPPORTED. */
MUST_CHECK enum err operate_find_verb(const struct session *session, uint8_t block,
                                      const char *name, uint8_t *verb, struct answer *answer);
/* The verb at that place of its kind. number: NULL where none is given. Some are the engineer's: ERR_LOCKED. Errors as
 * operate_find_verb(), and ERR_PARSE: a number is wanted, or none is; ERR_RANGE; ERR_STATE: the block is off; ERR_BUSY. */
MUST_CHECK enum err operate_verb(struct session *session, uint8_t block, uint8_t verb,
                                 const float *number, struct answer *answer);
/* The i-th inner value of what runs, and its name; NULL past the last. */
const char *operate_block_value(const struct session *session, uint8_t block, unsigned i,
                                float *value);

/* ---- proposals of blocks (block/proposal.h): proposals.c ---- */

#if CONFIG_BLOCKS
/* Once a turn of the main loop: checks what a block has proposed, and puts it into force where nobody must accept it. Returns
 * whether there was anything to do. */
bool operate_poll_proposals(struct operate *door);

/* The parameter of an id in a proposal; p->col: which value of a row. ERR_UNKNOWN. */
MUST_CHECK enum err operate_find_proposed(const struct config *config, uint32_t id,
                                          struct parameter *p);

struct proposal_reading {
    enum proposal_state state; /* of the one that waits */
    uint8_t block, values;
    /* Nobody must accept it, but it waits for the end of an open transaction, a sequence, a save or start-up. */
    bool at_once;
    const struct way_back *back;            /* NULL: there is none */
    const struct refused_proposal *refused; /* NULL: the last one was not */
};
/* False: there is nothing to show. */
bool operate_proposal(const struct session *session, struct proposal_reading *reading);
/* Value k of the one that waits. False: past the last, or no such parameter. */
bool operate_proposed(const struct session *session, unsigned k, struct parameter *p, float *value);
/* Row k of what blocks have switched off in the tick: of that which is not in force yet, or, with `applied`, of that which the transaction
 * just applied has brought with it, until the next turn. False: past the last, or no such parameter. */
bool operate_switched_off(const struct session *session, bool applied, unsigned k, uint8_t *block,
                          struct parameter *p, float *value);
/* Engineer, all of them. ERR_STATE: there is none, or a transaction is open; ERR_BUSY: not now; ERR_CONFLICT: other loops, blocks
 * or spans since; errors of service_apply(), and it waits on. */
MUST_CHECK enum err operate_proposal_accept(struct session *session, struct answer *answer);
MUST_CHECK enum err operate_proposal_reject(struct session *session, struct answer *answer);
/* The values there were before the last one that came into force, in one. */
MUST_CHECK enum err operate_proposal_back(struct session *session, struct answer *answer);

#else
static inline bool operate_poll_proposals(struct operate *door)
{
    (void)door;
    return false;
}
#endif

/* ---- settings: settings.c, transaction.c ---- */

/* The open transaction's, or those that apply to a request made now. */
const struct config *operate_view(const struct session *session);
static inline bool operate_is_open(const struct session *session)
{
    return session->door->service->staging;
}
/* ERR_UNKNOWN, ERR_UNSUPPORTED: larger boards have it. */
MUST_CHECK enum err operate_find_parameter(const struct session *session, const char *name,
                                           struct parameter *p, struct answer *answer);
/* Engineer, all of them. ERR_STATE: one is open already, or none is. */
MUST_CHECK enum err operate_begin(struct session *session, struct answer *answer);
MUST_CHECK enum err operate_abandon(struct session *session, struct answer *answer);
/* The transaction whole; errors as service_apply(), and it stays open to be mended. */
MUST_CHECK enum err operate_apply(struct session *session, struct answer *answer);
/* One parameter, in words; within a transaction it waits for operate_apply(). Errors as operate_find_parameter(),
 * parameter_set() and service_apply(). */
MUST_CHECK enum err operate_set(struct session *session, const char *name, const char *value,
                                struct answer *answer);
/* The same as a number, of a word its place in the list. */
MUST_CHECK enum err operate_set_number(struct session *session, const struct parameter *p,
                                       float value, struct answer *answer);
/* Does the open transaction change it? */
bool operate_changes(const struct session *session, const struct parameter *p);

/* ---- stored settings: stored.c. Engineer ---- */

/* Of operate_save(): also over what newer firmware has stored; also where the brown-out reset is off (ERR_STATE without it). */
#define SAVE_REPLACE 1u
#define SAVE_UNSAFE  2u

/* ERR_OK: begun; operate_result() tells how it ends. ERR_BUSY: this client waits for another. */
MUST_CHECK enum err operate_save(struct session *session, unsigned how, struct answer *answer);
MUST_CHECK enum err operate_load(struct session *session, struct answer *answer);
/* Once a turn of the main loop while operate_waits(); what was asked for is over when that is false, and then this is how it
 * ended. Errors as storage_save(), storage_result(), storage_load(), service_apply(). */
MUST_CHECK enum err operate_result(struct session *session, struct answer *answer);
static inline bool operate_waits(const struct session *session)
{
    return session->waits_for != WAITS_FOR_NOTHING;
}
#if CONFIG_PEOPLE
/* ERR_OK: operate_differs() can compare. ERR_BUSY: the stored settings are being read or written. ERR_EMPTY. */
MUST_CHECK enum err operate_may_compare(struct session *session, struct answer *answer);
/* Does a parameter of operate_view() differ from the stored one? Writes the stored value. */
bool operate_differs(const struct session *session, const struct parameter *p, struct text *stored);
#endif
/* Every parameter at its default, but the key; within a transaction it waits for operate_apply(). */
MUST_CHECK enum err operate_defaults(struct session *session, struct answer *answer);

/* ---- alarms: alarms.c ---- */

/* By the name of its entry (alarm_name()), or "alarm3"; NULL: all of them. ERR_UNKNOWN, ERR_BUSY. */
MUST_CHECK enum err operate_acknowledge(struct session *session, const char *name,
                                        struct answer *answer);
#define SHELVE_WANTED "expected 0 to 86400 s; 0 ends the shelving"
/* One of them, for 0 .. 86400 s; 0 takes it off the shelf. ERR_UNKNOWN, ERR_RANGE, ERR_BUSY. */
MUST_CHECK enum err operate_shelve(struct session *session, const char *name, float seconds,
                                   struct answer *answer);

/* Releases an interlock, "lock2", that its latch alone holds. ERR_UNKNOWN, ERR_STATE, ERR_BUSY. interlocks.c, on boards with
 * CONFIG_LOOP_GUARD. */
MUST_CHECK enum err operate_release(struct session *session, const char *name,
                                    struct answer *answer);

/* ---- sequences: sequences.c ---- */

/* "start", as the history names it. */
const char *operate_sequence_word(enum sequence_command what);
/* ERR_STATE; ERR_LOCKED: skip is the engineer's; ERR_BUSY. */
MUST_CHECK enum err operate_sequence(struct session *session, enum sequence_command what,
                                     struct answer *answer);

/* ---- automatic start-up: startup.c ---- */

#if COMMISSION_CHANNELS
/* Once a turn of the main loop: puts the old settings back where a trial has failed. Returns whether there was anything to do. */
bool operate_poll(struct operate *door);
/* Returns true while a trial of what start-up has proposed is running or rolling back. */
static inline bool operate_start_up_on_trial(const struct service *s)
{
    return commission_is_on_trial(s->commission);
}
#else
static inline bool operate_poll(struct operate *door)
{
    (void)door;
    return false;
}
static inline bool operate_start_up_on_trial(const struct service *s)
{
    (void)s;
    return false;
}
#endif
static inline bool operate_is_in_acceptance(const struct session *session)
{
    return operate_start_up_on_trial(session->door->service);
}
/* "begin", as the history names it; NULL: nothing a client may ask for so. */
const char *operate_startup_word(enum commission_ask what);
/* BEGIN, PAUSE, RESUME, SKIP, REPEAT, ABORT, REJECT. Pause and abort are everybody's, the others the engineer's.
 * ERR_LOCKED, ERR_STATE, ERR_BUSY (also: somebody else has the workspace), and those of commission_may_begin(). */
MUST_CHECK enum err operate_startup(struct session *session, enum commission_ask what,
                                    struct answer *answer);
/* Engineer. A relay test of one loop. Errors as commission_may_relay(). */
MUST_CHECK enum err operate_relay(struct session *session, uint8_t loop, struct answer *answer);
/* Engineer. The proposal, or the open transaction it was put into, goes into force on trial. Errors as commission_may_try(),
 * proposal_write(), service_apply(). */
MUST_CHECK enum err operate_accept(struct session *session, struct answer *answer);
/* Engineer. Opens a transaction with the proposal in it. */
MUST_CHECK enum err operate_edit(struct session *session, struct answer *answer);

/* Engineer. The kept loops are watched for so many hours. ERR_RANGE: hours, above 0 to KEPT_WATCH_HOURS_MOST; ERR_STATE: no trial has
 * kept loops, or its results are gone. */
MUST_CHECK enum err operate_watch(struct session *session, float hours, struct answer *answer);
/* Engineer. Discards the results: the workspace is free. ERR_STATE: under way, or there are no results. */
MUST_CHECK enum err operate_discard(struct session *session, struct answer *answer);
/* A client calls it when it has shown some of the results: others may have their place in the workspace then. */
void operate_startup_shown(const struct session *session);

/* The progress of start-up. */
struct startup_reading {
    enum commission_phase phase;
    bool proposal;                   /* one waits to be accepted, edited or rejected */
    enum commission_reason reason;   /* it ended, or the trial failed */
    char subject[CHANNEL_NAME_SIZE]; /* what `reason` is about, or empty */
};
struct startup_reading operate_startup_reading(const struct session *session);

#endif
