/* The whole configuration: one plain struct without pointers, so that it can be copied, compared and swapped as a
 * whole. Every field is a parameter declared in settings/parameter_table.c (ranges, units, defaults, help). A
 * channel or loop exists when its name is not empty. EU = engineering units of the channel that a field belongs to. */
#ifndef REFLUX_EXCHANGE_CONFIG_H
#define REFLUX_EXCHANGE_CONFIG_H

#include <stddef.h>
#include <stdint.h>

#include "base/channel.h"
#include "block/settings.h"
#include "exchange/pins.h"

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
/* Boards with start-up, which may propose a loop for every channel, have more of the rest as well. CONFIG_ANALYSERS: measurements that
 * come every n-th tick; CONFIG_CALIBRATION: meas.gain, zero, valid_lo and valid_hi, and watch.c; CONFIG_PEOPLE: help for people at the
 * console (events as sentences, suggestions, names in place of numbers); 0 leaves them out. */
#if COMMISSION_CHANNELS
#ifndef CONFIG_LOOPS
#define CONFIG_LOOPS 16
#endif
#ifndef CONFIG_PAIRS
#define CONFIG_PAIRS 4
#endif
#ifndef CONFIG_ANALYSERS
#define CONFIG_ANALYSERS 1
#endif
#ifndef CONFIG_CALIBRATION
#define CONFIG_CALIBRATION 1
#endif
#ifndef CONFIG_PEOPLE
#define CONFIG_PEOPLE 1
#endif
#else
#ifndef CONFIG_LOOPS
#define CONFIG_LOOPS 8
#endif
#ifndef CONFIG_PAIRS
#define CONFIG_PAIRS 0
#endif
#ifndef CONFIG_ANALYSERS
#define CONFIG_ANALYSERS 0
#endif
#ifndef CONFIG_CALIBRATION
#define CONFIG_CALIBRATION 0
#endif
#ifndef CONFIG_PEOPLE
#define CONFIG_PEOPLE 0
#endif
#ifndef CONFIG_DEVICES
#define CONFIG_DEVICES                                                                             \
    0 /* such a board says so in its limits, because its port looks there (hal/tick.h) */
#endif
#endif
/* Loops that act keep their sense, and have alarms of their own; interlocks can latch; 0 leaves these out. */
#ifndef CONFIG_LOOP_GUARD
#define CONFIG_LOOP_GUARD 1
#endif
/* Bytes for the settings of all blocks, a multiple of 4. */
#ifndef CONFIG_POOL_BYTES
#define CONFIG_POOL_BYTES (CONFIG_BLOCKS ? 2048 : 0)
#endif
/* Places for tables, which are not in the pool (exchange/tables.h), and bytes of each place. Several configurations
 * may refer to one place. */
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

/* Settings of features that a board may lack. Where the feature is left out, the struct is empty. */
#if COMMISSION_CHANNELS
struct measurement_start_up {
    float limit;      /* largest distance from rest during tests, EU; 0 = a fifth of the span */
    uint8_t test;     /* automatic start-up controls it */
    uint8_t critical; /* its limit is halved while the plant is tested */
};
struct mv_start_up {
    float step;       /* amplitude of the test, EU; 0 = found by trial */
    float time_s;     /* length of half a double step; 0 = until the plant is at rest */
    uint8_t test;     /* automatic start-up moves it */
    uint8_t critical; /* it is tested first, because its times suggest those of the others */
};
#else
struct measurement_start_up {
};
struct mv_start_up {
};
#endif
#if CONFIG_STEPS
struct measurement_offset {
    float eu; /* subtracted from the reading while a sequence has it switched on */
};
#else
struct measurement_offset {
};
#endif
#if CONFIG_CALIBRATION
struct measurement_calibration {
    float gain, zero;         /* reading = zero + gain * what the plant sends, EU */
    float valid_lo, valid_hi; /* limits of valid readings, EU; both 0 = as NAMUR NE 43 */
};
#else
struct measurement_calibration {
};
#endif
#if CONFIG_ANALYSERS
struct measurement_analyser {
    uint16_t every; /* base ticks from one of its samples to the next */
    uint16_t phase; /* it comes in base ticks t of plant time with t mod every = phase */
    uint16_t delay; /* base ticks from sampling to coming */
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
    /* A bad reading is held for this long before loops on it go to manual, s. */
    float sensor_hold_s;
    float rate_limit; /* a reading that moves faster is not valid, EU/s; 0 = any */
    float frozen_s;   /* a reading without any change for this long is not valid, s; 0 = never */
    float substitute; /* EU, FALLBACK_SUBSTITUTE */
    float infer_gain, infer_offset; /* value = offset + gain * its source, EU */
    /* Manipulated variable or estimate from which a lost value is inferred; empty = none. */
    char infer[CHANNEL_NAME_SIZE];
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
    /* A read-back closer to the command than this counts as followed, fraction of span. */
    float readback_band;
    float follow_s; /* time without following that raises an alarm, s */
    struct mv_start_up start_up;
};

struct loop_config {
    char name[CHANNEL_NAME_SIZE];
    char pv[CHANNEL_NAME_SIZE]; /* name of a measurement */
    /* Name of a manipulated variable, or of the loop whose setpoint this loop drives. */
    char out[CHANNEL_NAME_SIZE];
    struct loop_settings own; /* settings of its own controller */
    float sp_lo, sp_hi;       /* setpoint limits, EU; both 0 = the span */
    float sp_ramp_per_min;    /* EU per minute; 0 = jump */
    float sp_filter_s;        /* first-order setpoint filter, s */
    uint8_t sp_track;         /* in manual the setpoint follows the measurement */
    /* The loop takes part in the static decoupler; for the first DECOUPLER_MAX loops only. */
    uint8_t decouple;
    uint16_t divisor, phase; /* runs in base ticks t with t mod divisor = phase */
};

struct ff_config {
    char from[CHANNEL_NAME_SIZE]; /* measurement, or another manipulated variable */
    char to[CHANNEL_NAME_SIZE];   /* manipulated variable, driven by a loop */
    float gain;                   /* fraction of output span per fraction of the source's span */
    float lead_s, lag_s, dead_s;
    float reference; /* value of the source without correction, EU */
    float lo, hi;    /* limits of the correction, fraction of output span */
};

#define CONFIG_SCHEMA 1

enum interlock_side { INTERLOCK_ABOVE = 0, INTERLOCK_BELOW = 1 };

#if CONFIG_LOOP_GUARD
struct interlock_latch {
    uint8_t on; /* an interlock that holds stays so until an operator releases it */
};
#else
struct interlock_latch {
};
#endif

struct interlock_config {
    char measurement[CHANNEL_NAME_SIZE];
    char mv[CHANNEL_NAME_SIZE];
    float limit;      /* EU of the measurement */
    float hysteresis; /* EU: the interlock releases when the value is back inside by this much */
    float delay_s;    /* the condition must hold this long */
    float value;      /* value of the output while the interlock is active, EU */
    uint8_t side;     /* enum interlock_side */
    uint8_t on_bad;   /* a bad measurement counts as the condition */
    struct interlock_latch latch;
};

enum alarm_side { ALARM_HI_HI, ALARM_HI, ALARM_LO, ALARM_LO_LO, ALARM_DEVIATION };
enum alarm_priority { ALARM_PRIORITY_LOW, ALARM_PRIORITY_MEDIUM, ALARM_PRIORITY_HIGH };

struct alarm_config {
    char on[CHANNEL_NAME_SIZE]; /* a measurement, for a deviation a loop, or an event of a block */
    float limit;                /* EU of the measurement */
    float hysteresis;           /* EU: the alarm ends when the value is back inside by this much */
    float delay_s;              /* the condition must hold this long */
    uint8_t side;               /* enum alarm_side */
    uint8_t priority;           /* enum alarm_priority: for the reader of the list */
    uint8_t latch;              /* stays on the list until acknowledged */
    uint8_t group; /* the first alarm of a group is marked; 0 = no group, else a letter */
};

enum test_guard { TEST_GUARD_LINE, TEST_GUARD_MODEL };
enum test_pairs { TEST_PAIRS_FOUND, TEST_PAIRS_GIVEN };

#if COMMISSION_CHANNELS
/* How automatic start-up tests the plant. */
struct test_config {
    float noise_multiple; /* a response is large enough at this many times the noise */
    float blank_s;   /* time after a step during which the guard is off, s: for inverse responses */
    float longest_s; /* longest half of a double step, s; 0 = as responses ask */
    float confidence; /* least probability of a pairing that counts as determined */
    float probe;      /* factor on a loop's gain while the trial probes its margin; 0 = no probe */
    uint16_t rounds;  /* most tests of each input, with repeats */
    uint16_t window;  /* base ticks over which rest is judged */
    uint8_t guard;    /* enum test_guard */
    /* enum test_pairs. If given, every used pair[] is a pair, and start-up looks for no other. */
    uint8_t pairs;
};
#else
struct test_config {
};
#endif

/* Prior knowledge of one element of the plant, for automatic start-up. */
struct pair_config {
    char measurement[CHANNEL_NAME_SIZE];
    char mv[CHANNEL_NAME_SIZE];
    float time_s; /* dead time and time constant together; 0 = unknown */
    float gain;   /* EU per EU; 0 = unknown */
};

enum sequence_kind { SEQUENCE_NONE, SEQUENCE_START, SEQUENCE_STOP };
enum step_action {
    STEP_NOTHING,
    /* Writes `value` to a manipulated variable by hand; a loop on it goes to manual first. */
    STEP_OUT,
    STEP_MANUAL,
    STEP_AUTO,
    STEP_CASCADE,
    STEP_SETPOINT,
    STEP_OFFSET_ON,
    STEP_OFFSET_OFF,
    /* From here on the condition must hold; where it does not, `otherwise` says what happens. */
    STEP_GUARD,
    STEP_DROP /* ends the guards on a measurement */
};
enum step_until { STEP_AT_ONCE, STEP_ABOVE, STEP_BELOW, STEP_STEADY, STEP_TIME, STEP_CONFIRM };
enum step_otherwise { STEP_ABORT, STEP_GO_ON, STEP_HOLD };

/* One row of a sequence: its action, and the condition it waits for afterwards. docs/use/sequences.md */
struct step_config {
    char what[CHANNEL_NAME_SIZE]; /* manipulated variable, loop or measurement of the action */
    char measurement[CHANNEL_NAME_SIZE]; /* measurement of the condition */
    float value;                         /* value of the action, EU */
    float limit;        /* limit of the condition, EU; STEP_STEADY: width of the band */
    uint16_t wait_s;    /* s for which the condition must hold; STEP_TIME: s to wait */
    uint16_t timeout_s; /* longest wait, s; 0 = no limit */
    uint8_t sequence;   /* enum sequence_kind; SEQUENCE_NONE: the row is not used */
    uint8_t action;     /* enum step_action */
    uint8_t until;      /* enum step_until */
    uint8_t otherwise;  /* enum step_otherwise: effect of a time-out, or of a guard */
};
_Static_assert(sizeof(struct step_config) == 48, "there are many rows, in every plan");

#define BLOCK_LOOPS_SIZE 48 /* bytes of a list of names, with the terminating zero */
#define BLOCK_NAMES_SIZE 64

/* A block with a number (blockN), beside the loops' own controllers. The struct of its kind holds its settings
 * (exchange/block_settings.h). */
struct block_config {
    char kind[CHANNEL_NAME_SIZE];  /* name of a row of block_kinds[]; empty = unused */
    char loops[BLOCK_LOOPS_SIZE];  /* loops it serves: names with one blank between them */
    char inputs[BLOCK_NAMES_SIZE]; /* further points it reads */
    char points[BLOCK_NAMES_SIZE]; /* points it writes */
    /* Place and size of the settings in the pool. 0 bytes: the kind is unknown here, or its settings found no room. */
    uint16_t offset, bytes;
};

#define CONFIG_NO_TABLE 0 /* the block's settings, if it has any, are in the pool */

#if CONFIG_LOOP_GUARD
/* Deviation alarm of every loop that acts. */
struct deviation_config {
    float width;   /* distance from the setpoint, fraction of the PV's span; 0 = none */
    float delay_s; /* time for which the deviation must last, s */
};
#else
struct deviation_config {
};
#endif

enum restart_policy { RESTART_SAFE, RESTART_HOLD, RESTART_RESUME };

struct config {
    uint32_t schema; /* version of this declaration, read-only */
    float tick_s;    /* base tick; 0 = what the plant announces */
    /* Missing samples in a row, base ticks, after which the supervisor takes the safe state. */
    uint32_t miss_limit;
    struct measurement_config measurement[CHANNEL_MAX];
    struct mv_config mv[CHANNEL_MAX];
    struct loop_config loop[CONFIG_LOOPS];
    /* D of the first DECOUPLER_MAX loops: u_i = sum over j of D[i][j] v_j, fractions. The other loops have no row. */
    float decoupler[DECOUPLER_MAX][DECOUPLER_MAX];
    struct ff_config feedforward[CONFIG_FEEDFORWARDS];
    struct interlock_config interlock[CONFIG_INTERLOCKS];
    struct alarm_config alarm[CONFIG_ALARMS];
    struct step_config step[CONFIG_STEPS];
    /* Longest time without a sample before the safe state, s of the board's clock; 0 = never. */
    float sample_timeout_s;
    float restart_limit_s;  /* longest gap in plant time over a restart, s */
    uint8_t restart_policy; /* enum restart_policy: after a reset that left the memory alone */
    struct deviation_config deviation;
    struct test_config test;
    struct pair_config pair[CONFIG_PAIRS];
    struct pins_config pins;
    char console_key[CHANNEL_NAME_SIZE]; /* opens the engineer level; empty = it is open */
    /* Time without engineer commands after which the console locks again, s; 0 = never. */
    float relock_s;
    struct block_config block[CONFIG_BLOCKS];
    /* Settings of the blocks, in the order of the blocks, without gaps; the rest is 0. */
    _Alignas(4) uint8_t pool[CONFIG_POOL_BYTES];
    /* Place of the table of each block, from 1, or CONFIG_NO_TABLE. This field comes last because it says where a
     * table is, not what it holds: equal settings may differ in it. */
    uint8_t table[CONFIG_BLOCKS];
};

/* Bytes of struct config that hold settings. */
#define CONFIG_CONTENT_BYTES                                                                       \
    (CONFIG_BLOCKS ? offsetof(struct config, table) : sizeof(struct config))

#endif
