/* State of the square root within a step. For its owner covariance_root.c and for covariance_ud.h, which allocates it. */
#ifndef REFLUX_COMPOSITION_COVARIANCE_ROOT_STATE_H
#define REFLUX_COMPOSITION_COVARIANCE_ROOT_STATE_H

#include "kinds/composition/covariance.h"

#define COVARIANCE_UD_BLOCK ((size_t)(COLUMN_COMPONENTS_MAX - 1) * (COLUMN_COMPONENTS_MAX - 1))

struct covariance_root {
    size_t stages, m, n; /* n: stages m fractions */
    real_t *ud;          /* packed, n + extras: P between two steps */
    real_t *own;         /* [stages][m][m]: diagonal blocks, which are full on the way */
    real_t *left;        /* [stages][m][m]: those left of them */
    real_t below[COVARIANCE_UD_BLOCK]; /* the vapour of the stage below, in its own columns */
    enum err err;
};

#endif
