/* The shape of one element: gain (zero_s s + 1) exp(-dead_time_s s) / (square_s2 s^2 + lag_s s + 1).
 *
 * lag_s is the sum of two lags, or 2 zeta/omega of a damped element; square_s2 is their product, or 1/omega^2. Square 0 and
 * zero 0 are one lag. The element is stable where lag_s is above 0 and square_s2 is not below 0.
 *
 * An integrating element with a lag has no gain. It stands here with SHAPE_INTEGRATOR_TIMES times the record as its long lag,
 * and with its slope times that lag as its gain. At frequencies above 1/record such a lag differs from an integrator by at
 * most 1/SHAPE_INTEGRATOR_TIMES in phase (0.6 degrees), and its ramp bends by 0.5 % within the record, which is less than
 * the noise shows. A longer lag would cost digits: the response is the difference of 1 and nearly 1 in float. */
#ifndef REFLUX_LTI_SHAPE_H
#define REFLUX_LTI_SHAPE_H

#include "num/real.h"

#define SHAPE_INTEGRATOR_TIMES REAL_C(100.0)

struct shape {
    real_t gain;        /* output unit per input unit, either sign */
    real_t dead_time_s; /* s, 0 and up */
    real_t lag_s;       /* s, 0 and up */
    real_t square_s2;   /* s^2, 0 and up */
    real_t zero_s;      /* s, either sign: below 0 the response begins the wrong way */
};

/* Average residence time, s: area above the unit step response over its end. Below 0 where the zero is long. */
static inline real_t shape_residence_s(const struct shape *s)
{
    return s->dead_time_s + s->lag_s - s->zero_s;
}

#endif
