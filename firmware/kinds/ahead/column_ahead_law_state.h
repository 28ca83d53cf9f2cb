/* State of the law. For its owner column_ahead_law.c and for column_ahead_block.h, which allocates it. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_LAW_STATE_H
#define REFLUX_AHEAD_COLUMN_AHEAD_LAW_STATE_H

#include "kinds/ahead/column_ahead.h"
#include "num/real.h"

#if CONFIG_BLOCKS

struct ahead_law {
    uint8_t n;                          /* loops */
    uint8_t acting;                     /* bit j: input j is free to move, and output j counts */
    real_t b[AHEAD_LOOPS][AHEAD_LOOPS]; /* output i by input j, an interval later */
    real_t u[AHEAD_LOOPS];              /* where the model has the inputs */
    real_t lo[AHEAD_LOOPS], hi[AHEAD_LOOPS];
    /* at a limit beyond it: what would have been right */
    real_t asked[AHEAD_LOOPS];
};

#endif
#endif
