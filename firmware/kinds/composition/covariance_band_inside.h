/* The work of covariance_band.c at each stage. It is in covariance_band_stage.h, which is built twice: covariance_band_two.c for two
 * fractions a stage, which is what a column on a board mostly has, covariance_band_any.c for any number. */
#ifndef REFLUX_COMPOSITION_COVARIANCE_BAND_INSIDE_H
#define REFLUX_COMPOSITION_COVARIANCE_BAND_INSIDE_H

#include "kinds/composition/covariance.h"

#define COVARIANCE_BAND_M_MAX (COLUMN_COMPONENTS_MAX - 1)
/* Each variance of S becomes so much larger in a step, by 2^-19 of it: more than rounding can take from what it has to be, beside
 * covariances, to be that of a covariance matrix. */
#define COVARIANCE_BAND_GROWTH (REAL_C(1.0) + REAL_C(1.9073486328125e-6))
#define COVARIANCE_BAND_BLOCK  ((size_t)COVARIANCE_BAND_M_MAX * COVARIANCE_BAND_M_MAX)

/* The change of an extra over the step, for the fractions that depend on it. */
struct covariance_band_fresh {
    real_t unknown;                    /* variance of the old extra, given the new ones */
    real_t mix[COVARIANCE_EXTRAS_MAX]; /* the old one by them, less the new one */
};

static inline size_t covariance_band_stride(size_t m, size_t extras)
{
    return (2 * m + extras) * m;
}

/* A covariance as the work at each stage gets it (covariance_band.h has the meaning). */
struct band_view {
    size_t stages, m, extras;
    real_t *blocks;
    /* a sweep */
    const struct covariance_band_fresh *fresh;
    real_t (*block)[COVARIANCE_BAND_BLOCK];
    real_t *row;
    size_t next;
    bool down;
};

/* block[] of a sweep, which it takes from stage to stage; b stands for the numbers before the sweep down, r between the two, d after the
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

/* Does `count` stages more of a sweep, from c->next on. */
void covariance_band_sweep_two(struct band_view *c, const struct covariance_step *step,
                               size_t count);
void covariance_band_sweep_any(struct band_view *c, const struct covariance_step *step,
                               size_t count);

/* A measurement's effect on S and M of all stages, and the gains of their fractions. */
void covariance_band_spread_two(const struct band_view *c, const struct band_seen *seen,
                                real_t *gain);
void covariance_band_spread_any(const struct band_view *c, const struct band_seen *seen,
                                real_t *gain);

#endif
