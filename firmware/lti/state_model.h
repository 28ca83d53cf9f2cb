/* A plant as matrices: x' = A x + B u + E d, y = C x, deviations from where it is at rest; d are disturbances. In discrete time x' is x
 * a period later. There is no feedthrough. */
#ifndef REFLUX_LTI_STATE_MODEL_H
#define REFLUX_LTI_STATE_MODEL_H

#include "lti/double_symbols.h"
#include "num/matrix.h"

#define STATE_MODEL_STATES       MATRIX_MAX
#define STATE_MODEL_OUTPUTS      8 /* and inputs */
#define STATE_MODEL_DISTURBANCES 8

/* a: states x states, b: states x inputs, c: outputs x states, e: states x disturbances; e.cols is 0 where there are none. A matrix's own
 * size counts, and those of a say how many states there are. */
struct state_model {
    real_t period_s; /* 0: continuous, rates per second; else of the samples, to 1e6 */
    struct matrix a, b, c, e;
};

struct state_model_work {
    struct matrix power, sum, next;
};

/* Sizes, period, elements. *field: which is wrong, *wanted: what would be right, in words; either may be NULL. NaN, infinity and
 * magnitudes above 1e15 are ERR_NOT_FINITE, all else ERR_RANGE. */
MUST_CHECK enum err state_model_check(const struct state_model *model, const char **field,
                                      const char **wanted);

/* A continuous model as samples see it that are period_s apart, inputs and disturbances held in between: exp(A T), and the integral of it
 * times B and E. Taylor's series at T/2^k, then k doublings (Van Loan, IEEE Trans. Automatic Control 23 (1978) 395, has the
 * integral; the doubling of both together is ours). ERR_RANGE: the model is not continuous, or the period too long for a
 * number to stay below 1e15. 16 states: up to 6e5 instructions. */
MUST_CHECK enum err state_model_sample(const struct state_model *continuous, real_t period_s,
                                       struct state_model_work *work, struct state_model *sampled);

#endif
