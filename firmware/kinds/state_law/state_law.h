/* Kind `state_law`: finds on the board what the kind `state` computes with, F, G and Tf of design/state_decoupler.h for two loops, and keeps it as
 * settings of its own, which `state` takes when it names the block (its parameter law). It moves nothing itself.
 *
 * From where: the equations of the column whose table it names, linear around the table's profile (`block N design`); or, where it names no
 * table, another block that has identified the plant puts the law there (the kind `experiment`). docs/state-decoupling.md
 *
 * Inputs: first the measurements of the loops, one for each, then what else `state` is given, in its order; behind them the MVs of the loops.
 *
 * The law comes as proposals (block/proposal.h), as many as it takes; `made` is 0 until all of it is there, and as long as it is
 * `state` goes on with what it had. */
#ifndef REFLUX_STATE_LAW_STATE_LAW_H
#define REFLUX_STATE_LAW_STATE_LAW_H

#include "block/block.h"
#include "kinds/state/state_feedback.h"

#if CONFIG_BLOCKS

#define STATE_LAW_LOOPS 2 /* each value is a parameter of its own */

/* What an input is of the column. */
enum state_law_input {
    STATE_LAW_TEMPERATURE, /* of a stage */
    STATE_LAW_FRACTION,    /* of a component on a stage */
    STATE_LAW_FEED,
    STATE_LAW_FEED_FRACTION, /* of a component in the feed */
    STATE_LAW_FEED_TEMPERATURE,
    STATE_LAW_FEED_QUALITY,
    STATE_LAW_REFLUX,
    STATE_LAW_HEAT,
    STATE_LAW_BOILUP,
    STATE_LAW_INPUT_KINDS
};

enum state_law_basis { STATE_LAW_MOLE, STATE_LAW_MASS };
enum state_law_adopt { STATE_LAW_WHEN_ACCEPTED, STATE_LAW_AT_ONCE };

enum { STATE_LAW_STAGE, STATE_LAW_COMPONENT, STATE_LAW_PLACE }; /* columns of place */

struct state_law_settings {
    float period_s;                                     /* of the loops */
    float tau_s[STATE_LAW_LOOPS];                       /* time constants of the closed loops */
    float ti_s[STATE_LAW_LOOPS], td_s[STATE_LAW_LOOPS]; /* 0: none */
    float si[BLOCK_INPUTS_MAX];                         /* SI units for a unit of the input; 0: 1 */
    float left;                                         /* %, of F that inputs may leave out */
    uint16_t column; /* block; 0: another block puts the law there */
    uint16_t place[BLOCK_INPUTS_MAX][STATE_LAW_PLACE];
    uint8_t is[BLOCK_INPUTS_MAX]; /* enum state_law_input */
    uint8_t basis, adopt;
    /* From here on what is found. */
    float made_s; /* interval that it is for; 0: there is none, or not all of it */
    float f[STATE_LAW_LOOPS][STATE_FEEDBACK_INPUTS]; /* MV span per span of the input */
    float g[STATE_LAW_LOOPS][STATE_LAW_LOOPS];
};

#define STATE_LAW_ID_MADE 20
#define STATE_LAW_ID_G    21
#define STATE_LAW_ID_F    30

extern const struct block_kind state_law_kind;

#endif
#endif
