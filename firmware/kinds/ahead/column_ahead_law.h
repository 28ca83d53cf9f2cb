/* Which inputs take n outputs where they are asked to be. Where an input is at a limit its loop gives way alone: the others come to where they
 * are asked to be all the same. All numbers are fractions of span. For this folder alone. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_LAW_H
#define REFLUX_AHEAD_COLUMN_AHEAD_LAW_H

#include "kinds/ahead/column_ahead.h"
#include "num/real.h"

#if CONFIG_BLOCKS

struct ahead_law {
    uint8_t n;                          /* loops */
    uint8_t acting;                     /* bit j: input j is free to move, and output j counts */
    real_t b[AHEAD_LOOPS][AHEAD_LOOPS]; /* output i by input j, an interval later */
    real_t u[AHEAD_LOOPS];              /* where the model has the inputs */
    real_t lo[AHEAD_LOOPS], hi[AHEAD_LOOPS];
    real_t asked
        [AHEAD_LOOPS]; /* given: of an input at a limit beyond it, what would have been right */
};

/* Moves u by what takes the outputs by e[n], those of inputs that are not at a limit. False: no input does anything, or no number. */
MUST_CHECK bool ahead_law_solve(struct ahead_law *law, const real_t *e);

#endif
#endif
