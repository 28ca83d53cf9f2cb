/* Sine and cosine of real_t. In float they use whole numbers and a polynomial and no C library, so the bits are the same everywhere. */
#ifndef REFLUX_NUM_REAL_TRIG_H
#define REFLUX_NUM_REAL_TRIG_H

#include "num/double_symbols.h"
#include "num/real.h"

/* Finds sine and cosine of x, rad. In float the error is at most 1.5e-7 (absolute) for |x| up to 1e4. Beyond that the rounding
 * of the argument (6e-8 |x|) dominates, and above 1e6 both results are NaN. NaN and infinity give NaN. */
void real_sincos(real_t x, real_t *sine, real_t *cosine);

#endif
