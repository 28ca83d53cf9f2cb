/* A column that moves a little from step to step, another as its truth, and the estimator `composition` on it. For the image and for
 * the host. */
#ifndef REFLUX_BENCH_COLUMN_H
#define REFLUX_BENCH_COLUMN_H

#include "composition_whole.h"

#define BENCH_SENSORS 4
#define BENCH_STEP_S  30

enum bench_truncated { ALL_STAGES, BETWEEN_ON_A_LINE, BETWEEN_BY_THE_MEAN };

/* The splitter with so many stages, its profile stretched and then settled; sensors in its quarters, each moving a mole fraction.
 * 11 of the 37 stages may be truncated. False: it has no steady state, and there is nothing to measure. */
bool bench_begin(struct composition_block *estimator, size_t stages, enum composition_method method,
                 enum bench_truncated truncated);

/* Moves the inputs, steps the truth, and reads it with noise. */
void bench_next(struct composition_block *estimator, float *t);

/* The largest deviation of these mole fractions from the truth's. */
real_t bench_off(const real_t *x);

#endif
