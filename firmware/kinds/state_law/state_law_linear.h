/* A column as matrices, by differences: its own equations with the numbers of a table, around the table's profile and nominal inputs. For this
 * folder alone. */
#ifndef REFLUX_STATE_LAW_STATE_LAW_LINEAR_H
#define REFLUX_STATE_LAW_STATE_LAW_LINEAR_H

#include "kinds/column/column.h"
#include "law/state_law_settings.h"
#include "lti/state_model.h"

#if CONFIG_BLOCKS

/* An input of the column; value in SI units = span * fraction and something. */
struct state_law_place {
    real_t span;
    uint8_t role;      /* enum state_law_input */
    uint8_t stage;     /* from 0 */
    uint8_t component; /* from 0 */
    bool is_mv;
};

struct state_law_linear {
    struct state_law_place place[BLOCK_INPUTS_MAX];
    uint8_t inputs, loops, basis;
    uint8_t next; /* direction: states, then inputs */
    struct column_table table;
    struct column column;
    real_t x[STATE_MODEL_STATES], rates[STATE_MODEL_STATES];
    /* per second: mole fractions; inputs and outputs are fractions of span */
    struct state_model *plant;
    /* the inputs that are states, by mole fractions; a row for each */
    struct matrix *seen;
};

/* Takes the inputs of the block. */
void state_law_linear_put(struct state_law_linear *l, const struct state_law_settings *s,
                          const struct block_signal *input, unsigned inputs);

/* Begins; plant and seen are the caller's, and the record must stay. Errors as column_record_read; ERR_FULL: more than STATE_MODEL_STATES
 * mole fractions, or holdups that move. */
MUST_CHECK enum err state_law_linear_begin(struct state_law_linear *l,
                                           const struct column_record *record,
                                           struct state_model *plant, struct matrix *seen);

/* One direction: four evaluations of the rates, up to 16 stages. ERR_BUSY: there is another; ERR_OK: plant and seen are whole. Else the
 * equations have no solution there. */
MUST_CHECK enum err state_law_linear_piece(struct state_law_linear *l);

#endif
#endif
