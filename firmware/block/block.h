/* A block is what computes: a controller, a compensator, a feedforward element, an estimator. Every family of
 * blocks is one `struct block_kind`, and the tick knows blocks by this struct alone (docs/inside/architecture.md).
 *
 * All signals are num_t fractions of span. A block serves members: the loops whose outputs it gives. Arrays hold
 * one entry per member, in the order of the members.
 *
 *     stage           step                                       back_calculate
 *     estimate        inputs in, points out                      -
 *     control         setpoints and PVs in, outputs out          the outputs that took effect, in the form of step
 *     compensate      outputs of the controllers in, MVs out     a difference of MVs in, of controllers' outputs out
 *     feed forward    the disturbance in, the added value out    -
 *
 * Within a tick a controller that acts gets step, and gets back_calculate once when the outputs that took effect
 * are known. A controller that does not act (manual, an interlock, a start) gets follow instead. Follow sets its
 * state so that the next step with the same inputs gives the outputs in effect (bumpless transfer). A
 * controller with a number gets follow once in every base tick, whatever its divisor, and so also before its first
 * step, in the tick in which it begins to act. So follow sets a state, and must not advance one. An estimator
 * gets follow before its first step, and before its first step after the plant was away, because its state may
 * describe another plant or be hours old.
 *
 * Compensators and feedforward elements run in every base tick. A compensator gets step while one of its members
 * acts, and back_calculate once after each step; where nothing was limited the differences are 0 and must give 0. It
 * gets follow when its members, the set of acting members, its settings, or a compensator behind it change. Follow
 * takes MVs, and returns the controllers' outputs for which the next step gives these MVs; transients for the members
 * in `going_on` continue. A feedforward element gets follow before its first step, and starts at rest at its inputs. */
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

enum block_stage {
    STAGE_CONTROL,
    STAGE_ESTIMATE,
    STAGE_COMPENSATE,
    STAGE_FEED_FORWARD,
    BLOCK_STAGES
};

/* Reaction of a block of several members to the loss of one of its further inputs, and of a feedforward element to the
 * loss of any input. */
enum block_bad_input {
    /* The loops' own controllers take over; a compensator is bypassed, and a feedforward element adds
     * nothing. */
    BAD_INPUT_GIVES_UP,
    /* The members go to manual; for a feedforward element, the loops on its MVs do. */
    BAD_INPUT_MANUAL,
    /* The block sees the quality of its inputs, and has a fallback of its own. */
    BAD_INPUT_IS_TOLD
};

/* Properties of a member that the configuration sets, beside the kind's own settings. */
struct block_member {
    uint8_t loop; /* index of the loop */
    /* The member's output moves an MV, which keeps the limits of the loop; otherwise it is a setpoint. */
    bool drives_mv;
    float pv_span; /* EU */
    /* Largest |MV - feedforward|, fraction of span. For a compensator with another compensator behind it there is
     * no bound. */
    float out_reach;
};

/* Span of a signal: the block sees the signal as fractions of it. */
struct block_signal {
    float lo, hi; /* EU */
    bool is_mv;   /* else a measurement */
};

#define BLOCK_SIGNALS(n) (CONFIG_BLOCKS ? (n) : 0) /* a board without blocks needs none */

struct block_setup {
    /* Settings of the kind: a struct of block/settings.h, or the struct that the kind's parameters fill. */
    const void *settings;
    float interval_s; /* interval of its steps, s, [0.001, 1e5] */
    uint8_t members;  /* up to BLOCK_MEMBERS_MAX */
    uint8_t present;  /* bit k: member k exists */
    uint8_t inputs, points;
    struct block_member member[BLOCK_MEMBERS_MAX];
    /* These three are set for blocks with a number (blockN). If one of these spans changes, the block starts
     * without a past. */
    struct block_signal pv[BLOCK_SIGNALS(BLOCK_MEMBERS_MAX)]; /* PVs of the members */
    struct block_signal input[BLOCK_SIGNALS(BLOCK_INPUTS_MAX)];
    /* Points that the block writes; for a feedforward element, the MVs it adds to. */
    struct block_signal point[BLOCK_SIGNALS(BLOCK_POINTS_MAX)];
    /* Settings of the block that this block names; NULL if it names none. A state may keep this pointer until the
     * next configure, because configure is called whenever the pointer changes. In check(), the named block's own
     * kind may not have checked these settings yet; in configure(), both kinds have accepted them. */
    const void *named;
    bool named_other; /* the named block is of the kind's other_kind */
};

/* Why settings were refused. */
struct block_fault {
    uint8_t member;     /* first member concerned */
    const char *field;  /* name of the parameter; "" for the interval */
    const char *wanted; /* what would be right, in words */
    /* `wanted` is a range, so the message puts "must be" before it. */
    bool must_be;
};

/* Inputs and outputs of a block, by role. Arrays have an entry for each member, input, point, or event of the kind.
 * "Written by the block" marks an output. */
struct block_members {
    uint8_t acting;        /* bit k: member k has the block's output */
    const num_t *setpoint; /* for controllers */
    /* PVs; for a compensator the controllers' outputs, for a feedforward element its inputs. */
    const num_t *in;
    /* Outputs: step writes them; back_calculate, follow and shift read them. For a feedforward element, the added value
     * for each point. */
    num_t *out;
    const uint8_t *clamp; /* enum integral_clamp; in back_calculate */
    /* enum integral_clamp, written by the block: its own limits that the output has reached. */
    uint8_t *limited;
    /* For a block with a number (blockN), in step, back_calculate and follow: applied values of the member's MV, where
     * the kind asks for a history; NULL for a member that drives a loop. */
    const struct applied_history **applied;
    /* For a compensator, in follow: acting members that also acted in the last step. */
    uint8_t going_on;
    uint16_t divisor; /* for a block with a number: base ticks of a step */
};

#if CONFIG_BLOCKS
struct block_inputs {
    const num_t *value;
    /* enum quality. For an estimator, a held or substituted value is never good. */
    const uint8_t *quality;
    const float *age_s; /* time since the last valid reading was sampled, s; 0 for an MV */
    /* Plant time of this tick's sample, ms. It may go back, when the plant begins anew. The steps of a block are further apart than
     * its interval where samples were lost. */
    uint64_t time_ms;
    /* Applied values of an input that is an MV, where the kind asks for a history; NULL for a measurement. */
    const struct applied_history **applied;
};

struct block_points {
    num_t *value; /* written by the block */
    /* enum quality, written by the block; QUALITY_MISSING where the block writes none. */
    uint8_t *quality;
};

struct block_requests {
    bool work_done; /* the work that the block asked for is done; set for one step */
    /* Work is still under way, so asking again has no effect. */
    bool work_wanted;
    /* Written by the block: asks for work(), whose result the block takes after this many steps; 0 asks for none. */
    uint8_t ask_work;
    /* Written by the block that gives up: why, in a word. The loops' own controllers take over in this step
     * already, and a feedforward element adds nothing from this step on. For a compensator the MVs stay for this tick,
     * and it is bypassed from the next tick on. A block may give up in back_calculate and follow as well. */
    const char *gives_up;
    /* A step may write a proposal here; NULL while another proposal waits (block/proposal.h). */
    struct block_proposal *proposal;
    /* Written by the block: withdraws its proposal, if nobody has accepted it yet. */
    bool withdraws;
    /* A step may write a switch-off here; NULL while the block's last one waits (block/proposal.h). */
    struct block_switch_off *switch_off;
    /* For a feedforward element, bit k: term k is switched off, and adds nothing. */
    uint8_t silenced;
    /* Written by the block, bit k: the kind's k-th event holds in this step. */
    uint16_t raised;
    float *event_value; /* values of these events, in the unit that the event's words name */
    /* Test signals, [BLOCK_EXCITES_MAX]: written by the block, anew in every step; the default is EXCITE_NOTHING. */
    struct block_excitation *excite;
    uint8_t excite_state;  /* enum excite_state: answer to the block's last request */
    uint8_t excite_reason; /* enum excite_reason, for EXCITE_REFUSED and EXCITE_ENDED */
    /* Name of whoever excites the plant now, in a word, or NULL. */
    const char *excite_holder;
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

/* A parameter of a kind, `blockN.name` at the console, and its place in the struct of the kind's settings. With
 * rows * cols above 1 the parameter is a table. It is stored row by row, and its rows are called blockN.name.1 and
 * so on. */
struct block_parameter {
    uint8_t id;      /* 1..127, unique in its kind, never used again for something else */
    uint8_t type;    /* enum block_value: float, uint16_t, uint8_t */
    uint16_t offset; /* in the struct of settings, a multiple of the value's size */
    uint16_t rows, cols;
    const char *name;
    const char *unit; /* for a BLOCK_WORD the words, "off|on" */
    const char *help;
    float lo, hi, initial;
};

/* Longest name of a verb or an event, made of letters, digits and _: "block2.identify" is as long as a name may be. */
#define BLOCK_WORD_MAX 8

enum block_access { ACCESS_OPERATOR, ACCESS_ENGINEER };

/* A request that a block of the kind takes: `block N NAME [NUMBER]` at the console. */
struct block_verb {
    const char *name;   /* neither "on" nor "off" */
    const char *number; /* meaning or unit of the number, "s"; NULL if the verb takes none */
    const char *help;
    float lo, hi;         /* range of the number */
    bool may_lack_number; /* the number is optional */
    uint8_t access;       /* enum block_access */
    /* Runs in the tick, before the block's step, also while none of its members acts, but not while the block is
     * off. `number` is NULL if none was given. The function has no time for long computations: the block's next
     * step asks for these as work. Returns NULL, or why the block refuses, in a word. */
    const char *(*run)(void *state, const float *number);
};

#define BLOCK_EVENTS_MAX 12

enum block_event_level { BLOCK_INFO, BLOCK_ALARM };

/* An event that a block of the kind may report: a condition has begun to hold, or something happens. Its bit in
 * block_io.requests.raised may stay set for several steps in a row; the event is reported once, with its value, in
 * the first of them. An alarm on `blockN.CODE` is on the list while the bit is set. A block that runs no steps
 * raises nothing, except for the bits it set when it gave up. */
struct block_event {
    const char *code; /* "drift" */
    uint8_t level;    /* enum block_event_level */
    /* Text, with the unit of the value: "the model has left the plant, fraction of span". */
    const char *words;
};

/* Behaviour of a loop's setpoint when the loop above it loses the estimate that it controls, EU of that setpoint.
 * If both are 0, the setpoint returns to its value from before the cascade began, and has no limit. */
struct block_return {
    float setpoint; /* value it returns to */
    /* Largest distance to the last setpoint with a good estimate, while the estimate is not good; 0 = no limit. */
    float within;
};

struct block_kind {
    const char *name; /* "pid" */
    uint8_t stage;    /* enum block_stage */
    /* Bit a: the kind is a loop's own controller if the parameter `algorithm` has its a-th word. */
    uint8_t algorithms;
    /* A controller that acts uses new settings at once. Otherwise they wait until the old settings have made the
     * next step, because only then is that output what the old settings would have given, whatever moves meanwhile. */
    bool retunes_at_once;
    /* Its outputs are positions, not a range: an output found between or outside out_lo and out_hi stays until the
     * block acts. */
    bool positions;
    /* Why its outputs may pass through no compensator, in words; NULL if they may. */
    const char *uncompensated;

    /* Parameters of a block that blockN.kind selects. A kind whose parameters are in another group has none
     * (block/settings.h). */
    const struct block_parameter *parameter;
    uint8_t parameters;
    uint16_t settings_bytes; /* bytes of the struct that the parameters fill, a multiple of 4 */
    /* The settings are a table: they stand once, in one of a few places (exchange/tables.h), not in every
     * configuration. */
    bool table;
    /* Id of the parameter, a BLOCK_U16, that names a block of the kind `named_kind` by its number; 0 if the kind
     * has no such parameter. The named block's settings get into this block's setup. The value 0 of the parameter
     * names no block. */
    uint8_t names;
    const char *named_kind;
    const char *other_kind; /* second kind that the named block may have, or NULL */
    /* Most members, inputs and points of a block. Inputs are further points that it reads; points are those that it
     * writes. */
    uint8_t members_most, inputs_most, points_most;
    uint8_t bad_input; /* enum block_bad_input */
    /* For an estimator: offset in the settings of an array of struct block_return, one for each of its points; 0 if
     * it has none. */
    uint16_t returns;
    /* Returns how many of the block's steps the history of applied inputs goes back for these settings. The history
     * covers the MVs that its members drive, and the MVs among its inputs. A result of 0, or NULL for the function:
     * the block needs none. */
    uint16_t (*history)(const struct block_setup *setup);
    /* Does a piece of background work, of a bounded number of instructions, and returns true while there is more.
     * The tick may come between any two of these instructions. While work is under way, the tick does not touch the
     * data of that work. */
    bool (*work)(void *state);
    const struct block_verb *verb;
    uint8_t verbs;
    const struct block_event *event;
    uint8_t events; /* up to BLOCK_EVENTS_MAX */

    /* Returns the bytes of state that these settings need; for settings that check() refuses, 0. */
    uint32_t (*bytes)(const struct block_setup *setup);
    /* Checks everything. If it refuses something, *fault says what. */
    enum err (*check)(const struct block_setup *setup, struct block_fault *fault);
    /* Takes settings that check() accepts. With `retune` they are new settings for the same members, inputs and
     * points in as many bytes, and come into force without a bump; otherwise the state starts without a past. */
    enum err (*configure)(void *state, const struct block_setup *setup, bool retune);
    /* Returns true if two setups of the same members and interval have the same effect, so that nothing is
     * configured again. If NULL, two setups of a block with a number (blockN) are the same if all bytes of its
     * settings are; for other blocks they never are. */
    bool (*same)(const struct block_setup *before, const struct block_setup *now);
    void (*step)(void *state, struct block_io *io);
    void (*back_calculate)(void *state, struct block_io *io);
    /* May be NULL for an estimator, and for a compensator whose back_calculate also works for values. */
    void (*follow)(void *state, struct block_io *io);
    /* For controllers that act, when `out` gets another meaning (another compensator, another feedforward). The
     * next step gives io->members.out plus the change since the last step; transients continue. */
    void (*shift)(void *state, struct block_io *io);
    /* For compensators: only the acting members take part from now on. Returns true if that is a change, after
     * which all members need a bumpless transfer. NULL for a compensator with a number (blockN), because follow and
     * step get the acting members. */
    bool (*select)(void *state, const void *settings, uint8_t acting);
    /* Returns the name of the i-th inner value, for the console, and writes the value to *value; NULL past the end. */
    const char *(*describe)(const void *state, size_t i, float *value);
};

/* All kinds of this build: app/kinds.c. A kind is identified by its index. */
extern const struct block_kind *const block_kinds[];
extern const uint8_t block_kind_count;

#endif
