/* Upcrossing guards: how far would each output go if the negative half of the double step began now?
 *
 * Line guard (Johansson 1994): yhat = v t, v the slope now, t the time since the step. v is a regression that forgets,
 * over a window as short as the noise allows. v t is the peak of a ramp after any dead time, known or not; but on
 * every response that bends it comes out below y itself. So what has been reached, and the way of one dead time from
 * there when L is known, are taken too:
 *     predicted = v t or y + v L, whichever is larger in magnitude
 * On a first-order response that is never below the peak by more than one sample's motion, and v L where L is not known.
 * No verdict before the blanking time is over: plants that move the wrong way first.
 *
 * Model guard: the first-order model fitted to all data so far (identify/fopdt_fit.h) says where the peak would be,
 * K a (1 - e^(-t/T)) and the drift until then, and its covariance how sure that is.
 */
#ifndef REFLUX_IDENTIFY_GUARD_H
#define REFLUX_IDENTIFY_GUARD_H

#include <stdbool.h>
#include <stdint.h>

#include "base/channel.h"
#include "base/error.h"
#include "identify/fopdt_fit.h"
#include "num/real.h"

/* Windows of about 2, 4, 8 .. 1024 samples; the shortest is a plain difference. */
#define GUARD_WINDOWS 10

struct guard_output {
    real_t initial;     /* level before the step */
    real_t limit;       /* largest deviation allowed, above 0 */
    real_t noise_sd;    /* of one sample, 0 and up */
    real_t dead_time_s; /* if known, else 0 */
};

struct guard_config {
    uint32_t outputs;  /* 1 to CHANNEL_MAX */
    real_t h_s;        /* s, [1e-3, 1e5] */
    real_t blanking_s; /* no verdict before, [0, 1e6] */
    /* Part of the limit that noise may make of a prediction (one standard deviation), (0, 0.5]; 0.05. */
    real_t noise_share;
    struct guard_output output[CHANNEL_MAX];
};

struct guard_prediction {
    real_t source;    /* v t, as the source has it */
    real_t predicted; /* peak deviation with the additions above */
    real_t slope_per_s;
    real_t sd;       /* of predicted, from the noise */
    uint32_t window; /* samples, about */
};

struct guard {
    struct guard_config config;
    uint32_t samples;
    real_t ages[GUARD_WINDOWS][3]; /* sums of weight age^n: the same for every output */
    real_t sums[GUARD_WINDOWS][CHANNEL_MAX][2]; /* sums of weight age^n y */
    real_t last[CHANNEL_MAX], previous[CHANNEL_MAX];
};

/* ERR_RANGE, ERR_NOT_FINITE: *g unchanged. */
MUST_CHECK enum err guard_init(struct guard *g, const struct guard_config *config);

/* A sample of every output; the first is the one at whose instant the step begins. *trip: the output most over its
 * limit, or -1. Nothing trips before the third sample or within the blanking time. ERR_NOT_FINITE, ERR_RANGE (more
 * than 1e12 from the initial level): *g and *trip unchanged. */
MUST_CHECK enum err guard_step(struct guard *g, const real_t *y, int *trip);

/* The line guard's prediction for one output after the latest sample. ERR_EMPTY before the third, ERR_RANGE. */
MUST_CHECK enum err guard_predict(const struct guard *g, uint32_t output,
                                  struct guard_prediction *result);

/* Peak deviation from the fitted model if the negative half began elapsed_s after the first edge, amplitude its height,
 * counted from the level at that edge; *sd from the covariance of K and T (the drift's own is not in it). Where the gain
 * is lost in the noise, the peak is the drift alone and the sd that of what could hide there. ERR_RANGE, ERR_NOT_FINITE. */
MUST_CHECK enum err guard_model_peak(const struct fopdt_fit_result *fit, real_t amplitude,
                                     real_t elapsed_s, real_t *peak, real_t *sd);

#endif
