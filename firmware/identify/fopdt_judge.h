/* Judges a fit whose search is over (fopdt_fit.h): covariance, significance, flags, and the gain from the plateaus. */
#ifndef REFLUX_IDENTIFY_FOPDT_JUDGE_H
#define REFLUX_IDENTIFY_FOPDT_JUDGE_H

#include "identify/fopdt_fit_state.h"

/* Fills f->result. Uses all columns. */
void fopdt_judge(struct fopdt_fit *f);

#endif
