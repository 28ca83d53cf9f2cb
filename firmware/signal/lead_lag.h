/* Lead-lag element (Tlead s + 1)/(Tlag s + 1).
 *
 * Backward Euler: y += h/(Tlag + h) (x - y) + Tlead/(Tlag + h) (x - x'), x' the previous input. Gain exactly 1
 * at rest whatever the rounding of the coefficients; first step after a jump is (Tlead + h)/(Tlag + h).
 */
#ifndef REFLUX_SIGNAL_LEAD_LAG_H
#define REFLUX_SIGNAL_LEAD_LAG_H

#include <stdbool.h>

#include "base/error.h"
#include "num/accumulator.h"

/* Largest Tlead/(Tlag + h): how much a step of one sample is amplified. */
#define LEAD_LAG_MAX_RATIO 100.0f

struct lead_lag {
    struct accumulator y;
    struct coefficient k;    /* h / (Tlag + h) */
    struct coefficient lead; /* Tlead / (Tlag + h) */
    num_t last_x;
    bool through; /* Tlead = Tlag: the output is the input, bit for bit */
};

/* Tlead, Tlag [0, 1e6] s, h [0.001, 1e5] s, Tlead/(Tlag + h) <= 100 (so a lead needs a lag or a long step).
 * Output 0; call reset for a start without a jump. ERR_RANGE or ERR_NOT_FINITE leave *f unchanged. */
MUST_CHECK enum err lead_lag_init(struct lead_lag *f, float lead_s, float lag_s, float h_s);

/* Other times; input and output go on. Ranges and errors as lead_lag_init. */
MUST_CHECK enum err lead_lag_retune(struct lead_lag *f, float lead_s, float lag_s, float h_s);

/* Begins at rest at value. */
void lead_lag_reset(struct lead_lag *f, num_t value);

num_t lead_lag_step(struct lead_lag *f, num_t x);

#endif
