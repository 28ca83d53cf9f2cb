/* Exponential, logarithm and power of float, without double and without the C library.
 *
 * They compute in whole numbers of 64 bits, so a result is the same, bit for bit, on every processor. Error: at most
 * 0.505 ulp for float_exp, 0.501 for float_log, 0.515 for float_pow, subnormal results included
 * (tests/unit/test_real_math.c).
 *
 *   - not a number in, not a number out, also from float_pow(1, NaN) and float_pow(NaN, 0)
 *   - logarithm of 0 is -infinity, of less than 0 not a number
 *   - a negative base has a power only where the exponent is a whole number
 *   - zero of either sign counts as zero; too large becomes infinity, too small zero
 *   - errno and the floating-point flags are left alone
 */
#ifndef REFLUX_NUM_REAL_MATH_H
#define REFLUX_NUM_REAL_MATH_H

float float_exp(float x);
float float_log(float x);
float float_pow(float x, float y);

#endif
