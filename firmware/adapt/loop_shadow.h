/* What a loop does in answer to something that is added to its MV, by a model: so, on the same data, what it would have done without
 * its feedforward, or with another one.
 *
 *     y_shadow = Gp/(1 + Gp C) v      y without v = y - y_shadow      Gp = gain e^(-dead s)/(lag s + 1),  C: PI as control/pid.h has it
 *
 * The first-order model is fitted to a frequency response (R. Siddha 2003, L1001 to 1009, reads it off at one frequency; here all of the grid
 * counts): gain and lag by least squares of 1/|G|^2 = (1 + (w lag)^2)/gain^2, the dead time such that the distances, each over |G|, have the
 * least sum of squares. */
#ifndef REFLUX_ADAPT_LOOP_SHADOW_H
#define REFLUX_ADAPT_LOOP_SHADOW_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "num/cmatrix.h"

struct shadow_model {
    real_t gain, lag_s, dead_s; /* measurement span per output span */
    real_t off;                 /* r.m.s. of the distance to the response, over its size */
};

/* points from 2, at rising omega, rad/s, magnitudes of g above 0; sign: of the gain, +1 or -1. dead_most: s. ERR_SINGULAR: no
 * first-order gain comes out, *m is not written. */
MUST_CHECK enum err shadow_fit(const real_t *omega, const struct cplx *g, unsigned points,
                               real_t sign, real_t dead_most, struct shadow_model *m);

#define SHADOW_REACH 104u /* samples of dead time, with a fraction */

struct loop_shadow {
    real_t decay, into, fraction; /* of the model, per sample */
    real_t gain, integral_share;  /* of the controller */
    real_t x, integral;
    uint8_t dead;
    bool lost;              /* it has grown beyond all measure: the model's loop is not stable */
    real_t u[SHADOW_REACH]; /* newest first */
};

/* At rest. dead times beyond SHADOW_REACH - 2 samples count as that. gain: as in loop_response_of_pi(); h_s: of a sample. */
void shadow_begin(struct loop_shadow *s, const struct shadow_model *m, real_t gain, real_t ti_s,
                  real_t h_s);
/* y_shadow of this sample, from the v of those before; then v acts. */
real_t shadow_step(struct loop_shadow *s, real_t v);

#endif
