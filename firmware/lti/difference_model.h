/* A plant in discrete time: A(z^-1) y = B(z^-1) u with A diagonal, so that each output has a denominator of its own.
 * Source: J. Kotyk and J. Machacek, Sci. Papers Univ. Pardubice, Ser. A 1 (1995), section 2. */
#ifndef REFLUX_LTI_DIFFERENCE_MODEL_H
#define REFLUX_LTI_DIFFERENCE_MODEL_H

#include <stdint.h>

#include "base/error.h"
#include "lti/double_symbols.h"
#include "num/real.h"

#define DIFFERENCE_MOST   4 /* outputs and inputs */
#define DIFFERENCE_A_MOST 4 /* coefficients of A_ii behind the 1 */
#define DIFFERENCE_B_MOST 8 /* of B_ij, from z^-1 on; dead time is leading zeros */

struct difference_model {
    uint8_t outputs, inputs; /* 1 to DIFFERENCE_MOST */
    uint8_t na, nb;  /* coefficients of each A_ii, 0 to DIFFERENCE_A_MOST, and B_ij, from 1 */
    real_t period_s; /* of the samples, s, (0, 1e6] */
    /* A_ii = 1 + a[i][0] z^-1 + a[i][1] z^-2 + ... */
    real_t a[DIFFERENCE_MOST][DIFFERENCE_A_MOST];
    /* B_ij = b[i][j][0] z^-1 + b[i][j][1] z^-2 + ..., in units of output i per unit of input j */
    real_t b[DIFFERENCE_MOST][DIFFERENCE_MOST][DIFFERENCE_B_MOST];
};

/* Past inputs and outputs, newest first, as deviations from where the model is at rest. Zeros: at rest. */
struct difference_state {
    real_t y[DIFFERENCE_MOST][DIFFERENCE_A_MOST];
    real_t u[DIFFERENCE_MOST][DIFFERENCE_B_MOST];
};

/* Sizes, period, coefficients within them; what lies behind na and nb is not looked at. *field: which is wrong, *wanted:
 * what would be right, in words; either may be NULL. NaN and infinity are ERR_NOT_FINITE, all else ERR_RANGE. */
MUST_CHECK enum err difference_check(const struct difference_model *model, const char **field,
                                     const char **wanted);

/* Gains at rest, B_ij(1)/A_ii(1), of a model that difference_check accepts; rows and columns beyond its outputs and inputs
 * are left alone. Each within (na + nb + 2) REAL_EPSILON (sum |b|/|A(1)| + |gain| (1 + sum |a|)/|A(1)|) of the exact one.
 * ERR_SINGULAR: an A_ii(1) is 0 but for rounding, the output integrates; nothing is written. */
MUST_CHECK enum err difference_gain(const struct difference_model *model,
                                    real_t gain[DIFFERENCE_MOST][DIFFERENCE_MOST]);

/* One period on: u [inputs] acts from this sample to the next, y [outputs] gets the outputs at the next. y may not be u. */
void difference_step(const struct difference_model *model, struct difference_state *state,
                     const real_t *u, real_t *y);

#endif
