/* What a loop does in answer to something that is added to its MV, by a model: so, on the same data, what it would have done without
 * its feedforward, or with another one.
 *
 *     y_shadow = Gp/(1 + Gp C) v      y without v = y - y_shadow      Gp = gain e^(-dead s)/(lag s + 1),  C: PI as kinds/pid/pid.h has it */
#ifndef REFLUX_FF_TUNE_LOOP_SHADOW_H
#define REFLUX_FF_TUNE_LOOP_SHADOW_H

#include <stdbool.h>
#include <stdint.h>

#include "lti/fopdt.h"

#define SHADOW_REACH 104u /* samples of dead time, with a fraction */

struct loop_shadow {
    real_t decay, into, fraction; /* of the model, per sample */
    real_t gain, integral_share;  /* of the controller */
    real_t x, integral;
    uint8_t dead;
    bool lost;              /* it has grown beyond all measure: the model's loop is not stable */
    real_t u[SHADOW_REACH]; /* newest first */
};

/* At rest. The model's gain: measurement span per output span; its time constant may be 0; a dead time beyond SHADOW_REACH - 2 samples counts
 * as that. gain: as in loop_response_of_pi(); h_s: of a sample. */
void shadow_begin(struct loop_shadow *s, const struct fopdt *m, real_t gain, real_t ti_s,
                  real_t h_s);
/* y_shadow of this sample, from the v of those before; then v acts. */
real_t shadow_step(struct loop_shadow *s, real_t v);

#endif
