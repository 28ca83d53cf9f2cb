/* One element of the plant as identified: gain exp(-dead_time s) / (time_constant s + 1), and how sure
 * it is. Every method of this layer answers with it. */
#ifndef REFLUX_IDENTIFY_IDENTIFIED_H
#define REFLUX_IDENTIFY_IDENTIFIED_H

#include <stdbool.h>
#include <stdint.h>

#include "lti/fopdt.h"
#include "num/real.h"

enum identified_flag {
    IDENTIFIED_NO_GAIN =
        1 << 0, /* gain not distinguishable from noise: both times are 0 and mean nothing */
    IDENTIFIED_NEGATIVE_T =
        1 << 1, /* moments: T < 0; answered with T = 0, K and L estimated again */
    IDENTIFIED_NEGATIVE_RADICAND =
        1 << 2, /* moments: a^2 < 0, no lag to be seen; answered likewise with T = 0 */
    IDENTIFIED_NEGATIVE_L =
        1 << 3,                /* moments: L < 0; answered with L = 0, K and T estimated again */
    IDENTIFIED_SHORT = 1 << 4, /* record too short for what was found: K is an extrapolation */
    IDENTIFIED_NOT_SETTLED = 1 << 5, /* still moving when the record ends */
    IDENTIFIED_INTEGRATING =
        1 << 6, /* not distinguishable from an integrator: no gain to be had, refuse */
    IDENTIFIED_INVERSE = 1 << 7,     /* moved the wrong way first */
    IDENTIFIED_OSCILLATORY = 1 << 8, /* turned more often than a first-order response can */
    /* The last three are flags of a shape (shape_found.h). */
    IDENTIFIED_SLOW = 1 << 9,     /* its gain and time are at least these */
    IDENTIFIED_UNKNOWN = 1 << 10, /* nothing is known of it */
    IDENTIFIED_RAMP = 1 << 11     /* an integrator whose slope is known */
};

struct identified {
    real_t gain;            /* output unit per input unit, either sign */
    real_t time_constant_s; /* s, 0 and up: 0 is an answer (fopdt_validate() of lti refuses it) */
    real_t dead_time_s;     /* s, 0 and up */
    real_t gain_sd;         /* standard deviations; 0 when no noise is known of */
    real_t time_constant_sd_s;
    real_t dead_time_sd_s;
    uint16_t flags; /* enum identified_flag */
};

#define IDENTIFIED_OVER                                                                            \
    REAL_C(3.0) /* time constants after which a twentieth of a response is left */
#define IDENTIFIED_TIMED                                                                           \
    REAL_C(0.5) /* largest standard deviation of a known time constant, over it */

/* Time from a step to the end of the response but for a twentieth, s. */
static inline real_t identified_over_s(const struct identified *e)
{
    return e->dead_time_s + IDENTIFIED_OVER * e->time_constant_s;
}

/* The time constant is known within a half. */
static inline bool identified_is_timed(const struct identified *e)
{
    return !(e->flags & (IDENTIFIED_UNKNOWN | IDENTIFIED_INTEGRATING)) &&
           e->time_constant_sd_s < IDENTIFIED_TIMED * e->time_constant_s;
}

/* Prior knowledge of an output apart from its response: y(t) = offset + slope t + response + noise. Times and offset
 * count as the method says that takes it. All 0: nothing to remove, no noise. */
struct baseline {
    real_t offset;      /* output unit */
    real_t slope_per_s; /* output unit per second */
    real_t offset_sd;   /* standard deviations of the two */
    real_t slope_sd_per_s;
    real_t noise_sd; /* of one sample, output unit */
};

/* Magnitudes up to 1e12, standard deviations not below 0. ERR_NOT_FINITE, ERR_RANGE. */
MUST_CHECK enum err baseline_validate(const struct baseline *b);

/* Line through two means: mean_0 about time t0_s and mean_1 about t1_s > t0_s, with their standard deviations. The
 * surest drift there is for a double step: before its first edge and after it has died away. ERR_RANGE when t1_s is
 * not above t0_s, ERR_NOT_FINITE. */
MUST_CHECK enum err baseline_from_means(real_t t0_s, real_t mean_0, real_t sd_0, real_t t1_s,
                                        real_t mean_1, real_t sd_1, real_t noise_sd,
                                        struct baseline *result);

#endif
