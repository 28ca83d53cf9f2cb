/* One way from an input to an output, all rounds together: a record of model.c, which alone writes it. */
#ifndef REFLUX_COMMISSION_ELEMENT_H
#define REFLUX_COMMISSION_ELEMENT_H

#include "identify/identified.h"
#include "identify/shape_found.h"

#define ASYMMETRY_UNIT REAL_C(1000.0)

struct element {
    struct shape_found found; /* least squares, weighted over the rounds; the design uses it */
    uint16_t flags;           /* enum identified_flag */
    uint16_t moments_flags;
    struct fopdt moments; /* of the last round: a second opinion */
    real_t plateau_gain;  /* of the last round; 0: none */
    /* Gain up less gain down over their mean, last round, in 1/ASYMMETRY_UNIT; 0: none that is certain. */
    int16_t asymmetry;
};

/* Standard deviation of the sum of the lags, s. Without a zero that is at most what residence time and dead time leave, because
 * another plausible shape may add a lag and a zero that nearly cancel: the sum grows, but the response lasts no longer. */
static inline real_t element_lag_sd_s(const struct shape_found *f)
{
    real_t lag = f->sd[SHAPE_LAG], dead = f->sd[SHAPE_DEAD];
    real_t left = real_sqrt(f->residence_sd_s * f->residence_sd_s + dead * dead);
    return f->parameters < 5u && left < lag ? left : lag;
}

/* A shape as one lag of the sum of its lags, with the deviations. */
static inline struct identified element_of_found(const struct shape_found *f, uint16_t flags)
{
    return (struct identified){.gain = f->shape.gain,
                               .time_constant_s = f->shape.lag_s,
                               .dead_time_s = f->shape.dead_time_s,
                               .gain_sd = f->sd[SHAPE_GAIN],
                               .time_constant_sd_s = element_lag_sd_s(f),
                               .dead_time_sd_s = f->sd[SHAPE_DEAD],
                               .flags = flags};
}

static inline struct identified element_fit(const struct element *e)
{
    return element_of_found(&e->found, e->flags);
}

#endif
