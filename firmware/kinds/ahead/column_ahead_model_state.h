/* State of the column's model. For its owner column_ahead_model.c and for column_ahead_block.h, which allocates it. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_MODEL_STATE_H
#define REFLUX_AHEAD_COLUMN_AHEAD_MODEL_STATE_H

#include "kinds/column/column.h"
#include "model/column_transition.h"

#if CONFIG_BLOCKS

struct ahead_model {
    struct column_table table;
    struct column column;
    struct column_inputs inputs;         /* present ones */
    real_t *x, *later, *rates;           /* [n_fractions] present, an interval later, 1/s */
    struct column_transition transition; /* over a part of an interval */
    real_t h;                            /* s, of a part of an interval */
    uint16_t parts;
};

#endif
#endif
