/* The whole configuration: one plain struct, no pointers, so that it can be copied, compared and swapped
 * whole. Every field is a parameter declared in settings/parameter_table.c (ranges, units, defaults, help).
 * A channel or loop exists when its name is not empty. EU = engineering units of the channel it belongs to.
 */
#ifndef REFLUX_EXCHANGE_CONFIG_H
#define REFLUX_EXCHANGE_CONFIG_H

#include <stddef.h>
#include <stdint.h>

#include "base/channel.h"
#include "block/settings.h"

#ifndef CONFIG_FEEDFORWARDS
#define CONFIG_FEEDFORWARDS 4
#endif
#ifndef CONFIG_INTERLOCKS
#define CONFIG_INTERLOCKS 8
#endif
#ifndef CONFIG_ALARMS
#define CONFIG_ALARMS 8
#endif
#ifndef CONFIG_STEPS
#define CONFIG_STEPS 32 /* rows of sequences; 0 leaves sequences and measurement offsets out */
#endif

#ifndef COMMISSION_CHANNELS
#define COMMISSION_CHANNELS CHANNEL_MAX /* 0: the board leaves automatic start-up out */
#endif
#ifndef CONFIG_LOOPS
#if COMMISSION_CHANNELS
#define CONFIG_LOOPS 16 /* automatic start-up may propose one for every channel */
#else
#define CONFIG_LOOPS 8
#endif
#endif
#ifndef CONFIG_PAIRS
#if COMMISSION_CHANNELS
#define CONFIG_PAIRS 4
#else
#define CONFIG_PAIRS 0
#endif
#endif

#ifndef CONFIG_LOOP_GUARD /* a loop that acts keeps its sense, and has a deviation alarm; 0 leaves both out */
#define CONFIG_LOOP_GUARD 1
#endif
#ifndef CONFIG_ANALYSERS /* measurements that come every n-th tick; 0 leaves them out */
#if COMMISSION_CHANNELS
#define CONFIG_ANALYSERS 1
#else
#define CONFIG_ANALYSERS 0
#endif
#endif
#ifndef CONFIG_CALIBRATION /* meas.gain, zero, valid_lo and valid_hi, and watch.c; 0 leaves them out */
#if COMMISSION_CHANNELS
#define CONFIG_CALIBRATION 1
#else
#define CONFIG_CALIBRATION 0
#endif
#endif
#ifndef CONFIG_POOL_BYTES
#define CONFIG_POOL_BYTES                                                                          \
    (CONFIG_BLOCKS ? 2048 : 0) /* for the settings of all blocks, a multiple of 4 */
#endif
/* Tables, which are not in the pool (exchange/tables.h): so many places of so many bytes, whatever refers to them. */
#define CONFIG_TABLES 2
#ifndef CONFIG_TABLE_BYTES
#define CONFIG_TABLE_BYTES 1128 /* a multiple of 8 */
#endif

/* What a measurement does when it has no valid reading. */
enum fallback {
    FALLBACK_HOLD = 0,       /* last value for sensor_hold_s, then its loops go to manual */
    FALLBACK_SUBSTITUTE = 1, /* last value for sensor_hold_s, then `substitute` */
    FALLBACK_MANUAL = 2,     /* its loops go to manual at once */
    FALLBACK_SAFE = 3        /* last value for sensor_hold_s, then the safe state */
};

/* What a board may lack of the settings below is a struct that is empty there. */
#if COMMISSION_CHANNELS
struct measurement_start_up {
    float limit;      /* farthest from rest during tests, EU; 0 = a fifth of the span */
    uint8_t test;     /* automatic start-up controls it */
    uint8_t critical; /* its limit is halved while the plant is tested */
};
struct mv_start_up {
    float step;       /* amplitude of the test, EU; 0 = found by trying */
    float time_s;     /* length of half a double step; 0 = until the plant is at rest */
    uint8_t test;     /* automatic start-up moves it */
    uint8_t critical; /* it is tested first: its times suggest those of the others */
};
#else
struct measurement_start_up {
};
struct mv_start_up {
};
#endif
#if CONFIG_STEPS
struct measurement_offset {
    float eu; /* subtracted from the reading while a sequence has switched it on */
};
#else
struct measurement_offset {
};
#endif
#if CONFIG_CALIBRATION
struct measurement_calibration {
    float gain, zero;         /* reading = zero + gain * what the plant sends, EU */
    float valid_lo, valid_hi; /* a reading outside is not valid, EU; both 0 = as NAMUR NE 43 */
};
#else
struct measurement_calibration {
};
#endif
#if CONFIG_ANALYSERS
struct measurement_analyser {
    uint16_t every; /* base ticks from one of its samples to the next */
    uint16_t phase; /* it comes in base ticks t of plant time with t mod every = phase */
    uint16_t delay; /* base ticks between sampling and that */
};
#else
struct measurement_analyser {
};
#endif

struct measurement_config {
    char name[CHANNEL_NAME_SIZE]; /* as the plant announces it */
    char unit[CHANNEL_UNIT_SIZE]; /* must equal the announced unit */
    float lo, hi;                 /* span, EU: lo is fraction 0, hi is fraction 1 */
    float filter_s;               /* first-order filter, s; 0 = none */
    float sensor_hold_s; /* a bad reading is held this long before loops on it go to manual, s */
    float rate_limit;    /* faster than this, EU/s, is not valid; 0 = any */
    float frozen_s;      /* not the least change for this long is not valid, s; 0 = never */
    float substitute;    /* EU, FALLBACK_SUBSTITUTE */
    float infer_gain, infer_offset; /* value = offset + gain * what it is inferred from, EU */
    char infer
        [CHANNEL_NAME_SIZE]; /* manipulated variable or estimate to infer a value from; empty = none */
    struct measurement_start_up start_up;
    struct measurement_offset offset;
    struct measurement_calibration calibration;
    struct measurement_analyser analyser;
    uint8_t fallback; /* enum fallback */
};

struct mv_config {
    char name[CHANNEL_NAME_SIZE];
    char unit[CHANNEL_UNIT_SIZE];
    float lo, hi;     /* span, EU */
    float min, max;   /* operating limits, EU, inside the span */
    float rate_per_s; /* fastest change, EU/s; 0 = no limit */
    float safe;       /* value at start, on silence and in the safe state, EU */
    float
        readback_band; /* read-back closer than this to the command counts as followed, fraction of span */
    float follow_s; /* not followed for this long is an alarm, s */
    struct mv_start_up start_up;
};

struct loop_config {
    char name[CHANNEL_NAME_SIZE];
    char pv[CHANNEL_NAME_SIZE]; /* name of a measurement */
    char out
        [CHANNEL_NAME_SIZE]; /* name of a manipulated variable, or of the loop whose setpoint it drives */
    struct loop_settings own; /* of its own controller */
    float sp_lo, sp_hi;       /* setpoint limits, EU; both 0 = the span */
    float sp_ramp_per_min;    /* EU per minute; 0 = jump */
    float sp_filter_s;        /* first-order setpoint filter, s */
    uint8_t sp_track;         /* in manual the setpoint follows the measurement */
    uint8_t decouple;         /* takes part in the static decoupler; of the first DECOUPLER_MAX */
    uint16_t divisor, phase;  /* runs in base ticks t with t mod divisor = phase */
};

struct ff_config {
    char from[CHANNEL_NAME_SIZE]; /* measurement, or another manipulated variable */
    char to[CHANNEL_NAME_SIZE];   /* manipulated variable, driven by a loop */
    float gain;                   /* fraction of output span per fraction of the source's span */
    float lead_s, lag_s, dead_s;
    float reference; /* value of the source that gives no correction, EU */
    float lo, hi;    /* limits of the correction, fraction of output span */
};

#define CONFIG_SCHEMA 1

enum interlock_side { INTERLOCK_ABOVE = 0, INTERLOCK_BELOW = 1 };

struct interlock_config {
    char measurement[CHANNEL_NAME_SIZE];
    char mv[CHANNEL_NAME_SIZE];
    float limit;      /* EU of the measurement */
    float hysteresis; /* EU: released when back inside by this much */
    float delay_s;    /* the condition must hold this long */
    float value;      /* value of the output while interlocked, EU */
    uint8_t side;     /* enum interlock_side */
    uint8_t on_bad;   /* a bad measurement counts as the condition */
};

enum alarm_side { ALARM_HI_HI, ALARM_HI, ALARM_LO, ALARM_LO_LO, ALARM_DEVIATION };
enum alarm_priority { ALARM_PRIORITY_LOW, ALARM_PRIORITY_MEDIUM, ALARM_PRIORITY_HIGH };

struct alarm_config {
    char on[CHANNEL_NAME_SIZE]; /* a measurement; for a deviation, a loop */
    float limit;                /* EU of the measurement */
    float hysteresis;           /* EU: over when back inside by this much */
    float delay_s;              /* the condition must hold this long */
    uint8_t side;               /* enum alarm_side */
    uint8_t priority;           /* enum alarm_priority: for whoever reads the list */
    uint8_t latch;              /* stays on the list until acknowledged */
    uint8_t group;              /* the first of a group is marked; 0 = in none, else a letter */
};

enum test_guard { TEST_GUARD_LINE, TEST_GUARD_MODEL };
enum test_pairs { TEST_PAIRS_FOUND, TEST_PAIRS_GIVEN };

#if COMMISSION_CHANNELS
/* How automatic start-up goes about it. */
struct test_config {
    float noise_multiple; /* a response this many times the noise is enough */
    float blank_s;        /* the guard looks away for so long after a step: inverse responses */
    float longest_s;      /* no half of a double step is longer; 0 = 1000 base ticks */
    float confidence;     /* a pairing less probable than this is not determined */
    uint16_t rounds;      /* tests may be repeated until there are so many of each input */
    uint16_t window;      /* base ticks over which rest is judged */
    uint8_t guard;        /* enum test_guard */
    uint8_t
        pairs; /* enum test_pairs: given, every used pair[] is one, and no other is looked for */
};
#else
struct test_config {
};
#endif

/* What is known of one element beforehand. */
struct pair_config {
    char measurement[CHANNEL_NAME_SIZE];
    char mv[CHANNEL_NAME_SIZE];
    float time_s; /* dead time and time constant together; 0 = unknown */
    float gain;   /* EU per EU; 0 = unknown */
};

enum sequence_kind { SEQUENCE_NONE, SEQUENCE_START, SEQUENCE_STOP };
enum step_action {
    STEP_NOTHING,
    STEP_OUT, /* `value` to a manipulated variable by hand; a loop on it goes to manual first */
    STEP_MANUAL,
    STEP_AUTO,
    STEP_CASCADE,
    STEP_SETPOINT,
    STEP_OFFSET_ON,
    STEP_OFFSET_OFF,
    STEP_GUARD, /* from here on the condition must hold; ends the sequence where it does not */
    STEP_DROP   /* ends the guards on a measurement */
};
enum step_until { STEP_AT_ONCE, STEP_ABOVE, STEP_BELOW, STEP_STEADY, STEP_TIME, STEP_CONFIRM };
enum step_otherwise { STEP_ABORT, STEP_GO_ON, STEP_HOLD };

/* One row of a sequence: what is done, and what is waited for then. docs/sequences.md */
struct step_config {
    char what[CHANNEL_NAME_SIZE]; /* of the action: manipulated variable, loop or measurement */
    char measurement[CHANNEL_NAME_SIZE]; /* of the condition */
    float value;                         /* of the action, EU */
    float limit;        /* of the condition, EU; STEP_STEADY: the width it stays within */
    uint16_t wait_s;    /* the condition must hold for this long; STEP_TIME: how long */
    uint16_t timeout_s; /* longest wait; 0 = none */
    uint8_t sequence;   /* enum sequence_kind; SEQUENCE_NONE: the row is not used */
    uint8_t action;     /* enum step_action */
    uint8_t until;      /* enum step_until */
    uint8_t otherwise;  /* enum step_otherwise: what the time-out, or a guard, does */
};
_Static_assert(sizeof(struct step_config) == 48, "there are many rows, in every plan");

#define BLOCK_LOOPS_SIZE 48 /* bytes of a list of names, with the terminating zero */
#define BLOCK_NAMES_SIZE 64

/* A block beside the loops' own controllers. Its settings are a record of its kind (exchange/block_settings.h). */
struct block_config {
    char kind[CHANNEL_NAME_SIZE];  /* name of a row of block_kinds[]; empty = unused */
    char loops[BLOCK_LOOPS_SIZE];  /* it serves: names with one blank between them */
    char inputs[BLOCK_NAMES_SIZE]; /* further points it reads */
    char points[BLOCK_NAMES_SIZE]; /* points it writes */
    uint16_t offset,
        bytes; /* the record in the pool; no bytes: the kind is unknown here, or found no room */
};

#define CONFIG_NO_TABLE 0 /* the record, if there is one, is in the pool */

#if CONFIG_LOOP_GUARD
/* Alarm of every loop that acts. */
struct deviation_config {
    float width;   /* distance from the setpoint, fraction of the PV's span; 0 = none */
    float delay_s; /* for how long */
};
#else
struct deviation_config {
};
#endif

enum restart_policy { RESTART_SAFE, RESTART_HOLD, RESTART_RESUME };

struct config {
    uint32_t schema; /* version of this declaration, read-only */
    float tick_s;    /* base tick; 0 = what the plant announces */
    uint32_t
        miss_limit; /* missing samples in a row, base ticks, after which the safe state is taken */
    struct measurement_config measurement[CHANNEL_MAX];
    struct mv_config mv[CHANNEL_MAX];
    struct loop_config loop[CONFIG_LOOPS];
    /* D of the first loops: u_i = sum over j of D[i][j] v_j, fractions. The others have none. */
    float decoupler[DECOUPLER_MAX][DECOUPLER_MAX];
    struct ff_config feedforward[CONFIG_FEEDFORWARDS];
    struct interlock_config interlock[CONFIG_INTERLOCKS];
    struct alarm_config alarm[CONFIG_ALARMS];
    struct step_config step[CONFIG_STEPS];
    float sample_timeout_s; /* without a sample for so long of the board's clock: safe; 0 = never */
    float restart_limit_s;  /* longest gap in plant time over a restart, s */
    uint8_t restart_policy; /* enum restart_policy: after a reset that left the memory alone */
    struct deviation_config deviation;
    struct test_config test;
    struct pair_config pair[CONFIG_PAIRS];
    char console_key[CHANNEL_NAME_SIZE]; /* opens the engineer level; empty = it is open */
    float relock_s; /* without engineer commands for this long it locks again; 0 = never */
    struct block_config block[CONFIG_BLOCKS];
    /* Records of the blocks, in their order, one behind the other; the rest is 0. */
    _Alignas(4) uint8_t pool[CONFIG_POOL_BYTES];
    /* Of each block the place of its table, 1 and up, or CONFIG_NO_TABLE. Last: it says where, not what, and equal
     * settings may differ in it. */
    uint8_t table[CONFIG_BLOCKS];
};

/* So many bytes of it are what is set. */
#define CONFIG_CONTENT_BYTES                                                                       \
    (CONFIG_BLOCKS ? offsetof(struct config, table) : sizeof(struct config))

#endif
