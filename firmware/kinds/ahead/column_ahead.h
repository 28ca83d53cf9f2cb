/* Kind `ahead`: a controller of up to four loops on a distillation column that decouples them by the column's own equations. Input-output
 * linearisation in discrete time, ours:
 *
 *     y(k + 1) = w + exp(-h/tau) (y(k) - w)      for each loop, whatever the others do
 *
 * is what the linear law of design/state_decoupler.h asks for with one pole a loop (T. O. Folami, 1989, chapter 6). That law takes y(k + 1)
 * from matrices that belong to one point, which is where it failed on his column. Here the column of a compact table (docs/methods/column-table.md) is
 * carried one interval on from its present state, and B*, by how much each MV moves each y(k + 1), is found anew in every step.
 *
 * The present state is that of the model, corrected at the places of the inputs, measured or estimated. The error of the last prediction is
 * added to the next, a part of it in each step; that is the integral. Where an MV is limited only its own loop leaves its setpoint; the
 * others reach theirs. docs/methods/ahead.md */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_H
#define REFLUX_AHEAD_COLUMN_AHEAD_H

#include "block/block.h"

#if CONFIG_BLOCKS

#define AHEAD_LOOPS 4

/* Quantity of the column that an input measures. */
enum ahead_input {
    AHEAD_TEMPERATURE,   /* of a stage */
    AHEAD_FRACTION,      /* of a component on a stage */
    AHEAD_FEED_FRACTION, /* of a component in the feed */
    AHEAD_FEED,          /* from here on in the order of enum column_drive */
    AHEAD_FEED_TEMPERATURE,
    AHEAD_FEED_QUALITY,
    AHEAD_REFLUX,
    AHEAD_HEAT,
    AHEAD_BOILUP,
    AHEAD_PRESSURE,
    AHEAD_INPUT_KINDS
};

enum ahead_basis { AHEAD_MOLE, AHEAD_MASS };

/* Columns of place and target. */
enum { AHEAD_STAGE, AHEAD_COMPONENT, AHEAD_PLACE };
/* Columns of si and pv_si: SI = factor * value + zero. */
enum { AHEAD_FACTOR, AHEAD_ZERO, AHEAD_UNIT };

static inline bool ahead_is_of_stage(uint8_t role)
{
    return role == AHEAD_TEMPERATURE || role == AHEAD_FRACTION;
}

struct ahead_settings {
    /* s, time constant of the closed loop */
    float tau_s[AHEAD_LOOPS];
    /* EU of the PV: alarm, the prediction is off by more; 0: none */
    float alarm[AHEAD_LOOPS];
    /* s, time in which a miss is believed; 0: at once */
    float miss_s;
    /* part of steps in which it would have been better to expect no change, above which it gives up; 0: never */
    float doubt;
    /* part of the difference between an input and the model that a step corrects */
    float trust;
    float si[BLOCK_INPUTS_MAX][AHEAD_UNIT];
    float pv_si[AHEAD_LOOPS][AHEAD_UNIT];
    /* block with the table */
    uint16_t column;
    uint16_t place[BLOCK_INPUTS_MAX][AHEAD_PLACE];
    /* PVs: stage, component; 0: the temperature */
    uint16_t target[AHEAD_LOOPS][AHEAD_PLACE];
    /* number of the input that is the loop's MV */
    uint16_t moves[AHEAD_LOOPS];
    /* parts of an interval in which the model is carried on */
    uint16_t parts;
    /* enum ahead_input */
    uint8_t role[BLOCK_INPUTS_MAX];
    /* enum ahead_basis, of fractions on stages */
    uint8_t basis;
};

extern const struct block_kind ahead_kind;

#endif
#endif
