/* A block is what computes: a controller, a compensator, a feedforward element, an estimator. Every family of blocks
 * is one `struct block_kind`; the tick knows blocks only by it (docs/architecture.md).
 *
 * All signals are num_t fractions of span. A block serves members: the loops whose outputs it gives. Arrays hold one
 * entry per member, in the order of the members.
 *
 *     stage           step                                      back_calculate
 *     estimate        inputs in, points out                     -
 *     control         setpoints and PVs in, outputs out         the outputs that took effect, as step gave them
 *     compensate      outputs of the controllers in, MVs out    a difference of MVs in, of controllers' outputs out
 *     feed forward    the disturbance in, what is added out     -
 *
 * Within a tick a controller that acts gets step, and back_calculate once what became of the step is known; one that
 * does not act (manual, an interlock, a start) gets follow instead: its state is set so that the next step with the
 * same inputs gives the outputs in effect (bumpless transfer). An estimator gets follow before its first step, and before the
 * first after the plant was away: what it remembers may be of another plant, or hours old.
 *
 * Compensators and elements with a record (blockN) run in every base tick. A compensator gets step while one of its members
 * acts, and back_calculate once after each, with differences of 0 where nothing was limited, which have to come to 0. When its
 * members, which of them act, its settings, or what stands behind it change it gets follow: MVs in, the controllers' outputs
 * out for which the next step gives these MVs; what is under way in it for the members in `going_on` goes on. An element gets
 * follow before its first step: it begins at rest at its inputs.
 */
#ifndef REFLUX_BLOCK_BLOCK_H
#define REFLUX_BLOCK_BLOCK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "block/applied_history.h"
#include "block/excitation.h"
#include "block/proposal.h"
#include "block/settings.h"
#include "num/num.h"
#include "signal/integral_clamp.h"

enum block_stage { STAGE_ESTIMATE, STAGE_CONTROL, STAGE_COMPENSATE, STAGE_FEED_FORWARD };

/* What a block of several members does without one of its further inputs, and an element without any. */
enum block_bad_input {
    BAD_INPUT_GIVES_UP, /* the loops' own controllers take over; a compensator is passed over, an element adds nothing */
    BAD_INPUT_MANUAL, /* its members go to manual; of an element the loops on its MVs */
    BAD_INPUT_IS_TOLD /* it is told by their quality, and has a fall-back of its own */
};

/* What the configuration says of a member, beside the kind's own settings. */
struct block_member {
    uint8_t loop; /* its index */
    bool
        drives_mv; /* its output moves an MV, which keeps the limits of the loop; else it is a setpoint */
    float pv_span; /* EU */
    float
        out_reach; /* the largest |MV less feedforward|, fraction of span; of a compensator with another behind it no bound */
};

/* What fractions of it are of. */
struct block_signal {
    float lo, hi; /* EU */
    bool is_mv;   /* else a measurement */
};

#define BLOCK_SIGNALS(n) (CONFIG_BLOCKS ? (n) : 0) /* a board without blocks needs none */

struct block_setup {
    const void *settings; /* of the kind: block/settings.h, or the struct its parameters fill */
    float interval_s;     /* of its steps, [0.001, 1e5] s */
    uint8_t members;      /* up to BLOCK_MEMBERS_MAX */
    uint8_t present;      /* bit k: there is a member k */
    uint8_t inputs, points;
    struct block_member member[BLOCK_MEMBERS_MAX];
    /* Of blocks with a record. Where any of these has another span the block begins without a past. */
    struct block_signal pv[BLOCK_SIGNALS(BLOCK_MEMBERS_MAX)]; /* of the members */
    struct block_signal input[BLOCK_SIGNALS(BLOCK_INPUTS_MAX)];
    struct block_signal
        point[BLOCK_SIGNALS(BLOCK_POINTS_MAX)]; /* of an element the MVs it adds to */
    /* Settings of the block that it names, NULL: it names nobody. A state may keep it until it is configured again, which it
     * is whenever this changes; what is there was accepted by its own kind's check() only if this one's accepts it as well. */
    const void *named;
    bool named_other; /* of the kind's other_kind */
};

/* Why settings were refused. */
struct block_fault {
    uint8_t member;     /* the first that is concerned */
    const char *field;  /* as the parameter is called; "" when it is the interval */
    const char *wanted; /* what would be right, in words */
    bool must_be;       /* wanted is a range: in words it is "must be" and that */
};

/* What a block is given and gives, by role. Arrays have an entry for each member, input, point, or event of the kind. */
struct block_members {
    uint8_t acting;        /* bit k: member k has the block's output */
    const num_t *setpoint; /* of controllers */
    /* PVs; what goes into a compensator; of an element its inputs */
    const num_t *in;
    /* outputs: given by step, told to back_calculate, follow and shift; what an element adds, for each point */
    num_t *out;
    const uint8_t *clamp; /* enum integral_clamp, back_calculate */
    uint8_t *limited;     /* enum integral_clamp: limits of its own that its output is at */
    /* Blocks with a number (blockN), in step: */
    /* What took effect of the member's MV, where the kind keeps a history; NULL of a member that drives a loop. */
    const struct applied_history **applied;
    uint8_t going_on; /* of a compensator, follow: acting members that also did in the last step */
    uint16_t divisor; /* base ticks of a step */
};

#if CONFIG_BLOCKS
struct block_inputs {
    const num_t *value;
    const uint8_t
        *quality; /* enum quality; nothing that was held or made up is good for an estimator */
    const float *age_s; /* since the last valid reading was sampled, s; 0 of an MV */
    /* What took effect of an input that is an MV, where the kind keeps a history; NULL of a measurement. */
    const struct applied_history **applied;
};

struct block_points {
    num_t *value;     /* given */
    uint8_t *quality; /* enum quality, given; QUALITY_MISSING where it is not */
};

struct block_requests {
    bool work_done;   /* what was asked of work() is there: once */
    bool work_wanted; /* asked for before, and not over yet: asking again is in vain */
    /* given: work() is wanted, and its result taken after so many steps; 0 = no */
    uint8_t ask_work;
    /* given: why, in a word; the loops' own controllers take over, in this step already; an element adds nothing from this step
     * on, of a compensator the MVs stay for this tick, and are passed over it from the next on. It may do so in back_calculate
     * and follow as well. */
    const char *gives_up;
    /* a step may put one there; NULL: another waits (block/proposal.h) */
    struct block_proposal *proposal;
    bool withdraws; /* given: what it has proposed and nobody has accepted holds no longer */
    /* a step may put one there; NULL: its last one waits (block/proposal.h) */
    struct block_switch_off *switch_off;
    uint8_t silenced;   /* of an element, bit k: term k is switched off, and adds nothing */
    uint16_t raised;    /* given: bit k: the k-th of the kind's events holds in this step */
    float *event_value; /* given with it, in the unit its words name */
    /* Test signals: [BLOCK_EXCITES_MAX] given, in every step anew; EXCITE_NOTHING where it is not */
    struct block_excitation *excite;
    uint8_t excite_state;      /* enum excite_state: what became of the last asking */
    uint8_t excite_reason;     /* enum excite_reason, of EXCITE_REFUSED and EXCITE_ENDED */
    const char *excite_holder; /* who excites the plant now, in a word, or NULL */
};
#else
struct block_inputs {
};
struct block_points {
};
struct block_requests {
};
#endif

struct block_io {
    struct block_members members;
    struct block_inputs inputs;
    struct block_points points;
    struct block_requests requests;
};

enum block_value { BLOCK_FLOAT, BLOCK_U16, BLOCK_WORD };

/* A parameter of a kind, `blockN.name` at the console: where it is in the struct of the kind's settings. With rows * cols
 * above 1 it is a table, row by row, its rows called blockN.name.1 and so on. */
struct block_parameter {
    uint8_t id;      /* 1..127, unique in its kind, never used again for something else */
    uint8_t type;    /* enum block_value: float, uint16_t, uint8_t */
    uint16_t offset; /* in the struct of settings, a multiple of the value's size */
    uint16_t rows, cols;
    const char *name;
    const char *unit; /* of a BLOCK_WORD the words, "off|on" */
    const char *help;
    float lo, hi, initial;
};

/* Names of verbs and events have up to so many letters, digits and _: "block2.identify" is as long as a name may be. */
#define BLOCK_WORD_MAX 8

enum block_access { ACCESS_OPERATOR, ACCESS_ENGINEER };

/* What may be asked of a block of the kind: `block N NAME [NUMBER]` at the console. */
struct block_verb {
    const char *name;   /* neither "on" nor "off" */
    const char *number; /* what the number behind it is, "s"; NULL: it takes none */
    const char *help;
    float lo, hi;         /* allowed */
    bool may_lack_number; /* it also does without one */
    uint8_t access;       /* enum block_access */
    /* In the tick, before the block's step, also while none of its members acts; not while the block is off. number: NULL where
     * none was given. It has no time to compute: what is long is asked for as work by the next step. Returns NULL, or why not,
     * in a word. */
    const char *(*run)(void *state, const float *number);
};

#define BLOCK_EVENTS_MAX 12

enum block_event_level { BLOCK_INFO, BLOCK_ALARM };

/* What a block of the kind may say: that something has begun to hold, or happens. It is told once, with its value, in the
 * first of the steps in a row in which its bit of block_io.requests.raised is set. An entry of the alarms on `blockN.CODE` is on
 * the list while the bit is set; a block that makes no steps raises nothing, but for what it raised when it gave up. */
struct block_event {
    const char *code; /* "drift" */
    uint8_t level;    /* enum block_event_level */
    const char
        *words; /* with the unit of its value: "the model has left the plant, fraction of span" */
};

/* What the setpoint of a loop does when the loop above it loses the estimate that it acts on, EU of that setpoint. Both 0: the setpoint
 * is again what it was when the cascade began, and there is no limit. */
struct block_return {
    float setpoint; /* it returns to this one */
    float
        within; /* while the estimate is not good the setpoint stays this near to the last one with a good estimate; 0: anywhere */
};

struct block_kind {
    const char *name; /* "pid" */
    uint8_t stage;    /* enum block_stage */
    /* Bit a: it is a loop's own controller where the parameter `algorithm` has its a-th word. */
    uint8_t algorithms;
    /* New settings of a controller that acts hold at once. Otherwise they wait until the old ones have made the next
     * step: only then is that output, whatever moves meanwhile, what they would have given. */
    bool retunes_at_once;
    /* Its outputs are positions, not a range: an output found between or outside out_lo and out_hi stays until it acts. */
    bool positions;
    /* Why its outputs pass through no compensator, in words; NULL: they may. */
    const char *uncompensated;

    /* What it may be given by blockN.kind; none where it has parameters of another group (block/settings.h). */
    const struct block_parameter *parameter;
    uint8_t parameters;
    uint16_t settings_bytes; /* of the struct they fill, a multiple of 4 */
    /* They are a table: they stand in one of few places once (exchange/tables.h), not in every configuration. */
    bool table;
    /* The id of the parameter, a BLOCK_U16, with which it names a block of the kind `named_kind`, whose settings are put
     * into its setup; 0: there is none. The value 0 names nobody. */
    uint8_t names;
    const char *named_kind;
    const char *other_kind; /* it may be of that as well; NULL: no */
    /* How many it may have. Inputs are further points it reads, points those it writes. */
    uint8_t members_most, inputs_most, points_most;
    uint8_t bad_input; /* enum block_bad_input */
    /* Of an estimator: place in the settings of a struct block_return for each of its points; 0: it has none. */
    uint16_t returns;
    /* How many of its own steps the history of applied inputs goes back for these settings: of the MVs that its members
     * drive, and of those among its inputs. 0, or NULL: it needs none. */
    uint16_t (*history)(const struct block_setup *setup);
    /* A piece of background work, of a bounded number of instructions; true while there is more. The tick may come between
     * any two of its instructions, and leaves alone what it works on while work is wanted. */
    bool (*work)(void *state);
    const struct block_verb *verb;
    uint8_t verbs;
    const struct block_event *event;
    uint8_t events; /* up to BLOCK_EVENTS_MAX */

    /* Bytes of state these settings need; settings that are refused need none. */
    uint32_t (*bytes)(const struct block_setup *setup);
    /* Checks everything. Where something is refused *fault says what. */
    enum err (*check)(const struct block_setup *setup, struct block_fault *fault);
    /* Settings that check() accepts. retune: new ones for the same members, inputs and points in as many bytes, without a
     * bump; else the state begins without a past. */
    enum err (*configure)(void *state, const struct block_setup *setup, bool retune);
    /* Whether two setups of the same members and interval come to the same: then nothing is configured again. NULL: of a
     * record where all its bytes are the same, otherwise never. */
    bool (*same)(const struct block_setup *before, const struct block_setup *now);
    void (*step)(void *state, struct block_io *io);
    void (*back_calculate)(void *state, struct block_io *io);
    /* Of an estimator it may be NULL; of a compensator whose back_calculate does for values as well. */
    void (*follow)(void *state, struct block_io *io);
    /* Controllers that act: `out` gets another meaning (another compensator, another feedforward). The next step gives
     * io->members.out and what has changed since the last one; what is under way goes on. */
    void (*shift)(void *state, struct block_io *io);
    /* Compensators: only the acting members take part from now on. Returns whether that is a change, after which
     * all of them need a bumpless transfer. One with a record may do without: follow and step are told which act. */
    bool (*select)(void *state, const void *settings, uint8_t acting);
    /* The i-th named inner value, for the console: NULL past the end. */
    const char *(*describe)(const void *state, size_t i, float *value);
};

/* All kinds of this build: app/kinds.c. A kind is known by its place. */
extern const struct block_kind *const block_kinds[];
extern const uint8_t block_kind_count;

#endif
