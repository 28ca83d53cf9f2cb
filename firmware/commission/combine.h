/* Combines several tests of one input to one element. Main loop and tick. */
#ifndef REFLUX_COMMISSION_COMBINE_H
#define REFLUX_COMMISSION_COMBINE_H

#include "identify/identified.h"

/* Adds a test to an element: gains and times are weighted by their variances. */
void model_combine(struct identified *sum, const struct identified *next);
/* The mean of two numbers, weighted by the variances of the two gains. */
real_t combine_by_gains(real_t a, const struct identified *of_a, real_t b,
                        const struct identified *of_b);

#endif
