/* Chooses among the formulas that have been fitted (shape_fit.h) by an information criterion, and says how sure the result is.
 *
 * The formula with the least BIC is chosen (Schwarz 1978). The deviations mix the formulas with Akaike's weights, exp(-AIC/2)
 * (Burnham and Anderson 2002): a formula too many is a worse choice than one too few, but an error that it would explain must
 * not be left out. Both criteria count as many points as are independent, n (1 - r)/(1 + r), r the lag-one correlation of the
 * residuals. tests/campaign/results/shapes.md has the study. */
#ifndef REFLUX_IDENTIFY_SHAPE_CHOICE_H
#define REFLUX_IDENTIFY_SHAPE_CHOICE_H

#include "identify/shape_fit_state.h"
#include "identify/shape_found.h"

/* Correlation of the residuals of f->formula, right after shape_search_begin() at its best place. */
void shape_choice_residuals(struct shape_fit *f);

/* Covariance of f->formula, right after shape_search_slopes() at its best place. */
void shape_choice_covariance(struct shape_fit *f);

/* Works out what else the choice needs, in two evaluations. */
void shape_choice_prepare(struct shape_fit *f);

/* Weights of the formulas, of sum 1 each. */
struct shape_weights {
    real_t choice[SHAPE_FORMULAS];  /* by BIC */
    real_t mixture[SHAPE_FORMULAS]; /* by AIC */
    real_t tail[SHAPE_TAILS];       /* of slow tails, beside the sum of the mixture */
};

void shape_choice_weights(const struct shape_fit *f, struct shape_weights *w);

/* The shape of a candidate. */
void shape_choice_shape(const struct shape_fit *f, enum shape_formula formula, struct shape *s);

/* Fills *found. */
void shape_choice_find(const struct shape_fit *f, struct shape_found *found);

#endif
