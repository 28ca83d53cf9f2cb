#ifndef REFLUX_GMV_GMV_SAMPLES_STATE_H
#define REFLUX_GMV_GMV_SAMPLES_STATE_H

#include "kinds/gmv/gmv_samples.h"

/* Samples that are kept of a signal: horizon, terms, difference and data filter, one after the other, are 8 + 4 + 8 + 7 at
 * most, and P takes one more. A power of two. */
#define GMV_KEPT 32u

struct gmv_signal {
    num_t value[GMV_KEPT];
};

struct gmv_samples {
    struct gmv_shape shape;
    /* Index of the last sample in the signals. */
    uint8_t newest;
    /* Steps since the samples began. */
    uint32_t steps;
    /* R is P. */
    bool weighs_setpoint[GMV_LOOPS];
    /* R w, of R with a time constant. */
    struct accumulator setpoint[GMV_LOOPS];
    /* p and 1/(1 - p) of P. */
    num_t p[GMV_LOOPS], p_scale[GMV_LOOPS];
    /* Setpoints of the last two samples. */
    num_t w[GMV_LOOPS], w_before[GMV_LOOPS];
    /* 1 - r of R. */
    struct coefficient r_share[GMV_LOOPS];
    struct gmv_signal y[GMV_LOOPS], disturbance[GMV_DISTURBANCES];
    /* m_i */
    struct gmv_signal residual[GMV_LOOPS];
    /* Each stands at the step that made it. */
    struct gmv_signal prediction[GMV_LOOPS];
};

/* Starts the samples anew. */
static inline void gmv_samples_begin(struct gmv_samples *m)
{
    m->steps = 0;
}

static inline const struct gmv_shape *gmv_samples_shape(const struct gmv_samples *m)
{
    return &m->shape;
}

#endif
