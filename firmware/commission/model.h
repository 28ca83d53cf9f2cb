/* From the tests to the elements of the plant: the fits of the latest test, and how they join those before. model_begin_fit() and
 * model_keep() run in the tick, the pieces in the main loop. */
#ifndef REFLUX_COMMISSION_MODEL_H
#define REFLUX_COMMISSION_MODEL_H

#include "commission/experiment.h"
#include "identify/identified.h"

struct commission;
struct model_fits;

/* Begins the fits of the test that has just ended. Tick. */
void model_begin_fit(struct commission *c);
/* A piece of the fits. True while there is more to do. Main loop. */
bool model_piece(struct commission *c);
/* The latest test joins those before it, once the fits are done. Tick. */
void model_keep(struct commission *c);

/* Share of the response of a fitted output that was still to come when the positive half of the test ended, 0 to 1. */
real_t model_unseen(const struct experiment *x, const struct identified *fit);

#endif
