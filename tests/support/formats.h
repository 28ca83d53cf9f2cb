/* Bounds and conversions that differ between the float32 and the Q7.24 build of the same test. */
#ifndef REFLUX_TESTS_FORMATS_H
#define REFLUX_TESTS_FORMATS_H

#include "num/num.h"

#ifdef REFLUX_FIXED_POINT
#define BY_FORMAT(in_float, in_fixed) (in_fixed)
#else
#define BY_FORMAT(in_float, in_fixed) (in_float)
#endif

static inline num_t N(double x)
{
    return num_from_float((float)x);
}

/* Exact in both builds, unlike num_to_float in the fixed one. */
static inline double D(num_t a)
{
#ifdef REFLUX_FIXED_POINT
    return (double)a.q / 16777216.0;
#else
    return (double)a;
#endif
}

#endif
