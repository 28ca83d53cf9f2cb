/* Slow tails that a record cannot exclude: beside the response of a formula a second one of the same dead time and one long lag,
 * for a few lags from the longest level up. Gain of the tail and changes of the formula's own parameters are linear about its
 * best place, so a tail costs one evaluation. */
#ifndef REFLUX_IDENTIFY_SHAPE_TAIL_H
#define REFLUX_IDENTIFY_SHAPE_TAIL_H

#include "identify/shape_fit_state.h"

/* Finds the tails beside f->formula, which is ONE or TWO, right after shape_choice_covariance(). gain, residence: rows of both
 * by the columns' parameters, times the inverse of the triangle. variance: of a point. SHAPE_TAILS evaluations; the column of
 * the derivative is used up. */
void shape_tail_find(struct shape_fit *f, const real_t *gain, const real_t *residence,
                     real_t variance);

/* Squares that the best tail leaves; those without a response where there is none. */
real_t shape_tail_squares(const struct shape_fit *f);

#endif
