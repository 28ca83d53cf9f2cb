/* real_t: the scalar of matrix analysis, models and design. It is float in the firmware. The host builds the
 * same sources a second time with REFLUX_REAL_DOUBLE for the simulator and the host tools, and those of model/
 * a third time with REFLUX_REAL_LONG for derivatives of the simulated columns. */
#ifndef REFLUX_NUM_REAL_H
#define REFLUX_NUM_REAL_H

#include <math.h>
#include <stdbool.h>

#include "num/real_math.h"

#ifdef REFLUX_REAL_DOUBLE
typedef double real_t; /* host only: never defined in a firmware build */
#define REAL_C(x)         x
#define real_exp(x)       exp(x)
#define real_log(x)       log(x)
#define real_pow(x, y)    pow(x, y)
#define real_abs(x)       fabs(x)
#define real_sqrt(x)      sqrt(x)
#define REAL_EPSILON      2.220446049250313e-16
#define real_fma(a, b, c) __builtin_fma(a, b, c)
#elif defined REFLUX_REAL_LONG
#include <float.h>
typedef long double real_t; /* host only; on some machines no wider than double */
#define REAL_C(x)         x##L
#define real_exp(x)       expl(x)
#define real_log(x)       logl(x)
#define real_pow(x, y)    powl(x, y)
#define real_abs(x)       fabsl(x)
#define real_sqrt(x)      sqrtl(x)
#define REAL_EPSILON      LDBL_EPSILON
#define real_fma(a, b, c) __builtin_fmal(a, b, c)
#else
typedef float real_t;
#define REAL_C(x)         x##f
#define real_exp(x)       float_exp(x)
#define real_log(x)       float_log(x)
#define real_pow(x, y)    float_pow(x, y)
#define real_abs(x)       fabsf(x)
#define real_sqrt(x)      sqrtf(x)
#define REAL_EPSILON      1.1920929e-7f
/* a * b + c, rounded once on every machine. It is an instruction where the processor has one, else a call. */
#define real_fma(a, b, c) __builtin_fmaf(a, b, c)
#endif

/* lo <= x <= hi; false for NaN. */
static inline bool real_within(real_t x, real_t lo, real_t hi)
{
    return x >= lo && x <= hi;
}

/* Returns x, or the bound that it is beyond; lo must not be above hi. NaN stays. */
static inline real_t real_clamp(real_t x, real_t lo, real_t hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

#endif
