#include "thornton.h"

#include <string.h>

#include "num/ud.h"

void thornton_transition(const struct covariance_step *step, size_t n, real_t *matrix)
{
    static real_t column[COVARIANCE_STATES_MAX];
    size_t all = n + step->extras;
    memset(matrix, 0, all * all * sizeof *matrix);
    for (size_t j = 0; j < all; j++) {
        for (size_t i = 0; i < n; i++)
            column[i] = j < n ? (real_t)(i == j) : step->push[(j - n) * n + i];
        column_transition_apply(step->transition, column);
        for (size_t i = 0; i < n; i++)
            matrix[i * all + j] = column[i];
        if (j >= n)
            matrix[j * all + j] = step->keep[j - n];
    }
}

/* row of matrix U, which is triangular. */
static void multiply_row(const real_t *ud, size_t n, const real_t *of, real_t *out)
{
    for (size_t j = 0; j < n; j++) {
        real_t sum = of[j];
        for (size_t i = 0; i < j; i++)
            sum = real_fma(of[i], ud[i], sum);
        out[j] = sum;
        ud += j + 1;
    }
}

void thornton_carry(real_t *ud, size_t n, const real_t *matrix, size_t noisy, const size_t *at,
                    const real_t *noise, real_t *work)
{
    size_t width = n + noisy;
    real_t *w = work, *d = work + n * width;
    for (size_t i = 0; i < n; i++) {
        multiply_row(ud, n, matrix + i * n, w + i * width);
        for (size_t k = 0; k < noisy; k++)
            w[i * width + n + k] = (real_t)(at[k] == i);
        d[i] = ud[ud_count(i) + i];
    }
    for (size_t k = 0; k < noisy; k++)
        d[n + k] = noise[k];
    for (size_t j = n; j-- > 0;) {
        real_t *own = w + j * width, *column = ud + ud_count(j), sum = 0;
        real_t weighted[2 * COVARIANCE_STATES_MAX];
        for (size_t k = 0; k < width; k++) {
            weighted[k] = own[k] * d[k];
            sum = real_fma(weighted[k], own[k], sum);
        }
        column[j] = sum;
        real_t inverse = 1 / sum;
        for (size_t i = 0; i < j; i++) {
            real_t *other = w + i * width, product = 0;
            for (size_t k = 0; k < width; k++)
                product = real_fma(other[k], weighted[k], product);
            product *= inverse;
            column[i] = product;
            for (size_t k = 0; k < width; k++)
                other[k] = real_fma(-product, own[k], other[k]);
        }
    }
}
