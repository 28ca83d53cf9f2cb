/* Parts of a step of kinds/composition/covariance_ud.c on the square root S = U D^(1/2), in this order: every extra, every stage from the reboiler up,
 * every stage from the condenser down. Between the parts the triangle holds columns of S and of U D side by side. */
#ifndef REFLUX_COMPOSITION_COVARIANCE_ROOT_H
#define REFLUX_COMPOSITION_COVARIANCE_ROOT_H

#include "kinds/composition/covariance.h"

#define COVARIANCE_UD_BLOCK ((size_t)(COLUMN_COMPONENTS_MAX - 1) * (COLUMN_COMPONENTS_MAX - 1))

struct covariance_ud {
    size_t stages, m, n, extras; /* n: stages m fractions */
    real_t *ud;                  /* packed, n + extras: P between two steps */
    /* within a step */
    real_t *own;   /* [stages][m][m]: diagonal blocks, which are full on the way */
    real_t *left;  /* [stages][m][m]: those left of them */
    real_t *spare; /* [2 (n + extras)] */
    size_t phase, next;
    real_t below[COVARIANCE_UD_BLOCK]; /* the vapour of the stage below, in its own columns */
    enum err err; /* ERR_NOT_FINITE: the last step made something that is no number */
};

/* The column of extra k: what the extras push, Phi, keep, and back to one on the diagonal. */
void covariance_root_extra(struct covariance_ud *c, const struct covariance_step *step, size_t k);
/* Columns of stage s through both sweeps; the vapour of the stage is turned into them. */
void covariance_root_up(struct covariance_ud *c, const struct column_transition *t, size_t s);
/* Row block s becomes upper triangular, and its columns those of U and D. */
void covariance_root_back(struct covariance_ud *c, size_t s);

#endif
