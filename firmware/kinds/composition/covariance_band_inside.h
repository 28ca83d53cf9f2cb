/* Functions that the files of the banded covariance share: covariance_band_step.c (beginning, extras, pieces of a step), covariance_band_take.c
 * (measurements), and the work at each stage in covariance_band_stage.h, which is built twice: covariance_band_two.c for two
 * fractions a stage, which is what a column on a board mostly has, covariance_band_any.c for any number. */
#ifndef REFLUX_COMPOSITION_COVARIANCE_BAND_INSIDE_H
#define REFLUX_COMPOSITION_COVARIANCE_BAND_INSIDE_H

#include "kinds/composition/covariance_band.h"

/* Phases of a step. The sweeps go from the condenser down and back. */
enum { BAND_BEGINS, BAND_SWEEPS_DOWN, BAND_SWEEPS_UP };

/* c->block, which a sweep takes from stage to stage; b stands for the numbers before the sweep down, r between the two, d after the
 * sweep up, w for the vapour that leaves, C for a covariance. */
enum {
    BAND_B_SAYS_R = 0, /* down: S_(s+1)^-1 C(b_(s+1), r_(s+1)) */
    BAND_W_R = 0,      /* up: C(w_(s-1), r_s) */
    BAND_D_R = 1,      /* C(d_(s-1), r_s) */
    BAND_D_W = 2,      /* C(d_(s-1), w_(s-1)) */
    BAND_W_W = 3       /* C(w_(s-1), w_(s-1)) */
};

/* A measurement, as its stage sees it. */
struct band_seen {
    size_t stage;
    real_t slope[COVARIANCE_BAND_M_MAX];
    real_t by_extra[COVARIANCE_EXTRAS_MAX], extra_gain[COVARIANCE_EXTRAS_MAX]; /* f, T f */
    real_t spread, bound;                                                      /* h S h', a */
    real_t per_bound, per_alpha, left; /* 1/a, 1/alpha, variance/a */
};

static inline real_t band_at_least(real_t variance)
{
    return variance > COVARIANCE_LEAST ? variance : COVARIANCE_LEAST;
}

/* Does `count` stages more of the sweep of c->phase, from c->next on. */
void covariance_band_sweep_two(struct covariance_band *c, const struct covariance_step *step,
                               size_t count);
void covariance_band_sweep_any(struct covariance_band *c, const struct covariance_step *step,
                               size_t count);

/* A measurement's effect on S and M of all stages, and the gains of their fractions. */
void covariance_band_spread_two(const struct covariance_band *c, const struct band_seen *seen,
                                real_t *gain);
void covariance_band_spread_any(const struct covariance_band *c, const struct band_seen *seen,
                                real_t *gain);

#endif
