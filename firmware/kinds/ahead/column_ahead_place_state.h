/* State of the signals. For its owner column_ahead_place.c and for column_ahead_block.h, which allocates it. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_PLACE_STATE_H
#define REFLUX_AHEAD_COLUMN_AHEAD_PLACE_STATE_H

#include "kinds/ahead/column_ahead.h"
#include "num/real.h"

#if CONFIG_BLOCKS

/* A signal in units of the column: value in SI units = zero + span * fraction. */
struct ahead_place {
    real_t zero, span;
    uint8_t role;      /* enum ahead_input; of a PV AHEAD_TEMPERATURE or AHEAD_FRACTION */
    uint8_t stage;     /* from 0 */
    uint8_t component; /* from 0 */
};

struct ahead_places {
    struct ahead_place input[BLOCK_INPUTS_MAX], pv[AHEAD_LOOPS];
    uint8_t loops, inputs;
    uint8_t mv[AHEAD_LOOPS]; /* input that is the loop's MV */
    uint8_t basis;           /* enum ahead_basis */
};

#endif
#endif
