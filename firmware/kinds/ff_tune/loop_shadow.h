/* The answer of a loop to something that is added to its MV, by a model. So the same data tell what the loop would have done without its
 * feedforward, or with another one.
 *
 *     y_shadow = Gp/(1 + Gp C) v      y without v = y - y_shadow      Gp = gain e^(-dead s)/(lag s + 1),  C: PI as kinds/pid/pid.h has it */
#ifndef REFLUX_FF_TUNE_LOOP_SHADOW_H
#define REFLUX_FF_TUNE_LOOP_SHADOW_H

#include <stdbool.h>
#include <stdint.h>

#include "lti/fopdt.h"

/* Samples of dead time, with a fraction. */
#define SHADOW_REACH 104u

struct loop_shadow {
    /* Model, per sample. */
    real_t decay, share, fraction;
    /* Controller. */
    real_t gain, integral_share;
    real_t x, integral;
    uint8_t dead;
    bool lost;
    /* newest first */
    real_t u[SHADOW_REACH];
};

/* Begins at rest. The model's gain is measurement span per output span; its time constant may be 0; a dead time beyond SHADOW_REACH - 2 samples
 * counts as that. gain: as in loop_response_of_pi(); h_s: interval of a sample. */
void shadow_begin(struct loop_shadow *s, const struct fopdt *m, real_t gain, real_t ti_s,
                  real_t h_s);
/* Returns y_shadow of this sample, from the v of those before; then v acts. */
real_t shadow_step(struct loop_shadow *s, real_t v);
/* It has grown beyond all measure: the model's loop is not stable. */
bool shadow_is_lost(const struct loop_shadow *s);

#endif
