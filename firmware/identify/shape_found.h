/* Record of an element whose shape has been fitted: the shape that was chosen, how sure it is, and the next plausible
 * one. The deviations include the choice: shapes that explain the record as well, each with its weight. */
#ifndef REFLUX_IDENTIFY_SHAPE_FOUND_H
#define REFLUX_IDENTIFY_SHAPE_FOUND_H

#include <stdbool.h>
#include <stdint.h>

#include "lti/shape.h"
#include "num/real.h"

enum shape_kind {
    /* Nothing is known of the element. It is not zero, and nothing may be built on it. */
    SHAPE_UNKNOWN,
    /* No response stands out of the noise: the gain is that of a lag of a quarter of the longest level, which lag_s says, with
     * its deviation. A slower response than that may exist, and so may a larger gain with it. */
    SHAPE_NO_RESPONSE,
    SHAPE_ONE_LAG,
    SHAPE_TWO_LAGS,      /* or damped */
    SHAPE_TWO_WITH_ZERO, /* of either sign */
    /* A ramp with a lag (lti/shape.h): its slope is gain over lag. */
    SHAPE_INTEGRATING,
    /* The record does not show the end: gain and lag are what has been seen so far, with the beginning of the response as it
     * is. The element has at least these; only one that overshoots may come back from its gain. */
    SHAPE_SLOW,
    /* The shape that was chosen has been seen to its end, but one that has not been is nearly as plausible. Less noise tells as well as
     * a longer record. */
    SHAPE_PERHAPS_SLOW
};

enum shape_parameter { SHAPE_GAIN, SHAPE_DEAD, SHAPE_LAG, SHAPE_SQUARE, SHAPE_ZERO };

#define SHAPE_PARAMETERS   5
#define SHAPE_CORRELATIONS 10

struct shape_found {
    struct shape shape;
    /* Standard deviations in the order of enum shape_parameter, the choice included. */
    real_t sd[SHAPE_PARAMETERS];
    real_t residence_sd_s; /* of the average residence time, likewise */
    /* The same of one shape and without slow tails. Draws use it: a tail changes little at the frequencies at which a loop
     * acts, a lag of the tail's deviation would change much there. */
    real_t residence_drawn_sd_s;
    /* The next plausible shape, each parameter by the upper half of its float. */
    uint16_t other[SHAPE_PARAMETERS];
    uint8_t other_weight; /* of 255 */
    uint8_t kind;         /* enum shape_kind */
    /* Parameters that the shape has: 3 for one lag, 4 with a square, 5 with a zero; and those of the other. */
    uint8_t parameters, other_parameters;
    /* Correlations of gain, dead time, residence time, square and zero of one shape, of 127: lower triangle by rows without
     * its diagonal. */
    int8_t correlation[SHAPE_CORRELATIONS];
};

/* Packs: chosen and other with the weight of the other (0 to 1), `within`, the covariance of gain, dead time, residence time,
 * square and zero without the difference of the two (lower triangle by rows with its diagonal), and the variance of the lag,
 * the choice included. The deviations are found. */
void shape_found_pack(struct shape_found *f, const struct shape *chosen, uint8_t parameters,
                      const struct shape *other, uint8_t other_parameters, real_t other_weight,
                      const real_t *within, real_t lag_variance);

/* Adds a variance of the residence time, s2, of which draws know nothing. */
void shape_found_add_tails(struct shape_found *f, real_t variance);

/* The next plausible shape; returns its weight, 0 to 1. */
real_t shape_found_other(const struct shape_found *f, struct shape *other);

/* Covariance of the parameters in the order of enum shape_parameter, the choice included: all 25 elements. Rounded
 * correlations make it inexact by about 1 %; sd and residence_sd_s are exact. */
void shape_found_covariance(const struct shape_found *f, real_t *covariance);

/* Draw number n of a seed: a plausible member. It takes the chosen shape or the other by weight, and its parameters from
 * their covariance, of which slow tails of the residence time are left out. The result is stable: times are not below 0, the lag not below a twentieth of the chosen one, damping not
 * below 0.1. A gain of three deviations keeps its sign and a tenth of its size. Same seed and n, same member. */
void shape_found_draw(const struct shape_found *f, uint32_t seed, uint32_t n, struct shape *member);

#endif
