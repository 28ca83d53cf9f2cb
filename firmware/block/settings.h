/* Settings of blocks that have parameters of their own in the configuration (loopN, decoupleN, ffN), as the
 * supervisor passes them to the kinds. */
#ifndef REFLUX_BLOCK_SETTINGS_H
#define REFLUX_BLOCK_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

#ifndef DECOUPLER_MAX
/* The first loops of the configuration, which may take part in a static decoupler. */
#define DECOUPLER_MAX 8
#endif

/* Number of blocks whose kinds have settings of their own (blockN); 0 leaves them out. A board without automatic
 * start-up defines COMMISSION_CHANNELS as 0 before every file (its limits), and has none. */
#ifndef CONFIG_BLOCKS
#if defined(COMMISSION_CHANNELS) && COMMISSION_CHANNELS == 0
#define CONFIG_BLOCKS 0
#else
#define CONFIG_BLOCKS 4
#endif
#endif

#ifndef BLOCK_MEMBERS_MAX
#define BLOCK_MEMBERS_MAX DECOUPLER_MAX
#endif
_Static_assert(BLOCK_MEMBERS_MAX >= 1 && BLOCK_MEMBERS_MAX <= 8, "a bit of a byte for each");

#ifndef BLOCK_INPUTS_MAX
#define BLOCK_INPUTS_MAX 12
#endif
#ifndef BLOCK_POINTS_MAX
#define BLOCK_POINTS_MAX 8
#endif

enum loop_action { LOOP_REVERSE = 0, LOOP_DIRECT = 1 };
enum loop_algorithm { LOOP_POSITIONAL = 0, LOOP_VELOCITY = 1, LOOP_TWO_POSITION = 2 };

/* Settings of a loop's own controller: the parameters loopN.gain and so on, unchanged. */
struct loop_settings {
    float gain;           /* fraction of output span per fraction of measurement span */
    float ti_s, td_s;     /* 0 = no integral, no derivative action */
    float n;              /* derivative filter ratio */
    float b, c;           /* setpoint weights */
    float tt_s;           /* tracking time constant; 0 = automatic */
    float inhibit_s;      /* overshoot inhibitor, prediction time; 0 = off */
    float out_lo, out_hi; /* output limits, fraction of span */
    float out_rate_per_s; /* fraction of span per second; 0 = none */
    float band;           /* two_position: distance from the setpoint at which it switches, EU */
    uint8_t action;       /* enum loop_action */
    uint8_t algorithm;    /* enum loop_algorithm */
};

/* Settings of a static decoupler: row i, column j belong to loops i and j of the configuration. */
struct matrix_settings {
    const float (*d)[DECOUPLER_MAX];
};

/* Settings of a feedforward element. */
struct feedforward_settings {
    float gain;           /* output span per disturbance span, either sign, [-100, 100]; 0 = off */
    float lead_s, lag_s;  /* s, [0, 1e6]; lead/(lag + h) at most 100 */
    float dead_time_s;    /* s, [0, 1e6], at most 100000 steps */
    float reference;      /* disturbance without correction, fraction, [-1, 2] */
    float out_lo, out_hi; /* limits of the added value, fraction, -2 <= lo < hi <= 2 */
};

#endif
