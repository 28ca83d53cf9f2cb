/* A plan is a configuration that has been checked whole and resolved: names have become indices, cascades
 * have an order, dead times have a place in the arena. Nothing in it changes until the next plan.
 *
 * Owner: the main loop, which builds it (plan/). In force it belongs to nobody: both contexts read it, the tick as const. */
#ifndef REFLUX_EXCHANGE_PLAN_H
#define REFLUX_EXCHANGE_PLAN_H

#include <stdbool.h>
#include <string.h>

#include "base/assertion.h"
#include "base/error.h"
#include "block/block.h"
#include "exchange/config.h"

#ifndef PLAN_ARENA_BYTES
#define PLAN_ARENA_BYTES 16384 /* states of channels, loops and blocks */
#endif

#define ARENA_GRAIN         8u /* places in the arena are multiples of it: any state may stand there */
#define ARENA_GRAINS(bytes) (((bytes) + ARENA_GRAIN - 1u) / ARENA_GRAIN)
_Static_assert(ARENA_GRAINS(PLAN_ARENA_BYTES) <= UINT16_MAX, "places in the arena have 16 bits");

#define PLAN_NONE 0xFFu

/* Channels that blocks may write, or look back at. */
#define PLAN_POINTS (CONFIG_BLOCKS ? CHANNEL_MAX : 0)

/* Why a configuration was refused: "<group><index>.<field>: <subject> <wanted>". */
struct config_fault {
    enum err code;
    const char *group;               /* "loop" */
    uint8_t index;                   /* 1-based; 0 = the group has no index */
    const char *field;               /* "pv" */
    const char *wanted;              /* what would be right, in words */
    bool must_be;                    /* ... of which it is the range */
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
    uint8_t
        server; /* slot of the block that serves it in place of its own controller, or PLAN_NONE */
};

/* Blocks have fixed slots in a plan: the loops' own controllers, the static decoupler, the feedforward elements, and those
 * with a record (blockN). */
#define SLOT_MATRIX   CONFIG_LOOPS
#define SLOT_ELEMENTS (CONFIG_LOOPS + 1)
#define SLOT_RECORDS  (SLOT_ELEMENTS + CONFIG_FEEDFORWARDS)
#define PLAN_BLOCKS   ((uint8_t)(SLOT_RECORDS + CONFIG_BLOCKS))

struct block_place {
    uint16_t grain, grains; /* first grain of its state in the arena, and how many */
    uint8_t kind;           /* in block_kinds[]; PLAN_NONE = there is no block */
    uint8_t spare;          /* bytes of the last grain that the state does not need */
};

#define INFER_IS_ESTIMATE 0x80u
#define INPUT_IS_MV       0x80u /* an input is a measurement, or, with this bit, a manipulated variable */

/* The most that a feedforward element with a record adds to an MV, either way, fraction of span. */
#define PLAN_ELEMENT_MOST 1.0f

/* Whom a block with a record serves, and what it reads and writes. */
struct record_plan {
    uint8_t members, inputs, points;
    uint8_t member[BLOCK_MEMBERS_MAX]; /* loops */
    uint8_t input[BLOCK_INPUTS_MAX];
    uint8_t point[BLOCK_POINTS_MAX]; /* measurements; of a feedforward element the MVs it adds to */
    uint8_t last; /* the member whose turn comes last: then it runs for all of them */
};

/* An alarm on an event of a block: place of the record and of the event in its kind. */
#define ALARM_OF_BLOCK        0x80u
#define ALARM_OF_EVENT(n, k)  ((uint8_t)(ALARM_OF_BLOCK + (n)*BLOCK_EVENTS_MAX + (k)))
#define ALARM_BLOCK(of_event) ((uint8_t)(((of_event)-ALARM_OF_BLOCK) / BLOCK_EVENTS_MAX))
#define ALARM_EVENT(of_event) ((uint8_t)(((of_event)-ALARM_OF_BLOCK) % BLOCK_EVENTS_MAX))
_Static_assert(CONFIG_BLOCKS *BLOCK_EVENTS_MAX < 0x7F && CHANNEL_MAX <= 0x80 &&
                   CONFIG_LOOPS <= 0x80,
               "and none of them is PLAN_NONE");

struct plan {
    uint32_t serial;   /* differs between plans, whatever buffer they are in; set by the owner */
    uint32_t identity; /* checksum of the configuration */
    float tick_s;      /* base tick in force */
    struct loop_plan loop[CONFIG_LOOPS];
    uint8_t order[CONFIG_LOOPS]; /* outer loops before the ones they drive */
    uint8_t n_order;
    uint8_t owner[CHANNEL_MAX]; /* loop that drives output i directly, or PLAN_NONE */
    struct block_place block[PLAN_BLOCKS];
    struct record_plan record[CONFIG_BLOCKS];
    uint8_t records; /* there is none from this one on */
    uint8_t
        writer[PLAN_POINTS]; /* record of the estimator that writes measurement i, or PLAN_NONE */
    uint16_t history
        [PLAN_POINTS]; /* base ticks for which what was applied to MV j is kept; 0 = it is not */
    uint8_t histories; /* there is none from this MV on */
    struct {
        uint8_t from, to; /* measurement (or output) and output index; PLAN_NONE = unused */
        bool from_mv;     /* `from` is a manipulated variable */
    } feedforward[CONFIG_FEEDFORWARDS];
    struct {
        uint8_t measurement, mv; /* PLAN_NONE = unused */
    } interlock[CONFIG_INTERLOCKS];
    /* Output a measurement is inferred from, or, with INFER_IS_ESTIMATE, a measurement that a block writes; or PLAN_NONE. */
    uint8_t infer[CHANNEL_MAX];
    /* Measurement, loop of a deviation, or ALARM_OF_BLOCK; PLAN_NONE = unused, or of a block whose kind this build lacks. */
    uint8_t alarm[CONFIG_ALARMS];
    bool has_steps; /* there is at least one row */
    struct step_plan {
        uint8_t what, measurement; /* index by the kind of action; PLAN_NONE = not needed */
    } step[CONFIG_STEPS];
    struct config config; /* last, so that the rest can be cleared and resolved again around it */
};

static inline const struct block_kind *plan_kind(const struct plan *plan, uint8_t slot)
{
    REFLUX_ASSERT(slot < PLAN_BLOCKS && plan->block[slot].kind < block_kind_count);
    return block_kinds[plan->block[slot].kind];
}
/* Number of the block that writes a measurement, from 0, or PLAN_NONE: the plant announces it. */
static inline uint8_t plan_writer(const struct plan *plan, uint8_t measurement)
{
    REFLUX_ASSERT(measurement < CHANNEL_MAX);
    return CONFIG_BLOCKS ? plan->writer[measurement] : (uint8_t)PLAN_NONE;
}
/* The plant does not announce it: an estimator writes it. */
static inline bool plan_is_estimate(const struct plan *plan, uint8_t measurement)
{
    return plan_writer(plan, measurement) != PLAN_NONE;
}
/* Slot of the block that serves a loop in place of its own controller, or PLAN_NONE. */
static inline uint8_t plan_server(const struct plan *plan, uint8_t loop)
{
    return CONFIG_BLOCKS ? plan->loop[loop].server : (uint8_t)PLAN_NONE;
}
/* The name of an alarm's subject is that of an event of a block, "block2.drift": no other name has a dot. */
static inline bool alarm_is_on_event(const struct alarm_config *a)
{
    return CONFIG_BLOCKS && strchr(a->on, '.') != NULL;
}
/* The kind of block n is known, and runs in that stage. */
static inline bool plan_has_stage(const struct plan *plan, uint8_t n, enum block_stage stage)
{
    uint8_t slot = (uint8_t)(SLOT_RECORDS + n);
    return plan->block[slot].kind != PLAN_NONE && plan_kind(plan, slot)->stage == stage;
}
/* Setpoint limits in force, EU. */
void plan_setpoint_limits(const struct plan *plan, uint8_t loop, float *lo, float *hi);

/* Values an output may be given by hand, EU: the operating limits, widened to the safe value. */
void plan_manual_limits(const struct plan *plan, uint8_t output, float *lo, float *hi);

/* Index of the channel or loop with that name, or PLAN_NONE. Empty names are never found. */
uint8_t config_find_measurement(const struct config *config, const char *name);
uint8_t config_find_mv(const struct config *config, const char *name);
uint8_t config_find_loop(const struct config *config, const char *name);

#endif
