/* Settings of the kind `state_law`, which keeps a law, as the kind `state` reads them, which computes with it (docs/methods/state-decoupling.md). */
#ifndef REFLUX_LAW_STATE_LAW_SETTINGS_H
#define REFLUX_LAW_STATE_LAW_SETTINGS_H

#include "block/block.h"

#if CONFIG_BLOCKS

/* Loops of a law; each value is a parameter of its own. */
#define STATE_LAW_LOOPS 2
/* States and disturbances of `state`: a row of a record has no more columns. */
#define STATE_FEEDBACK_INPUTS 8

/* Quantity of the column that an input measures. */
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

/* Columns of place. */
enum { STATE_LAW_STAGE, STATE_LAW_COMPONENT, STATE_LAW_PLACE };

struct state_law_settings {
    /* s, interval of the loops */
    float period_s;
    /* s, time constants of the closed loops */
    float tau_s[STATE_LAW_LOOPS];
    /* s, integral and derivative times; 0: none */
    float ti_s[STATE_LAW_LOOPS], td_s[STATE_LAW_LOOPS];
    /* SI units for a unit of the input; 0: 1 */
    float si[BLOCK_INPUTS_MAX];
    /* %, part of F that inputs may leave out */
    float left;
    /* block with the column's table; 0: another block puts the law here */
    uint16_t column;
    uint16_t place[BLOCK_INPUTS_MAX][STATE_LAW_PLACE];
    /* enum state_law_input */
    uint8_t role[BLOCK_INPUTS_MAX];
    uint8_t basis, adopt;
    /* The law, from here on. made_s: s, the interval that it is for; 0: there is none, or not all of it. */
    float made_s;
    /* MV span per span of the input */
    float f[STATE_LAW_LOOPS][STATE_FEEDBACK_INPUTS];
    float g[STATE_LAW_LOOPS][STATE_LAW_LOOPS];
};

#define STATE_LAW_ID_MADE 20
#define STATE_LAW_ID_G    21
#define STATE_LAW_ID_F    30

static inline bool state_law_is_of_stage(uint8_t role)
{
    return role == STATE_LAW_TEMPERATURE || role == STATE_LAW_FRACTION;
}

#endif
#endif
