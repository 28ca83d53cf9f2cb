/* Numbers and checks that the files of this layer share. */
#ifndef REFLUX_IDENTIFY_COMMON_H
#define REFLUX_IDENTIFY_COMMON_H

#include "base/error.h"
#include "num/real.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)
#define TWO  REAL_C(2.0)

/* Largest value of a sample: squares of it can be summed in float32. */
#define VALUE_MAX REAL_C(1e12)

/* ERR_OK when lo <= x <= hi; NaN and infinity are ERR_NOT_FINITE. */
MUST_CHECK enum err check_real(real_t x, real_t lo, real_t hi);

/* 1 - e^-x without cancellation, x >= 0. */
real_t one_less_exp(real_t x);

#endif
