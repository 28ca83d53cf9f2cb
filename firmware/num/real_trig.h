/* Sine and cosine of real_t. Float: whole numbers and a polynomial, no C library, so the same bits everywhere. */
#ifndef REFLUX_NUM_REAL_TRIG_H
#define REFLUX_NUM_REAL_TRIG_H

#include "num/double_symbols.h"
#include "num/real.h"

/* x in rad, finite. Float: error at most 1.5e-7 (absolute) for |x| up to 1e4; beyond, the argument's own rounding
 * (6e-8 |x|) rules, and above 1e6 both results are NaN. NaN and infinity give NaN. */
void real_sincos(real_t x, real_t *sine, real_t *cosine);

#endif
