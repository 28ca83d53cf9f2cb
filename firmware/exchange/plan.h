/* A plan is a configuration that has been checked as a whole and resolved: names have become indices, cascades have
 * an order, and states have a place in the arena. Nothing in it changes until the next plan.
 *
 * Owner: the main loop, which builds it (plan/). While it is in force nobody writes it: both contexts read it, the
 * tick as const. */
#ifndef REFLUX_EXCHANGE_PLAN_H
#define REFLUX_EXCHANGE_PLAN_H

#include <stdbool.h>
#include <string.h>

#include "base/assertion.h"
#include "base/error.h"
#include "block/block.h"
#include "exchange/config.h"

#ifndef PLAN_ARENA_BYTES
#define PLAN_ARENA_BYTES 16448 /* states of channels, loops and blocks */
#endif

/* Bytes of a grain. Places in the arena are multiples of it, so that any state may stand there. */
#define ARENA_GRAIN         8u
#define ARENA_GRAINS(bytes) (((bytes) + ARENA_GRAIN - 1u) / ARENA_GRAIN)
_Static_assert(ARENA_GRAINS(PLAN_ARENA_BYTES) <= UINT16_MAX, "places in the arena have 16 bits");

#define PLAN_NONE 0xFFu

/* Number of channels that blocks may write or look back at. */
#define PLAN_POINTS (CONFIG_BLOCKS ? CHANNEL_MAX : 0)

/* Why a configuration was refused: "<group><index>.<field>: <subject> <wanted>". */
struct config_fault {
    enum err code;
    const char *group;  /* "loop" */
    uint8_t index;      /* 1-based; 0 = the group has no index */
    const char *field;  /* "pv" */
    const char *wanted; /* what would be right, in words */
    bool must_be;       /* `wanted` is a range, so the message puts "must be" before it */
    char subject[CHANNEL_NAME_SIZE]; /* the offending name, or empty */
    uint32_t bytes;                  /* ERR_MEMORY: bytes needed */
};

struct loop_plan {
    bool used;
    uint8_t pv;    /* measurement index */
    uint8_t mv;    /* MV index, or PLAN_NONE when it drives a loop */
    uint8_t inner; /* loop whose setpoint it drives, or PLAN_NONE */
    uint8_t outer; /* loop that drives its setpoint, or PLAN_NONE */
    bool decouple;
};

/* Blocks have fixed places in a plan: first the loops' own controllers, then the static decoupler, the feedforward
 * elements (ffN), and the blocks with a number (blockN). */
#define BLOCK_MATRIX       CONFIG_LOOPS
#define BLOCK_FEEDFORWARDS (CONFIG_LOOPS + 1)
#define BLOCK_NUMBERED     (BLOCK_FEEDFORWARDS + CONFIG_FEEDFORWARDS)
#define PLAN_BLOCKS        ((uint8_t)(BLOCK_NUMBERED + CONFIG_BLOCKS))

struct block_place {
    uint16_t grain, grains; /* first grain of its state in the arena, and how many */
    uint8_t kind;           /* place in block_kinds[]; PLAN_NONE = no block */
    uint8_t spare;          /* bytes of the last grain that the state does not need */
};

#define INFER_IS_ESTIMATE 0x80u
/* Bit of an input that is a manipulated variable; without it the input is a measurement. */
#define INPUT_IS_MV 0x80u
_Static_assert(CHANNEL_MAX < 0x80, "no MV is PLAN_NONE");

/* Largest value that a feedforward element with a number (blockN) adds to an MV, either way, fraction of span. */
#define PLAN_ADDED_MOST 1.0f
/* The same of ffN, whose own limits lie within. */
#define PLAN_FEEDFORWARD_MOST 2.0f

/* Members, inputs and points of a block with a number (blockN). */
struct numbered_plan {
    uint8_t members, inputs, points;
    uint8_t member[BLOCK_MEMBERS_MAX]; /* loops */
    uint8_t input[BLOCK_INPUTS_MAX];
    /* Measurements that the block writes; for a feedforward element, the MVs it adds to. */
    uint8_t point[BLOCK_POINTS_MAX];
};

/* An alarm on an event of a block: number of the block from 0, and place of the event in its kind. */
#define ALARM_OF_BLOCK        0x80u
#define ALARM_OF_EVENT(n, k)  ((uint8_t)(ALARM_OF_BLOCK + (n)*BLOCK_EVENTS_MAX + (k)))
#define ALARM_BLOCK(of_event) ((uint8_t)(((of_event)-ALARM_OF_BLOCK) / BLOCK_EVENTS_MAX))
#define ALARM_EVENT(of_event) ((uint8_t)(((of_event)-ALARM_OF_BLOCK) % BLOCK_EVENTS_MAX))
_Static_assert(CONFIG_BLOCKS *BLOCK_EVENTS_MAX < 0x7F && CHANNEL_MAX <= 0x80 &&
                   CONFIG_LOOPS <= 0x80,
               "and none of them is PLAN_NONE");

struct plan {
    uint32_t serial;   /* differs between plans, whatever buffer they are in; the owner sets it */
    uint32_t identity; /* checksum of the configuration */
    float tick_s;      /* base tick in force */
    struct loop_plan loop[CONFIG_LOOPS];
    uint8_t owner[CHANNEL_MAX]; /* loop that drives output i directly, or PLAN_NONE */
    struct block_place block[PLAN_BLOCKS];
    struct numbered_plan numbered[CONFIG_BLOCKS];
    uint8_t numbered_end; /* number of the last used blockN; 0 = none */
    /* All blocks by stage, each stage in the order in which they run: plan_stage_begin(). Controllers of outer loops stand before
     * those of the loops they drive, and a blockN behind the own controllers of its members. The others stand in the
     * order of their places. */
    uint8_t listed[PLAN_BLOCKS];
    uint8_t listed_end[BLOCK_STAGES];
    /* The blockN that acts for loop i in place of its own controller, or PLAN_NONE. */
    uint8_t server[CONFIG_BLOCKS ? CONFIG_LOOPS : 0];
    /* Number, from 0, of the blockN that writes measurement i, or PLAN_NONE. */
    uint8_t writer[PLAN_POINTS];
    /* Base ticks for which the applied values of MV j are kept; 0 = they are not. */
    uint16_t history[PLAN_POINTS];
    uint8_t histories; /* MVs from this one on have no history */
    struct {
        uint8_t input; /* what ffN looks at, like an input of a block; PLAN_NONE = unused */
        uint8_t point; /* the MV that it adds to */
    } feedforward[CONFIG_FEEDFORWARDS];
    struct {
        uint8_t measurement, mv; /* PLAN_NONE = unused */
    } interlock[CONFIG_INTERLOCKS];
    /* Output from which a measurement is inferred; with INFER_IS_ESTIMATE, a measurement that a block writes; or
     * PLAN_NONE. */
    uint8_t infer[CHANNEL_MAX];
    /* Measurement, loop of a deviation alarm, or event of a block (ALARM_OF_BLOCK). PLAN_NONE = unused, or on a
     * block whose kind this build lacks. */
    uint8_t alarm[CONFIG_ALARMS];
    bool has_steps; /* at least one row is used */
    struct step_plan {
        /* Indices, whose meaning depends on the action; PLAN_NONE = not needed. */
        uint8_t what, measurement;
    } step[CONFIG_STEPS];
    struct config config; /* last, because the rest is cleared and resolved again around it */
};

static inline const struct block_kind *plan_kind(const struct plan *plan, uint8_t block)
{
    REFLUX_ASSERT(block < PLAN_BLOCKS && plan->block[block].kind < block_kind_count);
    return block_kinds[plan->block[block].kind];
}
/* The blocks of a stage are listed[k], from k = plan_stage_begin() on and before plan_stage_end(). */
static inline uint8_t plan_stage_begin(const struct plan *plan, enum block_stage stage)
{
    return stage ? plan->listed_end[stage - 1] : 0;
}
static inline uint8_t plan_stage_end(const struct plan *plan, enum block_stage stage)
{
    return plan->listed_end[stage];
}
/* Returns the most that a feedforward block adds to an MV, either way, fraction of span. */
static inline float plan_added_most(uint8_t block)
{
    return block >= BLOCK_NUMBERED ? PLAN_ADDED_MOST : PLAN_FEEDFORWARD_MOST;
}
/* Returns the number, from 0, of the block that writes a measurement, or PLAN_NONE if the plant announces it. */
static inline uint8_t plan_writer(const struct plan *plan, uint8_t measurement)
{
    REFLUX_ASSERT(measurement < CHANNEL_MAX);
    return CONFIG_BLOCKS ? plan->writer[measurement] : (uint8_t)PLAN_NONE;
}
/* Returns true if an estimator writes the measurement, which the plant does not announce. */
static inline bool plan_is_estimate(const struct plan *plan, uint8_t measurement)
{
    return plan_writer(plan, measurement) != PLAN_NONE;
}
/* Returns the block that serves a loop in place of its own controller, or PLAN_NONE. */
static inline uint8_t plan_server(const struct plan *plan, uint8_t loop)
{
    return CONFIG_BLOCKS ? plan->server[loop] : (uint8_t)PLAN_NONE;
}
/* Returns true if the alarm is on an event of a block, such as "block2.drift". No other name has a dot. */
static inline bool alarm_is_on_event(const struct alarm_config *a)
{
    return CONFIG_BLOCKS && strchr(a->on, '.') != NULL;
}
/* Returns true if the kind of block n is known, and runs in that stage. */
static inline bool plan_has_stage(const struct plan *plan, uint8_t n, enum block_stage stage)
{
    uint8_t block = (uint8_t)(BLOCK_NUMBERED + n);
    return plan->block[block].kind != PLAN_NONE && plan_kind(plan, block)->stage == stage;
}
/* Returns the setpoint limits in force, EU. */
void plan_setpoint_limits(const struct plan *plan, uint8_t loop, float *lo, float *hi);

/* Returns the limits of an output by hand, EU: the operating limits, widened to the safe value. */
void plan_manual_limits(const struct plan *plan, uint8_t output, float *lo, float *hi);

/* Return the index of the channel or loop with that name, or PLAN_NONE. Empty names are never found. */
uint8_t config_find_measurement(const struct config *config, const char *name);
uint8_t config_find_mv(const struct config *config, const char *name);
uint8_t config_find_loop(const struct config *config, const char *name);

#endif
