/* The search for the best place of a formula: squares at a place, and damped Gauss-Newton steps from it. Gain and gain times
 * zero, offset and drift are linear and solved for at every place (variable projection: Golub and Pereyra 1973, with
 * Kaufman's simplification 1975). Dead time, logarithm of the lag and logarithm of the ratio are searched for. */
#ifndef REFLUX_IDENTIFY_SHAPE_SEARCH_H
#define REFLUX_IDENTIFY_SHAPE_SEARCH_H

#include "identify/shape_fit_state.h"

/* Least and largest ratio: lags of 1 and 1000; damping 0.09. */
#define SHAPE_RATIO_MIN REAL_C(1e-3)
#define SHAPE_RATIO_MAX REAL_C(30.0)

/* Share of the longest lag with a zero, the longest level, from which on a search has ended there. */
#define SHAPE_AT_BOUND REAL_C(0.98)

/* Steps of a search; each takes four evaluations at most. */
#define SHAPE_SEARCH_TRIES 14

/* Lag and square of a formula at a place, samples. */
void shape_search_lags(const struct shape_fit *f, enum shape_formula formula,
                       const struct shape_place *place, real_t *lag, real_t *square);

/* Squares that are left at a place without and with a zero, squares[2]; the gain of the first, gain and gain_zero of the
 * second: linear[3]. One evaluation. */
void shape_search_squares(struct shape_fit *f, enum shape_formula formula,
                          const struct shape_place *place, real_t *squares, real_t *linear);

/* The response of one lag, gain 1, line taken out. One evaluation. */
void shape_search_response(struct shape_fit *f, const struct shape_place *place, real_t *column);

/* Begins a search of f->formula at a place. One evaluation. */
void shape_search_begin(struct shape_fit *f, const struct shape_place *place);

/* A part of the factors of all columns at f->place, for a step from it and for the covariance: one evaluation. True when they
 * are found, after two or three. All columns are used up. */
bool shape_search_slopes(struct shape_fit *f);

/* A damped step. One evaluation. True when the search has ended; *better: the place has moved, new slopes are wanted. */
bool shape_search_step(struct shape_fit *f, bool *better);

/* Columns of a formula in the order of the triangle, as indices into f->column; returns their number. */
uint32_t shape_search_columns(enum shape_formula formula, uint8_t *columns);

#endif
