/* Exponential, logarithm and power of float, without double and without the C library.
 *
 * They compute in whole numbers of 64 bits, so a result is the same, bit for bit, on every processor. The error is at most
 * 0.505 ulp for float_exp, 0.501 for float_log, 0.515 for float_pow, subnormal results included
 * (tests/unit/test_real_math.c).
 *
 *   - NaN gives NaN, also in float_pow(1, NaN) and float_pow(NaN, 0)
 *   - the logarithm of 0 is -infinity; that of a negative number is NaN
 *   - a negative base has a power only where the exponent is a whole number
 *   - zero of either sign counts as zero; a result that is too large is infinity, one that is too small is zero
 *   - errno and the floating-point flags stay unchanged
 */
#ifndef REFLUX_NUM_REAL_MATH_H
#define REFLUX_NUM_REAL_MATH_H

float float_exp(float x);
float float_log(float x);
float float_pow(float x, float y);

#endif
