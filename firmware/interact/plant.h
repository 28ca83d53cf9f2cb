/* The plant as the analysis sees it: p outputs, m inputs, a model with dead time and one or two lags for every pair, and
 * how well its gain is known.
 *
 * Shapes: element[i][j] is the way from input j to output i, both from 0. Gains are output span per input span: relative
 * gains of a square plant do not depend on it, singular values, condition numbers and the choice of outputs do. */
#ifndef REFLUX_INTERACT_PLANT_H
#define REFLUX_INTERACT_PLANT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "interact/double_symbols.h"
#include "lti/fopdt.h"
#include "num/cmatrix.h"
#include "num/matrix.h"

#define INTERACT_MAX  MATRIX_MAX
#define INTERACT_NONE 255 /* no input, no output */

/* The part of an element beyond one lag. With gain K, dead time L and time constant T of the element it is
 *     K (zero_s s + 1) e^{-Ls} / (square_s2 s^2 + T s + 1)
 * T is then the sum of the lags, and square_s2 their product. Both 0: one lag. */
struct interact_shape {
    real_t square_s2; /* 0 to 1e12 s2; above 0 the damping T/(2 sqrt(square_s2)) is at least 0.01 */
    real_t zero_s;    /* -1e6 to 1e6 s, 0 where T is 0; below 0 the response begins the wrong way */
};

struct interact_plant {
    uint8_t outputs, inputs; /* 1 to INTERACT_MAX */
    /* Time constant and dead time each 0 to 1e6 s, 0 allowed (a direct effect). Gain 0: no effect, times unused. */
    struct fopdt element[INTERACT_MAX][INTERACT_MAX];
    struct interact_shape shape[INTERACT_MAX][INTERACT_MAX];
    /* Standard deviation of each gain, same unit, 0 or more; errors are taken as normal and independent. An error
     * common to an input's whole column (a wrong step size) changes no relative gain and need not be counted. */
    real_t gain_sd[INTERACT_MAX][INTERACT_MAX];
    /* A direction of the inputs along which gains were measured together, too, by input; and by output the standard deviation of
     * that sum, 0: it was not measured. interact/direction.h. */
    real_t share[INTERACT_MAX];
    real_t along_sd[INTERACT_MAX];
};

/* Rows and columns of a plant, in the order wanted. As a pairing: output[k] is controlled by input[k]. */
struct pairs {
    uint8_t n; /* 0 to INTERACT_MAX */
    uint8_t output[INTERACT_MAX], input[INTERACT_MAX];
};

/* The fault, in words, and its place; pointers to constant text. */
struct interact_refusal {
    const char *field, *wanted;
    uint8_t output, input;
};

/* A number of a configuration, and the bounds that it must be within. */
struct interact_range {
    real_t value, lo, hi;
    const char *field, *wanted;
};

/* Checks n numbers in turn. ERR_RANGE, ERR_NOT_FINITE: reason gets the first that is not within its bounds. */
MUST_CHECK enum err interact_check_ranges(const struct interact_range *ranges, size_t n,
                                          struct interact_refusal *reason);

/* First thing that is wrong: ERR_RANGE or ERR_NOT_FINITE; why may be NULL. */
MUST_CHECK enum err interact_check(const struct interact_plant *plant,
                                   struct interact_refusal *reason);

/* Every output and input of the plant, and none twice: ERR_RANGE. n = 0 is fine. */
MUST_CHECK enum err pairs_check(const struct interact_plant *plant, const struct pairs *pairs,
                                struct interact_refusal *reason);

/* Gains of the pairs (row k output[k], column l input[l]), or of the whole plant with NULL. */
void interact_gains(const struct interact_plant *plant, const struct pairs *pairs,
                    struct matrix *gains);
/* Response at omega, rad/s, 0 or more; rows and columns as above. */
void interact_response(const struct interact_plant *plant, const struct pairs *pairs, real_t omega,
                       struct cmatrix *response);
/* gain exp(-i omega L) / (1 + i omega T). */
struct cplx fopdt_response(const struct fopdt *model, real_t omega);

static inline bool interact_one_lag(const struct interact_shape *shape)
{
    return !(shape->square_s2 > REAL_C(0.0)) && !(real_abs(shape->zero_s) > REAL_C(0.0));
}
/* Returns the mean residence time L + T - zero_s of an element, s. A zero that makes the response overshoot by much makes it
 * negative. output and input must be of the plant. */
static inline real_t interact_residence(const struct interact_plant *plant, size_t output,
                                        size_t input)
{
    const struct fopdt *e = &plant->element[output][input];
    return e->dead_time_s + e->time_constant_s - plant->shape[output][input].zero_s;
}

#endif
