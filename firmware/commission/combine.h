/* What several tests of one input say of an element, together. */
#ifndef REFLUX_COMMISSION_COMBINE_H
#define REFLUX_COMMISSION_COMBINE_H

#include "identify/identified.h"

/* Element with several tests behind it: gains and times weighted by how well each test knew them. */
void model_combine(struct identified *sum, const struct identified *next);
/* The mean of two numbers, weighted by how well the gains of these two are known. */
real_t combine_by_gains(real_t a, const struct identified *of_a, real_t b,
                        const struct identified *of_b);

#endif
