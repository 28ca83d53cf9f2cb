/* A column as matrices, by differences: its own equations with the numbers of a table, around the table's profile and nominal inputs. */
#ifndef REFLUX_STATE_LAW_STATE_LAW_LINEAR_H
#define REFLUX_STATE_LAW_STATE_LAW_LINEAR_H

#include "kinds/column/column.h"
#include "kinds/state_law/state_law.h"
#include "lti/state_model.h"

#if CONFIG_BLOCKS

/* What an input is of the column; value in SI units = span * fraction and something. */
struct state_law_place {
    real_t span;
    uint8_t is;        /* enum state_law_input */
    uint8_t stage;     /* from 0 */
    uint8_t component; /* from 0 */
    bool is_mv;
};

struct state_law_linear {
    struct state_law_place place[BLOCK_INPUTS_MAX];
    uint8_t inputs, loops, basis;
    struct column_table table;
    struct column column;
    real_t x[STATE_MODEL_STATES], rates[STATE_MODEL_STATES];
    uint8_t at; /* which direction is next: states, then inputs */
    struct state_model
        plant;          /* per second: mole fractions; inputs and outputs are fractions of span */
    struct matrix seen; /* the inputs that are states, by mole fractions; a row for each */
};

static inline bool state_law_is_of_stage(uint8_t is)
{
    return is == STATE_LAW_TEMPERATURE || is == STATE_LAW_FRACTION;
}

/* place, inputs, loops and basis are there. The record must stay. Errors as column_record_read; ERR_FULL: more than STATE_MODEL_STATES
 * mole fractions, or holdups that move. */
MUST_CHECK enum err state_law_linear_begin(struct state_law_linear *l,
                                           const struct column_record *record);

/* One direction: four evaluations of the rates, up to 16 stages. ERR_BUSY: there is another; ERR_OK: plant and seen are whole. Else the
 * equations have no solution there. */
MUST_CHECK enum err state_law_linear_piece(struct state_law_linear *l);

#endif
#endif
