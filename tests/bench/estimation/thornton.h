/* The opponent of kinds/composition/covariance_ud.h: the time update of U D U' as textbooks have it, with the transition as a matrix and
 * modified weighted Gram-Schmidt. C. L. Thornton (1976); G. J. Bierman, Factorization Methods for Discrete Sequential Estimation (1977),
 * theorem VI.4.1. */
#ifndef REFLUX_BENCH_THORNTON_H
#define REFLUX_BENCH_THORNTON_H

#include "kinds/composition/covariance.h"

/* The whole transition as a matrix, of n + extras rows: each column by column_transition_apply. */
void thornton_transition(const struct covariance_step *step, size_t n, real_t *matrix);

/* Numbers of work for `noisy` states that gather noise. */
static inline size_t thornton_numbers(size_t n, size_t noisy)
{
    return n * (n + noisy) + n + noisy;
}

/* Packed U D (num/ud.h) of n states <- that of matrix U D U' matrix' + noise. at[noisy]: which states gather noise[noisy]. */
void thornton_carry(real_t *ud, size_t n, const real_t *matrix, size_t noisy, const size_t *at,
                    const real_t *noise, real_t *work);

#endif
