/* From finished tests to the elements of the plant: the background's part of commission.h. */
#ifndef REFLUX_COMMISSION_MODEL_H
#define REFLUX_COMMISSION_MODEL_H

#include "commission/commission_state.h"

/* Begins the job on what the tick has left in `c`. */
void model_begin_fit(struct commission *c);
/* Share of the response of a fitted output that was still to come when the positive half of the test ended, 0 to 1. */
real_t model_unseen(const struct experiment *x, const struct identified *fit);
/* The tick's part once it is done: the latest test joins those before it. */
void model_keep(struct commission *c);
/* The analysis takes the place of the last test in memory. */
void model_begin_analysis(struct commission *c, const struct config *config, real_t h_s);
/* A piece of the job that `commission` (a struct commission) is doing. True while there is more to do. */
bool model_work(void *commission);

#endif
