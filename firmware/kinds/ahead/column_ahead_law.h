/* Finds the inputs that take n outputs to where they are asked to be. Where an input is at a limit only its own output misses: the others come to where they
 * are asked to be all the same. All numbers are fractions of span. For this folder alone. */
#ifndef REFLUX_AHEAD_COLUMN_AHEAD_LAW_H
#define REFLUX_AHEAD_COLUMN_AHEAD_LAW_H

#include "kinds/ahead/column_ahead.h"
#include "num/real.h"

#if CONFIG_BLOCKS

struct ahead_law;

void ahead_law_set(struct ahead_law *law, uint8_t n);
/* bit j: input j is free to move, and output j counts */
void ahead_law_act(struct ahead_law *law, uint8_t acting);
/* Forgets the limits of input j, but 0 and 1. */
void ahead_law_free(struct ahead_law *law, unsigned j);
/* An input that was held back has a limit where it is, until it is seen beyond. held_above, held_below: of what was given. */
void ahead_law_limit(struct ahead_law *law, unsigned j, real_t applied, bool held_below,
                     bool held_above);
/* Inputs u[n], where the model has them. */
const real_t *ahead_law_u(const struct ahead_law *law);
void ahead_law_put_u(struct ahead_law *law, unsigned j, real_t u);
/* Change of output i by input j, an interval later. */
real_t ahead_law_b(const struct ahead_law *law, unsigned i, unsigned j);
void ahead_law_put_b(struct ahead_law *law, unsigned i, unsigned j, real_t b);
/* Returns input j as it is asked for: at a limit beyond it, what would have been right. */
real_t ahead_law_asked(const struct ahead_law *law, unsigned j);

/* Moves u by what takes the outputs by e[n], those of inputs that are not at a limit. False: no input does anything, or no number. */
MUST_CHECK bool ahead_law_solve(struct ahead_law *law, const real_t *e);

#endif
#endif
